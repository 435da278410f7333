//! Stress on a plane by complex transforms: two components at a time, as real and imaginary part.

use std::sync::Arc;

use num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// Transforms of rectangles of complex numbers, row-major.
#[derive(Clone)]
pub(super) struct Transform {
    periods: [usize; 2],
    /// Forward and inverse, along x1 and x2.
    plans: [[Arc<dyn Fft<f64>>; 2]; 2],
}

impl std::fmt::Debug for Transform {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Transform").field("periods", &self.periods).finish_non_exhaustive()
    }
}

impl Transform {
    pub(super) fn new(periods: [usize; 2]) -> Transform {
        let mut planner = FftPlanner::new();
        let plans = periods.map(|period| [planner.plan_fft_forward(period), planner.plan_fft_inverse(period)]);
        Transform { periods, plans }
    }

    pub(super) fn periods(&self) -> [usize; 2] {
        self.periods
    }

    pub(super) fn len(&self) -> usize {
        self.periods[0] * self.periods[1]
    }

    /// Transforms rows and columns in place; `work` has the same length.
    pub(super) fn forward(&self, values: &mut [Complex64], work: &mut [Complex64]) {
        self.apply(0, values, work);
    }

    /// The inverse of [`Transform::forward`], times [`Transform::len`].
    pub(super) fn inverse(&self, values: &mut [Complex64], work: &mut [Complex64]) {
        self.apply(1, values, work);
    }

    fn apply(&self, direction: usize, values: &mut [Complex64], work: &mut [Complex64]) {
        let [p1, p2] = self.periods;
        if p2 > 1 {
            self.plans[1][direction].process(values);
        }
        if p1 > 1 {
            transpose(values, work, [p1, p2]);
            self.plans[0][direction].process(work);
            transpose(work, values, [p2, p1]);
        }
    }
}

/// Side of the blocks that are transposed at once: both of them stay in the first cache.
const BLOCK: usize = 16;

fn transpose(from: &[Complex64], to: &mut [Complex64], [rows, columns]: [usize; 2]) {
    for first in (0..rows).step_by(BLOCK) {
        for second in (0..columns).step_by(BLOCK) {
            for i in first..(first + BLOCK).min(rows) {
                for j in second..(second + BLOCK).min(columns) {
                    to[j * rows + i] = from[i * columns + j];
                }
            }
        }
    }
}
