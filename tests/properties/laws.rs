//! Every rheology, geometry and load history of the crate, and random ones, against their laws.

use crate::common::spectra::spectra;
use crate::materials::spectra::assert_reciprocal;
use approx::assert_abs_diff_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSpectrum, PronyTerm, TimeTemperature, laws, library};
use viscocontact::{geometry, load};

fn models() -> Vec<(&'static str, Box<dyn Rheology>)> {
    let terms = [(0.5, 1e-3), (0.4, 1.0)].map(|(share, time)| PronyTerm { share, time });
    let warm = TimeTemperature::wlf(17.44, 51.6, 373.15).unwrap();
    let zener = || Zener::new(1.0e9, 1.0e6, 1.0e6).unwrap();
    vec![
        ("Elastic", Box::new(Elastic::new(1.0e6).unwrap())),
        ("Maxwell", Box::new(Maxwell::new(1.0e6, 1.0e6).unwrap())),
        ("KelvinVoigt", Box::new(KelvinVoigt::new(1.0e6, 1.0e6).unwrap())),
        ("Zener", Box::new(zener())),
        ("Burgers", Box::new(Burgers::new(1.0e9, 1.0e12, 1.0e8, 1.0e8).unwrap())),
        ("GeneralizedKelvin", Box::new(GeneralizedKelvin::new(0.0, 1.0e-9, &[(1.0e-6, 0.1), (2.0e-6, 10.0)]).unwrap())),
        ("GeneralizedMaxwell", Box::new(GeneralizedMaxwell::new(0.0, &[(1.0e9, 1e-6), (1.0e6, 1.0)]).unwrap())),
        ("Elastic::young", Box::new(Elastic::young(3.0e6, 0.49).unwrap())),
        ("Maxwell::with_time", Box::new(Maxwell::with_time(1.0e6, 0.3).unwrap())),
        ("KelvinVoigt::with_time", Box::new(KelvinVoigt::with_time(1.0e6, 0.3).unwrap())),
        ("Zener::with_time", Box::new(Zener::with_time(1.0e9, 1.0e6, 0.3).unwrap())),
        ("Zener::relaxing", Box::new(Zener::relaxing(1.0e9, 1.0e6, 1.0e-3).unwrap())),
        ("Burgers::with_times", Box::new(Burgers::with_times((1.0e9, 1.0e3), (1.0e8, 1.0)).unwrap())),
        ("prony", Box::new(GeneralizedMaxwell::prony(1.0e9, &terms).unwrap())),
        ("FractionalMaxwell::with_time", Box::new(FractionalMaxwell::with_time(1.0e9, 0.1, 0.4).unwrap())),
        ("FractionalZener::relaxing", Box::new(FractionalZener::relaxing(1.0e9, 1.0e7, 1.0e-4, 0.5).unwrap())),
        ("PowerLaw", Box::new(PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap())),
        ("FractionalMaxwell", Box::new(FractionalMaxwell::new(1.0e9, 1.0e8, 0.4).unwrap())),
        ("FractionalZener", Box::new(FractionalZener::new(1.0e9, 1.0e6, 1.0e-2, 0.5).unwrap())),
        ("Kww", Box::new(Kww::new(0.5e-9, 2.0e-9, 10.0, 0.33).unwrap())),
        ("LogCreep", Box::new(LogCreep::new(1.0e-9, 1.0e-10, 0.1).unwrap())),
        ("SlowCreep", Box::new(SlowCreep::new(1.0e-9, 1.0e-10, 10.0, 0.3).unwrap())),
        ("FnRheology", Box::new(FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t.sqrt())))),
        ("ShiftedRheology", Box::new(warm.at(zener(), 383.15).unwrap())),
        ("Arc", Box::new(std::sync::Arc::new(zener()))),
    ]
}

/// Fails with the name of what breaks a law.
fn obeys(name: &str, verdict: laws::Verdict) {
    verdict.unwrap_or_else(|violation| panic!("{name}: {violation}"));
}

