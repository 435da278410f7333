//! Newton's method for the problem of a step.

use crate::friction::kernel::TangentialKernel;
use crate::friction::modes::{Modes, add, inner};
use crate::friction::problem::{Cell, Problem, Solution, dot};
use crate::linalg;

/// Buffers of the solver.
#[derive(Debug, Clone, Default)]
pub(super) struct NewtonBuffers {
    pub(super) stress: Vec<f64>,
    normals: Vec<[f64; 2]>,
    /// max(−g·n, 0)/r where cells slip: the curvature of the circle.
    curvature: Vec<f64>,
    step: Vec<f64>,
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    modes: Modes,
    /// Of the multipliers, in the Newton step found last, and which cells began to slip in it.
    change: [f64; 3],
    began: Vec<bool>,
    /// Whether other cells slip than at the start of that step.
    changed: bool,
    /// Whether loads are met after a Newton step, too.
    carries: bool,
    /// Of the search by motion: the drift, and where it comes from.
    pub(super) drift: Vec<f64>,
    pub(super) kept: Solution,
    pub(super) beside: Solution,
}

impl NewtonBuffers {
    pub(super) fn resize(&mut self, n: usize) {
        let NewtonBuffers {
            stress,
            normals,
            curvature,
            step,
            residual,
            preconditioned,
            direction,
            image,
            modes,
            drift,
            ..
        } = self;
        modes.resize(n);
        [&mut self.kept, &mut self.beside].into_iter().for_each(|solution| solution.resize(n));
        normals.resize(n, [0.0; 2]);
        self.began.resize(n, false);
        curvature.resize(n, 0.0);
        let fields = [stress, step, residual, preconditioned, direction, image, drift];
        fields.into_iter().for_each(|field| field.resize(2 * n, 0.0));
    }
}

/// How a solve went.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Convergence {
    pub(super) iterations: usize,
    /// Max of the residuals of stick and slip over the largest displacement, and of those of the loads.
    pub(super) residual: f64,
    pub(super) is_solved: bool,
}

/// How the tractions of a step are found.
pub(super) struct Newton {
    /// Corrections of the loads after a Newton step.
    most_carries: usize,
    /// Newton steps before a solve is given up.
    most_steps: usize,
    /// From so many Newton steps on every fourth is a step of each cell alone.
    patience: usize,
    /// Part of the residual that conjugate gradients leave in a Newton step.
    forcing: f64,
    /// Conjugate gradients in a Newton step.
    most_gradients: usize,
    /// Displacements below this part of what friction could cause are not resolved further.
    pub(super) negligible: f64,
    /// What is left of a residual by rounding.
    nothing: f64,
    /// Stiffness, over that of a cell, below which there is none.
    unresisted: f64,
    /// Part of the tolerance beyond which a cell that would slip backwards sticks.
    backwards: f64,
}

pub(super) const NEWTON: Newton = Newton {
    most_carries: 8,
    most_steps: 40,
    patience: 10,
    forcing: 0.1,
    most_gradients: 150,
    negligible: 1e-3,
    nothing: 1e-12,
    unresisted: 1e-9,
    backwards: 1e-2,
};

impl Solution {
    /// Solves the problem from what is there; if that fails without traction, and then by the motion.
    pub(super) fn find(
        &mut self,
        problem: &Problem<'_>,
        kernel: &mut TangentialKernel,
        tolerance: f64,
        work: &mut NewtonBuffers,
    ) -> Convergence {
        self.begin(problem);
        work.carries = true;
        let mut found = self.solve(problem, kernel, tolerance, work);
        // where all cells near the limit would slip at once, loads are met by Newton steps alone
        work.carries = false;
        let mut iterations = found.iterations;
        let goes_on = |found: Convergence| !found.is_solved && !problem.is_cancelled();
        if goes_on(found) {
            self.begin_cold(problem);
            found = self.solve(problem, kernel, tolerance, work);
            iterations += found.iterations;
        }
        if goes_on(found) {
            found = self.find_by_motion(problem, kernel, tolerance, work);
            iterations += found.iterations;
        }
        Convergence { iterations, ..found }
    }

