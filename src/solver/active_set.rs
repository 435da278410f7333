//! The default solver: an active set of cells in contact, and preconditioned conjugate gradients on it.
//!
//! On the set A of cells in contact the problem is linear: r = −(c v + gap − ω) = 0 with ω the mean
//! that leaves r without one, and Σ p fixed. One iteration is
//!
//! z = P M P r,  d = z + β d,  p += a d,  v += a K d
//!
//! with M ≈ K⁻¹ ([`Preconditioner`]), P the restriction to A less the mean, β from conjugacy
//! z·Kd + β d·Kd = 0 (which stays exact when cells join A) and a the exact minimum along d. Two
//! things keep it at one convolution an iteration, whatever happens to A:
//!
//! * Cells that penetrate join A with p = 0: that changes no field.
//! * Cells whose pressure turned negative leave A at once, but are brought back to p = 0 by the *next*
//!   direction, which contains −p on them besides the correction of the others, so that the
//!   convolution it needs anyway repairs v. Its length is then 1, and the length that the line search
//!   would have found is taken from the last one, c a, which hardly varies because M ≈ K⁻¹.
//!
//! Removing pressure changes the force; scaling p and v together restores it, free of charge. In the
//! same way a guess extrapolated from earlier steps brings its own v along, and needs no convolution.

use crate::Grid;
use crate::kernel::Workspace;
use crate::solver::cold_start::cold_start;
use crate::solver::preconditioner::Preconditioner;
use crate::solver::problem::{Problem, Solution, Stop, relative_residual};

/// Cells join the active set when their penetration exceeds this fraction of rms |r|.
const JOIN: f64 = 0.5;

#[derive(Debug, Clone)]
pub(crate) struct ActiveSet {
    preconditioner: Preconditioner,
    /// Whether a cell is in A.
    member: Vec<bool>,
    /// The cells of A, ascending.
    cells: Vec<u32>,
    /// Cells outside A whose pressure is still to be brought to zero.
    leaving: Vec<u32>,
    /// r on A, 0 elsewhere.
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    /// c a of the last line search.
    length: f64,
}

impl ActiveSet {
    pub(crate) fn new(grid: &Grid) -> ActiveSet {
        let field = vec![0.0; grid.len()];
        ActiveSet {
            preconditioner: Preconditioner::new(grid),
            member: vec![false; grid.len()],
            cells: Vec::with_capacity(grid.len()),
            leaving: Vec::with_capacity(grid.len()),
            residual: field.clone(),
            preconditioned: field.clone(),
            direction: field.clone(),
            image: field,
            length: 1.0,
        }
    }

    /// Improves `solution` until its residual is below the tolerance or the iterations are spent. On
    /// entry `solution.potential` is K p of the guess, whose pressure may be negative on some cells;
    /// a guess without any positive pressure is replaced by a cold start.
    pub(crate) fn solve(&mut self, problem: &Problem<'_>, stop: Stop, solution: &mut Solution, work: &mut Workspace) {
        self.start(problem, solution, work);
        let mut conjugate = false;
        loop {
            let (square, displacement, penetration) = self.measure(problem, solution);
            solution.residual = relative_residual(square, penetration, displacement, self.cells.len());
            let done = self.leaving.is_empty() && solution.residual <= stop.tolerance;
            if done || solution.counts.iterations >= stop.max_iterations {
                return;
            }
            solution.counts.iterations += 1;

            if penetration > JOIN * (square / self.cells.len() as f64).sqrt() {
                self.join(problem, solution);
                self.measure(problem, solution);
            }
            self.find_direction(conjugate, problem.compliance, solution);
            problem.kernel.apply(&self.direction, &mut self.image, work);
            solution.counts.convolutions += 1;
            self.advance(problem, solution);
            conjugate = true;
            self.leave(problem, solution);
        }
    }

    /// A = {p > 0}; other cells that carry pressure are to leave; Σ p over A is the total.
    fn start(&mut self, problem: &Problem<'_>, solution: &mut Solution, work: &mut Workspace) {
        self.direction.fill(0.0);
        let possible = |p: f64, gap: f64| p > 0.0 && gap.is_finite();
        if !solution.pressure.iter().zip(problem.gap).any(|(&p, &gap)| possible(p, gap)) {
            cold_start(problem, solution);
            solution.convolve(problem, work);
        }
        for (member, (&p, &gap)) in self.member.iter_mut().zip(solution.pressure.iter().zip(problem.gap)) {
            *member = possible(p, gap);
        }
        self.collect_cells();
        self.leaving.clear();
        let outside = solution.pressure.iter().zip(&self.member).enumerate();
        self.leaving.extend(outside.filter(|(_, (p, member))| **p != 0.0 && !**member).map(|(k, _)| k as u32));
        self.restore_total(problem, solution);
    }

