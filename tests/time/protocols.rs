//! Jumps that press nothing: runs that begin with any load, change its kind, part and touch again, on bodies with and
//! without elastic response.

use crate::common::builder_of;
use crate::common::protocol::Protocol;
use crate::common::refused::refused;
use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::geometry::Sum;
use viscocontact::motion::{Straight, Travel};
use viscocontact::prelude::*;
use viscocontact::{Error, Result};

const LENGTH: f64 = 4.0e-3;
const DT: f64 = 0.1;
/// Over which times bodies without an exact series are wanted [s].
const TIMES: std::ops::RangeInclusive<f64> = 1e-3..=1e5;
/// Depths \[m\] and forces \[N\] of a contact that stays on the grid.
const DEPTH: f64 = 6.0e-5;
const FORCE: f64 = 0.3;

/// A body by number, its modulus and time changed by the factors of `scale`; 1, 2 and 3 have no elastic response.
fn material(body: usize, scale: [f64; 2]) -> Material {
    let (g, eta) = (1.0e6 * scale[0], 0.5e6 * scale[0] * scale[1]);
    match body {
        0 => Material::incompressible(Elastic::new(g).unwrap()),
        1 => Material::incompressible(KelvinVoigt::new(g, eta).unwrap()),
        2 => Material::incompressible(PowerLaw::new(1.0 / g, 1.0, 0.2 + 0.3 * scale[1]).unwrap()),
        3 => {
            Material::incompressible(GeneralizedKelvin::new(0.0, 0.2 / eta, &[(0.5 / g, 0.1), (0.5 / g, 1.0)]).unwrap())
        }
        4 => Material::incompressible(FractionalZener::new(3.0 * g, g, scale[1], 0.5).unwrap()),
        5 => Material::incompressible(Maxwell::new(2.0 * g, 10.0 * eta).unwrap()),
        6 => Material::incompressible(Zener::new(2.0 * g, g, eta).unwrap()),
        _ => Material::incompressible(Burgers::new(2.0 * g, 20.0 * eta, g, eta).unwrap()),
    }
}

/// A small scene at random.
#[derive(Debug, Clone)]
struct Scene {
    body: usize,
    scale: [f64; 2],
    shape: usize,
    off: [f64; 2],
    datum: f64,
    settings: Settings,
}

impl Scene {
    /// With a rule whose steps use only their own ends, which a jump does not reset.
    fn linear(mut self) -> Scene {
        self.settings = self.settings.with_time_rule(TimeRule::ExponentialLinear);
        self
    }

    fn geometry(&self) -> Box<dyn Geometry> {
        let datum = self.datum;
        let raised = FnGeometry::new(move |_, _| datum);
        let sphere = Sphere::new(10.0e-3).unwrap();
        let by = self.off.map(|off| off * LENGTH / 20.0);
        match self.shape {
            0 => Box::new(Sum::new(sphere, raised)),
            1 => Box::new(Sum::new(Shifted::new(sphere, by).unwrap(), raised)),
            2 => Box::new(Sum::new(Ellipsoid::new(8.0e-3, 15.0e-3).unwrap(), raised)),
            3 => Box::new(Sum::new(Cone::new(0.08).unwrap(), raised)),
            4 => Box::new(Sum::new(Shifted::new(FlatPunch::circular(0.7e-3).unwrap(), by).unwrap(), raised)),
            _ => Box::new(Sum::new(Sum::new(sphere, Wavy::new(4.0e-6, 1.0e-3).unwrap()), raised)),
        }
    }

    fn contact(&self) -> ViscoelasticContact {
        self.contact_of(material(self.body, self.scale))
    }

    fn contact_of(&self, material: Material) -> ViscoelasticContact {
        builder_of(&self.geometry(), Grid::new([20, 18], [LENGTH, 0.9 * LENGTH]).unwrap(), material)
            .times(TIMES)
            .settings(self.settings)
            .build()
            .unwrap()
    }
}

