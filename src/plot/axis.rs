//! Axes: their ticks, and the numbers on them.

use crate::plot::quantity::{scientific, superscript};
use crate::plot::sizes::SIZES;
use crate::plot::{Quantity, font};

/// An axis as drawn. Positions are fractions of its length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DrawnAxis {
    /// Name and unit.
    pub(super) label: String,
    /// Positions and texts of the numbers.
    pub(super) ticks: Vec<(f64, String)>,
    /// Positions of the ticks without numbers.
    pub(super) minor: Vec<f64>,
    /// The factor from SI to the unit of the label.
    factor: f64,
    /// The ends in the unit of the label; on a logarithmic axis their logarithms to base 10.
    ends: [f64; 2],
    logarithmic: bool,
}

/// How much space the numbers of an axis have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Room {
    /// Length of the axis in pixels.
    pub(super) length: f64,
    /// Whether the axis is horizontal.
    pub(super) horizontal: bool,
}

impl Room {
    /// The distance in pixels that ticks with these texts need.
    fn needed<'a>(self, texts: impl Iterator<Item = &'a str>) -> f64 {
        if self.horizontal {
            texts.map(|text| font::width(text, SIZES.numbers)).fold(0.0, f64::max) + 28.0
        } else {
            44.0
        }
    }
}

impl DrawnAxis {
    /// A linear axis between two values in SI. The unit, or a shared power of ten, is that for values up to `greatest`.
    pub(super) fn linear(quantity: &Quantity, greatest: f64, ends: [f64; 2], room: Room) -> DrawnAxis {
        let (label, factor) = shared_power(quantity.shown(greatest), greatest);
        let [low, high] = ends.map(|end| end * factor);
        let span = high - low;
        let mut ticks = Vec::new();
        for most in (1..=10).rev() {
            let step = round_step(span / f64::from(most));
            let decimals = (-(step.log10() + 1e-9).floor()).clamp(0.0, 17.0) as usize;
            let first = (low / step - 1e-6).ceil();
            let count = ((high / step + 1e-6).floor() - first).clamp(0.0, 20.0) as i32;
            let tick = |k: i32| {
                let value = (first + f64::from(k)) * step;
                let text = if value == 0.0 { "0".into() } else { format!("{value:.decimals$}").replace('-', "−") };
                ((value - low) / span, text)
            };
            ticks = (0..=count).map(tick).collect::<Vec<_>>();
            if room.needed(ticks.iter().map(|tick| tick.1.as_str())) <= step / span * room.length {
                break;
            }
        }
        DrawnAxis { label, ticks, minor: Vec::new(), factor, ends: [low, high], logarithmic: false }
    }

