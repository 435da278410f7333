//! Measured surfaces: heights on a regular grid of points, prepared, sampled and moved.

mod fill;
mod level;
mod prepare;
mod read;
mod resample;
mod sample;
mod unit;
mod write;

pub use level::Form;
pub use resample::{Resampled, ResamplingError};
pub use unit::LengthUnit;

use crate::Grid;
use crate::error::{Error, LONGEST, MapError, Result, exact_length};
use crate::geometry::Geometry;
use crate::geometry::spectrum::Spectrum;

/// Distances from a point of less than this, in cells, are rounding.
const ROUNDING: f64 = 1e-10;
/// Cells whose sides differ relatively by less than this are the same.
const SAME_SPACING: f64 = 1e-12;

/// The heights of a surface on a regular grid of points.
///
/// Heights are positive out of the material that they were measured on. As a [`Geometry`] the gap is what the
/// highest point exceeds the height by: that point touches first, at an approach of 0. The middle of the map is at
/// the origin, unless it is moved ([`HeightMap::centered_at`]).
///
/// Between its points a map is bicubic (Keys 1981, a = −1/2), through the outermost points it goes on straight to the
/// edge of their cells, and beyond there is nothing to touch (+∞), unless it is [periodic](HeightMap::periodic).
/// A periodic map without missing points moves over a grid of its own spacing as the sum of its waves, exact for
/// every surface whose shortest waves are longer than two cells.
///
/// What becomes of missing points is yours to say: [filled](HeightMap::filled) from their neighbours, or
/// [masked](HeightMap::masked) as nothing to touch. Where neither was said the gap is NaN, which a contact refuses.
///
/// ```
/// use viscocontact::geometry::{Form, Geometry, HeightMap};
///
/// // Heights of 3 × 3 points 1 µm apart; one was not measured.
/// let heights = vec![0.0, 1e-9, 0.0, 1e-9, f64::NAN, 1e-9, 0.0, 1e-9, 0.0];
/// let map = HeightMap::new([3, 3], [3e-6, 3e-6], heights)?;
/// assert_eq!(map.missing(), 1);
/// assert!(map.initial_gap(0.0, 0.0).is_nan());
///
/// let map = map.filled()?.leveled(Form::Tilt)?;
/// assert!(map.initial_gap(0.0, 0.0).abs() < 1e-18);
/// assert!((map.initial_gap(1e-6, 1e-6) - 1e-9).abs() < 1e-18);
/// assert_eq!(map.initial_gap(2e-6, 0.0), f64::INFINITY);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    cells: [usize; 2],
    spacing: [f64; 2],
    /// Row-major, x2 fastest; NaN where nothing was measured.
    heights: Vec<f64>,
    /// The greatest height known; −∞ if there is none.
    highest: f64,
    /// How many heights are missing.
    missing: usize,
    /// Whether there is nothing to touch where heights are missing; else they are undecided.
    masked: bool,
    center: [f64; 2],
    periodic: bool,
}

impl HeightMap {
    /// A map of `cells[0]` × `cells[1]` heights \[m\], each in the middle of its cell of a rectangle of `lengths`
    /// \[m\], row-major with x2 fastest; NaN where nothing was measured.
    ///
    /// # Errors
    /// If a count or a length is not one a [`Grid`] may have, there are not `cells[0] * cells[1]` heights,
    /// or one is infinite or beyond ±1e300 m.
    pub fn new(cells: [usize; 2], lengths: [f64; 2], heights: Vec<f64>) -> Result<HeightMap> {
        let grid = Grid::new(cells, lengths)?;
        exact_length("heights", heights.len(), grid.len())?;
        Ok(HeightMap::on(&grid, representable(heights)?))
    }

    /// A map on a grid, of heights known to be finite or missing and as many as cells.
    pub(in crate::geometry) fn on(grid: &Grid, heights: Vec<f64>) -> HeightMap {
        let map = HeightMap {
            cells: grid.cells(),
            spacing: grid.spacing(),
            heights: Vec::new(),
            highest: f64::NEG_INFINITY,
            missing: 0,
            masked: false,
            center: [0.0; 2],
            periodic: false,
        };
        map.with_heights(heights)
    }

    /// The map with other heights.
    fn with_heights(mut self, heights: Vec<f64>) -> HeightMap {
        self.highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        self.missing = heights.iter().filter(|h| h.is_nan()).count();
        self.heights = heights;
        self
    }

    /// Number of points along x1 and x2.
    pub fn cells(&self) -> [usize; 2] {
        self.cells
    }

    /// Distance of the points along x1 and x2 \[m\].
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Sides of the rectangle that the cells of the points fill \[m\]; the periods of a periodic map.
    pub fn lengths(&self) -> [f64; 2] {
        self.grid().lengths()
    }

    /// The heights \[m\], row-major with x2 fastest; NaN where one is missing.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// How many heights are missing, be they masked or undecided.
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// Middle of the map \[m\].
    pub fn center(&self) -> [f64; 2] {
        self.center
    }

    /// Whether the map repeats beyond its edges ([`HeightMap::periodic`]).
    pub fn is_periodic(&self) -> bool {
        self.periodic
    }

    /// The grid whose cells have the points in their middles, if the map is centred on the origin as every grid is.
    pub fn grid(&self) -> Grid {
        Grid::of_spacing(self.cells, self.spacing)
    }