fn scenes() -> impl Strategy<Value = Scene> {
    let settings = any::<[bool; 2]>().prop_map(|[symmetry, window]| {
        Settings::default().with_tolerance(1e-9).with_edge(Edge::Allow).with_symmetry(symmetry).with_window(window)
    });
    let datum = prop_oneof![Just(0.0), -1.0e-3..1.0e-3_f64];
    let scale = [0.5..2.0_f64, 0.2..1.8_f64];
    // bodies without elastic response more often
    let body = prop_oneof![1..=3_usize, 0..8_usize];
    (body, scale, 0..6_usize, [-1.0..1.0_f64, -1.0..1.0], datum, settings)
        .prop_map(|(body, scale, shape, off, datum, settings)| Scene { body, scale, shape, off, datum, settings })
}

/// One part of a protocol, to be given its loads when it is known where the contact is.
#[derive(Debug, Clone, Copy)]
enum Part {
    /// Held apart: which kind of load, by number, and how far up, 0 where the bodies just touch.
    Apart(usize, f64),
    /// A force, an eccentric one or an approach that rises from nothing, and stays or falls to nothing.
    Press(usize, f64, bool),
    /// Another kind of load that the state satisfies already, then held.
    Change(usize),
}

fn parts(kinds: std::ops::Range<usize>) -> impl Strategy<Value = Part> {
    let up = prop_oneof![Just(0.0), 0.0..1.0_f64];
    prop_oneof![
        2 => (0..5_usize, up).prop_map(|(kind, up)| Part::Apart(kind, up)),
        3 => (kinds, 0.3..1.0_f64, any::<bool>()).prop_map(|(kind, by, part)| Part::Press(kind, by, part)),
    ]
}

/// A load that leaves the bodies apart; tilted ones are lifted by what the tilt takes.
fn apart(kind: usize, up: f64, touch: f64) -> Load {
    let lifted = touch - up * DEPTH;
    match kind {
        0 => Load::approach(lifted),
        1 => Load::approach_and_tilt(lifted - 2.0 * DEPTH, [0.01 * up, -0.005]),
        2 => Load::force(0.0),
        3 => Load::eccentric_force(0.0, [1.0e-4 * up, -2.0e-4]),
        _ => Load::force_and_tilt(0.0, [0.005, 0.01 * up]),
    }
}

/// The loads of a rise from nothing.
fn press(kind: usize, by: f64, touch: f64) -> [Load; 2] {
    match kind {
        0 => [0.0, by * FORCE].map(Load::force),
        1 => [0.0, by * FORCE].map(|force| Load::eccentric_force(force, [1.0e-4, -0.5e-4])),
        2 => [touch, touch + by * DEPTH].map(Load::approach),
        _ => [touch - 2.0 * DEPTH, touch + by * DEPTH].map(|approach| Load::approach_and_tilt(approach, [0.002, 0.0])),
    }
}

/// The same state, asked for in another way.
fn changed(kind: usize, contact: &ViscoelasticContact) -> Load {
    let (force, [m1, m2]) = (contact.force(), contact.fields().moment());
    match kind {
        0 => Load::approach_and_tilt(contact.approach(), contact.tilt()),
        1 => Load::force_and_tilt(force, contact.tilt()),
        _ if force > 0.0 => Load::eccentric_force(force, [m1 / force, m2 / force]),
        _ => Load::force(0.0),
    }
}

/// Takes fixed steps along a protocol; returns it with what it did at each step, and the jumps.
fn follow(contact: &mut ViscoelasticContact, protocol: &Protocol) -> Result<Vec<StepReport>> {
    let mut run = contact.follow(protocol, Stepping::fixed(DT), protocol.end());
    let mut reports = Vec::new();
    while let Some(report) = run.next_step()? {
        reports.push(report);
    }
    Ok(reports)
}

