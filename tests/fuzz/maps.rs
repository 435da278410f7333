//! Height maps: their files and their operations.

use viscocontact::geometry::{Form, Geometry, HeightMap, LengthUnit, SurfaceStatistics};
use viscocontact::{Grid, TextFormat};

use crate::engine::{Outcome, Target, Verdict, finite, judged, known};
use crate::source::Source;

pub fn targets() -> Vec<Target> {
    vec![
        Target { name: "map_gsf", short: 1500, run: gsf },
        Target { name: "map_sdf", short: 1500, run: sdf },
        Target { name: "map_sur", short: 1500, run: sur },
        Target { name: "map_text", short: 1500, run: text },
        Target { name: "map_xyz", short: 1500, run: xyz },
        Target { name: "map_operations", short: 500, run: operations },
        Target { name: "map_npy", short: 1500, run: npy },
        Target { name: "map_x3p", short: 500, run: x3p },
        Target { name: "map_x3p_xml", short: 500, run: x3p_xml },
    ]
}

/// A small map of good values.
fn map(source: &mut Source) -> HeightMap {
    let cells = [source.count(1, 5), source.count(1, 5)];
    let gaps = source.chance(0.3);
    let heights = (0..cells[0] * cells[1])
        .map(|k| if k > 0 && gaps && source.chance(0.2) { f64::NAN } else { 1e-6 * (source.unit() - 0.5) })
        .collect();
    let spacing = 10f64.powf(-7.0 + 3.0 * source.unit());
    HeightMap::new(cells, cells.map(|n| spacing * n as f64), heights).expect("it is a good map")
}

/// Heights of a map are finite or missing, everything else is a number.
fn look(map: HeightMap) -> Result<(), String> {
    if map.heights().len() != map.cells()[0] * map.cells()[1] {
        return Err("heights are not as many as cells".to_owned());
    }
    if map.heights().iter().any(|height| height.is_infinite()) {
        return Err("a height is infinite".to_owned());
    }
    if map.missing() != map.heights().iter().filter(|height| height.is_nan()).count() {
        return Err("missing heights are not counted right".to_owned());
    }
    finite("spacing", map.spacing())?;
    finite("lengths", map.lengths())?;
    finite("centre", map.center())
}

/// Reads a file whose numbers begin after `head` bytes, damaged; a text begins with them.
fn read(
    file: &[u8],
    head: Option<usize>,
    source: &mut Source,
    read: impl Fn(&[u8]) -> viscocontact::Result<HeightMap>,
) -> Verdict {
    let file = match head {
        _ if source.chance(0.05) => file.to_vec(),
        Some(head) => source.damage_behind(file, head),
        None if source.chance(0.6) => source.damage_text(file),
        None => source.damage(file),
    };
    judged(read(&file), look)
}

fn gsf(source: &mut Source) -> Verdict {
    let mut file = Vec::new();
    map(source).write_gsf(&mut file).map_err(|error| error.to_string())?;
    // the head ends with zeros
    let head = file.iter().position(|&byte| byte == 0).unwrap_or(0) + 4;
    read(&file, Some(head), source, |file| HeightMap::from_gsf(file, None))
}

fn sdf(source: &mut Source) -> Verdict {
    let mut file = Vec::new();
    if source.chance(0.5) {
        map(source).write_sdf(&mut file).map_err(|error| error.to_string())?;
    } else {
        let (columns, rows) = (source.count(1, 4) as u16, source.count(1, 4) as u16);
        let kind = source.count(3, 7) as u8;
        let width = [4, 1, 2, 4, 8][usize::from(kind) - 3];
        file.extend_from_slice(b"bISO-1.0a         230620260930230620260930");
        file.extend(columns.to_le_bytes());
        file.extend(rows.to_le_bytes());
        for scale in [1e-6, 1e-6, 1e-9, 0.0_f64] {
            file.extend(scale.to_le_bytes());
        }
        file.extend([0, kind, 0]);
        file.extend(source.bytes(width * usize::from(columns) * usize::from(rows)));
    }
    let head = if file.starts_with(b"b") { Some(81) } else { None };
    read(&file, head, source, |file| HeightMap::from_sdf(file))
}

