//! Relaxation models of the contact modulus.

use crate::error::{Error, Result, within};

/// How the contact modulus relaxes. Times are in seconds and moduli in pascals; a modulus here is the modulus of the
/// contact, E* = 2G/(1 − ν) for a rigid tip.
///
/// | model | E(t) | parameters |
/// |---|---|---|
/// | `Elastic` | E | `E` |
/// | `Maxwell` | E0 exp(−t/tau) | `E0`, `tau` |
/// | `Zener` | Einf + (E0 − Einf) exp(−t/tau) | `E0`, `Einf`, `tau` |
/// | `Prony(n)` | Einf + Σ Ek exp(−t/tauk) | `Einf`, `E1`, `tau1`, … |
/// | `PowerLaw` | E1 ((t + cutoff)/1 s)^(−alpha) | `E1`, `alpha` |
/// | `PowerLawSolid` | Einf + E1 ((t + cutoff)/1 s)^(−alpha) | `E1`, `alpha`, `Einf` |
/// | `Stretched` | Einf + (E0 − Einf) exp(−(t/tau)^beta) | `E0`, `Einf`, `tau`, `beta` |
/// | `FractionalZener` | Einf + (E0 − Einf) E_alpha(−(t/tau)^alpha), with the Mittag-Leffler function | `E0`, `Einf`, `tau`, `alpha` |
/// | `Custom(law)` | a [`Law`] of your own | of the law |
///
/// Laws with powers of time and custom ones are evaluated as sums of exponentials that agree to 1e-6 with the law at all times
/// between the shortest sampling interval and the length of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Model {
    /// No relaxation.
    Elastic,
    /// A fluid of one relaxation time.
    Maxwell,
    /// The standard linear solid.
    Zener,
    /// A solid of several relaxation times.
    Prony(usize),
    /// A power of time, with a finite modulus at times below `cutoff`.
    PowerLaw {
        /// Time below which the modulus no longer rises \[s\]: well below the sampling interval, which makes it irrelevant.
        cutoff: f64,
    },
    /// A power of time above an equilibrium, with a finite modulus at times below `cutoff`.
    PowerLawSolid {
        /// As of [`Model::PowerLaw`] \[s\].
        cutoff: f64,
    },
    /// A stretched exponential (Kohlrausch, Williams and Watts).
    Stretched,
    /// A fractional solid (Cole and Cole).
    FractionalZener,
    /// Any other law.
    Custom(Law),
}

/// A relaxation law of a user. A name tells how a parameter is searched for, and between which starts: moduli begin with `E`, times with `tau`,
/// exponents between 0 and 1 with any other letter. Of the two first parameters `E0` and `Einf`, the second is at most the first.
///
/// ```
/// use viscocontact_identify::{Law, Model};
///
/// let logarithmic = Law {
///     name: "logarithmic",
///     parameters: &["E0", "tau"],
///     modulus: |of, t| of[0] / (1.0 + (t / of[1]).ln_1p()),
/// };
/// assert_eq!(Model::Custom(logarithmic).parameters(), ["E0", "tau"]);
/// ```
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Law {
    /// Its name.
    pub name: &'static str,
    /// Names of its parameters.
    pub parameters: &'static [&'static str],
    /// E(t) \[Pa\] of the parameters and a time \[s\], falling with time and finite at 0.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub modulus: fn(&[f64], f64) -> f64,
}

/// Laws are equal if their names and those of their parameters are.
impl PartialEq for Law {
    fn eq(&self, other: &Law) -> bool {
        (self.name, self.parameters) == (other.name, other.parameters)
    }
}

/// Which function of a parameter is searched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Scale {
    /// The logarithm: moduli, times, stiffness.
    Logarithm,
    /// ln(x/(1 − x)): exponents between 0 and 1.
    Logit,
    /// The parameter itself: contact point, offset, drift, drag.
    Linear,
}

impl Scale {
    /// Accepts values that have a coordinate on this scale.
    pub(crate) fn check(self, name: &str, value: f64) -> Result<()> {
        let (inside, allowed) = match self {
            Scale::Logarithm => (value > 0.0, "finite and > 0"),
            Scale::Logit => (value > 0.0 && value < 1.0, "> 0 and < 1"),
            Scale::Linear => (true, "finite"),
        };
        let refused = || Error::ParameterOutOfRange { name: name.into(), value, allowed };
        if value.is_finite() && inside { Ok(()) } else { Err(refused()) }
    }

