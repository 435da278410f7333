//! Headings of a table: the meaning and the unit of each column.

use super::Units;
use super::unit::{COMPLIANCE, FREQUENCY, MODULUS, TIME, name, readings, same};
use crate::error::TableError;
use crate::input::{TextRow, shortened};
use crate::rheology::fit::MaterialFunction;
use crate::rheology::table::data::{Deformation, Layout};

/// Parts of headings of other quantities.
const OTHERS: &[&str] = &["factor", "tan", "strain", "stress", "phase", "%"];

/// First words of the headings of a column, lower case.
fn words(column: &str) -> &'static [&'static str] {
    match column {
        "creep compliance" => &["j", "creep", "compliance"],
        "relaxation modulus" => &["g", "e", "relaxation", "modulus", "young's"],
        "storage modulus" => &["g'", "g′", "e'", "e′", "storage", "gp"],
        "loss modulus" => &["g''", "g″", "g\"", "e''", "e″", "e\"", "loss", "gpp"],
        _ => &["time", "t", "omega", "ω", "angular", "frequency", "freq", "f", "w"],
    }
}

/// Indices of the columns that a table needs, in its order.
pub(super) fn columns(headings: &TextRow, layout: &Layout) -> Result<Vec<usize>, TableError> {
    let place = |name: &'static str| {
        let is_named = |heading: &str| {
            let heading = heading.to_lowercase();
            let word = symbol(&heading);
            // a D alone may be a diameter
            let of_tension = name == "creep compliance" && word == "d" && is_compliance(&heading);
            (words(name).contains(&word) || of_tension) && !OTHERS.iter().any(|other| heading.contains(other))
        };
        let mut places = (0..headings.fields.len()).filter(|&k| is_named(&headings.fields[k]));
        match (places.next(), places.next()) {
            (Some(place), None) => Ok(place),
            _ => {
                let found = shortened(&headings.fields.join(", "));
                Err(TableError::Heading { line: headings.line, column: name, found })
            }
        }
    };
    layout.names().map(place).collect()
}

/// The first word of a heading.
fn symbol(heading: &str) -> &str {
    heading.split(|c: char| " [({_/,;:=.|*".contains(c)).next().unwrap_or_default()
}

/// Whether a heading is a function of time, or has the unit of a compliance.
fn is_compliance(heading: &str) -> bool {
    let of_compliance = |text: &str| readings(text).iter().any(|reading| reading.0 == COMPLIANCE);
    heading.contains("(t)") || unit_texts(heading).iter().any(|(text, _)| of_compliance(text))
}

/// The deformation that the headings of the columns of values name; `order` has the indices of the columns that are read.
pub(super) fn deformation(headings: &TextRow, order: &[usize]) -> Deformation {
    let named = |heading: &str| {
        let heading = heading.to_lowercase();
        let word = symbol(&heading);
        let letter = word.trim_end_matches(['\'', '′', '"', '″']);
        if ["e", "d"].contains(&letter)
            || word == "young's"
            || heading.contains("tensile")
            || heading.contains("tension")
        {
            Deformation::Tension
        } else if ["g", "j", "gp", "gpp"].contains(&letter) || heading.contains("shear") {
            Deformation::Shear
        } else {
            Deformation::Unnamed
        }
    };
    let of_values = order[1..].iter().map(|&column| named(&headings.fields[column]));
    of_values.fold(Deformation::Unnamed, |found, next| if found == Deformation::Unnamed { next } else { found })
}

