//! The description of a run in its files.

use crate::ViscoelasticContact;
use crate::output::Field;

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
        let grid = contact.grid();
        let grid = object([
            ("cells", format!("{:?}", grid.cells())),
            ("spacing", format!("{:?}", grid.spacing())),
            ("lengths", format!("{:?}", grid.lengths())),
        ]);
        let units = Field::ALL.map(|field| (field.name(), field.unit())).into_iter().chain(UNITS);
        let temperature = contact.temperature().map(|temperature| ("temperature", text(&format!("{temperature:?}"))));
        let scene = [
            ("grid", grid),
            ("bodies", contact.bodies().to_string()),
            ("kernel", text(&contact.kernel().to_string())),
            ("settings", text(&format!("{:?}", contact.settings()))),
            ("material", text(&format!("{:?}", contact.material()))),
        ];
        let units = ("units", object(units.map(|(name, unit)| (name, text(unit)))));
        let conventions = ("conventions", text(CONVENTIONS));
        object(self.head().into_iter().chain(scene).chain(temperature).chain([units, conventions]))
    }

    /// Title, notes and version of the crate as JSON.
    #[cfg(feature = "npy")]
    pub(super) fn brief(&self) -> String {
        object(self.head())
    }

    fn head(&self) -> [(&'static str, String); 4] {
        [
            ("title", text(&self.title)),
            ("notes", object(self.notes().map(|(key, value)| (key, text(value))))),
            ("crate", text(env!("CARGO_PKG_NAME"))),
            ("version", text(env!("CARGO_PKG_VERSION"))),
        ]
    }
}

/// A JSON object of keys and values in JSON.
fn object<'a>(entries: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let entries: Vec<String> = entries.into_iter().map(|(key, value)| format!("{}: {value}", text(key))).collect();
    format!("{{{}}}", entries.join(", "))
}

/// A JSON string, in which line breaks and other control characters are escaped.
fn text(text: &str) -> String {
    let escaped = text.chars().map(|c| match c {
        '"' | '\\' => format!("\\{c}"),
        '\n' => "\\n".into(),
        '\t' => "\\t".into(),
        c if c.is_control() => format!("\\u{:04x}", u32::from(c)),
        c => c.into(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_characters_are_escaped() {
        assert_eq!(text("a \"b\" \\ c\nd\te\r\u{1}\u{85} µm"), r#""a \"b\" \\ c\nd\te\u000d\u0001\u0085 µm""#);
    }

    #[test]
    fn objects_nest() {
        let inner = object([("spacing", format!("{:?}", [1e-30, 0.5]))]);
        assert_eq!(inner, r#"{"spacing": [1e-30, 0.5]}"#);
        let outer = object([("a", text("b")), ("grid", inner), ("empty", object([]))]);
        assert_eq!(outer, r#"{"a": "b", "grid": {"spacing": [1e-30, 0.5]}, "empty": {}}"#);
    }

    #[test]
    fn a_note_of_the_same_key_is_replaced() {
        let metadata = Metadata::new("t").note("a", "1").note("b", "2").note("a", "3");
        assert_eq!(metadata.title(), "t");
        assert_eq!(metadata.notes().collect::<Vec<_>>(), [("a", "3"), ("b", "2")]);
    }
}
