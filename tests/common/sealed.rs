//! Checkpoints of changed content: the length and the checksum that belong to it.

/// Where the checksum is: after mark, version and length, before the state.
pub const CHECKSUM: std::ops::Range<usize> = 20..24;

/// CRC-32 of IEEE 802.3, bit by bit.
fn crc(bytes: impl Iterator<Item = u8>) -> u32 {
    !bytes.fold(!0, |crc: u32, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
    })
}

/// Writes length and checksum into a file that is long enough for both.
pub fn seal(file: &mut [u8]) {
    if file.len() >= CHECKSUM.end {
        let length = (file.len() - CHECKSUM.end) as u64;
        file[12..CHECKSUM.start].copy_from_slice(&length.to_le_bytes());
        let right = crc(file[..CHECKSUM.start].iter().chain(&file[CHECKSUM.end..]).copied());
        file[CHECKSUM].copy_from_slice(&right.to_le_bytes());
    }
}
