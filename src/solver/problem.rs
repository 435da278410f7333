//! What a step asks of a solver, and what it gets back.

use crate::kernel::{LocalKernel, Workspace};
use crate::solver::rigid_motion::{Freedom, Gram, ModeCoefficients, Modes};
use crate::solver::trace::Trace;
use crate::sum::greatest;

/// Find p ≥ 0 and the free motions of the bodies with h = c K p + gap − motion ≥ 0, p h = 0, and the balance
/// of force and moments that each freedom asks for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Problem<'a> {
    pub(crate) kernel: &'a LocalKernel,
    /// The elastic-like compliance c of the step \[1/Pa\].
    pub(crate) compliance: f64,
    /// Initial gap, history and prescribed motion, hi + u_old − (ω + α·x) \[m\]; +∞ where there is nothing
    /// to touch.
    pub(crate) gap: &'a [f64],
    /// The greatest of the prescribed motions that were taken from it: what is left is rounded by as much as they are \[m\].
    pub(crate) prescribed: f64,
    /// What is free of the motion of each rigid body.
    pub(crate) bodies: &'a [Freedom],
    /// The body that each cell belongs to; `None` where there is one.
    pub(crate) owner: Option<&'a [u16]>,
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stop {
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
}

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
    /// Numbers have left their range.
    NotANumber,
}

/// A guess on entry, the answer on return.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Solution {
    /// p \[Pa\].
    pub(crate) pressure: Vec<f64>,
    /// v = K p \[Pa·m\], kept in step with `pressure`.
    pub(crate) potential: Vec<f64>,
    /// The free part of the motion of each body; on entry that of the last step.
    pub(crate) motions: Vec<ModeCoefficients>,
    pub(crate) counts: Counts,
    /// The residual on return, see `relative_residual`.
    pub(crate) residual: f64,
    /// What the gap is rounded by, in the same measure: no smaller residual could be told.
    pub(crate) rounding: f64,
    /// How it went.
    #[cfg_attr(feature = "checkpoint", serde(skip, default = "Trace::new"))]
    pub(crate) trace: Trace,
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

/// The cells of one body that are in contact, and the moments of its free modes over them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Patch {
    pub(crate) cells: Vec<u32>,
    pub(crate) gram: Gram,
}

/// Sums over the cells in contact that tell how good a state is.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Measure {
    /// Σ h².
    pub(crate) square: f64,
    /// Σ (c v)².
    pub(crate) displacement: f64,
    /// Σ of the squares of negative pressures.
    pub(crate) negative: f64,
    /// The greatest |gap|, prior to any pressure.
    pub(crate) height: f64,
    /// What gap and c K p are rounded by where they are much less than their parts.
    pub(crate) cancelled: f64,
    pub(crate) cells: usize,
}

/// Penetration may exceed the root mean square of the residual by this factor, being a maximum.
pub(crate) const PENETRATION_SLACK: f64 = 10.0;

/// How far a state is from solving its [`Problem`], relative to rms (c v) in contact: the larger of
/// rms |h| in contact and a tenth of the deepest penetration outside. What the gap itself is rounded by does
/// not count.
pub(crate) fn relative_residual(state: &Measure, penetration: f64) -> f64 {
    let error = state.rms().max(penetration / PENETRATION_SLACK) - state.rounding();
    if error <= 0.0 { 0.0 } else { error / state.yielding() }
}

impl Measure {
    /// rms |h| in contact.
    pub(crate) fn rms(&self) -> f64 {
        (self.square / self.cells.max(1) as f64).sqrt()
    }

    /// What the gap is rounded by.
    fn rounding(&self) -> f64 {
        4.0 * f64::EPSILON * self.height + self.cancelled
    }

    /// The same, relative to how far the surface yields; 0 if it does not.
    pub(crate) fn relative_rounding(&self) -> f64 {
        if self.displacement > 0.0 { self.rounding() / self.yielding() } else { 0.0 }
    }

    /// rms (c v) in contact: how far the surface yields.
    pub(crate) fn yielding(&self) -> f64 {
        (self.displacement / self.cells.max(1) as f64).sqrt()
    }
}

