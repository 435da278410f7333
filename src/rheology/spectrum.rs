//! Exponential series of creep and relaxation, and the exact conversion between them.

use crate::error::{Result, least_length, positive, within};
use crate::rheology::Rheology;
use crate::rheology::interconversion::reciprocal;

/// A creep compliance as an exponential series,
///
/// J(t) = J_g + φ t + Σ J_k (1 − e^(−t/λ_k)),
///
/// with glassy compliance J_g, fluidity φ and retardation times λ_k. Every coefficient is ≥ 0.
///
/// ```
/// use viscocontact::rheology::CreepSpectrum;
///
/// // Zener: 1/G = 1e-6, 1/G_K = 2e-6, retardation time 0.5 s
/// let creep = CreepSpectrum::new(1.0e-6, 0.0, &[(2.0e-6, 0.5)])?;
/// let relaxation = creep.relaxation();
/// assert!((relaxation.equilibrium() * 3.0e-6 - 1.0).abs() < 1e-14);
/// assert!((relaxation.terms()[0].1 - 0.5 / 3.0).abs() < 1e-14); // relaxation is faster than creep
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "CreepSpectrumParts"))]
pub struct CreepSpectrum {
    glassy: f64,
    fluidity: f64,
    /// Compliances and retardation times, times ascending and distinct.
    terms: Vec<(f64, f64)>,
}

/// A relaxation modulus as an exponential series,
///
/// G(t) = G_∞ + Σ G_k e^(−t/τ_k) + η δ(t),
///
/// with equilibrium modulus G_∞, relaxation times τ_k and, for bodies without elastic response, the
/// viscosity η of an immediate dashpot. Every coefficient is ≥ 0.
#[derive(Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "RelaxationSpectrumParts")
)]
pub struct RelaxationSpectrum {
    equilibrium: f64,
    viscosity: f64,
    /// Moduli and relaxation times, times ascending and distinct.
    terms: Vec<(f64, f64)>,
}

clone_by_fields! { RelaxationSpectrum { equilibrium, viscosity, terms } }

/// A relaxation modulus as a checkpoint stores it. A file is compared with the scene before it is used.
#[cfg(feature = "checkpoint")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(remote = "RelaxationSpectrum")]
pub(crate) struct SavedRelaxation {
    equilibrium: f64,
    viscosity: f64,
    terms: Vec<(f64, f64)>,
}

/// Declares what a file holds of a series, which is checked when it is read.
#[cfg(feature = "serde")]
macro_rules! checked_parts {
    ($parts:ident of $series:ident: $first:ident, $second:ident) => {
        #[derive(serde::Deserialize)]
        struct $parts {
            $first: f64,
            $second: f64,
            terms: Vec<(f64, f64)>,
        }

        impl TryFrom<$parts> for $series {
            type Error = crate::Error;

            fn try_from(parts: $parts) -> Result<$series> {
                $series::new(parts.$first, parts.$second, &parts.terms)
            }
        }
    };
}
#[cfg(feature = "serde")]
checked_parts!(CreepSpectrumParts of CreepSpectrum: glassy, fluidity);
#[cfg(feature = "serde")]
checked_parts!(RelaxationSpectrumParts of RelaxationSpectrum: equilibrium, viscosity);

/// A spring, a dashpot and any number of Kelvin–Voigt elements in series: J = J_g + φ t + Σ J_k (1 − e^(−t/λ_k)), the
/// series itself.
pub type GeneralizedKelvin = CreepSpectrum;

impl CreepSpectrum {
    /// A series with `glassy` compliance \[1/Pa\], `fluidity` \[1/(Pa·s)\] and `terms` of (compliance
    /// \[1/Pa\], retardation time \[s\]) in any order; equal times are merged, zero terms dropped.
    ///
    /// # Errors
    /// If a compliance or the fluidity is neither 0 nor in \[1e-100, 1e100\], a time is not in that range, or
    /// everything is zero (a rigid body).
    pub fn new(glassy: f64, fluidity: f64, terms: &[(f64, f64)]) -> Result<CreepSpectrum> {
        let names = ["creep spectrum", "glassy compliance", "fluidity", "retarded compliance", "retardation time"];
        let terms = sorted_terms(names, [glassy, fluidity], terms)?;
        Ok(CreepSpectrum { glassy, fluidity, terms })
    }

    /// Compliance at t = 0, 1/G for an elastic response, 0 for a body without \[1/Pa\].
    pub fn glassy(&self) -> f64 {
        self.glassy
    }

    /// Compliance without the flow after a long time \[1/Pa\].
    pub(crate) fn relaxed(&self) -> f64 {
        self.glassy + self.terms.iter().map(|(compliance, _)| compliance).sum::<f64>()
    }

    /// Rate of steady flow under unit stress, 0 for a solid \[1/(Pa·s)\].
    pub fn fluidity(&self) -> f64 {
        self.fluidity
    }

    /// (Compliance \[1/Pa\], retardation time \[s\]) of each term, times ascending.
    pub fn terms(&self) -> &[(f64, f64)] {
        &self.terms
    }

    /// J(t) \[1/Pa\] at t ≥ 0 \[s\].
    pub fn compliance(&self, t: f64) -> f64 {
        let retarded: f64 = self.terms.iter().map(|&(c, lambda)| -c * (-t / lambda).exp_m1()).sum();
        let flow = if self.fluidity > 0.0 { self.fluidity * t } else { 0.0 };
        self.glassy + retarded + flow
    }