/// Greatest difference of two pressures over the greatest one, and of two displacements; small ones, which rounding makes
/// where bodies just touch, count as parts of what a scene presses with.
fn difference(a: &ViscoelasticContact, b: &ViscoelasticContact) -> [f64; 2] {
    let relative = |a: &[f64], b: &[f64], least: f64| {
        let most = a.iter().chain(b).fold(least, |most, x| x.abs().max(most));
        a.iter().zip(b).map(|(a, b)| (a - b).abs() / most).fold(0.0, f64::max)
    };
    [
        relative(a.pressure(), b.pressure(), 1.0e3),
        relative(a.fields().displacement(), b.fields().displacement(), 1.0e-2 * DEPTH),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(7201), max_shrink_iters: 200, ..ProptestConfig::with_cases(60) })]

    /// Jumps between loads that press nothing, or that the state satisfies already, change nothing: the same steps without
    /// the jumps end alike, by a rule that does not begin anew after a jump.
    #[test]
    fn free_jumps_change_nothing(
        scene in scenes(),
        first in (0..5_usize, 0.0..1.0_f64),
        parts in prop::collection::vec(prop_oneof![4 => parts(0..4), 2 => (0..3_usize).prop_map(Part::Change)], 1..6),
    ) {
        let scene = scene.linear();
        let (mut whole, mut steps, mut scout) = (scene.contact(), scene.contact(), scene.contact());
        let touch = scout.approach();
        let mut protocol = Protocol::default().then(2.0 * DT, apart(first.0, first.1, touch), apart(first.0, first.1, touch));
        follow(&mut scout, &protocol).unwrap();
        for part in parts {
            let end = protocol.clone();
            protocol = match part {
                Part::Change(kind) => {
                    let held = changed(kind, &scout);
                    protocol.then(2.0 * DT, held, held)
                }
                // a release is a jump that bodies with an elastic response do respond to
                _ if scout.contact_cells() > 0 && scout.material().contact_compliance(0.0) > 0.0 => continue,
                Part::Apart(kind, up) => protocol.then(2.0 * DT, apart(kind, up, touch), apart(kind, up, touch)),
                Part::Press(kind, by, back) => {
                    let [from, to] = press(kind, by, touch);
                    let risen = protocol.then(3.0 * DT, from, to);
                    if back { risen.then(3.0 * DT, to, from) } else { risen }
                }
            };
            if let Err(error) = follow(&mut scout, &protocol) {
                panic!("{part:?} after {} s: {error}", end.end());
            }
        }
        let reports = follow(&mut whole, &protocol).unwrap();
        for report in reports.iter().filter(|report| report.dt > 0.0) {
            steps.step(report.dt, protocol.before(report.time)).unwrap();
        }
        let [pressure, displacement] = difference(&whole, &steps);
        prop_assert!(pressure < 1e-6 && displacement < 1e-7, "pressure {pressure:e}, displacement {displacement:e}");
    }

    /// Releases and changes on bodies without elastic response are the limit of those on bodies with hardly any.
    #[test]
    fn jumps_are_the_limit_of_a_stiff_response(
        mut scene in scenes(),
        first in (0..5_usize, 0.0..1.0_f64),
        // approaches that go on where a force left off would depend on the difference of the displacements
        parts in prop::collection::vec((parts(0..4), any::<bool>()), 1..6),
    ) {
        scene.body = 1;
        let scene = scene.linear();
        let [g, time] = scene.scale;
        let stiff = Zener::new(1.0e14, 1.0e6 * g, 0.5e6 * g * time).unwrap();
        let (mut soft, mut stiff) = (scene.contact(), scene.contact_of(Material::incompressible(stiff)));
        let touch = soft.approach();
        let begin = apart(first.0, first.1, touch);
        let mut protocol = Protocol::default().then(DT, begin, begin);
        for (part, hold) in parts {
            protocol = match part {
                Part::Press(kind, by, back) => {
                    let [from, to] = press(kind, by, touch);
                    let risen = protocol.then(3.0 * DT, from, to);
                    let held = if hold { risen.then(2.0 * DT, to, to) } else { risen };
                    if back { held.then(3.0 * DT, to, from) } else { held }
                }
                Part::Apart(kind, up) => protocol.then(2.0 * DT, apart(kind, up, touch), apart(kind, up, touch)),
                Part::Change(_) => protocol,
            };
        }
        let [a, b] = [follow(&mut soft, &protocol).unwrap(), follow(&mut stiff, &protocol).unwrap()];
        prop_assert_eq!(a.len(), b.len());
        let [pressure, displacement] = difference(&soft, &stiff);
        prop_assert!(pressure < 1e-5 && displacement < 1e-6, "pressure {pressure:e}, displacement {displacement:e}");
    }

    /// What presses harder in a jump is refused as before, and leaves no trace.
    #[test]
    fn jumps_that_press_are_refused(mut scene in scenes(), pressed in any::<bool>(), kind in 0..7_usize, by in 1e-3..1.0_f64) {
        scene.body = if scene.body % 2 == 0 { 1 } else { 3 };
        let mut contact = scene.contact();
        let touch = contact.approach();
        if pressed {
            contact.step(DT, Load::force(0.5 * FORCE)).unwrap();
        }
        let (force, approach) = (contact.force(), contact.approach());
        let load = match kind {
            0 => Load::force(force + by * FORCE),
            1 => Load::approach(approach + by * DEPTH),
            2 => Load::eccentric_force(force + by * FORCE, [0.0; 2]),
            3 => Load::approach_and_tilt(approach + 0.1 * by * DEPTH, [0.0, 0.01 * by]),
            4 => Load::force_and_tilt(force + 1e-3 * FORCE, [0.01 * by, 0.0]),
            5 => Load::spring(FORCE / DEPTH, approach + (by + force / FORCE) * DEPTH),
            _ if pressed => Load::force((1.0 - 0.9 * by) * force),
            _ => Load::approach(touch + 1e-9 * by),
        };
        let mut twin = contact.clone();
        let error = contact.step(0.0, load).unwrap_err();
        prop_assert!(matches!(error, Error::Step(StepError::NoElasticResponse { .. })), "{error}");
        prop_assert!(error.to_string().contains("ramp the load"), "{error}");
        if !pressed {
            let history = StepLoad::new(load).unwrap();
            let error = twin.clone().follow(&history, Stepping::fixed(DT), 1.0).next_step().unwrap_err();
            prop_assert!(matches!(error, Error::Step(StepError::NoElasticResponse { .. })), "{error}");
        }
        prop_assert_eq!((contact.pressure(), contact.fields().displacement()), (twin.pressure(), twin.fields().displacement()));
        let load = Load::force(0.4 * FORCE);
        prop_assert_eq!(contact.step(DT, load), twin.step(DT, load));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(7203), max_shrink_iters: 100, ..ProptestConfig::with_cases(16) })]

    /// Adaptive runs of forces that begin with any load that keeps the bodies apart agree with runs that begin without a jump.
    #[test]
    fn adaptive_runs_begin_with_any_load(
        mut scene in scenes(),
        waits in prop::collection::vec((0..5_usize, 0.0..1.0_f64), 2),
        rises in prop::collection::vec(0.3..1.0_f64, 2),
        eccentric in any::<bool>(),
    ) {
        scene.settings = scene.settings.with_tolerance(1e-8);
        // sums over the whole past are first order: their steps are many
        scene.settings = scene.settings.with_time_rule(TimeRule::Exponential);
        let protocol = |wait: &dyn Fn(usize) -> Load| {
            let mut protocol = Protocol::default();
            for (k, rise) in rises.iter().enumerate() {
                let [from, to] = press(usize::from(eccentric), *rise, 0.0);
                let apart = wait(k);
                protocol = protocol.then(0.4, apart, apart).then(0.4, from, to).then(0.4, to, to).then(0.4, to, from);
            }
            protocol
        };
        let (mut jumping, mut plain) = (scene.contact(), scene.contact());
        let touch = plain.approach();
        let run = |contact: &mut ViscoelasticContact, protocol: &Protocol| {
            let mut run = contact.follow(protocol, Stepping::adaptive(1e-3), protocol.end()).stop_at([2.7]).unwrap();
            let mut state = Vec::new();
            while let Some(report) = run.next_step().unwrap() {
                if report.time == 2.7 {
                    state = run.contact().fields().displacement().to_vec();
                }
            }
            state
        };
        let free = press(usize::from(eccentric), 0.0, 0.0)[0];
        let a = run(&mut jumping, &protocol(&|k| apart(waits[k].0, waits[k].1, touch)));
        let b = run(&mut plain, &protocol(&|_| free));
        let most = a.iter().fold(0.0, |most: f64, u| u.abs().max(most));
        let difference = a.iter().zip(&b).map(|(a, b)| (a - b).abs() / most).fold(0.0, f64::max);
        prop_assert!(difference < 1e-2, "{difference:e}");
    }

    /// Of several bodies each may be lifted, tilted and let go of in a jump, while another stays pressed.
    #[test]
    fn bodies_are_lifted_one_by_one(
        scene in scenes(), loads in prop::collection::vec((0..5_usize, 0.0..1.0_f64), 4), press_both in any::<bool>(),
    ) {
        let scene = scene.linear();
        let at = |x: f64| Shifted::new(Sphere::new(10.0e-3).unwrap(), [x, 0.0]).unwrap();
        let build = || {
            ViscoelasticContact::builder(Grid::new([24, 16], [6.0e-3, LENGTH]).unwrap())
                .geometry(&at(-1.5e-3))
                .another_body(&at(1.5e-3))
                .material(material(scene.body, scene.scale))
                .times(TIMES)
                .settings(scene.settings)
                .build()
                .unwrap()
        };
        let (mut contact, mut steps) = (build(), build());
        let apart = |k: usize| apart(loads[k].0, loads[k].1, -DEPTH);
        contact.step(0.0, [apart(0), apart(1)]).unwrap();
        let held = if press_both { apart(2) } else { Load::force(0.0) };
        for (dt, pair) in [
            (DT, [Load::force(FORCE), held]),
            (0.0, [Load::force(FORCE), apart(3)]),
            (DT, [Load::force(FORCE), apart(3)]),
            (0.0, [Load::force(FORCE), Load::force(0.0)]),
            (DT, [Load::force(0.5 * FORCE), Load::force(0.5 * FORCE)]),
        ] {
            let before = contact.pressure().to_vec();
            contact.step(dt, pair).unwrap();
            if dt > 0.0 {
                steps.step(dt, pair).unwrap();
            } else if contact.material().contact_compliance(0.0) == 0.0 {
                prop_assert!(contact.pressure() == before);
            }
        }
        let [pressure, displacement] = difference(&contact, &steps);
        prop_assert!(pressure < 1e-6 && displacement < 1e-7, "pressure {pressure:e}, displacement {displacement:e}");
    }
}

