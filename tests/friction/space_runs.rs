//! Runs of contacts with friction in space: true over asked, slip that begins, what a run does with too much load.

use std::f64::consts::PI;
use std::sync::Arc;

use viscocontact::friction::{Coulomb, FrictionContact, Outcome, ShearHistory, ShearLoad};
use viscocontact::prelude::*;
use viscocontact::states::{ElasticStates, StatesContact};

use super::dense::relaxation;
use super::runs::{Along, Kind, Scene, err_by_what_was_asked, kind_of};
use super::space::pair;
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::random_bodies::random_body;
use crate::common::random_histories::{Control, random_history};

const UNTIL: f64 = 4.0;

/// Forces between corners, of which the first acts at once.
fn ramps(values: &[f64], by_force: bool) -> PiecewiseLinear {
    let times = (0..values.len()).map(|k| UNTIL * k as f64 / (values.len() - 1) as f64);
    let load = |value: f64| if by_force { Load::force(value) } else { Load::approach(value) };
    let corners: Vec<_> = times.zip(values).map(|(time, value)| (time, load(*value))).collect();
    PiecewiseLinear::new(&corners).unwrap()
}

/// A contact that is pressed, and sheared by forces, forces and a torque, motions, or one of each.
fn scene(seed: u64) -> (FrictionContact, PiecewiseLinear) {
    let draws = &mut Draws::new(7000 + seed);
    let (nu, f) = ([0.0, 0.3, 0.5][draws.below(3)], draws.between(0.2, 1.0));
    let builder = ViscoelasticContact::builder(Grid::square(16, 1.0).unwrap())
        .geometry(&Sphere::new(draws.between(0.5, 2.0)).unwrap())
        .material(pair(&relaxation(draws.below(2)), nu))
        .settings(Settings::default().with_edge(Edge::Allow));
    let pressed: Vec<f64> = (0..4).map(|_| draws.between(0.02, 0.06)).collect();
    let holds = f * pressed.iter().fold(f64::INFINITY, |least: f64, force| least.min(*force));
    let mut values = |most: f64| -> Vec<f64> {
        (0..4).map(|k| if k == 0 { 0.0 } else { most * draws.between(-1.0, 1.0) }).collect()
    };
    let (forces, motions) =
        ([values(0.6 * holds), values(0.6 * holds)], [values(0.5 * f * 0.05), values(0.5 * f * 0.05)]);
    let twists = [values(0.05 * holds), values(0.2 * f)];
    let shear = match seed % 4 {
        0 => ShearHistory::new(ramps(&forces[0], true), ramps(&forces[1], true)),
        1 => ShearHistory::new(ramps(&forces[0], true), ramps(&forces[1], true)).with_twist(ramps(&twists[0], true)),
        2 => {
            ShearHistory::new(ramps(&motions[0], false), ramps(&motions[1], false)).with_twist(ramps(&twists[1], false))
        }
        _ => ShearHistory::new(ramps(&motions[0], false), ramps(&forces[1], true)),
    };
    (FrictionContact::new(builder, Coulomb::new(f).unwrap()).unwrap().sheared_by(shear), ramps(&pressed, true))
}

/// Motion, force, loss by slip and work.
type Seen = ([f64; 3], [f64; 3], [f64; 2]);

/// What is seen at times of a run, and its steps; angles times the square root of the contact area, torques
/// over it, and that of the last time.
fn course(seed: u64, tolerance: f64) -> (Vec<Seen>, u64) {
    let (contact, pressed) = scene(seed);
    let mut run =
        contact.into_follow(pressed, Stepping::adaptive(tolerance), UNTIL).sample_at(Times::every(0.25)).unwrap();
    let mut seen = Vec::new();
    while run.next_step().unwrap().is_some() {
        for sample in run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for()) {
            let contact = sample.contact();
            let (arm, [m1, m2, m3], [q1, q2, q3]) = (contact.contact_area().sqrt(), contact.motion(), contact.force());
            let work = contact.lateral_work();
            seen.push(([m1, m2, arm * m3], [q1, q2, q3 / arm], [work.slip, work.work]));
        }
    }
    (seen, run.progress().steps)
}

