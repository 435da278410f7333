//! The relaxation of a model as a sum of exponentials.

use std::f64::consts::PI;

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;
use viscocontact::numeric::non_negative_least_squares;
use viscocontact::rheology::{CreepSpectrum, Material, RelaxationSpectrum, Rheology};
use viscocontact::states::ElasticStates;

use crate::error::{Result, same_length, within};
use crate::fractional::spectrum;
use crate::model::Model;

/// Spacing of the logarithms of the rates: sums of such exponentials are within 1e-6 of smooth relaxation.
const SPACING: f64 = 0.55;
/// Least rate times the longest time, and maximum rate times the shortest.
const RATES: [f64; 2] = [0.5, 20.0];
/// A narrow peak of a spectrum has twice as many rates up to so many halves of the spacing from it.
const PEAK: i64 = 4;
/// First time at which sums and laws agree, over the shortest; two last exponentials have the integral of the law before.
const FIRST: f64 = 0.5;
/// The lesser rate of the last two, over the largest other one.
const LAST: f64 = 10.0;
/// Weight of the moduli, which makes those without effect small.
const RIDGE: f64 = 1e-8;
/// E(t).
type Relaxation = Box<dyn Fn(f64) -> f64>;

/// A sum of exponentials: E(t) = Σ Ek exp(−t ratek). A rate of 0 is the equilibrium modulus.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Prony<T = f64> {
    pub(crate) moduli: Vec<T>,
    pub(crate) rates: Vec<T>,
}

impl Prony {
    /// From pairs of modulus and rate.
    fn of(terms: impl IntoIterator<Item = (f64, f64)>) -> Prony {
        let (moduli, rates) = terms.into_iter().unzip();
        Prony { moduli, rates }
    }

    /// Itself, unless its law is not finite: for values that are no steps of a search.
    pub(crate) fn finite(self) -> Result<Prony> {
        let allowed = "finite at all times from t = 0 on";
        let endless = self.moduli.iter().copied().find(|modulus| !modulus.is_finite());
        within("modulus of the law", endless.unwrap_or_default(), true, allowed).map(|_| self)
    }

    /// E(t).
    pub(crate) fn modulus(&self, t: f64) -> f64 {
        self.moduli.iter().zip(&self.rates).map(|(modulus, rate)| modulus * (-t * rate).exp()).sum()
    }

    /// ∫ E dt from 0 to a time.
    fn integral(&self, t: f64) -> f64 {
        let of = |(modulus, rate): (&f64, &f64)| modulus * if *rate == 0.0 { t } else { -(-t * rate).exp_m1() / rate };
        self.moduli.iter().zip(&self.rates).map(of).sum()
    }

    /// The same relaxation with moduli of zero or more.
    pub(crate) fn positive(&self) -> Prony {
        if self.moduli.iter().all(|modulus| *modulus >= 0.0) {
            return self.clone();
        }
        // without equilibrium and the last two
        let rates = &self.rates[1..self.rates.len() - 2];
        let times = times([FIRST * RATES[1] / rates[rates.len() - 1], 1.0 / rates[0]], 3 * rates.len());
        let entry = |row: usize, column: usize| (-times[row] * self.rates[column]).exp() / self.modulus(times[row]);
        let moduli = non_negative_least_squares(&vec![1.0; times.len()], self.rates.len(), entry);
        Prony { moduli, rates: self.rates.clone() }
    }

    /// The material of this contact modulus and Poisson's ratio, against a rigid tip, measured between two times.
    pub(crate) fn material(&self, poisson: f64, measured: [f64; 2]) -> Result<Material> {
        // E* = 2G/(1 − ν)
        let (shear, positive) = (0.5 * (1.0 - poisson), self.positive());
        let pairs = positive.moduli.iter().zip(&positive.rates).filter(|(modulus, _)| **modulus > 0.0);
        let (equilibria, relaxing): (Vec<_>, Vec<_>) = pairs.partition(|(_, rate)| **rate == 0.0);
        let equilibrium = shear * equilibria.iter().map(|(modulus, _)| *modulus).sum::<f64>();
        let terms: Vec<(f64, f64)> = relaxing.iter().map(|(e, rate)| (shear * *e, 1.0 / *rate)).collect();
        let spectrum = RelaxationSpectrum::new(equilibrium, 0.0, &terms)?.creep();
        Ok(Material::constant_poisson(Measured { spectrum, times: measured }, poisson)?)
    }

