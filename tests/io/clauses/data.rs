//! Tables in texts, and loads.

use viscocontact::ErrorKind::{File, Value};
use viscocontact::TextFormat;
use viscocontact::input::{Quantity, TextTable, WantedColumn};
use viscocontact::prelude::*;

use super::Table;

const FORCE: WantedColumn =
    WantedColumn { name: "force", words: &["force"], others: &[], quantity: Quantity::FORCE, by_unit: false };

fn text(text: &str) -> TextTable {
    TextTable::read(text.as_bytes(), TextFormat::default()).unwrap()
}

pub fn rows(t: &mut Table) {
    let columns = |of: &TextTable| vec![of.find(&FORCE).unwrap().unwrap()];
    for (lines, says) in [
        ("time [s],force [N]\n0,1\n1,2\n2,3,4\n", "line 4: 3 columns separated by commas, but 2 are needed…"),
        ("time [s],force [N]\n0,1\n1,2\n2,high\n", "line 4, column 2: \"high\" is not a number; leave the line out…"),
        ("time [s],force [N]\n0,1\n1,2\n2\n", "line 4: 1 columns separated by commas, but 2 are needed…"),
    ] {
        let of = text(lines);
        t.row("TextTable::rows", of.rows(&columns(&of)), File, says);
    }
    let both = text("force [N],force [mN]\n0,1\n1,2\n");
    t.row(
        "TextTable::find",
        both.find(&FORCE),
        File,
        "line 1: …1 \"force [N]\", 2 \"force [mN]\"…choose by TextTable::only…",
    );
    for column in [0, 3] {
        t.row(
            "TextTable::with_heading",
            both.clone().with_heading(column, "force [N]"),
            File,
            "there is no column …, or its number from 1 on",
        );
    }
    t.row(
        "TextTable::only",
        both.only(&["depth"]),
        File,
        "there is no column depth (headings: force [N], force [mN])…",
    );

    let at = |time: f64, force: f64| (time, Load::force(force));
    for (rows, says) in [
        (vec![], "load table: 0 given, at least 2 needed"),
        (vec![at(0.0, 1.0)], "load table: 1 given, at least 2 needed"),
        (vec![at(1.0, 1.0), at(1.0, 2.0)], "period = 0.0 → finite and > 0"),
        (vec![at(0.0, 1.0), at(f64::INFINITY, 2.0)], "load table times = inf → finite"),
        (vec![at(0.0, 1.0), at(1.0, f64::NAN)], "normal force = NaN → finite"),
        (vec![at(0.0, 1.0), at(-1.0, 1.0)], "load table times[1] = -1.0 may not follow 0.0: …not decrease"),
        (
            vec![at(0.0, 1.0), (1.0, Load::approach(1.0))],
            "the load table mixes…(a force…; an approach…: take loads of one kind…",
        ),
    ] {
        t.row("Periodic::new", Periodic::new(&rows), Value, says);
    }
    let force = Load::force;
    for (low, high, frequency, says) in [
        (force(0.0), force(1.0), 0.0, "frequency = 0.0 → finite and > 0"),
        (force(0.0), force(1.0), f64::NAN, "frequency = NaN → finite and > 0"),
        (force(f64::NAN), force(1.0), 1.0, "normal force = NaN → finite"),
        (force(0.0), Load::approach(1.0), 1.0, "the sinusoid mixes loads…(a force…: take loads of one kind…"),
        (force(2.0), force(1.0), 1.0, "sinusoid from low to high[1] = 1.0 may not follow 2.0: …`Sinusoid::about`…"),
        (
            Load::spring(1.0, 2.0),
            Load::spring(1.0, 1.0),
            1.0,
            "sinusoid from low to high[1] = 1.0 may not follow 2.0: …`Sinusoid::about`…",
        ),
    ] {
        t.row("Sinusoid::new", Sinusoid::new(low, high, frequency), Value, says);
    }
}
