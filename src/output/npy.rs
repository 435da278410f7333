//! Fields as arrays in the NPY format of NumPy.

use std::io::Write;
use std::path::Path;

use crate::Grid;
use crate::error::{Result, exact_length};
use crate::file::{npy, replace, write_numbers};

/// Writes a field, one value per cell of `grid`, as an NPY file: a `float64` array of the shape of the grid, so that
/// `numpy.load(path)[i, j]` is the value of the cell `[i, j]`. An existing file is replaced.
///
/// Needs the feature `npy`.
///
/// ```
/// use viscocontact::{Grid, output::write_npy};
///
/// let grid = Grid::new([2, 3], [2.0e-3, 3.0e-3])?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-npy-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder).unwrap();
/// # let path = folder.join("heights.npy");
/// write_npy(&path, &grid, &[0.0, 1.0, 2.0, 10.0, 11.0, 12.0])?;
/// # std::fs::remove_dir_all(&folder).unwrap();
/// # Ok::<(), viscocontact::Error>(())
/// ```
///
/// # Errors
/// If there is not one value per cell, or the file cannot be written.
pub fn write_npy(path: impl AsRef<Path>, grid: &Grid, values: &[f64]) -> Result<()> {
    exact_length("field", values.len(), grid.len())?;
    replace(path.as_ref(), |out| {
        out.write_all(&npy::header("<f8", &grid.cells()))?;
        write_numbers(out, values.iter().copied())
    })
}
