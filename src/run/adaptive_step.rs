//! Steps as long as their error allows.

use crate::contact::step::Attempt;
use crate::contact::step::error_in_time::error_in_time;
use crate::contact::{Step, StepReport, ViscoelasticContact};
use crate::error::{AdhesionError, Error, Result, StepError};
use crate::events;
use crate::hereditary::{StepContext, TimeError, WEIGHTS};
use crate::load::Load;
use crate::run::control::Course;
use crate::run::halves::{Divided, Halves, add_work, greater};
use crate::run::outlook::excess;
use crate::run::passage::Span;
use crate::run::step_control::{Proposal, StepControl};
use crate::run::track::{Track, presses};

/// Number of shorter attempts after the solver has failed to converge.
const MAX_SOLVER_RETRIES: u32 = 5;
/// Order in the step length of the error due to cells that join the contact within the step: a shorter step ends sooner
/// after they join.
const ORDER_OF_KINKS: u32 = 2;

/// Takes one step as long as its error allows: proposes a length, checks the load within the step, tries the step,
/// judges its error, and accepts it or tries a shorter one.
pub(super) fn adaptive_step(
    contact: &mut ViscoelasticContact,
    control: &mut StepControl,
    course: &Course<'_>,
) -> Result<(StepReport, TimeError)> {
    let Course { histories, until, .. } = *course;
    let ViscoelasticContact { scene, computation, .. } = &*contact;
    let (state, now) = (&computation.state, computation.state.clock.time);
    control.begin(scene, state, histories, until)?;
    let tolerance = control.solver_tolerance(scene);
    let before = Span { now, end: course.stop };
    let touch = if state.is_undisturbed() { control.first_touch(histories, before)? } else { f64::INFINITY };
    let (kink, mut stop) = (course.kink.min(touch), course.stop.min(touch));
    let mut loads = std::mem::take(&mut control.loads);
    let (mut wasted, mut failures, mut tried) = ([0; 2], 0, f64::INFINITY);
    loop {
        let ViscoelasticContact { scene, computation, .. } = &*contact;
        let state = &computation.state;
        let mut proposal = control.propose(scene, state, histories, until - now, stop, tried)?;
        let Proposal { time, unresolved, .. } = proposal;
        tried = time;
        histories.loads(&mut loads, |history| history.checked_before(time, scene.ground.attraction.is_some()))?;
        let mut step = contact.request(time, time - now, &loads, tolerance)?;
        step.cancelled = course.cancelled;
        let dt = step.interval.dt;
        control.look(histories, Span { now, end: time })?;
        // what happens at a top of the load within the step would not show at its end
        if let Some(top) = control.first_top(histories, |_, track| track.is_parted()) {
            stop = top;
            continue;
        }
        let straying = control.straying(scene, state, histories, |track| !track.is_parted())?;
        if straying > control.tolerance {
            control.judge(proposal, dt, straying);
            continue;
        }
        // the path of bodies that stay apart does not matter
        let apart = control.straying(scene, state, histories, Track::is_parted)?;
        let outlook = control.outlook(scene, state, &step, course, kink)?;
        step.interval.interpolant = scene.ground.settings.adaptive_interpolant();
        step.tolerance = control.solver_tolerance_before_meeting(scene, &step, &outlook);
        let Tried { attempt, mut error, excess, halves } =
            match try_step(contact, control, &mut step, (course, &outlook), [straying, apart], &mut wasted) {
                Ok(tried) => tried,
                Err(error) => {
                    let unsolved = matches!(
                        error,
                        Error::Step(StepError::NotConverged { .. })
                            | Error::Adhesion(AdhesionError::NotConverged { .. } | AdhesionError::FillsGrid { .. })
                    );
                    // where the bodies separate within the step, a shorter one shows when
                    let separates = matches!(error, Error::Adhesion(AdhesionError::PulledOff { .. }));
                    failures += u32::from(unsolved);
                    if !(unsolved && failures <= MAX_SOLVER_RETRIES || separates && time - now > outlook.resolution) {
                        return Err(error);
                    }
                    control.shorten(dt);
                    continue;
                }
            };
        let computed = attempt.computation(&contact.computation);
        let parts = |body: usize, track: &Track| {
            track.is_driven && !track.is_apart && !computed.state.attracts && !presses(&contact.scene, computed, body)
        };
        if let Some(top) = control.first_top(histories, parts) {
            add_work(&mut wasted, computed);
            (stop, control.rejected) = (top, control.rejected + 1);
            continue;
        }
        // a jump takes no time: shorter steps would show nothing but its moment
        let jumps = contact.scene.ground.attraction.is_some()
            && time - now <= outlook.resolution
            && error.relative > control.tolerance;
        if jumps {
            error.relative = 0.0;
        }
        if error.by_kinks && error.relative > control.tolerance || excess > 1.0 {
            proposal.order = ORDER_OF_KINKS;
        }
        // the report gives the error of a step that cannot be shorter
        let unresolved = unresolved && error.relative.is_finite();
        if !control.judge(proposal, dt, error.relative) && !unresolved {
            events::rejected(time, time - now, error.relative, control.tolerance);
            control.rejected += 1;
            add_work(&mut wasted, computed);
            if let Some(divided) = control.halves.as_ref().filter(|_| halves.is_some()) {
                divided.undo(contact);
            }
            continue;
        }
        let motion_is_given = !computed.trial.free.iter().any(|freedom| freedom.translation);
        let rule = computed.state.history.rule();
        match &halves {
            Some(errors) => {
                errors.iter().for_each(|error| control.past.include(rule, 0.5 * dt, error, motion_is_given))
            }
            None => control.past.include(rule, dt, &error, motion_is_given),
        }
        control.accept(step.interval.reduced, &loads, dt, outlook.is_last, proposal);
        let mut report = contact.accept(attempt, step, error)?;
        if halves.is_some() {
            report.dt = time - now;
        }
        // bodies apart do not respond to a given approach before they touch
        let apart = !loads.iter().any(Load::is_force) && report.contact_cells == 0 && time < touch;
        control.loads = loads;
        if jumps || outlook.is_last && !apart {
            contact.computation.state.history.reset_differences();
        }
        report.convolutions += wasted[0];
        report.preconditioner_applications += wasted[1];
        return Ok((report, error));
    }
}

