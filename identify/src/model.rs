//! Relaxation models of the contact modulus.

use std::f64::consts::PI;

use libm::tgamma;
use viscocontact::rheology::{GeneralizedMaxwell, Material};
use viscocontact::states::ElasticStates;

use crate::error::{Error, Result, within};

/// Spacing of the nodes of a continuous spectrum in the logarithm of the rate: the trapezoidal rule errs by
/// exp(−π²/spacing), below 1e-7.
const SPACING: f64 = 0.6;
/// Terms with times further outside the times of the data are one term with the same sum and first moment: the error is
/// the square of this ratio.
const MARGIN: f64 = 3e-4;
/// Least share of a spectrum that is summed.
const LEAST_SHARE: f64 = 1e-10;

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
/// | `FractionalZener` | Einf + (E0 − Einf) E_alpha(−(t/tau)^alpha), with the Mittag-Leffler function | `E0`, `Einf`, `tau`, `alpha` |
///
/// The two laws with powers of time are evaluated as sums of exponentials that agree to 1e-6 with the law at all times
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
    /// A fractional solid (Cole and Cole).
    FractionalZener,
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

/// A sum of exponentials: E(t) = Σ Ek exp(−t ratek). A rate of 0 is the equilibrium modulus.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Prony<T = f64> {
    pub(crate) moduli: Vec<T>,
    pub(crate) rates: Vec<T>,
}

impl Prony {
    fn push(&mut self, modulus: f64, rate: f64) {
        if modulus > 0.0 {
            self.moduli.push(modulus);
            self.rates.push(rate);
        }
    }

    /// E(t).
    pub(crate) fn modulus(&self, t: f64) -> f64 {
        self.moduli.iter().zip(&self.rates).map(|(modulus, rate)| modulus * (-t * rate).exp()).sum()
    }

    /// Terms from a spectrum sampled at ascending rates. Terms faster than `fastest` become one, and slower than `slowest` too.
    fn gathered(terms: &[(f64, f64)], [slowest, fastest]: [f64; 2]) -> Prony {
        let mut prony = Prony::default();
        let one = |part: &[(f64, f64)], mean: &dyn Fn(f64, f64) -> f64| {
            let sum: f64 = part.iter().map(|(modulus, _)| modulus).sum();
            let moment: f64 = part.iter().map(|&(modulus, rate)| mean(modulus, rate)).sum();
            (sum, moment)
        };
        let (low, high) = (terms.partition_point(|t| t.1 < slowest), terms.partition_point(|t| t.1 <= fastest));
        // slow terms: E and the first moment of the rate decide E(t) at times long before they relax
        let (sum, moment) = one(&terms[..low], &|modulus, rate| modulus * rate);
        prony.push(sum, if sum > 0.0 { moment / sum } else { 0.0 });
        for &(modulus, rate) in &terms[low..high] {
            prony.push(modulus, rate);
        }
        // fast terms: E(0) and the viscosity
        let (sum, moment) = one(&terms[high..], &|modulus, rate| modulus / rate);
        prony.push(sum, if moment > 0.0 { sum / moment } else { 0.0 });
        prony
    }

    /// The material of this contact modulus and Poisson's ratio, against a rigid tip.
    pub(crate) fn material(&self, poisson: f64) -> Result<Material> {
        let equilibrium: f64 =
            self.moduli.iter().zip(&self.rates).filter(|(_, rate)| **rate == 0.0).map(|(e, _)| e).sum();
        let relaxing = self.moduli.iter().zip(&self.rates).filter(|(_, rate)| **rate > 0.0);
        // E* = 2G/(1 − ν)
        let shear = 0.5 * (1.0 - poisson);
        let terms: Vec<(f64, f64)> = relaxing.map(|(e, rate)| (shear * e, 1.0 / rate)).collect();
        Ok(Material::constant_poisson(GeneralizedMaxwell::new(shear * equilibrium, &terms)?, poisson)?)
    }

    /// The material on elastic states: with the Poisson's ratio that they state, else incompressible.
    pub(crate) fn material_on(&self, states: &ElasticStates) -> Result<Material> {
        self.material(states.poisson_ratio().unwrap_or(0.5))
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
            Model::FractionalZener => &["E0", "Einf", "tau", "alpha"],
            Model::Prony(terms) => {
                let pairs = (1..=*terms).flat_map(|k| [format!("E{k}"), format!("tau{k}")]);
                return std::iter::once("Einf".to_string()).chain(pairs).collect();
            }
        };
        names.iter().map(|name| (*name).to_string()).collect()
    }

    /// On which scale each parameter is searched for.
    pub(crate) fn scale(name: &str) -> Scale {
        if name == "alpha" { Scale::Logit } else { Scale::Logarithm }
    }

    /// E(t) of given parameters, evaluated as a fit does for data of the same time.
    ///
    /// # Errors
    /// If the number of parameters differs, one is not finite and positive, an exponent is not below 1, or Einf is above E0.
    pub fn modulus(&self, parameters: &[f64], t: f64) -> Result<f64> {
        Ok(self.prony(parameters, [t.max(f64::MIN_POSITIVE); 2])?.modulus(t))
    }

    /// The exponentials of the model for data between two times \[s\].
    pub(crate) fn prony(&self, parameters: &[f64], [shortest, longest]: [f64; 2]) -> Result<Prony> {
        let names = self.parameters();
        if names.len() != parameters.len() {
            let (len, expected) = (parameters.len(), names.len());
            return Err(Error::WrongLength { field: "parameters", len, expected });
        }
        for (name, &value) in names.iter().zip(parameters) {
            match Model::scale(name) {
                Scale::Logit => within("exponent alpha", value, value > 0.0 && value < 1.0, "> 0 and < 1")?,
                _ => within("modulus or time", value, value > 0.0, "finite and > 0")?,
            };
        }
        let relaxing = |e0: f64, einf: f64| within("Einf", einf, einf <= e0, "at most E0").map(|_| e0 - einf);
        let window = [MARGIN / longest, 1.0 / (MARGIN * shortest)];
        let mut prony = Prony::default();
        match (*self, parameters) {
            (Model::Elastic, &[e]) => prony.push(e, 0.0),
            (Model::Maxwell, &[e0, tau]) => prony.push(e0, 1.0 / tau),
            (Model::Zener, &[e0, einf, tau]) => {
                prony.push(einf, 0.0);
                prony.push(relaxing(e0, einf)?, 1.0 / tau);
            }
            (Model::Prony(_), [einf, terms @ ..]) => {
                prony.push(*einf, 0.0);
                for term in terms.chunks_exact(2) {
                    prony.push(term[0], 1.0 / term[1]);
                }
            }
            (Model::PowerLaw { cutoff }, &[e1, alpha]) => {
                let cutoff = within("cutoff", cutoff, cutoff > 0.0, "finite and > 0")?;
                prony = Prony::gathered(&power_law(e1, alpha, cutoff, window[0]), window);
            }
            (Model::FractionalZener, &[e0, einf, tau, alpha]) => {
                prony = Prony::gathered(&mittag_leffler(relaxing(e0, einf)?, tau, alpha), window);
                prony.push(einf, 0.0);
            }
            _ => {}
        }
        Ok(prony)
    }
}

