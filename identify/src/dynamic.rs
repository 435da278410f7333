//! The complex modulus from a small oscillation about a hold.

use std::f64::consts::TAU;
use std::ops::Range;

use faer::{Col, Mat};
use viscocontact::num_complex::Complex;

use crate::bounds::inverse_gram;
use crate::error::{Result, positive, within};
use crate::experiment::Curve;

/// Fewest periods of an oscillation: over less, it is no more told from a drift.
const LEAST_PERIODS: f64 = 2.0;
/// Fewest points of a period.
const LEAST_PER_PERIOD: f64 = 4.0;
/// Columns of the fit of a window.
const COLUMNS: usize = 4;

/// The complex contact modulus at one frequency, see [`Curve::complex_modulus`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ComplexModulus {
    /// Frequency \[Hz\].
    pub frequency: f64,
    /// Storage contact modulus E′ \[Pa\].
    pub storage: f64,
    /// Loss contact modulus E″ \[Pa\].
    pub loss: f64,
    /// Standard error of E′ for white noise in the force \[Pa\].
    pub storage_error: f64,
    /// Standard error of E″ for white noise in the force \[Pa\].
    pub loss_error: f64,
    /// Mean depth \[m\].
    pub depth: f64,
    /// Amplitude of the depth \[m\].
    pub amplitude: f64,
    /// Stiffness of the contact of unit modulus S = dl/dδ at this depth \[m\].
    pub stiffness: f64,
    /// Standard deviation of the force from the fitted sine \[N\]: noise, drift that is not linear, and harmonics.
    pub residual: f64,
}

impl Curve {
    /// The complex modulus E*(iω) = F̂/(S δ̂) of an oscillation of the drive at `frequency` \[Hz\] in a `window` of times \[s\],
    /// about a hold at some depth; `contact_point` is the drive at which the tip touches first \[m\].
    ///
    /// Force and drive are fitted in the window by sine, cosine, a constant and a slope; through a spring of stiffness k, δ̂ is
    /// ẑ − F̂/k. S = dl/dδ belongs to the elastic states of the tip at the mean depth, as the secant over the oscillation. The
    /// edge of the contact carries no pressure, so that its motion changes the result by the order of amplitude over depth
    /// only, as long as the contact does not shrink from period to period. The window should begin when the relaxation of
    /// the hold has slowed down to a straight line, and the oscillation itself has lasted for some periods.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact_identify::{Curve, Experiment, Protocol};
    ///
    /// // a paraboloid on an elastic body: E′ is its modulus, E″ nothing
    /// let tip = ElasticStates::sphere(10.0e-6)?;
    /// let protocol = Protocol::builder(0.0, 0.01).line(1.0e-6, 1.0).oscillate(1.0e-9, 5.0, 10, 40).build()?;
    /// let force = protocol.drive().iter().map(|&depth| 2.0e3 * tip.level_at(depth)).collect();
    /// let measured = Curve::new(Experiment::new(protocol, tip), force)?.complex_modulus(5.0, 1.0..3.0, 0.0)?;
    /// assert!((measured.storage / 2.0e3 - 1.0).abs() < 1e-6 && measured.loss.abs() < 1.0e-3);
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the frequency is not finite and positive; if the window holds fewer than two periods, or fewer than four points of each; if
    /// the mean depth is not positive, or the drive does not oscillate; [`Error::BeyondStates`](crate::Error::BeyondStates).
    pub fn complex_modulus(&self, frequency: f64, window: Range<f64>, contact_point: f64) -> Result<ComplexModulus> {
        positive("frequency", frequency)?;
        let times = self.experiment().protocol().times();
        let [from, to] = [window.start, window.end].map(|end| times.partition_point(|&time| time < end));
        let inside = from..to.max(from);
        let length = if inside.len() > 1 { times[to - 1] - times[from] } else { 0.0 };
        // a window of whole periods may end before its last sample
        let periods = frequency * length * (1.0 + 1.0 / inside.len().saturating_sub(1).max(1) as f64);
        within("periods in the window", periods, periods >= LEAST_PERIODS - 1e-6, ">= 2")?;
        let per_period = inside.len() as f64 / periods;
        within("points of a period in the window", per_period, per_period >= LEAST_PER_PERIOD, ">= 4")?;
        let times = &times[inside.clone()];
        let (force, mean_force, residual, inverse) = harmonic(times, &self.force()[inside.clone()], frequency)?;
        let (drive, mean_drive, ..) = harmonic(times, &self.experiment().protocol().drive()[inside], frequency)?;
        let spring = self.experiment.stiffness;
        let amplitude = drive - force / spring;
        let depth = positive("mean depth in the window", mean_drive - contact_point - mean_force / spring)?;
        let swing = amplitude.norm();
        let is_small = swing > 1e-9 * depth && swing < depth;
        within("amplitude of the depth", swing, is_small, "above 1e-9 of the mean depth, and below it")?;
        let level = |depth: f64| self.experiment.level_within(depth);
        let stiffness = (level(depth + swing)? - level(depth - swing)?) / (2.0 * swing);
        let modulus = force / (stiffness * amplitude);
        // dE*/dF̂ of E* = F̂/(S (ẑ − F̂/k)): an analytic function
        let slope = drive / (stiffness * amplitude * amplitude);
        let [xx, xy, yy] = [(0, 0), (0, 1), (1, 1)].map(|at| residual * residual * inverse[at]);
        let error = |[x, y]: [f64; 2]| (x * x * xx + 2.0 * x * y * xy + y * y * yy).max(0.0).sqrt();
        Ok(ComplexModulus {
            frequency,
            storage: modulus.re,
            loss: modulus.im,
            storage_error: error([slope.re, -slope.im]),
            loss_error: error([slope.im, slope.re]),
            depth,
            amplitude: swing,
            stiffness,
            residual,
        })
    }
}

/// Fits values at some times by Re(Y e^(iωt)), a constant and a slope: Y, the mean, the standard deviation of what is left, and the covariance of
/// Re Y, Im Y and the others over its square.
fn harmonic(times: &[f64], values: &[f64], frequency: f64) -> Result<(Complex<f64>, f64, f64, Mat<f64>)> {
    let (count, half) = (times.len(), 0.5 * (times[times.len() - 1] - times[0]));
    let middle = times[0] + half;
    let rows = Mat::from_fn(count, COLUMNS, |row, column| {
        let angle = TAU * frequency * times[row];
        match column {
            0 => angle.cos(),
            1 => -angle.sin(),
            2 => 1.0,
            _ => (times[row] - middle) / half,
        }
    });
    let value = Col::from_fn(count, |row| values[row]);
    let inverse = inverse_gram(&rows, 0.0)?;
    let solution = &inverse * (rows.transpose() * &value);
    let residual = (value - &rows * &solution).norm_l2() / (count.saturating_sub(COLUMNS).max(1) as f64).sqrt();
    Ok((Complex::new(solution[0], solution[1]), solution[2], residual, inverse))
}
