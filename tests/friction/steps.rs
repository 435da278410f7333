//! Steps against closed forms and tables, and one kind of load against another.

use viscocontact::prelude::*;
use viscocontact::states::{ElasticStates, StatesContact};

use super::bodies::Relaxation;
use super::dense::{material, relaxation};
use crate::common::draws::Draws;

/// A ball with δ = l^(2/3), on two bodies of ν = 0.
fn ball(relaxation: &Relaxation, friction: f64) -> StatesContact {
    // l = 4/3 a³/R, δ = a²/R: δ = l^(2/3) of R = 9/16
    let states = ElasticStates::sphere(0.5625).unwrap();
    StatesContact::new(&states, &material(relaxation)).unwrap().with_friction(friction).unwrap()
}

/// C = 4 − 3 e^(−t/4): E = 1/4 + 3/4 e^(−t).
fn zener() -> Relaxation {
    Relaxation { equilibrium: 0.25, terms: vec![(0.75, 1.0)] }
}

#[test]
fn a_force_held_along_a_contact_that_grows() {
    // pressed and sheared at once, and held
    let mut contact = ball(&zener(), 0.4);
    let run = |contact: &mut StatesContact, ramp: bool, until: f64| {
        let steps = 4000;
        for step in 0..=steps {
            let time = until * f64::from(step) / f64::from(steps);
            let part = if ramp { time.min(1.0) } else { 1.0 };
            let dt = if step == 0 { 0.0 } else { until / f64::from(steps) };
            contact.step_sheared(dt, Load::force(part), Load::force(0.2 * part)).unwrap();
        }
    };
    run(&mut contact, false, 3.0);
    for (value, expected) in
        [(contact.level(), 2.582900), (contact.stick_level(), 2.582900), (contact.lateral_displacement(), 0.376503)]
    {
        assert!((value - expected).abs() < 2e-6, "{value}, {expected}");
    }
    let mut contact = ball(&zener(), 0.4);
    run(&mut contact, true, 4.0);
    for (value, expected) in
        [(contact.level(), 2.746155), (contact.stick_level(), 2.746155), (contact.lateral_displacement(), 0.392205)]
    {
        assert!((value - expected).abs() < 2e-6, "{value}, {expected}");
    }
}

/// τ = λ p whatever P does, if Q = λ P: in steps of given length of both rules.
#[test]
fn oblique_loading_sticks() {
    for seed in 0..200 {
        let mut draws = Draws::new(seed);
        let (friction, part) = (draws.between(0.1, 0.9), draws.between(-0.99, 0.99));
        let mut contact = ball(&relaxation(seed as usize % 3), friction);
        if seed.is_multiple_of(2) {
            contact = contact.with_linear_steps().with_merge_error(0.0).unwrap();
        }
        let mut worst = 0.0f64;
        for step in 0..30 {
            let force = if draws.chance(0.1) { 0.0 } else { draws.power_of_ten(-2.0, 0.0) };
            let dt = if step == 0 || draws.chance(0.1) { 0.0 } else { draws.power_of_ten(-2.0, 1.0) };
            let crept = contact.lateral_work().creep;
            contact.step_sheared(dt, Load::force(force), Load::force(part * friction * force)).unwrap();
            // nothing creeps at once, but for what merging of groups changes: the work is stored, 2/5 Q d of a ball
            let work = contact.lateral_work();
            let size = work.stored + work.creep.abs();
            let rounding = if seed.is_multiple_of(2) { 1e-11 } else { 1e-6 };
            assert!(dt > 0.0 || (work.creep - crept).abs() <= rounding * size, "seed {seed}, step {step}: {work:?}");
            if step == 0 {
                let exact = 0.4 * contact.lateral_force() * contact.lateral_displacement();
                assert!((work.work - exact).abs() <= 1e-9 * exact, "seed {seed}: {work:?}, {exact}");
            }
            let most = contact.tractions().map(|(_, w)| w).fold(0.0, f64::max);
            let off =
                contact.tractions().zip(contact.shear_tractions()).map(|(w, q)| (q.1 - part * friction * w.1).abs());
            worst = off.fold(worst, |worst, off| worst.max(off / (friction * most)));
            assert_eq!(contact.stick_level(), contact.level(), "seed {seed}, step {step}");
        }
        assert!(worst < 1e-10, "seed {seed}: {worst:e}");
        let lost = contact.lateral_work().slip;
        assert!(lost.abs() < 1e-12, "seed {seed}: what sticks lost {lost:e}");
    }
}

/// At once levels slip one after the other, so that the loss depends on where a force turns, not on the steps between.
#[test]
fn losses_at_once_do_not_depend_on_steps() {
    let lost = |parts: u32| {
        let (mut contact, mut from) = (ball(&zener(), 0.4), 0.0);
        contact.step(0.0, Load::force(1.0)).unwrap();
        for to in [0.3, -0.2, 0.25] {
            for k in 1..=parts {
                let along = from + (to - from) * f64::from(k) / f64::from(parts);
                contact.step_sheared(0.0, Load::force(1.0), Load::force(along)).unwrap();
            }
            from = to;
        }
        contact.lateral_work().slip
    };
    let (one, many) = (lost(1), lost(50));
    assert!(many > 0.0 && (one / many - 1.0).abs() < 1e-9, "{one:e}, {many:e}");
}

