use crate::contact::Settings;
use crate::error::{Result, within};
use crate::run::Stepping;

/// The accuracy of a result: approach, force and, where it is finite, peak pressure, relative to their greatest values.
/// It determines the tolerances of steps and solver and, through a [`Plan`](crate::plan::Plan), mesh and domain.
///
/// ```
/// use viscocontact::plan::Accuracy;
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

/// Shares of the target for the error in time and the error of the mesh, as measured (docs/accuracy.md).
const TIME_SHARE: f64 = 0.36;
const SPACE_SHARE: f64 = 0.8;
/// The same of a pressure field.
const FIELD_TIME_SHARE: f64 = 0.3;
const FIELD_SPACE_SHARE: f64 = 0.6;
/// Share of the target for the residual of the solver, relative to the displacement: far below the other shares.
const SOLVER_SHARE: f64 = 0.01;

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

    /// Adaptive steps for this accuracy.
    pub fn stepping(&self) -> Stepping {
        Stepping::adaptive(self.step_tolerance())
    }

    /// Tolerance of adaptive steps for this accuracy.
    pub(crate) fn step_tolerance(&self) -> f64 {
        (TIME_SHARE * self.target).clamp(1e-9, 0.1)
    }

    /// Settings with the tolerances of this accuracy; the other settings are default.
    pub fn settings(&self) -> Settings {
        let tolerance = (SOLVER_SHARE * self.target).clamp(1e-12, 1e-3);
        Settings { tolerance, series_tolerance: (0.1 * self.target).clamp(1e-7, 1e-2), ..Settings::default() }
    }

    /// Accuracy in time of pressure fields for this accuracy.
    pub(crate) fn fields(&self) -> f64 {
        (FIELD_TIME_SHARE * self.target).max(1e-5)
    }

    /// Allowed error of the mesh of pressure fields for this accuracy.
    pub(crate) fn field_space(&self) -> f64 {
        FIELD_SPACE_SHARE * self.target
    }

    /// Allowed error of the mesh for this accuracy.
    pub(crate) fn space(&self) -> f64 {
        SPACE_SHARE * self.target
    }
}
