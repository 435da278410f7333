//! Periodic histories: their corners at any number of periods, against a phase that is exact.

use viscocontact::load::{Load, Periodic, laws};
use viscocontact::prelude::*;

use crate::common::{Draws, from_environment};

/// Number of random periods; those of 0.01 s to 1 s are tested in any case.
const QUICK: u64 = 300;
/// Periods from which on a history is followed.
const PERIODS: [f64; 6] = [0.0, 28.0, 999.0, 12_345.0, 999_999.0, 1.0e6];

/// A history, and the table of its period.
struct Case {
    period: f64,
    table: Vec<(f64, f64)>,
    history: Periodic,
}

fn loads(rows: &[(f64, f64)]) -> Vec<(f64, Load)> {
    rows.iter().map(|&(time, force)| (time, Load::force(force))).collect()
}

impl Case {
    fn random(number: u64) -> Case {
        let mut draws = Draws::new(number);
        let period = if number < 100 { 0.01 * (number + 1) as f64 } else { draws.power_of_ten(-9.0, 9.0) };
        let [a, b] = [draws.between(0.0, 1.0), draws.between(0.0, 1.0)];
        let [first, second] = [a, b].map(Load::force);
        let duty = if draws.chance(0.5) { 0.5 } else { draws.between(0.01, 0.99) };
        let (table, history) = match draws.below(5) {
            0 | 1 => (
                vec![(0.0, a), (duty * period, a), (duty * period, b), (period, b)],
                Periodic::square(first, second, period, duty),
            ),
            2 => (vec![(0.0, a), (0.5 * period, b), (period, a)], Periodic::triangle(first, second, period)),
            3 => (vec![(0.0, a), (period, b)], Periodic::sawtooth(first, second, period)),
            _ => {
                let mut rows = vec![(0.0, a)];
                for k in 1..2 + draws.below(6) {
                    let time = period * (k as f64 + draws.between(-0.4, 0.4)) / 9.0;
                    rows.push((time, draws.between(0.0, 1.0)));
                    if draws.chance(0.4) {
                        rows.push((time, draws.between(0.0, 1.0)));
                    }
                }
                rows.push((period, b));
                let history = Periodic::new(&loads(&rows));
                (rows, history)
            }
        };
        Case { period, table, history: history.unwrap() }
    }
}

#[test]
fn corners_ascend_and_are_exact_in_a_random_population() {
    let (mut corners, mut compared) = (0, 0);
    for number in 0..100 + from_environment("RANDOM_PERIODS", QUICK) {
        let Case { period, table, history } = Case::random(number);
        let one = PiecewiseLinear::new(&loads(&table)).unwrap();
        let what = |at: f64| format!("{number}: {history:?} at {at:?}");
        for start in PERIODS.map(|periods| periods * period) {
            let resolution = (start + 4.0 * period).next_up() - (start + 4.0 * period);
            let mut before = start;
            for _ in 0..3 * table.len() {
                let corner = history.next_breakpoint(before).unwrap();
                assert!(corner > before, "{}", what(before));
                assert_eq!(history.next_breakpoint(corner.next_down()), Some(corner), "{}", what(corner));
                // the remainder of a division has no error
                let phase = corner % period;
                let off = |&(time, _): &(f64, f64)| (phase - time).abs().min((phase - period - time).abs());
                assert!(table.iter().map(off).fold(f64::INFINITY, f64::min) <= resolution, "{}", what(corner));
                let middle = before + 0.37 * (corner - before);
                if 1e-6 * (corner - before) > resolution {
                    let Load::Force { normal: found, .. } = history.at(middle) else { unreachable!() };
                    let Load::Force { normal: expected, .. } = one.at(middle % period) else { unreachable!() };
                    let steepest = 2.0 / (corner - before);
                    assert!((found - expected).abs() <= 4.0 * steepest * resolution + 1e-15, "{}", what(middle));
                    assert_eq!(history.before(middle), history.at(middle), "{}", what(middle));
                    compared += 1;
                }
                (before, corners) = (corner, corners + 1);
            }
            let times = laws::even_times(start, start + 3.0 * period, 5);
            laws::all(&history, &times).unwrap_or_else(|violation| panic!("{violation}\n{}", what(start)));
        }
    }
    println!("{corners} corners, {compared} loads");
    assert!(corners >= 100 * 6 * 3 * 2 && compared > corners / 2, "{corners} {compared}");
}

/// The load before the first period is the first one, and a table may begin at any time.
#[test]
fn a_period_begins_where_its_table_does() {
    let history = Periodic::new(&loads(&[(0.25, 0.0), (0.25, 1.0), (0.5, 3.0), (1.25, 2.0)])).unwrap();
    let force = |force: f64| Load::force(force);
    for time in [f64::NEG_INFINITY, -1.0, 0.0] {
        assert_eq!((history.at(time), history.next_breakpoint(time)), (force(0.0), Some(0.25)));
    }
    assert_eq!([history.before(0.25), history.at(0.25), history.at(0.375)], [0.0, 1.0, 2.0].map(force));
    assert_eq!([history.before(1.25), history.at(1.25), history.at(1000.375)], [2.0, 1.0, 2.0].map(force));
    // beyond what f64 resolves there is a load, and no breakpoint
    for time in [1e30, f64::MAX, f64::INFINITY, f64::NAN] {
        assert!(matches!(history.at(time), Load::Force { normal, .. } if (0.0..=3.0).contains(&normal)), "{time}");
        let next = history.next_breakpoint(time);
        assert!(next.is_none_or(|next| next.is_finite() && (next > time || time.is_nan())), "{time}");
    }
}
