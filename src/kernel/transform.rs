//! A pruned, blocked two-dimensional real transform with a real even spectrum in its middle.
//!
//! Both the influence kernel (zero-padded, so that the convolution is linear) and the
//! preconditioner (periodic) are such an operator: transform, multiply by a real even function of
//! the wave numbers, transform back. Rows of the padded grid that are known to be zero are never
//! transformed, rows of the result that are dropped are never computed, and columns are gathered
//! into blocks that stay in cache.

use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};

/// Columns transformed together: 8 complex numbers fill two cache lines of every row.
const BLOCK: usize = 8;

/// The plans of a transform of `cells` values, zero-padded to `period`.
#[derive(Clone)]
struct Plans {
    rows_forward: Arc<dyn RealToComplex<f64>>,
    rows_inverse: Arc<dyn ComplexToReal<f64>>,
    columns_forward: Arc<dyn Fft<f64>>,
    columns_inverse: Arc<dyn Fft<f64>>,
}

/// A linear operator on fields, diagonal in wave-number space with a real even spectrum.
#[derive(Clone)]
pub(crate) struct SpectralOperator {
    cells: [usize; 2],
    period: [usize; 2],
    plans: Plans,
    /// For each column of wave number k2 = 0 … period/2 the values at k1 = 0 … period/2, divided by
    /// the size of the period: the unnormalised transforms need no other factor.
    spectrum: Vec<f64>,
}

