use crate::contact::Settings;
use crate::error::{Result, within};
use crate::study::course::COURSE;

/// The accuracy of a result: its error relative to the maximum value of the run. It gives the tolerances of a
/// [`Study`](crate::study::Study).
///
/// ```
/// use viscocontact::study::Accuracy;
///
/// assert_eq!(Accuracy::STANDARD.target(), 1e-3);
/// let custom = Accuracy::new(3e-4)?;
/// assert!(custom.settings().tolerance() < Accuracy::STANDARD.settings().tolerance());
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "f64", into = "f64"))]
pub struct Accuracy {
    target: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<f64> for Accuracy {
    type Error = crate::Error;

    fn try_from(target: f64) -> Result<Accuracy> {
        Accuracy::new(target)
    }
}

#[cfg(feature = "serde")]
impl From<Accuracy> for f64 {
    fn from(accuracy: Accuracy) -> f64 {
        accuracy.target
    }
}

impl Default for Accuracy {
    fn default() -> Accuracy {
        Accuracy::STANDARD
    }
}

impl Accuracy {
    /// 1e-2: for a first look.
    pub const COARSE: Accuracy = Accuracy { target: 1e-2 };
    /// 1e-3: for design. The default.
    pub const STANDARD: Accuracy = Accuracy { target: 1e-3 };
    /// 1e-4: for reference solutions.
    pub const FINE: Accuracy = Accuracy { target: 1e-4 };

    /// Any target in \[1e-6, 0.1\].
    ///
    /// # Errors
    /// If the target is outside this range.
    pub fn new(target: f64) -> Result<Accuracy> {
        within("accuracy", target, (1e-6..=0.1).contains(&target), "in [1e-6, 0.1]")?;
        Ok(Accuracy { target })
    }

    /// The target, a relative error.
    pub fn target(&self) -> f64 {
        self.target
    }

    /// Settings with the tolerances of this accuracy; the other settings are default.
    pub fn settings(&self) -> Settings {
        let tolerance = (COURSE.of_solver * self.target).clamp(1e-12, 1e-3);
        let series_tolerance = (COURSE.of_series * self.target).clamp(1e-7, 1e-2);
        Settings { tolerance, series_tolerance, ..Settings::default() }
    }
}
