//! The displacement under a steady pressure that moves, in the frame of the pressure.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::coefficients::{Row, Rules};
use crate::Grid;
use crate::fft::RealPlane;
use crate::kernel::{InfluenceKernel, fast_length};
use crate::rheology::CreepSpectrum;

/// A linear map of the pressure \[Pa\] to the displacement \[m\] of the bodies that it moves over, and an approximate inverse.
///
/// A point x in the frame of the pressure was at x + v s a time s before. On bodies that are periodic along both axes a wave q of the pressure
/// therefore displaces by
///
/// u(q) = K(q) C(q·v) p(q), C(ω) = C(0) + Σ C_k/(1 − iω λ_k):
///
/// the conjugate of the complex compliance at the frequency at which the wave passes a point. On a half-space each term has influence
/// coefficients of its own, in place of waves. The real part of C is positive, so that the map is strictly monotone, and a contact has one
/// steady state.
#[derive(Debug)]
pub(super) struct MovingBodies {
    pub(super) response: Multiplier,
    pub(super) inverse: Multiplier,
    drag: Drag,
}

/// How the force with which bodies resist is found.
#[derive(Debug)]
enum Drag {
    /// From each wave, with its wave numbers \[1/m\].
    OfWaves(Vec<[f64; 2]>),
    /// Σ p L p along a direction, L = Σ C_k (K − f_k)/l_k.
    OfLoss(Box<Multiplier>, [f64; 2]),
}

impl MovingBodies {
    /// Bodies that are periodic along both axes, under a pressure with this `velocity` \[m/s\].
    pub(super) fn periodic(kernel: &InfluenceKernel, creep: &CreepSpectrum, velocity: [f64; 2]) -> MovingBodies {
        let grid = kernel.grid();
        let cells @ [n1, n2] = grid.cells();
        let waves = waves(grid);
        let factor = |(k, &q): (usize, &[f64; 2])| {
            let k = [(k % n1).min(n1 - k % n1), k / n1];
            // a wave of alternating cells is its own mirror image: it moves both ways
            let signs = [0, 1].map(|axis| if 2 * k[axis] == cells[axis] { &[1.0, -1.0][..] } else { &[1.0] });
            let both = signs[0].iter().flat_map(|s1| signs[1].iter().map(move |s2| [s1 * q[0], s2 * q[1]]));
            let count = (signs[0].len() * signs[1].len()) as f64;
            let passes = both.map(|q| moving_compliance(creep, q[0] * velocity[0] + q[1] * velocity[1]));
            kernel.of_wave(k) / count * passes.sum::<Complex64>()
        };
        let factors: Vec<Complex64> = waves.iter().enumerate().map(factor).collect();
        let inverse = factors.iter().map(|&of| if of == Complex64::ZERO { of } else { of.inv() }).collect();
        let of = |factors| Multiplier::new(cells, [n1, n2], factors);
        MovingBodies { response: of(factors), inverse: of(inverse), drag: Drag::OfWaves(waves) }
    }

