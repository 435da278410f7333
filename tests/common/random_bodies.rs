//! Bodies of every rheology, drawn at random: times over many decades, creep by factors of 1 to 100 000.

use viscocontact::prelude::*;

use super::draws::Draws;

/// A body, and a duration over which it shows what it is.
pub struct Body {
    pub name: &'static str,
    pub material: Material,
    /// Duration of a run \[s\].
    pub until: f64,
}

impl Body {
    /// Whether the body answers a jump of the load at once.
    pub fn is_elastic_at_once(&self) -> bool {
        self.material.contact_compliance(0.0) > 0.0
    }

    /// The shortest of its times \[s\], at most the duration of a run.
    pub fn shortest_time(&self) -> f64 {
        let creep = self.material.contact_spectrum().unwrap().unwrap();
        let relaxation = creep.relaxation();
        let times = creep.terms().iter().chain(relaxation.terms()).map(|term| term.1);
        times.fold(self.until, f64::min)
    }

    /// Compliance in the end over that at first, or over that after a millionth of the run.
    pub fn creep_ratio(&self) -> f64 {
        let compliance = |t: f64| self.material.contact_compliance(t);
        let first = if self.is_elastic_at_once() { 0.0 } else { 1e-6 * self.until };
        compliance(self.until) / compliance(first)
    }
}

/// Terms of (weight, time), the weights adding up to 1, the times over so many decades from `first`.
pub(super) fn terms(draws: &mut Draws, count: usize, first: f64, decades: f64) -> Vec<(f64, f64)> {
    let weights: Vec<f64> = (0..count).map(|_| draws.power_of_ten(-1.0, 1.0)).collect();
    let sum: f64 = weights.iter().sum();
    let time = |k: usize, off: f64| first * 10f64.powf(decades * (k as f64 + off) / count as f64);
    weights.iter().enumerate().map(|(k, weight)| (weight / sum, time(k, draws.between(0.1, 0.9)))).collect()
}

/// The body with a series in place of a formula, fitted once for all runs; less closely where that misses by a hair.
fn fitted(rheology: impl Rheology + 'static, until: f64) -> Material {
    let body = Material::incompressible(rheology);
    let fit = |tolerance: f64| body.fitted(1e-6 * until..=until, tolerance);
    fit(1e-4).or_else(|_| fit(3e-4)).unwrap()
}

/// A body whose times span twenty decades, and a duration anywhere among them.
pub fn body_of_twenty_decades(draws: &mut Draws) -> Body {
    let terms: Vec<(f64, f64)> = (-10..=10).map(|k| (draws.power_of_ten(4.0, 5.0), 10f64.powi(k))).collect();
    let equilibrium = if draws.chance(0.5) { 0.0 } else { 1.0e3 };
    let material = Material::incompressible(GeneralizedMaxwell::new(equilibrium, &terms).unwrap());
    Body { name: "twenty decades", material, until: draws.power_of_ten(-9.0, 9.0) }
}

