//! The displacement under a steady pressure that moves, in the frame of the pressure.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::coefficients::{RowOfCells, Rules};
use crate::fft::RealPlane;
use crate::kernel::{fast_length, waves_at};

/// A reach beyond so many cells gives nothing.
const LONGEST: f64 = 1e200;

/// A linear map of the pressure \[Pa\] to the displacement \[m\] of the bodies that it moves over, and an approximate
/// inverse.
///
/// A point x in the frame of the pressure was at x + v s a time s before. On bodies that are periodic along both axes
/// a wave q of the pressure therefore displaces by
///
/// u(q) = K(q) C(q·v) p(q), C(ω) = C(0) + Σ C_k/(1 − iω λ_k):
///
/// the conjugate of the complex compliance at the frequency at which the wave passes a point. Other bodies have
/// influence coefficients in place of waves. The real part of C is positive, so that the map is strictly monotone,
/// and a contact has one steady state.
#[derive(Debug, Clone)]
pub(super) struct MovingBodies {
    response: Multiplier,
    inverse: Multiplier,
    /// The symmetric part of −∂u/∂x of each wave along either axis, by which bodies resist.
    loss: [Vec<f64>; 2],
    /// Pairs of a forward and an inverse transform so far.
    pub(super) transforms: usize,
}

/// Influence coefficients of bodies along a motion, in each row aside of it.
#[derive(Debug, Clone)]
pub(super) struct Coefficients {
    /// u under a unit pressure on a cell, at the distances −(n − 1) to n − 1.
    pub(super) response: Vec<Vec<f64>>,
    /// The symmetric part of −∂u/∂x, which resists, at the distances 0 to n − 1. The other part is larger by many
    /// orders of magnitude where the motion is slow.
    pub(super) loss: Vec<Vec<f64>>,
}

impl Coefficients {
    pub(super) fn zero(rows: usize, cells: usize) -> Coefficients {
        let of = |count: usize| vec![vec![0.0; count]; rows];
        Coefficients { response: of(2 * cells - 1), loss: of(cells) }
    }

    /// Adds the influence of a row, of compliances with their reaches l \[m\]: C K where l is 0, else C f, which
    /// resists by C S.
    pub(super) fn add(&mut self, j: usize, row: &RowOfCells, creep: &[(f64, f64)], rules: &Rules) {
        let (at_once, moving): (Vec<_>, Vec<_>) = creep.iter().partition(|(_, reach)| *reach == 0.0);
        let at_once: f64 = at_once.iter().map(|(compliance, _)| compliance).sum();
        // f is nothing at so great a speed that the tail has no end
        let reaches: Vec<f64> = moving.iter().map(|(_, reach)| reach.min(LONGEST * row.side())).collect();
        let terms = row.terms(&reaches, rules);
        for (i, elastic) in row.elastic().enumerate() {
            self.response[j][i] += at_once * elastic;
            for ((compliance, _), f) in moving.iter().zip(&terms) {
                self.response[j][i] += compliance * f[i];
            }
        }
        for ((compliance, _), (f, reach)) in moving.iter().zip(terms.iter().zip(&reaches)) {
            let losses = row.losses(*reach, f, rules);
            self.loss[j].iter_mut().zip(losses).for_each(|(own, loss)| *own += compliance * loss);
        }
    }

    /// The rows at the distances of n cells, from one row for each wave of a period of n cells aside.
    pub(super) fn of_waves_aside(&self, n: usize) -> Coefficients {
        let sum = |rows: &[Vec<f64>]| {
            let of = |j: usize| {
                let parts: Vec<f64> = (0..rows.len()).map(|k| waves_at(j, k, n) / n as f64).collect();
                let at = |i: usize| parts.iter().zip(rows).map(|(part, row)| part * row[i]).sum();
                (0..rows[0].len()).map(at).collect()
            };
            (0..n).map(of).collect()
        };
        Coefficients { response: sum(&self.response), loss: sum(&self.loss) }
    }
}

impl MovingBodies {
    /// Bodies that are periodic along both axes, of one factor for each wave, which the inverse divides by.
    pub(super) fn of_waves(cells: [usize; 2], factors: Vec<Complex64>, loss: [Vec<f64>; 2]) -> MovingBodies {
        let inverse = factors.iter().map(|&of| if of == Complex64::ZERO { of } else { of.inv() }).collect();
        let [response, inverse] = [factors, inverse].map(|factors| Multiplier::new(cells, cells, factors));
        MovingBodies { response, inverse, loss, transforms: 0 }
    }

