//! X3P, the archive of ISO 25178-72 (formerly ISO 5436-2): `main.xml` and the heights, which it refers to or contains.
//!
//! Elements and number types follow the schema of the openGPS consortium
//! (<https://sourceforge.net/p/open-gps/mwiki>).

use std::io::{Cursor, Read};

use roxmltree::{Document, Node, ParsingOptions};
use zip::ZipArchive;

use super::{First, Header, Kind, Number, bytes, count, listed, wrong_size};
use super::{missing, wrong_magic};
use crate::error::{Error, Refusal, Result};
use crate::geometry::HeightMap;

const FORMAT: &str = "X3P";
/// Maximum size of `main.xml` in bytes and in nodes: an archive may expand a thousandfold.
const MAX_XML: u64 = 1 << 26;
const MAX_NODES: u32 = 1 << 23;
/// Maximum size of the heights in bytes: 16384² in double precision.
const MAX_DATA: usize = 1 << 31;

const HEIGHT_TYPE: &str = "Record1/Axes/CZ/DataType";
const INCREMENT: &str = "Record1/Axes/CZ/Increment";
const OFFSET: &str = "Record1/Axes/CZ/Offset";
const POINTS: &str = "Record3/DataLink/PointDataLink";
const VALID: &str = "Record3/DataLink/ValidPointsLink";

impl HeightMap {
    /// Reads an X3P archive of ISO 25178-72, in m: a surface (`SUR`) whose points are a matrix, equally spaced along x
    /// and y.
    ///
    /// Needs the feature `x3p`.
    ///
    /// Heights are signed integers of 16 or 32 bits (`I`, `L`) or floats of single or double precision (`F`, `D`), in a
    /// binary file or in the XML itself, times `Increment` plus `Offset` of their axis. Missing points are NaN,
    /// infinite or the largest number of single precision, empty in the XML, or marked in the file of valid points. The
    /// first row has the smallest x2. The offsets of x and y are ignored. The MD5 sums are not verified, the
    /// checksums of the archive are.
    ///
    /// An archive may contain at most 2 GiB of heights and 64 MiB of XML, so that a small one cannot fill the memory.
    ///
    /// # Errors
    /// If the archive cannot be read, is malformed or contains another feature
    /// type; as [`HeightMap::new`] if its map is invalid.
    pub fn from_x3p(reader: impl Read) -> Result<HeightMap> {
        let file = bytes(reader, FORMAT)?;
        if !file.starts_with(b"PK") {
            return Err(wrong_magic(FORMAT, "PK, as zip archives do"));
        }
        let mut archive = ZipArchive::new(Cursor::new(file)).map_err(|error| unreadable(&error.to_string()))?;
        let xml = member(&mut archive, "main.xml", "bytes of main.xml at most", MAX_XML)?;
        let xml = String::from_utf8(xml).map_err(|error| unreadable(&format!("main.xml: {error}")))?;
        let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
        let document = Document::parse_with_options(xml.trim_start_matches('\u{feff}'), options)
            .map_err(|error| unreadable(&format!("main.xml: {error}")))?;
        map(document.root_element(), &mut archive)
    }
}

type Archive = ZipArchive<Cursor<Vec<u8>>>;

fn unreadable(reason: &str) -> Error {
    Error::Unreadable { file: format!("{FORMAT} file"), reason: reason.to_owned(), kind: None }
}

/// The contents of a file of the archive, of at most `most` bytes. All of them may be in a folder, and names may be
/// written as in Windows.
fn member(archive: &mut Archive, name: &str, what: &'static str, most: u64) -> Result<Vec<u8>> {
    let plain = |name: &str| name.replace('\\', "/").trim_start_matches("./").to_owned();
    let mut names: Vec<String> = archive.file_names().flatten().map(|name| name.to_string()).collect();
    names.sort_by_key(String::len);
    let main = names.iter().map(|name| plain(name)).find(|name| format!("/{name}").ends_with("/main.xml"));
    let wanted = format!("{}{}", main.as_deref().unwrap_or_default().trim_end_matches("main.xml"), plain(name));
    let found = names.into_iter().find(|name| plain(name) == wanted).unwrap_or_else(|| name.to_owned());
    let broken = |reason: String| unreadable(&format!("{name}: {reason}"));
    let file = archive.by_name(&found).map_err(|error| broken(error.to_string()))?;
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes).map_err(|error| broken(error.to_string()))?;
    // one byte more than allowed is read to detect files that are too large
    let found = bytes.len() as u64;
    if found > most {
        return Err(oversized(what, found, most));
    }
    Ok(bytes)
}

