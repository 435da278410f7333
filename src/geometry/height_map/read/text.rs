//! Matrices of heights in text files.

use std::io::Read;

use super::{First, bytes};
use crate::Grid;
use crate::error::{MapError, Result};
use crate::geometry::{HeightMap, LengthUnit};

const FORMAT: &str = "text";

impl HeightMap {
    /// Reads a matrix of heights in `unit` from text, on a rectangle of `lengths` \[m\]. A line is a row along x1; the
    /// first line is the top.
    ///
    /// Heights are separated by semicolons, tabs, commas or blanks. A field that is empty, `nan` or `bad` is a missing
    /// point. Empty lines and lines that start with `#` are skipped.
    ///
    /// ```
    /// use viscocontact::geometry::{HeightMap, LengthUnit};
    ///
    /// let text = "# a step, in µm\n0.0, 0.5, 0.5\n0.0,    , 0.6\n";
    /// let map = HeightMap::from_text(text.as_bytes(), [3e-6, 2e-6], LengthUnit::Micrometre)?;
    /// # let _ = map;
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Map`](crate::Error::Map) if the text cannot be read, a line differs from the first in its number of
    /// columns, or a field is not a number, each with the number of the line; as [`HeightMap::new`] if the map is
    /// invalid.
    pub fn from_text(reader: impl Read, lengths: [f64; 2], unit: LengthUnit) -> Result<HeightMap> {
        let text = text(reader)?;
        let table = Table::new(&text);
        let (mut rows, mut columns) = (Vec::new(), 0);
        // a separator at the end of every line terminates it; one at the end of some lines precedes a missing height
        let is_terminated = |line: &str| table.separator.is_some_and(|mark| line.trim_end_matches(' ').ends_with(mark));
        let terminated = table.lines().all(|(_, line)| is_terminated(line));
        for (line, content) in table.lines() {
            let mut fields = table.fields(content);
            if terminated {
                fields.pop();
            }
            columns = if rows.is_empty() { fields.len() } else { columns };
            if fields.len() != columns {
                return Err(MapError::Columns { line, found: fields.len(), expected: columns }.into());
            }
            for (k, field) in fields.iter().enumerate() {
                rows.push(height(line, k + 1, field)?);
            }
        }
        let cells = [columns, rows.len().checked_div(columns).unwrap_or(0)];
        let spacing = Grid::new(cells, lengths)?.spacing();
        HeightMap::from_rows(cells, spacing, &rows, First::Top, |height| unit.to_metres(height))
    }
}

/// The text of a reader. Comments may be in any encoding; numbers are ASCII.
pub(super) fn text(reader: impl Read) -> Result<String> {
    let bytes = bytes(reader, FORMAT)?;
    if bytes.contains(&0) {
        return Err(
            MapError::Unreadable { file: "text file".into(), reason: "it is not text".into(), kind: None }.into()
        );
    }
    let text = String::from_utf8_lossy(&bytes);
    // byte order mark that some spreadsheets write
    Ok(text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned())
}

/// Lines of numbers with a common separator.
pub(super) struct Table<'a> {
    text: &'a str,
    /// `None` for blanks.
    separator: Option<char>,
}

impl<'a> Table<'a> {
    pub(super) fn new(text: &'a str) -> Table<'a> {
        let mut table = Table { text, separator: None };
        let first = table.lines().next().map_or("", |(_, line)| line);
        table.separator = [';', '\t', ','].into_iter().find(|&mark| first.contains(mark));
        table
    }

    /// The lines with data, and their numbers.
    pub(super) fn lines(&self) -> impl Iterator<Item = (u64, &'a str)> {
        let numbered = (1..).zip(self.text.lines());
        numbered.filter(|(_, line)| {
            let line = line.trim_start();
            !line.is_empty() && !line.starts_with('#')
        })
    }

    pub(super) fn fields(&self, line: &'a str) -> Vec<&'a str> {
        match self.separator {
            Some(separator) => line.split(separator).map(str::trim).collect(),
            None => line.split_whitespace().collect(),
        }
    }
}

/// A height, NaN if it is missing.
pub(super) fn height(line: u64, column: usize, text: &str) -> Result<f64> {
    match text.parse::<f64>() {
        _ if text.is_empty() || text.eq_ignore_ascii_case("bad") => Ok(f64::NAN),
        Ok(height) if !height.is_infinite() => Ok(height),
        _ => Err(MapError::NotNumeric { line, column, text: text.to_owned() }.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    fn read(text: &str) -> Result<HeightMap> {
        HeightMap::from_text(text.as_bytes(), [3.0, 4.0], LengthUnit::Millimetre)
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
        let columns = MapError::Columns { line: 3, found: 2, expected: 3 };
        assert_eq!(read("# a\n1,2,3\n4,5\n").unwrap_err(), columns.into());
        for text in ["five", "inf", "1e999", "2:3"] {
            let numeric = MapError::NotNumeric { line: 2, column: 2, text: text.into() };
            assert_eq!(read(&format!("1 2 3\n4 {text} 6\n")).unwrap_err(), numeric.into());
        }
        for empty in ["", "\n\n", "# nothing\n"] {
            assert!(matches!(read(empty), Err(Error::CountOutOfRange { value: 0, .. })));
        }
        assert!(matches!(read("1 2\0\n"), Err(Error::Map(MapError::Unreadable { .. }))));
        let flat = HeightMap::from_text("1 2\n".as_bytes(), [0.0, 1.0], LengthUnit::Metre);
        assert!(matches!(flat, Err(Error::OutOfRange { field: "length along x1", .. })));
    }
}
