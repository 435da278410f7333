//! The stress in a volume, as files.

use std::io::{self, Write};
use std::path::Path;

use crate::error::{Error, Result};
use crate::fields::Fields;
use crate::file::replace;
use crate::observe::{Stress, StressVolume};
#[cfg(feature = "npy")]
use crate::output::npz::Archive;
use crate::output::time_of;
use crate::output::vtk::{CLOSING, Section, write_array, write_opening};
use crate::output::{Format, Metadata};

/// Unit and conventions of the stress, a note of the metadata.
const NOTE: &str = "Pa; tension is positive; x3 is the depth below the surface";

/// Writes the stress in a volume to a file, which replaces an earlier one.
///
/// An NPZ archive contains `time` \[s\], the cell centres `x1` and `x2` and the depths `x3` \[m\], the components
/// `s11`, `s22`, `s33`, `s12`, `s13`, `s23`, `von_mises` and `tresca` \[Pa\] as arrays of shape (n1, n2, depths), the
/// `pressure` \[Pa\] of shape (n1, n2), and the [`Metadata`] as the JSON text `metadata`.
///
/// A VTK file is a rectilinear grid (`.vtr`), which ParaView opens: its points lie below the centres of the cells,
/// with x1 and x2 as x and y and the depth as z. `stress [Pa]` is a symmetric tensor, `von Mises stress [Pa]` and
/// `Tresca stress [Pa]` are scalars; `TimeValue` \[s\] and the [`Metadata`] as the JSON text `metadata` are field
/// data.
///
/// ```
/// # #[cfg(feature = "npy")] {
/// use viscocontact::{output::{Format, Metadata, write_stress}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 2.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Elastic::new(1.0e6)?))
///     .build()?;
/// contact.step(0.0, Load::force(0.1))?;
/// let volume = contact.fields().stress()?.in_volume(&[0.1e-3, 0.2e-3, 0.4e-3])?;
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-stress-{}.npz", std::process::id()));
/// write_stress(&path, Format::Npz, &contact, &volume, &Metadata::new("Ball on rubber"))?;
/// # std::fs::remove_file(&path).unwrap();
/// # }
/// # Ok::<(), viscocontact::Error>(())
/// ```
///
/// # Errors
/// If the volume lies below a grid other than the contact's, or the file cannot be written.
pub fn write_stress<'a>(
    path: impl AsRef<Path>,
    format: Format,
    contact: impl Into<Fields<'a>>,
    volume: &StressVolume,
    metadata: &Metadata,
) -> Result<()> {
    let contact = contact.into();
    let (len, expected) = (volume.values.len(), contact.grid().len() * volume.depths.len());
    if *contact.grid() != volume.grid || len != expected {
        return Err(Error::WrongLength { field: "stress in a volume", len, expected, exact: true });
    }
    let metadata = metadata.clone().note("stress", NOTE).of(Some(contact));
    replace(path.as_ref(), |out| match format {
        #[cfg(feature = "npy")]
        Format::Npz => write_archive(out, contact, volume, &metadata),
        Format::Vtk => write_rectilinear(out, time_of(contact), volume, &metadata),
    })
}

#[cfg(feature = "npy")]
fn write_archive(
    out: &mut (impl Write + io::Seek),
    contact: Fields<'_>,
    volume: &StressVolume,
    metadata: &str,
) -> io::Result<()> {
    let ([n1, n2], depths) = (volume.grid.cells(), volume.depths.len());
    let mut values = vec![0.0; volume.values.len()];
    let mut archive = Archive::new(out, time_of(contact), &volume.grid)?;
    archive.add("x3", &[depths], &volume.depths)?;
    archive.add("pressure", &[n1, n2], contact.pressure())?;
    for (name, quantity) in QUANTITIES {
        for (k, plane) in volume.values.chunks_exact(volume.grid.len()).enumerate() {
            plane.iter().enumerate().for_each(|(cell, stress)| values[cell * depths + k] = quantity(stress));
        }
        archive.add(name, &[n1, n2, depths], &values)?;
    }
    archive.finish(metadata)
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

fn write_rectilinear(out: &mut impl Write, time: f64, volume: &StressVolume, metadata: &str) -> io::Result<()> {
    let ([n1, n2], count) = (volume.grid.cells(), volume.values.len());
    let depths = volume.depths.len();
    let scalar = |name: &str, count: usize| (format!("Name=\"{name}\""), count);
    let tensor = ("Name=\"stress [Pa]\" NumberOfComponents=\"6\"".to_owned(), 6 * count);
    let sections: [Section<'_>; 2] = [
        (
            "PointData Scalars=\"von Mises stress [Pa]\"",
            vec![scalar("von Mises stress [Pa]", count), scalar("Tresca stress [Pa]", count), tensor],
        ),
        ("Coordinates", vec![scalar("x", n1), scalar("y", n2), scalar("z", depths)]),
    ];
    let extent = format!("0 {} 0 {} 0 {}", n1 - 1, n2 - 1, depths - 1);
    let time: (&str, &[f64]) = ("TimeValue", &[time]);
    write_opening(out, ("RectilinearGrid", &extent), "", (&[time], metadata), &sections)?;
    // in VTK x varies fastest
    let points = || {
        let row = move |k: usize, j: usize| (0..n1).map(move |i| &volume.values[(k * n1 + i) * n2 + j]);
        (0..depths).flat_map(move |k| (0..n2).flat_map(move |j| row(k, j)))
    };
    for quantity in [Stress::von_mises, Stress::tresca] {
        write_array(out, count, points().map(quantity))?;
    }
    // the order of VTK
    let tensor = |&Stress { s11, s22, s33, s12, s13, s23 }: &Stress| [s11, s22, s33, s12, s23, s13];
    write_array(out, 6 * count, points().flat_map(tensor))?;
    for (axis, cells) in [n1, n2].into_iter().enumerate() {
        write_array(out, cells, (0..cells).map(|k| volume.grid.coordinate(axis, k)))?;
    }
    write_array(out, depths, volume.depths.iter().copied())?;
    out.write_all(CLOSING)
}