/// Every model, and what a contact runs on: its series over ten decades, with its error, its laws and its relaxation.
#[test]
fn every_model_and_its_series_obey_every_law() {
    let times = laws::log_times(1e-5, 1e5);
    for (name, model) in models() {
        obeys(name, laws::all(&*model, &times));
        let series = model.series(1e-5..=1e5, 1e-4).unwrap_or_else(|error| panic!("{name}: {error}"));
        println!("{name}: {}", series.report());
        assert!(series.report().max_misfit() <= 1e-4, "{name}");
        for &t in &times {
            let relative = series.creep_compliance(t) / model.creep_compliance(t) - 1.0;
            assert!(relative.abs() <= 1e-4, "{name} at {t:e}: {relative:e}");
        }
        if model.creep_compliance(0.0) > 0.0 {
            assert_eq!(series.creep_compliance(0.0), model.creep_compliance(0.0), "{name}: elastic response");
        }
        obeys(&format!("series of {name}"), laws::all(&series, &times));
        assert_reciprocal(series.spectrum());
    }
}

#[test]
fn published_materials_are_as_printed() {
    let times = laws::log_times(1e-12, 1e12);
    for material in library::all() {
        let name = material.name;
        let body = material.rheology(0.4).unwrap();
        obeys(name, laws::all(&body, &times));
        assert!(!material.reference.is_empty() && !material.remark.is_empty());
        assert_eq!(library::find(&name.to_uppercase()).unwrap().name, name);
    }
    let terms: Vec<usize> = library::all().iter().map(|material| material.terms().len()).collect();
    assert_eq!(terms, [11, 24, 30, 28, 8]);
    // glassy moduli, added up by hand: tension of PMMA 2239.47 MPa, shear of the epoxy 891 MPa, E(0) of the adhesive
    let glassy = |name: &str| {
        let material = library::find(name).unwrap();
        material.equilibrium() + material.terms().iter().map(|(modulus, _)| modulus).sum::<f64>()
    };
    assert_abs_diff_eq!(glassy("PMMA") / 2239.47e6, 1.0, epsilon = 1e-12);
    assert_abs_diff_eq!(glassy("epoxy") / 891.0e6, 1.0, epsilon = 1e-12);
    assert_abs_diff_eq!(glassy("adhesive") / (9115.8e6 / 2.7), 1.0, epsilon = 1e-9);
    assert_abs_diff_eq!(glassy("polystyrene rings") / 1.264147007e6, 1.0, epsilon = 1e-12);
    assert_abs_diff_eq!(glassy("polyisobutylene") / 2.969e9, 1.0, epsilon = 2e-3);
    let error = library::find("cheese").unwrap_err();
    assert!(error.to_string().contains("PMMA, epoxy"), "{error}");
}

/// The laws are no formality: each catches its own offender.
#[test]
fn every_law_can_be_broken() {
    #[derive(Debug)]
    struct Wrong(fn(f64) -> f64, Option<CreepSpectrum>);
    impl Rheology for Wrong {
        fn creep_compliance(&self, t: f64) -> f64 {
            (self.0)(t)
        }
        fn creep_spectrum(&self) -> Option<CreepSpectrum> {
            self.1.clone()
        }
    }
    let broken = |creep: fn(f64) -> f64, spectrum| {
        laws::all(&Wrong(creep, spectrum), &laws::log_times(1e-3, 1e3)).unwrap_err().law
    };
    assert_eq!(broken(|t| 0.5 - t, None), "creep is finite and not negative");
    assert_eq!(broken(|t| 1.0 - t.min(1.0), None), "creep is positive after t = 0");
    assert_eq!(broken(|_| f64::NAN, None), "creep is finite and not negative");
    assert_eq!(broken(|t| 2.0 - 1e-4 * t, None), "creep never decreases");
    assert_eq!(broken(|t| 1.0 + t * t, None), "the creep rate never increases");
    assert_eq!(broken(|t| if t > 0.0 { 2.0 } else { 1.0 }, None), "creep starts at J(0)");
    let spectrum = CreepSpectrum::new(1.0, 1.0001, &[]).unwrap();
    assert_eq!(broken(|t| 1.0 + t, Some(spectrum)), "the series is the creep compliance");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2014), ..ProptestConfig::with_cases(120) })]

    #[test]
    fn random_spectra_obey_every_law(creep in spectra()) {
        obeys(&format!("{creep:?}"), laws::all(&creep, &laws::log_times(1e-11, 1e11)));
    }

    /// 1/J* = G* from the two series, whatever the frequency.
    #[test]
    fn random_spectra_have_one_complex_modulus(creep in spectra(), exponent in -12.0..12.0_f64) {
        let omega = 10f64.powf(exponent);
        let (one, other) = (creep.complex_modulus(omega), creep.relaxation().complex_modulus(omega));
        prop_assert!((one - other).norm() <= 1e-11 * one.norm(), "{one} {other}");
        prop_assert!(one.re >= 0.0 && one.im >= 0.0);
    }
}

