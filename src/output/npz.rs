//! Frames as NumPy archives.

use std::io;
use std::path::{Path, PathBuf};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::ViscoelasticContact;
use crate::error::Result;
use crate::file::replace;
use crate::output::deferred::Deferred;
use crate::output::frames::Frames;
use crate::output::{Field, Scene, npy};

/// A run as a folder of NPZ archives, one a frame: `frame_000000.npz` and so on.
///
/// Needs the feature `npy`.
///
/// An archive holds `time` \[s\], the cell centres `x1` and `x2` \[m\], the fields chosen as arrays of shape
/// (n1, n2), `approach` \[m\], `force` \[N\], `tilt` \[rad\], `contact_area` \[m²\], all in double precision and
/// uncompressed, and the [`Scene`] as the JSON text `scene`. In Python, without pickle:
///
/// ```python
/// frame = numpy.load("run/frame_000012.npz")
/// matplotlib.pyplot.pcolormesh(frame["x1"], frame["x2"], frame["pressure"].T)
/// units = json.loads(str(frame["scene"]))["units"]
/// ```
///
/// ```
/// use viscocontact::{output::{Field, NpzSeries, Scene}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-npz-{}", std::process::id()));
/// let mut series = NpzSeries::create(&folder, Scene::new("Ball on rubber"), &[Field::Pressure])?;
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
    scene: Scene,
    fields: Vec<Field>,
    buffer: Vec<f64>,
}

impl NpzSeries {
    /// A series in `folder`, which is made if there is none.
    ///
    /// # Errors
    /// If the folder cannot be used or holds frames already, or a field is asked for twice.
    pub fn create(folder: impl AsRef<Path>, scene: Scene, fields: &[Field]) -> Result<NpzSeries> {
        let frames = Frames::create(folder.as_ref(), "npz", fields)?;
        Ok(NpzSeries { frames, scene, fields: fields.to_vec(), buffer: Vec::new() })
    }

    /// Writes the state the contact is in as the next frame, and returns its path.
    ///
    /// # Errors
    /// If the file cannot be written; there is no frame then, and the next call tries the same number.
    pub fn write(&mut self, contact: &ViscoelasticContact) -> Result<PathBuf> {
        let path = self.frames.path(&self.frames.next_name());
        let NpzSeries { scene, fields, buffer, .. } = self;
        replace(&path, |out| {
            let mut archive = Archive(ZipWriter::new(Deferred::new(out)));
            archive.add("time", &[], &[contact.time()])?;
            for (axis, name) in ["x1", "x2"].into_iter().enumerate() {
                let cells = contact.grid().cells()[axis];
                let centers: Vec<f64> = (0..cells).map(|k| contact.grid().coordinate(axis, k)).collect();
                archive.add(name, &[cells], &centers)?;
            }
            for field in fields.iter() {
                let values = field.values(contact, buffer).map_err(io::Error::other)?;
                archive.add(field.name(), &contact.grid().cells(), values)?;
            }
            archive.add("approach", &[], &[contact.approach()])?;
            archive.add("force", &[], &[contact.force()])?;
            archive.add("tilt", &[2], &contact.tilt())?;
            archive.add("contact_area", &[], &[contact.contact_area()])?;
            archive.start("scene", false)?;
            npy::text(&mut archive.0, &scene.json(contact))?;
            archive.0.finish()?.finish()
        })?;
        self.frames.count();
        Ok(path)
    }

    /// Frames written.
    pub fn frames(&self) -> usize {
        self.frames.written()
    }
}

/// An archive under construction.
struct Archive<W: io::Write + io::Seek>(ZipWriter<Deferred<W>>);

impl<W: io::Write + io::Seek> Archive<W> {
    fn start(&mut self, name: &str, large: bool) -> io::Result<()> {
        let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored).large_file(large);
        Ok(self.0.start_file(npyz::npz::file_name_from_array_name(name), options)?)
    }

    fn add(&mut self, name: &str, shape: &[usize], values: &[f64]) -> io::Result<()> {
        // the sizes of a plain entry are kept in 32 bits, and an array has a header
        let large = values.len() >= (u32::MAX as usize - 4096) / 8;
        self.start(name, large)?;
        npy::array(&mut self.0, shape, values)
    }
}
