//! Checks of arguments.

use super::{Error, Refusal, Result};

/// Accepts finite values above zero.
pub(crate) fn positive(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, value > 0.0, "finite and > 0")
}

/// Accepts finite values of zero or more.
pub(crate) fn non_negative(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, value >= 0.0, "finite and >= 0")
}

/// Accepts lengths above zero whose multiples and sums do not overflow.
pub(crate) fn length(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, value > 0.0 && value <= LONGEST, "finite, > 0 and at most 1e300 m")
}

/// Maximum length of a shape, and maximum height of a map \[m\].
pub(crate) const LONGEST: f64 = 1e300;

/// Accepts Poisson's ratios of stable bodies.
pub(crate) fn poisson_ratio(field: &'static str, nu: f64) -> Result<f64> {
    within(field, nu, nu > -1.0 && nu <= 0.5, "in (-1, 0.5]")
}

/// Accepts any finite value.
pub(crate) fn finite(field: &'static str, value: f64) -> Result<f64> {
    within(field, value, true, "finite")
}

/// Accepts finite values for which `inside` holds.
pub(crate) fn within(field: &'static str, value: f64, inside: bool, allowed: &'static str) -> Result<f64> {
    if value.is_finite() && inside { Ok(value) } else { Err(Error::OutOfRange { field, value, allowed }) }
}

/// Accepts a count for which `inside` holds.
pub(crate) fn count_within(field: &'static str, value: usize, inside: bool, allowed: &'static str) -> Result<()> {
    if inside { Ok(()) } else { Err(Error::CountOutOfRange { field, value, allowed }) }
}

/// Accepts values of which each `may_follow` the one before it.
pub(crate) fn in_order(
    field: &'static str,
    values: impl IntoIterator<Item = f64>,
    rule: &'static str,
    may_follow: impl Fn(f64, f64) -> bool,
) -> Result<()> {
    let mut before: Option<f64> = None;
    for (index, value) in values.into_iter().enumerate() {
        if let Some(previous) = before.filter(|&previous| !may_follow(previous, value)) {
            return Err(Error::OutOfOrder { field, index, value, previous, rule });
        }
        before = Some(value);
    }
    Ok(())
}

/// The error of a builder without a part that every contact needs.
pub(crate) fn missing(part: &'static str) -> Error {
    let message = format!("a contact needs {part}: call Builder::{part} before build");
    let (what, remedy) = message.split_at(message.find(':').unwrap_or(message.len()));
    Refusal::value("missing", what, remedy).naming(part).into()
}

/// The error of a snapshot that was taken of another contact.
pub(crate) fn of_other_contact() -> Error {
    let remedy = ": only snapshots of the contact or of a clone can be restored";
    Refusal::value("other_contact", "the snapshot was taken of another contact", remedy).into()
}

/// Accepts a slice of exactly `expected` values.
pub(crate) fn exact_length(field: &'static str, len: usize, expected: usize) -> Result<()> {
    if len == expected { Ok(()) } else { Err(Error::WrongLength { field, len, expected, exact: true }) }
}

/// Accepts a table of at least `least` entries.
pub(crate) fn least_length(field: &'static str, len: usize, least: usize) -> Result<()> {
    if len >= least { Ok(()) } else { Err(Error::WrongLength { field, len, expected: least, exact: false }) }
}
