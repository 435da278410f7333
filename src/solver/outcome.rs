//! The residual of a state, and the outcome of a solve.

use std::sync::atomic::Ordering;

use super::{ContactSet, Problem, Solution, Stop};

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub(crate) enum Outcome {
    /// The residual is below the tolerance, with pressures ≥ 0 that balance the loads.
    Converged,
    /// The iterations are spent.
    OutOfIterations,
    /// Rounding hides any further gain.
    Stagnated,
    /// No pressure on the cells of the problem can balance the load of this body.
    Unbalanced(usize),
    /// The residual is NaN.
    NotANumber,
    /// Another thread ended the solve.
    Cancelled,
}

impl Stop<'_> {
    /// The outcome if the solve ends here. Only an `admissible` state converges: its pressures are ≥ 0 and balance the
    /// loads.
    pub(crate) fn outcome(&self, solution: &Solution, admissible: impl FnOnce() -> bool) -> Option<Outcome> {
        if solution.residual <= self.tolerance && admissible() {
            Some(Outcome::Converged)
        } else if solution.residual.is_nan() {
            Some(Outcome::NotANumber)
        } else if solution.counts.iterations >= self.max_iterations {
            Some(Outcome::OutOfIterations)
        } else if self.cancelled.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            Some(Outcome::Cancelled)
        } else {
            None
        }
    }
}

/// Sums over the cells in contact, from which the residual is computed.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ResidualSums {
    /// Σ h².
    pub(crate) square: f64,
    /// Σ (c v)².
    pub(crate) displacement: f64,
    /// Σ of the squares of negative pressures.
    pub(crate) negative: f64,
    /// The largest |gap|, before any pressure.
    pub(crate) greatest_gap: f64,
    /// Rounding of gap and c K p where they are small differences of large parts.
    pub(crate) cancellation: f64,
    pub(crate) cells: usize,
    /// The largest −h in contact.
    pub(crate) deepest: f64,
    /// The deepest penetration outside the contact.
    pub(crate) penetration: f64,
}

/// Penetration may exceed the root mean square of the residual by this factor, being a maximum.
pub(crate) const PENETRATION_SLACK: f64 = 10.0;

/// Lengths whose squares underflow \[m\].
const UNDERFLOW: f64 = 1.5e-154;

impl ResidualSums {
    /// The sums over a set of cells before they are computed.
    pub(crate) fn of(set: &ContactSet) -> ResidualSums {
        ResidualSums { greatest_gap: set.greatest_gap, cells: set.count(), ..ResidualSums::default() }
    }

    /// Writes the relative residual and its rounding to `solution`. `guess_rounding` is the rounding of the guess. The
    /// step judges convergence and warns of rounding by them.
    pub(crate) fn note(&mut self, problem: &Problem<'_>, guess_rounding: f64, solution: &mut Solution) {
        self.cancellation = problem.displacement_rounding(&solution.pressure) + guess_rounding;
        // where a rank is lost, the sums are NaN, which ends the iterations
        let lost = problem.rows().intact().is_err();
        solution.residual = if lost { f64::NAN } else { self.relative_residual() };
        // a smaller residual cannot be detected; where squares of displacements vanish, none can
        solution.relative_rounding = if self.displacement > 0.0 {
            (self.gap_rounding() + UNDERFLOW) / self.yielding()
        } else if problem.rows().any(solution.pressure.iter().any(|&p| p > 0.0)) {
            f64::INFINITY
        } else {
            0.0
        };
    }

    /// The residual of a state, relative to rms (c v) in contact: the larger of rms |h| in contact
    /// and a tenth of the deepest penetration. Rounding of the gap itself does not count.
    fn relative_residual(&self) -> f64 {
        let error =
            self.rms().max(self.deepest.max(self.penetration) / PENETRATION_SLACK) - self.gap_rounding() - UNDERFLOW;
        if error <= 0.0 { 0.0 } else { error / self.yielding() }
    }

    /// rms |h| in contact.
    pub(crate) fn rms(&self) -> f64 {
        (self.square / self.cells.max(1) as f64).sqrt()
    }

    /// Rounding of the gap.
    pub(crate) fn gap_rounding(&self) -> f64 {
        4.0 * f64::EPSILON * self.greatest_gap + self.cancellation
    }

    /// rms (c v) in contact: how far the surface yields.
    pub(crate) fn yielding(&self) -> f64 {
        (self.displacement / self.cells.max(1) as f64).sqrt()
    }

    /// The penetration from which cells join the contact: the shallowest cells, on the rim of a growing contact,
    /// would mostly leave again. A body that penetrates deeper than the surface yields is far from its position: then
    /// only the deepest cells join.
    pub(crate) fn joining_depth(&self) -> f64 {
        self.penetration * if self.penetration > self.yielding() { 0.5 } else { 0.2 }
    }
}
