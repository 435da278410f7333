//! The fields of a contact on the whole grid, or on the local rows of a rank.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use crate::equilibrium::{Ground, Held, Region};

/// The displacement of a contact on the region that is computed, and of the rest of the grid the source of which it
/// is the convolution, with its factor; none where it is zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface<'a> {
    pub(crate) own: &'a [f64],
    pub(crate) far: Option<(f64, &'a [f64])>,
}

/// Pressure and displacement on the whole grid, where only a region is computed; on the local rows, where ranks share
/// them out. Computed at the first call after a step.
#[derive(Debug, Default)]
pub(crate) struct View {
    pressure: OnceLock<Vec<f64>>,
    /// Room for the pressure.
    room: Mutex<Vec<f64>>,
    displacement: OnceLock<Vec<f64>>,
}

impl Clone for View {
    fn clone(&self) -> View {
        let room = Mutex::new(Vec::with_capacity(self.room().capacity()));
        View { pressure: self.pressure.clone(), room, displacement: self.displacement.clone() }
    }
}

impl View {
    fn room(&self) -> MutexGuard<'_, Vec<f64>> {
        self.room.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Drops the fields of what was `held` before.
    pub(crate) fn refresh(&mut self, held: &Held) {
        self.displacement.take();
        let room = self.room.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(last) = self.pressure.take() {
            *room = last;
        }
        room.clear();
        if held.region.is_shown() {
            *room = Vec::new();
        } else {
            room.reserve_exact(held.region.shown_len());
        }
    }

    pub(super) fn pressure<'a>(&'a self, held: &'a Held) -> &'a [f64] {
        let Held { region, current, .. } = held;
        let whole = || {
            let mut whole = std::mem::take(&mut *self.room());
            whole.resize(region.shown_len(), 0.0);
            region.show(&current.solution.pressure, &mut whole);
            whole
        };
        if region.is_shown() { &current.solution.pressure } else { self.pressure.get_or_init(whole) }
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
