//! Named constructors, and bodies measured in tension.

use crate::common::refused::says;
use approx::assert_abs_diff_eq;
use viscocontact::num_complex::Complex64;
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSpectrum, Experiment, Isotherm, MasterCurve, PronyTerm, Tension, Units};
use viscocontact::{Error, TextFormat};

fn terms_of(body: &dyn Rheology) -> (f64, Vec<(f64, f64)>) {
    let relaxation = body.creep_spectrum().unwrap().relaxation();
    (relaxation.equilibrium(), relaxation.terms().to_vec())
}

fn shares<const N: usize>(terms: [(f64, f64); N]) -> [PronyTerm; N] {
    terms.map(|(share, time)| PronyTerm { share, time })
}

fn close(found: f64, expected: f64, within: f64) {
    assert_abs_diff_eq!(found / expected, 1.0, epsilon = within);
}

/// What each name promises, from the relaxation modulus that the body has; others are in `spectra::every_model_evaluates_its_formula`.
#[test]
fn named_constructors_take_times() {
    let (rest, terms) = terms_of(&Maxwell::with_time(2.0e6, 3.0).unwrap());
    assert_eq!(rest, 0.0);
    close(terms[0].0, 2.0e6, 1e-14);
    close(terms[0].1, 3.0, 1e-14);

    for (glassy, rubbery, time) in [(1.0e9, 1.0e6, 1.0e-3), (3.0e6, 2.9e6, 40.0), (1.0e9, 1.0e9 - 1.0, 1.0)] {
        let (rest, terms) = terms_of(&Zener::relaxing(glassy, rubbery, time).unwrap());
        close(rest, rubbery, 1e-13);
        let rounding = 1e-15 * glassy / (glassy - rubbery);
        close(terms[0].0, glassy - rubbery, 1e-12 + 10.0 * rounding);
        close(terms[0].1, time, 1e-12);
    }

    for body in [
        GeneralizedMaxwell::prony(8.0e6, &shares([(0.25, 0.1), (0.5, 10.0)])),
        GeneralizedMaxwell::prony_long_term(2.0e6, &shares([(1.0, 0.1), (2.0, 10.0)])),
    ] {
        let (rest, terms) = terms_of(&body.unwrap());
        close(rest, 2.0e6, 1e-13);
        for (found, expected) in terms.iter().zip([(2.0e6, 0.1), (4.0e6, 10.0)]) {
            close(found.0, expected.0, 1e-12);
            close(found.1, expected.1, 1e-12);
        }
    }
    let fluid = GeneralizedMaxwell::prony(1.0e6, &shares([(0.1, 0.1), (0.2, 1.0), (0.7, 10.0)])).unwrap();
    assert_eq!(terms_of(&fluid).0, 0.0, "shares that add up to 1 but for rounding");

    let springpot = FractionalMaxwell::with_time(2.0e6, 4.0, 0.5).unwrap();
    let gamma = 0.5 * std::f64::consts::PI.sqrt(); // Γ(3/2)
    close(springpot.creep_compliance(16.0), (1.0 + 2.0 / gamma) / 2.0e6, 1e-14);
}

/// G* = G_∞ + (G − G_∞) (iωτ)^α/(1 + (iωτ)^α), against the oscillation of the series fitted to its creep.
#[test]
fn a_fractional_body_relaxes_in_its_time() {
    let (glassy, rubbery, time, order) = (1.0e9, 1.0e7, 0.02, 0.6);
    let body = FractionalZener::relaxing(glassy, rubbery, time, order).unwrap();
    let series = body.series(1e-6..=1e6, 1e-6).unwrap().creep_spectrum().unwrap();
    for omega in [0.1, 1.0, 50.0, 1.0e3] {
        let wave = Complex64::new(0.0, omega * time).powf(order);
        let modulus = rubbery + (glassy - rubbery) * wave / (1.0 + wave);
        let error = (series.complex_modulus(omega) - modulus).norm() / modulus.norm();
        println!("ω = {omega} rad/s: {error:.1e}");
        assert!(error < 1e-4, "{error:e}");
    }
}

