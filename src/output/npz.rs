//! Frames as NPZ archives of NumPy.

use std::io;
use std::path::{Path, PathBuf};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::ViscoelasticContact;
use crate::error::Result;
use crate::output::deferred::Deferred;
use crate::output::field_values::{Order, write_fields};
use crate::output::frames::Frames;
use crate::output::{Field, Metadata, npy};

/// A run as a folder of NPZ archives, one per frame: `frame_000000.npz` and so on.
///
/// Needs the feature `npy`.
///
/// An archive contains `time` \[s\], the cell centres `x1` and `x2` \[m\], the chosen fields as arrays of shape (n1,
/// n2), `approach` \[m\], `force` \[N\], `tilt` \[rad\] and `contact_area` \[m²\], all in double precision and
/// uncompressed, and the [`Metadata`] as the JSON text `metadata`. In Python, without pickle:
///
/// ```python
/// frame = numpy.load("run/frame_000012.npz")
/// matplotlib.pyplot.pcolormesh(frame["x1"], frame["x2"], frame["pressure"].T)
/// units = json.loads(str(frame["metadata"]))["units"]
/// ```
///
/// ```
/// use viscocontact::{output::{Field, Metadata, NpzSeries}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-npz-{}", std::process::id()));
/// let mut series = NpzSeries::create(&folder, &Metadata::new("Ball on rubber"), &[Field::Pressure])?;
/// contact.step(0.0, Load::force(0.5))?;
/// for _ in 0..3 {
///     contact.step(0.1, Load::force(0.5))?;
///     series.write(&contact)?;
/// }
/// assert!(folder.join("frame_000002.npz").exists());
/// # std::fs::remove_dir_all(&folder).unwrap();
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug)]
pub struct NpzSeries {
    frames: Frames,
}

impl NpzSeries {
    /// A new series in `folder`, which is created if it does not exist.
    ///
    /// # Errors
    /// If the folder cannot be used or contains frames already ([`AlreadyExists`](std::io::ErrorKind::AlreadyExists)), or a
    /// field is requested twice.
    pub fn create(folder: impl AsRef<Path>, metadata: &Metadata, fields: &[Field]) -> Result<NpzSeries> {
        NpzSeries::begin(folder.as_ref(), (metadata, fields), false)
    }

    /// [`NpzSeries::create`] in the place of an earlier series, whose frames are removed first.
    ///
    /// # Errors
    /// If the folder or its frames cannot be used, or a field is requested twice.
    pub fn create_or_replace(folder: impl AsRef<Path>, metadata: &Metadata, fields: &[Field]) -> Result<NpzSeries> {
        NpzSeries::begin(folder.as_ref(), (metadata, fields), true)
    }

    fn begin(folder: &Path, contents: (&Metadata, &[Field]), replaced: bool) -> Result<NpzSeries> {
        Ok(NpzSeries { frames: Frames::create(folder, "npz", contents, replaced)? })
    }

    /// Writes the current state of the contact as the next frame and returns its path.
    ///
    /// # Errors
    /// If the file cannot be written. Then there is no frame, and the next call uses the same number.
    pub fn write(&mut self, contact: &ViscoelasticContact) -> Result<PathBuf> {
        let path = self.frames.folder.join(self.frames.next_name());
        let Frames { metadata, fields, buffer, .. } = &mut self.frames;
        let (grid, area) = (contact.grid(), contact.contact_area());
        write_fields(&path, (contact, fields, Order::Rows), buffer, |out, values| {
            let mut archive = Archive::new(out);
            archive.add("time", &[], &[contact.time()])?;
            for (axis, name) in ["x1", "x2"].into_iter().enumerate() {
                let cells = grid.cells()[axis];
                let centers: Vec<f64> = (0..cells).map(|k| grid.coordinate(axis, k)).collect();
                archive.add(name, &[cells], &centers)?;
            }
            for field in fields.iter() {
                archive.add_pieces(field.name(), &grid.cells(), |take| values.by_rows(take))?;
            }
            archive.add("approach", &[], &[contact.approach()])?;
            archive.add("force", &[], &[contact.force()])?;
            archive.add("tilt", &[2], &contact.tilt())?;
            archive.add("contact_area", &[], &[area])?;
            archive.finish(&metadata.json(contact))
        })?;
        self.frames.written += 1;
        Ok(path)
    }

    /// Number of frames written.
    pub fn frames(&self) -> usize {
        self.frames.written
    }
}

/// An NPZ archive being written.
pub(super) struct Archive<W: io::Write + io::Seek>(ZipWriter<Deferred<W>>);

impl<W: io::Write + io::Seek> Archive<W> {
    pub(super) fn new(out: W) -> Archive<W> {
        Archive(ZipWriter::new(Deferred::new(out)))
    }

    fn start(&mut self, name: &str, large: bool) -> io::Result<()> {
        let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored).large_file(large);
        Ok(self.0.start_file(npyz::npz::file_name_from_array_name(name), options)?)
    }

    pub(super) fn add(&mut self, name: &str, shape: &[usize], values: &[f64]) -> io::Result<()> {
        self.add_pieces(name, shape, |take| take(values))
    }

    /// Adds an array in row-major order, one piece per call that `give` makes.
    fn add_pieces(
        &mut self,
        name: &str,
        shape: &[usize],
        give: impl FnOnce(npy::Take<'_>) -> io::Result<()>,
    ) -> io::Result<()> {
        // plain entries have sizes of 32 bits, including the header of the array
        let large = shape.iter().product::<usize>() >= (u32::MAX as usize - 4096) / 8;
        self.start(name, large)?;
        npy::array_of_pieces(&mut self.0, shape, give)
    }

    /// Adds the metadata and completes the archive.
    pub(super) fn finish(mut self, metadata: &str) -> io::Result<()> {
        self.start("metadata", false)?;
        npy::text(&mut self.0, metadata)?;
        self.0.finish()?.finish()
    }
}
