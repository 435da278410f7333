use crate::error::{Failure, UserError};
use crate::geometry::Geometry;

/// A geometry whose gap \[m\] is a closure of (x1, x2) \[m\].
///
/// ```
/// use viscocontact::geometry::{FnGeometry, Geometry};
///
/// let saddle = FnGeometry::new(|x1, x2| x1 * x1 - x2 * x2);
/// assert_eq!(saddle.initial_gap(2.0, 1.0), 3.0);
/// ```
#[derive(Clone)]
pub struct FnGeometry<F> {
    gap: F,
    failure: Failure,
}

impl FnGeometry<fn(f64, f64) -> f64> {
    /// Wraps a closure that may fail: its error comes out of the call that needed the gap, as the source of
    /// [`Error::User`](crate::Error::User).
    pub fn fallible<E: Into<Box<dyn std::error::Error + Send + Sync>>>(
        gap: impl Fn(f64, f64) -> Result<f64, E> + Send + Sync,
    ) -> FnGeometry<impl Fn(f64, f64) -> f64 + Send + Sync> {
        let failure = Failure::default();
        let caught = failure.clone();
        FnGeometry { gap: move |x1, x2| caught.or("the gap", gap(x1, x2), f64::NAN), failure }
    }
}

impl<F: Fn(f64, f64) -> f64 + Send + Sync> FnGeometry<F> {
    /// Wraps the closure. Its values are checked when a contact is built.
    pub fn new(gap: F) -> FnGeometry<F> {
        FnGeometry { gap, failure: Failure::default() }
    }
}

debug_by!(self: FnGeometry<F> =>);

impl<F: Fn(f64, f64) -> f64 + Send + Sync> Geometry for FnGeometry<F> {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        (self.gap)(x1, x2)
    }

    fn failure(&self) -> Option<UserError> {
        self.failure.take()
    }
}
