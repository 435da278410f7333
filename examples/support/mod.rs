//! What the examples share.
#![allow(dead_code, reason = "each example takes what it needs")]

use std::error::Error;
use std::fs;
use std::path::PathBuf;

/// Ends an example: an error is told in a line, and in the exit status.
pub fn finish(result: Result<(), Box<dyn Error>>) {
    if let Err(error) = result {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}

/// The path, free for new results: the library writes over nothing, so what an earlier run left there goes first.
pub fn cleared(path: PathBuf) -> std::io::Result<PathBuf> {
    if path.is_dir() {
        fs::remove_dir_all(&path)?;
    } else if path.exists() {
        fs::remove_file(&path)?;
    }
    Ok(path)
}
