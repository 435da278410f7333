//! Frames as images of VTK.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::file::replace;
use crate::output::frames::Frames;
use crate::output::{Field, Scene};
use crate::{Grid, ViscoelasticContact};

/// The file that lists the frames.
const COLLECTION: &str = "series.pvd";

/// A run as a folder of VTK images, one a frame, `frame_000000.vti` and so on, and a `series.pvd` that lists them
/// with their times: open this in ParaView, also while the run goes on.
///
/// Needs the feature `vtk`.
///
/// An image is a flat sheet of n1 × n2 cells with x1 along its x, where the grid lies in the plane of contact. The
/// fields chosen are cell data in double precision, named with their units, as `pressure [Pa]`. `TimeValue` \[s\],
/// `approach [m]`, `force [N]`, `tilt [rad]`, `contact area [m2]` and the [`Scene`] as the JSON text `scene` are field
/// data. Where there is nothing to touch the gap is +∞: rescale the colours to the finite range.
///
/// Two frames of the same time, as before and after a jump of the load, are both written and listed; ParaView shows
/// one of them.
///
/// ```
/// use viscocontact::{output::{Field, Scene, VtkSeries}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-vtk-{}", std::process::id()));
/// let mut series = VtkSeries::create(&folder, Scene::new("Ball on rubber"), &Field::ALL)?;
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
    scene: Scene,
    fields: Vec<Field>,
    buffer: Vec<f64>,
    /// The entries of the collection, one a line.
    entries: String,
}

impl VtkSeries {
    /// A series in `folder`, which is made if there is none.
    ///
    /// # Errors
    /// If the folder cannot be used or holds frames already, or a field is asked for twice.
    pub fn create(folder: impl AsRef<Path>, scene: Scene, fields: &[Field]) -> Result<VtkSeries> {
        let frames = Frames::create(folder.as_ref(), "vti", fields)?;
        Ok(VtkSeries { frames, scene, fields: fields.to_vec(), buffer: Vec::new(), entries: String::new() })
    }

    /// Writes the state the contact is in as the next frame, lists it in `series.pvd`, and returns its path.
    ///
    /// # Errors
    /// If a file cannot be written; the frame is not listed then, and the next call tries the same number.
    pub fn write(&mut self, contact: &ViscoelasticContact) -> Result<PathBuf> {
        let name = self.frames.next_name();
        let path = self.frames.path(&name);
        let VtkSeries { scene, fields, buffer, .. } = self;
        replace(&path, |out| image(out, contact, &scene.json(contact), fields, buffer))?;

        let time = contact.time();
        let entry = format!("    <DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{name}\"/>\n");
        let entries = &self.entries;
        replace(&self.frames.path(COLLECTION), |out| {
            out.write_all(b"<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n")?;
            out.write_all(entries.as_bytes())?;
            out.write_all(entry.as_bytes())?;
            out.write_all(b"  </Collection>\n</VTKFile>\n")
        })?;
        self.entries.push_str(&entry);
        self.frames.count();
        Ok(path)
    }

    /// Frames written.
    pub fn frames(&self) -> usize {
        self.frames.written()
    }
}

/// Writes an image: a head in XML, then all values as they are in memory, each array behind its size in bytes.
fn image(
    out: &mut impl Write,
    contact: &ViscoelasticContact,
    scene: &str,
    fields: &[Field],
    buffer: &mut Vec<f64>,
) -> io::Result<()> {
    let grid = contact.grid();
    let numbers: [(&str, &[f64]); 5] = [
        ("TimeValue", &[contact.time()]),
        ("approach [m]", &[contact.approach()]),
        ("force [N]", &[contact.force()]),
        ("tilt [rad]", &contact.tilt()),
        ("contact area [m2]", &[contact.contact_area()]),
    ];
    head(out, grid, &numbers, scene, fields)?;
    for (_, values) in numbers {
        size(out, 8 * values.len() as u64)?;
        values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))?;
    }
    // texts end with a zero, which there is none of within JSON
    size(out, scene.len() as u64 + 1)?;
    out.write_all(scene.as_bytes())?;
    out.write_all(&[0])?;
    let [n1, n2] = grid.cells();
    for field in fields {
        let values = field.values(contact, buffer).map_err(io::Error::other)?;
        size(out, 8 * values.len() as u64)?;
        // VTK runs along x first
        for j in 0..n2 {
            (0..n1).try_for_each(|i| out.write_all(&values[i * n2 + j].to_le_bytes()))?;
        }
    }
    out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
}

/// The size of the array that follows.
fn size(out: &mut impl Write, bytes: u64) -> io::Result<()> {
    out.write_all(&bytes.to_le_bytes())
}

/// The XML before the values.
fn head(
    out: &mut impl Write,
    grid: &Grid,
    numbers: &[(&str, &[f64])],
    scene: &str,
    fields: &[Field],
) -> io::Result<()> {
    let ([n1, n2], [d1, d2], [c1, c2]) = (grid.cells(), grid.spacing(), grid.center(0, 0));
    let extent = format!("0 {n1} 0 {n2} 0 0");
    let mut offset = 0;
    let mut next = |bytes: usize| {
        let this = offset;
        offset += 8 + bytes as u64;
        format!("format=\"appended\" offset=\"{this}\"/>")
    };
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  \
         <ImageData WholeExtent=\"{extent}\" Origin=\"{:?} {:?} 0\" Spacing=\"{d1:?} {d2:?} {d1:?}\">\n    <FieldData>",
        c1 - 0.5 * d1,
        c2 - 0.5 * d2,
    )?;
    for (name, values) in numbers {
        // one tuple, of as many components as there are values
        let (components, place) = (values.len(), next(8 * values.len()));
        let shape = format!("NumberOfComponents=\"{components}\" NumberOfTuples=\"1\"");
        writeln!(out, "      <DataArray type=\"Float64\" Name=\"{name}\" {shape} {place}")?;
    }
    let place = next(scene.len() + 1);
    writeln!(out, "      <Array type=\"String\" Name=\"scene\" NumberOfTuples=\"1\" {place}")?;
    writeln!(out, "    </FieldData>\n    <Piece Extent=\"{extent}\">\n      <CellData>")?;
    for field in fields {
        let (name, unit, place) = (field.name(), field.unit(), next(8 * grid.len()));
        writeln!(out, "        <DataArray type=\"Float64\" Name=\"{name} [{unit}]\" {place}")?;
    }
    write!(out, "      </CellData>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n   _")
}
