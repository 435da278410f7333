//! Drives a contact along a load history.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::ascending::Schedule;
use crate::contact::{Step, StepReport, ViscoelasticContact};
use crate::error::{Error, LoadError, Result};
use crate::hereditary::StepContext;
use crate::load::{Load, LoadHistory};
use crate::run::adaptive_step::{Course, adaptive_step};
use crate::run::progress::{ErrorBudget, Progress, RunProgress, StepErrors, Stepping};
use crate::run::run_scale::RunScale;
#[cfg(feature = "checkpoint")]
use crate::run::saving::Autosave;
use crate::run::{OwnedOrBorrowed, RunContact, RunHistory};

/// Two times closer than this fraction of a step are the same time.
pub(super) const SAME_TIME: f64 = 1e-6;

/// A run along a load history, made by [`ViscoelasticContact::follow`]. Each call of
/// [`Run::next_step`] takes one step.
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
pub struct Run<'a> {
    pub(super) contact: RunContact<'a>,
    pub(super) history: RunHistory<'a>,
    stepping: Stepping,
    pub(super) until: f64,
    pub(super) progress: Progress,
    /// Times at which steps end, and at which states within steps are sampled.
    pub(super) stops: Schedule,
    pub(super) sampled: Schedule,
    /// Set by another thread to end the step under way.
    cancelled: Option<Arc<AtomicBool>>,
    /// Start and report of the last step of this run, and the number of its steps.
    pub(super) last: Option<(f64, StepReport)>,
    taken: u64,
    /// Length of the first step of this run that took time.
    first_step: f64,
    #[cfg(feature = "checkpoint")]
    pub(super) autosave: Option<Autosave>,
    /// Report of a step after which the file could not be written.
    #[cfg(feature = "checkpoint")]
    unreported: Option<Option<StepReport>>,
}

impl ViscoelasticContact {
    /// Follows a load history to the time `until` \[s\], in steps chosen by `stepping`.
    pub fn follow<'a>(&'a mut self, history: &'a dyn LoadHistory, stepping: Stepping, until: f64) -> Run<'a> {
        Run::new(OwnedOrBorrowed::Borrowed(self), OwnedOrBorrowed::Borrowed(history), stepping, until)
    }

    /// Like [`ViscoelasticContact::follow`], for a run that owns the contact and its history. Such a run can be stored
    /// or sent to another thread.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// struct Simulation {
    ///     run: Run<'static>,
    /// }
    ///
    /// let contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// let load = StepLoad::new(Load::force(0.5))?;
    /// let mut simulation = Simulation { run: contact.into_follow(load, Stepping::fixed(0.5), 1.0) };
    /// while simulation.run.next_step()?.is_some() {}
    /// let contact = simulation.run.into_contact();
    /// assert_eq!(contact.time(), 1.0);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn into_follow(self, history: impl LoadHistory + 'static, stepping: Stepping, until: f64) -> Run<'static> {
        Run::new(OwnedOrBorrowed::Owned(Box::new(self)), OwnedOrBorrowed::Owned(Box::new(history)), stepping, until)
    }
}

