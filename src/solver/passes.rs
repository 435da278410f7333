//! The passes of the solvers over their fields.
//!
//! Each pass works on pieces of [`RowSegments`], along which the motion of a body is affine, and does all work that
//! reads the same fields at once. Sums are taken for each body: Σ B f of its modes B from Σ f and Σ j f of every
//! piece.

use super::{BandSums, Bands, ModeCoefficients, PIECE_CELLS, Piece, Problem, RowModes, RowSegments, Solution, Solve};
use crate::sum::{most, sum, sum_of_pairs};

/// The numbers j = 0, 1, … of the cells of a piece, as values.
static NUMBERS: [f64; PIECE_CELLS] = {
    let (mut numbers, mut j) = ([0.0; PIECE_CELLS], 0);
    while j < PIECE_CELLS {
        numbers[j] = j as f64;
        j += 1;
    }
    numbers
};

/// A search direction d and its K d.
#[derive(Debug, Clone)]
pub(crate) struct Search {
    pub(crate) direction: Vec<f64>,
    pub(crate) image: Vec<f64>,
}

impl Search {
    pub(crate) fn new(cells: usize) -> Search {
        Search { direction: vec![0.0; cells], image: vec![0.0; cells] }
    }

    /// Computes K d.
    pub(crate) fn convolve(&mut self, solve: &mut Solve<'_>) {
        solve.convolve_field(&self.direction, &mut self.image);
    }
}

/// The cells of a problem, cut into bands and pieces, for one pass.
pub(crate) struct Passes<'a> {
    pub(crate) problem: &'a Problem<'a>,
    pub(crate) segments: &'a RowSegments,
    pub(crate) bands: &'a mut Bands,
}

/// A piece of cells under one body, in a pass.
struct Visit<'p, T, const M: usize> {
    piece: Piece,
    in_contact: bool,
    /// The parts of the fields that the pass writes.
    outputs: [&'p mut [T]; M],
    /// A buffer for r.
    residual: &'p mut [f64],
    /// The sums of the body.
    sums: &'p mut BandSums,
}

impl<'a> Passes<'a> {
    /// Calls `visit` with all pieces.
    #[inline]
    fn over<T: Send, const M: usize>(
        self,
        outputs: [&mut [T]; M],
        visit: impl Fn(Visit<'_, T, M>) + Sync,
    ) -> &'a mut Bands {
        let Passes { problem, segments, bands } = self;
        let cut = problem.cut();
        bands.over(outputs, |band, mut outputs, sums| {
            let mut residual = [0.0; PIECE_CELLS];
            segments.walk(&band, cut, |piece, in_contact| {
                let here = piece.cells.start - band.start..piece.cells.end - band.start;
                let outputs = outputs.each_mut().map(|output| &mut output[here.clone()]);
                let (residual, sums) = (&mut residual[..here.len()], &mut sums[piece.body]);
                visit(Visit { piece, in_contact, outputs, residual, sums });
            });
        });
        bands
    }

