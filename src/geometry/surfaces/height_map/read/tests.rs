//! Properties of every format.

use super::*;
use crate::geometry::LengthUnit;
use crate::{Error, TextFormat};

/// Reads a file in a known format.
type Reader = fn(&[u8]) -> Result<HeightMap>;

/// A valid file of each format.
fn files() -> Vec<(&'static str, Vec<u8>, Reader)> {
    let map = HeightMap::new([3, 2], [3e-6, 2e-6], vec![1e-6, 2e-6, f64::NAN, 4e-6, 5e-6, -6e-6]).unwrap();
    let (mut gsf, mut sdf) = (Vec::new(), Vec::new());
    map.write_gsf(&mut gsf).unwrap();
    map.write_sdf(&mut sdf).unwrap();
    let xyz = b"0 0 1\n1 0 2\n2 0 nan\n0 1 4\n1 1 5\n2 1 6\n".to_vec();
    #[cfg_attr(not(any(feature = "npy", feature = "x3p")), expect(unused_mut, reason = "more with features"))]
    let mut files: Vec<(_, _, Reader)> = vec![
        ("gsf", gsf, |file| HeightMap::from_gsf(file, None)),
        ("sdf", sdf, |file| HeightMap::from_sdf(file)),
        ("sur", sur(16, &[1, 2, 3, 4, 5, 6]), |file| HeightMap::from_sur(file)),
        ("binary sdf", binary_sdf(5, &[1; 12]), |file| HeightMap::from_sdf(file)),
        ("text", b"# a\n1, 2, 3\n4, bad, 6\n".to_vec(), |file| {
            HeightMap::from_text(file, [1.0; 2], LengthUnit::Metre, TextFormat::default())
        }),
        ("xyz", xyz, |file| HeightMap::from_xyz(file, LengthUnit::Metre, LengthUnit::Metre, TextFormat::default())),
    ];
    #[cfg(feature = "npy")]
    {
        let mut npy = Vec::new();
        map.write_npy(&mut npy).unwrap();
        files.push(("npy", npy, |file| HeightMap::from_npy(file, [1.0; 2], LengthUnit::Metre)));
    }
    #[cfg(feature = "x3p")]
    {
        let xml = x3p::xml("F</DataType>", x3p::LINK);
        let x3p = x3p::archive(&[("main.xml", xml.as_bytes()), ("bindata/data.bin", &[1; 24])]);
        files.push(("x3p", x3p, |file| HeightMap::from_x3p(file)));
        // damage in the XML itself, which the checksum of the archive does not detect
        files.push(("x3p, xml", xml.into_bytes(), |file| {
            HeightMap::from_x3p(&x3p::archive(&[("main.xml", file), ("bindata/data.bin", &[1; 24])])[..])
        }));
    }
    files
}

/// A binary SDF of 3 × 2 points.
pub(super) fn binary_sdf(data_type: u8, data: &[u8]) -> Vec<u8> {
    let mut file = b"bISO-1.0Nobody    010120240000010120240000".to_vec();
    file.extend([3, 0, 2, 0]);
    file.extend([1e-6_f64, 2.5e-6, 1e-9, -1.0].iter().flat_map(|scale| scale.to_le_bytes()));
    file.extend([0, data_type, 0]);
    file.extend(data);
    file
}

/// A SUR of 3 × 2 points of 0.5 nm, heights below 0 missing, after a comment of 5 bytes.
pub(super) fn sur(bits: u8, heights: &[i32]) -> Vec<u8> {
    let mut file = vec![0; 512];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"DIGITAL SURF");
    for (at, byte) in [(14, 1), (16, 1), (18, 2), (86, 1), (98, bits), (104, 100), (108, 3), (112, 2), (334, 5)] {
        put(at, &[byte]);
    }
    for (at, size) in [(120, 0.5_f32), (124, 250.0), (128, 0.5)] {
        put(at, &size.to_le_bytes());
    }
    for (at, unit) in [(180, &b"\xb5m"[..]), (196, b"nm   "), (212, b"nm")] {
        put(at, unit);
    }
    file.extend(b"gauge");
    let bytes = usize::from(bits / 8);
    file.extend(heights.iter().flat_map(|height| height.to_le_bytes()[..bytes].to_vec()));
    file
}

