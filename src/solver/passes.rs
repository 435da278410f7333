//! The passes of the active set over its fields, for a single body that does not tilt: the common scene.
//!
//! Each pass works on whole [`Runs`] of cells, and does everything that needs the same fields at once.

use std::ops::Range;

use crate::kernel::{join, lanes};
use crate::solver::runs::Runs;
use crate::sum::{sum, sum_of_pairs};

/// Lanes in which maxima are taken.
const LANES: usize = 8;

/// Result of [`Passes::survey`].
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Survey {
    /// Σ r, Σ r², Σ (c v)², Σ min(p, 0)² over the cells in contact.
    pub(crate) residual: f64,
    pub(crate) square: f64,
    pub(crate) displacement: f64,
    pub(crate) negative: f64,
    /// The greatest −(c v + gap) of all others.
    pub(crate) depth: f64,
}

/// The fields of [`Passes::survey`].
pub(crate) struct Fields<'a> {
    pub(crate) gap: &'a [f64],
    pub(crate) direction: &'a [f64],
    pub(crate) image: &'a [f64],
    pub(crate) pressure: &'a mut [f64],
    pub(crate) potential: &'a mut [f64],
    pub(crate) residual: &'a mut [f64],
}

/// Sums and maximum of a pass over a band.
#[derive(Debug, Clone, Copy)]
struct Found {
    sums: [f64; 4],
    greatest: f64,
}

impl Found {
    const NOTHING: Found = Found { sums: [0.0; 4], greatest: f64::NEG_INFINITY };

    fn and(self, other: Found) -> Found {
        let sums = [0, 1, 2, 3].map(|m| self.sums[m] + other.sums[m]);
        Found { sums, greatest: self.greatest.max(other.greatest) }
    }
}

/// The passes over the fields of one contact.
#[derive(Debug, Clone)]
pub(crate) struct Passes {
    pub(crate) runs: Runs,
    bands: Bands,
}

/// The fields cut into bands, which threads may share.
#[derive(Debug, Clone)]
struct Bands {
    found: Vec<Found>,
    shared: bool,
}

/// Cells passed over by one thread at a time. Sums are taken band by band, whatever the number of threads.
const BAND_CELLS: usize = 1 << 13;

impl Passes {
    pub(crate) fn new(cells: usize) -> Passes {
        let bands = Bands { found: vec![Found::NOTHING; cells.div_ceil(BAND_CELLS)], shared: lanes(cells) > 1 };
        Passes { runs: Runs::with_capacity(cells), bands }
    }

    /// p += a d, v += a K d, and r = motion − (c v + gap) on the cells in contact, with the sums over them.
    pub(crate) fn survey(&mut self, a: f64, c: f64, motion: f64, fields: Fields<'_>) -> Survey {
        let Fields { gap, direction, image, pressure, potential, residual } = fields;
        let Passes { runs, bands } = self;
        let found = bands.over([pressure, potential, residual], gap.len(), |band, [p, v, r]| {
            let [image, direction, gap] = [image, direction, gap].map(|field| &field[band.clone()]);
            let (mut found, mut depth) = ([0.0; 4], [f64::NEG_INFINITY; LANES]);
            runs.walk(&band, |piece, inside| {
                let (v, h) = (&mut v[piece.clone()], &gap[piece.clone()]);
                if a != 0.0 {
                    add(v, a, &image[piece.clone()]);
                }
                if !inside {
                    reduce([&*v, h], &mut depth, |depth, [v, h]| {
                        let below = -(c * v + h);
                        if below > depth { below } else { depth }
                    });
                    return;
                }
                let (p, r) = (&mut p[piece.clone()], &mut r[piece.clone()]);
                if a != 0.0 {
                    add(p, a, &direction[piece]);
                }
                for ((r, &v), &h) in r.iter_mut().zip(&*v).zip(h) {
                    *r = motion - (c * v + h);
                }
                found[0] += sum(r);
                found[1] += sum_of_pairs(r, r, |r, _| r * r);
                found[2] += sum_of_pairs(v, v, |v, _| (c * v) * (c * v));
                found[3] += sum_of_pairs(p, p, |p, _| if p < 0.0 { p * p } else { 0.0 });
            });
            Found { sums: found, greatest: depth.into_iter().fold(f64::NEG_INFINITY, f64::max) }
        });
        let [residual, square, displacement, negative] = found.sums;
        Survey { residual, square, displacement, negative, depth: found.greatest }
    }