    /// A logarithmic axis between two values in SI. Numbers from 0.001 to 10 000 are written out, in a unit with a
    /// prefix if they are not so short without; others are powers of ten without a prefix.
    pub(super) fn logarithmic(quantity: &Quantity, ends: [f64; 2], room: Room) -> DrawnAxis {
        let powers = |factor: f64| ends.map(|end| (end * factor).log10());
        let is_plain = |factor: f64| powers(factor)[0].ceil() >= -3.0 && powers(factor)[1].floor() <= 4.0;
        let without = quantity.shown(0.0);
        let shown = [without.clone(), quantity.shown((ends[0] * ends[1]).sqrt())];
        let plain = shown.into_iter().find(|(_, factor)| is_plain(*factor));
        let is_short = plain.is_some();
        let (label, factor) = plain.unwrap_or(without);
        let [low, high] = powers(factor);
        let fraction = |exponent: f64| (exponent - low) / (high - low);
        let (first, last) = (low.ceil() as i32, high.floor() as i32);
        let number = |multiple: i32, k: i32| {
            let value = f64::from(multiple) * 10_f64.powi(k);
            if is_short { format!("{value:.*}", -k.min(0) as usize) } else { scientific(value, 0) }
        };
        let decade = |k: i32| (fraction(f64::from(k)), number(1, k));
        let multiples = |of: &[i32]| -> Vec<(f64, i32, i32)> {
            let all = (first - 1..=last).flat_map(|k| of.iter().map(move |&m| (k, m)));
            let placed = all.map(|(k, m)| (fraction(f64::from(k) + f64::from(m).log10()), m, k));
            placed.filter(|(at, ..)| (0.0..=1.0).contains(at)).collect()
        };
        let mut ticks: Vec<_> = (first..=last).map(decade).collect();
        let mut minor: Vec<f64> = multiples(&[2, 3, 4, 5, 6, 7, 8, 9]).iter().map(|tick| tick.0).collect();
        if ticks.len() <= 2 {
            // numbers at whole decades alone would be few
            ticks.extend(multiples(&[2, 5]).iter().map(|&(at, m, k)| (at, number(m, k))));
        }
        let per_decade = room.length / (high - low);
        let every = (room.needed(ticks.iter().map(|tick| tick.1.as_str())) / per_decade).ceil().max(1.0) as i32;
        if every > 1 && last - first > 1 {
            minor = ticks.iter().map(|tick| tick.0).collect();
            ticks = (first..=last).filter(|k| k.rem_euclid(every) == 0).map(decade).collect();
        } else if per_decade < 100.0 {
            minor.clear();
        }
        DrawnAxis { label, ticks, minor, factor, ends: [low, high], logarithmic: true }
    }

    /// The position of a value in SI.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        let shown = value * self.factor;
        let shown = if self.logarithmic { shown.log10() } else { shown };
        (shown - self.ends[0]) / (self.ends[1] - self.ends[0])
    }

    /// Width of the widest number in pixels.
    pub(super) fn widest(&self) -> f64 {
        self.ticks.iter().map(|tick| font::width(&tick.1, SIZES.numbers)).fold(0.0, f64::max)
    }
}

/// Moves a power of ten that all numbers share into the unit, where a prefix has not made them short already.
fn shared_power((label, factor): (String, f64), greatest: f64) -> (String, f64) {
    let shown = (greatest * factor).abs();
    if shown == 0.0 || (0.01..1e5).contains(&shown) {
        return (label, factor);
    }
    let power = 3 * ((shown.log10() + 1e-9).floor() as i32).clamp(-300, 300).div_euclid(3);
    let text = format!("10{}", superscript(power));
    let label = match label.rsplit_once('[') {
        Some((name, unit)) if label.ends_with(']') && unit.len() > 1 => format!("{name}[{text} {unit}"),
        _ => format!("{label} [{text}]"),
    };
    (label, factor * 10_f64.powi(-power))
}

