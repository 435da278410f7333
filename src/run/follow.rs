//! Drives a contact along a load history.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::ascending::{Schedule, Times};
use crate::contact::{StepReport, ViscoelasticContact, Warnings};
use crate::error::{Error, Result, within};
use crate::load::{Load, LoadHistory};
#[cfg(feature = "checkpoint")]
use crate::run::autosave::Autosave;
use crate::run::control::{Control, Course};
use crate::run::error_budget::ErrorBudget;
use crate::run::event::Event;
use crate::run::fields::RunFields;
use crate::run::histories::{Histories, RunHistory};
use crate::run::progress::{Progress, RunProgress, Stepping, rounding};
use crate::run::{Contact, OwnedOrBorrowed};

/// Times up to here count as the `time` at which a step ended.
fn covered_by(time: f64) -> f64 {
    time + rounding(time)
}

/// A time beyond an end of the run by no more than this part of itself counts as that end: users compute times, as
/// 10³ from powers of ten, with rounding.
const ROUNDING_OF_GIVEN: f64 = 1e-12;

/// A run along a load history, made by [`Contact::follow`]. Each call of [`Run::next_step`] takes
/// one step.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(KelvinVoigt::with_time(1.0e6, 1.0)?))
///     .build()?;
/// let ramp = Ramp::new(Load::force(0.0), Load::force(0.5), 1.0)?;
/// let mut run = contact.follow(&ramp, Stepping::fixed(0.25), 2.0);
/// let mut steps = 0;
/// while let Some(report) = run.next_step()? {
///     steps += 1;
///     assert_eq!(report.time, 0.25 * steps as f64);
///     assert!(run.contact().contact_cells() > 0);
/// }
/// assert_eq!(steps, 8);
/// # Ok::<(), viscocontact::Error>(())
/// ```
///
/// With [`Stepping::adaptive`] the step length follows the creep, here over nine decades of time.
/// [`Run::within_step`] gives the state between the ends of a step:
///
/// ```
/// # use viscocontact::prelude::*;
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(GeneralizedKelvin::new(1.0e-6, 0.0, &[(1.0e-6, 1.0e-3), (1.0e-6, 1.0e3)])?))
///     .build()?;
/// let load = StepLoad::new(Load::force(0.5))?;
/// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-3), 1.0e5);
/// let mut steps = 0;
/// while let Some(report) = run.next_step()? {
///     assert!(report.time_error <= Some(1.0e-3));
///     steps += 1;
/// }
/// assert!(steps < 60);
/// println!("{}", run.error_budget());
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug)]
#[must_use = "a run takes no step until next_step is called"]
pub struct Run<'a, C: Contact = ViscoelasticContact> {
    pub(super) contact: OwnedOrBorrowed<&'a mut C, Box<C>>,
    pub(super) histories: Histories<'a>,
    /// The loads at the end of the next step, or now.
    loads: Vec<Load>,
    pub(super) stepping: Stepping,
    pub(super) until: f64,
    pub(super) progress: Progress,
    pub(super) control: Box<dyn Control<C>>,
    /// Times at which steps end, and at which states within steps are sampled.
    pub(super) stops: Schedule,
    pub(super) sampled: Schedule,
    /// Quantities whose crossings end steps.
    pub(super) events: Vec<Event<C>>,
    /// Set by another thread to end the step under way.
    pub(super) cancelled: Option<Arc<AtomicBool>>,
    /// Start and report of the last step of this run.
    pub(super) last: Option<(f64, StepReport)>,
    /// Whether the material is known until the end.
    known: bool,
    /// Times up to here were sampled in the steps before.
    pub(super) covered: f64,
    pub(super) fields: Option<RunFields<C>>,
    #[cfg(feature = "checkpoint")]
    pub(super) autosave: Option<Autosave>,
}

