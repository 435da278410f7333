//! Where a load may act: in the convex hull of the cells that a body may touch.

use crate::Grid;

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
        // a load so near to the boundary is on it: the shares of the force that inner cells would carry are rounding
        let tolerance = 1e-11 * l1.max(l2);
        // corners so near to a line are on it
        let area = 1e-12 * l1.max(l2) * l1.min(l2);
        let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            let mut chain: Vec<[f64; 2]> = Vec::new();
            for point in points {
                while chain.len() >= 2 && cross(chain[chain.len() - 2], chain[chain.len() - 1], point) <= area {
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

    /// The point at which pressures balance a force at `point`: `point` itself, or the nearest point of the boundary
    /// if their distance is rounding; the body then rests on an edge or a corner. `None` for a force outside the
    /// hull. An axis along which the body cannot tilt does not count.
    pub(crate) fn balanced_at(&self, point: [f64; 2], tilts: [bool; 2]) -> Option<[f64; 2]> {
        match tilts {
            [false, false] => Some(point),
            [true, false] => Some([self.within_span(0, point[0])?, point[1]]),
            [false, true] => Some([point[0], self.within_span(1, point[1])?]),
            [true, true] => self.within(point),
        }
    }

    /// `x`, or the end of the range of coordinates along `axis` to which `x` is equal up to rounding.
    fn within_span(&self, axis: usize, x: f64) -> Option<f64> {
        let low = self.corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
        let high = self.corners.iter().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
        let ends = [low, high].into_iter().find(|end| (x - end).abs() <= self.tolerance);
        ends.or_else(|| (low < x && x < high).then_some(x))
    }

    fn within(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        let edges = || self.corners.iter().zip(self.corners.iter().cycle().skip(1)).map(|(&from, &to)| (from, to));
        let distance = |other: [f64; 2]| (point[0] - other[0]).hypot(point[1] - other[1]);
        if let Some(&corner) = self.corners.iter().find(|&&corner| distance(corner) <= self.tolerance) {
            return Some(corner);
        }
        let nearest = edges().map(|(from, to)| nearest_on(from, to, point));
        let nearest = nearest.min_by(|&a, &b| distance(a).total_cmp(&distance(b)))?;
        if distance(nearest) <= self.tolerance {
            return Some(nearest);
        }
        edges().all(|(from, to)| cross(from, to, point) > 0.0).then_some(point)
    }
}

/// The nearest point between two others.
fn nearest_on(from: [f64; 2], to: [f64; 2], point: [f64; 2]) -> [f64; 2] {
    let way = [to[0] - from[0], to[1] - from[1]];
    let square = way[0] * way[0] + way[1] * way[1];
    let along = (point[0] - from[0]) * way[0] + (point[1] - from[1]) * way[1];
    let share = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    [from[0] + share * way[0], from[1] + share * way[1]]
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

    fn contains(hull: &Hull, point: [f64; 2]) -> bool {
        hull.balanced_at(point, [true, true]).is_some()
    }

    #[test]
    fn a_full_grid_is_a_rectangle() {
        let hull = hull([4, 6], |_, _| true);
        assert_eq!(hull.corners.len(), 4);
        assert!(contains(&hull, [1.4, -2.4]) && contains(&hull, [1.5, 0.0]) && contains(&hull, [1.5, 2.5]));
        assert!(!contains(&hull, [1.5 + 1e-9, 0.0]) && !contains(&hull, [1.6, 0.0]));
        assert_eq!(hull.balanced_at([1.5 - 1e-12, 0.5], [true; 2]), Some([1.5, 0.5]));
        assert!(
            hull.balanced_at([1.4, 99.0], [true, false]).is_some()
                && hull.balanced_at([1.6, 0.0], [true, false]).is_none()
        );
        assert!(hull.balanced_at([99.0, 99.0], [false, false]).is_some());
    }

    #[test]
    fn two_feet_hold_what_lies_between() {
        let hull = hull([9, 9], |x, _| x.abs() > 3.0);
        assert!(contains(&hull, [0.0, 0.0]) && contains(&hull, [2.0, 3.0]) && !contains(&hull, [4.1, 0.0]));
    }

    #[test]
    fn a_disc_has_no_corners_outside() {
        let hull = hull([41, 41], |x, y| x.hypot(y) < 18.0);
        for angle in (0..60).map(|k| k as f64 / 60.0 * std::f64::consts::TAU) {
            assert!(contains(&hull, [16.5 * angle.cos(), 16.5 * angle.sin()]));
            assert!(!contains(&hull, [18.0 * angle.cos(), 18.0 * angle.sin()]));
        }
    }

    #[test]
    fn rows_diagonals_and_points() {
        let row = hull([1, 5], |_, _| true);
        assert!(contains(&row, [0.0, 1.9]) && !contains(&row, [0.0, 2.1]) && !contains(&row, [0.1, 0.0]));
        let diagonal = hull([5, 5], |x, y| x == y);
        assert!(
            contains(&diagonal, [0.5, 0.5]) && !contains(&diagonal, [0.5, 0.4]) && !contains(&diagonal, [2.5, 2.5])
        );
        let point = hull([5, 5], |x, y| x == 1.0 && y == 0.0);
        assert!(contains(&point, [1.0, 0.0]) && !contains(&point, [1.1, 0.0]));
    }
}
