use std::fmt;

use crate::error::{Failure, Result, UserError, finite};

/// The position of an indenter as a function of time.
pub trait Path: fmt::Debug + Send + Sync {
    /// Position (x1, x2) \[m\] of the origin of the shape at time `t` \[s\].
    fn at(&self, t: f64) -> [f64; 2];

    /// Why the last position was none, of a path that can fail ([`FnPath::fallible`]): such a position is NaN.
    fn failure(&self) -> Option<UserError> {
        None
    }
}

macro_rules! forward_path {
    ($($pointer:ty),*) => {
        $(forward! {
            Path, (<T> self: $pointer => **self),
            at(t: f64) -> [f64; 2];
            failure() -> Option<UserError>;
        })*
    };
}
forward_path!(&T, Box<T>, std::sync::Arc<T>);

/// A straight path at constant velocity.
///
/// ```
/// use viscocontact::motion::{Path, Straight};
///
/// let path = Straight::new([1.0e-3, 0.0], [0.0, 2.0])?;
/// assert_eq!(path.at(0.5), [1.0e-3, 1.0]);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Straight {
    start: [f64; 2],
    velocity: [f64; 2],
}

impl Straight {
    /// A path from `start` \[m\] at t = 0 with `velocity` \[m/s\].
    ///
    /// # Errors
    /// If a component is not finite.
    pub fn new(start: [f64; 2], velocity: [f64; 2]) -> Result<Straight> {
        Ok(Straight {
            start: [finite("start along x1", start[0])?, finite("start along x2", start[1])?],
            velocity: [finite("velocity along x1", velocity[0])?, finite("velocity along x2", velocity[1])?],
        })
    }
}

impl Path for Straight {
    fn at(&self, t: f64) -> [f64; 2] {
        [0, 1].map(|axis| self.start[axis] + self.velocity[axis] * t)
    }
}

/// A path given by a closure of time: oscillating, circular, measured.
///
/// ```
/// use viscocontact::motion::{FnPath, Path};
///
/// let fretting = FnPath::new(|t| [1.0e-5 * (100.0 * t).sin(), 0.0]);
/// assert_eq!(fretting.at(0.0), [0.0, 0.0]);
/// ```
#[derive(Clone)]
pub struct FnPath<F> {
    at: F,
    failure: Failure,
}

impl FnPath<fn(f64) -> [f64; 2]> {
    /// Wraps a closure that may fail: its error comes out of the step that needed the position, as the source of
    /// [`Error::User`](crate::Error::User).
    pub fn fallible<E: Into<Box<dyn std::error::Error + Send + Sync>>>(
        at: impl Fn(f64) -> Result<[f64; 2], E> + Send + Sync,
    ) -> FnPath<impl Fn(f64) -> [f64; 2] + Send + Sync> {
        let failure = Failure::default();
        let caught = failure.clone();
        FnPath { at: move |t| caught.or("the path", at(t), [f64::NAN; 2]), failure }
    }
}

impl<F: Fn(f64) -> [f64; 2] + Send + Sync> FnPath<F> {
    /// Wraps the closure; each step checks its values.
    pub fn new(at: F) -> FnPath<F> {
        FnPath { at, failure: Failure::default() }
    }
}

debug_by!(self: FnPath<F> =>);

impl<F: Fn(f64) -> [f64; 2] + Send + Sync> Path for FnPath<F> {
    fn at(&self, t: f64) -> [f64; 2] {
        (self.at)(t)
    }

    fn failure(&self) -> Option<UserError> {
        self.failure.take()
    }
}
