//! Files of the crate as bytes.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::OrRaise;

/// A file for the time of a pickle.
pub struct Scratch(pub PathBuf);

impl Scratch {
    fn new(ending: &str) -> Scratch {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        Scratch(std::env::temp_dir().join(format!("viscocontact-{}-{number}.{ending}", std::process::id())))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

pub fn bytes_of<'py>(
    py: Python<'py>,
    ending: &str,
    save: impl FnOnce(&PathBuf) -> viscocontact::Result<()> + Send,
) -> PyResult<Bound<'py, PyBytes>> {
    let file = Scratch::new(ending);
    py.detach(|| save(&file.0)).or_raise()?;
    Ok(PyBytes::new(py, &std::fs::read(&file.0)?))
}

pub fn file_of(bytes: &Bound<'_, PyBytes>) -> PyResult<Scratch> {
    let file = Scratch::new("checkpoint");
    std::fs::write(&file.0, bytes.as_bytes())?;
    Ok(file)
}
