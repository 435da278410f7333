//! One curve of a least-squares problem.

use crate::experiment::Curve;
use crate::forward::Tip;
use crate::noise::{Noise, Whitening};
use crate::parameters::Property;
use crate::protocol::Protocol;
use crate::statistics::means;

/// One curve of a problem.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// Experiment and measured forces: zeros where none are measured yet.
    pub(crate) curve: Curve,
    pub(crate) whitening: Whitening,
    /// Weight of the residuals made white.
    pub(crate) scale: f64,
    /// Weight of means of samples, whose noise is less.
    weight: f64,
    /// A further weight of each: below 1 for outliers.
    pub(crate) outliers: Vec<f64>,
    pub(crate) tip: Tip,
    /// Speed of the drive at each sample \[m/s\].
    speed: Vec<f64>,
}

impl Part {
    pub(crate) fn new(index: usize, curve: Curve, noise: Noise) -> Part {
        let Protocol { times, drive } = &curve.experiment.protocol;
        let last = times.len() - 1;
        let speed = |k: usize| {
            let [a, b] = [k.saturating_sub(1), (k + 1).min(last)];
            (drive[b] - drive[a]) / (times[b] - times[a])
        };
        let (speed, outliers) = ((0..=last).map(speed).collect(), vec![1.0; times.len()]);
        let tip = Tip::new(index, &curve.experiment.tip, curve.experiment.surface);
        let phi = if let Noise::AutoregressiveWith(phi) = noise { phi } else { 0.0 };
        let whitening = Whitening { phi, memory: 0.0 };
        Part { curve, whitening, scale: 1.0, weight: 1.0, outliers, tip, speed }
    }

    /// At most so many means of neighbouring samples, as if their noise were white.
    pub(crate) fn thinned(&self, most: usize) -> Part {
        let count = self.len().min(most);
        let [outliers, speed] = [&self.outliers, &self.speed].map(|values| means(values, count));
        let weight = self.weight * (self.len() as f64 / count as f64).sqrt();
        let (curve, whitening) = (self.curve.means(count), Whitening::default());
        Part { curve, whitening, weight, outliers, speed, ..self.clone() }
    }

    pub(crate) fn len(&self) -> usize {
        self.speed.len()
    }

    /// Makes a column of the data white, with its weights.
    pub(crate) fn whiten(&self, column: &mut [f64]) {
        self.whitening.apply(column);
        column.iter_mut().zip(&self.outliers).for_each(|(value, own)| *value *= self.scale * self.weight * own);
    }

    /// −ln of the determinant of the covariance, up to the factor σ².
    pub(crate) fn log_weight(&self) -> f64 {
        self.whitening.log_weight() + 2.0 * self.len() as f64 * (self.scale * self.weight).ln()
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
