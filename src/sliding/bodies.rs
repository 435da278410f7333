//! What a motion passes over: influences of cells and waves, and how they creep.

use std::f64::consts::{FRAC_1_PI, TAU};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use num_complex::Complex64;

use super::coefficients::{RowOfCells, Rules};
use super::coverage;
use super::creep::Creep;
use super::operator::{Coefficients, MovingBodies};
use crate::error::{Error, Refusal, Result};
use crate::fft::{real_rows, wave_numbers};
use crate::kernel::InfluenceKernel;
use crate::numeric::EULER;
use crate::rounded::rounded;

/// A modulus that gains energy by a smaller part of itself is rounded.
const ROUNDING: f64 = 1e-12;
/// A free dashpot acts as a term with a reach of so many lengths of the grid.
const ENDLESS: f64 = 1e12;

/// Bodies, and what is known of them whatever the velocity.
pub(super) struct Bodies {
    pub(super) kernel: Arc<InfluenceKernel>,
    pub(super) creep: Creep,
    /// Influences along rows of a motion along either axis.
    pub(super) rows: [OnceLock<Vec<RowOfCells>>; 2],
    /// The shortest and the longest time at which the materials of the moving pressure were
    /// measured \[s\].
    pub(super) measured: [f64; 2],
    /// Whether they have relaxed by the longest.
    pub(super) relaxed: bool,
    /// The part of the relaxed compliance that is extrapolated in a counter-body that slides.
    pub(super) unmeasured_at_rest: f64,
}

debug_by!(self: Bodies => kernel: self.kernel);

impl Bodies {
    /// The bodies under a pressure with this velocity \[m/s\].
    pub(super) fn moving(&self, velocity: [f64; 2]) -> Result<MovingBodies> {
        let (periodic, cells) = (self.kernel.periodic_axes(), self.kernel.grid().cells());
        if periodic == [true; 2] {
            return self.over_period(velocity);
        }
        let axis = self.axis(velocity)?;
        let speed = velocity[axis].abs();
        let coefficients = if periodic[axis] { self.of_waves(axis, speed) } else { self.of_rows(axis, speed) };
        Ok(MovingBodies::of_coefficients(cells, periodic, (axis, velocity[axis] < 0.0), &coefficients))
    }

    /// The axis along which the motion counts.
    pub(super) fn axis(&self, velocity: [f64; 2]) -> Result<usize> {
        let (periodic, cells) = (self.kernel.periodic_axes(), self.kernel.grid().cells());
        // in plane strain a motion along the lines changes nothing
        if let Some(lines) = (0..2).find(|&axis| periodic[axis] && cells[axis] == 1) {
            return Ok(1 - lines);
        }
        coverage::OBLIQUE.refuse_if(|_| velocity[0] != 0.0 && velocity[1] != 0.0)?;
        Ok(usize::from(velocity[0] == 0.0))
    }

    /// The error of bodies whose modulus E′ + i E″ at a frequency \[rad/s\] is in the other convention, or no number.
    fn not_passive(&self, omega: f64) -> Error {
        let Complex64 { re, im } = self.creep.at(omega);
        let [re, im] = [re, im].map(|part| rounded(part / (re * re + im * im), 5));
        let what = format!(
            "at {} rad/s the complex modulus is {re} + {im} i Pa: in the convention E' + i E'' bodies have E' > 0 and \
             E'' >= 0",
            rounded(omega, 5)
        );
        let remedy = "; check signs, units and frequencies of the moduli";
        Refusal::value("sliding_not_passive", what, remedy).naming("frequency").valued(omega).into()
    }

