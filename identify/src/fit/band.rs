//! The modulus of a fit, with its uncertainty, at any time.

use faer::Col;

use super::{Fit, LITTLE};
use crate::error::{Result, within};
use crate::problem::WIDTH;

/// Standard deviations to the ends from which bands are made: about those of an interval of 95 %.
const DEVIATIONS: f64 = 2.0;
/// Accuracy of the ends, in standard deviations.
const NEAR: f64 = 0.1;

impl Fit {
    /// The contact modulus E*(t) at a time after a sudden step \[Pa\], by the law of the model: NaN where the time is negative or not finite. What the
    /// data show lies between their shortest sampling interval and the length of the longest curve; at other times the law is extrapolated.
    pub fn modulus(&self, t: f64) -> f64 {
        self.modulus_of(&self.values, t)
    }

    /// The law of the model for some values of all parameters.
    fn modulus_of(&self, values: &[f64], t: f64) -> f64 {
        let model = self.model();
        model.modulus(&values[..model.parameters().len()], t).unwrap_or(f64::NAN)
    }

    /// The contact modulus at a time with its standard deviation, relative: \[Pa, 1\]. The deviation is infinite, which means that the modulus is not known,
    /// where it depends on a parameter that has run to its limit or that the data do not bound, or is too small to be a number. Other models may fit the
    /// same data, and differ beyond their times by more than the deviation.
    pub fn modulus_band(&self, t: f64) -> [f64; 2] {
        let modulus = self.modulus(t);
        if modulus.is_nan() {
            return [f64::NAN; 2];
        }
        let fall = |values: &[f64]| (self.modulus_of(values, t) / modulus).ln();
        let coordinates = self.problem.coordinates(&self.values);
        let moved = |column, width| fall(&self.problem.moved(&coordinates, column, width));
        // derivatives of ln E by the coordinates, which may all be moved either way
        let slope = |column| (moved(column, WIDTH) - moved(column, -WIDTH)) / (2.0 * WIDTH);
        let slopes = Col::from_fn(coordinates.len(), slope);
        let variance = slopes.transpose() * &self.of_coordinates * &slopes;
        let deviation = |(values, is_bound): &(Vec<f64>, bool)| match fall(values).abs() {
            change if !is_bound && change > LITTLE => f64::INFINITY,
            change => change / DEVIATIONS,
        };
        let ends = self.ends.get_or_init(|| self.ends()).iter().map(deviation);
        // of what is not a number, nothing is known
        let deviation =
            ends.fold(variance.abs().sqrt(), |most, end| if most.is_nan() || end <= most { most } else { end });
        [modulus, if deviation.is_nan() { f64::INFINITY } else { deviation }]
    }

    /// The shear modulus G(t) = E*(t) (1 − ν)/2 for a known constant Poisson's ratio \[Pa\]. One contact cannot tell ν.
    ///
    /// # Errors
    /// If the ratio is outside (−1, 0.5], or the time is negative or not finite.
    pub fn shear_modulus(&self, t: f64, poisson: f64) -> Result<f64> {
        within("Poisson's ratio", poisson, poisson > -1.0 && poisson <= 0.5, "> -1 and at most 0.5")?;
        within("time", t, t >= 0.0, "finite and >= 0")?;
        Ok(0.5 * self.modulus(t) * (1.0 - poisson))
    }

    /// Values of all parameters at the ends of the profile of each parameter of the material, and whether the data bound the side. Where derivatives tell
    /// little, as at a minimum from which a parameter has run away, these ends are far.
    fn ends(&self) -> Vec<(Vec<f64>, bool)> {
        let threshold = (DEVIATIONS * self.sigma).powi(2);
        let material = (0..self.model().parameters().len()).filter(|&k| self.problem.parameters[k].is_free);
        let sides = material.flat_map(|k| [(k, -1.0), (k, 1.0)]);
        let end = |(k, side)| {
            let (end, values) = self.profile_end(k, side, threshold, NEAR);
            (values, end > 0.0 && end.is_finite())
        };
        sides.map(end).collect()
    }
}
