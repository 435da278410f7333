//! The transform of a single column, as of a line contact: it needs no tiles and no rows.

use std::sync::Arc;

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

use super::SpectralOperator;
use crate::kernel::transform::line::LineTransform;

/// The transform: a real one of half the work, or, of a folded column, the transform of folded lines.
#[derive(Clone)]
pub(super) enum Column {
    Real(Arc<dyn RealToComplex<f64>>, Arc<dyn ComplexToReal<f64>>),
    Folded,
}

/// Buffers of the transform.
#[derive(Clone, Default)]
pub(super) struct ColumnWorkspace {
    real: Vec<f64>,
    /// The cells of all ranks, if they share them out.
    pub(super) all: Vec<f64>,
    waves: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Column {
    pub(super) fn new(line: &LineTransform) -> Column {
        if line.is_folded() {
            return Column::Folded;
        }
        let mut planner = RealFftPlanner::new();
        Column::Real(planner.plan_fft_forward(line.len()), planner.plan_fft_inverse(line.len()))
    }

    pub(super) fn workspace(&self, line: &LineTransform) -> ColumnWorkspace {
        let zeros = |count| vec![Complex64::default(); count];
        match self {
            Column::Real(forward, inverse) => ColumnWorkspace {
                real: vec![0.0; line.len()],
                all: Vec::new(),
                waves: zeros(line.independent()),
                scratch: zeros(forward.get_scratch_len().max(inverse.get_scratch_len())),
            },
            Column::Folded => ColumnWorkspace {
                waves: zeros(line.len()),
                scratch: zeros(line.scratch()),
                ..ColumnWorkspace::default()
            },
        }
    }
}

impl SpectralOperator {
    /// Transforms `input`, multiplies it by the spectrum and transforms it back; the result remains in the workspace.
    pub(super) fn convolve_column(&self, column: &Column, input: &[f64], work: &mut ColumnWorkspace) {
        let ColumnWorkspace { real, waves, scratch, .. } = work;
        match column {
            Column::Real(forward, inverse) => {
                let (values, padding) = real.split_at_mut(input.len());
                values.copy_from_slice(input);
                padding.fill(0.0);
                let transformed = forward.process_with_scratch(real, waves, scratch);
                waves.iter_mut().zip(&self.spectrum).for_each(|(z, s)| *z *= *s);
                let inverted = inverse.process_with_scratch(waves, real, scratch);
                // the inverse rejects a mean that is NaN: so does the step that convolves
                debug_assert!(transformed.is_ok());
                let _ = inverted;
            }
            Column::Folded => {
                let line = &self.columns;
                line.pad(waves, input.len());
                line.fill(waves, input.iter().map(Complex64::from));
                line.bare_forward(waves, scratch);
                line.multiply_folded(waves, &self.spectrum, &self.spectrum);
                line.bare_inverse(waves, scratch);
            }
        }
    }

    /// Copies the result from the workspace.
    pub(super) fn read_column(&self, column: &Column, work: &ColumnWorkspace, output: &mut [f64]) {
        match column {
            Column::Real(..) => output.copy_from_slice(&work.real[..output.len()]),
            Column::Folded => self.columns.read(&work.waves, output, |z| z.re),
        }
    }
}
