//! Missing heights from those around them.

use super::HeightMap;
use crate::error::{Error, MapError, Result};
use crate::memory;

/// Residual of the equations, relative to the range of the known heights, at which the missing ones are found.
const TOLERANCE: f64 = 1e-10;

impl HeightMap {
    /// The map with its missing heights filled as a membrane that spans them: each is the mean of its neighbours
    /// (harmonic interpolation), so that none exceeds the known ones around.
    ///
    /// # Errors
    /// If no height is known, or the equations are not solved ([`MapError::NotFilled`]), or there is no memory for them: 16 bytes
    /// a point, and 120 more for each that is missing.
    pub fn filled(mut self) -> Result<HeightMap> {
        self.some_known()?;
        if self.missing == 0 {
            return Ok(self);
        }
        memory::check("the missing heights of a map", 16 * self.heights.len() as u128 + 120 * self.missing as u128)?;
        let low = self.known().fold(f64::INFINITY, f64::min);
        let membrane = Membrane::new(&self);
        // The middle of the range is where the unknowns start, and what they are measured from: halves do not overflow.
        let middle = 0.5 * low + 0.5 * self.highest;
        let values = membrane.solved(&self, middle, TOLERANCE * (self.highest - low))?;
        let mut heights = std::mem::take(&mut self.heights);
        // No mean exceeds its parts: what does is within the tolerance.
        for (&point, value) in membrane.points.iter().zip(values) {
            heights[point] = (middle + value).clamp(low, self.highest);
        }
        Ok(self.with_heights(heights))
    }
}

/// The missing points and their neighbours, whose equations say that the weighted differences to these add up to 0.
struct Membrane {
    points: Vec<usize>,
    /// The number of each point of the map among the missing ones.
    number: Vec<Option<usize>>,
    /// Neighbours of each missing point with their weights; 0 where there is none.
    neighbours: Vec<[(usize, f64); 4]>,
}

impl Membrane {
    fn new(map: &HeightMap) -> Membrane {
        let ([n1, n2], [s1, s2]) = (map.cells, map.spacing);
        let points: Vec<usize> = (0..map.heights.len()).filter(|&k| map.heights[k].is_nan()).collect();
        let mut number = vec![None; map.heights.len()];
        for (n, &k) in points.iter().enumerate() {
            number[k] = Some(n);
        }
        // In proportion to 1/s², with a sum of 1/2 for both.
        let (w1, w2) = (0.5 / (1.0 + (s1 / s2).powi(2)), 0.5 / (1.0 + (s2 / s1).powi(2)));
        let step = |index: usize, n: usize, forward: bool| match (forward, index) {
            (true, index) if index + 1 < n => Some(index + 1),
            (false, index) if index > 0 => Some(index - 1),
            (forward, _) => (map.periodic && n > 1).then_some(if forward { 0 } else { n - 1 }),
        };
        let neighbours = points.iter().map(|&k| {
            let (i, j) = (k / n2, k % n2);
            let along1 = |forward| step(i, n1, forward).map_or((k, 0.0), |i| (i * n2 + j, w1));
            let along2 = |forward| step(j, n2, forward).map_or((k, 0.0), |j| (i * n2 + j, w2));
            [along1(false), along1(true), along2(false), along2(true)]
        });
        let neighbours = neighbours.collect();
        Membrane { points, number, neighbours }
    }

    /// Σ weight (value − value of the neighbour), where known neighbours count 0: the equations without right sides.
    fn apply(&self, values: &[f64], result: &mut [f64]) {
        for ((around, value), result) in self.neighbours.iter().zip(values).zip(result) {
            *result =
                around.iter().fold(0.0, |sum, &(k, w)| sum + w * (value - self.number[k].map_or(0.0, |n| values[n])));
        }
    }

    /// The missing heights above `middle`, by conjugate gradients: the equations are symmetric and definite, as
    /// every hole has an edge.
    fn solved(&self, map: &HeightMap, middle: f64, tolerance: f64) -> Result<Vec<f64>> {
        let mut residual: Vec<f64> = (self.neighbours.iter())
            .map(|around| {
                let known = around.iter().filter(|(k, w)| *w > 0.0 && self.number[*k].is_none());
                known.map(|&(k, w)| w * (map.heights[k] - middle)).sum()
            })
            .collect();
        let diagonal: Vec<f64> = self.neighbours.iter().map(|a| a.iter().map(|(_, w)| w).sum()).collect();
        let mut values = vec![0.0; residual.len()];
        let mut image = values.clone();
        let mut scaled: Vec<f64> = residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect();
        let mut direction = scaled.clone();
        let mut weight = dot(&residual, &scaled);
        let most = 1000 + 100 * (map.cells[0] + map.cells[1]);
        for _ in 0..most {
            if greatest(&residual) <= tolerance {
                return Ok(values);
            }
            self.apply(&direction, &mut image);
            let length = weight / dot(&direction, &image);
            for k in 0..values.len() {
                values[k] += length * direction[k];
                residual[k] -= length * image[k];
                scaled[k] = residual[k] / diagonal[k];
            }
            let next = dot(&residual, &scaled);
            let kept = next / weight;
            weight = next;
            direction.iter_mut().zip(&scaled).for_each(|(d, s)| *d = s + kept * *d);
        }
        Err(Error::Map(MapError::NotFilled { iterations: most, residual: greatest(&residual) }))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    crate::sum::sum_of_pairs(a, b, |a, b| a * b)
}

fn greatest(values: &[f64]) -> f64 {
    crate::sum::greatest(values)
}

#[cfg(test)]
mod tests {
    use super::super::tests::map_of;
    use super::*;

    #[test]
    fn harmonic_surfaces_come_back() {
        // x1² − x2² has the same second difference, with opposite signs, along both axes.
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
    fn cells_need_not_be_square_and_edges_are_free() {
        let surface = |x1: f64, x2: f64| if x2 > 0.1 { f64::NAN } else { 5.0 + x1 * 0.0 };
        let filled = map_of([4, 9], surface).filled().unwrap();
        assert!(filled.heights().iter().all(|z| (z - 5.0).abs() < 1e-9));
        // Between 0 on one side and 1 on the other along x1, the same for any x2.
        let ramp = map_of([5, 30], |x1, x2| if x1.abs() > 0.3 || x2.abs() > 0.49 { 2.5 * x1 + 1.0 } else { f64::NAN });
        for (k, z) in ramp.filled().unwrap().heights().iter().enumerate() {
            assert!((z - (k / 30) as f64 * 0.5).abs() < 1e-8, "{k}: {z}");
        }
    }

    #[test]
    fn holes_of_periodic_maps_reach_around() {
        let ring = HeightMap::new([6, 1], [6.0, 1.0], vec![f64::NAN, 0.0, 9.0, f64::NAN, f64::NAN, 3.0]).unwrap();
        let expected = [1.5, 0.0, 9.0, 7.0, 5.0, 3.0];
        for (a, b) in ring.periodic().filled().unwrap().heights().iter().zip(expected) {
            assert!((a - b).abs() < 1e-8, "{a} for {b}");
        }
        let nothing = HeightMap::new([2, 1], [1.0, 1.0], vec![f64::NAN; 2]).unwrap();
        assert_eq!(nothing.filled(), Err(Error::Map(MapError::NothingKnown)));
    }
}
