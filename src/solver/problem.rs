//! The contact problem of one step, and its solution.

use std::sync::atomic::AtomicBool;

use super::{Cut, Freedom, ModeCoefficients, Modes, RowModes};
use crate::kernel::{LocalKernel, Workspace};
use crate::parallel::Rows;
use crate::sum::greatest;

/// Find p ≥ 0 and the free motions of the bodies with h = c K p + gap − motion ≥ 0, p h = 0, and the balance
/// of force and moments that each freedom needs (Eq. 2 and Eq. 3 of the paper).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Problem<'a> {
    pub(crate) kernel: &'a LocalKernel,
    /// The elastic-like compliance c of the step \[1/Pa\].
    pub(crate) compliance: f64,
    /// Initial gap, history and prescribed motion, hi + u_old − (ω + α·x) \[m\]; +∞ where the indenter has no surface.
    pub(crate) gap: &'a [f64],
    /// Largest of the prescribed motions that were subtracted from `gap`; their rounding is in it \[m\].
    pub(crate) prescribed: f64,
    /// The free motions of each rigid body.
    pub(crate) bodies: &'a [Freedom],
    /// The body that each cell belongs to; `None` where there is one.
    pub(crate) owner: Option<&'a [u16]>,
    /// Cells that are likely to be in contact, if earlier steps allow a prediction.
    pub(crate) likely: Option<&'a [bool]>,
}

/// A guess on entry, the solution on return.
#[derive(Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Solution {
    /// p \[Pa\].
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(crate) pressure: Vec<f64>,
    /// v = K p \[Pa·m\], updated together with `pressure`.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(crate) potential: Vec<f64>,
    /// The attraction s \[Pa\] where surfaces attract each other: v of a state is then K (p − s). Empty elsewhere.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(crate) attraction: Vec<f64>,
    /// The free part of the motion of each body; on entry the motion of the last step.
    pub(crate) motions: Vec<ModeCoefficients>,
    pub(crate) counts: Counts,
    /// The residual on return, relative to rms (c v) in contact.
    pub(crate) residual: f64,
    /// Rounding of the gap, in the same measure: a smaller residual cannot be detected.
    pub(crate) relative_rounding: f64,
    /// Where surfaces attract each other, an estimate of the least curvature of the energy along any direction, over
    /// the curvature of its convex part; 0 where none is known.
    pub(crate) stiffness: f64,
}

clone_by_fields! {
    Solution {
        pressure, potential, attraction, motions, counts, residual, relative_rounding, stiffness,
    }
}

/// Work done, in units that do not depend on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Counts {
    pub(crate) iterations: usize,
    pub(crate) convolutions: usize,
    pub(crate) preconditioner_applications: usize,
    /// Iterations of the fall-back.
    pub(crate) fallback_iterations: usize,
}

impl<'a> Problem<'a> {
    pub(crate) fn modes(&self, body: usize) -> Modes<'a> {
        Modes::new(self.kernel.grid(), self.kernel.rows(), self.bodies[body])
    }

    /// The free modes of a body along a row, from cell `k` on.
    #[inline]
    pub(crate) fn line(&self, body: usize, k: usize) -> RowModes {
        self.modes(body).line(k)
    }

    /// The local rows, with the reductions over all ranks.
    pub(crate) fn rows(&self) -> &'a Rows {
        self.kernel.rows()
    }

    /// How the cells are cut into pieces along which the motion of a body is affine.
    pub(crate) fn cut(&self) -> Cut<'a> {
        let tilts = self.bodies.iter().any(Freedom::tilts);
        Cut { columns: if tilts { self.kernel.grid().cells()[1] } else { usize::MAX }, owner: self.owner }
    }

    /// Rounding of the gap where a prescribed motion closes it, and of c K p on bodies whose mean displacement is
    /// held: a nearly uniform pressure displaces them hardly at all.
    pub(crate) fn displacement_rounding(&self, pressure: &[f64]) -> f64 {
        let displaced = match self.kernel.whole.softest_wave_if_mean_is_held() {
            Some(softest) => self.compliance * softest * self.rows().greatest(greatest(pressure)),
            None => 0.0,
        };
        4.0 * f64::EPSILON * (self.prescribed + displaced)
    }

    /// The body that cell `k` belongs to.
    pub(crate) fn owner(&self, k: usize) -> usize {
        self.owner.map_or(0, |owner| owner[k].into())
    }

    /// Whether the force on `body` is zero: it carries no pressure, and follows the surface.
    pub(crate) fn released(&self, body: usize) -> bool {
        self.bodies[body].translation && self.bodies[body].total == 0.0
    }

    /// The bodies under a force that is not zero, and those whose approach is given.
    pub(crate) fn loaded_bodies(&self) -> impl Iterator<Item = usize> {
        (0..self.bodies.len()).filter(|&body| !self.released(body))
    }

    /// Whether cell `k` may carry pressure.
    pub(crate) fn possible(&self, k: usize) -> bool {
        self.gap[k].is_finite() && !self.released(self.owner(k))
    }

    /// Penetration of cell `k`; a negative value is its gap.
    pub(crate) fn depth(&self, solution: &Solution, k: usize) -> f64 {
        let body = self.owner(k);
        self.modes(body).displacement(solution.motions[body], k)
            - (self.compliance * solution.potential[k] + self.gap[k])
    }
}

impl Solution {
    pub(crate) fn zero(cells: usize, bodies: usize) -> Solution {
        Solution {
            pressure: vec![0.0; cells],
            potential: vec![0.0; cells],
            motions: vec![ModeCoefficients::default(); bodies],
            ..Solution::default()
        }
    }

    /// Removes all pressure.
    pub(crate) fn release(&mut self) {
        self.pressure.fill(0.0);
        self.potential.fill(0.0);
        (self.residual, self.relative_rounding) = (0.0, 0.0);
    }

    /// Moves every released body until it just touches the surface, without tilt.
    pub(crate) fn follow_surface(&mut self, problem: &Problem<'_>) {
        for body in (0..problem.bodies.len()).filter(|&body| problem.released(body)) {
            let own = (0..problem.gap.len()).filter(|&k| problem.owner(k) == body);
            let heights = own.map(|k| problem.compliance * self.potential[k] + problem.gap[k]);
            let lowest = problem.rows().least(heights.fold(f64::INFINITY, f64::min));
            self.motions[body] = ModeCoefficients([lowest, 0.0, 0.0]);
        }
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop<'a> {
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
    /// Set by another thread to end the solve.
    pub(crate) cancelled: Option<&'a AtomicBool>,
}

/// A problem, its solution so far, when to stop, and the buffers of the convolutions.
pub(crate) struct Solve<'a> {
    pub(crate) problem: &'a Problem<'a>,
    pub(crate) stop: Stop<'a>,
    pub(crate) solution: &'a mut Solution,
    pub(crate) work: &'a mut Workspace,
}

impl Solve<'_> {
    /// v ← K p, counted.
    pub(crate) fn convolve(&mut self) {
        self.problem.kernel.apply(&self.solution.pressure, &mut self.solution.potential, self.work);
        self.solution.counts.convolutions += 1;
    }

    /// image ← K field, counted.
    pub(crate) fn convolve_field(&mut self, field: &[f64], image: &mut [f64]) {
        self.problem.kernel.apply(field, image, self.work);
        self.solution.counts.convolutions += 1;
    }
}
