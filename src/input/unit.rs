//! Units in the notations of headings.

use std::borrow::Cow;

/// The quantity of a unit: powers of second, newton, metre, radian and kelvin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quantity([i32; 5]);

impl Quantity {
    /// A number: tan δ.
    pub const NUMBER: Quantity = Quantity([0, 0, 0, 0, 0]);
    /// Time, in s.
    pub const TIME: Quantity = Quantity([1, 0, 0, 0, 0]);
    /// Angular frequency, in rad/s; 1 Hz is 2π rad/s.
    pub const FREQUENCY: Quantity = Quantity([-1, 0, 0, 1, 0]);
    /// Modulus, in Pa.
    pub const MODULUS: Quantity = Quantity([0, 1, -2, 0, 0]);
    /// Compliance, in 1/Pa.
    pub const COMPLIANCE: Quantity = Quantity([0, -1, 2, 0, 0]);
    /// Length, in m.
    pub const LENGTH: Quantity = Quantity([0, 0, 1, 0, 0]);
    /// Force, in N.
    pub const FORCE: Quantity = Quantity([0, 1, 0, 0, 0]);
    /// Angle, in rad.
    pub const ANGLE: Quantity = Quantity([0, 0, 0, 1, 0]);
    /// Temperature, in K or °C.
    pub const TEMPERATURE: Quantity = Quantity([0, 0, 0, 0, 1]);
    /// `1/s`: an angular frequency, or Hz.
    const RATE: Quantity = Quantity([-1, 0, 0, 0, 0]);

    /// The unit of this quantity in SI.
    pub(crate) fn si(self) -> &'static str {
        NAMED.iter().find(|(quantity, _)| *quantity == self).map_or("1", |(_, unit)| unit)
    }
}

/// The quantities that columns have, and their units in SI.
const NAMED: [(Quantity, &str); 8] = [
    (Quantity::TIME, "s"),
    (Quantity::FREQUENCY, "rad/s"),
    (Quantity::MODULUS, "Pa"),
    (Quantity::COMPLIANCE, "1/Pa"),
    (Quantity::LENGTH, "m"),
    (Quantity::FORCE, "N"),
    (Quantity::ANGLE, "rad"),
    (Quantity::TEMPERATURE, "K"),
];

use Quantity as Q;
const TAU: f64 = std::f64::consts::TAU;

/// A quantity, and the size of its unit in SI.
pub(crate) type Unit = (Quantity, f64);

/// Names of each unit, with the name for errors first; its quantity, its size, and whether it has prefixes.
const UNITS: [(&[&str], Quantity, f64, bool); 20] = [
    (&["s", "sec", "secs", "second", "seconds"], Q::TIME, 1.0, true),
    (&["min", "mins", "minute", "minutes"], Q::TIME, 60.0, false),
    (&["h", "hr", "hrs", "hour", "hours"], Q::TIME, 3600.0, false),
    (&["d", "day", "days"], Q::TIME, 86400.0, false),
    (&["week", "weeks"], Q::TIME, 604_800.0, false),
    (&["year", "years"], Q::TIME, 31_557_600.0, false),
    (&["Hz", "hertz"], Q::FREQUENCY, TAU, true),
    (&["Pa", "pascal", "pascals"], Q::MODULUS, 1.0, true),
    (&["bar"], Q::MODULUS, 1e5, true),
    (&["psi"], Q::MODULUS, 6894.757, false),
    (&["ksi"], Q::MODULUS, 6_894_757.0, false),
    (&["N", "newton", "newtons"], Q::FORCE, 1.0, true),
    (&["dyn", "dyne"], Q::FORCE, 1e-5, false),
    (&["m", "metre", "metres", "meter", "meters"], Q::LENGTH, 1.0, true),
    (&["micron", "microns"], Q::LENGTH, 1e-6, false),
    // letter, ångström sign, and the ASCII substitute
    (&["Å", "\u{212b}", "A"], Q::LENGTH, 1e-10, false),
    (&["rad"], Q::ANGLE, 1.0, true),
    (&["°", "deg", "degree", "degrees"], Q::ANGLE, TAU / 360.0, false),
    (&["K", "kelvin"], Q::TEMPERATURE, 1.0, false),
    (&["°C", "C", "degC", "celsius"], Q::TEMPERATURE, 1.0, false),
];
const PREFIXES: [&str; 11] = ["", "k", "M", "G", "T", "c", "m", "µ", "u", "n", "p"];
const FACTORS: [f64; 11] = [1.0, 1e3, 1e6, 1e9, 1e12, 1e-2, 1e-3, 1e-6, 1e-6, 1e-9, 1e-12];
/// Names of prefixes, in lower case, and their symbols. Those without a size in [`PREFIXES`], hecto and femto, are known
/// so that their headings are refused.
const NAMED_PREFIXES: [(&str, &str); 12] = [
    ("tera", "T"),
    ("giga", "G"),
    ("mega", "M"),
    ("kilo", "k"),
    ("hecto", "h"),
    ("centi", "c"),
    ("milli", "m"),
    ("micro", "µ"),
    ("mikro", "µ"),
    ("nano", "n"),
    ("pico", "p"),
    ("femto", "f"),
];

