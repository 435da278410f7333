//! What a step asks of a solver, and what it gets back.

use crate::kernel::{InfluenceKernel, Workspace};

/// Find p ≥ 0 with h = c K p + gap − ω ≥ 0, p h = 0 and Σ p = `total`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Problem<'a> {
    pub(crate) kernel: &'a InfluenceKernel,
    /// The elastic-like compliance c of the step \[1/Pa\].
    pub(crate) compliance: f64,
    /// Initial gap and history, hi + u_old \[m\]; +∞ where there is nothing to touch.
    pub(crate) gap: &'a [f64],
    /// The force divided by the area of a cell \[Pa\].
    pub(crate) total: f64,
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop {
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
}

/// A guess on entry, the answer on return.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    /// p \[Pa\].
    pub(crate) pressure: Vec<f64>,
    /// v = K p \[Pa·m\], kept in step with `pressure`.
    pub(crate) potential: Vec<f64>,
    /// ω \[m\].
    pub(crate) approach: f64,
    pub(crate) counts: Counts,
    /// The residual on return, see [`Residual`].
    pub(crate) residual: f64,
}

/// Work done, in units that do not depend on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) iterations: usize,
    pub(crate) convolutions: usize,
    pub(crate) preconditioner_applications: usize,
}

/// Penetration may exceed the root mean square of the residual by this factor, being a maximum.
const PENETRATION_SLACK: f64 = 10.0;

/// How far a state is from solving its [`Problem`], relative to rms (c v) in contact: the larger of
/// rms |h| in contact and a tenth of the deepest penetration outside.
pub(crate) fn relative_residual(square_sum: f64, penetration: f64, displacement_square_sum: f64, cells: usize) -> f64 {
    let scale = (displacement_square_sum / cells as f64).sqrt();
    if scale == 0.0 {
        return if square_sum == 0.0 && penetration <= 0.0 { 0.0 } else { f64::INFINITY };
    }
    let gap = (square_sum / cells as f64).sqrt();
    gap.max(penetration / PENETRATION_SLACK) / scale
}

impl Solution {
    pub(crate) fn zero(cells: usize) -> Solution {
        Solution {
            pressure: vec![0.0; cells],
            potential: vec![0.0; cells],
            approach: 0.0,
            counts: Counts::default(),
            residual: 0.0,
        }
    }

    /// The answer to a vanishing force: no pressure, the bodies just touching.
    pub(crate) fn release(&mut self, problem: &Problem<'_>) {
        self.pressure.fill(0.0);
        self.potential.fill(0.0);
        self.approach = problem.gap.iter().copied().fold(f64::INFINITY, f64::min);
        self.residual = 0.0;
    }

    /// v ← K p, counted.
    pub(crate) fn convolve(&mut self, problem: &Problem<'_>, work: &mut Workspace) {
        problem.kernel.apply(&self.pressure, &mut self.potential, work);
        self.counts.convolutions += 1;
    }
}
