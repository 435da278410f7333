//! Exports of rheometers as they are: rows of units of which some are unknown, sections, long preambles.

use viscocontact::input::{Quantity, TextTable, WantedColumn};
use viscocontact::rheology::{Experiment, Isotherm, Measurements, TableError, Units};
use viscocontact::{Error, Result, TextError, TextFormat};

const ROWS: [[f64; 3]; 4] = [[1.0, 100.0, 10.0], [3.0, 120.0, 15.0], [10.0, 150.0, 20.0], [30.0, 180.0, 20.0]];

fn table(text: &str) -> TextTable {
    TextTable::read(text.as_bytes(), TextFormat::default()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Frequencies and moduli of a table.
fn rows(table: &TextTable) -> Result<Vec<Vec<f64>>> {
    let wanted = |name, words, quantity| WantedColumn { name, words, others: &["loss"], quantity, by_unit: false };
    let columns = [
        WantedColumn { others: &[], ..wanted("frequency", &["angular", "frequency"], Quantity::FREQUENCY) },
        wanted("storage modulus", &["storage"], Quantity::MODULUS),
        WantedColumn { others: &["factor"], ..wanted("loss modulus", &["loss"], Quantity::MODULUS) },
    ];
    let columns =
        columns.map(|column| table.find(&column).unwrap().unwrap_or_else(|| panic!("{}: {table}", column.name)));
    let sizes = columns.each_ref().map(|column| column.unit().unwrap());
    let sized = |values: Vec<f64>| values.iter().zip(sizes).map(|(value, size)| value * size).collect();
    Ok(table.rows(&columns)?.into_iter().map(|row| sized(row.values)).collect())
}

/// An interval of RheoCompass (Anton Paar): a row of tabs, a row of units in brackets, a column of remarks.
fn interval(number: usize, factor: f64) -> String {
    let mut text = format!(
        "Result:\tFrequency sweep {number}\n\nInterval and data points:\t{number}\t4\nInterval data:\tPoint No.\t\
         Angular Frequency\tStorage Modulus\tLoss Modulus\tLoss Factor\tShear Strain\tTorque\tStatus\n\
         \t\t\t\t\t\t\t\t\n\t\t[rad/s]\t[Pa]\t[Pa]\t[1]\t[%]\t[mN·m]\t\n"
    );
    for (k, [x, storage, loss]) in ROWS.iter().enumerate() {
        let [storage, loss] = [factor * storage, factor * loss];
        text += &format!("\t{}\t{x}\t{storage}\t{loss}\t{}\t1\t0.63\tME-,taD\n", k + 1, loss / storage);
    }
    text + "\n"
}

/// A step of TRIOS (TA Instruments): every row begins with what it is; two frequencies.
fn step(name: &str, temperature: f64, factor: f64) -> String {
    let mut text = format!(
        "[Step]\nStep name\t{name}\nNumber of points\t4\nVariables\tTemperature\tAngular frequency\tFrequency\t\
         Oscillation torque\tStorage modulus\tLoss modulus\tComplex viscosity\tStatus bits\n\
         Units\t°C\trad/s\tHz\tµN.m\tMPa\tMPa\tPa.s\t\n"
    );
    for [x, storage, loss] in ROWS {
        let [storage, loss] = [1e-6 * factor * storage, 1e-6 * factor * loss];
        let hertz = x / std::f64::consts::TAU;
        text += &format!("Data point\t{temperature}\t{x}\t{hertz}\t630.94\t{storage}\t{loss}\t1\t0xB6453\n");
    }
    text
}

fn scaled(factor: f64) -> Vec<Vec<f64>> {
    ROWS.iter().map(|[x, storage, loss]| vec![*x, factor * storage, factor * loss]).collect()
}

fn assert_same(found: &[Vec<f64>], expected: &[Vec<f64>]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} for {expected}");
    }
}

