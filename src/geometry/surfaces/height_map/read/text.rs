//! Matrices of heights in text files.

use std::collections::HashSet;
use std::io::Read;

use super::First;
use super::missing;
use super::number::is_missing;
use crate::Grid;
use crate::error::{Error, Refusal, Result};
use crate::geometry::{HeightMap, LengthUnit};
use crate::input::{Text, TextFormat, TextRow};

/// Fields of points without a height, in lower case.
const MISSING: [&str; 6] = ["", "bad", "---", "no data", "nodata", "n/a"];
/// Numbers that programs write for points without a height, and the least magnitude of others.
const STAND_INS: [f64; 7] = [-9999.0, 9999.0, -99999.0, 99999.0, -32768.0, 32767.0, 65535.0];
pub(super) const NO_HEIGHT: f64 = 1e30;
/// A stand-in is further from the heights than this multiple of their range.
const FAR: f64 = 10.0;

impl HeightMap {
    /// Reads a matrix of heights in `unit` from text, on a rectangle of `lengths` \[m\]. A line is a row along x1; the
    /// first line is the top.
    ///
    /// `format` states how the text is written, and which height stands for missing points. A field that is empty,
    /// `nan`, `inf`, `bad`, `---`, `no data` or `n/a` is a missing point, and so is the largest number of single
    /// precision, as in all files of maps. Lines of words at the beginning are a header, as
    /// of Wyko, ESRI, Bruker, Zygo or Keyence: its lengths and units are not read, but its `NODATA_value` is. An
    /// index 0, 1, 2… above and beside the heights, as of a data frame, is left out.
    ///
    /// ```
    /// use viscocontact::TextFormat;
    /// use viscocontact::geometry::{HeightMap, LengthUnit};
    ///
    /// let text = "# a step, in µm\n0.0, 0.5, 0.5\n0.0,    , 0.6\n";
    /// let lengths = [3e-6, 2e-6];
    /// let map = HeightMap::from_text(text.as_bytes(), lengths, LengthUnit::Micrometre, TextFormat::default())?;
    /// # let _ = map;
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the text cannot be read, a line differs from the first in its number of columns, or a field is not a
    /// number, each with the number of the line; if the text is a profile or has coordinates,
    /// or some heights look like missing ones; as
    /// [`HeightMap::new`] if the map is invalid.
    pub fn from_text(reader: impl Read, lengths: [f64; 2], unit: LengthUnit, format: TextFormat) -> Result<HeightMap> {
        let text = Text::read(reader, "text file", format)?;
        let mut stand_in = format.missing_height();
        let (mut matrix, mut header) = (text.rows(), Vec::new());
        while let Some(row) = matrix.clone().next().filter(is_header) {
            if row.fields[0].to_lowercase().starts_with("nodata") && row.is_number(1) {
                stand_in = stand_in.or(Some(row.number(1)?).filter(|stated| !stated.is_nan()));
            }
            header.push(row);
            matrix.next();
        }
        let mut columns = matrix.clone().next().map_or(0, |row| row.fields.len());
        // a row of heights with a fault, or of headings, is no header
        let ends_in_heights = |row: &TextRow| {
            let rest = row.fields.len().saturating_sub(columns.max(3) - 1);
            let mut last = rest..row.fields.len();
            rest > 0 && last.clone().any(|k| row.is_number(k)) && last.all(|k| height(row, k).is_ok())
        };
        let is_row = |row: &&TextRow| (row.fields.len() == columns || ends_in_heights(row)) && !is_marked(row);
        if let Some(row) = header.iter().find(|row| columns == 0 || is_row(row)) {
            return Err(row.not_numeric(0));
        }
        // a delimiter at the end of every line terminates it; one at the end of some lines precedes a missing height
        let terminated =
            matrix.clone().all(|row| row.fields.len() > 1 && row.fields.last().is_some_and(|field| field.is_empty()));
        columns = columns.saturating_sub(usize::from(terminated));
        let mut heights = Vec::new();
        for mut row in matrix {
            if terminated {
                row.fields.pop();
            }
            row.check_width(columns, "as in the first row")?;
            for column in 0..columns {
                heights.push(height(&row, column)?);
            }
        }
        if heights.is_empty() {
            return Err(missing("text", "line of heights"));
        }
        let (columns, mut heights) = without_index(columns, heights)?;
        mask(&mut heights, stand_in)?;
        let cells = [columns, heights.len() / columns];
        let spacing = Grid::new(cells, lengths)?.spacing();
        HeightMap::from_rows(cells, spacing, &heights, First::Top, |height| unit.to_metres(height))
    }
}

