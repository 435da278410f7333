//! Moduli that change with temperature beside the times: found in a master curve, carried to every temperature, and refused where they
//! cannot be modelled. `VERTICAL_CURVES` random curves.

use crate::common::{Draws, builder_of, from_environment, sphere};
use viscocontact::ErrorKind;
use viscocontact::prelude::*;
use viscocontact::rheology::{
    Experiment, Isotherm, MasterCurve, RelaxationSpectrum, TemperatureHistory, Tension, TimeTemperature,
};
use viscocontact::sliding::SlidingSweep;

const REFERENCE: f64 = 300.0;

/// A rubber with a relaxation time in each of sixteen decades.
fn rubber(draws: &mut Draws) -> RelaxationSpectrum {
    let slope = draws.between(0.25, 0.6);
    let terms: Vec<(f64, f64)> = (-12..4)
        .map(|decade| (1.0e6 * 10f64.powf(-slope * f64::from(decade)) * draws.between(0.7, 1.4), 10f64.powi(decade)))
        .collect();
    RelaxationSpectrum::new(1.0e6 * draws.scale(0.3, 3.0), 0.0, &terms).unwrap()
}

/// A law with moduli in proportion to the temperature, or as a table says.
fn law(draws: &mut Draws) -> TimeTemperature {
    let law = match draws.below(2) {
        0 => TimeTemperature::wlf(draws.between(6.0, 12.0), draws.between(150.0, 220.0), REFERENCE),
        _ => TimeTemperature::arrhenius(draws.scale(80.0e3, 150.0e3), REFERENCE),
    };
    if draws.chance(0.5) {
        return law.unwrap().with_entropic_moduli();
    }
    let [cold, warm] = [0, 1].map(|_| draws.scale(0.75, 1.35));
    law.unwrap().with_vertical_factors(&[(250.0, cold), (REFERENCE, 1.0), (360.0, warm)]).unwrap()
}

/// What an instrument measures of a body with such moduli and creep at a temperature, over four decades.
fn isotherm(experiment: Experiment, body: &RelaxationSpectrum, law: &TimeTemperature, kelvin: f64) -> Isotherm {
    let (slow, stiff) = (law.shift_factor(kelvin).unwrap(), law.vertical_factor(kelvin).unwrap());
    let terms: Vec<_> = body.terms().iter().map(|(modulus, time)| (stiff * modulus, slow * time)).collect();
    let body = RelaxationSpectrum::new(stiff * body.equilibrium(), 0.0, &terms).unwrap();
    let creep = body.creep();
    let times: Vec<f64> = (-10..=10).map(|k| 10f64.powf(0.2 * f64::from(k))).collect();
    let measured = super::table(experiment, (&|t| creep.compliance(t), &body), &times, |value| value);
    Isotherm::new(kelvin, measured).unwrap()
}

/// Random curves of known shifts: the factors that are found, and the creep at every temperature within the window measured there,
/// by the curve's table, its own law and the law known before.
#[test]
fn the_creep_at_each_temperature_is_what_was_measured_there() {
    let (mut worst, mut without, mut curves) = (0.0_f64, 0.0_f64, 0);
    for number in 0..from_environment("VERTICAL_CURVES", 6) {
        let mut draws = Draws::new(31 + number);
        let (body, law) = (rubber(&mut draws), law(&mut draws));
        let experiment = [Experiment::Creep, Experiment::Relaxation, Experiment::Dynamic][draws.below(3)];
        let kelvins: Vec<f64> = (-3..=4).map(|k| REFERENCE + 11.0 * f64::from(k)).collect();
        let isotherms = || kelvins.iter().map(|&kelvin| isotherm(experiment, &body, &law, kelvin)).collect::<Vec<_>>();
        let found = MasterCurve::with_vertical_shifts(REFERENCE, isotherms()).unwrap();
        let known = MasterCurve::with_law(&law, isotherms()).unwrap();
        let own = if law.wlf_constants().is_some() { found.wlf() } else { found.arrhenius() }.unwrap();
        assert!(own.has_vertical_factors() && found.shift_table().unwrap().has_vertical_factors());
        let (series, exact) = (found.fit().unwrap(), known.fit().unwrap());
        // beyond the window of the whole curve the creep is guessed
        for &kelvin in &kelvins[1..kelvins.len() - 1] {
            let (slow, stiff) = (law.shift_factor(kelvin).unwrap(), law.vertical_factor(kelvin).unwrap());
            let bodies: [Box<dyn Rheology>; 3] = [
                Box::new(found.shift_table().unwrap().at(series.clone(), kelvin).unwrap()),
                Box::new(own.at(series.clone(), kelvin).unwrap()),
                Box::new(law.at(exact.clone(), kelvin).unwrap()),
            ];
            for t in (-7..=7).map(|k| 10f64.powf(0.2 * f64::from(k))) {
                let truth = body.creep().compliance(t / slow) / stiff;
                for (k, shifted) in bodies.iter().enumerate() {
                    let error = (shifted.creep_compliance(t) / truth - 1.0).abs();
                    assert!(
                        error < [0.04, 0.05, 0.02][k],
                        "curve {number}, {experiment:?}, {kelvin} K, {t:e} s, body {k}: {error}"
                    );
                    worst = worst.max(error);
                }
                let plain = own.clone().without_vertical_factors().at(series.clone(), kelvin).unwrap();
                without = without.max((plain.creep_compliance(t) / truth - 1.0).abs());
            }
        }
        curves += 1;
    }
    println!("{curves} curves: creep off by at most {worst:.4}, without vertical factors by {without:.3}");
    assert!(curves > 0 && worst > 0.0 && without > 5.0 * worst);
}

