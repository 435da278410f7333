//! Maps read from files.
//!
//! Orientation: x1 is the x of the file, along its rows, and x2 its y, which points up. Image formats (GSF, SUR, text
//! matrices) begin with the top row, at the largest x2; SDF and X3P begin with the bottom row.

pub(super) mod gsf;
mod header;
#[cfg(feature = "npy")]
pub(super) mod npy;
mod number;
mod regular_axis;
mod sdf;
mod sur;
#[cfg(test)]
mod tests;
mod text;
#[cfg(feature = "x3p")]
mod x3p;
mod xyz;

use std::io::Read;
use std::path::Path;

use crate::error::{Error, Refusal, Result};
use crate::file::open;
use crate::geometry::HeightMap;
use crate::{Grid, input, memory};

use header::Header;
use number::{Kind, Number, is_missing};

/// Extensions of the formats that include the lengths of the map.
#[cfg(feature = "x3p")]
const KNOWN: &str = "gsf, sdf, sur, pro or x3p";
#[cfg(not(feature = "x3p"))]
const KNOWN: &str = "gsf, sdf, sur or pro (or x3p, with the feature of that name)";

/// The first row of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum First {
    /// The row of largest x2, as in an image.
    Top,
    /// The row of smallest x2.
    Bottom,
}

impl HeightMap {
    /// Reads a file in a format that includes the lengths of the map. The extension determines the format:
    /// [`gsf`](HeightMap::from_gsf), [`sdf`](HeightMap::from_sdf), [`sur` and `pro`](HeightMap::from_sur), or `x3p` with the feature of that name.
    ///
    /// # Orientation
    ///
    /// x1 is the x of the file, along its rows, and x2 its y, which points up. The cell `[i, j]` of the map has the
    /// height of point i along x1 and j along x2. Image formats (GSF, SUR, text matrices) begin with the top row, at
    /// the largest x2; SDF and X3P begin with the bottom row. The origin stated in a file is ignored: the map is
    /// centred on its rectangle.
    ///
    /// # Errors
    /// If the extension is unknown, or the file cannot be read or is malformed; as
    /// [`HeightMap::new`] if its map is invalid.
    pub fn read(path: impl AsRef<Path>) -> Result<HeightMap> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "gsf" => HeightMap::from_gsf(open(path)?, None),
            "sdf" => HeightMap::from_sdf(open(path)?),
            "sur" | "pro" => HeightMap::from_sur(open(path)?),
            #[cfg(feature = "x3p")]
            "x3p" => HeightMap::from_x3p(open(path)?),
            _ => {
                let what = format!("{}: the extension must be {KNOWN}", path.display());
                let remedy = "; other formats do not store the side lengths of a map: use HeightMap::from_npy, \
                    from_text or from_xyz; instrument formats (.opd, .ibw, .spm, .tif) are exported as GSF by Gwyddion";
                Err(Refusal::file("map_extension", what, remedy).into())
            }
        }
    }

    /// The map of `rows` of `cells[0]` heights along x1, which `metres` converts, with exactly the given `spacing`.
    fn from_rows(
        cells: [usize; 2],
        spacing: [f64; 2],
        rows: &[f64],
        first: First,
        metres: impl Fn(f64) -> f64,
    ) -> Result<HeightMap> {
        let [n1, n2] = cells;
        let row = |j: usize| if first == First::Top { n2 - 1 - j } else { j };
        let heights = (0..n1).flat_map(|i| (0..n2).map(move |j| rows[row(j) * n1 + i])).map(metres);
        let heights = memory::collect("the heights of a file", rows.len(), heights)?;
        let lengths = [n1 as f64 * spacing[0], n2 as f64 * spacing[1]];
        // the spacing of the file, bitwise, instead of a quotient of lengths
        Ok(HeightMap { spacing, ..HeightMap::new(cells, lengths, heights)? })
    }
}

fn bytes(reader: impl Read, format: &str) -> Result<Vec<u8>> {
    input::bytes(reader, &format!("{format} file"))
}

/// The number of points, within the limits of a grid: checked before anything is allocated for the points.
fn count(cells: [usize; 2], spacing: [f64; 2]) -> Result<usize> {
    Ok(Grid::new(cells, [cells[0] as f64 * spacing[0], cells[1] as f64 * spacing[1]])?.len())
}

/// The heights that a file lists in words, NaN for words where `is_word` is true and numbers for missing points; there
/// must be `count` words.
fn listed<'a>(
    words: impl Iterator<Item = &'a str>,
    is_word: impl Fn(&str) -> bool,
    count: usize,
    format: &'static str,
    refuse: impl Fn(&str) -> Error,
) -> Result<Vec<f64>> {
    let height = |word: &str| match word.parse::<f64>() {
        _ if is_word(word) => Ok(f64::NAN),
        Ok(height) if is_missing(word, height) => Ok(f64::NAN),
        Ok(height) if !height.is_infinite() => Ok(height),
        _ => Err(refuse(word)),
    };
    let rows: Vec<f64> = words.map(height).collect::<Result<_, _>>()?;
    if rows.len() == count { Ok(rows) } else { Err(wrong_size(format, "heights", rows.len(), count)) }
}

/// The error of a file with `found` items where `expected` are needed; all items are counted.
fn wrong_size(format: &'static str, what: &'static str, found: usize, expected: usize) -> Error {
    let what = format!("the {format} file should hold {expected} {what}, but holds {found}");
    Refusal::file("map_size", what, "").into()
}

/// The error of a file that does not begin as its format does.
fn wrong_magic(format: &'static str, magic: &'static str) -> Error {
    let what = format!("not a {format} file: it does not begin with {magic} and the line end of its format");
    Refusal::file("map_magic", what, "; export it anew, or as GSF by Gwyddion").into()
}

/// The error of a file without a required part.
fn missing(format: &'static str, key: &'static str) -> Error {
    let what = format!("the {format} file has no {key}");
    Refusal::file("map_missing", what, ": add it, or export the map anew").naming(key).into()
}

/// The error of an entry of a header that has another value than allowed.
fn entry(format: &'static str, key: &'static str, text: &str, allowed: &'static str) -> Error {
    let what = format!("the {format} file has {key} = {text:?}, which must be {allowed}");
    Refusal::file("map_entry", what, "").naming(key).allowing(allowed).into()
}
