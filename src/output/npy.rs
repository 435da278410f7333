//! Arrays in the NPY format of NumPy.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use npyz::WriterBuilder;

use crate::error::{Result, exact_length};
use crate::file::replace;
use crate::output::Field;
use crate::output::field_values::{Order, write_fields};
use crate::{Grid, ViscoelasticContact};

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
    replace(path.as_ref(), |out| array(out, &grid.cells(), values))
}

/// Writes a field of the contact as an NPY file, like [`write_npy`]: a call of all [ranks](crate::parallel) that share out the
/// contact, of which rank 0 writes, and none holds the whole. An existing file is replaced.
///
/// Needs the feature `npy`.
///
/// ```
/// use viscocontact::{output::{Field, write_field_npy}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// contact.step(0.0, Load::force(0.5))?;
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-field-{}.npy", std::process::id()));
/// write_field_npy(&path, &contact, Field::Pressure)?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), Error>(())
/// ```
///
/// # Errors
/// If the file cannot be written.
pub fn write_field_npy(path: impl AsRef<Path>, contact: &ViscoelasticContact, field: Field) -> Result<()> {
    let (fields, mut buffer) = ([field], Vec::new());
    write_fields(path.as_ref(), (contact, &fields, Order::Rows), &mut buffer, |out, values| {
        array_of_pieces(out, &contact.grid().cells(), |take| values.by_rows(take))
    })
}

/// Writes numbers in row-major order.
pub(super) fn array(out: impl Write, shape: &[usize], values: &[f64]) -> io::Result<()> {
    array_of_pieces(out, shape, |take| take(values))
}

/// Takes the next numbers of an array.
pub(super) type Take<'a> = &'a mut dyn FnMut(&[f64]) -> io::Result<()>;

/// Writes numbers in row-major order, one piece per call that `give` makes.
pub(super) fn array_of_pieces(
    out: impl Write,
    shape: &[usize],
    give: impl FnOnce(Take<'_>) -> io::Result<()>,
) -> io::Result<()> {
    let shape: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
    let mut out = BufWriter::with_capacity(1 << 16, out);
    let number = npyz::DType::Plain(type_string("<f8")?);
    let mut writer = npyz::WriteOptions::new().dtype(number).shape(&shape).writer(&mut out).begin_nd()?;
    give(&mut |values| writer.extend(values.iter().copied()))?;
    writer.finish()?;
    out.flush()
}

/// Writes a text as a zero-dimensional string array: `str(array)` is the text.
pub(super) fn text(mut out: impl Write, text: &str) -> io::Result<()> {
    let text: Vec<char> = text.chars().collect();
    let string = npyz::DType::Plain(type_string(&format!("<U{}", text.len().max(1)))?);
    let mut writer = npyz::WriteOptions::new().dtype(string).shape(&[]).writer(&mut out).begin_nd()?;
    writer.push(&text[..])?;
    writer.finish()
}

fn type_string(text: &str) -> io::Result<npyz::TypeStr> {
    text.parse().map_err(io::Error::other)
}
