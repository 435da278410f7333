//! Surface data files of ISO 25178-71 and EUR 15178.
//!
//! The layout follows ISO 25178-71:2012. Records and number types of older files follow K. J. Stout et al.,
//! *The development of methods for the characterisation of roughness in three dimensions*, EUR 15178 EN (1993), as
//! documented by NIST (<https://physics.nist.gov/VSC/Help/DataFormat/SDF_Format.jsp>) and NPL
//! (<http://resource.npl.co.uk/softgauges/Help.htm>).

use std::io::Read;

use super::{First, Header, Kind, Number, bytes, count, listed, wrong_size};
use super::{missing, wrong_magic};
use crate::error::Result;
use crate::geometry::HeightMap;

const FORMAT: &str = "SDF";
/// Size of the binary header: version, manufacturer, two dates, two counts, four scales, three type bytes.
const BINARY_HEADER: usize = 8 + 10 + 2 * 12 + 2 * 2 + 4 * 8 + 3;
/// Bytes that some instruments write after the header: the numbers 5 and 1.
const EXTRA: [u8; 8] = [5, 0, 0, 0, 1, 0, 0, 0];

/// The types of numbers.
const TYPES: [&str; 8] = ["0", "1", "2", "3", "4", "5", "6", "7"];

impl HeightMap {
    /// Reads a surface data file (SDF) of ISO 25178-71 or its predecessor EUR 15178: text (`aISO-1.0`, `aBCR-1.0`) or
    /// binary (`bISO-1.0`, `bBCR-1.0`), in m.
    ///
    /// Missing points are `BAD` in text; in binary they are the least number of their type, or NaN. Binary files may
    /// have the number types 3 (single precision), 4, 5, 6 (8, 16, 32 bits, signed) and 7 (double precision), little
    /// endian. Unsigned types are not supported: sources disagree on how they mark a missing point. The first profile
    /// has the smallest x2. Dates, `Zresolution` and the trailer are ignored.
    ///
    /// ```
    /// use viscocontact::geometry::HeightMap;
    ///
    /// let file = "aISO-1.0\nNumPoints = 2\nNumProfiles = 2\nXscale = 1e-6\nYscale = 2e-6\nZscale = 1\n\
    ///             Compression = 0\nDataType = 7\nCheckType = 0\n*\n1e-8 BAD\n3e-8 4e-8\n*\n";
    /// let map = HeightMap::from_sdf(file.as_bytes())?;
    /// # let _ = map;
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the file cannot be read or is malformed, compressed or of an unknown
    /// type; as [`HeightMap::new`] if its map is invalid.
    pub fn from_sdf(reader: impl Read) -> Result<HeightMap> {
        let file = bytes(reader, FORMAT)?;
        match file.get(..8) {
            Some(b"aISO-1.0" | b"aBCR-1.0") => from_text(&String::from_utf8_lossy(&file[8..])),
            Some(b"bISO-1.0" | b"bBCR-1.0") => from_binary(&file),
            _ => Err(wrong_magic(FORMAT, "aISO-1.0, aBCR-1.0, bISO-1.0 or bBCR-1.0")),
        }
    }
}

/// Numbers of points, spacing and scale of the heights by the header. Neither compression nor a checksum is allowed.
fn described(header: &Header<'_>) -> Result<([usize; 2], [f64; 2], f64)> {
    let cells = [header.count("NumPoints")?, header.count("NumProfiles")?];
    let spacing = [header.positive("Xscale")?, header.positive("Yscale")?];
    let scale = header.positive("Zscale")?;
    for key in ["Compression", "CheckType"] {
        if header.count(key)? != 0 {
            return Err(header.error(key, header.require(key)?, "0 (none)"));
        }
    }
    Ok((cells, spacing, scale))
}

fn from_text(text: &str) -> Result<HeightMap> {
    let Some((head, rest)) = text.split_once("\n*") else {
        return Err(missing(FORMAT, "line * after the header"));
    };
    let header = Header::of_lines(FORMAT, head);
    // texts have numbers of each type
    header.get("DataType").map_or(Ok(""), |_| header.one_of("DataType", &TYPES, "a type from 0 to 7"))?;
    let (cells, spacing, scale) = described(&header)?;
    let count = count(cells, spacing)?;
    let area = rest.split('*').next().unwrap_or_default();
    let refuse = |word: &str| header.error("height", word, "a finite number or BAD");
    let rows = listed(area.split_whitespace(), |word| word.eq_ignore_ascii_case("bad"), count, FORMAT, refuse)?;
    HeightMap::from_rows(cells, spacing, &rows, First::Bottom, |height| height * scale)
}

