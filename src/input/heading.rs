//! Headings of columns: their words and their units.

use super::unit::{Quantity, is_prefix, is_prefix_name, readings};

/// What a heading says of the unit of its column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum UnitOf {
    /// Nothing.
    Unnamed,
    /// A text, and the sizes in SI that it may have: of `1/s` as an angular frequency, 1 and 2π.
    Sizes(String, Vec<f64>),
    /// The unit of another quantity, or an unknown one.
    Other(String),
    /// Logarithms, a factor beside the unit, whose sense is not known, or words that are not all of a unit.
    Unclear(String),
}

/// The unit of `quantity` in a heading: the whole of a text in brackets or at the end, and nothing in the rest of the
/// heading that changes it.
pub(crate) fn unit_of(heading: &str, quantity: Quantity) -> UnitOf {
    if let Some(logarithm) = logarithm(heading) {
        return UnitOf::Unclear(logarithm.into());
    }
    let texts = unit_texts(heading);
    let sizes = |text: &str| -> Vec<f64> {
        readings(bare(text)).iter().filter(|unit| unit.0 == quantity).map(|unit| unit.1).collect()
    };
    let found = texts.iter().find(|unit| !unit.is_torn && !sizes(unit.text).is_empty());
    // brackets around another unit are a condition: of E'(10 Hz)/MPa
    let conditions = texts.iter().filter(|unit| unit.is_enclosed && !readings(bare(unit.text)).is_empty());
    let rest = without(heading, conditions.chain(found).map(|unit| unit.text));
    if let Some(factor) = factor(&rest) {
        return UnitOf::Unclear(factor);
    }
    if let Some(found) = found {
        let mut all = sizes(found.text);
        // two units of one quantity: Load (N) [mN]
        let apart = texts.iter().filter(|unit| unit.is_enclosed && !found.text.contains(unit.text));
        all.extend(apart.flat_map(|unit| sizes(unit.text)).filter(|size| !sizes(found.text).contains(size)));
        return UnitOf::Sizes(bare(found.text).into(), all);
    }
    if let Some(part) = texts.iter().find(|unit| unit.is_torn || unit.is_enclosed && ends_in(unit.text, quantity)) {
        return UnitOf::Unclear(part.text.into());
    }
    let is_other = |unit: &&UnitText| {
        let text = unit.text;
        // G(s) is a function, and a last word need not be a unit
        let clear = unit.is_marked && text.chars().count() > 1;
        // text in square brackets is a unit, even an unsupported one; so is a character that was misread, as of µs
        let square = heading.contains(&format!("[{text}")) && text.contains(char::is_alphabetic);
        let misread = text.starts_with(|c: char| c == '?' || !c.is_ascii()) && text.contains(char::is_alphabetic);
        clear && (misread || !readings(text).is_empty()) || square
    };
    texts.iter().find(is_other).map_or(UnitOf::Unnamed, |unit| UnitOf::Other(unit.text.into()))
}

/// What is in brackets or behind a slash without words that do not change a unit: of `in MPa` and `x10^6 Pa`.
fn bare(text: &str) -> &str {
    let text = text.trim();
    let text = text.strip_prefix("in ").unwrap_or(text).trim_start();
    let rest = text.strip_prefix(MULTIPLIED).map(str::trim_start);
    rest.filter(|rest| is_power_of_ten(rest)).unwrap_or(text)
}

/// Whether the last word of a text in brackets is a unit of `quantity`, which the words before it may change: of
/// `k Pa` or `true Pa`, but not of `at 5 MPa`.
fn ends_in(text: &str, quantity: Quantity) -> bool {
    let words: Vec<&str> = text.split([' ', '_', ',', ';']).filter(|word| !word.is_empty()).collect();
    let [before @ .., last] = &words[..] else { return false };
    let is_condition = before.len() > 1 && before[before.len() - 1].parse::<f64>().is_ok();
    !is_condition && readings(last).iter().any(|unit| unit.0 == quantity)
}

