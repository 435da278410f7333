//! The spectrum of an even kernel that is known by its coefficients.

use num_complex::Complex64;
use realfft::RealFftPlanner;

use super::layout::Layout;

/// A quarter of the real even spectrum on the period of a padded layout.
pub(super) struct Spectrum {
    values: Vec<f64>,
    columns: usize,
}

impl Spectrum {
    /// Of the kernel with the given coefficients at distances that the layout knows, zero beyond.
    pub(super) fn of(layout: Layout, coefficient: impl Fn(usize, usize) -> f64) -> Spectrum {
        // of a periodic kernel, half a period is known
        let known = [0, 1].map(|axis| match (layout.padded, layout.folded[axis]) {
            (true, folded) => layout.cells[axis] * if folded { 2 } else { 1 },
            (false, _) => layout.period(axis) / 2 + 1,
        });
        let [period1, period2] = [layout.period(0), layout.period(1)];
        let (half1, half2) = (period1 / 2 + 1, period2 / 2 + 1);
        let mut planner = RealFftPlanner::<f64>::new();
        let plans = [planner.plan_fft_forward(period1), planner.plan_fft_forward(period2)];
        let mut line = vec![0.0; period1.max(period2)];
        let mut transformed = vec![Complex64::default(); half1.max(half2)];
        let mut transform = |axis: usize, values: &mut dyn Iterator<Item = f64>, out: &mut [f64]| {
            let period = [period1, period2][axis];
            let line = &mut line[..period];
            line.fill(0.0);
            for (i, value) in values.enumerate() {
                line[i] = value;
                line[(period - i) % period] = value;
            }
            let done = plans[axis].process(line, &mut transformed[..period / 2 + 1]);
            debug_assert!(done.is_ok());
            out.iter_mut().zip(&transformed).for_each(|(out, z)| *out = z.re);
        };
        let mut rows = vec![0.0; known[0] * half2];
        for (i, row) in rows.chunks_exact_mut(half2).enumerate() {
            transform(1, &mut (0..known[1]).map(|j| coefficient(i, j)), row);
        }
        // column after column
        let mut values = vec![0.0; half1 * half2];
        for (k2, column) in values.chunks_exact_mut(half1).enumerate() {
            transform(0, &mut rows[k2..].iter().step_by(half2).copied(), column);
        }
        Spectrum { values, columns: half1 }
    }

    /// Its value at the wave numbers `k1`, `k2` of the period.
    pub(super) fn at(&self, k1: usize, k2: usize) -> f64 {
        self.values[k2 * self.columns + k1]
    }
}
