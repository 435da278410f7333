//! The problem of a step along the surface.
//!
//! With the bound r of each cell, the displacement u = c K τ + u_old and the motion B d of the body,
//!
//! minimise ½ c τᵀ K τ + τᵀ (u_old − u_before) over |τ_i| ≤ r_i, Bᵀ τ = Q,
//!
//! whose multipliers are the motions Δd of the step that no load prescribes. The gradient g = c K τ + u_old −
//! u_before − a B Δd is the slip of the body over the surface, reversed: it is 0 where cells stick, |τ| < r, and points
//! against τ where they slip. a is the share of the step for which a cell was in contact (the entry rule): of what
//! joins, only the motion after it was met is slip.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Error, Refusal};
use crate::linalg;
use crate::rounded::{TIME, rounded};

/// What a step asks along the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Problem<'a> {
    /// The influence of a cell on itself \[m\].
    pub(super) self_influence: f64,
    /// c, the compliance of the step.
    pub(super) compliance: f64,
    /// r of each cell \[Pa\], 0 where it is apart.
    pub(super) bound: &'a [f64],
    /// u_old − u_before less the motion that is prescribed, both components \[m\].
    pub(super) drift: &'a [f64],
    /// Centre of each cell \[m\].
    pub(super) places: &'a [[f64; 2]],
    /// a of each cell: the share of the step for which it was in contact, 1 unless it was met in this step.
    pub(super) entered: &'a [f64],
    /// Force over the area of a cell along each component whose force is prescribed.
    pub(super) wanted: [Option<f64>; 3],
    /// Set by another thread that wants the search to end.
    pub(super) cancelled: &'a AtomicBool,
}

/// A motion of 1 along a component of the load, at a place.
pub(super) fn rigid(component: usize, place: [f64; 2]) -> [f64; 2] {
    match component {
        0 => [1.0, 0.0],
        1 => [0.0, 1.0],
        _ => [-place[1], place[0]],
    }
}

impl Problem<'_> {
    pub(super) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    pub(super) fn cells(&self) -> usize {
        self.bound.len()
    }

    /// Cells in contact.
    pub(super) fn touching(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.cells()).filter(|&i| self.bound[i] > 0.0)
    }

    /// Components whose force is prescribed.
    pub(super) fn driven(&self) -> impl Iterator<Item = usize> + '_ {
        (0..3).filter(|&k| self.wanted[k].is_some())
    }

    /// Column k of B at a cell.
    pub(super) fn mode(&self, k: usize, i: usize) -> [f64; 2] {
        rigid(k, self.places[i])
    }

    /// Σ B_k τ.
    pub(super) fn carried(&self, k: usize, field: &[f64]) -> f64 {
        let n = self.cells();
        self.touching().map(|i| dot(self.mode(k, i), [field[i], field[n + i]])).sum()
    }

    /// What is missing of each load.
    pub(super) fn missing_loads(&self, field: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.wanted[k].map_or(0.0, |wanted| wanted - self.carried(k, field)))
    }

    /// The largest of them, over its scale.
    pub(super) fn balance(&self, missing_loads: [f64; 3]) -> f64 {
        self.driven().map(|k| missing_loads[k].abs() / self.size(k)).fold(0.0, f64::max)
    }

    /// g of some cells from c K τ.
    pub(super) fn gradient(
        &self,
        cells: impl Iterator<Item = usize>,
        stress: &[f64],
        motion: [f64; 3],
        out: &mut [f64],
    ) {
        let n = self.cells();
        for i in cells {
            [i, n + i].into_iter().for_each(|at| out[at] = self.compliance * stress[at] + self.drift[at]);
            take_motion(out, [i], self.entered, self.places, motion);
        }
    }

    /// The work of a step and the part of it that slip dissipates, from the tractions averaged over the step (`mean`)
    /// and from `stress`, K τ. The bodies take up Σ mean·Δu with the change Δu = a B Δd + g of their surface: this is
    /// the energy that their springs and dashpots take, to the last digit, for a displacement that is linear in time. A
    /// cell that slips carries its bound meanwhile: it dissipates |g| times the average of its tractions at the start of
    /// slip and at the end.
    pub(super) fn works(
        &self,
        before: &Solution,
        now: &Solution,
        given: [f64; 3],
        mean: &[f64],
        stress: &[f64],
    ) -> [f64; 2] {
        let n = self.cells();
        (0..n).fold([0.0; 2], |[work, slip], i| {
            let [old, new, g] = [before.of(i), now.of(i), [now.gradient[i], now.gradient[n + i]]];
            let along = (0..3).map(|k| given[k] * dot(self.mode(k, i), [mean[i], mean[n + i]])).sum::<f64>();
            let taken = [i, n + i].map(|at| mean[at] * (self.compliance * stress[at] + self.drift[at]));
            let size = new[0].hypot(new[1]);
            let lost = match (now.cells[i], before.cells[i]) {
                (Cell::Stick, _) => 0.0,
                // nothing is gained by slip, however far the body moves while a cell parts
                (Cell::Apart, _) => (-0.5 * dot(g, old)).max(0.0),
                (Cell::Slip, Cell::Stick) => size * g[0].hypot(g[1]),
                (Cell::Slip, _) => 0.5 * (old[0].hypot(old[1]) + size) * g[0].hypot(g[1]),
            };
            [work + self.entered[i] * along + taken[0] + taken[1] + lost, slip + lost]
        })
    }

    /// The scale of what may be missing of a load: what is asked, and a thousandth of what friction can carry.
    pub(super) fn size(&self, k: usize) -> f64 {
        self.wanted[k].unwrap_or(0.0).abs() + 1e-3 * self.reach(k)
    }
}

