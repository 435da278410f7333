//! The file around its contents: a magic number, the version of the format, length, checksum. Contents are written and read
//! as a stream: no copy of them is held.

use std::cmp::Ordering;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

use crc32fast::Hasher;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::CheckpointError;

/// What a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// The state of one process.
    Whole,
    /// What several ranks have in common, and the names of the files with their rows.
    Ranks,
    /// The rows of one of them.
    Rows,
}

/// Raised whenever what is saved changes.
pub(super) const VERSION: u32 = 7;
/// Magic number, version, length, checksum of all but itself.
const HEADER: usize = 24;
const CHECKSUM: usize = 20;
/// Bytes that are hashed or read at once.
const PIECE: usize = 1 << 16;
/// The longest text that a file may hold.
const TEXT: u64 = 1 << 24;

impl Kind {
    const ALL: [Kind; 3] = [Kind::Whole, Kind::Ranks, Kind::Rows];

    fn magic(self) -> [u8; 8] {
        match self {
            Kind::Whole => *b"VISCOCHK",
            Kind::Ranks => *b"VISCORKS",
            Kind::Rows => *b"VISCOROW",
        }
    }
}

/// Writes a file, and returns its checksum.
pub(super) fn write(out: &mut BufWriter<File>, kind: Kind, contents: &impl Serialize) -> io::Result<u32> {
    out.write_all(&[0; HEADER])?;
    let mut stream = Hashing { out, piece: Vec::with_capacity(PIECE), hasher: Hasher::new(), length: 0 };
    let serialized = postcard::to_io(contents, &mut stream).map(drop);
    // an error of the medium is still there when the rest of the piece is written
    stream.spill()?;
    serialized.map_err(io::Error::other)?;
    let Hashing { hasher, length, .. } = stream;
    let mut header = Vec::with_capacity(HEADER);
    header.extend(kind.magic());
    header.extend(VERSION.to_le_bytes());
    header.extend(length.to_le_bytes());
    let mut all = Hasher::new();
    all.update(&header);
    all.combine(&hasher);
    let checksum = all.finalize();
    header.extend(checksum.to_le_bytes());
    out.seek(SeekFrom::Start(0))?;
    out.write_all(&header)?;
    Ok(checksum)
}

/// Hashes what it writes.
struct Hashing<'a> {
    out: &'a mut BufWriter<File>,
    piece: Vec<u8>,
    hasher: Hasher,
    length: u64,
}

impl Hashing<'_> {
    fn spill(&mut self) -> io::Result<()> {
        self.out.write_all(&self.piece)?;
        self.hasher.update(&self.piece);
        self.length += self.piece.len() as u64;
        self.piece.clear();
        Ok(())
    }
}

impl Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.piece.len() + bytes.len() > PIECE {
            self.spill()?;
        }
        self.piece.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What a file begins like, if it is one of these.
pub(super) fn kind_at(path: &Path) -> Option<Kind> {
    let mut magic = [0; 8];
    File::open(path).and_then(|mut file| file.read_exact(&mut magic)).ok()?;
    Kind::ALL.into_iter().find(|kind| kind.magic() == magic)
}

/// A file that was found to be whole.
#[derive(Debug)]
pub(super) struct Whole {
    file: File,
    pub(super) kind: Kind,
    pub(super) checksum: u32,
    length: u64,
}

impl Whole {
    /// Opens a file of this format, and checks its checksum.
    pub(super) fn open(path: &Path) -> Result<Whole, CheckpointError> {
        let mut file = File::open(path).map_err(unreadable)?;
        let found = file.metadata().map_err(unreadable)?.len();
        let mut header = Vec::with_capacity(HEADER);
        (&file).take(HEADER as u64).read_to_end(&mut header).map_err(unreadable)?;
        let begins = |kind: &Kind| kind.magic().starts_with(&header[..header.len().min(8)]);
        let Some(kind) = Kind::ALL.into_iter().find(begins).filter(|_| !header.is_empty()) else {
            return Err(CheckpointError::Foreign);
        };
        let Some(header) = header.first_chunk::<HEADER>() else {
            return Err(CheckpointError::Size { found, expected: HEADER as u64 });
        };
        let number =
            |from: usize| u32::from_le_bytes([header[from], header[from + 1], header[from + 2], header[from + 3]]);
        let version = number(8);
        match version.cmp(&VERSION) {
            Ordering::Greater => return Err(CheckpointError::Newer { found: version, known: VERSION }),
            Ordering::Less => return Err(CheckpointError::Older { found: version, known: VERSION }),
            Ordering::Equal => {}
        }
        let length = u64::from(number(12)) | u64::from(number(16)) << 32;
        let expected = length.saturating_add(HEADER as u64);
        if expected != found {
            return Err(CheckpointError::Size { found, expected });
        }
        let mut hasher = Hasher::new();
        hasher.update(&header[..CHECKSUM]);
        let mut piece = vec![0; PIECE];
        loop {
            match file.read(&mut piece) {
                Ok(0) => break,
                Ok(count) => hasher.update(&piece[..count]),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(unreadable(error)),
            }
        }
        let (found, expected) = (hasher.finalize(), number(CHECKSUM));
        if found != expected {
            return Err(CheckpointError::Damaged { found, expected });
        }
        Ok(Whole { file, kind, checksum: expected, length })
    }

    /// What it holds.
    pub(super) fn contents<T: DeserializeOwned>(mut self) -> Result<T, CheckpointError> {
        self.file.seek(SeekFrom::Start(HEADER as u64)).map_err(unreadable)?;
        let mut text = vec![0; self.length.min(TEXT) as usize];
        let stream = BufReader::with_capacity(PIECE, self.file.take(self.length));
        let read = postcard::from_io((stream, &mut text[..])).map(|(contents, _)| contents);
        read.map_err(|error| CheckpointError::Malformed { what: error.to_string() })
    }
}

fn unreadable(error: io::Error) -> CheckpointError {
    CheckpointError::Unreadable { what: error.to_string(), kind: error.kind() }
}