/// Shapes that are not among those drawn at random; interpolated shapes are on their own grid.
fn shapes() -> Vec<(&'static str, Grid, Box<dyn Geometry>)> {
    let grid = || Grid::new([12, 9], [1.2, 0.9]).unwrap();
    let spec = RoughSpec::new(1.0, 0.2, Roughness::RmsHeight(1e-3)).with_roll_off(0.5).with_seed(3);
    let heights = |at: fn(usize) -> f64| HeightMap::new([12, 9], [1.2, 0.9], (0..108).map(at).collect()).unwrap();
    let missing = heights(|k| if k % 7 == 0 { f64::NAN } else { 1.0 });
    let shapes: Vec<(_, Box<dyn Geometry>)> = vec![
        ("FlatPunch on cell centres", Box::new(FlatPunch::rectangular([0.5, 0.4]).unwrap())),
        ("Sum", Box::new(Sum::new(Sphere::new(1.0).unwrap(), heights(|k| ((k * k) as f64).sin())))),
        ("Repeated along x1", Box::new(Repeated::new(Sphere::new(1.0).unwrap(), [0.5, f64::INFINITY]).unwrap())),
        ("HeightMap with holes", Box::new(missing.masked())),
        ("Rough", Box::new(Rough::new(&grid(), spec).unwrap())),
        ("FnGeometry", Box::new(FnGeometry::new(|x1: f64, x2: f64| x1.abs() + x2))),
    ];
    shapes.into_iter().map(|(name, shape)| (name, grid(), shape)).collect()
}

#[test]
fn every_geometry_obeys_every_law() {
    for (name, grid, shape) in shapes() {
        obeys(name, geometry::laws::all(&*shape, &grid));
    }
}

