//! Quantities of axes, and their numbers in units with a suitable prefix.

use crate::error::{Result, within};

/// The quantity of an axis or a colour bar.
///
/// A quantity with a unit is given in SI and shown with the prefix for which its maximum value lies between 1 and
/// 1000 (areas from 0.1, volumes from 0.01 on): `approach [µm]`, `contact area [mm²]`. Lengths, times and angles get
/// no prefix above 1 (`km`, `ks`). Units that have a prefix already, or take none (`kg`, `%`, `1/Pa`, `°C`), are not
/// changed. A plain text is a quantity without a unit. Values that still have many digits get a shared power of ten:
/// `J [10⁻⁶ 1/Pa]`.
///
/// ```
/// use viscocontact::plot::Quantity;
///
/// assert_eq!(Quantity::new("pressure", "Pa").shown(2.5e4), ("pressure [kPa]".to_string(), 1e-3));
/// assert_eq!(Quantity::new("contact area", "m²").shown(3.0e-6), ("contact area [mm²]".to_string(), 1e6));
/// assert_eq!(Quantity::from("t / τ").shown(1e4), ("t / τ".to_string(), 1.0));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Quantity {
    name: String,
    unit: Option<String>,
}

/// SI prefixes in steps of a thousand, from 1e-24 on.
const PREFIXES: [&str; 15] = ["y", "z", "a", "f", "p", "n", "µ", "m", "", "k", "M", "G", "T", "P", "E"];
/// Steps below the unit in [`PREFIXES`].
const STEPS_BELOW_UNIT: i32 = 8;

/// Symbols that take prefixes below 1 alone.
const SMALL_PREFIXES: [&str; 3] = ["m", "s", "rad"];
/// Symbols that take all prefixes.
const ALL_PREFIXES: [&str; 7] = ["Pa", "N", "J", "W", "Hz", "V", "A"];

impl Quantity {
    /// The quantity `name`, whose values are in the SI unit `unit`.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Quantity {
        Quantity { name: name.into(), unit: Some(unit.into()) }
    }

    /// The label for values up to `maximum` in magnitude, in SI, and the factor from SI to the unit of the label. If
    /// `maximum` is zero or not finite, the unit has no prefix.
    pub fn shown(&self, maximum: f64) -> (String, f64) {
        let Some(unit) = &self.unit else { return (self.name.clone(), 1.0) };
        let (prefix, factor) = prefix(unit, maximum.abs()).unwrap_or(("", 1.0));
        (format!("{} [{prefix}{unit}]", self.name), factor)
    }
}

impl<T: Into<String>> From<T> for Quantity {
    fn from(name: T) -> Quantity {
        Quantity { name: name.into(), unit: None }
    }
}

/// The prefix for a unit and the factor that values are multiplied by; `None` if the unit takes none.
fn prefix(unit: &str, greatest: f64) -> Option<(&'static str, f64)> {
    if !(greatest > 0.0 && greatest.is_finite()) {
        return None;
    }
    let letters = unit.find(|c: char| !c.is_alphabetic()).unwrap_or(unit.len());
    let (symbol, rest) = unit.split_at(letters);
    let above = ALL_PREFIXES.contains(&symbol);
    if !above && !SMALL_PREFIXES.contains(&symbol) {
        return None;
    }
    // a prefix is raised to the power of its unit
    let power = match rest.chars().next() {
        Some('²') => 2,
        Some('³') => 3,
        Some('2' | '3' | '^' | '⁴' | '⁻') => return None,
        _ => 1,
    };
    // 999.99999 counts as 1000, which it would be rounded to
    // 0.4 mm² rather than 400 000 µm²
    let tens = (greatest.log10() + 1e-9).floor() as i32 + power - 1;
    let steps = tens.div_euclid(3 * power).min(if above { i32::MAX } else { 0 });
    let prefix = PREFIXES.get(usize::try_from(steps + STEPS_BELOW_UNIT).ok()?)?;
    Some((prefix, 10f64.powi(-3 * steps * power)))
}

/// Maximum magnitude that a picture can show.
const MAX_DRAWABLE: f64 = 1e100;

/// Accepts values that a picture can show.
pub(super) fn drawable(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, value.abs() <= MAX_DRAWABLE, "finite and at most 1e100 in magnitude")
}

