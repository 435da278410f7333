//! Triplets of coordinates and height in text files.

use std::io::Read;

use super::regular_axis::{Point, RegularAxis, axis, sparse};
use super::text::{NO_HEIGHT, height, known_heights, mask};
use super::{First, count};
use crate::error::{Refusal, Result, within};
use crate::geometry::{HeightMap, LengthUnit};
use crate::input::{Quantity, TableRow, TakenColumn, TextFormat, TextTable, UnitOf, WantedColumn, name, same};
use crate::memory;
use crate::rounded::rounded;

/// Maximum number of grid points per point of the file, and of a profile.
const MAX_CELLS_PER_POINT: usize = 100;
const MAX_CELLS_PER_POINT_OF_PROFILE: usize = 2;

impl HeightMap {
    /// Reads lines of x, y and height from text, with coordinates in the unit `lateral` and heights in the unit
    /// `vertical`.
    ///
    /// The points may be in any order, but must lie on a regular grid along x and y to within 1/1000 of its spacing,
    /// which is determined from them. Points of the grid that are absent, or whose height is `nan` or `bad`, are
    /// missing. `format` states how the text is written, and which height stands for missing points. Headings (x, y,
    /// z, with the units given) are looked for as in a [`TextTable`].
    ///
    /// ```
    /// use viscocontact::TextFormat;
    /// use viscocontact::geometry::{HeightMap, LengthUnit};
    ///
    /// let text = "0 0 1.0\n1 0 1.5\n2 0 2.0\n0 2 1.1\n1 2 1.6\n2 2 2.1\n";
    /// let (lateral, vertical) = (LengthUnit::Millimetre, LengthUnit::Micrometre);
    /// let map = HeightMap::from_xyz(text.as_bytes(), lateral, vertical, TextFormat::default())?;
    /// # let _ = map; // 3 × 2 cells on 3 mm × 4 mm
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the text cannot be read or a line does not have three numbers; if a point
    /// lies off the grid or is given twice, or less than 1 % of the points of the grid are given; if there are fewer
    /// than two different coordinates along x or y; as
    /// [`HeightMap::new`] if the map is invalid.
    pub fn from_xyz(
        reader: impl Read,
        lateral: LengthUnit,
        vertical: LengthUnit,
        format: TextFormat,
    ) -> Result<HeightMap> {
        let table = TextTable::read(reader, format)?;
        on_plane(&points(&table, &[X, Y, HEIGHT], [lateral, vertical], format)?)
    }

    /// [`HeightMap::from_xyz`] of points x, y, height \[m\], given as an array; NaN where no height was measured.
    ///
    /// # Errors
    /// As [`HeightMap::from_xyz`]; lines count the points from 1.
    pub fn from_points(points: &[[f64; 3]]) -> Result<HeightMap> {
        let point = |(k, &[x, y, height]): (usize, &[f64; 3])| Point { line: k as u64 + 1, at: [x, y], height };
        known_heights(&points.iter().map(|point| point[2]).collect::<Vec<_>>())?;
        let points: Vec<Point> = points.iter().enumerate().map(point).collect();
        for (field, value) in points.iter().flat_map(|p| [("x of the points", p.at[0]), ("y of the points", p.at[1])]) {
            // a mark of missing data is no coordinate
            within(field, value, value.abs() < NO_HEIGHT, "within ±1e30 m")?;
        }
        on_plane(&points)
    }