#[test]
fn every_law_of_geometry_can_be_broken() {
    #[derive(Debug)]
    struct Wrong(fn(f64, f64) -> f64, fn(&Grid, &mut [f64]), fn([f64; 2]) -> [f64; 2]);
    impl Geometry for Wrong {
        fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
            (self.0)(x1, x2)
        }
        fn fill_gap(&self, grid: &Grid, gap: &mut [f64]) {
            self.fill_gap_at(grid, [0.0; 2], gap);
            (self.1)(grid, gap);
        }
        fn fill_gap_at(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
            Shifted::new(FnGeometry::new(self.0), (self.2)(by)).unwrap().fill_gap(grid, gap);
        }
    }
    let grid = Grid::new([8, 6], [8.0, 6.0]).unwrap();
    let bowl: fn(f64, f64) -> f64 = |x1, x2| x1 * x1 + x2 * x2;
    let broken = |wrong: Wrong| {
        let violation = geometry::laws::all(&wrong, &grid).unwrap_err();
        let geometry::laws::Location::Cell { cell, .. } = violation.at else { panic!("{violation}") };
        (violation.law, cell)
    };
    let nothing: fn(&Grid, &mut [f64]) = |_, _| ();
    let stay: fn([f64; 2]) -> [f64; 2] = |by| by;
    assert!(geometry::laws::all(&Wrong(bowl, nothing, stay), &grid).is_ok());
    let hole: fn(f64, f64) -> f64 = |x1, x2| if x1 > 3.0 && x2 > 2.0 { f64::NAN } else { 0.0 };
    assert_eq!(broken(Wrong(hole, nothing, stay)), ("a gap is a number or +∞", [7, 5]));
    assert_eq!(broken(Wrong(|_, _| f64::NEG_INFINITY, nothing, stay)), ("a gap is a number or +∞", [0, 0]));
    assert_eq!(broken(Wrong(|_, _| f64::INFINITY, nothing, stay)), ("there is something to touch", [0, 0]));
    let twice = |_: &Grid, gap: &mut [f64]| gap[9] *= 2.0;
    assert_eq!(broken(Wrong(bowl, twice, stay)), ("a field is the gap at the cell centres", [1, 3]));
    let always = |by: [f64; 2]| [by[0] + 0.5, by[1]];
    assert_eq!(broken(Wrong(|_, x2| x2.abs(), nothing, |[a, b]| [a, -b])).0, "a shift by whole cells shifts the field");
    let undone: fn(&Grid, &mut [f64]) = |grid, gap| {
        let n2 = grid.cells()[1];
        gap.iter_mut().enumerate().for_each(|(k, h)| *h = grid.center(k / n2, k % n2)[0]);
    };
    assert_eq!(broken(Wrong(|x1, _| x1, undone, always)).0, "a shift by zero changes nothing");

    // keeps what the field held
    #[derive(Debug)]
    struct Lazy;
    impl Geometry for Lazy {
        fn initial_gap(&self, _: f64, _: f64) -> f64 {
            0.0
        }
        fn fill_gap(&self, _: &Grid, gap: &mut [f64]) {
            gap[1..].fill(0.0);
        }
    }
    let violation = geometry::laws::all(&Lazy, &grid).unwrap_err();
    assert_eq!(violation.law, "repeated evaluations give the same gap");
    assert!(matches!(violation.at, geometry::laws::Location::Cell { cell: [0, 0], .. }), "{violation}");
    let error =
        geometry::laws::shift_matches_points(&Wrong(bowl, nothing, always), &grid, [0.1, 0.0], 0.0).unwrap_err();
    assert_eq!(error.law, "the shifted field is the gap at the shifted points");
}

#[test]
fn every_history_obeys_every_law() {
    let hinge = |normal, at| Load::Force { normal, tilt: [Tilt::Free { at }, Tilt::Fixed(0.0)] };
    let table = PiecewiseLinear::new(&[(1.0, Load::force(0.0)), (2.0, Load::force(1.0))]);
    // what is not drawn at random, and times before 0
    let histories: Vec<(&str, Box<dyn LoadHistory>)> = vec![
        ("StepLoad, approach", Box::new(StepLoad::new(Load::approach(1e-6)).unwrap())),
        ("Ramp", Box::new(Ramp::new(hinge(0.0, 0.1), hinge(2.0, -0.3), 0.7).unwrap())),
        ("level", Box::new(Periodic::triangle(Load::force(2.0), Load::force(2.0), 0.1).unwrap())),
        ("Sinusoid", Box::new(Sinusoid::new(Load::approach(-1e-6), Load::approach(1e-6), 7.0).unwrap())),
        (
            "arches, nothing at their feet",
            Box::new(
                FnHistory::new(|t: f64| Load::force((std::f64::consts::PI * t.fract()).sin().abs()))
                    .with_breakpoints(&(-1..=1000).map(f64::from).collect::<Vec<_>>())
                    .unwrap(),
            ),
        ),
        ("Arc of a table", Box::new(std::sync::Arc::new(table.unwrap()))),
    ];
    for (name, history) in histories {
        for times in [
            load::laws::even_times(0.0, 3.0, 17),
            load::laws::even_times(-1.0, 1e3, 40),
            load::laws::even_times(-0.02, 0.02, 3),
        ] {
            obeys(name, load::laws::all(&*history, &times));
        }
    }
}

fn time(violation: &load::laws::Violation) -> f64 {
    let load::laws::Location::Time(time) = violation.at else { panic!("{violation}") };
    time
}

