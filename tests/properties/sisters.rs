//! What one kind of contact, load or run is guarded against, its sisters are, too.

use std::sync::Arc;

use crate::common::{Temporary, builder_of, builder_on, elastic, maxwell, sphere_on, zener};
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::contact::{Energies, EnergyBalance, Warnings};
use viscocontact::elastic::ElasticContact;
use viscocontact::friction::{Coulomb, FrictionContact, Outcome, ShearLoad};
use viscocontact::geometry::{Sum, Wavy};
use viscocontact::prelude::*;
use viscocontact::run::{Contact, Crossing};

fn grid() -> Grid {
    Grid::square(24, 4.0e-3).unwrap()
}

fn dashpots() -> Material {
    Material::incompressible(KelvinVoigt::with_time(1.0e6, 1.0).unwrap())
}

fn sphere() -> Sphere {
    Sphere::new(10.0e-3).unwrap()
}

fn to_end<C: Contact>(mut run: Run<'_, C>) -> Result<Vec<f64>, viscocontact::Error> {
    let mut times = Vec::new();
    while let Some(report) = run.next_step()? {
        times.push(report.time);
    }
    Ok(times)
}

/// A stop lies one digit of time before a jump.
#[test]
fn steps_of_a_digit_end_at_jumps() {
    let load = Periodic::square(Load::force(0.5), Load::force(0.2), 0.1, 0.5).unwrap();
    let jump = load.next_breakpoint(0.29).unwrap();
    assert!(jump > 0.3 && jump < 0.3 * (1.0 + 1e-15), "{jump:e}");
    let mut contact = sphere_on(grid(), maxwell(), Settings::default());
    let run = contact.follow(&load, Stepping::adaptive(1e-2), 1.0).stop_at([0.3]).unwrap();
    let times = to_end(run).unwrap();
    assert!(times.contains(&0.3) && times.contains(&jump) && times.last() == Some(&1.0));
    let states = ElasticStates::sphere(10.0e-3).unwrap();
    let mut contact = StatesContact::new(&states, &maxwell()).unwrap();
    let run = contact.follow(&load, Stepping::adaptive(1e-2), 1.0).stop_at([0.3]).unwrap();
    assert!(to_end(run).unwrap().contains(&jump));
}

/// Quantities may be infinite where bodies are apart.
#[test]
fn events_of_infinite_quantities_are_found() {
    let load = Ramp::new(Load::approach(-1.0e-5), Load::approach(2.0e-5), 1.0).unwrap();
    let mut contact = sphere_on(grid(), maxwell(), Settings::default());
    let run = contact.follow(&load, Stepping::fixed(0.25), 1.0);
    let mut run = run.stop_when(|contact| 1.0 / contact.force(), Crossing::Down(1.0e3)).unwrap();
    while run.next_step().unwrap().is_some() {}
    let time = run.events()[0].times()[0];
    assert!((run.events()[0].times().len(), time > 0.3 && time < 1.0) == (1, true), "{time}");
}

/// A run that a file held goes on to a later end, and sees the loads there.
#[test]
fn runs_go_on_beyond_the_end_that_they_had() {
    let folder = Temporary::folder("sisters-later");
    let path = folder.join("run");
    // a tap in what the first run did not look at
    let taps =
        [(0.0, 0.3), (5.0, 0.3), (5.02, 0.9), (5.04, 0.3), (40.0, 0.3)].map(|(time, force)| (time, Load::force(force)));
    let load = PiecewiseLinear::new(&taps).unwrap();
    let contact = || {
        let builder = builder_of(
            &sphere(),
            Grid::square(12, 4.0e-3).unwrap(),
            Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0).unwrap()),
        );
        FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap()
    };
    let (mut first, ends) = (contact(), [1.0, 40.0]);
    let run = first.follow(&load, Stepping::adaptive(1e-2), ends[0]).autosave_to(&path, std::time::Duration::ZERO);
    to_end(run).unwrap();
    let mut resumed = contact();
    resumed.resume(&path).unwrap();
    let again = to_end(resumed.follow(&load, Stepping::adaptive(1e-2), ends[1])).unwrap();
    let mut whole = contact();
    let at_once = to_end(whole.follow(&load, Stepping::adaptive(1e-2), ends[1])).unwrap();
    let off = (resumed.approach() / whole.approach() - 1.0).abs();
    assert!(again.contains(&5.02) && off < 2e-2, "{off:e}");
    assert!(3 * again.len() > at_once.len(), "{} and {} steps", again.len(), at_once.len());
}