/// Rejects headings with units other than those given; `order` has the indices of the columns that are read.
pub(super) fn check_units(
    headings: &TextRow,
    order: &[usize],
    layout: &Layout,
    units: Units,
) -> Result<(), TableError> {
    let abscissa = if layout.zero { TIME } else { FREQUENCY };
    let values = layout.columns.iter().map(|&(_, function)| {
        let quantity = if function == MaterialFunction::Creep { COMPLIANCE } else { MODULUS };
        ("value", quantity, units.value)
    });
    let fields = std::iter::once(("abscissa", abscissa, units.abscissa)).chain(values);
    for ((field, quantity, given), &column) in fields.zip(order) {
        let heading = &*headings.fields[column];
        let refused = |unit: &str, size: Option<f64>| {
            let (line, heading, unit) = (headings.line, heading.to_owned(), unit.into());
            let expected = name(quantity, given).into();
            Err(TableError::Unit { line, column: column + 1, heading, unit, size, field, given, expected })
        };
        if let Some(logarithm) = logarithm(heading) {
            return refused(logarithm, None);
        }
        for (text, marked) in unit_texts(heading) {
            let readings = readings(text);
            let sizes: Vec<f64> =
                readings.iter().filter(|reading| reading.0 == quantity).map(|reading| reading.1).collect();
            if sizes.iter().any(|&size| same(size, given)) {
                break;
            }
            // G(s) is a function, and a last word need not be a unit
            let clear = !sizes.is_empty() || marked && text.chars().count() > 1;
            // text in square brackets is a unit, even an unsupported one
            let square = heading.contains(&format!("[{text}")) && text.contains(char::is_alphabetic);
            if clear && !readings.is_empty() || square {
                return refused(text, sizes.first().copied());
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

/// Characters between a symbol and its unit, and brackets.
const SEPARATORS: &str = " _,;:=|/-.";
const BRACKETS: [[char; 2]; 3] = [['[', ']'], ['(', ')'], ['{', '}']];

/// Possible units in a heading, and whether brackets or a slash mark them: its end, else the end of the part before a
/// bracket, and the texts in brackets.
fn unit_texts(heading: &str) -> Vec<(&str, bool)> {
    let inside = BRACKETS.iter().filter_map(|[open, close]| {
        let (before, rest) = heading.rsplit_once(*open)?;
        Some((before, rest.rsplit_once(*close)?.0.trim()))
    });
    let before = inside.clone().map(|(before, _)| before).min_by_key(|before| before.len());
    let end = last_unit(heading).or_else(|| last_unit(before?));
    end.into_iter().chain(inside.map(|(_, text)| (text, true))).collect()
}

/// The longest end of a text that is a unit: of `J 1/Pa`, this is 1/Pa, and not Pa. None after a number, as in `E at 5 MPa`.
fn last_unit(text: &str) -> Option<(&str, bool)> {
    let opens = |c: char| BRACKETS.iter().any(|[open, _]| *open == c);
    let starts = text.char_indices().filter(|&(_, c)| SEPARATORS.contains(c) || opens(c));
    let found = starts.map(|(at, c)| (at, c, if opens(c) { &text[at..] } else { text[at + c.len_utf8()..].trim() }));
    let (at, mark, unit) = found.into_iter().find(|(_, _, unit)| !readings(unit).is_empty())?;
    let word = text[..at].trim_end().rsplit(|c: char| SEPARATORS.contains(c)).next()?;
    let bare = BRACKETS.iter().find_map(|[open, close]| unit.strip_prefix(*open)?.strip_suffix(*close));
    let marked = mark == '/' || bare.is_some();
    (marked || word.parse::<f64>().is_err()).then_some((bare.unwrap_or(unit).trim(), marked))
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
    fn units_end_a_heading_or_stand_in_brackets() {
        for (heading, unit) in [
            ("time [s]", "s"),
            ("J / (1/GPa)", "1/GPa"),
            ("t/min", "min"),
            ("J/GPa^-1", "GPa^-1"),
            ("J 1/Pa", "1/Pa"),
            ("J_1/Pa", "1/Pa"),
            ("J 1/(GPa)", "1/(GPa)"),
            ("J1 10^{-9} 1/Pa", "10^{-9} 1/Pa"),
            ("E_MPa", "MPa"),
            ("E MPa (at 23 °C)", "MPa"),
        ] {
            assert_eq!(unit_texts(heading).first().map(|text| text.0), Some(unit), "{heading}");
        }
        for heading in ["E at 5 MPa", "G'", "J (dry)"] {
            assert!(unit_texts(heading).iter().all(|(text, _)| readings(text).is_empty()), "{heading}");
        }
    }
}