/// E1 (t + c)^(−α) = E1/Γ(α) ∫ u^α exp(−u (t + c)) dln u by the trapezoidal rule. What lies below the lower limit is one term of the
/// same sum and first moment, which are geometric series.
fn power_law(e1: f64, alpha: f64, cutoff: f64, slowest: f64) -> Vec<(f64, f64)> {
    let factor = e1 / tgamma(alpha) * SPACING;
    let series = |power: f64| slowest.powf(power) / (power * SPACING).exp_m1();
    let mut terms = vec![(factor * series(alpha), series(alpha + 1.0) / series(alpha))];
    let last = (-LEAST_SHARE.ln() / cutoff / slowest).ln().max(0.0);
    let nodes = (last / SPACING).ceil() as usize;
    terms.extend((0..=nodes).map(|k| {
        let rate = slowest * (k as f64 * SPACING).exp();
        (factor * rate.powf(alpha) * (-rate * cutoff).exp(), rate)
    }));
    terms
}

/// E E_α(−(t/τ)^α) as a spectrum: sin(πα)/π/(x^α + 2 cos(πα) + x^(−α)) dln x with x = rate τ (Gorenflo & Mainardi 1997), by the
/// trapezoidal rule. The poles at ±iπ(1 − α)/α in ln x limit its spacing.
fn mittag_leffler(modulus: f64, tau: f64, alpha: f64) -> Vec<(f64, f64)> {
    let strip = (PI * (1.0 - alpha) / alpha).min(0.5 * PI);
    let spacing = SPACING * strip / (0.5 * PI);
    let nodes = (-LEAST_SHARE.ln() / alpha / spacing).ceil() as i64;
    let (sine, cosine) = (PI * alpha).sin_cos();
    let terms = (-nodes..=nodes).map(|k| {
        let ln_rate = k as f64 * spacing;
        (modulus * spacing * sine / PI / (2.0 * (alpha * ln_rate).cosh() + 2.0 * cosine), ln_rate.exp() / tau)
    });
    terms.filter(|(_, rate)| rate.is_finite() && *rate > 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_time_are_sums_of_exponentials() {
        for alpha in [0.05, 0.2, 0.5, 0.8] {
            let law = Model::PowerLaw { cutoff: 1e-5 };
            let prony = law.prony(&[3.0, alpha], [1e-3, 10.0]).unwrap();
            for t in [0.0, 1e-3, 0.02, 1.0, 10.0] {
                let exact = 3.0 * (t + 1e-5_f64).powf(-alpha);
                assert!((prony.modulus(t) / exact - 1.0).abs() < 1e-6, "alpha {alpha}, t {t}");
            }
        }
    }

    #[test]
    fn the_fractional_solid_has_closed_forms() {
        // E_½(−√x) = exp(x) erfc(√x)
        let prony = Model::FractionalZener.prony(&[3.0, 1.0, 2.0, 0.5], [1e-3, 100.0]).unwrap();
        for t in [1e-3, 0.1, 2.0, 50.0] {
            let x: f64 = t / 2.0;
            let exact = 1.0 + 2.0 * x.exp() * libm::erfc(x.sqrt());
            assert!((prony.modulus(t) / exact - 1.0).abs() < 1e-6, "t {t}: {} {exact}", prony.modulus(t));
        }
        // near 1 it is the standard solid
        let near = Model::FractionalZener.prony(&[3.0, 1.0, 2.0, 0.98], [1e-3, 100.0]).unwrap();
        assert!((near.modulus(1.0) / Model::Zener.modulus(&[3.0, 1.0, 2.0], 1.0).unwrap() - 1.0).abs() < 0.02);
    }

    #[test]
    fn refuses_moduli_that_rise() {
        assert!(Model::Zener.prony(&[1.0, 2.0, 1.0], [0.1, 1.0]).is_err());
        assert!(Model::Zener.prony(&[1.0, 0.5], [0.1, 1.0]).is_err());
        assert!(Model::PowerLaw { cutoff: 1e-3 }.prony(&[1.0, 1.0], [0.1, 1.0]).is_err());
    }
}
