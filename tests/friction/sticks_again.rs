//! Bodies that slide under a motion which slows down stick again as soon as it is slower than they creep: in a step that
//! slides on, averaged over it, as both of its halves do. Forces of adaptive runs against many times finer steps of
//! prescribed ends.

use viscocontact::friction::{Coulomb, FrictionContact, ShearHistory};
use viscocontact::prelude::*;
use viscocontact::run::Contact;
use viscocontact::states::{ElasticStates, StatesContact};

use crate::common::{Draws, Ratios, from_environment};

const UNTIL: f64 = 2.5;

/// A load, motion or drive of a spring that swings about its mean, in time with s = `often` t + `phase`.
#[derive(Debug, Clone)]
struct Swing {
    mean: f64,
    most: f64,
    often: f64,
    phase: f64,
    load: fn(f64, f64) -> Load,
    spring: f64,
}

impl LoadHistory for Swing {
    fn at(&self, t: f64) -> Load {
        (self.load)(self.spring, self.mean + self.most * f64::sin(self.often * t + self.phase))
    }
}

/// What presses: a force that is held or swings, or an approach that is held.
fn normal(draws: &mut Draws) -> Swing {
    let force = draws.scale(1e-3, 1e-2);
    let held = Swing { mean: force, most: 0.0, often: 1.0, phase: 0.0, load: |_, size| Load::force(size), spring: 0.0 };
    match draws.below(4) {
        0 | 1 => held,
        2 => {
            let [often, phase] = [draws.between(0.5, 4.0), draws.between(0.0, 6.0)];
            Swing { most: force * draws.between(0.1, 0.9), often, phase, ..held }
        }
        _ => Swing { mean: draws.scale(5e-3, 3e-2), load: |_, size| Load::approach(size), ..held },
    }
}

/// What moves along the surface, from rest or from half a swing on.
fn along(draws: &mut Draws, spring: Option<f64>) -> Swing {
    let (most, often) = (draws.scale(0.02, 0.2), draws.scale(1.0, 4.0));
    let phase = if draws.chance(0.5) { 0.0 } else { draws.between(-1.5, 1.5) };
    let load = if spring.is_some() { Load::spring } else { |_, size| Load::approach(size) };
    Swing { mean: -most * phase.sin(), most, often, phase, load, spring: spring.unwrap_or(0.0) }
}

/// A body that flows, or creeps to four times its compliance.
fn body(draws: &mut Draws, poisson: f64) -> Material {
    let time = draws.scale(0.2, 5.0);
    let body = if draws.chance(0.7) {
        Material::constant_poisson(Maxwell::new(1.0, time).unwrap(), poisson)
    } else {
        Material::constant_poisson(Zener::with_time(0.3, 1.0, time).unwrap(), poisson)
    };
    body.unwrap()
}

/// True over asked of the force along the surface, of its maximum, at 200 times, the steps, and whether it slid and stuck
/// again.
fn over_asked<C: Contact>(
    contact: &C,
    pressed: &Swing,
    (tolerance, finer, parts): (f64, f64, u32),
    along: impl Fn(&C) -> f64,
) -> (f64, u64, bool) {
    let times: Vec<f64> = (1..=200).map(|k| UNTIL * (f64::from(k) - 0.37) / 200.0).collect();
    let run = |tolerance: f64, stops: Vec<f64>| {
        let mut run = contact.clone().into_follow(pressed.clone(), Stepping::adaptive(tolerance), UNTIL);
        run = run.stop_at(stops).unwrap().sample_at(times.clone()).unwrap();
        let (mut found, mut slid, mut again) = (Vec::new(), false, false);
        while run.next_step().unwrap().is_some() {
            let samples = run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for());
            found.extend(samples.map(|sample| along(sample.contact())));
            let slides = run.contact().slides();
            (again, slid) = (again || slid && !slides && !run.contact().is_separated(), slides);
        }
        (found, run.progress().steps, again)
    };
    let stops = (1..parts).map(|k| UNTIL * f64::from(k) / f64::from(parts)).collect();
    let ((found, steps, _), (exact, _, again)) = (run(tolerance, vec![]), run(finer * tolerance, stops));
    assert_eq!([found.len(), exact.len()], [times.len(); 2]);
    let most = exact.iter().fold(0.0f64, |most, force| most.max(force.abs()));
    let off = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).max_by(f64::total_cmp).unwrap();
    (off / most / tolerance, steps, again)
}

#[test]
fn on_states() {
    let (mut ratios, mut stuck_again) = (Ratios::default(), 0);
    for seed in 0..from_environment("STICK_AGAIN", 12) {
        let draws = &mut Draws::new(seed);
        let (body, pressed) = (body(draws, 0.0), normal(draws));
        let spring = draws.chance(0.3).then(|| draws.scale(0.05, 1.0));
        let swing = along(draws, spring);
        let contact = StatesContact::new(&ElasticStates::sphere(1.0).unwrap(), &body).unwrap();
        let contact = contact.with_estimated_friction(0.5).unwrap().sheared_by(swing).unwrap();
        let (ratio, steps, again) = over_asked(&contact, &pressed, (1e-3, 0.1, 600), StatesContact::lateral_force);
        stuck_again += usize::from(again);
        ratios.push(ratio, &format!("{seed}, {steps} steps"));
    }
    ratios.print("on states", 4);
    assert!(ratios.greatest() < 2.0 && 2 * stuck_again > ratios.count(), "{stuck_again}");
}

#[test]
fn in_space() {
    let (mut ratios, mut stuck_again) = (Ratios::default(), 0);
    for seed in 0..from_environment("STICK_AGAIN", 12) {
        let draws = &mut Draws::new(seed);
        let (body, pressed, swing) = (body(draws, 0.5), normal(draws), along(draws, None));
        let angle = draws.between(0.0, 2.0);
        let [x1, x2] = [f64::cos(angle), f64::sin(angle)];
        let [first, second] =
            [x1, x2].map(|part| Swing { mean: part * swing.mean, most: part * swing.most, ..swing.clone() });
        let grid = Grid::square(16, 1.0).unwrap();
        let mut builder = ViscoelasticContact::builder(grid.clone())
            .geometry(&Sphere::new(1.0).unwrap())
            .material(body)
            .settings(Settings::default().with_edge(Edge::Allow));
        let is_periodic = draws.chance(0.4);
        if is_periodic {
            builder = builder.kernel(InfluenceKernel::periodic(&grid).unwrap());
        }
        let contact = FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap();
        let contact = contact.sheared_by(ShearHistory::new(first, second));
        let along = |contact: &FrictionContact| x1 * contact.force()[0] + x2 * contact.force()[1];
        let (ratio, steps, again) = over_asked(&contact, &pressed, (3e-3, 0.3, 200), along);
        stuck_again += usize::from(again);
        ratios.push(ratio, &format!("{seed}, {steps} steps, periodic {is_periodic}"));
    }
    ratios.print("in space", 4);
    assert!(ratios.greatest() < 2.0 && 2 * stuck_again > ratios.count(), "{stuck_again}");
}
