//! A contact on elastic states along a load history.

use crate::ascending::Schedule;
use crate::contact::Stepping;
use crate::error::{Error, LoadError, Result, StepError, within};
use crate::load::{Load, LoadHistory};
use crate::states::contact::{StatesContact, StatesReport};

/// Two times closer than this fraction of a step are the same time.
const SAME_TIME: f64 = 1e-6;
/// First adaptive step after a jump or a corner, over the time to the next one.
const FIRST_STEP: f64 = 1e-4;
/// Limits of the ratio of a step to the one before.
const MAX_GROWTH: f64 = 4.0;
const MIN_GROWTH: f64 = 0.1;
/// Shares of the tolerance that the error of a step aims at, and that it may have: errors of several steps add up.
const AIM: f64 = 0.1;
const ALLOWED: f64 = 0.3;
/// Order of a corrected step, so that two halves err by a seventh of their difference to the whole.
const ORDER: f64 = 3.0;

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
///     println!("{:.3} s  {:.4} mm²", report.time, report.area * 1e6);
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
    /// Length of the next adaptive step; 0 after a jump or a corner.
    next: f64,
    /// State at the start of the last step, and after an adaptive one was taken whole.
    before: StatesContact,
    whole: StatesContact,
    /// Greatest depth and force of the run, for errors relative to them.
    greatest: [f64; 2],
    rejected: u64,
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
        let whole = before.clone();
        let (load, steps, next, greatest, rejected) = (None, 0, 0.0, [0.0; 2], 0);
        StatesRun {
            contact: self,
            history,
            stepping,
            until,
            start,
            steps,
            load,
            next,
            before,
            whole,
            greatest,
            rejected,
            stops: Schedule::default(),
            sampled: Schedule::default(),
            stepped: false,
        }
    }
}

