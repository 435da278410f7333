//! Units in headings of tables: accepted if they are those given, else refused by their names.

use viscocontact::prelude::*;
use viscocontact::rheology::{Experiment, TableError, Units};

use super::dialects::{creep, points};

const ROWS: &str = "1;1.0\n2;1.1\n4;1.3\n8;1.4\n";
const MODULI_ROWS: &str = "0.1;1.0;0.2\n1;1.5;0.4\n10;2.2;0.4\n100;2.5;0.1\n";

#[test]
fn units_of_headings_are_those_given() {
    let minutes = Units::new(60.0, 1e-9).unwrap();
    let refused =
        |headings: &str, units: Units| match creep(&format!("{headings}\n{ROWS}"), units, points()).unwrap_err() {
            Error::Table(TableError::Unit { line: 1, column, unit, field, expected, .. }) => {
                (column, unit.into_string(), field, expected.into_string())
            }
            other => panic!("{headings}: {other}"),
        };
    let as_text = |column, unit: &str, field, expected: &str| (column, unit.to_owned(), field, expected.to_owned());
    // all other units stand in the places that the population below draws
    assert_eq!(refused("J (MPa^-1);t (min)", minutes), as_text(1, "MPa^-1", "value", "1/GPa"));
    assert_eq!(refused("t;J [GPa]", minutes), as_text(2, "GPa", "value", "1/GPa"));
    assert_eq!(refused("J;t [h]", Units::SI), as_text(2, "h", "abscissa", "s"));
    for headings in
        ["t [min];J [1/GPa]", "t / min;J / GPa^-1", "t;J", "t [MINUTES];J [10^-9 1/Pa]", "t [?];J (at 5 MPa)"]
    {
        creep(&format!("{headings}\n{ROWS}"), minutes, points()).unwrap_or_else(|error| panic!("{headings}: {error}"));
    }
    let dynamic = |headings: &str, units| {
        let text = format!("{headings}\n{MODULI_ROWS}");
        Measurements::from_csv_reader(Experiment::Dynamic, text.as_bytes(), units, points())
            .and_then(|table| table.fit())
            .map(|_| ())
    };
    let kilohertz = Units::new(6283.19, 1e6).unwrap();
    assert_eq!(dynamic("f [kHz];G' [MPa];G'' [MPa]", kilohertz), Ok(()));
    let error = dynamic("f [Hz];G' [MPa];G'' [MPa]", kilohertz).unwrap_err();
    assert!(
        matches!(&error, Error::Table(TableError::Unit { column: 1, .. })) && error.to_string().contains("kHz"),
        "{error}"
    );
    let error = dynamic("omega [rad/s];G' [MPa];G'' [Pa]", Units::new(1.0, 1e6).unwrap()).unwrap_err();
    assert!(matches!(error, Error::Table(TableError::Unit { column: 3, .. })), "{error}");
    let message = creep(&format!("time [min];J\n{ROWS}"), Units::SI, points()).unwrap_err().to_string();
    let expected =
        "line 1, column 1: the heading \"time [min]\" says min, but Units::abscissa = 1 means s; of min it is 60";
    assert_eq!(message, expected);
}

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
    println!("{read} headings read, {refused} refused");
    assert!(read > 1000 && refused > 2000);
}
