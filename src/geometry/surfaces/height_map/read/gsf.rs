//! Gwyddion Simple Field 1.0, as described in the user guide of Gwyddion
//! (<http://gwyddion.net/documentation/user-guide-en/gsf.html>).

use std::io::Read;

use super::{First, Header, Kind, Number, bytes, count};
use super::{missing, wrong_magic};
use crate::error::{Refusal, Result};
use crate::geometry::{HeightMap, LengthUnit};
use crate::input::by_lines;

pub(in crate::geometry::surfaces::height_map) const MAGIC: &str = "Gwyddion Simple Field 1.0\n";
const FORMAT: &str = "GSF";

impl HeightMap {
    /// Reads a Gwyddion Simple Field 1.0, the [format](http://gwyddion.net/documentation/user-guide-en/gsf.html) in
    /// which Gwyddion exchanges single maps: heights in single precision, NaN where nothing was measured.
    ///
    /// The file must state lengths, which the format makes optional. Lengths or heights without a unit are in
    /// `fallback`; without one, the file must state its units ([`LengthUnit`]), too. The first row is the top.
    /// `XOffset` and `YOffset` are ignored.
    ///
    /// ```
    /// use viscocontact::geometry::{HeightMap, LengthUnit};
    ///
    /// let mut file = b"Gwyddion Simple Field 1.0\nXRes = 1\nYRes = 2\nXReal = 5\nYReal = 10\nXYUnits = mm\n\0\0".to_vec();
    /// file.extend([1.0_f32, 2.0].iter().flat_map(|height| height.to_le_bytes()));
    /// assert!(HeightMap::from_gsf(&file[..], None).is_err());
    /// let map = HeightMap::from_gsf(&file[..], Some(LengthUnit::Micrometre))?;
    /// assert_eq!(map, HeightMap::new([1, 2], [5e-3, 10e-3], vec![2e-6, 1e-6])?);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the file cannot be read, is malformed, or lacks a unit; as
    /// [`HeightMap::new`] if its map is invalid.
    pub fn from_gsf(reader: impl Read, fallback: Option<LengthUnit>) -> Result<HeightMap> {
        let file = bytes(reader, FORMAT)?;
        let Some(rest) = file.strip_prefix(MAGIC.as_bytes()) else {
            return Err(wrong_magic(FORMAT, MAGIC.trim_end()));
        };
        let Some(end) = rest.iter().position(|&byte| byte == 0) else {
            return Err(missing(FORMAT, "NUL byte after the header"));
        };
        // titles may contain any bytes, and units are in Latin-1 in some files
        let (lines, _) = by_lines(&rest[..end]);
        let header = Header::of_lines(FORMAT, &lines);
        let unit = |key: &'static str| match (header.get(key), fallback) {
            (Some(symbol), _) => symbol.parse(),
            (None, Some(unit)) => Ok(unit),
            (None, None) => {
                let what = format!("the {FORMAT} file has no {key}, the unit of its numbers");
                let remedy = ": give it, as to HeightMap::from_gsf";
                Err(Refusal::file("map_no_unit", what, remedy).naming(key).into())
            }
        };
        let cells = [header.count("XRes")?, header.count("YRes")?];
        let lengths = [header.positive("XReal")?, header.positive("YReal")?];
        let (lateral, vertical) = (unit("XYUnits")?, unit("ZUnits")?);
        let spacing = [0, 1].map(|axis| lateral.to_metres(lengths[axis]) / cells[axis] as f64);
        let count = count(cells, spacing)?;
        // one to four NUL bytes, up to a multiple of four from the start of the file
        let header_length = MAGIC.len() + end;
        let start = header_length + 4 - header_length % 4;
        let padding = file.get(header_length..start).unwrap_or_default();
        if padding.is_empty() || padding.iter().any(|&byte| byte != 0) {
            return Err(missing(FORMAT, "padding of NUL bytes to a multiple of four"));
        }
        let rows = Number::little(Kind::Float, 4).decode_all(FORMAT, &file[start..], count, true)?;
        HeightMap::from_rows(cells, spacing, &rows, First::Top, |height| vertical.to_metres(height))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{entry, wrong_size};
    use super::*;
    use crate::Error;

    const FULL: &str =
        "XRes = 3\nYRes=2\n XReal = 6e-3 \nYReal = 2\nXOffset = 7\nXYUnits = mm\nTitle = height, µm\nZUnits = nm\n";

    fn file(header: &str, heights: &[f32]) -> Vec<u8> {
        let mut file = format!("{MAGIC}{header}").into_bytes();
        file.resize(file.len() + 4 - file.len() % 4, 0);
        file.extend(heights.iter().flat_map(|height| height.to_le_bytes()));
        file
    }

