//! What is kept of elastic states, and of contacts on them: files, snapshots, states within a step.

use crate::common::refused::says;
use std::sync::Arc;

use crate::common::Temporary;
use crate::friction::kept;
use viscocontact::ErrorKind;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};
use viscocontact::states::{ElasticStates, Reach, StatesContact, Sweep};

fn rough_states(kept: bool) -> Arc<ElasticStates> {
    let grid = Grid::square(24, 1.0).unwrap();
    let rough = Rough::new(&grid, RoughSpec::new(0.5, 0.2, Roughness::RmsHeight(0.02))).unwrap();
    let sweep = Sweep::new(grid.clone(), &rough).kernel(InfluenceKernel::periodic(&grid).unwrap()).accuracy(1e-3);
    let sweep = if kept { sweep.keep_pressures() } else { sweep };
    sweep.run(Reach::Level(0.05)).unwrap()
}

fn material() -> Material {
    Material::incompressible(GeneralizedMaxwell::new(0.05, &[(0.1, 0.1), (0.1, 1.0), (0.05, 10.0)]).unwrap())
}

fn load(step: u32) -> (f64, Load) {
    let wave = 0.5 + 0.5 * (1.7 * f64::from(step)).sin();
    let load = if step % 3 == 2 { Load::spring(0.05, 0.02 * (1.0 + wave)) } else { Load::force(2.0e-3 * wave) };
    (if step.is_multiple_of(5) { 0.0 } else { 0.1 * (1.0 + wave) }, load)
}

fn advanced(contact: &mut StatesContact, steps: std::ops::Range<u32>) {
    for step in steps {
        let (dt, load) = load(step);
        contact.step(dt, load).unwrap();
    }
}

/// A contact restored or resumed goes on by the same bits, sheared or not.
#[test]
fn contacts_on_states_come_back_to_the_last_bit() {
    type Kind<'a> = (&'a dyn Fn() -> StatesContact, fn(&mut StatesContact, std::ops::Range<u32>));
    let (states, folder) = (rough_states(false), Temporary::folder("states-checkpoint"));
    let path = folder.join("state");
    let plain = || StatesContact::new(&states, &material()).unwrap();
    let kinds: [Kind<'_>; 2] = [(&plain, advanced), (&|| kept::contact(0.4), kept::advance)];
    for (new, advanced) in kinds {
        let seen = |contact: &StatesContact| (format!("{contact:?}"), format!("{:?}", contact.lateral_work()));
        let mut contact = new();
        advanced(&mut contact, 0..8);
        let mut start = contact.clone();
        contact.save(&path).unwrap();
        let bytes = contact.to_bytes().unwrap();
        assert!(std::fs::read(&path).unwrap() == bytes);
        advanced(&mut contact, 8..20);
        let end = seen(&contact);
        contact.restore(&start).unwrap();
        advanced(&mut contact, 8..20);
        assert_eq!(seen(&contact), end);
        start.restore(&contact).unwrap();
        assert_eq!(format!("{start:?}"), end.0);
        let mut other = new();
        says(&other.restore(&start).unwrap_err(), "other_contact", "the snapshot was taken");
        assert_eq!(other.resume_bytes(b"other").unwrap_err().code(), "checkpoint_foreign");
        for from_bytes in [false, true] {
            let again = if from_bytes { other.resume_bytes(&bytes) } else { other.resume(&path) };
            again.unwrap();
            advanced(&mut other, 8..20);
            assert_eq!(seen(&other), end);
        }
    }
    // of another coefficient, or of none
    for mut wrong in [kept::contact(0.5), kept::smooth().with_linear_steps()] {
        let error = wrong.resume(&path).unwrap_err();
        assert_eq!((error.code(), error.name()), ("checkpoint_other_scene", Some("friction")), "{error}");
    }
    // a contact within a step is one of its clones
    let history = Ramp::new(Load::force(0.0), Load::force(1.0e-3), 1.0).unwrap();
    let (mut other, mut apart) = (plain(), plain());
    apart.clone_from(&other);
    let mut run = apart.follow(&history, Stepping::adaptive(1e-2), 1.0);
    let time = run.next_step().unwrap().unwrap().time;
    let within = run.within_step(0.7 * time).unwrap();
    other.restore(&within).unwrap();
    assert_eq!(other.time(), 0.7 * time);
    // of another material, other states
    advanced(&mut other, 0..8);
    other.save(&path).unwrap();
    let stiffer = Material::incompressible(Maxwell::with_time(1.0, 1.0).unwrap());
    let mut wrong = StatesContact::new(&states, &stiffer).unwrap();
    assert!(matches!(wrong.resume(&path), Err(Error::Checkpoint { .. })));
    let table = ElasticStates::from_table(&[(1.0, 1.0, 1.0, 1.0), (2.0, 1.5, 2.0, 2.0)]).unwrap();
    assert_eq!(StatesContact::new(&table, &material()).unwrap().resume(&path).unwrap_err().kind(), ErrorKind::File);
}

