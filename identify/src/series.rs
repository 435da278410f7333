//! The relaxation of a model as a sum of exponentials.

use std::f64::consts::PI;
use std::ops::Range;

use libm::tgamma;
use viscocontact::rheology::{GeneralizedMaxwell, Material};
use viscocontact::states::ElasticStates;

use crate::error::{Error, Result, within};
use crate::model::{Model, Scale};

/// Spacing of the nodes of a continuous spectrum in the logarithm of the rate: the trapezoidal rule errs by
/// exp(−π²/spacing), below 1e-8.
const SPACING: f64 = 0.5;
/// Terms with times further outside the times of the data are one term with the same sum and first moment: the error is
/// the square of this ratio.
const MARGIN: f64 = 3e-4;
/// −ln of the least share of a spectrum that is summed.
const LEAST_SHARE: f64 = 23.0;
/// Least part of a spectrum that is a term of its own.
const LEAST_WEIGHT: f64 = 1e-10;
/// Nodes so close in the logarithm of the rate to the peak of a spectrum are one term: the error is below the square.
const PEAK: f64 = 5e-4;
/// Width of coordinates over which derivatives of the terms are taken.
const DIFFERENCE: f64 = 1e-5;

/// A sum of exponentials: E(t) = Σ Ek exp(−t ratek). A rate of 0 is the equilibrium modulus.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Prony<T = f64> {
    pub(crate) moduli: Vec<T>,
    pub(crate) rates: Vec<T>,
}

/// Where a continuous spectrum is summed: it depends on the parameters, and their derivatives are taken with the nodes kept.
#[derive(Clone, Debug, Default)]
struct Nodes {
    /// Logarithms of the rates in units of the model, and their weights.
    at: Vec<(f64, f64)>,
    /// Nodes within the window of the data.
    inside: [usize; 2],
    /// Nodes so close to each other that they are one term.
    peak: Range<usize>,
}

impl Prony {
    fn push(&mut self, modulus: f64, rate: f64) {
        self.moduli.push(modulus);
        self.rates.push(rate);
    }

    /// E(t).
    pub(crate) fn modulus(&self, t: f64) -> f64 {
        self.moduli.iter().zip(&self.rates).map(|(modulus, rate)| modulus * (-t * rate).exp()).sum()
    }

    /// Terms of a spectrum at ascending rates, and moduli below and above all of them. Terms outside the window become one on each side.
    fn gather(&mut self, terms: &[(f64, f64)], [low, high]: [usize; 2], [below, above]: [f64; 2]) {
        // slow terms: E and the first moment of the rate decide E(t) at times long before they relax
        let sum = below + terms[..low].iter().map(|(modulus, _)| modulus).sum::<f64>();
        let moment: f64 = terms[..low].iter().map(|(modulus, rate)| modulus * rate).sum();
        self.push(sum, if sum > 0.0 { moment / sum } else { 0.0 });
        for &(modulus, rate) in &terms[low..high] {
            self.push(modulus, rate);
        }
        // fast terms: E(0) and the viscosity
        let sum = above + terms[high..].iter().map(|(modulus, _)| modulus).sum::<f64>();
        let moment: f64 = terms[high..].iter().map(|(modulus, rate)| modulus / rate).sum();
        if let Some(&(_, fastest)) = terms.last() {
            self.push(sum, if moment > 0.0 { sum / moment } else { fastest });
        }
    }

    /// The material of this contact modulus and Poisson's ratio, against a rigid tip.
    pub(crate) fn material(&self, poisson: f64) -> Result<Material> {
        // E* = 2G/(1 − ν)
        let shear = 0.5 * (1.0 - poisson);
        let pairs = || self.moduli.iter().zip(&self.rates).filter(|(modulus, _)| **modulus > 0.0);
        let equilibrium: f64 = pairs().filter(|(_, rate)| **rate == 0.0).map(|(e, _)| e).sum();
        let relaxing = pairs().filter(|(_, rate)| **rate > 0.0);
        let terms: Vec<(f64, f64)> = relaxing.map(|(e, rate)| (shear * e, 1.0 / rate)).collect();
        if terms.is_empty() {
            return Ok(Material::constant_poisson(
                viscocontact::rheology::Elastic::new(shear * equilibrium)?,
                poisson,
            )?);
        }
        Ok(Material::constant_poisson(GeneralizedMaxwell::new(shear * equilibrium, &terms)?, poisson)?)
    }

    /// The material on elastic states: with the Poisson's ratio that they state, else incompressible.
    pub(crate) fn material_on(&self, states: &ElasticStates) -> Result<Material> {
        self.material(states.poisson_ratio().unwrap_or(0.5))
    }
}

impl Model {
    /// The exponentials of the model for data between two times \[s\].
    pub(crate) fn prony(&self, parameters: &[f64], window: [f64; 2]) -> Result<Prony> {
        Ok(self.on(&self.nodes(parameters, window)?, parameters))
    }