    /// Reads a profile, lines of x and height, for a line contact: a map of a single row along x1.
    ///
    /// As [`HeightMap::from_xyz`]: the points must lie at regular distances, and may have headings. An array of
    /// heights at regular distances is a profile by [`HeightMap::new`] with `[n, 1]` cells.
    ///
    /// ```
    /// use viscocontact::TextFormat;
    /// use viscocontact::geometry::{HeightMap, LengthUnit};
    ///
    /// let text = "x (mm);z (µm)\n0,0;1,5\n0,1;1,7\n0,2;1,1\n0,3;---\n";
    /// let (lateral, vertical) = (LengthUnit::Millimetre, LengthUnit::Micrometre);
    /// let profile = HeightMap::from_profile(text.as_bytes(), lateral, vertical, TextFormat::default())?;
    /// assert_eq!(profile.cells(), [4, 1]);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`HeightMap::from_xyz`].
    pub fn from_profile(
        reader: impl Read,
        lateral: LengthUnit,
        vertical: LengthUnit,
        format: TextFormat,
    ) -> Result<HeightMap> {
        let table = TextTable::read(reader, format)?;
        let points = points(&table, &[X, HEIGHT], [lateral, vertical], format)?;
        let along = axis(&points, "x", 0)?;
        let across = RegularAxis { cells: 1, spacing: along.spacing, indices: vec![0; points.len()] };
        on_grid(&points, [along, across], MAX_CELLS_PER_POINT_OF_PROFILE)
    }
}

/// The map of points of a plane.
fn on_plane(points: &[Point]) -> Result<HeightMap> {
    on_grid(points, [axis(points, "x", 0)?, axis(points, "y", 1)?], MAX_CELLS_PER_POINT)
}

/// The map of points on a regular grid of at most so many cells for each point.
fn on_grid(points: &[Point], axes: [RegularAxis; 2], most_cells: usize) -> Result<HeightMap> {
    let (cells, spacing) = (axes.each_ref().map(|axis| axis.cells), axes.each_ref().map(|axis| axis.spacing));
    let count = count(cells, spacing)?;
    if count.div_ceil(most_cells) > points.len() {
        return Err(sparse(points.len(), cells));
    }
    let what = "the grid that the points of a file lie on";
    let (mut rows, mut lines) = (memory::field(what, count, f64::NAN)?, memory::field(what, count, 0_u64)?);
    for (k, point) in points.iter().enumerate() {
        let at = axes[1].indices[k] * cells[0] + axes[0].indices[k];
        if lines[at] != 0 {
            let [x, y] = point.at.map(|x| rounded(x, 5));
            let what = format!("lines {} and {} give two heights for the point ({x}, {y}) m", lines[at], point.line);
            return Err(Refusal::file("map_duplicate", what, ": give their mean").into());
        }
        (rows[at], lines[at]) = (point.height, point.line);
    }
    HeightMap::from_rows(cells, spacing, &rows, First::Bottom, |height| height)
}

