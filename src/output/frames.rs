//! The numbered files of a series.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::file::{check_regular, failed};
use crate::output::{Field, Metadata};

/// A folder of frames `frame_000000`, `frame_000001`, ... with the same fields and metadata in each.
#[derive(Debug)]
pub(super) struct Frames {
    pub(super) folder: PathBuf,
    extension: &'static str,
    /// Number of frames written.
    pub(super) written: usize,
    pub(super) metadata: Metadata,
    pub(super) fields: Vec<Field>,
    /// For fields that the contact does not store.
    pub(super) buffer: Vec<f64>,
}

impl Frames {
    /// Creates the folder if it does not exist. Frames of another run in it are removed if they are to be `replaced`, else the
    /// folder is refused.
    pub(super) fn create(
        folder: &Path,
        extension: &'static str,
        (metadata, fields): (&Metadata, &[Field]),
        replaced: bool,
    ) -> Result<Frames> {
        if let Some(k) = (1..fields.len()).find(|&k| fields[..k].contains(&fields[k])) {
            let reason = format!("the field {} is requested twice", fields[k].name());
            return Err(failed(folder, io::Error::new(io::ErrorKind::InvalidInput, reason)));
        }
        let unusable = |error: io::Error| failed(folder, error);
        fs::create_dir_all(folder).map_err(unusable)?;
        for entry in fs::read_dir(folder).map_err(unusable)? {
            let entry = entry.map_err(unusable)?;
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if !(name.starts_with("frame_") && name.ends_with(&format!(".{extension}"))) {
                continue;
            }
            if !replaced {
                let reason = format!("the folder contains {name} of another run");
                return Err(failed(folder, io::Error::new(io::ErrorKind::AlreadyExists, reason)));
            }
            check_regular(&entry.path())?;
            remove(&entry.path())?;
        }
        let (folder, metadata, fields) = (folder.to_owned(), metadata.clone(), fields.to_vec());
        Ok(Frames { folder, extension, written: 0, metadata, fields, buffer: Vec::new() })
    }

    /// Name of the next frame.
    pub(super) fn next_name(&self) -> String {
        format!("frame_{:06}.{}", self.written, self.extension)
    }
}

/// Removes a file of another run, unless another rank has.
pub(super) fn remove(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(failed(path, error)),
        _ => Ok(()),
    }
}