impl<'a> Run<'a> {
    fn new(mut contact: RunContact<'a>, history: RunHistory<'a>, stepping: Stepping, until: f64) -> Run<'a> {
        let begun = Progress::begin(contact.time(), stepping);
        // continues a saved run that began like this one
        let saved = contact.saved_run.take().and_then(|saved| saved.downcast::<Progress>().ok());
        let saved = saved.filter(|saved| until >= begun.now && saved.continues(&begun));
        Run {
            contact,
            history,
            stepping,
            until,
            progress: saved.map_or(begun, Arc::unwrap_or_clone),
            stops: Schedule::default(),
            sampled: Schedule::default(),
            cancelled: None,
            last: None,
            taken: 0,
            first_step: 0.0,
            #[cfg(feature = "checkpoint")]
            autosave: None,
            #[cfg(feature = "checkpoint")]
            unreported: None,
        }
    }

    /// Takes the next step and returns its report, or `None` at the end of the run.
    ///
    /// At the start, and wherever the history jumps or changes its kind, a step of length zero applies the new load.
    /// [`ViscoelasticContact::step`] states which jumps a body without elastic response can follow. Steps end exactly
    /// at corners and jumps of the history.
    ///
    /// # Errors
    /// If the end is not finite or lies before the contact's time, the fixed step is not finite and positive or too
    /// short to change the time, the tolerance is out of range or requires steps too short to change the time, the
    /// history returns an invalid load at any time that is evaluated
    /// ([`LoadError::OutOfRange`](crate::load::LoadError::OutOfRange); a run evaluates the whole history when it
    /// begins, for the greatest loads, and adaptive steps evaluate it between their ends and ahead), or a step fails.
    /// The contact then keeps its state after the last successful step, and the call may be repeated.
    ///
    /// If the file of `Run::autosave_to` cannot be written. The step is then taken nevertheless; the next call
    /// writes the file and returns the report of the step.
    pub fn next_step(&mut self) -> Result<Option<StepReport>> {
        #[cfg(feature = "checkpoint")]
        {
            let report = match self.unreported.take() {
                Some(report) => report,
                None => self.take_next()?,
            };
            if let Err(error) = self.autosave(report.is_none()) {
                self.unreported = Some(report);
                return Err(error);
            }
            Ok(report)
        }
        #[cfg(not(feature = "checkpoint"))]
        self.take_next()
    }

    /// Takes the next step and keeps its report for [`Run::samples`].
    fn take_next(&mut self) -> Result<Option<StepReport>> {
        self.last = None;
        let start = self.contact.time();
        let report = self.take_step()?;
        self.last = report.map(|report| (start, report));
        if let Some(report) = report {
            self.taken += 1;
            if self.first_step == 0.0 {
                self.first_step = report.dt;
            }
        }
        Ok(report)
    }

    fn take_step(&mut self) -> Result<Option<StepReport>> {
        self.stepping.validate_run(self.progress.start, self.until)?;
        let now = self.contact.time();
        let load = self.history.at(now).validated_at(now, self.contact.scene.attraction.is_some())?;
        if load != self.contact.load() {
            if let Some(control) = &mut self.progress.control {
                control.jump();
            }
            return self.step_to(now, 0.0, load).map(Some);
        }
        if now >= self.until {
            return Ok(None);
        }
        let corner = self.history.next_breakpoint(now).unwrap_or(f64::INFINITY);
        if corner <= now || corner.is_nan() {
            return Err(LoadError::InvalidBreakpoint { after: now, breakpoint: corner }.into());
        }
        let (turn, jumps) = self.contact.scene.next_temperature_corner(now);
        let kink = if jumps { corner.min(turn) } else { corner };
        let corner = corner.min(turn);
        let stop = corner.min(self.until).min(self.next_stop(now));
        let Run { contact, history, until, progress, cancelled, .. } = self;
        if let Some(mut control) = progress.control.take() {
            let rows = contact.computation.state.region.rows();
            let course = Course { history: &**history, until: *until, stop, kink, cancelled: cancelled.as_deref() };
            let report = rows.together(|| {
                let (report, errors) = adaptive_step(contact, &mut control, course)?;
                progress.include(errors, contact.mesh_error().unwrap_or_default());
                Ok(report)
            });
            progress.control = Some(control);
            return report.map(Some);
        }
        let Stepping::Fixed { dt } = self.stepping else { return Ok(None) };
        let time = self.next_time(now, dt, corner)?;
        let load = self.history.before(time).validated_at(time, self.contact.scene.attraction.is_some())?;
        let report = self.step_to(time, time - now, load)?;
        if time == corner {
            self.contact.computation.state.history.reset_differences();
        }
        Ok(Some(report))
    }

    /// Takes one step of given end and length.
    fn step_to(&mut self, time: f64, dt: f64, load: Load) -> Result<StepReport> {
        let tolerance = self.solver_tolerance();
        let loads = [load];
        let rows = self.contact.computation.state.region.rows();
        rows.together(|| {
            let step =
                Step { cancelled: self.cancelled.as_deref(), ..self.contact.request(time, dt, &loads, tolerance)? };
            let ViscoelasticContact { scene, computation, .. } = &*self.contact;
            if self.progress.scale.is_none() {
                self.progress.scale = Some(RunScale::new(scene, &computation.state, &*self.history, self.until)?);
            }
            let age = step.interval.reduced - computation.state.clock.undisturbed_until;
            let expected = self.progress.scale.as_ref().map_or([0.0; 2], |scale| scale.expected(scene, &load, age));
            let outlook = StepContext { expected, ..StepContext::default() };
            let (report, error) = self.contact.take_expecting(step, outlook)?;
            let mesh = self.contact.mesh_error().unwrap_or_default();
            let errors = StepErrors { time: error.relative, pressure: error.greatest, residual: report.residual };
            self.progress.include(errors, mesh);
            Ok(report)
        })
    }

    pub(super) fn solver_tolerance(&self) -> f64 {
        let scene = &self.contact.scene;
        self.progress.control.as_ref().map_or(scene.settings.tolerance, |control| control.solver_tolerance(scene))
    }

    /// The first of the times to stop at after `now`.
    pub(super) fn next_stop(&self, now: f64) -> f64 {
        self.stops.after(now).unwrap_or(f64::INFINITY)
    }

    /// The end of the next equal step, or an earlier corner, stop or end of the run.
    fn next_time(&mut self, now: f64, dt: f64, corner: f64) -> Result<f64> {
        let (same, progress) = (SAME_TIME * dt, &mut self.progress);
        while progress.end_of_step(dt) <= now + same {
            let end = progress.end_of_step(dt);
            progress.steps += 1;
            if progress.end_of_step(dt) <= end {
                let allowed = "long enough to change the time";
                return Err(Error::OutOfRange { field: "fixed step", value: dt, allowed });
            }
        }
        let end = progress.end_of_step(dt);
        let stop = corner.min(self.until).min(self.next_stop(now));
        Ok(if stop <= end + same { stop } else { end })
    }

    /// Lets another thread end the step under way, however long: as soon as it sets `flag`, the step fails with
    /// [`Error::Cancelled`] within an iteration of the solver, and leaves the contact as it was. While the flag is set no step is
    /// taken; once it is cleared the run goes on, with the same steps. Where ranks share out the contact they look at their flags
    /// when a step begins.
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
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Run<'a> {
        self.cancelled = Some(flag);
        self
    }

    /// How far the run has come.
    pub fn progress(&self) -> RunProgress {
        let (start, time, until) = (self.progress.start, self.contact.time(), self.until);
        RunProgress { steps: self.taken, start, time, until, first_step: self.first_step }
    }

    /// The errors of the run so far, by their source.
    pub fn error_budget(&self) -> ErrorBudget {
        self.progress.error_budget(self.contact.mesh_error().unwrap_or_default())
    }

    /// Number of steps rejected for their error, with [`Stepping::adaptive`].
    pub fn rejected_steps(&self) -> u64 {
        self.progress.control.as_ref().map_or(0, |control| control.rejected)
    }

    /// The contact after the last step.
    pub fn contact(&self) -> &ViscoelasticContact {
        &self.contact
    }
}

impl Run<'static> {
    /// The contact of a run that owns it ([`ViscoelasticContact::into_follow`]), after the last step.
    pub fn into_contact(self) -> ViscoelasticContact {
        match self.contact {
            OwnedOrBorrowed::Borrowed(contact) => contact.clone(), // of a leaked contact
            OwnedOrBorrowed::Owned(contact) => *contact,
        }
    }
}
