//! Stress on a plane by complex transforms: two components at a time, as real and imaginary part.

use std::sync::Arc;

use num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

use crate::parallel::{join, lanes};

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

    /// Transforms lines along `axis` that lie one after the other.
    pub(super) fn forward_lines(&self, axis: usize, lines: &mut [Complex64]) {
        self.process(axis, 0, lines);
    }

    /// The inverse of [`Transform::forward_lines`], times the period.
    pub(super) fn inverse_lines(&self, axis: usize, lines: &mut [Complex64]) {
        self.process(axis, 1, lines);
    }

    fn apply(&self, direction: usize, values: &mut [Complex64], work: &mut [Complex64]) {
        let [p1, p2] = self.periods;
        self.process(1, direction, values);
        if p1 > 1 {
            transpose(values, work, [p1, p2]);
            self.process(0, direction, work);
            transpose(work, values, [p2, p1]);
        }
    }

    fn process(&self, axis: usize, direction: usize, lines: &mut [Complex64]) {
        if self.periods[axis] > 1 {
            share_lines(lines, self.periods[axis], &|_, share| self.plans[axis][direction].process(share));
        }
    }
}

/// Calls `job` with shares of the lines of some values, and the number of the first line of each: as many shares as there are
/// threads for as many values. What `job` does to a line must not depend on the others.
pub(super) fn share_lines<T: Send>(values: &mut [T], length: usize, job: &(impl Fn(usize, &mut [T]) + Sync)) {
    let shares = lanes(values.len());
    halve(values, length, [0, shares], job);
}

fn halve<T: Send>(
    values: &mut [T],
    length: usize,
    [first, shares]: [usize; 2],
    job: &(dyn Fn(usize, &mut [T]) + Sync),
) {
    let middle = values.len() / length / 2;
    if shares < 2 || middle == 0 {
        return job(first, values);
    }
    let (before, after) = values.split_at_mut(middle * length);
    join(
        true,
        || halve(before, length, [first, shares / 2], job),
        || halve(after, length, [first + middle, shares - shares / 2], job),
    );
}

/// Side of the blocks that are transposed at once: both of them stay in the first cache.
const BLOCK: usize = 16;

fn transpose(from: &[Complex64], to: &mut [Complex64], [rows, columns]: [usize; 2]) {
    share_lines(to, rows, &|begin, share| {
        let count = share.len() / rows;
        for second in (0..count).step_by(BLOCK) {
            for first in (0..rows).step_by(BLOCK) {
                for j in second..(second + BLOCK).min(count) {
                    for i in first..(first + BLOCK).min(rows) {
                        share[j * rows + i] = from[i * columns + begin + j];
                    }
                }
            }
        }
    });
}