fn sur(source: &mut Source) -> Verdict {
    let (columns, rows, size) = (source.count(1, 4), source.count(1, 4), source.choose(&[2, 4]));
    let mut file = vec![0; 512];
    let mut put = |at: usize, bytes: &[u8]| file[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, b"DIGITAL SURF");
    for (at, number) in [(14, 1), (18, 2), (86, source.count(0, 1)), (98, 8 * size), (108, columns), (112, rows)] {
        put(at, &(number as u16).to_le_bytes());
    }
    for (spacing, at, unit) in [(120, 180, b"um"), (124, 196, b"um"), (128, 212, b"nm")] {
        put(spacing, &(source.scale(1e-3, 1e3) as f32).to_le_bytes());
        put(at, unit);
    }
    file.extend(source.bytes(size * columns * rows));
    read(&file, Some(340), source, |file| HeightMap::from_sur(file))
}

fn text(source: &mut Source) -> Verdict {
    const FILES: [&str; 3] =
        ["# a\n1, 2, 3\n4, bad, 6\n", "# Channel: Height\n# Width: 2 um\n1.5e-3\t2\n3\tnan\n", "1 2\n3 4\n"];
    let (file, lengths) = (source.choose(&FILES), [source.scale(1e-6, 1e-2), source.scale(1e-6, 1e-2)]);
    read(file.as_bytes(), None, source, |file| {
        HeightMap::from_text(file, lengths, LengthUnit::Micrometre, TextFormat::default())
    })
}

fn xyz(source: &mut Source) -> Verdict {
    const FILES: [&str; 2] =
        ["0 0 1\n1 0 2\n2 0 nan\n0 1 4\n1 1 5\n2 1 6\n", "# x y z\n0.5;0;1\n0;0;1\n0;0.25;1\n0.5;0.25;-3e2\n"];
    let file = source.choose(&FILES);
    read(file.as_bytes(), None, source, |file| {
        HeightMap::from_xyz(file, LengthUnit::Millimetre, LengthUnit::Micrometre, TextFormat::default())
    })
}

fn npy(source: &mut Source) -> Verdict {
    let mut file = Vec::new();
    map(source).write_npy(&mut file).map_err(|error| error.to_string())?;
    read(&file, Some(128), source, |file| HeightMap::from_npy(file, [1e-3; 2], LengthUnit::Metre))
}

mod packed {
    use std::io::{Cursor, Write};

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    fn xml(source: &mut Source) -> String {
        let height = source.choose(&["D</DataType>", "F</DataType>", "I</DataType><Increment>0.5</Increment>"]);
        let data = source.choose(&[
            "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>",
            "<DataLink><PointDataLink>bindata/data.bin</PointDataLink>\
             <ValidPointsLink>bindata/valid.bin</ValidPointsLink></DataLink>",
            "<DataList><Datum>1</Datum><Datum>2</Datum><Datum>;;3</Datum><Datum>4</Datum><Datum/>\
             <Datum>-6</Datum></DataList>",
        ]);
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?><p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\">\
             <Record1><Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>\
             <CX><AxisType>I</AxisType><DataType>D</DataType><Increment>1e-6</Increment><Offset>0</Offset></CX>\
             <CY><AxisType>I</AxisType><DataType>D</DataType><Increment>2.5E-6</Increment><Offset>0</Offset></CY>\
             <CZ><AxisType>A</AxisType><DataType>{height}</CZ></Axes></Record1><Record3><MatrixDimension>\
             <SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>1</SizeZ></MatrixDimension>{data}</Record3></p:ISO5436_2>"
        )
    }

    fn archive(xml: &[u8], source: &mut Source) -> Vec<u8> {
        // mostly the width of the description
        let widths = [("D</DataType></CZ>", 8), ("F</DataType></CZ>", 4), ("Increment>0.5", 2)];
        let text = String::from_utf8_lossy(xml);
        let said = widths.iter().find(|(mark, _)| text.contains(mark)).map_or(8, |&(_, width)| width);
        let width = if source.chance(0.9) { said } else { source.choose(&[8, 4, 2]) };
        let data: Vec<u8> = source.bytes(6 * width);
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in [("main.xml", xml), ("bindata/data.bin", &data), ("bindata/valid.bin", &[0b10_1111])] {
            archive.start_file(name, SimpleFileOptions::default()).expect("a file in memory");
            archive.write_all(content).expect("a file in memory");
        }
        archive.finish().expect("a file in memory").into_inner()
    }

    /// A damaged archive.
    pub fn x3p(source: &mut Source) -> Verdict {
        let xml = xml(source);
        let file = archive(xml.as_bytes(), source);
        // of an archive anything that is turned is found, but a sound one of any numbers is not refused for them
        if source.chance(0.4) {
            return judged(HeightMap::from_x3p(&file[..]), look);
        }
        read(&file, Some(file.len()), source, |file| HeightMap::from_x3p(file))
    }

    /// A sound archive of a damaged description, which no check sum catches.
    pub fn x3p_xml(source: &mut Source) -> Verdict {
        let xml = xml(source);
        let damaged =
            if source.chance(0.8) { source.damage_text(xml.as_bytes()) } else { source.damage(xml.as_bytes()) };
        let file = archive(&damaged, source);
        judged(HeightMap::from_x3p(&file[..]), look)
    }
}

