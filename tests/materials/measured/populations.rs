//! Random tables with noise, and random isotherms.

use viscocontact::prelude::*;
use viscocontact::rheology::{GeneralizedMaxwell, Isotherm, MasterCurve, Measurements};

use super::log_spaced;
use crate::common::{Draws, Ratios, from_environment, noise};

/// A body with relaxation times over many decades: shares and times of a broad peak.
fn broad(draw: &mut Draws, middle: f64) -> GeneralizedMaxwell {
    let width = draw.between(1.5, 3.5);
    let terms: Vec<(f64, f64)> = (-24..=24)
        .map(|k| {
            let decade = f64::from(k) / 3.0;
            let strength = (-(decade / width).powi(2)).exp() + draw.between(0.02, 0.17);
            (1.0e6 * strength, middle * 10f64.powf(decade))
        })
        .collect();
    GeneralizedMaxwell::new(draw.between(1.0e4, 2.0e5), &terms).unwrap()
}

/// No table of a linear body is refused for noise that the limit of the misfit covers.
#[test]
fn noisy_tables_of_linear_bodies_are_fitted() {
    let (count, mut fitted, mut worst) = (from_environment("NOISY_TABLES", 18), 0, 0.0_f64);
    for seed in 0..count {
        let mut draw = Draws::new(seed);
        let body = broad(&mut draw, 1.0);
        let spectrum = body.creep_spectrum().unwrap().relaxation();
        let deviation = [0.03, 0.05, 0.08][seed as usize % 3];
        let mut noise = noise(seed + 1000);
        let (rows, decades) = (8 + draw.below(53), draw.between(3.0, 6.0));
        let x = (0..rows).map(|k| 10f64.powf(decades * (k as f64 / (rows - 1) as f64 - 0.5)));
        let mut squares = 0.0;
        let mut noisy = |value: f64| {
            let error = deviation * noise();
            squares += error * error;
            value * (1.0 + error)
        };
        let kind = seed as usize / 3 % 3;
        let table = match kind {
            0 => Measurements::creep(&x.map(|t| (t, noisy(body.creep_compliance(t)))).collect::<Vec<_>>()),
            1 => Measurements::relaxation(&x.map(|t| (t, noisy(spectrum.modulus(t)))).collect::<Vec<_>>()),
            _ => {
                let row = |w: f64| (w, noisy(spectrum.complex_modulus(w).re), noisy(spectrum.complex_modulus(w).im));
                Measurements::dynamic(&x.map(row).collect::<Vec<_>>())
            }
        };
        let rms = (squares / (rows * if kind == 2 { 2 } else { 1 }) as f64).sqrt();
        if rms > 0.095 {
            continue;
        }
        let fit = table.unwrap().fit();
        let fit = fit.unwrap_or_else(|error| panic!("seed {seed}, {rows} rows, noise {rms:.3}: {error}"));
        worst = worst.max(fit.report().rms_misfit() / rms);
        fitted += 1;
    }
    println!("{fitted} of {count} tables fitted, misfit at most {worst:.2} of the noise");
    assert!(fitted * 10 >= count * 9);
}

/// A pair of rows that contradict each other by little, in data with less scatter, is no end of linearity.
#[test]
fn a_pair_where_isotherms_meet_is_fitted_and_an_outlier_is_not() {
    let body = broad(&mut Draws::new(3), 1.0);
    let mut noise = noise(5);
    let mut table: Vec<(f64, f64)> = log_spaced(1e-3, 1e3, 10)
        .into_iter()
        .map(|t| (t, body.creep_compliance(t) * (1.0 + 0.003 * noise())))
        .collect();
    let (time, value) = table[30];
    table[30].1 = 1.03 * value;
    table.push((1.001 * time, 0.97 * value));
    let fit = Measurements::creep(&table).unwrap().fit().unwrap();
    assert!(fit.report().rms_misfit() < 0.01, "{}", fit.report());
    table.pop();
    table[30].1 = 1.5 * value;
    let outlier = Measurements::creep(&table).unwrap();
    assert!(outlier.fit().unwrap_err().to_string().contains("Measurements::with_scatter"));
    assert!(outlier.with_scatter(0.1).unwrap().fit().is_ok());
}

#[test]
fn isotherms_are_shifted_within_their_errors() {
    shifts_within_their_errors(false);
}

/// The same where the values of each isotherm have a factor, which takes the place of a shift where slopes are alike: both are found,
/// or told by the error.
#[test]
fn isotherms_are_shifted_within_their_errors_with_factors() {
    shifts_within_their_errors(true);
}

