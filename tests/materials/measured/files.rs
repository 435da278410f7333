//! Tables from files: shapes that are read, and errors that name the line.

use super::*;
use crate::common::refused::says;
use viscocontact::rheology::{CreepSeries, Experiment, Units};
use viscocontact::{Error, TextFormat};

fn fitted(experiment: Experiment, bytes: &[u8], units: Units) -> Result<CreepSeries> {
    Measurements::from_csv_reader(experiment, bytes, units, TextFormat::default()).and_then(|table| table.fit())
}

fn read(text: &str) -> Result<CreepSeries> {
    fitted(Experiment::Creep, text.as_bytes(), Units::SI)
}

/// Files of other shapes are in `dialects` and `io::layouts`.
#[test]
fn rows_come_in_any_order() {
    let plain = creep(&[(1.0, 1.0e-9), (10.0, 1.1e-9), (100.0, 1.3e-9), (1000.0, 1.4e-9)]).unwrap();
    assert_eq!(read("time,J\n1000,1.4e-9\n10,1.1e-9\n1,1e-9\n100,1.3e-9").unwrap(), plain);
}

/// Fields that are no numbers, and rows of another width, are named in `dialects`.
#[test]
fn errors_name_the_line() {
    let error = |result: Result<CreepSeries>| result.unwrap_err();
    let heading = |text: &str, named: &str| {
        let beginning = format!("line 1: not exactly one heading names the {named} (headings: ");
        says(&read(text).unwrap_err(), "text_heading", &beginning);
    };
    heading("time,t,J\n1,1,1\n", "time: 1 \"time\", 2 \"t\"");
    let bad = error(read("time,J\n1,1e-9\n\n2,1.1e-9\n1,1.2e-9\n3,2e-9\n"));
    says(&bad, "table_duplicate", "creep table: line 5 and line 2 give two values");
    for value in ["-1.1e-9", "NaN"] {
        let bad = error(read(&format!("time,J\n1,1e-9\n2,{value}\n3,1.2e-9\n")));
        says(&bad, "table_out_of_range", "creep table, line 3: ");
    }
    // columns that are something else, decimal commas, frequencies in Hz
    heading("time,creep strain [%]\n1,2\n", "creep compliance");
    let bad = read("time,J\n1,5,1,1\n2,5,2,2\n").unwrap_err();
    says(&bad, "text_columns", "line 2: 4 columns separated by commas, but 2 are needed");
    heading("first,second\n1,1e-9\n2,1.1e-9\n", "time");
    let dynamic = |text: &str| error(fitted(Experiment::Dynamic, text.as_bytes(), Units::SI));
    let bad = dynamic("frequency,storage modulus,strain\n1,1e6,0.1\n");
    says(&bad, "table_storage_only", "line 1: ");
    // a heading may be a comment
    for mark in ["", "# "] {
        let bad = dynamic(&format!("{mark}f [Hz],G',G''\n1,1e6,1e5\n"));
        says(&bad, "table_unit", "line 1, column 1: the heading \"f [Hz]\" says Hz, but ");
        assert!(bad.to_string().ends_with("; of Hz it is 6.28319"), "{bad}");
    }
    // tan δ in percent
    let table = |heading: &str, by: f64| {
        let rows = [(1.0, 0.05), (10.0, 0.06), (100.0, 0.07), (1000.0, 0.06)]
            .map(|(omega, tan)| format!("{omega},2e6,{}\n", by * tan));
        let text = format!("omega [rad/s],G' [Pa],{heading}\n{}", rows.concat());
        Measurements::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::OF_HEADINGS, TextFormat::default())
            .unwrap()
    };
    let [of_number, of_percent] =
        [table("tan delta", 1.0), table("tan delta [%]", 100.0)].map(|table| table.fit().unwrap());
    for (one, other) in of_number.spectrum().terms().iter().zip(of_percent.spectrum().terms()) {
        assert!((one.0 / other.0 - 1.0).abs() < 1e-9 && (one.1 / other.1 - 1.0).abs() < 1e-9);
    }
    // remarks in any encoding
    assert!(fitted(Experiment::Creep, b"# 23 \xb0C\n1,1\n2,1.1\n3,1.2\n4,1.3\n", Units::SI).is_ok());
    for empty in ["", "\n\n", "# nothing\n", "time,J\n"] {
        let none = Error::WrongLength { field: "creep table", len: 0, expected: 4, exact: false };
        assert_eq!(read(empty).unwrap_err(), none, "{empty:?}");
    }
    let format = TextFormat::default();
    let missing = Measurements::from_csv(Experiment::Creep, "no/such/file.csv", Units::SI, format).unwrap_err();
    let binary = fitted(Experiment::Creep, &[0xff, 0x00, 0x00, 0x31], Units::SI).unwrap_err();
    for (bad, said) in [(missing, "no/such/file.csv"), (binary, "")] {
        let is_unreadable = matches!(bad, Error::Unreadable { .. });
        assert!(is_unreadable && bad.to_string().contains(said), "{bad}");
    }
}
