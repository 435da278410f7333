//! Headers of entries that are found by their keys.

use super::{entry, missing};
use crate::error::{Error, Result};
use crate::input::number;

/// Returns the value of an entry by its key.
type Find<'a> = Box<dyn Fn(&str) -> Option<&'a str> + 'a>;

/// The entries of a header.
pub(super) struct Header<'a> {
    format: &'static str,
    find: Find<'a>,
}

impl<'a> Header<'a> {
    /// A header whose entries `find` returns by their keys.
    pub(super) fn new(format: &'static str, find: impl Fn(&str) -> Option<&'a str> + 'a) -> Header<'a> {
        Header { format, find: Box::new(find) }
    }

    /// A header of lines `key = value`.
    pub(super) fn of_lines(format: &'static str, lines: &'a str) -> Header<'a> {
        let entry = |line: &'a str| {
            let line = line.trim();
            let end = line.find(|c: char| c == '=' || c.is_whitespace())?;
            let value = line[end..].trim_start();
            Some((&line[..end], value.strip_prefix('=').unwrap_or(value)))
        };
        let entries: Vec<_> = lines.lines().filter_map(entry).collect();
        Header::new(format, move |key| {
            entries.iter().find(|(name, _)| name.eq_ignore_ascii_case(key)).map(|(_, value)| *value)
        })
    }

    /// The value of the entry `key`, if it exists and is not empty.
    pub(super) fn get(&self, key: &'static str) -> Option<&'a str> {
        (self.find)(key).map(str::trim).filter(|value| !value.is_empty())
    }

    pub(super) fn require(&self, key: &'static str) -> Result<&'a str> {
        self.get(key).ok_or_else(|| missing(self.format, key))
    }

    /// The error of an entry that has another value than allowed.
    pub(super) fn error(&self, key: &'static str, text: &str, allowed: &'static str) -> Error {
        entry(self.format, key, text, allowed)
    }

    /// Accepts a header whose entry `key` is `allowed`.
    pub(super) fn must_be(&self, key: &'static str, allowed: &'static str) -> Result<()> {
        self.one_of(key, &[allowed], allowed).map(|_| ())
    }

    /// The value of an entry, which must be one of `values`.
    pub(super) fn one_of(&self, key: &'static str, values: &[&str], allowed: &'static str) -> Result<&'a str> {
        let text = self.require(key)?;
        if values.contains(&text) { Ok(text) } else { Err(self.error(key, text, allowed)) }
    }

    /// A whole number. The grid checks the range of numbers of cells.
    pub(super) fn count(&self, key: &'static str) -> Result<usize> {
        let text = self.require(key)?;
        text.parse().map_err(|_| self.error(key, text, "a whole number"))
    }

    pub(super) fn finite(&self, key: &'static str) -> Result<f64> {
        let text = self.require(key)?;
        let found = number(text, false).ok_or_else(|| self.error(key, text, "a number with a decimal point"))?;
        if found.is_finite() { Ok(found) } else { Err(self.error(key, text, "finite")) }
    }

    pub(super) fn positive(&self, key: &'static str) -> Result<f64> {
        let found = self.finite(key)?;
        if found > 0.0 { Ok(found) } else { Err(self.error(key, self.require(key)?, "> 0")) }
    }
}