/// Whether a heading has a value of `quantity` in brackets, at which its column was measured: of `E'(10.0Hz)/MPa`.
pub(super) fn is_at(heading: &str, quantity: Quantity) -> bool {
    let is_value = |text: &str| {
        let unit = text.trim_start_matches(|c: char| c.is_ascii_digit() || ".,+-".contains(c));
        unit.len() < text.len() && readings(unit).iter().any(|unit| unit.0 == quantity)
    };
    heading.split(['(', '[']).skip(1).filter_map(|text| text.split([')', ']']).next()).any(is_value)
}

/// A heading without parts of it.
fn without<'a>(heading: &str, parts: impl Iterator<Item = &'a str>) -> String {
    parts.fold(heading.to_owned(), |rest, part| match rest.rfind(part) {
        Some(at) => format!("{} {}", &rest[..at], &rest[at + part.len()..]),
        None => rest,
    })
}

const MULTIPLIED: [char; 4] = ['x', '×', '*', '·'];

/// Whether a text begins with a power of ten: 10^3, 10⁻³, 1e-3, 1000.
fn is_power_of_ten(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('1') else { return false };
    let digits = |text: &str| text.starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c));
    rest.starts_with('0') || rest.strip_prefix(['e', 'E']).is_some_and(digits)
}

/// A factor in what a heading has beside its unit: a power of ten, or the name of one. Whether values are to be
/// multiplied or divided by it is not known.
fn factor(rest: &str) -> Option<String> {
    const NUMBERS: [&str; 6] = ["thousand", "thousands", "million", "millions", "billion", "billions"];
    let word = |c: char| !(c.is_alphanumeric() || "^+-*×·{}".contains(c));
    let names = |text: &&str| {
        is_prefix_name(text.trim_matches('-')) || NUMBERS.iter().any(|number| text.eq_ignore_ascii_case(number))
    };
    if let Some(name) = rest.split(word).find(names) {
        return Some(name.into());
    }
    // written as a power, or beside a mark: 10^3, 1e3, x1000, 10*; the star of E* 10 Hz is none
    let is_factor = |&(at, _): &(usize, char)| {
        let (before, text) = (&rest[..at], &rest[at..]);
        let number = text.find(|c: char| !c.is_ascii_digit()).map_or(text, |end| &text[..end]);
        let after = &text[number.len()..];
        let is_written = after.starts_with(|c: char| "^eE⁻⁰¹²³⁴⁵⁶⁷⁸⁹×".contains(c));
        let marked = |mark: char| {
            let left = before.trim_end().strip_suffix(mark);
            let is_star = before.ends_with(' ') && left.is_some_and(|left| !left.ends_with(' '));
            left.is_some_and(|left| !is_star && (mark != 'x' || !left.ends_with(char::is_alphanumeric)))
        };
        let is_start = !before.ends_with(|c: char| c.is_ascii_digit() || ".,".contains(c));
        is_start
            && is_power_of_ten(text)
            && (is_written
                || after.trim_start().starts_with(['*', '×'])
                || after.starts_with(" x ")
                || MULTIPLIED.into_iter().any(marked))
    };
    let found = rest.char_indices().find(is_factor)?;
    Some(rest[found.0..].split(' ').next().unwrap_or_default().to_owned())
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
    const LOGARITHMS: [&str; 6] = ["log", "log10", "lg", "ln", "logarithm", "logarithmic"];
    let mut words = heading.split(|c: char| !c.is_ascii_alphanumeric());
    words.find(|word| LOGARITHMS.iter().any(|log| word.eq_ignore_ascii_case(log)))
}

/// Characters between a symbol and its unit, and brackets.
const SEPARATORS: &str = " _,;:=|/-.";
const BRACKETS: [[char; 2]; 3] = [['[', ']'], ['(', ')'], ['{', '}']];

