//! Rows that repeat a time or a frequency, and single rows that go the wrong way.

use viscocontact::TextFormat;
use viscocontact::prelude::*;
use viscocontact::rheology::{Experiment, FitWarning, Isotherm, MasterCurve, Measurements, Units};

use crate::common::noise;

/// Times printed with four digits repeat from 1000 s on: two values at one time are two measurements.
#[test]
fn repeated_times_are_averaged_and_told() {
    let compliance = |t: f64| 1.0e-6 * (1.0 + t.powf(0.2));
    let table: Vec<(f64, f64)> = (0..60)
        .map(|k| 990.0 + 0.5 * f64::from(k))
        .map(|t| (if t < 1000.0 { t } else { t.floor() }, compliance(t)))
        .collect();
    let body = Measurements::creep(&table).and_then(|table| table.fit()).unwrap();
    assert_eq!((body.report().samples().len(), body.report().averaged()), (40, 20));
    assert!(body.report().to_string().contains("20 rows at the time or frequency of the row before"));
    for t in [995.0, 1005.0, 1010.0] {
        assert!((body.creep_compliance(t) / compliance(t) - 1.0).abs() < 1e-3);
    }
    // values that contradict each other, and rows that do not follow one another
    for rows in [[(1.0, 1.0), (2.0, 1.1), (2.0, 1.3), (4.0, 1.5)], [(1.0, 1.0), (2.0, 1.1), (4.0, 1.5), (2.0, 1.11)]] {
        assert!(Measurements::creep(&[rows.to_vec(), vec![(8.0, 1.6)]].concat()).is_err(), "{rows:?}");
    }
}

/// A knock at one row of thousands is a warning, a step that lasts is refused.
#[test]
fn one_row_of_thousands_may_go_the_wrong_way() {
    let (mut noise, mut table) = (noise(3), Vec::new());
    for k in 0..4000 {
        let t = 0.2 + 0.5 * f64::from(k);
        table.push((t, 1.0e-6 * (1.0 + t.powf(0.2)) * (1.0 + 2e-4 * noise())));
    }
    let exact = Measurements::creep(&table).and_then(|table| table.fit()).unwrap();
    let at = table[2000].0;
    table[2000].1 *= 0.99;
    let body = Measurements::creep(&table).and_then(|table| table.fit()).unwrap();
    let Some(FitWarning::Outlier { x, deviation }) = body.report().warning() else { panic!("{}", body.report()) };
    assert!(x == at && (deviation + 0.01).abs() < 3e-3, "{x} {deviation}");
    for t in [1.0, 100.0, at, 1900.0] {
        assert!((body.creep_compliance(t) / exact.creep_compliance(t) - 1.0).abs() < 1e-3);
    }
    table.iter_mut().skip(2000).take(400).for_each(|row| row.1 *= 0.99);
    assert!(Measurements::creep(&table).and_then(|table| table.fit()).is_err());
}

/// The moduli of a temperature ramp at five frequencies, in the order of the temperatures or of the frequencies.
fn ramp(step: f64, by_frequency: bool) -> String {
    let hertz = [0.5, 1.0, 3.0, 10.0, 30.0];
    let mut rows = Vec::new();
    for k in 0..30 {
        let temperature = step * f64::from(k);
        for (place, f) in hertz.iter().enumerate() {
            let x = f * 10f64.powf(-0.1 * temperature);
            let (storage, loss) = (1000.0 * x.powf(0.1), 150.0 * x.powf(0.1));
            // the oven is a little off its set point
            let temperature = temperature + 0.02 * (7.0 * x).sin();
            rows.push((place, format!("{temperature:.3},{f},{storage:.4},{loss:.4}\n")));
        }
    }
    if by_frequency {
        rows.sort_by_key(|row| row.0);
    }
    let rows: String = rows.into_iter().map(|row| row.1).collect();
    format!("Temperature,Frequency,Storage modulus E',Loss modulus E''\n°C,Hz,MPa,MPa\n{rows}")
}

#[test]
fn a_frequency_that_returns_begins_an_isotherm() {
    for (step, by_frequency) in [(0.2, false), (0.5, false), (2.0, false), (0.2, true), (0.5, true), (2.0, true)] {
        let text = ramp(step, by_frequency);
        let format = TextFormat::default();
        let isotherms =
            Isotherm::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::OF_HEADINGS, format).unwrap();
        assert_eq!(isotherms.len(), 30, "{step} {by_frequency}");
        let reference = isotherms[15].temperature();
        let master = MasterCurve::new(reference, isotherms).unwrap();
        for (temperature, factor) in master.shift_factors() {
            let exact = -0.1 * (temperature - reference);
            assert!((factor.log10() - exact).abs() < 0.06 + 0.02 * exact.abs(), "{temperature}: {factor} {exact}");
        }
    }
}
