//! Interpolation of heights between the points of a map.

use super::{HeightMap, ROUNDING};

/// The points along one axis that an interpolated value depends on, with their weights.
struct Stencil {
    index: [usize; 4],
    weights: [f64; 4],
}

/// Weights of the four points around a position that lies `t` after the second (Keys 1981, a = −1/2).
fn cubic(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [0.5 * (2.0 * t2 - t3 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), 0.5 * (4.0 * t2 - 3.0 * t3 + t), 0.5 * (t3 - t2)]
}

/// Splits an index into the preceding point and the fraction after it, without the rounding errors of coordinates.
fn split(index: f64) -> (f64, f64) {
    let nearest = index.round();
    let at = if (index - nearest).abs() <= ROUNDING { nearest } else { index };
    (at.floor(), at - at.floor())
}

impl Stencil {
    /// The stencil around the fractional `index` among `n` points.
    fn new(index: f64, n: usize, periodic: bool) -> Stencil {
        let (before, t) = split(index);
        let weights = cubic(t);
        if periodic {
            let first = before.rem_euclid(n as f64) as usize + n - 1;
            return Stencil { index: [0, 1, 2, 3].map(|k| (first + k) % n), weights };
        }
        // Linear extrapolation: a point d beyond the end is (1 + d) times the last minus d times the last but one.
        let (before, last) = (before as isize, n as isize - 1);
        let window = (before - 1).clamp(0, (last - 3).max(0));
        let index = [0, 1, 2, 3].map(|k| (window + k).min(last) as usize);
        let mut stencil = Stencil { index, weights: [0.0; 4] };
        for (k, weight) in weights.into_iter().enumerate() {
            let node = before - 1 + k as isize;
            let end = node.clamp(0, last);
            let next = if node < 0 { 1.min(last) } else { (last - 1).max(0) };
            let beyond = (node - end).unsigned_abs() as f64;
            for (to, part) in [(end, 1.0 + beyond), (next, -beyond)] {
                if part != 0.0 {
                    stencil.weights[(to - window) as usize] += part * weight;
                }
            }
        }
        stencil
    }
}

impl HeightMap {
    /// The coordinate `x` as a fractional index among the points along `axis`.
    pub(super) fn index(&self, axis: usize, x: f64) -> f64 {
        let (distance, spacing, middle) =
            (x - self.center[axis], self.spacing[axis], 0.5 * (self.cells[axis] as f64 - 1.0));
        let index = distance / spacing + middle;
        if index.is_finite() || !self.periodic {
            return index;
        }
        // the number of periods overflows, and the phase is lost: any value in the period serves
        distance.clamp(f64::MIN, f64::MAX) % self.lengths()[axis] / spacing + middle
    }

    /// Position of a point in the map, as fractional indices; `None` outside the map.
    pub(super) fn indices(&self, x1: f64, x2: f64) -> Option<[f64; 2]> {
        let indices = [self.index(0, x1), self.index(1, x2)];
        let inside = |axis: usize| {
            let (index, end) = (indices[axis], self.cells[axis] as f64 - 0.5 + ROUNDING);
            if self.periodic { index.is_finite() } else { index >= -0.5 - ROUNDING && index <= end }
        };
        (inside(0) && inside(1)).then_some(indices)
    }

    /// Height at the point (x1, x2) \[m\]; `None` outside the map and where it is missing.
    ///
    /// Interpolated bicubically, exact at the points of the map. Next to masked points the height is interpolated
    /// linearly between the known points; it is missing if the nearest point is missing. Next to undecided points it
    /// is missing.
    pub fn height_at(&self, x1: f64, x2: f64) -> Option<f64> {
        let at = self.indices(x1, x2)?;
        let height = self.weighted(&self.stencils(at));
        if height.is_nan() && self.masked { self.linear_of_known(at) } else { Some(height).filter(|z| !z.is_nan()) }
    }

    fn stencils(&self, at: [f64; 2]) -> [Stencil; 2] {
        [0, 1].map(|axis| Stencil::new(at[axis], self.cells[axis], self.periodic))
    }

    /// Sum of sixteen heights with their weights; NaN if a height with a nonzero weight is missing.
    fn weighted(&self, [rows, columns]: &[Stencil; 2]) -> f64 {
        let mut sum = 0.0;
        for (i, a) in rows.index.iter().zip(&rows.weights).filter(|(_, a)| **a != 0.0) {
            for (j, b) in columns.index.iter().zip(&columns.weights).filter(|(_, b)| **b != 0.0) {
                sum += a * b * self.heights[i * self.cells[1] + j];
            }
        }
        sum
    }

    /// Linear interpolation between the known heights among the four neighbours; `None` if the nearest is missing.
    fn linear_of_known(&self, at: [f64; 2]) -> Option<f64> {
        let [(b1, t1), (b2, t2)] = at.map(split);
        let (mut sum, mut weights) = (0.0, 0.0);
        for (d1, w1) in [(0.0, 1.0 - t1), (1.0, t1)] {
            for (d2, w2) in [(0.0, 1.0 - t2), (1.0, t2)] {
                let height = self.point(b1 + d1, b2 + d2).filter(|z| !z.is_nan());
                if d1 == t1.round() && d2 == t2.round() {
                    height?;
                }
                if let Some(height) = height {
                    sum += w1 * w2 * height;
                    weights += w1 * w2;
                }
            }
        }
        Some(sum / weights).filter(|z| z.is_finite())
    }