    /// The material on elastic states: with the Poisson's ratio that they state, else incompressible.
    pub(crate) fn material_on(&self, states: &ElasticStates) -> Result<Material> {
        self.material(states.poisson_ratio().unwrap_or(0.5), [0.0, f64::INFINITY])
    }
}

/// The creep that data show between two times.
#[derive(Debug)]
struct Measured {
    spectrum: CreepSpectrum,
    times: [f64; 2],
}

impl Rheology for Measured {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.spectrum.compliance(t)
    }

    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        Some(self.spectrum.clone())
    }

    fn measured(&self) -> [f64; 2] {
        self.times
    }
}

/// Times between two, at equal distances of their logarithms.
pub(crate) fn times([first, last]: [f64; 2], count: usize) -> Vec<f64> {
    (0..count).map(|k| first * (last / first).powf(k as f64 / (count - 1) as f64)).collect()
}

impl Model {
    /// The exponentials of the model for data between two times \[s\].
    pub(crate) fn prony(&self, parameters: &[f64], window: [f64; 2]) -> Result<Prony> {
        Ok(self.sums(&[parameters.to_vec()], window)?.swap_remove(0))
    }

    /// Whether the first parameters are E0 and Einf.
    pub(crate) fn has_equilibrium(&self) -> bool {
        self.parameters().starts_with(&["E0".into(), "Einf".into()])
    }

    /// Refuses parameters outside their ranges.
    fn check(&self, parameters: &[f64]) -> Result<()> {
        let names = self.parameters();
        same_length("parameters", parameters.len(), names.len())?;
        for (name, &value) in names.iter().zip(parameters) {
            Model::scale(name).check(name, value)?;
        }
        if self.has_equilibrium() {
            within("Einf", parameters[1], parameters[1] <= parameters[0], "at most E0")?;
        }
        self.check_cutoff()
    }

    /// The exponentials of some parameters, of which all are near the first: as many for each.
    pub(crate) fn sums(&self, all: &[Vec<f64>], window: [f64; 2]) -> Result<Vec<Prony>> {
        self.check(&all[0])?;
        let times = [FIRST * window[0], window[1]];
        let sum = |of: &Vec<f64>| match (*self, of.as_slice()) {
            (Model::Elastic, &[e]) => Prony::of([(e, 0.0)]),
            (Model::Maxwell, &[e0, tau]) => Prony::of([(e0, 1.0 / tau)]),
            (Model::Zener, &[e0, einf, tau]) => Prony::of([(einf, 0.0), (e0 - einf, 1.0 / tau)]),
            (Model::Prony(_), [einf, terms @ ..]) => {
                let relaxing = terms.chunks_exact(2).map(|term| (term[0], 1.0 / term[1]));
                Prony::of(std::iter::once((*einf, 0.0)).chain(relaxing))
            }
            _ => {
                let rates = self.rates(of, &all[0], window);
                let (law, integral) = self.law(of, &rates, times[0]);
                nearest_sum(&rates, law, integral, times)
            }
        };
        Ok(all.iter().map(sum).collect())
    }

