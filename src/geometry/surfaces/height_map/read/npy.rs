//! Arrays of NumPy, as described in NEP 1 and the documentation of `numpy.lib.format`.
//!
//! The header is parsed here, because general readers of arrays trust the sizes stated in it.

use std::io::Read;

use super::text::known_heights;
use super::{Header, Kind, Number, bytes, wrong_size};
use super::{entry, missing, wrong_magic};
use crate::error::Result;
use crate::file::npy::MAGIC;
use crate::geometry::{HeightMap, LengthUnit};
use crate::{Grid, memory};

const FORMAT: &str = "NPY";

impl HeightMap {
    /// Reads a two-dimensional array written by `numpy.save`: the heights in `unit` on a rectangle of `lengths` \[m\].
    /// The first axis is x1, the second x2: `heights[i, j]` belongs to the cell `[i, j]`.
    ///
    /// Needs the feature `npy`.
    ///
    /// Floats of single and double precision and integers are supported, in either byte order and in C or Fortran
    /// order. NaN, infinity and the largest number of single precision mark missing points. Convert an image, whose
    /// first axis points down, by `numpy.flipud(image).T`.
    ///
    /// # Errors
    /// If the file cannot be read, is malformed or contains another type of
    /// array; as [`HeightMap::new`] if its map is invalid.
    pub fn from_npy(reader: impl Read, lengths: [f64; 2], unit: LengthUnit) -> Result<HeightMap> {
        let file = bytes(reader, FORMAT)?;
        let (header, data) = split(&file)?;
        // the text of an entry ends where the next one begins
        let entry = |key: &str| {
            let (_, rest) = header.split_once(&format!("'{key}'"))?;
            let rest = rest.trim_start().strip_prefix(':').unwrap_or_default();
            Some(rest.split(", '").next()?.split(",'").next()?.split('}').next()?.trim_end_matches([',', ' ', '\n']))
        };
        let header = Header::new(FORMAT, entry);
        let text = header.require("descr")?;
        let allowed = "a float of 4 or 8 bytes or an integer, such as '<f8'";
        let descr = text.strip_prefix('\'').and_then(|text| text.strip_suffix('\''));
        let number = descr.and_then(number).ok_or_else(|| header.error("descr", text, allowed))?;
        let fortran = match header.require("fortran_order")? {
            "True" => true,
            "False" => false,
            text => return Err(header.error("fortran_order", text, "True or False")),
        };
        let text = header.require("shape")?;
        let sides = text.strip_prefix('(').and_then(|text| text.split_once(')')).map_or("", |(sides, _)| sides);
        let sides = sides.split(',').map(str::trim).filter(|side| !side.is_empty());
        let sides: Result<Vec<usize>, _> = sides.map(str::parse).collect();
        let Ok(&[n1, n2]) = sides.as_deref() else { return Err(header.error("shape", text, "two numbers")) };
        let count = Grid::new([n1, n2], lengths)?.len();
        let stored = number.decode_all(FORMAT, data, count, true)?;
        known_heights(&stored)?;
        let index = |i: usize, j: usize| if fortran { j * n1 + i } else { i * n2 + j };
        let heights = (0..n1).flat_map(|i| (0..n2).map(move |j| index(i, j))).map(|k| unit.to_metres(stored[k]));
        HeightMap::new([n1, n2], lengths, memory::collect("the heights of a file", count, heights)?)
    }
}

/// Splits a file into header and data.
fn split(file: &[u8]) -> Result<(String, &[u8])> {
    let Some(rest) = file.strip_prefix(MAGIC) else {
        return Err(wrong_magic(FORMAT, "\\x93NUMPY"));
    };
    let (length, start) = match *rest {
        [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([a, b])), 4),
        [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([a, b, c, d]) as usize, 6),
        [1..=3, ..] | [] => return Err(missing(FORMAT, "header")),
        [version, ..] => return Err(entry(FORMAT, "version", &version.to_string(), "1, 2 or 3")),
    };
    let rest = &rest[start..];
    if rest.len() < length {
        return Err(wrong_size(FORMAT, "bytes of header", rest.len(), length));
    }
    let (header, data) = rest.split_at(length);
    // Python strings may have either kind of quotes
    Ok((String::from_utf8_lossy(header).replace('"', "'"), data))
}

