//! Smooth isotherms that superpose to a few per cent, as those of real bodies do: shifted as least squares say.

use viscocontact::rheology::{Isotherm, MasterCurve, Measurements};

use crate::common::Draws;

/// ln of frequencies, and of storage and loss moduli.
type Curve = Vec<(f64, [f64; 2])>;

fn at(curve: &Curve, x: f64, column: usize) -> Option<f64> {
    let k = curve.partition_point(|row| row.0 < x);
    let (before, after) = (curve.get(k.checked_sub(1)?)?, curve.get(k)?);
    let part = (x - before.0) / (after.0 - before.0);
    Some(before.1[column] + part * (after.1[column] - before.1[column]))
}

/// The root mean square of the differences of two curves where they overlap, of which one is shifted.
fn misfit(one: &Curve, other: &Curve, shift: f64) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for (from, to, sign) in [(other, one, -1.0), (one, other, 1.0)] {
        for (x, values) in from {
            for (column, value) in values.iter().enumerate() {
                if let Some(line) = at(to, x + sign * shift, column) {
                    (squares, count) = (squares + (line - value).powi(2), count + 1.0);
                }
            }
        }
    }
    if count > 0.0 { f64::sqrt(squares / count) } else { f64::INFINITY }
}

#[test]
fn isotherms_that_superpose_to_a_few_per_cent_are_shifted_as_least_squares_say() {
    const PAIRS: usize = 80;
    const DECADE: f64 = std::f64::consts::LN_10;
    let (mut pairs, mut worst): (_, f64) = (0, 0.0);
    for seed in 0.. {
        let mut draw = Draws::new(seed);
        let (exponent, apart, shift) = (draw.between(0.1, 0.5), draw.between(-0.2, 0.2), draw.between(0.2, 1.3));
        let (rows, span) = (8 + draw.below(10), draw.between(1.8, 3.0));
        let (plateau, loss) = (draw.between(0.05, 1.0), draw.between(0.2, 0.6));
        let curve = |shift: f64, exponent: f64| -> Curve {
            let row = |k: usize| {
                let f = -0.5 + span * k as f64 / (rows - 1) as f64;
                let power = 10f64.powf(exponent * (f + shift));
                (f * DECADE, [(1.0e6 * (plateau + power)).ln(), (1.0e6 * loss * power).ln()])
            };
            (0..rows).map(row).collect()
        };
        let (cold, warm) = (curve(0.0, exponent * (1.0 + apart / 2.0)), curve(-shift, exponent * (1.0 - apart / 2.0)));
        // of overlaps of a third of the span and more
        let shifts = (0..2000).map(|k| f64::from(k) / 2000.0 * 0.67 * span * DECADE);
        let least =
            shifts.map(|shift| (misfit(&cold, &warm, shift), shift)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        if !(0.01..0.05).contains(&least.0) {
            continue;
        }
        pairs += 1;
        let isotherm = |temperature: f64, curve: &Curve| {
            let rows: Vec<_> = curve.iter().map(|(x, [a, b])| (x.exp(), a.exp(), b.exp())).collect();
            Isotherm::new(temperature, Measurements::dynamic(&rows).unwrap()).unwrap()
        };
        let master = MasterCurve::new(298.15, vec![isotherm(298.15, &cold), isotherm(303.15, &warm)])
            .unwrap_or_else(|error| panic!("{seed}: {error}"));
        let off = (master.shift_factors()[1].1.ln() + least.1).abs() / DECADE;
        assert!(off < 0.1, "{seed}: {off} decades off, where the best misfit is {}", least.0);
        worst = worst.max(off);
        if pairs == PAIRS {
            break;
        }
    }
    println!("{pairs} pairs, at most {worst:.3} decades from least squares");
}