/// A saved state is taken up by a contact of the same curve, time rule and temperature only, with exact states too.
#[test]
fn states_are_resumed_by_the_same_contact_only() {
    let folder = Temporary::folder("states-resumed");
    let path = folder.join("state");
    // l = k δ^1.5, with another k but at the last state
    let row = |depth: f64, k: f64| (depth.powf(1.5) * k, depth, 1.5 * depth.sqrt() * k, depth);
    let table = |below: f64| {
        let depth = |k: i32| 1.0e-3 * 4000.0_f64.powf(f64::from(k) / 40.0);
        let rows: Vec<_> = (0..=40).map(|k| row(depth(k), if k == 40 { 1.0 } else { below })).collect();
        ElasticStates::from_table(&rows).unwrap()
    };
    let warming = |by: f64| {
        let law = TimeTemperature::wlf(10.0, 60.0, 300.0).unwrap();
        TemperatureHistory::function(law, move |t| 300.0 + by * t, &[]).unwrap()
    };
    let contact = |below: f64| StatesContact::new(&table(below), &material()).unwrap();
    let others: [(&str, StatesContact); 4] = [
        ("elastic states", contact(0.5)),
        ("time rule", contact(1.0).with_linear_steps()),
        ("temperature", contact(1.0)),
        ("temperature", contact(1.0).with_temperature(warming(1.1))),
    ];
    let mut saved = contact(1.0).with_temperature(warming(1.0));
    for step in 1..10 {
        saved.step(0.1, Load::approach(0.1 * f64::from(step))).unwrap();
    }
    saved.save(&path).unwrap();
    for (named, mut other) in others {
        let before = format!("{other:?}");
        let error = other.resume(&path).unwrap_err();
        assert_eq!((error.code(), error.name()), ("checkpoint_other_scene", Some(named)), "{error}");
        assert_eq!(format!("{other:?}"), before);
    }
    let mut again = contact(1.0).with_temperature(warming(1.0));
    again.resume(&path).unwrap();
    for contact in [&mut saved, &mut again] {
        contact.step(0.1, Load::approach(1.2)).unwrap();
    }
    assert_eq!(format!("{saved:?}"), format!("{again:?}"));

    let states = rough_states(false);
    let exact = || StatesContact::new(&states, &material()).unwrap().with_exact_states().unwrap();
    let (mut contact, mut again) = (exact(), exact());
    advanced(&mut contact, 0..8);
    contact.save(&path).unwrap();
    again.resume(&path).unwrap();
    for contact in [&mut contact, &mut again] {
        advanced(contact, 8..12);
    }
    assert!((again.force() / contact.force() - 1.0).abs() < 1e-6, "{} {}", again.force(), contact.force());
    assert!((again.approach() / contact.approach() - 1.0).abs() < 1e-6, "{} {}", again.approach(), contact.approach());
}