/// Shifts of random isotherms, with noise, outliers and loss moduli spoiled at one end, within 0.05 decades or three of their
/// stated errors.
fn shifts_within_their_errors(is_vertical: bool) {
    let (count, mut shifts, mut off, mut errors) =
        (from_environment("ISOTHERM_SETS", 12), 0, Vec::new(), Ratios::default());
    for seed in 0..count {
        let mut draw = Draws::new(seed);
        let (mut number, decades, per_decade) = (3 + draw.below(10), draw.between(2.0, 4.0), draw.between(4.0, 12.0));
        let (deviation, dynamic) = (draw.scale(0.003, 0.08), draw.chance(0.6));
        let (outliers, spoiled) = (draw.chance(0.5), draw.chance(0.4));
        let mut factors = vec![1.0];
        for k in 1..number {
            factors.push(factors[k - 1] * 10f64.powf(-decades * draw.between(0.2, 0.65)));
        }
        // the body relaxes over sixteen decades
        factors.retain(|factor| *factor > 1e-11);
        number = factors.len();
        let body = broad(&mut draw, factors[number - 1].sqrt());
        let spectrum = body.creep_spectrum().unwrap().relaxation();
        let verticals: Vec<f64> =
            (0..number).map(|_| if is_vertical { draw.between(0.8, 1.25) } else { 1.0 }).collect();
        let mut noise = noise(seed + 7);
        let rows = (decades * per_decade) as usize + 1;
        let isotherm = |k: usize, draw: &mut Draws, noise: &mut dyn FnMut() -> f64| {
            let mut noisy = |value: f64, draw: &mut Draws| {
                let outlier = if outliers && draw.chance(0.03) { [0.25, -0.25][draw.below(2)] } else { 0.0 };
                verticals[k] * value * (deviation * noise() + outlier).exp()
            };
            let x: Vec<f64> = (0..rows).map(|i| 10f64.powf(decades * (i as f64 / (rows - 1) as f64 - 0.5))).collect();
            let table = if dynamic {
                let mut table: Vec<(f64, f64, f64)> = x
                    .iter()
                    .map(|&w| {
                        let at = w * factors[k] / factors[number - 1];
                        (w, noisy(spectrum.complex_modulus(at).re, draw), noisy(spectrum.complex_modulus(at).im, draw))
                    })
                    .collect();
                if spoiled {
                    table[rows - 1].2 *= 1.35;
                }
                Measurements::dynamic(&table)
            } else {
                let at = |t: f64| spectrum.modulus(t / factors[k] * factors[number - 1]);
                Measurements::relaxation(&x.iter().map(|&t| (t, noisy(at(t), draw))).collect::<Vec<_>>())
            };
            Isotherm::new(300.0 + 5.0 * k as f64, table.unwrap()).unwrap()
        };
        let isotherms: Vec<Isotherm> = (0..number).map(|k| isotherm(k, &mut draw, &mut noise)).collect();
        let reference = draw.below(number);
        let shifted = if is_vertical { MasterCurve::with_vertical_shifts } else { MasterCurve::new };
        let master = shifted(300.0 + 5.0 * reference as f64, isotherms)
            .unwrap_or_else(|error| panic!("seed {seed}, noise {deviation:.3}: {error}"));
        let verticals_found = master.vertical_factors();
        assert!(is_vertical || verticals_found.iter().all(|(_, factor)| *factor == 1.0));
        for (k, ((_, found), (_, error))) in master.shift_factors().into_iter().zip(master.shift_errors()).enumerate() {
            let apart = (found / (factors[k] / factors[reference])).log10().abs();
            let of_values = (verticals_found[k].1 / (verticals[k] / verticals[reference])).ln().abs();
            shifts += 1;
            errors.push(apart, "");
            let told = 3.0 * error * std::f64::consts::LN_10;
            if apart > 0.05 && apart > 3.0 * error || of_values > 0.05 && of_values > told {
                let of = format!("seed {seed}, {k} of {number}: {apart:.3} ± {error:.3}, factor off by {of_values:.3}");
                off.push(format!("{of}, noise {deviation:.3}"));
            }
        }
    }
    errors.print("decades of shifts", 0);
    assert!(shifts > 5 * count as usize / 2);
    assert!(off.is_empty(), "{} of {shifts}:\n{}", off.len(), off.join("\n"));
}

/// A loss modulus that the machine spoils does not move the shift, and storage and loss are said to disagree.
#[test]
fn columns_that_disagree_are_told() {
    let body = broad(&mut Draws::new(1), 1.0);
    let spectrum = body.creep_spectrum().unwrap().relaxation();
    let isotherm = |temperature: f64, shift: f64, loss: f64| {
        let row = |w: f64| {
            let at = w * 10f64.powf(shift);
            (w, spectrum.complex_modulus(at).re, spectrum.complex_modulus(at * loss).im)
        };
        let table: Vec<_> = log_spaced(0.1, 100.0, 6).into_iter().map(row).collect();
        Isotherm::new(temperature, Measurements::dynamic(&table).unwrap()).unwrap()
    };
    let simple = MasterCurve::new(300.0, vec![isotherm(300.0, 0.0, 1.0), isotherm(310.0, -1.5, 1.0)]).unwrap();
    assert!((simple.shift_factors()[1].1.log10() + 1.5).abs() < 0.01, "{:?}", simple.shift_factors());
    assert_eq!(simple.disagreements(), []);
    let apart = MasterCurve::new(300.0, vec![isotherm(300.0, 0.0, 1.0), isotherm(310.0, -1.0, 3.0)]).unwrap();
    assert!(matches!(apart.disagreements()[..], [(310.0, by)] if by > 0.2), "{:?}", apart.disagreements());
}