#[test]
fn every_law_of_histories_can_be_broken() {
    /// `at`, `before`, `next_breakpoint`.
    type Parts = (fn(f64) -> f64, fn(f64) -> f64, fn(f64) -> Option<f64>);
    #[derive(Debug)]
    struct Wrong(Parts);
    impl LoadHistory for Wrong {
        fn at(&self, t: f64) -> Load {
            Load::force((self.0.0)(t))
        }
        fn before(&self, t: f64) -> Load {
            Load::force((self.0.1)(t))
        }
        fn next_breakpoint(&self, after: f64) -> Option<f64> {
            (self.0.2)(after)
        }
    }
    let times = load::laws::even_times(0.0, 2.0, 8);
    let broken = |parts: Parts| load::laws::all(&Wrong(parts), &times).unwrap_err();
    let one: fn(f64) -> f64 = |_| 1.0;
    let none: fn(f64) -> Option<f64> = |_| None;
    assert!(load::laws::all(&Wrong((one, one, none)), &times).is_ok());
    assert_eq!(broken((|_| -1.0, one, none)).law, "every load is one that a step accepts");
    let nan = broken((one, |t| if t == 0.5 { f64::NAN } else { 1.0 }, none));
    assert_eq!((nan.law, time(&nan)), ("every load is one that a step accepts", 0.5));
    let standing = broken((one, one, |after| (after == 0.25).then_some(0.25)));
    assert_eq!(standing.to_string(), "breakpoints increase: breakpoint at t = 0.25 s is 0.25, expected more than 0.25");
    assert_eq!(broken((one, one, Some)).law, "breakpoints increase");
    assert_eq!(broken((one, one, |_| Some(f64::INFINITY))).law, "breakpoints increase");
    let fleeing = broken((one, one, |after| Some(after + 1.0)));
    assert_eq!(fleeing.law, "the next breakpoint is the same until it is reached");
    let jump: fn(f64) -> f64 = |t| if t < 1.0 { 1.0 } else { 3.0 };
    let late: fn(f64) -> f64 = |t| if t <= 1.0 { 1.0 } else { 3.0 };
    let told: fn(f64) -> Option<f64> = |after| (after < 1.0).then_some(1.0);
    assert!(load::laws::all(&Wrong((jump, late, told)), &times).is_ok());
    assert_eq!(broken((late, late, told)).law, "at a time it is the load after it");
    let unlimited = broken((jump, jump, told));
    assert_eq!((unlimited.law, time(&unlimited)), ("before a time it is the left limit", 1.0));
    assert_eq!((unlimited.found, unlimited.expected), (3.0, 1.0));
    assert_eq!(broken((jump, late, none)).law, "jumps lie on breakpoints");
    let hidden: fn(f64) -> f64 = |t| if t < 0.6 { 1.0 } else { 3.0 };
    let found = broken((hidden, hidden, told));
    assert_eq!(found.law, "jumps lie on breakpoints");
    assert_abs_diff_eq!(time(&found), 0.6, epsilon = 1e-6);
    let corner: fn(f64) -> f64 = |t| (t - 0.61).abs() + t.exp();
    let found = broken((corner, corner, told));
    assert_eq!(found.law, "corners lie on breakpoints");
    assert!((time(&found) - 0.61).abs() < 1e-3, "{found}");

    #[derive(Debug, Default)]
    struct Counting(std::sync::atomic::AtomicU64);
    impl LoadHistory for Counting {
        fn at(&self, _: f64) -> Load {
            Load::force(self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed) as f64)
        }
    }
    assert_eq!(load::laws::all(&Counting::default(), &times).unwrap_err().law, "asked again, it answers the same");
    let turning = FnHistory::new(|t: f64| if t < 0.6 { Load::force(1.0) } else { Load::approach(1.0) });
    let violation = load::laws::all(&turning, &times).unwrap_err();
    assert_eq!((violation.law, violation.quantity), ("jumps lie on breakpoints", "kind of load"));
    assert!(violation.to_string().ends_with("kind of load at t = 0.75 s is another one"), "{violation}");
}

