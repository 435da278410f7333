//! Tables as programs and people write them: read exactly, or refused where they are spoiled.

use viscocontact::prelude::*;
use viscocontact::rheology::{GeneralizedMaxwell, Rheology, TableError, TabulatedCreep, TabulatedDynamic, Units};

use crate::common::noise::uniform;

fn creep(text: &str, units: Units) -> Result<TabulatedCreep, TableError> {
    TabulatedCreep::from_csv_reader(text.as_bytes(), units).map_err(|error| match error {
        Error::Table(error) => error,
        other => panic!("{other}"),
    })
}

/// Times and values as they were read.
fn samples(text: &str) -> Vec<[f64; 2]> {
    let table = creep(text, Units::SI).unwrap_or_else(|error| panic!("{text:?}: {error}"));
    table.report().samples().iter().map(|sample| [sample.x, sample.given]).collect()
}

#[test]
fn decimal_commas_and_fortran_exponents_are_read() {
    let expected = [[0.5, 1.0], [1.0, 1.25], [2.0, 1.5], [4.0, 1.75]];
    for text in [
        "0,5;1\n1;1,25\n2;1,5\n4;1,75\n",
        "0,5\t1,0\n1\t1,25\n2\t1,5\n4\t1,75\n",
        "t J\n0,5 1,0\n1,0 1,25\n2,0 1,5\n4,0 1,75\n",
        "\"0,5\",\"1,0\"\n\"1\",\"1,25\"\n\"2,0\",\"1,5\"\n\"4,0\",\"1,75\"\n",
        "0.5D0, 1D0\n1D0, 1.25D+00\n0.2d1, 15.D-1\n4, 1.75d0\n",
        "5,0E-1;1,0E0\n1;1,25\n2;1,5\n4;1,75\n",
        "n/T;t/s;J·Pa;J\n;0.5;;1\n;1;;1.25\n;2;;1.5\n;4;;1.75\n",
    ] {
        assert_eq!(samples(text), expected, "{text:?}");
    }
}

#[test]
fn fields_that_are_not_numbers_are_named() {
    let rest = "2;1.1\n4;1.3\n8;1.4\n16;1.5\n";
    let error = |text: String| creep(&text, Units::SI).unwrap_err();
    for (row, column, text) in [
        ("<1;1.0", 1, "<1"),
        ("1;<1.0", 2, "<1.0"),
        ("oops;1.0", 1, "oops"),
        ("1.0.0;1.0", 1, "1.0.0"),
        ("1;n/a", 2, "n/a"),
        ("1;", 2, ""),
        ("-;-", 1, "-"),
        ("1 min;1 GPa", 1, "1 min"),
        ("1;\"1.0", 2, "\"1.0"),
        ("\"1\"0;1.0", 1, "\"1\"0"),
    ] {
        let bad = error(format!("{row}\n{rest}"));
        assert_eq!(bad, TableError::NotNumeric { line: 1, column, text: text.into() }, "{row}");
        let bad = error(format!("t;J\n{rest}{row}\n"));
        assert_eq!(bad, TableError::NotNumeric { line: 6, column, text: text.into() }, "{row}");
    }
    let bad = error("1,5 ;1,000\n2;2.5\n".into());
    assert!(matches!(bad, TableError::Ambiguous { line: 2, column: 2, .. }), "{bad}");
    // a number among headings
    let bad = error("t,J,2nd run\n1,1,1\n".into());
    assert_eq!(bad, TableError::NotNumeric { line: 1, column: 3, text: "2nd run".into() });
    // a column of decimal commas
    for text in ["1,5\n2,6\n3,7\n4,8\n", "x,y\n1,5e-9\n2,6e-9\n3,7e-9\n4,8e-9\n"] {
        let bad = error(text.into());
        assert!(matches!(bad, TableError::Ambiguous { column: 1, .. }), "{bad}");
    }
    let bad = error("J\n1,5\n2,6\n3,7\n4,8\n".into());
    assert!(matches!(bad, TableError::Columns { line: 1, found: 1, .. }), "{bad}");
    let integers = "1,5\n2,6\n3,7\n4,8\n";
    for text in [format!("t,J\n{integers}"), integers.replace(',', ", ")] {
        assert_eq!(samples(&text), [[1.0, 5.0], [2.0, 6.0], [3.0, 7.0], [4.0, 8.0]], "{text:?}");
    }
}

