//! The default solver: an active set of cells in contact, and preconditioned conjugate gradients on it.
//!
//! On the set A of cells in contact the problem is linear: r = −(c v + gap − ω) = 0 with ω the mean
//! that leaves r without one, and Σ p fixed. One iteration is
//!
//! z = P M P r,  d = z + β d,  p += a d,  v += a K d
//!
//! with M ≈ K⁻¹ ([`Preconditioner`]), P the restriction to A less the mean, β from conjugacy
//! z·Kd + β d·Kd = 0 (which stays exact when cells join A) and a the exact minimum along d.
//!
//! An iteration costs one convolution, whatever happens to A:
//!
//! * Cells that penetrate join with p = 0, which changes no field. They do so when the penetration
//!   stands out of the residual ([`JOIN`]).
//! * Cells whose pressure turned negative leave when their error does ([`EVICT`]). The *next* direction
//!   brings them to p = 0: it contains δ = −p on them, so that the convolution it needs anyway repairs v.
//!   Its length is then 1, and the length a of the rest is taken from the last line search; c a hardly
//!   varies, because M ≈ K⁻¹. The response of the other cells to δ is M δ/m, m the diagonal of M (by
//!   block inversion −K_AA⁻¹ K_AN = M_AN M_NN⁻¹), and rides on the same application of M.
//! * Less pressure on A is less force; scaling p and v together restores it. In the same way a guess
//!   extrapolated from earlier steps brings its own v along.
//!
//! Measured on a creeping Maxwell sphere (256², 100 steps, convolution equivalents a step, residual
//! 1e-6 / 1e-4): 8.9 / 5.2 when cells leave and join at once, 7.6 / 4.1 with JOIN, 6.8 / 3.6 with EVICT
//! too, 5.9 / 3.1 with the response to δ.

use crate::Grid;
use crate::kernel::Workspace;
use crate::solver::cold_start::cold_start;
use crate::solver::preconditioner::Preconditioner;
use crate::solver::problem::{Problem, Solution, Stop, relative_residual};

/// Cells join A when the deepest penetration exceeds this many times rms |r|. It must be below the
/// slack that [`relative_residual`] grants to penetration, or a state could neither improve nor pass.
const JOIN: f64 = 6.0;

/// Cells leave A when rms (c p⁻/m), the gap that their negative pressure is worth, exceeds this
/// fraction of rms |r|.
const EVICT: f64 = 0.3;

#[derive(Debug, Clone)]
pub(crate) struct ActiveSet {
    preconditioner: Preconditioner,
    /// Whether a cell is in A.
    member: Vec<bool>,
    /// The cells of A, ascending.
    cells: Vec<u32>,
    /// Cells outside A whose pressure the next direction brings to zero.
    leaving: Vec<u32>,
    /// r on A.
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    /// c a of the last line search.
    length: f64,
}

/// Sums over A that tell how good a state is.
#[derive(Debug, Clone, Copy)]
struct Measure {
    /// Σ r².
    square: f64,
    /// Σ (c v)².
    displacement: f64,
    /// Σ of the squares of negative pressures.
    negative: f64,
    cells: usize,
}