    /// A half-space loaded on the grid or in plane strain, with the influence K at a distance from a cell, under a pressure that moves along an axis
    /// with this `velocity` \[m/s\].
    ///
    /// The approximate inverse inverts the nearest circulant matrix on the grid without padding (T. F. Chan, SIAM J. Sci. Stat. Comput.
    /// 9, 1988).
    pub(super) fn half_space(
        grid: &Grid,
        influence: &dyn Fn([f64; 2]) -> f64,
        creep: &CreepSpectrum,
        axis: usize,
        velocity: f64,
    ) -> MovingBodies {
        let (cells, spacing, rules) = (grid.cells(), grid.spacing(), Rules::new());
        let [n, d, side] = [cells[axis] as f64, spacing[axis], spacing[1 - axis]];
        let n = n as usize;
        let at_rest = velocity == 0.0;
        // f is K at rest, and nothing at so great a speed that the tail has no end
        let reaches: Vec<f64> =
            creep.terms().iter().map(|&(_, time)| (velocity.abs() * time).min(LONGEST * d)).collect();
        let mut response = Vec::new();
        let mut loss = Vec::new();
        for j in 0..cells[1 - axis] {
            let aside = j as f64 * side;
            let own = |x: f64| influence(if axis == 0 { [x, aside] } else { [aside, x] });
            let elastic: Vec<f64> = (0..n).map(|i| own(i as f64 * d)).collect();
            let elastic = |i: usize| elastic[i.abs_diff(n - 1)];
            let row = Row { influence: &own, half: 0.5 * d, aside: (aside - 0.5 * side).max(0.0) };
            let terms = if at_rest { Vec::new() } else { row.terms(n, d, &reaches, &rules) };
            let sum = |weight: &dyn Fn(usize, f64, f64) -> f64, i: usize| {
                let each = creep.terms().iter().enumerate();
                each.map(|(k, (compliance, _))| {
                    compliance * weight(k, terms.get(k).map_or(elastic(i), |f| f[i]), elastic(i))
                })
                .sum::<f64>()
            };
            response
                .push((0..2 * n - 1).map(|i| creep.glassy() * elastic(i) + sum(&|_, f, _| f, i)).collect::<Vec<_>>());
            let lost = |k: usize, f: f64, elastic: f64| if at_rest { 0.0 } else { (elastic - f) / reaches[k] };
            loss.push((0..2 * n - 1).map(|i| sum(&lost, i)).collect::<Vec<_>>());
        }
        let table = |rows: &[Vec<f64>], at: [isize; 2]| {
            // towards lower indices the row is mirrored
            let along = if velocity < 0.0 { -at[axis] } else { at[axis] };
            rows[at[1 - axis].unsigned_abs()][(n as isize - 1 + along) as usize]
        };
        let mut direction = [0.0; 2];
        direction[axis] = velocity.signum();
        MovingBodies {
            response: Multiplier::of_coefficients(cells, &|at| table(&response, at)),
            inverse: Multiplier::of_circulant(cells, &|at| table(&response, at)),
            drag: Drag::OfLoss(Box::new(Multiplier::of_coefficients(cells, &|at| table(&loss, at))), direction),
        }
    }

    /// Bodies with the symmetric part of the response: the pressure moves both ways at once.
    pub(super) fn symmetric(&self) -> MovingBodies {
        let Multiplier { cells, ref plane, ref factors, .. } = self.response;
        let real = factors.iter().map(|factor| Complex64::from(factor.re)).collect();
        let none = Multiplier::new(cells, [1, 1], vec![Complex64::ZERO]);
        MovingBodies {
            response: Multiplier::new(cells, plane.periods(), real),
            inverse: Multiplier { pairs: 0, ..self.inverse.clone() },
            drag: Drag::OfLoss(Box::new(none), [0.0; 2]),
        }
    }

    /// −∬ p ∇u over the area of a cell \[N/m²\]: the force along each axis with which the bodies resist.
    pub(super) fn drag(&mut self, pressure: &[f64]) -> [f64; 2] {
        match &mut self.drag {
            Drag::OfWaves(waves) => {
                let Multiplier { plane, factors, coefficients, cells: [n1, n2], .. } = &mut self.response;
                plane.forward(pressure.chunks_exact(*n2), coefficients);
                let mut drag = [0.0; 2];
                for (k, (p, response)) in coefficients.iter().zip(&*factors).enumerate() {
                    let k2 = k / *n1;
                    // the other half of the waves is conjugate to this one
                    let count = if k2 == 0 || 2 * k2 == *n2 { 1.0 } else { 2.0 };
                    (0..2).for_each(|axis| drag[axis] += count * waves[k][axis] * p.norm_sqr() * response.im);
                }
                drag.map(|sum| sum / (*n1 * *n2) as f64)
            }
            Drag::OfLoss(loss, direction) => {
                let mut lost = vec![0.0; pressure.len()];
                loss.apply(pressure, &mut lost);
                let sum: f64 = lost.iter().zip(pressure).map(|(lost, p)| lost * p).sum();
                direction.map(|along| along * sum)
            }
        }
    }

    /// Pairs of transforms so far.
    pub(super) fn transforms(&self) -> usize {
        self.response.pairs + self.inverse.pairs
    }
}

/// A reach beyond so many cells gives nothing.
const LONGEST: f64 = 1e200;

/// The wave numbers of a grid along each axis \[1/m\], in the order of a [`RealPlane`].
fn waves(grid: &Grid) -> Vec<[f64; 2]> {
    let ([n1, n2], [length1, length2]) = (grid.cells(), grid.lengths());
    let number = |k1: usize| if 2 * k1 > n1 { k1 as f64 - n1 as f64 } else { k1 as f64 };
    let of = |k2: usize| (0..n1).map(move |k1| [TAU * number(k1) / length1, TAU * k2 as f64 / length2]);
    (0..=n2 / 2).flat_map(of).collect()
}