#[test]
fn a_law_has_its_factors_at_every_temperature() {
    let plain = TimeTemperature::wlf(8.61, 200.4, REFERENCE).unwrap();
    let entropic = plain.clone().with_entropic_moduli();
    let table = plain.clone().with_vertical_factors(&[(280.0, 280.0 / 300.0), (REFERENCE, 1.0), (330.0, 1.1)]).unwrap();
    for kelvin in [280.0, 287.3, 300.0, 314.0, 330.0] {
        assert_eq!(plain.vertical_factor(kelvin), Ok(1.0));
        let factor = kelvin / REFERENCE;
        assert!((entropic.vertical_factor(kelvin).unwrap() / factor - 1.0).abs() < 1e-15);
        // a power of the temperature between two rows
        assert!((table.vertical_factor(kelvin).unwrap() / factor - 1.0).abs() < 1e-14, "{kelvin}");
    }
    let outside = table.vertical_factor(340.0).unwrap_err();
    assert!(outside.to_string().contains("TimeTemperature::extrapolated"), "{outside}");
    assert!(table.at(Elastic::new(1.0e6).unwrap(), 340.0).is_err());
    let beyond = table.clone().extrapolated().vertical_factor(340.0).unwrap();
    assert!((beyond / (340.0 / REFERENCE) - 1.0).abs() < 1e-14);
    assert!(plain.clone().with_vertical_factors(&[(280.0, 1.0), (330.0, 1.1)]).is_err(), "none at the reference");
    assert!(plain.clone().with_vertical_factors(&[]).is_err());
    assert_eq!(format!("{:?}", entropic.clone().without_vertical_factors()), format!("{plain:?}"));
    assert_eq!(entropic.without_vertical_factors(), plain);

    // C(t) of a material
    let zener = || Zener::relaxing(4.0e6, 1.0e6, 0.5).unwrap();
    let [cold, warm] = [REFERENCE, 330.0].map(|kelvin| Material::incompressible(table.at(zener(), kelvin).unwrap()));
    assert!((cold.contact_compliance(0.0) / warm.contact_compliance(0.0) - 1.1).abs() < 1e-12);
    for (t, modulus) in [(0.0, 1.76e7), (1.0e6, 4.4e6)] {
        assert!((warm.contact_compliance(t) * modulus - 1.0).abs() < 1e-12, "{warm:?}");
    }
    let rod = Material::from_tension(Tension(table.at(zener(), 330.0).unwrap()), 0.5).unwrap();
    assert!((rod.contact_compliance(0.0) * 4.4e6 / 0.75 - 1.0).abs() < 1e-12);
}

/// Where a factor belongs to one body of two, to the shear and not to the bulk, or to a temperature that changes, it is refused.
#[test]
fn what_vertical_factors_do_not_describe_is_refused() {
    let law = TimeTemperature::wlf(8.61, 200.4, REFERENCE).unwrap();
    let entropic = law.clone().with_entropic_moduli();
    let named = |error: Option<Error>, what: &str| {
        let error = error.unwrap_or_else(|| panic!("{what} is accepted"));
        assert!(error.code() == "material_vertical_factors", "{what}: {error}");
        let remedies = ["TimeTemperature::at", "TimeTemperature::without_vertical_factors"];
        assert!(remedies.iter().all(|remedy| error.to_string().contains(remedy)), "{error}");
        assert_eq!(error.kind(), ErrorKind::Unsupported);
    };
    named(TemperatureHistory::table(entropic.clone(), &[(0.0, 300.0), (1.0, 310.0)]).err(), "a table");
    named(TemperatureHistory::function(entropic.clone(), |t| 300.0 + t, &[]).err(), "a function");
    assert!(TemperatureHistory::table(entropic.clone().without_vertical_factors(), &[(0.0, 310.0)]).is_ok());

    let rubber = || GeneralizedMaxwell::new(1.0e6, &[(10.0e6, 1.0e-2)]).unwrap();
    let grid = || Grid::square(24, 4.0e-3).unwrap();
    let steel = Material::constant_poisson(Elastic::young(210.0e9, 0.3).unwrap(), 0.3).unwrap();
    let sweep = |law: &TimeTemperature, kelvin: f64| {
        SlidingSweep::new([[0.01, 0.0]], [Load::force(0.3)]).at_temperatures(law.clone(), [kelvin])
    };
    let bodies =
        [Material::incompressible(rubber()).against(steel.clone()), Material::elastic_bulk(rubber(), 2.0e9).unwrap()];
    for body in bodies {
        let mut sliding = builder_of(&sphere(), grid(), body).build_sliding().unwrap();
        named(sliding.sweep(&sweep(&entropic, 310.0)).err(), "a sweep");
        assert!(sliding.sweep(&sweep(&entropic, REFERENCE)).is_ok(), "nothing changes at the reference");
        assert!(sliding.sweep(&sweep(&law, 310.0)).is_ok());
    }
}
