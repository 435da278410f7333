use crate::error::{Result, positive, within};
use crate::rheology::{CreepSpectrum, forward_rheology};

/// The standard linear solid, a spring in series with a Kelvin–Voigt element:
/// J = 1/G + (1 − e^(−t/λ))/G_K, retardation time λ = η_K/G_K.
///
/// Its relaxation modulus is G_∞ + (G − G_∞) e^(−t/τ): it relaxes faster than it creeps, τ = λ G_∞/G.
///
/// ```
/// use viscocontact::rheology::{Rheology, Zener};
///
/// let rubber = Zener::relaxing(1.0e9, 1.0e6, 1.0e-3)?; // from 1 GPa to 1 MPa within 1 ms
/// assert_eq!(rubber.creep_compliance(0.0), 1.0e-9);
/// let series = rubber.creep_spectrum().unwrap();
/// assert!((series.relaxation().terms()[0].1 / 1.0e-3 - 1.0).abs() < 1e-12);
/// assert!((series.terms()[0].1 - 1.0).abs() < 1e-12); // but creeps for 1 s
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Zener(CreepSpectrum);

impl Zener {
    /// A body of glassy shear modulus `g` \[Pa\] whose Kelvin–Voigt element has modulus `g_k` \[Pa\] and
    /// viscosity `eta_k` \[Pa·s\].
    ///
    /// # Errors
    /// If one is not finite and positive.
    pub fn new(g: f64, g_k: f64, eta_k: f64) -> Result<Zener> {
        positive("shear modulus", g)?;
        positive("Kelvin–Voigt modulus", g_k)?;
        positive("Kelvin–Voigt viscosity", eta_k)?;
        Zener::with_time(g, g_k, eta_k / g_k)
    }

    /// A body of glassy shear modulus `g` \[Pa\] whose Kelvin–Voigt element has modulus `g_k` \[Pa\] and
    /// `retardation_time` λ \[s\].
    ///
    /// # Errors
    /// If one is not finite and positive.
    pub fn with_time(g: f64, g_k: f64, retardation_time: f64) -> Result<Zener> {
        positive("shear modulus", g)?;
        positive("Kelvin–Voigt modulus", g_k)?;
        positive("retardation time", retardation_time)?;
        Ok(Zener(CreepSpectrum::new(1.0 / g, 0.0, &[(1.0 / g_k, retardation_time)])?))
    }

    /// A body whose shear modulus relaxes from `glassy` to `rubbery` \[Pa\] with `relaxation_time` τ \[s\]:
    /// G(t) = rubbery + (glassy − rubbery) e^(−t/τ).
    ///
    /// # Errors
    /// If the moduli or the time are not finite and positive, or the glassy modulus is not the greater one.
    pub fn relaxing(glassy: f64, rubbery: f64, relaxation_time: f64) -> Result<Zener> {
        let [ratio, g_k] = relaxed_element(glassy, rubbery)?;
        positive("relaxation time", relaxation_time)?;
        Zener::with_time(glassy, g_k, relaxation_time * ratio)
    }
}

/// The ratio of the moduli, and the modulus of the Kelvin–Voigt element that makes a body of `glassy` modulus relax
/// to `rubbery`.
pub(super) fn relaxed_element(glassy: f64, rubbery: f64) -> Result<[f64; 2]> {
    positive("rubbery modulus", rubbery)?;
    within("glassy modulus", glassy, glassy > rubbery, "finite, and greater than the rubbery modulus")?;
    let ratio = glassy / rubbery;
    // 1/G_K = 1/G_∞ − 1/G
    Ok([ratio, glassy / (glassy - rubbery) * rubbery])
}

forward_rheology!(self: Zener => self.0);
