//! Where the stress is largest.

use super::{Stress, SubsurfaceStress};
use crate::error::Result;
use crate::kernel::HalfSpace;
use crate::memory;

/// Rounds of the refinement; each narrows the parabolas by [`NARROWER`].
const ROUNDS: usize = 8;
const NARROWER: f64 = 0.4;

/// The point where a stress is largest, see [`SubsurfaceStress::maximum`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct StressPeak {
    /// The maximum value \[Pa\].
    pub value: f64,
    /// Where it is: x1, x2 and the depth \[m\].
    pub position: [f64; 3],
    /// The stress there.
    pub stress: Stress,
    /// Whether it lies at the first or last depth, so that it may be greater beyond.
    pub at_end_of_depths: bool,
}

impl SubsurfaceStress {
    /// The largest of a quantity of the stress, such as [`Stress::von_mises`] or [`Stress::tresca`], between the
    /// first and the last of the `depths` \[m\], and its place.
    ///
    /// Sought below the centres of all cells at each of the depths, then refined by parabolas through its neighbours
    /// along each axis, which are computed anew at the vertices and narrowed in eight rounds: the place does not
    /// depend on the depths as long as they find the right peak. Of equal peaks, as in symmetric contacts, one is
    /// returned.
    ///
    /// # Errors
    /// As [`SubsurfaceStress::on_section`].
    pub fn maximum(&self, depths: &[f64], quantity: impl Fn(&Stress) -> f64) -> Result<StressPeak> {
        self.check_depths(depths)?;
        let mut plane = memory::field("the stress on a plane", self.grid.len(), Stress::default())?;
        let mut buffers = self.buffers();
        let (mut value, mut cell, mut layer) = (f64::NEG_INFINITY, 0, 0);
        for (k, &depth) in depths.iter().enumerate() {
            buffers.fill_plane(self, depth, &mut plane);
            for (index, stress) in plane.iter().enumerate() {
                let here = quantity(stress);
                if here > value {
                    (value, cell, layer) = (here, index, k);
                }
            }
        }
        let n2 = self.grid.cells()[1];
        let [x1, x2] = self.grid.center(cell / n2, cell % n2);
        let (first, last) = (depths[0], depths[depths.len() - 1]);
        // along depths that are not equally spaced, the nearer neighbour
        let gap = |k: usize| depths.get(k + 1).map_or(f64::INFINITY, |next| next - depths[k]);
        let neighbour = gap(layer).min(if layer > 0 { gap(layer - 1) } else { f64::INFINITY });
        let mut widths = [self.width(0), self.width(1), if neighbour.is_finite() { neighbour } else { 0.0 }];
        let at = |point: [f64; 3]| quantity(&self.at_point(point));
        let mut point = [x1, x2, depths[layer]];
        value = at(point);
        for _ in 0..ROUNDS {
            let mut vertex = point;
            for axis in (0..3).filter(|&axis| widths[axis] > 0.0) {
                let moved = |steps: f64| {
                    let mut moved = point;
                    moved[axis] += steps * widths[axis];
                    moved[2] = moved[2].clamp(first, last);
                    moved
                };
                let [before, after] = [moved(-1.0), moved(1.0)];
                vertex[axis] = vertex_of([before[axis], point[axis], after[axis]], [at(before), value, at(after)]);
            }
            let there = at(vertex);
            if there > value {
                (point, value) = (vertex, there);
            }
            widths = widths.map(|width| NARROWER * width);
        }
        let stress = self.at_point(point);
        let at_end_of_depths = point[2] == first || point[2] == last;
        Ok(StressPeak { value, position: point, stress, at_end_of_depths })
    }

    /// The side of a cell along an axis along which the stress varies, else 0.
    fn width(&self, axis: usize) -> f64 {
        let uniform = match self.body {
            HalfSpace::Line { across } => axis != across,
            HalfSpace::Periodic => self.grid.cells()[axis] == 1,
            HalfSpace::LoadedOnGrid => false,
        };
        if uniform { 0.0 } else { self.grid.spacing()[axis] }
    }
}

/// The vertex of the parabola through three points, or the highest point if no vertex lies between them.
fn vertex_of(points: [f64; 3], values: [f64; 3]) -> f64 {
    let ([before, here, after], [low, middle, high]) = (points, values);
    let highest = if low > middle && low >= high {
        before
    } else if high > middle {
        after
    } else {
        here
    };
    if before >= here || here >= after {
        return highest;
    }
    let (left, right) = ((middle - low) / (here - before), (high - middle) / (after - here));
    let curvature = (right - left) / (after - before);
    if curvature >= 0.0 || highest != here {
        return highest;
    }
    // the slope at `here` of the parabola
    let slope = (left * (after - here) + right * (here - before)) / (after - before);
    (here - 0.5 * slope / curvature).clamp(before, after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_of_parabolas() {
        let parabola = |x: f64| 3.0 - 2.0 * (x - 0.3).powi(2);
        for points in [[-1.0, 0.2, 0.5], [0.0, 0.25, 2.0]] {
            assert!((vertex_of(points, points.map(parabola)) - 0.3).abs() < 1e-14);
        }
        assert_eq!(vertex_of([0.0, 1.0, 2.0], [0.0, 1.0, 2.0]), 2.0);
        assert_eq!(vertex_of([0.0, 1.0, 2.0], [2.0, 1.0, 0.0]), 0.0);
        assert_eq!(vertex_of([1.0, 1.0, 2.0], [1.0, 1.0, 0.5]), 1.0);
    }
}
