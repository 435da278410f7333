//! Maps from files.
//!
//! Orientation: x1 is the x of the file, along its rows, and x2 its y, which points up. Formats that are images (GSF,
//! text matrices) begin with the top row, the one of largest x2; SDF and X3P begin with the lowest.

pub(super) mod gsf;
mod header;
#[cfg(feature = "npy")]
pub(super) mod npy;
mod number;
mod sdf;
#[cfg(test)]
mod tests;
mod text;
#[cfg(feature = "x3p")]
mod x3p;
mod xyz;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::Grid;
use crate::error::{MapError, Result};
use crate::geometry::HeightMap;
use crate::memory;

/// The extensions of files that carry the lengths of their maps.
#[cfg(feature = "x3p")]
const KNOWN: &str = "gsf, sdf or x3p";
#[cfg(not(feature = "x3p"))]
const KNOWN: &str = "gsf or sdf (or x3p, with the feature of that name)";

/// Which row a file begins with.
#[derive(Debug, Clone, Copy, PartialEq)]
enum First {
    /// That of largest x2, as in an image.
    Top,
    /// That of smallest x2.
    Bottom,
}

impl HeightMap {
    /// Reads a file whose format carries the lengths of the map, which its extension tells:
    /// [`gsf`](HeightMap::from_gsf), [`sdf`](HeightMap::from_sdf), or `x3p` with the feature of that name.
    ///
    /// # Orientation
    ///
    /// x1 is the x of a file, along its rows, x2 its y, which points up, and the map has the height of the point i
    /// along x1, j along x2 in the cell `[i, j]`. Formats that are images (GSF, text matrices) begin with the top row,
    /// the one of largest x2; SDF and X3P begin with the lowest. The origin that a file may state is not kept: a map
    /// is centred on its rectangle.
    ///
    /// # Errors
    /// [`Error::Map`](crate::Error::Map) if the extension is none of these, the file cannot be read or is malformed;
    /// as [`HeightMap::new`] if the map in it is not one that may be.
    pub fn read(path: impl AsRef<Path>) -> Result<HeightMap> {
        let path = path.as_ref();
        let name = || path.display().to_string();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let open =
            || File::open(path).map_err(|error| MapError::Unreadable { file: name(), reason: error.to_string() });
        match extension.as_str() {
            "gsf" => HeightMap::from_gsf(open()?),
            "sdf" => HeightMap::from_sdf(open()?),
            #[cfg(feature = "x3p")]
            "x3p" => HeightMap::from_x3p(open()?),
            _ => Err(MapError::Extension { file: name(), known: KNOWN }.into()),
        }
    }

    /// The map of `rows`, each of `cells[0]` heights along x1, with the exact `spacing`.
    fn from_rows(cells: [usize; 2], spacing: [f64; 2], rows: &[f64], first: First) -> Result<HeightMap> {
        let [n1, n2] = cells;
        let row = |j: usize| match first {
            First::Top => n2 - 1 - j,
            First::Bottom => j,
        };
        let heights = (0..n1).flat_map(|i| (0..n2).map(move |j| rows[row(j) * n1 + i]));
        let heights = memory::collect("the heights of a file", rows.len(), heights)?;
        let lengths = [n1 as f64 * spacing[0], n2 as f64 * spacing[1]];
        // the spacing is what the file says, to the last bit, and not a quotient of the length
        Ok(HeightMap { spacing, ..HeightMap::new(cells, lengths, heights)? })
    }
}

/// All that a reader gives. No more is ever allocated than was there.
fn bytes(mut reader: impl Read, format: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = reader.read_to_end(&mut bytes);
    read.map_err(|error| MapError::Unreadable { file: format!("{format} file"), reason: error.to_string() })?;
    Ok(bytes)
}

/// The number of cells, if a grid may have them, before anything is allocated for them.
fn count(cells: [usize; 2], spacing: [f64; 2]) -> Result<usize> {
    Ok(Grid::new(cells, [cells[0] as f64 * spacing[0], cells[1] as f64 * spacing[1]])?.len())
}