    /// Bodies that are periodic along both axes, on half as many cells along each axis: their long waves.
    pub(super) fn coarser(&self) -> MovingBodies {
        let [n1, n2] = self.response.cells;
        let [m1, m2] = [n1 / 2, n2 / 2];
        let waves = (0..=m2 / 2).flat_map(|k2| (0..m1).map(move |k1| [k1, k2]));
        let factors = waves.map(|[k1, k2]| {
            let factor = self.response.factors[k2 * n1 + if 2 * k1 > m1 { n1 - m1 + k1 } else { k1 }];
            // a wave of alternating cells moves both ways
            if 2 * k1 == m1 || 2 * k2 == m2 { Complex64::from(factor.re) } else { factor }
        });
        MovingBodies::of_waves([m1, m2], factors.collect(), Default::default())
    }

    /// Bodies of influence coefficients that move along an axis, `backward` or not.
    ///
    /// The approximate inverse inverts the nearest circulant matrix on the grid without padding (T. F. Chan, SIAM J.
    /// Sci. Stat. Comput. 9, 1988): along each axis that ends c_k = ((n − k) a_k + k a_(k − n))/n.
    pub(super) fn of_coefficients(
        cells: [usize; 2],
        periodic: [bool; 2],
        (axis, backward): (usize, bool),
        of: &Coefficients,
    ) -> MovingBodies {
        let response = |at: [isize; 2]| {
            // towards lower indices the row is mirrored
            let along = if backward { -at[axis] } else { at[axis] };
            of.response[at[1 - axis].unsigned_abs()][(cells[axis] as isize - 1 + along) as usize]
        };
        let loss = |at: [isize; 2]| of.loss[at[1 - axis].unsigned_abs()][at[axis].unsigned_abs()];
        let periods = [0, 1].map(|axis| match cells[axis] {
            n if periodic[axis] || n == 1 => n,
            n => fast_length(2 * n - 1),
        });
        // no cells are so far apart
        let distance = |axis: usize, k: usize| match (k as isize, cells[axis]) {
            (k, n) if k < n as isize => Some(k),
            (k, n) => Some(k - periods[axis] as isize).filter(|k| k.unsigned_abs() < n),
        };
        let padded = |table: &dyn Fn([isize; 2]) -> f64| {
            let at = |[i, j]: [usize; 2]| Some(table([distance(0, i)?, distance(1, j)?]));
            Multiplier::of_values(cells, periods, &|place| at(place).unwrap_or(0.0))
        };
        let (padded_response, lost) = (padded(&response), padded(&loss).factors);
        let sign = if backward { -1.0 } else { 1.0 };
        let mut loss = [vec![0.0; lost.len()], vec![0.0; lost.len()]];
        loss[axis] = lost.iter().map(|factor| sign * factor.re).collect();
        let parts = |axis: usize, k: usize| {
            let n = cells[axis];
            let part = if periodic[axis] { 0.0 } else { k as f64 / n as f64 };
            [(k as isize, 1.0 - part), (k as isize - n as isize, part)].into_iter().filter(|(_, part)| *part > 0.0)
        };
        let mut inverse = Multiplier::of_values(cells, cells, &|[i, j]| {
            let row = |k: isize| parts(1, j).map(|(l, part)| part * response([k, l])).sum::<f64>();
            parts(0, i).map(|(k, part)| part * row(k)).sum()
        });
        inverse.factors.iter_mut().for_each(|factor| *factor = factor.inv());
        MovingBodies { response: padded_response, inverse, loss, transforms: 0 }
    }

    /// Bodies of the symmetric part of the response, over which the pressure moves both ways at once.
    pub(super) fn symmetric(&self) -> MovingBodies {
        let mut bodies = MovingBodies { transforms: 0, ..self.clone() };
        bodies.response.factors.iter_mut().for_each(|factor| factor.im = 0.0);
        bodies
    }

    /// |p|² of each wave of a pressure, together with the conjugate one, over the number of waves.
    pub(super) fn spectrum(&mut self, pressure: &[f64]) -> Vec<f64> {
        let Multiplier { plane, coefficients, cells, .. } = &mut self.response;
        plane.forward(pressure.chunks_exact(cells[1]), coefficients);
        let [n1, n2] = plane.periods();
        // the other half of the waves is conjugate to this one
        let count = |k: usize| if k < n1 || 2 * (k / n1) == n2 { 1.0 } else { 2.0 };
        let all = (n1 * n2) as f64;
        coefficients.iter().enumerate().map(|(k, p)| count(k) * p.norm_sqr() / all).collect()
    }

    /// −∬ p ∇u over the area of a cell \[N/m²\]: the force along each axis with which the bodies
    /// resist, of the `part` of each loss.
    pub(super) fn drag(&self, spectrum: &[f64], part: fn(f64) -> f64) -> [f64; 2] {
        self.loss.each_ref().map(|loss| spectrum.iter().zip(loss).map(|(own, loss)| own * part(*loss)).sum())
    }

