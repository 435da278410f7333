//! Bodies that slide under a motion which slows down stick again as soon as it is slower than they creep: in a step that
//! slides on in its mean, and in both of its halves. Forces of adaptive runs against many times finer steps of given ends.

use viscocontact::friction::{Coulomb, FrictionContact, ShearHistory};
use viscocontact::prelude::*;
use viscocontact::run::Contact;
use viscocontact::states::{ElasticStates, StatesContact};

use crate::common::{Draws, Ratios, from_environment};

const UNTIL: f64 = 2.5;

/// A motion, or the drive of a spring, that turns once.
#[derive(Debug, Clone)]
struct Swing {
    most: f64,
    spring: Option<f64>,
}

impl LoadHistory for Swing {
    fn at(&self, t: f64) -> Load {
        let here = self.most * t.sin();
        self.spring.map_or(Load::approach(here), |stiffness| Load::spring(stiffness, here))
    }
}

/// A body that flows, or creeps to four times its compliance; how far it swings, the force on it, and a stiffness.
fn drawn(draws: &mut Draws, poisson: f64) -> (Material, f64, f64, f64) {
    let time = draws.scale(0.2, 5.0);
    let body = if draws.chance(0.7) {
        Material::constant_poisson(Maxwell::new(1.0, time).unwrap(), poisson)
    } else {
        Material::constant_poisson(Zener::with_time(0.3, 1.0, time).unwrap(), poisson)
    };
    (body.unwrap(), draws.scale(0.02, 0.2), draws.scale(1e-3, 1e-2), draws.scale(0.05, 1.0))
}

/// True over asked of the force along the surface, of its maximum, at 200 times, and the steps.
fn over_asked<C: Contact>(
    contact: &C,
    force: f64,
    (tolerance, finer, parts): (f64, f64, u32),
    along: impl Fn(&C) -> f64,
) -> (f64, u64) {
    let pressed = StepLoad::new(Load::force(force)).unwrap();
    let times: Vec<f64> = (1..=200).map(|k| UNTIL * (f64::from(k) - 0.37) / 200.0).collect();
    let run = |tolerance: f64, stops: Vec<f64>| {
        let mut run = contact.clone().into_follow(pressed, Stepping::adaptive(tolerance), UNTIL);
        run = run.stop_at(stops).unwrap().sample_at(times.clone()).unwrap();
        let mut found = Vec::new();
        while run.next_step().unwrap().is_some() {
            let samples = run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for());
            found.extend(samples.map(|sample| along(sample.contact())));
        }
        (found, run.progress().steps)
    };
    let stops = (1..parts).map(|k| UNTIL * f64::from(k) / f64::from(parts)).collect();
    let ((found, steps), (exact, _)) = (run(tolerance, vec![]), run(finer * tolerance, stops));
    assert_eq!([found.len(), exact.len()], [times.len(); 2]);
    let most = exact.iter().fold(0.0f64, |most, force| most.max(force.abs()));
    let off = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    (off / most / tolerance, steps)
}

#[test]
fn on_states() {
    let mut ratios = Ratios::default();
    for seed in 0..from_environment("STICK_AGAIN", 8) {
        let draws = &mut Draws::new(seed);
        let (body, most, force, stiffness) = drawn(draws, 0.0);
        let swing = Swing { most, spring: draws.chance(0.3).then_some(stiffness) };
        let contact = StatesContact::new(&ElasticStates::sphere(1.0).unwrap(), &body).unwrap();
        let contact = contact.with_estimated_friction(0.5).unwrap().sheared_by(swing).unwrap();
        let (ratio, steps) = over_asked(&contact, force, (1e-3, 0.1, 600), StatesContact::lateral_force);
        ratios.push(ratio, &format!("{seed}, {steps} steps"));
    }
    ratios.print("on states", 4);
    assert!(ratios.greatest() < 2.0);
}

#[test]
fn in_space() {
    let mut ratios = Ratios::default();
    for seed in 0..from_environment("STICK_AGAIN", 8) {
        let draws = &mut Draws::new(seed);
        let (body, most, force, _) = drawn(draws, 0.5);
        let angle = draws.between(0.0, 2.0);
        let [x1, x2] = [f64::cos(angle), f64::sin(angle)];
        let [first, second] = [x1, x2].map(|part| Swing { most: part * most, spring: None });
        let builder = ViscoelasticContact::builder(Grid::square(16, 1.0).unwrap())
            .geometry(&Sphere::new(1.0).unwrap())
            .material(body)
            .settings(Settings::default().with_edge(Edge::Allow));
        let contact = FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap();
        let contact = contact.sheared_by(ShearHistory::new(first, second));
        let along = |contact: &FrictionContact| x1 * contact.force()[0] + x2 * contact.force()[1];
        let (ratio, steps) = over_asked(&contact, force, (3e-3, 0.3, 200), along);
        ratios.push(ratio, &format!("{seed}, {steps} steps"));
    }
    ratios.print("in space", 4);
    assert!(ratios.greatest() < 2.0);
}
