//! The description of a run in its files.

use crate::ViscoelasticContact;
use crate::output::Field;
use crate::output::json::Object;

/// Units of the values written besides the fields.
const UNITS: [(&str, &str); 7] = [
    ("time", "s"),
    ("x1", "m"),
    ("x2", "m"),
    ("approach", "m"),
    ("force", "N"),
    ("tilt", "rad"),
    ("contact_area", "m2"),
];

const CONVENTIONS: &str = "pressure is positive in compression, displacement positive into the bodies, the gap \
                           positive when open and infinite where there is nothing to touch; one value per cell";

/// The description of a run that is written into each of its files: your title and notes, and the
/// parameters of the contact.
///
/// ```
/// use viscocontact::{output::Metadata, prelude::*};
///
/// let contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// let metadata = Metadata::new("Ball on rubber").note("radius", "10 mm").note("batch", "B-12");
/// let json = metadata.json(&contact);
/// assert!(json.starts_with(r#"{"title": "Ball on rubber", "notes": {"radius": "10 mm", "batch": "B-12"}"#));
/// assert!(json.contains(r#""cells": [16, 16]"#));
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Metadata {
    title: String,
    notes: Vec<(String, String)>,
}

impl Metadata {
    /// Metadata with a title, without notes.
    pub fn new(title: impl Into<String>) -> Metadata {
        Metadata { title: title.into(), notes: Vec::new() }
    }

    /// Adds a note on facts that the contact does not hold, such as the shape of the bodies, the specimen or the operator. A
    /// note of the same key is replaced.
    #[must_use]
    pub fn note(mut self, key: impl Into<String>, value: impl Into<String>) -> Metadata {
        let (key, value) = (key.into(), value.into());
        match self.notes.iter_mut().find(|(other, _)| *other == key) {
            Some((_, old)) => *old = value,
            None => self.notes.push((key, value)),
        }
        self
    }

    /// The title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Keys and values of the notes in the order given.
    pub fn notes(&self) -> impl Iterator<Item = (&str, &str)> {
        self.notes.iter().map(|(key, value)| (&key[..], &value[..]))
    }

    /// The whole description as JSON on a single line: `title`, `notes`, `crate` and `version`, `grid` (`cells`,
    /// `spacing` and `lengths` \[m\]), `bodies`, `kernel`, `settings`, `material` and, if it changes, `temperature` (as
    /// Rust prints them), `units` of all values written, and `conventions`.
    pub fn json(&self, contact: &ViscoelasticContact) -> String {
        let notes = self.notes.iter().fold(Object::default(), |notes, (key, value)| notes.text(key, value));
        let grid = contact.grid();
        let grid = Object::default()
            .value("cells", &format!("{:?}", grid.cells()))
            .numbers("spacing", grid.spacing())
            .numbers("lengths", grid.lengths());
        let fields = Field::ALL.map(|field| (field.name(), field.unit()));
        let units = fields.iter().chain(&UNITS).fold(Object::default(), |units, (name, unit)| units.text(name, unit));
        let scene = Object::default()
            .text("title", &self.title)
            .value("notes", &notes.finish())
            .text("crate", env!("CARGO_PKG_NAME"))
            .text("version", env!("CARGO_PKG_VERSION"))
            .value("grid", &grid.finish())
            .value("bodies", &contact.bodies().to_string())
            .text("kernel", &contact.kernel().to_string())
            .text("settings", &format!("{:?}", contact.settings()))
            .text("material", &format!("{:?}", contact.material()));
        let scene = match contact.temperature() {
            Some(temperature) => scene.text("temperature", &format!("{temperature:?}")),
            None => scene,
        };
        scene.value("units", &units.finish()).text("conventions", CONVENTIONS).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_of_the_same_key_is_replaced() {
        let metadata = Metadata::new("t").note("a", "1").note("b", "2").note("a", "3");
        assert_eq!(metadata.title(), "t");
        assert_eq!(metadata.notes().collect::<Vec<_>>(), [("a", "3"), ("b", "2")]);
    }
}
