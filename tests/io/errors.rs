//! Bad input gets its own error, and a failed step leaves the contact as it was.

use crate::common::fields::gap;
use crate::common::refused::{field, refused, says};
use crate::common::watched_runs::seen;
use crate::common::{builder_on, maxwell, sphere_on};
use std::process::Command;

use viscocontact::ErrorKind;
use viscocontact::prelude::*;

fn grid() -> Grid {
    Grid::square(24, 4.0e-3).unwrap()
}

/// A failing step must not change the contact, nor the steps that follow, successful or not: up, and down so
/// that cells leave.
fn assert_untouched(contact: &mut ViscoelasticContact, dt: f64, load: Load) -> Error {
    let (before, mut twin) = (seen(contact), contact.clone());
    let error = contact.step(dt, load).unwrap_err();
    assert_eq!(seen(contact), before);
    for force in [0.11, 0.05, 0.02] {
        let small = Load::force(force);
        assert_eq!(contact.step(0.01, small), twin.step(0.01, small));
        assert_eq!(seen(contact), seen(&twin));
    }
    error
}

/// What else is missing or wrong is a row of `mistakes`.
#[test]
fn settings_out_of_range_are_named() {
    let settings = |settings: Settings| field(builder_on(grid(), maxwell()).settings(settings).build());
    for tolerance in [0.0, -1.0, f64::NAN, 1.0, 1e-14] {
        assert_eq!(settings(Settings::default().with_tolerance(tolerance)), "Settings::tolerance");
    }
    assert_eq!(settings(Settings::default().with_max_iterations(0)), "Settings::max_iterations");
}

#[test]
fn build_says_what_a_material_cannot_do() {
    let closure = || Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 + t.sqrt())));
    // nor as one of two bodies, of which the other has a series
    let power_law = Material::incompressible(PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap());
    for body in [closure(), power_law] {
        let builder = || builder_on(grid(), body.clone());
        let both = builder_on(grid(), maxwell()).counter_body(body.clone());
        for error in [builder().memory().err(), builder().build().err(), both.build().err()].map(Option::unwrap) {
            assert!(error.code() == "material_no_exponential_series", "{error}");
            assert!(error.to_string().contains("Builder::times"), "{error}");
        }
    }
    let timed = |times| builder_on(grid(), closure()).times(times).build().map(drop);
    assert_eq!(timed(1e-3..=1e3), Ok(()));
    for times in [0.0..=1.0, -1.0..=1.0, f64::NAN..=1.0, 1.0..=f64::INFINITY, 1e-200..=1.0, 2.0..=1.0] {
        assert!(matches!(timed(times.clone()), Err(Error::OutOfRange { .. })), "{times:?}");
    }
    for series_tolerance in [0.0, 1e-9, 0.2, f64::NAN] {
        let settings = Settings::default().with_series_tolerance(series_tolerance);
        let builder = builder_on(grid(), closure()).times(1e-3..=1e3).settings(settings);
        assert_eq!(field(builder.build()), "Settings::series_tolerance");
    }
    let negative = Material::incompressible(FnRheology::new(|t| t - 1.0));
    let built = builder_on(grid(), negative).times(1e-3..=1e3).build().map(drop);
    assert!(built.as_ref().is_err_and(|error| error.code() == "material_invalid_compliance"), "{built:?}");
}

#[test]
fn steps_refuse_bad_arguments() {
    let mut contact = sphere_on(grid(), maxwell(), Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    let mut step = |dt, load, named| refused([(Some(assert_untouched(&mut contact, dt, load)), named)]);
    for bad in [-1e-9, f64::NAN, f64::INFINITY] {
        step(bad, Load::force(0.1), "time step");
        step(0.1, Load::force(bad), "normal force");
    }
    for stiffness in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        step(0.1, Load::spring(stiffness, 1.0), "stiffness of the spring");
    }
    step(0.1, Load::spring(1.0, f64::NAN), "drive of the spring");
}

