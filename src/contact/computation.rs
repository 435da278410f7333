//! A state on its region, with what computes there.

use std::sync::Arc;

use crate::contact::step::attraction::Attracted;
use crate::contact::{Scene, State};
use crate::equilibrium::pressed::Pressed;
use crate::equilibrium::window::fields::transfer_by_role;
use crate::equilibrium::{Indenter, Region, Trial, Window};
use crate::error::Result;

/// State, window and trial of one computation. A step that needs a larger region continues in a copy, which the
/// contact takes over if the step is accepted.
#[derive(Debug, Clone)]
pub(crate) struct Computation {
    pub(crate) state: State,
    pub(crate) window: Window,
    pub(crate) trial: Trial,
    /// What steps of surfaces that attract each other work in, from the first one on.
    pub(crate) attracted: Option<Box<Attracted>>,
}

impl Computation {
    pub(crate) fn new(scene: &Scene, state: State) -> Computation {
        let window = Window::new(&scene.ground, &state.held.region, &state.held.indenter);
        let trial = Trial::new(state.held.region.len(), scene.ground.bodies);
        Computation { trial, window, state, attracted: None }
    }

    /// A copy on another region, for a step under `indenter`. This state keeps its values and loses the start of its
    /// last step.
    ///
    /// # Errors
    /// If there is no memory for both.
    pub(crate) fn transferred_to(
        &mut self,
        scene: &Scene,
        region: Region,
        indenter: &Arc<Indenter>,
    ) -> Result<Box<Computation>> {
        self.check_memory_for(scene, &region)?;
        let mut window = Window::new(&scene.ground, &region, indenter);
        self.state.history.apply_pending_step();
        let mut transfer = transfer_by_role(&self.state.held.region, &region, &mut window);
        let mut state = self.state.map(&region, &mut transfer);
        drop(transfer);
        state.sum_up();
        let trial = Trial::new(region.len(), scene.ground.bodies);
        Ok(Box::new(Computation { state, window, trial, attracted: None }))
    }

    /// Adds the convolutions and preconditioner applications of a trial that does not count.
    pub(crate) fn add_work(&self, work: &mut [usize; 2]) {
        let counts = self.trial.solution.counts;
        *work = [work[0] + counts.convolutions, work[1] + counts.preconditioner_applications];
    }

    /// Where the trial presses. A call of all ranks.
    pub(crate) fn pressed(&self, scene: &Scene) -> Pressed {
        let Computation { state: State { held, .. }, trial, .. } = self;
        Pressed::by(&trial.solution.pressure, &scene.ground, &held.region, &held.indenter)
    }

    /// Rejects a region for which there is no memory beside this one.
    pub(crate) fn check_memory_for(&self, scene: &Scene, region: &Region) -> Result<()> {
        let history = &self.state.history;
        scene.check_memory(history, region, scene.memory_on(history, &self.state.held.region).total())
    }

    /// Goes to another state, without reallocating where the regions are the same.
    pub(crate) fn restore(&mut self, scene: &Scene, state: &State) {
        if self.state.held.region == state.held.region {
            self.state.clone_from(state);
        } else {
            *self = Computation::new(scene, state.clone());
        }
    }
}
