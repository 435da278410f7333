//! The passes of the solvers over their fields.
//!
//! Each pass works on pieces of [`RowSegments`], along which the motion of a body is affine, and does everything that needs the
//! same fields at once. Sums are taken for each body: Σ B f of its modes B from Σ f and Σ j f of every piece.

use crate::parallel::Rows;
use crate::solver::bands::{Bands, Found};
use crate::solver::problem::Problem;
use crate::solver::rigid_motion::{Line, ModeCoefficients};
use crate::solver::row_segments::{PIECE_CELLS, Piece, RowSegments};
use crate::sum::{most, sum, sum_of_pairs};

/// The numbers of the cells of a piece.
pub(crate) static NUMBERS: [f64; PIECE_CELLS] = {
    let (mut numbers, mut j) = ([0.0; PIECE_CELLS], 0);
    while j < PIECE_CELLS {
        numbers[j] = j as f64;
        j += 1;
    }
    numbers
};

/// The fields of [`Passes::survey`].
pub(crate) struct Fields<'a> {
    pub(crate) direction: &'a [f64],
    pub(crate) image: &'a [f64],
    pub(crate) pressure: &'a mut [f64],
    pub(crate) potential: &'a mut [f64],
}

/// The passes over the fields of one contact.
#[derive(Debug, Clone)]
pub(crate) struct Passes {
    bands: Bands,
}

impl Passes {
    pub(crate) fn new(rows: &Rows, bodies: usize) -> Passes {
        Passes { bands: Bands::new(rows, bodies) }
    }

    /// p += a d, v += a K d, with r = motion − (c v + gap) on the cells in contact. Finds Σ B r, Σ r², Σ (c v)² and
    /// Σ min(p, 0)² over them, the greatest r of them, and the greatest motion − (c v + gap) of all others that may carry pressure.
    pub(crate) fn survey(
        &mut self,
        problem: &Problem<'_>,
        runs: &RowSegments,
        a: f64,
        motions: &[ModeCoefficients],
        fields: Fields<'_>,
    ) -> &[Found] {
        let Fields { direction, image, pressure, potential } = fields;
        let (c, cut) = (problem.compliance, problem.cut());
        self.bands.over([pressure, potential], |band, [p, v], found| {
            let mut residual = [0.0; PIECE_CELLS];
            runs.walk(&band, cut, |Piece { cells, body }, inside| {
                let here = cells.start - band.start..cells.end - band.start;
                let (v, h, found) = (&mut v[here.clone()], &problem.gap[cells.clone()], &mut found[body]);
                if a != 0.0 {
                    add(v, a, &image[cells.clone()]);
                }
                let line = problem.line(body, cells.start);
                let motion = line.of(motions[body]);
                if !inside {
                    if !problem.released(body) {
                        note_depth(found, motion, c, v, h);
                    }
                    return;
                }
                let (p, r) = (&mut p[here], &mut residual[..cells.len()]);
                if a != 0.0 {
                    add(p, a, &direction[cells]);
                }
                fill_residual(motion, r, c, v, h);
                add_modes(&mut found.sums.residual_modes, &line, r);
                found.peak = found.peak.max(most(r));
                found.sums.residual_square += sum_of_pairs(r, r, |r, _| r * r);
                found.sums.displacement_square += sum_of_pairs(v, v, |v, _| (c * v) * (c * v));
                found.sums.negative_square += sum_of_pairs(p, p, |p, _| if p < 0.0 { p * p } else { 0.0 });
            });
        })
    }

    /// The deepest penetration of the cells outside that may carry pressure, 0 if there is none.
    pub(crate) fn penetration(
        &mut self,
        problem: &Problem<'_>,
        runs: &RowSegments,
        motions: &[ModeCoefficients],
        potential: &[f64],
    ) -> f64 {
        let (c, cut) = (problem.compliance, problem.cut());
        let found = self.bands.over([], |band, [], found| {
            runs.walk(&band, cut, |Piece { cells, body }, inside| {
                if !inside && !problem.released(body) {
                    let motion = problem.line(body, cells.start).of(motions[body]);
                    note_depth(&mut found[body], motion, c, &potential[cells.clone()], &problem.gap[cells]);
                }
            });
        });
        found.iter().map(Found::greatest).fold(0.0, f64::max)
    }

