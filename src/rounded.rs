//! Numbers as people want to read them.

/// Decimals, in scientific notation, of a time in a message: times are sums of steps, whose last digits are rounding.
pub(crate) const TIME: usize = 11;

/// The nearest number with so many decimals in scientific notation.
pub(crate) fn rounded(value: f64, decimals: usize) -> f64 {
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_steps_lose_their_last_digits() {
        assert_eq!(rounded(0.1 + 0.2, TIME).to_string(), "0.3");
        assert_eq!(rounded(1.0e-12, TIME), 1.0e-12);
        assert_eq!(rounded(-123_456.789, 5), -123_457.0);
        assert_eq!(rounded(f64::INFINITY, TIME), f64::INFINITY);
        assert!(rounded(f64::NAN, TIME).is_nan());
    }
}