    /// Lists the members of A.
    fn collect_cells(&mut self) {
        self.cells.clear();
        self.cells.extend(self.member.iter().enumerate().filter(|(_, member)| **member).map(|(k, _)| k as u32));
    }

    /// Scales p and v so that the pressure on A carries the force.
    fn restore_total(&self, problem: &Problem<'_>, solution: &mut Solution) {
        let sum: f64 = self.cells.iter().map(|&k| solution.pressure[k as usize]).sum();
        let scale = problem.total / sum;
        if scale != 1.0 {
            solution.pressure.iter_mut().for_each(|p| *p *= scale);
            solution.potential.iter_mut().for_each(|v| *v *= scale);
        }
    }

    /// Sets r and ω; returns Σ r², Σ (c v)² over A and the deepest penetration outside.
    fn measure(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> (f64, f64, f64) {
        let c = problem.compliance;
        let (mut sum, mut displacement) = (0.0, 0.0);
        for &k in &self.cells {
            let k = k as usize;
            let u = c * solution.potential[k];
            let h = u + problem.gap[k];
            self.residual[k] = -h;
            sum += h;
            displacement += u * u;
        }
        let approach = sum / self.cells.len() as f64;
        let mut square = 0.0;
        for &k in &self.cells {
            let r = &mut self.residual[k as usize];
            *r += approach;
            square += *r * *r;
        }
        solution.approach = approach;
        let mut penetration = 0.0_f64;
        for ((&member, &v), &gap) in self.member.iter().zip(&solution.potential).zip(problem.gap) {
            let depth = approach - (c * v + gap);
            if !member {
                penetration = penetration.max(depth);
            }
        }
        (square, displacement, penetration)
    }

    /// Takes every penetrating cell into A.
    fn join(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let depth = |k: usize| solution.approach - (problem.compliance * solution.potential[k] + problem.gap[k]);
        for k in 0..self.member.len() {
            if !self.member[k] && depth(k) > 0.0 {
                self.member[k] = true;
            }
        }
        self.leaving.retain(|&k| !self.member[k as usize]);
        self.collect_cells();
    }

    /// d ← z + β d without mean on A; with cells to bring to zero, c a d is the whole correction.
    fn find_direction(&mut self, conjugate: bool, c: f64, solution: &mut Solution) {
        for (r, &member) in self.residual.iter_mut().zip(&self.member) {
            if !member {
                *r = 0.0;
            }
        }
        self.preconditioner.apply(&self.residual, &mut self.preconditioned);
        solution.counts.preconditioner_applications += 1;

        let count = self.cells.len() as f64;
        let mean = self.cells.iter().map(|&k| self.preconditioned[k as usize]).sum::<f64>() / count;
        let (mut overlap, mut energy) = (0.0, 0.0);
        for &k in &self.cells {
            let k = k as usize;
            overlap += (self.preconditioned[k] - mean) * self.image[k];
        }
        for (&d, &kd) in self.direction.iter().zip(&self.image) {
            energy += d * kd;
        }
        let beta = if conjugate && energy > 0.0 { -overlap / energy } else { 0.0 };
        let mut sum = 0.0;
        for &k in &self.cells {
            let k = k as usize;
            let d = self.preconditioned[k] - mean + beta * self.direction[k];
            self.preconditioned[k] = d;
            sum += d;
        }
        let drift = sum / count;
        let scale = if self.leaving.is_empty() { 1.0 } else { self.length / c };
        self.direction.fill(0.0);
        for &k in &self.cells {
            let k = k as usize;
            self.direction[k] = scale * (self.preconditioned[k] - drift);
        }
        for &k in &self.leaving {
            self.direction[k as usize] = -solution.pressure[k as usize];
        }
    }

    /// p += a d, v += a K d.
    fn advance(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        let mut a = 1.0;
        if self.leaving.is_empty() {
            let (mut slope, mut curvature) = (0.0, 0.0);
            for &k in &self.cells {
                let k = k as usize;
                slope += self.residual[k] * self.direction[k];
                curvature += self.direction[k] * self.image[k];
            }
            self.length = if curvature > 0.0 { slope / curvature } else { 0.0 };
            a = self.length / problem.compliance;
        }
        for &k in &self.cells {
            let k = k as usize;
            solution.pressure[k] += a * self.direction[k];
        }
        for &k in &self.leaving {
            solution.pressure[k as usize] = 0.0;
        }
        self.leaving.clear();
        for (v, &kd) in solution.potential.iter_mut().zip(&self.image) {
            *v += a * kd;
        }
    }

    /// Takes cells with negative pressure out of A.
    fn leave(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        for &k in &self.cells {
            if solution.pressure[k as usize] < 0.0 {
                self.member[k as usize] = false;
                self.leaving.push(k);
            }
        }
        if !self.leaving.is_empty() {
            self.collect_cells();
            self.restore_total(problem, solution);
        }
    }
}
