//! How a solve that failed went, and what that says.

use std::fmt;

/// Residuals that stay within this factor for the second half of a solve make no progress.
const PROGRESS: f64 = 0.9;
/// Residuals that end higher than the lowest by this factor have grown.
const GROWN: f64 = 10.0;
/// A residual below this that makes no progress is what rounding leaves.
const ROUNDING: f64 = 1e-8;
/// Fewer residuals say nothing.
const FEWEST: usize = 4;

/// The history of the residual of a solve that did not converge, carried by
/// [`Error::NotConverged`](crate::Error::NotConverged). Its `Display` is the advice that fits.
///
/// ```
/// use viscocontact::prelude::*;
/// use viscocontact::Trend;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(48, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .settings(Settings { max_iterations: 5, tolerance: 1.0e-13, ..Settings::default() })
///     .build()?;
/// let Err(Error::NotConverged { convergence, .. }) = contact.step(0.0, Load::force(0.5)) else { panic!() };
/// assert_eq!(convergence.trend(), Trend::Falling);
/// assert!(convergence.to_string().contains("max_iterations"));
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Convergence {
    samples: Vec<(usize, f64)>,
    tolerance: f64,
    /// Whether the solver lowers the energy of the contact in every iteration, whatever the residual does.
    monotone: bool,
    /// Whether the solver found that rounding hides any further gain.
    stagnated: bool,
}

/// What a residual does over the iterations of a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Trend {
    /// Too few iterations were done to tell.
    TooFew,
    /// It was still falling: more iterations would have done.
    Falling,
    /// It has come down to what numbers are rounded by, and stays there: the tolerance is below what the scales of the scene
    /// allow.
    Rounding,
    /// It stays where it is, far above rounding.
    Stalled,
    /// It goes up and down, by more than a factor of ten.
    Oscillating,
    /// It grows.
    Growing,
}

impl Convergence {
    pub(crate) fn new(samples: Vec<(usize, f64)>, tolerance: f64, monotone: bool, stagnated: bool) -> Convergence {
        Convergence { samples, tolerance, monotone, stagnated }
    }

    /// Iterations done, and the residual then, in order; no more than 33, spread over the whole solve, its first and last
    /// among them. Empty where nothing was noted.
    pub fn residuals(&self) -> &[(usize, f64)] {
        &self.samples
    }

    /// The lowest residual; +∞ without any.
    pub fn lowest(&self) -> f64 {
        self.samples.iter().map(|sample| sample.1).fold(f64::INFINITY, f64::min)
    }

    /// What the residual did.
    pub fn trend(&self) -> Trend {
        if self.stagnated {
            return Trend::Rounding;
        }
        if self.samples.len() < FEWEST {
            return Trend::TooFew;
        }
        let (before, after) = self.samples.split_at(self.samples.len() / 2);
        let lowest = |samples: &[(usize, f64)]| samples.iter().map(|sample| sample.1).fold(f64::INFINITY, f64::min);
        let (low, first) = (lowest(after), lowest(before));
        if low < PROGRESS * first {
            return Trend::Falling;
        }
        let last = after.iter().rev().take(3).map(|sample| sample.1).fold(f64::INFINITY, f64::min);
        let highest = after.iter().map(|sample| sample.1).fold(0.0, f64::max);
        if low.min(first) < ROUNDING {
            Trend::Rounding
        } else if last > GROWN * first {
            Trend::Growing
        } else if highest > GROWN * low {
            Trend::Oscillating
        } else {
            Trend::Stalled
        }
    }

    /// Iterations that would be needed in all, at the rate of the second half; `None` unless the residual falls.
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

impl fmt::Display for Convergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lowest = self.lowest();
        match (self.trend(), self.monotone) {
            (Trend::TooFew, _) => f.write_str("too few iterations to say why: raise Settings::max_iterations"),
            (Trend::Falling, _) => {
                f.write_str("the residual was still falling: raise Settings::max_iterations")?;
                match self.iterations_needed() {
                    Some(needed) => write!(f, " (about {needed} are needed at this rate)"),
                    None => Ok(()),
                }
            }
            (Trend::Rounding, _) => write!(
                f,
                "the residual stays at {lowest:.1e}, which is rounding: raise Settings::tolerance above that, or bring the scales of the scene closer together (a grid not much larger than the contact)"
            ),
            (_, true) => {
                write!(f, "the residual came no lower than {lowest:.1e} so far: raise Settings::max_iterations")
            }
            (trend, false) => {
                let course = match trend {
                    Trend::Oscillating => "goes up and down",
                    Trend::Growing => "grows",
                    _ => "does not fall",
                };
                write!(f, "the residual {course}, and came no lower than {lowest:.1e}: use Solver::ActiveSet")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(residual: impl Fn(usize) -> f64) -> Convergence {
        let samples = (0..30).map(|k| (10 * k, residual(k))).collect();
        Convergence::new(samples, 1e-12, false, false)
    }

    #[test]
    fn the_advice_fits_the_history() {
        let wave = |k: usize| if k.is_multiple_of(3) { 1.0 } else { 0.01 };
        for (convergence, trend, advice) in [
            (history(|k| 0.5_f64.powi(k as i32)), Trend::Falling, "raise Settings::max_iterations (about 399"),
            (history(|k| 1e-3_f64.powi(k.min(4) as i32)), Trend::Rounding, "raise Settings::tolerance"),
            (history(|k| 1e-3 + 0.5_f64.powi(3 * k as i32)), Trend::Stalled, "use Solver::ActiveSet"),
            (history(|k| 1e-3 * wave(k)), Trend::Oscillating, "use Solver::ActiveSet"),
            (history(|k| 1e-3 * 1.4_f64.powi(k as i32)), Trend::Growing, "grows, and came no lower than 1.0e-3"),
        ] {
            assert_eq!(convergence.trend(), trend, "{convergence}");
            assert!(convergence.to_string().contains(advice), "{convergence}");
            assert_eq!(convergence.iterations_needed().is_some(), trend == Trend::Falling);
        }
        let few = Convergence::new(vec![(0, 1.0), (1, 0.5)], 1e-6, false, false);
        assert_eq!(few.trend(), Trend::TooFew);
        let none = Convergence::new(Vec::new(), 1e-6, false, false);
        assert!(none.lowest() == f64::INFINITY && !none.to_string().is_empty());
    }
}
