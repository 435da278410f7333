//! The stress in a volume, as files.

#[cfg(feature = "vtk")]
use std::io::{self, Write};
use std::path::Path;

use crate::ViscoelasticContact;
use crate::error::{Error, Result};
use crate::file::replace;
use crate::observe::{Stress, StressVolume};
use crate::output::Metadata;
#[cfg(feature = "vtk")]
use crate::output::appended::{CLOSING, OPENING, Offsets, write_numbers, write_text};
#[cfg(feature = "npy")]
use crate::output::npz::Archive;

/// Unit and conventions of the stress, a note of the metadata.
const NOTE: &str = "Pa; tension is positive; x3 is the depth below the surface";

/// Writes the stress in a volume as an NPZ archive of NumPy: `time` \[s\], the cell centres `x1` and `x2` and the depths `x3`
/// \[m\], the components `s11`, `s22`, `s33`, `s12`, `s13`, `s23`, `von_mises` and `tresca` \[Pa\] as arrays of shape (n1, n2,
/// depths), the `pressure` \[Pa\] of shape (n1, n2), and the [`Metadata`] as the JSON text `metadata`. An existing file is
/// replaced.
///
/// Needs the feature `npy`.
///
/// ```
/// use viscocontact::{output::{Metadata, write_stress_npz}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 2.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Elastic::new(1.0e6)?))
///     .build()?;
/// contact.step(0.0, Load::force(0.1))?;
/// let volume = contact.stress()?.in_volume(&[0.1e-3, 0.2e-3, 0.4e-3])?;
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-stress-{}.npz", std::process::id()));
/// write_stress_npz(&path, &contact, &volume, &Metadata::new("Ball on rubber"))?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), Error>(())
/// ```
///
/// # Errors
/// If the volume lies below a grid other than the contact's, or the file cannot be written.
#[cfg(feature = "npy")]
pub fn write_stress_npz(
    path: impl AsRef<Path>,
    contact: &ViscoelasticContact,
    volume: &StressVolume,
    metadata: &Metadata,
) -> Result<()> {
    check_grid(contact, volume)?;
    let (cells, depths) = (volume.grid.cells(), volume.depths.len());
    let shape = [cells[0], cells[1], depths];
    let mut values = vec![0.0; volume.values.len()];
    replace(path.as_ref(), |out| {
        let mut archive = Archive::new(out);
        archive.add("time", &[], &[contact.time()])?;
        for (axis, name) in ["x1", "x2"].into_iter().enumerate() {
            let centers: Vec<f64> = (0..cells[axis]).map(|k| volume.grid.coordinate(axis, k)).collect();
            archive.add(name, &[cells[axis]], &centers)?;
        }
        archive.add("x3", &[depths], &volume.depths)?;
        archive.add("pressure", &cells, contact.pressure())?;
        for (name, quantity) in QUANTITIES {
            for (k, plane) in volume.values.chunks_exact(volume.grid.len()).enumerate() {
                plane.iter().enumerate().for_each(|(cell, stress)| values[cell * depths + k] = quantity(stress));
            }
            archive.add(name, &shape, &values)?;
        }
        archive.finish(&metadata.clone().note("stress", NOTE).json(contact))
    })
}

/// A quantity of the stress.
#[cfg(feature = "npy")]
type Quantity = fn(&Stress) -> f64;

/// Names and values of the arrays of stress in an archive.
#[cfg(feature = "npy")]
const QUANTITIES: [(&str, Quantity); 8] = [
    ("s11", |s| s.s11),
    ("s22", |s| s.s22),
    ("s33", |s| s.s33),
    ("s12", |s| s.s12),
    ("s13", |s| s.s13),
    ("s23", |s| s.s23),
    ("von_mises", Stress::von_mises),
    ("tresca", Stress::tresca),
];

