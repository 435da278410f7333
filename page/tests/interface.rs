//! The functions that the page calls, natively: their values are those of programs that use the crate directly.

use viscocontact::contact::Settings;
use viscocontact::prelude::*;
use viscocontact_page as page;
use viscocontact_page::settings::{Key, PARAMETERS, Settings as Scene};
use viscocontact_page::simulation::Simulation;

fn run(values: &[(Key, f64)], load: &[(f64, f64)]) -> Simulation {
    let mut simulation = Simulation::new(&Scene::with(values, load)).unwrap();
    while simulation.advance().unwrap() {}
    simulation
}

fn built(material: Material, shape: &dyn Geometry) -> ViscoelasticContact {
    let grid = Grid::square(32, 4.0e-3).unwrap();
    let solver = Settings::default().with_tolerance(1e-10);
    ViscoelasticContact::builder(grid).geometry(shape).material(material).settings(solver).build().unwrap()
}

#[test]
fn a_held_depth_is_the_program_of_the_tour() {
    let values = [(Key::Material, 1.0), (Key::Time, 0.2), (Key::Duration, 0.2), (Key::Hold, 0.1), (Key::Steps, 2.0)];
    let seen = run(&[&values[..], &[(Key::Cells, 32.0)]].concat(), &[(0.0, 0.5)]).frames;

    let rubber = Zener::with_time(1.0e6, 0.5e6, 0.2).unwrap();
    let ball = Sphere::new(10.0e-3).unwrap();
    let mut contact = built(Material::constant_poisson(rubber, 0.5).unwrap(), &ball);
    for (k, dt) in [0.0, 0.1, 0.0, 0.1].into_iter().enumerate() {
        let load = if k < 2 { Load::force(0.5) } else { Load::approach(contact.approach()) };
        let report = contact.step(dt, load).unwrap();
        let expected =
            [report.time, report.force, report.approach, contact.contact_area(), contact.fields().max_pressure()];
        assert_eq!(seen.series.each_ref().map(|series| series[k]), expected);
        assert_eq!(seen.pressure[k], contact.pressure());
        assert_eq!(seen.lines[k][0], contact.fields().profile(Axis::X1, 0.0).unwrap().pressure);
    }
    assert_eq!(seen.pressure.len(), 4);
}

#[test]
fn a_friction_loop_is_that_of_elastic_states() {
    let values =
        [(Key::Friction, 0.6), (Key::Amplitude, 20.0), (Key::Period, 0.5), (Key::Duration, 0.5), (Key::Cells, 32.0)];
    let [displacement, force] = run(&values, &[(0.0, 1.0)]).friction;

    let oil = Material::constant_poisson(Maxwell::with_time(1.0e6, 1.0).unwrap(), 0.5).unwrap();
    let motion = FnHistory::new(|t: f64| Load::approach(20.0 * 1e-6 * (std::f64::consts::TAU * t / 0.5).sin()));
    let states = ElasticStates::sphere(10.0e-3).unwrap();
    let contact = StatesContact::new(&states, &oil).unwrap().with_estimated_friction(0.6).unwrap();
    let mut contact = contact.sheared_by(motion).unwrap();
    let held = PiecewiseLinear::new(&[(0.0, Load::force(1.0)), (0.5, Load::force(1.0))]).unwrap();
    let mut run = contact.follow(&held, Stepping::fixed(0.5 / 100.0), 0.5);
    let mut k = 0;
    while run.next_step().unwrap().is_some() {
        let expected = [run.contact().lateral_displacement(), run.contact().lateral_force()];
        assert_eq!([displacement[k], force[k]], expected);
        k += 1;
    }
    assert_eq!(k, displacement.len());
    assert!(force.iter().any(|&q| q.abs() > 0.05));
}

/// What the page reads of the memory that a function points to.
fn says(call: impl FnOnce()) -> String {
    call();
    assert!(!page::text().is_null());
    page::with_text(str::to_owned)
}

#[test]
fn numbers_go_in_and_come_out() {
    let description = says(|| _ = page::describe());
    assert!(description.starts_with(r#"{"parameters":[{"key":"shape""#), "{description}");
    assert_eq!(page::frames(), 0);
    page::set(Key::Cells as usize, 16.0);
    page::set(Key::Steps as usize, 3.0);
    page::clear_load();
    page::add_load(0.0, 0.1);
    assert_eq!(page::start(), 1);
    let mut steps = 0;
    while page::advance() == 1 {
        steps += 1;
    }
    assert_eq!([page::frames(), steps], [4, 4]);
    assert!(says(|| _ = page::report()).contains("error in time"));
    // nothing is beyond the ends
    assert_eq!(page::loop_points(), 0);
    assert!(!page::pressure(99).is_null() && !page::series(99).is_null() && !page::line(99, 99).is_null());
    page::set(999, 1.0);
}

#[test]
fn what_is_refused_says_why_and_the_page_goes_on() {
    for (key, value, expected) in [
        (Key::Cells, 16.5, "not a whole number"),
        (Key::Cells, 1e6, "outside the range of 8 to 256"),
        (Key::Radius, f64::NAN, "outside the range"),
        (Key::Shape, -1.0, "outside the range"),
        (Key::Duration, f64::INFINITY, "outside the range"),
    ] {
        let start = PARAMETERS[key as usize].default;
        page::set(key as usize, value);
        assert_eq!(page::start(), -1);
        let text = page::with_text(str::to_owned);
        assert!(text.contains(expected), "{text}");
        page::set(key as usize, start);
    }
    for load in [vec![], vec![(0.0, f64::NAN)], vec![(1.0, 1.0), (0.0, 1.0)], vec![(f64::NAN, 1.0)]] {
        page::clear_load();
        load.iter().for_each(|&(time, value)| page::add_load(time, value));
        assert_eq!(page::start(), -1, "{load:?}");
    }
    page::clear_load();
    page::add_load(0.0, 1.0);
    assert_eq!(page::start(), 1);
}

#[test]
fn every_scene_runs_to_its_end_or_says_why_not() {
    for (name, _, settings) in page::scenes::scenes() {
        let mut simulation = Simulation::new(&settings).unwrap();
        let refused = loop {
            match simulation.advance() {
                Ok(true) => {}
                Ok(false) => break None,
                Err(error) => break Some(error),
            }
        };
        match refused {
            None => assert_eq!(simulation.frames.series[0].last(), Some(&settings.get(Key::Duration)), "{name}"),
            Some(error) => assert!(
                name == "Too small a grid" && error.ends_with(": enlarge the side of the grid"),
                "{name}: {error}"
            ),
        }
    }
}
