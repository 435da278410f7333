//! What the examples share.

use std::error::Error;

/// Ends an example: an error is told in a line, and in the exit status.
pub fn finish(result: Result<(), Box<dyn Error>>) {
    if let Err(error) = result {
        eprintln!("error: {error}");
        std::process::exit(1);
    }
}