/// Bodies without elastic response may part in a jump, and keep what they carry.
#[test]
fn dashpots_rub() {
    let (press, gone) = (Load::force(0.5), Load::force(0.0));
    let mut states = StatesContact::new(&ElasticStates::sphere(10.0e-3).unwrap(), &dashpots()).unwrap();
    states = states.with_estimated_friction(0.5).unwrap();
    states.step_sheared(1.0, press, Load::force(0.1)).unwrap();
    states.step_sheared(0.0, gone, Load::force(0.0)).unwrap();
    assert!(states.force() == 0.0 && states.lateral_force() == 0.0);

    let mut contact =
        FrictionContact::new(builder_of(&sphere(), grid(), dashpots()), Coulomb::new(0.5).unwrap()).unwrap();
    let along = ShearLoad::force([0.1, 0.0]);
    assert!(matches!(contact.step(1.0, press, along), Ok(Outcome::Holds(_))));
    let traction = contact.traction();
    assert!(matches!(contact.step(0.0, press, along), Ok(Outcome::Holds(_))));
    assert_eq!(contact.traction(), traction);
    assert!(contact.step(0.0, press, ShearLoad::force([0.2, 0.0])).is_err());
    assert!(matches!(contact.step(0.0, gone, ShearLoad::force([0.0; 2])), Ok(Outcome::Holds(_))));
    assert!(contact.traction().iter().flatten().all(|traction| *traction == 0.0) && contact.force() == [0.0; 3]);
    // a second run of what a first one has pressed
    let mut contact =
        FrictionContact::new(builder_of(&sphere(), grid(), dashpots()), Coulomb::new(0.5).unwrap()).unwrap();
    let load = Ramp::new(Load::force(0.0), press, 1.0).unwrap();
    for until in [1.0, 2.0] {
        to_end(contact.follow(&load, Stepping::fixed(0.25), until)).unwrap();
    }
}

/// On elastic states of a body that turns as it is pressed, what sticks would not move as one.
#[test]
fn friction_refuses_states_of_bodies_that_turn() {
    let states = |at: f64| {
        let tilt = [Tilt::Free { at }, Tilt::Fixed(0.0)];
        let punch = FlatPunch::circular(1.0e-3).unwrap();
        Sweep::new(grid(), &punch).tilt(tilt).run(Reach::Level(1.0e-9)).unwrap()
    };
    let rubs = |at: f64| StatesContact::new(&states(at), &elastic()).unwrap().with_estimated_friction(0.5);
    assert!(rubs(0.0).is_ok());
    assert_eq!(rubs(0.2e-3).unwrap_err().code(), "friction_turning");
}

/// Steps of contacts with friction end at the times of the run to the last digit, and a jump along the surface has two samples.
#[test]
fn times_and_jumps_along_the_surface_are_those_of_the_run() {
    let load = Ramp::new(Load::force(0.1), Load::force(0.2), 0.03).unwrap();
    let builder = builder_of(&sphere(), grid(), Material::incompressible(Elastic::new(1.0e6).unwrap()));
    let mut contact = FrictionContact::new(builder, Coulomb::new(0.5).unwrap()).unwrap();
    let times = to_end(contact.follow(&load, Stepping::fixed(1.0), 0.3)).unwrap();
    assert_eq!(times.last(), Some(&0.3));

    let zener = Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0).unwrap());
    let pressed = StepLoad::new(Load::force(0.5)).unwrap();
    let along = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.1), (2.0, 0.1)].map(|(time, force)| (time, Load::force(force)));
    let states = StatesContact::new(&ElasticStates::sphere(10.0e-3).unwrap(), &zener).unwrap();
    let mut states =
        states.with_estimated_friction(0.5).unwrap().sheared_by(PiecewiseLinear::new(&along).unwrap()).unwrap();
    let run = states.follow(&pressed, Stepping::adaptive(1e-2), 2.0).sample_at([1.0, 1.5]).unwrap();
    let mut run = run.fields_to(1e-3).unwrap();
    let mut seen = Vec::new();
    while run.next_step().unwrap().is_some() {
        for sample in run.samples() {
            let sample = sample.unwrap();
            if sample.is_asked_for() {
                seen.push(sample.contact().lateral_force());
            }
        }
    }
    assert!(seen.len() == 3 && seen[0] == 0.0 && seen[1..].iter().all(|force| (force - 0.1).abs() < 1e-9), "{seen:?}");
}