#[test]
fn bodies_in_tension_have_the_contact_compliance_of_their_shear() {
    let terms = [(2.0e-10, 0.1), (4.0e-10, 10.0)];
    let rod = CreepSpectrum::new(3.0e-10, 1.0e-13, &terms).unwrap();
    for nu in [-0.5, 0.0, 0.3, 0.5] {
        let material = Material::from_tension(Tension(rod.clone()), nu).unwrap();
        let shear = Material::constant_poisson(rod.scaled(2.0 * (1.0 + nu)).unwrap(), nu).unwrap();
        assert_eq!(material.poisson_ratios().collect::<Vec<_>>(), [Some(nu)]);
        let series = material.contact_spectrum().unwrap().unwrap();
        for t in [0.0, 0.05, 3.0, 1.0e4] {
            close(material.contact_compliance(t), (1.0 - nu * nu) * rod.compliance(t), 1e-14);
            close(material.contact_compliance(t), shear.contact_compliance(t), 1e-14);
            close(series.compliance(t), material.contact_compliance(t), 1e-14);
        }
    }
}

/// s Ĵ(s).
pub fn carson(spectrum: &CreepSpectrum, s: f64) -> f64 {
    let terms = spectrum.terms().iter().map(|&(c, lambda)| c / (1.0 + s * lambda));
    spectrum.glassy() + spectrum.fluidity() / s + terms.sum::<f64>()
}

/// At every s the contact compliance is (3K + 4G)/(4G (3K + G)) of the moduli K and G there.
fn obeys(material: &Material, within: f64, moduli: impl Fn(f64) -> [f64; 2]) -> CreepSpectrum {
    let contact = material.contact_spectrum().unwrap().unwrap();
    for exponent in -24..=24 {
        let s = 10f64.powf(0.25 * f64::from(exponent));
        let [k, g] = moduli(s);
        let relative = carson(&contact, s) * (4.0 * g * (3.0 * k + g)) / (3.0 * k + 4.0 * g) - 1.0;
        assert!(relative.abs() < within, "{material:?} s = {s:e}: {relative:e}");
    }
    contact
}

/// Of the two Prony series, with k_i = c g_i.
#[test]
fn a_relaxing_bulk_obeys_the_correspondence_principle() {
    for (terms, fluid) in [(vec![(0.3, 0.01), (0.4, 1.0), (0.2, 50.0)], false), (vec![(0.6, 0.1), (0.4, 3.0)], true)] {
        let (glassy, bulk) = (1.0e9, 2.5e9);
        let shares: Vec<PronyTerm> = terms.iter().map(|&(share, time)| PronyTerm { share, time }).collect();
        for ratio in [0.0, 0.2, 0.9] {
            let body = GeneralizedMaxwell::prony(glassy, &shares).unwrap();
            let material = Material::relaxing_bulk(body.clone(), bulk, ratio).unwrap();
            let contact = obeys(&material, 1e-10, |s| {
                // what is left of the relaxing branches, s τ/(1 + s τ), and what never relaxes
                let rest = 1.0 - terms.iter().map(|(share, _)| share).sum::<f64>();
                let left = terms.iter().map(|&(share, time)| share * s * time / (1.0 + s * time)).sum::<f64>();
                let shear = if fluid { left } else { rest + left };
                [bulk * (1.0 - ratio * (1.0 - shear)), glassy * shear]
            });
            assert_eq!(contact.fluidity() > 0.0, fluid);
        }
    }
}