/// States read from a file or from bytes carry the same contacts, and the same pressures.
#[test]
fn states_in_files_are_the_states() {
    use viscocontact::output::{Metadata, read_states, states_from_bytes, states_to_bytes, write_states};

    let folder = Temporary::folder("states-npz");
    let path = folder.join("states.npz");
    for kept in [false, true] {
        let states = rough_states(kept);
        write_states(&path, &states, &Metadata::new("rough").note("seed", "0")).unwrap();
        let read = read_states(&path).unwrap();
        let in_memory = states_from_bytes(&states_to_bytes(&states).unwrap()).unwrap();
        assert!(read.states() == states.states() && in_memory.states() == states.states());
        assert_eq!(read.interpolation_error(), states.interpolation_error());
        assert_eq!(read.grid(), states.grid());
        let [mut one, mut other] = [&states, &read].map(|states| StatesContact::new(states, &material()).unwrap());
        for step in 0..12 {
            let (dt, load) = load(step);
            let report = one.step(dt, load).unwrap();
            assert!((report.contact_cells > 0) == (report.force > 0.0));
            assert_eq!(report, other.step(dt, load).unwrap());
        }
        let no_pressures = |error: Error| error.code() == "states_no_pressures";
        match kept {
            true => assert_eq!(one.pressure().unwrap(), other.pressure().unwrap()),
            false => assert!(no_pressures(one.pressure().unwrap_err()) && no_pressures(other.pressure().unwrap_err())),
        }
        assert!(other.fields(0.0).unwrap_err().code() == "states_no_scene");
    }
    // a layer keeps its Poisson's ratio
    let (grid, layer) = (Grid::square(16, 2.0).unwrap(), Layer::bonded_to_rigid(0.5, 0.3).unwrap());
    let sweep = Sweep::new(grid.clone(), &Sphere::new(10.0).unwrap());
    let states = sweep.kernel(InfluenceKernel::layer(&grid, layer).unwrap()).run(Reach::Level(0.01)).unwrap();
    write_states(&path, &states, &Metadata::default()).unwrap();
    assert_eq!(StatesContact::new(&read_states(&path).unwrap(), &material()).unwrap_err().kind(), ErrorKind::Value);
    assert_eq!(read_states(folder.join("absent.npz")).unwrap_err().kind(), ErrorKind::File);
    assert_eq!(states_from_bytes(b"other").unwrap_err().kind(), ErrorKind::File);
}

/// Tables take contacts on elastic states, with what acts along the surface; what these do not have is empty.
#[test]
fn histories_of_states_are_written() {
    let folder = Temporary::folder("states-history");
    let (path, mut contact) = (folder.join("history.csv"), kept::contact(0.4));
    let mut table =
        CsvHistory::create(&path, &Metadata::new("rubbed"), &contact, &["level [m2]"], Earlier::Refuse).unwrap();
    for _ in 0..3 {
        let report = contact.step_sheared(0.1, Load::force(1.0), Load::force(0.3)).unwrap();
        assert_eq!(report.dt, 0.1);
        table.record(&contact, &report, &[contact.level()]).unwrap();
    }
    let smooth = kept::smooth();
    let report = smooth.report(0.0, Load::force(0.0));
    assert_eq!(table.record(&smooth, &report, &[0.0]).unwrap_err().kind(), ErrorKind::File);
    let text = std::fs::read_to_string(path).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 4);
    let field = |row: usize, name: &str| rows[row][rows[0].iter().position(|heading| *heading == name).unwrap()];
    let value = |row: usize, name: &str| field(row, name).parse::<f64>().unwrap();
    let work = contact.lateral_work();
    for (name, expected) in [
        ("force [N]", contact.force()),
        ("contact area [m2]", contact.contact_area()),
        ("level [m2]", contact.level()),
        ("force along [N]", contact.lateral_force()),
        ("displacement along [m]", contact.lateral_displacement()),
        ("slid [m]", 0.0),
        ("stick area [m2]", contact.stick_area()),
        ("work along [J]", work.work),
        ("loss by slip [J]", work.slip),
    ] {
        assert_eq!(value(3, name), expected, "{name}");
    }
    assert!(value(1, "displacement along [m]") < value(3, "displacement along [m]"));
    assert_eq!(field(3, "max pressure [Pa]"), "");
}

/// Between the states of a table whose stiffnesses contradict its depths, the depth rises nevertheless.
#[test]
fn depths_rise_whatever_a_table_holds() {
    for stiffnesses in [[1e-9, 1e3, 1e-9], [1e3, 1e-9, 1e3], [1e-9; 3]] {
        let rows = [(1e-6, 1e-5), (2e-6, 1.5e-5), (1e-5, 2e-5)];
        let table: Vec<_> = rows.iter().zip(stiffnesses).map(|(&(l, d), stiffness)| (l, d, stiffness, 1e-9)).collect();
        let states = ElasticStates::from_table(&table).unwrap();
        let depths: Vec<f64> = (0..=400).map(|k| states.approach(1e-8 * 10f64.powf(f64::from(k) / 133.4))).collect();
        assert!(depths.is_sorted() && depths.iter().all(|depth| depth.is_finite()), "{stiffnesses:?}");
    }
}
