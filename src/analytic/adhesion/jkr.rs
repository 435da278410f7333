use std::f64::consts::PI;

use super::Bodies;
use crate::error::Result;

/// A sphere that sticks to an elastic half-space by an attraction of vanishing range (Johnson, Kendall & Roberts,
/// Proc. R. Soc. A 324, 1971):
///
/// W = 4E*a³/3R − √(8π w E* a³), ω = a²/R − √(2π w a/E*).
///
/// ```
/// use viscocontact::analytic::Jkr;
///
/// let gel = Jkr::new(1.0e-3, 1.0e5, 0.05)?;
/// let [force, approach] = gel.state(gel.radius_at_pull_off());
/// assert!((force / gel.pull_off_force() - 1.0).abs() < 1e-12 && approach < 0.0);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jkr(pub(super) Bodies);

impl Jkr {
    /// A sphere of `radius` R \[m\] on a body of contact `modulus` E* \[Pa\] with the `work` of separation w \[J/m²\].
    ///
    /// # Errors
    /// If one of them is not finite and positive.
    pub fn new(radius: f64, modulus: f64, work: f64) -> Result<Jkr> {
        Bodies::new("radius", radius, modulus, work).map(Jkr)
    }

    /// Force W \[N\] and approach ω \[m\] at the contact radius a \[m\].
    pub fn state(&self, contact_radius: f64) -> [f64; 2] {
        let (Bodies { length, modulus, work }, a) = (self.0, contact_radius);
        let force = 4.0 * modulus * a.powi(3) / (3.0 * length) - (8.0 * PI * work * modulus * a.powi(3)).sqrt();
        [force, a * a / length - (2.0 * PI * work * a / modulus).sqrt()]
    }

    /// The minimum force, −(3/2)π w R: a greater pull separates the bodies \[N\].
    pub fn pull_off_force(&self) -> f64 {
        -1.5 * PI * self.0.work * self.0.length
    }

    /// The contact radius at the minimum force \[m\].
    pub fn radius_at_pull_off(&self) -> f64 {
        let Bodies { length, modulus, work } = self.0;
        (1.125 * PI * work * length * length / modulus).cbrt()
    }

    /// The contact radius at the minimum approach, where the force is −(5/6)π w R: a contact of given approach
    /// separates there \[m\].
    pub fn radius_at_min_approach(&self) -> f64 {
        self.radius_at_pull_off() / 9f64.cbrt()
    }
}
