//! The file around a state: a magic number, the version of the format, length, checksum.

use std::cmp::Ordering;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::CheckpointError;

const MAGIC: [u8; 8] = *b"VISCOCHK";
/// Raised whenever what is saved changes.
pub(super) const VERSION: u32 = 6;
/// Magic number, version, length, checksum of all but itself.
const HEADER: usize = 24;
const CHECKSUM: std::ops::Range<usize> = 20..HEADER;

/// The bytes of a checkpoint.
pub(super) fn encode(state: &impl Serialize) -> Result<Vec<u8>, CheckpointError> {
    let mut bytes = Vec::from(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.resize(HEADER, 0);
    let mut bytes = postcard::to_extend(state, bytes).map_err(malformed)?;
    let length = (bytes.len() - HEADER) as u64;
    bytes[12..20].copy_from_slice(&length.to_le_bytes());
    let checksum = checksum(&bytes);
    bytes[CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
    Ok(bytes)
}

/// The state in the bytes of a checkpoint.
pub(super) fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, CheckpointError> {
    let (found, expected) = (bytes.len() as u64, HEADER as u64);
    let Some((header, payload)) = bytes.split_first_chunk::<HEADER>() else {
        return Err(if MAGIC.starts_with(&bytes[..bytes.len().min(8)]) && !bytes.is_empty() {
            CheckpointError::Size { found, expected }
        } else {
            CheckpointError::Foreign
        });
    };
    let number = |from: usize| u32::from_le_bytes([header[from], header[from + 1], header[from + 2], header[from + 3]]);
    if header[..8] != MAGIC {
        return Err(CheckpointError::Foreign);
    }
    let version = number(8);
    match version.cmp(&VERSION) {
        Ordering::Greater => return Err(CheckpointError::Newer { found: version, known: VERSION }),
        Ordering::Less => return Err(CheckpointError::Older { found: version, known: VERSION }),
        Ordering::Equal => {}
    }
    let length = u64::from(number(12)) | u64::from(number(16)) << 32;
    if length != payload.len() as u64 {
        return Err(CheckpointError::Size { found, expected: expected.saturating_add(length) });
    }
    let (found, expected) = (checksum(bytes), number(20));
    if found != expected {
        return Err(CheckpointError::Damaged { found, expected });
    }
    postcard::from_bytes(payload).map_err(malformed)
}

fn checksum(bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&bytes[..CHECKSUM.start]);
    hasher.update(&bytes[CHECKSUM.end..]);
    hasher.finalize()
}

fn malformed(error: postcard::Error) -> CheckpointError {
    CheckpointError::Malformed { what: error.to_string() }
}
