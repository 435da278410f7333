//! The displacement under a steady pressure that moves, in the frame of the pressure.

use num_complex::Complex64;

use super::coefficients::{Row, Rules};
use crate::Grid;
use crate::fft::{RealPlane, wave_numbers};
use crate::kernel::{fast_length, waves_at};

/// A reach beyond so many cells gives nothing.
const LONGEST: f64 = 1e200;

/// A linear map of the pressure \[Pa\] to the displacement \[m\] of the bodies that it moves over, and an approximate inverse.
///
/// A point x in the frame of the pressure was at x + v s a time s before. On bodies that are periodic along both axes a wave q of the pressure
/// therefore displaces by
///
/// u(q) = K(q) C(q·v) p(q), C(ω) = C(0) + Σ C_k/(1 − iω λ_k):
///
/// the conjugate of the complex compliance at the frequency at which the wave passes a point. Other bodies have influence coefficients in
/// place of waves. The real part of C is positive, so that the map is strictly monotone, and a contact has one steady state.
#[derive(Debug)]
pub(super) struct MovingBodies {
    pub(super) response: Multiplier,
    pub(super) inverse: Multiplier,
    /// The symmetric part of −∂u/∂x of each wave along either axis, by which bodies resist.
    loss: [Vec<f64>; 2],
}

/// Influence coefficients of bodies along a motion, at the distances −(n − 1) to n − 1 in each row aside of the motion.
#[derive(Debug, Clone)]
pub(super) struct Coefficients {
    /// u under a unit pressure on a cell.
    pub(super) response: Vec<Vec<f64>>,
    /// −∂u/∂x, of which the symmetric part resists.
    pub(super) loss: Vec<Vec<f64>>,
}

impl Coefficients {
    pub(super) fn zero(rows: usize, count: usize) -> Coefficients {
        let zero = vec![vec![0.0; count]; rows];
        Coefficients { response: zero.clone(), loss: zero }
    }

    /// Adds the influence of a row, of compliances with their reaches l \[m\]: C K where l is 0, else C f with ∂f/∂x = (f − K)/l.
    pub(super) fn add(&mut self, j: usize, row: &Row, creep: &[(f64, f64)], rules: &Rules) {
        let (at_once, moving): (Vec<_>, Vec<_>) = creep.iter().partition(|(_, reach)| *reach == 0.0);
        let at_once: f64 = at_once.iter().map(|(compliance, _)| compliance).sum();
        // f is nothing at so great a speed that the tail has no end
        let reaches: Vec<f64> = moving.iter().map(|(_, reach)| reach.min(LONGEST * row.side())).collect();
        let terms = row.terms(&reaches, rules);
        for (i, elastic) in row.elastic().enumerate() {
            self.response[j][i] += at_once * elastic;
            for ((compliance, _), (f, reach)) in moving.iter().zip(terms.iter().zip(&reaches)) {
                self.response[j][i] += compliance * f[i];
                self.loss[j][i] += compliance * ((elastic - f[i]) / reach);
            }
        }
    }

    /// The rows at the distances of n cells, from one row for each wave of a period of n cells aside.
    pub(super) fn of_waves_aside(&self, n: usize) -> Coefficients {
        let sum = |rows: &[Vec<f64>]| {
            let of = |j: usize| {
                let mut sum = vec![0.0; rows[0].len()];
                for (k, row) in rows.iter().enumerate() {
                    let part = waves_at(j, k, n) / n as f64;
                    sum.iter_mut().zip(row).for_each(|(sum, own)| *sum += part * own);
                }
                sum
            };
            (0..n).map(of).collect()
        };
        Coefficients { response: sum(&self.response), loss: sum(&self.loss) }
    }
}

impl MovingBodies {
    /// Bodies that are periodic along both axes, of which `displaces` returns the compliance \[m/Pa\] of a wave \[1/m\] of these absolute numbers.
    pub(super) fn periodic(grid: &Grid, displaces: &dyn Fn([usize; 2], [f64; 2]) -> Complex64) -> MovingBodies {
        let cells @ [n1, _] = grid.cells();
        let waves = wave_numbers(grid);
        let mut loss = [Vec::with_capacity(waves.len()), Vec::with_capacity(waves.len())];
        let factor = |(k, &q): (usize, &[f64; 2])| {
            let k = [(k % n1).min(n1 - k % n1), k / n1];
            // a wave of alternating cells is its own mirror image: it moves both ways
            let signs = [0, 1].map(|axis| if 2 * k[axis] == cells[axis] { &[1.0, -1.0][..] } else { &[1.0] });
            let both = signs[0].iter().flat_map(|s1| signs[1].iter().map(move |s2| [s1 * q[0], s2 * q[1]]));
            let part = 1.0 / (signs[0].len() * signs[1].len()) as f64;
            let each: Vec<_> = both.map(|q| (q, part * displaces(k, q))).collect();
            let sum = |axis: usize| each.iter().map(|(q, own)| q[axis] * own.im).sum();
            (0..2).for_each(|axis| loss[axis].push(sum(axis)));
            each.iter().map(|(_, own)| own).sum()
        };
        let factors = waves.iter().enumerate().map(factor).collect();
        MovingBodies::of_waves(cells, factors, loss)
    }