    /// The same compliance multiplied by a positive `factor`.
    ///
    /// # Errors
    /// If the factor is not finite and positive.
    pub fn scaled(&self, factor: f64) -> Result<CreepSpectrum> {
        positive("factor of a creep spectrum", factor)?;
        let terms: Vec<_> = self.terms.iter().map(|&(c, lambda)| (factor * c, lambda)).collect();
        CreepSpectrum::new(factor * self.glassy, factor * self.fluidity, &terms)
    }

    /// The same body with all times multiplied by `factor`.
    ///
    /// # Errors
    /// If the factor is not finite and positive, or a time or the fluidity leaves \[1e-100, 1e100\].
    pub fn slowed(&self, factor: f64) -> Result<CreepSpectrum> {
        positive("factor of time", factor)?;
        let terms: Vec<_> = self.terms.iter().map(|&(c, lambda)| (c, factor * lambda)).collect();
        CreepSpectrum::new(self.glassy, self.fluidity / factor, &terms)
    }

    /// The compliance of this body and `other` in series, or of two bodies of a contact: the sum.
    ///
    /// # Errors
    /// If a coefficient leaves \[1e-100, 1e100\].
    pub fn plus(&self, other: &CreepSpectrum) -> Result<CreepSpectrum> {
        let terms = [self.terms.as_slice(), &other.terms].concat();
        CreepSpectrum::new(self.glassy + other.glassy, self.fluidity + other.fluidity, &terms)
    }

    /// The relaxation modulus of the same body, exactly: s Ĵ(s) · s Ĝ(s) = 1.
    pub fn relaxation(&self) -> RelaxationSpectrum {
        // s Ĵ(s) = J_g + φ/s + Σ J_k x_k/(x_k + s), poles at the rates x_k = 1/λ_k
        let terms: Vec<_> = self.terms.iter().rev().map(|&(c, lambda)| (c, 1.0 / lambda)).collect();
        let (equilibrium, viscosity, terms) = reciprocal(self.glassy, self.fluidity, &terms);
        let terms = terms.into_iter().rev().map(|(g, rate)| (g, 1.0 / rate)).collect();
        RelaxationSpectrum { equilibrium, viscosity, terms }
    }
}

impl RelaxationSpectrum {
    /// A series with `equilibrium` modulus \[Pa\], immediate `viscosity` \[Pa·s\] (0 unless the body has
    /// no elastic response) and `terms` of (modulus \[Pa\], relaxation time \[s\]) in any order; equal
    /// times are merged, zero terms dropped.
    ///
    /// # Errors
    /// If a modulus or the viscosity is neither 0 nor in \[1e-100, 1e100\], a time is not in that range, or
    /// everything is zero (no body).
    pub fn new(equilibrium: f64, viscosity: f64, terms: &[(f64, f64)]) -> Result<RelaxationSpectrum> {
        let names = [
            "relaxation spectrum",
            "equilibrium modulus",
            "immediate viscosity",
            "relaxing modulus",
            "relaxation time",
        ];
        let terms = sorted_terms(names, [equilibrium, viscosity], terms)?;
        Ok(RelaxationSpectrum { equilibrium, viscosity, terms })
    }

    /// Modulus after an infinite time, 0 for a fluid \[Pa\].
    pub fn equilibrium(&self) -> f64 {
        self.equilibrium
    }

    /// Viscosity of the immediate dashpot, 0 for a body with elastic response \[Pa·s\].
    pub fn viscosity(&self) -> f64 {
        self.viscosity
    }

    /// (Modulus \[Pa\], relaxation time \[s\]) of each term, times ascending.
    pub fn terms(&self) -> &[(f64, f64)] {
        &self.terms
    }

    /// G(t) \[Pa\] at t ≥ 0 \[s\], without the immediate dashpot.
    pub fn modulus(&self, t: f64) -> f64 {
        self.equilibrium + self.terms.iter().map(|&(g, tau)| g * (-t / tau).exp()).sum::<f64>()
    }

    /// The creep compliance of the same body, exactly: s Ĵ(s) · s Ĝ(s) = 1.
    pub fn creep(&self) -> CreepSpectrum {
        // In σ = 1/s the modulus reads s Ĝ = G_∞ + η/σ + Σ G_k τ_k/(τ_k + σ): the form of s Ĵ with
        // times in place of rates, so that the same function converts both ways.
        let (glassy, fluidity, terms) = reciprocal(self.equilibrium, self.viscosity, &self.terms);
        CreepSpectrum { glassy, fluidity, terms }
    }
}

/// Checks the ends of a series and its (strength, time) pairs, sorts the pairs by time, merges equal times, drops
/// zero strengths.
fn sorted_terms(
    [series, first, second, strength_name, time_name]: [&'static str; 5],
    ends: [f64; 2],
    terms: &[(f64, f64)],
) -> Result<Vec<(f64, f64)>> {
    // so that reciprocals and products of two do not overflow
    let inside = |value: f64| (1e-100..=1e100).contains(&value);
    let magnitude = |field, value: f64| within(field, value, value == 0.0 || inside(value), "0, or in [1e-100, 1e100]");
    magnitude(first, ends[0])?;
    magnitude(second, ends[1])?;
    let mut sorted = Vec::with_capacity(terms.len());
    for &(strength, time) in terms {
        magnitude(strength_name, strength)?;
        within(time_name, time, inside(time), "in [1e-100, 1e100]")?;
        if strength > 0.0 {
            sorted.push((strength, time));
        }
    }
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    sorted.dedup_by(|next, kept| {
        let equal = next.1 == kept.1;
        if equal {
            kept.0 += next.0;
        }
        equal
    });
    if ends == [0.0; 2] {
        least_length(series, sorted.len(), 1)?;
    }
    Ok(sorted)
}

impl Rheology for CreepSpectrum {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.compliance(t)
    }

    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        Some(self.clone())
    }
}