/// Every unit with every prefix: the prefix, its names without the prefix, and the unit.
fn prefixed() -> impl Iterator<Item = (&'static str, &'static [&'static str], Unit)> {
    UNITS.into_iter().flat_map(|(names, quantity, size, has_prefixes)| {
        let prefixes = PREFIXES.into_iter().zip(FACTORS).take(if has_prefixes { PREFIXES.len() } else { 1 });
        prefixes.map(move |(prefix, factor)| (prefix, names, (quantity, factor * size)))
    })
}

/// The name of the unit of this size, for errors.
pub(crate) fn name(quantity: Quantity, size: f64) -> String {
    let named = |quantity, size| {
        let (prefix, names, _) = prefixed().find(|(.., unit)| unit.0 == quantity && same(unit.1, size))?;
        Some(format!("{prefix}{}", names[0]))
    };
    let found = match quantity {
        Q::FREQUENCY if same(size, 1.0) => Some("rad/s".to_owned()),
        Q::COMPLIANCE => named(Q::MODULUS, 1.0 / size).map(|modulus| format!("1/{modulus}")),
        _ => named(quantity, size),
    };
    found.unwrap_or_else(|| format!("{size:e} {}", quantity.si()))
}

/// Whether a word is the symbol of a prefix: what follows is not the whole unit.
pub(super) fn is_prefix(word: &str) -> bool {
    !word.is_empty() && PREFIXES.contains(&word)
}

/// Whether a word is the name of a prefix.
pub(super) fn is_prefix_name(word: &str) -> bool {
    NAMED_PREFIXES.iter().any(|(name, _)| word.eq_ignore_ascii_case(name))
}

/// A word with the symbol of a prefix in place of its name: of `micro-N`, `micro_N`, `microN` and `micronewton`, but
/// not of microns.
fn with_symbol(word: &str) -> Option<String> {
    NAMED_PREFIXES.iter().find_map(|(name, symbol)| {
        let (head, rest) = word.split_at_checked(name.len()).filter(|(head, _)| head.eq_ignore_ascii_case(name))?;
        let unit = rest.trim_start_matches(['-', '_']);
        let is_symbol = rest.starts_with(char::is_uppercase) && head.ends_with(char::is_lowercase);
        let is_name = rest.len() > 2;
        (unit.len() < rest.len() || is_symbol || is_name).then(|| format!("{symbol}{unit}"))
    })
}

/// Whether two sizes are equal: 2π may be given with few digits.
pub(crate) fn same(one: f64, other: f64) -> bool {
    (one / other - 1.0).abs() < 1e-2
}

/// The possible meanings of the whole of a text as a unit, empty if none: `1/s` is an angular frequency or another
/// notation of Hz. A power of ten stands before the units that it multiplies.
pub(crate) fn readings(text: &str) -> Vec<Unit> {
    let text = plain(text);
    // of J / (10⁻⁶/Pa), the first slash is no part of the unit
    if text.starts_with('/') && text.matches('/').count() > 1 {
        return Vec::new();
    }
    let mut products = vec![(Q::NUMBER, 1.0)];
    for (k, part) in text.split('/').enumerate() {
        let Some(mut factors) = factors(part) else { return Vec::new() };
        if k == 0 && text.contains('/') {
            // of 10^-9 1/Pa
            factors.pop_if(|factor| factor == "1");
        } else if factors.is_empty() {
            return Vec::new();
        }
        let sign = if k == 0 { 1 } else { -1 };
        for (place, factor) in factors.iter().enumerate() {
            let powers = powers(factor, sign);
            // of N*1e6 and Pa/10^3, the factor has two meanings
            let is_misplaced = place > 0 || sign < 0 && factors.len() == 1;
            if is_misplaced && powers.iter().any(|power| power.0 == Q::NUMBER) {
                return Vec::new();
            }
            let times = |(quantity, size): Unit| {
                powers
                    .iter()
                    .map(move |other| (Q(std::array::from_fn(|k| quantity.0[k] + other.0.0[k])), size * other.1))
            };
            products = products.into_iter().flat_map(times).collect();
        }
    }
    let rates: Vec<Unit> =
        products.iter().filter(|unit| unit.0 == Q::RATE).map(|unit| (Q::FREQUENCY, TAU * unit.1)).collect();
    let angular =
        products.into_iter().map(|(quantity, size)| (if quantity == Q::RATE { Q::FREQUENCY } else { quantity }, size));
    angular.chain(rates).filter(|unit| NAMED.iter().any(|(quantity, _)| *quantity == unit.0)).collect()
}

/// The factors of a product, with the name of a prefix joined to its unit; none, if a mark lacks a factor on a side.
fn factors(product: &str) -> Option<Vec<String>> {
    let mut factors: Vec<String> = Vec::new();
    if product.trim().is_empty() {
        return Some(factors);
    }
    for marked in product.split(['·', '*', '×']) {
        let before = factors.len();
        for word in marked.split_whitespace() {
            match factors.last_mut().filter(|last| is_prefix_name(last.trim_end_matches(['-', '_']))) {
                Some(prefix) => *prefix += &format!("_{word}"),
                None => factors.push(word.to_owned()),
            }
        }
        if factors.len() == before {
            return None;
        }
    }
    Some(factors)
}

/// The text with blanks in place of brackets, and powers as in 10^-9 Pa^-1 for 10⁻⁹ Pa⁻¹ and 10^{-9} Pa^{-1}.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for c in text.replace("**", "^").trim().trim_end_matches('.').chars().filter(|c| !"{}".contains(*c)) {
        let raised = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻".chars().zip("0123456789-".chars()).find(|(raised, _)| *raised == c);
        if raised.is_some() && !plain.ends_with(['-', '^']) {
            plain.push('^');
        }
        plain.push(match (raised, c) {
            (Some((_, digit)), _) => digit,
            (None, 'μ') => 'µ',
            (None, '(' | ')' | '[' | ']') => ' ',
            _ => c,
        });
    }
    plain.trim().to_owned()
}

