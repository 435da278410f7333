//! Bad input gets its own error, and a failed step leaves the contact as it was.

use std::sync::Arc;

use viscocontact::prelude::*;

fn grid() -> Grid {
    Grid::square(24, 4.0e-3).unwrap()
}

fn sphere() -> Sphere {
    Sphere::new(10.0e-3).unwrap()
}

fn maxwell() -> Material {
    Material::incompressible(Maxwell::new(1.0e6, 1.0e6).unwrap())
}

fn contact_with(material: Material, settings: Settings) -> ViscoelasticContact {
    ViscoelasticContact::builder(grid()).geometry(&sphere()).material(material).settings(settings).build().unwrap()
}

/// Everything a caller can see of a contact.
fn state(contact: &ViscoelasticContact) -> (f64, f64, f64, usize, Vec<f64>, Vec<f64>, Load) {
    (
        contact.time(),
        contact.approach(),
        contact.force(),
        contact.contact_cells(),
        contact.pressure().to_vec(),
        contact.displacement().to_vec(),
        contact.load(),
    )
}

/// A failing step must not change the contact, nor the steps that follow.
fn assert_untouched(contact: &mut ViscoelasticContact, dt: f64, load: Load) -> Error {
    let (before, mut twin) = (state(contact), contact.clone());
    let error = contact.step(dt, load).unwrap_err();
    assert_eq!(state(contact), before);
    let small = Load::force(0.11);
    if let (Ok(a), Ok(b)) = (contact.step(0.01, small), twin.step(0.01, small)) {
        assert_eq!(a, b);
        assert_eq!(state(contact), state(&twin));
    }
    error
}

#[test]
fn build_says_what_is_missing_or_wrong() {
    let build = |builder: Builder| builder.build().unwrap_err();
    assert_eq!(build(ViscoelasticContact::builder(grid()).material(maxwell())), Error::Missing { part: "geometry" });
    assert_eq!(build(ViscoelasticContact::builder(grid()).geometry(&sphere())), Error::Missing { part: "material" });

    let good = || ViscoelasticContact::builder(grid()).geometry(&sphere()).material(maxwell());
    for tolerance in [0.0, -1.0, f64::NAN, 1.0, 1e-14] {
        let error = build(good().settings(Settings { tolerance, ..Settings::default() }));
        assert!(matches!(error, Error::OutOfRange { field: "Settings::tolerance", .. }), "{error}");
    }
    let error = build(good().settings(Settings { max_iterations: 0, ..Settings::default() }));
    assert!(matches!(error, Error::CountOutOfRange { field: "Settings::max_iterations", .. }), "{error}");

    let nan = FnGeometry::new(|_, _| f64::NAN);
    assert!(matches!(build(good().geometry(&nan)), Error::InvalidGap { cell: [0, 0], .. }));
    let nothing = FnGeometry::new(|_, _| f64::INFINITY);
    assert_eq!(build(good().geometry(&nothing)), Error::NothingToTouch { body: 0, cells: 576 });

    let other = Arc::new(InfluenceKernel::half_space(&Grid::square(24, 5.0e-3).unwrap()).unwrap());
    assert!(matches!(build(good().kernel(other)), Error::KernelMismatch { .. }));
}

#[test]
fn build_says_what_a_material_cannot_do() {
    let build = |material: Material, time_rule| {
        let settings = Settings { time_rule, ..Settings::default() };
        ViscoelasticContact::builder(grid()).geometry(&sphere()).material(material).settings(settings).build().map(drop)
    };
    let voigt = || Material::incompressible(KelvinVoigt::new(1.0e6, 1.0e6).unwrap());
    assert!(matches!(build(voigt(), TimeRule::Rectangle), Err(Error::NoElasticResponse { .. })));
    assert_eq!(build(voigt(), TimeRule::Backward), Ok(()));
    let closure = || Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 + t.sqrt())));
    let Err(Error::NoExponentialSeries { rheology }) = build(closure(), TimeRule::Exponential) else { panic!() };
    assert!(rheology.contains("FnRheology"));
    assert_eq!(build(closure(), TimeRule::Automatic), Ok(()));
    let negative = Material::incompressible(FnRheology::new(|t| t - 1.0));
    assert!(matches!(build(negative, TimeRule::Automatic), Err(Error::InvalidCompliance { .. })));
}