/// Whether a row has words: at its beginning, and in half of its fields or more.
fn is_header(row: &TextRow) -> bool {
    let begins = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let is_word = !row.fields[0].starts_with(begins)
        && !row.is_number(0)
        && !MISSING.contains(&row.fields[0].to_lowercase().as_str());
    is_word && (2 * row.numbers() <= row.fields.len() || is_marked(row))
}

/// Whether the heights of a Wyko file follow.
fn is_marked(row: &TextRow) -> bool {
    row.fields[0].to_lowercase().starts_with("raw")
}

/// A height, NaN if it is missing.
pub(super) fn height(row: &TextRow, column: usize) -> Result<f64> {
    if MISSING.contains(&row.fields[column].to_lowercase().as_str()) {
        return Ok(f64::NAN);
    }
    let height = row.number(column)?;
    match is_missing(&row.fields[column], height) {
        true => Ok(f64::NAN),
        false if height.is_infinite() => Err(row.not_numeric(column)),
        false => Ok(height),
    }
}

/// The matrix without the index of a data frame: numbers from 0 in the first row and column, whose corner is empty.
fn without_index(columns: usize, heights: Vec<f64>) -> Result<(usize, Vec<f64>)> {
    let ascends = |values: &[f64]| values.len() > 1 && values.windows(2).all(|pair| pair[0] < pair[1]);
    let is_even = |values: &[f64]| {
        let step = (values[values.len() - 1] - values[0]) / (values.len() - 1) as f64;
        values.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 5e-2 * step.abs())
    };
    let beside: Vec<f64> = heights.iter().step_by(columns.max(1)).copied().collect();
    if columns == 2 && beside.len() > 2 && ascends(&beside) {
        return Err(not_a_matrix("two columns, of which the first ascends", "HeightMap::from_profile or Measurements"));
    }
    if columns == 3 && is_grid(&heights) {
        return Err(not_a_matrix("three columns, two of which are coordinates of a grid", "HeightMap::from_xyz"));
    }
    if columns < 3 || beside.len() < 3 || !beside[0].is_nan() {
        return Ok((columns, heights));
    }
    let (above, beside) = (&heights[1..columns], &beside[1..]);
    let is_index = |values: &[f64]| values.iter().enumerate().all(|(k, value)| *value == k as f64);
    // x2 descends, where the first line is at the top
    let descends = |values: &[f64]| values.len() > 1 && values.windows(2).all(|pair| pair[0] > pair[1]);
    let is_axis = |values: &[f64]| (ascends(values) || descends(values)) && is_even(values);
    match (is_index(above), is_index(beside)) {
        (true, true) => {}
        // half an index, or coordinates
        (false, false) if !is_axis(above) || !is_axis(beside) => return Ok((columns, heights)),
        _ => {
            let found = "coordinates, or half an index, in its first row and column, whose corner is empty";
            return Err(not_a_matrix(found, "the matrix without them"));
        }
    }
    Ok((columns - 1, heights[columns..].chunks(columns).flat_map(|row| row[1..].to_vec()).collect()))
}

fn not_a_matrix(found: &str, remedy: &str) -> Error {
    let remedy = format!(": use {remedy}, or HeightMap::new for a matrix that looks so");
    Refusal::file("map_not_a_matrix", format!("the text has {found}"), &remedy).into()
}

/// Whether rows of three numbers begin with the coordinates of a grid, each point once.
fn is_grid(heights: &[f64]) -> bool {
    let distinct = |of: &dyn Fn(&[f64]) -> [f64; 2]| {
        heights.chunks(3).map(|row| of(row).map(f64::to_bits)).collect::<HashSet<_>>().len()
    };
    let (x, y) = (distinct(&|row| [row[0], 0.0]), distinct(&|row| [0.0, row[1]]));
    x > 1 && y > 1 && 3 * x * y == heights.len() && x * y == distinct(&|row| [row[0], row[1]])
}

