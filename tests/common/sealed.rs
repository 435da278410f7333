//! Checkpoints of changed content: the checksum that belongs to it.

/// Where the checksum is: after mark and version, before the contents.
pub const CHECKSUM: std::ops::Range<usize> = 12..16;

/// CRC-32 of IEEE 802.3, bit by bit.
fn crc(bytes: impl Iterator<Item = u8>) -> u32 {
    !bytes.fold(!0, |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
    })
}

/// Writes the checksum into a file that is long enough for it.
pub fn seal(file: &mut [u8]) {
    if file.len() >= CHECKSUM.end {
        let right = crc(file[CHECKSUM.end..].iter().copied());
        file[CHECKSUM].copy_from_slice(&right.to_le_bytes());
    }
}
