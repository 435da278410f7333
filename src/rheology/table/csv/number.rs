//! Numbers with decimal points or commas, and with exponents `e` or `d`.

use crate::error::TableError;

/// Reads the numbers of a table, which all have decimal points or all decimal commas.
#[derive(Debug, Default)]
pub(super) struct Numbers {
    point: bool,
    comma: bool,
    /// The error for the first number that may have a thousands separator.
    thousands: Option<TableError>,
}

impl Numbers {
    /// The number in a field; the exponent follows an `e`, or a `d` as in Fortran.
    pub(super) fn read(&mut self, line: u64, column: usize, text: &str) -> Result<f64, TableError> {
        let ambiguous = |readings| TableError::Ambiguous { line, column, text: shortened(text), readings };
        let number = parse(text).ok_or_else(|| TableError::NotNumeric { line, column, text: shortened(text) })?;
        if let Some((whole, decimals)) = text.split_once(',') {
            let group = decimals.len() == 3 && decimals.bytes().all(|byte| byte.is_ascii_digit());
            let whole = whole.trim_start_matches(['+', '-']);
            if self.point {
                return Err(ambiguous("a decimal comma or a thousands separator beside decimal points"));
            } else if group && whole.len() <= 3 && !whole.starts_with('0') {
                self.thousands.get_or_insert(ambiguous("a decimal comma or a thousands separator"));
            } else {
                self.comma = true;
            }
        } else if text.contains('.') {
            if self.comma {
                return Err(ambiguous("a decimal point or a thousands separator beside decimal commas"));
            }
            self.point = true;
        }
        match &self.thousands {
            Some(error) if self.point => Err(error.clone()),
            _ => Ok(number),
        }
    }

    /// Rejects numbers that may have a thousands separator, once all are read.
    pub(super) fn finish(self) -> Result<(), TableError> {
        self.thousands.filter(|_| !self.comma).map_or(Ok(()), Err)
    }
}

fn parse(text: &str) -> Option<f64> {
    let number = match text.split_once(',') {
        Some((whole, decimals)) => {
            let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
            let one = !text.contains('.') && digit(whole.chars().last()) && digit(decimals.chars().next());
            format!("{whole}.{}", one.then_some(decimals)?)
        }
        None => text.to_owned(),
    };
    number.parse().ok().or_else(|| {
        let (mantissa, exponent) = number.split_once(['d', 'D'])?;
        let complete = mantissa.ends_with(|c: char| c.is_ascii_digit() || c == '.');
        complete.then(|| format!("{mantissa}e{exponent}"))?.parse().ok()
    })
}

/// Whether a text is a finite number.
pub(super) fn plain(text: &str) -> bool {
    text.bytes().any(|byte| byte.is_ascii_digit()) && parse(text).is_some()
}

/// Whether a text is no heading: it is a number, resembles a number, or marks a missing value.
pub(super) fn resembles(text: &str) -> bool {
    const MISSING: [&str; 8] = ["na", "n/a", "null", "nil", "none", "-", "--", "?"];
    let begin = text.trim_start_matches(|c: char| !c.is_alphanumeric() && !"[(".contains(c));
    // 1/T begins with a digit, but is not a number
    let reciprocal = begin.strip_prefix("1/").is_some_and(|rest| rest.starts_with(char::is_alphabetic));
    let text = text.trim_matches(['(', ')']);
    let outside = text.split(['(', '[']).next().unwrap_or_default();
    let decimals = outside.as_bytes().windows(2).any(|pair| b".,".contains(&pair[0]) && pair[1].is_ascii_digit());
    parse(text).is_some()
        || MISSING.contains(&text.to_lowercase().as_str())
        || begin.starts_with(|c: char| c.is_ascii_digit()) && !reciprocal
        || decimals && outside.chars().filter(|c| c.is_alphabetic()).count() <= 2
}

/// Whether a row of two fields without quotes may also be one number with a decimal comma.
pub(super) fn one_decimal(row: &str) -> bool {
    let Some((whole, rest)) = row.trim().trim_start_matches(['+', '-']).split_once(',') else { return false };
    let (decimals, exponent) = rest.split_once(['e', 'E', 'd', 'D']).map_or((rest, None), |(d, e)| (d, Some(e)));
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    // with an exponent there is one digit before the comma
    let fits = exponent.is_none_or(|exponent| digits(exponent.trim_start_matches(['+', '-'])) && whole.len() == 1);
    digits(whole) && digits(decimals) && fits
}

/// A text, shortened for errors.
pub(super) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    if text.chars().count() <= MOST { text.to_owned() } else { text.chars().take(MOST).chain("…".chars()).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(texts: &[&str]) -> Result<Vec<f64>, TableError> {
        let mut numbers = Numbers::default();
        let read: Result<Vec<_>, _> = texts.iter().enumerate().map(|(k, text)| numbers.read(1, k + 1, text)).collect();
        read.and_then(|read| numbers.finish().map(|()| read))
    }

    #[test]
    fn numbers_are_read_in_every_notation() {
        assert_eq!(
            all(&["1", "-1.5", ".5", "+1e3", "1.D0", "2d-3", "1.5D+02"]).unwrap(),
            [1.0, -1.5, 0.5, 1e3, 1.0, 2e-3, 150.0]
        );
        assert_eq!(all(&["1", "1,5", "-0,25E-3", "1,500", "3,5D2"]).unwrap(), [1.0, 1.5, -0.25e-3, 1.5, 350.0]);
        for bad in ["", "<1", "1,5,2", "1.000,5", "1 000", "1e", "d5", "1d5d5", "1D", "O.5", "1,", ",5", "--1", "1e5,0"]
        {
            let error = all(&["1", bad]).unwrap_err();
            assert_eq!(error, TableError::NotNumeric { line: 1, column: 2, text: bad.into() });
        }
    }

    #[test]
    fn thousands_separators_are_not_decimals() {
        for (texts, at) in [
            (&["1,000", "2,500"][..], 1),
            (&["1,000", "2.5"], 1),
            (&["2.5", "1,000"], 2),
            (&["1,5", "1.000"], 2),
            (&["7", "-12,345"], 2),
        ] {
            let error = all(texts).unwrap_err();
            assert!(matches!(&error, TableError::Ambiguous { column, .. } if *column == at), "{texts:?}: {error}");
        }
    }

    #[test]
    fn headings_do_not_resemble_numbers() {
        for heading in ["time", "t [s]", "J [1/Pa]", "E1", "G' (23.5 °C)", "1/T", "[1/Pa]", "(1/Pa)", "T1", "", "10^-3"]
        {
            assert_eq!(resembles(heading), heading == "10^-3", "{heading}");
        }
        for number in
            ["1,5", "1D0", "<1", "≤ 0.5", "~3", "O.5", "-", "n/a", "NaN", "inf", "(1.5)", "+-1", "1e", "5 Pa", "$1"]
        {
            assert!(resembles(number), "{number}");
        }
    }

    #[test]
    fn two_fields_may_be_one_number_with_a_decimal_comma() {
        for row in ["1,5", "-10,25", "1,5e-9", " 1,5D3 "] {
            assert!(one_decimal(row), "{row}");
        }
        for row in ["1", "1.5,2", "1,2.5", "10,2e-9", "1, 5", "1,-5", "1,5,2", "\"1\",\"5\"", "1,5e"] {
            assert!(!one_decimal(row), "{row}");
        }
    }
}
