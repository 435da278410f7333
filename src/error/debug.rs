//! `Debug` of the errors: the message and its causes.

use std::error::Error as _;
use std::fmt;

use super::Error;

/// The message and its causes: a `main` that returns a [`Result`](crate::Result) prints errors so.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")?;
        let mut next = self.source();
        while let Some(cause) = next {
            write!(f, ": {cause}")?;
            next = cause.source();
        }
        Ok(())
    }
}
