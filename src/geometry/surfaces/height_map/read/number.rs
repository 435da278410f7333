//! Numbers in binary files.

use super::wrong_size;
use crate::error::Result;
use crate::memory;

/// The magnitude from which a number stands for a point without a height: the largest number of single precision, in
/// seven digits, with which many programs mark it, as others do by infinity.
const MISSING: f64 = 3.402823e38;

/// Whether a word stands for a missing point by its `number`; a number that overflows is none.
pub(super) fn is_missing(word: &str, number: f64) -> bool {
    number.abs() >= MISSING && (number.is_finite() || !word.contains(|c: char| c.is_ascii_digit()))
}

/// Binary representation of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Number {
    pub(super) kind: Kind,
    /// Size in bytes: 1, 2, 4 or 8; 4 or 8 for a float.
    pub(super) size: usize,
    pub(super) big_endian: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Signed,
    #[cfg_attr(not(feature = "npy"), allow(dead_code, reason = "only NPY files have unsigned numbers"))]
    Unsigned,
    Float,
}

impl Number {
    pub(super) const fn little(kind: Kind, size: usize) -> Number {
        Number { kind, size, big_endian: false }
    }

    /// The number represented by `bytes`.
    pub(super) fn decode(self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        for (k, &byte) in bytes.iter().enumerate() {
            word[if self.big_endian { self.size - 1 - k } else { k }] = byte;
        }
        let word = u64::from_le_bytes(word);
        let unused = 64 - 8 * self.size;
        match self.kind {
            Kind::Unsigned => word as f64,
            Kind::Signed => ((word << unused) as i64 >> unused) as f64,
            Kind::Float if self.size == 4 => f32::from_bits(word as u32).into(),
            Kind::Float => f64::from_bits(word),
        }
    }

    /// The least whole number; floats that stand for missing points are NaN already.
    pub(super) fn least(self) -> f64 {
        if self.kind == Kind::Signed { -(2.0_f64.powi(8 * self.size as i32 - 1)) } else { f64::NAN }
    }

    /// The first `count` heights of `data`, NaN for missing points; if `exact`, further data are an error.
    pub(super) fn decode_all(self, format: &'static str, data: &[u8], count: usize, exact: bool) -> Result<Vec<f64>> {
        let expected = count.saturating_mul(self.size);
        if data.len() < expected || exact && data.len() > expected {
            return Err(wrong_size(format, "bytes of heights", data.len(), expected));
        }
        let height = |bytes| Some(self.decode(bytes)).filter(|height| height.abs() < MISSING).unwrap_or(f64::NAN);
        let numbers = data.chunks_exact(self.size).take(count).map(height);
        memory::collect("the numbers of a file", count, numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_decoded() {
        let number = |kind, size, big_endian| Number { kind, size, big_endian };
        assert_eq!(number(Kind::Signed, 1, false).decode(&[0xfe]), -2.0);
        assert_eq!(number(Kind::Signed, 2, true).decode(&(-300_i16).to_be_bytes()), -300.0);
        assert_eq!(number(Kind::Signed, 4, false).decode(&(-70_000_i32).to_le_bytes()), -70_000.0);
        assert_eq!(number(Kind::Signed, 8, true).decode(&(-7_i64).to_be_bytes()), -7.0);
        assert_eq!(number(Kind::Unsigned, 2, true).decode(&65_000_u16.to_be_bytes()), 65_000.0);
        assert_eq!(number(Kind::Unsigned, 8, false).decode(&(1_u64 << 63).to_le_bytes()), 2f64.powi(63));
        assert_eq!(number(Kind::Float, 4, true).decode(&1.5e-7_f32.to_be_bytes()), f64::from(1.5e-7_f32));
        assert_eq!(number(Kind::Float, 8, false).decode(&(-1.1e-7_f64).to_le_bytes()), -1.1e-7);
        assert_eq!(number(Kind::Signed, 2, false).least(), -32768.0);
        assert_eq!(number(Kind::Signed, 4, false).least(), f64::from(i32::MIN));
    }
}
