//! Interpolation of missing heights.

use std::sync::atomic::{AtomicBool, Ordering};

use super::HeightMap;
use crate::error::{Error, Refusal, Result};
use crate::memory;
use crate::sum::{greatest, sum_of_pairs};

/// Residual of the equations, relative to the range of the known heights, at which the iteration stops.
const TOLERANCE: f64 = 1e-10;
/// No residual is less, over this range.
const ROUNDING: f64 = 1e-15;

impl HeightMap {
    /// The map with its missing heights filled by harmonic interpolation: each is the mean of its neighbours, as in a
    /// stretched membrane, and lies within the range of the known heights around it.
    ///
    /// # Errors
    /// If no height is known, the iteration does not converge, or there is no memory for it:
    /// 16 bytes per point, and 120 more per missing point.
    pub fn filled(self) -> Result<HeightMap> {
        self.filled_unless(&AtomicBool::new(false))
    }

    /// [`HeightMap::filled`], ended within an iteration where another thread sets `cancelled`.
    ///
    /// # Errors
    /// As [`HeightMap::filled`], and [`Error::Cancelled`].
    pub fn filled_unless(mut self, cancelled: &AtomicBool) -> Result<HeightMap> {
        self.require_known()?;
        if self.missing == 0 {
            return Ok(self);
        }
        memory::check("the missing heights of a map", 16 * self.heights.len() as u128 + 120 * self.missing as u128)?;
        let low = self.known().fold(f64::INFINITY, f64::min);
        let laplacian = Laplacian::new(&self);
        // Unknowns are relative to the middle of the range, and start there. Halves do not overflow.
        let middle = 0.5 * low + 0.5 * self.highest;
        // along the axis of the smaller weight heights err by a residual over this weight
        let tolerance = (TOLERANCE * laplacian.least_weight).max(ROUNDING);
        let values = laplacian.solve(&self, middle, tolerance * (self.highest - low), cancelled)?;
        // A mean does not exceed its terms: any excess is within the tolerance.
        for (&point, value) in laplacian.points.iter().zip(values) {
            self.heights[point] = (middle + value).clamp(low, self.highest);
        }
        Ok(self.summarized())
    }
}

/// The discrete Laplace equation at the missing points: the weighted differences from their neighbours add up to 0.
struct Laplacian {
    /// The missing points.
    points: Vec<usize>,
    /// The unknown of each point of the map; `None` where the height is known.
    unknown: Vec<Option<usize>>,
    /// Neighbours of each missing point with their weights; 0 where there is none.
    neighbours: Vec<[(usize, f64); 4]>,
    /// The least weight of a neighbour.
    least_weight: f64,
}

impl Laplacian {
    fn new(map: &HeightMap) -> Laplacian {
        let ([n1, n2], [s1, s2]) = (map.cells, map.spacing);
        let points: Vec<usize> = (0..map.heights.len()).filter(|&k| map.heights[k].is_nan()).collect();
        let mut unknown = vec![None; map.heights.len()];
        for (n, &k) in points.iter().enumerate() {
            unknown[k] = Some(n);
        }
        // proportional to 1/s², with a sum of 1/2 over the axes that have neighbours
        let (w1, w2) = match [n1, n2] {
            [_, 1] => (0.5, 0.0),
            [1, _] => (0.0, 0.5),
            _ => (0.5 / (1.0 + (s1 / s2).powi(2)), 0.5 / (1.0 + (s2 / s1).powi(2))),
        };
        let next = |index: usize, n: usize, forward: bool| match (forward, index) {
            (true, index) if index + 1 < n => Some(index + 1),
            (false, index) if index > 0 => Some(index - 1),
            (forward, _) => (map.periodic && n > 1).then_some(if forward { 0 } else { n - 1 }),
        };
        let neighbours = points.iter().map(|&k| {
            let (i, j) = (k / n2, k % n2);
            let along1 = |forward| next(i, n1, forward).map_or((k, 0.0), |i| (i * n2 + j, w1));
            let along2 = |forward| next(j, n2, forward).map_or((k, 0.0), |j| (i * n2 + j, w2));
            [along1(false), along1(true), along2(false), along2(true)]
        });
        let least_weight = [w1, w2].into_iter().filter(|w| *w > 0.0).fold(1.0, f64::min);
        Laplacian { neighbours: neighbours.collect(), points, unknown, least_weight }
    }

    /// Σ weight (value − neighbour) with 0 for known neighbours: the equations without their right-hand sides.
    fn apply(&self, values: &[f64], result: &mut [f64]) {
        for ((around, value), result) in self.neighbours.iter().zip(values).zip(result) {
            *result =
                around.iter().fold(0.0, |sum, &(k, w)| sum + w * (value - self.unknown[k].map_or(0.0, |n| values[n])));
        }
    }

