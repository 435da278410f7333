use crate::error::{Failure, UserError};
use crate::rheology::Rheology;

/// A rheology given by a closure J(t): shear creep compliance \[1/Pa\] at t ≥ 0 \[s\].
///
/// A contact uses it as an exponential series, fitted over the times of the scene
/// ([`Builder::times`](crate::contact::Builder::times)) within
/// [`Settings::series_tolerance`](crate::contact::Settings); the error is reported by
/// [`ViscoelasticContact::material`](crate::ViscoelasticContact::material). Memory and work per step do not grow. For a
/// compliance that no series fits, sum over the past yourself, in a loop over
/// [`ElasticContact::solve`](crate::elastic::ElasticContact::solve) on the surface that is left of it
/// ([`ElasticContact::set_surface`](crate::elastic::ElasticContact::set_surface)).
///
/// ```
/// use viscocontact::rheology::{FnRheology, Rheology};
///
/// let power_law = FnRheology::new(|t| 1.0e-9 + 1.0e-9 * t.powf(0.3));
/// assert_eq!(power_law.creep_compliance(1.0), 2.0e-9);
/// let series = power_law.series(1.0e-2..=1.0e4, 1.0e-4)?;
/// assert!(series.report().max_misfit() < 1.0e-4);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone)]
pub struct FnRheology<F> {
    compliance: F,
    failure: Failure,
}

impl FnRheology<fn(f64) -> f64> {
    /// Wraps a closure that may fail: its error comes out of the call that needed the compliance, as the source of
    /// [`Error::User`](crate::Error::User).
    pub fn fallible<E: Into<Box<dyn std::error::Error + Send + Sync>>>(
        compliance: impl Fn(f64) -> Result<f64, E> + Send + Sync,
    ) -> FnRheology<impl Fn(f64) -> f64 + Send + Sync> {
        let failure = Failure::default();
        let caught = failure.clone();
        FnRheology { compliance: move |t| caught.or("the creep function", compliance(t), f64::NAN), failure }
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync> FnRheology<F> {
    /// Wraps the closure. Its values are checked when used: they must be finite, ≥ 0 and non-decreasing.
    pub fn new(compliance: F) -> FnRheology<F> {
        FnRheology { compliance, failure: Failure::default() }
    }
}

debug_by!(self: FnRheology<F> =>);

impl<F: Fn(f64) -> f64 + Send + Sync> Rheology for FnRheology<F> {
    fn creep_compliance(&self, t: f64) -> f64 {
        (self.compliance)(t)
    }

    fn failure(&self) -> Option<UserError> {
        self.failure.take()
    }
}
