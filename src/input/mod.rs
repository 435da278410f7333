//! Text files as instruments and programs write them: encodings, lines, headings with units, columns, numbers.
//!
//! Readers of one kind of data ([`Measurements::from_csv`](crate::rheology::Measurements::from_csv)) use a [`TextTable`], which
//! they also accept; so do other crates, by [`TextTable::find`].

mod column;
mod encoding;
mod format;
mod heading;
mod lines;
mod table;
mod unit;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, FileError, Result};

pub use column::{TableRow, TakenColumn, WantedColumn};
pub(crate) use encoding::by_lines;
pub use format::{Delimiter, TextFormat};
pub(crate) use heading::{UnitOf, symbol};
pub(crate) use lines::{Text, TextRow, number};
pub use table::TextTable;
pub use unit::Quantity;
pub(crate) use unit::{name, readings, same};

pub(crate) fn open(path: &Path) -> Result<File> {
    File::open(path).map_err(|error| unreadable(path.display().to_string(), error))
}

/// All bytes of a reader. `name` stands for the file in errors.
pub(crate) fn bytes(mut reader: impl Read, name: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes).map_err(|error| unreadable(name.to_owned(), error))?;
    Ok(bytes)
}

fn unreadable(file: String, error: io::Error) -> Error {
    Error::File(FileError::Unreadable { file, reason: error.to_string(), kind: Some(error.kind()) })
}