    /// The missing heights relative to `middle`, by preconditioned conjugate gradients. The equations are symmetric and
    /// positive definite, because every hole has known heights at its edge.
    fn solve(&self, map: &HeightMap, middle: f64, tolerance: f64, cancelled: &AtomicBool) -> Result<Vec<f64>> {
        let mut residual: Vec<f64> = (self.neighbours.iter())
            .map(|around| {
                let known = around.iter().filter(|(k, w)| *w > 0.0 && self.unknown[*k].is_none());
                known.map(|&(k, w)| w * (map.heights[k] - middle)).sum()
            })
            .collect();
        let diagonal: Vec<f64> = self.neighbours.iter().map(|a| a.iter().map(|(_, w)| w).sum()).collect();
        let mut values = vec![0.0; residual.len()];
        let mut product = values.clone();
        let mut preconditioned: Vec<f64> = residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect();
        let mut direction = preconditioned.clone();
        let mut norm = dot(&residual, &preconditioned);
        let max_iterations = 1000 + 100 * (map.cells[0] + map.cells[1]);
        for _ in 0..max_iterations {
            if greatest(&residual) <= tolerance {
                return Ok(values);
            }
            if cancelled.load(Ordering::Relaxed) {
                return Err(Error::Cancelled { what: "the filling of a map" });
            }
            self.apply(&direction, &mut product);
            let step = norm / dot(&direction, &product);
            for k in 0..values.len() {
                values[k] += step * direction[k];
                residual[k] -= step * product[k];
                preconditioned[k] = residual[k] / diagonal[k];
            }
            let next = dot(&residual, &preconditioned);
            let conjugation = next / norm;
            norm = next;
            direction.iter_mut().zip(&preconditioned).for_each(|(d, z)| *d = z + conjugation * *d);
        }
        let what = format!(
            "the interpolation of the missing heights did not converge in {max_iterations} iterations: the residual \
             is {:.1e} m",
            greatest(&residual)
        );
        Err(Refusal::value("map_not_filled", what, "; crop the part without heights").into())
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    sum_of_pairs(a, b, |a, b| a * b)
}

#[cfg(test)]
mod tests {
    use super::super::nothing_known;
    use super::super::tests::map_of;
    use super::*;

    #[test]
    fn harmonic_surfaces_are_reproduced() {
        // x1² − x2² has second differences of opposite sign along the two axes.
        let surface = |x1: f64, x2: f64| x1 * x1 - x2 * x2 + 3.0 * x1 * x2 + x1;
        let holed =
            map_of(
                [20, 20],
                |x1, x2| {
                    if (0.0..0.3).contains(&x1) && x2.abs() < 0.25 { f64::NAN } else { surface(x1, x2) }
                },
            );
        assert!(holed.missing() >= 60);
        let filled = holed.filled().unwrap();
        let whole = map_of([20, 20], surface);
        assert_eq!(filled.missing(), 0);
        for (a, b) in filled.heights().iter().zip(whole.heights()) {
            assert!((a - b).abs() < 1e-8, "{a} for {b}");
        }
    }

    #[test]
    fn rectangular_cells_and_free_edges() {
        let surface = |x1: f64, x2: f64| if x2 > 0.1 { f64::NAN } else { 5.0 + x1 * 0.0 };
        let filled = map_of([4, 9], surface).filled().unwrap();
        assert!(filled.heights().iter().all(|z| (z - 5.0).abs() < 1e-9));
        // From 0 on one side to 1 on the other along x1, independent of x2.
        let ramp = map_of([5, 30], |x1, x2| if x1.abs() > 0.3 || x2.abs() > 0.49 { 2.5 * x1 + 1.0 } else { f64::NAN });
        for (k, z) in ramp.filled().unwrap().heights().iter().enumerate() {
            assert!((z - (k / 30) as f64 * 0.5).abs() < 1e-8, "{k}: {z}");
        }
    }

    /// Points of a profile, and rows far apart, along which alone heights are known.
    #[test]
    fn spacings_may_differ_by_orders() {
        for (cells, lengths) in
            [([5, 1], [5.0, 1e-5]), ([5, 2], [5.0, 2e-5]), ([5, 2], [5.0, 2.0e4]), ([5, 1], [5.0, 1e5])]
        {
            let known = |k: usize| if k == 0 || k == 4 { k as f64 / 4.0 } else { f64::NAN };
            let heights = (0..cells[0] * cells[1]).map(|k| known(k / cells[1])).collect();
            let filled = HeightMap::new(cells, lengths, heights).unwrap().filled().unwrap();
            for (k, z) in filled.heights().iter().enumerate() {
                assert!((z - (k / cells[1]) as f64 / 4.0).abs() < 1e-4, "{lengths:?} {k}: {z}");
            }
        }
    }

    #[test]
    fn holes_across_the_periodic_boundary() {
        let ring = HeightMap::new([6, 1], [6.0, 1.0], vec![f64::NAN, 0.0, 9.0, f64::NAN, f64::NAN, 3.0]).unwrap();
        let expected = [1.5, 0.0, 9.0, 7.0, 5.0, 3.0];
        for (a, b) in ring.periodic().filled().unwrap().heights().iter().zip(expected) {
            assert!((a - b).abs() < 1e-8, "{a} for {b}");
        }
        let nothing = HeightMap::new([2, 1], [1.0, 1.0], vec![f64::NAN; 2]).unwrap();
        assert_eq!(nothing.filled(), Err(nothing_known()));
    }

    #[test]
    fn filling_can_be_cancelled() {
        let holed = map_of([20, 20], |x1, x2| if x1.abs() < 0.3 { f64::NAN } else { x1 + x2 });
        let cancelled = AtomicBool::new(true);
        assert!(matches!(holed.filled_unless(&cancelled), Err(Error::Cancelled { .. })));
    }
}
