//! Drives a contact along a load history.

use crate::contact::adaptive::Controller;
#[cfg(feature = "checkpoint")]
use crate::contact::checkpoint::Keeping;
use crate::contact::report::StepReport;
use crate::contact::spatial::SpatialError;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Error, LoadError, Result, finite, positive, within};
use crate::events;
use crate::load::LoadHistory;

/// Two times closer than this fraction of a step are the same time.
const SAME_TIME: f64 = 1e-6;

/// How long the steps are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Stepping {
    /// Equal steps, counted from the time at which following starts; cut where the load has a corner.
    Fixed {
        /// Length of a step \[s\].
        dt: f64,
    },
    /// Steps as long as the error in time allows; short after jumps and corners of the load, long when little happens.
    Adaptive {
        /// Error in time of a step, relative to the displacement.
        tolerance: f64,
    },
}

impl Stepping {
    /// Equal steps of `dt` \[s\], which must be finite and positive.
    pub fn fixed(dt: f64) -> Stepping {
        Stepping::Fixed { dt }
    }

    /// Steps whose error in time, relative to the displacement, is estimated to be at most `tolerance`, in
    /// \[1e-9, 0.1\]. The solver is not asked for more than suits:
    /// [`Settings::tolerance`](crate::contact::Settings::tolerance) or a fiftieth of `tolerance`, whichever is
    /// greater.
    pub fn adaptive(tolerance: f64) -> Stepping {
        Stepping::Adaptive { tolerance }
    }
}

/// A run along a load history, made by [`ViscoelasticContact::follow`]. Each call of
/// [`Follow::next_step`] takes one step.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(KelvinVoigt::new(1.0e6, 1.0e6)?))
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
/// With [`Stepping::adaptive`] the steps follow what happens, here over nine decades of time; the state in between
/// is there for the asking, [`ViscoelasticContact::within_step`]:
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
///     assert!(report.time_error <= 1.0e-3);
///     steps += 1;
/// }
/// assert!(steps < 60);
/// let budget = run.error_budget();
/// println!("time {:.0e}, mesh {:.0e}, solver {:.0e}", budget.time, budget.space.approach, budget.solver);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug)]
#[must_use = "a run takes no step until next_step is called"]
pub struct Follow<'a> {
    pub(super) contact: &'a mut ViscoelasticContact,
    history: &'a dyn LoadHistory,
    stepping: Stepping,
    until: f64,
    pub(super) progress: Progress,
    /// Times to end steps on, ascending.
    landings: Vec<f64>,
    #[cfg(feature = "checkpoint")]
    pub(super) keeping: Option<Keeping>,
    /// The report of a step whose file could not be written.
    #[cfg(feature = "checkpoint")]
    unreported: Option<Option<StepReport>>,
}

/// How far a run has come, and what it knows of the steps to come.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Progress {
    start: f64,
    /// Where the contact was when this was true.
    pub(super) now: f64,
    /// Steps of the fixed raster already behind, and their length, 0 for steps chosen by their error.
    behind: u64,
    raster: f64,
    controller: Option<Controller>,
    /// Greatest estimated error in time of a step, and greatest residual.
    worst: [f64; 2],
}

impl Progress {
    /// Whether it is that of a run that begins like this one.
    fn goes_on(&self, begun: &Progress) -> bool {
        let tolerance = |progress: &Progress| progress.controller.as_ref().map(|controller| controller.tolerance);
        self.now == begun.now && self.raster == begun.raster && tolerance(self) == tolerance(begun)
    }
}

/// Where the error of a run comes from, made by [`Follow::error_budget`]. All relative.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ErrorBudget {
    /// Greatest error in time estimated for a step, of the displacement; 0 for fixed steps, which nothing is estimated for.
    pub time: f64,
    /// Errors due to the mesh, of the present state.
    pub space: SpatialError,
    /// Greatest residual of the contact problems, of the displacement.
    pub solver: f64,
}

/// A step that the solver cannot do is tried again so many times, shorter.
const SOLVER_RETRIES: u32 = 5;

