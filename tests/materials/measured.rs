//! Tables of measured data: fits, noise, invalid tables, and files.

mod dialects;
mod files;
mod populations;

use crate::common::refused::says;
use crate::common::{Ratios, noise, pairs, sphere_on, triples};
use approx::assert_abs_diff_eq;
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;
use viscocontact::rheology::{CreepSeries, CreepSpectrum, Experiment, Isotherm, MasterCurve, TimeTemperature};
use viscocontact::{Error, Result};

fn log_spaced(first: f64, last: f64, a_decade: usize) -> Vec<f64> {
    let count = ((last / first).log10() * a_decade as f64).round() as usize;
    (0..=count).map(|k| first * (last / first).powf(k as f64 / count as f64)).collect()
}

fn creep(rows: &[(f64, f64)]) -> Result<CreepSeries> {
    Measurements::creep(rows).and_then(|table| table.fit())
}

/// 3 and 6 retardation times, solids and fluids.
fn truths() -> Vec<(&'static str, CreepSpectrum)> {
    let three = [(1.0e-6, 0.02), (3.0e-6, 1.0), (2.0e-6, 40.0)];
    let six = [(1.0e-9, 2e-3), (2.0e-9, 3e-2), (5.0e-9, 0.5), (2.0e-8, 4.0), (8.0e-8, 50.0), (3.0e-7, 900.0)];
    vec![
        ("three, solid", CreepSpectrum::new(1.0e-6, 0.0, &three).unwrap()),
        ("three, fluid", CreepSpectrum::new(1.0e-6, 2.0e-8, &three).unwrap()),
        ("six, solid", CreepSpectrum::new(1.0e-9, 0.0, &six).unwrap()),
        ("six, fluid", CreepSpectrum::new(1.0e-9, 1.0e-10, &six).unwrap()),
    ]
}