    /// z ← r = motion − (c v + gap) in contact, zero elsewhere; returns Σ r² and the greatest r.
    pub(crate) fn residual(
        &mut self,
        problem: &Problem<'_>,
        runs: &RowSegments,
        motions: &[ModeCoefficients],
        potential: &[f64],
        z: &mut [f64],
    ) -> [f64; 2] {
        let (c, cut) = (problem.compliance, problem.cut());
        let found = self.bands.over([z], |band, [z], found| {
            runs.walk(&band, cut, |Piece { cells, body }, inside| {
                let z = &mut z[cells.start - band.start..cells.end - band.start];
                if !inside {
                    return z.fill(0.0);
                }
                let motion = problem.line(body, cells.start).of(motions[body]);
                fill_residual(motion, z, c, &potential[cells.clone()], &problem.gap[cells]);
                found[body].sums.residual_square += sum_of_pairs(z, z, |z, _| z * z);
                found[body].peak = found[body].peak.max(most(z));
            });
        });
        let of =
            |[square, deepest]: [f64; 2], found: &Found| [square + found.sums.residual_square, deepest.max(found.peak)];
        found.iter().fold([0.0; 2], of)
    }

    /// Finds Σ B z, Σ B Kd, Σ B d and Σ z·Kd in contact.
    pub(crate) fn overlaps(
        &mut self,
        problem: &Problem<'_>,
        runs: &RowSegments,
        z: &[f64],
        image: &[f64],
        direction: &[f64],
    ) -> &[Found] {
        let cut = problem.cut();
        self.bands.over([], |band, [], found| {
            for Piece { cells, body } in runs.inside(&band, cut) {
                let (sums, line) = (&mut found[body].sums, problem.line(body, cells.start));
                let (z, kd, d) = (&z[cells.clone()], &image[cells.clone()], &direction[cells]);
                add_modes(&mut sums.residual_modes, &line, z);
                add_modes(&mut sums.image_modes, &line, kd);
                add_modes(&mut sums.direction_modes, &line, d);
                sums.residual_image += sum_of_pairs(z, kd, |z, kd| z * kd);
            }
        })
    }

    /// d ← scale (z + β d + motion) in contact, 0 elsewhere; with β = 0 for any d, NaN included.
    pub(crate) fn redirect(
        &mut self,
        problem: &Problem<'_>,
        runs: &RowSegments,
        [scale, beta]: [f64; 2],
        motions: &[ModeCoefficients],
        z: &[f64],
        direction: &mut [f64],
    ) {
        let cut = problem.cut();
        self.bands.over([direction], |band, [d], _| {
            runs.walk(&band, cut, |Piece { cells, body }, inside| {
                let d = &mut d[cells.start - band.start..cells.end - band.start];
                if !inside {
                    return d.fill(0.0);
                }
                let motion = problem.line(body, cells.start).of(motions[body]);
                let z = &z[cells];
                if beta == 0.0 {
                    map(motion, d, [z, z], |_, z, _, motion| scale * (z + motion));
                } else {
                    map(motion, d, [z, z], |d, z, _, motion| scale * (z + beta * d + motion));
                }
            });
        });
    }

    /// d += max(0, p + shape · motion) − p in contact, with p = 0 for negative pressures; if `whole`,
    /// d ← max(0, p + d + shape · motion) − p. Bodies without motion keep their d.
    pub(crate) fn correct(
        &mut self,
        problem: &Problem<'_>,
        runs: &RowSegments,
        motions: &[Option<ModeCoefficients>],
        whole: bool,
        [pressure, shape]: [&[f64]; 2],
        direction: &mut [f64],
    ) {
        let cut = problem.cut();
        self.bands.over([direction], |band, [d], _| {
            for Piece { cells, body } in runs.inside(&band, cut) {
                let d = &mut d[cells.start - band.start..cells.end - band.start];
                let Some(motion) = motions[body] else { continue };
                let motion = problem.line(body, cells.start).of(motion);
                map(motion, d, [&pressure[cells.clone()], &shape[cells]], |d, p, shape, motion| {
                    if whole {
                        return (p + d + shape * motion).max(0.0) - p;
                    }
                    let p = p.max(0.0);
                    d + ((p + shape * motion).max(0.0) - p)
                });
            }
        });
    }

    /// Finds Σ B Kd of bodies that tilt, and Σ r·d and Σ d·Kd, in contact.
    pub(crate) fn slope_and_curvature(
        &mut self,
        problem: &Problem<'_>,
        runs: &RowSegments,
        motions: &[ModeCoefficients],
        [potential, direction, image]: [&[f64]; 3],
    ) -> &[Found] {
        let (c, cut) = (problem.compliance, problem.cut());
        self.bands.over([], |band, [], found| {
            let mut residual = [0.0; PIECE_CELLS];
            for Piece { cells, body } in runs.inside(&band, cut) {
                let (sums, line) = (&mut found[body].sums, problem.line(body, cells.start));
                let (d, kd, r) = (&direction[cells.clone()], &image[cells.clone()], &mut residual[..cells.len()]);
                fill_residual(line.of(motions[body]), r, c, &potential[cells.clone()], &problem.gap[cells]);
                if problem.bodies[body].tilts() {
                    add_modes(&mut sums.image_modes, &line, kd);
                }
                sums.residual_direction += sum_of_pairs(r, d, |r, d| r * d);
                sums.direction_image += sum_of_pairs(d, kd, |d, kd| d * kd);
            }
        })
    }
}