/// The number type of a description such as `<f8`.
fn number(descr: &str) -> Option<Number> {
    let (order, rest) = descr.split_at_checked(1)?;
    let (kind, size) = rest.split_at_checked(1)?;
    let big_endian = match order {
        "<" => false,
        ">" => true,
        "|" if size == "1" => false,
        _ => return None,
    };
    let size = size.parse().ok()?;
    let kind = match (kind, size) {
        ("f", 4 | 8) => Kind::Float,
        ("i", 1 | 2 | 4 | 8) => Kind::Signed,
        ("u", 1 | 2 | 4 | 8) => Kind::Unsigned,
        _ => return None,
    };
    Some(Number { kind, size, big_endian })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    /// A file as written by `numpy.save`, but without padding.
    fn file(header: &str, data: &[u8]) -> Vec<u8> {
        [MAGIC, &[1, 0], &(header.len() as u16).to_le_bytes(), header.as_bytes(), data].concat()
    }

    fn read(file: &[u8]) -> Result<HeightMap> {
        HeightMap::from_npy(file, [2.0, 6.0], LengthUnit::Millimetre)
    }

    #[test]
    fn axes_are_x1_and_x2_in_either_order() {
        let expected =
            HeightMap::new([2, 3], [2.0, 6.0], [1, 2, 3, 4, 5, 6].map(|h| f64::from(h) / 1e3).into()).unwrap();
        let c: Vec<u8> = [1.0_f64, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|h| h.to_le_bytes()).collect();
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }\n";
        assert_eq!(read(&file(header, &c)).unwrap(), expected);
        let fortran: Vec<u8> = [1_i16, 4, 2, 5, 3, 6].iter().flat_map(|h| h.to_be_bytes()).collect();
        let header = r#"{"shape":(2,3,),"fortran_order":True,"descr":">i2"}"#;
        assert_eq!(read(&file(header, &fortran)).unwrap(), expected);
        let floats: Vec<u8> = [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|h| h.to_be_bytes()).collect();
        let header = "{'descr': '>f4', 'fortran_order': False, 'shape': (2, 3), }      \n";
        assert_eq!(read(&file(header, &floats)).unwrap(), expected);
        let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }";
        assert_eq!(read(&file(header, &[1, 2, 3, 4, 5, 6])).unwrap(), expected);
        let long = [MAGIC, &[2, 0, header.len() as u8, 0, 0, 0], header.as_bytes(), &[1, 2, 3, 4, 5, 6]].concat();
        assert_eq!(read(&long).unwrap(), expected);
    }

    #[test]
    fn errors_of_malformed_files_name_the_defect() {
        let header = "{'descr': '|i1', 'fortran_order': False, 'shape': (2, 3), }";
        let with = |from: &str, to: &str| read(&file(&header.replace(from, to), &[0; 6])).unwrap_err();
        for key in ["descr", "fortran_order", "shape"] {
            assert_eq!(with(key, "other"), missing(FORMAT, key));
        }
        for descr in ["'<f2'", "'<c8'", "'|O'", "'<U3'", "'<i3'", "'=f8'", "''", "'µ'", "[('a', '<f8')]", "'<f80'", "7"]
        {
            let error = with("'|i1'", descr);
            assert!(error.is("map_entry", "descr"), "{error}");
        }
        for shape in ["()", "(6,)", "(1, 2, 3)", "(2, x)", "(2, -3)", "2, 3", "(2, 3", "(99999999999999999999, 1)"] {
            let error = with("(2, 3)", shape);
            assert!(error.is("map_entry", "shape"), "{error}");
        }
        assert!(with("False", "None").is("map_entry", "fortran_order"));
        assert!(matches!(with("(2, 3)", "(0, 3)"), Error::CountOutOfRange { value: 0, .. }));
        assert!(matches!(with("(2, 3)", "(18446744073709551615, 3)"), Error::CountOutOfRange { .. }));
        let size = |found, expected| wrong_size(FORMAT, "bytes of heights", found, expected);
        assert_eq!(with("(2, 3)", "(4000000000, 1)"), size(6, 4_000_000_000));
        assert_eq!(with("(2, 3)", "(2, 2)"), size(6, 4));
        let whole = file(header, &[0; 6]);
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length}");
        }
        assert!(read(b"\x93NUMPX").is_err_and(|error| error.code() == "map_magic"));
        assert!(read(b"\x93NUMPY\x09\0\0\0\0\0").is_err_and(|error| error.is("map_entry", "version")));
        let absurd = b"\x93NUMPY\x02\0\xff\xff\xff\xff{}";
        assert!(read(absurd).is_err_and(|error| error.to_string().contains("bytes of header, but holds")));
    }
}