/// The error of a file with more than the `most` items that are counted.
fn oversized(what: &str, found: u64, most: u64) -> Error {
    let what = format!("the {FORMAT} file should hold {most} {what}, but holds {found} or more");
    Refusal::file("map_oversized", what, "").into()
}

/// The descendant of a node at a path of names.
fn descendant<'a, 'i>(node: Node<'a, 'i>, path: &str) -> Option<Node<'a, 'i>> {
    let child = |node: Node<'a, 'i>, name| node.children().find(|child| child.tag_name().name() == name);
    path.split('/').try_fold(node, child)
}

/// The map that the root of `main.xml` describes.
fn map(root: Node<'_, '_>, archive: &mut Archive) -> Result<HeightMap> {
    let header = Header::new(FORMAT, |path| descendant(root, path)?.text());
    header.must_be("Record1/FeatureType", "SUR")?;
    header.must_be("Record1/Axes/CX/AxisType", "I")?;
    header.must_be("Record1/Axes/CY/AxisType", "I")?;
    header.must_be("Record1/Axes/CZ/AxisType", "A")?;
    require_unrotated(root, &header)?;
    let spacing = [header.positive("Record1/Axes/CX/Increment")?, header.positive("Record1/Axes/CY/Increment")?];
    let text = header.require(HEIGHT_TYPE)?;
    let number = match text {
        "I" => Number::little(Kind::Signed, 2),
        "L" => Number::little(Kind::Signed, 4),
        "F" => Number::little(Kind::Float, 4),
        "D" => Number::little(Kind::Float, 8),
        _ => return Err(header.error(HEIGHT_TYPE, text, "I, L, F or D")),
    };
    // integers have no scale without it
    let scale = match header.get(INCREMENT) {
        None if number.kind == Kind::Float => 1.0,
        _ => header.positive(INCREMENT)?,
    };
    let offset = header.get(OFFSET).map_or(Ok(0.0), |_| header.finite(OFFSET))?;
    let cells = [header.count("Record3/MatrixDimension/SizeX")?, header.count("Record3/MatrixDimension/SizeY")?];
    header.must_be("Record3/MatrixDimension/SizeZ", "1")?;
    let count = count(cells, spacing)?;
    let mut rows = match header.get(POINTS) {
        Some(name) => {
            let expected = count.saturating_mul(number.size);
            if expected > MAX_DATA {
                return Err(wrong_size(FORMAT, "bytes of heights at most", expected, MAX_DATA));
            }
            let data = member(archive, name, "bytes of heights", expected as u64)?;
            number.decode_all(FORMAT, &data, count, true)?
        }
        None => {
            let list = descendant(root, "Record3/DataList");
            let list = list.ok_or_else(|| missing(FORMAT, "PointDataLink or DataList"))?;
            // the last number of each datum, after x and y if they are present
            let data = list.children().filter(|child| child.tag_name().name() == "Datum");
            let heights =
                data.map(|datum| datum.text().and_then(|text| text.rsplit(';').next()).unwrap_or_default().trim());
            let refuse = |text: &str| header.error("Datum", text, "a finite number or empty");
            listed(heights, str::is_empty, count, FORMAT, refuse)?
        }
    };
    if let Some(name) = header.get(VALID) {
        let (expected, what) = (count.div_ceil(8), "bytes of valid points");
        let valid = member(archive, name, what, expected as u64)?;
        if valid.len() < expected {
            return Err(wrong_size(FORMAT, what, valid.len(), expected));
        }
        // one bit per point, the lowest of a byte first
        let missing = |k: &usize| valid[k / 8] >> (k % 8) & 1 == 0;
        (0..count).filter(missing).for_each(|k| rows[k] = f64::NAN);
    }
    HeightMap::from_rows(cells, spacing, &rows, First::Bottom, |height| height * scale + offset)
}

