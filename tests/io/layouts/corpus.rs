//! Files in the layouts of instruments and programs, with the values that they hold.

use viscocontact::geometry::{HeightMap, LengthUnit};
use viscocontact::rheology::{Experiment, Isotherm, MasterCurve, Measurements, TimeTemperature, Units};
use viscocontact::{Result, TextFormat};
use viscocontact_identify::Recording;

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Table(Experiment),
    Isotherms(Experiment),
    Recording,
    Matrix,
    /// A matrix in which this height is stated to be missing.
    Stated(f64),
    Points,
    Profile,
}

/// A file, and its rows in SI.
#[derive(Clone, Debug)]
pub struct Layout {
    pub name: String,
    pub kind: Kind,
    pub text: String,
    pub encoding: Encoding,
    pub rows: Vec<Vec<f64>>,
    /// Characters that may not be put in: a number could have them.
    pub marks: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    Utf8,
    Windows,
    Utf16,
}

impl Encoding {
    pub fn bytes(self, text: &str) -> Vec<u8> {
        match self {
            Encoding::Utf8 => text.as_bytes().to_vec(),
            // the characters of these texts are those of Latin-1
            Encoding::Windows => text.chars().map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?')).collect(),
            Encoding::Utf16 => [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect(),
        }
    }
}

/// The rows that the reader of this kind finds; NaN for missing heights.
pub fn read(kind: Kind, bytes: &[u8]) -> std::result::Result<Vec<Vec<f64>>, String> {
    let format = TextFormat::default();
    let points = |isotherms: Vec<Isotherm>| -> Result<Vec<Vec<f64>>> {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for isotherm in isotherms {
            let temperature = isotherm.temperature();
            let law = TimeTemperature::arrhenius(1.0, temperature)?;
            let points = MasterCurve::with_law(&law, vec![isotherm])?.points();
            for (x, _, value) in points {
                match rows.last_mut() {
                    Some(row) if row[0] == x => row.push(value),
                    _ => rows.push(vec![x, value]),
                }
            }
        }
        Ok(rows)
    };
    let of_map = |map: HeightMap| -> Vec<Vec<f64>> {
        let [n1, n2] = map.cells();
        (0..n2).rev().map(|j| (0..n1).map(|i| map.heights()[i * n2 + j]).collect()).collect()
    };
    let (mm, um) = (LengthUnit::Millimetre, LengthUnit::Micrometre);
    match kind {
        Kind::Table(experiment) => Measurements::from_csv_reader(experiment, bytes, Units::OF_HEADINGS, format)
            .and_then(|table| points(vec![Isotherm::new(300.0, table)?]))
            .map_err(|error| error.to_string()),
        Kind::Isotherms(experiment) => Isotherm::from_csv_reader(experiment, bytes, Units::OF_HEADINGS, format)
            .and_then(points)
            .map_err(|error| error.to_string()),
        Kind::Recording => {
            let recording = Recording::from_csv_reader(bytes, format).map_err(|error| error.to_string())?;
            let columns = [&recording.force, &recording.deflection, &recording.drive, &recording.depth];
            let row = |(k, time): (usize, &f64)| {
                std::iter::once(*time).chain(columns.into_iter().flatten().map(|column| column[k])).collect()
            };
            Ok(recording.times.iter().enumerate().map(row).collect())
        }
        Kind::Matrix => HeightMap::from_text(bytes, [3e-3, 2e-3], um, format).map(of_map).map_err(|e| e.to_string()),
        Kind::Stated(height) => {
            let format = format.with_missing_height(height);
            HeightMap::from_text(bytes, [3e-3, 2e-3], um, format).map(of_map).map_err(|error| error.to_string())
        }
        Kind::Points => HeightMap::from_xyz(bytes, mm, um, format).map(of_map).map_err(|error| error.to_string()),
        Kind::Profile => HeightMap::from_profile(bytes, mm, um, format).map(of_map).map_err(|error| error.to_string()),
    }
}

/// A column of a table: its name, its unit and the size of this, and the column of the rows that it holds.
type Column = (&'static str, &'static str, f64, Source);

#[derive(Clone, Copy)]
enum Source {
    /// A column of the rows.
    Of(usize),
    /// tan δ, the phase in rad, or the magnitude, of storage and loss modulus in columns 1 and 2.
    Tan,
    Phase,
    Magnitude,
    Word(&'static str),
    Number(f64),
    /// The number of the row.
    Count,
}
use Source::{Count, Magnitude, Number, Of, Phase, Tan, Word};

/// Columns `name~unit~source`: a column of the rows, `=` and a number, a derived quantity, or a word.
fn columns(spec: &'static str) -> Vec<Column> {
    let column = |text: &'static str| {
        let [name, unit, source] = text.split('~').collect::<Vec<_>>()[..] else { panic!("{text}") };
        let size = match unit {
            "µs" | "1/MPa" | "µm" | "uN" => 1e-6,
            "1/GPa" | "nN" | "nm" => 1e-9,
            "ms" | "mN" => 1e-3,
            "min" => 60.0,
            "h" => 3600.0,
            "kPa" => 1e3,
            "MPa" => 1e6,
            "GPa" => 1e9,
            "Hz" => std::f64::consts::TAU,
            "°" => std::f64::consts::TAU / 360.0,
            _ => 1.0,
        };
        let source = match source {
            "tan" => Tan,
            "phase" => Phase,
            "magnitude" => Magnitude,
            "count" => Count,
            _ => match source.strip_prefix('=') {
                Some(number) => Number(number.parse().unwrap()),
                None => source.parse().map_or(Word(source), Of),
            },
        };
        (name, unit, size, source)
    };
    spec.split("; ").map(column).collect()
}

/// How a table is written.
#[derive(Clone, Copy)]
struct Style {
    name: &'static str,
    preamble: &'static str,
    delimiter: &'static str,
    decimal_comma: bool,
    /// `[]`, `()`, `/`, or `row`; `#` are brackets in a comment.
    unit: &'static str,
    exponent: &'static str,
    end: &'static str,
    quotes: bool,
    encoding: Encoding,
}

type Row = (&'static str, &'static str, &'static str, bool, &'static str, &'static str, &'static str, bool, Encoding);

#[rustfmt::skip]
const STYLES: [Row; 6] = [
    ("plain", "", ",", false, "[]", "e", "\n", false, Encoding::Utf8),
    ("German spreadsheet", "Prüfbericht\n\nProbe;PMMA;23 °C\n", ";", true, "()", "e", "\r\n", false, Encoding::Utf16),
    ("rheometer", "Filename\tx.tri\nGeometry\t40.0\tmm\nRun\t3\n[step]\nSweep - 1\n", "\t", false, "row", "e", "\n", false, Encoding::Windows),
    ("NumPy", "# made by a script\n", " ", false, "#", "D", "\n", false, Encoding::Utf8),
    ("quoted", "", ",", true, "[]", "e", "\r", true, Encoding::Utf8),
    ("DIN", "", ";", false, "/", "e", "\n", false, Encoding::Windows),
];

fn styles() -> [Style; 6] {
    STYLES.map(|(name, preamble, delimiter, decimal_comma, unit, exponent, end, quotes, encoding)| Style {
        name,
        preamble,
        delimiter,
        decimal_comma,
        unit,
        exponent,
        end,
        quotes,
        encoding,
    })
}

fn table(kind: Kind, name: &str, columns: &[Column], rows: &[Vec<f64>], style: Style) -> Layout {
    let quoted = |text: String| if style.quotes { format!("\"{text}\"") } else { text };
    let names = |with_units: bool| -> String {
        let heading = |&(name, unit, ..): &Column| {
            let name = if style.delimiter == " " { name.replace(' ', "_") } else { name.to_owned() };
            quoted(match style.unit {
                _ if !with_units || ["", "-"].contains(&unit) => name,
                "()" => format!("{name} ({unit})"),
                "/" if unit.contains('/') => format!("{name} / ({unit})"),
                "/" => format!("{name} / {unit}"),
                _ => format!("{name} [{unit}]"),
            })
        };
        columns.iter().map(heading).collect::<Vec<_>>().join(style.delimiter)
    };
    let mut text = style.preamble.to_owned();
    match style.unit {
        "row" => {
            let units: Vec<&str> = columns.iter().map(|column| column.1).collect();
            text += &format!("{}\n{}\n", names(false), units.join(style.delimiter));
        }
        "#" => text += &format!("# {}\n", names(true)),
        _ => text += &format!("{}\n", names(true)),
    }
    let mut read = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let value = |source: Source| match source {
            Of(column) => row[column],
            Tan => row[2] / row[1],
            Phase => row[2].atan2(row[1]),
            Magnitude => row[1].hypot(row[2]),
            Number(value) => value,
            Count => k as f64,
            Word(_) => f64::NAN,
        };
        // times and heights have as many digits as they need
        let written = |&(.., size, source): &Column| match source {
            Of(0) | Number(_) | Count => format!("{}", (value(source) / size * 1e9).round() / 1e9),
            _ => format!("{:.11e}", value(source) / size),
        };
        let fields: Vec<String> = columns
            .iter()
            .map(|column| match column.3 {
                Word(word) => quoted(word.into()),
                _ => {
                    let number = written(column).replace('e', style.exponent);
                    quoted(if style.decimal_comma { number.replace('.', ",") } else { number })
                }
            })
            .collect();
        text += &format!("{}\n", fields.join(style.delimiter));
        let back = |column: &Column| written(column).parse::<f64>().unwrap() * column.2;
        let found = |of: usize| columns.iter().find(|column| matches!(column.3, Of(index) if index == of)).map(back);
        read.push((0..row.len()).map(|of| found(of).unwrap_or(row[of])).collect());
    }
    let marks = if style.decimal_comma { ",." } else { "." };
    Layout {
        name: format!("{name}, {}", style.name),
        kind,
        text: text.replace('\n', style.end),
        encoding: style.encoding,
        rows: read,
        marks: marks.into(),
    }
}

