//! Interpolation of a map onto another grid.

use super::HeightMap;
use super::nothing_known;
use crate::error::Result;
use crate::geometry::surfaces::statistics::FLAT;
use crate::{Grid, memory};

/// A map interpolated onto another grid, and the error of the interpolation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ResampledMap {
    /// The map on the new grid.
    pub map: HeightMap,
    /// Difference from the old map.
    pub error: ResamplingError,
}

/// Error of resampling: the new map, interpolated back to the points of the old map, minus the old map. It contains the
/// waves that the new grid does not resolve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ResamplingError {
    /// Root mean square \[m\].
    pub rms: f64,
    /// Maximum magnitude \[m\].
    pub max: f64,
    /// `rms` relative to the rms height of the old map about its mean, at the points compared; 0 for a flat map.
    pub of_rms_height: f64,
}

impl HeightMap {
    /// The map interpolated at the cells of `grid` by [`HeightMap::height_at`], with the error that a coarser grid
    /// makes.
    ///
    /// Points outside the map are masked. On a grid of the same lengths a periodic map stays periodic.
    ///
    /// ```
    /// use viscocontact::{Grid, geometry::HeightMap};
    ///
    /// let ridges = (0..64).map(|i| (i as f64 * std::f64::consts::TAU / 16.0).sin()).collect();
    /// let map = HeightMap::new([64, 1], [1.0, 1.0], ridges)?.periodic();
    /// let fine = map.resampled(&Grid::new([128, 1], [1.0, 1.0])?)?;
    /// let coarse = map.resampled(&Grid::new([12, 1], [1.0, 1.0])?)?;
    /// assert!(fine.error.of_rms_height < 0.01 && coarse.error.of_rms_height > 0.1);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If map and grid have no known points in common, or there is no memory for the heights on the grid.
    pub fn resampled(&self, grid: &Grid) -> Result<ResampledMap> {
        let [_, n2] = grid.cells();
        let heights = (0..grid.len()).map(|k| {
            let [x1, x2] = grid.center(k / n2, k % n2);
            self.height_at(x1, x2).unwrap_or(f64::NAN)
        });
        let mut map = HeightMap::on(grid, memory::collect("a map on another grid", grid.len(), heights)?);
        map.require_known()?;
        map.center =
            [0, 1].map(|axis| 0.5 * (grid.coordinate(axis, 0) + grid.coordinate(axis, grid.cells()[axis] - 1)));
        // If the old map has no missing points, missing points of the new map lie outside the old map.
        map.masked = self.masked || self.missing == 0;
        let (old, new) = (self.lengths(), map.lengths());
        map.periodic = self.periodic && (0..2).all(|axis| (new[axis] / old[axis] - 1.0).abs() < 1e-9);
        let error = self.error_of(&map)?;
        Ok(ResampledMap { map, error })
    }

    /// The difference of `other` from this map at the points of this map.
    fn error_of(&self, other: &HeightMap) -> Result<ResamplingError> {
        let grid = self.grid();
        let pairs = || {
            (self.heights.iter().enumerate()).filter(|(_, z)| !z.is_nan()).filter_map(|(k, &z)| {
                let [x1, x2] = grid.center(k / self.cells[1], k % self.cells[1]);
                other.height_at(x1 + self.center[0], x2 + self.center[1]).map(|back| (z, back))
            })
        };
        let count = pairs().count() as f64;
        if count == 0.0 {
            return Err(nothing_known());
        }
        let mean = pairs().map(|(z, _)| z / count).sum::<f64>();
        // in units of a power of two near the greatest height, squares stay in range without rounding
        let highest = pairs().fold(f64::MIN_POSITIVE, |highest, (z, back)| highest.max(z.abs()).max(back.abs()));
        let unit = 2_f64.powi(highest.log2().clamp(-1000.0, 1000.0) as i32);
        let rms_of = |sum: f64| (sum / count).sqrt() * unit;
        let rms_height = rms_of(pairs().map(|(z, _)| (z / unit - mean / unit).powi(2)).sum());
        let rms = rms_of(pairs().map(|(z, back)| (back / unit - z / unit).powi(2)).sum());
        let greatest = pairs().fold(0.0, |greatest: f64, (z, back)| greatest.max((back - z).abs()));
        let of_rms_height = if rms_height > FLAT * mean.abs() { rms / rms_height } else { 0.0 };
        Ok(ResamplingError { rms, max: greatest, of_rms_height })
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::super::tests::{map_of, waves};
    use super::*;
    use crate::geometry::Geometry;

    #[test]
    fn resampling_on_the_same_grid_changes_nothing() {
        let map = map_of([12, 10], waves).periodic();
        let again = map.resampled(&map.grid()).unwrap();
        assert_eq!(again.map, HeightMap { masked: true, ..map });
        assert_eq!(again.error, ResamplingError { rms: 0.0, max: 0.0, of_rms_height: 0.0 });
    }

    #[test]
    fn the_error_is_the_difference_after_interpolating_back() {
        let map = map_of([64, 8], waves).periodic();
        let errors = [64, 32, 16, 8].map(|n| {
            let coarse = map.resampled(&Grid::new([n, 8], [1.0, 1.0]).unwrap()).unwrap();
            assert!(coarse.map.is_periodic());
            let by_hand = (map.heights.iter().enumerate()).map(|(k, z)| {
                let [x1, x2] = map.grid().center(k / 8, k % 8);
                (coarse.map.height_at(x1, x2).unwrap() - z).powi(2)
            });
            let by_hand = (by_hand.sum::<f64>() / 512.0).sqrt();
            assert!((coarse.error.rms - by_hand).abs() < 1e-15 && coarse.error.max >= by_hand);
            coarse.error.of_rms_height
        });
        assert!(errors.is_sorted() && errors[1] < 0.01 && errors[3] > 0.03, "{errors:?}");
    }

    /// The squares of these heights overflow or underflow, the error does not.
    #[test]
    fn errors_of_extreme_heights_are_finite() {
        let map = map_of([32, 8], waves);
        let coarse = |map: &HeightMap| map.resampled(&Grid::new([8, 8], [1.0, 1.0]).unwrap()).unwrap().error;
        let usual = coarse(&map);
        for scale in [1e200, 1e299, 1e-200, 1e-290] {
            let error = coarse(&map.clone().scaled(scale).unwrap());
            for (found, expected) in [(error.rms / scale, usual.rms), (error.of_rms_height, usual.of_rms_height)] {
                assert!((found / expected - 1.0).abs() < 1e-9, "{scale:e}: {found:e} {expected:e}");
            }
        }
    }

    #[test]
    fn outside_the_map_there_is_nothing_to_touch() {
        let map = map_of([8, 8], waves).centered_at([0.5, 0.0]).unwrap();
        let wide = map.resampled(&Grid::new([16, 8], [2.0, 1.0]).unwrap()).unwrap().map;
        assert_eq!(wide.missing(), 64);
        assert_eq!(wide.initial_gap(-0.5, 0.0), f64::INFINITY);
        assert_abs_diff_eq!(wide.height_at(0.3, 0.2).unwrap(), map.height_at(0.3, 0.2).unwrap(), epsilon = 1e-12);
        let beside = map.centered_at([5.0, 0.0]).unwrap();
        let refused = beside.resampled(&Grid::square(4, 1.0).unwrap()).unwrap_err();
        assert_eq!(refused, nothing_known());
    }
}
