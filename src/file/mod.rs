//! Files that are written completely or not at all, and files that grow by complete pieces.

use std::fmt::Display;
use std::path::Path;

use crate::error::Error;

#[cfg(any(feature = "csv", feature = "plot"))]
mod appending;
#[cfg(any(feature = "checkpoint", feature = "npy", feature = "plot", feature = "vtk"))]
mod part;

#[cfg(any(feature = "csv", feature = "plot"))]
pub(crate) use appending::Appending;
#[cfg(feature = "plot")]
pub(crate) use part::Part;
#[cfg(any(feature = "checkpoint", feature = "npy", feature = "plot", feature = "vtk"))]
pub(crate) use part::replace;

/// The error of writing a file.
pub(crate) fn failed(path: &Path, what: impl Display) -> Error {
    Error::Output { path: path.display().to_string(), what: what.to_string() }
}