/// Times, or frequencies, and two moduli or compliances.
fn moduli(falling: bool) -> Vec<Vec<f64>> {
    let row = |k: i32| {
        let x = 10f64.powf(0.5 * f64::from(k)) * 0.03;
        let (a, b) = (1.0 / (1.0 + x * x), x * x / (1.0 + x * x));
        if falling { vec![x, 1.0e6 + 2.0e6 * a] } else { vec![x, 1.0e6 + 2.0e6 * b, 1.0e3 + 2.0e6 * x / (1.0 + x * x)] }
    };
    (0..10).map(row).collect()
}

pub fn corpus() -> Vec<Layout> {
    use Experiment::{Creep, Dynamic, Relaxation, Storage};
    let creep: Vec<Vec<f64>> = moduli(true).iter().map(|row| vec![row[0], 1.0 / row[1]]).collect();
    let (relaxation, dynamic) = (moduli(true), moduli(false));
    let storage: Vec<Vec<f64>> = dynamic.iter().map(|row| row[..2].to_vec()).collect();
    let curve: Vec<Vec<f64>> = (0..12)
        .map(|k| {
            let [time, depth] = [0.01 * f64::from(k), 1e-8 * f64::from(k)];
            vec![time, 2.0 * depth.powf(1.5), depth]
        })
        .collect();
    #[rustfmt::skip]
    let tables: [(Kind, &str, &Vec<Vec<f64>>, &str); 18] = [
        (Kind::Table(Creep), "creep", &creep, "t~s~0; J~1/Pa~1"),
        (Kind::Table(Creep), "creep, reversed", &creep, "Creep compliance~1/GPa~1; Time~min~0; Sample~~A"),
        (Kind::Table(Creep), "creep in tension", &creep, "t~µs~0; D~1/MPa~1"),
        (Kind::Table(Relaxation), "relaxation, pyvisco", &relaxation, "t~s~0; E_relax~MPa~1; T~°C~=23; Set~-~=0"),
        (Kind::Table(Relaxation), "relaxation, German", &relaxation, "Zeit t~h~0; E~GPa~1"),
        (Kind::Table(Relaxation), "relaxation with segments", &relaxation, "Segment~~Hold; G(t)~kPa~1; Time~ms~0; Temperature~K~=296.15"),
        (Kind::Table(Dynamic), "DMA, pyvisco", &dynamic, "f~Hz~0; E_stor~MPa~1; E_loss~MPa~2"),
        (Kind::Table(Dynamic), "rheometer sweep", &dynamic, "Angular frequency~rad/s~0; Storage modulus~kPa~1; Loss modulus~Pa~2; Tan(delta)~~tan"),
        (Kind::Table(Dynamic), "both frequencies", &dynamic, "Angular frequency~rad/s~0; Frequency~Hz~0; G'~Pa~1; G''~Pa~2"),
        (Kind::Table(Dynamic), "time and frequency", &dynamic, "Time~s~count; Freq~Hz~0; E'~MPa~1; E''~MPa~2; T~°C~=23"),
        (Kind::Table(Dynamic), "magnitude and phase", &dynamic, "f~Hz~0; |E*|~MPa~magnitude; phase~°~phase"),
        (Kind::Table(Dynamic), "loss factor", &dynamic, "omega~rad/s~0; G'~kPa~1; tan delta~~tan"),
        (
            Kind::Table(Dynamic),
            "rheometer with other columns",
            &dynamic,
            "Point No.~~count; Angular Frequency~rad/s~0; Storage Modulus~Pa~1; Loss Modulus~Pa~2; Loss Factor~1~tan; \
             Shear Strain~%~=1; Torque~mN·m~=0.5; Status~~ME",
        ),
        (Kind::Table(Storage), "storage alone", &storage, "f~Hz~0; G'~MPa~1"),
        (Kind::Isotherms(Dynamic), "isotherm", &dynamic, "f~Hz~0; E_stor~MPa~1; E_loss~MPa~2; T~°C~=18"),
        (Kind::Recording, "AFM", &curve, "t~s~0; F~nN~1; z~nm~2"),
        (Kind::Recording, "nanoindenter", &curve, "Segment~~Load; Load On Sample~mN~1; Time On Sample~ms~0; Depth~µm~2"),
        (Kind::Recording, "Chiaro", &curve, "Time~s~0; Load~uN~1; Piezo~nm~2; Auxiliary~~=0"),
    ];
    let mut all: Vec<Layout> = tables
        .iter()
        .flat_map(|(kind, name, rows, spec)| styles().map(|style| table(*kind, name, &columns(spec), rows, style)))
        // a unit or symbol that a style cannot write
        .filter(|layout| !(layout.encoding == Encoding::Windows && layout.text.contains('δ')))
        .collect();
    let heights = [[1.5, 2.25, 3.5], [4.0, 5.125, 6.75]].map(|row| row.map(|z: f64| z / 1e6));
    let with_hole = [[1.5, f64::NAN, 3.5], [4.0, 5.125, 6.75]].map(|row| row.map(|z: f64| z / 1e6));
    let line = [1.5, 1.25, 2.0, 2.25, 1.75].map(|z: f64| z / 1e6);
    let rows = |[a, b]: [[f64; 3]; 2]| vec![a.to_vec(), b.to_vec()];
    let (whole, hole, line) = (&rows(heights), &rows(with_hole), &vec![line.to_vec()]);
    let points = "0 1 1.5\n1 1 2.25\n2 1 3.5\n0 0 4.0\n1 0 5.125\n2 0 6.75\n";
    let wyko = "Wyko ASCII Data File Format 0 0 1\nX Size\t3\nY Size\t2\nPixel_size\t2.00E-003\nBlock Name Type Length Value\n\
        RAW DATA\t3\t24\n1.5\tBad\t3.5\n4.0\t5.125\t6.75\n";
    let esri = "ncols 3\nnrows 2\nxllcorner 0.0\ncellsize 50\nNODATA_value -9999\n1.5 -9999 3.5\n4.0 5.125 6.75\n";
    let keyence = "\"Date\",\"2024\"\n\"Unit\",\"um\"\n1.5,---,3.5\n4.0,5.125,6.75\n";
    let bruker = "\"\\Exported image units: um\"\nh=2 w=3\n1.5\t2.25\t3.5\n4.0\t5.125\t6.75\n";
    let gwyddion = "# Channel: Height\n# Width: 3.00 µm\n# Value units: µm\n1.5\t2.25\t3.5\n4.0\t5.125\t6.75\n";
    let frame = ",0,1,2\n0,1.5,2.25,3.5\n1,4.0,5.125,6.75\n";
    let german = "0,0;1,0;1,5\n1,0;1,0;---\n2,0;1,0;3,5\n0,0;0,0;4,0\n1,0;0,0;5,125\n2,0;0,0;6,75\n";
    let profile = "Profil 1\nx [mm];z [µm]\n0,0;1,5\n0,1;1,25\n0,2;2,0\n0,3;2,25\n0,4;1,75\n";
    let maps: [(Kind, &str, &str, &Vec<Vec<f64>>); 18] = [
        (Kind::Matrix, "plain", "1.5 2.25 3.5\n4.0 5.125 6.75\n", whole),
        (Kind::Matrix, "tabs at the ends", "1.5\t2.25\t3.5\t\n4.0\t5.125\t6.75\t\n", whole),
        (Kind::Matrix, "German", "1,5;2,25;3,5\n4,0;5,125;6,75\n", whole),
        (Kind::Matrix, "Wyko", wyko, hole),
        (Kind::Matrix, "ESRI", esri, hole),
        (Kind::Matrix, "data frame", frame, whole),
        (Kind::Matrix, "Keyence", keyence, hole),
        (Kind::Matrix, "Bruker", bruker, whole),
        (Kind::Matrix, "Gwyddion", gwyddion, whole),
        (Kind::Matrix, "Zygo", "# Zygo\n1.5 No Data 3.5\n4.0 5.125 6.75\n", hole),
        (Kind::Stated(65535.0), "65535", "1.5 65535 3.5\n4.0 5.125 6.75\n", hole),
        (Kind::Stated(-9999.0), "-9999, German", "1,5;-9999;3,5\n4,0;5,125;6,75\n", hole),
        (Kind::Stated(-3.4028235e38), "least float", "1.5 -3.4028235e38 3.5\n4.0 5.125 6.75\n", hole),
        (Kind::Points, "points", points, whole),
        (Kind::Points, "points with headings", &format!("x (mm),y (mm),z (um)\n{}", points.replace(' ', ",")), whole),
        (Kind::Points, "points, German", german, hole),
        (Kind::Profile, "profile", "0.0 1.5\n0.1 1.25\n0.2 2.0\n0.3 2.25\n0.4 1.75\n", line),
        (Kind::Profile, "profile with headings", profile, line),
    ];
    for (kind, name, text, rows) in maps {
        let encoding = if name.contains("German") { Encoding::Utf16 } else { Encoding::Utf8 };
        let marks = if name.contains("German") || text.contains("0,1;") { ",." } else { "." };
        all.push(Layout {
            name: name.into(),
            kind,
            text: text.into(),
            encoding,
            rows: rows.clone(),
            marks: marks.into(),
        });
    }
    all
}
