//! Archives in the NPZ format of NumPy.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use crate::Grid;
use crate::fields::Fields;
use crate::file::{npy, write_numbers};
use crate::output::deferred::Deferred;
use crate::output::field_values::FieldValues;
use crate::output::{Metadata, time_of};

/// Writes a frame; `area` is the contact area.
pub(super) fn write_frame(
    out: &mut (impl Write + Seek),
    (contact, area): (Fields<'_>, f64),
    metadata: &Metadata,
    values: &mut FieldValues<'_>,
) -> io::Result<()> {
    let cells = contact.grid().cells();
    let mut archive = Archive::new(out, time_of(contact), contact.grid())?;
    for field in values.fields {
        let mut array = archive.array(field.name(), &cells)?;
        values.next(|part| write_numbers(&mut array, part.iter().copied()))?;
        array.flush()?;
    }
    archive.add("approach", &[], &[contact.approach()])?;
    archive.add("force", &[], &[contact.force()])?;
    archive.add("tilt", &[2], &contact.tilt())?;
    archive.add("contact_area", &[], &[area])?;
    archive.finish(&metadata.of(Some(contact)))
}

/// Time, force and approach of a frame.
pub(super) fn state_of(frame: File) -> io::Result<[f64; 3]> {
    let (mut archive, mut state) = (ZipArchive::new(frame)?, [0.0; 3]);
    for (number, name) in state.iter_mut().zip(["time.npy", "force.npy", "approach.npy"]) {
        let mut bytes = Vec::new();
        archive.by_name(name)?.read_to_end(&mut bytes)?;
        *number = f64::from_le_bytes(*bytes.last_chunk().ok_or(io::ErrorKind::InvalidData)?);
    }
    Ok(state)
}

/// An NPZ archive being written.
pub(super) struct Archive<W: Write + Seek>(ZipWriter<Deferred<W>>);

impl<W: Write + Seek> Archive<W> {
    /// An archive without arrays.
    pub(super) fn empty(out: W) -> Archive<W> {
        Archive(ZipWriter::new(Deferred::new(out)))
    }

    /// An archive that begins with the time and the cell centres.
    pub(super) fn new(out: W, time: f64, grid: &Grid) -> io::Result<Archive<W>> {
        let mut archive = Archive::empty(out);
        archive.add("time", &[], &[time])?;
        for (axis, name) in ["x1", "x2"].into_iter().enumerate() {
            let cells = grid.cells()[axis];
            let centers: Vec<f64> = (0..cells).map(|k| grid.coordinate(axis, k)).collect();
            archive.add(name, &[cells], &centers)?;
        }
        Ok(archive)
    }

    /// Adds an array in row-major order.
    pub(super) fn add(&mut self, name: &str, shape: &[usize], values: &[f64]) -> io::Result<()> {
        let mut array = self.array(name, shape)?;
        write_numbers(&mut array, values.iter().copied())?;
        array.flush()
    }

    /// Begins an array, whose numbers are to be written and flushed.
    fn array(&mut self, name: &str, shape: &[usize]) -> io::Result<impl Write> {
        // plain entries have sizes of 32 bits, including the header of the array
        let large = shape.iter().product::<usize>() >= (u32::MAX as usize - 4096) / 8;
        self.start(name, large, &npy::header("<f8", shape))?;
        Ok(BufWriter::with_capacity(1 << 16, &mut self.0))
    }

    /// Adds the metadata, as a zero-dimensional array of one string, and completes the archive.
    pub(super) fn finish(mut self, metadata: &str) -> io::Result<()> {
        let text: Vec<u8> = metadata.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        self.start("metadata", false, &npy::header(&format!("<U{}", text.len() / 4), &[]))?;
        self.0.write_all(&text)?;
        self.0.finish()?.finish()
    }

    fn start(&mut self, name: &str, large: bool, header: &[u8]) -> io::Result<()> {
        let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored).large_file(large);
        self.0.start_file(format!("{name}.npy"), options)?;
        self.0.write_all(header)
    }
}
