//! Intervals from the profile of the sum of squares.

use crate::error::{Error, Result};
use crate::fit::Fit;
use crate::least_squares::square;
use crate::statistics::fisher;

/// Widest interval that is searched, in standard deviations.
const WIDEST: f64 = 30.0;
/// Accuracy of a limit, in standard deviations.
const ENOUGH: f64 = 1e-3;

impl Fit {
    /// Profile interval of a parameter: all values for which the best fit of the other parameters is not significantly worse. It holds
    /// where the sum of squares is no parabola. A side without a limit within 30 standard deviations is infinite, or zero for a
    /// quantity that is positive.
    ///
    /// # Errors
    /// If the parameter was not fitted, or `confidence` is outside (0, 1).
    pub fn profile_interval(&self, name: &str, confidence: f64) -> Result<[f64; 2]> {
        crate::error::within("confidence", confidence, confidence > 0.0 && confidence < 1.0, "> 0 and < 1")?;
        let at = self.estimates().iter().position(|estimate| estimate.name == name);
        let unknown = || Error::UnknownParameter {
            name: name.to_string(),
            names: self.estimates().iter().map(|e| e.name.clone()).collect::<Vec<_>>().join(", "),
        };
        let at = at.ok_or_else(unknown)?;
        let mut problem = self.problem()?;
        let best = self.estimates().len();
        let points = problem.len();
        let freedom = if self.identification.sigma().is_some() { 1e6 } else { (points - best) as f64 };
        let threshold = self.sum + self.sigma * self.sigma * fisher(confidence, freedom);
        let index = problem.parameters.iter().enumerate().filter(|(_, p)| p.is_free).nth(at).map(|(index, _)| index);
        let index = index.ok_or_else(unknown)?;
        let parameter = problem.parameters[index].clone();
        // at a limit, a factor of e
        let deviation = self.estimates[at].deviation.min(parameter.unit);
        problem.parameters[index].is_free = false;
        let centre = parameter.scale.forward(self.values[index]);
        let mut limits = [0.0; 2];
        for (limit, side) in limits.iter_mut().zip([-1.0, 1.0]) {
            let mut values = self.values.clone();
            // excess of the sum of squares over the threshold, at a distance in standard deviations
            let mut excess = |distance: f64| -> f64 {
                values[index] = parameter.scale.back(centre + side * distance * deviation);
                problem.parameters[index].given = Some(values[index]);
                match self.identification.minimum(&problem, problem.coordinates(&values)) {
                    Ok(minimum) => {
                        values = problem.values(&minimum.coordinates);
                        square(&minimum.residuals) - threshold
                    }
                    Err(_) => f64::INFINITY,
                }
            };
            let (mut low, mut high) = (0.0, 1.0);
            let mut at_high = excess(high);
            let mut at_low = self.sum - threshold;
            while at_high < 0.0 && high < WIDEST {
                (low, at_low) = (high, at_high);
                high *= 1.7;
                at_high = excess(high);
            }
            if at_high < 0.0 {
                *limit = parameter.scale.back(side * f64::INFINITY);
                continue;
            }
            for _ in 0..60 {
                if high - low < ENOUGH {
                    break;
                }
                let secant = if at_high.is_finite() {
                    low - at_low * (high - low) / (at_high - at_low)
                } else {
                    0.5 * (low + high)
                };
                let middle = secant.clamp(low + 0.1 * (high - low), high - 0.1 * (high - low));
                let value = excess(middle);
                if value < 0.0 {
                    (low, at_low) = (middle, value);
                } else {
                    (high, at_high) = (middle, value);
                }
            }
            *limit = parameter.scale.back(centre + side * 0.5 * (low + high) * deviation);
        }
        Ok(limits)
    }
}
