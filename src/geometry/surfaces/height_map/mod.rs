//! Measured surfaces: heights on a regular grid of points, read, prepared, interpolated and shifted.

mod fill;
mod level;
mod prepare;
mod read;
mod resample;
mod sample;
mod unit;
mod write;

pub use level::Form;
pub use unit::LengthUnit;

use std::fmt;

use crate::Grid;
use crate::error::{Error, LONGEST, Refusal, Result, exact_length};
use crate::geometry::surfaces::height_spectrum::HeightSpectrum;
use crate::geometry::{Geometry, Waves};
use crate::values::Counted;

/// Distances from a point below this, in cells, are rounding errors.
const ROUNDING: f64 = 1e-10;
/// Spacings whose relative difference is below this are the same.
const SAME_SPACING: f64 = 1e-12;

/// The heights of a surface on a regular grid of points.
///
/// Heights are positive out of the measured material. As a [`Geometry`], the gap is the height of the highest point
/// above the surface: that point touches first, at an approach of 0. The middle of the map is at the origin, unless
/// [`HeightMap::centered_at`] moves it.
///
/// Between its points a map is interpolated bicubically (Keys 1981, a = −1/2). Beyond the outermost points it is
/// extrapolated linearly to the edge of their cells, and outside there is nothing to touch (+∞), unless it is
/// [periodic](HeightMap::periodic). A periodic map without missing points is shifted over a grid of its own spacing by
/// its Fourier series, which is exact for every surface whose waves are longer than two cells.
///
/// You decide how missing points are treated: [filled](HeightMap::filled) by interpolation, or
/// [masked](HeightMap::masked) as nothing to touch. Otherwise the gap there is NaN, which a contact refuses.
///
/// ```
/// use viscocontact::geometry::{Form, Geometry, HeightMap};
///
/// // Heights of 3 × 3 points 1 µm apart, one of them not measured.
/// let heights = vec![0.0, 1e-9, 0.0, 1e-9, f64::NAN, 1e-9, 0.0, 1e-9, 0.0];
/// let map = HeightMap::new([3, 3], [3e-6, 3e-6], heights)?;
/// assert_eq!(map.missing(), 1);
/// assert!(map.initial_gap(0.0, 0.0).is_nan());
///
/// // the form first, from the known heights: holes are filled on the level surface
/// let map = map.leveled(Form::Tilt)?.filled()?;
/// assert!(map.initial_gap(0.0, 0.0).abs() < 1e-18);
/// assert!((map.initial_gap(1e-6, 1e-6) - 1e-9).abs() < 1e-18);
/// assert_eq!(map.initial_gap(2e-6, 0.0), f64::INFINITY);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct HeightMap {
    cells: [usize; 2],
    spacing: [f64; 2],
    /// Row-major, x2 fastest; NaN where nothing was measured.
    heights: Vec<f64>,
    /// The largest known height; −∞ if there is none.
    highest: f64,
    /// Number of missing heights.
    missing: usize,
    /// Whether there is nothing to touch at missing heights; otherwise they are undecided.
    masked: bool,
    center: [f64; 2],
    periodic: bool,
}

debug_by! {
    self: HeightMap =>
    cells: self.cells, spacing: self.spacing, heights: Counted(&self.heights), highest: self.highest,
    missing: self.missing, masked: self.masked, center: self.center, periodic: self.periodic
}

/// One line: numbers of points, lengths, least and maximum height, missing heights.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let map = HeightMap::new([2, 2], [4e-6, 4e-6], vec![0.0, 1e-9, 3e-9, f64::NAN])?;
/// assert_eq!(map.to_string(), "2 × 2 heights from 0.000e0 m to 3.000e-9 m on 4.000e-6 m × 4.000e-6 m, 1 missing");
/// # Ok::<(), viscocontact::Error>(())
/// ```
impl fmt::Display for HeightMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([n1, n2], [l1, l2]) = (self.cells, self.lengths());
        write!(f, "{n1} × {n2} heights")?;
        if self.missing < self.heights.len() {
            let lowest = self.heights.iter().copied().fold(f64::INFINITY, f64::min);
            write!(f, " from {lowest:.3e} m to {:.3e} m", self.highest)?;
        }
        write!(f, " on {l1:.3e} m × {l2:.3e} m")?;
        if self.missing > 0 {
            write!(f, ", {} missing", self.missing)?;
        }
        if self.periodic { f.write_str(", periodic") } else { Ok(()) }
    }
}

