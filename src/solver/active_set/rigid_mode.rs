//! The rigid motion of a contact whose approach is given, apart from the preconditioner.
//!
//! M answers a residual that is even on A with the stiffness of the whole grid, not of A, so that conjugate gradients take an iteration for it.
//! The pressure g = Eᵀ 1 is nearly the pressure under a flat punch: K g ≈ κ on A. With Σ g = 1 the residual is divided into its mean g·r,
//! to which g/κ is the answer, and the rest, to which M answers without a force (deflation: Nicolaides, SIAM J. Numer. Anal. 24, 1987):
//!
//! z = Q Eᵀ M E Qᵀ r + g (g·r)/κ,  Q = 1 − g Σ.

use crate::solver::{ContactSet, Preconditioner, Problem, Solution};

/// g, and κ.
pub(super) struct RigidMode<'a> {
    shape: &'a [f64],
    yielding: f64,
}

impl<'a> RigidMode<'a> {
    /// The mode of a single body whose approach is given, where surfaces attract each other: their steps solve many similar problems.
    /// Writes g to `shape`. Since K is symmetric, g·v = κ Σ p.
    pub(super) fn of(
        problem: &Problem<'_>,
        solution: &Solution,
        set: &ContactSet,
        preconditioner: &mut Preconditioner,
        shape: &'a mut Vec<f64>,
    ) -> Option<RigidMode<'a>> {
        if solution.attraction.is_empty() || problem.bodies.len() != 1 || problem.bodies[0].moves() {
            return None;
        }
        shape.resize(solution.pressure.len(), 0.0);
        shape.fill(1.0);
        preconditioner.gather(shape, set);
        let total = set.sum(problem, 0, shape);
        shape.iter_mut().for_each(|g| *g /= total);
        let (Solution { pressure, potential, .. }, shape) = (solution, &shape[..]);
        let yielding = set.sum_of(problem, 0, |k| shape[k] * potential[k]) / set.sum(problem, 0, pressure);
        (yielding.is_finite() && yielding > 0.0).then_some(RigidMode { shape, yielding })
    }

    /// r ← Qᵀ r on A; returns g·r.
    pub(super) fn take_out(&self, set: &ContactSet, residual: &mut [f64]) -> f64 {
        let mean = set.segments.cells().map(|k| self.shape[k] * residual[k]).sum::<f64>();
        set.segments.cells().for_each(|k| residual[k] -= mean);
        mean
    }

    /// z ← Q z + g (g·r)/κ on A.
    pub(super) fn put_back(&self, problem: &Problem<'_>, set: &ContactSet, mean: f64, z: &mut [f64]) {
        let share = mean / self.yielding - set.sum(problem, 0, z);
        set.segments.cells().for_each(|k| z[k] += share * self.shape[k]);
    }
}
