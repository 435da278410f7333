//! Steps as long as their error allows.

use crate::contact::step::Attempt;
use crate::contact::step::error_in_time::error_in_time;
use crate::contact::{Step, StepReport, ViscoelasticContact};
use crate::error::{Error, ErrorKind, Result};
use crate::hereditary::{Outlook, TimeError};
use crate::load::Load;
use crate::run::Contact;
use crate::run::control::{Course, MOST_UNSOLVED};
use crate::run::halves::is_pulled_off;
use crate::run::outlook::excess;
use crate::run::passage::Span;
use crate::run::step_control::{Proposal, StepControl};
use crate::run::track::{Track, presses};
use crate::traced;

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
    let (tolerance, whole) = (control.solver_tolerance(scene), Span { now, end: course.stop });
    let touch = if state.is_undisturbed() { control.first_touch(histories, whole)? } else { f64::INFINITY };
    let (kink, stop) = (course.kink.min(touch), course.stop.min(touch));
    let mut loads = std::mem::take(&mut control.loads);
    let mut search =
        StepSearch { control, course, now, stop, tried: f64::INFINITY, dt: 0.0, failures: 0, wasted: [0; 2] };
    loop {
        let ViscoelasticContact { scene, computation, .. } = &*contact;
        let (state, control) = (&computation.state, &mut *search.control);
        let proposal = control.propose(scene, state, histories, until - now, search.stop, search.tried)?;
        let time = proposal.time;
        histories.loads(&mut loads, contact, |history, pulls| history.checked_before(time, pulls))?;
        let mut step = contact.request(time, time - now, &loads, tolerance)?;
        step.cancelled = course.cancelled;
        (search.tried, search.dt) = (time, step.interval.dt);
        let Some(deviations) = search.look(contact, proposal)? else { continue };
        let outlook = search.control.outlook(scene, state, &step, course, kink)?;
        step.interval.interpolant = scene.ground.settings.adaptive_interpolant();
        step.tolerance = search.control.solver_tolerance_before_meeting(scene, &step, &outlook);
        let mut tried = match search.compute(contact, &mut step, &outlook, deviations) {
            Ok(tried) => tried,
            Err(error) if search.may_be_shorter(&error, &outlook) => {
                search.control.shorten(search.dt);
                continue;
            }
            Err(error) => return Err(error),
        };
        let Verdict::Accepted { jumps } = search.judge(contact, proposal, &mut tried, &outlook) else { continue };
        let error = tried.error;
        let mut report = search.accept(contact, proposal, step, tried, outlook.is_last)?;
        // bodies apart do not respond to a given approach before they touch
        let apart = !loads.iter().any(Load::is_force) && report.contact_cells == 0 && time < touch;
        search.control.loads = loads;
        if jumps || outlook.is_last && !apart {
            contact.computation.state.history.reset_differences();
        }
        report.dt = time - now;
        report.convolutions += search.wasted[0];
        report.preconditioner_applications += search.wasted[1];
        return Ok((report, error));
    }
}

/// The search for a step that its error allows.
pub(super) struct StepSearch<'a> {
    pub(super) control: &'a mut StepControl,
    pub(super) course: &'a Course<'a>,
    now: f64,
    /// The latest end of the step.
    stop: f64,
    /// The end of the step that is tried, and its length in reduced time.
    tried: f64,
    dt: f64,
    /// How often the solver has failed to converge.
    failures: u32,
    /// The work of steps that do not count.
    pub(super) wasted: [usize; 2],
}

/// A step that was tried.
pub(super) struct Tried {
    pub(super) attempt: Attempt,
    pub(super) error: TimeError,
    /// By how much the error exceeds the estimate of the whole step.
    pub(super) excess: f64,
    /// The errors of its [halves](Halves): the first is the state, and the second is the attempt.
    pub(super) halves: Option<[TimeError; 2]>,
}

/// What becomes of a step that was tried.
enum Verdict {
    /// Another one is to be tried.
    TryAnother,
    /// It is taken; `jumps` if it is the shortest one that shows a jump.
    Accepted { jumps: bool },
}