#[test]
fn steps_refuse_bad_arguments() {
    let mut contact = contact_with(maxwell(), Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    for dt in [-1e-9, f64::NAN, f64::INFINITY] {
        let error = assert_untouched(&mut contact, dt, Load::force(0.1));
        assert!(matches!(error, Error::OutOfRange { field: "time step", .. }), "{error}");
    }
    for force in [-1e-9, f64::NAN, f64::INFINITY] {
        let error = assert_untouched(&mut contact, 0.1, Load::force(force));
        assert!(matches!(error, Error::OutOfRange { field: "normal force", .. }), "{error}");
    }
}

#[test]
fn a_jump_needs_an_elastic_response() {
    let voigt = || Material::incompressible(KelvinVoigt::new(1.0e6, 1.0e6).unwrap());
    for time_rule in [TimeRule::Exponential, TimeRule::Backward] {
        let mut contact = contact_with(voigt(), Settings { time_rule, ..Settings::default() });
        let error = assert_untouched(&mut contact, 0.0, Load::force(0.1));
        assert!(matches!(error, Error::NoElasticResponse { .. }), "{error}");
        assert!(error.to_string().contains("ramp the load"));
    }
    let mut contact = contact_with(voigt(), Settings::default());
    let history = StepLoad::new(Load::force(0.1)).unwrap();
    let error = contact.follow(&history, Stepping::fixed(0.1), 1.0).next_step().unwrap_err();
    assert!(matches!(error, Error::NoElasticResponse { .. }));
}

#[test]
fn contact_at_the_edge_is_an_error_unless_allowed() {
    let mut contact = contact_with(maxwell(), Settings::default());
    contact.step(0.0, Load::force(0.5)).unwrap();
    let error = assert_untouched(&mut contact, 0.1, Load::force(50.0));
    let Error::ContactAtEdge { cells, time } = error else { panic!("{error}") };
    assert!(cells > 0 && time == 0.1);
    let mut allowed = contact_with(maxwell(), Settings { edge: Edge::Allow, ..Settings::default() });
    allowed.step(0.0, Load::force(50.0)).unwrap();
    assert_eq!(allowed.contact_cells(), 576);
}

#[test]
fn running_out_of_iterations_is_an_error_with_numbers() {
    for solver in [Solver::ActiveSet, Solver::PolonskyKeer] {
        let settings = Settings { tolerance: 1e-12, max_iterations: 2, solver, ..Settings::default() };
        let mut contact = contact_with(maxwell(), settings);
        let error = assert_untouched(&mut contact, 0.0, Load::force(0.5));
        let Error::NotConverged { iterations, residual, tolerance, .. } = error else { panic!("{error}") };
        assert!(iterations == 2 && residual > tolerance);
    }
}

#[test]
fn an_impossible_closure_is_caught_when_it_is_used() {
    let falling = Material::incompressible(FnRheology::new(|t| 1.0e-6 * (1.0 - 0.1 * t).max(0.5)));
    let mut contact = contact_with(falling, Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    let error = assert_untouched(&mut contact, 1.0, Load::force(0.1));
    assert!(matches!(error, Error::InvalidCompliance { .. }), "{error}");
}

#[test]
fn a_bad_geometry_leaves_the_old_one() {
    let mut contact = contact_with(maxwell(), Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    let before = state(&contact);
    assert!(contact.set_geometry(&FnGeometry::new(|x1, _| x1.sqrt())).is_err());
    assert_eq!(state(&contact), before);
    let mut gap = vec![0.0; 576];
    contact.gap_into(&mut gap).unwrap();
    assert!(gap.iter().all(|h| h.is_finite()));
    assert!(matches!(contact.gap_into(&mut gap[1..]), Err(Error::WrongLength { field: "gap", len: 575, .. })));
}

#[test]
fn a_moved_indenter_presses_elsewhere() {
    let mut contact = contact_with(maxwell(), Settings::default());
    contact.step(0.0, Load::force(0.1)).unwrap();
    contact.set_geometry(&Shifted::new(sphere(), [0.5e-3, -0.5e-3]).unwrap()).unwrap();
    contact.step(0.1, Load::force(0.1)).unwrap();
    let center = contact.moment().map(|moment| moment / contact.force());
    // the dent left behind makes it lean back a little
    assert!((0.4e-3..0.51e-3).contains(&center[0]) && (-0.51e-3..-0.4e-3).contains(&center[1]), "{center:?}");
}

#[test]
fn load_tables_are_checked() {
    let at = |t: f64, w: f64| (t, Load::force(w));
    let error = |table: &[(f64, Load)]| PiecewiseLinear::new(table).unwrap_err();
    assert!(matches!(error(&[at(0.0, 1.0)]), Error::WrongLength { field: "load table", len: 1, .. }));
    assert!(matches!(error(&[at(0.0, 1.0), at(-1.0, 1.0)]), Error::OutOfOrder { index: 1, .. }));
    assert!(matches!(error(&[at(0.0, 1.0), at(0.0, 2.0), at(0.0, 3.0)]), Error::OutOfOrder { index: 2, .. }));
    assert!(matches!(
        error(&[at(0.0, 1.0), at(f64::NAN, 1.0)]),
        Error::OutOfRange { field: "time in the load table", .. }
    ));
    assert!(matches!(error(&[at(0.0, 1.0), at(1.0, -1.0)]), Error::OutOfRange { field: "normal force", .. }));
    let load = Load::force(1.0);
    assert!(matches!(Ramp::new(load, load, 0.0), Err(Error::OutOfRange { field: "duration of the ramp", .. })));
    assert!(matches!(Sinusoid::new(load, load, -1.0), Err(Error::OutOfRange { field: "frequency", .. })));
    assert!(matches!(StepLoad::new(Load::force(f64::NAN)), Err(Error::OutOfRange { field: "normal force", .. })));
    let history = FnHistory::new(|_| Load::force(1.0));
    assert!(matches!(history.with_breakpoints(&[f64::NAN]), Err(Error::OutOfRange { field: "breakpoint", .. })));
}

#[test]
fn everything_travels_between_threads() {
    fn assert_send_sync<T: Send + Sync + std::fmt::Debug>() {}
    fn assert_clone<T: Clone>() {}
    assert_send_sync::<ViscoelasticContact>();
    assert_clone::<ViscoelasticContact>();
    assert_send_sync::<InfluenceKernel>();
    assert_send_sync::<Material>();
    assert_send_sync::<Box<dyn Rheology>>();
    assert_send_sync::<Box<dyn Geometry>>();
    assert_send_sync::<Box<dyn LoadHistory>>();
    assert_send_sync::<Error>();
}