    /// p += a d, v += a K d, with r = motion − (c v + gap) on the cells in contact. Sums Σ B r, Σ r², Σ (c v)² and Σ
    /// min(p, 0)² over them, and takes the largest r. Over all other cells that may carry pressure it takes the
    /// maximum motion − (c v + gap).
    pub(crate) fn survey(self, a: f64, search: &Search, solution: &mut Solution) -> &'a [BandSums] {
        let (problem, c) = (self.problem, self.problem.compliance);
        let Solution { motions, pressure, potential, .. } = solution;
        let bands = self.over([pressure, potential], |visit| {
            let Visit { piece, in_contact, outputs: [p, v], residual: r, sums } = visit;
            if a != 0.0 {
                add(v, a, &search.image[piece.cells.clone()]);
            }
            if !in_contact && problem.released(piece.body) {
                return;
            }
            let line = fill_residual(problem, &piece, motions, v, r);
            if !in_contact {
                sums.penetration = sums.penetration.max(most(r));
                return;
            }
            if a != 0.0 {
                add(p, a, &search.direction[piece.cells]);
            }
            add_modes(&mut sums.residual_modes, &line, r);
            sums.peak = sums.peak.max(most(r));
            sums.residual_square += sum_of_pairs(r, r, |r, _| r * r);
            sums.displacement_square += sum_of_pairs(v, v, |v, _| (c * v) * (c * v));
            sums.negative_square += sum_of_pairs(p, p, |p, _| if p < 0.0 { p * p } else { 0.0 });
        });
        bands.joined()
    }

    /// The deepest penetration of the cells outside that may carry pressure, 0 if there is none.
    pub(crate) fn penetration(self, solution: &Solution) -> f64 {
        let (problem, Solution { motions, potential, .. }) = (self.problem, solution);
        let bands = self.over::<f64, 0>([], |Visit { piece, in_contact, residual: depth, sums, .. }| {
            if !in_contact && !problem.released(piece.body) {
                fill_residual(problem, &piece, motions, &potential[piece.cells.clone()], depth);
                sums.penetration = sums.penetration.max(most(depth));
            }
        });
        bands.joined().iter().map(|sums| sums.penetration).fold(0.0, f64::max)
    }

    /// Takes cells without pressure that penetrate deeper than `least` into the set.
    pub(crate) fn add_penetrating(self, least: f64, solution: &Solution, member: &mut [bool]) {
        let (problem, Solution { motions, pressure, potential, .. }) = (self.problem, solution);
        self.over([member], |Visit { piece, in_contact, outputs: [member], residual: depth, .. }| {
            if !in_contact && !problem.released(piece.body) {
                fill_residual(problem, &piece, motions, &potential[piece.cells.clone()], depth);
                let members = member.iter_mut().zip(pressure[piece.cells].iter().zip(depth));
                members.for_each(|(member, (&p, &mut depth))| *member = (p == 0.0) & (depth > least));
            }
        });
    }

    /// z ← r = motion − (c v + gap) in contact, zero elsewhere; returns Σ r² and the largest r.
    pub(crate) fn residual(self, solution: &Solution, z: &mut [f64]) -> [f64; 2] {
        let (problem, Solution { motions, potential, .. }) = (self.problem, solution);
        let bands = self.over([z], |Visit { piece, in_contact, outputs: [z], sums, .. }| {
            if !in_contact {
                return z.fill(0.0);
            }
            fill_residual(problem, &piece, motions, &potential[piece.cells.clone()], z);
            sums.residual_square += sum_of_pairs(z, z, |z, _| z * z);
            sums.peak = sums.peak.max(most(z));
        });
        let add = |[square, peak]: [f64; 2], sums: &BandSums| [square + sums.residual_square, peak.max(sums.peak)];
        bands.joined().iter().fold([0.0; 2], add)
    }

    /// Sums Σ B z, Σ B Kd, Σ B d and Σ z·Kd in contact.
    pub(crate) fn overlaps(self, z: &[f64], search: &Search) -> &'a [BandSums] {
        let problem = self.problem;
        let bands = self.over::<f64, 0>([], |Visit { piece: Piece { cells, body }, in_contact, sums, .. }| {
            if !in_contact {
                return;
            }
            let line = problem.line(body, cells.start);
            let (z, kd, d) = (&z[cells.clone()], &search.image[cells.clone()], &search.direction[cells]);
            add_modes(&mut sums.residual_modes, &line, z);
            add_modes(&mut sums.image_modes, &line, kd);
            add_modes(&mut sums.direction_modes, &line, d);
            sums.residual_image += sum_of_pairs(z, kd, |z, kd| z * kd);
        });
        bands.joined()
    }

    /// d ← scale (z + β d + motion) in contact, 0 elsewhere; with β = 0 for any d, NaN included.
    pub(crate) fn redirect(
        self,
        scale: f64,
        beta: f64,
        motions: &[ModeCoefficients],
        z: &[f64],
        direction: &mut [f64],
    ) {
        let problem = self.problem;
        self.over([direction], |Visit { piece: Piece { cells, body }, in_contact, outputs: [d], .. }| {
            if !in_contact {
                return d.fill(0.0);
            }
            let (motion, z) = (problem.line(body, cells.start).of(motions[body]), &z[cells]);
            if beta == 0.0 {
                map(motion, d, [z, z], |_, z, _, motion| scale * (z + motion));
            } else {
                map(motion, d, [z, z], |d, z, _, motion| scale * (z + beta * d + motion));
            }
        });
    }

    /// d += max(0, p + shape · motion) − p in contact, with p = 0 for negative pressures; if `whole`,
    /// d ← max(0, p + d + shape · motion) − p. Bodies without motion keep their d.
    pub(crate) fn correct(
        self,
        motions: &[Option<ModeCoefficients>],
        whole: bool,
        [pressure, shape]: [&[f64]; 2],
        direction: &mut [f64],
    ) {
        let problem = self.problem;
        self.over([direction], |Visit { piece: Piece { cells, body }, in_contact, outputs: [d], .. }| {
            let Some(motion) = motions[body].filter(|_| in_contact) else { return };
            let motion = problem.line(body, cells.start).of(motion);
            map(motion, d, [&pressure[cells.clone()], &shape[cells]], |d, p, shape, motion| {
                if whole {
                    return (p + d + shape * motion).max(0.0) - p;
                }
                let p = p.max(0.0);
                d + ((p + shape * motion).max(0.0) - p)
            });
        });
    }

    /// Sums Σ B Kd of bodies that tilt, and Σ r·d and Σ d·Kd, in contact.
    pub(crate) fn slope_and_curvature(self, solution: &Solution, search: &Search) -> &'a [BandSums] {
        let (problem, Solution { motions, potential, .. }) = (self.problem, solution);
        let bands = self.over::<f64, 0>([], |Visit { piece, in_contact, residual: r, sums, .. }| {
            if !in_contact {
                return;
            }
            let cells = || piece.cells.clone();
            let (d, kd) = (&search.direction[cells()], &search.image[cells()]);
            let line = fill_residual(problem, &piece, motions, &potential[cells()], r);
            if problem.bodies[piece.body].tilts() {
                add_modes(&mut sums.image_modes, &line, kd);
            }
            sums.residual_direction += sum_of_pairs(r, d, |r, d| r * d);
            sums.direction_image += sum_of_pairs(d, kd, |d, kd| d * kd);
        });
        bands.joined()
    }
}

