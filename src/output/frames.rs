//! The numbered files of a series.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::file::failed;
use crate::output::{Field, Metadata};

/// A folder of frames `frame_000000`, `frame_000001`, ... and what each of them contains.
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
    /// Creates the folder if it does not exist, and refuses one that contains frames.
    pub(super) fn create(
        folder: &Path,
        extension: &'static str,
        metadata: Metadata,
        fields: &[Field],
    ) -> Result<Frames> {
        if let Some(k) = (1..fields.len()).find(|&k| fields[..k].contains(&fields[k])) {
            return Err(failed(folder, format!("the field {} is requested twice", fields[k].name())));
        }
        let unusable = |error: std::io::Error| failed(folder, error);
        fs::create_dir_all(folder).map_err(unusable)?;
        for entry in fs::read_dir(folder).map_err(unusable)? {
            let name = entry.map_err(unusable)?.file_name();
            let name = name.to_string_lossy();
            if name.starts_with("frame_") && name.ends_with(&format!(".{extension}")) {
                let reason = format!("the folder contains {name} of another run; remove it or choose another folder");
                return Err(failed(folder, reason));
            }
        }
        let (folder, fields) = (folder.to_owned(), fields.to_vec());
        Ok(Frames { folder, extension, written: 0, metadata, fields, buffer: Vec::new() })
    }

    /// Name of the next frame.
    pub(super) fn next_name(&self) -> String {
        format!("frame_{:06}.{}", self.written, self.extension)
    }
}
