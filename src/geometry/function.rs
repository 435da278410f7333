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
}

impl<F: Fn(f64, f64) -> f64 + Send + Sync> FnGeometry<F> {
    /// Wraps the closure. Its values are checked when a contact is built.
    pub fn new(gap: F) -> FnGeometry<F> {
        FnGeometry { gap }
    }
}

debug_by!(self: FnGeometry<F> =>);

impl<F: Fn(f64, f64) -> f64 + Send + Sync> Geometry for FnGeometry<F> {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        (self.gap)(x1, x2)
    }
}