/// The possible meanings of a power, of ten or of a unit, or its reciprocal if `sign` is −1. Case is ignored in names
/// longer than a letter.
fn powers(factor: &str, sign: i32) -> Vec<Unit> {
    if let Some(power) = ["10^", "1e", "1E"].iter().find_map(|ten| factor.strip_prefix(ten)) {
        return exponent(power).map(|power| (Q::NUMBER, 10_f64.powi(sign * power))).into_iter().collect();
    }
    let factor = with_symbol(factor).map_or(Cow::Borrowed(factor), Cow::Owned);
    let end = factor.find(|c: char| c == '^' || c == '-' || c.is_ascii_digit()).unwrap_or(factor.len());
    let (name, power) = factor.split_at(end);
    let power = if power.is_empty() { Some(1) } else { exponent(power.trim_start_matches('^')) };
    let Some(power) = power.map(|power| sign * power) else { return Vec::new() };
    let units = |fits: &dyn Fn(&str, &str) -> bool| -> Vec<Unit> {
        let named = prefixed().filter(|(prefix, names, _)| names.iter().any(|unit| fits(prefix, unit)));
        named.map(|(.., (quantity, size))| (Q(quantity.0.map(|one| power * one)), size.powi(power))).collect()
    };
    let exact = units(&|prefix, unit| name.strip_prefix(prefix) == Some(unit));
    if !exact.is_empty() || name.len() < 2 {
        return exact;
    }
    units(&|prefix, unit| name.to_lowercase() == format!("{prefix}{unit}").to_lowercase())
}