impl ViscoelasticContact {
    /// Like [`Contact::follow`], for several rigid bodies
    /// ([`Builder::another_body`](crate::contact::Builder::another_body)): each follows a history of its own, in
    /// their order. Steps end at the corners and jumps of all histories; adaptive ones are as short as the body needs
    /// that needs the shortest, and their error is that of all bodies together.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// // a ball is held, and another one pressed beside it
    /// let ball = |x1: f64| Shifted::new(Sphere::new(5.0e-3)?, [x1, 0.0]);
    /// let mut contact = ViscoelasticContact::builder(Grid::new([64, 32], [6.0e-3, 3.0e-3])?)
    ///     .geometry(&ball(-1.5e-3)?)
    ///     .another_body(&ball(1.5e-3)?)
    ///     .material(Material::incompressible(Zener::relaxing(4.0e6, 1.0e6, 1.0)?))
    ///     .build()?;
    /// let held = StepLoad::new(Load::approach(20.0e-6))?;
    /// let pressed = Ramp::new(Load::force(0.0), Load::force(0.5), 2.0)?;
    /// let mut run = contact.follow_each(&[&held, &pressed], Stepping::adaptive(1.0e-2), 5.0)?;
    /// while run.next_step()?.is_some() {}
    /// assert!(contact.fields().body(1).unwrap().force > 0.499);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If there is not one history for each body.
    pub fn follow_each<'a>(
        &'a mut self,
        histories: &[&'a dyn LoadHistory],
        stepping: Stepping,
        until: f64,
    ) -> Result<Run<'a>> {
        let histories = histories.iter().map(|&history| OwnedOrBorrowed::Borrowed(history)).collect();
        Run::along_each(OwnedOrBorrowed::Borrowed(self), histories, stepping, until)
    }

    /// Like [`ViscoelasticContact::follow_each`], for a run that owns the contact and its histories.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::follow_each`].
    pub fn into_follow_each(
        self,
        histories: Vec<Box<dyn LoadHistory>>,
        stepping: Stepping,
        until: f64,
    ) -> Result<Run<'static>> {
        let histories = histories.into_iter().map(OwnedOrBorrowed::Owned).collect();
        Run::along_each(OwnedOrBorrowed::Owned(Box::new(self)), histories, stepping, until)
    }
}

impl<'a> Run<'a> {
    fn along_each(
        contact: OwnedOrBorrowed<&'a mut ViscoelasticContact, Box<ViscoelasticContact>>,
        histories: Vec<RunHistory<'a>>,
        stepping: Stepping,
        until: f64,
    ) -> Result<Run<'a>> {
        let (field, len, expected) = ("load histories of the rigid bodies", histories.len(), contact.fields().bodies());
        let histories = Histories::new(histories).filter(|_| len == expected);
        let histories = histories.ok_or(Error::WrongLength { field, len, expected, exact: true })?;
        Ok(Run::follows(contact, histories, stepping, until))
    }
}

