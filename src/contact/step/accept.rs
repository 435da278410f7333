//! A step that was computed becomes the state.

use crate::contact::computation::Computation;
use crate::contact::step::request::Step;
use crate::solver::RigidMotion;

impl Computation {
    /// Makes the trial the state; `sum` is Σ p, and `sizes` are the means of displacement and v in
    /// contact.
    pub(super) fn accept(&mut self, step: Step<'_>, sum: f64, sizes: [f64; 2]) {
        let Computation { state, trial, .. } = self;
        let (interval, datum) = (step.interval, step.indenter.gap().datum);
        let pressed = trial.solution.pressure.iter().filter(|&&p| p > 0.0).count();
        let contact_cells = state.region.rows().count(pressed);
        let touched = !state.is_undisturbed() || contact_cells > 0;
        let (before, after) = (&state.current.solution, &trial.solution);
        let pressed = [[&before.pressure[..], &after.pressure], [&before.potential, &after.potential]];
        state.history.commit(interval, pressed, touched);
        if step.indenter.id() != state.indenter.id() {
            // where the indenter was within the step is not known
            state.history.forget_start();
        }

        state.keep_start(interval.interpolant);
        std::mem::swap(&mut state.previous, &mut state.current);
        std::mem::swap(&mut state.current.solution, &mut trial.solution);
        (state.current.contact_cells, state.current.sum) = (state.region.images() * contact_cells, sum);
        for body in 0..step.loads.len() {
            let modes = state.region.modes(trial.free[body]);
            let free = modes.physical(state.current.solution.motions[body]);
            let RigidMotion { approach, tilt } = step.prescribed(body);
            state.current.motions[body] = RigidMotion { approach: datum + approach, tilt } + free;
        }
        state.loads.copy_from_slice(step.loads);
        (state.indenter, state.indenter_is_new) = (step.indenter, false);
        state.extrapolation.accept(interval.dt, sum, trial.reach);
        (0..2).for_each(|which| state.greatest[which] = state.greatest[which].max(sizes[which]));
        state.clock.accept(interval, touched);
    }
}
