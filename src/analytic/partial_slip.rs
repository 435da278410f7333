use std::f64::consts::PI;

use ellip::{ellipe, ellipk};

use crate::analytic::Hertz;
use crate::error::{Error, Result, positive, within};
use crate::quadrature::GaussLegendre;

/// A ball that is pressed and then sheared, with partial slip (C. Cattaneo 1938; R. D. Mindlin, J. Appl. Mech. 16,
/// 1949): it sticks within the radius c = a (1 − Q/fP)^(1/3), and moves by d = κ f δ (1 − (1 − Q/fP)^(2/3)). Exact
/// where bodies respond alike to normal and tangential loads, κ = 1; else, with κ = (2 − ν)/(2(1 − ν)), for slip that
/// is taken to be along Q everywhere.
///
/// ```
/// use viscocontact::analytic::{CattaneoMindlin, Hertz};
///
/// let hertz = Hertz::new(10.0e-3, 4.0e6, 1.0)?;
/// let ball = CattaneoMindlin::new(&hertz, 1.0, 0.5, 1.5)?;
/// assert!((ball.stick_radius(0.25) / hertz.contact_radius - 0.5_f64.cbrt()).abs() < 1e-12);
/// // to and fro: the branches of the loop are the first loading in twice its size
/// let there = ball.displacement(&[0.25]);
/// assert!((ball.displacement(&[0.25, -0.25]) + there).abs() < 1e-12 * there);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CattaneoMindlin {
    /// What friction carries, f P \[N\].
    pub limit: f64,
    /// Displacement when all of it begins to slide, κ f δ \[m\].
    pub sliding: f64,
    /// Contact radius a \[m\].
    pub radius: f64,
}

impl CattaneoMindlin {
    /// Of a ball under `force` P \[N\], with a coefficient of friction f and the `ratio` κ of tangential to normal
    /// compliance.
    ///
    /// # Errors
    /// If a number is not finite and positive.
    pub fn new(hertz: &Hertz, force: f64, friction: f64, ratio: f64) -> Result<CattaneoMindlin> {
        positive("force", force)?;
        positive("coefficient of friction", friction)?;
        positive("ratio of compliances", ratio)?;
        let (limit, sliding) = (friction * force, ratio * friction * hertz.approach);
        Ok(CattaneoMindlin { limit, sliding, radius: hertz.contact_radius })
    }

    /// Radius c that sticks when the body is first loaded to Q \[m\]; 0 if it slides.
    pub fn stick_radius(&self, force: f64) -> f64 {
        self.radius * (1.0 - force.abs() / self.limit).max(0.0).cbrt()
    }

    /// Displacement d \[m\] when Q has gone from 0 to each of these in turn \[N\], each turn within the last loop. NaN
    /// beyond f P.
    pub fn displacement(&self, turns: &[f64]) -> f64 {
        let first = |force: f64| {
            let left = 1.0 - force.abs() / self.limit;
            force.signum() * self.sliding * if left < 0.0 { f64::NAN } else { 1.0 - left.cbrt().powi(2) }
        };
        let branches = turns.windows(2).map(|pair| 2.0 * first(0.5 * (pair[1] - pair[0])));
        turns.first().copied().map_or(0.0, first) + branches.sum::<f64>()
    }

    /// What a cycle between −Q and Q dissipates \[J\], for |Q| ≤ f P.
    pub fn loss(&self, force: f64) -> f64 {
        let (x, left) = (force.abs() / self.limit, 1.0 - force.abs() / self.limit);
        let parts = 4.0 * x * (1.0 - left.cbrt().powi(2)) - 8.0 * x + 4.8 * (1.0 - left.cbrt().powi(5));
        self.limit * self.sliding * parts
    }
}

/// A ball that is pressed and then twisted about the normal, with slip in the ring outside a radius c (J. L. Lubkin,
/// J. Appl. Mech. 18, 1951), for any Poisson's ratio: with k² = 1 − (ρ/a)² and I(ρ) = K(k) − E(k), the angle is φ = f
/// p₀/(2G) I(c), and the moment M = (8/3) f p₀ (c³ I(c) + 3 ∫ ρ² I dρ over c < ρ < a).
///
/// ```
/// use viscocontact::analytic::LubkinTorsion;
///
/// let ball = LubkinTorsion::new([1.0, 1.0], 1.0, 0.813_568_13)?;
/// assert!((ball.angle / 0.154_368_46 - 1.0).abs() < 1e-7 && (ball.moment / ball.limit - 0.5).abs() < 1e-7);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LubkinTorsion {
    /// Angle of the twist \[rad\].
    pub angle: f64,
    /// Its moment \[N m\].
    pub moment: f64,
    /// The moment at which all of the contact slides, π² f p₀ a³/8 \[N m\].
    pub limit: f64,
}

impl LubkinTorsion {
    /// Of the friction in the middle f p₀ and the shear modulus G \[Pa\], the contact `radius` a \[m\], and the part of
    /// it that sticks, c/a.
    ///
    /// # Errors
    /// If a number is not finite and positive, or `stick` not between 0 and 1.
    pub fn new([friction, modulus]: [f64; 2], radius: f64, stick: f64) -> Result<LubkinTorsion> {
        positive("friction in the middle f p₀", friction)?;
        positive("shear modulus", modulus)?;
        positive("contact radius", radius)?;
        within("part of the radius that sticks", stick, stick > 0.0 && stick < 1.0, "between 0 and 1")?;
        let at = |ratio: f64| {
            let squared = (1.0 - ratio) * (1.0 + ratio);
            match (ellipk(squared), ellipe(squared)) {
                (Ok(k), Ok(e)) => Ok(k - e),
                _ => Err(Error::OutOfRange { field: "part of the radius that sticks", value: ratio, allowed: "more" }),
            }
        };
        let rule = GaussLegendre::new(24);
        let ring = rule.integrate(stick, 1.0, |ratio| ratio * ratio * at(ratio).unwrap_or(f64::NAN));
        let unit = friction * radius.powi(3);
        Ok(LubkinTorsion {
            angle: 0.5 * friction / modulus * at(stick)?,
            moment: 8.0 / 3.0 * unit * (stick.powi(3) * at(stick)? + 3.0 * ring),
            limit: PI * PI / 8.0 * unit,
        })
    }
}
