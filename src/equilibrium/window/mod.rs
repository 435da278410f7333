//! The part of the grid that is computed: which one, with what, and how a state gets to a larger one.

pub(crate) mod fields;
pub(crate) mod growth;
pub(crate) mod placement;
pub(crate) mod region;

use std::sync::Arc;

use crate::equilibrium::{Ground, Indenter, Region, Trial};
use crate::geometry::Gap;
use crate::kernel::{LocalKernel, Workspace};
use crate::solver::{ActiveSet, Outcome, Problem, Solve, Stop};

/// Kernel, solver and gap on the region of a state: all of it follows from scene, region and indenter. It is rebuilt
/// for another region and never saved.
#[derive(Debug, Clone)]
pub(crate) struct Window {
    pub(crate) kernel: LocalKernel,
    pub(crate) work: Workspace,
    solver: Box<ActiveSet>,
    /// The gap of the indenter on the region, if that is not the whole grid.
    gap: Option<Gap>,
    /// The lowest of the gaps outside the region and its mirror images, above the datum.
    pub(crate) lowest_outside: f64,
    /// The indenter that the gap belongs to.
    indenter: Option<Arc<Indenter>>,
}

impl Window {
    pub(crate) fn new(ground: &Ground, region: &Region, indenter: &Arc<Indenter>) -> Window {
        let rows = region.rows();
        let kernel = ground.kernel.on_rows(region.grid(), region.folded(), &rows);
        let mut work = kernel.workspace();
        let solver = Box::new(ActiveSet::new(&kernel, ground.bodies, &mut work));
        let mut window = Window { work, kernel, solver, gap: None, lowest_outside: f64::INFINITY, indenter: None };
        window.follow(region, indenter);
        window
    }

    /// Brings the gap up to date with an indenter that has moved.
    pub(crate) fn follow(&mut self, region: &Region, indenter: &Arc<Indenter>) {
        if self.indenter.as_ref().is_some_and(|own| Arc::ptr_eq(own, indenter)) {
            return;
        }
        region.cut_gap(indenter.gap(), &mut self.gap);
        self.lowest_outside = region.lowest_outside(&indenter.gap().above);
        self.indenter = Some(Arc::clone(indenter));
    }

    /// The gap of the indenter on the region, which the window follows.
    pub(crate) fn gap<'a>(&'a self, indenter: &'a Indenter) -> &'a Gap {
        self.gap.as_ref().unwrap_or(indenter.gap())
    }

    /// Solves the contact problem of a step of compliance `c`, from the guess that the trial holds; `prescribed` is the
    /// maximum motion that was taken from its gap. Where c is 0, the guess is the solution.
    pub(crate) fn solve(
        &mut self,
        indenter: &Indenter,
        c: f64,
        prescribed: f64,
        stop: Stop<'_>,
        trial: &mut Trial,
    ) -> Outcome {
        let Window { kernel, work, solver, gap, .. } = self;
        let Trial { solution, gap: open, free, likely, predicted, .. } = trial;
        let owner = gap.as_ref().unwrap_or(indenter.gap()).owner.as_deref();
        let problem = Problem {
            kernel,
            compliance: c,
            gap: open,
            prescribed,
            bodies: free,
            owner,
            likely: predicted.then_some(&likely[..]),
        };
        let outcome = if c == 0.0 {
            Outcome::Converged
        } else if problem.loaded_bodies().next().is_none() {
            solution.release();
            Outcome::Converged
        } else {
            solver.solve(&mut Solve { problem: &problem, stop, solution, work })
        };
        solution.follow_surface(&problem);
        outcome
    }
}