    /// E(t) of a model that is no sum of a few exponentials, between the times that some rates show, and its integral from 0 to the `first` time.
    fn law(&self, parameters: &[f64], rates: &[f64], first: f64) -> (Relaxation, f64) {
        let of = parameters.to_vec();
        let law: Relaxation = match *self {
            Model::PowerLaw { cutoff } | Model::PowerLawSolid { cutoff } => {
                let einf = of.get(2).copied().unwrap_or_default();
                Box::new(move |t| einf + of[0] * (t + cutoff).powf(-of[1]))
            }
            Model::Stretched => Box::new(move |t| of[1] + (of[0] - of[1]) * (-(t / of[2]).powf(of[3])).exp()),
            Model::FractionalZener => {
                let shown = [rates[0], rates[rates.len() - 1]].map(|rate| rate.ln() + of[2].ln());
                let (spectrum, relaxing) = (Prony::of(spectrum(of[3], shown)), of[0] - of[1]);
                let integral = of[1] * first + relaxing * (of[2] * spectrum.integral(first / of[2]));
                let relaxed = move |t: f64| if t == 0.0 { 1.0 } else { spectrum.modulus(t) };
                return (Box::new(move |t| of[1] + relaxing * relaxed(t / of[2])), integral);
            }
            Model::Custom(law) => Box::new(move |t| (law.modulus)(&of, t)),
            _ => Box::new(|_| f64::NAN),
        };
        let integral = integral(&law, first);
        (law, integral)
    }

    /// Rates at equal distances of their logarithms, of which one is the peak of the spectrum of a fractional element; as many as `near` has.
    fn rates(&self, parameters: &[f64], near: &[f64], [shortest, longest]: [f64; 2]) -> Vec<f64> {
        let [slowest, fastest] = [(RATES[0] / longest).ln(), (RATES[1] / shortest).ln()];
        let is_peaked = *self == Model::FractionalZener;
        let centre = |of: &[f64]| if is_peaked { -of[2].ln() } else { slowest };
        // the spectrum of an unknown law may have peaks anywhere
        let is_custom = matches!(self, Model::Custom(_));
        let [from, to] = [slowest, fastest].map(|end| (2.0 * (end - centre(near)) / SPACING).round() as i64);
        let is_rate = |k: &i64| k % 2 == 0 || is_custom || is_peaked && k.abs() < PEAK;
        (from..=to).filter(is_rate).map(|k| (centre(parameters) + 0.5 * SPACING * k as f64).exp()).collect()
    }
}

/// The sum of exponentials of given rates and an equilibrium that is nearest to a law, relative to the law. Two last terms have E(0) and the
/// integral of the law before the first time.
fn nearest_sum(rates: &[f64], law: Relaxation, integral: f64, [first, last]: [f64; 2]) -> Prony {
    let times = times([first, last], 2 * rates.len());
    let weights: Vec<f64> = times.iter().map(|&t| 1.0 / law(t)).collect();
    let columns = rates.len() + 1;
    let matrix = Mat::from_fn(times.len() + columns, columns, |row, column| match times.get(row) {
        Some(_) if column == 0 => weights[row],
        Some(t) => weights[row] * (-t * rates[column - 1]).exp(),
        None if row - times.len() == column => RIDGE * weights[0],
        None => 0.0,
    });
    let right = Mat::from_fn(matrix.nrows(), 1, |row, _| f64::from(u8::from(row < times.len())));
    let solved = matrix.qr().solve_lstsq(&right);
    let mut sum =
        Prony::of((0..columns).map(|row| solved[(row, 0)]).zip(std::iter::once(0.0).chain(rates.iter().copied())));
    let (integral, instant) = (integral - sum.integral(first), law(0.0) - sum.modulus(0.0));
    let slow = LAST * rates[rates.len() - 1];
    // one modulus alone has both, if its rate is fast enough
    let fast = Some(instant / integral).filter(|rate| rate.is_finite()).unwrap_or(0.0).max(2.0 * slow);
    let rest = slow * (integral - instant / fast) / (1.0 - slow / fast);
    sum.moduli.extend([rest, instant - rest]);
    sum.rates.extend([slow, fast]);
    sum
}

