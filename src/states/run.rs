//! A contact on elastic states along a load history.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::ascending::{Schedule, Times};
use crate::contact::{RunProgress, StepReport, Stepping};
use crate::error::{Error, LoadError, Result, within};
use crate::load::{Load, LoadHistory};
use crate::states::contact::StatesContact;
use crate::states::control::{SAME_TIME, StepControl, load_at};

/// A run of a [`StatesContact`] along a load history, made by [`StatesContact::follow`]. Each call of
/// [`StatesRun::next_step`] takes one step.
///
/// Adaptive steps are taken whole and in two halves; the difference is the error of the step, and the halves are kept.
///
/// ```
/// use viscocontact::prelude::*;
/// use viscocontact::states::{Reach, StatesContact, Sweep};
///
/// let states = Sweep::new(Grid::square(32, 4.0e-3)?, &Sphere::new(10.0e-3)?).run(Reach::Level(6.0e-7))?;
/// let mut contact = StatesContact::new(&states, &Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?))?;
/// let load = Ramp::new(Load::force(0.0), Load::force(0.5), 1.0)?;
/// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-4), 10.0);
/// while let Some(report) = run.next_step()? {
///     println!("{:.3} s  {:.4} mm²", report.time, run.contact().contact_area() * 1e6);
/// }
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug)]
#[must_use = "a run takes no step until next_step is called"]
pub struct StatesRun<'a> {
    contact: &'a mut StatesContact,
    history: &'a dyn LoadHistory,
    stepping: Stepping,
    until: f64,
    start: f64,
    /// Number of equal steps taken.
    steps: u64,
    load: Option<Load>,
    control: StepControl,
    /// State at the start of the last step.
    before: StatesContact,
    /// Steps taken, and the length of the first one that took time.
    taken: u64,
    first_step: f64,
    /// Set by another thread to end the run.
    cancelled: Option<Arc<AtomicBool>>,
    /// Times at which steps end, and at which states within steps are sampled.
    stops: Schedule,
    sampled: Schedule,
    /// Whether the last call took a step.
    stepped: bool,
}

impl StatesContact {
    /// Follows a load history to the time `until` \[s\], in steps chosen by `stepping`.
    pub fn follow<'a>(&'a mut self, history: &'a dyn LoadHistory, stepping: Stepping, until: f64) -> StatesRun<'a> {
        let (start, before) = (self.time(), self.clone());
        let control = StepControl::new(&before, until);
        StatesRun {
            contact: self,
            history,
            stepping,
            until,
            start,
            steps: 0,
            load: None,
            control,
            before,
            taken: 0,
            first_step: 0.0,
            cancelled: None,
            stops: Schedule::default(),
            sampled: Schedule::default(),
            stepped: false,
        }
    }
}

