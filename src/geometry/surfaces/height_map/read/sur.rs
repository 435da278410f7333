//! Digital Surf SUR, the surfaces of MountainsMap.
//!
//! The layout of the header is the one in which the readers of Gwyddion, surfalize and RosettaSciIO agree.

use std::io::Read;

use super::{First, Header, Kind, Number, bytes, count, wrong_size};
use super::{entry, wrong_magic};
use crate::error::Result;
use crate::geometry::{HeightMap, LengthUnit};
use crate::input::by_lines;

const FORMAT: &str = "SUR";
const MAGIC: &str = "DIGITAL SURF";
const HEADER: usize = 512;
/// Names, offsets and sizes of the whole numbers in the header.
const WHOLE: [(&str, usize, usize); 12] = [
    ("byte order", 12, 2),
    ("number of objects", 14, 2),
    ("type of object", 18, 2),
    ("special points", 86, 2),
    ("bits per point", 98, 2),
    ("minimum height", 100, 4),
    ("maximum height", 104, 4),
    ("points per line", 108, 4),
    ("lines", 112, 4),
    ("inversion", 290, 2),
    ("length of comment", 334, 2),
    ("length of private zone", 336, 2),
];
/// Names and offsets of the spacings along x, y and z, and of their units.
const SPACINGS: [(&str, usize); 3] = [("x spacing", 120), ("y spacing", 124), ("z spacing", 128)];
const UNITS: [(&str, usize); 3] = [("x unit", 180), ("y unit", 196), ("z unit", 212)];

impl HeightMap {
    /// Reads a surface or profile of Digital Surf (SUR, PRO): heights as whole numbers of 16 or 32 bits, not
    /// compressed.
    ///
    /// The first line is the top. Where the file has special points, heights beyond the stated range were not
    /// measured, or saturated the instrument: they are missing. Heights count from an arbitrary level, since readers
    /// disagree on the meaning of the offset in the file. Compressed files, series, images and inverted surfaces are
    /// refused.
    ///
    /// # Errors
    /// If the file cannot be read, is malformed or of another kind; as
    /// [`HeightMap::new`] if its map is invalid.
    pub fn from_sur(reader: impl Read) -> Result<HeightMap> {
        let file = bytes(reader, FORMAT)?;
        if file.starts_with(b"DSCOMPRESSED") {
            let allowed = "DIGITAL SURF: save it uncompressed, or export it as GSF by Gwyddion";
            return Err(entry(FORMAT, "signature", "DSCOMPRESSED", allowed));
        }
        if !file.starts_with(MAGIC.as_bytes()) {
            return Err(wrong_magic(FORMAT, MAGIC));
        }
        let Some((binary, rest)) = file.split_at_checked(HEADER) else {
            return Err(wrong_size(FORMAT, "bytes of header", file.len(), HEADER));
        };
        // the header that a text file has
        let whole = |(key, at, size): (&'static str, usize, usize)| {
            (key, Number::little(Kind::Signed, size).decode(&binary[at..at + size]).to_string())
        };
        let spacing = |(key, at)| (key, Number::little(Kind::Float, 4).decode(&binary[at..at + 4]).to_string());
        let unit = |(key, at)| (key, by_lines(&binary[at..at + 16]).0.replace('\0', " "));
        let entries = WHOLE.map(whole).into_iter().chain(SPACINGS.map(spacing)).chain(UNITS.map(unit));
        let entries: Vec<(&str, String)> = entries.collect();
        let find = |key: &str| entries.iter().find(|(name, _)| *name == key).map(|(_, text)| &**text);
        let header = Header::new(FORMAT, find);
        map(&header, rest)
    }
}

/// The map of the data after a header.
fn map(header: &Header<'_>, rest: &[u8]) -> Result<HeightMap> {
    for (key, allowed) in [("byte order", "0"), ("number of objects", "1"), ("inversion", "0")] {
        header.must_be(key, allowed)?;
    }
    header.one_of("type of object", &["1", "2"], "1 or 2, a profile or a surface")?;
    let has_special = header.one_of("special points", &["0", "1"], "0 or 1")? == "1";
    let size = header.one_of("bits per point", &["16", "32"], "16 or 32")?;
    let number = Number::little(Kind::Signed, if size == "16" { 2 } else { 4 });
    let cells = [header.count("points per line")?, header.count("lines")?];
    let [(x, dx), (y, dy), (z, dz)] = [0, 1, 2].map(|k| (UNITS[k].0, SPACINGS[k].0));
    let unit = |key| header.require(key)?.parse::<LengthUnit>();
    let (across, down, up) = (unit(x)?, unit(y)?, unit(z)?);
    let spacing = [across.to_metres(header.positive(dx)?), down.to_metres(header.positive(dy)?)];
    let scale = header.positive(dz)?;
    let zones = header.count("length of comment")? + header.count("length of private zone")?;
    let data = rest.get(zones..).unwrap_or_default();
    let mut rows = number.decode_all(FORMAT, data, count(cells, spacing)?, true)?;
    if has_special {
        let measured = header.finite("minimum height")?..=header.finite("maximum height")?;
        rows.iter_mut().filter(|height| !measured.contains(height)).for_each(|height| *height = f64::NAN);
    }
    HeightMap::from_rows(cells, spacing, &rows, First::Top, |height| up.to_metres(height * scale))
}

#[cfg(test)]
mod tests {
    use super::super::tests::sur;
    use super::*;

    #[test]
    fn the_first_line_is_the_top_and_points_beyond_the_range_are_missing() {
        for bits in [16, 32] {
            let map = HeightMap::from_sur(&sur(bits, &[10, 20, -2, 40, 50, 60])[..]).unwrap();
            assert_eq!((map.cells, map.spacing), ([3, 2], [0.5e-6, 0.25e-6]));
            assert_eq!(map.heights[..4], [40e-9, 10e-9, 50e-9, 20e-9].map(|height| height / 2.0));
            assert!(map.heights[4] == 30e-9 && map.heights[5].is_nan());
            let mut all = sur(bits, &[10, 20, -2, 40, 50, 60]);
            all[86] = 0;
            assert_eq!(HeightMap::from_sur(&all[..]).unwrap().heights[5], -1e-9);
        }
    }

    #[test]
    fn files_of_another_kind_are_refused_with_the_cure() {
        let whole = sur(16, &[0; 6]);
        let read = |at: usize, bytes: &[u8]| {
            let mut file = whole.clone();
            file[at..at + bytes.len()].copy_from_slice(bytes);
            HeightMap::from_sur(&file[..]).unwrap_err()
        };
        for length in 0..whole.len() {
            assert!(HeightMap::from_sur(&whole[..length]).is_err(), "{length}");
        }
        assert!(read(0, b"DSCOMPRESSED").to_string().contains("export it as GSF by Gwyddion"));
        assert!(read(0, b"DIGITAL SURD").code() == "map_magic");
        assert_eq!(read(108, &[4]), wrong_size(FORMAT, "bytes of heights", 12, 16));
        assert!(read(108, &[255; 4]).is("map_entry", "points per line"));
        assert!(read(334, &[255; 2]).is("map_entry", "length of comment"));
        assert!(read(212, b"a.u.  ").code() == "map_unit");
        assert!(read(128, &[0; 4]).is("map_entry", "z spacing"));
        for (at, name) in [(12, "byte order"), (14, "number of objects"), (18, "type of object"), (290, "inversion")] {
            assert!(read(at, &[9]).is("map_entry", name), "{name}");
        }
    }
}