/// A map of fields that multiplies each wave by a factor.
#[derive(Debug, Clone)]
pub(super) struct Multiplier {
    cells: [usize; 2],
    plane: RealPlane,
    factors: Vec<Complex64>,
    coefficients: Vec<Complex64>,
    /// Pairs of a forward and an inverse transform so far.
    pub(super) pairs: usize,
}

impl Multiplier {
    /// Fields on `cells`, padded to `periods`.
    fn new(cells: [usize; 2], periods: [usize; 2], factors: Vec<Complex64>) -> Multiplier {
        let plane = RealPlane::new(periods);
        Multiplier { cells, coefficients: vec![Complex64::ZERO; plane.coefficients()], plane, factors, pairs: 0 }
    }

    /// The factors of a plane of values.
    fn of_plane(
        cells: [usize; 2],
        periods: [usize; 2],
        plane: &[f64],
        factor: impl Fn(Complex64) -> Complex64,
    ) -> Multiplier {
        let mut transform = RealPlane::new(periods);
        let mut coefficients = vec![Complex64::ZERO; transform.coefficients()];
        transform.forward(plane.chunks_exact(periods[1]), &mut coefficients);
        Multiplier::new(cells, periods, coefficients.into_iter().map(factor).collect())
    }

    /// The convolution with coefficients of distances in cells.
    fn of_coefficients(cells: [usize; 2], at: &dyn Fn([isize; 2]) -> f64) -> Multiplier {
        let periods = cells.map(|n| if n == 1 { 1 } else { fast_length(2 * n - 1) });
        let mut plane = vec![0.0; periods[0] * periods[1]];
        let distances = |axis: usize| 1 - cells[axis] as isize..cells[axis] as isize;
        for i in distances(0) {
            for j in distances(1) {
                let [row, column] = [i.rem_euclid(periods[0] as isize), j.rem_euclid(periods[1] as isize)];
                plane[row as usize * periods[1] + column as usize] = at([i, j]);
            }
        }
        Multiplier::of_plane(cells, periods, &plane, |factor| factor)
    }

    /// The inverse of the nearest circulant matrix: along each axis c_k = ((n − k) a_k + k a_(k − n))/n.
    fn of_circulant(cells: [usize; 2], at: &dyn Fn([isize; 2]) -> f64) -> Multiplier {
        let parts = |axis: usize, k: usize| {
            let n = cells[axis];
            let part = k as f64 / n as f64;
            [(k as isize, 1.0 - part), (k as isize - n as isize, part)].into_iter().filter(|(_, part)| *part > 0.0)
        };
        let indices = (0..cells[0]).flat_map(|i| (0..cells[1]).map(move |j| [i, j]));
        let mean = |[i, j]: [usize; 2]| {
            let row = |k: isize| parts(1, j).map(|(l, part)| part * at([k, l])).sum::<f64>();
            parts(0, i).map(|(k, part)| part * row(k)).sum::<f64>()
        };
        let plane: Vec<f64> = indices.map(mean).collect();
        Multiplier::of_plane(cells, cells, &plane, |factor| factor.inv())
    }

    pub(super) fn apply(&mut self, field: &[f64], out: &mut [f64]) {
        let [_, n2] = self.cells;
        self.plane.forward(field.chunks_exact(n2), &mut self.coefficients);
        let scale = 1.0 / self.plane.periods().iter().product::<usize>() as f64;
        self.coefficients.iter_mut().zip(&self.factors).for_each(|(own, factor)| *own *= scale * factor);
        self.plane.inverse(&mut self.coefficients, out.chunks_exact_mut(n2));
        self.pairs += 1;
    }
}

/// Beyond this ωλ a term has only its imaginary part left, and squares overflow.
const FAST: f64 = 1e100;

/// C(0) + Σ C_k/(1 − iω λ_k) \[1/Pa\].
fn moving_compliance(creep: &CreepSpectrum, omega: f64) -> Complex64 {
    let term = |&(compliance, time): &(f64, f64)| {
        let x = omega * time;
        if x.abs() > FAST { Complex64::I * (compliance / x) } else { compliance / Complex64::new(1.0, -x) }
    };
    creep.glassy() + creep.terms().iter().map(term).sum::<Complex64>()
}