impl<'a> Follow<'a> {
    pub(crate) fn new(
        contact: &'a mut ViscoelasticContact,
        history: &'a dyn LoadHistory,
        stepping: Stepping,
        until: f64,
    ) -> Follow<'a> {
        let now = contact.time();
        let (controller, raster) = match stepping {
            Stepping::Fixed { dt } => (None, dt),
            Stepping::Adaptive { tolerance } => (Some(Controller::new(tolerance)), 0.0),
        };
        let begun = Progress { start: now, now, behind: 0, raster, controller, worst: [0.0; 2] };
        // a run that was saved goes on, if this is the one
        let saved = contact.progress.take().filter(|saved| until >= now && saved.goes_on(&begun));
        let progress = saved.map_or(begun, |saved| *saved);
        Follow {
            contact,
            history,
            stepping,
            until,
            progress,
            landings: Vec::new(),
            #[cfg(feature = "checkpoint")]
            keeping: None,
            #[cfg(feature = "checkpoint")]
            unreported: None,
        }
    }

    /// Lets steps end exactly on these `times` \[s\] too, in any order; those before the contact's time do not
    /// matter.
    ///
    /// # Errors
    /// If a time is not finite.
    pub fn landing_on(mut self, times: &[f64]) -> Result<Follow<'a>> {
        for &time in times {
            self.landings.push(finite("time to land on", time)?);
        }
        self.landings.sort_by(f64::total_cmp);
        Ok(self)
    }

    /// Takes the next step and reports it; `None` when the end is reached.
    ///
    /// At the start, and wherever the history jumps or changes its kind, a step of length zero brings in the new load; which
    /// of these a body without elastic response can follow, tells [`ViscoelasticContact::step`].
    /// Corners and jumps of the history are met exactly.
    ///
    /// # Errors
    /// If the end is not finite or lies before the contact's time, the fixed step is not finite and
    /// positive or too short to change the time, the tolerance is out of range or asks for steps too short to change
    /// the time, the history returns what is not a load wherever the run looks at it ([`LoadError::OutOfRange`](crate::load::LoadError::OutOfRange); adaptive steps
    /// look between their ends, and ahead), or a step fails; the contact is then as it was after the last good step, and the call may be
    /// repeated. Or if the file of `Follow::keeping` cannot be written: the step is then taken all the same, and the next call
    /// tries to write again, and reports it.
    pub fn next_step(&mut self) -> Result<Option<StepReport>> {
        #[cfg(feature = "checkpoint")]
        {
            let report = match self.unreported.take() {
                Some(report) => report,
                None => self.take_step()?,
            };
            if let Err(error) = self.keep(report.is_none()) {
                self.unreported = Some(report);
                return Err(error);
            }
            Ok(report)
        }
        #[cfg(not(feature = "checkpoint"))]
        self.take_step()
    }

    fn take_step(&mut self) -> Result<Option<StepReport>> {
        match self.stepping {
            Stepping::Fixed { dt } => positive("fixed step", dt)?,
            Stepping::Adaptive { tolerance } => {
                let inside = (1e-9..=0.1).contains(&tolerance);
                within("tolerance of the adaptive steps", tolerance, inside, "in [1e-9, 0.1]")?
            }
        };
        finite("end of the run", self.until)?;
        within("end of the run", self.until, self.until >= self.progress.start, "at or after the time of the contact")?;

        self.contact.history.expect(self.until - self.contact.state.undisturbed_until);

        let now = self.contact.time();
        let load = self.history.at(now).validated_at(now)?;
        if load != self.contact.load() {
            if let Some(controller) = &mut self.progress.controller {
                controller.restart();
            }
            let tolerance = self.solver_tolerance();
            let attempt = self.contact.attempt(now, 0.0, &[load], tolerance)?;
            let report = self.contact.accept(attempt, &[load]);
            return Ok(Some(self.note(report)));
        }
        if now >= self.until {
            return Ok(None);
        }
        let corner = self.history.next_breakpoint(now).unwrap_or(f64::INFINITY);
        if corner <= now || corner.is_nan() {
            return Err(LoadError::InvalidBreakpoint { after: now, breakpoint: corner }.into());
        }
        if let Some(mut controller) = self.progress.controller.take() {
            let report = self.adaptive_step(&mut controller, corner);
            self.progress.controller = Some(controller);
            return report.map(|report| Some(self.note(report)));
        }
        let Stepping::Fixed { dt } = self.stepping else { return Ok(None) };
        let time = self.next_time(now, dt, corner)?;
        let load = self.history.before(time).validated_at(time)?;
        let report = self.contact.step_to(time, time - now, &[load])?;
        Ok(Some(self.note(report)))
    }

    /// One step as long as its error allows.
    fn adaptive_step(&mut self, controller: &mut Controller, corner: f64) -> Result<StepReport> {
        let now = self.contact.time();
        controller.remember(self.contact);
        let stop = corner.min(self.until).min(self.landing(now));
        let tolerance = controller.solver_tolerance(self.contact.settings().tolerance);
        let (mut wasted, mut failures, mut tried) = ([0; 2], 0, f64::INFINITY);
        loop {
            let wanted = controller.length(self.contact, self.history, self.until - now)?;
            let (time, dt) = towards(now, stop, wanted);
            // a step of the last digit of the time, shortened, may round to itself again, and again
            if time <= now || time >= tried {
                return Err(Error::StepTooShort { time: now, dt, tolerance: controller.tolerance });
            }
            tried = time;
            let load = self.history.before(time).validated_at(time)?;
            let straying = controller.watch(self.history, self.contact, time)?;
            if straying > controller.tolerance {
                controller.judge(dt, straying);
                self.may_shorten(time, dt)?;
                continue;
            }
            let attempt = match self.contact.attempt(time, dt, &[load], tolerance) {
                Err(Error::NotConverged { .. }) if failures < SOLVER_RETRIES => {
                    failures += 1;
                    controller.shorten(dt);
                    wasted = self.wasted(wasted);
                    self.may_shorten(time, dt)?;
                    continue;
                }
                other => other?,
            };
            let error = controller.estimate(self.contact, dt).max(straying);
            if controller.judge(dt, error) {
                if time == corner {
                    controller.restart();
                } else {
                    controller.resume(wanted, dt);
                }
                let mut report = self.contact.accept(attempt, &[load]);
                report.time_error = error;
                report.convolutions += wasted[0];
                report.preconditioner_applications += wasted[1];
                return Ok(report);
            }
            events::rejected(time, dt, error, controller.tolerance);
            wasted = self.wasted(wasted);
            self.contact.move_back();
            self.may_shorten(time, dt)?;
        }
    }

    /// The work of steps tried in vain, with that of the last one.
    fn wasted(&self, before: [usize; 2]) -> [usize; 2] {
        let work = self.contact.work_of_trial();
        [before[0] + work[0], before[1] + work[1]]
    }

    /// Whether a step that was found too long may be tried again, shorter: not below what the material resolves, or it
    /// would be tried for ever.
    fn may_shorten(&self, time: f64, dt: f64) -> Result<()> {
        let known_from = self.contact.state.shortest;
        // what is left of a length after it was added to a time is a little off
        if dt > 1.01 * known_from { Ok(()) } else { Err(Error::BelowMaterial { time, dt, known_from }) }
    }

    fn solver_tolerance(&self) -> f64 {
        let wanted = self.contact.settings().tolerance;
        self.progress.controller.as_ref().map_or(wanted, |controller| controller.solver_tolerance(wanted))
    }

    /// The first time after `now` to land on.
    fn landing(&self, now: f64) -> f64 {
        self.landings.get(self.landings.partition_point(|&time| time <= now)).copied().unwrap_or(f64::INFINITY)
    }

    /// The end of the next step: the raster, unless a corner or the end of the run comes first.
    fn next_time(&mut self, now: f64, dt: f64, corner: f64) -> Result<f64> {
        let same = SAME_TIME * dt;
        while self.raster(dt) <= now + same {
            self.progress.behind += 1;
            if self.progress.start + (self.progress.behind + 1) as f64 * dt
                <= self.progress.start + self.progress.behind as f64 * dt
            {
                return Err(Error::OutOfRange {
                    field: "fixed step",
                    value: dt,
                    allowed: "long enough to change the time",
                });
            }
        }
        let stop = corner.min(self.until).min(self.landing(now));
        Ok(if stop <= self.raster(dt) + same { stop } else { self.raster(dt) })
    }

    /// The end of the step of the fixed raster that is under way.
    fn raster(&self, dt: f64) -> f64 {
        self.progress.start + (self.progress.behind + 1) as f64 * dt
    }

    /// What the answer errs by, so far, as far as it can be told.
    pub fn error_budget(&self) -> ErrorBudget {
        ErrorBudget {
            time: self.progress.worst[0],
            space: self.contact.spatial_error(),
            solver: self.progress.worst[1],
        }
    }

    fn note(&mut self, report: StepReport) -> StepReport {
        self.progress.worst =
            [self.progress.worst[0].max(report.time_error), self.progress.worst[1].max(report.residual)];
        report
    }

    /// Steps that were tried and found too long, with [`Stepping::adaptive`].
    pub fn rejected_steps(&self) -> u64 {
        self.progress.controller.as_ref().map_or(0, |controller| controller.rejected)
    }

    /// The contact as the last step left it.
    pub fn contact(&self) -> &ViscoelasticContact {
        self.contact
    }
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