/// Indenters that move in no time are free to, as long as they touch nothing.
#[test]
fn lifted_indenters_move_at_once() {
    let voigt = || Material::incompressible(KelvinVoigt::with_time(1.0e6, 0.5).unwrap());
    let (grid, sphere) = (Grid::square(24, LENGTH).unwrap(), Sphere::new(10.0e-3).unwrap());
    let lifted = Load::approach(-DEPTH);
    let build = |frame| {
        let builder = builder_of(&sphere, grid.clone(), voigt());
        builder.settings(Settings::default().with_frame(frame)).build().unwrap()
    };
    let travel = Travel::new(sphere, Straight::new([-1.0e-3, 0.0], [0.0, 0.0]).unwrap());
    let mut along = build(Frame::Bodies);
    let mut over = build(Frame::Indenter);
    for contact in [&mut along, &mut over] {
        contact.step(DT, Load::force(0.1)).unwrap();
    }
    let cells = |x: f64| (x / grid.spacing()[0]).round() as isize;
    refused([
        (along.step_along(&travel, 0.0, Load::force(0.1)).err(), "needs an elastic response"),
        (over.step_over([cells(-1.0e-3), 0], 0.0, Load::force(0.1)).err(), "needs an elastic response"),
    ]);
    let before = along.fields().displacement().to_vec();
    along.step_along(&travel, 0.0, lifted).unwrap();
    over.step_over([cells(-1.0e-3), 0], 0.0, lifted).unwrap();
    assert!((along.contact_cells(), over.contact_cells()) == (0, 0));
    // the symmetry is given up, and with it goes a rounding
    assert!(along.fields().displacement().iter().zip(&before).all(|(u, before)| (u - before).abs() < 1e-12 * DEPTH));
    for _ in 0..2 {
        along.step_along(&travel, DT, Load::force(0.1)).unwrap();
        over.step_over([0, 0], DT, Load::force(0.1)).unwrap();
    }
    assert_abs_diff_eq!(along.approach() / over.approach(), 1.0, epsilon = 1e-5);
}
