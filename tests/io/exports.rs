//! Exports of rheometers as they are: rows of units of which some are unknown, sections, long preambles.

use crate::common::refused::says;
use viscocontact::input::{Quantity, TextTable, WantedColumn};
use viscocontact::rheology::{Experiment, Isotherm, Measurements, Units};
use viscocontact::{Delimiter, Error, Result, TextFormat};

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
    for text in
        ["t\tJ\tN\n1\t1\ts\n2\t2\ts\n3\t3\ts\n4\t4\ts\n", "made\tby\thand\nh\tF\tt\n1\t2\t3\n2\t3\t4\n3\t4\t5\n"]
    {
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
            says(&error, "text_no_section", &format!("there is no section {number}: give one from 1 to 2"));
        }
        // two values at one frequency that contradict each other
        let error = Measurements::from_table(Experiment::Dynamic, &both, Units::OF_HEADINGS).unwrap_err();
        assert!(error.code() == "table_duplicate", "{error}");
        assert!(error.to_string().contains("TextTable::section"), "{error}");
    }
    let steps = table(&(step("a", 25.0, 1.0) + &step("b", 40.0, 0.8)));
    let isotherms = Isotherm::from_table(Experiment::Dynamic, &steps, Units::OF_HEADINGS).unwrap();
    assert_eq!(isotherms.len(), 2);
}

#[test]
fn what_is_no_section_is_refused_where_it_is() {
    let (one, two) = (interval(1, 1.0), interval(2, 0.8));
    // the last row before a section, with a fault, belongs to the table
    for spoiled in
        ["\t4\t30\t180\t20\n", "\t4\t30\toops\t20\t0.1\t1\t0.63\tME-,taD\n", "\t4\t3O\t180\t2O\t0.1\t1\t0.63\t\n"]
    {
        let start = one.rfind("\t4\t30").unwrap();
        let error = rows(&table(&format!("{}{spoiled}{two}", &one[..start]))).unwrap_err();
        assert!(["text_columns", "text_not_numeric"].contains(&error.code()), "{error}");
        assert!(error.to_string().starts_with("line 10"), "{spoiled}: {error}");
    }
}

/// A label before the headings, to which no field of the rows belongs.
#[test]
fn labels_before_headings_are_no_columns() {
    let labelled = interval(1, 1.0).replace("\n\t1\t", "\n1\t").replace("\n\t2\t", "\n2\t");
    let labelled = labelled.replace("\n\t3\t", "\n3\t").replace("\n\t4\t", "\n4\t");
    assert_same(&rows(&table(&labelled)).unwrap(), &scaled(1.0));
    assert_eq!(table(&labelled).headings()[0], "Point No.");
    // of one row alone, it is a mark that is lost
    let error = rows(&table(&interval(1, 1.0).replace("\n\t1\t", "\n1\t"))).unwrap_err();
    assert!(error.code() == "text_columns", "{error}");
}

/// Steps with other columns or units are chosen from: the first has no moduli, or others.
#[test]
fn sections_with_other_headings_are_chosen_from() {
    let (one, two) = (interval(1, 1.0), interval(2, 0.8));
    for (other, factor) in [("Shear Strain", 1.0), ("[Pa]", 1e3)] {
        let both = table(&(one.clone() + &two.replace(other, if factor > 1.0 { "[kPa]" } else { "Shear Stress" })));
        let beginning = "line 15 begins a section with other headings or units than those of line 4: ";
        says(&rows(&both).unwrap_err(), "text_section", beginning);
        assert!(both.to_string().contains("2 sections with different headings"), "{both}");
        for (number, factor) in [(1, 1.0), (2, 0.8 * factor)] {
            let own = both.clone().section(number).unwrap();
            assert_same(&rows(&own).unwrap(), &scaled(factor));
        }
    }
    let soak = "[Step]\nStep name\tSoak\nVariables\tTime\tTemperature\tStatus bits\nUnits\ts\t°C\t\n".to_owned()
        + &[0, 10, 20, 30].map(|t| format!("Data point\t{t}\t25.0\t0xB6453\n")).concat();
    let all = table(&(soak.clone() + &step("a", 25.0, 1.0) + &soak + &step("b", 40.0, 0.8)));
    let error = Measurements::from_table(Experiment::Dynamic, &all, Units::OF_HEADINGS).unwrap_err();
    assert!(error.to_string().contains("line 12 has others: choose by TextTable::section"), "{error}");
    for (number, factor) in [(2, 1.0), (4, 0.8)] {
        assert_same(&rows(&all.clone().section(number).unwrap()).unwrap(), &scaled(factor));
    }
    assert_eq!(all.clone().section(3).unwrap().headings()[1..3], ["Time [s]", "Temperature [°C]"]);
    says(&all.section(5).unwrap_err(), "text_no_section", "there is no section 5: give one from 1 to 4");
}