impl<'a> StatesRun<'a> {
    /// Makes steps end exactly at these [`Times`] too, as [`Run::stop_at`](crate::contact::Run::stop_at).
    ///
    /// # Errors
    /// As [`Run::stop_at`](crate::contact::Run::stop_at).
    pub fn stop_at(mut self, times: impl Into<Times>) -> Result<StatesRun<'a>> {
        self.stops.add(times.into(), self.start)?;
        Ok(self)
    }

    /// Samples the states at these [`Times`] ([`StatesRun::samples`]).
    ///
    /// # Errors
    /// As [`StatesRun::stop_at`].
    pub fn sample_at(mut self, times: impl Into<Times>) -> Result<StatesRun<'a>> {
        self.sampled.add(times.into(), self.start)?;
        Ok(self)
    }

    /// Lets another thread end the run: while it sets `flag`, a step fails with [`Error::Cancelled`] and leaves the contact as it was,
    /// as [`Run::cancelled_by`](crate::contact::Run::cancelled_by).
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> StatesRun<'a> {
        self.cancelled = Some(flag);
        self
    }

    /// How far the run has come.
    pub fn progress(&self) -> RunProgress {
        let StatesRun { taken, start, until, first_step, .. } = *self;
        RunProgress { steps: taken, start, time: self.contact.time(), until, first_step }
    }

    /// The states of the last step, in the order of time: at each time to sample within it, and at its end, as
    /// [`Run::samples`](crate::contact::Run::samples). The steps stay as they are.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let states = Sweep::new(Grid::square(32, 4.0e-3)?, &Sphere::new(10.0e-3)?).run(Reach::Level(6.0e-7))?;
    /// let rubber = Material::incompressible(Zener::relaxing(1.0e6, 0.5e6, 1.0)?);
    /// let mut contact = StatesContact::new(&states, &rubber)?;
    /// let load = StepLoad::new(Load::force(0.3))?;
    /// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-3), 100.0).sample_at(Times::decades(1.0e-2, 20))?;
    /// let mut curve = Vec::new();
    /// while run.next_step()?.is_some() {
    ///     for sample in run.samples() {
    ///         let sample = sample?;
    ///         curve.push((sample.time(), sample.contact_area()));
    ///     }
    /// }
    /// assert!(curve.len() > 80 && curve.is_sorted_by_key(|point| point.0));
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// Each sample as [`StatesRun::within_step`].
    pub fn samples(&self) -> impl Iterator<Item = Result<StatesContact>> {
        let (start, end) = (self.before.time(), self.contact.time());
        let same = SAME_TIME * (end - start);
        let (mut time, mut left) = (start + same, self.stepped);
        std::iter::from_fn(move || {
            if !left {
                return None;
            }
            let next = self.sampled.after(time).filter(|next| *next < end - same);
            left = next.is_some();
            time = next.unwrap_or(end) + same;
            Some(self.within_step(next.unwrap_or(end)))
        })
    }

    /// Takes the next step and returns its report, or `None` at the end of the run. At the start, and where the
    /// history jumps, a step of length zero applies the new load; steps end at corners and jumps.
    ///
    /// # Errors
    /// If the end of the run, the fixed step or the tolerance is not allowed, the history returns an invalid load, or
    /// a step fails ([`StatesContact::step`]).
    pub fn next_step(&mut self) -> Result<Option<StepReport>> {
        self.stepped = false;
        let report = self.take_step()?;
        if let Some(report) = report {
            (self.stepped, self.taken) = (true, self.taken + 1);
            self.first_step = if self.first_step > 0.0 { self.first_step } else { report.dt };
        }
        Ok(report)
    }

    fn take_step(&mut self) -> Result<Option<StepReport>> {
        self.stepping.validate_run(self.start, self.until)?;
        let now = self.contact.time();
        if self.cancelled.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Err(Error::Cancelled { what: "a step" });
        }
        let load = self.history.at(now).validated_at(now, false)?;
        if self.load != Some(load) {
            self.before.copy_from(self.contact);
            let report = self.contact.step(0.0, load)?;
            self.load = Some(load);
            self.control.restart();
            return Ok(Some(report));
        }
        if now >= self.until {
            return Ok(None);
        }
        let corner = self.history.next_breakpoint(now).unwrap_or(f64::INFINITY);
        if corner <= now || corner.is_nan() {
            return Err(LoadError::InvalidBreakpoint { after: now, breakpoint: corner }.into());
        }
        let kink = corner.min(self.contact.next_temperature_corner(now)).min(self.until);
        let stop = kink.min(self.stops.after(now).unwrap_or(f64::INFINITY));
        let report = match self.stepping {
            Stepping::Fixed { dt } => self.fixed_step(now, dt, stop)?,
            Stepping::Adaptive { tolerance } => self.adaptive_step(tolerance, stop)?,
        };
        if report.time >= kink {
            self.contact.reset_differences();
            self.control.restart();
        }
        Ok(Some(report))
    }

    /// The contact at a time within the last step, its ends included, under the load of the history at that time: as
    /// exact as the steps of the run.
    ///
    /// # Errors
    /// If the time does not lie within the last step, the load of the history there is invalid, or the step to it fails.
    pub fn within_step(&self, time: f64) -> Result<StatesContact> {
        let (start, end) = (self.before.time(), self.contact.time());
        within("time within the last step", time, (start..=end).contains(&time), "between its start and its end")?;
        if time == end {
            return Ok(self.contact.clone());
        }
        let mut contact = self.before.clone();
        // an adaptive step is taken in two halves
        let middle = start + 0.5 * (end - start);
        let halved = matches!(self.stepping, Stepping::Adaptive { .. }) && time > middle;
        for stop in [halved.then_some(middle), (time > start).then_some(time)].into_iter().flatten() {
            contact.step_to(stop, stop - contact.time(), self.history.at(stop).validated_at(stop, false)?)?;
        }
        Ok(contact)
    }

    fn fixed_step(&mut self, now: f64, dt: f64, stop: f64) -> Result<StepReport> {
        self.before.copy_from(self.contact);
        while self.start + (self.steps + 1) as f64 * dt <= now * (1.0 + f64::EPSILON) + SAME_TIME * dt {
            self.steps += 1;
        }
        let end = self.start + (self.steps + 1) as f64 * dt;
        self.step_to(now, if stop <= end + SAME_TIME * dt { stop } else { end })
    }

    /// Advances to a time under the load there, or just before it where it jumps.
    fn step_to(&mut self, now: f64, time: f64) -> Result<StepReport> {
        let load = load_at(self.history, time)?;
        self.load = Some(load);
        self.contact.step_to(time, time - now, load)
    }

    fn adaptive_step(&mut self, tolerance: f64, stop: f64) -> Result<StepReport> {
        self.before.copy_from(self.contact);
        let report = self.control.step(self.contact, self.history, tolerance, stop)?;
        self.load = Some(load_at(self.history, report.time)?);
        Ok(report)
    }

    /// Number of steps rejected for their error, with [`Stepping::adaptive`].
    pub fn rejected_steps(&self) -> u64 {
        self.control.rejected
    }

    /// The contact after the last step.
    pub fn contact(&self) -> &StatesContact {
        self.contact
    }
}
