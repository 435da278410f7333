//! The spectrum of an even kernel that is given by its coefficients, or, along periodic axes, by its waves.

use std::sync::Arc;

use num_complex::Complex64;
use realfft::{RealFftPlanner, RealToComplex};

use super::{Ends, Layout, Shares};

/// A real even function of wave numbers.
pub(super) type Symbol = Box<dyn Fn(usize, usize) -> f64>;

/// The spectrum of the kernel with this response on the period of a padded layout. The response is taken at the
/// distances of the layout along an axis that ends, and zero beyond; at wave numbers along a periodic one. For local
/// columns, where ranks share it out.
pub(super) fn even_spectrum(layout: Layout, shares: Option<&Shares>, response: &dyn Fn([usize; 2]) -> f64) -> Symbol {
    // a kernel made periodic needs half a period at most, and none beyond the cells
    let known = [0, 1].map(|axis| {
        let (cells, half) = (layout.unfolded(axis), layout.period(axis) / 2 + 1);
        if layout.ends[axis] == Ends::Free { cells } else { cells.min(half) }
    });
    let columns = shares.map_or(0..layout.period(1) / 2 + 1, |shares| shares.columns(&layout));
    let (first, count, length) = (columns.start, columns.len(), layout.period(0) / 2 + 1);
    let [mut down, mut across] = [0, 1].map(|axis| EvenLine::new(&layout, axis));
    let mut write = |i: usize, row: &mut [f64]| across.transform((0..known[1]).map(|j| response([i, j])), row);
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
        down.transform(rows[k2..].iter().step_by(count).copied(), column);
    }
    Box::new(move |k1, k2| values[(k2 - first) * length + k1])
}

/// Transforms real even lines of one period, if their axis is not periodic: there they hold waves already.
struct EvenLine {
    plan: Option<Arc<dyn RealToComplex<f64>>>,
    line: Vec<f64>,
    transformed: Vec<Complex64>,
}

impl EvenLine {
    fn new(layout: &Layout, axis: usize) -> EvenLine {
        let period = layout.period(axis);
        let plan = (layout.ends[axis] != Ends::Periodic).then(|| RealFftPlanner::new().plan_fft_forward(period));
        EvenLine { plan, line: vec![0.0; period], transformed: vec![Complex64::default(); period / 2 + 1] }
    }

    /// Writes the independent coefficients of the line that begins with `values` and is zero beyond them.
    fn transform(&mut self, values: impl Iterator<Item = f64>, out: &mut [f64]) {
        let Some(plan) = &self.plan else {
            return out.iter_mut().zip(values).for_each(|(out, value)| *out = value);
        };
        let period = self.line.len();
        self.line.fill(0.0);
        for (i, value) in values.enumerate() {
            self.line[i] = value;
            self.line[(period - i) % period] = value;
        }
        let transformed = plan.process(&mut self.line, &mut self.transformed);
        debug_assert!(transformed.is_ok());
        out.iter_mut().zip(&self.transformed).for_each(|(out, z)| *out = z.re);
    }
}