/// Buffers that a [`SpectralOperator`] works in; made once, used by every application.
#[derive(Clone)]
pub(crate) struct TransformWorkspace {
    row: Vec<f64>,
    /// Half spectra of the rows that are not zero: cells[0] rows of period[1]/2 + 1.
    rows: Vec<Complex64>,
    block: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl SpectralOperator {
    /// Circular convolution on `period` with the even kernel whose coefficient at distance (i, j) is
    /// `coefficient(i, j)` for i < cells\[0\], j < cells\[1\], and zero elsewhere.
    pub(crate) fn from_coefficients(
        cells: [usize; 2],
        period: [usize; 2],
        coefficient: impl Fn(usize, usize) -> f64,
    ) -> SpectralOperator {
        let plans = Plans::new(period);
        let (half, quarter) = (period[1] / 2 + 1, period[0] / 2 + 1);
        let mut row = vec![0.0; period[1]];
        let mut row_spectrum = vec![Complex64::default(); half];
        // real parts of the row spectra, column after column
        let mut columns = vec![0.0; half * cells[0]];
        for i in 0..cells[0] {
            row.fill(0.0);
            for j in 0..cells[1] {
                let value = coefficient(i, j);
                row[j] = value;
                row[(period[1] - j) % period[1]] = value;
            }
            let done = plans.rows_forward.process(&mut row, &mut row_spectrum);
            debug_assert!(done.is_ok());
            for (k, value) in row_spectrum.iter().enumerate() {
                columns[k * cells[0] + i] = value.re;
            }
        }
        let scale = 1.0 / (period[0] * period[1]) as f64;
        let mut column = vec![Complex64::default(); period[0]];
        let mut spectrum = Vec::with_capacity(half * quarter);
        for values in columns.chunks_exact(cells[0]) {
            column.fill(Complex64::default());
            for (i, &value) in values.iter().enumerate() {
                column[i] = value.into();
                column[(period[0] - i) % period[0]] = value.into();
            }
            plans.columns_forward.process(&mut column);
            spectrum.extend(column[..quarter].iter().map(|value| scale * value.re));
        }
        SpectralOperator { cells, period, plans, spectrum }
    }

    /// Multiplication of the Fourier coefficients on `period` by `symbol(k1, k2)`, for wave numbers
    /// 0 … period/2 along each axis.
    pub(crate) fn from_symbol(
        cells: [usize; 2],
        period: [usize; 2],
        symbol: impl Fn(usize, usize) -> f64,
    ) -> SpectralOperator {
        let scale = 1.0 / (period[0] * period[1]) as f64;
        let spectrum = (0..=period[1] / 2)
            .flat_map(|k2| (0..=period[0] / 2).map(move |k1| (k1, k2)))
            .map(|(k1, k2)| scale * symbol(k1, k2))
            .collect();
        SpectralOperator { cells, period, plans: Plans::new(period), spectrum }
    }

    /// Buffers for [`SpectralOperator::apply`].
    pub(crate) fn workspace(&self) -> TransformWorkspace {
        let half = self.period[1] / 2 + 1;
        let scratch = [
            self.plans.rows_forward.get_scratch_len(),
            self.plans.rows_inverse.get_scratch_len(),
            self.plans.columns_forward.get_inplace_scratch_len(),
            self.plans.columns_inverse.get_inplace_scratch_len(),
        ];
        TransformWorkspace {
            row: vec![0.0; self.period[1]],
            rows: vec![Complex64::default(); self.cells[0] * half],
            block: vec![Complex64::default(); BLOCK.min(half) * self.period[0]],
            scratch: vec![Complex64::default(); scratch.into_iter().max().unwrap_or(0)],
        }
    }

    /// Whether `work` was made for an operator of this size.
    pub(crate) fn fits(&self, work: &TransformWorkspace) -> bool {
        let half = self.period[1] / 2 + 1;
        work.row.len() == self.period[1]
            && work.rows.len() == self.cells[0] * half
            && work.block.len() == BLOCK.min(half) * self.period[0]
    }

    /// Writes the operator applied to `input` into `output`; both hold one value a cell.
    pub(crate) fn apply(&self, input: &[f64], output: &mut [f64], work: &mut TransformWorkspace) {
        self.rows_forward(input, work);
        self.columns(work);
        self.rows_inverse(output, work);
    }

    /// [`SpectralOperator::apply`] with one field for input and output.
    pub(crate) fn apply_in_place(&self, field: &mut [f64], work: &mut TransformWorkspace) {
        self.rows_forward(field, work);
        self.columns(work);
        self.rows_inverse(field, work);
    }

    fn rows_forward(&self, input: &[f64], work: &mut TransformWorkspace) {
        let half = self.period[1] / 2 + 1;
        for (values, spectrum) in input.chunks_exact(self.cells[1]).zip(work.rows.chunks_exact_mut(half)) {
            work.row[..values.len()].copy_from_slice(values);
            work.row[values.len()..].fill(0.0);
            let plan = &self.plans.rows_forward;
            let done = plan.process_with_scratch(&mut work.row, spectrum, &mut work.scratch);
            debug_assert!(done.is_ok());
        }
    }

    fn columns(&self, work: &mut TransformWorkspace) {
        let (half, quarter) = (self.period[1] / 2 + 1, self.period[0] / 2 + 1);
        let [n1, p1] = [self.cells[0], self.period[0]];
        for first in (0..half).step_by(BLOCK) {
            let width = BLOCK.min(half - first);
            let block = &mut work.block[..width * p1];
            for (i, row) in work.rows.chunks_exact(half).enumerate() {
                for (k, value) in row[first..first + width].iter().enumerate() {
                    block[k * p1 + i] = *value;
                }
            }
            for column in block.chunks_exact_mut(p1) {
                column[n1..].fill(Complex64::default());
            }
            self.plans.columns_forward.process_with_scratch(block, &mut work.scratch);
            let spectra = self.spectrum[first * quarter..].chunks_exact(quarter);
            for (column, spectrum) in block.chunks_exact_mut(p1).zip(spectra) {
                let (rising, falling) = column.split_at_mut(quarter);
                rising.iter_mut().zip(spectrum).for_each(|(value, s)| *value *= s);
                // wave numbers above period/2 mirror those below; period/2 itself is its own image
                falling.iter_mut().rev().zip(&spectrum[1..]).for_each(|(value, s)| *value *= s);
            }
            self.plans.columns_inverse.process_with_scratch(block, &mut work.scratch);
            for (i, row) in work.rows.chunks_exact_mut(half).enumerate() {
                for (k, value) in row[first..first + width].iter_mut().enumerate() {
                    *value = block[k * p1 + i];
                }
            }
        }
    }

    fn rows_inverse(&self, output: &mut [f64], work: &mut TransformWorkspace) {
        let half = self.period[1] / 2 + 1;
        for (values, spectrum) in output.chunks_exact_mut(self.cells[1]).zip(work.rows.chunks_exact_mut(half)) {
            // the spectrum of a real row: these are real but for rounding
            spectrum[0].im = 0.0;
            if self.period[1].is_multiple_of(2) {
                spectrum[half - 1].im = 0.0;
            }
            let plan = &self.plans.rows_inverse;
            let done = plan.process_with_scratch(spectrum, &mut work.row, &mut work.scratch);
            debug_assert!(done.is_ok());
            values.copy_from_slice(&work.row[..values.len()]);
        }
    }
}

impl Plans {
    fn new(period: [usize; 2]) -> Plans {
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        Plans {
            rows_forward: real.plan_fft_forward(period[1]),
            rows_inverse: real.plan_fft_inverse(period[1]),
            columns_forward: complex.plan_fft_forward(period[0]),
            columns_inverse: complex.plan_fft_inverse(period[0]),
        }
    }
}

impl fmt::Debug for SpectralOperator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpectralOperator").field("cells", &self.cells).field("period", &self.period).finish()
    }
}

