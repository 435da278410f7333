//! Headings of a table: the meaning and the unit of each column.

use super::Units;
use super::number::shortened;
use super::unit::{Kind, readings, same};
use crate::error::TableError;
use crate::rheology::fit::MaterialFunction;
use crate::rheology::table::data::Layout;

/// Parts of headings of other quantities.
const OTHERS: &[&str] = &["factor", "tan", "strain", "stress", "phase", "%"];

/// First words of the headings of a column, lower case.
fn words(column: &str) -> &'static [&'static str] {
    match column {
        "creep compliance" => &["j", "creep", "compliance"],
        "relaxation modulus" => &["g", "e", "relaxation", "modulus"],
        "storage modulus" => &["g'", "g′", "e'", "e′", "storage", "gp"],
        "loss modulus" => &["g''", "g″", "g\"", "e''", "e″", "e\"", "loss", "gpp"],
        _ => &["time", "t", "omega", "ω", "angular", "frequency", "freq", "f", "w"],
    }
}

/// Indices of the columns that a table needs, in its order, or `None` if no heading names one.
pub(super) fn columns(
    line: u64,
    headings: &[String],
    names: &[&'static str],
) -> Result<Option<Vec<usize>>, TableError> {
    let is_other = |heading: &&String| OTHERS.iter().any(|other| heading.to_lowercase().contains(other));
    let meaning: Vec<Option<&'static str>> = headings
        .iter()
        .map(|heading| {
            if is_other(&heading) {
                return None;
            }
            let heading = heading.to_lowercase();
            let word = heading.split(|c: char| " [(_/,;|*".contains(c)).next().unwrap_or_default();
            names.iter().copied().find(|name| words(name).contains(&word))
        })
        .collect();
    let nothing = meaning.iter().all(Option::is_none) && !headings.iter().any(|heading| is_other(&heading));
    if nothing && headings.len() == names.len() {
        return Ok(None);
    }
    let single = |&name: &&'static str| {
        let mut places = (0..headings.len()).filter(|&k| meaning[k] == Some(name));
        match (places.next(), places.next()) {
            (Some(place), None) => Ok(place),
            _ => {
                let found = shortened(&headings.join(", "));
                Err(TableError::Heading { line, column: name, found })
            }
        }
    };
    names.iter().map(single).collect::<Result<_, _>>().map(Some)
}

/// Rejects headings with units other than those given; `order` has the indices of the columns that are read.
pub(super) fn check_units(
    line: u64,
    headings: &[String],
    order: &[usize],
    layout: &Layout,
    units: Units,
) -> Result<(), TableError> {
    let heading = &headings[order[0]];
    if heading.to_lowercase().contains("hz") && units.abscissa == 1.0 {
        return Err(TableError::Hertz { line, heading: heading.clone() });
    }
    let abscissa = if layout.zero { Kind::Time } else { Kind::Frequency };
    let values = layout.columns.iter().map(|&(_, function)| match function {
        MaterialFunction::Creep => Kind::Compliance,
        _ => Kind::Modulus,
    });
    let columns =
        std::iter::once(("abscissa", abscissa, units.abscissa)).chain(values.map(|kind| ("value", kind, units.value)));
    for ((field, kind, given), &column) in columns.zip(order) {
        let heading = &headings[column];
        let refused = |unit: &str| {
            let (heading, expected) = (heading.clone(), kind.name(given));
            Err(TableError::Unit { line, column: column + 1, heading, unit: unit.to_owned(), field, given, expected })
        };
        if let Some(logarithm) = logarithm(heading) {
            return refused(logarithm);
        }
        for (text, enclosed) in unit_texts(heading) {
            let readings = readings(text);
            let right = readings.iter().filter(|reading| reading.0 == kind);
            if right.clone().any(|reading| same(reading.1, given)) {
                break;
            }
            // G(s) is a function, and a last word need not be a unit
            let clear = right.clone().next().is_some() || enclosed && text.chars().count() > 1;
            // text in square brackets is a unit, known or not
            let square = heading.contains(&format!("[{text}")) && text.contains(char::is_alphabetic);
            if clear && !readings.is_empty() || square {
                return refused(text);
            }
        }
    }
    Ok(())
}

/// The word in a heading that marks a column of logarithms.
fn logarithm(heading: &str) -> Option<&str> {
    let word = heading.trim().split(|c: char| !c.is_ascii_alphanumeric()).next()?;
    ["log", "log10", "lg", "ln"].contains(&word.to_ascii_lowercase().as_str()).then_some(word)
}

/// Possible units in a heading: in brackets, after a slash, or its last word; and whether brackets or a slash mark it.
fn unit_texts(heading: &str) -> Vec<(&str, bool)> {
    let mut texts = Vec::new();
    let mut outside = heading;
    for brackets in [['[', ']'], ['(', ')']] {
        if let Some((before, rest)) = heading.rsplit_once(brackets[0])
            && let Some((inside, _)) = rest.rsplit_once(brackets[1])
        {
            texts.push((inside.trim(), true));
            outside = if before.len() < outside.len() { before } else { outside };
        }
    }
    if let Some((_, below)) = outside.split_once('/') {
        texts.push((below.trim(), true));
    }
    let mut words = outside.trim().rsplit([' ', '_', ',']);
    if let (Some(last), Some(before)) = (words.next(), words.next())
        && !before.contains(|c: char| c.is_ascii_digit())
    {
        texts.push((last, false));
    }
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_are_recognised() {
        for (heading, word) in [("log t [s]", Some("log")), ("Log10(J)", Some("Log10")), ("ln_t", Some("ln"))] {
            assert_eq!(logarithm(heading), word);
        }
        for heading in ["logger", "time", "J", "t/s", ""] {
            assert_eq!(logarithm(heading), None);
        }
    }

    #[test]
    fn units_are_in_brackets_after_slashes_or_last() {
        assert_eq!(unit_texts("time [s]"), [("s", true)]);
        assert_eq!(unit_texts("J / (1/GPa)"), [("1/GPa", true), ("", true), ("/", false)]);
        assert_eq!(unit_texts("t/min"), [("min", true)]);
        assert_eq!(unit_texts("J/GPa^-1"), [("GPa^-1", true)]);
        assert_eq!(unit_texts("E_MPa"), [("MPa", false)]);
        assert_eq!(unit_texts("E at 5 MPa"), []);
        assert_eq!(unit_texts("G'"), []);
    }
}
