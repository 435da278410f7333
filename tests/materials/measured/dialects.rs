//! Tables as programs and people write them: read exactly, or refused where they are spoiled.

use viscocontact::rheology::{CreepSeries, Experiment, GeneralizedMaxwell, Measurements, Rheology, Units};
use viscocontact::{Delimiter, Result, TextFormat};

use crate::common::refused::says;
use crate::common::uniform;

fn creep(text: &str, units: Units, format: TextFormat) -> Result<CreepSeries> {
    Measurements::from_csv_reader(Experiment::Creep, text.as_bytes(), units, format).and_then(|table| table.fit())
}

/// Decimal points, and any delimiter.
fn points() -> TextFormat {
    TextFormat::default().with_decimal_comma(false)
}

fn commas() -> TextFormat {
    TextFormat::default().with_decimal_comma(true)
}

/// Times and values as they were read.
fn samples(text: &str, format: TextFormat) -> Vec<[f64; 2]> {
    let table = creep(text, Units::SI, format).unwrap_or_else(|error| panic!("{text:?}: {error}"));
    table.report().samples().iter().map(|sample| [sample.x, sample.given]).collect()
}

/// Beside the random tables below.
#[test]
fn fields_that_are_not_numbers_are_named() {
    let rest = "2;1.1\n4;1.3\n8;1.4\n16;1.5\n";
    let error = |text: String| creep(&text, Units::SI, points()).unwrap_err();
    // a first line without a number has headings
    for row in ["-;-", "1 min;1 GPa", "oops;n/a"] {
        let bad = error(format!("{row}\n{rest}"));
        says(&bad, "text_heading", "line 1: not exactly one heading names the time");
    }
    // decimal commas where points are stated
    for (text, line, column) in [("1,5 ;1.0\n2;2.5\n", 1, 1), ("2;2.5\n1;1,000\n", 2, 2), ("t;J\n1;1,5e-9\n", 2, 2)] {
        let bad = error(text.into());
        says(&bad, "text_decimal_mark", &format!("line {line}, column {column}: "));
        assert!(bad.to_string().contains("decimal_comma = false"), "{bad}");
    }
    let bad = creep("1;1,5\n2;1.6\n", Units::SI, commas()).unwrap_err();
    let beginning = "line 2, column 2: \"1.6\" is not a number with TextFormat::with_decimal_comma = true";
    says(&bad, "text_decimal_mark", beginning);
    // a single column of decimal commas
    let bad = creep("1,5\n2,6\n3,7\n4,8\n", Units::SI, commas()).unwrap_err();
    says(&bad, "text_columns", "line 1: 1 columns");
    let bad = error("J\n1,5\n2,6\n3,7\n4,8\n".into());
    says(&bad, "text_heading", "line 1: not exactly one heading names the time");
    let integers = "1,5\n2,6\n3,7\n4,8\n";
    let apart = "n/T;t/s;J·Pa;J\n;1.0;;5\n;2;;6\n;3;;7\n;4;;8\n";
    let beside = format!("t,J,2nd run\n{}", integers.replace('\n', ",0\n"));
    for text in [format!("t,J\n{integers}"), beside, integers.into(), apart.into()] {
        assert_eq!(samples(&text, points()), [[1.0, 5.0], [2.0, 6.0], [3.0, 7.0], [4.0, 8.0]], "{text:?}");
    }
}

#[test]
fn a_wrong_delimiter_is_refused_by_its_name() {
    let text = "t;J\n1;1.0\n2;1.1\n4;1.3\n8;1.4\n";
    for (delimiter, mark) in [(Delimiter::Comma, ','), (Delimiter::Tab, '\t'), (Delimiter::Blanks, ' ')] {
        let format = points().with_delimiter(delimiter);
        let headings = creep(text, Units::SI, format).unwrap_err();
        says(&headings, "text_heading", "line 1: ");
        let error = creep(&text[4..], Units::SI, format).unwrap_err();
        assert!(error.code().starts_with("table_") || error.code().starts_with("text_"), "{error}");
        assert_eq!(samples(&text.replace(';', &mark.to_string()), format).len(), 4, "{mark:?}");
    }
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
                    true => vec![spectrum.complex_modulus(x).re, spectrum.complex_modulus(x).im],
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
        let units = Units::new(x_unit.1, value_unit.1).unwrap();
        // columns in any order, and one that is not needed, where there are headings
        // without names they are read in order, if the headings are a comment
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
            let line = join(fields, &mut random);
            lines.push(if headings == 1 { format!("# {line}") } else { line });
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

        let delimiter = match dialect.separator {
            ',' => Delimiter::Comma,
            ';' => Delimiter::Semicolon,
            '\t' => Delimiter::Tab,
            _ => Delimiter::Blanks,
        };
        let format = points().with_delimiter(delimiter).with_decimal_comma(dialect.comma);
        let experiment = if dynamic { Experiment::Dynamic } else { Experiment::Creep };
        let table = Measurements::from_csv_reader(experiment, text.as_bytes(), units, format);
        match table.and_then(|table| table.fit()) {
            Ok(body) => {
                let report = body.report();
                assert!(bad.is_empty() && wrong.is_none(), "seed {seed}: {bad:?} {wrong:?} in\n{text}");
                let found: Vec<[f64; 2]> = report.samples().iter().map(|sample| [sample.x, sample.given]).collect();
                let value = |text: &String, unit: f64| text.parse::<f64>().unwrap() * unit;
                let expected: Vec<[f64; 2]> = (1..width)
                    .flat_map(|column| {
                        rows.iter().map(move |row| [value(&row[0], x_unit.1), value(&row[column], value_unit.1)])
                    })
                    .collect();
                assert_eq!(found, expected, "seed {seed}:\n{text}");
                exact += 1;
            }
            Err(error) if error.code() == "table_unit" => {
                let place = order.iter().position(|&column| Some(column) == wrong).unwrap();
                says(&error, "table_unit", &format!("line {heading_line}, column {}: ", place + 1));
                other_unit += 1;
            }
            Err(error) if error.code().starts_with("text_") => {
                let Some(&(row, place, spoil)) = bad.first() else { panic!("seed {seed}: {error} in\n{text}") };
                let line = row_lines[row] as u64;
                // a separator within a field makes another number of them, and so does a field of blanks
                let torn = spoil.contains(dialect.separator) || spoil.is_empty() && dialect.separator == ' ';
                let beginning = match error.code() {
                    "text_not_numeric" | "text_decimal_mark" => {
                        format!("line {line}, column {}: {spoil:?} is not a number", place + 1)
                    }
                    "text_columns" if torn => format!("line {line}: "),
                    _ => panic!("seed {seed}: {error} of {spoil} in\n{text}"),
                };
                assert!(error.to_string().starts_with(&beginning), "seed {seed}: {error}, {spoil}\n{text}");
                spoiled += 1;
            }
            Err(other) => panic!("seed {seed}: {other}"),
        }
    }
    println!("{exact} exact, {spoiled} spoiled, {other_unit} in other units");
    assert!(exact > 600 && spoiled > 500 && other_unit > 80);
}
