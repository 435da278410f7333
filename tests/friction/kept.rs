//! What is kept of contacts with friction: runs that go on; what is refused. Snapshots and files are in `time::states_kept`.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use viscocontact::prelude::*;
use viscocontact::states::{ElasticStates, Reach, StatesContact, Sweep};

use super::dense::{material, relaxation};
use crate::common::Temporary;

pub(crate) fn smooth() -> StatesContact {
    StatesContact::new(&ElasticStates::sphere(0.5625).unwrap(), &material(&relaxation(1))).unwrap()
}

pub(crate) fn contact(friction: f64) -> StatesContact {
    smooth().with_friction(friction).unwrap()
}

/// To and fro, with one jump.
fn shear() -> impl LoadHistory {
    let row = |time: f64, shift: f64| (time, Load::approach(shift));
    PiecewiseLinear::new(&[row(0.0, 0.0), row(0.7, 0.3), row(1.5, -0.2), row(1.5, 0.1), row(3.0, 0.2)]).unwrap()
}

pub(crate) fn advance(contact: &mut StatesContact, steps: std::ops::Range<u32>) {
    for step in steps {
        let wave = (1.7 * f64::from(step)).sin();
        let dt = if step.is_multiple_of(5) { 0.0 } else { 0.1 };
        contact
            .step_sheared(dt, Load::force(1.0 + 0.8 * wave), Load::approach(0.4 * (0.9 * f64::from(step)).sin()))
            .unwrap();
    }
}

#[test]
fn sheared_runs_go_on_by_the_same_steps() {
    let folder = Temporary::folder("friction-run");
    let path = folder.join("run");
    let press = Ramp::new(Load::force(0.2), Load::force(1.0), 2.0).unwrap();
    let made = || contact(0.4).sheared_by(shear()).unwrap();
    let whole = {
        let (mut contact, mut reports) = (made(), Vec::new());
        let mut run = contact.follow(&press, Stepping::adaptive(1e-2), 3.0);
        while let Some(report) = run.next_step().unwrap() {
            reports.push((report.time, run.contact().lateral_force(), run.contact().lateral_work()));
        }
        reports
    };
    // the jump of the shear is a step of no time
    assert!(whole.windows(2).any(|pair| pair[0].0 == 1.5 && pair[1].0 == 1.5));
    let (mut first, cancel) = (made(), Arc::new(AtomicBool::new(false)));
    let mut run = first.follow(&press, Stepping::adaptive(1e-2), 3.0).cancelled_by(Arc::clone(&cancel));
    run = run.autosave_to(&path, std::time::Duration::ZERO);
    for _ in 0..whole.len() / 2 {
        run.next_step().unwrap();
    }
    cancel.store(true, Ordering::Relaxed);
    assert!(matches!(run.next_step(), Err(Error::Cancelled { .. })));
    let mut other = made();
    other.resume(&path).unwrap();
    let mut run = other.follow(&press, Stepping::adaptive(1e-2), 3.0);
    for (time, force, work) in &whole[whole.len() / 2..] {
        let report = run.next_step().unwrap().unwrap();
        let contact = run.contact();
        assert_eq!((report.time, contact.lateral_force(), contact.lateral_work()), (*time, *force, *work));
    }
    assert!(run.next_step().unwrap().is_none());
}

/// An event of the shear: the contact begins to slide.
#[test]
fn runs_stop_where_the_contact_slides() {
    let press = StepLoad::new(Load::force(1.0)).unwrap();
    let pull = Ramp::new(Load::approach(0.0), Load::approach(2.0), 10.0).unwrap();
    let mut contact = contact(0.4).sheared_by(pull).unwrap();
    contact.step_sheared(0.0, Load::force(1.0), Load::force(0.0)).unwrap();
    let mut run = contact.follow(&press, Stepping::adaptive(1e-4), 10.0);
    run = run.stop_when(|contact| contact.slid(), viscocontact::run::Crossing::Up(1e-6)).unwrap();
    while run.events()[0].times().is_empty() {
        run.next_step().unwrap().unwrap();
    }
    let (time, found) = (run.events()[0].times()[0], run.contact());
    assert!(0.0 < time && time < 10.0);
    assert!((found.slid() - 1e-6).abs() < 1e-7, "{}", found.slid());
    assert!((found.lateral_force() - 0.4).abs() < 1e-12 && found.stick_level() == 0.0);
    assert!((found.lateral_displacement() / (0.2 * time) - 1.0).abs() < 1e-9);
}