/// r ← motion − (c v + gap) on the cells of a piece; returns the modes of the body along it.
#[inline]
fn fill_residual(
    problem: &Problem<'_>,
    Piece { cells, body }: &Piece,
    motions: &[ModeCoefficients],
    v: &[f64],
    r: &mut [f64],
) -> RowModes {
    let (line, c) = (problem.line(*body, cells.start), problem.compliance);
    map(line.of(motions[*body]), r, [v, &problem.gap[cells.clone()]], |_, v, h, motion| motion - (c * v + h));
    line
}

/// x += a y.
pub(crate) fn add(x: &mut [f64], a: f64, y: &[f64]) {
    for (x, &y) in x.iter_mut().zip(y) {
        *x += a * y;
    }
}

/// Adds Σ B f over a piece.
#[inline]
fn add_modes(sums: &mut [f64; 3], line: &RowModes, f: &[f64]) {
    let moment = if line.step != 0.0 { sum_of_pairs(f, &NUMBERS[..f.len()], |f, j| f * j) } else { 0.0 };
    let part = line.sums(sum(f), moment);
    sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
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

    /// Every pass equals its definition, cell by cell, with one body and with several, on one band and on several.
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
        let modes = |k: usize| problem.modes(problem.owner(k)).line(k).sums(1.0, 0.0);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * (1.0 + a.abs()), "{a} {b}");
        let inside = |body: usize, f: &dyn Fn(usize) -> f64| {
            (0..n).filter(|&k| set.member[k] && problem.owner(k) == body).map(f).sum::<f64>()
        };
        let (mut bands, search) =
            (Bands::new(kernel.rows(), bodies.len()), Search { direction: d.clone(), image: kd.clone() });

        let (p0, v0) = (field(1.3), field(1.7));
        let mut solution = Solution::zero(n, bodies.len());
        (solution.pressure, solution.potential) = (p0.clone(), v0.clone());
        solution.motions.clone_from(&motions);
        let found = set.passes(&problem, &mut bands).survey(a, &search, &mut solution).to_vec();
        let Solution { pressure: p, potential: v, .. } = &solution;
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
            (0..3).for_each(|m| near(found.residual_modes[m], inside(body, &|k| modes(k)[m] * r[k])));
            near(found.residual_square, inside(body, &|k| r[k] * r[k]));
            near(found.displacement_square, inside(body, &|k| c * v[k] * c * v[k]));
            near(found.negative_square, inside(body, &|k| p[k].min(0.0).powi(2)));
            let own = (0..n).filter(|&k| set.member[k] && problem.owner(k) == body);
            assert_eq!(found.peak, own.map(|k| r[k]).fold(f64::NEG_INFINITY, f64::max));
        }
        near(found.iter().map(|sums| sums.penetration).fold(0.0, f64::max), deepest);
        near(set.passes(&problem, &mut bands).penetration(&solution), deepest);

        let mut z = field(2.0);
        let [square, highest] = set.passes(&problem, &mut bands).residual(&solution, &mut z);
        near(square, z.iter().map(|z| z * z).sum());
        assert_eq!(highest, z.iter().copied().fold(0.0, f64::max));
        (0..n).for_each(|k| near(z[k], if set.member[k] { r[k] } else { 0.0 }));
        let z = field(2.2);
        for (body, found) in set.passes(&problem, &mut bands).overlaps(&z, &search).iter().enumerate() {
            for m in 0..3 {
                near(found.residual_modes[m], inside(body, &|k| modes(k)[m] * z[k]));
                near(found.image_modes[m], inside(body, &|k| modes(k)[m] * kd[k]));
                near(found.direction_modes[m], inside(body, &|k| modes(k)[m] * d[k]));
            }
            near(found.residual_image, inside(body, &|k| z[k] * kd[k]));
        }
        for (body, found) in set.passes(&problem, &mut bands).slope_and_curvature(&solution, &search).iter().enumerate()
        {
            let tilts = if bodies[body].tilts() { 1.0 } else { 0.0 };
            (0..3).for_each(|m| near(found.image_modes[m], tilts * inside(body, &|k| modes(k)[m] * kd[k])));
            near(found.residual_direction, inside(body, &|k| r[k] * d[k]));
            near(found.direction_image, inside(body, &|k| d[k] * kd[k]));
        }
        let mut turned = d.clone();
        set.passes(&problem, &mut bands).redirect(2.0, 0.5, &motions, &z, &mut turned);
        (0..n).for_each(|k| {
            near(turned[k], if set.member[k] { 2.0 * (z[k] + 0.5 * d[k] + at(k)) } else { 0.0 });
        });
        let corrected = |body: usize| (body != 1).then_some(motions[body]);
        let corrections: Vec<_> = (0..bodies.len()).map(corrected).collect();
        for whole in [false, true] {
            let before = turned.clone();
            set.passes(&problem, &mut bands).correct(&corrections, whole, [p, &gap], &mut turned);
            for k in 0..n {
                let (base, kept) =
                    if whole { (p[k] + before[k], -p[k]) } else { (p[k].max(0.0), before[k] - p[k].max(0.0)) };
                let correct = set.member[k] && corrections[problem.owner(k)].is_some();
                near(turned[k], if correct { (base + gap[k] * at(k)).max(0.0) + kept } else { before[k] });
            }
        }
    }
}
