//! Frames as VTK images.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::file::{check_regular, replace};
use crate::output::appended::{CLOSING, OPENING, Offsets, write_length, write_numbers, write_text};
use crate::output::field_values::{FieldValues, Order, write_fields};
use crate::output::frames::{Frames, remove};
use crate::output::{Field, Metadata};
use crate::{Grid, ViscoelasticContact};

/// Name of the file that lists the frames.
const COLLECTION: &str = "series.pvd";

/// A run as a folder of VTK images, one per frame, `frame_000000.vti` and so on, and a `series.pvd` that lists them
/// with their times. Open this file in ParaView, even while the run continues.
///
/// Needs the feature `vtk`.
///
/// An image is a flat sheet of n1 × n2 cells in the plane of contact, with x1 along its x. The chosen fields are cell
/// data in double precision, named with their units, such as `pressure [Pa]`. `TimeValue` \[s\], `approach [m]`,
/// `force [N]`, `tilt [rad]`, `contact area [m2]` and the [`Metadata`] as the JSON text `metadata` are field data. The
/// gap is +∞ where the initial gap is infinite: rescale the colours to the finite range.
///
/// Two frames of the same time, such as before and after a jump of the load, are both written and listed; ParaView
/// shows one of them.
///
/// ```
/// use viscocontact::{output::{Field, Metadata, VtkSeries}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-vtk-{}", std::process::id()));
/// let mut series = VtkSeries::create(&folder, &Metadata::new("Ball on rubber"), &Field::ALL)?;
/// contact.step(0.0, Load::force(0.5))?;
/// for _ in 0..3 {
///     contact.step(0.1, Load::force(0.5))?;
///     series.write(&contact)?;
/// }
/// assert!(folder.join("series.pvd").exists());
/// # std::fs::remove_dir_all(&folder).unwrap();
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug)]
pub struct VtkSeries {
    frames: Frames,
    /// The entries of the collection, one per line.
    entries: String,
}

impl VtkSeries {
    /// A new series in `folder`, which is created if it does not exist.
    ///
    /// # Errors
    /// If the folder cannot be used or contains frames already ([`AlreadyExists`](std::io::ErrorKind::AlreadyExists)), or a
    /// field is requested twice.
    pub fn create(folder: impl AsRef<Path>, metadata: &Metadata, fields: &[Field]) -> Result<VtkSeries> {
        VtkSeries::begin(folder.as_ref(), (metadata, fields), false)
    }

    /// [`VtkSeries::create`] in the place of an earlier series, whose frames are removed first.
    ///
    /// # Errors
    /// If the folder or its frames cannot be used, or a field is requested twice.
    pub fn create_or_replace(folder: impl AsRef<Path>, metadata: &Metadata, fields: &[Field]) -> Result<VtkSeries> {
        VtkSeries::begin(folder.as_ref(), (metadata, fields), true)
    }

    fn begin(folder: &Path, contents: (&Metadata, &[Field]), replaced: bool) -> Result<VtkSeries> {
        let frames = Frames::create(folder, "vti", contents, replaced)?;
        let collection = folder.join(COLLECTION);
        if replaced && collection.exists() {
            check_regular(&collection)?;
            remove(&collection)?;
        }
        Ok(VtkSeries { frames, entries: String::new() })
    }

    /// Writes the current state of the contact as the next frame, lists it in `series.pvd` and returns its path.
    ///
    /// # Errors
    /// If a file cannot be written. Then the frame is not listed, and the next call uses the same number.
    pub fn write(&mut self, contact: &ViscoelasticContact) -> Result<PathBuf> {
        let name = self.frames.next_name();
        let path = self.frames.folder.join(&name);
        let Frames { metadata, fields, buffer, .. } = &mut self.frames;
        let area = contact.contact_area();
        write_fields(&path, (contact, fields, Order::Columns), buffer, |out, values| {
            write_image(out, (contact, area), (metadata, fields), values)
        })?;

        let time = contact.time();
        let entry = format!("    <DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{name}\"/>\n");
        let entries = &self.entries;
        contact.by_one_rank(|| {
            replace(&self.frames.folder.join(COLLECTION), |out| {
                write!(
                    out,
                    "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n\
                     {entries}{entry}  </Collection>\n</VTKFile>\n"
                )
            })
        })?;
        self.entries.push_str(&entry);
        self.frames.written += 1;
        Ok(path)
    }

    /// Number of frames written.
    pub fn frames(&self) -> usize {
        self.frames.written
    }
}

/// Writes an image: an XML header, then all values.
fn write_image(
    out: &mut impl Write,
    (contact, area): (&ViscoelasticContact, f64),
    (metadata, fields): (&Metadata, &[Field]),
    values: &mut FieldValues<'_>,
) -> io::Result<()> {
    let (grid, metadata) = (contact.grid(), metadata.json(contact));
    let numbers: [(&str, &[f64]); 5] = [
        ("TimeValue", &[contact.time()]),
        ("approach [m]", &[contact.approach()]),
        ("force [N]", &[contact.force()]),
        ("tilt [rad]", &contact.tilt()),
        ("contact area [m2]", &[area]),
    ];
    write_header(out, grid, &numbers, &metadata, fields)?;
    for (_, values) in numbers {
        write_numbers(out, values.len(), values.iter().copied())?;
    }
    write_text(out, &metadata)?;
    for _ in fields {
        write_length(out, grid.len())?;
        // in VTK x varies fastest
        values.by_columns(|value| out.write_all(&value.to_le_bytes()))?;
    }
    out.write_all(CLOSING)
}

/// Writes the XML before the values.
fn write_header(
    out: &mut impl Write,
    grid: &Grid,
    numbers: &[(&str, &[f64])],
    metadata: &str,
    fields: &[Field],
) -> io::Result<()> {
    let ([n1, n2], [d1, d2], [c1, c2]) = (grid.cells(), grid.spacing(), grid.center(0, 0));
    let extent = format!("0 {n1} 0 {n2} 0 0");
    let mut offsets = Offsets::default();
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  \
         <ImageData WholeExtent=\"{extent}\" Origin=\"{:?} {:?} 0\" Spacing=\"{d1:?} {d2:?} {d1:?}\">\n    <FieldData>",
        c1 - 0.5 * d1,
        c2 - 0.5 * d2,
    )?;
    for (name, values) in numbers {
        // one tuple with as many components as values
        let (components, place) = (values.len(), offsets.next(8 * values.len()));
        let shape = format!("NumberOfComponents=\"{components}\" NumberOfTuples=\"1\"");
        writeln!(out, "      <DataArray type=\"Float64\" Name=\"{name}\" {shape} {place}")?;
    }
    out.write_all(offsets.metadata(metadata).as_bytes())?;
    writeln!(out, "    </FieldData>\n    <Piece Extent=\"{extent}\">\n      <CellData>")?;
    for field in fields {
        let (name, unit, place) = (field.name(), field.unit(), offsets.next(8 * grid.len()));
        writeln!(out, "        <DataArray type=\"Float64\" Name=\"{name} [{unit}]\" {place}")?;
    }
    write!(out, "      </CellData>\n    </Piece>\n  </ImageData>\n{OPENING}")
}