impl HeightMap {
    /// A map of `cells[0]` × `cells[1]` heights \[m\] at the centres of the cells of a rectangle of `lengths` \[m\],
    /// row-major with x2 fastest; NaN where nothing was measured.
    ///
    /// # Errors
    /// If a [`Grid`] may not have these numbers of cells or lengths, there are not `cells[0] * cells[1]` heights, or
    /// one is infinite or beyond ±1e300 m.
    pub fn new(cells: [usize; 2], lengths: [f64; 2], heights: Vec<f64>) -> Result<HeightMap> {
        let grid = Grid::new(cells, lengths)?;
        exact_length("heights", heights.len(), grid.len())?;
        check_heights(&heights)?;
        Ok(HeightMap::on(&grid, heights))
    }

    /// A map on the cells of a grid. The heights, one per cell, must be finite or NaN.
    pub(in crate::geometry) fn on(grid: &Grid, heights: Vec<f64>) -> HeightMap {
        let map = HeightMap {
            cells: grid.cells(),
            spacing: grid.spacing(),
            heights,
            highest: f64::NEG_INFINITY,
            missing: 0,
            masked: false,
            center: [0.0; 2],
            periodic: false,
        };
        map.summarized()
    }

    /// The map with its maximum height and its number of missing heights recomputed.
    fn summarized(mut self) -> HeightMap {
        self.highest = self.heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        self.missing = self.heights.iter().filter(|h| h.is_nan()).count();
        self
    }

    /// Number of points along x1 and x2.
    pub fn cells(&self) -> [usize; 2] {
        self.cells
    }

    /// Distance between points along x1 and x2 \[m\].
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Sides of the rectangle of all cells \[m\]; the periods of a periodic map.
    pub fn lengths(&self) -> [f64; 2] {
        self.grid().lengths()
    }

    /// The heights \[m\], row-major with x2 fastest; NaN where one is missing.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Number of missing heights, masked or undecided.
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// Middle of the map \[m\].
    pub fn center(&self) -> [f64; 2] {
        self.center
    }

    /// Whether the map is periodic ([`HeightMap::periodic`]).
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }

    /// The grid whose cell centres are the points of the map, centred at the origin like every grid.
    pub fn grid(&self) -> Grid {
        Grid::of_spacing(self.cells, self.spacing)
    }

    /// The known heights \[m\].
    pub(in crate::geometry) fn known(&self) -> impl Iterator<Item = f64> {
        self.heights.iter().copied().filter(|h| !h.is_nan())
    }

    /// Refuses a map without a known height.
    pub(in crate::geometry) fn require_known(&self) -> Result<()> {
        if self.missing < self.heights.len() { Ok(()) } else { Err(nothing_known()) }
    }

    /// Position of the first cell of `grid` in the map shifted by `by`: index of the nearest point, and the fraction
    /// of a cell from there. The fraction is counted from the origin: it is the same to the last bit for all rows of
    /// a grid.
    fn offset(&self, grid: &Grid, by: [f64; 2], axis: usize) -> (f64, f64) {
        let (cells, half) = grid.offset_of_first(axis);
        let position = self.index(axis, half * grid.spacing()[axis] - by[axis]);
        let whole = position.round();
        (whole + cells as f64, position - whole)
    }

    /// Writes the gap of the shifted map: the Fourier series shifts the heights by a fraction of a cell, and whole
    /// cells are copied.
    fn fill_by_fourier_shift(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
        let offset = [0, 1].map(|axis| self.offset(grid, by, axis));
        let (whole, fraction) = (offset.map(|(whole, _)| whole), offset.map(|(_, fraction)| fraction));
        let shifted = (fraction.iter().any(|f| f.abs() > ROUNDING)).then(|| {
            let mut spectrum = HeightSpectrum::of(self.cells, &self.heights);
            spectrum.shift(fraction);
            spectrum.heights()
        });
        let heights = shifted.as_ref().unwrap_or(&self.heights);
        // The remainder first: large shifts exceed the range of isize.
        let first = [0, 1].map(|axis| whole[axis].rem_euclid(self.cells[axis] as f64) as usize);
        let ([n1, n2], [_, columns]) = (self.cells, grid.cells());
        for (i, row) in gap.chunks_exact_mut(columns).enumerate() {
            let from = (first[0] + i) % n1 * n2;
            for (j, value) in row.iter_mut().enumerate() {
                *value = self.highest - heights[from + (first[1] + j) % n2];
            }
        }
    }

    /// Whether map and grid have the same spacing, so that all points have the same fractional offset.
    fn has_spacing_of(&self, grid: &Grid) -> bool {
        let differs = |axis: usize| (grid.spacing()[axis] / self.spacing[axis] - 1.0).abs() > SAME_SPACING;
        (0..2).all(|axis| self.cells[axis] == 1 || !differs(axis))
    }
}