/// A body that tilts about a point off its origin does not jump by being pressed, and adheres without a lateral force.
#[test]
fn bodies_that_attract_are_balanced_about_their_load_point() {
    let law = Arc::new(ExponentialAttraction::new(1.0, 1.0).unwrap());
    let wide = Grid::square(24, 8.0).unwrap();
    let body = Material::incompressible(Elastic::new(0.25).unwrap());
    let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(1e-8);
    let punch = FlatPunch::circular(2.0).unwrap();
    let contact = |shape: &dyn Geometry| {
        builder_of(shape, wide.clone(), body.clone()).attraction(law.clone()).settings(settings).build().unwrap()
    };
    let mut pressed = contact(&punch);
    let mut balance = EnergyBalance::new(&pressed).unwrap();
    let load = |at: f64| Load::Approach { approach: at, tilt: [Tilt::Free { at: 0.4 }, Tilt::Fixed(0.0)] };
    let mut released = Vec::new();
    for steps in [16, 64] {
        let mut own = pressed.clone();
        for k in 1..=steps {
            let report = own.step(0.1, load(0.5 + 0.5 * f64::from(k) / f64::from(steps))).unwrap();
            assert!(!report.warnings.contains(Warnings::JUMP) || k == 1, "step {k} of {steps}");
            if k == steps {
                released.push(own.passes().unwrap().released.abs());
            }
        }
        assert!(own.fields().tilt()[0].abs() > 1e-3);
    }
    // of second order in the length of the step
    assert!(released[1] < released[0] / 8.0, "{released:?}");
    let report = pressed.step(0.0, load(0.6)).unwrap();
    let Energies { work, .. } = balance.record(&pressed, &report).unwrap();
    assert!(work.is_finite());

    let bumpy = Sum::new(Sphere::new(4.0).unwrap(), Shifted::new(Wavy::new(0.1, 2.0).unwrap(), [0.3, 0.2]).unwrap());
    let mut adhering = contact(&bumpy);
    adhering.step(0.0, Load::approach(adhering.approach() + 0.2)).unwrap();
    let (lateral, mut force) = (adhering.fields().slope_force(&bumpy), vec![0.0; wide.len()]);
    adhering.fields().traction_into(&mut force).unwrap();
    let size: f64 = force.iter().map(|traction| traction.abs()).sum::<f64>() * wide.cell_area();
    assert!(lateral.iter().all(|force| force.abs() < 0.02 * size), "{lateral:?} of {size}");
}

/// What elastic contacts show and warn of does not depend on where their origin is, on what is computed, or on how they came there.
#[test]
fn contacts_show_and_warn_of_what_is_there() {
    let wide = Grid::square(64, 4.0e-3).unwrap();
    let ball = |settings| {
        ElasticContact::builder(wide.clone()).geometry(&sphere()).modulus(4.0e6).settings(settings).build().unwrap()
    };
    let mut tilted = ball(Settings::default());
    let report = tilted.solve(Load::force_and_tilt(0.05, [0.1, 0.0])).unwrap();
    assert!(report.contact_cells > 0 && tilted.fields().approach() < 0.0);
    assert!(!report.warnings.contains(Warnings::ROUNDING), "{}", report.warnings);

    let mut pressed = ball(Settings::default());
    pressed.solve(Load::force(0.1)).unwrap();
    let before = pressed.fields().displacement().to_vec();
    pressed.set_surface(&vec![0.0; wide.len()]).unwrap();
    let after = pressed.fields().displacement().to_vec();
    let most = before.iter().fold(0.0, |most: f64, u| most.max(*u));
    assert!(before.iter().zip(&after).all(|(before, after)| (before - after).abs() < 1e-9 * most));

    // steps do not depend on whether half of the cells is computed
    let steps = [true, false].map(|symmetry| {
        let settings = Settings::default().with_symmetry(symmetry);
        let mut contact = builder_on(Grid::square(16, 4.0e-3).unwrap(), zener()).settings(settings).build().unwrap();
        let load = StepLoad::new(Load::eccentric_force(0.5, [0.2e-3, 0.0])).unwrap();
        to_end(contact.follow(&load, Stepping::adaptive(1e-3), 5.0)).unwrap()
    });
    assert_eq!(steps[0].len(), steps[1].len());

    // waves that the grid misses are those of the indenter that is there
    let coarse = Wavy::new(1.0e-6, 2.0 * grid().spacing()[0]).unwrap();
    let mut contact = builder_of(&Sum::new(sphere(), coarse), grid(), maxwell()).build().unwrap();
    let rough = contact.snapshot();
    let warned = |contact: &mut ViscoelasticContact| {
        contact.step(0.1, Load::force(0.3)).unwrap().warnings.contains(Warnings::SHORT_WAVES)
    };
    assert!(warned(&mut contact));
    contact.set_geometries(&[&sphere()]).unwrap();
    assert!(!warned(&mut contact));
    contact.restore(&rough).unwrap();
    assert!(warned(&mut contact));
}