impl<'a> StatesRun<'a> {
    /// Makes steps end exactly at these `times` \[s\] too, as [`Run::stop_at`](crate::contact::Run::stop_at).
    ///
    /// # Errors
    /// If a time is not finite.
    pub fn stop_at(mut self, times: &[f64]) -> Result<StatesRun<'a>> {
        self.stops.add("time to stop at", times)?;
        Ok(self)
    }

    /// Makes steps end exactly at every multiple of `interval` \[s\] from the start of the run too.
    ///
    /// # Errors
    /// If the interval is not finite and positive.
    pub fn stop_every(mut self, interval: f64) -> Result<StatesRun<'a>> {
        self.stops.add_every("interval of the stops", interval, self.start)?;
        Ok(self)
    }

    /// Makes steps end exactly `first` \[s\] after the start of the run too, and at `per_decade` times in each decade beyond.
    ///
    /// # Errors
    /// If `first` is not finite and positive, or `per_decade` not 1 to 1000.
    pub fn stop_at_decades(mut self, first: f64, per_decade: usize) -> Result<StatesRun<'a>> {
        self.stops.add_decades(["first time to stop at", "stops per decade"], (first, per_decade), self.start)?;
        Ok(self)
    }

    /// Samples the states at these `times` \[s\] ([`StatesRun::samples`]).
    ///
    /// # Errors
    /// If a time is not finite.
    pub fn sample_at(mut self, times: &[f64]) -> Result<StatesRun<'a>> {
        self.sampled.add("time to sample", times)?;
        Ok(self)
    }

    /// Samples the states at every multiple of `interval` \[s\] from the start of the run ([`StatesRun::samples`]).
    ///
    /// # Errors
    /// If the interval is not finite and positive.
    pub fn sample_every(mut self, interval: f64) -> Result<StatesRun<'a>> {
        self.sampled.add_every("interval of the samples", interval, self.start)?;
        Ok(self)
    }

    /// Samples the states `first` \[s\] after the start of the run, and at `per_decade` times in each decade beyond
    /// ([`StatesRun::samples`]).
    ///
    /// # Errors
    /// If `first` is not finite and positive, or `per_decade` not 1 to 1000.
    pub fn sample_at_decades(mut self, first: f64, per_decade: usize) -> Result<StatesRun<'a>> {
        self.sampled.add_decades(["first time to sample", "samples per decade"], (first, per_decade), self.start)?;
        Ok(self)
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
    /// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-3), 100.0).sample_at_decades(1.0e-2, 20)?;
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
    pub fn next_step(&mut self) -> Result<Option<StatesReport>> {
        self.stepped = false;
        let report = self.take_step()?;
        self.stepped = report.is_some();
        Ok(report)
    }

    fn take_step(&mut self) -> Result<Option<StatesReport>> {
        self.stepping.validate_run(self.start, self.until)?;
        let now = self.contact.time();
        let load = self.history.at(now).validated_at(now, false)?;
        if self.load != Some(load) {
            self.before.copy_from(self.contact);
            let report = self.contact.step(0.0, load)?;
            (self.load, self.next) = (Some(load), 0.0);
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
            Stepping::Adaptive { tolerance } => self.adaptive_step(now, tolerance, stop)?,
        };
        if report.time >= kink {
            self.contact.reset_differences();
            self.next = 0.0;
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

    fn fixed_step(&mut self, now: f64, dt: f64, stop: f64) -> Result<StatesReport> {
        self.before.copy_from(self.contact);
        while self.start + (self.steps + 1) as f64 * dt <= now * (1.0 + f64::EPSILON) + SAME_TIME * dt {
            self.steps += 1;
        }
        let end = self.start + (self.steps + 1) as f64 * dt;
        self.step_to(now, if stop <= end + SAME_TIME * dt { stop } else { end })
    }

    /// Advances to a time under the load there, or just before it where it jumps.
    fn step_to(&mut self, now: f64, time: f64) -> Result<StatesReport> {
        let load = self.history.before(time).validated_at(time, false)?;
        self.load = Some(load);
        self.contact.step_to(time, time - now, load)
    }

    fn adaptive_step(&mut self, now: f64, tolerance: f64, stop: f64) -> Result<StatesReport> {
        self.before.copy_from(self.contact);
        let mut length = if self.next > 0.0 { self.next } else { FIRST_STEP * (stop - now) };
        loop {
            let end = if now + (1.0 + SAME_TIME) * length >= stop { stop } else { now + length };
            let middle = now + 0.5 * (end - now);
            if !(now < middle && middle < end) {
                return Err(Error::Step(StepError::StepTooShort { time: now, dt: length, tolerance }));
            }
            let report = match self.whole_and_halves([now, middle, end]) {
                Ok(report) => report,
                Err(error) => {
                    self.contact.copy_from(&self.before);
                    return Err(error);
                }
            };
            let error = self.error_of_whole() / (2f64.powf(ORDER) - 1.0);
            let growth = (AIM * tolerance / error).powf(1.0 / ORDER).clamp(MIN_GROWTH, MAX_GROWTH);
            if error <= ALLOWED * tolerance {
                self.next = growth.max(0.5) * (end - now).max(length.min(stop - now));
                return Ok(report);
            }
            self.contact.copy_from(&self.before);
            self.rejected += 1;
            length = growth.min(0.5) * (end - now);
        }
    }

    /// Takes a step whole, then again in two halves.
    fn whole_and_halves(&mut self, [now, middle, end]: [f64; 3]) -> Result<StatesReport> {
        self.step_to(now, end)?;
        self.whole.copy_from(self.contact);
        self.contact.copy_from(&self.before);
        self.step_to(now, middle)?;
        self.step_to(middle, end)
    }

    /// Difference of depth and force between the whole step and its halves, relative to values that are not small in this run.
    fn error_of_whole(&mut self) -> f64 {
        let [whole, halves] = [&self.whole, &*self.contact].map(|contact| [contact.depth(), contact.force()]);
        let mut error = 0.0f64;
        for k in 0..2 {
            self.greatest[k] = self.greatest[k].max(halves[k].abs());
            let scale = halves[k].abs().max(0.1 * self.greatest[k]);
            if scale > 0.0 {
                error = error.max((whole[k] - halves[k]).abs() / scale);
            }
        }
        error
    }

    /// Number of steps rejected for their error, with [`Stepping::adaptive`].
    pub fn rejected_steps(&self) -> u64 {
        self.rejected
    }

    /// The contact after the last step.
    pub fn contact(&self) -> &StatesContact {
        self.contact
    }
}
