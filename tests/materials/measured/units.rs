//! Units in headings of tables: accepted if they are those given, else refused by their names.

use viscocontact::prelude::*;
use viscocontact::rheology::{Experiment, TableError, Units};

use super::dialects::{creep, points};

const ROWS: &str = "1;1.0\n2;1.1\n4;1.3\n8;1.4\n";
const MODULI_ROWS: &str = "0.1;1.0;0.2\n1;1.5;0.4\n10;2.2;0.4\n100;2.5;0.1\n";

/// Every unit after a symbol, with and without brackets: read where it is given, else refused by its own name.
#[test]
fn units_are_read_however_they_follow_the_symbol() {
    type Case = (&'static [&'static str], f64);
    const TIMES: [Case; 4] =
        [(&["s", "sec"], 1.0), (&["ms"], 1e-3), (&["min", "mins"], 60.0), (&["h", "hours"], 3600.0)];
    const RATES: [Case; 3] = [
        (&["rad/s", "rad s^-1", "rad·s⁻¹", "1/s", "s^-1"], 1.0),
        (&["Hz", "hertz"], std::f64::consts::TAU),
        (&["kHz"], 1e3 * std::f64::consts::TAU),
    ];
    const MODULI: [Case; 4] = [
        (&["Pa", "N/m2", "N/m^2", "N m^-2"], 1.0),
        (&["MPa", "N/mm²", "10^6 Pa"], 1e6),
        (&["GPa", "10⁹ Pa"], 1e9),
        (&["dyn/cm^2"], 0.1),
    ];
    const COMPLIANCES: [Case; 4] = [
        (&["1/Pa", "Pa^-1", "Pa-1", "Pa⁻¹", "m²/N", "m^2 N^-1", "1/(Pa)"], 1.0),
        (&["1/MPa", "MPa-1", "mm2/N", "10^-6 1/Pa", "10⁻⁶/Pa"], 1e-6),
        (&["1/GPa", "GPa^-1", "10^-9 Pa^-1", "10^{-9} 1/Pa", "1e-9 1/Pa"], 1e-9),
        (&["cm^2/dyn"], 10.0),
    ];
    let written = |symbol: &str, unit: &str| {
        let spaced = [" ", "_", " in ", ": ", " = ", " | ", ", "].map(|between| format!("{symbol}{between}{unit}"));
        let enclosed = [["[", "]"], [" [", "]"], [" (", ")"], ["/(", ")"], [" / (", ")"], [" {", "}"]];
        let enclosed = enclosed.map(|[open, close]| format!("{symbol}{open}{unit}{close}"));
        spaced.into_iter().chain(enclosed)
    };
    let (mut read, mut refused) = (0, 0);
    for (symbols, kinds, dynamic, first) in [
        (["t", "time", "Time"], &TIMES[..], false, true),
        (["omega", "ω", "Frequency"], &RATES, true, true),
        (["J", "J(t)", "Creep compliance"], &COMPLIANCES, false, false),
        (["G'", "E'", "Storage modulus"], &MODULI, true, false),
    ] {
        for (symbol, (units, size)) in symbols.iter().flat_map(|symbol| kinds.iter().map(move |kind| (symbol, kind))) {
            for heading in units.iter().flat_map(|unit| written(symbol, unit).map(move |heading| (heading, unit))) {
                let (heading, unit) = heading;
                let quoted = format!("\"{heading}\"");
                let table = |given: f64| {
                    let units = if first { Units::new(given, 1.0).unwrap() } else { Units::new(1.0, given).unwrap() };
                    let (experiment, x, value, rest) = match dynamic {
                        true => (Experiment::Dynamic, "omega", "G'", format!(";G''\n{MODULI_ROWS}")),
                        false => (Experiment::Creep, "t", "J", format!("\n{ROWS}")),
                    };
                    let [x, value] = if first { [&*quoted, value] } else { [x, &quoted] };
                    let text = format!("{x};{value}{rest}");
                    Measurements::from_csv_reader(experiment, text.as_bytes(), units, points())
                };
                table(*size).unwrap_or_else(|error| panic!("{heading}: {error}"));
                read += 1;
                for &(_, other) in kinds {
                    let also = unit.contains("/s") || unit.starts_with("s^") && !unit.starts_with("rad");
                    if other == *size || also {
                        continue;
                    }
                    match table(other).unwrap_err() {
                        Error::Table(TableError::Unit { line: 1, column, unit: said, field, .. }) => {
                            let place = if first { (1, "abscissa") } else { (2, "value") };
                            assert_eq!((&*said, (column, field)), (*unit, place), "{heading}");
                        }
                        error => panic!("{heading}: {error}"),
                    }
                    refused += 1;
                }
            }
        }
    }
    // no unit, one that is none, and one of something else
    for headings in ["t;J", "t [?];J (at 5 MPa)"] {
        let read = creep(&format!("{headings}\n{ROWS}"), Units::new(60.0, 1e-9).unwrap(), points());
        assert!(read.is_ok(), "{headings}");
    }
    println!("{read} headings read, {refused} refused");
    assert!(read > 1000 && refused > 2000);
}