    /// The exponentials, and their derivatives by some coordinates: `moved` gives the parameters where a coordinate is larger by some width.
    pub(crate) fn derived(
        &self,
        parameters: &[f64],
        window: [f64; 2],
        coordinates: usize,
        moved: impl Fn(usize, f64) -> Vec<f64>,
    ) -> Result<(Prony, Vec<Prony>)> {
        let nodes = self.nodes(parameters, window)?;
        let by = |coordinate: usize| {
            let [up, down] = [DIFFERENCE, -DIFFERENCE].map(|width| self.on(&nodes, &moved(coordinate, width)));
            let slope = |up: &[f64], down: &[f64]| {
                up.iter().zip(down).map(|(up, down)| (up - down) / (2.0 * DIFFERENCE)).collect()
            };
            Prony { moduli: slope(&up.moduli, &down.moduli), rates: slope(&up.rates, &down.rates) }
        };
        Ok((self.on(&nodes, parameters), (0..coordinates).map(by).collect()))
    }

    /// Checks parameters, and places the nodes of a continuous spectrum.
    fn nodes(&self, parameters: &[f64], [shortest, longest]: [f64; 2]) -> Result<Nodes> {
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
        if names.get(1).is_some_and(|name| name == "Einf") {
            within("Einf", parameters[1], parameters[1] <= parameters[0], "at most E0")?;
        }
        let [slowest, fastest] = [(MARGIN / longest).ln(), -(MARGIN * shortest).ln()];
        match (*self, parameters) {
            (Model::PowerLaw { cutoff }, _) => {
                let cutoff = within("cutoff", cutoff, cutoff > 0.0, "finite and > 0")?;
                let nodes = ((LEAST_SHARE.ln() - cutoff.ln() - slowest).max(0.0) / SPACING).ceil() as usize;
                let at: Vec<_> = (0..=nodes).map(|k| (slowest + k as f64 * SPACING, SPACING)).collect();
                let high = at.partition_point(|(y, _)| *y <= fastest);
                Ok(Nodes { at, inside: [0, high], peak: 0..0 })
            }
            (Model::FractionalZener, &[_, _, tau, alpha]) => {
                Ok(fractional_nodes(alpha, [slowest, fastest].map(|limit| limit + tau.ln())))
            }
            _ => Ok(Nodes::default()),
        }
    }

    /// The exponentials of given parameters on given nodes.
    fn on(&self, nodes: &Nodes, parameters: &[f64]) -> Prony {
        let mut prony = Prony::default();
        match (*self, parameters) {
            (Model::Elastic, &[e]) => prony.push(e, 0.0),
            (Model::Maxwell, &[e0, tau]) => prony.push(e0, 1.0 / tau),
            (Model::Zener, &[e0, einf, tau]) => {
                prony.push(einf, 0.0);
                prony.push(e0 - einf, 1.0 / tau);
            }
            (Model::Prony(_), [einf, terms @ ..]) => {
                prony.push(*einf, 0.0);
                for term in terms.chunks_exact(2) {
                    prony.push(term[0], 1.0 / term[1]);
                }
            }
            // E1 (t + c)^(−α) = E1/Γ(α) ∫ u^α exp(−u (t + c)) dln u by the trapezoidal rule. What lies below the first node is one term
            // of the same sum and first moment, which are geometric series.
            (Model::PowerLaw { cutoff }, &[e1, alpha]) => {
                let factor = e1 / tgamma(alpha) * SPACING;
                let slowest = nodes.at[0].0;
                let series = |power: f64| (power * slowest).exp() / (power * SPACING).exp_m1();
                let mut terms = vec![(factor * series(alpha), series(alpha + 1.0) / series(alpha))];
                let term = |&(y, _): &(f64, f64)| (factor * (alpha * y - y.exp() * cutoff).exp(), y.exp());
                terms.extend(nodes.at.iter().map(term));
                prony.gather(&terms, nodes.inside.map(|node| node + 1), [0.0; 2]);
            }
            (Model::FractionalZener, &[e0, einf, tau, alpha]) => {
                prony.push(einf, 0.0);
                let mut terms: Vec<(f64, f64)> = nodes
                    .at
                    .iter()
                    .map(|&(y, weight)| ((e0 - einf) * weight * fractional_density(alpha, y), y.exp() / tau))
                    .collect();
                let peak = terms[nodes.peak.clone()].iter().map(|(modulus, _)| modulus).sum();
                terms.splice(nodes.peak.clone(), (!nodes.peak.is_empty()).then_some((peak, 1.0 / tau)));
                // the sum beyond the first and the last node
                let [below, above] = [nodes.at[0], nodes.at[nodes.at.len() - 1]].map(|(y, h)| {
                    let [near, far] = [y.abs(), y.abs() + h].map(|y| fractional_density(alpha, y));
                    // the midpoint rule, with its first correction h² f′/24
                    fractional_share(alpha, -y.abs() - 0.5 * h) + h * (far - near) / 24.0
                });
                prony.gather(&terms, nodes.inside, [below, above].map(|share| (e0 - einf) * share));
            }
            _ => {}
        }
        prony
    }
}