#[test]
fn rows_of_units_are_read_with_unknown_ones() {
    let one = table(&format!("Project:\tx\n\n{}", interval(1, 1.0)));
    assert_same(&rows(&one).unwrap(), &scaled(1.0));
    assert_eq!(one.headings()[7], "Torque [mN·m]");
    assert_same(&rows(&table(&step("Sweep", 25.0, 1.0))).unwrap(), &scaled(1.0));
    // no row of units: what has a number, or letters for symbols
    for text in ["t\tJ\tN\n1\t1\ts\n2\t2\ts\n3\t3\ts\n4\t4\ts\n", "made\tby\thand\nh\tF\tt\n1\t2\t3\n2\t3\t4\n3\t4\t5\n"] {
        let table = table(text);
        assert!(table.headings().iter().all(|heading| !heading.contains('[')), "{table}");
        assert_eq!(table.to_string().split(' ').next(), Some(if text.starts_with('t') { "4" } else { "3" }));
    }
}

#[test]
fn sections_with_the_same_headings_are_joined_and_told() {
    for text in [interval(1, 1.0) + &interval(2, 0.8), step("a", 25.0, 1.0) + &step("b", 40.0, 0.8)] {
        let both = table(&text);
        assert!(both.to_string().contains("2 sections with the same headings joined"), "{both}");
        assert_same(&rows(&both).unwrap(), &[scaled(1.0), scaled(0.8)].concat());
        for (number, factor) in [(1, 1.0), (2, 0.8)] {
            assert_same(&rows(&both.clone().section(number).unwrap()).unwrap(), &scaled(factor));
        }
        for number in [0, 3] {
            let error = both.clone().section(number).unwrap_err();
            assert_eq!(error, Error::Text(TextError::NoSection { section: number, sections: 2 }));
        }
        // two values at one frequency that contradict each other
        let error = Measurements::from_table(Experiment::Dynamic, &both, Units::OF_HEADINGS).unwrap_err();
        assert!(matches!(error, Error::Table(TableError::Duplicate { .. })), "{error}");
        assert!(error.to_string().contains("TextTable::section"), "{error}");
    }
    let steps = table(&(step("a", 25.0, 1.0) + &step("b", 40.0, 0.8)));
    let isotherms = Isotherm::from_table(Experiment::Dynamic, &steps, Units::OF_HEADINGS).unwrap();
    assert_eq!(isotherms.len(), 2);
}

#[test]
fn what_is_no_section_is_refused_where_it_is() {
    let (one, two) = (interval(1, 1.0), interval(2, 0.8));
    let other = TextTable::read((one.clone() + &two.replace("[Pa]", "[kPa]")).as_bytes(), TextFormat::default());
    assert_eq!(other.unwrap_err(), Error::Text(TextError::Section { line: 14, headings: 4 }));
    let others = table(&(one.clone() + &two.replace("Shear Strain", "Shear Stress")));
    assert!(rows(&others).unwrap_err().to_string().contains("another table"));
    // the last row before a section, with a fault, belongs to the table
    for spoiled in ["\t4\t30\t180\t20\n", "\t4\t30\toops\t20\t0.1\t1\t0.63\tME-,taD\n", "\t4\t3O\t180\t2O\t0.1\t1\t0.63\t\n"] {
        let start = one.rfind("\t4\t30").unwrap();
        let error = rows(&table(&format!("{}{spoiled}{two}", &one[..start]))).unwrap_err();
        let line = match error {
            Error::Text(TextError::Columns { line, .. } | TextError::NotNumeric { line, .. }) => line,
            other => panic!("{other}"),
        };
        assert_eq!(line, 10, "{spoiled}");
    }
}

#[test]
fn preambles_may_be_long() {
    for lines in [3, 150, 990, 1500, 9000] {
        let preamble: String = (0..lines).map(|k| format!("Calibration {k}\t{k}.5 mrad/N.m, or less\n")).collect();
        assert_same(&rows(&table(&(preamble + &step("a", 25.0, 1.0)))).unwrap(), &scaled(1.0));
    }
}

#[test]
fn units_in_the_place_of_headings_are_told() {
    let text = "x\n[rad/s]\t[Pa]\t[Pa]\n1\t100\t10\n3\t120\t15\n10\t150\t20\n30\t180\t20\n";
    let read =
        Measurements::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::OF_HEADINGS, TextFormat::default());
    assert!(read.unwrap_err().to_string().contains("line 2 looks like units"));
}
