//! Elastic states without a sweep: closed forms and tables.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::equilibrium::depth_of_power;
use crate::error::{Result, positive, within};
use crate::load::Tilt;
use crate::solver::RigidMotion;
use crate::states::curve::{ElasticState, ElasticStates};

/// Greatest number of a closed form. Products and quotients of such numbers do not overflow.
const GREATEST: f64 = 1e100;

/// Accepts sizes of which levels are numbers.
fn size(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, (1.0 / GREATEST..=GREATEST).contains(&value), "in [1e-100, 1e100]")
}

/// A power of a size: coefficient and exponent.
type Power = (f64, f64);

/// Upright axisymmetric bodies on a half-space: exact at every level, in any units. The contact may grow until a
/// number of it exceeds 10¹⁰⁰. The superposition is then the method of dimensionality reduction (Popov & Heß, *Method
/// of Dimensionality Reduction in Contact Mechanics and Friction*, 2015; for creeping bodies Ting 1968, Greenwood,
/// Int. J. Mech. Sci. 52, 2010).
impl ElasticStates {
    /// A sphere of `radius` R \[m\] as a paraboloid r²/2R (Hertz): δ = a²/R, l = 4/3 a³/R.
    ///
    /// ```
    /// use viscocontact::analytic::Hertz;
    /// use viscocontact::prelude::*;
    /// use viscocontact::states::{ElasticStates, StatesContact};
    ///
    /// let (ball, body) = (10.0e-3, Material::incompressible(Elastic::new(1.0e6)?));
    /// let mut contact = StatesContact::new(&ElasticStates::sphere(ball)?, &body)?;
    /// let report = contact.step(0.0, Load::force(1.0))?;
    /// let hertz = Hertz::new(ball, 4.0e6, 1.0)?;
    /// assert!((report.approach / hertz.approach - 1.0).abs() < 1e-12);
    /// // the pressure in the middle, from the elastic one
    /// let pressure = contact.superposed(|level| Hertz::new(ball, 1.0, level).map_or(0.0, |hertz| hertz.max_pressure));
    /// assert!((pressure / hertz.max_pressure - 1.0).abs() < 1e-12);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the radius is not in \[1e-100, 1e100\] m.
    pub fn sphere(radius: f64) -> Result<Arc<ElasticStates>> {
        ElasticStates::power(0.5 / size("sphere radius", radius)?, 2.0)
    }

    /// A cone of slope `tan_beta` (Love 1939): δ = (π/2) a tan β, l = δ a.
    ///
    /// # Errors
    /// If the slope is not in \[1e-100, 1e100\].
    pub fn cone(tan_beta: f64) -> Result<Arc<ElasticStates>> {
        ElasticStates::power(size("cone slope tan β", tan_beta)?, 1.0)
    }

    /// A flat circular punch of `radius` a \[m\]: l = 2 a δ.
    ///
    /// # Errors
    /// As [`ElasticStates::sphere`].
    pub fn punch(radius: f64) -> Result<Arc<ElasticStates>> {
        size("punch radius", radius)?;
        ElasticStates::of_powers([(2.0 * radius, 1.0), (1.0, 1.0), (2.0 * radius, 0.0), (PI * radius * radius, 0.0)])
    }

    /// A body of the shape c r^n, with `coefficient` c \[m^(1−n)\] and `exponent` n (Galin; Sneddon 1965): δ = κ c a^n,
    /// κ = √π Γ(n/2 + 1)/Γ((n + 1)/2), l = 2n/(n + 1) δ a.
    ///
    /// # Errors
    /// If the coefficient is not finite and positive, or levels are no numbers; if the exponent is outside \[0.1,
    /// 100\].
    pub fn power(coefficient: f64, exponent: f64) -> Result<Arc<ElasticStates>> {
        positive("coefficient of the shape c r^n", coefficient)?;
        let n = within("exponent of the shape c r^n", exponent, (0.1..=100.0).contains(&exponent), "in [0.1, 100]")?;
        let depth = depth_of_power(n) * coefficient;
        ElasticStates::of_powers([(2.0 * n / (n + 1.0) * depth, n + 1.0), (depth, n), (2.0, 1.0), (PI, 2.0)])
    }