/// Greatest relative error of J over the measured range.
fn worst(fitted: &dyn Rheology, truth: &CreepSpectrum, [first, last]: [f64; 2]) -> f64 {
    let times = log_spaced(first, last, 53);
    times.iter().map(|&t| (fitted.creep_compliance(t) / truth.compliance(t) - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn clean_creep_is_recovered() {
    for (name, truth) in truths() {
        let times = log_spaced(1e-4, 1e4, 20);
        let compliances: Vec<f64> = times.iter().map(|&t| truth.compliance(t)).collect();
        let body = creep(&pairs(&times, &compliances)).unwrap();
        let error = worst(&body, &truth, [1e-4, 1e4]);
        println!("{name}: {error:.1e}; {}", body.report());
        assert!(error <= 1e-4, "{name}: {error:e}");
        assert_eq!(body.report().terms(), truth.terms().len(), "{name}: sparse");
        assert_eq!(body.report().samples().len(), times.len());
    }
}

/// Twenty tables with 2 % noise of each truth, discrete and continuous. What p parameters can be known to from m values
/// is 2 % √(p/m) in the root mean square (Cramér and Rao), 0.45 % and 0.6 % for three and six times; no fit can promise
/// the worst point of every table.
#[test]
fn noisy_creep_is_smoothed() {
    let mut bodies: Vec<(&str, Box<dyn Rheology>, usize)> = Vec::new();
    for (name, truth) in truths() {
        let terms = truth.terms().len();
        bodies.push((name, Box::new(truth), terms + 2));
    }
    bodies.push(("fractional Zener", Box::new(FractionalZener::new(1.0e9, 1.0e6, 0.1, 0.45).unwrap()), 12));
    bodies.push(("logarithmic", Box::new(LogCreep::new(1.0e-9, 1.0e-10, 0.1).unwrap()), 8));
    for (name, truth, most_terms) in bodies {
        let (mut worst, mut all) = (Ratios::default(), Ratios::default());
        for seed in 0..20 {
            let mut noise = noise(seed);
            let times = log_spaced(1e-4, 1e4, 20);
            let measured = |&t: &f64| truth.creep_compliance(t) * (1.0 + 0.02 * noise());
            let compliances: Vec<f64> = times.iter().map(measured).collect();
            let body = creep(&pairs(&times, &compliances)).unwrap();
            let terms = body.report().terms();
            assert!(terms <= most_terms, "{name}, {seed}: {terms} terms");
            let check = log_spaced(1e-4, 1e4, 53);
            let misfit = |t: f64| body.creep_compliance(t.min(1e4)) / truth.creep_compliance(t) - 1.0;
            let rms = (check.iter().map(|&t| misfit(t).powi(2)).sum::<f64>() / check.len() as f64).sqrt();
            assert!(rms < 0.01, "{name}, {seed}: {rms}");
            assert!((0.016..0.022).contains(&body.report().rms_misfit()), "{name}: the noise is seen for what it is");
            worst.push(100.0 * check.iter().map(|&t| misfit(t).abs()).fold(0.0, f64::max), "");
            all.push(rms, "");
        }
        worst.print(&format!("{name}, rms {:.2} %, worst point in %", 100.0 * all.mean()), 0);
        assert!(all.mean() < 0.0075 && worst.median() < 2.2, "{name}");
    }
}

#[test]
fn relaxation_and_dynamic_tables_give_the_same_body() {
    for (name, truth) in truths() {
        let relaxation = truth.relaxation();
        // a fluid forgets everything in the end
        let mut times = log_spaced(1e-5, 1e6, 10);
        times.retain(|&t| relaxation.modulus(t) > 1e-6 * relaxation.modulus(0.0));
        let last = times[times.len() - 1];
        let [relaxed, dynamic] = [Experiment::Relaxation, Experiment::Dynamic].map(|experiment| {
            let table = super::table(experiment, (&|t| truth.compliance(t), &relaxation), &times, |value| value);
            table.fit().unwrap()
        });
        assert_abs_diff_eq!(dynamic.known_until() / last, 1.0, epsilon = 1e-12);
        assert_eq!(relaxed.known_until(), last);
        for (kind, body) in [("relaxation", &relaxed as &dyn Rheology), ("dynamic", &dynamic)] {
            let error = worst(body, &truth, [1e-4, 0.1 * last]);
            println!("{name}, {kind}: {error:.1e}");
            assert!(error < 1e-4, "{name}, {kind}: {error:e}");
        }
    }
}

#[test]
fn times_beyond_the_data_are_refused_unless_extrapolated() {
    let times = log_spaced(1e-2, 1e2, 5);
    let compliances: Vec<f64> = times.iter().map(|t| 1.0e-6 * (1.0 + t / (1.0 + t))).collect();
    let body = creep(&pairs(&times, &compliances)).unwrap();
    assert_eq!(body.known_until(), 1e2);
    assert!(body.creep_compliance(1e2).is_finite() && body.creep_compliance(101.0).is_nan());
    let bulk = Material::elastic_bulk(body.clone(), 1.0e9).unwrap();
    assert!(bulk.contact_compliance(1e2).is_finite() && bulk.contact_compliance(101.0).is_nan());
    let mut contact = sphere(Material::incompressible(body.clone()));
    contact.step(0.0, Load::force(0.1)).unwrap();
    let report = contact.step(30.0, Load::force(0.1)).unwrap();
    assert!(!report.warnings.contains(Warnings::NEAR_END_OF_MATERIAL), "{report}");
    let report = contact.step(70.0, Load::force(0.1)).unwrap();
    assert!(report.warnings.contains(Warnings::NEAR_END_OF_MATERIAL), "{report}");
    let error = contact.step(1.0, Load::force(0.1)).unwrap_err();
    assert_eq!(error, Error::Step(StepError::BeyondMaterial { time: 101.0, age: 101.0, known_until: 100.0 }));
    assert_eq!(contact.time(), 100.0);
    // time at rest does not count
    let mut contact = sphere(Material::incompressible(body.clone()));
    for _ in 0..20 {
        contact.step(1e5, Load::force(0.0)).unwrap();
    }
    contact.step(0.0, Load::force(0.1)).unwrap();
    contact.step(50.0, Load::force(0.1)).unwrap();
    let error = contact.step(51.0, Load::force(0.1)).unwrap_err();
    assert!(matches!(error, Error::Step(StepError::BeyondMaterial { known_until: 100.0, .. })), "{error}");
    let states = ElasticStates::sphere(1.0e-2).unwrap();
    let mut contact = StatesContact::new(&states, &Material::incompressible(body.clone())).unwrap();
    contact.step(1e5, Load::force(0.0)).unwrap();
    contact.step(0.0, Load::force(0.1)).unwrap();
    let report = contact.step(50.0, Load::force(0.1)).unwrap();
    assert!(!report.warnings.contains(Warnings::NEAR_END_OF_MATERIAL), "{report}");
    let error = contact.step(51.0, Load::force(0.1)).unwrap_err();
    assert_eq!(error, Error::Step(StepError::BeyondMaterial { time: 100101.0, age: 101.0, known_until: 100.0 }));
    // the choice
    let trusted = body.extrapolated();
    assert!(trusted.creep_compliance(150.0).is_finite());
    let mut contact = sphere(Material::incompressible(trusted));
    contact.step(0.0, Load::force(0.1)).unwrap();
    let [before, after] = [90.0, 60.0].map(|dt| contact.step(dt, Load::force(0.1)).unwrap().warnings);
    assert!(!before.contains(Warnings::EXTRAPOLATED) && after.contains(Warnings::EXTRAPOLATED), "{before} {after}");
    assert!(!after.contains(Warnings::NEAR_END_OF_MATERIAL), "{after}");
}

fn sphere(material: Material) -> ViscoelasticContact {
    sphere_on(Grid::square(24, 4.0e-3).unwrap(), material, Settings::default())
}

fn table_error(times: &[f64], compliances: &[f64]) -> Error {
    creep(&pairs(times, compliances)).unwrap_err()
}

#[test]
fn bad_data_are_told_apart() {
    let good = [1.0, 2.0, 3.0, 4.0, 5.0];
    for few in [&[][..], &[1.0, 2.0]] {
        let error = creep(&pairs(few, few)).unwrap_err();
        assert_eq!(error, Error::WrongLength { field: "creep table", len: few.len(), expected: 4, exact: false });
    }
    for (times, values, entry, named) in [
        ([1.0, f64::NAN, 3.0, 4.0, 5.0], good, 1, "time"),
        (good, [1.0, 2.0, 3.0, f64::INFINITY, 5.0], 3, "creep compliance"),
        ([1.0, -2.0, 3.0, 4.0, 5.0], good, 1, "time"),
        (good, [0.0, 2.0, 3.0, 4.0, 5.0], 0, "creep compliance"),
    ] {
        let (error, given) = (table_error(&times, &values), if named == "time" { times[entry] } else { values[entry] });
        says(&error, "table_out_of_range", &format!("creep table, entry {entry}: {named} = {given:?} is not"));
        assert_eq!((error.name(), error.value().map(f64::to_bits)), (Some(named), Some(given.to_bits())));
    }
    let error = table_error(&[5.0, 1.0, 2.0, 5.0, 4.0], &good);
    says(&error, "table_duplicate", "creep table: entry 3 and entry 0 give two values for time = 5: ");
    let error = table_error(&good, &[1.0, 2.0, 3.0, 1.5, 5.0]);
    says(&error, "table_wrong_way", "creep table, entry 3: creep compliance = 1.5 deviates");
    let error = Measurements::dynamic(&triples(&[0.0, 1.0, 2.0, 3.0], &good[..4], &good[..4]))
        .and_then(|table| table.fit())
        .unwrap_err();
    assert!(error.code() == "table_out_of_range" && error.name() == Some("angular frequency"), "{error}");
    let error = Measurements::relaxation(&pairs(&good, &good)).and_then(|table| table.fit()).unwrap_err();
    assert!(error.code() == "table_wrong_way", "{error}");

    // a slow slip of 3 % in clean data is no noise; the same within 2 % noise is
    let times = log_spaced(1e-2, 1e2, 20);
    let clean: Vec<f64> = times.iter().map(|t| 1.0 + 0.03 / (1.0 + t)).collect();
    assert!(table_error(&times, &clean).code() == "table_wrong_way");
    let mut noise = noise(7);
    let noisy: Vec<f64> = clean.iter().map(|value| value * (1.0 + 0.02 * noise())).collect();
    let body = creep(&pairs(&times, &noisy)).unwrap();
    assert!(body.report().wrong_way() > 0.01, "{}", body.report());
}

#[test]
fn tables_of_any_size_and_unit_are_fitted() {
    // nothing creeps
    let elastic = creep(&[1.0, 2.0, 3.0, 4.0].map(|t| (t, 2.0e-9))).unwrap();
    assert_abs_diff_eq!(elastic.creep_compliance(2.5) / 2.0e-9, 1.0, epsilon = 1e-12);
    assert_eq!(elastic.report().terms(), 0);
    // a fluid from the start, with the time of loading itself
    let viscous = creep(&[0.0, 1.0, 2.0, 3.0, 9.0].map(|t| (t, 1.0 + t))).unwrap();
    assert!((viscous.creep_compliance(5.0) / 6.0 - 1.0).abs() < 1e-6, "{viscous:?}");
    // the same body in other units is the same body
    let times = log_spaced(1e-3, 1e3, 7);
    let values: Vec<f64> = times.iter().map(|t| 1.0 + t.powf(0.4)).collect();
    let body = creep(&pairs(&times, &values)).unwrap();
    for (time, value) in [(1e-40, 1e-30), (1e40, 1e30), (1e20, 1e-40)] {
        let rows: Vec<_> = times.iter().zip(&values).map(|(t, j)| (time * t, value * j)).collect();
        let scaled = creep(&rows).unwrap();
        assert_eq!(scaled.report().terms(), body.report().terms());
        for t in log_spaced(1e-3, 1e3, 3) {
            let t = t.min(1e3);
            let relative = scaled.creep_compliance(time * t) / value / body.creep_compliance(t) - 1.0;
            assert!(relative.abs() < 1e-5, "{time:e} {value:e} {t:e}: {relative:e}");
        }
    }
}

/// Isotherms of one body that shifts by a law, three decades each.
fn isotherms(law: &TimeTemperature, temperatures: &[f64]) -> Vec<Isotherm> {
    let body = FractionalZener::new(1.0e9, 1.0e6, 1.0e3, 0.4).unwrap();
    let times = log_spaced(1.0, 1e3, 10);
    let isotherm = |&temperature: &f64| {
        let slow = law.shift_factor(temperature).unwrap();
        let compliances: Vec<f64> = times.iter().map(|t| body.creep_compliance(t / slow)).collect();
        Isotherm::new(temperature, Measurements::creep(&pairs(&times, &compliances)).unwrap()).unwrap()
    };
    temperatures.iter().map(isotherm).collect()
}

#[test]
fn master_curves_find_the_law_behind_them() {
    let temperatures = [360.0, 363.0, 366.0, 369.0, 373.15, 378.0, 383.0, 390.0];
    let law = TimeTemperature::wlf(17.44, 51.6, 373.15).unwrap();
    let master = MasterCurve::new(373.15, isotherms(&law, &temperatures)).unwrap();
    for (temperature, factor) in master.shift_factors() {
        let expected = law.shift_factor(temperature).unwrap();
        assert!((factor / expected).log10().abs() < 0.02, "{temperature}: {factor:e} {expected:e}");
    }
    let [c1, c2] = master.wlf().unwrap().wlf_constants().unwrap();
    println!("WLF {c1:.3} {c2:.2}");
    assert!((c1 / 17.44 - 1.0).abs() < 0.03 && (c2 / 51.6 - 1.0).abs() < 0.03, "{c1} {c2}");
    // eleven decades from three: against the body itself
    let body = FractionalZener::new(1.0e9, 1.0e6, 1.0e3, 0.4).unwrap();
    let curve = master.fit().unwrap();
    println!("{}", curve.report());
    let [first, last] = curve.report().range().unwrap();
    assert!(last / first > 1e10, "{first:e} … {last:e}");
    for t in log_spaced(first, last, 10) {
        let t = t.min(last);
        let relative = curve.creep_compliance(t) / body.creep_compliance(t) - 1.0;
        assert!(relative.abs() < 0.02, "{t:e}: {relative:e}");
    }

    let law = TimeTemperature::arrhenius(200.0e3, 373.15).unwrap();
    let master = MasterCurve::new(373.15, isotherms(&law, &temperatures)).unwrap();
    let energy = master.arrhenius().unwrap().activation_energy().unwrap();
    assert_abs_diff_eq!(energy, 200.0e3, epsilon = 0.01 * 200.0e3);
    let known = MasterCurve::with_law(&law, isotherms(&law, &temperatures)).unwrap();
    for ((_, a), (_, b)) in known.shift_factors().into_iter().zip(master.shift_factors()) {
        assert_abs_diff_eq!((a / b).ln(), 0.0, epsilon = 0.02);
    }
}

#[test]
fn temperatures_shift_time() {
    let wlf = TimeTemperature::wlf(17.44, 51.6, 373.15).unwrap();
    let zener = Zener::with_time(1.0e9, 1.0e6, 1.0).unwrap();
    let warm = wlf.at(zener.clone(), 380.0).unwrap();
    let factor = warm.shift_factor();
    assert!(factor < 0.1);
    let exact = warm.creep_spectrum().unwrap();
    for t in log_spaced(1e-6, 1e3, 4) {
        assert_eq!(warm.creep_compliance(t), zener.creep_compliance(t / factor));
        assert_abs_diff_eq!(exact.compliance(t) / warm.creep_compliance(t), 1.0, epsilon = 1e-13);
    }
}

/// What tables may not be, what they may, and how long a fit takes: the findings of those who tried.
#[test]
fn tables_as_they_come_are_fitted_or_refused_for_a_reason() {
    // printed with three digits, on a plateau
    let zener = Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap();
    let times = log_spaced(1e-3, 1e3, 27);
    for seed in 0..50 {
        let mut noise = noise(seed);
        let printed = |&t: &f64| format!("{:.2e}", zener.creep_compliance(t) * (1.0 + 3e-4 * noise())).parse().unwrap();
        let values: Vec<f64> = times.iter().map(printed).collect();
        creep(&pairs(&times, &values)).unwrap_or_else(|error| panic!("{seed}: {error}"));
    }
    // not those of a linear body
    let rows = [1.0, 2.0, 3.0, 4.0];
    for values in [vec![1.0, 10.0, 100.0, 1000.0], vec![1.0, 1.0, 1.0e6, 1.0e6]] {
        let error = creep(&pairs(&rows, &values)).unwrap_err();
        assert!(error.code() == "table_inconsistent" && error.value().unwrap() > 0.1, "{error}");
    }
    let tertiary: Vec<f64> = times.iter().map(|t| 1.0 + 0.1 * t.powf(0.3) + (t / 100.0).powi(4)).collect();
    let error = creep(&pairs(&times, &tertiary)).unwrap_err();
    assert!(error.code() == "table_inconsistent", "{error}");
    // a few noisy rows are not met exactly
    for seed in 0..50 {
        let mut noise = noise(seed);
        let rows = log_spaced(0.1, 10.0, 3);
        let values: Vec<f64> = rows.iter().map(|&t| zener.creep_compliance(t) * (1.0 + 0.01 * noise())).collect();
        if let Ok(body) = creep(&pairs(&rows, &values)) {
            assert!(2 * body.report().terms() < rows.len(), "{seed}: {}", body.report());
        }
    }
    // large tables are gathered before they are fitted
    let clock = std::time::Instant::now();
    let times = log_spaced(1e-6, 1e6, 2000);
    let body = FractionalZener::new(1.0e9, 1.0e6, 1.0, 0.4).unwrap();
    let values: Vec<f64> = times.iter().map(|&t| body.creep_compliance(t)).collect();
    let fitted = creep(&pairs(&times, &values)).unwrap();
    println!("{} in {:.2} s", fitted.report(), clock.elapsed().as_secs_f64());
    assert!(fitted.report().max_misfit() < 1e-3 && fitted.report().samples().len() == times.len());
    assert_eq!(Material::incompressible(fitted).fit_reports().count(), 1);
}

/// What a table says of its scatter holds for it as an isotherm, and what a fit says of itself for a series of it. Tables that are shorter
/// than a mean of their rows are fitted.
#[test]
fn what_is_known_of_a_table_is_not_lost() {
    let rows = [(0.1, 1.0e-9), (1.0, 1.4e-9), (10.0, 1.1e-9), (100.0, 1.6e-9), (1000.0, 2.1e-9)];
    let table = Measurements::creep(&rows).unwrap();
    let as_isotherm = |table: Measurements| MasterCurve::new(300.0, vec![Isotherm::new(300.0, table)?])?.fit();
    assert!(as_isotherm(table.clone()).is_err());
    let table = table.with_scatter(0.08).unwrap();
    let (curve, body) = (as_isotherm(table.clone()).unwrap(), table.fit().unwrap());
    assert_eq!(curve.spectrum(), body.spectrum());
    let again = body.series(1e-3..=1e3, 1e-6).unwrap();
    assert_eq!((again.report(), again.measured()), (body.report(), body.measured()));
    /// A creep function that was measured in a part of the times.
    #[derive(Debug)]
    struct Measured(PowerLaw);
    impl Rheology for Measured {
        fn creep_compliance(&self, t: f64) -> f64 {
            self.0.creep_compliance(t)
        }
        fn measured(&self) -> [f64; 2] {
            [1.0, 10.0]
        }
    }
    let series = Measured(PowerLaw::new(1.0e-6, 1.0, 0.3).unwrap()).series(1e-3..=1e3, 1e-4).unwrap();
    assert_eq!(series.measured(), [1.0, 10.0]);
    let short = [(1.00, 1.00e6), (1.01, 0.99e6), (1.02, 0.98e6), (1.03, 0.97e6)];
    assert!(Measurements::relaxation(&short).unwrap().fit().is_ok());
}

/// J* at frequencies at which ωλ has no square.
#[test]
fn oscillations_may_be_of_any_frequency() {
    let body = CreepSpectrum::new(1.0, 0.0, &[(2.0, 1.0)]).unwrap();
    for (omega, real, imaginary) in
        [(0.0, 3.0, 0.0), (1e-200, 3.0, -2e-200), (1.0, 2.0, -1.0), (1e180, 1.0, -2e-180), (f64::INFINITY, 1.0, 0.0)]
    {
        let compliance = body.complex_compliance(omega);
        let near = |value: f64, wanted: f64| (value - wanted).abs() <= 1e-12 * wanted.abs() + 1e-190;
        assert!(near(compliance.re, real) && near(compliance.im, imaginary), "{omega:e}: {compliance}");
    }
}