impl fmt::Debug for TransformWorkspace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TransformWorkspace").field("row", &self.row.len()).field("rows", &self.rows.len()).finish()
    }
}

impl TransformWorkspace {
    /// Numbers held by the padded part of the buffers: tells workspaces of different sizes apart.
    pub(crate) fn len(&self) -> usize {
        self.row.len() + self.rows.len() + self.block.len()
    }
}

/// The least length ≥ `least` whose only prime factors are 2, 3, 5 and 7, and which is a multiple of
/// `multiple` (itself such a number).
pub(crate) fn smooth_length(least: usize, multiple: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5, 7] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (least.div_ceil(multiple)..).map(|n| n * multiple).find(|&n| n > 0 && smooth(n)).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_lengths() {
        assert_eq!([1, 511, 513, 11, 13, 121].map(|n| smooth_length(n, 1)), [1, 512, 525, 12, 14, 125]);
        assert_eq!([1, 511, 513, 11, 13, 121].map(|n| smooth_length(n, 2)), [2, 512, 540, 12, 14, 126]);
    }

    /// The operator against its definition as a sum, for every parity of cells and periods.
    #[test]
    fn circular_convolution_matches_the_sum() {
        for (cells, period) in [
            ([1, 1], [1, 2]),
            ([4, 3], [7, 6]),
            ([3, 5], [5, 10]),
            ([6, 6], [12, 12]),
            ([5, 9], [9, 17]),
            ([2, 40], [4, 80]),
        ] {
            let coefficient = |i: usize, j: usize| 1.0 / (1.0 + (i * i + 2 * j * j) as f64);
            let operator = SpectralOperator::from_coefficients(cells, period, coefficient);
            let input: Vec<f64> = (0..cells[0] * cells[1]).map(|k| ((k * k + 3) as f64).sin()).collect();
            let mut output = vec![f64::NAN; input.len()];
            operator.apply(&input, &mut output, &mut operator.workspace());
            for i in 0..cells[0] {
                for j in 0..cells[1] {
                    let mut sum = 0.0;
                    for k in 0..cells[0] {
                        for l in 0..cells[1] {
                            sum += coefficient(i.abs_diff(k), j.abs_diff(l)) * input[k * cells[1] + l];
                        }
                    }
                    let value = output[i * cells[1] + j];
                    assert!((value - sum).abs() < 1e-13, "{cells:?} {period:?}: {value} {sum}");
                }
            }
        }
    }

    #[test]
    fn a_symbol_multiplies_its_wave() {
        let (cells, k) = ([12, 10], [2, 3]);
        let operator = SpectralOperator::from_symbol(cells, cells, |k1, k2| (1 + k1 + 10 * k2) as f64);
        let wave: Vec<f64> = (0..120)
            .map(|n| {
                let phase = (n / 10 * k[0]) as f64 / 12.0 + (n % 10 * k[1]) as f64 / 10.0;
                (std::f64::consts::TAU * phase).cos()
            })
            .collect();
        let mut output = vec![0.0; 120];
        operator.apply(&wave, &mut output, &mut operator.workspace());
        for (value, wave) in output.iter().zip(&wave) {
            assert!((value - 33.0 * wave).abs() < 1e-12);
        }
    }
}
