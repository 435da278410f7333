use std::fmt;

use crate::rheology::Rheology;

/// A rheology given by a closure J(t): shear creep compliance \[1/Pa\] at t ≥ 0 \[s\].
///
/// It has no exponential series, so a contact sums its whole past at every step: the work of a run
/// grows with the square of the number of steps and the memory with the number of steps (one field
/// of 8 bytes a cell for each).
///
/// ```
/// use viscocontact::rheology::{FnRheology, Rheology};
///
/// let power_law = FnRheology::new(|t| 1.0e-9 + 1.0e-9 * t.powf(0.3));
/// assert_eq!(power_law.creep_compliance(1.0), 2.0e-9);
/// ```
pub struct FnRheology<F> {
    compliance: F,
}

impl<F: Fn(f64) -> f64 + Send + Sync> FnRheology<F> {
    /// Wraps the closure; its values are checked as they are used: they must be finite, ≥ 0 and
    /// never decrease.
    pub fn new(compliance: F) -> FnRheology<F> {
        FnRheology { compliance }
    }
}

impl<F> fmt::Debug for FnRheology<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FnRheology").finish_non_exhaustive()
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync> Rheology for FnRheology<F> {
    fn creep_compliance(&self, t: f64) -> f64 {
        (self.compliance)(t)
    }
}