/// A possible unit in a heading.
#[derive(Debug, Clone, Copy)]
struct UnitText<'a> {
    text: &'a str,
    /// Whether brackets or a slash mark it.
    is_marked: bool,
    /// Whether it is all that a pair of brackets encloses.
    is_enclosed: bool,
    /// Whether the symbol of a prefix or a sign of multiplication stands apart before it, as in k_Pa.
    is_torn: bool,
}

/// Possible units in a heading: its ends, else the ends of the part before a bracket, and the texts in brackets.
fn unit_texts<'a>(heading: &'a str) -> Vec<UnitText<'a>> {
    let enclosed = enclosed(heading);
    let mut texts = last_units(heading);
    if let (true, Some(first)) = (texts.is_empty(), enclosed.first()) {
        texts = last_units(&heading[..first.0 - 1]);
    }
    let whole = |(_, text): &(usize, &'a str)| UnitText {
        text: text.trim(),
        is_marked: true,
        is_enclosed: true,
        is_torn: false,
    };
    texts.extend(enclosed.iter().map(whole));
    texts
}

/// What the outermost pairs of brackets enclose, and where it begins; none in a heading with a bracket without its
/// counterpart.
fn enclosed(heading: &str) -> Vec<(usize, &str)> {
    let (mut open, mut found) = (Vec::<(usize, char)>::new(), Vec::new());
    for (at, c) in heading.char_indices() {
        for [left, right] in BRACKETS {
            if c == left {
                open.push((at, right));
            } else if c == right {
                match open.pop() {
                    Some((from, closing)) if closing == c && open.is_empty() => {
                        found.push((from + 1, &heading[from + 1..at]));
                    }
                    Some((_, closing)) if closing == c => {}
                    _ => return Vec::new(),
                }
            }
        }
    }
    if open.is_empty() { found } else { Vec::new() }
}

/// The ends of a text that are units, the longest first: of `J 1/Pa`, this is 1/Pa, and not Pa; of `t / s`, the
/// second is s. None after a number, as in `E at 5 MPa`, and none in brackets.
fn last_units(text: &str) -> Vec<UnitText<'_>> {
    let enclosed = enclosed(text);
    let opens = |c: char| BRACKETS.iter().any(|[open, _]| *open == c);
    let is_inside = |at: usize| enclosed.iter().any(|(from, inner)| (*from..=from + inner.len()).contains(&at));
    let starts = text.char_indices().filter(|&(at, c)| SEPARATORS.contains(c) && !is_inside(at));
    let unit = |(at, mark): (usize, char)| {
        let is_marked = mark == '/';
        let unit = text[at + mark.len_utf8()..].trim();
        // brackets end the unit, but for those of 1/(GPa) and 10^{-9} Pa
        let is_own = |from: usize| ['/', '^'].iter().any(|&mark| text[at + 1..from - 1].trim_end().ends_with(mark));
        if !enclosed.iter().filter(|(from, _)| *from > at).all(|(from, _)| is_own(*from)) {
            return None;
        }
        if readings(if is_marked { bare(unit) } else { unit }).is_empty() {
            return None;
        }
        let left = text[..at].trim();
        let word = left.rsplit(|c: char| SEPARATORS.contains(c) || opens(c)).next()?;
        // the s of rad/s is no unit of its own; h/nm is a depth
        let divides = is_marked && word != left && !readings(word).is_empty();
        let is_torn = !is_marked && word != left && (is_prefix(word) || word.ends_with(MULTIPLIED));
        let allowed = word.parse::<f64>().is_err() && !divides && (is_marked || !left.ends_with('/'));
        allowed.then_some(UnitText { text: unit, is_marked, is_enclosed: false, is_torn })
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
            assert_eq!(unit_texts(heading).first().map(|unit| unit.text), Some(unit), "{heading}");
        }
        for heading in ["E at 5 MPa", "G'", "J (dry)", "|E*| (M(Pa)", "t [m[s]", "t [?]", "J (at 5 MPa)"] {
            assert!(unit_texts(heading).iter().all(|unit| readings(unit.text).is_empty()), "{heading}");
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
