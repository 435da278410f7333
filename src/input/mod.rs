//! Files that are read as a whole: opening, reading, and tables in text files.

mod text;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, FileError, Result};

pub(crate) use text::shortened;
pub use text::{Delimiter, TextFormat};
pub(crate) use text::{TextRow, TextTable};

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