    /// Newton's method in the sets of cells that stick and slip, by conjugate gradients in the null space of the
    /// loads.
    pub(super) fn solve(
        &mut self,
        problem: &Problem<'_>,
        kernel: &mut TangentialKernel,
        tolerance: f64,
        work: &mut NewtonBuffers,
    ) -> Convergence {
        let n = problem.cells();
        let drift =
            problem.touching().map(|i| problem.drift[i].abs().max(problem.drift[n + i].abs())).fold(0.0, f64::max);
        // what friction could displace
        let (largest, count) =
            problem.touching().fold((0.0_f64, 0), |(r, count), i| (r.max(problem.bound[i]), count + 1));
        let least = NEWTON.negligible * problem.compliance * largest * problem.self_influence * f64::from(count).sqrt();
        let mut convergence = Convergence::default();
        work.changed = false;
        work.began.fill(false);
        work.modes.are_known = false;
        for iteration in 0..=NEWTON.most_steps {
            kernel.apply(&self.traction, &mut work.stress);
            if iteration == 0 {
                self.motion = problem.fitting_motion(self, &work.stress);
            }
            problem.gradient(problem.touching(), &work.stress, self.motion, &mut self.gradient);
            let stress = problem.touching().map(|i| work.stress[i].abs().max(work.stress[n + i].abs()));
            let scale = (problem.compliance * stress.fold(0.0, f64::max)).max(drift).max(least).max(f64::MIN_POSITIVE);
            let missing_loads = problem.missing_loads(&self.traction);
            let balance = problem.balance(missing_loads);
            let residual = self.judge(problem, work) / scale;
            let is_solved = residual <= tolerance && balance <= tolerance;
            convergence = Convergence { iterations: iteration, residual: residual.max(balance), is_solved };
            if convergence.is_solved
                || iteration == NEWTON.most_steps
                || !residual.is_finite()
                || problem.is_cancelled()
            {
                break;
            }
            if iteration > NEWTON.patience && iteration % 4 == 0 {
                self.smooth(problem);
                work.changed = true;
                continue;
            }
            self.let_stick(problem, work, NEWTON.backwards * tolerance * scale);
            // what is beyond reach while the sets change, or would be beyond what is asked, is left
            let forcing = if work.changed {
                2.0 * NEWTON.forcing
            } else {
                NEWTON.forcing.min(residual.max(0.7 * tolerance / residual))
            };
            let missing_loads = if balance <= 0.003 * tolerance { [0.0; 3] } else { missing_loads };
            if !self.advance(problem, kernel, (missing_loads, forcing), work) {
                break;
            }
            work.began.fill(false);
            self.move_by(problem, work);
            (0..3).for_each(|k| self.motion[k] += work.change[k]);
            self.carry(problem, work, 0.003 * tolerance);
        }
        convergence
    }

    /// Changes the tractions by the step found last: what leaves its circle slips. Returns whether other cells began
    /// to.
    fn move_by(&mut self, problem: &Problem<'_>, work: &mut NewtonBuffers) -> bool {
        let (n, step, mut any) = (problem.cells(), &work.step, false);
        for i in problem.touching() {
            let [x, y] = [self.traction[i] + step[i], self.traction[n + i] + step[n + i]];
            let (bound, size) = (problem.bound[i], x.hypot(y));
            let begins = size > bound && self.cells[i] == Cell::Stick;
            work.began[i] |= begins;
            any |= begins;
            if size > bound {
                self.cells[i] = Cell::Slip;
            }
            let scale = if self.cells[i] == Cell::Slip && size > 0.0 { bound / size } else { 1.0 };
            (self.traction[i], self.traction[n + i]) = (scale * x, scale * y);
        }
        work.changed |= any;
        any
    }

    /// Lets the tractions carry the loads again, as those under a rigid body that moves: what projections took away is
    /// given back without a convolution.
    fn carry(&mut self, problem: &Problem<'_>, work: &mut NewtonBuffers, least: f64) {
        if !(work.carries && work.modes.are_known) {
            return;
        }
        for _ in 0..NEWTON.most_carries {
            let missing_loads = problem.missing_loads(&self.traction);
            if problem.balance(missing_loads) <= least {
                break;
            }
            let free = |i: usize, modes: &Modes| {
                let (answers, traction) = (modes.answers_at(i), self.of(i));
                if self.cells[i] == Cell::Stick {
                    return answers;
                }
                let size = traction[0].hypot(traction[1]);
                let tangent = [-traction[1] / size, traction[0] / size];
                answers.map(|answer| tangent.map(|part| part * dot(tangent, answer)))
            };
            let mut carried = [[0.0; 3]; 3];
            for i in problem.touching() {
                let answers = free(i, &work.modes);
                for a in problem.driven() {
                    problem.driven().for_each(|b| carried[a][b] += dot(problem.mode(a, i), answers[b]));
                }
            }
            let parts = linalg::solve_normal_equations(&carried, missing_loads, 1e-13);
            for i in problem.touching() {
                let answers = free(i, &work.modes);
                let by = [0, 1].map(|axis| (0..3).map(|k| parts[k] * answers[k][axis]).sum::<f64>());
                (work.step[i], work.step[problem.cells() + i]) = (by[0], by[1]);
            }
            // near the limit all cells would slip before the others had a say
            if self.move_by(problem, work) {
                break;
            }
        }
    }

    /// Finds normals and curvatures, and the largest residual: |g| where cells stick, its tangential part and what
    /// points along τ where they slip.
    fn judge(&self, problem: &Problem<'_>, work: &mut NewtonBuffers) -> f64 {
        let n = problem.cells();
        let mut worst = 0.0_f64;
        for i in problem.touching() {
            let (traction, g) = (self.of(i), [self.gradient[i], self.gradient[n + i]]);
            let size = traction[0].hypot(traction[1]);
            let normal = if size > 0.0 { traction.map(|value| value / size) } else { [0.0; 2] };
            let along = dot(g, normal);
            let (slips, beside) = (self.cells[i] == Cell::Slip, dot(g, [-normal[1], normal[0]]).abs());
            work.normals[i] = normal;
            work.curvature[i] = if slips { (-along).max(0.0) / problem.bound[i] } else { 0.0 };
            let off = if slips { beside.max(along) } else { g[0].hypot(g[1]) };
            worst = if off.is_finite() { worst.max(off) } else { f64::INFINITY };
        }
        worst
    }

