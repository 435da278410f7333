//! What a refused value is called.

use viscocontact::prelude::*;

/// The name of the value that is out of range or of the wrong length.
pub fn field<T>(refused: Result<T, Error>) -> &'static str {
    match refused.err().expect("an error") {
        Error::OutOfRange { field, .. } | Error::CountOutOfRange { field, .. } | Error::WrongLength { field, .. } => {
            field
        }
        other => panic!("unexpected {other}"),
    }
}