/// ∫ f dt from 0 to a time, where f may be steep at 0: by the rule of H. Takahasi & M. Mori (1974).
fn integral(f: impl Fn(f64) -> f64, end: f64) -> f64 {
    // a law may fall within a thousandth of the time, where neighbouring nodes differ by less than a factor of e
    let step = 0.075;
    let node = |k: i32| {
        let s = step * f64::from(k);
        let x = 1.0 / (1.0 + (PI * s.sinh()).exp());
        let weight = PI * s.cosh() * x * (1.0 - x);
        if weight > 0.0 { weight * f(x * end) } else { 0.0 }
    };
    (-40..=60).map(node).sum::<f64>() * step * end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Law;

    #[test]
    fn powers_of_time_are_sums_of_exponentials() {
        for alpha in [1e-6, 0.05, 0.2, 0.5, 0.8, 0.999_999] {
            let prony = Model::PowerLaw { cutoff: 1e-5 }.prony(&[3.0, alpha], [1e-3, 10.0]).unwrap();
            assert!(prony.moduli.len() < 35, "{}", prony.moduli.len());
            for t in [0.0, 1e-3, 0.02, 1.0, 10.0] {
                let exact = 3.0 * (t + 1e-5_f64).powf(-alpha);
                assert!((prony.modulus(t) / exact - 1.0).abs() < 1e-6, "alpha {alpha}, t {t}");
            }
            let terms = prony.moduli.iter().zip(&prony.rates);
            // over the first interval
            let found: f64 =
                terms.map(|(e, rate)| if *rate == 0.0 { 1e-3 * e } else { -e * (-1e-3 * rate).exp_m1() / rate }).sum();
            let exact = 3.0 * (1.01e-3_f64.powf(1.0 - alpha) - 1e-5_f64.powf(1.0 - alpha)) / (1.0 - alpha);
            assert!((found / exact - 1.0).abs() < 1e-6, "alpha {alpha}: {found} {exact}");
        }
    }

    #[test]
    fn stretched_and_custom_laws_are_sums_of_exponentials() {
        fn burgers(of: &[f64], t: f64) -> f64 {
            of[0] * (-t / of[1]).exp() + of[2] * (-t / of[3]).exp()
        }
        let custom = Law { name: "Burgers", parameters: &["E1", "tau1", "E2", "tau2"], modulus: burgers };
        let cases: [(Model, Vec<f64>, Relaxation); 3] = [
            (Model::Stretched, vec![3.0, 1.0, 0.3, 0.4], Box::new(|t| 1.0 + 2.0 * (-(t / 0.3).powf(0.4)).exp())),
            (
                Model::PowerLawSolid { cutoff: 1e-5 },
                vec![3.0, 0.4, 1.0],
                Box::new(|t| 1.0 + 3.0 * (t + 1e-5).powf(-0.4)),
            ),
            (
                Model::Custom(custom),
                vec![1.0, 0.1, 2.0, 20.0],
                Box::new(|t| (-t / 0.1).exp() + 2.0 * (-t / 20.0).exp()),
            ),
        ];
        for (model, parameters, exact) in cases {
            let prony = model.prony(&parameters, [1e-3, 10.0]).unwrap();
            for t in [1e-3, 0.02, 0.3, 1.0, 10.0] {
                assert!((prony.modulus(t) / exact(t) - 1.0).abs() < 1e-6, "{model:?} {t}");
            }
        }
    }

    #[test]
    fn moduli_are_positive_where_a_material_needs_them() {
        for alpha in [0.1, 0.5, 0.9, 0.99] {
            let prony = Model::FractionalZener.prony(&[3.0, 1.0, 0.1, alpha], [1e-3, 10.0]).unwrap();
            let positive = prony.positive();
            assert!(positive.moduli.iter().all(|modulus| *modulus >= 0.0));
            for t in [1e-3, 0.03, 1.0, 10.0] {
                assert!((positive.modulus(t) / prony.modulus(t) - 1.0).abs() < 1e-3, "{alpha} {t}");
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
