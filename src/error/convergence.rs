//! The residual history of a solve that failed, and the remedy that it suggests.

use std::fmt;

/// A residual falls if the second half of a solve lowers it by this factor.
const PROGRESS: f64 = 0.9;
/// A residual below this that no longer falls is rounding.
const ROUNDING: f64 = 1e-8;
/// A solver that makes no progress at residuals above this is not hindered by rounding.
const STALLED: f64 = 1e-3;
/// Fewer residuals show no trend.
const FEWEST: usize = 4;

/// The residual history of a solve that did not converge, part of
/// [`StepError::NotConverged`](crate::contact::StepError::NotConverged). Its `Display` suggests a remedy.
///
/// ```
/// use viscocontact::prelude::*;
/// use viscocontact::Trend;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(48, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
///     .settings(Settings::default().with_max_iterations(5).with_tolerance(1.0e-13))
///     .build()?;
/// let Err(Error::Step(StepError::NotConverged { convergence, .. })) = contact.step(0.0, Load::force(0.5)) else { panic!() };
/// assert_eq!(convergence.trend(), Trend::Falling);
/// assert!(convergence.to_string().contains("max_iterations"));
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Convergence {
    samples: Vec<(usize, f64)>,
    tolerance: f64,
    /// Whether the solver ended because no step made progress.
    stagnated: bool,
}

/// How the residual changes over the iterations of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Trend {
    /// Too few iterations to show a trend.
    TooFew,
    /// The residual was still falling: more iterations would converge.
    Falling,
    /// The residual stagnates at rounding level: the tolerance is too small for the scales of the scene.
    Rounding,
    /// The residual stagnates, oscillates or grows far above rounding.
    Stalled,
}

impl Convergence {
    pub(crate) fn new(samples: Vec<(usize, f64)>, tolerance: f64, stagnated: bool) -> Convergence {
        Convergence { samples, tolerance, stagnated }
    }

    /// Pairs of iterations done and the residual after them, in order: at most 33, spread over the whole solve, the
    /// first and the last included. Empty if none was recorded.
    pub fn residuals(&self) -> &[(usize, f64)] {
        &self.samples
    }

    /// The lowest residual; +∞ without any.
    pub fn lowest(&self) -> f64 {
        lowest(&self.samples)
    }

    /// How the residual changed.
    pub fn trend(&self) -> Trend {
        if self.stagnated {
            return if self.lowest() > STALLED { Trend::Stalled } else { Trend::Rounding };
        }
        if self.samples.len() < FEWEST {
            return Trend::TooFew;
        }
        let (before, after) = self.samples.split_at(self.samples.len() / 2);
        let (low, first) = (lowest(after), lowest(before));
        if low < PROGRESS * first {
            return Trend::Falling;
        }
        if low.min(first) < ROUNDING { Trend::Rounding } else { Trend::Stalled }
    }

    /// The total number of iterations needed at the rate of the second half; `None` unless the residual falls.
    pub fn iterations_needed(&self) -> Option<usize> {
        if self.trend() != Trend::Falling {
            return None;
        }
        let middle = self.samples.get(self.samples.len() / 2)?;
        let last = self.samples.last()?;
        let rate = (middle.1 / last.1).ln() / (last.0 - middle.0) as f64;
        let more = (last.1 / self.tolerance).ln() / rate;
        (rate > 0.0 && (0.0..1e9).contains(&more)).then(|| last.0 + more.ceil() as usize)
    }
}

fn lowest(samples: &[(usize, f64)]) -> f64 {
    samples.iter().map(|sample| sample.1).fold(f64::INFINITY, f64::min)
}

impl fmt::Display for Convergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lowest = self.lowest();
        match self.trend() {
            Trend::TooFew => f.write_str("too few iterations to show a trend: raise Settings::max_iterations"),
            Trend::Falling => {
                f.write_str("the residual was still falling: raise Settings::max_iterations")?;
                match self.iterations_needed() {
                    Some(needed) => write!(f, " (about {needed} are needed at this rate)"),
                    None => Ok(()),
                }
            }
            Trend::Rounding => write!(
                f,
                "the residual stagnates at {lowest:.1e}, the level of rounding: raise Settings::tolerance above \
                that, or bring the scales of the scene closer together (a grid not much larger than the contact)"
            ),
            // of a body alone, not of a step
            Trend::Stalled if self.samples.is_empty() => f.write_str(
                "the body hardly determines the pressure under a rigid motion: check its influence coefficients",
            ),
            Trend::Stalled if self.stagnated => {
                write!(f, "the residual stagnates at {lowest:.1e}, far above rounding: take smaller steps")
            }
            Trend::Stalled => {
                write!(f, "the lowest residual so far is {lowest:.1e}: raise Settings::max_iterations")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(residual: impl Fn(usize) -> f64) -> Convergence {
        let samples = (0..30).map(|k| (10 * k, residual(k))).collect();
        Convergence::new(samples, 1e-12, false)
    }

    #[test]
    fn the_advice_fits_the_history() {
        let wave = |k: usize| if k.is_multiple_of(3) { 1.0 } else { 0.01 };
        for (convergence, trend, advice) in [
            (history(|k| 0.5_f64.powi(k as i32)), Trend::Falling, "raise Settings::max_iterations (about 399"),
            (history(|k| 1e-3_f64.powi(k.min(4) as i32)), Trend::Rounding, "raise Settings::tolerance"),
            (history(|k| 1e-3 + 0.5_f64.powi(3 * k as i32)), Trend::Stalled, "raise Settings::max_iterations"),
            (history(|k| 1e-3 * wave(k)), Trend::Stalled, "raise Settings::max_iterations"),
            (history(|k| 1e-3 * 1.4_f64.powi(k as i32)), Trend::Stalled, "the lowest residual so far is 1.0e-3"),
        ] {
            assert_eq!(convergence.trend(), trend, "{convergence}");
            assert!(convergence.to_string().contains(advice), "{convergence}");
            assert_eq!(convergence.iterations_needed().is_some(), trend == Trend::Falling);
        }
        let few = Convergence::new(vec![(0, 1.0), (1, 0.5)], 1e-6, false);
        assert_eq!(few.trend(), Trend::TooFew);
        for (residual, trend) in [(3e-2, Trend::Stalled), (1e-9, Trend::Rounding)] {
            let stagnated = Convergence::new(vec![(0, 1.0), (80, residual)], 1e-10, true);
            assert_eq!(stagnated.trend(), trend);
            assert_eq!(stagnated.to_string().contains("smaller steps"), trend == Trend::Stalled, "{stagnated}");
        }
        let none = Convergence::new(Vec::new(), 1e-6, false);
        assert!(none.lowest() == f64::INFINITY && !none.to_string().is_empty());
    }
}