    /// r ← r − mean, and z = r in contact, zero elsewhere; returns Σ r².
    pub(crate) fn center(&mut self, mean: f64, residual: &mut [f64], z: &mut [f64]) -> f64 {
        let Passes { runs, bands } = self;
        let cells = z.len();
        let found = bands.over([residual, z], cells, |band, [r, z]| {
            let mut square = 0.0;
            runs.walk(&band, |piece, inside| {
                let (r, z) = (&mut r[piece.clone()], &mut z[piece]);
                if !inside {
                    return z.fill(0.0);
                }
                for (r, z) in r.iter_mut().zip(&mut *z) {
                    *r -= mean;
                    *z = *r;
                }
                square += sum_of_pairs(z, z, |z, _| z * z);
            });
            Found { sums: [square, 0.0, 0.0, 0.0], ..Found::NOTHING }
        });
        found.sums[0]
    }

    /// Σ z, Σ z·Kd, Σ Kd and Σ d in contact.
    pub(crate) fn overlaps(&mut self, z: &[f64], image: &[f64], direction: &[f64]) -> [f64; 4] {
        let Passes { runs, bands } = self;
        let found = bands.over([], z.len(), |band, []| {
            let mut sums = [0.0; 4];
            for run in runs.within(&band) {
                let (z, kd, d) = (&z[run.clone()], &image[run.clone()], &direction[run]);
                sums[0] += sum(z);
                sums[1] += sum_of_pairs(z, kd, |z, kd| z * kd);
                sums[2] += sum(kd);
                sums[3] += sum(d);
            }
            Found { sums, ..Found::NOTHING }
        });
        found.sums
    }

    /// d ← scale (z + β d + shift) in contact, 0 elsewhere; with β = 0 for any d, NaN included.
    pub(crate) fn redirect(&mut self, [scale, beta, shift]: [f64; 3], z: &[f64], direction: &mut [f64]) {
        let Passes { runs, bands } = self;
        bands.over([direction], z.len(), |band, [d]| {
            let z = &z[band.clone()];
            runs.walk(&band, |piece, inside| {
                let (d, z) = (&mut d[piece.clone()], &z[piece]);
                if !inside {
                    d.fill(0.0);
                } else if beta == 0.0 {
                    d.iter_mut().zip(z).for_each(|(d, &z)| *d = scale * (z + shift));
                } else {
                    d.iter_mut().zip(z).for_each(|(d, &z)| *d = scale * (z + beta * *d + shift));
                }
            });
            Found::NOTHING
        });
    }

    /// Σ r·d and Σ d·Kd in contact.
    pub(crate) fn slope_and_curvature(&mut self, residual: &[f64], direction: &[f64], image: &[f64]) -> [f64; 2] {
        let Passes { runs, bands } = self;
        let found = bands.over([], residual.len(), |band, []| {
            let mut sums = [0.0; 4];
            for run in runs.within(&band) {
                let (r, d, kd) = (&residual[run.clone()], &direction[run.clone()], &image[run]);
                sums[0] += sum_of_pairs(r, d, |r, d| r * d);
                sums[1] += sum_of_pairs(d, kd, |d, kd| d * kd);
            }
            Found { sums, ..Found::NOTHING }
        });
        [found.sums[0], found.sums[1]]
    }
}

impl Bands {
    /// Calls `job` with each band and its part of `outputs`; returns the sums and the maximum over all of them.
    fn over<const M: usize>(
        &mut self,
        outputs: [&mut [f64]; M],
        cells: usize,
        job: impl Fn(Range<usize>, [&mut [f64]; M]) -> Found + Sync,
    ) -> Found {
        let found = &mut self.found[..cells.div_ceil(BAND_CELLS)];
        halve(0..cells, outputs, found, self.shared, &job);
        found.iter().fold(Found::NOTHING, |all, found| all.and(*found))
    }
}

/// Halves the cells down to single bands, and calls `job` with each.
fn halve<const M: usize>(
    cells: Range<usize>,
    outputs: [&mut [f64]; M],
    found: &mut [Found],
    shared: bool,
    job: &(impl Fn(Range<usize>, [&mut [f64]; M]) -> Found + Sync),
) {
    if let [found] = found {
        *found = job(cells, outputs);
        return;
    }
    let bands = found.len() / 2;
    let middle = bands * BAND_CELLS;
    let mut halves = outputs.map(|output| output.split_at_mut(middle));
    let first = halves.each_mut().map(|(first, _)| std::mem::take(first));
    let second = halves.map(|(_, second)| second);
    let (found, others) = found.split_at_mut(bands);
    let (before, after) = (cells.start..cells.start + middle, cells.start + middle..cells.end);
    join(shared, || halve(before, first, found, shared, job), || halve(after, second, others, shared, job));
}