    #[test]
    fn first_row_is_the_top() {
        let map = HeightMap::from_gsf(&file(FULL, &[10.0, 20.0, 30.0, 40.0, f32::NAN, 60.0])[..], None).unwrap();
        assert_eq!((map.cells, map.spacing), ([3, 2], [6e-6 / 3.0, 1e-3]));
        assert_eq!(map.heights[..2], [40e-9, 10e-9]);
        assert!(map.heights[2].is_nan());
        assert_eq!(map.heights[3..], [20e-9, 60e-9, 30e-9]);
        // µm in Latin-1
        let mut latin = file(&FULL.replace("ZUnits = nm", "ZUnits = ?m"), &[1.0; 6]);
        let at = latin.iter().position(|&byte| byte == b'?').unwrap();
        latin[at] = 0xb5;
        assert_eq!(HeightMap::from_gsf(&latin[..], None).unwrap().heights, [1e-6; 6]);
    }

    #[test]
    fn headers_of_every_length_are_padded() {
        for length in 0..9 {
            let header = format!("{FULL}Note = {}\n", "x".repeat(length));
            let map = HeightMap::from_gsf(&file(&header, &[1.0; 6])[..], None).unwrap();
            assert_eq!(map.heights, [1e-9; 6]);
        }
    }

    #[test]
    fn errors_of_malformed_files_name_the_defect() {
        let read = |header: &str, heights: &[f32]| HeightMap::from_gsf(&file(header, heights)[..], None).unwrap_err();
        let six = [1.0; 6];
        let size = |found| wrong_size(FORMAT, "bytes of heights", found, 24);
        assert_eq!(read(FULL, &six[1..]), size(20));
        assert_eq!(read(FULL, &[1.0; 7]), size(28));
        let missing = |key| missing(FORMAT, key);
        for (key, start) in [("XRes", 0), ("YRes", 9)] {
            let cut = format!("{}Other{}", &FULL[..start], &FULL[start..]);
            assert_eq!(read(&cut, &six), missing(key));
        }
        let without = |name: &str| FULL.replace(name, "Other");
        assert_eq!(read(&without("XReal"), &six), missing("XReal"));
        assert_eq!(read(&without("YReal"), &six), missing("YReal"));
        assert!(read(&without("XYUnits"), &six).is("map_no_unit", "XYUnits"));
        assert!(read(&FULL.replace("nm", ""), &six).is("map_no_unit", "ZUnits"));
        assert!(read(&FULL.replace("nm", "V"), &six).to_string().starts_with("\"V\" is not a known unit of length"));
        let entry = entry(FORMAT, "XRes", "three", "a whole number");
        assert_eq!(read(&FULL.replace("XRes = 3", "XRes = three"), &six), entry);
        for length in ["0", "-6e-3", "inf", "nan"] {
            let error = read(&FULL.replace("6e-3", length), &six);
            assert!(error.is("map_entry", "XReal"), "{error}");
        }
        let zero = read(&FULL.replace("XRes = 3", "XRes = 0"), &six);
        assert!(matches!(zero, Error::CountOutOfRange { value: 0, .. }), "{zero}");
    }

    #[test]
    fn infinite_heights_and_the_largest_number_are_missing() {
        let heights = [1.0, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 3.0e38];
        let map = HeightMap::from_gsf(&file(FULL, &heights)[..], None).unwrap();
        assert_eq!(map.missing(), 4);
    }

    #[test]
    fn damaged_headers_are_refused() {
        let magic = wrong_magic(FORMAT, "Gwyddion Simple Field 1.0");
        assert_eq!(HeightMap::from_gsf(&b"Gwyddion Simple Field 2.0\n"[..], None).unwrap_err(), magic);
        assert_eq!(HeightMap::from_gsf(&b""[..], None).unwrap_err(), magic);
        let unterminated = format!("{MAGIC}{FULL}");
        let error = HeightMap::from_gsf(unterminated.as_bytes(), None).unwrap_err();
        assert_eq!(error, missing(FORMAT, "NUL byte after the header"));
        for cut in 0..4 {
            let mut truncated = format!("{MAGIC}{FULL}").into_bytes();
            truncated.extend(std::iter::repeat_n(0, cut));
            assert!(HeightMap::from_gsf(&truncated[..], None).is_err(), "{cut}");
        }
    }

    #[test]
    fn absurd_sizes_are_refused_before_allocating() {
        for size in ["65000", "4000000000", "18446744073709551615"] {
            let header = FULL.replace("XRes = 3", &format!("XRes = {size}")).replace("YRes=2", &format!("YRes={size}"));
            assert!(HeightMap::from_gsf(&file(&header, &[1.0; 6])[..], None).is_err());
        }
    }
}