/// A body that is held along the surface while it is lifted at once does no work there, so that all that was stored goes
/// into slip; one that is let go as it is lifted gets it back.
#[test]
fn what_parts_loses_what_it_had_stored_unless_it_is_let_go() {
    for (is_held, parts) in [(true, 1), (true, 40), (true, 640), (false, 1), (false, 40)] {
        let mut contact = ball(&zener(), 0.4);
        contact.step_sheared(0.0, Load::force(1.0), Load::force(0.2)).unwrap();
        let (before, at) = (contact.lateral_work(), contact.lateral_displacement());
        assert_eq!(before.slip, 0.0);
        for k in 1..=parts {
            let left = 1.0 - f64::from(k) / f64::from(parts);
            let along = if is_held { Load::approach(at) } else { Load::force(0.2 * left) };
            contact.step_sheared(0.0, Load::force(left), along).unwrap();
        }
        let after = contact.lateral_work();
        assert!(after.stored.abs() < 1e-12 * before.stored, "{after:?}");
        let lost = after.slip / before.stored;
        println!("held {is_held} in {parts}: {lost:.6}");
        let most = if parts == 1 { 1e-12 } else { 0.3 / f64::from(parts) };
        assert!((lost - f64::from(u8::from(is_held))).abs() < most, "{is_held} {parts}: {lost}");
    }
}

/// A spring holds a body along the surface while its load falls to where it slides: steps in which sliding begins lose
/// what many steps lose, by the mean of the force at which it began and that at the end.
#[test]
fn sliding_that_begins_as_the_load_falls_loses_the_mean_force_over_its_way() {
    let lost = |parts: u32| {
        let mut contact = ball(&zener(), 0.4);
        contact.step_sheared(0.0, Load::force(1.0), Load::force(0.2)).unwrap();
        // soft beside the contact, whose slip before it slides is little then
        let stiffness = 1e-3 * 0.2 / contact.lateral_displacement();
        let along = Load::spring(stiffness, contact.lateral_displacement() + 0.2 / stiffness);
        for k in 1..=parts {
            let normal = 1.0 - 0.8 * f64::from(k) / f64::from(parts);
            contact.step_sheared(0.0, Load::force(normal), along).unwrap();
        }
        contact.lateral_work().slip
    };
    let many = lost(4096);
    for (parts, most) in [(1, 1e-3), (2, 1e-3), (3, 1e-3), (7, 3e-4), (64, 2e-5)] {
        let off = lost(parts) / many - 1.0;
        println!("{parts}: {off:e}");
        assert!(many > 0.0 && off.abs() < most, "{parts}: {off:e}");
    }
}

/// Displacements and springs that were read off a run under forces bring the forces back.
#[test]
fn motions_and_springs_bring_forces_back() {
    let mut worst = 0.0f64;
    for seed in 0..200 {
        let mut draws = Draws::new(1000 + seed);
        let friction = draws.between(0.1, 0.9);
        let mut by_force = ball(&relaxation(seed as usize % 3), friction);
        let (mut by_motion, mut by_spring) = (by_force.clone(), by_force.clone());
        let stiffness = draws.power_of_ten(-2.0, 2.0);
        for step in 0..30 {
            let force = draws.power_of_ten(-1.0, 0.0);
            let dt = if step == 0 || draws.chance(0.1) { 0.0 } else { draws.power_of_ten(-2.0, 1.0) };
            let along = friction * force * draws.between(-0.95, 0.95);
            by_force.step_sheared(dt, Load::force(force), Load::force(along)).unwrap();
            let d = by_force.lateral_displacement();
            by_motion.step_sheared(dt, Load::force(force), Load::approach(d)).unwrap();
            by_spring.step_sheared(dt, Load::force(force), Load::spring(stiffness, d + along / stiffness)).unwrap();
            for other in [&by_motion, &by_spring] {
                worst = worst.max((other.lateral_force() - along).abs() / (friction * force));
            }
        }
    }
    assert!(worst < 1e-8, "{worst:e}");
}

/// A body that is moved farther than it can follow slides, and a force that is too great is refused.
#[test]
fn the_whole_contact_slides() {
    let mut contact = ball(&zener(), 0.4);
    contact.step(0.0, Load::force(1.0)).unwrap();
    contact.step_sheared(0.0, Load::force(1.0), Load::approach(10.0)).unwrap();
    assert!((contact.lateral_force() - 0.4).abs() < 1e-12 && contact.stick_level() == 0.0);
    // a ball of ν = 0: d = f δ where all of it slips
    assert!((contact.slid() - (10.0 - 0.4)).abs() < 1e-12, "{}", contact.slid());
    let before = contact.lateral_work();
    assert!((before.work - before.slip - before.stored - before.creep).abs() < 1e-12);
    let error = contact.step_sheared(0.0, Load::force(1.0), Load::force(0.5)).unwrap_err().to_string();
    assert!(error.contains("1.25 times what friction carries"), "{error}");
    contact.step_sheared(0.0, Load::force(0.0), Load::force(0.0)).unwrap();
    assert_eq!(contact.lateral_force(), 0.0);
}
