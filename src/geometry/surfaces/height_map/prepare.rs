//! Preparation of maps: masked, cropped, mirrored, scaled and placed.

use super::HeightMap;
use crate::error::{Result, count_within, finite};
use crate::memory;

impl HeightMap {
    /// The map with nothing to touch where heights are missing.
    #[must_use]
    pub fn masked(self) -> HeightMap {
        HeightMap { masked: true, ..self }
    }

    /// The part of `cells` points that begins at the point `first`. It has the centre of the whole map and is not
    /// periodic.
    ///
    /// # Errors
    /// If the part is empty or exceeds the map, or there is no memory for it.
    pub fn cropped(self, first: [usize; 2], cells: [usize; 2]) -> Result<HeightMap> {
        let fields = [("first point along x1", "points along x1"), ("first point along x2", "points along x2")];
        for (axis, (of_first, of_cells)) in fields.into_iter().enumerate() {
            let inside = first[axis] < self.cells[axis];
            count_within(of_first, first[axis], inside, "below the number of points of the map")?;
            let inside = (1..=self.cells[axis] - first[axis]).contains(&cells[axis]);
            let allowed = "at least 1, and at most the number of points of the map from the first on";
            count_within(of_cells, cells[axis], inside, allowed)?;
        }
        let n2 = self.cells[1];
        let rows = (first[0]..first[0] + cells[0]).map(|i| i * n2 + first[1]);
        let heights = rows.flat_map(|from| self.heights[from..from + cells[1]].iter().copied());
        let heights = memory::collect("a part of a map", cells[0] * cells[1], heights)?;
        Ok(HeightMap { cells, periodic: false, heights, ..self }.summarized())
    }

    /// The mirror image: the order of the points is reversed along the chosen axes. Flip a surface that was measured
    /// from above along one axis to place it face down on another body.
    #[must_use]
    pub fn flipped(mut self, along: [bool; 2]) -> HeightMap {
        if along[0] != along[1] {
            self.heights.chunks_exact_mut(self.cells[1]).for_each(<[f64]>::reverse);
        }
        // Reversing all points flips both axes; after a flip along x2 it leaves a flip along x1.
        if along[0] {
            self.heights.reverse();
        }
        self
    }

    /// The map with x1 and x2 exchanged.
    #[must_use]
    pub fn transposed(mut self) -> HeightMap {
        let [n1, n2] = self.cells;
        self.heights = (0..n1 * n2).map(|k| self.heights[k % n1 * n2 + k / n1]).collect();
        self.cells.swap(0, 1);
        self.spacing.swap(0, 1);
        self.center.swap(0, 1);
        self
    }

    /// The map with peaks and valleys exchanged, as on a replica: z becomes −z.
    #[must_use]
    pub fn inverted(mut self) -> HeightMap {
        self.heights.iter_mut().for_each(|z| *z = -*z);
        self.summarized()
    }

    /// The map with all heights multiplied by `factor`.
    ///
    /// # Errors
    /// If the factor is not finite, or a height exceeds ±1e300 m.
    pub fn scaled(mut self, factor: f64) -> Result<HeightMap> {
        finite("factor of the heights", factor)?;
        self.heights.iter_mut().for_each(|z| *z *= factor);
        super::check_heights(&self.heights)?;
        Ok(self.summarized())
    }

    /// The map with its middle at the point `center` \[m\].
    ///
    /// # Errors
    /// If a coordinate is not finite.
    pub fn centered_at(self, center: [f64; 2]) -> Result<HeightMap> {
        let center =
            [finite("middle of the map along x1", center[0])?, finite("middle of the map along x2", center[1])?];
        Ok(HeightMap { center, ..self })
    }

    /// The map repeated periodically along both axes, with its lengths as periods.
    #[must_use]
    pub fn periodic(self) -> HeightMap {
        HeightMap { periodic: true, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    fn map() -> HeightMap {
        HeightMap::new([2, 3], [2.0, 6.0], vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap()
    }

    #[test]
    fn maps_are_cropped_and_flipped() {
        let part = map().periodic().cropped([0, 1], [2, 2]).unwrap();
        assert_eq!((part.heights(), part.lengths()), (&[2.0, 3.0, 5.0, 6.0][..], [2.0, 4.0]));
        assert!(!part.is_periodic());
        assert_eq!(map().flipped([true, false]).heights(), [4.0, 5.0, 6.0, 1.0, 2.0, 3.0]);
        assert_eq!(map().flipped([false, true]).heights(), [3.0, 2.0, 1.0, 6.0, 5.0, 4.0]);
        assert_eq!(map().flipped([true, true]).heights(), [6.0, 5.0, 4.0, 3.0, 2.0, 1.0]);
        assert_eq!(map().flipped([false, false]), map());
        let transposed = map().centered_at([1.0, 2.0]).unwrap().transposed();
        assert_eq!(transposed.heights(), [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
        assert_eq!((transposed.cells(), transposed.spacing(), transposed.center()), ([3, 2], [2.0, 1.0], [2.0, 1.0]));
        assert_eq!(transposed.height_at(2.0, 1.5), Some(5.0));
    }

    #[test]
    fn the_highest_point_follows_the_heights() {
        use crate::geometry::Geometry;
        let inverted = map().inverted();
        assert_eq!((inverted.heights()[0], inverted.initial_gap(-0.5, -2.0)), (-1.0, 0.0));
        let doubled = map().scaled(2.0).unwrap();
        assert_eq!((doubled.heights()[5], doubled.initial_gap(-0.5, -2.0)), (12.0, 10.0));
        assert_eq!(map().cropped([0, 0], [1, 3]).unwrap().initial_gap(0.0, 2.0), 0.0);
    }

    #[test]
    fn bad_arguments_are_refused_by_name() {
        let field = |result: Result<HeightMap>| match result.unwrap_err() {
            Error::OutOfRange { field, .. } | Error::CountOutOfRange { field, .. } => field,
            other => panic!("unexpected {other}"),
        };
        assert_eq!(field(map().cropped([2, 0], [1, 1])), "first point along x1");
        assert_eq!(field(map().cropped([0, 1], [1, 3])), "points along x2");
        assert_eq!(field(map().cropped([0, 1], [0, 1])), "points along x1");
        assert_eq!(field(map().scaled(f64::NAN)), "factor of the heights");
        assert_eq!(field(map().centered_at([0.0, f64::INFINITY])), "middle of the map along x2");
        assert!(map().scaled(3e299).is_err_and(|error| error.to_string().starts_with("height 3 of the map is ")));
    }
}
