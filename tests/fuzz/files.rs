//! Files that are written: fields, frames, histories; and a folder to write them to.

use std::sync::OnceLock;

use viscocontact::output::{CsvHistory, Earlier, Field, Format, FrameSeries, Metadata, write_npy};
use viscocontact::prelude::*;

use crate::engine::{Outcome, Target, Verdict};
use crate::models;
use crate::source::Source;
use viscocontact_scenes::Temporary;

pub fn targets() -> Vec<Target> {
    vec![
        Target { name: "output_fields", short: 30, run: fields },
        Target { name: "output_frames", short: 30, run: frames },
    ]
}

/// The folder in which targets write over what they wrote before; [`leave`] removes it.
pub fn shared() -> &'static Temporary {
    static SHARED: OnceLock<Temporary> = OnceLock::new();
    SHARED.get_or_init(|| Temporary::folder("fuzz-shared"))
}

pub fn leave() {
    let _ = std::fs::remove_dir_all(shared());
}

/// A word or two, of letters and of what texts stumble over.
pub fn text(source: &mut Source) -> String {
    const LETTERS: [char; 16] =
        ['a', 'µ', '²', ' ', '"', '\\', '\n', '\r', '\0', '#', ',', '<', '&', ']', '\u{202e}', '\u{1f300}'];
    (0..source.below(9)).map(|_| source.choose(&LETTERS)).collect()
}

/// A contact of few cells, mostly after a step.
fn contact(source: &mut Source) -> viscocontact::Result<ViscoelasticContact> {
    let length = source.scale(1e-6, 1.0);
    let grid = Grid::new([source.count(1, 6), source.count(1, 6)], [length, length * source.scale(0.3, 3.0)])?;
    let material = models::material(source, false)?;
    let softness = material.contact_compliance(1.0).abs().max(1e-300);
    let geometry = models::geometry(source, length)?;
    let mut contact = ViscoelasticContact::builder(grid).geometry(&geometry).material(material).build()?;
    let _ = contact.step(0.0, models::load(source, length, softness));
    let _ = contact.step(0.1, models::load(source, length, softness));
    Ok(contact)
}

/// A field of any numbers comes back from its file bit by bit.
fn fields(source: &mut Source) -> Verdict {
    let most = if source.chance(0.1) { 32 } else { 6 };
    let cells = [source.count(1, most), source.count(1, most)];
    let Ok(grid) = Grid::new(cells, [source.scale(1e-6, 1.0), source.scale(1e-6, 1.0)]) else {
        return Ok(Outcome::Refused);
    };
    let same = source.anything();
    let constant = source.chance(0.2);
    let mut values: Vec<f64> = (0..grid.len()).map(|_| if constant { same } else { source.anything() }).collect();
    if source.chance(0.1) {
        values.truncate(source.below(values.len()));
    }
    let path = shared().join("field.npy");
    if let Err(error) = write_npy(&path, &grid, &values) {
        let short = values.len() != grid.len() && !error.to_string().is_empty();
        return if short { Ok(Outcome::Refused) } else { Err(format!("a field that is not written: {error}")) };
    }
    let file = std::fs::read(&path).map_err(|error| error.to_string())?;
    let bits: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    if !file.ends_with(&bits) || !(file.len() - bits.len()).is_multiple_of(64) {
        return Err("the file does not hold the field".to_owned());
    }
    Ok(Outcome::Accepted)
}

/// Frames and a history of a contact, whatever its state and the texts that go with it.
fn frames(source: &mut Source) -> Verdict {
    let Ok(contact) = contact(source) else { return Ok(Outcome::Refused) };
    let scene = Metadata::new(text(source)).note(text(source), text(source)).note(text(source), text(source));
    let json = scene.json(&contact);
    let balanced = json.matches('{').count() == json.matches('}').count() || json.contains("\\\"");
    if json.contains(|c: char| c.is_control()) || !json.starts_with('{') || !json.ends_with('}') || !balanced {
        return Err(format!("no JSON: {json}"));
    }
    let folder = Temporary::folder("fuzz-frames");
    let chosen: Vec<Field> = (0..source.below(4)).map(|_| source.choose(&Field::ALL)).collect();
    let twice = (1..chosen.len()).any(|k| chosen[..k].contains(&chosen[k]));
    let refused = |error: Error| {
        if twice && !error.to_string().is_empty() { Ok(Outcome::Refused) } else { Err(error.to_string()) }
    };
    if source.chance(0.5) {
        match FrameSeries::create(folder.join("npz"), Format::Npz, &scene, &contact, &chosen, Earlier::Refuse) {
            Ok(mut series) => {
                let path = series.record(&contact).map_err(|error| error.to_string())?;
                let length = std::fs::metadata(path).map_err(|error| error.to_string())?.len();
                if length < 8 * (chosen.len() * contact.grid().len()) as u64 {
                    return Err("an archive without the fields".to_owned());
                }
            }
            Err(error) => return refused(error),
        }
    }
    if source.chance(0.5) {
        match FrameSeries::create(folder.join("vtk"), Format::Vtk, &scene, &contact, &chosen, Earlier::Refuse) {
            Ok(mut series) => {
                let path = series.record(&contact).map_err(|error| error.to_string())?;
                let file = std::fs::read(path).map_err(|error| error.to_string())?;
                let head = file.split(|&byte| byte == b'_').next().unwrap_or_default();
                if head.windows(3).any(|three| three == b"NaN" || three == b"inf") {
                    return Err("a head with a number that is none".to_owned());
                }
            }
            Err(error) => return refused(error),
        }
    }
    history(source, &contact, &scene, &folder)
}

/// Every number of a history is read back as it was.
fn history(source: &mut Source, contact: &ViscoelasticContact, scene: &Metadata, folder: &Temporary) -> Verdict {
    let good = source.chance(0.7);
    let name = |k: usize, source: &mut Source| if good { format!("column {k}") } else { text(source) };
    let names: Vec<String> = (0..source.below(3)).map(|k| name(k, source)).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let path = folder.join("history.csv");
    let Ok(mut history) = CsvHistory::create(&path, scene, contact, &names, Earlier::Refuse) else {
        return Ok(Outcome::Refused);
    };
    let mut contact = contact.clone();
    let Ok(report) = contact.step(0.5, contact.fields().load()) else { return Ok(Outcome::Refused) };
    let further: Vec<f64> = names.iter().map(|_| source.anything()).collect();
    history.record(&contact, &report, &further).map_err(|error| error.to_string())?;
    let file = std::fs::read_to_string(&path).map_err(|error| error.to_string())?;
    let row: Vec<f64> = file.lines().last().unwrap_or_default().split(',').flat_map(str::parse).collect();
    if row.len() != 17 + further.len() || row[..17].iter().any(|value| !value.is_finite()) {
        return Err(format!("a row that is none: {row:?}"));
    }
    let alike = row[17..].iter().zip(&further).all(|(read, given)| read == given || read.is_nan() && given.is_nan());
    if alike { Ok(Outcome::Accepted) } else { Err("columns of the user's came back otherwise".to_owned()) }
}
