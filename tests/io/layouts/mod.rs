//! Are text files read as they are, and damaged ones never otherwise than they were?

mod corpus;

use corpus::{Encoding, Kind, Layout, corpus, read};

use viscocontact::rheology::Experiment::{Creep, Dynamic, Relaxation, Storage};

use crate::common::draws::Draws;
use crate::common::environment::from_environment;

/// Relative difference of two values by their conversion, and by the digits of a frequency in Hz.
const ROUNDING: f64 = 1e-6;

fn same(a: f64, b: f64) -> bool {
    a == b || a.is_nan() && b.is_nan() || (a - b).abs() <= ROUNDING * b.abs()
}

fn same_row(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(*a, *b))
}

#[test]
fn every_layout_is_read() {
    let layouts = corpus();
    for layout in &layouts {
        let rows = read(layout.kind, &layout.encoding.bytes(&layout.text));
        let rows = rows.unwrap_or_else(|error| panic!("{}: {error}\n{}", layout.name, layout.text));
        assert_eq!(rows.len(), layout.rows.len(), "{}", layout.name);
        for (found, wanted) in rows.iter().zip(&layout.rows) {
            assert!(same_row(found, wanted), "{}: {found:?} for {wanted:?} in\n{}", layout.name, layout.text);
        }
    }
    println!("{} layouts", layouts.len());
    assert!(layouts.len() >= 60);
}

/// Moduli are no compliances, times no frequencies, tables no recordings: the units and names of the headings say so.
#[test]
fn no_table_is_read_as_another() {
    let kinds = [Creep, Relaxation, Dynamic].map(Kind::Table).into_iter().chain([Kind::Recording]);
    let (layouts, mut refused) = (corpus(), 0);
    for layout in layouts.iter().filter(|layout| matches!(layout.kind, Kind::Table(_) | Kind::Recording)) {
        let storage = layout.kind == Kind::Table(Storage);
        for kind in kinds.clone().filter(|kind| *kind != layout.kind && !storage) {
            let found = read(kind, &layout.encoding.bytes(&layout.text));
            assert!(found.is_err(), "{} as {kind:?}: {found:?}\n{}", layout.name, layout.text);
            refused += 1;
        }
    }
    println!("{refused} refused");
    assert!(refused >= 200, "{refused}");
}

/// What cannot be read, or would be guessed, is refused with its remedy.
#[test]
fn what_is_no_table_or_map_is_refused_with_its_cure() {
    let (dma, rows) = ("f [Hz],E' [MPa],E'' [MPa]", "0.01,1.50,0.02\n0.1,1.52,0.15\n1,2.25,0.75\n10,2.98,0.15\n");
    let twice = format!("{dma},T [°C]\n{}", [18, 25].map(|t| rows.replace('\n', &format!(",{t}\n"))).concat());
    for (kind, text, remedy) in [
        (Kind::Table(Dynamic), &*twice, "Isotherm::from_csv_reader"),
        (Kind::Table(Dynamic), &format!("{dma}\n{rows}1,2.24,0.75\n"), "give their mean"),
        (Kind::Table(Dynamic), &format!("{dma}\n{rows}100,3.00,-0.02\n"), "leave out rows"),
        (Kind::Table(Dynamic), "Angular frequency,G',G''\n1,2,1\n2,3,1\n3,4,1\n4,5,1\n", "write it in brackets"),
        (Kind::Table(Relaxation), "t [s],E [MPa]\n0.01,3\n0.1,\n1,2\n10,1\n", "leave the line out"),
        (Kind::Table(Relaxation), "t [s],E [MPa]\n0.01,3\n0.1,NaN\n1,2\n10,1\n", "leave out rows"),
        (Kind::Table(Relaxation), "T,E\n20,2900\n60,2700\n80,2300\n90,1700\n", "names the time"),
        (Kind::Table(Relaxation), "T (°C),E (MPa)\n20,2900\n60,2700\n80,2300\n90,1700\n", "names the time"),
        (Kind::Table(Creep), "T (°C),J (1/GPa)\n20,0.3\n30,0.4\n40,0.5\n50,0.6\n", "names the time"),
        (Kind::Matrix, "1,234.5;2,345.6\n3,456.7;4,567.8\n", "separators of thousands"),
        (Kind::Matrix, "1 2 3\n4 5 6 7\n", "4 columns"),
        (Kind::Matrix, "1 2 -9999\n3 4 5\n", "with_missing_height(-9999)"),
        (Kind::Matrix, "% relaxation\n0.01 3.0\n0.1 2.9\n1 2.25\n10 1.6\n", "Measurements"),
        (Kind::Matrix, "0.0 1.5\n0.5 1.7\n1.0 1.1\n", "from_profile"),
        (Kind::Matrix, "0 0 1\n1 0 2\n0 1 3\n1 1 4\n", "from_xyz"),
        (Kind::Recording, "t [s],F [nN],z [um]\n0,0,0\n1,1,1\n0,1,1\n1,0,0\n", "add the end of the segment before"),
    ] {
        let error = read(kind, text.as_bytes()).expect_err(text);
        assert!(error.contains(remedy), "{remedy}: {error}\n{text}");
    }
}

