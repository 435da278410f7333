//! Headings of columns: their words and their units.

use super::unit::{Quantity, is_prefix, readings};

/// What a heading says of the unit of its column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum UnitOf {
    /// Nothing.
    Unnamed,
    /// A text, and the sizes in SI that it may have: of `1/s` as an angular frequency, 1 and 2π.
    Sizes(String, Vec<f64>),
    /// The unit of another quantity, an unknown one, or logarithms.
    Other(String),
}

/// The unit of `quantity` in a heading.
pub(crate) fn unit_of(heading: &str, quantity: Quantity) -> UnitOf {
    if let Some(logarithm) = logarithm(heading) {
        return UnitOf::Other(logarithm.into());
    }
    let texts = unit_texts(heading);
    for (text, _) in &texts {
        let sizes: Vec<f64> = readings(text).iter().filter(|unit| unit.0 == quantity).map(|unit| unit.1).collect();
        if !sizes.is_empty() {
            return UnitOf::Sizes((*text).into(), sizes);
        }
    }
    let is_other = |&&(text, marked): &&(&str, bool)| {
        // G(s) is a function, and a last word need not be a unit
        let clear = marked && text.chars().count() > 1;
        // text in square brackets is a unit, even an unsupported one; so is a character that was misread, as of µs
        let square = heading.contains(&format!("[{text}")) && text.contains(char::is_alphabetic);
        let misread = text.starts_with(|c: char| c == '?' || !c.is_ascii()) && text.contains(char::is_alphabetic);
        clear && (misread || !readings(text).is_empty()) || square
    };
    texts.iter().find(is_other).map_or(UnitOf::Unnamed, |(text, _)| UnitOf::Other((*text).into()))
}

/// The first word or symbol of a heading, in lower case.
pub(crate) fn symbol(heading: &str) -> String {
    heading.trim().split(|c: char| " [({_/,;:=.|*".contains(c)).next().unwrap_or_default().to_lowercase()
}

/// Whether a heading begins with one of the `words` in lower case: a symbol, or several with their marks.
pub(crate) fn begins_with(heading: &str, words: &[&str]) -> bool {
    let (symbol, heading) = (symbol(heading), heading.trim().to_lowercase());
    let several = |word: &str| word.contains([' ', '_', '|', '*', '(']);
    words.iter().any(|word| *word == symbol || several(word) && heading.starts_with(word))
}

/// The word in a heading that marks a column of logarithms.
fn logarithm(heading: &str) -> Option<&str> {
    let word = heading.trim().split(|c: char| !c.is_ascii_alphanumeric()).next()?;
    ["log", "log10", "lg", "ln"].contains(&word.to_ascii_lowercase().as_str()).then_some(word)
}

/// Characters between a symbol and its unit, and brackets.
const SEPARATORS: &str = " _,;:=|/-.";
const BRACKETS: [[char; 2]; 3] = [['[', ']'], ['(', ')'], ['{', '}']];

/// Possible units in a heading, and whether brackets or a slash mark them: its ends, else the ends of the part before a
/// bracket, and the texts in brackets.
fn unit_texts(heading: &str) -> Vec<(&str, bool)> {
    let inside = BRACKETS.iter().filter_map(|[open, close]| {
        let (before, rest) = heading.rsplit_once(*open).filter(|(before, _)| !is_open(before))?;
        Some((before, rest.rsplit_once(*close)?.0.trim()))
    });
    let before = inside.clone().map(|(before, _)| before).min_by_key(|before| before.len());
    let mut ends = last_units(heading);
    if let (true, Some(before)) = (ends.is_empty(), before) {
        ends = last_units(before);
    }
    ends.into_iter().chain(inside.map(|(_, text)| (text, true))).collect()
}

/// Whether a bracket of a text is not closed: what follows is not all that it encloses, as of `E (M(Pa)`.
fn is_open(text: &str) -> bool {
    BRACKETS.iter().any(|[open, close]| text.matches(*open).count() > text.matches(*close).count())
}

/// The ends of a text that are units, the longest first: of `J 1/Pa`, this is 1/Pa, and not Pa; of `t / s`, the
/// second is s. None after a number, as in `E at 5 MPa`.
fn last_units(text: &str) -> Vec<(&str, bool)> {
    let opens = |c: char| BRACKETS.iter().any(|[open, _]| *open == c);
    let starts = text.char_indices().filter(|&(_, c)| SEPARATORS.contains(c) || opens(c));
    let unit = |(at, mark): (usize, char)| {
        let unit = if opens(mark) { &text[at..] } else { text[at + mark.len_utf8()..].trim() };
        if readings(unit).is_empty() {
            return None;
        }
        let left = text[..at].trim();
        let word = left.rsplit(|c: char| SEPARATORS.contains(c) || opens(c)).next()?;
        let bare = BRACKETS.iter().find_map(|[open, close]| unit.strip_prefix(*open)?.strip_suffix(*close));
        let bare = bare.filter(|_| !is_open(left));
        // the s of rad/s is no unit of its own; h/nm is a depth
        let divides = mark == '/' && word != left && !readings(word).is_empty();
        // a unit torn from its prefix, as in k_Pa
        let is_torn = mark != '/' && word != left && is_prefix(word);
        let allowed = bare.is_some() || word.parse::<f64>().is_err() && !divides && !is_torn;
        allowed.then_some((bare.unwrap_or(unit).trim(), mark == '/' || bare.is_some()))
    };
    starts.filter_map(unit).collect()
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
        for heading in ["E at 5 MPa", "G'", "J (dry)", "|E*| (M(Pa)", "t [m[s]", "t [?]", "J (at 5 MPa)"] {
            assert!(unit_texts(heading).iter().all(|(text, _)| readings(text).is_empty()), "{heading}");
        }
    }

    #[test]
    fn units_follow_a_symbol_in_every_way() {
        for (symbol, unit, quantity, size) in [
            ("t", "min", Quantity::TIME, 60.0),
            ("Frequency", "kHz", Quantity::FREQUENCY, 1e3 * std::f64::consts::TAU),
            ("omega", "rad s^-1", Quantity::FREQUENCY, 1.0),
            ("J(t)", "10^{-9} 1/Pa", Quantity::COMPLIANCE, 1e-9),
            ("Creep compliance", "1/(Pa)", Quantity::COMPLIANCE, 1.0),
            ("Storage modulus", "10⁹ Pa", Quantity::MODULUS, 1e9),
            ("E'", "N m^-2", Quantity::MODULUS, 1.0),
        ] {
            let spaced = [" ", "_", " in ", ": ", " = ", " | ", ", "].map(|between| format!("{symbol}{between}{unit}"));
            let enclosed = [["[", "]"], [" [", "]"], [" (", ")"], ["/(", ")"], [" / (", ")"], [" {", "}"]];
            let enclosed = enclosed.map(|[open, close]| format!("{symbol}{open}{unit}{close}"));
            for heading in spaced.into_iter().chain(enclosed) {
                let UnitOf::Sizes(text, sizes) = unit_of(&heading, quantity) else { panic!("{heading}") };
                assert!(
                    text == unit && sizes.iter().any(|found| (found / size - 1.0).abs() < 1e-12),
                    "{heading}: {text}"
                );
            }
        }
    }
}
