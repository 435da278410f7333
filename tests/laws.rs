//! Every rheology of the crate, and random ones, against the laws of `rheology::laws`.

mod common;

use common::spectra;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSpectrum, TimeTemperature, laws, library};

fn models() -> Vec<(&'static str, Box<dyn Rheology>)> {
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
        ("PowerLaw", Box::new(PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap())),
        ("FractionalMaxwell", Box::new(FractionalMaxwell::new(1.0e9, 1.0e8, 0.4).unwrap())),
        ("FractionalZener", Box::new(FractionalZener::new(1.0e9, 1.0e6, 1.0e-2, 0.5).unwrap())),
        ("Kww", Box::new(Kww::new(0.5e-9, 2.0e-9, 10.0, 0.33).unwrap())),
        ("LogCreep", Box::new(LogCreep::new(1.0e-9, 1.0e-10, 0.1).unwrap())),
        ("SlowCreep", Box::new(SlowCreep::new(1.0e-9, 1.0e-10, 10.0, 0.3).unwrap())),
        ("FnRheology", Box::new(FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t.sqrt())))),
        ("AtTemperature", Box::new(warm.at(zener(), 383.15).unwrap())),
        ("Arc", Box::new(std::sync::Arc::new(zener()))),
    ]
}

#[test]
fn every_model_obeys_every_law() {
    let times = laws::log_times(1e-5, 1e5);
    for (name, model) in models() {
        if let Err(violation) = laws::all(&*model, &times) {
            panic!("{name}: {violation}");
        }
    }
}

/// What a contact runs on: the series of every model over ten decades, its error and its laws, J ∗ G = t among them.
#[test]
fn every_series_obeys_every_law() {
    let times = laws::log_times(1e-5, 1e5);
    for (name, model) in models() {
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
        if let Err(violation) = laws::all(&series, &times) {
            panic!("series of {name}: {violation}");
        }
    }
}

#[test]
fn published_materials_are_as_printed() {
    let times = laws::log_times(1e-12, 1e12);
    for material in library::all() {
        let name = material.name();
        let body = material.rheology(0.4).unwrap();
        if let Err(violation) = laws::all(&body, &times) {
            panic!("{name}: {violation}");
        }
        assert!(!material.reference().is_empty() && !material.remark().is_empty());
        assert_eq!(library::find(&name.to_uppercase()).unwrap().name(), name);
    }
    // glassy moduli, added up by hand: tension of PMMA 2239.47 MPa, shear of the epoxy 891 MPa, E(0) of the adhesive
    let glassy = |name: &str| {
        let material = library::find(name).unwrap();
        material.equilibrium() + material.terms().iter().map(|(modulus, _)| modulus).sum::<f64>()
    };
    assert!((glassy("PMMA") / 2239.47e6 - 1.0).abs() < 1e-12);
    assert!((glassy("epoxy") / 891.0e6 - 1.0).abs() < 1e-12);
    assert!((glassy("adhesive") / (9115.8e6 / 2.7) - 1.0).abs() < 1e-9);
    assert!((glassy("polystyrene rings") / 1.264147007e6 - 1.0).abs() < 1e-12);
    assert!((glassy("polyisobutylene") / 2.969e9 - 1.0).abs() < 2e-3);
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
    assert_eq!(broken(|t| 1.0 - t, None), "creep is finite and not negative");
    assert_eq!(broken(|_| f64::NAN, None), "creep is finite and not negative");
    assert_eq!(broken(|t| 2.0 - 1e-4 * t, None), "creep never decreases");
    assert_eq!(broken(|t| 1.0 + t * t, None), "the creep rate never increases");
    assert_eq!(broken(|t| if t > 0.0 { 2.0 } else { 1.0 }, None), "creep starts at J(0)");
    let spectrum = CreepSpectrum::new(1.0, 1.0001, &[]).unwrap();
    assert_eq!(broken(|t| 1.0 + t, Some(spectrum)), "the series is the creep compliance");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2014), ..ProptestConfig::with_cases(200) })]

    #[test]
    fn random_spectra_obey_every_law(creep in spectra()) {
        if let Err(violation) = laws::all(&creep, &laws::log_times(1e-11, 1e11)) {
            prop_assert!(false, "{violation}\n{creep:?}");
        }
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
