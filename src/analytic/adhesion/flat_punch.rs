use std::f64::consts::PI;

use super::Bodies;
use crate::error::Result;

/// A rigid flat circular punch that sticks to an elastic half-space with its whole face, by an attraction of
/// vanishing range (Kendall, J. Phys. D 4, 1971): W = 2a E* ω until it separates.
///
/// ```
/// use viscocontact::analytic::AdhesivePunch;
///
/// let probe = AdhesivePunch::new(1.0e-3, 1.0e5, 0.05)?;
/// assert!((probe.pull_off_force() - 2.0e-3 * 1.0e5 * probe.approach_at_pull_off()).abs() < 1e-12);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesivePunch(Bodies);

impl AdhesivePunch {
    /// A punch of `radius` a \[m\] on a body of contact `modulus` E* \[Pa\] with the `work` of separation w \[J/m²\].
    ///
    /// # Errors
    /// If one of them is not finite and positive.
    pub fn new(radius: f64, modulus: f64, work: f64) -> Result<AdhesivePunch> {
        Bodies::new("punch radius", radius, modulus, work).map(AdhesivePunch)
    }

    /// The minimum force, −√(8π w E* a³) \[N\].
    pub fn pull_off_force(&self) -> f64 {
        let Bodies { length, modulus, work } = self.0;
        -(8.0 * PI * work * modulus * length.powi(3)).sqrt()
    }

    /// The approach at the minimum force, −√(2π w a/E*) \[m\].
    pub fn approach_at_pull_off(&self) -> f64 {
        let Bodies { length, modulus, work } = self.0;
        -(2.0 * PI * work * length / modulus).sqrt()
    }
}