    /// Level, approach, stiffness and area as powers of one size. Two states give the powers between them and below:
    /// the size 1, or less where a number is great there, and the size at which the first number is [`GREATEST`].
    fn of_powers(powers: [Power; 4]) -> Result<Arc<ElasticStates>> {
        let greatest = |(coefficient, exponent): Power| (GREATEST.ln() - coefficient.ln()) / exponent;
        let last = powers.into_iter().map(greatest).fold(f64::INFINITY, f64::min);
        let table = [last.min(1.0) - 1.0, last].map(|size| {
            let [level, depth, stiffness, area] =
                powers.map(|(factor, exponent)| (factor.ln() + exponent * size).exp());
            (level, depth, stiffness, area)
        });
        ElasticStates::from_table(&table)
    }

    /// States of an upright body from a table of (level \[m²\], approach \[m\], stiffness over the modulus \[m\],
    /// contact area \[m²\]), as of another closed form, another program or a measurement, whose level is the force over
    /// the contact modulus E*. The approach is measured from the first touch, and the contact is taken to grow only.
    ///
    /// An axisymmetric body of the shape f(r) has, at the contact radius a, the depth g(a) = a ∫ f′(r)/√(a² − r²) dr
    /// over 0 < r < a, the level 2 ∫ (g(a) − g(x)) dx over 0 < x < a, and the stiffness 2a.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact::states::{ElasticStates, StatesContact};
    ///
    /// // a cone with a spherical tip of radius R, tangent at the radius b: g = x²/R within b
    /// let (radius, b) = (1.0e-3_f64, 0.1e-3_f64);
    /// let depth = |x: f64| if x < b { x * x / radius } else { x / radius * (x - (x * x - b * b).sqrt() + b * (b / x).acos()) };
    /// let mut table = Vec::new();
    /// let (mut sum, mut last) = (0.0, 0.0);
    /// for k in 0..=200 {
    ///     let a = 1.0e-6 * 10.0_f64.powf(f64::from(k) / 60.0);
    ///     // ∫ g dx by Simpson's rule
    ///     sum += (a - last) / 6.0 * (depth(last) + 4.0 * depth(0.5 * (last + a)) + depth(a));
    ///     last = a;
    ///     table.push((2.0 * (a * depth(a) - sum), depth(a), 2.0 * a, std::f64::consts::PI * a * a));
    /// }
    /// let states = ElasticStates::from_table(&table)?;
    /// let mut contact = StatesContact::new(&states, &Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))?;
    /// contact.step(0.0, Load::force(1.0))?;
    /// assert!(contact.contact_area() > std::f64::consts::PI * b * b);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If there are fewer than two states, a number is not finite and positive, or levels and approaches do not ascend.
    pub fn from_table(table: &[(f64, f64, f64, f64)]) -> Result<Arc<ElasticStates>> {
        let rest = RigidMotion { approach: 0.0, tilt: [0.0; 2] };
        ElasticStates::from_rows(table.iter().copied(), rest, [Tilt::Fixed(0.0); 2])
    }

    /// States of a body that does not turn, from rows of level, approach, stiffness and area.
    pub(crate) fn from_rows(
        rows: impl Iterator<Item = (f64, f64, f64, f64)>,
        rest: RigidMotion,
        tilt: [Tilt; 2],
    ) -> Result<Arc<ElasticStates>> {
        let states = rows.map(|(level, approach, stiffness, area)| ElasticState {
            level,
            approach,
            stiffness,
            load_stiffness: stiffness,
            area,
            ..ElasticState::default()
        });
        ElasticStates::new(states.collect(), rest, tilt).validated().map(Arc::new)
    }
}