    /// The height at whole-numbered indices, if the map has it.
    fn point(&self, i: f64, j: f64) -> Option<f64> {
        let whole = |at: f64, n: usize| {
            let n = n as f64;
            if self.periodic { Some(at.rem_euclid(n) as usize) } else { (at >= 0.0 && at < n).then_some(at as usize) }
        };
        Some(self.heights[whole(i, self.cells[0])? * self.cells[1] + whole(j, self.cells[1])?])
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::super::tests::{map_of, waves};
    use crate::geometry::{Geometry, HeightMap};

    #[test]
    fn points_and_planes_are_exact() {
        let map = map_of([7, 5], waves);
        for k in 0..35 {
            let [x1, x2] = map.grid().center(k / 5, k % 5);
            assert_eq!(map.height_at(x1, x2), Some(map.heights[k]));
        }
        let plane = map_of([7, 5], |x1, x2| 2.0 * x1 - 3.0 * x2 + 0.25);
        for (x1, x2) in [(-0.5, 0.5), (0.499, -0.123), (0.01, 0.02), (-0.47, 0.3), (0.5, 0.5)] {
            let height = plane.height_at(x1, x2).unwrap();
            assert!((height - (2.0 * x1 - 3.0 * x2 + 0.25)).abs() < 1e-14, "({x1}, {x2}): {height}");
        }
        assert_eq!(plane.height_at(0.501, 0.0), None);
        assert_eq!(plane.initial_gap(0.0, -0.501), f64::INFINITY);
    }

    #[test]
    fn parabolas_are_exact_inside() {
        let map = map_of([9, 8], |x1, x2| x1 * x1 - 0.5 * x2 * x2 + x1 * x2);
        let (x1, x2) = (0.13, -0.21);
        assert_abs_diff_eq!(map.height_at(x1, x2).unwrap(), x1 * x1 - 0.5 * x2 * x2 + x1 * x2, epsilon = 1e-15);
    }

    #[test]
    fn smooth_maps_converge_with_third_order() {
        let error = |n: usize| {
            let map = map_of([n, n], waves).periodic();
            let points = (0..200).map(|k| (0.0137 * k as f64, 0.0271 * k as f64));
            points.map(|(x1, x2)| (map.height_at(x1, x2).unwrap() - waves(x1, x2)).abs()).fold(0.0, f64::max)
        };
        let order = (error(64) / error(128)).log2();
        assert!(order > 2.7, "{order}");
    }

    #[test]
    fn masked_points_are_excluded() {
        let plane = |x1: f64, x2: f64| if x1.hypot(x2) < 0.05 { f64::NAN } else { x1 + x2 };
        let map = map_of([5, 5], plane);
        assert!(map.initial_gap(0.0, 0.0).is_nan() && map.initial_gap(0.15, 0.0).is_nan());
        let map = map.masked();
        assert_eq!(map.initial_gap(0.09, 0.0), f64::INFINITY);
        // Between (0.2, 0), known, and the middle, unknown: the known point counts.
        assert_abs_diff_eq!(map.initial_gap(0.15, 0.0), 0.8 - 0.2, epsilon = 1e-14);
        assert_abs_diff_eq!(map.height_at(0.2, 0.1).unwrap(), 0.3, epsilon = 1e-14);
    }

    #[test]
    fn periodic_maps_are_finite_at_any_distance() {
        let map = HeightMap::new([3, 2], [3e-150, 2e-150], vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap().periodic();
        let far = map.clone().centered_at([-f64::MAX, 1e150]).unwrap();
        for (x1, x2) in [(1e200, 0.0), (f64::MAX, -1e300), (-1e120, 1e130)] {
            for map in [&map, &far] {
                let gap = map.initial_gap(x1, x2);
                assert!((-3.0..=8.0).contains(&gap), "{gap} at {x1:e}, {x2:e}");
            }
        }
        let mut gap = [f64::NAN; 4];
        let grid = crate::Grid::square(2, 1.0).unwrap();
        for map in [map, HeightMap::new([1, 1], [1.0, 1e-200], vec![2.0]).unwrap().periodic()] {
            map.fill_gap_at(&grid, [0.0, 1e200], &mut gap);
            assert!(gap.iter().all(|gap| gap.is_finite()), "{gap:?}");
        }
    }

    #[test]
    fn maps_of_one_to_three_points_are_interpolated() {
        let constant = HeightMap::new([1, 1], [1.0, 1.0], vec![2.0]).unwrap();
        assert_abs_diff_eq!(constant.height_at(0.3, -0.4).unwrap(), 2.0, epsilon = 1e-15);
        assert_abs_diff_eq!(constant.clone().periodic().height_at(7.3, -9.4).unwrap(), 2.0, epsilon = 1e-14);
        for n in [2, 3] {
            let line = map_of([n, 1], |x1, _| 3.0 * x1);
            assert_abs_diff_eq!(line.height_at(0.45, 0.2).unwrap(), 1.35, epsilon = 1e-15);
            let ring = map_of([n, 1], |x1, _| 3.0 * x1).periodic();
            let [x1, _] = ring.grid().center(0, 0);
            assert_eq!(ring.height_at(x1 + 1.0, 0.0), Some(ring.heights[0]));
        }
    }
}
