//! The cells in contact, listed by body, and the fit of the free motions on them.

use crate::solver::outcome::ResidualSums;
use crate::solver::problem::{Problem, Solution};
use crate::solver::rigid_motion::{Gram, ModeCoefficients, Modes};

/// The cells of one body that are in contact, and the products of its free modes over them.
#[derive(Debug, Clone)]
pub(crate) struct ContactCells {
    pub(crate) cells: Vec<u32>,
    pub(crate) gram: Gram,
}

impl ContactCells {
    /// Lists for `bodies` bodies, each with memory for all cells of a grid.
    pub(crate) fn of_bodies(bodies: usize, grid_cells: usize) -> Vec<ContactCells> {
        // cloned vectors would not keep their capacity
        (0..bodies).map(|_| ContactCells { cells: Vec::with_capacity(grid_cells), gram: Gram::default() }).collect()
    }

    /// Keeps only the cells with positive pressure.
    pub(crate) fn keep_pressed(&mut self, modes: Modes<'_>, pressure: &[f64]) {
        self.cells.retain(|&k| pressure[k as usize] > 0.0);
        self.gram = modes.gram(&self.cells);
    }
}

/// Lists `cells` by the body that they belong to.
pub(crate) fn list(problem: &Problem<'_>, contacts: &mut [ContactCells], cells: impl Iterator<Item = usize>) {
    contacts.iter_mut().for_each(|contact| contact.cells.clear());
    cells.for_each(|k| contacts[problem.owner(k)].cells.push(k as u32));
    for (body, contact) in contacts.iter_mut().enumerate() {
        contact.gram = problem.modes(body).gram(&contact.cells);
    }
}

/// The cells in contact under any body.
pub(crate) fn all(contacts: &[ContactCells]) -> impl Iterator<Item = usize> {
    contacts.iter().flat_map(|contact| &contact.cells).map(|&k| k as usize)
}

/// Sets the free motion of each body to the best fit on its cells in contact, and `residual` to −h there.
pub(crate) fn fit_motions(
    problem: &Problem<'_>,
    contacts: &[ContactCells],
    solution: &mut Solution,
    residual: &mut [f64],
) -> ResidualSums {
    let mut sums = ResidualSums::default();
    // where no cell tells how a body moves, its motion remains
    for (body, contact) in contacts.iter().enumerate().filter(|(_, contact)| !contact.cells.is_empty()) {
        // The fit is that of a change of the last motion: what the cells at hand do not determine remains as it was, and
        // the sums are of small numbers, so that they do not round by more than the tolerance.
        let (c, modes, last) = (problem.compliance, problem.modes(body), solution.motions[body]);
        for k in contact.cells.iter().map(|&k| k as usize) {
            let u = c * solution.potential[k];
            residual[k] = modes.displacement(last, k) - (u + problem.gap[k]);
            sums.displacement += u * u;
            sums.greatest_gap = sums.greatest_gap.max(problem.gap[k].abs());
            sums.negative += solution.pressure[k].min(0.0).powi(2);
        }
        let change = modes.project_out(&contact.gram, &contact.cells, residual);
        solution.motions[body] = ModeCoefficients([0, 1, 2].map(|m| last.0[m] - change.0[m]));
        sums.square += contact.cells.iter().map(|&k| residual[k as usize].powi(2)).sum::<f64>();
        sums.cells += contact.cells.len();
    }
    sums
}
