//! Interpolation of a map onto another grid.

use super::HeightMap;
use crate::error::Result;
use crate::{Grid, memory};

impl HeightMap {
    /// The map interpolated at the cells of `grid` by [`HeightMap::height_at`]. A coarser grid loses the waves that it
    /// does not resolve.
    ///
    /// Points outside the map are masked. On a grid of the same lengths a periodic map stays periodic.
    ///
    /// ```
    /// use viscocontact::{Grid, geometry::HeightMap};
    ///
    /// let ridges = (0..64).map(|i| (i as f64 * std::f64::consts::TAU / 16.0).sin()).collect();
    /// let map = HeightMap::new([64, 1], [1.0, 1.0], ridges)?.periodic();
    /// let fine = map.resampled(&Grid::new([128, 1], [1.0, 1.0])?)?;
    /// let [here, there] = [&map, &fine].map(|map| map.height_at(0.1, 0.0).unwrap());
    /// assert!(fine.is_periodic() && (here - there).abs() < 0.01);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If map and grid have no known points in common, or there is no memory for the heights on the grid.
    pub fn resampled(&self, grid: &Grid) -> Result<HeightMap> {
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
        Ok(map)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::super::nothing_known;
    use super::super::tests::{map_of, waves};
    use super::*;
    use crate::geometry::Geometry;

    #[test]
    fn resampling_on_the_same_grid_changes_nothing() {
        let map = map_of([12, 10], waves).periodic();
        let again = map.resampled(&map.grid()).unwrap();
        assert_eq!(again, HeightMap { masked: true, ..map });
    }

    #[test]
    fn the_map_on_finer_grids_is_nearer() {
        let map = map_of([64, 8], waves).periodic();
        let rms_height = map.statistics().unwrap().rms_height;
        let errors = [64, 32, 16, 8].map(|n| {
            let coarse = map.resampled(&Grid::new([n, 8], [1.0, 1.0]).unwrap()).unwrap();
            assert!(coarse.is_periodic());
            let squares = (map.heights.iter().enumerate()).map(|(k, z)| {
                let [x1, x2] = map.grid().center(k / 8, k % 8);
                (coarse.height_at(x1, x2).unwrap() - z).powi(2)
            });
            (squares.sum::<f64>() / 512.0).sqrt() / rms_height
        });
        assert!(errors.is_sorted() && errors[1] < 0.01 && errors[3] > 0.03, "{errors:?}");
    }

    #[test]
    fn outside_the_map_there_is_nothing_to_touch() {
        let map = map_of([8, 8], waves).centered_at([0.5, 0.0]).unwrap();
        let wide = map.resampled(&Grid::new([16, 8], [2.0, 1.0]).unwrap()).unwrap();
        assert_eq!(wide.missing(), 64);
        assert_eq!(wide.initial_gap(-0.5, 0.0), f64::INFINITY);
        assert_abs_diff_eq!(wide.height_at(0.3, 0.2).unwrap(), map.height_at(0.3, 0.2).unwrap(), epsilon = 1e-12);
        let beside = map.centered_at([5.0, 0.0]).unwrap();
        let refused = beside.resampled(&Grid::square(4, 1.0).unwrap()).unwrap_err();
        assert_eq!(refused, nothing_known());
    }
}