    /// Bodies of one factor for each wave, which the inverse divides by.
    pub(super) fn of_waves(cells: [usize; 2], factors: Vec<Complex64>, loss: [Vec<f64>; 2]) -> MovingBodies {
        let none = Multiplier::new(cells, cells, Vec::new());
        let mut bodies = MovingBodies { response: none.clone(), inverse: none, loss };
        bodies.set_waves(factors);
        bodies
    }

    /// Takes other factors; no transform has been counted of them.
    pub(super) fn set_waves(&mut self, factors: Vec<Complex64>) {
        let inverse = |&of: &Complex64| if of == Complex64::ZERO { of } else { of.inv() };
        (self.inverse.factors, self.inverse.pairs) = (factors.iter().map(inverse).collect(), 0);
        (self.response.factors, self.response.pairs) = (factors, 0);
    }

    /// Bodies of influence coefficients that move along an axis, `backward` or not.
    ///
    /// The approximate inverse inverts the nearest circulant matrix on the grid without padding (T. F. Chan, SIAM J. Sci. Stat. Comput.
    /// 9, 1988).
    pub(super) fn of_coefficients(
        cells: [usize; 2],
        periodic: [bool; 2],
        (axis, backward): (usize, bool),
        of: &Coefficients,
    ) -> MovingBodies {
        let table = |rows: &[Vec<f64>], at: [isize; 2]| {
            // towards lower indices the row is mirrored
            let along = if backward { -at[axis] } else { at[axis] };
            rows[at[1 - axis].unsigned_abs()][(cells[axis] as isize - 1 + along) as usize]
        };
        let response = Multiplier::of_coefficients(cells, periodic, &|at| table(&of.response, at));
        let lost = Multiplier::of_coefficients(cells, periodic, &|at| table(&of.loss, at)).factors;
        let sign = if backward { -1.0 } else { 1.0 };
        let mut loss = [vec![0.0; lost.len()], vec![0.0; lost.len()]];
        loss[axis] = lost.iter().map(|factor| sign * factor.re).collect();
        let inverse = Multiplier::of_circulant(cells, periodic, &|at| table(&of.response, at));
        MovingBodies { response, inverse, loss }
    }

    /// Bodies with this part of the skew-symmetric response; without any the pressure moves both ways at once.
    pub(super) fn with_skew(&self, part: f64) -> MovingBodies {
        let Multiplier { cells, ref plane, ref factors, .. } = self.response;
        let factors = factors.iter().map(|factor| Complex64::new(factor.re, part * factor.im)).collect();
        MovingBodies {
            response: Multiplier::new(cells, plane.periods(), factors),
            inverse: Multiplier { pairs: 0, ..self.inverse.clone() },
            loss: Default::default(),
        }
    }

    /// −∬ p ∇u over the area of a cell \[N/m²\]: the force along each axis with which the bodies resist.
    pub(super) fn drag(&mut self, pressure: &[f64]) -> [f64; 2] {
        let Multiplier { plane, coefficients, cells, .. } = &mut self.response;
        plane.forward(pressure.chunks_exact(cells[1]), coefficients);
        let [n1, n2] = plane.periods();
        // the other half of the waves is conjugate to this one
        let count = |k: usize| if k < n1 || 2 * (k / n1) == n2 { 1.0 } else { 2.0 };
        let each = coefficients.iter().enumerate().map(|(k, p)| count(k) * p.norm_sqr());
        let sum = |loss: &Vec<f64>| each.clone().zip(loss).map(|(energy, loss)| energy * loss).sum::<f64>();
        self.loss.each_ref().map(|loss| sum(loss) / (n1 * n2) as f64)
    }

    /// Pairs of transforms so far.
    pub(super) fn transforms(&self) -> usize {
        self.response.pairs + self.inverse.pairs
    }
}

/// A map of fields that multiplies each wave by a factor.
#[derive(Debug, Clone)]
pub(super) struct Multiplier {
    pub(super) cells: [usize; 2],
    pub(super) plane: RealPlane,
    pub(super) factors: Vec<Complex64>,
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
    fn of_coefficients(cells: [usize; 2], periodic: [bool; 2], at: &dyn Fn([isize; 2]) -> f64) -> Multiplier {
        let padded = |n: usize| if n == 1 { 1 } else { fast_length(2 * n - 1) };
        let periods = [0, 1].map(|axis| if periodic[axis] { cells[axis] } else { padded(cells[axis]) });
        let mut plane = vec![0.0; periods[0] * periods[1]];
        let distances = |axis: usize| if periodic[axis] { 0 } else { 1 - cells[axis] as isize }..cells[axis] as isize;
        for i in distances(0) {
            for j in distances(1) {
                let [row, column] = [i.rem_euclid(periods[0] as isize), j.rem_euclid(periods[1] as isize)];
                plane[row as usize * periods[1] + column as usize] = at([i, j]);
            }
        }
        Multiplier::of_plane(cells, periods, &plane, |factor| factor)
    }

    /// The inverse of the nearest circulant matrix: along each axis that ends c_k = ((n − k) a_k + k a_(k − n))/n.
    fn of_circulant(cells: [usize; 2], periodic: [bool; 2], at: &dyn Fn([isize; 2]) -> f64) -> Multiplier {
        let parts = |axis: usize, k: usize| {
            let n = cells[axis];
            let part = if periodic[axis] { 0.0 } else { k as f64 / n as f64 };
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