/// A damage: the bytes, how many rows may be missing, and whether heights may.
struct Damaged {
    bytes: Vec<u8>,
    lost: usize,
    missing: bool,
    how: String,
}

/// Fields that are no numbers.
const JUNK: [&str; 12] = ["", "n/a", "---", "NaN", "<1", "1:30", "1x2", "0x10", "1e", "--5", "∞", "?"];

fn damaged(layout: &Layout, draw: &mut Draws) -> Option<Damaged> {
    let text = &layout.text;
    let end = if text.contains("\r\n") {
        "\r\n"
    } else if text.contains('\r') {
        "\r"
    } else {
        "\n"
    };
    let lines: Vec<&str> = text.split(end).collect();
    let characters: Vec<char> = text.chars().collect();
    let at = draw.below(characters.len());
    let line = draw.below(lines.len() - 1);
    let joined = |lines: Vec<String>| lines.join(end);
    let owned = || lines.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>();
    let (mut lost, mut missing, mut encoding) = (0, false, layout.encoding);
    let (how, text) = match draw.below(10) {
        0 => {
            let junk = ['x', '?', '&', '|', '"', '#', '\'', ';', '_', '=', '!', '('][draw.below(12)];
            // a comment is a row less
            lost = usize::from(junk == '#');
            let text: String = characters[..at].iter().chain([&junk]).chain(&characters[at..]).collect();
            (format!("{junk:?} at {at}"), text)
        }
        1 => {
            let without = characters[at];
            // rows that end in a delimiter become one longer row, another matrix; one after a remark becomes part of it
            let before: String = characters[..at].iter().collect();
            let remark = before.rsplit(end).next().is_some_and(|line| line.starts_with('#'));
            let joins = "\n\r".contains(without) && (remark || before.ends_with(['\t', ';', ',']));
            if !" ,;\t\n\r\"".contains(without) || layout.marks.contains(without) || joins {
                return None;
            }
            (format!("without {without:?} at {at}"), characters[..at].iter().chain(&characters[at + 1..]).collect())
        }
        2 => {
            if matches!(layout.kind, Kind::Matrix | Kind::Stated(_) | Kind::Profile) {
                return None;
            }
            let mut lines = owned();
            lines.insert(line, lines[line].clone());
            (format!("line {line} twice"), joined(lines))
        }
        3 => {
            lost = 1;
            let mut lines = owned();
            lines.remove(line);
            (format!("without line {line}"), joined(lines))
        }
        4 => {
            let cut = characters[..at].iter().collect::<String>();
            if !cut.ends_with([',', ';', '\t', '\n', '\r']) || cut.ends_with(|c| layout.marks.contains(c)) {
                return None;
            }
            lost = usize::MAX;
            (format!("cut at {at}"), cut)
        }
        5 | 6 => {
            let delimiter = ['\t', ';', ',', ' '].into_iter().find(|&mark| lines[lines.len() - 2].contains(mark))?;
            let mut lines = owned();
            let mut fields: Vec<String> = lines[line].split(delimiter).map(str::to_owned).collect();
            let (field, junk) = (draw.below(fields.len()), JUNK[draw.below(JUNK.len())]);
            // an empty field is no value, and a word in the place of one may be
            if fields[field].is_empty()
                || layout.text.contains('"') && delimiter == ','
                || junk == "∞" && encoding == Encoding::Windows
            {
                return None;
            }
            // a heading without a name may leave the columns as they are
            fields[field] = junk.into();
            missing = true;
            lines[line] = fields.join(&delimiter.to_string());
            (format!("{junk:?} in field {field} of line {line}"), joined(lines))
        }
        7 => {
            let other = [Encoding::Utf8, Encoding::Utf16, Encoding::Windows][draw.below(3)];
            encoding = other;
            (format!("in {other:?}"), format!("{}{text}", if other == Encoding::Utf8 { "\u{feff}" } else { "" }))
        }
        8 => {
            let mut lines = owned();
            lines.insert(line, ["", "# remark", "  ", "% 1,5; x"][draw.below(4)].into());
            (format!("a remark before line {line}"), lines.join(["\n", "\r\n", "\r"][draw.below(3)]))
        }
        _ => {
            let mut bytes = encoding.bytes(text);
            let at = draw.below(bytes.len());
            bytes[at] = [0, 0xff, 0x80, 0x1a][draw.below(4)];
            return Some(Damaged { bytes, lost: usize::MAX, missing: true, how: format!("a byte at {at}") })
                .filter(|_| layout.encoding != Encoding::Utf16);
        }
    };
    Some(Damaged { bytes: encoding.bytes(&text), lost, missing, how })
}

