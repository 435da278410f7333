//! What presses the bodies together, and how it changes with time.
//!
//! A [`Load`] is what one step is given; a [`LoadHistory`] says it for every time, so that
//! [`ViscoelasticContact::follow`](crate::ViscoelasticContact::follow) can drive the steps.
//!
//! | history | load |
//! |---|---|
//! | [`StepLoad`] | nothing, then a constant load |
//! | [`Ramp`] | straight from one load to another, then held |
//! | [`PiecewiseLinear`] | a table of corners and jumps |
//! | [`Sinusoid`] | oscillation between two loads |
//! | [`FnHistory`] | any closure of time |

mod function;
mod piecewise_linear;
mod ramp;
mod sinusoid;
mod step;

pub use function::FnHistory;
pub use piecewise_linear::PiecewiseLinear;
pub use ramp::Ramp;
pub use sinusoid::Sinusoid;
pub use step::StepLoad;

use std::fmt::Debug;

use crate::error::{Result, non_negative};

/// What holds at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Load {
    /// A centred force: the bodies approach without tilting until the pressure carries it.
    Force {
        /// Normal force, ≥ 0 \[N\].
        normal: f64,
    },
}

impl Load {
    /// A normal force \[N\] that cannot tilt the bodies; 0 lets go.
    pub fn force(normal: f64) -> Load {
        Load::Force { normal }
    }

    /// Accepts loads that a step can be given.
    pub(crate) fn validate(&self) -> Result<()> {
        match *self {
            Load::Force { normal } => non_negative("normal force", normal).map(|_| ()),
        }
    }

    /// The load a fraction `s` of the way from `self` to `to`, which is of the same kind.
    pub(crate) fn towards(&self, to: &Load, s: f64) -> Load {
        let mix = |a: f64, b: f64| if s == 1.0 { b } else { a + s * (b - a) };
        match (*self, *to) {
            (Load::Force { normal: a }, Load::Force { normal: b }) => Load::Force { normal: mix(a, b) },
        }
    }
}

/// A load for every time.
///
/// ```
/// use viscocontact::load::{Load, LoadHistory};
///
/// /// Half a sine, then nothing.
/// #[derive(Debug)]
/// struct Knock;
///
/// impl LoadHistory for Knock {
///     fn at(&self, t: f64) -> Load {
///         Load::force(if t < 1.0 { (std::f64::consts::PI * t).sin().max(0.0) } else { 0.0 })
///     }
///     fn next_breakpoint(&self, after: f64) -> Option<f64> {
///         (after < 1.0).then_some(1.0)
///     }
/// }
/// assert_eq!(Knock.at(0.5), Load::force(1.0));
/// ```
pub trait LoadHistory: Debug + Send + Sync {
    /// The load at time `t` \[s\]; at a jump, the load after it (right-continuous).
    fn at(&self, t: f64) -> Load;

    /// The load just before time `t`: differs from [`LoadHistory::at`] only at a jump.
    fn before(&self, t: f64) -> Load {
        self.at(t)
    }

    /// The first corner or jump later than `after` \[s\]; steps end exactly on it.
    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        let _ = after;
        None
    }
}