use packed::{x3p, x3p_xml};

/// A map of any numbers, and what can be done with it.
fn operations(source: &mut Source) -> Verdict {
    let cells = [source.count(1, 6), source.count(1, 6)];
    let size = source.scale(1e-9, 1e-3);
    let heights: Vec<f64> = (0..cells[0] * cells[1])
        .map(|_| match source.below(8) {
            0 => source.between(-size.abs(), size.abs()),
            1 if source.chance(0.3) => f64::NAN,
            _ => size * (source.unit() - 0.5),
        })
        .collect();
    let mut map = match HeightMap::new(cells, [source.scale(1e-6, 1.0), source.scale(1e-6, 1.0)], heights) {
        Ok(map) => map,
        Err(_) => return Ok(Outcome::Refused),
    };
    for _ in 0..source.below(5) {
        let kept = map.clone();
        let next = match source.below(10) {
            0 => map.filled(),
            1 => map.leveled(source.choose(&[Form::Mean, Form::Tilt, Form::Curvature])),
            2 => Ok(map.masked()),
            3 => map.cropped([source.below(4), source.below(4)], [source.below(5), source.below(5)]),
            4 => Ok(map.flipped([source.chance(0.5), source.chance(0.5)])),
            5 => Ok(map.transposed()),
            6 => Ok(map.inverted()),
            7 => map.scaled(source.between(-2.0, 2.0)),
            8 => map.centered_at([source.between(-1e-3, 1e-3), source.between(-1e-3, 1e-3)]),
            _ => Ok(map.periodic()),
        };
        map = next.unwrap_or(kept);
        look(map.clone())?;
    }
    let lengths = [source.scale(1e-6, 1.0), source.scale(1e-6, 1.0)];
    if let Ok(grid) = Grid::new([source.count(1, 9), source.count(1, 9)], lengths) {
        if let Ok(resampled) = map.resampled(&grid) {
            look(resampled)?;
        }
        // a missing point that is not masked is NaN in the gap by contract: a contact refuses it by name
        let mut gap = vec![0.0; grid.len()];
        let whole = map.missing() == 0;
        map.fill_gap(&grid, &mut gap);
        if whole {
            known("gap of a whole map", gap).map_err(|what| format!("{what}, of {map:?} on {grid:?}"))?;
        }
    }
    let at = [source.between(-1e-3, 1e-3), source.between(-1e-3, 1e-3)];
    known("height", map.height_at(at[0], at[1]))?;
    if let Ok(statistics) = map.statistics() {
        let SurfaceStatistics { mean, rms_height, skewness, kurtosis, rms_slope, rms_curvature, .. } = statistics;
        let all = [mean, rms_height, skewness, kurtosis, rms_slope, rms_curvature];
        known("statistics", all.into_iter().chain(statistics.rms_slopes))?;
    }
    let mut file = Vec::new();
    if map.write_gsf(&mut file).is_ok() {
        let back = HeightMap::from_gsf(&file[..], None).map_err(|error| format!("its own GSF: {error}"))?;
        look(back)?;
    }
    Ok(Outcome::Accepted)
}