fn size([a, b, c]: [f64; 3]) -> f64 {
    a.hypot(b).hypot(c)
}

#[test]
fn errors_are_what_was_asked_for() {
    let (scenes, mut worst, mut over) = (from_environment("SHEARED_RUNS", 4), [0.0_f64; 4], 0);
    for seed in 0..scenes {
        let tolerance = [1e-2, 3e-3][((seed + seed / 4) % 2) as usize];
        let ((found, steps), (exact, _)) = (course(seed, tolerance), course(seed, 0.04 * tolerance));
        assert!(found.len() == exact.len() && found.len() == 16, "{}", found.len());
        let (mut off, mut largest) = ([0.0_f64; 4], [0.0_f64; 4]);
        for ((m, q, works), (exact_m, exact_q, exact_works)) in found.into_iter().zip(exact) {
            let apart = |one: [f64; 3], other: [f64; 3]| size([0, 1, 2].map(|k| one[k] - other[k]));
            let [lost, work] = [0, 1].map(|k| (works[k] - exact_works[k]).abs());
            let own = [apart(m, exact_m), apart(q, exact_q), lost, work];
            let sizes = [size(exact_m), size(exact_q), exact_works[0].abs(), exact_works[1].abs()];
            (0..4).for_each(|k| (off[k], largest[k]) = (off[k].max(own[k]), largest[k].max(sizes[k])));
        }
        // what hardly slips loses nothing
        largest[2] = largest[2].max(0.1 * largest[3]);
        let ratios = [0, 1, 2, 3].map(|k| off[k] / (largest[k] * tolerance));
        println!("{seed}: {tolerance:.0e} in {steps} steps: {ratios:.2?}");
        over += usize::from(ratios.iter().any(|ratio| *ratio > 2.0));
        (0..4).for_each(|k| worst[k] = worst[k].max(ratios[k]));
    }
    println!("{scenes} runs, {over} over 2: motion, force, loss, work, true over asked {worst:.2?}");
    assert!(over == 0 && worst.iter().all(|ratio| *ratio > 1e-3), "{worst:?}");
}

/// A random body and any two histories, on cells.
fn random(seed: u64) -> Option<Scene<FrictionContact>> {
    let draws = &mut Draws::new(seed);
    let tolerance = [1e-2, 3e-3][draws.below(2)];
    let body = random_body(draws);
    if !body.is_elastic_at_once() {
        return None;
    }
    let (depth, friction, until): (f64, f64, f64) = (0.05, draws.between(0.1, 0.9), body.until);
    let (shape, curved): (Box<dyn Geometry>, f64) = match draws.below(3) {
        0 => (Box::new(Sphere::new(1.0).unwrap()), 4.0 / 3.0 * depth.powf(1.5)),
        1 => (Box::new(Cone::new(0.2).unwrap()), 2.0 / PI * depth * depth / 0.2),
        _ => (Box::new(Cylinder::new(1.0).unwrap()), 0.25 * PI * depth),
    };
    let force = curved / body.material.contact_compliance(until);
    let control = match draws.below(3) {
        0 => Control::Force(force),
        1 => Control::Approach { touch: 0.0, depth },
        _ => Control::by_spring(draws, 0.0, depth, force),
    };
    let normal = random_history(draws, control, until, true);
    let history: Arc<dyn LoadHistory> = Arc::from(normal.history);
    let mut corners = normal.corners;
    let mut name = format!("{seed}: {}, {}, {tolerance:.0e};", body.name, normal.name);
    let mut along = |far: f64, may_push: bool| {
        let part = random_history(draws, Control::Approach { touch: -0.4, depth: 1.3 }, until, true);
        corners.extend(part.corners);
        let kind = if may_push && draws.chance(0.5) {
            Kind::Force(Arc::clone(&history), 0.67 * friction)
        } else {
            Kind::Motion(far * draws.scale(0.1, 3.0))
        };
        name += &format!(" {} {}", part.name, kind_of(&kind));
        Along { part: Arc::from(part.history), kind }
    };
    let pushes = matches!(control, Control::Force(_));
    let [first, second] = [0, 1].map(|_| along(friction * depth, pushes));
    let shear = ShearHistory::new(first, second);
    let grid = Grid::square(12, 1.0).unwrap();
    let mut builder = ViscoelasticContact::builder(grid.clone())
        .geometry(&*shape)
        .material(body.material)
        .settings(Settings::default().with_edge(Edge::Allow));
    if draws.chance(0.4) {
        builder = builder.kernel(InfluenceKernel::periodic(&grid).unwrap());
        name += ", periodic";
    }
    let contact = match FrictionContact::new(builder, Coulomb::new(friction).unwrap()) {
        Err(error) if error.code() == "friction_other_bodies" => return None,
        contact => contact.unwrap().sheared_by(shear),
    };
    corners.retain(|corner| *corner > 0.0 && *corner < until);
    Some(Scene { name, until, contact, normal: history, corners, tolerance })
}