#[test]
fn units_of_headings_are_those_given() {
    let rows = "1;1.0\n2;1.1\n4;1.3\n8;1.4\n";
    let minutes = Units { abscissa: 60.0, value: 1e-9 };
    let refused = |headings: &str, units: Units| match creep(&format!("{headings}\n{rows}"), units).unwrap_err() {
        TableError::Unit { line: 1, column, unit, field, expected, .. } => (column, unit, field, expected),
        other => panic!("{headings}: {other}"),
    };
    let as_text = |column, unit: &str, field, expected: &str| (column, unit.to_owned(), field, expected.to_owned());
    assert_eq!(refused("time [min];J [1/Pa]", Units::SI), as_text(1, "min", "abscissa", "s"));
    assert_eq!(refused("time [s];J [1/GPa]", Units::SI), as_text(2, "1/GPa", "value", "1/Pa"));
    assert_eq!(refused("t/s;J", minutes), as_text(1, "s", "abscissa", "min"));
    assert_eq!(refused("J (MPa^-1);t (min)", minutes), as_text(1, "MPa^-1", "value", "1/GPa"));
    assert_eq!(refused("time min;J", Units::SI), as_text(1, "min", "abscissa", "s"));
    assert_eq!(refused("t;J [GPa]", minutes), as_text(2, "GPa", "value", "1/GPa"));
    assert_eq!(refused("first [h];second", Units::SI), as_text(1, "h", "abscissa", "s"));
    for headings in
        ["t [min];J [1/GPa]", "t / min;J / GPa^-1", "t;J", "t [MINUTES];J [10^-9 1/Pa]", "t [?];J (at 5 MPa)"]
    {
        creep(&format!("{headings}\n{rows}"), minutes).unwrap_or_else(|error| panic!("{headings}: {error}"));
    }
    let dynamic = |headings: &str, units| {
        let text = format!("{headings}\n0.1;1.0;0.2\n1;1.5;0.4\n10;2.2;0.4\n100;2.5;0.1\n");
        TabulatedDynamic::from_csv_reader(text.as_bytes(), units).map(|_| ())
    };
    let kilohertz = Units { abscissa: 6283.19, value: 1e6 };
    assert_eq!(dynamic("f [kHz];G' [MPa];G'' [MPa]", kilohertz), Ok(()));
    let error = dynamic("f [Hz];G' [MPa];G'' [MPa]", kilohertz).unwrap_err();
    assert!(
        matches!(&error, Error::Table(TableError::Unit { column: 1, .. })) && error.to_string().contains("kHz"),
        "{error}"
    );
    let error = dynamic("omega [rad/s];G' [MPa];G'' [Pa]", Units { abscissa: 1.0, value: 1e6 }).unwrap_err();
    assert!(matches!(error, Error::Table(TableError::Unit { column: 3, .. })), "{error}");
    let message = creep(&format!("time [min];J\n{rows}"), Units::SI).unwrap_err().to_string();
    assert_eq!(message, "line 1, column 1: the heading \"time [min]\" says min, but Units::abscissa = 1 means s");
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
                    let units = if first {
                        Units { abscissa: given, value: 1.0 }
                    } else {
                        Units { abscissa: 1.0, value: given }
                    };
                    let column = if dynamic { ";G''" } else { "" };
                    let headings = if first {
                        format!("{quoted};{}", if dynamic { "G'" } else { "J" })
                    } else {
                        format!("x;{quoted}")
                    };
                    let rows = if dynamic {
                        "0.1;1.0;0.2\n1;1.5;0.4\n10;2.2;0.4\n100;2.5;0.1\n"
                    } else {
                        "1;1.0\n2;1.1\n4;1.3\n8;1.4\n"
                    };
                    let headings =
                        if first { headings } else { headings.replace('x', if dynamic { "omega" } else { "t" }) };
                    let text = format!("{headings}{column}\n{rows}");
                    if dynamic {
                        TabulatedDynamic::from_csv_reader(text.as_bytes(), units).map(|_| ())
                    } else {
                        TabulatedCreep::from_csv_reader(text.as_bytes(), units).map(|_| ())
                    }
                };
                table(*size).unwrap_or_else(|error| panic!("{heading}: {error}"));
                read += 1;
                for &(_, other) in kinds {
                    let also = unit.contains("/s") || unit.starts_with("s^") && !unit.starts_with("rad");
                    if other == *size || also {
                        continue;
                    }
                    match table(other).unwrap_err() {
                        Error::Table(TableError::Unit { unit: said, .. }) => assert_eq!(said, *unit, "{heading}"),
                        Error::Table(TableError::Hertz { .. }) => assert!(["Hz", "hertz"].contains(unit), "{heading}"),
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

/// How a table is written.
struct Dialect {
    separator: char,
    comma: bool,
    exponent: &'static str,
    end: &'static str,
    quotes: bool,
}

/// Random tables in random dialects, some with headings, wrong units or spoiled fields: what was written is read exactly, or
/// refused where it is spoiled.
#[test]
fn tables_are_read_exactly_or_refused_where_they_are_spoiled() {
    const TIMES: [(&str, f64); 4] = [("s", 1.0), ("min", 60.0), ("h", 3600.0), ("ms", 1e-3)];
    const FREQUENCIES: [(&str, f64); 3] = [("rad/s", 1.0), ("Hz", std::f64::consts::TAU), ("rad·s⁻¹", 1.0)];
    const COMPLIANCES: [(&str, f64); 4] = [("1/Pa", 1.0), ("1/GPa", 1e-9), ("MPa^-1", 1e-6), ("GPa⁻¹", 1e-9)];
    const MODULI: [(&str, f64); 3] = [("Pa", 1.0), ("MPa", 1e6), ("kPa", 1e3)];
    const SPOILED: [&str; 15] =
        ["<1", "≥ 2.5", "1,5,2", "", "NA", "1.5.2", "oops", "1e", "O.5", "--", "1;5", "5 Pa", "\"1", "\"1\"5", "1D"];
    let [mut exact, mut spoiled, mut other_unit] = [0; 3];
    for seed in 0..1500 {
        let mut number = uniform(seed);
        let mut random = move |below: usize| (number() * below as f64) as usize;
        let dynamic = random(3) == 0;
        let width = if dynamic { 3 } else { 2 };
        let body = GeneralizedMaxwell::new(1.0, &[(2.0, 1.0), (3.0, 30.0)]).unwrap();
        let spectrum = body.creep_spectrum().unwrap().relaxation();
        let (digits, scientific) = (2 + random(4), dynamic || random(2) == 0);
        let first = [0.03, 1.0][random(2)];
        let written = |value: f64| match scientific {
            true => format!("{value:.digits$e}"),
            false => format!("{value:.0$}", digits + 2),
        };
        let rows: Vec<Vec<String>> = (0..5 + random(5))
            .map(|k| {
                let x: f64 = format!("{:.1e}", first * 3f64.powi(k as i32)).parse().unwrap();
                let values = match dynamic {
                    true => vec![spectrum.storage_modulus(x), spectrum.loss_modulus(x)],
                    false => vec![body.creep_compliance(x)],
                };
                std::iter::once(format!("{x}")).chain(values.into_iter().map(written)).collect()
            })
            .collect();

        let dialect = Dialect {
            separator: [',', ';', '\t', ' '][random(4)],
            comma: random(2) == 0,
            exponent: ["e", "E", "d", "D"][random(4)],
            end: ["\n", "\r\n", "\r"][random(3)],
            quotes: random(4) == 0,
        };
        let (x_units, value_units) =
            if dynamic { (&FREQUENCIES[..], &MODULI[..]) } else { (&TIMES[..], &COMPLIANCES[..]) };
        let (x_unit, value_unit) = (x_units[random(x_units.len())], value_units[random(value_units.len())]);
        let units = Units { abscissa: x_unit.1, value: value_unit.1 };
        // columns in any order, and one that is not needed, where there are headings
        let headings = random(4);
        let mut order: Vec<usize> = (0..width).collect();
        if headings > 1 {
            order.swap(0, random(width));
            order.insert(random(width + 1), usize::MAX);
        }
        let wrong = (headings == 3 && random(3) == 0).then(|| random(width));
        let mut bad: Vec<(usize, usize, &str)> = Vec::new();
        if random(2) == 0 {
            for _ in 0..=random(3) {
                let (row, place) = (random(rows.len()), random(order.len()));
                if order[place] != usize::MAX && bad.iter().all(|spoiled| spoiled.0 != row) {
                    bad.push((row, place, SPOILED[random(SPOILED.len())]));
                }
            }
            bad.sort_unstable();
        }

        let quoted = |text: &str| match text.contains(dialect.separator) || dialect.quotes {
            true => format!("\"{}\"", text.replace('"', "\"\"")),
            false => text.to_owned(),
        };
        let pad = if dialect.separator == ' ' { ["", "  ", " "] } else { ["", " ", "  "] };
        let join = |fields: Vec<String>, random: &mut dyn FnMut(usize) -> usize| {
            let mut line = String::new();
            for (k, field) in fields.iter().enumerate() {
                if k > 0 {
                    line.push_str(pad[random(3)]);
                    line.push(dialect.separator);
                    line.push_str(pad[random(3)]);
                }
                line.push_str(field);
            }
            line
        };
        let (mut lines, mut heading_line, mut row_lines) = (Vec::<String>::new(), 0, Vec::new());
        let remark = |lines: &mut Vec<String>, random: &mut dyn FnMut(usize) -> usize| match random(8) {
            0 => lines.push("# 1,5; \"a\tb".into()),
            1 => lines.push(["", "  ", " # remark"][random(3)].into()),
            _ => {}
        };
        remark(&mut lines, &mut random);
        if headings > 0 {
            let names: [&str; 3] = match (headings, dynamic) {
                (1, _) => ["first", "second", "third"],
                (_, true) => ["omega", "G'", "G''"],
                (_, false) => ["time", "J", ""],
            };
            let title = |column: usize| {
                if column == usize::MAX {
                    return "remark".to_owned();
                }
                let own = if column == 0 { x_unit } else { value_unit };
                let unit = match wrong == Some(column) {
                    true => {
                        let all = if column == 0 { x_units } else { value_units };
                        all.iter().find(|unit| unit.1 != own.1).unwrap().0
                    }
                    false => own.0,
                };
                match (headings, seed % 3) {
                    (3, 0) => format!("{}[{unit}]", names[column]),
                    (3, 1) => format!("{}({unit})", names[column]),
                    (3, _) => format!("{}/({unit})", names[column]),
                    _ => names[column].to_owned(),
                }
            };
            let fields = order.iter().map(|&column| quoted(&title(column))).collect();
            // Hz without 2π has an error of its own
            lines.push(join(fields, &mut random));
            heading_line = lines.len();
        }
        for (k, row) in rows.iter().enumerate() {
            remark(&mut lines, &mut random);
            let field = |(place, &column): (usize, &usize)| {
                if let Some(&(_, _, text)) = bad.iter().find(|spoiled| (spoiled.0, spoiled.1) == (k, place)) {
                    return text.to_owned();
                }
                if column == usize::MAX {
                    return "steel".to_owned();
                }
                let number = row[column].replace('e', dialect.exponent);
                quoted(&if dialect.comma { number.replace('.', ",") } else { number })
            };
            let fields = order.iter().enumerate().map(field).collect();
            lines.push(join(fields, &mut random));
            row_lines.push(lines.len());
        }
        let mut text = lines.join(dialect.end);
        if random(2) == 0 {
            text += dialect.end;
        }
        if random(4) == 0 {
            text.insert(0, '\u{feff}');
        }

        let read = match dynamic {
            true => TabulatedDynamic::from_csv_reader(text.as_bytes(), units).map(|table| table.report().clone()),
            false => TabulatedCreep::from_csv_reader(text.as_bytes(), units).map(|table| table.report().clone()),
        };
        match read {
            Ok(report) => {
                assert!(bad.is_empty() && wrong.is_none(), "seed {seed}: {bad:?} {wrong:?} in\n{text}");
                let found: Vec<[f64; 2]> = report.samples().iter().map(|sample| [sample.x, sample.given]).collect();
                let value = |text: &String, unit: f64| text.parse::<f64>().unwrap() * unit;
                let expected: Vec<[f64; 2]> = (1..width)
                    .flat_map(|column| {
                        rows.iter().map(move |row| [value(&row[0], units.abscissa), value(&row[column], units.value)])
                    })
                    .collect();
                assert_eq!(found, expected, "seed {seed}:\n{text}");
                exact += 1;
            }
            Err(Error::Table(TableError::Unit { line, column, .. })) => {
                let place = order.iter().position(|&column| Some(column) == wrong);
                assert_eq!((line as usize, Some(column - 1)), (heading_line, place), "seed {seed}:\n{text}");
                other_unit += 1;
            }
            Err(Error::Table(TableError::Hertz { .. })) => {
                assert!(wrong == Some(0) && dynamic, "seed {seed}:\n{text}");
                other_unit += 1;
            }
            Err(Error::Table(error)) => {
                let Some(&(row, place, spoil)) = bad.first() else { panic!("seed {seed}: {error} in\n{text}") };
                let line = row_lines[row] as u64;
                // a separator within a field makes another number of them, and so does a field of blanks
                let torn = spoil.contains(dialect.separator) || spoil.is_empty() && dialect.separator == ' ';
                match error {
                    TableError::NotNumeric { line: found, column, .. } => {
                        assert_eq!((found, column), (line, place + 1), "seed {seed}: {spoil}\n{text}");
                    }
                    TableError::Columns { line: found, .. } => {
                        assert!(torn && found == line, "seed {seed}: {spoil}, {found}\n{text}");
                    }
                    other => panic!("seed {seed}: {other} of {spoil} in\n{text}"),
                }
                spoiled += 1;
            }
            Err(other) => panic!("seed {seed}: {other}"),
        }
    }
    println!("{exact} exact, {spoiled} spoiled, {other_unit} in other units");
    assert!(exact > 600 && spoiled > 500 && other_unit > 80);
}
