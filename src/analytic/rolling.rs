use std::f64::consts::PI;

use crate::error::{Error, Result, finite, positive};
use crate::quadrature::{GaussLegendre, bisect};

/// A cylinder that rolls or slides steadily, without friction of its surface, on a body with one retardation time:
/// C(t) = C₀ + C₁ (1 − e^(−t/τ)), in line contact (S. C. Hunter, J. Appl. Mech. 28, 1961).
///
/// With the reach l = vτ and C∞ = C₀ + C₁, q = C∞ p − l C₀ p′ is Hertz's pressure with a tilt on the contact \[c − w,
/// c + w\]. With β = C∞/(l C₀), k = K₁(w/l)/K₀(w/l) and i = I₁(βw)/I₀(βw), modified Bessel functions,
///
/// c = l (C₁/C∞) i/(i + k), F = π/(4 R C∞) (w² + 2cwk), μ = (c + M/F)/R, M = ((l − c) πw²/4R − l C₀ F)/C∞.
///
/// The moment M is a difference of large numbers where l is much longer than the contact: of l/w digits.
///
/// ```
/// use viscocontact::analytic::RollingCylinder;
///
/// let cylinder = RollingCylinder::new(0.1, [2.0e-7, 8.0e-7], 2.0e3, 0.01)?;
/// assert!(cylinder.friction > 0.0 && cylinder.center > 0.0);
/// // slow: μ = l C₁/(C∞ R)
/// let slow = RollingCylinder::new(0.1, [2.0e-7, 8.0e-7], 2.0e3, 1.0e-6)?;
/// assert!((slow.friction / (1.0e-6 * 0.8 / 0.1) - 1.0).abs() < 1.0e-3);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RollingCylinder {
    /// Half the width of the contact w \[m\].
    pub half_width: f64,
    /// Middle of the contact ahead of the axis of the cylinder c \[m\].
    pub center: f64,
    /// Coefficient of friction μ: lateral over normal force.
    pub friction: f64,
}

/// Halvings of the interval that contains w.
const HALVINGS: usize = 80;

impl RollingCylinder {
    /// A cylinder of `radius` R \[m\] on a body with the contact compliances C₀ and C₁ \[1/Pa\], under `force` F on a
    /// unit of its length \[N/m\], with the `reach` l \[m\]: velocity times retardation time.
    ///
    /// # Errors
    /// If a number is not finite and positive, or there is no such contact in `f64`.
    pub fn new(radius: f64, [at_once, delayed]: [f64; 2], force: f64, reach: f64) -> Result<RollingCylinder> {
        positive("cylinder radius", radius)?;
        positive("compliance at once", at_once)?;
        positive("delayed compliance", delayed)?;
        positive("force", force)?;
        positive("reach", reach)?;
        let relaxed = at_once + delayed;
        let parts = |w: f64| {
            let (k, i) = (ratio_of_second_kind(w / reach), ratio_of_first_kind(relaxed * w / (reach * at_once)));
            let c = reach * delayed / relaxed * i / (i + k);
            (c, PI / (4.0 * radius * relaxed) * (w * w + 2.0 * c * w * k))
        };
        let slow = (4.0 * radius * relaxed * force / PI).sqrt();
        let [half_width, _] = bisect(0.0, slow, HALVINGS, |w| parts(w).1 < force);
        let center = parts(half_width).0;
        let moment =
            ((reach - center) * PI * half_width * half_width / (4.0 * radius) - reach * at_once * force) / relaxed;
        let friction = finite("friction of a rolling cylinder", (center + moment / force) / radius)?;
        if half_width == 0.0 {
            return Err(Error::OutOfRange { field: "half width of a contact", value: 0.0, allowed: "> 0" });
        }
        Ok(RollingCylinder { half_width, center, friction })
    }
}

/// ∫ e^(z (cos t − 1)) cos nt over 0 < t < π is π e^(−z) I_n(z): I₁/I₀.
fn ratio_of_first_kind(z: f64) -> f64 {
    // what is left of the exponential after this is rounding
    let end = if z > 20.0 { (1.0 - 37.0 / z).max(-1.0).acos() } else { PI };
    let sum = |n: f64| integral(end, |t| (-2.0 * z * (0.5 * t).sin().powi(2)).exp() * (n * t).cos());
    sum(1.0) / sum(0.0)
}

/// ∫ e^(z (1 − cosh t)) cosh nt over t > 0 is e^z K_n(z): K₁/K₀.
fn ratio_of_second_kind(z: f64) -> f64 {
    let end = (1.0 + 750.0 / z).acosh();
    let sum = |n: f64| integral(end, |t| (-2.0 * z * (0.5 * t).sinh().powi(2)).exp() * (n * t).cosh());
    sum(1.0) / sum(0.0)
}

fn integral(end: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (rule, pieces) = (GaussLegendre::new(16), 64);
    let piece = end / f64::from(pieces);
    (0..pieces).map(|k| rule.integrate(f64::from(k) * piece, f64::from(k + 1) * piece, &f)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form with 40 digits.
    #[test]
    fn friction_has_the_digits_that_do_not_cancel() {
        let (radius, c0, c1, force) = (1.0, 0.25e-6, 2.25e-6, 5.0e3);
        let half = (4.0_f64 * radius * (c0 + c1) * force / PI).sqrt();
        for (over_half, exact) in [
            (0.01, 0.00112916499941),
            (0.05, 0.0055210009519),
            (0.5, 0.0417296683762),
            (5.0, 0.0350524117689),
            (100.0, 0.00347562378807),
        ] {
            let found = RollingCylinder::new(radius, [c0, c1], force, over_half * half).unwrap().friction;
            assert!(
                (found / exact - 1.0).abs() < 1e-11 * (1.0 + over_half * over_half),
                "{over_half}: {found} {exact}"
            );
        }
    }
}
