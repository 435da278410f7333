//! A single column: what a line contact is made of. It pays for no tiles and no rows.

use std::fmt;
use std::sync::Arc;

use num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

use super::SpectralOperator;
use crate::kernel::lines::{Line, Scalar};

/// How it is transformed: by a real transform of half the work, or if it is folded as all folded lines are.
#[derive(Clone)]
pub(super) enum Column<T: Scalar> {
    Real(Arc<dyn RealToComplex<T>>, Arc<dyn ComplexToReal<T>>),
    Folded,
}

/// What its transforms work in.
#[derive(Clone, Default)]
pub(super) struct ColumnWorkspace<T: Scalar> {
    real: Vec<T>,
    waves: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
}

impl<T: Scalar> Column<T> {
    pub(super) fn new(line: &Line<T>) -> Column<T> {
        if line.is_folded() {
            return Column::Folded;
        }
        let mut planner = RealFftPlanner::new();
        Column::Real(planner.plan_fft_forward(line.len()), planner.plan_fft_inverse(line.len()))
    }

    pub(super) fn workspace(&self, line: &Line<T>) -> ColumnWorkspace<T> {
        let zeros = |count| vec![Complex::default(); count];
        match self {
            Column::Real(forward, inverse) => ColumnWorkspace {
                real: vec![T::default(); line.len()],
                waves: zeros(line.independent()),
                scratch: zeros(forward.get_scratch_len().max(inverse.get_scratch_len())),
            },
            Column::Folded => {
                ColumnWorkspace { real: Vec::new(), waves: zeros(line.len()), scratch: zeros(line.scratch()) }
            }
        }
    }
}

impl<T: Scalar> ColumnWorkspace<T> {
    /// Numbers held.
    pub(super) fn len(&self) -> usize {
        self.real.len() + 2 * self.waves.len()
    }
}

impl<T: Scalar> SpectralOperator<T> {
    /// Transforms `before` × `input`, multiplies it by the spectrum and transforms it back; the result stays in the workspace.
    pub(super) fn convolve_column(
        &self,
        column: &Column<T>,
        input: &[f64],
        before: f64,
        work: &mut ColumnWorkspace<T>,
    ) {
        let ColumnWorkspace { real, waves, scratch } = work;
        let values = input.iter().map(|&value| T::new(before * value));
        match column {
            Column::Real(forward, inverse) => {
                real[input.len()..].fill(T::default());
                real.iter_mut().zip(values).for_each(|(real, value)| *real = value);
                let forth = forward.process_with_scratch(real, waves, scratch);
                waves.iter_mut().zip(&self.spectrum).for_each(|(z, s)| *z = *z * *s);
                let back = inverse.process_with_scratch(waves, real, scratch);
                // the way back complains of a mean that is not a number: so will the step that asked
                debug_assert!(forth.is_ok());
                let _ = back;
            }
            Column::Folded => {
                let line = &self.columns;
                line.pad(waves, input.len());
                line.fill(waves, values.map(Complex::from));
                line.bare_forward(waves, scratch);
                line.multiply_folded(waves, &self.spectrum);
                line.bare_inverse(waves, scratch);
            }
        }
    }

    /// Takes `after` × the result out of the workspace.
    pub(super) fn read_column(&self, column: &Column<T>, work: &ColumnWorkspace<T>, after: f64, output: &mut [f64]) {
        match column {
            Column::Real(..) => {
                output.iter_mut().zip(&work.real).for_each(|(out, value)| *out = after * value.get());
            }
            Column::Folded => self.columns.read(&work.waves, output, |z| after * z.re.get()),
        }
    }
}

impl<T: Scalar> fmt::Debug for Column<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if matches!(self, Column::Folded) { "Folded" } else { "Real" })
    }
}