#[test]
fn any_loads_err_by_what_was_asked() {
    let seen = |contact: &FrictionContact| {
        let ([m1, m2, _], [q1, q2, _], work) = (contact.motion(), contact.force(), contact.lateral_work());
        [m1 + 0.5 * m2, q1 + 0.5 * q2, work.slip, work.work]
    };
    err_by_what_was_asked([4, 0], random, seen);
}

#[test]
fn runs_follow_jumps_and_say_when_bodies_slide() {
    let builder = || {
        ViscoelasticContact::builder(Grid::square(16, 1.0).unwrap())
            .geometry(&Sphere::new(1.0).unwrap())
            .material(pair(&relaxation(0), 0.0))
    };
    let still = StepLoad::new(Load::force(0.0)).unwrap();
    let contact = || FrictionContact::new(builder(), Coulomb::new(0.5).unwrap()).unwrap();
    let pressed = StepLoad::new(Load::force(0.04)).unwrap();
    // a jump of both at once is one step of oblique loading: all of it sticks
    let jump = ShearHistory::new(StepLoad::new(Load::force(0.012)).unwrap(), still);
    let mut run = contact().sheared_by(jump).into_follow(pressed, Stepping::fixed(0.5), 1.0);
    run.next_step().unwrap().unwrap();
    assert_eq!(run.contact().stick_cells(), run.contact().normal().contact_cells());
    while run.next_step().unwrap().is_some() {}
    let mut by_steps = contact();
    for dt in [0.0, 0.5, 0.5] {
        let outcome = by_steps.step(dt, Load::force(0.04), ShearLoad::force([0.012, 0.0])).unwrap();
        assert!(matches!(outcome, Outcome::Holds(_)));
    }
    assert_eq!(run.contact().motion(), by_steps.motion());
    // the force grows to 1.2 of what friction carries
    let ramp = Ramp::new(Load::force(0.0), Load::force(0.024), 1.2).unwrap();
    let run = contact().sheared_by(ShearHistory::new(ramp, still)).into_follow(pressed, Stepping::adaptive(1e-2), 2.0);
    let mut run = run.stop_when(|contact| contact.load_share(), Crossing::Up(0.9)).unwrap();
    let error = loop {
        match run.next_step() {
            Ok(step) => assert!(step.is_some()),
            Err(error) => break error,
        }
    };
    assert!((run.events()[0].times()[0] - 0.9).abs() < 1e-2);
    // steps grow shorter towards the load that is too much
    assert!(matches!(error, Error::Slides { time, .. } if (time - 1.0).abs() < 2e-3), "{error}");
    assert!(run.contact().load_share() > 0.99);
}