    fn over_period(&self, velocity: [f64; 2]) -> Result<MovingBodies> {
        let cells @ [n1, _] = self.kernel.grid().cells();
        let (mut factors, mut loss) = (Vec::new(), [Vec::new(), Vec::new()]);
        for (k, q) in wave_numbers(self.kernel.grid()).into_iter().enumerate() {
            let k = [(k % n1).min(n1 - k % n1), k / n1];
            // a wave of alternating cells is its own mirror image: it moves both ways
            let signs = [0, 1].map(|axis| if 2 * k[axis] == cells[axis] { &[1.0, -1.0][..] } else { &[1.0] });
            let both = signs[0].iter().flat_map(|s1| signs[1].iter().map(move |s2| [s1 * q[0], s2 * q[1]]));
            let (mut factor, mut lost) = (Complex64::ZERO, [0.0; 2]);
            for q in both {
                let omega = q[0] * velocity[0] + q[1] * velocity[1];
                let own = self.kernel.of_wave(k) * self.creep.at(omega) / (signs[0].len() * signs[1].len()) as f64;
                let gains = own.im * omega.signum() < -ROUNDING * own.norm();
                if !(own.re > 0.0 && own.im.is_finite() && !gains || own == Complex64::ZERO) {
                    return Err(self.not_passive(omega.abs()));
                }
                factor += own;
                (0..2).for_each(|axis| lost[axis] += q[axis] * own.im);
            }
            factors.push(factor);
            (0..2).for_each(|axis| loss[axis].push(lost[axis]));
        }
        Ok(MovingBodies::of_waves(cells, factors, loss))
    }

    /// Coefficients of a motion along an axis on which bodies end.
    fn of_rows(&self, axis: usize, speed: f64) -> Coefficients {
        let (grid, rules) = (self.kernel.grid(), Rules::new());
        let [n, aside] = [grid.cells()[axis], grid.cells()[1 - axis]];
        let rows = self.rows[axis].get_or_init(|| {
            let own = self.kernel.rows_along(axis).unwrap_or_default();
            own.into_iter().map(|own| RowOfCells::new(own, n, grid.spacing()[axis], &rules)).collect()
        });
        let mut reaches = self.creep.reaches(speed);
        if self.creep.fluidity() > 0.0 {
            let reach = ENDLESS * grid.lengths()[axis];
            reaches.push((self.creep.fluidity() * reach / speed, reach));
        }
        let mut coefficients = Coefficients::zero(rows.len(), n);
        rows.iter().enumerate().for_each(|(j, row)| coefficients.add(j, row, &reaches, &rules));
        if self.kernel.periodic_axes()[1 - axis] { coefficients.of_waves_aside(aside) } else { coefficients }
    }

    /// Coefficients of a motion along a periodic axis, of bodies that end aside of it.
    fn of_waves(&self, axis: usize, speed: f64) -> Coefficients {
        let grid = self.kernel.grid();
        let [n, aside] = [grid.cells()[axis], grid.cells()[1 - axis]];
        let wave = |k: usize| TAU * k as f64 / grid.lengths()[axis];
        let waves: Vec<f64> = (0..=n / 2).map(wave).collect();
        let of = |i: usize, k: usize| {
            let at = if axis == 0 { [k, i] } else { [i, k] };
            self.kernel.of_wave(at) * self.creep.at(waves[k] * speed)
        };
        let table: Vec<Vec<Complex64>> = (0..aside).map(|i| (0..waves.len()).map(|k| of(i, k)).collect()).collect();
        // the shortest wave is its own mirror image
        let part = |i: usize, k: usize| if 2 * k == n { table[i][k].re.into() } else { table[i][k] } / n as f64;
        let along = |part: &dyn Fn(usize, usize) -> Complex64, distances: Range<usize>| {
            let rows = real_rows(aside, n, part);
            rows.chunks_exact(n).map(|row| distances.clone().map(|m| row[m % n]).collect()).collect()
        };
        // the symmetric part of −∂u/∂x: the shortest wave moves both ways, and loses by either
        let lost = |i: usize, k: usize| Complex64::from(waves[k] * table[i][k].im / n as f64);
        Coefficients { response: along(&part, 1..2 * n), loss: along(&lost, 0..n) }
    }

    /// What the approach of a body that flows exceeds the one after a way of the length of the grid by, under a force:
    /// φ F/(π v) times the logarithm of the way.
    pub(super) fn excess(&self, velocity: [f64; 2], force: f64) -> f64 {
        let speed = velocity[0].abs().max(velocity[1].abs());
        let per_force = FRAC_1_PI * (ENDLESS.ln() - EULER) * self.creep.fluidity();
        if per_force > 0.0 { per_force * force / speed } else { 0.0 }
    }
}
