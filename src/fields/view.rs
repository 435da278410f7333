//! The fields of a contact on the whole grid, or on the local rows of a rank.

use std::sync::OnceLock;

use crate::equilibrium::{Ground, Held, Region};

/// The displacement of a contact on the region that is computed, and of the rest of the grid the source of which it
/// is the convolution, with its factor; none where it is zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface<'a> {
    pub(crate) own: &'a [f64],
    pub(crate) far: Option<(f64, &'a [f64])>,
}

/// Pressure and displacement on the whole grid, where only a region is computed; on the local rows, where ranks share
/// them out.
#[derive(Debug, Clone, Default)]
pub(crate) struct View {
    pressure: Vec<f64>,
    /// Computed at the first call.
    displacement: OnceLock<Vec<f64>>,
}

impl View {
    /// Updates the fields to what is `held`.
    pub(crate) fn refresh(&mut self, held: &Held) {
        let Held { region, current, .. } = held;
        self.displacement.take();
        if region.is_shown() {
            self.pressure = Vec::new();
        } else {
            self.pressure.clear();
            self.pressure.resize(region.shown_len(), 0.0);
            region.show(&current.solution.pressure, &mut self.pressure);
        }
    }

    pub(super) fn pressure<'a>(&'a self, held: &'a Held) -> &'a [f64] {
        if held.region.is_shown() { &held.current.solution.pressure } else { &self.pressure }
    }

    pub(super) fn displacement<'a>(&'a self, ground: &Ground, region: &Region, surface: Surface<'a>) -> &'a [f64] {
        let whole = || self.displacement.get_or_init(|| on_the_whole_grid(ground, region, surface));
        if region.is_shown() { surface.own } else { whole() }
    }

    pub(super) fn has_displacement(&self) -> bool {
        self.displacement.get().is_some()
    }
}

/// The displacement on the whole grid.
fn on_the_whole_grid(ground: &Ground, region: &Region, surface: Surface<'_>) -> Vec<f64> {
    let mut whole = vec![0.0; region.shown_len()];
    if let Some((factor, source)) = surface.far {
        let all = Region::whole(&ground.grid, region.folded());
        let kernel = ground.kernel.on(all.grid(), all.folded());
        let mut far = vec![0.0; all.len()];
        kernel.apply(&region.transfer(source, &all, |_| 0.0), &mut far, &mut kernel.workspace());
        far.iter_mut().for_each(|u| *u *= factor);
        all.show(&far, &mut whole);
    }
    region.show(surface.own, &mut whole);
    whole
}
