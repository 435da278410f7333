//! Headings of columns: their names and units.

use crate::data::error::DataError;

/// A quantity, the units that its columns may have, and an example of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Quantity {
    Time,
    Length,
    Force,
}

/// A column of a recording: its name for errors, first words of its headings, lower case, and its quantity.
pub(super) struct Column {
    pub(super) name: &'static str,
    words: &'static [&'static str],
    quantity: Quantity,
}

pub(super) const TIME: Column = Column { name: "time", words: &["t", "time"], quantity: Quantity::Time };
pub(super) const FORCE: Column =
    Column { name: "force", words: &["f", "force", "load", "p"], quantity: Quantity::Force };
pub(super) const DEFLECTION: Column =
    Column { name: "deflection", words: &["deflection", "defl"], quantity: Quantity::Length };
pub(super) const DRIVE: Column = Column {
    name: "drive",
    words: &["z", "zsnsr", "drive", "position", "piezo", "base", "stage"],
    quantity: Quantity::Length,
};
pub(super) const DEPTH: Column =
    Column { name: "depth", words: &["depth", "indentation", "δ", "delta", "h"], quantity: Quantity::Length };

impl Quantity {
    fn name(self) -> (&'static str, &'static str) {
        match self {
            Quantity::Time => ("time", "s"),
            Quantity::Length => ("length", "nm"),
            Quantity::Force => ("force", "nN"),
        }
    }

    /// The size of a unit in SI.
    fn size(self, unit: &str) -> Option<f64> {
        let unit = unit.trim();
        let symbol = match self {
            Quantity::Time => match unit {
                "sec" | "second" | "seconds" => return Some(1.0),
                "min" => return Some(60.0),
                "h" => return Some(3600.0),
                _ => 's',
            },
            Quantity::Length => match unit {
                "micron" | "microns" => return Some(1e-6),
                "Å" => return Some(1e-10),
                _ => 'm',
            },
            Quantity::Force => 'N',
        };
        match unit.strip_suffix(symbol)? {
            "" => Some(1.0),
            "k" => Some(1e3),
            "m" => Some(1e-3),
            // micro sign, Greek letter
            "u" | "\u{b5}" | "\u{3bc}" => Some(1e-6),
            "n" => Some(1e-9),
            "p" => Some(1e-12),
            _ => None,
        }
    }
}

impl Column {
    /// Index of the column with this name and the size of its unit in SI; `None` if no heading names it.
    pub(super) fn find(&self, line: u64, headings: &[String]) -> Result<Option<(usize, f64)>, DataError> {
        let mut places = (0..headings.len()).filter(|&k| self.words.contains(&first_word(&headings[k]).as_str()));
        let Some(place) = places.next() else { return Ok(None) };
        if places.next().is_some() {
            return Err(self.missing(line, headings));
        }
        let heading = &headings[place];
        let (quantity, example) = self.quantity.name();
        let size = units(heading).find_map(|unit| self.quantity.size(unit));
        let size = size.ok_or(DataError::Unit { line, heading: heading.clone(), quantity, example })?;
        Ok(Some((place, size)))
    }

    /// The error of a column that no heading names, or more than one.
    pub(super) fn missing(&self, line: u64, headings: &[String]) -> DataError {
        let words = self.words.join(", ");
        DataError::Heading { line, column: self.name, words, found: headings.join(", ") }
    }
}

fn first_word(heading: &str) -> String {
    heading.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_lowercase()
}

/// What may be the unit of a heading: text in brackets, or else the end after a slash, an underscore or a blank.
fn units(heading: &str) -> impl Iterator<Item = &str> {
    let inside = [['[', ']'], ['(', ')'], ['{', '}']].into_iter().filter_map(|[open, close]| {
        let (_, rest) = heading.rsplit_once(open)?;
        Some(rest.split_once(close)?.0)
    });
    let is_bare = !heading.contains(['[', '(', '{']);
    let end = is_bare.then(|| heading.rsplit_once(['/', '_', ' ', ',', ';'])).flatten();
    inside.chain(end.map(|(_, end)| end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_in_every_notation() {
        for (heading, column, size) in [
            ("t [s]", TIME, 1.0),
            ("Time (ms)", TIME, 1e-3),
            ("time/min", TIME, 60.0),
            ("F_nN", FORCE, 1e-9),
            ("Load on sample (mN)", FORCE, 1e-3),
            ("P, \u{b5}N", FORCE, 1e-6),
            ("Z [\u{3bc}m]", DRIVE, 1e-6),
            ("depth um", DEPTH, 1e-6),
            ("h [Å]", DEPTH, 1e-10),
            ("Defl (m)", DEFLECTION, 1.0),
        ] {
            assert_eq!(column.find(1, &[heading.into()]), Ok(Some((0, size))), "{heading}");
        }
        for (heading, column) in
            [("t", TIME), ("t [nm]", TIME), ("F [N/m]", FORCE), ("z (dry)", DRIVE), ("depth [Gm]", DEPTH)]
        {
            let found = column.find(3, &[heading.into()]);
            assert!(matches!(found, Err(DataError::Unit { line: 3, .. })), "{heading}: {found:?}");
        }
        for heading in ["temperature [s]", "phase [s]", "", "[s]"] {
            assert_eq!(TIME.find(1, &[heading.into()]), Ok(None), "{heading}");
        }
    }
}
