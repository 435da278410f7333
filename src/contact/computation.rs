//! A state on its region, with what computes there.

use std::sync::Arc;

use crate::contact::window::fields::transferred;
use crate::contact::{Indenter, Region, Scene, State, Trial, Window};
use crate::error::Result;

/// State, window and trial of one computation. A step that needs a larger region continues in a copy, which the
/// contact takes over if the step is accepted.
#[derive(Debug, Clone)]
pub(crate) struct Computation {
    pub(crate) state: State,
    pub(crate) window: Window,
    pub(crate) trial: Trial,
}

impl Computation {
    pub(crate) fn new(scene: &Scene, state: State) -> Computation {
        let window = Window::new(scene, &state.region, &state.indenter);
        Computation { trial: Trial::new(state.region.len(), scene.bodies), window, state }
    }

    /// A copy on another region, for a step under `indenter`. This state keeps its values and loses the start of its last step.
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
        let cells = region.len();
        let (state, window) = transferred(scene, &mut self.state, region, indenter);
        Ok(Box::new(Computation { state, window, trial: Trial::new(cells, scene.bodies) }))
    }

    /// Rejects a region for which there is no memory beside this one.
    pub(crate) fn check_memory_for(&self, scene: &Scene, region: &Region) -> Result<()> {
        let history = &self.state.history;
        scene.check_memory(history, region, scene.memory_on(history, &self.state.region).total())
    }

    /// Goes to another state, without reallocating where the regions are the same.
    pub(crate) fn restore(&mut self, scene: &Scene, state: &State) {
        if self.state.region == state.region {
            self.state.clone_from(state);
        } else {
            *self = Computation::new(scene, state.clone());
        }
    }
}
