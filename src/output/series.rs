//! A run as a folder of frames.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::Result;
use crate::fields::Fields;
use crate::file::{check_regular, failed, replace};
use crate::output::field_values::write_fields;
#[cfg(feature = "npy")]
use crate::output::npz;
use crate::output::time_of;
use crate::output::vtk;
use crate::output::{Earlier, Field, Format, Kept, Metadata};

/// Name of the file that lists the frames of VTK.
const COLLECTION: &str = "series.pvd";

/// A run as a folder of files, one per frame, with the same fields and metadata in each.
///
/// ```
/// # #[cfg(feature = "npy")] {
/// use viscocontact::{output::{Earlier, Field, Format, FrameSeries, Metadata}, prelude::*};
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
///     .build()?;
/// # let folder = std::env::temp_dir().join(format!("viscocontact-doc-series-{}", std::process::id()));
/// let metadata = Metadata::new("Ball on rubber");
/// let mut series = FrameSeries::create(&folder, Format::Npz, &metadata, &contact, &[Field::Pressure], Earlier::Refuse)?;
/// contact.step(0.0, Load::force(0.5))?;
/// for _ in 0..3 {
///     contact.step(0.1, Load::force(0.5))?;
///     series.record(&contact)?;
/// }
/// assert!(folder.join("frame_000002.npz").exists());
/// # std::fs::remove_dir_all(&folder).unwrap();
/// # }
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug)]
pub struct FrameSeries {
    folder: PathBuf,
    format: Format,
    metadata: Metadata,
    fields: Vec<Field>,
    /// Number of frames written.
    written: usize,
    /// The entries of the collection, one per line.
    entries: String,
    /// Values of a field that the contact does not store.
    buffer: Vec<f64>,
}

impl FrameSeries {
    /// A series of `contact` in `folder`, which is created if it does not exist.
    ///
    /// # Errors
    /// If the folder cannot be used, contains frames where [`Earlier`] refuses them or one that cannot be read where
    /// they are continued, or a field is requested twice.
    pub fn create<'a>(
        folder: impl AsRef<Path>,
        format: Format,
        metadata: &Metadata,
        contact: impl Into<Fields<'a>>,
        fields: &[Field],
        earlier: Earlier,
    ) -> Result<FrameSeries> {
        let folder = folder.as_ref();
        let unusable = |error: io::Error| failed(folder, error);
        let refused = |kind, reason: String| Err(unusable(io::Error::new(kind, reason)));
        if let Some(k) = (1..fields.len()).find(|&k| fields[..k].contains(&fields[k])) {
            let reason = format!("the field {} is requested twice", fields[k].name());
            return refused(io::ErrorKind::InvalidInput, reason);
        }
        if folder.is_file() {
            return refused(io::ErrorKind::AlreadyExists, "it is a file, and frames need a folder".into());
        }
        fs::create_dir_all(folder).map_err(unusable)?;
        let (mut written, mut entries) = (0, String::new());
        if earlier == Earlier::Continue {
            (written, entries) = kept(folder, format, contact.into())?;
        }
        let kept: Vec<String> = (0..written).map(|number| format.frame(number)).collect();
        for entry in fs::read_dir(folder).map_err(unusable)? {
            let path = entry.map_err(unusable)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let is_frame = name.starts_with("frame_") && name.ends_with(&format!(".{}", format.extension()));
            if is_frame && earlier == Earlier::Refuse {
                let reason = format!("the folder contains {name} of another run: Earlier::Replace removes it");
                return refused(io::ErrorKind::AlreadyExists, reason);
            }
            let is_kept = kept.iter().any(|frame| *frame == name);
            let is_list = earlier == Earlier::Replace && format.is_vtk() && name == COLLECTION;
            if is_frame && !is_kept || is_list {
                check_regular(&path)?;
                match fs::remove_file(&path) {
                    // another rank may have removed it
                    Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(failed(&path, error)),
                    _ => {}
                }
            }
        }
        let (folder, metadata, fields) = (folder.to_owned(), metadata.clone(), fields.to_vec());
        Ok(FrameSeries { folder, format, metadata, fields, written, entries, buffer: Vec::new() })
    }

    /// Writes the current state of the contact as the next frame and returns its path; a frame of VTK is listed in
    /// `series.pvd`.
    ///
    /// # Errors
    /// If a file cannot be written. Then the frame is not listed, and the next call uses the same number.
    pub fn record<'a>(&mut self, contact: impl Into<Fields<'a>>) -> Result<PathBuf> {
        let contact = contact.into();
        let FrameSeries { folder, format, metadata, fields, buffer, .. } = self;
        let name = format.frame(self.written);
        let path = folder.join(&name);
        let area = contact.contact_area();
        write_fields(&path, (contact, fields, *format), buffer, |out, values| match format {
            #[cfg(feature = "npy")]
            Format::Npz => npz::write_frame(out, (contact, area), metadata, values),
            Format::Vtk => vtk::write_frame(out, (contact, area), metadata, values),
        })?;
        if format.is_vtk() {
            let entries = format!("{}{}", self.entries, entry(time_of(contact), &name));
            contact.by_one_rank(|| {
                replace(&folder.join(COLLECTION), |out| {
                    write!(
                        out,
                        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n\
                         {entries}  </Collection>\n</VTKFile>\n"
                    )
                })
            })?;
            self.entries = entries;
        }
        self.written += 1;
        Ok(path)
    }

    /// Number of frames written.
    pub fn frames(&self) -> usize {
        self.written
    }
}

/// The number of the frames of an earlier series up to the state of a contact, and their entries in the collection.
fn kept(folder: &Path, format: Format, contact: Fields<'_>) -> Result<(usize, String)> {
    let (mut kept, mut entries) = (Kept::default(), Vec::new());
    loop {
        let path = folder.join(format.frame(entries.len()));
        let no_frame = |error: io::Error| {
            let reason = format!("it is no frame to continue from ({error}): Earlier::Replace removes it");
            failed(&path, io::Error::new(error.kind(), reason))
        };
        let state = match (fs::File::open(&path), format) {
            (Err(error), _) if error.kind() == io::ErrorKind::NotFound => break,
            (Err(error), _) => Err(error),
            #[cfg(feature = "npy")]
            (Ok(frame), Format::Npz) => npz::state_of(frame),
            (Ok(frame), Format::Vtk) => vtk::state_of(frame),
        };
        let state = state.map_err(no_frame)?;
        entries.push(entry(state[0], &format.frame(entries.len())));
        if !kept.includes(entries.len() as u64, state, [time_of(contact), contact.force(), contact.approach()]) {
            break;
        }
    }
    entries.truncate(kept.end() as usize);
    Ok((entries.len(), entries.concat()))
}

/// The entry of a frame in the collection.
fn entry(time: f64, name: &str) -> String {
    format!("    <DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{name}\"/>\n")
}
