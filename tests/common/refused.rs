//! What is refused, and by which name.

use viscocontact::ErrorKind;
use viscocontact::prelude::*;

/// The name of the value that is out of range or of the wrong length.
pub fn field<T>(refused: Result<T, Error>) -> &'static str {
    let error = refused.err().expect("an error");
    field_of(&error).unwrap_or_else(|| panic!("unexpected {error}"))
}

fn field_of(error: &Error) -> Option<&'static str> {
    match error {
        Error::OutOfRange { field, .. } | Error::CountOutOfRange { field, .. } | Error::WrongLength { field, .. } => {
            Some(field)
        }
        _ => None,
    }
}

/// A table of values that are refused: each row is an error, and the name of its value or words of its message.
pub fn refused<const N: usize>(rows: [(Option<Error>, &str); N]) {
    table(ErrorKind::Value, &rows);
}

/// A table of what is not covered, likewise.
pub fn not_covered<const N: usize>(rows: [(Option<Error>, &str); N]) {
    table(ErrorKind::Unsupported, &rows);
}

fn table(kind: ErrorKind, rows: &[(Option<Error>, &str)]) {
    for (row, (error, named)) in rows.iter().enumerate() {
        let error = error.as_ref().unwrap_or_else(|| panic!("row {row} is not refused: {named}"));
        assert_eq!(error.kind(), kind, "row {row}: {error}");
        let is_named = field_of(error).map_or_else(|| error.to_string().contains(named), |field| field == *named);
        assert!(is_named, "row {row}, {named}: {error}");
    }
}

/// An error of this code, whose message begins so.
pub fn says(error: &Error, code: &str, beginning: &str) {
    assert_eq!(error.code(), code, "{error}");
    assert!(error.to_string().starts_with(beginning), "{beginning}: {error}");
}
