//! The file: a magic number, the version of the format, and a checksum of all that follows. First what tells its scene
//! from others, then contents, then the fields. All of it is written and read as a stream: no copy of it is held.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, ErrorKind, IntoInnerError, Read, Seek, SeekFrom, Write};
use std::path::Path;

use crc32fast::Hasher;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::check::malformed;
use super::fingerprint::{Fingerprint, require_same_scene};
use crate::error::Refusal;
use crate::file::write_numbers;
use crate::parallel::Rows;

const MAGIC: &[u8; 8] = b"VISCOCHK";
/// Raised with every change of what is saved: the `State`s of contacts and of friction, `Levels`, the `Progress` and
/// control of a run, and all that these hold; and the [fingerprint](super::fingerprint). What is new there is also
/// checked by the `fits` or `check` of its type, which the compiler does not ask for.
const VERSION: u32 = 25;
/// Where the checksum is, and where what it is of begins.
const CHECKSUM: u64 = 12;
const CONTENTS: u64 = 16;
/// Bytes that are written or read at once, and values that ranks bring.
pub(super) const PIECE: usize = 1 << 16;

/// Passes on what is written, and finds its checksum.
struct Hashed<W> {
    out: W,
    hasher: Hasher,
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// A file that is being written.
pub(crate) struct CheckpointWriter<'a, W: Write>(BufWriter<Hashed<&'a mut W>>);

impl<'a, W: Write + Seek> CheckpointWriter<'a, W> {
    pub(crate) fn begin(
        out: &'a mut W,
        scene: &Fingerprint,
        contents: &impl Serialize,
    ) -> io::Result<CheckpointWriter<'a, W>> {
        out.write_all(&[&MAGIC[..], &VERSION.to_le_bytes(), &[0; (CONTENTS - CHECKSUM) as usize]].concat())?;
        let mut out = BufWriter::with_capacity(PIECE, Hashed { out, hasher: Hasher::new() });
        let scene: Vec<_> = scene.iter().map(|(_, numbers)| numbers).collect();
        postcard::to_io(&(scene, contents), &mut out).map_err(io::Error::other)?;
        Ok(CheckpointWriter(out))
    }

    pub(super) fn values(&mut self, values: &[f64]) -> io::Result<()> {
        write_numbers(&mut self.0, values.iter().copied())
    }

    /// Completes the file.
    pub(crate) fn finish(self) -> io::Result<()> {
        let Hashed { out, hasher } = self.0.into_inner().map_err(IntoInnerError::into_error)?;
        out.seek(SeekFrom::Start(CHECKSUM))?;
        out.write_all(&hasher.finalize().to_le_bytes())
    }
}

/// A file that is being read.
pub(crate) struct CheckpointReader<R> {
    file: R,
    pub(super) stated_checksum: u32,
    /// Where the field that is read next begins.
    field: u64,
}

impl CheckpointReader<BufReader<File>> {
    /// Opens a file of this format.
    pub(crate) fn open(path: &Path) -> Result<Self, Refusal> {
        CheckpointReader::begin(BufReader::with_capacity(PIECE, File::open(path).map_err(unreadable)?))
    }
}

impl<R: Read + Seek> CheckpointReader<R> {
    /// Reads what begins a file of this format.
    pub(crate) fn begin(mut file: R) -> Result<CheckpointReader<R>, Refusal> {
        let mut header = Vec::new();
        (&mut file).take(CONTENTS).read_to_end(&mut header).map_err(unreadable)?;
        if !header.starts_with(MAGIC) {
            let what = "not a checkpoint: the magic number is missing";
            return Err(Refusal::file("checkpoint_foreign", what, ""));
        }
        let mut numbers = header[MAGIC.len()..].as_chunks().0.iter().copied().map(u32::from_le_bytes);
        let (Some(found), Some(stated_checksum)) = (numbers.next(), numbers.next()) else {
            return Err(damaged());
        };
        if found != VERSION {
            let what = format!("the checkpoint is of format {found}, this version reads format {VERSION}");
            let is_newer = found > VERSION;
            let remedy = if is_newer { ": update viscocontact" } else { ": resume it with the version that wrote it" };
            return Err(Refusal::file("checkpoint_format", what, remedy));
        }
        Ok(CheckpointReader { file, stated_checksum, field: 0 })
    }

    /// Whether the file holds what was written.
    pub(crate) fn is_intact(&mut self) -> bool {
        let mut all = Hashed { out: io::sink(), hasher: Hasher::new() };
        let read = self.file.seek(SeekFrom::Start(CONTENTS)).and_then(|_| io::copy(&mut self.file, &mut all));
        read.is_ok() && all.hasher.finalize() == self.stated_checksum
    }

    /// Reads the contents, unless they are of another scene.
    pub(crate) fn contents<T: DeserializeOwned>(&mut self, scene: &Fingerprint) -> Result<T, Refusal> {
        self.file.seek(SeekFrom::Start(CONTENTS)).map_err(unreadable)?;
        require_same_scene(&self.read::<Vec<Vec<f64>>>()?, scene)?;
        let contents = self.read()?;
        self.field = self.file.stream_position().map_err(unreadable)?;
        Ok(contents)
    }

    fn read<T: DeserializeOwned>(&mut self) -> Result<T, Refusal> {
        // for one number at a time: nothing in a file is a text, which would need more room
        let mut room = [0; size_of::<f64>()];
        let read = postcard::from_io((&mut self.file, &mut room));
        read.map(|(own, _)| own).map_err(|error| malformed(&error.to_string()))
    }

    /// Reads the local rows of the next field.
    pub(super) fn field(&mut self, rows: &Rows) -> Result<Vec<f64>, Refusal> {
        let (own, columns) = (rows.own(), rows.cells()[1]);
        self.file.seek(SeekFrom::Start(self.field + 8 * (own.start * columns) as u64)).map_err(unreadable)?;
        self.field += 8 * rows.len() as u64;
        let (mut values, mut bytes) = (Vec::with_capacity(own.len() * columns), [0; 8]);
        for _ in 0..own.len() * columns {
            self.file.read_exact(&mut bytes).map_err(unreadable)?;
            values.push(f64::from_le_bytes(bytes));
        }
        Ok(values)
    }
}

fn unreadable(error: io::Error) -> Refusal {
    match error.kind() {
        ErrorKind::UnexpectedEof => malformed("fields that do not fit its region"),
        kind => Refusal::file("checkpoint_unreadable", format!("it cannot be read: {error}"), "").of_system(kind),
    }
}

/// The error of a file that does not hold what was written.
pub(crate) fn damaged() -> Refusal {
    let what = "the checkpoint is damaged or truncated: its checksum is not that of its contents";
    Refusal::file("checkpoint_damaged", what, "")
}
