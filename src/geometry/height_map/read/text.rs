//! Matrices of heights in text files.

use std::io::Read;

use super::First;
use crate::Grid;
use crate::error::Result;
use crate::geometry::{HeightMap, LengthUnit};
use crate::input::{TextFormat, TextRow, TextTable};

impl HeightMap {
    /// Reads a matrix of heights in `unit` from text, on a rectangle of `lengths` \[m\]. A line is a row along x1; the
    /// first line is the top.
    ///
    /// A field that is empty, `nan` or `bad` is a missing point. `format` states the delimiter and the decimal mark; empty
    /// lines and lines that start with `#` are skipped.
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
    /// If the text cannot be read, a line differs from the first in its number of columns, or a field is not a number, each
    /// with the number of the line ([`TextError`](crate::TextError)); as [`HeightMap::new`] if the map is invalid.
    pub fn from_text(reader: impl Read, lengths: [f64; 2], unit: LengthUnit, format: TextFormat) -> Result<HeightMap> {
        let table = TextTable::read(reader, "text file", format)?;
        let (mut rows, mut columns) = (Vec::new(), 0);
        // a delimiter at the end of every line terminates it; one at the end of some lines precedes a missing height
        let terminated =
            table.rows().all(|row| row.fields.len() > 1 && row.fields.last().is_some_and(|f| f.is_empty()));
        for mut row in table.rows() {
            if terminated {
                row.fields.pop();
            }
            columns = if rows.is_empty() { row.fields.len() } else { columns };
            row.check_width(columns, "as in the first row")?;
            for column in 0..columns {
                rows.push(height(&row, column)?);
            }
        }
        let cells = [columns, rows.len().checked_div(columns).unwrap_or(0)];
        let spacing = Grid::new(cells, lengths)?.spacing();
        HeightMap::from_rows(cells, spacing, &rows, First::Top, |height| unit.to_metres(height))
    }
}

/// A height, NaN if it is missing.
pub(super) fn height(row: &TextRow, column: usize) -> Result<f64> {
    let text = &*row.fields[column];
    if text.is_empty() || text.eq_ignore_ascii_case("bad") {
        return Ok(f64::NAN);
    }
    let height = row.number(column)?;
    if height.is_infinite() { Err(row.not_numeric(column).into()) } else { Ok(height) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Error, FileError, TextError};

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
    fn malformed_lines_are_reported() {
        let columns = read("# a\n1,2,3\n4,5\n").unwrap_err();
        assert!(matches!(columns, Error::Text(TextError::Columns { line: 3, found: 2, expected: 3, .. })), "{columns}");
        for text in ["five", "inf", "1e999", "2:3"] {
            let numeric = TextError::NotNumeric { line: 2, column: 2, text: text.into() };
            assert_eq!(read(&format!("1 2 3\n4 {text} 6\n")).unwrap_err(), numeric.into());
        }
        for empty in ["", "\n\n", "# nothing\n"] {
            assert!(matches!(read(empty), Err(Error::CountOutOfRange { value: 0, .. })));
        }
        assert!(matches!(read("1 2\0\n"), Err(Error::File(FileError::Unreadable { .. }))));
        let flat = HeightMap::from_text("1 2\n".as_bytes(), [0.0, 1.0], LengthUnit::Metre, TextFormat::default());
        assert!(matches!(flat, Err(Error::OutOfRange { field: "length along x1", .. })));
    }
}
