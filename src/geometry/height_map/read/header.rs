//! Text headers of lines `key = value`.

use crate::error::{MapError, Result, positive};

/// The entries of a header.
#[derive(Debug)]
pub(super) struct Header<'a> {
    format: &'static str,
    entries: Vec<(&'a str, &'a str)>,
}

impl<'a> Header<'a> {
    pub(super) fn new(format: &'static str, lines: &'a str) -> Header<'a> {
        let entry = |line: &'a str| {
            let line = line.trim();
            let end = line.find(|c: char| c == '=' || c.is_whitespace())?;
            let value = line[end..].trim_start();
            Some((&line[..end], value.strip_prefix('=').unwrap_or(value).trim()))
        };
        Header { format, entries: lines.lines().filter_map(entry).collect() }
    }

    /// The value of the entry `key`, if it exists and is not empty.
    pub(super) fn get(&self, key: &'static str) -> Option<&'a str> {
        let &(_, value) = self.entries.iter().find(|(name, _)| name.eq_ignore_ascii_case(key))?;
        (!value.is_empty()).then_some(value)
    }

    fn require(&self, key: &'static str) -> Result<&'a str> {
        self.get(key).ok_or_else(|| MapError::Missing { format: self.format, key }.into())
    }

    pub(super) fn error(&self, key: &'static str, text: &str, allowed: &'static str) -> MapError {
        MapError::Entry { format: self.format, key, text: text.to_owned(), allowed }
    }

    /// A whole number. The grid checks the range of numbers of cells.
    pub(super) fn count(&self, key: &'static str) -> Result<usize> {
        let text = self.require(key)?;
        text.parse().map_err(|_| self.error(key, text, "a whole number").into())
    }

    /// A positive number.
    pub(super) fn positive(&self, key: &'static str) -> Result<f64> {
        let text = self.require(key)?;
        positive(key, text.parse().map_err(|_| self.error(key, text, "a number"))?)
    }
}
