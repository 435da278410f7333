//! The description of a run in its files.

use crate::contact::Settings;
use crate::fields::{About, Fields};
use crate::output::Field;
use crate::rheology::{Material, TemperatureHistory, Volume};
use crate::run::Contact;

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
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
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

    /// Adds a note on facts that the contact does not hold, such as the shape of the bodies, the specimen or the
    /// operator. A note of the same key is replaced.
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
    /// `spacing` and `lengths` \[m\]), `bodies`, `kernel`, `settings` (their fields), `material`, `temperature` if it
    /// changes, `units` of all values written, and `conventions`.
    ///
    /// `material` has an entry for each body: `poisson` or `bulk_modulus` \[Pa\], and `contact_creep`, the series of
    /// C(t) with `glassy` \[1/Pa\], `fluidity` \[1/(Pa s)\] and `terms` of \[compliance, retardation time\]; a body
    /// without a series has `rheology`, as Rust prints it. `temperature` has the `reference`, the constants of the
    /// law, and the `table` of \[time, temperature\], or the `corners` of a function. Of a contact on elastic states
    /// there is no more than title, notes, crate and version, units and conventions.
    pub fn json(&self, contact: &impl Contact) -> String {
        self.of(contact.in_space())
    }

    /// [`Metadata::json`] of a contact with these fields.
    pub(super) fn of(&self, contact: Option<Fields<'_>>) -> String {
        let units = Field::ALL.map(|field| (field.name(), field.unit())).into_iter().chain(UNITS);
        let units = ("units", object(units.map(|(name, unit)| (name, text(unit)))));
        let about = self.head().into_iter();
        let after = [units, ("conventions", text(CONVENTIONS))];
        let Some(contact) = contact else { return object(about.chain(after)) };
        let grid = contact.grid();
        let grid = object([
            ("cells", format!("{:?}", grid.cells())),
            ("spacing", format!("{:?}", grid.spacing())),
            ("lengths", format!("{:?}", grid.lengths())),
        ]);
        let About { material: bodies, temperature: history, .. } = contact.about;
        let bodies = bodies.map(|bodies| ("material", material(bodies)));
        let temperature = history.map(|history| ("temperature", temperature(history)));
        let scene = [
            ("grid", grid),
            ("bodies", contact.bodies().to_string()),
            ("kernel", text(&contact.kernel().to_string())),
            ("settings", settings(&contact.ground.settings)),
        ];
        object(about.chain(scene).chain(bodies).chain(temperature).chain(after))
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

/// The fields of settings.
fn settings(settings: &Settings) -> String {
    let Settings { tolerance, max_iterations, time_rule, edge, series_tolerance, symmetry, window, frame } = *settings;
    object([
        ("tolerance", number(tolerance)),
        ("max_iterations", max_iterations.to_string()),
        ("time_rule", text(&format!("{time_rule:?}"))),
        ("edge", text(&format!("{edge:?}"))),
        ("series_tolerance", number(series_tolerance)),
        ("symmetry", symmetry.to_string()),
        ("window", window.to_string()),
        ("frame", text(&format!("{frame:?}"))),
    ])
}

fn material(material: &Material) -> String {
    let bodies = material.bodies.iter().map(|body| {
        let volume = match body.volume {
            Volume::Proportional { poisson, .. } => ("poisson", number(poisson)),
            Volume::Bulk(at_once, ..) => ("bulk_modulus", number(at_once)),
        };
        let creep = match body.contact_spectrum() {
            Ok(Some(creep)) => {
                let ends = [("glassy", number(creep.glassy())), ("fluidity", number(creep.fluidity()))];
                ("contact_creep", object(ends.into_iter().chain([("terms", pairs(creep.terms()))])))
            }
            _ => ("rheology", text(&format!("{:?}", body.rheology))),
        };
        object([volume, creep])
    });
    array(bodies)
}

fn temperature(history: &TemperatureHistory) -> String {
    let law = history.law();
    let constants = law.wlf_constants().map(|[c1, c2]| [("c1", number(c1)), ("c2", number(c2))]);
    let energy = law.activation_energy().map(|energy| ("activation_energy", number(energy)));
    let course = match history.course() {
        Ok(table) => ("table", pairs(table)),
        Err(corners) => ("corners", array(corners.iter().copied().map(number))),
    };
    let below: Vec<_> = law.arrhenius_below().collect();
    let parts = [
        law.rows().map(|(rows, _)| ("shift_factors", pairs(rows))),
        law.rows().map(|(_, extrapolated)| ("extrapolated", extrapolated.to_string())),
        (!below.is_empty()).then(|| ("arrhenius_below", pairs(&below))),
    ];
    let reference = ("reference", number(law.reference()));
    let law = [reference].into_iter().chain(constants.into_iter().flatten()).chain(energy);
    object(law.chain(parts.into_iter().flatten()).chain([course]))
}

fn pairs(pairs: &[(f64, f64)]) -> String {
    array(pairs.iter().map(|&(one, other)| array([one, other].map(number))))
}

fn array(values: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", values.into_iter().collect::<Vec<_>>().join(", "))
}

/// A JSON number; JSON has none for NaN and infinity.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { "null".into() }
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
