use std::f64::consts::PI;

use super::Bodies;
use crate::error::Result;

/// A cylinder that sticks to an elastic half-space in plane strain, by an attraction of vanishing range (Barquins, J.
/// Adhes. 26, 1988): W = πE*a²/4R − √(2π w E* a) for a unit of its length.
///
/// ```
/// use viscocontact::analytic::AdhesiveCylinder;
///
/// let roller = AdhesiveCylinder::new(1.0e-3, 1.0e5, 0.05)?;
/// let pull_off = roller.pull_off_force();
/// assert!([0.9, 1.1].iter().all(|part| roller.force(part * roller.width_at_pull_off()) > pull_off));
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesiveCylinder(Bodies);

impl AdhesiveCylinder {
    /// A cylinder of `radius` R \[m\] on a body of contact `modulus` E* \[Pa\] with the `work` of separation w
    /// \[J/m²\].
    ///
    /// # Errors
    /// If one of them is not finite and positive.
    pub fn new(radius: f64, modulus: f64, work: f64) -> Result<AdhesiveCylinder> {
        Bodies::new("radius", radius, modulus, work).map(AdhesiveCylinder)
    }

    /// The force at the half-width a \[m\] of the contact \[N/m\].
    pub fn force(&self, half_width: f64) -> f64 {
        let (Bodies { length, modulus, work }, a) = (self.0, half_width);
        0.25 * PI * modulus * a * a / length - (2.0 * PI * work * modulus * a).sqrt()
    }

    /// The half-width at the minimum force, (2w R²/πE*)^⅓ \[m\].
    pub fn width_at_pull_off(&self) -> f64 {
        let Bodies { length, modulus, work } = self.0;
        (2.0 * work * length * length / (PI * modulus)).cbrt()
    }

    /// The minimum force \[N/m\].
    pub fn pull_off_force(&self) -> f64 {
        self.force(self.width_at_pull_off())
    }
}