/// Writes the stress in a volume as a VTK rectilinear grid (`.vtr`), which ParaView opens: its points lie below the centres of
/// the cells, with x1 and x2 as x and y and the depth as z. `stress [Pa]` is a symmetric tensor, `von Mises stress [Pa]` and
/// `Tresca stress [Pa]` are scalars; `TimeValue` \[s\] and the [`Metadata`] as the JSON text `metadata` are field data. An
/// existing file is replaced.
///
/// Needs the feature `vtk`.
///
/// # Errors
/// If the volume lies below a grid other than the contact's, or the file cannot be written.
#[cfg(feature = "vtk")]
pub fn write_stress_vtk(
    path: impl AsRef<Path>,
    contact: &ViscoelasticContact,
    volume: &StressVolume,
    metadata: &Metadata,
) -> Result<()> {
    check_grid(contact, volume)?;
    let metadata = metadata.clone().note("stress", NOTE).json(contact);
    replace(path.as_ref(), |out| write_rectilinear(out, contact.time(), volume, &metadata))
}

/// An XML header, then all values.
#[cfg(feature = "vtk")]
fn write_rectilinear(out: &mut impl Write, time: f64, volume: &StressVolume, metadata: &str) -> io::Result<()> {
    let ([n1, n2], count) = (volume.grid.cells(), volume.values.len());
    let extent = format!("0 {} 0 {} 0 {}", n1 - 1, n2 - 1, volume.depths.len() - 1);
    let mut offsets = Offsets::default();
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    text += "<VTKFile type=\"RectilinearGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
    text += &format!("  <RectilinearGrid WholeExtent=\"{extent}\">\n    <FieldData>\n");
    text += &format!("      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" {}\n", offsets.next(8));
    text += &offsets.metadata(metadata);
    text += &format!(
        "    </FieldData>\n    <Piece Extent=\"{extent}\">\n      <PointData Scalars=\"von Mises stress [Pa]\">\n"
    );
    for name in ["von Mises stress [Pa]", "Tresca stress [Pa]"] {
        text += &format!("        <DataArray type=\"Float64\" Name=\"{name}\" {}\n", offsets.next(8 * count));
    }
    let tensor = "Name=\"stress [Pa]\" NumberOfComponents=\"6\"";
    text += &format!("        <DataArray type=\"Float64\" {tensor} {}\n", offsets.next(48 * count));
    text += "      </PointData>\n      <Coordinates>\n";
    for (name, points) in [("x", n1), ("y", n2), ("z", volume.depths.len())] {
        text += &format!("        <DataArray type=\"Float64\" Name=\"{name}\" {}\n", offsets.next(8 * points));
    }
    text += "      </Coordinates>\n    </Piece>\n  </RectilinearGrid>\n";
    out.write_all(text.as_bytes())?;
    out.write_all(OPENING.as_bytes())?;

    write_numbers(out, 1, [time].into_iter())?;
    write_text(out, metadata)?;
    // in VTK x varies fastest
    let place = |k: usize, j: usize, i: usize| &volume.values[(k * n1 + i) * n2 + j];
    let points = || {
        let planes = 0..volume.depths.len();
        planes.flat_map(move |k| (0..n2).flat_map(move |j| (0..n1).map(move |i| place(k, j, i))))
    };
    for quantity in [Stress::von_mises, Stress::tresca] {
        write_numbers(out, count, points().map(quantity))?;
    }
    // the order of VTK
    let tensor = |&Stress { s11, s22, s33, s12, s13, s23 }: &Stress| [s11, s22, s33, s12, s23, s13];
    write_numbers(out, 6 * count, points().flat_map(tensor))?;
    for axis in 0..2 {
        let cells = volume.grid.cells()[axis];
        write_numbers(out, cells, (0..cells).map(|k| volume.grid.coordinate(axis, k)))?;
    }
    write_numbers(out, volume.depths.len(), volume.depths.iter().copied())?;
    out.write_all(CLOSING)
}

fn check_grid(contact: &ViscoelasticContact, volume: &StressVolume) -> Result<()> {
    let same = *contact.grid() == volume.grid && volume.values.len() == volume.grid.len() * volume.depths.len();
    let len = volume.values.len();
    let expected = contact.grid().len() * volume.depths.len();
    if same { Ok(()) } else { Err(Error::WrongLength { field: "stress in a volume", len, expected, exact: true }) }
}
