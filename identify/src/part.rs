//! One curve of a least-squares problem.

use crate::error::Result;
use crate::experiment::{Curve, Experiment};
use crate::forward::Tip;
use crate::noise::{Noise, Whitening};
use crate::parameters::Property;
use crate::protocol::Protocol;
use crate::statistics::mean;

/// Samples of a curve with which a search begins.
pub(crate) const ROUGH: usize = 128;

/// One curve of a problem.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// Experiment and measured forces: zeros where none are measured yet.
    pub(crate) curve: Curve,
    pub(crate) whitening: Whitening,
    /// Weight of the residuals made white.
    pub(crate) scale: f64,
    /// A further weight of each: below 1 for outliers.
    pub(crate) outliers: Vec<f64>,
    pub(crate) tip: Tip,
    /// Speed of the drive at each sample \[m/s\].
    pub(crate) speed: Vec<f64>,
}

impl Part {
    pub(crate) fn new(index: usize, curve: Curve, noise: &Noise) -> Result<Part> {
        let whitening = Whitening::of(noise, index, curve.force.len())?;
        let Protocol { times, drive } = &curve.experiment.protocol;
        let last = times.len() - 1;
        let speed = |k: usize| {
            let [a, b] = [k.saturating_sub(1), (k + 1).min(last)];
            (drive[b] - drive[a]) / (times[b] - times[a])
        };
        let (speed, outliers) = ((0..=last).map(speed).collect(), vec![1.0; times.len()]);
        let tip = Tip::new(index, &curve.experiment.tip, curve.experiment.surface);
        Ok(Part { curve, whitening, scale: 1.0, outliers, tip, speed })
    }

    /// Means of neighbouring samples, as if their noise were white.
    pub(crate) fn thinned(&self) -> Part {
        let of = |values: &[f64]| -> Vec<f64> { values.chunks(self.len().div_ceil(ROUGH)).map(mean).collect() };
        let Protocol { times, drive } = &self.curve.experiment.protocol;
        let protocol = Protocol { times: of(times), drive: of(drive) };
        let experiment = Experiment { protocol, ..self.curve.experiment.clone() };
        let curve = Curve { experiment, force: of(&self.curve.force) };
        let (outliers, speed, whitening) = (of(&self.outliers), of(&self.speed), Whitening::Autoregressive(0.0));
        Part { curve, whitening, outliers, speed, ..self.clone() }
    }

    pub(crate) fn len(&self) -> usize {
        self.speed.len()
    }

    /// Makes a column of the data white, with its weights.
    pub(crate) fn whiten(&self, column: &mut [f64]) {
        self.whitening.apply(column);
        column.iter_mut().zip(&self.outliers).for_each(|(value, weight)| *value *= self.scale * weight);
    }

    /// −ln of the determinant of the covariance, up to the factor σ².
    pub(crate) fn log_weight(&self) -> f64 {
        self.whitening.log_weight() + 2.0 * self.len() as f64 * self.scale.ln()
    }

    /// The force at a sample over a property in which it is linear.
    pub(crate) fn force_over(&self, property: Property, sample: usize) -> f64 {
        let Protocol { times, drive } = &self.curve.experiment.protocol;
        match property {
            Property::Drift => times[sample] - times[0],
            Property::Tilt => drive[sample] - drive[0],
            Property::Drag => self.speed[sample],
            _ => 1.0,
        }
    }
}