/// Motions of creeping bodies near the limit grow beyond all accuracy: the error is that of the load all the same.
#[test]
fn adaptive_runs_of_creeping_bodies_say_that_they_slide() {
    let maxwell = || GeneralizedMaxwell::new(0.0, &[(1.0e6, 1.0)]).unwrap();
    for (nu, creeps, tolerance) in [(0.5, false, 3e-3), (0.5, true, 1e-2), (0.3, false, 1e-2)] {
        let zener = || Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap();
        let material = match (nu, creeps) {
            (_, true) => Material::incompressible(maxwell()),
            (0.5, _) => Material::incompressible(zener()),
            _ => {
                let body = || Material::constant_poisson(zener(), nu).unwrap();
                body().against(body())
            }
        };
        let ball = Sphere::new(10.0e-3).unwrap();
        let builder =
            ViscoelasticContact::builder(Grid::square(16, 4.4e-3).unwrap()).geometry(&ball).material(material);
        let still = StepLoad::new(Load::force(0.0)).unwrap();
        let shear = ShearHistory::new(Ramp::new(Load::force(0.0), Load::force(1.0), 1.0).unwrap(), still);
        let contact = FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap().sheared_by(shear);
        let pressed = StepLoad::new(Load::force(1.0)).unwrap();
        let mut run = contact.into_follow(pressed, Stepping::adaptive(tolerance), 4.0);
        let error = loop {
            match run.next_step() {
                Ok(step) => assert!(step.is_some()),
                Err(error) => break error,
            }
        };
        println!("{nu} {creeps} {tolerance:.0e}: {} steps, {error}", run.progress().steps);
        let Error::Slides { time, direction: Some(direction), .. } = error else { panic!("{error}") };
        assert!((0.5..0.5 * (1.0 + 4.0 * tolerance)).contains(&time) && (direction[0] - 1.0).abs() < 1e-6);
        assert!(run.contact().load_share() > 1.0 - 4.0 * tolerance);
    }
}

/// What slip has dissipated is never given back, however far a body is moved in the step in which it is lifted.
#[test]
fn slip_gives_nothing_back() {
    for back in [0.0, 1e-6, -3e-6, 2e-5] {
        let material = Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap());
        let builder = ViscoelasticContact::builder(Grid::square(24, 4.0e-3).unwrap())
            .geometry(&Sphere::new(10.0e-3).unwrap())
            .material(material);
        let mut contact = FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap();
        let mut last = 0.0;
        for (dt, force, shear) in [
            (0.0, 1.0, ShearLoad::force([0.0; 2])),
            (0.1, 1.0, ShearLoad::force([0.3, 0.0])),
            (0.1, 0.0, ShearLoad::motion([back, 0.0])),
        ] {
            assert!(matches!(contact.step(dt, Load::force(force), shear).unwrap(), Outcome::Holds(_)));
            let slip = contact.lateral_work().slip;
            assert!(slip >= last, "{back}: {last} {slip}");
            last = slip;
        }
        assert!(last > 1e-7);
    }
}

#[test]
fn loads_along_the_surface_have_their_names() {
    let material = || Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap());
    let states = || {
        let states = ElasticStates::sphere(1.0e-2).unwrap();
        StatesContact::new(&states, &material()).unwrap().with_estimated_friction(0.5).unwrap()
    };
    let named = |message: String| assert!(message.contains("force along the surface = NaN"), "{message}");
    named(states().step_sheared(0.0, Load::force(1.0), Load::force(f64::NAN)).unwrap_err().to_string());
    // from the start, and later
    for from in [0.0, 0.05] {
        let nothing = || FnHistory::new(move |t| Load::force(if t >= from { f64::NAN } else { 0.0 }));
        let builder = ViscoelasticContact::builder(Grid::square(16, 4.0e-3).unwrap())
            .geometry(&Sphere::new(10.0e-3).unwrap())
            .material(material());
        let still = StepLoad::new(Load::force(0.0)).unwrap();
        let contact = FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap();
        let pressed = StepLoad::new(Load::force(1.0)).unwrap();
        let contact = contact.sheared_by(ShearHistory::new(nothing(), still));
        named(contact.into_follow(pressed, Stepping::adaptive(1e-2), 1.0).next_step().unwrap_err().to_string());
        let sheared = states().sheared_by(nothing()).unwrap();
        named(sheared.into_follow(pressed, Stepping::adaptive(1e-2), 1.0).next_step().unwrap_err().to_string());
    }
    let message = states().step_sheared(0.0, Load::force(1.0), Load::approach(f64::NAN)).unwrap_err().to_string();
    assert!(message.contains("displacement along the surface = NaN"), "{message}");
}

