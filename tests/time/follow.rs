//! Following a load history: which times are met, and with which load.

use crate::common::{maxwell, sphere_on};
use viscocontact::prelude::*;

fn contact(material: Material) -> ViscoelasticContact {
    sphere_on(Grid::square(24, 4.0e-3).unwrap(), material, Settings::default())
}

/// (time, length, force) of every step.
fn steps(history: &dyn LoadHistory, dt: f64, until: f64) -> Vec<(f64, f64, f64)> {
    let mut contact = contact(maxwell());
    let mut run = contact.follow(history, Stepping::fixed(dt), until);
    let mut steps = Vec::new();
    while let Some(report) = run.next_step().unwrap() {
        assert_eq!(run.contact().time(), report.time);
        steps.push((report.time, report.dt, (report.force * 1e9).round() / 1e9));
    }
    assert!(run.next_step().unwrap().is_none(), "the end is the end");
    steps
}

#[test]
fn a_step_load_jumps_first() {
    let history = StepLoad::new(Load::force(0.4)).unwrap();
    assert_eq!(steps(&history, 0.5, 1.0), [(0.0, 0.0, 0.4), (0.5, 0.5, 0.4), (1.0, 0.5, 0.4)]);
}

#[test]
fn corners_and_jumps_are_met_exactly() {
    let table =
        [(0.0, 0.0), (0.3, 0.3), (0.7, 0.3), (0.7, 0.1), (2.0, 0.1)].map(|(time, force)| (time, Load::force(force)));
    let history = PiecewiseLinear::new(&table).unwrap();
    let times: Vec<f64> = steps(&history, 0.5, 1.2).iter().map(|step| step.0).collect();
    assert_eq!(times, [0.3, 0.5, 0.7, 0.7, 1.0, 1.2]);
    let forces: Vec<f64> = steps(&history, 0.5, 1.2).iter().map(|step| step.2).collect();
    assert_eq!(forces, [0.3, 0.3, 0.3, 0.1, 0.1, 0.1]);
}

#[test]
fn fixed_steps_end_on_multiples_of_their_length() {
    let history = Ramp::new(Load::force(0.0), Load::force(0.4), 0.7).unwrap();
    let times: Vec<f64> = steps(&history, 0.1, 1.0).iter().map(|step| step.0).collect();
    let expected = [0.1, 0.2, 3.0 * 0.1, 0.4, 0.5, 6.0 * 0.1, 0.7, 0.8, 0.9, 1.0];
    assert_eq!(times, expected);
}

#[test]
fn a_run_can_be_continued_and_changed() {
    let mut contact = contact(maxwell());
    let ramp = Ramp::new(Load::force(0.0), Load::force(0.4), 1.0).unwrap();
    let mut count = 0;
    for until in [0.35, 1.0] {
        let mut run = contact.follow(&ramp, Stepping::fixed(0.25), until);
        while run.next_step().unwrap().is_some() {
            count += 1;
        }
        assert_eq!(contact.time(), until);
    }
    assert_eq!(count, 2 + 3);
    contact.step(0.1, Load::force(0.2)).unwrap();
    let mut back = contact.follow(&ramp, Stepping::fixed(0.25), 1.2);
    assert_eq!(back.next_step().unwrap().unwrap().dt, 0.0, "another load than the last step's is a jump");
}

#[test]
fn a_sinusoid_swings_between_its_loads() {
    let history = Sinusoid::new(Load::force(0.1), Load::force(0.5), 0.25).unwrap();
    assert_eq!(
        steps(&history, 1.0, 4.0),
        [(0.0, 0.0, 0.3), (1.0, 1.0, 0.5), (2.0, 1.0, 0.3), (3.0, 1.0, 0.1), (4.0, 1.0, 0.3)]
    );
}