/// Archives of X3P.
#[cfg(feature = "x3p")]
pub(super) mod x3p {
    use std::io::{Cursor, Write};

    use zip::write::{SimpleFileOptions, ZipWriter};

    pub(in super::super) const LINK: &str = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";

    pub(in super::super) fn xml(height: &str, data: &str) -> String {
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?><p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\">\
             <Record1><Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>\
             <CX><AxisType>I</AxisType><DataType>D</DataType><Increment>1e-6</Increment><Offset>0</Offset></CX>\
             <CY><AxisType>I</AxisType><DataType>D</DataType><Increment>2.5E-6</Increment><Offset>0</Offset></CY>\
             <CZ><AxisType>A</AxisType><DataType>{height}</CZ></Axes></Record1>\
             <Record3><MatrixDimension><SizeX> 3 </SizeX><SizeY>2</SizeY><SizeZ>1</SizeZ></MatrixDimension>{data}</Record3>\
             </p:ISO5436_2>"
        )
    }

    pub(in super::super) fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in files {
            archive.start_file(*name, SimpleFileOptions::default()).unwrap();
            archive.write_all(content).unwrap();
        }
        archive.finish().unwrap().into_inner()
    }
}

/// Splitmix64.
fn random(state: &mut u64) -> usize {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as usize
}

#[test]
fn damaged_files_are_errors_or_maps() {
    let mut state = 7;
    for (name, file, read) in files() {
        assert!(read(&file).is_ok(), "{name}");
        let (mut refused, trials) = (0, 4000);
        for _ in 0..trials {
            let mut damaged = file.clone();
            for _ in 0..1 + random(&mut state) % 4 {
                let at = random(&mut state) % damaged.len();
                match random(&mut state) % 6 {
                    0 => damaged.truncate(at.max(1)),
                    1 => damaged.insert(at, random(&mut state) as u8),
                    2 => damaged[at] = b"0123456789.-e,; \n\0\xff"[random(&mut state) % 19],
                    3 => drop(damaged.remove(at)),
                    _ => damaged[at] = random(&mut state) as u8,
                }
                if damaged.is_empty() {
                    break;
                }
            }
            match read(&damaged) {
                Ok(map) => {
                    assert_eq!(map.heights.len(), map.cells[0] * map.cells[1], "{name}");
                    assert!(map.heights.iter().all(|height| !height.is_infinite()), "{name}");
                    assert!(map.spacing.iter().all(|spacing| *spacing > 0.0 && spacing.is_finite()), "{name}");
                }
                Err(error) => {
                    assert!(!error.to_string().is_empty(), "{name}");
                    refused += 1;
                }
            }
        }
        assert!(refused > trials / 10, "{name}: {refused}");
    }
}

#[test]
fn the_extension_determines_the_format() {
    let folder = std::env::temp_dir().join(format!("viscocontact-maps-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut read = Vec::new();
    for (name, file, reader) in files() {
        let path = folder.join(format!("map.{}", if name == "sdf" { "SDF" } else { name }));
        if ["gsf", "sdf", "sur", "x3p"].contains(&name) {
            std::fs::write(&path, &file).unwrap();
            read.push((HeightMap::read(&path).unwrap(), reader(&file).unwrap()));
        }
    }
    let unknown = |name: &str| HeightMap::read(folder.join(name)).unwrap_err();
    for name in ["map.npy", "map", "map.txt", ".gsf"] {
        assert!(unknown(name).code() == "map_extension", "{name}");
    }
    let absent = unknown("absent.gsf");
    assert!(matches!(&absent, Error::Unreadable { file, .. } if file.ends_with("absent.gsf")), "{absent}");
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(read.len(), if cfg!(feature = "x3p") { 4 } else { 3 });
    for (map, expected) in read {
        assert_eq!((map.cells, map.spacing), (expected.cells, expected.spacing));
    }
}

#[test]
fn reading_errors_are_reported() {
    struct Broken;
    impl Read for Broken {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("the disk is on fire"))
        }
    }
    let error = HeightMap::from_sdf(Broken).unwrap_err();
    assert_eq!(error.to_string(), "SDF file cannot be read: the disk is on fire");
}