impl StepSearch<'_> {
    /// By how much the loads within a step deviate from what it takes them for, of the bodies whose path matters, and of
    /// those that are apart; `None` where another step is to be tried.
    fn look(&mut self, contact: &ViscoelasticContact, proposal: Proposal) -> Result<Option<[f64; 2]>> {
        let StepSearch { control, course: Course { histories, .. }, now, tried, dt, .. } = self;
        let (scene, state) = (&contact.scene, &contact.computation.state);
        control.look(histories, Span { now: *now, end: *tried })?;
        // what happens at a top of the load within the step would not show at its end
        if let Some(top) = control.first_top(histories, |_, track| track.is_parted()) {
            self.stop = top;
            return Ok(None);
        }
        let straying = control.straying(scene, state, histories, |track| !track.is_parted())?;
        if straying > control.tolerance {
            control.accept_or_shorten(proposal, *dt, straying);
            return Ok(None);
        }
        Ok(Some([straying, control.straying(scene, state, histories, Track::is_parted)?]))
    }

    /// Tries a step, the whole of it, and in two halves where surfaces attract each other, unless the whole errs by too
    /// much. The loads deviate by `straying` from what the step takes them for, and by `apart` those of bodies that are
    /// apart at its start.
    fn compute(
        &mut self,
        contact: &mut ViscoelasticContact,
        step: &mut Step<'_>,
        outlook: &Outlook,
        [straying, apart]: [f64; 2],
    ) -> Result<Tried> {
        let StepSearch { control, wasted, .. } = self;
        let tried = contact.attempt(step);
        let ViscoelasticContact { scene, computation, .. } = &*contact;
        let attempt = tried.inspect_err(|_| computation.add_work(wasted))?;
        let computed = attempt.computation(computation);
        let mut error = error_in_time(scene, computed, step, outlook);
        computed.state.held.region.rows().intact()?;
        let meets = |(body, track): (usize, &Track)| track.is_parted() && presses(scene, computed, body);
        let meets = apart > 0.0 && control.tracks.iter().enumerate().any(meets);
        error.relative = error.relative.max(straying).max(if meets { apart } else { 0.0 });
        let excess = excess(scene, computed, step.interval.dt);
        error.relative *= excess;
        let resolved = step.interval.length > outlook.resolution;
        if !contact.attracts() || resolved && error.relative > control.tolerance {
            return Ok(Tried { attempt, error, excess, halves: None });
        }
        self.in_halves(contact, attempt, step, outlook, error, excess)
    }

    /// Whether a shorter step may succeed where this one has failed. Where the bodies separate within it, a shorter one
    /// shows when.
    fn may_be_shorter(&mut self, error: &Error, outlook: &Outlook) -> bool {
        if is_pulled_off(error) {
            return self.tried - self.now > outlook.resolution;
        }
        let is_unsolved = error.kind() == ErrorKind::Convergence;
        self.failures += u32::from(is_unsolved);
        is_unsolved && self.failures <= MOST_UNSOLVED
    }

    /// Judges a step that was tried.
    fn judge(
        &mut self,
        contact: &mut ViscoelasticContact,
        mut proposal: Proposal,
        tried: &mut Tried,
        outlook: &Outlook,
    ) -> Verdict {
        let StepSearch { control, course, wasted, .. } = self;
        let ViscoelasticContact { scene, computation, .. } = &*contact;
        let (computed, error) = (tried.attempt.computation(computation), &mut tried.error);
        let (attracts, length) = (contact.attracts(), self.tried - self.now);
        let parts = |body: usize, track: &Track| {
            track.is_driven && !track.is_apart && !attracts && !presses(scene, computed, body)
        };
        if let Some(top) = control.first_top(course.histories, parts) {
            computed.add_work(wasted);
            (self.stop, control.rejected) = (top, control.rejected + 1);
            return Verdict::TryAnother;
        }
        // a jump takes no time: shorter steps would show nothing but its moment
        let jumps = attracts && length <= outlook.resolution && error.relative > control.tolerance;
        if jumps {
            error.relative = 0.0;
        }
        if error.by_kinks && error.relative > control.tolerance || tried.excess > 1.0 {
            proposal.order = ORDER_OF_KINKS;
        }
        // the report gives the error of a step that cannot be shorter
        if control.accept_or_shorten(proposal, self.dt, error.relative)
            || proposal.unresolved && error.relative.is_finite()
        {
            return Verdict::Accepted { jumps };
        }
        traced::rejected(self.tried, length, error.relative, control.tolerance);
        control.rejected += 1;
        computed.add_work(wasted);
        if let Some(divided) = control.halves.as_ref().filter(|_| tried.halves.is_some()) {
            divided.undo(contact);
        }
        Verdict::TryAnother
    }

    fn accept(
        &mut self,
        contact: &mut ViscoelasticContact,
        proposal: Proposal,
        step: Step<'_>,
        tried: Tried,
        is_last: bool,
    ) -> Result<StepReport> {
        let Tried { attempt, error, halves, .. } = tried;
        let computed = attempt.computation(&contact.computation);
        let (rule, given) = (computed.state.history.rule(), !computed.trial.free.iter().any(|free| free.translation));
        let (errors, length) =
            halves.as_ref().map_or((std::slice::from_ref(&error), self.dt), |both| (both, 0.5 * self.dt));
        // by the weights of this step, which those of the parts of a jump replace
        errors.iter().for_each(|error| self.control.past.include(rule, length, error, given));
        let (reduced, loads) = (step.interval.reduced, step.loads);
        let report = contact.accept(attempt, step, error)?;
        self.control.accept(reduced, loads, self.dt, is_last, proposal);
        Ok(report)
    }
}