    /// The known heights \[m\].
    pub(in crate::geometry) fn known(&self) -> impl Iterator<Item = f64> {
        self.heights.iter().copied().filter(|h| !h.is_nan())
    }

    /// Refuses a map without a single height.
    pub(in crate::geometry) fn some_known(&self) -> Result<()> {
        if self.missing < self.heights.len() { Ok(()) } else { Err(Error::Map(MapError::NothingKnown)) }
    }

    /// Where the first cell of `grid` lies among the points of the map moved by `by`: an index with its fraction.
    fn offset(&self, grid: &Grid, by: [f64; 2], axis: usize) -> f64 {
        self.index(axis, grid.coordinate(axis, 0) - by[axis])
    }

    /// The gap of the moved map by its waves: the heights moved by the fraction of a cell, and copied from there on.
    fn fill_by_waves(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
        let offset = [0, 1].map(|axis| self.offset(grid, by, axis));
        let whole = offset.map(f64::round);
        let fraction = [0, 1].map(|axis| offset[axis] - whole[axis]);
        let moved = (fraction.iter().any(|f| f.abs() > ROUNDING)).then(|| {
            let mut spectrum = Spectrum::of(self.cells, &self.heights);
            spectrum.shift(fraction);
            spectrum.heights()
        });
        let heights = moved.as_ref().unwrap_or(&self.heights);
        // The remainder first: whole numbers far away leave the range of isize.
        let first = [0, 1].map(|axis| whole[axis].rem_euclid(self.cells[axis] as f64) as usize);
        let ([n1, n2], [_, columns]) = (self.cells, grid.cells());
        for (i, row) in gap.chunks_exact_mut(columns).enumerate() {
            let from = (first[0] + i) % n1 * n2;
            for (j, value) in row.iter_mut().enumerate() {
                *value = self.highest - heights[from + (first[1] + j) % n2];
            }
        }
    }

    /// Whether the points of the map fall on cells of `grid`, or all beside them by the same fraction.
    fn keeps_step_with(&self, grid: &Grid) -> bool {
        let same = |axis: usize| {
            self.cells[axis] == 1 || (grid.spacing()[axis] / self.spacing[axis] - 1.0).abs() <= SAME_SPACING
        };
        same(0) && same(1)
    }
}

/// Refuses heights whose differences and sums are no numbers.
fn representable(heights: Vec<f64>) -> Result<Vec<f64>> {
    match heights.iter().position(|height| height.abs() > LONGEST) {
        Some(entry) => Err(Error::Map(MapError::NotFinite { entry, value: heights[entry] })),
        None => Ok(heights),
    }
}

impl Geometry for HeightMap {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        match self.height_at(x1, x2) {
            Some(height) => self.highest - height,
            None if self.masked || !self.covers(x1, x2) => f64::INFINITY,
            None => f64::NAN,
        }
    }

    fn fill_gap(&self, grid: &Grid, gap: &mut [f64]) {
        self.fill_gap_at(grid, [0.0; 2], gap);
    }

    fn fill_gap_at(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
        if self.periodic && self.missing == 0 && self.keeps_step_with(grid) && by.iter().all(|b| b.is_finite()) {
            assert_eq!(gap.len(), grid.len(), "gap must hold one value a cell");
            self.fill_by_waves(grid, by, gap);
        } else {
            super::fill_by_points(self, grid, by, gap);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum of waves that a map of `cells` on the unit square resolves.
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
        let Error::Map(MapError::NotFinite { entry, .. }) = refused(vec![0.0, 0.0, f64::INFINITY, 0.0]) else {
            panic!()
        };
        assert_eq!(entry, 2);
        // a difference of two such would be no number, nor would a sum
        assert!(matches!(refused(vec![1e305, 0.0, -1e308, 0.0]), Error::Map(MapError::NotFinite { entry: 0, .. })));
        assert!(HeightMap::new([0, 2], [1.0, 1.0], vec![]).is_err());
    }

    #[test]
    fn the_highest_point_touches_first() {
        let map = map_of([4, 3], |x1, x2| 3.0 * x1 - x2);
        let mut gap = vec![0.0; 12];
        map.fill_gap(&map.grid(), &mut gap);
        assert_eq!(gap.iter().copied().fold(f64::INFINITY, f64::min), 0.0);
        assert_eq!(gap[9], 0.0);
        assert!((gap[2] - (9.0 / 4.0 + 2.0 / 3.0)).abs() < 1e-14);
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
    fn band_limited_maps_move_exactly() {
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
    fn whole_cells_are_copied_bit_by_bit() {
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
    fn a_wave_at_the_limit_stays_real() {
        // The shortest wave of an even number of points: what a shift leaves of it at the points is its cosine.
        let map = map_of([6, 4], |x1, _| if ((x1 + 0.5) * 6.0) as i64 % 2 == 0 { 1.0 } else { -1.0 }).periodic();
        let mut gap = vec![0.0; 24];
        map.fill_gap_at(&map.grid(), [0.25 / 6.0, 0.0], &mut gap);
        let left = (0.25 * std::f64::consts::PI).cos();
        assert!((gap[0] - (1.0 - left)).abs() < 1e-14);
        assert!((gap[4] - (1.0 + left)).abs() < 1e-14);
    }
}
