//! The rigid motions along the surface whose forces are prescribed, in a Newton step.

use crate::friction::problem::Problem;
use crate::linalg;

/// B, restricted to what cells are free to do.
#[derive(Debug, Clone, Default)]
pub(super) struct Modes {
    fields: [Vec<f64>; 3],
    /// What the preconditioner made of them in the last step that it was asked in, if it was.
    answers: [Vec<f64>; 3],
    pub(super) are_known: bool,
    is_driven: [bool; 3],
    gram: [[f64; 3]; 3],
}

impl Modes {
    pub(super) fn resize(&mut self, n: usize) {
        self.fields.iter_mut().chain(&mut self.answers).for_each(|field| field.resize(2 * n, 0.0));
    }

    /// Fits them to a step.
    pub(super) fn fit(&mut self, problem: &Problem<'_>, restrict: impl Fn(&mut [f64])) {
        let n = problem.cells();
        self.is_driven = problem.wanted.map(|wanted| wanted.is_some());
        for k in problem.driven() {
            let field = &mut self.fields[k];
            field.fill(0.0);
            problem.touching().for_each(|i| [field[i], field[n + i]] = problem.mode(k, i));
            restrict(field);
        }
        self.gram = self.products(|a, b| inner(&self.fields[a], &self.fields[b]));
    }

    fn products(&self, of: impl Fn(usize, usize) -> f64) -> [[f64; 3]; 3] {
        let entry = |a: usize, b: usize| if self.is_driven[a] && self.is_driven[b] { of(a, b) } else { 0.0 };
        std::array::from_fn(|a| std::array::from_fn(|b| entry(a, b)))
    }

    fn driven(&self) -> impl Iterator<Item = usize> + '_ {
        (0..3).filter(|&k| self.is_driven[k])
    }

    /// Bᵀ field.
    fn along(&self, field: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|k| if self.is_driven[k] { inner(&self.fields[k], field) } else { 0.0 })
    }

    /// Takes B ν out of a field, so that it carries nothing, and returns ν.
    pub(super) fn project(&self, field: &mut [f64]) -> [f64; 3] {
        let taken = linalg::solve_normal_equations(&self.gram, self.along(field), 1e-13);
        self.driven().for_each(|k| add(field, -taken[k], &self.fields[k]));
        taken
    }

    /// Lets a field carry what is missing of the loads, like the tractions under a rigid body that moves.
    pub(super) fn meet(&mut self, gaps: [f64; 3], field: &mut [f64], mut precondition: impl FnMut(&[f64], &mut [f64])) {
        for k in (0..3).filter(|&k| self.is_driven[k]) {
            precondition(&self.fields[k], &mut self.answers[k]);
        }
        self.are_known = true;
        let carried = self.products(|a, b| inner(&self.fields[a], &self.answers[b]));
        let parts = linalg::solve_normal_equations(&carried, gaps, 1e-13);
        self.driven().for_each(|k| add(field, parts[k], &self.answers[k]));
    }

    /// What each carries at a cell.
    pub(super) fn answers_at(&self, i: usize) -> [[f64; 2]; 3] {
        let n = self.answers[0].len() / 2;
        [0, 1, 2].map(|k| if self.is_driven[k] { [self.answers[k][i], self.answers[k][n + i]] } else { [0.0; 2] })
    }

    /// The motion that takes B ν where cells take part in it for a share of the step, as the loads feel it:
    /// (Bᵀ a B) Δd = BᵀB ν.
    pub(super) fn motion(&self, entered: &[f64], wanted: [f64; 3]) -> [f64; 3] {
        let n = entered.len();
        let felt = self.products(|a, b| {
            let (one, other) = (&self.fields[a], &self.fields[b]);
            (0..n).map(|i| entered[i] * (one[i] * other[i] + one[n + i] * other[n + i])).sum()
        });
        let right = self.gram.map(|row| (0..3).map(|k| row[k] * wanted[k]).sum());
        linalg::solve_normal_equations(&felt, right, 1e-13)
    }
}

pub(super) fn inner(a: &[f64], b: &[f64]) -> f64 {
    crate::dense::product(a, b)
}

pub(super) fn add(to: &mut [f64], factor: f64, field: &[f64]) {
    to.iter_mut().zip(field).for_each(|(to, value)| *to += factor * value);
}