/// Makes NaN of heights that stand for missing ones; without a value for them, heights that look so are an error.
pub(super) fn mask(heights: &mut [f64], missing: Option<f64>) -> Result<()> {
    let Some(missing) = missing else {
        let remedy = |value: f64| {
            format!(
                ": state TextFormat::with_missing_height({value}) if nothing was measured there, or \
                 with_missing_height(f64::NAN) if it was"
            )
        };
        return without_stand_ins(heights, |height| STAND_INS.contains(&height) || height.abs() >= NO_HEIGHT, remedy);
    };
    let near = if missing.is_finite() { 1e-6 * missing.abs() } else { 0.0 };
    let is_missing = |height: &f64| *height == missing || (height - missing).abs() <= near;
    heights.iter_mut().filter(|height| is_missing(height)).for_each(|height| *height = f64::NAN);
    Ok(())
}

/// Rejects heights of an array that look like a number for points that were not measured.
pub(super) fn known_heights(heights: &[f64]) -> Result<()> {
    let remedy = |_| ": make them NaN where nothing was measured; HeightMap::new takes heights as they are".to_owned();
    without_stand_ins(heights, |height| STAND_INS.contains(&height), remedy)
}

fn without_stand_ins(
    heights: &[f64],
    looks_missing: impl Fn(f64) -> bool,
    remedy: impl Fn(f64) -> String,
) -> Result<()> {
    let others = heights.iter().copied().filter(|height| !looks_missing(*height) && !height.is_nan());
    let [least, most] = others.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| [a.min(z), b.max(z)]);
    let is_near = |value: f64| least <= most && (least - value).max(value - most) <= FAR * (most - least);
    let is_far = |height: &&f64| looks_missing(**height) && !is_near(**height);
    let Some(&value) = heights.iter().find(is_far) else { return Ok(()) };
    let count = heights.iter().filter(|height| **height == value).count();
    let what = format!("{count} of the heights are {value}, far from all others");
    Err(Refusal::file("map_stand_in", what, &remedy(value)).naming("height").valued(value).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<HeightMap> {
        HeightMap::from_text(text.as_bytes(), [3.0, 4.0], LengthUnit::Millimetre, TextFormat::default())
    }

    #[test]
    fn first_line_is_the_top() {
        let texts = [
            "1,2,3\n4,5,6\n",
            "1;2;3\n4;5;6",
            "1\t2\t3\r\n4\t5\t6\r\n",
            "\u{feff}# heights\n\n  1  2   3\n  #\n 4 5 6  \n   \n",
            "1, 2, 3,\n4, 5, 6,\n",
            "1e0 +2 3.\n4 5 6",
        ];
        let expected = HeightMap::new([3, 2], [3.0, 4.0], vec![4e-3, 1e-3, 5e-3, 2e-3, 6e-3, 3e-3]).unwrap();
        for text in texts {
            assert_eq!(read(text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn empty_fields_are_missing() {
        for text in ["1,,3\n4,5,\n", "1;NaN;3\n4;5;bad\n", "1 BAD 3\n4 5 nan\n", "1\t\t3\n4\t5\t\n"] {
            let heights = read(text).unwrap().heights;
            assert_eq!([heights[0], heights[1], heights[2], heights[5]], [4e-3, 1e-3, 5e-3, 3e-3], "{text}");
            assert!(heights[3].is_nan() && heights[4].is_nan(), "{text}");
        }
        // a row, or a column, without measured points
        assert_eq!(read("1,2\n,\n3,4\n").unwrap().cells, [2, 3]);
        assert_eq!(read("1,2,\n4,5,6\n").unwrap().cells, [3, 2]);
    }

    #[test]
    fn heights_that_are_no_number_may_stand_for_missing_ones() {
        let read = |text: &str, missing: f64| {
            let format = TextFormat::default().with_missing_height(missing);
            HeightMap::from_text(text.as_bytes(), [3.0, 2.0], LengthUnit::Metre, format).unwrap().missing()
        };
        assert_eq!(read("1 2 3\n4 5 6\n", f64::INFINITY), 0);
        for missing in ["inf", "-inf", "Infinity", "3.402823e+38", "-3.4028234663852886e+38"] {
            let text = format!("1 2 3\n4 {missing} 6\n");
            let map = HeightMap::from_text(text.as_bytes(), [3.0, 2.0], LengthUnit::Nanometre, TextFormat::default())
                .unwrap();
            assert_eq!(map.missing(), 1, "{missing}");
        }
        assert_eq!([read("1 2 3\n4 -9999 6\n", -9999.0), read("1 2 3\n4 5 6\n", f64::NAN)], [1, 0]);
    }

    #[test]
    fn malformed_lines_are_reported() {
        let columns = read("# a\n1,2,3\n4,5\n").unwrap_err();
        assert!(
            columns.to_string().starts_with("line 3: 2 columns separated by commas, but 3 are needed"),
            "{columns}"
        );
        for text in ["five", "1e999", "2:3"] {
            let error = read(&format!("1 2 3\n4 {text} 6\n")).unwrap_err();
            let numeric = format!("line 2, column 2: {text:?} is not a number; ");
            assert!(error.to_string().starts_with(&numeric), "{error}");
        }
        for empty in ["", "\n\n", "# nothing\n"] {
            assert!(read(empty).is_err_and(|error| error.is("map_missing", "line of heights")));
        }
        assert!(matches!(read("1 2\0\n"), Err(Error::Unreadable { .. })));
        let flat = HeightMap::from_text("1 2\n".as_bytes(), [0.0, 1.0], LengthUnit::Metre, TextFormat::default());
        assert!(matches!(flat, Err(Error::OutOfRange { field: "length along x1", .. })));
    }

    #[test]
    fn headers_indices_and_stand_ins_are_told_from_heights() {
        let expected = HeightMap::new([3, 2], [3.0, 4.0], vec![4e-3, 1e-3, 5e-3, 2e-3, 6e-3, 3e-3]).unwrap();
        for text in [
            "X Size\t3\nY Size\t2\nRAW DATA\t3\t24\n1\t2\t3\n4\t5\t6\n",
            "ncols 3\nNODATA_value -9999\n1 2 3\n4 5 6\n",
            ",0,1,2\n0,1,2,3\n1,4,5,6\n",
        ] {
            assert_eq!(read(text).unwrap(), expected, "{text}");
        }
        for (text, line) in [("one 2 3\n4 5 6\n7 8 9\n", 1), ("x,y,z\n1,2,3\n4,5,6\n", 1), ("a\nb\n", 1)] {
            let error = read(text).unwrap_err();
            assert_eq!(error.code(), "text_not_numeric");
            assert!(error.to_string().starts_with(&format!("line {line}, column 1: ")), "{error}");
        }
        for (text, value) in [("1 2 3\n4 -9999 6\n", -9999.0), ("1 2 3\n-1e33 5 6\n", -1e33)] {
            let error = read(text).unwrap_err();
            assert_eq!((error.code(), error.value()), ("map_stand_in", Some(value)));
            let read = |missing: f64| {
                let format = TextFormat::default().with_missing_height(missing);
                HeightMap::from_text(text.as_bytes(), [3.0, 4.0], LengthUnit::Nanometre, format).unwrap()
            };
            assert_eq!((read(value).missing(), read(f64::NAN).missing()), (1, 0), "{text}");
        }
        assert!(read("9999 9998 1\n2 3 5\n").is_ok());
        for (text, remedy) in [
            ("0 1\n1 4\n2 9\n", "from_profile"),
            ("% relaxation\n0.01 3.0\n0.1 2.9\n1 2.25\n", "Measurements"),
            ("0 0 1\n1 0 2\n0 1 3\n1 1 No Data\n", "from_xyz"),
            (",0.5,1.0,1.5\n2.5,1,2,3\n5.0,4,5,6\n", "without them"),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.code(), "map_not_a_matrix");
            assert!(error.remedy().unwrap().contains(remedy), "{error}");
        }
    }
}