/// Accepts a colour scale that a picture can show.
pub(super) fn color_scale([low, high]: [f64; 2]) -> Result<()> {
    drawable("lower end of the colour scale", low)?;
    let upper = "upper end of the colour scale";
    within(upper, drawable(upper, high)?, high > low, "above the lower end").map(drop)
}

/// Accepts values that a logarithmic axis can show.
pub(super) fn drawable_as_power(field: &'static str, value: f64) -> Result<f64> {
    let inside = (1.0 / MAX_DRAWABLE..=MAX_DRAWABLE).contains(&value);
    within(field, value, inside, "in [1e-100, 1e100] on a logarithmic axis")
}

/// A value in SI with its unit and a suitable prefix, to four digits and all digits before the point: for titles and
/// legends.
///
/// ```
/// assert_eq!(viscocontact::plot::measure(4.1237e-4, "s"), "412.4 µs");
/// ```
pub fn measure(value: f64, unit: &str) -> String {
    let (prefix, factor) = prefix(unit, value.abs()).unwrap_or(("", 1.0));
    let number = value * factor;
    if number != 0.0 && prefix.is_empty() && number.abs() < 1e-3 {
        return format!("{} {unit}", scientific(number, 3));
    }
    let decimals = if number == 0.0 { 0.0 } else { (3.0 - number.abs().log10().floor()).clamp(0.0, 12.0) };
    format!("{} {prefix}{unit}", shortened(&format!("{number:.*}", decimals as usize)))
}

/// A number as digits, so many of them `decimals`, and a power of ten: `5×10⁻²`, `10⁻²`.
pub(super) fn scientific(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$e}");
    let Some((digit, exponent)) = text.split_once('e') else { return text };
    let power = format!("10{}", superscript(exponent.parse().unwrap_or(0)));
    let digit = shortened(digit);
    if digit == "1" { power } else { format!("{digit}×{power}") }
}

/// An exponent: −3 as ⁻³.
pub(super) fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]);
    exponent.to_string().chars().map(raised).collect()
}

/// A number without trailing zeros, without the sign of a negative zero, and with a minus instead of a hyphen.
pub(super) fn shortened(text: &str) -> String {
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text };
    if short == "-0" { "0".into() } else { short.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_keep_numbers_short() {
        for (unit, greatest, label, factor) in [
            ("m", 2.0e-3, "q [mm]", 1e3),
            ("m", 0.99e-3, "q [µm]", 1e6),
            ("m", 5.0e3, "q [m]", 1.0),
            ("Pa", 1.0e6, "q [MPa]", 1e-6),
            ("Pa", 999.0e3, "q [kPa]", 1e-3),
            ("m²", 0.4e-6, "q [mm²]", 1e6),
            ("m²", 0.4e-7, "q [µm²]", 1e12),
            ("m³", 2.0e-9, "q [mm³]", 1e9),
            ("m/s", 0.02, "q [mm/s]", 1e3),
            ("N m", -2.0e-5, "q [µN m]", 1e6),
            ("1/Pa", 1e-6, "q [1/Pa]", 1.0),
            ("kg", 1e-6, "q [kg]", 1.0),
            ("m^2", 1e-6, "q [m^2]", 1.0),
            ("J", 0.0, "q [J]", 1.0),
            ("J", f64::INFINITY, "q [J]", 1.0),
            ("J", 1e-90, "q [J]", 1.0),
        ] {
            let (text, by) = Quantity::new("q", unit).shown(greatest);
            assert_eq!(text, label, "{greatest} {unit}");
            assert!((by / factor - 1.0).abs() < 1e-12, "{greatest} {unit}");
        }
        for (value, unit, text) in [
            (4.1237e-11, "1/Pa", "4.124×10⁻¹¹ 1/Pa"),
            (-4.0e-13, "1/Pa", "−4×10⁻¹³ 1/Pa"),
            (0.0, "1/Pa", "0 1/Pa"),
            (1e-30, "s", "10⁻³⁰ s"),
            (2.5e-3, "kg", "0.0025 kg"),
        ] {
            assert_eq!(measure(value, unit), text);
        }
    }
}