/// Takes a B d out of a displacement of some cells.
pub(super) fn take_motion(
    field: &mut [f64],
    cells: impl IntoIterator<Item = usize>,
    entered: &[f64],
    places: &[[f64; 2]],
    motion: [f64; 3],
) {
    for i in cells {
        for (k, by) in motion.into_iter().enumerate() {
            let (mode, by) = (rigid(k, places[i]), entered[i] * by);
            field[i] -= by * mode[0];
            field[places.len() + i] -= by * mode[1];
        }
    }
}

pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// What a cell does in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Cell {
    #[default]
    Apart,
    Stick,
    Slip,
}

/// Tractions of a step, and what they leave.
#[derive(Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Solution {
    /// τ, both components one after the other \[Pa\].
    pub(super) traction: Vec<f64>,
    pub(super) cells: Vec<Cell>,
    /// Δd where forces are prescribed.
    pub(super) motion: [f64; 3],
    /// g \[m\].
    pub(super) gradient: Vec<f64>,
}

clone_by_fields! { Solution { traction, cells, motion, gradient } }

impl Solution {
    pub(super) fn resize(&mut self, n: usize) {
        self.cells.resize(n, Cell::Apart);
        [&mut self.traction, &mut self.gradient].into_iter().for_each(|field| field.resize(2 * n, 0.0));
    }

    pub(super) fn of(&self, i: usize) -> [f64; 2] {
        [self.traction[i], self.traction[self.cells.len() + i]]
    }

    /// Fits the tractions of the step before into the bounds of this one: what slipped slips.
    pub(super) fn begin(&mut self, problem: &Problem<'_>) {
        let n = self.cells.len();
        for i in 0..n {
            let (bound, size) = (problem.bound[i], self.of(i)[0].hypot(self.of(i)[1]));
            let slips = size > bound || self.cells[i] == Cell::Slip && size > 0.0;
            let scale = if slips { bound / size } else { 1.0 };
            self.cells[i] = match (bound > 0.0, slips) {
                (false, _) => Cell::Apart,
                (true, true) => Cell::Slip,
                (true, false) => Cell::Stick,
            };
            self.traction[i] *= scale;
            self.traction[n + i] *= scale;
        }
        self.gradient.fill(0.0);
    }

    /// Without traction, for a start that does not depend on the past.
    pub(super) fn begin_cold(&mut self, problem: &Problem<'_>) {
        self.traction.fill(0.0);
        self.cells.fill(Cell::Apart);
        self.begin(problem);
    }

    /// A step of each cell alone along −g within its circle, half of what it would take without the others: where
    /// Newton's method takes turns between sets of cells, this settles the quarrels of neighbours.
    pub(super) fn smooth(&mut self, problem: &Problem<'_>) {
        let (n, stiffness) = (problem.cells(), 0.5 / (problem.compliance * problem.self_influence));
        for i in problem.touching() {
            let moved = [0, n].map(|start| self.traction[start + i] - stiffness * self.gradient[start + i]);
            let scale = problem.bound[i] / moved[0].hypot(moved[1]);
            self.cells[i] = if scale < 1.0 { Cell::Slip } else { Cell::Stick };
            (self.traction[i], self.traction[n + i]) = (scale.min(1.0) * moved[0], scale.min(1.0) * moved[1]);
        }
    }
}

impl Problem<'_> {
    /// Σ r |B_k|, beyond which no force is carried.
    pub(super) fn reach(&self, k: usize) -> f64 {
        self.touching().map(|i| self.bound[i] * rigid(k, self.places[i])[0].hypot(rigid(k, self.places[i])[1])).sum()
    }

    /// The motion that leaves the least of g where cells stick.
    pub(super) fn fitting_motion(&self, solution: &Solution, stress: &[f64]) -> [f64; 3] {
        let n = self.cells();
        let (mut gram, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        for i in self.touching().filter(|&i| solution.cells[i] == Cell::Stick) {
            let free = [0, n].map(|start| self.compliance * stress[start + i] + self.drift[start + i]);
            for a in self.driven() {
                let share = self.entered[i];
                right[a] += share * dot(self.mode(a, i), free);
                self.driven().for_each(|b| gram[a][b] += share * share * dot(self.mode(a, i), self.mode(b, i)));
            }
        }
        linalg::solve_normal_equations(&gram, right, 1e-13)
    }
}

/// The error of tractions whose residual stays above what is allowed.
pub(super) fn not_found(time: f64, residual: f64, tolerance: f64, iterations: usize) -> Error {
    let what = format!(
        "at t = {} s the tractions along the surface were not found: residual {residual:.1e} after {iterations} Newton \
         steps, where {tolerance:.1e} is allowed",
        rounded(time, TIME)
    );
    let remedy = "; take a shorter step, or a greater Settings::tolerance";
    Refusal::search("friction_not_converged", what, remedy).into()
}
