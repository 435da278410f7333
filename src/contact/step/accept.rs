//! Acceptance of a computed step, and its warnings.

use std::sync::Arc;

use crate::contact::read::limits::LONG_STEP;
use crate::contact::{Computation, Scene, Step};
use crate::equilibrium::{Figures, Warnings};
use crate::extent::Extent;

impl Computation {
    /// Makes the trial the state; `sum` is Σ p less the attraction, `contact_cells` is the number of pressed cells of the region, and
    /// `sizes` are the means of displacement and v in contact.
    pub(super) fn accept(&mut self, step: Step<'_>, sum: f64, contact_cells: usize, sizes: [f64; 2]) {
        let Computation { state, trial, .. } = self;
        let interval = step.interval;
        let touched = !state.is_undisturbed() || contact_cells > 0 || state.attracts;
        state.history.commit(interval);
        if !Arc::ptr_eq(&step.indenter, &state.held.indenter) {
            // where the indenter was within the step is not known
            state.history.forget_start();
        }

        state.keep_start(interval.interpolant);
        std::mem::swap(&mut state.previous, &mut state.held.current);
        state.held.take(trial, step.request(), sum, contact_cells);
        state.indenter_is_new = false;
        // the extrapolation watches the pressure of the wall: with attraction the sum may vanish
        let pressed =
            if state.attracts { state.held.region.rows().sum(&state.held.current.solution.pressure) } else { sum };
        state.held.extrapolation.accept(interval.dt, pressed, trial.reach);
        (0..2).for_each(|which| state.greatest[which] = state.greatest[which].max(sizes[which]));
        state.clock.accept(interval, touched);
    }
}

/// The warnings of the step accepted last, with all pressed cells in `reach`.
pub(super) fn collect_warnings(
    scene: &Scene,
    computation: &Computation,
    reach: Option<Extent>,
    figures: &Figures,
    time_error: Option<f64>,
) -> Warnings {
    let Computation { state, attracted, .. } = computation;
    let dt = state.clock.last_dt;
    let of_material =
        if state.is_undisturbed() { Warnings::empty() } else { scene.limits.warnings(state.clock.age(), dt) };
    let reasons = [
        (Warnings::COARSE_ZONE, figures.cells_in_zone.is_some()),
        (Warnings::BEYOND_EDGE, figures.beyond_edge.is_some()),
        (Warnings::LONG_STEP, time_error > Some(LONG_STEP)),
        (Warnings::JUMP, attracted.as_ref().is_some_and(|own| own.jumped())),
    ];
    of_material | state.held.warnings(&scene.ground, reach, figures) | Warnings::of(&reasons)
}
