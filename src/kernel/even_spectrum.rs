//! The spectrum of an even kernel that is given by its coefficients.

use std::sync::Arc;

use num_complex::Complex64;
use realfft::{RealFftPlanner, RealToComplex};

use super::layout::{Ends, Layout};
use super::transform::Shares;

/// A quarter of the real even spectrum on the period of a padded layout, or some columns of it.
pub(super) struct EvenSpectrum {
    values: Vec<f64>,
    /// The first column, and the values of each.
    first: usize,
    length: usize,
}

impl EvenSpectrum {
    /// The spectrum of the kernel with these coefficients at the distances of the layout, and zero beyond; own columns, where
    /// ranks share it out.
    pub(super) fn of(
        layout: Layout,
        shares: Option<&Shares>,
        coefficient: impl Fn(usize, usize) -> f64,
    ) -> EvenSpectrum {
        // a kernel made periodic needs half a period at most, and none beyond the cells
        let known = [0, 1].map(|axis| {
            let cells = layout.cells[axis] * if layout.folded[axis] { 2 } else { 1 };
            if layout.ends[axis] == Ends::Free { cells } else { cells.min(layout.period(axis) / 2 + 1) }
        });
        let [period1, period2] = [layout.period(0), layout.period(1)];
        let columns = shares.map_or(layout.all_columns(), |shares| shares.columns(&layout));
        let (first, count, length) = (columns.start, columns.len(), period1 / 2 + 1);
        let [mut across, mut down] = [EvenLine::new(period2), EvenLine::new(period1)];
        let mut write = |i: usize, row: &mut [f64]| {
            let values = across.transform((0..known[1]).map(|j| coefficient(i, j)));
            row.iter_mut().zip(values).for_each(|(out, value)| *out = value);
        };
        let rows = if let Some(shares) = shares {
            shares.own_columns(&layout, known[0], write)
        } else {
            let mut rows = vec![0.0; known[0] * count];
            rows.chunks_exact_mut(count).enumerate().for_each(|(i, row)| write(i, row));
            rows
        };
        // stored column by column
        let mut values = vec![0.0; length * count];
        for (k2, column) in values.chunks_exact_mut(length).enumerate() {
            let values = down.transform(rows[k2..].iter().step_by(count).copied());
            column.iter_mut().zip(values).for_each(|(out, value)| *out = value);
        }
        EvenSpectrum { values, first, length }
    }

    /// The value at the wave numbers `k1`, `k2` of the period.
    pub(super) fn at(&self, k1: usize, k2: usize) -> f64 {
        self.values[(k2 - self.first) * self.length + k1]
    }
}

/// Transforms real even lines of one period.
pub(super) struct EvenLine {
    plan: Arc<dyn RealToComplex<f64>>,
    line: Vec<f64>,
    transformed: Vec<Complex64>,
}

impl EvenLine {
    pub(super) fn new(period: usize) -> EvenLine {
        let plan = RealFftPlanner::new().plan_fft_forward(period);
        EvenLine { plan, line: vec![0.0; period], transformed: vec![Complex64::default(); period / 2 + 1] }
    }

    /// The independent coefficients of the line that begins with `values` and is zero beyond them.
    pub(super) fn transform(&mut self, values: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
        let period = self.line.len();
        self.line.fill(0.0);
        for (i, value) in values.enumerate() {
            self.line[i] = value;
            self.line[(period - i) % period] = value;
        }
        let transformed = self.plan.process(&mut self.line, &mut self.transformed);
        debug_assert!(transformed.is_ok());
        self.transformed.iter().map(|z| z.re)
    }
}
