//! Where a load may act: inside the convex hull of the cells that a body may touch.

use crate::Grid;

/// Distances below this fraction of the grid's length count as none.
const TOUCHING: f64 = 1e-9;

/// The convex hull of some cell centres.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hull {
    /// Corners in counter-clockwise order; one or two where all cells lie on a point or a line.
    corners: Vec<[f64; 2]>,
    tolerance: f64,
}

impl Hull {
    /// The hull of the cells for which `inside` holds, by Andrew's monotone chain over the ends of each row.
    pub(crate) fn new(grid: &Grid, inside: impl Fn(usize) -> bool) -> Hull {
        let n2 = grid.cells()[1];
        Hull::of_rows(grid, |i| {
            let row = || (0..n2).filter(|j| inside(i * n2 + j));
            row().next().zip(row().next_back()).map(|(first, last)| [first, last])
        })
    }

    /// The hull of rows of cells with these ends.
    pub(crate) fn of_rows(grid: &Grid, ends: impl Fn(usize) -> Option<[usize; 2]>) -> Hull {
        let n1 = grid.cells()[0];
        let mut points = Vec::with_capacity(2 * n1);
        for i in 0..n1 {
            if let Some([first, last]) = ends(i) {
                points.push(grid.center(i, first));
                if last != first {
                    points.push(grid.center(i, last));
                }
            }
        }
        let [l1, l2] = grid.lengths();
        let tolerance = TOUCHING * l1.max(l2);
        let area = tolerance * l1.min(l2);
        let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            let mut chain: Vec<[f64; 2]> = Vec::new();
            for point in points {
                while chain.len() >= 2 && cross(chain[chain.len() - 2], chain[chain.len() - 1], point) <= area * 1e-3 {
                    chain.pop();
                }
                chain.push(point);
            }
            chain.pop();
            chain
        };
        if points.len() < 2 {
            return Hull { corners: points, tolerance };
        }
        let mut corners = half(&mut points.iter().copied());
        corners.extend(half(&mut points.iter().rev().copied()));
        Hull { corners, tolerance }
    }

    /// Whether pressures on more than its boundary can balance a force at `point`. An axis along which the
    /// body cannot tilt does not count.
    pub(crate) fn admits(&self, point: [f64; 2], tilts: [bool; 2]) -> bool {
        match tilts {
            [false, false] => true,
            [true, false] => self.spans(0, point[0]),
            [false, true] => self.spans(1, point[1]),
            [true, true] => self.contains(point),
        }
    }

    /// Whether `x` lies between the least and the greatest coordinate along `axis`.
    fn spans(&self, axis: usize, x: f64) -> bool {
        let low = self.corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
        let high = self.corners.iter().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
        between(low, high, x, self.tolerance)
    }

    fn contains(&self, point: [f64; 2]) -> bool {
        match self.corners[..] {
            [] => false,
            [only] => (point[0] - only[0]).hypot(point[1] - only[1]) <= self.tolerance,
            [from, to] => {
                let length = (to[0] - from[0]).hypot(to[1] - from[1]);
                let along =
                    ((point[0] - from[0]) * (to[0] - from[0]) + (point[1] - from[1]) * (to[1] - from[1])) / length;
                cross(from, to, point).abs() <= self.tolerance * length && between(0.0, length, along, self.tolerance)
            }
            ref corners => {
                let edges = corners.iter().zip(corners.iter().cycle().skip(1));
                edges.map(|(&from, &to)| (from, to)).all(|(from, to)| {
                    cross(from, to, point) > self.tolerance * (to[0] - from[0]).hypot(to[1] - from[1])
                })
            }
        }
    }
}

/// Strictly inside an interval, or on it where it is a point.
fn between(low: f64, high: f64, x: f64, tolerance: f64) -> bool {
    if high - low <= tolerance { (x - low).abs() <= tolerance } else { x > low + tolerance && x < high - tolerance }
}

/// Twice the area of the triangle a, b, c: positive if c lies left of the way from a to b.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hull(cells: [usize; 2], inside: impl Fn(f64, f64) -> bool) -> Hull {
        let grid = Grid::new(cells, cells.map(|n| n as f64)).unwrap();
        Hull::new(&grid, |k| {
            let [x, y] = grid.center(k / cells[1], k % cells[1]);
            inside(x, y)
        })
    }

    #[test]
    fn a_full_grid_is_a_rectangle() {
        let hull = hull([4, 6], |_, _| true);
        assert_eq!(hull.corners.len(), 4);
        assert!(hull.contains([1.4, -2.4]) && !hull.contains([1.5, 0.0]) && !hull.contains([1.6, 0.0]));
        assert!(hull.admits([1.4, 99.0], [true, false]) && !hull.admits([1.6, 0.0], [true, false]));
        assert!(hull.admits([99.0, 99.0], [false, false]));
    }

    #[test]
    fn two_feet_hold_what_lies_between() {
        let hull = hull([9, 9], |x, _| x.abs() > 3.0);
        assert!(hull.contains([0.0, 0.0]) && hull.contains([2.0, 3.0]) && !hull.contains([4.1, 0.0]));
    }

    #[test]
    fn a_disc_has_no_corners_outside() {
        let hull = hull([41, 41], |x, y| x.hypot(y) < 18.0);
        for angle in (0..60).map(|k| k as f64 / 60.0 * std::f64::consts::TAU) {
            assert!(hull.contains([16.5 * angle.cos(), 16.5 * angle.sin()]));
            assert!(!hull.contains([18.0 * angle.cos(), 18.0 * angle.sin()]));
        }
    }

    #[test]
    fn rows_diagonals_and_points() {
        let row = hull([1, 5], |_, _| true);
        assert!(row.contains([0.0, 1.9]) && !row.contains([0.0, 2.1]) && !row.contains([0.1, 0.0]));
        let diagonal = hull([5, 5], |x, y| x == y);
        assert!(diagonal.contains([0.5, 0.5]) && !diagonal.contains([0.5, 0.4]) && !diagonal.contains([2.5, 2.5]));
        let point = hull([5, 5], |x, y| x == 1.0 && y == 0.0);
        assert!(point.contains([1.0, 0.0]) && !point.contains([1.1, 0.0]));
    }
}
