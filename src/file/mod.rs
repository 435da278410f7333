//! Files that are written completely or not at all, and files that grow by complete pieces.

use std::fs::{self, File, FileType};
use std::io;
use std::path::Path;

use crate::error::{Error, OutputError, Refusal, Result};

mod appending;
#[cfg(feature = "npy")]
pub(crate) mod npy;
mod part;

pub(crate) use appending::Appending;
pub(crate) use part::{Part, replace};

/// Opens a file for reading.
pub(crate) fn open(path: &Path) -> Result<File> {
    File::open(path).map_err(|error| unreadable(path.display().to_string(), error))
}

/// The error of reading a file.
pub(crate) fn unreadable(file: String, error: io::Error) -> Error {
    Error::Unreadable { file, reason: error.to_string(), kind: Some(error.kind()) }
}

/// The error of writing a file.
pub(crate) fn failed(path: &Path, cause: io::Error) -> Error {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    let cause = match folder {
        Some(folder) if cause.kind() == io::ErrorKind::NotFound => {
            io::Error::new(cause.kind(), format!("the folder {} does not exist: create it first", folder.display()))
        }
        _ => cause,
    };
    OutputError::new(path, cause).into()
}

/// What a file would hold, in memory.
#[cfg(any(feature = "checkpoint", feature = "npy", feature = "plot"))]
pub(crate) fn in_memory(write: impl FnOnce(&mut io::Cursor<Vec<u8>>) -> io::Result<()>) -> Result<Vec<u8>> {
    let mut out = io::Cursor::new(Vec::new());
    write(&mut out).map(|()| out.into_inner()).map_err(|error| failed(Path::new("bytes in memory"), error))
}

/// Writes numbers in little-endian order.
pub(crate) fn write_numbers(out: &mut impl io::Write, mut values: impl Iterator<Item = f64>) -> io::Result<()> {
    values.try_for_each(|value| out.write_all(&value.to_le_bytes()))
}

/// Rejects a path at which there is something other than a regular file, or a link to one.
pub(crate) fn check_regular(path: &Path) -> Result<()> {
    let kind = match fs::metadata(path) {
        Ok(found) if found.is_file() => return Ok(()),
        Ok(found) => kind(found.file_type()),
        Err(error) if error.kind() == io::ErrorKind::NotFound && path.is_symlink() => "a symbolic link to nothing",
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(failed(path, error)),
    };
    let what = format!("{} cannot be written: it is {kind}, not a regular file", path.display());
    Err(Refusal::file("not_a_file", what, "; give the path of a file").into())
}

fn kind(found: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kinds = [
            (found.is_fifo(), "a pipe"),
            (found.is_socket(), "a socket"),
            (found.is_char_device() || found.is_block_device(), "a device"),
        ];
        if let Some((_, kind)) = kinds.into_iter().find(|(is, _)| *is) {
            return kind;
        }
    }
    if found.is_dir() { "a folder" } else { "a special file" }
}