impl<'a> Problem<'a> {
    pub(crate) fn modes(&self, body: usize) -> Modes<'a> {
        Modes::new(self.kernel.grid(), self.bodies[body])
    }

    /// What the gap is rounded by where a prescribed motion closes it, and c K p on bodies whose mean displacement is held: a
    /// pressure that is nearly uniform displaces nearly nothing.
    pub(crate) fn rounding(&self, pressure: &[f64]) -> f64 {
        let displaced = match self.kernel.softest_wave_if_mean_is_held() {
            Some(softest) => self.compliance * softest * greatest(pressure),
            None => 0.0,
        };
        4.0 * f64::EPSILON * (self.prescribed + displaced)
    }

    /// The body that cell `k` belongs to.
    pub(crate) fn owner(&self, k: usize) -> usize {
        self.owner.map_or(0, |owner| owner[k].into())
    }

    /// Whether `body` is pressed by no force: it carries no pressure, and follows the surface.
    pub(crate) fn released(&self, body: usize) -> bool {
        self.bodies[body].translation && self.bodies[body].total == 0.0
    }

    /// Whether no force presses any body.
    pub(crate) fn all_released(&self) -> bool {
        (0..self.bodies.len()).all(|body| self.released(body))
    }

    /// Whether cell `k` may carry pressure.
    pub(crate) fn possible(&self, k: usize) -> bool {
        self.gap[k].is_finite() && !self.released(self.owner(k))
    }

    /// Sets the free motion of `body` to the best fit on its patch, `residual` to −h there, and adds to
    /// `sums`.
    pub(crate) fn measure(
        &self,
        body: usize,
        patch: &Patch,
        solution: &mut Solution,
        residual: &mut [f64],
        sums: &mut Measure,
    ) {
        if patch.cells.is_empty() {
            return; // nothing says how it moves: as before
        }
        // The fit is that of a change of the last motion: what the cells at hand do not determine stays as it
        // was, and the sums are of small numbers, so that they do not round by more than the tolerance.
        let (c, modes, last) = (self.compliance, self.modes(body), solution.motions[body]);
        for k in patch.cells.iter().map(|&k| k as usize) {
            let u = c * solution.potential[k];
            residual[k] = modes.displacement(last, k) - (u + self.gap[k]);
            sums.displacement += u * u;
            sums.height = sums.height.max(self.gap[k].abs());
            sums.negative += solution.pressure[k].min(0.0).powi(2);
        }
        let change = modes.project_out(&patch.gram, &patch.cells, residual);
        solution.motions[body] = ModeCoefficients([0, 1, 2].map(|m| last.0[m] - change.0[m]));
        sums.square += patch.cells.iter().map(|&k| residual[k as usize].powi(2)).sum::<f64>();
        sums.cells += patch.cells.len();
    }

    /// How deep cell `k` penetrates (negative: its gap).
    pub(crate) fn depth(&self, solution: &Solution, k: usize) -> f64 {
        let body = self.owner(k);
        self.modes(body).displacement(solution.motions[body], k)
            - (self.compliance * solution.potential[k] + self.gap[k])
    }

    /// The deepest penetration on cells that may touch and for which `outside` holds, 0 if there is none.
    pub(crate) fn penetration(&self, solution: &Solution, outside: impl Fn(usize) -> bool) -> f64 {
        // one body without tilt, the common scene, needs no look-up
        if self.owner.is_none() && !self.modes(0).tilts() {
            let motion = solution.motions[0].0[0];
            let depth = |k: usize| motion - (self.compliance * solution.potential[k] + self.gap[k]);
            return (0..self.gap.len()).filter(|&k| outside(k)).map(depth).fold(0.0, f64::max);
        }
        let cells = (0..self.gap.len()).filter(|&k| outside(k) && self.possible(k));
        cells.map(|k| self.depth(solution, k)).fold(0.0, f64::max)
    }
}

impl Solution {
    pub(crate) fn zero(cells: usize, bodies: usize) -> Solution {
        Solution {
            pressure: vec![0.0; cells],
            potential: vec![0.0; cells],
            motions: vec![ModeCoefficients::default(); bodies],
            counts: Counts::default(),
            residual: 0.0,
            rounding: 0.0,
            trace: Trace::new(),
        }
    }

    /// Takes over another's values, in its own memory.
    pub(crate) fn copy_from(&mut self, other: &Solution) {
        self.pressure.clone_from(&other.pressure);
        self.potential.clone_from(&other.potential);
        self.motions.clone_from(&other.motions);
        (self.counts, self.residual, self.rounding) = (other.counts, other.residual, other.rounding);
    }

    /// No pressure at all.
    pub(crate) fn release(&mut self) {
        self.pressure.fill(0.0);
        self.potential.fill(0.0);
        (self.residual, self.rounding) = (0.0, 0.0);
    }

    /// Lets every released body follow the surface: just touching, and without any tilt of its own.
    pub(crate) fn follow_surface(&mut self, problem: &Problem<'_>) {
        for body in (0..problem.bodies.len()).filter(|&body| problem.released(body)) {
            let own = (0..problem.gap.len()).filter(|&k| problem.owner(k) == body);
            let heights = own.map(|k| problem.compliance * self.potential[k] + problem.gap[k]);
            self.motions[body] = ModeCoefficients([heights.fold(f64::INFINITY, f64::min), 0.0, 0.0]);
        }
    }

    /// v ← K p, counted.
    pub(crate) fn convolve(&mut self, problem: &Problem<'_>, work: &mut Workspace) {
        problem.kernel.apply(&self.pressure, &mut self.potential, work);
        self.counts.convolutions += 1;
    }
}