pub fn random_body(draws: &mut Draws) -> Body {
    let (g, tau) = (draws.power_of_ten(5.0, 7.0), draws.power_of_ten(-3.0, 3.0));
    // how often J(0) is contained in J in the end, and in the part that creeps
    let ratio = draws.power_of_ten(0.0, 5.0).max(1.01);
    let creep = (ratio - 1.0) / g;
    let many_times = |draws: &mut Draws| {
        let (count, decades) = (1 + draws.below(20), draws.between(0.0, 8.0));
        let terms = terms(draws, count, tau, decades);
        (terms, tau * draws.power_of_ten(-1.0, decades + 1.0))
    };
    let some = |rheology: Box<dyn Rheology>| Material::incompressible(rheology);
    let kelvin_voigt = |part: f64| (g / (part * (ratio - 1.0)), g / (part * (ratio - 1.0)) * tau);
    let (name, material, until) = match draws.below(17) {
        0 => ("elastic", some(Box::new(Elastic::new(g).unwrap())), tau),
        1 => {
            let until = tau * draws.power_of_ten(-2.0, 5.0);
            ("Maxwell", some(Box::new(Maxwell::new(g, g * tau).unwrap())), until)
        }
        2 => {
            let until = tau * draws.power_of_ten(-2.0, 4.0);
            ("Kelvin-Voigt", some(Box::new(KelvinVoigt::new(g, g * tau).unwrap())), until)
        }
        3 => {
            let ((g_k, eta_k), until) = (kelvin_voigt(1.0), tau * draws.power_of_ten(-2.0, 6.0));
            ("Zener", some(Box::new(Zener::new(g, g_k, eta_k).unwrap())), until)
        }
        4 => {
            let ((g_k, eta_k), until) = (kelvin_voigt(0.5), tau * draws.power_of_ten(-2.0, 6.0));
            ("Burgers", some(Box::new(Burgers::new(g, 2.0 * until / creep, g_k, eta_k).unwrap())), until)
        }
        5 | 6 => {
            let (mut terms, until) = many_times(draws);
            terms.iter_mut().for_each(|term| term.0 *= creep);
            ("generalized Kelvin", some(Box::new(GeneralizedKelvin::new(1.0 / g, 0.0, &terms).unwrap())), until)
        }
        7 => {
            let until = tau * draws.power_of_ten(-2.0, 4.0);
            let (count, fluidity) = (1 + draws.below(4), draws.power_of_ten(-3.0, 1.0) / (g * tau));
            let mut terms = terms(draws, count, tau, 2.0);
            terms.iter_mut().for_each(|term| term.0 /= g);
            ("Jeffreys", some(Box::new(GeneralizedKelvin::new(0.0, fluidity, &terms).unwrap())), until)
        }
        8 | 9 => {
            let (mut terms, until) = many_times(draws);
            terms.iter_mut().for_each(|term| term.0 *= g);
            let equilibrium = if draws.chance(0.3) { 0.0 } else { g / (ratio - 1.0) };
            ("generalized Maxwell", some(Box::new(GeneralizedMaxwell::new(equilibrium, &terms).unwrap())), until)
        }
        10 => {
            let (until, order) = (tau * draws.power_of_ten(-2.0, 4.0), draws.between(0.2, 0.9));
            ("fractional Zener", fitted(FractionalZener::new(g, 1.0 / creep, tau, order).unwrap(), until), until)
        }
        11 => {
            let order = draws.between(0.1, 0.9);
            let findley = FractionalMaxwell::findley(1.0 / g, creep / tau.powf(order), order).unwrap();
            ("fractional Maxwell", fitted(findley, tau), tau)
        }
        12 => {
            let order = draws.between(0.1, 0.8);
            ("springpot", fitted(PowerLaw::new(1.0 / g, tau, order).unwrap(), tau), tau)
        }
        13 => {
            let (until, exponent) = (tau * draws.power_of_ten(-2.0, 3.0), draws.between(0.3, 1.0));
            ("KWW", fitted(Kww::new(1.0 / g, creep, tau, exponent).unwrap(), until), until)
        }
        14 => {
            let until = tau * draws.power_of_ten(-1.0, 5.0);
            let strength = creep / (until / tau).ln_1p();
            if draws.chance(0.5) {
                ("logarithmic creep", fitted(LogCreep::new(1.0 / g, strength, tau).unwrap(), until), until)
            } else {
                let slow = SlowCreep::new(1.0 / g, strength, tau, draws.between(0.2, 0.9)).unwrap();
                ("slow creep", fitted(slow, until), until)
            }
        }
        15 => {
            let order = draws.between(0.2, 0.8);
            let times: Vec<f64> = (0..25).map(|k| tau * 10f64.powf((f64::from(k) - 24.0) / 4.0)).collect();
            let values: Vec<f64> = times.iter().map(|t| 1.0 / g + creep * (t / tau).powf(order)).collect();
            (
                "measured creep",
                some(Box::new(
                    Measurements::creep(&crate::pairs(&times, &values)).and_then(|table| table.fit()).unwrap(),
                )),
                tau,
            )
        }
        _ => {
            let ((g_k, eta_k), until) = (kelvin_voigt(1.0), tau * draws.power_of_ten(-1.0, 4.0));
            let zener = Zener::new(g, g_k, eta_k).unwrap();
            if draws.chance(0.5) {
                ("elastic bulk", Material::elastic_bulk(zener, g * draws.power_of_ten(0.0, 2.0)).unwrap(), until)
            } else {
                let other =
                    Material::incompressible(Maxwell::new(g, g * draws.power_of_ten(-1.0, 1.0) * until).unwrap());
                ("two bodies", Material::incompressible(zener).against(other), until)
            }
        }
    };
    Body { name, material, until }
}
