//! Intervals from the profile of the sum of squares.

use viscocontact::numeric::root;

use crate::error::{Result, unknown, within};
use crate::fit::Fit;
use crate::parameters::Parameter;
use crate::statistics::student;

/// Widest interval that is searched, in standard deviations.
const WIDEST: f64 = 30.0;
/// Where no fit is found, the sum of squares is above the least one by so many times the distance of the threshold.
const NO_FIT: f64 = 100.0;
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
        within("confidence", confidence, confidence > 0.0 && confidence < 1.0, "> 0 and < 1")?;
        let index = self.problem.parameters.iter().position(|of| of.is_free && of.name == name);
        let index = index.ok_or_else(|| unknown(name, self.estimates.iter().map(|own| &own.name)))?;
        let threshold = (self.sigma * student(confidence, self.freedom.max(1.0))).powi(2);
        let ends = [-1.0, 1.0].map(|side| self.profile_end(index, side, threshold, ENOUGH).0);
        self.goes_on().map(|()| ends)
    }

    /// To one side of a parameter, where the best fit of the others is above the least sum of squares by a threshold: the parameter, infinite if it is
    /// nowhere within 30 standard deviations, and the values of all.
    pub(super) fn profile_end(&self, index: usize, side: f64, threshold: f64, accuracy: f64) -> (f64, Vec<f64>) {
        let mut problem = self.problem.clone();
        let Parameter { scale, unit, ref name, .. } = self.problem.parameters[index];
        // at a limit, a factor of e
        let deviation = self.estimate(name).map_or(unit, |own| own.deviation.min(unit));
        problem.parameters[index].is_free = false;
        let (centre, mut values) = (scale.forward(self.values[index]), self.values.clone());
        // the sum of squares above the least one, at a distance in standard deviations
        let mut rise = |distance: f64| -> f64 {
            values[index] = scale.back(centre + side * distance * deviation);
            problem.parameters[index].given = Some(values[index]);
            match self.identification.minimum(&problem, problem.coordinates(&values)) {
                Ok(minimum) => {
                    values = problem.values(&minimum.coordinates);
                    minimum.sum() - self.found.minimum.sum()
                }
                Err(_) => NO_FIT * threshold,
            }
        };
        let (mut low, mut high) = (0.0, 1.0);
        while high < WIDEST && rise(high) < threshold {
            (low, high) = (high, 1.7 * high);
        }
        // nearly a parabola
        let found = root([low, high], high, accuracy, |distance| {
            let rise = rise(distance);
            [rise - threshold, 2.0 * rise / distance]
        });
        let end = if found < WIDEST { found * deviation } else { f64::INFINITY };
        (scale.back(centre + side * end), values)
    }
}