/// The spectrum of E_α(−(t/τ)^α) over y = ln(rate τ), of area 1: sin(πα)/2π/(cosh αy + cos πα) (Gorenflo & Mainardi 1997). With
/// c = sin(π(1 − α)/2) and s = cos(π(1 − α)/2) this is s c/2π/(sinh²(αy/2) + c²).
fn fractional_density(alpha: f64, y: f64) -> f64 {
    let (c, s) = (0.5 * PI * (1.0 - alpha)).sin_cos();
    s * c / (2.0 * PI * ((0.5 * alpha * y).sinh().powi(2) + c * c))
}

/// Its area below y < 0.
fn fractional_share(alpha: f64, y: f64) -> f64 {
    let (c, s) = (0.5 * PI * (1.0 - alpha)).sin_cos();
    // 1/2 + atan(tanh(αy/2) s/c)/πα, free of the cancellation
    let u = (0.5 * alpha * y).tanh();
    let rest = 2.0 * (alpha * y).exp() / (1.0 + (alpha * y).exp());
    // atan(s/c) + atan(u s/c) = atan of (s/c)(1 + u)/(1 − u s²/c²)
    (s / c * rest).atan2(1.0 - u * s * s / (c * c)) / (PI * alpha)
}

/// Nodes in y for the trapezoidal rule in v = y + asinh(y/b), where ±ib are the poles: the spectrum is as smooth in v for
/// α → 1, where the peak is narrow, as for α → 0, where it is wide.
fn fractional_nodes(alpha: f64, [slowest, fastest]: [f64; 2]) -> Nodes {
    let width = PI * (1.0 - alpha) / alpha;
    let v = |y: f64| y + (y / width).asinh();
    let reach = LEAST_SHARE / alpha;
    let [first, last] = [(slowest - LEAST_SHARE).clamp(-reach, -1.0), (fastest + LEAST_SHARE).clamp(1.0, reach)];
    let spacing = SPACING;
    let y = |v_k: f64| {
        // Newton's steps from the side of 0, where v is steepest, do not pass the root
        let mut y = v_k * width / (1.0 + width);
        for _ in 0..60 {
            let step = (v(y) - v_k) / (1.0 + 1.0 / y.hypot(width));
            y -= step;
            if step.abs() <= 1e-15 * y.abs() {
                break;
            }
        }
        y
    };
    let [from, to] = [first, last].map(|end| (v(end) / spacing).round() as i64);
    let node = |k: i64| {
        let y = y(k as f64 * spacing);
        (y, spacing / (1.0 + 1.0 / y.hypot(width)))
    };
    let is_felt = |&(y, h): &(f64, f64)| h * fractional_density(alpha, y) > LEAST_WEIGHT;
    let mut at: Vec<(f64, f64)> = (from..=to).map(node).collect();
    // the ends are kept: the area beyond them is known
    let [first, last] = [at[0], at[at.len() - 1]];
    at.retain(|node| is_felt(node) || *node == first || *node == last);
    let below = |limit: f64| at.partition_point(|(y, _)| *y < limit);
    let peak = below(-PEAK)..below(PEAK);
    let merged = peak.len().saturating_sub(1);
    let inside = [slowest, fastest].map(|limit| {
        let node = below(limit);
        if node >= peak.end { node - merged } else { node.min(peak.start) }
    });
    Nodes { at, inside, peak }
}
#[cfg(test)]
mod tests {
    use super::*;
    use viscocontact::rheology::{FractionalZener, Rheology};

    #[test]
    fn powers_of_time_are_sums_of_exponentials() {
        for alpha in [1e-6, 0.05, 0.2, 0.5, 0.8, 0.999_999] {
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

    /// The Mittag-Leffler function of the main crate is another algorithm: 1 + [1 − E_α(−t^α)] is the compliance of unit moduli.
    #[test]
    fn the_fractional_solid_is_the_mittag_leffler_function_at_any_exponent() {
        for alpha in [1e-9, 1e-5, 1e-3, 0.01, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999, 1.0 - 1e-9] {
            let exact = FractionalZener::new(1.0, 1.0, 1.0, alpha).unwrap();
            for tau in [1e-4, 0.3, 50.0, 1e5] {
                let prony = Model::FractionalZener.prony(&[2.0, 1.0, tau, alpha], [1e-3, 100.0]).unwrap();
                assert!(prony.moduli.len() < 100, "{alpha}: {} terms", prony.moduli.len());
                for t in [1e-3, 0.1, 2.0, 50.0, 100.0] {
                    let exact = 3.0 - exact.creep_compliance(t / tau);
                    let error = (prony.modulus(t) / exact - 1.0).abs();
                    assert!(error < 1e-6, "α = {alpha}, τ = {tau}, t = {t}: {} {exact}", prony.modulus(t));
                }
            }
        }
    }

    #[test]
    fn refuses_moduli_that_rise() {
        assert!(Model::Zener.prony(&[1.0, 2.0, 1.0], [0.1, 1.0]).is_err());
        assert!(Model::Zener.prony(&[1.0, 0.5], [0.1, 1.0]).is_err());
        assert!(Model::PowerLaw { cutoff: 1e-3 }.prony(&[1.0, 1.0], [0.1, 1.0]).is_err());
    }
}
