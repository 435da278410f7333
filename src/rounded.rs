//! Numbers as people want to read them.

use std::fmt;

/// Decimals, in scientific notation, of a time in a message: times are sums of steps, whose last digits are rounding.
pub(crate) const TIME: usize = 11;

/// A number as a person would write it: 0.25 and 143.4, but 4e-11.
#[derive(Clone, Copy)]
pub(crate) struct Rounded(f64);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Rounded(value) = *self;
        let short = value == 0.0 || !value.is_finite() || (1e-3..1e6).contains(&value.abs());
        if short { write!(f, "{value}") } else { write!(f, "{value:e}") }
    }
}

/// The nearest number with so many decimals in scientific notation.
pub(crate) fn rounded(value: f64, decimals: usize) -> Rounded {
    Rounded(nearest(value, decimals))
}

fn nearest(value: f64, decimals: usize) -> f64 {
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}

/// A value out of range without the noise of its last digits, unless they are all that puts it out of the range:
/// where the rounded value is a limit that `allowed` names, or where `allowed` names none.
pub(crate) fn without_noise(value: f64, allowed: &str) -> f64 {
    let short = nearest(value, TIME);
    let of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | 'e');
    let mut limits = allowed.split(|c| !of_number(c)).filter_map(|word| word.parse::<f64>().ok()).peekable();
    if limits.peek().is_some() && limits.all(|limit| limit != short) { short } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_shown_where_it_decides() {
        assert_eq!(without_noise(0.1 + 0.2, "in [1e-13, 0.1]"), 0.3);
        assert_eq!(without_noise(0.5_f64.next_up(), "in (-1, 0.5]"), 0.5_f64.next_up());
        assert_eq!(without_noise(-1.0e-320, "finite and >= 0"), -1.0e-320);
        assert_eq!(without_noise(0.1 + 0.2, "finite and >= the shortest wavelength"), 0.1 + 0.2);
        assert!(without_noise(f64::NAN, "finite, > 0 and at most 1e300 m").is_nan());
    }

    #[test]
    fn sums_of_steps_lose_their_last_digits() {
        let text = |value, decimals| rounded(value, decimals).to_string();
        assert_eq!([text(0.1 + 0.2, TIME), text(1.0e-12, TIME), text(4.0e-11, 3)], ["0.3", "1e-12", "4e-11"]);
        assert_eq!([text(-123_456.789, 5), text(1.434_372e2, 3), text(0.0, 5)], ["-123457", "143.4", "0"]);
        assert_eq!([text(f64::INFINITY, TIME), text(f64::NAN, TIME)], ["inf", "NaN"]);
    }
}
