//! What the examples share.
#![allow(dead_code, reason = "each example takes what it needs")]

use std::error::Error;

/// Ends an example: an error is told in a line, and in the exit status.
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
