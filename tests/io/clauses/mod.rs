//! Eighty clauses under `# Errors`, drawn at random from the pages of the public interface (the eightieth, of a picture of a fit, is tested with the
//! package for identification): each row provokes one of them, and compares kind and message: the name, the value, the allowed range, what to do.

mod contacts;
mod data;
mod identify;
mod materials;
mod results;
mod shapes;

use std::collections::BTreeSet;
use std::error::Error as StdError;

use viscocontact::rheology::laws::Violation;
use viscocontact::{Error, ErrorKind, TextError};

/// An error of any interface.
trait Answer: StdError {
    fn kind(&self) -> ErrorKind;
}

impl Answer for Error {
    fn kind(&self) -> ErrorKind {
        Error::kind(self)
    }
}

impl Answer for TextError {
    fn kind(&self) -> ErrorKind {
        Error::from(self.clone()).kind()
    }
}

impl Answer for Violation {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

impl Answer for viscocontact_identify::Error {
    fn kind(&self) -> ErrorKind {
        match self {
            viscocontact_identify::Error::Contact(error) => error.kind(),
            viscocontact_identify::Error::NotConverged { .. } => ErrorKind::Convergence,
            _ => ErrorKind::Value,
        }
    }
}

/// What was provoked.
#[derive(Default)]
struct Table {
    clauses: BTreeSet<&'static str>,
    rows: usize,
    wrong: Vec<String>,
}

impl Table {
    /// A provocation of a clause; of the message with its causes `says` has the parts, with … between, and → for "is not allowed: it must be".
    fn row<T, E: Answer>(&mut self, clause: &'static str, outcome: Result<T, E>, kind: ErrorKind, says: &str) {
        self.clauses.insert(clause);
        self.rows += 1;
        let Err(error) = outcome else { return self.wrong.push(format!("{clause}: accepted, not {says}")) };
        let (mut text, mut source) = (error.to_string(), error.source());
        while let Some(cause) = source {
            text += &format!(": {cause}");
            source = cause.source();
        }
        let mut rest = &text[..];
        let is_said = says.replace('→', "is not allowed: it must be").split('…').enumerate().all(|(k, part)| {
            let at = rest.find(part).filter(|at| k > 0 || *at == 0);
            rest = at.map_or("", |at| &rest[at + part.len()..]);
            at.is_some()
        });
        if error.kind() != kind || !is_said {
            self.wrong.push(format!("{clause}: {:?}: {text}\n    not {kind:?}: {says}", error.kind()));
        }
    }
}

#[test]
fn clauses_of_errors_are_kept() {
    let mut table = Table::default();
    for rows in [contacts::rows, data::rows, identify::rows, materials::rows, results::rows, shapes::rows] {
        rows(&mut table);
    }
    assert!(table.wrong.is_empty(), "{} of {} rows:\n{}", table.wrong.len(), table.rows, table.wrong.join("\n"));
    assert_eq!(table.clauses.len(), 81);
}