fn from_binary(file: &[u8]) -> Result<HeightMap> {
    let Some((binary, mut data)) = file.split_at_checked(BINARY_HEADER) else {
        return Err(wrong_size(FORMAT, "bytes of header", file.len(), BINARY_HEADER));
    };
    let u16_at = |at: usize| u16::from_le_bytes([binary[at], binary[at + 1]]);
    let f64_at = |at: usize| f64::from_le_bytes(std::array::from_fn(|k| binary[at + k]));
    let ([n1, n2], [x, y, z]) = ([42, 44].map(u16_at), [46, 54, 62].map(f64_at));
    let [compression, data_type, check] = [78, 79, 80].map(|at| binary[at]);
    // the header that a text file has
    let lines = format!(
        "NumPoints {n1}\nNumProfiles {n2}\nXscale {x:e}\nYscale {y:e}\nZscale {z:e}\n\
         Compression {compression}\nDataType {data_type}\nCheckType {check}"
    );
    let header = Header::of_lines(FORMAT, &lines);
    let (cells, spacing, scale) = described(&header)?;
    let number = match header.require("DataType")? {
        "3" => Number::little(Kind::Float, 4),
        "4" => Number::little(Kind::Signed, 1),
        "5" => Number::little(Kind::Signed, 2),
        "6" => Number::little(Kind::Signed, 4),
        "7" => Number::little(Kind::Float, 8),
        other => return Err(header.error("DataType", other, "3, 4, 5, 6 or 7 (signed)")),
    };
    let count = count(cells, spacing)?;
    if data.len() as u64 == count as u64 * number.size as u64 + 8 {
        data = data.strip_prefix(&EXTRA).unwrap_or(data);
    }
    let mut rows = number.decode_all(FORMAT, data, count, false)?;
    rows.iter_mut().filter(|height| **height == number.least()).for_each(|height| *height = f64::NAN);
    HeightMap::from_rows(cells, spacing, &rows, First::Bottom, |height| height * scale)
}

#[cfg(test)]
mod tests {
    use super::super::entry;
    use super::super::tests::binary_sdf as binary;
    use super::*;
    use crate::Error;

    const TEXT: &str = "aISO-1.0\r\nManufacID = Nobody\r\nCreateDate = 010120240000\r\nModDate = 010120240000\r\n\
        NumPoints = 3\r\nNumProfiles = 2\r\nXscale = 1e-6\r\nYscale = 2.5E-06\r\nZscale = 1e-9\r\nZresolution = -1\r\n\
        Compression = 0\r\nDataType = 7\r\nCheckType = 0\r\n*\r\n1 2 BAD\r\n4 5.5\r\n-6\r\n*\r\nNote = * and 7\r\n*\r\n";

    fn expected(map: &HeightMap) {
        assert_eq!((map.cells, map.spacing), ([3, 2], [1e-6, 2.5e-6]));
        let wanted = [1.0, 4.0, 2.0, 5.5, f64::NAN, -6.0].map(|height| height * 1e-9);
        for (height, wanted) in map.heights.iter().zip(wanted) {
            assert!(*height == wanted || height.is_nan() && wanted.is_nan(), "{height} for {wanted}");
        }
    }

    #[test]
    fn first_profile_is_the_lowest() {
        expected(&HeightMap::from_sdf(TEXT.as_bytes()).unwrap());
        expected(&HeightMap::from_sdf(TEXT.replace("aISO", "aBCR").replace("\r\n", "\n").as_bytes()).unwrap());
    }

    #[test]
    fn binary_numbers_of_every_type_are_read() {
        let rows = [1.0, 2.0, f64::NAN, 4.0, 5.5, -6.0];
        let doubles: Vec<u8> = rows.iter().flat_map(|height| height.to_le_bytes()).collect();
        expected(&HeightMap::from_sdf(&binary(7, &doubles)[..]).unwrap());
        let marked: Vec<u8> = rows.iter().flat_map(|h| if h.is_nan() { f64::MIN } else { *h }.to_le_bytes()).collect();
        expected(&HeightMap::from_sdf(&binary(7, &marked)[..]).unwrap());
        let floats: Vec<u8> = rows.iter().flat_map(|height| (*height as f32).to_le_bytes()).collect();
        expected(&HeightMap::from_sdf(&binary(3, &floats)[..]).unwrap());
        let extra = [&EXTRA[..], &floats].concat();
        expected(&HeightMap::from_sdf(&binary(3, &extra)[..]).unwrap());
        let trailer = [&floats[..], b"trailing"].concat();
        expected(&HeightMap::from_sdf(&binary(3, &trailer)[..]).unwrap());

        let whole = [1, 2, i32::MIN, 4, 5, -6];
        let bytes: [Vec<u8>; 3] = [
            whole.iter().map(|&h| if h == i32::MIN { i8::MIN } else { h as i8 } as u8).collect(),
            whole.iter().flat_map(|&h| if h == i32::MIN { i16::MIN } else { h as i16 }.to_le_bytes()).collect(),
            whole.iter().flat_map(|h| h.to_le_bytes()).collect(),
        ];
        for (data_type, data) in (4..).zip(bytes) {
            let map = HeightMap::from_sdf(&binary(data_type, &data)[..]).unwrap();
            assert_eq!(map.heights[..4], [1.0, 4.0, 2.0, 5.0].map(|height| height * 1e-9), "type {data_type}");
            assert!(map.heights[4].is_nan() && map.heights[5] == -6.0 * 1e-9, "type {data_type}");
        }
    }