/// A remark that is not written leaves a row one field short: it is read where no other column can be the missing one.
#[test]
fn rows_may_lack_remarks_at_their_end() {
    let whole = interval(1, 1.0);
    for lacking in ["180\t20\t0.1111111111111111\t1\t0.63", "120\t15\t0.125\t1\t0.63"] {
        let text = whole.replace(&format!("{lacking}\tME-,taD\n"), &format!("{lacking}\n"));
        assert!(text.len() < whole.len());
        assert_same(&rows(&table(&text)).unwrap(), &scaled(1.0));
    }
    let columns = |error: Error| error.code() == "text_columns";
    // a mark lost between two numbers, a number that is lacking, a file that is cut off
    for (from, to) in [("\t3\t120", "\t3120"), ("120\t15\t0.125\t1\t0.63\tME-,taD", "120\t15\t0.125\t1")] {
        let text = whole.replace(from, to);
        assert!(text != whole && columns(rows(&table(&text)).unwrap_err()), "{to}");
    }
    let text = "omega [rad/s],G' [Pa],remark\n1,100,a\n3,120,b\n10,150,c\n30,180";
    let cut = |text: &str| {
        Measurements::from_csv_reader(Experiment::Storage, text.as_bytes(), Units::OF_HEADINGS, TextFormat::default())
    };
    let error = cut(text).unwrap_err();
    assert!(error.to_string().contains("leave the line out by #"), "{error}");
    assert!(columns(error) && cut(&format!("{text}\n")).is_ok());
}

/// A temperature ramp with a column for each frequency, which the headings have in brackets.
#[test]
fn frequencies_in_headings_are_told() {
    let text = "#SAMPLE:;NBR\n##Temp./°C;Time/min;E'(1.000Hz)/MPa;E''(1.000Hz)/MPa;E'(10.000Hz)/MPa;E''(10.000Hz)/MPa\n\
        -40,0;0,0;900,1;120,3;1100,0;100,3\n-30,0;5,0;500,1;180,3;700,0;200,3\n-20,0;10,0;100,1;80,3;200,0;150,3\n";
    let read =
        Isotherm::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::OF_HEADINGS, TextFormat::default());
    let error = read.unwrap_err().to_string();
    assert!(error.contains("write it in a column of its own, and a row for each of its values"), "{error}");
}

#[test]
fn preambles_may_be_long() {
    for lines in [3, 150, 990, 1500, 9000] {
        let preamble: String = (0..lines).map(|k| format!("Calibration\t{k}.5 mrad/N.m, or less\n")).collect();
        assert_same(&rows(&table(&(preamble + &step("a", 25.0, 1.0)))).unwrap(), &scaled(1.0));
    }
    // two numbers in each line, between blanks: the delimiter has to be stated
    let preamble: String = (0..150).map(|k| format!("Calibration {k}\t{k}.5 mrad/N.m, or less\n")).collect();
    let text = preamble + &step("a", 25.0, 1.0);
    let read = |format| Measurements::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::OF_HEADINGS, format);
    assert!(read(TextFormat::default()).is_err());
    let stated = TextTable::read(text.as_bytes(), TextFormat::default().with_delimiter(Delimiter::Tab)).unwrap();
    assert_same(&rows(&stated).unwrap(), &scaled(1.0));
}

#[test]
fn units_in_the_place_of_headings_are_told() {
    let text = "x\n[rad/s]\t[Pa]\t[Pa]\n1\t100\t10\n3\t120\t15\n10\t150\t20\n30\t180\t20\n";
    let read =
        Measurements::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::OF_HEADINGS, TextFormat::default());
    assert!(read.unwrap_err().to_string().contains("line 2 looks like units"));
}