#[test]
fn what_friction_does_not_cover_is_refused() {
    let states = ElasticStates::sphere(1.0).unwrap();
    let rubber = || Material::incompressible(Elastic::new(1.0e6).unwrap());
    let on_rubber = || StatesContact::new(&states, &rubber()).unwrap();
    let refused = |found: viscocontact::Result<StatesContact>| found.unwrap_err().code();
    assert_eq!(refused(on_rubber().with_friction(0.5)), "states_other_kernel");
    assert_eq!(refused(on_rubber().sheared_by(shear())), "states_no_friction");
    assert_eq!(refused(on_rubber().with_slip_from_start()), "states_no_friction");
    let bulk = Material::elastic_bulk(Maxwell::new(1.0e6, 1.0e6).unwrap(), 1.0e7).unwrap();
    let changing = StatesContact::new(&states, &bulk).unwrap();
    assert_eq!(refused(changing.with_estimated_friction(0.5)), "states_other_kernel");
    for coefficient in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(on_rubber().with_estimated_friction(coefficient).is_err());
    }
    let mut contact = on_rubber().with_estimated_friction(0.5).unwrap();
    contact.step(0.0, Load::force(1.0)).unwrap();
    let before = format!("{contact:?}");
    for along in
        [Load::force(f64::NAN), Load::approach(f64::INFINITY), Load::eccentric_force(0.1, [1.0, 0.0]), Load::force(0.6)]
    {
        contact.step_sheared(1.0, Load::force(1.0), along).unwrap_err();
        assert_eq!(format!("{contact:?}"), before);
    }
    assert!(on_rubber().step_sheared(0.0, Load::force(1.0), Load::force(0.0)).is_err());
    // line contact at ν = ½ is exact, a layer is not covered
    let grid = Grid::new([64, 1], [4.0, 1.0]).unwrap();
    let swept = |kernel: InfluenceKernel, grid: &Grid| {
        let settings = Settings::default().with_edge(Edge::Allow);
        let sweep = Sweep::new(grid.clone(), &Cylinder::new(1.0).unwrap()).kernel(kernel).settings(settings);
        sweep.run(Reach::Level(0.1)).unwrap()
    };
    let line = swept(InfluenceKernel::line(&grid, 20.0).unwrap(), &grid);
    assert!(StatesContact::new(&line, &rubber()).unwrap().with_friction(0.5).is_ok());
    let square = Grid::square(32, 4.0).unwrap();
    let layer = swept(InfluenceKernel::layer(&square, Layer::bonded_to_rigid(0.5, 0.4).unwrap()).unwrap(), &square);
    let compressible = Material::constant_poisson(Elastic::new(1.0e6).unwrap(), 0.4).unwrap();
    let on_layer = StatesContact::new(&layer, &compressible).unwrap();
    assert_eq!(refused(on_layer.with_estimated_friction(0.5)), "states_other_kernel");
}

/// A contact that was pressed before gets friction: its groups have not been sheared.
#[test]
fn friction_begins_at_any_time() {
    let mut late = smooth().with_linear_steps();
    let mut early = contact(0.4);
    for step in 0..12 {
        let (dt, load) = (if step == 0 { 0.0 } else { 0.3 }, Load::force(1.0 + 0.8 * (1.3 * f64::from(step)).sin()));
        late.step(dt, load).unwrap();
        early.step_sheared(dt, load, Load::force(0.0)).unwrap();
    }
    assert!(late.groups() > 3);
    late = late.with_friction(0.4).unwrap();
    for contact in [&mut late, &mut early] {
        advance(contact, 0..10);
    }
    assert!((late.lateral_force() - early.lateral_force()).abs() < 1e-12);
    assert!((late.lateral_work().slip / early.lateral_work().slip - 1.0).abs() < 1e-9);
}

/// Groups merge, however many cycles there are.
#[test]
fn cycles_keep_few_groups() {
    let mut contact = contact(0.4).with_merge_error(1e-5).unwrap();
    let mut most = 0;
    for step in 0..40_000 {
        let phase = 0.05 * f64::from(step);
        let (press, shear) = (Load::force(1.0 + 0.3 * (0.37 * phase).sin()), Load::approach(0.1 * phase.sin()));
        contact.step_sheared(if step == 0 { 0.0 } else { 0.01 }, press, shear).unwrap();
        most = most.max(contact.groups());
    }
    println!("at most {most} groups");
    assert!(most < 2000);
}