/// A step that was tried.
struct Tried {
    attempt: Attempt,
    error: TimeError,
    /// By how much the error exceeds the estimate of the whole step.
    excess: f64,
    /// The errors of its [halves](Halves): the first is the state, and the second is the attempt.
    halves: Option<[TimeError; 2]>,
}

/// Tries a step, the whole of it, and in two halves where surfaces attract each other, unless the whole errs by too
/// much. The loads deviate by `straying` from what the step takes them for, and by `apart` those of bodies that are
/// apart at its start.
fn try_step(
    contact: &mut ViscoelasticContact,
    control: &mut StepControl,
    step: &mut Step<'_>,
    (course, outlook): (&Course<'_>, &StepContext),
    [straying, apart]: [f64; 2],
    wasted: &mut [usize; 2],
) -> Result<Tried> {
    let tried = contact.attempt(step);
    let ViscoelasticContact { scene, computation, .. } = &*contact;
    let attempt = tried.inspect_err(|_| add_work(wasted, computation))?;
    let computed = attempt.computation(computation);
    let mut error = error_in_time(scene, computed, step, outlook);
    computed.state.held.region.rows().intact()?;
    let meets = |(body, track): (usize, &Track)| track.is_parted() && presses(scene, computed, body);
    let meets = apart > 0.0 && control.tracks.iter().enumerate().any(meets);
    error.relative = error.relative.max(straying).max(if meets { apart } else { 0.0 });
    let excess = excess(scene, computed, step.interval.dt);
    error.relative *= excess;
    let resolved = step.interval.length > outlook.resolution;
    if scene.ground.attraction.is_none() || resolved && error.relative > control.tolerance {
        return Ok(Tried { attempt, error, excess, halves: None });
    }
    let mut halves = control.halves.take().unwrap_or_else(|| Box::new(Halves::new(&contact.computation.state)));
    let divided = halves.divide(contact, step, course.histories.first(), outlook, wasted);
    if divided.is_err() {
        add_work(wasted, &contact.computation);
        halves.undo(contact);
    }
    control.halves = Some(halves);
    let Divided { attempt, difference, errors } = divided?;
    let jumped = contact.passes().is_some_and(|passes| passes.jumped);
    error.relative = greater(error.relative, difference) * if jumped { WEIGHTS.jumped } else { 1.0 };
    Ok(Tried { attempt, error, excess, halves: Some(errors) })
}