const fn coordinate(name: &'static str, words: &'static [&'static str]) -> WantedColumn {
    WantedColumn { name, words, others: &[], quantity: Quantity::LENGTH, by_unit: false }
}

const X: WantedColumn = coordinate("x", &["x", "x1"]);
const Y: WantedColumn = coordinate("y", &["y", "x2"]);
const HEIGHT: WantedColumn = coordinate("height", &["z", "height", "h"]);

/// The points of a table with these columns, the last of which has the heights. `units` apply to coordinates and
/// heights.
fn points(
    table: &TextTable,
    wanted: &[WantedColumn],
    units: [LengthUnit; 2],
    format: TextFormat,
) -> Result<Vec<Point>> {
    let last = wanted.len() - 1;
    let taken: Vec<TakenColumn> =
        match wanted.iter().map(|column| table.find(column)).collect::<Result<Option<_>, _>>()? {
            Some(taken) => taken,
            None if table.headings().is_empty() => {
                wanted.iter().enumerate().map(|(k, column)| table.by_place(column, k)).collect()
            }
            None => match table.without_comment() {
                Some(plain) => return points(&plain, wanted, units, format),
                None => return Err(table.missing(&wanted[0], "")),
            },
        };
    for (k, column) in taken.iter().enumerate() {
        let given = units[usize::from(k == last)];
        let differs = |size: f64| !same(size, given.factor());
        if column.unit().is_ok_and(differs) || matches!(column.unit_of, UnitOf::Other(_) | UnitOf::Unclear(_)) {
            let (heading, given) = (column.heading(), name(Quantity::LENGTH, given.factor()));
            let index = column.index() + 1;
            let what =
                format!("column {index}: the heading {heading:?} names another unit than {given}, which was given");
            return Err(Refusal::file("map_other_unit", what, ": give that of the heading").into());
        }
    }
    let coordinates = taken[..last].to_vec();
    let mut rows = table.rows_by(&taken, |row, column| {
        if coordinates.iter().all(|coordinate| coordinate.index() != column) {
            return height(row, column);
        }
        // nor is a coordinate a mark of missing data, as −3.4e38
        row.number(column)
            .and_then(|value| if value.abs() < NO_HEIGHT { Ok(value) } else { Err(row.not_numeric(column)) })
    })?;
    let mut heights: Vec<f64> = rows.iter_mut().filter_map(|row| row.values.pop()).collect();
    mask(&mut heights, format.missing_height())?;
    let point = |(row, height): (TableRow, f64)| {
        let at = [row.values[0], row.values.get(1).copied().unwrap_or(0.0)].map(|value| units[0].to_metres(value));
        Point { line: row.line, at, height: units[1].to_metres(height) }
    };
    Ok(rows.into_iter().zip(heights).map(point).collect())
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;
    use crate::error::Error;

    fn read(text: &str) -> Result<HeightMap> {
        HeightMap::from_xyz(text.as_bytes(), LengthUnit::Micrometre, LengthUnit::Nanometre, TextFormat::default())
    }

    #[test]
    fn points_in_any_order_define_the_grid() {
        // x: 10, 10.5, 11; y: -1, 1; one point absent, one not measured
        let map = read("# x y z\n11;1;6\n10; -1 ;1\n10.5;1;nan\n\n10;1;4\n11;-1;3").unwrap();
        assert_eq!(map.cells, [3, 2]);
        assert!((map.spacing[0] / 0.5e-6 - 1.0).abs() < 1e-12 && (map.spacing[1] / 2e-6 - 1.0).abs() < 1e-12);
        let wanted = [1.0, 4.0, f64::NAN, f64::NAN, 3.0, 6.0].map(|height| height / 1e9);
        for (height, wanted) in map.heights.iter().zip(wanted) {
            assert!(*height == wanted || height.is_nan() && wanted.is_nan(), "{height} for {wanted}");
        }
    }

    #[test]
    fn arrays_headings_and_profiles_are_read() {
        let map = read("0 0 1\n1 0 2\n0 1 3\n1 1 4\n").unwrap();
        let points = [[0.0, 0.0, 1e-9], [1e-6, 0.0, 2e-9], [0.0, 1e-6, 3e-9], [1e-6, 1e-6, 4e-9]];
        assert_eq!(HeightMap::from_points(&points).unwrap().heights, map.heights);
        for mark in [f64::NAN, -3.4028235e38] {
            let refused =
                HeightMap::from_points(&[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, mark, 1.0]]);
            assert!(matches!(refused, Err(Error::OutOfRange { field: "y of the points", .. })), "{refused:?}");
        }
        let named = read("y [um];x [um];z [nm]\n0;0;1\n0;1;2\n1;0;3\n1;1;4\n").unwrap();
        assert_eq!(named, map);
        let other = read("x [mm];y [um];z [nm]\n0;0;1\n0;1;2\n1;0;3\n1;1;4\n").unwrap_err();
        assert!(other.code() == "map_other_unit" && other.to_string().starts_with("column 1: "), "{other}");
        let profile = |text: &str| {
            let units = [LengthUnit::Micrometre, LengthUnit::Nanometre];
            HeightMap::from_profile(text.as_bytes(), units[0], units[1], TextFormat::default())
        };
        let line = profile("0 1\n0.5 bad\n1 3\n1.5 4\n").unwrap();
        assert_eq!((line.cells, line.missing), ([4, 1], 1));
        let uneven = profile("0.01 1\n0.1 2\n1 3\n10 4\n").unwrap_err();
        assert!(uneven.code() == "map_sparse" && uneven.to_string().starts_with("4 points"), "{uneven}");
        // a gap of 120 spacings, in two files merged
        let merged: String = (0..300).filter(|k| !(100..219).contains(k)).map(|k| format!("{k} 1\n")).collect();
        let merged = profile(&merged).unwrap();
        assert_eq!((merged.cells, merged.missing), ([300, 1], 119));
        let twice = profile("0 1\n0.5 2\n1 3\n0.5 4\n").unwrap_err();
        assert!(twice.to_string().starts_with("lines 2 and 4 give two heights"), "{twice}");
    }

    #[test]
    fn rounded_coordinates_of_a_long_grid_are_found() {
        // a spacing of 1/3 to four decimals: no single rounded step could locate 2000 points
        let mut text = String::new();
        for i in 0..2000 {
            for j in 0..2 {
                if i % 7 != 3 || j == 0 {
                    text += &format!("{:.4},{},{}\n", f64::from(i) / 3.0, 5 * j, i + 10_000 * j);
                }
            }
        }
        let map = read(&text).unwrap();
        assert_eq!(map.cells, [2000, 2]);
        assert_abs_diff_eq!(map.spacing[0] * 3e6, 1.0, epsilon = 1e-6);
        for i in 0..2000 {
            assert_eq!(map.heights[2 * i], i as f64 / 1e9);
            assert!(
                map.heights[2 * i + 1] == (i + 10_000) as f64 / 1e9 || i % 7 == 3 && map.heights[2 * i + 1].is_nan()
            );
        }
    }

    #[test]
    fn columns_that_are_absent_throughout_are_missing() {
        let map = read("0 0 1\n1 0 2\n5 0 3\n0 1 4\n1 1 5\n5 1 6\n").unwrap();
        assert_eq!(map.cells, [6, 2]);
        assert_eq!(map.heights.iter().filter(|height| height.is_nan()).count(), 6);
        assert_eq!(map.heights[10..], [3.0 / 1e9, 6.0 / 1e9]);
    }

    #[test]
    fn points_off_a_grid_are_refused() {
        let square = "0 0 1\n1 0 2\n2 0 3\n0 1 4\n1 1 5\n";
        assert!(read(square).is_ok());
        let duplicate = read(&format!("{square}1.0002 0 7\n")).unwrap_err();
        assert!(duplicate.to_string().starts_with("lines 2 and 6 give two heights"), "{duplicate}");
        for (stray, name) in [("2.01 1 6", "x"), ("2.005 1 6", "x"), ("2.3 1 6", "x"), ("2 1.4 6", "y")] {
            let error = read(&format!("{square}{stray}\n")).unwrap_err();
            assert!(error.is("map_off_grid", name), "{error}");
        }
        for text in ["", "0 0 1\n", "0 0 1\n1 0 2\n", "0 0 1\n0 1 2\n"] {
            assert!(matches!(read(text), Err(Error::WrongLength { expected: 2, .. })), "{text}");
        }
        // scattered points: a diagonal in a grid of a million
        let diagonal: String = (0..1000).map(|k| format!("{k} {k} 1\n")).collect();
        assert_eq!(read(&diagonal).unwrap_err(), sparse(1000, [1000, 1000]));
        let wide = "-1e308 0 1\n1e308 0 1\n0 1 1\n1e308 1 1\n";
        assert!(
            HeightMap::from_xyz(wide.as_bytes(), LengthUnit::Metre, LengthUnit::Metre, TextFormat::default()).is_err()
        );
        assert!(read("0 0 1\n1e-320 0 1\n0 1 1\n").is_err());
    }

    #[test]
    fn malformed_lines_are_reported() {
        let columns = read("0 0 1\n1 0\n").unwrap_err();
        assert!(
            columns.to_string().starts_with("line 2: 2 columns separated by blanks, but 3 are needed"),
            "{columns}"
        );
        for (line, column, text) in [
            ("one 0 1", 1, "one"),
            ("-3.4028235e38 0 1", 1, "-3.4028235e38"),
            ("1 nan 1", 2, "nan"),
            ("1 0 1e999", 3, "1e999"),
        ] {
            let error = read(&format!("0 0 1\n{line}\n")).unwrap_err();
            let wanted = format!("line 2, column {column}: {text:?} is not a number; ");
            assert!(error.to_string().starts_with(&wanted), "{error}");
        }
    }
}