    /// The part of the elastic energy in waves whose period over 2π is longer than the last of the
    /// times that are `measured` \[s\], or of the part of it that a wave can lose in a time, the
    /// energy times the frequency, in those where it is shorter than the first, whichever is more.
    /// Waves at rest are known if the bodies have `relaxed` by the last time.
    pub(super) fn unmeasured(
        &self,
        spectrum: &[f64],
        velocity: [f64; 2],
        spacing: [f64; 2],
        ([from, until], relaxed): ([f64; 2], bool),
    ) -> f64 {
        if (from, until) == (0.0, f64::INFINITY) {
            return 0.0;
        }
        let (n @ [n1, _], cells) = (self.response.plane.periods(), self.response.cells);
        let unit = [0, 1].map(|axis| TAU / (n[axis] as f64 * spacing[axis]));
        // the first of the waves of a body that ends stands for those between it and none
        let least = [0, 1].map(|axis| if n[axis] > cells[axis] { 0.25 } else { 0.0 });
        let rate = |axis: usize, k: f64| unit[axis] * velocity[axis] * if k == 0.0 { least[axis] } else { k };
        let (mut slow, mut fast) = ([0.0; 2], [0.0; 2]);
        for (k, (own, factor)) in spectrum.iter().zip(&self.response.factors).enumerate().skip(1) {
            let k1 = (k % n1) as f64 - if 2 * (k % n1) > n1 { n1 as f64 } else { 0.0 };
            let omega = (rate(0, k1) + rate(1, (k / n1) as f64)).abs();
            let (energy, rests) = (own * factor.re.abs(), omega == 0.0);
            slow[0] += energy;
            slow[1] += if omega * until < 1.0 && !(rests && relaxed) { energy } else { 0.0 };
            fast[0] += omega * energy;
            fast[1] += if omega * from > 1.0 { omega * energy } else { 0.0 };
        }
        [slow, fast].map(|[all, beyond]| if all > 0.0 { beyond / all } else { 0.0 }).into_iter().fold(0.0, f64::max)
    }

    /// The displacement under a pressure.
    pub(super) fn displacement(&mut self, pressure: &[f64]) -> Vec<f64> {
        self.transforms += 1;
        self.response.apply(pressure)
    }

    /// The pressure under which bodies are displaced so, about.
    pub(super) fn pressure(&mut self, displacement: &[f64]) -> Vec<f64> {
        self.transforms += 1;
        self.inverse.apply(displacement)
    }

    /// The maximum displacement under a pressure of waves of 1 Pa \[m/Pa\].
    pub(super) fn greatest_compliance(&self) -> f64 {
        self.response.factors.iter().map(|factor| factor.norm()).fold(0.0, f64::max)
    }

    /// Whether the bodies have nothing but waves of the grid.
    pub(super) fn are_periodic(&self) -> bool {
        self.response.plane.periods() == self.response.cells
    }
}

/// A map of fields that multiplies each wave by a factor.
#[derive(Debug, Clone)]
struct Multiplier {
    cells: [usize; 2],
    plane: RealPlane,
    factors: Vec<Complex64>,
    coefficients: Vec<Complex64>,
}

impl Multiplier {
    /// Fields on `cells`, padded to `periods`.
    fn new(cells: [usize; 2], periods: [usize; 2], factors: Vec<Complex64>) -> Multiplier {
        let plane = RealPlane::new(periods);
        Multiplier { cells, coefficients: vec![Complex64::ZERO; plane.coefficients()], plane, factors }
    }

    /// The convolution with a plane of values.
    fn of_values(cells: [usize; 2], periods: [usize; 2], value: &dyn Fn([usize; 2]) -> f64) -> Multiplier {
        let mut of = Multiplier::new(cells, periods, Vec::new());
        let places = (0..periods[0]).flat_map(|i| (0..periods[1]).map(move |j| [i, j]));
        let plane: Vec<f64> = places.map(value).collect();
        of.plane.forward(plane.chunks_exact(periods[1]), &mut of.coefficients);
        Multiplier { factors: of.coefficients.clone(), ..of }
    }

    fn apply(&mut self, field: &[f64]) -> Vec<f64> {
        let (n2, mut out) = (self.cells[1], vec![0.0; field.len()]);
        self.plane.forward(field.chunks_exact(n2), &mut self.coefficients);
        let scale = 1.0 / self.plane.periods().iter().product::<usize>() as f64;
        self.coefficients.iter_mut().zip(&self.factors).for_each(|(own, factor)| *own *= scale * factor);
        self.plane.inverse(&mut self.coefficients, out.chunks_exact_mut(n2));
        out
    }
}
