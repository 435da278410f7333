//! The numbered files of a series.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::file::failed;
use crate::output::Field;

/// A folder of frames `frame_000000`, `frame_000001`, ...
#[derive(Debug)]
pub(super) struct Frames {
    folder: PathBuf,
    extension: &'static str,
    written: usize,
}

impl Frames {
    /// Makes the folder, if there is none, and refuses one that holds frames.
    pub(super) fn create(folder: &Path, extension: &'static str, fields: &[Field]) -> Result<Frames> {
        if let Some(k) = (1..fields.len()).find(|&k| fields[..k].contains(&fields[k])) {
            return Err(failed(folder, format!("the field {} is asked for twice", fields[k].name())));
        }
        let unusable = |error: std::io::Error| failed(folder, error);
        fs::create_dir_all(folder).map_err(unusable)?;
        for entry in fs::read_dir(folder).map_err(unusable)? {
            let name = entry.map_err(unusable)?.file_name();
            let name = name.to_string_lossy();
            if name.starts_with("frame_") && name.ends_with(&format!(".{extension}")) {
                return Err(failed(
                    folder,
                    format!("it holds {name} of another run; remove it or choose another folder"),
                ));
            }
        }
        Ok(Frames { folder: folder.to_owned(), extension, written: 0 })
    }

    /// Name of the next frame.
    pub(super) fn next_name(&self) -> String {
        format!("frame_{:06}.{}", self.written, self.extension)
    }

    /// A file in the folder.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Counts a frame that was written.
    pub(super) fn count(&mut self) {
        self.written += 1;
    }

    /// Frames written.
    pub(super) fn written(&self) -> usize {
        self.written
    }
}