#[test]
fn a_bad_geometry_leaves_the_old_one() {
    let mut contact = sphere_on(grid(), maxwell(), Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    let before = seen(&contact);
    assert_eq!(contact.set_geometries(&[&FnGeometry::new(|x1, _| x1.sqrt())]).unwrap_err().kind(), ErrorKind::Value);
    assert_eq!(seen(&contact), before);
    let mut gap = gap(contact.fields());
    assert!(gap.iter().all(|h| h.is_finite()));
    assert!(matches!(contact.fields().gap_into(&mut gap[1..]), Err(Error::WrongLength { field: "gap", len: 575, .. })));
}

#[test]
fn loads_and_shapes_are_refused_by_name() {
    let at = |t: f64, w: f64| (t, Load::force(w));
    let twice = PiecewiseLinear::new(&[at(0.0, 1.0), at(0.0, 2.0), at(0.0, 3.0)]);
    assert!(matches!(twice, Err(Error::OutOfOrder { index: 2, .. })));
    let load = Load::force(1.0);
    refused([
        (Ramp::new(load, load, 0.0).err(), "duration of the ramp"),
        (Sinusoid::about(load, -1.0, 1.0).err(), "amplitude"),
        (Periodic::square(load, load, 1.0, 1.0).err(), "duty cycle"),
        (Periodic::square(load, load, f64::NAN, 0.5).err(), "period"),
        (Periodic::triangle(load, load, -1.0).err(), "period"),
        (Periodic::sawtooth(load, load, f64::INFINITY).err(), "period"),
        (StepLoad::new(Load::force(f64::NAN)).err(), "normal force"),
        (FnHistory::new(|_| Load::force(1.0)).with_breakpoints(&[f64::NAN]).err(), "breakpoint"),
        // messages print twice the length of a shape: lengths whose double overflows
        (Sphere::new(1.2e308).err(), "sphere radius"),
        (Cylinder::new(1.2e308).err(), "cylinder radius"),
        (Ellipsoid::new(1.0, 1.2e308).err(), "radius of curvature along x2"),
        (Wavy::new(1.2e308, 1.0).err(), "amplitude along x1"),
    ]);
    let far = Shifted::new(Sphere::new(1e300).unwrap(), [1e271, 1e300]).unwrap();
    assert!(!far.initial_gap(0.1, 0.1).is_nan());
}

#[test]
fn everything_travels_between_threads() {
    fn assert_send_sync<T: Send + Sync + std::fmt::Debug>() {}
    fn assert_clone<T: Clone>() {}
    fn assert_send<T: Send>() {}
    assert_send::<Run<'static>>();
    assert_send_sync::<ViscoelasticContact>();
    assert_clone::<ViscoelasticContact>();
    assert_send_sync::<InfluenceKernel>();
    assert_send_sync::<Material>();
    assert_send_sync::<Box<dyn Rheology>>();
    assert_send_sync::<Box<dyn Geometry>>();
    assert_send_sync::<Box<dyn LoadHistory>>();
    assert_send_sync::<Error>();
}

/// A history that names a corner in the past would stop the run, or turn it back.
#[test]
fn corners_in_the_past_are_refused() {
    #[derive(Debug)]
    struct Stuck;
    impl LoadHistory for Stuck {
        fn at(&self, _: f64) -> Load {
            Load::force(0.1)
        }
        fn next_breakpoint(&self, _: f64) -> Option<f64> {
            Some(0.25)
        }
    }
    let mut contact = sphere_on(grid(), maxwell(), Settings::default());
    let mut run = contact.follow(&Stuck, Stepping::fixed(0.2), 1.0);
    let error = loop {
        if let Err(error) = run.next_step() {
            break error;
        }
    };
    says(
        &error,
        "load_invalid_breakpoint",
        "the load history returned 0.25 s as the first breakpoint after t = 0.25 s: ",
    );
}

/// What a program prints whose `main` returns an error: the message, what to do, and the causes.
#[test]
fn a_program_that_returns_an_error_says_what_to_do() {
    let printed = |arguments: &[&str]| {
        let ended = Command::new(env!("CARGO_BIN_EXE_failing_program")).args(arguments).output().unwrap();
        assert!(!ended.status.success() && ended.stdout.is_empty());
        String::from_utf8(ended.stderr).unwrap()
    };
    let widths = "the grid is 0.004 m × 0.004 m, the load needs about 0.011 m × 0.011 m";
    let advice = "enlarge the grid, give a surface that repeats a periodic body (InfluenceKernel::periodic), or set Settings::edge to Edge::Allow if the body ends there";
    let expected =
        format!("Error: at t = 0 s the contact touches the edge of the grid on 60 cells; {widths}: {advice}\n");
    assert_eq!(printed(&[]), expected);
    let (path, cause) = ("no/such/folder/history.csv", "the folder no/such/folder does not exist: create it first");
    assert_eq!(printed(&[path]), format!("Error: {path} cannot be written: {cause}\n"));
}
