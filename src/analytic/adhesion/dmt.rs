use std::f64::consts::PI;

use super::Bodies;
use crate::error::Result;

/// A sphere that sticks to a stiff half-space by a long-range attraction, which does not deform it (Derjaguin, Muller
/// & Toporov, J. Colloid Interface Sci. 53, 1975): W = 4E*a³/3R − 2π w R, ω = a²/R.
///
/// ```
/// use viscocontact::analytic::Dmt;
///
/// let tip = Dmt::new(20.0e-9, 1.0e11, 0.1)?;
/// assert_eq!(tip.state(0.0)[0], tip.pull_off_force());
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dmt(Bodies);

impl Dmt {
    /// A sphere of `radius` R \[m\] on a body of contact `modulus` E* \[Pa\] with the `work` of separation w \[J/m²\].
    ///
    /// # Errors
    /// If one of them is not finite and positive.
    pub fn new(radius: f64, modulus: f64, work: f64) -> Result<Dmt> {
        Bodies::new("radius", radius, modulus, work).map(Dmt)
    }

    /// Force W \[N\] and approach ω \[m\] at the contact radius a ≥ 0 \[m\]; NaN below.
    pub fn state(&self, contact_radius: f64) -> [f64; 2] {
        let (Bodies { length, modulus, .. }, a) =
            (self.0, if contact_radius < 0.0 { f64::NAN } else { contact_radius });
        [4.0 * modulus * a.powi(3) / (3.0 * length) + self.pull_off_force(), a * a / length]
    }

    /// The minimum force, −2π w R \[N\].
    pub fn pull_off_force(&self) -> f64 {
        -2.0 * PI * self.0.work * self.0.length
    }
}
