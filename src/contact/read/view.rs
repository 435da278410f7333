//! The fields of a contact on the whole grid, or own rows of it, for the accessors.

use std::borrow::Cow;
use std::sync::OnceLock;

use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::contact::window::region::Region;

/// Pressure and displacement on the whole grid, where not all of it is computed; on own rows, where ranks share them out.
#[derive(Debug, Clone)]
pub(crate) struct View {
    pressure: Vec<f64>,
    /// The region that the pressure is of: elsewhere it is zero.
    region: Region,
    /// Computed at the first call.
    displacement: OnceLock<Vec<f64>>,
}

impl View {
    pub(in crate::contact) fn new(state: &State) -> View {
        let mut view = View { pressure: Vec::new(), region: state.region.clone(), displacement: OnceLock::new() };
        view.refresh(state);
        view
    }

    /// Follows the state.
    pub(in crate::contact) fn refresh(&mut self, state: &State) {
        self.displacement.take();
        if self.region != state.region {
            self.region = state.region.clone();
            // what lies outside a smaller region is of the larger one
            self.pressure.fill(0.0);
        }
        if state.region.is_shown() {
            self.pressure = Vec::new();
        } else {
            self.pressure.resize(state.region.shown_len(), 0.0);
            state.region.show(&state.current.solution.pressure, &mut self.pressure);
        }
    }

    pub(in crate::contact) fn pressure<'a>(&'a self, state: &'a State) -> &'a [f64] {
        if state.region.is_shown() { &state.current.solution.pressure } else { &self.pressure }
    }

    pub(in crate::contact) fn displacement<'a>(&'a self, scene: &Scene, state: &'a State) -> &'a [f64] {
        let own = state.history.displacement();
        if state.region.is_shown() {
            return own;
        }
        let whole = || on_the_whole_grid(scene, &state.region, own, state.history.far_source()).into_owned();
        self.displacement.get_or_init(whole)
    }

    /// Whether the displacement has been computed, or needs not be.
    pub(in crate::contact) fn has_displacement(&self, state: &State) -> bool {
        state.region.is_shown() || state.region.is_shared() || self.displacement.get().is_some()
    }
}

/// A field on the cells that are shown from one of a region. Elsewhere it is the convolution of a source, or zero if there is none.
pub(in crate::contact) fn on_the_whole_grid<'a>(
    scene: &Scene,
    region: &Region,
    own: &'a [f64],
    source: Option<&[f64]>,
) -> Cow<'a, [f64]> {
    if region.is_shown() {
        return Cow::Borrowed(own);
    }
    let mut whole = vec![0.0; region.shown_len()];
    if let Some(source) = source {
        let all = Region::whole(&scene.grid, region.folded());
        let kernel = scene.kernel.on(all.grid(), all.folded());
        let mut far = vec![0.0; all.len()];
        kernel.apply(&region.carry(source, &all, |_| 0.0), &mut far, &mut kernel.workspace());
        all.spread(&far, &mut whole);
    }
    region.show(own, &mut whole);
    Cow::Owned(whole)
}