/// r = motion − (c v + gap) on the cells of a piece.
#[inline]
fn fill_residual(motion: [f64; 2], r: &mut [f64], c: f64, v: &[f64], gap: &[f64]) {
    map(motion, r, [v, gap], |_, v, h, motion| motion - (c * v + h));
}

/// x += a y.
pub(crate) fn add(x: &mut [f64], a: f64, y: &[f64]) {
    for (x, &y) in x.iter_mut().zip(y) {
        *x += a * y;
    }
}

/// Adds Σ B f over a piece.
#[inline]
fn add_modes(sums: &mut [f64; 3], line: &Line, f: &[f64]) {
    if line.upright {
        sums[0] += sum(f);
        return;
    }
    let moment = if line.changes() { sum_of_pairs(f, &NUMBERS[..f.len()], |f, j| f * j) } else { 0.0 };
    let part = line.sums([sum(f), moment]);
    sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
}

/// Takes the depths of a piece into the greatest.
#[inline]
fn note_depth(found: &mut Found, [start, slope]: [f64; 2], c: f64, v: &[f64], h: &[f64]) {
    if slope == 0.0 {
        found.raise([v, h], |v, h, _| start - (c * v + h));
    } else {
        found.raise([v, h], |v, h, j| start + slope * j - (c * v + h));
    }
}

