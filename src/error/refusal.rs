//! Errors that differ only in their message. A new one needs no variant: it gets a code of its own where it is made
//! ([`Refusal::value`] and its sisters), and is provoked in `tests/io/codes.rs`.

use std::fmt;
use std::io;

use super::ErrorKind;

/// What cannot be done, and what to do: [`Error::code`](crate::Error::code) names it.
#[derive(Clone, PartialEq)]
pub struct Refusal(pub(super) Box<Parts>);

#[derive(Clone, PartialEq)]
pub(super) struct Parts {
    pub(super) kind: ErrorKind,
    pub(super) code: &'static str,
    message: String,
    /// Where the remedy begins in the message.
    remedy: usize,
    pub(super) name: Option<&'static str>,
    pub(super) value: Option<f64>,
    pub(super) allowed: Option<&'static str>,
    pub(super) io_kind: Option<io::ErrorKind>,
}

impl Refusal {
    /// A refusal that says `what` and then the `remedy`, which begins with a colon or a semicolon.
    fn new(kind: ErrorKind, code: &'static str, what: impl Into<String>, remedy: &str) -> Refusal {
        let message = what.into() + remedy;
        let remedy = message.len() - remedy.trim_start_matches([':', ';', ' ']).len();
        let (name, value, allowed, io_kind) = (None, None, None, None);
        Refusal(Box::new(Parts { kind, code, message, remedy, name, value, allowed, io_kind }))
    }

    /// Of a value.
    pub(crate) fn value(code: &'static str, what: impl Into<String>, remedy: &str) -> Refusal {
        Refusal::new(ErrorKind::Value, code, what, remedy)
    }

    /// Of a file.
    pub(crate) fn file(code: &'static str, what: impl Into<String>, remedy: &str) -> Refusal {
        Refusal::new(ErrorKind::File, code, what, remedy)
    }

    /// Of a search that does not converge.
    pub(crate) fn search(code: &'static str, what: impl Into<String>, remedy: &str) -> Refusal {
        Refusal::new(ErrorKind::Convergence, code, what, remedy)
    }

    /// Of what is not covered.
    pub(crate) fn unsupported(code: &'static str, what: impl Into<String>, remedy: &str) -> Refusal {
        Refusal::new(ErrorKind::Unsupported, code, what, remedy)
    }

    /// The same with the name of what is wrong.
    pub(crate) fn naming(mut self, name: &'static str) -> Refusal {
        self.0.name = Some(name);
        self
    }

    /// The same with its value.
    pub(crate) fn valued(mut self, value: f64) -> Refusal {
        self.0.value = Some(value);
        self
    }

    /// The same with the values allowed.
    pub(crate) fn allowing(mut self, allowed: &'static str) -> Refusal {
        self.0.allowed = Some(allowed);
        self
    }

    /// The same with the values allowed, as the end of its message.
    pub(crate) fn must_be(mut self, allowed: &'static str) -> Refusal {
        self.0.message += &format!(": it must be {allowed}");
        self.0.remedy = self.0.message.len();
        self.allowing(allowed)
    }

    /// The same of an error of the system.
    pub(crate) fn of_system(mut self, kind: io::ErrorKind) -> Refusal {
        self.0.io_kind = Some(kind);
        self
    }

    /// What to do, if it says so.
    pub(super) fn remedy(&self) -> Option<&str> {
        Some(&self.0.message[self.0.remedy..]).filter(|remedy| !remedy.is_empty())
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.message)
    }
}

/// The message.
impl fmt::Debug for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl std::error::Error for Refusal {}