impl<'a, C: Contact> Run<'a, C> {
    pub(crate) fn new(
        contact: OwnedOrBorrowed<&'a mut C, Box<C>>,
        history: RunHistory<'a>,
        stepping: Stepping,
        until: f64,
    ) -> Run<'a, C> {
        Run::follows(contact, Histories::one(history), stepping, until)
    }

    fn follows(
        mut contact: OwnedOrBorrowed<&'a mut C, Box<C>>,
        histories: Histories<'a>,
        stepping: Stepping,
        until: f64,
    ) -> Run<'a, C> {
        let (progress, control) = contact.lead(stepping, until);
        let covered = if progress.is_new() { progress.start.next_down() } else { covered_by(progress.now) };
        Run {
            contact,
            loads: Vec::with_capacity(histories.count() + 1),
            histories,
            stepping,
            until,
            progress,
            control,
            stops: Schedule::default(),
            sampled: Schedule::default(),
            events: Vec::new(),
            cancelled: None,
            last: None,
            known: false,
            covered,
            fields: None,
            #[cfg(feature = "checkpoint")]
            autosave: None,
        }
    }

    /// Makes steps end exactly at these [`Times`] too. Stops shorten steps, so that an adaptive run takes more of them.
    ///
    /// # Errors
    /// If a given time is not finite, or not between the start and the end of the run (where it is resumed, of the
    /// whole run), an interval or the first time in decades not finite and positive, or there are not 1 to 1000 times
    /// per decade.
    pub fn stop_at(mut self, times: impl Into<Times>) -> Result<Run<'a, C>> {
        self.stops.add(self.within_run(times.into())?, self.progress.start)?;
        Ok(self)
    }

    /// Samples the states at these [`Times`] ([`Run::samples`]), the start of the run among them if it is given.
    /// Samples leave the steps as they are, bitwise.
    ///
    /// # Errors
    /// As [`Run::stop_at`].
    pub fn sample_at(mut self, times: impl Into<Times>) -> Result<Run<'a, C>> {
        self.sampled.add(self.within_run(times.into())?, self.progress.start)?;
        Ok(self)
    }

    /// Rejects given times at which the run has no state; those that are beyond its ends by their computation alone
    /// are moved there.
    fn within_run(&self, times: Times) -> Result<Times> {
        let (from, to) = (self.progress.start, self.until);
        times.map_given(|time| {
            let inside = time.clamp(from, to.max(from));
            let is_near = (time - inside).abs() <= ROUNDING_OF_GIVEN * inside.abs();
            // times and ends that are not finite have errors of their own
            let is_allowed = is_near || !time.is_finite() || !to.is_finite();
            let allowed = "between the start and the end of the run";
            within("time to stop at or to sample", time, is_allowed, allowed)?;
            Ok(if is_near { inside } else { time })
        })
    }

    /// Lets another thread end the step under way, however long: as soon as it sets `flag`, the step fails with
    /// [`Error::Cancelled`](crate::Error::Cancelled) within an iteration of the solver, and leaves the contact as it was. While the flag is set no step is
    /// taken; once it is cleared the run goes on, with the same steps. Where ranks share out the contact they look at
    /// their flags when a step begins.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use std::sync::atomic::{AtomicBool, Ordering};
    ///
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// let (load, cancel) = (StepLoad::new(Load::force(0.5))?, Arc::new(AtomicBool::new(false)));
    /// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-3), 1.0).cancelled_by(Arc::clone(&cancel));
    /// run.next_step()?;
    /// cancel.store(true, Ordering::Relaxed); // by the handler of Ctrl-C, or of a button
    /// assert!(matches!(run.next_step(), Err(Error::Cancelled { .. })));
    /// assert_eq!(run.contact().time(), 0.0);
    /// # Ok::<(), Error>(())
    /// ```
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Run<'a, C> {
        self.cancelled = Some(flag);
        self
    }

    /// Takes the next step and returns its report, or `None` at the end of the run.
    ///
    /// At the start, and wherever the history jumps or changes its kind, a step of length zero applies the new load.
    /// [`ViscoelasticContact::step`] states which jumps a body without elastic response can follow. Steps end exactly
    /// at corners and jumps of the history.
    ///
    /// # Errors
    /// If the end is not finite or lies before the contact's time, or is a time at which the material is not known
    /// (from the step on in which the bodies touch); if the fixed step is not finite and positive or too short to
    /// change the time, the tolerance is out of range or requires steps too short to change the time, the history
    /// returns an invalid load at any time that is evaluated
    /// ([`Error::LoadOutOfRange`](crate::Error::LoadOutOfRange); [`LoadHistory::at`] states when a run
    /// evaluates it), or a step fails. The contact then keeps its state after the last successful step, and the call
    /// may be repeated.
    ///
    /// If the file of `Run::autosave_to` cannot be written. The step is then taken nevertheless; the next call
    /// writes the file and returns the report of the step.
    pub fn next_step(&mut self) -> Result<Option<StepReport>> {
        #[cfg(feature = "checkpoint")]
        return self.take_and_save();
        #[cfg(not(feature = "checkpoint"))]
        self.take_next()
    }

    /// Takes the next step and keeps its report for [`Run::samples`].
    pub(super) fn take_next(&mut self) -> Result<Option<StepReport>> {
        if let Some((_, StepReport { time, .. })) = self.last.take() {
            self.covered = covered_by(time);
        }
        self.prepare_fields()?;
        let start = self.contact.time();
        let mut report = if self.events.is_empty() { self.take_step() } else { self.take_until_event() }?;
        if let Some(report) = &mut report {
            // its end was checked
            report.warnings -= Warnings::NEAR_END_OF_MATERIAL;
            if report.time >= self.until {
                self.contact.untouched().into_iter().for_each(|touch| report.warn_of_no_contact(touch));
            }
            self.last = Some((start, *report));
            self.progress.count(report);
            self.show_step(start);
        }
        Ok(report)
    }

    pub(super) fn take_step(&mut self) -> Result<Option<StepReport>> {
        self.stepping.validate_run(self.progress.start, self.until)?;
        let Run { contact, histories, loads, until, progress, control, cancelled, known, .. } = self;
        let (now, until) = (contact.time(), *until);
        histories.loads(loads, &**contact, |history, pulls| history.checked_at(now, pulls))?;
        let jumps = !control.loads_act(contact, loads);
        if !jumps && now >= until {
            return Ok(None);
        }
        // bodies that never touch have no loading time
        if !*known && contact.untouched().is_none_or(|touch| loads.iter().any(|load| load.presses(touch))) {
            contact.is_known_until(until)?;
            *known = true;
        }
        let corner = if jumps { f64::INFINITY } else { histories.next_breakpoint(now, contact.lateral())? };
        let temperature = contact.temperature().and_then(|history| Some((history, history.next_corner(now)?)));
        let turn = temperature.map_or(f64::INFINITY, |(_, turn)| turn);
        let kink =
            if temperature.is_some_and(|(history, turn)| history.jumps_at(turn)) { corner.min(turn) } else { corner };
        let corner = corner.min(turn);
        let stop = corner.min(until).min(self.stops.after(now).unwrap_or(f64::INFINITY));
        let given = match self.stepping {
            _ if jumps => Some(now),
            Stepping::Fixed { dt } => {
                let time = progress.next_time(now, dt, stop)?;
                histories.loads(loads, &**contact, |history, pulls| history.checked_before(time, pulls))?;
                Some(time)
            }
            Stepping::Adaptive { .. } => None,
        };
        let given = given.map(|time| (time, &loads[..]));
        let course = Course { histories, given, until, stop, corner, kink, cancelled: cancelled.as_deref() };
        control.advance(contact, &course).map(Some)
    }

    /// How far the run has come.
    pub fn progress(&self) -> RunProgress {
        self.progress.report(self.contact.time(), self.until)
    }

    /// Number of steps rejected for their error, with [`Stepping::adaptive`].
    pub fn rejected_steps(&self) -> u64 {
        self.control.rejected()
    }

    /// The contact after the last step.
    pub fn contact(&self) -> &C {
        &self.contact
    }

    /// The errors of the run so far, by their source. That of the mesh of a contact in space is
    /// [measured](crate::fields::Fields::mesh_error) by this call, in the present state.
    pub fn error_budget(&self) -> ErrorBudget {
        let mesh = self.contact.in_space().and_then(|fields| fields.mesh_error().unwrap_or_default());
        ErrorBudget { field: self.worst_field(), mesh, ..self.control.worst() }
    }
}

impl<C: Contact> Run<'static, C> {
    /// The contact of a run that owns it ([`Contact::into_follow`]), after the last step.
    pub fn into_contact(self) -> C {
        self.contact.into_owned()
    }
}