/// Rejects rotated axes.
fn require_unrotated(root: Node<'_, '_>, header: &Header<'_>) -> Result<()> {
    const ROTATION: &str = "Record1/Axes/Rotation";
    let entries = descendant(root, ROTATION).into_iter().flat_map(|rotation| rotation.children());
    for entry in entries.filter(Node::is_element) {
        let text = entry.text().unwrap_or_default().trim();
        let identity = if ["r11", "r22", "r33"].contains(&entry.tag_name().name()) { 1.0 } else { 0.0 };
        if !text.parse().is_ok_and(|value: f64| (value - identity).abs() < 1e-9) {
            return Err(header.error(ROTATION, text, "none (1 on the diagonal, 0 off it)"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::tests::x3p::{LINK, archive, xml};
    use super::*;
    use crate::Error;

    const MASK: &str = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink>\
        <ValidPointsLink>bindata/valid.bin</ValidPointsLink></DataLink>";

    fn read(xml: &str, data: &[u8]) -> Result<HeightMap> {
        let files = [("main.xml", xml.as_bytes()), ("bindata/data.bin", data), ("bindata/valid.bin", &[0b10_1111])];
        HeightMap::from_x3p(&archive(&files)[..])
    }

    fn expected(map: &HeightMap) {
        assert_eq!((map.cells, map.spacing), ([3, 2], [1e-6, 2.5e-6]));
        let wanted = [1.0, 4.0, 2.0, f64::NAN, 3.0, -6.0];
        for (height, wanted) in map.heights.iter().zip(wanted) {
            assert!(
                (height / wanted - 1.0).abs() < 1e-15 || height.is_nan() && wanted.is_nan(),
                "{height} for {wanted}"
            );
        }
    }

    const DOUBLE: &str = "D</DataType>";

    #[test]
    fn first_row_is_the_lowest_in_every_type() {
        let rows = [1.0, 2.0, 3.0, 4.0, f64::NAN, -6.0];
        let doubles: Vec<u8> = rows.iter().flat_map(|height| height.to_le_bytes()).collect();
        expected(&read(&xml(DOUBLE, LINK), &doubles).unwrap());
        let floats: Vec<u8> = rows.iter().flat_map(|height| (*height as f32).to_le_bytes()).collect();
        let scaled = "F</DataType><Increment>1</Increment><Offset>0</Offset>";
        expected(&read(&xml(scaled, LINK), &floats).unwrap());
        let halves: Vec<u8> = [2_i16, 4, 6, 8, 0, -12].iter().flat_map(|height| height.to_le_bytes()).collect();
        expected(&read(&xml("I</DataType><Increment>0.5</Increment>", MASK), &halves).unwrap());
        let longs: Vec<u8> = [0_i32, 2, 4, 6, 0, -14].iter().flat_map(|height| height.to_le_bytes()).collect();
        let offset = "L</DataType><Increment>0.5</Increment><Offset>1</Offset>";
        expected(&read(&xml(offset, MASK), &longs).unwrap());
    }

    #[test]
    fn folders_and_names_of_windows_are_read() {
        let rows = [1.0, 2.0, 3.0, 4.0, f64::NAN, -6.0];
        let data: Vec<u8> = rows.iter().flat_map(|height: &f64| height.to_le_bytes()).collect();
        for (folder, link) in [
            ("sample/", "bindata/data.bin"),
            ("./", "./bindata/data.bin"),
            ("", "bindata\\data.bin"),
            ("a folder/b/", "bindata\\data.bin"),
        ] {
            let text = xml(DOUBLE, LINK).replace("bindata/data.bin", link);
            let (main, points) = (format!("{folder}main.xml"), format!("{folder}bindata/data.bin"));
            let files = [(&*main, text.as_bytes()), ("remarks/main.xml.txt", &[]), (&*points, &data[..])];
            expected(&HeightMap::from_x3p(&archive(&files)[..]).unwrap());
        }
    }

    #[test]
    fn heights_in_the_xml_are_read() {
        for list in [
            "<Datum>1</Datum><Datum>2</Datum><Datum>3</Datum><Datum>4</Datum><Datum/><Datum>-6</Datum>",
            "<Datum>;;1</Datum><Datum>1;0;2</Datum><Datum>3</Datum> <Datum>4</Datum><Datum>1;1;</Datum><Datum> -6 \
            </Datum>",
        ] {
            expected(&read(&xml(DOUBLE, &format!("<DataList>{list}</DataList>")), &[]).unwrap());
        }
    }

    #[test]
    fn errors_of_malformed_archives_name_the_defect() {
        let whole = xml(DOUBLE, LINK);
        let with = |from: &str, to: &str| {
            assert!(whole.contains(from), "{from}");
            read(&whole.replacen(from, to, 1), &[0; 48]).unwrap_err()
        };
        for (from, to, key) in [
            ("SUR", "PRF", "Record1/FeatureType"),
            ("<CX><AxisType>I", "<CX><AxisType>A", "Record1/Axes/CX/AxisType"),
            ("<CY><AxisType>I", "<CY><AxisType>A", "Record1/Axes/CY/AxisType"),
            ("<CZ><AxisType>A", "<CZ><AxisType>I", "Record1/Axes/CZ/AxisType"),
            ("<CZ><AxisType>A</AxisType><DataType>D", "<CZ><AxisType>A</AxisType><DataType>Q", HEIGHT_TYPE),
            ("1e-6", "small", "Record1/Axes/CX/Increment"),
            (" 3 ", "3.5", "Record3/MatrixDimension/SizeX"),
            ("<SizeZ>1", "<SizeZ>2", "Record3/MatrixDimension/SizeZ"),
            ("<Axes>", "<Axes><Rotation><r11>0.9</r11></Rotation>", "Record1/Axes/Rotation"),
        ] {
            let error = with(from, to);
            assert!(error.is("map_entry", key), "{error}");
        }
        for (from, to, key) in [
            ("FeatureType>SUR</FeatureType", "Other>SUR</Other", "Record1/FeatureType"),
            ("1e-6", "", "Record1/Axes/CX/Increment"),
            ("<MatrixDimension>", "<MatrixDimension/><ListDimension>", "Record3/MatrixDimension/SizeX"),
            ("<DataType>D</DataType></CZ>", "<DataType>I</DataType></CZ>", INCREMENT),
            (LINK, "", "PointDataLink or DataList"),
        ] {
            let from_to = whole.replacen(from, to, 1).replace(
                "</MatrixDimension>",
                if to.contains("List") { "</ListDimension>" } else { "</MatrixDimension>" },
            );
            let error = read(&from_to, &[0; 48]).unwrap_err();
            assert!(error.is("map_missing", key), "{error}");
        }
        for increment in ["0", "-1", "NaN", "INF"] {
            assert!(with("1e-6", increment).is("map_entry", "Record1/Axes/CX/Increment"));
        }
        assert!(matches!(with(" 3 ", "0"), Error::CountOutOfRange { value: 0, .. }));
        for size in ["400000000", "4000000000", "18446744073709551615"] {
            let error = with(" 3 ", size);
            assert!(["map_size", "count_out_of_range"].contains(&error.code()), "{error}");
        }
        for (length, found) in [(40, 40), (47, 47), (49, 49), (4000, 49)] {
            let error = read(&whole, &vec![0; length]).unwrap_err();
            let what = "bytes of heights";
            let size = if found < 48 { wrong_size(FORMAT, what, found, 48) } else { oversized(what, found as u64, 48) };
            assert_eq!(error, size);
        }
        for broken in ["", "<a", "<a></a></a>", "<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>"] {
            assert!(matches!(read(broken, &[]), Err(Error::Unreadable { .. })), "{broken}");
        }
        assert!(matches!(with("bindata/data.bin", "nowhere"), Error::Unreadable { .. }));
        let none = HeightMap::from_x3p(&archive(&[("other.xml", b"")])[..]);
        assert!(matches!(none, Err(Error::Unreadable { .. })));
        assert!(HeightMap::from_x3p(&b"<xml/>"[..]).is_err_and(|error| error.code() == "map_magic"));
    }

    #[test]
    fn the_mask_must_cover_all_points() {
        let files = |valid: &'static [u8]| {
            let xml = xml(DOUBLE, MASK);
            let files = [("main.xml", xml.as_bytes()), ("bindata/data.bin", &[0; 48]), ("bindata/valid.bin", valid)];
            HeightMap::from_x3p(&archive(&files)[..])
        };
        assert!(files(&[0xff]).is_ok());
        for valid in [&b""[..], b"\xff\xff"] {
            assert!(files(valid).is_err_and(|error| error.to_string().contains("should hold 1 bytes of valid points")));
        }
    }

    #[test]
    fn deep_and_oversized_xml_is_refused() {
        let deep = "<a>".repeat(300_000);
        assert!(matches!(read(&deep, &[]), Err(Error::Unreadable { .. })));
        let oversized = " ".repeat(MAX_XML as usize + 2);
        assert!(read(&oversized, &[]).is_err_and(|error| error.code() == "map_oversized"));
    }
}
