//! Numbers as people want to read them.

/// Decimals, in scientific notation, of a time in a message: times are sums of steps, whose last digits are rounding.
pub(crate) const TIME: usize = 11;

/// The nearest number with so many decimals in scientific notation.
pub(crate) fn rounded(value: f64, decimals: usize) -> f64 {
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}

/// A value out of range without the noise of its last digits, unless they are all that puts it out of the range: where the rounded
/// value is a limit that `allowed` names, or where `allowed` names none.
pub(crate) fn without_noise(value: f64, allowed: &str) -> f64 {
    let short = rounded(value, TIME);
    let of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | 'e');
    let mut limits = allowed.split(|c| !of_number(c)).filter_map(|word| word.parse::<f64>().ok()).peekable();
    if limits.peek().is_some() && limits.all(|limit| limit != short) { short } else { value }
}

/// Two texts with the noise of the last digits of their numbers removed, if the texts still differ.
#[cfg(feature = "checkpoint")]
pub(crate) fn texts_without_noise(texts: [String; 2]) -> [String; 2] {
    let of_word = |word: &str| match word.parse::<f64>() {
        Ok(number) if word.len() > NOISY => format!("{:e}", rounded(number, SHOWN)),
        _ => word.to_owned(),
    };
    let short = texts.each_ref().map(|text| text.split(' ').map(of_word).collect::<Vec<_>>().join(" "));
    if short[0] == short[1] { texts } else { short }
}

/// Numbers of more characters than this have digits that nobody typed, ...
#[cfg(feature = "checkpoint")]
const NOISY: usize = 12;
/// ... of which so many decimals are shown.
#[cfg(feature = "checkpoint")]
const SHOWN: usize = 4;

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

    #[cfg(feature = "checkpoint")]
    #[test]
    fn texts_keep_the_digits_that_tell_them_apart() {
        let texts = |other: &str| texts_without_noise(["of 8.333333333333333e-5 m".into(), format!("of {other} m")]);
        assert_eq!(texts("1.25e-4"), ["of 8.3333e-5 m", "of 1.25e-4 m"]);
        assert_eq!(texts("8.333333333333334e-5")[1], "of 8.333333333333334e-5 m");
    }

    #[test]
    fn sums_of_steps_lose_their_last_digits() {
        assert_eq!(rounded(0.1 + 0.2, TIME).to_string(), "0.3");
        assert_eq!(rounded(1.0e-12, TIME), 1.0e-12);
        assert_eq!(rounded(-123_456.789, 5), -123_457.0);
        assert_eq!(rounded(f64::INFINITY, TIME), f64::INFINITY);
        assert!(rounded(f64::NAN, TIME).is_nan());
    }
}
