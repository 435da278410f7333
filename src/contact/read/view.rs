//! The fields of a contact on the whole grid, or on the local rows of a rank.

use std::sync::OnceLock;

use crate::contact::{Region, Scene, State};

/// Pressure and displacement on the whole grid, where only a region is computed; on the local rows, where ranks share
/// them out.
#[derive(Debug, Clone, Default)]
pub(crate) struct View {
    pressure: Vec<f64>,
    /// Computed at the first call.
    pub(super) displacement: OnceLock<Vec<f64>>,
}

impl View {
    /// Updates the fields to `state`.
    pub(in crate::contact) fn refresh(&mut self, state: &State) {
        self.displacement.take();
        if state.region.is_shown() {
            self.pressure = Vec::new();
        } else {
            self.pressure.clear();
            self.pressure.resize(state.region.shown_len(), 0.0);
            state.region.show(&state.current.solution.pressure, &mut self.pressure);
        }
    }

    pub(in crate::contact) fn pressure<'a>(&'a self, state: &'a State) -> &'a [f64] {
        if state.region.is_shown() { &state.current.solution.pressure } else { &self.pressure }
    }

    pub(in crate::contact) fn displacement<'a>(&'a self, scene: &Scene, state: &'a State) -> &'a [f64] {
        let own = state.history.displacement();
        if state.region.is_shown() { own } else { self.displacement.get_or_init(|| on_the_whole_grid(scene, state)) }
    }
}

/// The displacement on the whole grid. Outside the region it is the convolution of the source of the far field, or zero without
/// a source.
fn on_the_whole_grid(scene: &Scene, State { region, history, .. }: &State) -> Vec<f64> {
    let mut whole = vec![0.0; region.shown_len()];
    if let Some(source) = history.far_source() {
        let all = Region::whole(&scene.grid, region.folded());
        let kernel = scene.kernel.on(all.grid(), all.folded());
        let mut far = vec![0.0; all.len()];
        kernel.apply(&region.transfer(source, &all, |_| 0.0), &mut far, &mut kernel.workspace());
        all.show(&far, &mut whole);
    }
    region.show(history.displacement(), &mut whole);
    whole
}