    #[test]
    fn errors_of_malformed_text_name_the_defect() {
        let read = |from: &str, to: &str| {
            assert!(TEXT.contains(from));
            HeightMap::from_sdf(TEXT.replacen(from, to, 1).as_bytes()).unwrap_err()
        };
        let keys = ["NumPoints", "NumProfiles", "Xscale", "Yscale", "Zscale", "Compression", "CheckType"];
        for key in keys {
            assert_eq!(read(key, "Other"), missing(FORMAT, key));
        }
        for (key, from) in [("Xscale", "1e-6"), ("Yscale", "2.5E-06"), ("Zscale", "1e-9")] {
            for scale in ["0", "-1e-6", "nan", "inf"] {
                let error = read(from, scale);
                assert!(error.is("map_entry", key), "{error}");
            }
            assert_eq!(read(from, "small"), entry(FORMAT, key, "small", "a number with a decimal point"));
        }
        let size = |found| wrong_size(FORMAT, "heights", found, 6);
        assert_eq!(read("5.5", ""), size(5));
        assert_eq!(read("5.5", "5 5"), size(7));
        for token in ["GOOD", "1,5", "1e999"] {
            assert_eq!(read("5.5", token), entry(FORMAT, "height", token, "a finite number or BAD"));
        }
        assert!(read("Compression = 0", "Compression = 1").is("map_entry", "Compression"));
        assert!(read("CheckType = 0", "CheckType = 1").is("map_entry", "CheckType"));
        assert!(read("NumPoints = 3", "NumPoints = 3.5").is("map_entry", "NumPoints"));
        assert!(matches!(read("NumPoints = 3", "NumPoints = 0"), Error::CountOutOfRange { value: 0, .. }));
        assert!(read("NumPoints = 3", "NumPoints = 2000000000").code() == "map_size");
        assert!(read("NumPoints = 3", "NumPoints = 4000000000").code() == "map_size");
        assert!(matches!(read("NumPoints = 3", "NumPoints = 4000000000000000000"), Error::CountOutOfRange { .. }));
        assert!(read("aISO", "aBC").code() == "map_magic");
        let cut = HeightMap::from_sdf(TEXT.split('*').next().unwrap().as_bytes()).unwrap_err();
        assert_eq!(cut, missing(FORMAT, "line * after the header"));
    }

    #[test]
    fn errors_of_malformed_binary_name_the_defect() {
        let whole = binary(5, &[0; 12]);
        let read = |at: usize, bytes: &[u8]| {
            let mut file = whole.clone();
            file[at..at + bytes.len()].copy_from_slice(bytes);
            HeightMap::from_sdf(&file[..]).unwrap_err()
        };
        for length in 0..whole.len() {
            assert!(HeightMap::from_sdf(&whole[..length]).is_err(), "{length}");
        }
        assert!(matches!(read(42, &[0, 0]), Error::CountOutOfRange { value: 0, .. }));
        assert_eq!(read(42, &[255; 4]), wrong_size(FORMAT, "bytes of heights", 12, 8_589_672_450));
        for (at, key) in [(46, "Xscale"), (54, "Yscale"), (62, "Zscale")] {
            for scale in [0.0_f64, -1.0, f64::NAN, f64::INFINITY] {
                let error = read(at, &scale.to_le_bytes());
                assert!(error.is("map_entry", key), "{error}");
            }
        }
        for (at, name) in [(78, "Compression"), (79, "DataType"), (80, "CheckType")] {
            let error = read(at, &[9]);
            assert!(error.is("map_entry", name), "{error}");
        }
    }
}