/// Of s Ĝ(s) and B, or in tension of E = 1/(s D̂(s)) and B, where G = 3BE/(9B − E).
#[test]
fn an_elastic_bulk_obeys_the_correspondence_principle() {
    let series = PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap().series(1e-5..=1e5, 1e-4).unwrap();
    let bodies: [&dyn Rheology; 4] = [
        &Maxwell::with_time(1.0e6, 1.0).unwrap(),
        &Zener::with_time(1.0e9, 1.0e6, 1.0).unwrap(),
        &KelvinVoigt::with_time(1.0e6, 1.0).unwrap(),
        &series,
    ];
    for spectrum in bodies.map(|body| body.creep_spectrum().unwrap()) {
        for bulk in [1.0e5, 2.0e6, 1.0e10] {
            let material = Material::elastic_bulk(spectrum.clone(), bulk).unwrap();
            obeys(&material, 1e-11, |s| [bulk, 1.0 / carson(&spectrum, s)]);
        }
    }
    for (glassy, fluidity, terms) in [
        (5.0e-10, 0.0, &[][..]),
        (5.0e-10, 0.0, &[(3.0e-10, 0.1), (1.0e-6, 10.0)]),
        (4.0e-11, 1.0e-9, &[(3.0e-10, 0.1)]),
    ] {
        let (rod, bulk) = (CreepSpectrum::new(glassy, fluidity, terms).unwrap(), 3.5e9);
        let material = Material::from_tension_elastic_bulk(Tension(rod.clone()), bulk).unwrap();
        obeys(&material, 1e-11, |s| {
            let e = 1.0 / carson(&rod, s);
            [bulk, 3.0 * bulk * e / (9.0 * bulk - e)]
        });
    }
}

/// A file whose headings say tension is not fitted as shear, nor the reverse; nor are isotherms from it.
#[test]
fn headings_keep_tension_and_shear_apart() {
    let read = |experiment, headings: &str| {
        let rows = match experiment {
            Experiment::Dynamic => "0.1,1.0,0.2\n1,1.5,0.4\n10,2.2,0.4\n100,2.5,0.1\n",
            Experiment::Relaxation => "1,2.0\n2,1.5\n4,1.2\n8,1.1\n16,1.05\n",
            _ => "1,1.0\n2,1.1\n4,1.3\n8,1.4\n16,1.45\n",
        };
        let text = format!("{headings}\n{rows}");
        Measurements::from_csv_reader(experiment, text.as_bytes(), Units::SI, TextFormat::default()).unwrap()
    };
    let refuses = |error: Error, tension: bool| {
        let named = if tension { "tension" } else { "shear" };
        says(&error, "table_deformation", &format!("the headings of the table name moduli in {named}: "));
    };
    for (experiment, headings) in [
        (Experiment::Dynamic, "omega,E',E''"),
        (Experiment::Dynamic, "omega [rad/s],E′ [Pa],E″ [Pa]"),
        (Experiment::Dynamic, "omega,storage modulus in tension [Pa],loss modulus [Pa]"),
        (Experiment::Relaxation, "t,E(t)"),
        (Experiment::Relaxation, "t,Young's modulus [Pa]"),
        (Experiment::Creep, "t [s],D [1/Pa]"),
        (Experiment::Creep, "t [s],D(t)"),
    ] {
        let table = read(experiment, headings);
        refuses(table.fit().unwrap_err(), true);
        assert!(table.fit_tension().is_ok(), "{headings}");
        let isotherm = Isotherm::new(300.0, table).unwrap();
        let master = MasterCurve::new(300.0, vec![isotherm]).unwrap();
        refuses(master.fit().unwrap_err(), true);
        assert!(master.fit_tension().is_ok(), "{headings}");
    }
    for (experiment, headings) in [
        (Experiment::Dynamic, "omega,G',G''"),
        (Experiment::Relaxation, "t,G(t)"),
        (Experiment::Creep, "t,J"),
        (Experiment::Creep, "t,creep compliance in shear"),
    ] {
        let table = read(experiment, headings);
        refuses(table.fit_tension().unwrap_err(), false);
        assert!(table.fit().is_ok(), "{headings}");
    }
    for (experiment, headings) in [(Experiment::Relaxation, "t,modulus"), (Experiment::Creep, "t,compliance")] {
        let table = read(experiment, headings);
        assert_eq!(table.fit_tension().unwrap(), Tension(table.fit().unwrap()));
    }
    // a diameter is no compliance
    let diameter = "t,D [mm],J\n1,5,1.0\n2,5,1.1\n4,5,1.3\n8,5,1.4\n";
    let table = Measurements::from_csv_reader(Experiment::Creep, diameter.as_bytes(), Units::SI, TextFormat::default())
        .unwrap();
    assert!(table.fit().is_ok());
}
