//! A state carried to another region.

use crate::contact::indenter::Indenter;
use crate::contact::scene::Scene;
use crate::contact::state::{Equilibrium, State};
use crate::contact::window::region::Region;
use crate::contact::window::window::Window;
use crate::hereditary::Transfer;
use crate::kernel::{LocalKernel, Workspace};
use crate::solver::Solution;

/// Carries fields from one region to another. What is not known there is the convolution of a source: with u = K U, all
/// that the displacement depends on transfers with U.
struct Carry<'a> {
    from: &'a Region,
    to: &'a Region,
    kernel: &'a LocalKernel,
    work: &'a mut Workspace,
}

impl Transfer for Carry<'_> {
    fn cells(&self) -> [usize; 2] {
        self.to.cells()
    }

    fn covers(&self) -> bool {
        self.to.covers()
    }

    fn confined(&self, own: &[f64]) -> Vec<f64> {
        self.from.carry(own, self.to, |_| 0.0)
    }

    fn induced(&mut self, own: &[f64], source: Option<&[f64]>) -> Vec<f64> {
        let mut far = vec![0.0; self.to.len()];
        // nothing is unknown where the images of a region cover the grid
        let source = source.filter(|source| !self.from.covers() && source.iter().any(|&s| s != 0.0));
        if let Some(source) = source {
            self.kernel.apply(&self.confined(source), &mut far, self.work);
        }
        self.from.carry(own, self.to, |k| far[k])
    }
}

/// A copy of the state on another region, and the window that computes there under `indenter`. The state itself stays what
/// it is.
pub(in crate::contact) fn carried(
    scene: &Scene,
    state: &mut State,
    region: Region,
    indenter: &Indenter,
) -> (State, Window) {
    let mut window = Window::new(scene, &region, indenter);
    let (kernel, work) = window.kernel_and_work();
    let mut carry = Carry { from: &state.region, to: &region, kernel, work };
    let history = state.history.carried(&mut carry);
    let [current, previous] = [&state.current, &state.previous].map(|old| {
        let Solution { pressure, potential, motions, .. } = &old.solution;
        let solution = Solution {
            potential: carry.induced(potential, Some(pressure)),
            pressure: carry.confined(pressure),
            motions: motions.clone(),
            ..old.solution
        };
        let sum = region.rows().sum(&solution.pressure);
        Equilibrium { solution, motions: old.motions.clone(), contact_cells: old.contact_cells, sum }
    });
    let carried = State {
        loads: state.loads.clone(),
        start: state.start.clone(),
        indenter: state.indenter.clone(),
        region,
        history,
        current,
        previous,
        ..*state
    };
    (carried, window)
}