/// z ← f(z, x, y, start + slope j) on the cells of a piece.
#[inline(always)]
fn map([start, slope]: [f64; 2], z: &mut [f64], [x, y]: [&[f64]; 2], f: impl Fn(f64, f64, f64, f64) -> f64) {
    let values = z.iter_mut().zip(x.iter().zip(y));
    if slope == 0.0 {
        values.for_each(|(z, (&x, &y))| *z = f(*z, x, y, start));
    } else {
        values.zip(&NUMBERS).for_each(|((z, (&x, &y)), &j)| *z = f(*z, x, y, start + slope * j));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::kernel::InfluenceKernel;
    use crate::solver::contact_set::ContactSet;
    use crate::solver::rigid_motion::Freedom;

    /// Every pass against its definition, cell by cell, with one body and with several, on one band and on more.
    #[test]
    fn passes_match_their_definitions() {
        let freedom = |translation, tilt, total| Freedom { translation, tilt, point: [0.1, -0.2], total };
        let [upright, tilting] = [freedom(true, [false; 2], 1.0), freedom(true, [true; 2], 1.0)];
        let several = [freedom(false, [true, false], 0.0), tilting, freedom(true, [false; 2], 0.0), upright];
        for cells in [[11, 7], [3, 5000], [180, 151]] {
            check_passes(cells, &[upright]);
            check_passes(cells, &[tilting]);
            check_passes(cells, &several);
        }
    }

    fn check_passes(cells: [usize; 2], bodies: &[Freedom]) {
        let grid = Grid::new(cells, [2.0, 3.0]).unwrap();
        let (n, columns) = (grid.len(), cells[1]);
        let kernel = InfluenceKernel::half_space(&grid).unwrap().on(&grid, [false; 2]);
        let field = |seed: f64| (0..n).map(|k| (seed * k as f64 + seed).sin()).collect::<Vec<f64>>();
        let owner: Vec<u16> = (0..n).map(|k| ((k % columns / 3 + k / columns) % bodies.len()) as u16).collect();
        let (gap, d, kd, a, c) = (field(0.3), field(0.7), field(1.1), 0.4, 0.8);
        let owner = (bodies.len() > 1).then_some(owner.as_slice());
        let problem =
            Problem { kernel: &kernel, compliance: c, gap: &gap, prescribed: 0.0, bodies, owner, likely: None };
        let mut set = ContactSet::new(n, bodies.len());
        for (k, member) in set.member.iter_mut().enumerate() {
            *member = k % 1000 > 9 && k % 1000 != 50 && !problem.released(problem.owner(k));
        }
        set.update(&problem);
        let motions: Vec<ModeCoefficients> = (0..bodies.len())
            .map(|body| {
                let (size, Freedom { tilt, .. }) = (1.0 + body as f64, bodies[body]);
                let [tilt1, tilt2] = tilt.map(|free| if free { 0.1 * size } else { 0.0 });
                ModeCoefficients([0.2 * size, tilt1, tilt2])
            })
            .collect();
        let at = |k: usize| problem.modes(problem.owner(k)).displacement(motions[problem.owner(k)], k);
        let modes = |k: usize| problem.modes(problem.owner(k)).line(k).sums([1.0, 0.0]);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * (1.0 + a.abs()), "{a} {b}");
        let inside = |body: usize, f: &dyn Fn(usize) -> f64| {
            (0..n).filter(|&k| set.member[k] && problem.owner(k) == body).map(f).sum::<f64>()
        };
        let (mut passes, runs) = (Passes::new(kernel.rows(), bodies.len()), &set.runs);

        let (mut p, mut v) = (field(1.3), field(1.7));
        let (p0, v0) = (p.clone(), v.clone());
        let fields = Fields { direction: &d, image: &kd, pressure: &mut p, potential: &mut v };
        let found = passes.survey(&problem, runs, a, &motions, fields).to_vec();
        let mut deepest = 0.0_f64;
        for k in 0..n {
            assert_eq!(v[k], v0[k] + a * kd[k]);
            assert_eq!(p[k], if set.member[k] { p0[k] + a * d[k] } else { p0[k] });
            if !set.member[k] && !problem.released(problem.owner(k)) {
                deepest = deepest.max(at(k) - (c * v[k] + gap[k]));
            }
        }
        let r: Vec<f64> = (0..n).map(|k| at(k) - (c * v[k] + gap[k])).collect();
        for (body, found) in found.iter().enumerate() {
            (0..3).for_each(|m| near(found.sums.residual_modes[m], inside(body, &|k| modes(k)[m] * r[k])));
            near(found.sums.residual_square, inside(body, &|k| r[k] * r[k]));
            near(found.sums.displacement_square, inside(body, &|k| c * v[k] * c * v[k]));
            near(found.sums.negative_square, inside(body, &|k| p[k].min(0.0).powi(2)));
            let own = (0..n).filter(|&k| set.member[k] && problem.owner(k) == body);
            assert_eq!(found.peak, own.map(|k| r[k]).fold(f64::NEG_INFINITY, f64::max));
        }
        near(found.iter().map(Found::greatest).fold(0.0, f64::max), deepest);
        near(passes.penetration(&problem, runs, &motions, &v), deepest);

        let mut z = field(2.0);
        let [square, highest] = passes.residual(&problem, runs, &motions, &v, &mut z);
        near(square, z.iter().map(|z| z * z).sum());
        assert_eq!(highest, z.iter().copied().fold(0.0, f64::max));
        (0..n).for_each(|k| near(z[k], if set.member[k] { r[k] } else { 0.0 }));
        let z = field(2.2);
        for (body, found) in passes.overlaps(&problem, runs, &z, &kd, &d).iter().enumerate() {
            for m in 0..3 {
                near(found.sums.residual_modes[m], inside(body, &|k| modes(k)[m] * z[k]));
                near(found.sums.image_modes[m], inside(body, &|k| modes(k)[m] * kd[k]));
                near(found.sums.direction_modes[m], inside(body, &|k| modes(k)[m] * d[k]));
            }
            near(found.sums.residual_image, inside(body, &|k| z[k] * kd[k]));
        }
        for (body, found) in passes.slope_and_curvature(&problem, runs, &motions, [&v, &d, &kd]).iter().enumerate() {
            let tilts = if bodies[body].tilts() { 1.0 } else { 0.0 };
            (0..3).for_each(|m| near(found.sums.image_modes[m], tilts * inside(body, &|k| modes(k)[m] * kd[k])));
            near(found.sums.residual_direction, inside(body, &|k| r[k] * d[k]));
            near(found.sums.direction_image, inside(body, &|k| d[k] * kd[k]));
        }
        let mut turned = d.clone();
        passes.redirect(&problem, runs, [2.0, 0.5], &motions, &z, &mut turned);
        (0..n).for_each(|k| {
            near(turned[k], if set.member[k] { 2.0 * (z[k] + 0.5 * d[k] + at(k)) } else { 0.0 });
        });
        let corrected = |body: usize| (body != 1).then_some(motions[body]);
        let corrections: Vec<_> = (0..bodies.len()).map(corrected).collect();
        for whole in [false, true] {
            let before = turned.clone();
            passes.correct(&problem, runs, &corrections, whole, [&p, &gap], &mut turned);
            for k in 0..n {
                let (base, kept) =
                    if whole { (p[k] + before[k], -p[k]) } else { (p[k].max(0.0), before[k] - p[k].max(0.0)) };
                let correct = set.member[k] && corrections[problem.owner(k)].is_some();
                near(turned[k], if correct { (base + gap[k] * at(k)).max(0.0) + kept } else { before[k] });
            }
        }
    }
}