    pub(crate) fn forward(self, value: f64) -> f64 {
        match self {
            Scale::Logarithm => value.ln(),
            Scale::Logit => (value / (1.0 - value)).ln(),
            Scale::Linear => value,
        }
    }

    pub(crate) fn back(self, value: f64) -> f64 {
        match self {
            Scale::Logarithm => value.exp(),
            Scale::Logit => 1.0 / (1.0 + (-value).exp()),
            Scale::Linear => value,
        }
    }
}

impl Model {
    /// Names of the parameters, in their order.
    pub fn parameters(&self) -> Vec<String> {
        let names: &[&str] = match self {
            Model::Elastic => &["E"],
            Model::Maxwell => &["E0", "tau"],
            Model::Zener => &["E0", "Einf", "tau"],
            Model::PowerLaw { .. } => &["E1", "alpha"],
            Model::PowerLawSolid { .. } => &["E1", "alpha", "Einf"],
            Model::Stretched => &["E0", "Einf", "tau", "beta"],
            Model::FractionalZener => &["E0", "Einf", "tau", "alpha"],
            Model::Custom(law) => law.parameters,
            Model::Prony(terms) => {
                let pairs = (1..=*terms).flat_map(|k| [format!("E{k}"), format!("tau{k}")]);
                return std::iter::once("Einf".to_string()).chain(pairs).collect();
            }
        };
        names.iter().map(|name| (*name).to_string()).collect()
    }

    /// Accepts a cutoff that is a time.
    pub(crate) fn check_cutoff(&self) -> Result<()> {
        let (Model::PowerLaw { cutoff } | Model::PowerLawSolid { cutoff }) = *self else { return Ok(()) };
        within("cutoff", cutoff, cutoff > 0.0, "finite and > 0").map(drop)
    }

    /// On which scale each parameter is searched for.
    pub(crate) fn scale(name: &str) -> Scale {
        if name.starts_with('E') || name.starts_with("tau") { Scale::Logarithm } else { Scale::Logit }
    }

    /// E(t) of given parameters, evaluated as a fit does for data of the same time.
    ///
    /// # Errors
    /// If the number of parameters differs, one is not finite and positive, an exponent is not below 1, or Einf is above E0; if the time is negative or
    /// not finite.
    pub fn modulus(&self, parameters: &[f64], t: f64) -> Result<f64> {
        within("time", t, t >= 0.0, "finite and >= 0")?;
        // the rates for shorter times are not finite
        Ok(self.prony(parameters, [t.max(1e-300); 2])?.modulus(t))
    }

    /// The model of which this one is the next generalisation, in a chain whose first link is the elastic body.
    pub(crate) fn contained(&self) -> Option<Model> {
        Some(match *self {
            Model::Elastic | Model::Custom(_) => return None,
            Model::PowerLawSolid { cutoff } => Model::PowerLaw { cutoff },
            Model::Maxwell | Model::PowerLaw { .. } | Model::Prony(0) => Model::Elastic,
            Model::Zener => Model::Maxwell,
            Model::Prony(1) | Model::FractionalZener | Model::Stretched => Model::Zener,
            Model::Prony(terms) => Model::Prony(terms - 1),
        })
    }

    /// The parameters with which this model is a contained one, or next to it, for curves of a length \[s\].
    pub(crate) fn of_contained(&self, inner: Model, values: &[f64], length: f64) -> Vec<f64> {
        match (self, inner, values) {
            (Model::Maxwell, _, &[e]) => vec![e, length / NEXT_TO],
            (Model::PowerLaw { .. }, _, &[e]) => vec![e, NEXT_TO],
            (Model::Zener, _, &[e0, tau]) => vec![e0, NEXT_TO * e0, tau],
            (Model::Prony(_), Model::Zener, &[e0, einf, tau]) => vec![einf, e0 - einf, tau],
            (Model::PowerLawSolid { .. }, _, &[e1, alpha]) => vec![e1, alpha, NEXT_TO * e1],
            (Model::FractionalZener | Model::Stretched, _, &[e0, einf, tau]) => vec![e0, einf, tau, 1.0 - NEXT_TO],
            // another term without strength
            (Model::Prony(_), _, values) => [values, &[NEXT_TO * values[0], 0.1 * length]].concat(),
            _ => values.to_vec(),
        }
    }
}

/// How near a model comes to a model that it contains at a limit.
const NEXT_TO: f64 = 1e-8;