/// Every reader of heights refuses what looks like a mark of missing points, and coordinates beside a matrix.
#[test]
fn readers_of_heights_see_what_is_none() {
    let read = |text: &str| {
        HeightMap::from_text(text.as_bytes(), [1.0, 1.0], LengthUnit::Metre, viscocontact::TextFormat::default())
    };
    // the first line is at the top: its coordinate is the greatest
    for text in [
        ",0.5,1.0,1.5\n5.0,1,2,3\n2.5,4,5,7\n",
        ",0.5,1.0,1.5\n2.5,1,2,3\n5.0,4,5,7\n",
        ",0.33,0.67,1.0\n5.0,1,2,3\n2.5,4,5,7\n",
    ] {
        assert_eq!(read(text).unwrap_err().code(), "map_not_a_matrix", "{text}");
    }
    // two marks, of which each is near the other
    for marks in ["0.1 0.9 0.4\n-9999 0.3 9999\n", "0.1 0.9 0.4\n-32768 0.3 32767\n"] {
        assert_eq!(read(marks).unwrap_err().code(), "map_stand_in", "{marks}");
    }
    let point = |k: usize, height: f64| [(k % 3) as f64, (k / 3) as f64, height];
    let points: Vec<_> = (0..9).map(|k| point(k, if k == 4 { -9999.0 } else { 0.1 * k as f64 })).collect();
    assert_eq!(HeightMap::from_points(&points).unwrap_err().code(), "map_stand_in");
    let points: Vec<_> = (0..9).map(|k| point(k, if k == 4 { f64::NAN } else { 0.1 * k as f64 })).collect();
    assert_eq!(HeightMap::from_points(&points).unwrap().missing(), 1);
    let grid = Grid::new([3, 3], [1.0, 1.0]).unwrap();
    let folder = Temporary::folder("sisters-npy");
    let path = folder.join("map.npy");
    viscocontact::output::write_npy(
        &path,
        &grid,
        &points.iter().map(|p| if p[2].is_nan() { -9999.0 } else { p[2] }).collect::<Vec<_>>(),
    )
    .unwrap();
    let file = std::fs::File::open(&path).unwrap();
    assert_eq!(HeightMap::from_npy(file, [1.0, 1.0], LengthUnit::Metre).unwrap_err().code(), "map_stand_in");
}

/// A sweep that is ended has the states that it told of, and the contact is in the last of them.
#[test]
fn sweeps_end_where_they_are_told_to() {
    use std::ops::ControlFlow;
    use viscocontact::sliding::SlidingSweep;
    let grid = Grid::new([64, 32], [8.0e-3, 4.0e-3]).unwrap();
    let mut motion = builder_of(&sphere(), grid, zener()).build_sliding().unwrap();
    let loads = [0.2, 0.3, 0.4].map(Load::force);
    let sweep = SlidingSweep::new([[0.01, 0.0], [0.02, 0.0]], loads);
    let mut told = 0;
    let table = motion
        .sweep_with(&sweep, |_, _| {
            told += 1;
            ControlFlow::Break(())
        })
        .unwrap();
    assert_eq!((told, table.states().len()), (1, 1));
    assert!((motion.fields().force() / table.states()[0].report.force - 1.0).abs() < 1e-9);
}