/// x += a y.
fn add(x: &mut [f64], a: f64, y: &[f64]) {
    for (x, &y) in x.iter_mut().zip(y) {
        *x += a * y;
    }
}

/// Combines every pair of values with one of the lanes.
fn reduce([x, y]: [&[f64]; 2], lanes: &mut [f64; LANES], join: impl Fn(f64, [f64; 2]) -> f64) {
    let ((x, x_rest), (y, y_rest)) = (x.as_chunks::<LANES>(), y.as_chunks::<LANES>());
    for (x, y) in x.iter().zip(y) {
        for lane in 0..LANES {
            lanes[lane] = join(lanes[lane], [x[lane], y[lane]]);
        }
    }
    for (lane, (&x, &y)) in lanes.iter_mut().zip(x_rest.iter().zip(y_rest)) {
        *lane = join(*lane, [x, y]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pass against its definition, cell by cell.
    #[test]
    fn passes_match_their_definitions() {
        for n in [77, BAND_CELLS, 3 * BAND_CELLS + 100] {
            check_passes(n);
        }
    }

    fn check_passes(n: usize) {
        let field = |seed: f64| (0..n).map(|k| (seed * k as f64 + seed).sin()).collect::<Vec<f64>>();
        let member: Vec<bool> = (0..n).map(|k| (10..40).contains(&k) || k == 50 || k > 70 && k % 1000 != 7).collect();
        let mut passes = Passes::new(n);
        passes.runs.find(&member);
        let (gap, d, kd, c, motion, a) = (field(0.3), field(0.7), field(1.1), 0.8, 0.2, 0.4);
        let (mut p, mut v, mut r) = (field(1.3), field(1.7), vec![0.0; n]);
        let (p0, v0) = (p.clone(), v.clone());
        let fields =
            Fields { gap: &gap, direction: &d, image: &kd, pressure: &mut p, potential: &mut v, residual: &mut r };
        let found = passes.survey(a, c, motion, fields);
        let (mut sums, mut deepest, mut highest) = ([0.0; 4], f64::NEG_INFINITY, 0.0_f64);
        for k in 0..n {
            let u = c * (v0[k] + a * kd[k]);
            assert_eq!(v[k], v0[k] + a * kd[k]);
            assert_eq!(p[k], if member[k] { p0[k] + a * d[k] } else { p0[k] });
            if !member[k] {
                deepest = deepest.max(-(u + gap[k]));
                continue;
            }
            let residual = motion - (u + gap[k]);
            assert_eq!(r[k], residual);
            highest = highest.max(gap[k].abs());
            let parts = [residual, residual * residual, u * u, p[k].min(0.0).powi(2)];
            (0..4).for_each(|m| sums[m] += parts[m]);
        }
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-13 * (1.0 + a.abs()), "{a} {b}");
        near(found.residual, sums[0]);
        near(found.square, sums[1]);
        near(found.displacement, sums[2]);
        near(found.negative, sums[3]);
        assert_eq!((passes.runs.greatest(&gap), found.depth), (highest, deepest));

        let mut z = field(2.0);
        let square = passes.center(0.1, &mut r, &mut z);
        near(square, z.iter().map(|z| z * z).sum::<f64>());
        assert!((0..n).all(|k| z[k] == if member[k] { r[k] } else { 0.0 }));
        let inside = |f: &dyn Fn(usize) -> f64| (0..n).filter(|&k| member[k]).map(f).sum::<f64>();
        let z = field(2.2);
        let sums = passes.overlaps(&z, &kd, &d);
        near(sums[0], inside(&|k| z[k]));
        near(sums[1], inside(&|k| z[k] * kd[k]));
        near(sums[2], inside(&|k| kd[k]));
        near(sums[3], inside(&|k| d[k]));
        let [slope, curvature] = passes.slope_and_curvature(&r, &d, &kd);
        near(slope, inside(&|k| r[k] * d[k]));
        near(curvature, inside(&|k| d[k] * kd[k]));
        let mut turned = d.clone();
        passes.redirect([2.0, 0.5, 0.1], &z, &mut turned);
        assert!((0..n).all(|k| turned[k] == if member[k] { 2.0 * (z[k] + 0.5 * d[k] + 0.1) } else { 0.0 }));
    }
}