impl Measure {
    /// rms |r|.
    fn rms(&self) -> f64 {
        (self.square / self.cells as f64).sqrt()
    }
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
        loop {
            let mut state = self.measure(problem, solution);
            if state.negative > 0.0 && self.should_evict(problem, stop, state) {
                self.evict(problem, solution);
                state = self.measure(problem, solution);
            }
            let penetration = self.penetration(problem, solution);
            solution.residual = relative_residual(state.square, penetration, state.displacement, state.cells);
            let admissible = self.leaving.is_empty() && state.negative == 0.0;
            if admissible && solution.residual <= stop.tolerance || solution.counts.iterations >= stop.max_iterations {
                return;
            }
            if penetration > JOIN * state.rms() {
                self.join(problem, solution);
                self.measure(problem, solution);
            }

            solution.counts.iterations += 1;
            self.find_direction(problem.compliance, solution);
            problem.kernel.apply(&self.direction, &mut self.image, work);
            solution.counts.convolutions += 1;
            self.advance(problem.compliance, solution);
        }
    }

    /// A = {p > 0}; other cells that carry pressure are to leave; Σ p over A is the total.
    fn start(&mut self, problem: &Problem<'_>, solution: &mut Solution, work: &mut Workspace) {
        self.direction.fill(0.0);
        self.image.fill(0.0);
        let possible = |(&p, gap): (&f64, &f64)| p > 0.0 && gap.is_finite();
        if !solution.pressure.iter().zip(problem.gap).any(possible) {
            cold_start(problem, solution);
            solution.convolve(problem, work);
        }
        let cells = solution.pressure.iter().zip(problem.gap);
        self.member.iter_mut().zip(cells).for_each(|(member, cell)| *member = possible(cell));
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

    /// Sets r and ω and takes the sums over A.
    fn measure(&mut self, problem: &Problem<'_>, solution: &mut Solution) -> Measure {
        let c = problem.compliance;
        // the mean is taken of what exceeds the first cell's gap: a plain sum of many nearly equal
        // numbers would round by more than the tolerance
        let pivot = self.cells.first().map_or(0.0, |&k| c * solution.potential[k as usize] + problem.gap[k as usize]);
        let (mut sum, mut displacement, mut negative) = (0.0, 0.0, 0.0);
        for &k in &self.cells {
            let k = k as usize;
            let u = c * solution.potential[k];
            let h = u + problem.gap[k] - pivot;
            self.residual[k] = -h;
            sum += h;
            displacement += u * u;
            negative += solution.pressure[k].min(0.0).powi(2);
        }
        let cells = self.cells.len();
        let mean = sum / cells as f64;
        solution.approach = pivot + mean;
        let mut square = 0.0;
        for &k in &self.cells {
            let r = &mut self.residual[k as usize];
            *r += mean;
            square += *r * *r;
        }
        Measure { square, displacement, negative, cells }
    }

    /// How deep cell `k` penetrates (negative: its gap).
    fn depth(problem: &Problem<'_>, solution: &Solution, k: usize) -> f64 {
        solution.approach - (problem.compliance * solution.potential[k] + problem.gap[k])
    }

    /// The deepest penetration outside A, 0 if there is none.
    fn penetration(&self, problem: &Problem<'_>, solution: &Solution) -> f64 {
        let outside = (0..self.member.len()).filter(|&k| !self.member[k]);
        outside.map(|k| Self::depth(problem, solution, k)).fold(0.0, f64::max)
    }

    /// Takes every penetrating cell into A, but for those that are about to leave: they would bring a
    /// negative pressure with them, and change the force.
    fn join(&mut self, problem: &Problem<'_>, solution: &Solution) {
        for k in 0..self.member.len() {
            self.member[k] |= solution.pressure[k] == 0.0 && Self::depth(problem, solution, k) > 0.0;
        }
        self.collect_cells();
    }

    /// Whether negative pressures are the larger part of the error, or all that is left of it.
    fn should_evict(&self, problem: &Problem<'_>, stop: Stop, state: Measure) -> bool {
        let worth = problem.compliance / self.preconditioner.diagonal();
        let solved = state.square <= stop.tolerance * stop.tolerance * state.displacement;
        solved || worth * worth * state.negative > EVICT * EVICT * state.square
    }

    /// Takes cells with negative pressure out of A.
    fn evict(&mut self, problem: &Problem<'_>, solution: &mut Solution) {
        for &k in &self.cells {
            if solution.pressure[k as usize] < 0.0 {
                self.member[k as usize] = false;
                self.leaving.push(k);
            }
        }
        self.collect_cells();
        self.restore_total(problem, solution);
    }

    /// d ← z + β d without mean on A; with cells to bring to zero, d is the whole change of p.
    fn find_direction(&mut self, c: f64, solution: &mut Solution) {
        let length = self.length / c;
        self.preconditioned.fill(0.0);
        for &k in &self.cells {
            self.preconditioned[k as usize] = self.residual[k as usize];
        }
        for &k in &self.leaving {
            let delta = -solution.pressure[k as usize];
            self.preconditioned[k as usize] = delta / (length * self.preconditioner.diagonal());
        }
        self.preconditioner.apply(&mut self.preconditioned);
        solution.counts.preconditioner_applications += 1;

        let z = &mut self.preconditioned;
        remove_mean(z, &self.cells);
        let overlap: f64 = self.cells.iter().map(|&k| z[k as usize] * self.image[k as usize]).sum();
        let energy: f64 = self.direction.iter().zip(&self.image).map(|(d, kd)| d * kd).sum();
        if energy > 0.0 {
            let beta = -overlap / energy;
            self.cells.iter().for_each(|&k| z[k as usize] += beta * self.direction[k as usize]);
            remove_mean(z, &self.cells);
        }
        let scale = if self.leaving.is_empty() { 1.0 } else { length };
        self.direction.fill(0.0);
        for &k in &self.cells {
            self.direction[k as usize] = scale * z[k as usize];
        }
        for &k in &self.leaving {
            self.direction[k as usize] = -solution.pressure[k as usize];
        }
    }

    /// p += a d, v += a K d.
    fn advance(&mut self, c: f64, solution: &mut Solution) {
        let mut a = 1.0;
        if self.leaving.is_empty() {
            let (mut slope, mut curvature) = (0.0, 0.0);
            for &k in &self.cells {
                let k = k as usize;
                slope += self.residual[k] * self.direction[k];
                curvature += self.direction[k] * self.image[k];
            }
            // nothing is left to gain along a direction that vanishes, as on a single cell
            if slope > 0.0 && curvature > 0.0 {
                self.length = slope / curvature;
                a = self.length / c;
            } else {
                a = 0.0;
            }
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
}

/// Subtracts from `field` its mean over `cells`, there.
fn remove_mean(field: &mut [f64], cells: &[u32]) {
    let mean = cells.iter().map(|&k| field[k as usize]).sum::<f64>() / cells.len() as f64;
    cells.iter().for_each(|&k| field[k as usize] -= mean);
}