/// The least of 1, 2 and 5 times a power of ten that is not below `least`.
pub(super) fn round_step(least: f64) -> f64 {
    let exponent = least.log10().floor();
    let power = 10_f64.powf(exponent);
    let multiple = [1.0, 2.0, 5.0].into_iter().find(|m| m * power >= 0.999_999 * least).unwrap_or(10.0);
    // a division is exact where a product is not: 3 / 10, not 3 * 0.1
    if exponent < 0.0 { multiple / 10_f64.powf(-exponent) } else { multiple * power }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACROSS: Room = Room { length: 1000.0, horizontal: true };
    const UP: Room = Room { length: 650.0, horizontal: false };

    fn linear(name: &str, unit: &str, ends: [f64; 2]) -> (String, String) {
        let quantity = if unit.is_empty() { Quantity::from(name) } else { Quantity::new(name, unit) };
        let axis = DrawnAxis::linear(&quantity, ends[0].abs().max(ends[1].abs()), ends, UP);
        let texts: Vec<&str> = axis.ticks.iter().map(|tick| tick.1.as_str()).collect();
        (axis.label.clone(), texts.join(" "))
    }

    fn logarithmic(ends: [f64; 2], room: Room) -> String {
        let axis = DrawnAxis::logarithmic(&"q".into(), ends, room);
        let texts: Vec<&str> = axis.ticks.iter().map(|tick| tick.1.as_str()).collect();
        texts.join(" ")
    }

    #[test]
    fn numbers_have_few_digits() {
        for (name, unit, ends, label, texts) in [
            ("q", "", [0.0, 0.7], "q", "0 0.1 0.2 0.3 0.4 0.5 0.6 0.7"),
            ("q", "m", [0.0, 2.5e-3], "q [mm]", "0 0.5 1.0 1.5 2.0 2.5"),
            ("q", "", [-1.0, 1.0], "q", "−1.0 −0.8 −0.6 −0.4 −0.2 0 0.2 0.4 0.6 0.8 1.0"),
            ("J", "1/Pa", [0.0, 4.0e-6], "J [10⁻⁶ 1/Pa]", "0 0.5 1.0 1.5 2.0 2.5 3.0 3.5 4.0"),
            ("J [1/Pa]", "", [0.0, 4.0e-6], "J [10⁻⁶ 1/Pa]", "0 0.5 1.0 1.5 2.0 2.5 3.0 3.5 4.0"),
            ("steps", "", [0.0, 2.0e5], "steps [10³]", "0 20 40 60 80 100 120 140 160 180 200"),
            (
                "q",
                "",
                [1.0, 1.0001],
                "q",
                "1.00000 1.00001 1.00002 1.00003 1.00004 1.00005 1.00006 1.00007 1.00008 1.00009 1.00010",
            ),
        ] {
            assert_eq!(linear(name, unit, ends), (label.to_owned(), texts.to_owned()), "{name} {unit} {ends:?}");
        }
    }

    #[test]
    fn logarithmic_axes_have_powers_of_ten() {
        assert_eq!(logarithmic([0.5e-3, 20.0], UP), "0.001 0.01 0.1 1 10");
        assert_eq!(logarithmic([0.5, 15.0], UP), "1 10 0.5 2 5");
        assert_eq!(logarithmic([1.5, 40.0], UP), "10 2 5 20");
        assert_eq!(logarithmic([0.5e-4, 20.0], UP), "10⁻⁴ 10⁻³ 10⁻² 10⁻¹ 10⁰ 10¹");
        assert_eq!(logarithmic([0.5e-5, 15e-5], UP), "10⁻⁵ 10⁻⁴ 5×10⁻⁶ 2×10⁻⁵ 5×10⁻⁵");
        // a prefix where the numbers are short with it alone
        let label = |unit, ends| DrawnAxis::logarithmic(&Quantity::new("q", unit), ends, UP).label;
        assert_eq!(label("m/s", [0.7e-8, 1.4e-3]), "q [µm/s]");
        assert_eq!(label("s", [0.7e-3, 14.0]), "q [s]");
        assert_eq!(label("s", [0.7e-3, 1.0e6]), "q [s]");
        // only as many as there is room for
        assert_eq!(logarithmic([1e-20, 1e20], ACROSS), "10⁻²⁰ 10⁻¹⁶ 10⁻¹² 10⁻⁸ 10⁻⁴ 10⁰ 10⁴ 10⁸ 10¹² 10¹⁶ 10²⁰");
        let axis = DrawnAxis::logarithmic(&"q".into(), [0.1, 1e3], UP);
        assert_eq!(axis.minor.len(), 32);
        assert!((axis.fraction(10.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn numbers_do_not_touch_each_other() {
        for span in [1.0, 3.7, 12.0, 1234.0, 8.8e4] {
            for length in [40.0, 200.0, 460.0, 1000.0] {
                let room = Room { length, horizontal: true };
                let axis = DrawnAxis::linear(&"q".into(), span, [-span, span], room);
                let ends: Vec<[f64; 2]> = axis
                    .ticks
                    .iter()
                    .map(|(at, text)| {
                        let half = 0.5 * font::width(text, SIZES.numbers);
                        [at * length - half, at * length + half]
                    })
                    .collect();
                assert!(ends.windows(2).all(|two| two[0][1] + 10.0 < two[1][0]) || ends.len() <= 3, "{span} {length}");
            }
        }
    }
}
