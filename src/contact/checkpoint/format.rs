//! The file around its contents: a magic number, the version of the format, length, checksum. Contents are written
//! and read as a stream: no copy of them is held.

use std::cmp::Ordering;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use crc32fast::Hasher;
use serde::de::DeserializeOwned;

use crate::error::CheckpointError;
use crate::parallel::Rows;

const MAGIC: &[u8; 8] = b"VISCOCHK";
/// Raised with every change of the contents.
pub(crate) const VERSION: u32 = 19;
/// Magic number, version, length, checksum of all but itself.
const HEADER: usize = 24;
const CHECKSUM: usize = 20;
/// Bytes that are hashed or read at once.
const PIECE: usize = 1 << 16;
/// The longest text that a file may hold.
const TEXT: u64 = 1 << 24;

/// A file that is being written: hashes what goes into it.
pub(crate) struct Output<'a> {
    out: &'a mut BufWriter<File>,
    hasher: Hasher,
    length: u64,
}

impl<'a> Output<'a> {
    pub(crate) fn begin(out: &'a mut BufWriter<File>) -> io::Result<Output<'a>> {
        out.write_all(&[0; HEADER])?;
        Ok(Output { out, hasher: Hasher::new(), length: 0 })
    }

    /// Writes the header, once all contents are there.
    pub(crate) fn finish(self) -> io::Result<()> {
        let mut header = Vec::with_capacity(HEADER);
        header.extend(MAGIC);
        header.extend(VERSION.to_le_bytes());
        header.extend(self.length.to_le_bytes());
        let mut all = Hasher::new();
        all.update(&header);
        all.combine(&self.hasher);
        header.extend(all.finalize().to_le_bytes());
        self.out.seek(SeekFrom::Start(0))?;
        self.out.write_all(&header)
    }
}

impl Write for Output<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write_all(bytes)?;
        self.hasher.update(bytes);
        self.length += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// A file that is being read.
#[derive(Debug)]
pub(crate) struct Input {
    file: BufReader<File>,
    header: [u8; HEADER],
    /// Bytes of the contents.
    length: u64,
    /// Where the values that are read next begin.
    values: u64,
}

impl Input {
    /// Opens a file of this format and of the length that it states.
    pub(crate) fn open(path: &Path) -> Result<Input, CheckpointError> {
        let mut file = File::open(path).map_err(unreadable)?;
        let found = file.metadata().map_err(unreadable)?.len();
        let mut header = Vec::with_capacity(HEADER);
        (&mut file).take(HEADER as u64).read_to_end(&mut header).map_err(unreadable)?;
        if header.is_empty() || !MAGIC.starts_with(&header[..header.len().min(MAGIC.len())]) {
            return Err(CheckpointError::Foreign);
        }
        let Some(&header) = header.first_chunk::<HEADER>() else {
            return Err(CheckpointError::Size { found, expected: HEADER as u64 });
        };
        let version = number(&header, 8);
        match version.cmp(&VERSION) {
            Ordering::Greater => return Err(CheckpointError::Newer { found: version, known: VERSION }),
            Ordering::Less => return Err(CheckpointError::Older { found: version, known: VERSION }),
            Ordering::Equal => {}
        }
        let length = u64::from(number(&header, 12)) | u64::from(number(&header, 16)) << 32;
        let expected = length.saturating_add(HEADER as u64);
        if expected != found {
            return Err(CheckpointError::Size { found, expected });
        }
        Ok(Input { file: BufReader::with_capacity(PIECE, file), header, length, values: 0 })
    }

    /// The checksum that the file states.
    pub(crate) fn stated_checksum(&self) -> u32 {
        number(&self.header, CHECKSUM)
    }

    /// The checksum of what the file holds.
    pub(crate) fn checksum(&mut self) -> Result<u32, CheckpointError> {
        self.file.seek(SeekFrom::Start(HEADER as u64)).map_err(unreadable)?;
        let mut hasher = Hasher::new();
        hasher.update(&self.header[..CHECKSUM]);
        while let piece @ [_, ..] = self.file.fill_buf().map_err(unreadable)? {
            hasher.update(piece);
            let read = piece.len();
            self.file.consume(read);
        }
        Ok(hasher.finalize())
    }

    /// Refuses a file with another checksum than it states.
    pub(crate) fn require_checksum(&self, found: u32) -> Result<(), CheckpointError> {
        let expected = self.stated_checksum();
        if found == expected { Ok(()) } else { Err(CheckpointError::Damaged { found, expected }) }
    }

    /// Reads what the file begins with.
    pub(crate) fn contents<T: DeserializeOwned>(&mut self) -> Result<T, CheckpointError> {
        self.file.seek(SeekFrom::Start(HEADER as u64)).map_err(unreadable)?;
        let mut text = vec![0; self.length.min(TEXT) as usize];
        let read = postcard::from_io((&mut self.file, &mut text[..])).map(|(contents, _)| contents);
        let contents = read.map_err(|error| CheckpointError::Malformed { what: error.to_string() })?;
        self.values = self.file.stream_position().map_err(unreadable)?;
        Ok(contents)
    }

    /// Whether so many values follow what the file begins with.
    pub(crate) fn has_values(&self, count: u64) -> bool {
        count.checked_mul(8).and_then(|bytes| bytes.checked_add(self.values)) == Some(self.length + HEADER as u64)
    }

    /// Reads one value for each local cell, of the next values of all cells.
    pub(crate) fn rows(&mut self, rows: &Rows) -> Result<Vec<f64>, CheckpointError> {
        let (own, columns) = (rows.own(), rows.cells()[1]);
        self.file.seek(SeekFrom::Start(self.values + 8 * (own.start * columns) as u64)).map_err(unreadable)?;
        self.values += 8 * rows.len() as u64;
        let (mut values, mut bytes) = (Vec::with_capacity(own.len() * columns), [0; 8]);
        for _ in 0..own.len() * columns {
            self.file.read_exact(&mut bytes).map_err(unreadable)?;
            values.push(f64::from_le_bytes(bytes));
        }
        Ok(values)
    }
}

fn number(header: &[u8; HEADER], from: usize) -> u32 {
    u32::from_le_bytes([header[from], header[from + 1], header[from + 2], header[from + 3]])
}

fn unreadable(error: io::Error) -> CheckpointError {
    CheckpointError::Unreadable { what: error.to_string(), kind: error.kind() }
}
