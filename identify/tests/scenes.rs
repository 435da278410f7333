//! Random materials, tips and protocols.

use std::sync::{Arc, OnceLock};

use viscocontact::prelude::*;
use viscocontact_identify::{Experiment, Identification, Model, Nuisance, Protocol};

use crate::random::{choice, generator, logarithmic, uniform};

/// An experiment on a material.
pub struct Scene {
    pub experiment: Experiment,
    pub identification: Identification,
    pub truth: Vec<(String, f64)>,
    pub contact_point: f64,
    /// Depth of the drive beyond the contact point \[m\].
    pub depth: f64,
}

impl Scene {
    /// Parameters of the material by name.
    pub fn named(&self) -> Vec<(&str, f64)> {
        self.truth.iter().map(|(name, value)| (name.as_str(), *value)).collect()
    }
}

/// A ball on an elastic layer that is bonded to a rigid base: its states are swept once.
fn layer() -> Arc<ElasticStates> {
    static STATES: OnceLock<Arc<ElasticStates>> = OnceLock::new();
    let sweep = || {
        let grid = Grid::square(48, 10e-6).unwrap();
        let layer = Layer::bonded_to_rigid(2e-6, 0.49).unwrap();
        let kernel = InfluenceKernel::layer(&grid, layer).unwrap();
        Sweep::new(grid, &Sphere::new(5e-6).unwrap()).kernel(kernel).run(Reach::Approach(1e-6)).unwrap()
    };
    Arc::clone(STATES.get_or_init(sweep))
}

/// A random scene: a tip of a few micrometres, pressed, held, and often retracted.
pub fn scene(seed: u64) -> Scene {
    let rng = &mut generator(seed);
    let tip = match choice(rng, &[0, 1, 2, 3, 4]) {
        0 => ElasticStates::sphere(logarithmic(rng, [1e-6, 20e-6])).unwrap(),
        1 => ElasticStates::cone(uniform(rng, [0.2, 3.0])).unwrap(),
        2 => ElasticStates::punch(logarithmic(rng, [1e-6, 10e-6])).unwrap(),
        3 => ElasticStates::power(1e3, 1.5).unwrap(),
        _ => layer(),
    };
    let duration = logarithmic(rng, [1e-2, 1e3]);
    let count = choice(rng, &[200, 400, 1000]);
    let depth = uniform(rng, [0.2e-6, 0.7e-6]);
    // rise, hold, fall: shares of the duration
    let rise = uniform(rng, [0.05, 0.4]);
    let hold = if choice(rng, &[true, false]) { uniform(rng, [0.1, 0.5]) } else { 0.0 };
    let fall = if choice(rng, &[true, true, false]) { uniform(rng, [0.05, 0.4]) } else { f64::INFINITY };
    let contact_point = choice(rng, &[0.0, 0.3 * depth]);
    let times: Vec<f64> = (0..=count).map(|k| duration * f64::from(k) / f64::from(count)).collect();
    let at = |t: f64| {
        let x = t / duration;
        let top = depth + contact_point;
        (x / rise).min(1.0).min(1.0 - (x - rise - hold).max(0.0) / fall) * top
    };
    let drive = times.iter().map(|&t| at(t)).collect();
    let experiment = Experiment::new(Protocol::new(times, drive).unwrap(), tip);
    let modulus = logarithmic(rng, [1e2, 1e9]);
    let ratio = uniform(rng, [0.1, 0.7]);
    let tau = duration * logarithmic(rng, [0.02, 0.4]);
    let (model, values) = match choice(rng, &[0, 1, 2, 2, 3, 4, 5]) {
        0 => (Model::Elastic, vec![modulus]),
        1 => (Model::Maxwell, vec![modulus, tau]),
        2 => (Model::Zener, vec![modulus, ratio * modulus, tau]),
        3 => {
            let (first, second) = (0.4 * modulus, 0.3 * modulus);
            (Model::Prony(2), vec![ratio * modulus, first, 0.1 * tau, second, tau])
        }
        4 => {
            let cutoff = 1e-3 * duration / f64::from(count);
            (Model::PowerLaw { cutoff }, vec![modulus, uniform(rng, [0.05, 0.6])])
        }
        _ => (Model::FractionalZener, vec![modulus, ratio * modulus, tau, uniform(rng, [0.3, 0.8])]),
    };
    let mut identification = Identification::new(model);
    identification = match choice(rng, &[true, false]) {
        true => identification.contact_point(Nuisance::Fitted),
        false => identification.contact_point(Nuisance::Fixed(contact_point)),
    };
    let experiment = match choice(rng, &[true, false]) {
        // as stiff as the contact, within a decade
        true => {
            let level = experiment.tip().level_at(experiment.tip().approach(0.0) + depth);
            let stiffness = modulus * level / depth * logarithmic(rng, [0.3, 10.0]);
            experiment.with_spring(stiffness).unwrap()
        }
        false => experiment,
    };
    let truth = model.parameters().into_iter().zip(values).collect();
    Scene { experiment, identification, truth, contact_point, depth }
}