/// An exponent of a unit; none has more than two digits.
fn exponent(text: &str) -> Option<i32> {
    text.parse::<i8>().ok().map(i32::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_in_every_notation() {
        for (texts, unit) in [
            (&["s", "sec", "seconds", "SEC", "10^0 s"][..], (Q::TIME, 1.0)),
            (&["min", "Min", "minutes", "minute", "mins", "min."], (Q::TIME, 60.0)),
            (&["h", "hr", "hour", "hours"], (Q::TIME, 3600.0)),
            (&["week", "weeks"], (Q::TIME, 604_800.0)),
            (&["cm2/dyn", "dyn^-1 cm^2", "cm²/dyn"], (Q::COMPLIANCE, 10.0)),
            (&["1/kbar", "kbar^-1"], (Q::COMPLIANCE, 1e-8)),
            (&["TPa^-1", "µm²/N"], (Q::COMPLIANCE, 1e-12)),
            (&["µs", "μs", "us", "10⁻⁶ s", "1e-6 s"], (Q::TIME, 1e-6)),
            (&["rad/s", "rad s^-1", "rad·s⁻¹", "1/s", "s^-1"], (Q::FREQUENCY, 1.0)),
            (&["Hz", "HZ", "hertz", "1/s", "s⁻¹"], (Q::FREQUENCY, TAU)),
            (&["kHz"], (Q::FREQUENCY, 1e3 * TAU)),
            (&["ms"], (Q::TIME, 1e-3)),
            (&["Pa", "N/m2", "N/m^2", "N m^-2"], (Q::MODULUS, 1.0)),
            (&["dyn/cm^2"], (Q::MODULUS, 0.1)),
            (&["Pa^-1", "Pa-1", "m²/N", "m^2 N^-1", "1/(Pa)"], (Q::COMPLIANCE, 1.0)),
            (&["GPa", "gpa", "10^9 Pa", "1E9 Pa", "10⁹·Pa"], (Q::MODULUS, 1e9)),
            (&["MPa", "mpa", "N/mm^2", "N/mm²", "10^6 Pa"], (Q::MODULUS, 1e6)),
            (
                &["1/GPa", "GPa^-1", "GPa⁻¹", "/GPa", "1 / GPa", "10^-9/Pa", "10^{-9} 1/Pa", "1e-9 1/Pa", "1/(GPa)"],
                (Q::COMPLIANCE, 1e-9),
            ),
            (&["1/MPa", "mm²/N", "mm2/N", "MPa-1", "10^-6 1/Pa", "10⁻⁶/Pa"], (Q::COMPLIANCE, 1e-6)),
            (&["nm", "10^-9 m"], (Q::LENGTH, 1e-9)),
            (&["Å", "A", "\u{212b}"], (Q::LENGTH, 1e-10)),
            (&["µm", "μm", "um", "micron"], (Q::LENGTH, 1e-6)),
            (&["pN"], (Q::FORCE, 1e-12)),
            (&["°", "deg"], (Q::ANGLE, TAU / 360.0)),
            (&["K", "°C", "C"], (Q::TEMPERATURE, 1.0)),
        ] {
            for text in texts {
                let readings = readings(text);
                let found = readings.iter().any(|reading| reading.0 == unit.0 && same(reading.1, unit.1));
                assert!(found, "{text}: {readings:?}");
            }
            let (quantity, size) = unit;
            assert!(
                self::readings(&name(quantity, size)).iter().any(|&(q, s)| q == quantity && same(s, size)),
                "{}",
                name(quantity, size)
            );
        }
        for text in ["", "%", "t", "S", "H", "1", "10^", "%", "N/m", "-", "5 MPa", "1 Hz", "ω", "m s", "1/K"] {
            assert_eq!(readings(text), [], "{text}");
        }
        // powers of no unit
        for text in ["Pa^2000000000", "1/10^-2147483648", "10^400 Pa", "Pa^128"] {
            assert_eq!(readings(text), [], "{text}");
        }
        assert_eq!(name(Q::TIME, 7.0), "7e0 s");
    }
}