/// Whatever the strategies make is valid, and obeys the laws.
mod at_random {
    use super::*;
    use viscocontact::laws::strategies::{geometries, height_maps, histories, loads, rheologies, spectra};

    fn fail(violation: impl std::fmt::Display, what: &dyn std::fmt::Debug) -> TestCaseError {
        TestCaseError::fail(format!("{violation}\n{what:?}"))
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2026), ..ProptestConfig::with_cases(400) })]

        #[test]
        fn random_rheologies_obey_every_law(body in rheologies(1e7, 1e-2)) {
            laws::all(&body, &laws::log_times(1e-6, 1e2)).map_err(|violation| fail(violation, &body))?;
        }

        #[test]
        fn random_creep_obeys_every_law(body in spectra(1e7, 1e-2)) {
            laws::all(&body, &laws::log_times(1e-6, 1e2)).map_err(|violation| fail(violation, &body))?;
        }

        #[test]
        fn random_geometries_obey_every_law(
            shape in geometries(0.5e-3), cells in [4_usize..24, 4_usize..24], aspect in 0.7..1.4_f64,
            by in [-1e-3..1e-3_f64, -1e-3..1e-3_f64],
        ) {
            let grid = Grid::new(cells, [1e-3, aspect * 1e-3]).unwrap();
            geometry::laws::all(&shape, &grid).map_err(|violation| fail(violation, &shape))?;
            geometry::laws::shift_matches_points(&shape, &grid, by, 0.0).map_err(|violation| fail(violation, &shape))?;
        }

        #[test]
        fn random_maps_obey_every_law(map in height_maps(1e-3, 1e-6)) {
            geometry::laws::all(&map, &map.grid()).map_err(|violation| fail(violation, &map))?;
        }

        #[test]
        fn random_histories_obey_every_law(history in histories(3.0, 10.0), until in 1.0..100.0_f64, count in 2_usize..40) {
            let times = load::laws::even_times(0.0, until, count);
            load::laws::all(&history, &times).map_err(|violation| fail(violation, &history))?;
        }

        #[test]
        fn random_loads_are_loads(load in loads(3.0, 1e-6, 1e-3, 1e-3)) {
            prop_assert!(StepLoad::new(load).is_ok(), "{:?}", load);
        }
    }
}

/// Too few times or times that do not ascend are refused, and so is a body that never creeps.
#[test]
fn laws_refuse_times_that_test_nothing() {
    let maxwell = Maxwell::new(1.0e6, 1.0e6).unwrap();
    for times in [vec![], vec![0.0, 1.0], vec![1.0, 1.0], vec![2.0, 1.0], vec![1.0, f64::NAN], vec![-1.0, 1.0]] {
        let law = laws::all(&maxwell, &times).unwrap_err().law;
        assert!(law.contains("ascend"), "{times:?}: {law}");
    }
    for (first, last) in [(0.0, 1.0), (1.0e3, 1.0e-3), (-1.0, 1.0), (1.0, f64::INFINITY), (f64::NAN, 1.0)] {
        assert!(laws::log_times(first, last).is_empty(), "{first} {last}");
    }
    let wide = laws::log_times(1e-300, 1e300);
    assert!(wide.len() == 4801 && wide.is_sorted() && wide.iter().all(|t| *t > 0.0 && t.is_finite()));
    let times = laws::log_times(1e-3, 1e3);
    let rigid = laws::all(&FnRheology::new(|_| 0.0), &times).unwrap_err();
    assert_eq!(rigid.law, "creep is positive after t = 0");
    // times beyond the series are not evaluated
    let known = PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap().series(1e-3..=1e1, 1e-4).unwrap();
    laws::all(&known, &times).unwrap();

    let load = StepLoad::new(Load::force(1.0)).unwrap();
    for times in [vec![], vec![1.0], vec![1.0, 1.0], vec![1.0, f64::NAN], vec![2.0, 1.0]] {
        let law = viscocontact::load::laws::all(&load, &times).unwrap_err().law;
        assert!(law.contains("ascend"), "{times:?}: {law}");
    }
}
