//! Steps as long as their error allows.

use crate::contact::computation::Computation;
use crate::contact::read::report::StepReport;
use crate::contact::run::follow::Follow;
use crate::contact::run::step_control::StepControl;
use crate::contact::settings::Settings;
use crate::contact::state::State;
use crate::contact::step::error_in_time::error_in_time;
use crate::contact::stepper::ViscoelasticContact;
use crate::error::{Error, Result};
use crate::events;

/// A step that the solver cannot do is tried again so many times, shorter.
const MAX_SOLVER_RETRIES: u32 = 5;
/// The order, in the length of a step, of the error due to cells that join in it: a shorter step ends sooner after they do.
const ORDER_OF_KINKS: u32 = 2;

impl Follow<'_> {
    /// One step as long as its error allows.
    pub(super) fn adaptive_step(&mut self, control: &mut StepControl, corner: f64) -> Result<StepReport> {
        let ViscoelasticContact { scene, computation, .. } = &*self.contact;
        let now = self.contact.time();
        control.begin(scene, &computation.state, &*self.history, self.until)?;
        let tolerance = control.solver_tolerance(scene.settings.tolerance);
        let corner = corner.min(control.first_touch(&computation.state, &*self.history, corner.min(self.until)));
        let stop = corner.min(self.until).min(self.next_stop(now));
        let (mut wasted, mut failures, mut tried) = ([0; 2], 0, f64::INFINITY);
        loop {
            let ViscoelasticContact { scene, computation, .. } = &*self.contact;
            let [wanted, reduced] = control.length(scene, &computation.state, &*self.history, self.until - now)?;
            let (order, dashpot) = order_of(&computation.state, &scene.settings);
            let (time, dt) = towards(now, stop, wanted);
            // near the resolution of the time, a shortened step may round to the same end for ever
            if time <= now || time >= tried {
                return Err(Error::StepTooShort { time: now, dt, tolerance: control.tolerance });
            }
            tried = time;
            let loads = [self.history.before(time).validated_at(time)?];
            let mut step = self.contact.request(time, dt, &loads, tolerance)?;
            let clock = &computation.state.clock;
            let straying = control.watch(&*self.history, [now, time], |time| scene.reduced_time(clock, time))?;
            let parted = computation.state.current.contact_cells == 0 && control.stays_away(&*self.history, now, time);
            if straying > control.tolerance && !parted {
                control.judge(step.interval.dt, straying, order, dashpot);
                continue;
            }
            step.interval.interpolant = scene.settings.adaptive_interpolant();
            let attempt = match self.contact.attempt(&step) {
                Err(Error::NotConverged { .. }) if failures < MAX_SOLVER_RETRIES => {
                    failures += 1;
                    control.shorten(step.interval.dt);
                    add_work(&mut wasted, &self.contact.computation);
                    continue;
                }
                other => other?,
            };
            let ViscoelasticContact { scene, computation, .. } = &*self.contact;
            let computed = attempt.computation(computation);
            let age = step.interval.reduced - computed.state.clock.undisturbed_until;
            let end = scene.reduced_time(&computation.state.clock, corner.min(self.until))?;
            let outlook = control.outlook(scene, &loads[0], [time, age, end]);
            let mut error = error_in_time(scene, computed, &step, outlook);
            // how bodies moved that stayed apart makes no difference
            if !parted || computed.state.region.is_positive_anywhere(&computed.trial.solution.pressure) {
                error.relative = error.relative.max(straying);
            }
            let by_kinks = error.by_kinks && error.relative > control.tolerance;
            let order = if by_kinks { ORDER_OF_KINKS } else { order };
            if control.judge(step.interval.dt, error.relative, order, dashpot) {
                let is_given = !computed.trial.free.iter().any(|freedom| freedom.translation);
                control.include(computed.state.history.exponential_rule(), step.interval.dt, &error, is_given);
                control.accept(step.interval.reduced, loads[0], [reduced, step.interval.dt], time == corner, order);
                let mut report = self.contact.accept(attempt, step, error);
                if time == corner {
                    self.contact.computation.state.history.forget_slopes();
                }
                report.convolutions += wasted[0];
                report.preconditioner_applications += wasted[1];
                let errors = [error.relative.max(error.lasting), error.greatest, report.residual];
                self.progress.include(errors, self.contact.mesh_error().unwrap_or_default());
                return Ok(report);
            }
            events::rejected(time, dt, error.relative, control.tolerance);
            add_work(&mut wasted, computed);
        }
    }
}

/// The order of the error of a step in its length, and whether an immediate dashpot resists it.
fn order_of(state: &State, settings: &Settings) -> (u32, bool) {
    match state.history.exponential_rule() {
        Some(rule) => (rule.order(settings.adaptive_interpolant()), rule.has_dashpot()),
        None => (1, false),
    }
}

/// Adds the convolutions and preconditioner applications of a step that was tried.
fn add_work(work: &mut [usize; 2], tried: &Computation) {
    let counts = tried.trial.solution.counts;
    *work = [work[0] + counts.convolutions, work[1] + counts.preconditioner_applications];
}

/// The end and the length of a step of about `wanted` towards `stop`: onto it if it is near, halfway if the rest
/// would be a sliver.
fn towards(now: f64, stop: f64, wanted: f64) -> (f64, f64) {
    let left = stop - now;
    if wanted >= 0.99 * left {
        (stop, left)
    } else {
        let dt = if wanted > 0.5 * left { 0.5 * left } else { wanted };
        (now + dt, now + dt - now) // the step that is really taken
    }
}
