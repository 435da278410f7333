//! Functions that the examples share.
#![allow(dead_code, reason = "each example takes what it needs")]

pub mod figures;

use std::error::Error;

use indicatif::{ProgressBar, ProgressStyle};

/// Ends an example: prints an error with its causes in a line, and sets the exit status.
pub fn finish(result: Result<(), Box<dyn Error>>) {
    if let Err(error) = result {
        eprint!("error: {error}");
        let mut cause = error.source();
        while let Some(error) = cause {
            eprint!(": {error}");
            cause = error.source();
        }
        eprintln!();
        std::process::exit(1);
    }
}

/// A bar on the terminal, with the time that is left.
pub fn progress(length: u64) -> ProgressBar {
    let bar = ProgressBar::new(length);
    match ProgressStyle::with_template("{bar:40} {pos}/{len}, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Reads a positive number of the command line.
pub fn positive(text: &str) -> Result<f64, String> {
    let value = text.parse().map_err(|_| "not a number".to_owned())?;
    if f64::is_finite(value) && value > 0.0 { Ok(value) } else { Err("must be positive".to_owned()) }
}

/// Reads a number of things of the command line.
pub fn at_least_one(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|&count| count > 0).ok_or_else(|| "must be a number from 1 on".to_owned())
}
