use std::f64::consts::PI;

use super::Bodies;
use crate::error::{Result, finite, positive};
use crate::numeric::golden_section;
use crate::quadrature::bisect;

/// A sphere that sticks to an elastic half-space by Dugdale's attraction, a constant traction σ₀ up to the gap w/σ₀
/// (Maugis, J. Colloid Interface Sci. 150, 1992): between [`Dmt`](crate::analytic::Dmt) for λ → 0 and
/// [`Jkr`](crate::analytic::Jkr) for λ → ∞, with λ = 2σ₀ (R/(π w K²))^⅓ and K = 4E*/3.
///
/// ```
/// use viscocontact::analytic::MaugisDugdale;
///
/// let sphere = MaugisDugdale::new(1.0e-3, 1.0e5, 0.05, 1.0e4)?;
/// let [force, approach] = sphere.state(0.2e-3);
/// assert!(force > sphere.pull_off()[0] && approach.is_finite());
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaugisDugdale {
    bodies: Bodies,
    parameter: f64,
}

impl MaugisDugdale {
    /// A sphere of `radius` R \[m\] on a body of contact `modulus` E* \[Pa\] with the `work` of separation w \[J/m²\]
    /// and the `traction` σ₀ \[Pa\].
    ///
    /// # Errors
    /// If one of them is not finite and positive.
    pub fn new(radius: f64, modulus: f64, work: f64, traction: f64) -> Result<MaugisDugdale> {
        let bodies = Bodies::new("radius", radius, modulus, work)?;
        positive("traction", traction)?;
        let stiffness = 4.0 / 3.0 * modulus;
        let parameter = 2.0 * traction * (radius / (PI * work * stiffness * stiffness)).cbrt();
        Ok(MaugisDugdale { bodies, parameter: finite("Maugis' parameter", parameter)? })
    }

    /// Maugis' parameter λ.
    pub fn parameter(&self) -> f64 {
        self.parameter
    }

    /// The units of contact radius \[m\], force \[N\] and approach \[m\].
    fn units(&self) -> [f64; 3] {
        let Bodies { length, modulus, work } = self.bodies;
        let (stiffness, unit) = (4.0 / 3.0 * modulus, PI * work * length);
        let radius = (unit * length / stiffness).cbrt();
        [radius, unit, radius * radius / length]
    }

    /// Force W \[N\] and approach ω \[m\] at the contact radius a ≥ 0 \[m\].
    pub fn state(&self, contact_radius: f64) -> [f64; 2] {
        let [unit, force, approach] = self.units();
        let found = self.reduced(contact_radius / unit);
        [force * found[0], approach * found[1]]
    }

    /// The minimum force \[N\], and the contact radius there \[m\].
    pub fn pull_off(&self) -> [f64; 2] {
        let [unit, force, _] = self.units();
        // the force has one minimum in the radius, or its least value at radius zero
        let radius = golden_section(0.0, 3.0, 90, |radius| self.reduced(radius)[0]);
        [force * self.reduced(radius)[0], unit * radius]
    }

    /// Force and approach in their units at a contact radius in its unit.
    fn reduced(&self, radius: f64) -> [f64; 2] {
        let (parameter, a) = (self.parameter, radius);
        // √(m² − 1) and arcsec m of the ratio m = 1 + n of the radii of the zone and the contact
        let parts = |n: f64| ((n * (2.0 + n)).sqrt(), (1.0 / (1.0 + n)).acos());
        // the opening at the edge of the zone is w/σ₀
        let opening = |n: f64| {
            let ((root, angle), m) = (parts(n), 1.0 + n);
            0.5 * parameter * a * a * (root + (m * m - 2.0) * angle)
                + 4.0 / 3.0 * parameter * parameter * a * (root * angle - n)
        };
        if a == 0.0 {
            // a → 0 at a radius c = m a of the zone: (π/4) λ c² + (4/3) (π/2 − 1) λ² c = 1
            let (square, linear) = (0.25 * PI * parameter, 4.0 / 3.0 * (0.5 * PI - 1.0) * parameter * parameter);
            let c = 2.0 / (linear + (linear * linear + 4.0 * square).sqrt());
            return [-0.5 * PI * parameter * c * c, -4.0 / 3.0 * parameter * c];
        }
        let mut most = 1.0;
        while opening(most) < 1.0 {
            most *= 2.0;
        }
        let n = bisect(0.0, most, 200, |n| opening(n) < 1.0)[1];
        let ((root, angle), m) = (parts(n), 1.0 + n);
        [a.powi(3) - parameter * a * a * (root + m * m * angle), a * a - 4.0 / 3.0 * parameter * a * root]
    }
}