/// The error of a map without heights.
fn nothing_known() -> Error {
    let what = "no height is known: nothing was measured there";
    Refusal::value("map_nothing_known", what, "; take a part of the map with heights").into()
}

/// The error of a height that overflows.
pub(super) fn not_finite(entry: usize, value: f64) -> Error {
    let what = format!(
        "height {entry} of the map is {value:?}: heights must be finite and within ±1e300 m, or NaN where nothing was \
         measured"
    );
    Refusal::value("map_not_finite", what, "")
        .naming("height")
        .valued(value)
        .allowing("finite and within ±1e300 m, or NaN")
        .into()
}

/// Refuses heights whose differences and sums would overflow.
fn check_heights(heights: &[f64]) -> Result<()> {
    match heights.iter().position(|height| height.abs() > LONGEST) {
        Some(entry) => Err(not_finite(entry, heights[entry])),
        None => Ok(()),
    }
}

impl Geometry for HeightMap {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        match self.height_at(x1, x2) {
            Some(height) => self.highest - height,
            None if self.masked || self.indices(x1, x2).is_none() => f64::INFINITY,
            None => f64::NAN,
        }
    }

    fn fill_gap_at(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
        if self.periodic && self.missing == 0 && self.has_spacing_of(grid) && by.iter().all(|b| b.is_finite()) {
            assert_eq!(gap.len(), grid.len(), "gap must have one value per cell");
            self.fill_by_fourier_shift(grid, by, gap);
        } else {
            crate::geometry::fill_by_points(self, grid, by, gap);
        }
    }

    /// Waves of four of its points and more, whatever shorter ones it may hold: on a grid of its own spacing nothing
    /// is missed.
    fn waves(&self) -> Vec<Waves> {
        let period = if self.periodic { self.lengths() } else { [f64::INFINITY; 2] };
        vec![Waves { period, shortest: self.spacing.map(|spacing| 4.0 * spacing) }]
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;
    use crate::geometry::{Shifted, Sphere, Sum};

    /// A sum of waves on the unit square.
    pub(super) fn waves(x1: f64, x2: f64) -> f64 {
        let tau = std::f64::consts::TAU;
        (tau * (x1 + 0.1)).sin() + 0.5 * (tau * (2.0 * x1 - 3.0 * x2)).cos() + 0.3 * (tau * (x2 - 0.3)).cos()
    }

    pub(super) fn map_of(cells: [usize; 2], f: impl Fn(f64, f64) -> f64) -> HeightMap {
        let grid = Grid::new(cells, [1.0, 1.0]).unwrap();
        let heights = (0..grid.len()).map(|k| {
            let [x1, x2] = grid.center(k / cells[1], k % cells[1]);
            f(x1, x2)
        });
        HeightMap::new(cells, [1.0, 1.0], heights.collect()).unwrap()
    }

    #[test]
    fn bad_maps_are_refused() {
        let refused = |heights: Vec<f64>| HeightMap::new([2, 2], [1.0, 1.0], heights).unwrap_err();
        assert!(matches!(refused(vec![0.0; 3]), Error::WrongLength { len: 3, expected: 4, .. }));
        assert_eq!(refused(vec![0.0, 0.0, f64::INFINITY, 0.0]), not_finite(2, f64::INFINITY));
        // their differences and sums would overflow
        assert_eq!(refused(vec![1e305, 0.0, -1e308, 0.0]), not_finite(0, 1e305));
        assert_eq!(HeightMap::new([0, 2], [1.0, 1.0], vec![]).unwrap_err().kind(), crate::ErrorKind::Value);
    }

    #[test]
    fn the_highest_point_touches_first() {
        let map = map_of([4, 3], |x1, x2| 3.0 * x1 - x2);
        let mut gap = vec![0.0; 12];
        map.fill_gap(&map.grid(), &mut gap);
        assert_eq!(gap.iter().copied().fold(f64::INFINITY, f64::min), 0.0);
        assert_eq!(gap[9], 0.0);
        assert_abs_diff_eq!(gap[2], 9.0 / 4.0 + 2.0 / 3.0, epsilon = 1e-14);
    }

    #[test]
    fn undecided_points_are_refused_where_the_gap_is_used() {
        use crate::geometry::{Gap, evaluate};
        let map = map_of([4, 4], |x1, x2| if x1 > 0.3 && x2 > 0.3 { f64::NAN } else { x1 });
        let joined = |map: &HeightMap| Gap::new(vec![evaluate(map, &map.grid()).unwrap()], &map.grid());
        let refused = joined(&map).unwrap_err();
        assert!(matches!(refused, Error::InvalidGap { cell: [3, 3], value, .. } if value.is_nan()));
        assert_eq!(joined(&map.clone().masked()).unwrap().above[15], f64::INFINITY);
        assert!(joined(&map.filled().unwrap()).unwrap().above.iter().all(|h| h.is_finite()));
        let nothing = map_of([2, 2], |_, _| f64::NAN).masked();
        assert_eq!(joined(&nothing), Err(Error::NothingToTouch { body: 0, cells: 4 }));
    }

    #[test]
    fn band_limited_maps_are_shifted_exactly() {
        for cells in [[16, 12], [15, 13], [16, 15]] {
            let map = map_of(cells, waves).periodic();
            let grid = Grid::new(cells, [1.0, 1.0]).unwrap();
            let mut gap = vec![0.0; grid.len()];
            for by in [[0.013, -0.4], [2.0 / cells[0] as f64, 0.0], [-7.3, 5.01], [1e3, 0.21]] {
                map.fill_gap_at(&grid, by, &mut gap);
                for (k, value) in gap.iter().enumerate() {
                    let [x1, x2] = grid.center(k / cells[1], k % cells[1]);
                    let expected = map.highest - waves(x1 - by[0], x2 - by[1]);
                    assert!((value - expected).abs() < 1e-11, "{by:?}: {value} for {expected}");
                }
            }
        }
    }

    #[test]
    fn whole_cells_are_copied_bitwise() {
        let map = map_of([8, 6], |x1, x2| (37.0 * x1 + 91.0 * x2 * x2).sin()).periodic();
        let (mut moved, mut wide) = (vec![0.0; 48], vec![0.0; 16 * 6]);
        map.fill_gap_at(&map.grid(), [3.0 / 8.0, -2.0 / 6.0], &mut moved);
        map.fill_gap(&Grid::new([16, 6], [2.0, 1.0]).unwrap(), &mut wide);
        for i in 0..8 {
            for j in 0..6 {
                let from = map.heights[(i + 5) % 8 * 6 + (j + 2) % 6];
                assert_eq!(moved[i * 6 + j], map.highest - from);
                assert_eq!(wide[(i + 4) * 6 + j], map.highest - map.heights[i * 6 + j]);
            }
        }
    }

    #[test]
    fn the_nyquist_wave_stays_real() {
        // The shortest wave of an even number of points: a shift multiplies it by a cosine.
        let map = map_of([6, 4], |x1, _| if ((x1 + 0.5) * 6.0) as i64 % 2 == 0 { 1.0 } else { -1.0 }).periodic();
        let mut gap = vec![0.0; 24];
        map.fill_gap_at(&map.grid(), [0.25 / 6.0, 0.0], &mut gap);
        let factor = (0.25 * std::f64::consts::PI).cos();
        assert_abs_diff_eq!(gap[0], 1.0 - factor, epsilon = 1e-14);
        assert_abs_diff_eq!(gap[4], 1.0 + factor, epsilon = 1e-14);
    }

    #[test]
    fn parts_of_a_sum_are_shifted_by_their_own_methods() {
        // A wave with a period of 3 points is shifted exactly only by its Fourier series: bicubic interpolation errs by
        // a tenth.
        let wave = |x: f64| (std::f64::consts::TAU * x / 3.0).cos();
        let map = HeightMap::new([9, 1], [9.0, 1.0], (0..9).map(|i| wave(i as f64 - 4.0)).collect()).unwrap();
        let moved = Shifted::new(Sum::new(map.periodic(), Sphere::new(1.0).unwrap()), [0.2, 0.0]).unwrap();
        let moved = Shifted::new(moved, [0.2, 0.0]).unwrap();
        let grid = Grid::new([9, 1], [9.0, 1.0]).unwrap();
        let mut gap = vec![0.0; 9];
        moved.fill_gap(&grid, &mut gap);
        for (i, h) in gap.iter().enumerate() {
            let x = i as f64 - 4.4;
            assert_abs_diff_eq!(*h, 1.0 - wave(x) + 0.5 * x * x, epsilon = 1e-13);
        }
    }
}