#[test]
fn no_damage_changes_a_value() {
    let (layouts, count) = (corpus(), from_environment("LAYOUT_DAMAGES", 2000));
    let (mut accepted, mut refused, mut changed) = (0, 0, Vec::new());
    for seed in 0..count {
        let mut draw = Draws::new(seed);
        let layout = &layouts[draw.below(layouts.len())];
        let Some(damage) = damaged(layout, &mut draw) else { continue };
        let Ok(rows) = read(layout.kind, &damage.bytes) else {
            refused += 1;
            continue;
        };
        accepted += 1;
        let fits = |found: &[f64], wanted: &[f64]| {
            let is_map = !matches!(layout.kind, Kind::Table(_) | Kind::Isotherms(_) | Kind::Recording);
            let hole = damage.missing && is_map && found.len() == wanted.len();
            let values = || found.iter().zip(wanted).all(|(a, b)| same(*a, *b) || a.is_nan());
            same_row(found, wanted) || hole && values() || is_map && damage.lost > 0
        };
        let mut wanted = layout.rows.iter();
        let found = rows.iter().all(|row| wanted.any(|wanted| fits(row, wanted)));
        let lost = layout.rows.len().saturating_sub(rows.len());
        if !found || lost > damage.lost {
            let text = String::from_utf8_lossy(&damage.bytes);
            changed.push(format!("seed {seed}, {}: {} ({lost} lost)\n{rows:?}\n{text}", layout.name, damage.how));
        }
    }
    println!("{accepted} accepted, {refused} refused of {count}");
    assert!(accepted > count / 10 && refused > count / 10, "{accepted} accepted, {refused} refused of {count}");
    assert!(
        changed.is_empty(),
        "{} changed:\n{}",
        changed.len(),
        changed.iter().take(40).cloned().collect::<Vec<_>>().join("\n")
    );
}
