use crate::contact::{Settings, Stepping};
use crate::error::{Result, within};

/// How accurate an answer is wanted: approach, force and, where it is finite, peak pressure, relative to their greatest values.
/// It sets steps, solver and, through a [`Plan`](crate::plan::Plan), mesh and domain together.
///
/// ```
/// use viscocontact::plan::Accuracy;
///
/// assert_eq!(Accuracy::Standard.target(), 1e-3);
/// let custom = Accuracy::target_of(3e-4)?;
/// assert!(custom.settings().tolerance < Accuracy::Standard.settings().tolerance);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Accuracy {
    /// 1e-2: to look.
    Coarse,
    /// 1e-3: to design.
    #[default]
    Standard,
    /// 1e-4: to compare with.
    Fine,
    /// Any other target, in \[1e-6, 0.1\], made by [`Accuracy::target_of`]; a plan refuses others.
    Custom(f64),
}

/// Parts of the target that the error in time may take up, and that of the mesh. Measured (docs/accuracy.md).
const TIME_SHARE: f64 = 0.36;
const SPACE_SHARE: f64 = 0.8;
/// The solver's part: its residual is relative to the displacement, and it is asked for far less than the rest.
const SOLVER_SHARE: f64 = 0.01;

impl Accuracy {
    /// Any target in \[1e-6, 0.1\].
    ///
    /// # Errors
    /// If the target is outside.
    pub fn target_of(target: f64) -> Result<Accuracy> {
        within("accuracy", target, (1e-6..=0.1).contains(&target), "in [1e-6, 0.1]")?;
        Ok(Accuracy::Custom(target))
    }

    /// The relative error aimed at.
    pub fn target(&self) -> f64 {
        match *self {
            Accuracy::Coarse => 1e-2,
            Accuracy::Standard => 1e-3,
            Accuracy::Fine => 1e-4,
            Accuracy::Custom(target) => target,
        }
    }

    /// Adaptive steps that suit.
    pub fn stepping(&self) -> Stepping {
        Stepping::adaptive((TIME_SHARE * self.target()).clamp(1e-9, 0.1))
    }

    /// Settings that suit; change what else you like.
    pub fn settings(&self) -> Settings {
        let tolerance = (SOLVER_SHARE * self.target()).clamp(1e-12, 1e-3);
        Settings { tolerance, series_tolerance: (0.1 * self.target()).clamp(1e-7, 1e-2), ..Settings::default() }
    }

    /// The error of the mesh that suits.
    pub(crate) fn space(&self) -> f64 {
        SPACE_SHARE * self.target()
    }
}