#[test]
fn too_much_shear_ends_a_run_before_it() {
    let builder = ViscoelasticContact::builder(Grid::square(16, 4.0e-3).unwrap())
        .geometry(&Sphere::new(10.0e-3).unwrap())
        .material(Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap()));
    let ramp = Ramp::new(Load::force(0.0), Load::force(0.6), 1.2).unwrap();
    let shear = ShearHistory::new(StepLoad::new(Load::force(0.0)).unwrap(), ramp);
    let contact = FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap().sheared_by(shear);
    let mut run = contact.into_follow(StepLoad::new(Load::force(1.0)).unwrap(), Stepping::fixed(0.08), 2.0);
    let error = loop {
        match run.next_step() {
            Ok(step) => assert!(step.is_some()),
            Err(error) => break error,
        }
    };
    let Error::Slides { time, direction: Some(direction), over_limit } = error else { panic!("{error}") };
    assert!((time - 1.04).abs() < 1e-9 && (over_limit - 1.04).abs() < 1e-9, "{time} {over_limit}");
    assert!(direction[1] == 1.0 && direction[0].abs() < 1e-6, "{direction:?}");
    // the contact is what it was, and says how near it came
    assert!((run.contact().time() - 0.96).abs() < 1e-9 && (run.contact().load_share() - 0.96).abs() < 1e-9);
}

/// A normal load that is lost in rounding carries nothing, and the force that goes through nothing with it is none.
#[test]
fn loads_go_through_nothing_together() {
    let material = || Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap());
    // friction can carry all of them: a shear of the course of the load, and one whose load grows or falls from touch to touch
    type OfTime = fn(f64) -> f64;
    let scenes: [[OfTime; 2]; 5] = [
        [|t| (PI * t).sin().powi(2), |t| 0.3 * (PI * t).sin().powi(2)],
        [|t| (1.0 - 1.0 / t).exp(), |t| 0.3 * (1.0 - 1.0 / t).exp()],
        [|t| (3.0 * t).sin().abs().powi(5), |t| 0.3 * (3.0 * t).sin().abs().powi(5)],
        [|t| (1.0 + t) * (PI * t).sin().powi(2), |t| 0.3 * (PI * t).sin().powi(2)],
        [|t| (3.0 - t) * (PI * t).sin().powi(2), |t| 0.3 * (PI * t).sin().powi(2)],
    ];
    for [load, shear] in scenes {
        let [pressed, along] = [load, shear].map(|of| FnHistory::new(move |t| Load::force(of(t))));
        let states = ElasticStates::sphere(1.0e-2).unwrap();
        let states = StatesContact::new(&states, &material()).unwrap().with_estimated_friction(0.5).unwrap();
        let contact = states.sheared_by(along.clone()).unwrap();
        let mut run = contact.into_follow(pressed.clone(), Stepping::adaptive(1e-2), 2.3);
        while run.next_step().unwrap().is_some() {}
        assert_eq!(run.contact().lateral_force(), shear(2.3));
        let builder = ViscoelasticContact::builder(Grid::square(12, 8.0e-3).unwrap())
            .geometry(&Sphere::new(10.0e-3).unwrap())
            .material(material());
        let still = StepLoad::new(Load::force(0.0)).unwrap();
        let contact = FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap();
        let contact = contact.sheared_by(ShearHistory::new(along, still));
        let mut run = contact.into_follow(pressed, Stepping::adaptive(1e-2), 2.3);
        while run.next_step().unwrap().is_some() {}
        assert!((run.contact().force()[0] / shear(2.3) - 1.0).abs() < 1e-6);
    }
}