    /// Lets cells that would slip backwards stick.
    fn let_stick(&mut self, problem: &Problem<'_>, work: &mut NewtonBuffers, least: f64) {
        let n = problem.cells();
        for i in problem.touching() {
            let along = dot([self.gradient[i], self.gradient[n + i]], work.normals[i]);
            // those that began to slip in the last step move along their circle first
            if self.cells[i] == Cell::Slip && along > least && !work.began[i] {
                (self.cells[i], work.curvature[i]) = (Cell::Stick, 0.0);
                work.changed = true;
            }
        }
    }

    /// Keeps of a field what cells are free to do: nothing where they are apart, along the circle where they slip.
    fn restrict(&self, normals: &[[f64; 2]], field: &mut [f64]) {
        let n = self.cells.len();
        for i in 0..n {
            let kept = match self.cells[i] {
                Cell::Apart => [0.0; 2],
                Cell::Stick => continue,
                Cell::Slip => {
                    let tangent = [-normals[i][1], normals[i][0]];
                    let part = dot(tangent, [field[i], field[n + i]]);
                    tangent.map(|value| part * value)
                }
            };
            (field[i], field[n + i]) = (kept[0], kept[1]);
        }
    }

    /// A Newton step. Returns whether there was one.
    fn advance(
        &mut self,
        problem: &Problem<'_>,
        kernel: &mut TangentialKernel,
        (missing_loads, forcing): ([f64; 3], f64),
        work: &mut NewtonBuffers,
    ) -> bool {
        let NewtonBuffers { step, residual, preconditioned, direction, image, modes, normals, curvature, .. } = work;
        kernel.fit(&self.cells, curvature, problem.compliance);
        modes.fit(problem, |field| self.restrict(normals, field));
        step.fill(0.0);
        residual.iter_mut().zip(&self.gradient).for_each(|(r, g)| *r = -g);
        self.restrict(normals, residual);
        if missing_loads != [0.0; 3] {
            // meets the loads; what follows stays in the null space
            modes.meet(missing_loads, step, |mode, out| kernel.precondition(mode, out, &self.cells, normals));
            self.operate(problem, kernel, step, image, (normals, curvature));
            add(residual, -1.0, image);
        }
        let whole = largest(residual);
        let mut multipliers = modes.project(residual);
        let first = largest(residual);
        let mut size = f64::INFINITY;
        direction.fill(0.0);
        // if the loads leave nothing free, what is left is rounding
        let most = if first <= NEWTON.nothing * whole { 0 } else { NEWTON.most_gradients };
        for _ in 0..most {
            kernel.precondition(residual, preconditioned, &self.cells, normals);
            modes.project(preconditioned);
            let next = inner(residual, preconditioned);
            if next <= 0.0 || next.is_nan() || problem.is_cancelled() {
                break;
            }
            direction.iter_mut().zip(&*preconditioned).for_each(|(p, z)| *p = z + next / size * *p);
            size = next;
            self.operate(problem, kernel, direction, image, (normals, curvature));
            let resists = inner(direction, image);
            if !resists.is_finite() {
                return false;
            }
            // the mean of a periodic body that sticks to all of another one: on to the circles
            if resists <= NEWTON.unresisted * problem.compliance * problem.self_influence * inner(direction, direction)
            {
                add(step, 2.0 * largest(problem.bound) / largest(direction), direction);
                break;
            }
            let length = size / resists;
            add(step, length, direction);
            add(residual, -length, image);
            let taken = modes.project(residual);
            (0..3).for_each(|k| multipliers[k] += taken[k]);
            if largest(residual) <= forcing * first {
                break;
            }
        }
        // the step leaves −B ν of the gradient, and a further motion takes a B Δd of it
        (work.change, work.changed) = (modes.motion(problem.entered, multipliers.map(|value| -value)), false);
        true
    }

    /// c K, restricted, and the curvature of the circles.
    fn operate(
        &self,
        problem: &Problem<'_>,
        kernel: &mut TangentialKernel,
        field: &[f64],
        out: &mut [f64],
        (normals, curvature): (&[[f64; 2]], &[f64]),
    ) {
        kernel.apply(field, out);
        self.restrict(normals, out);
        let n = problem.cells();
        out.iter_mut().for_each(|value| *value *= problem.compliance);
        for i in problem.touching().filter(|&i| curvature[i] > 0.0) {
            out[i] += curvature[i] * field[i];
            out[n + i] += curvature[i] * field[n + i];
        }
    }
}

fn largest(field: &[f64]) -> f64 {
    field.iter().fold(0.0_f64, |most, value| most.max(value.abs()))
}
