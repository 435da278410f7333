//! A run repeated on levels, in steps graded towards a time.

use std::sync::Arc;

use crate::error::{Error, Result, StepError};
use crate::load::LoadHistory;
use crate::run::{Contact, Stepping};
use crate::states::contact::StatesContact;
use crate::states::curve::ElasticStates;
use crate::states::profile::Profile;

/// How the steps of a run are repeated on levels.
pub(super) struct Repetition {
    /// Tolerance of the steps that show how long steps of a run may be.
    coarse: f64,
    /// Maximum number of steps that are halved.
    most_halved: usize,
    /// Steps twice as long err by so many times more, the order being 2.
    of_longer: f64,
    /// Times that steps are halved where it is not known whether bodies touch.
    most_unknown: u32,
    /// Parts of the levels whose mean tractions are compared.
    parts_compared: usize,
    /// The shortest step, over the time since the start.
    shortest: f64,
    /// The last step before a time, over the time since the start.
    last_step: f64,
    /// The accuracy of a field holds relative to this part of the maximum force at least.
    pub(super) least_force: f64,
}

pub(super) const REPEATED: Repetition = Repetition {
    coarse: 1e-3,
    most_halved: 8000,
    of_longer: 3.0,
    most_unknown: 2,
    parts_compared: 16,
    shortest: 1e-7,
    last_step: 1e-5,
    least_force: 0.01,
};

/// Repeats a run on levels.
#[derive(Debug, Clone)]
pub(crate) struct GradedRun {
    /// The contact at the start of the run.
    origin: StatesContact,
    pub(super) accuracy: f64,
    /// Ends of steps that resolve the load, and what the bodies do under it.
    schedule: Arc<[f64]>,
    /// Times, and the maximum force until then: times far on leave out steps near the start.
    forces: Arc<[(f64, f64)]>,
    /// The part by which steps before a time are shorter than the one before.
    shortening: f64,
    /// Whether all loads are forces.
    by_force: bool,
}

/// A contact on levels at a time.
pub(crate) struct StateAt {
    pub(crate) contact: StatesContact,
    /// The greatest force so far.
    force: f64,
    by_force: bool,
}

impl GradedRun {
    /// A run from `origin`, under forces alone or not; and its greatest level.
    pub(crate) fn new(
        origin: StatesContact,
        history: &dyn LoadHistory,
        until: f64,
        (by_force, accuracy): (bool, f64),
    ) -> Result<(GradedRun, f64)> {
        let (mut contact, mut ends, mut greatest) = (origin.clone(), vec![origin.time()], 0.0_f64);
        let (mut force, mut forces) = (0.0_f64, Vec::new());
        let mut run = contact.follow(history, Stepping::adaptive(REPEATED.coarse), until);
        while let Some(report) = run.next_step()? {
            greatest = greatest.max(run.contact().level());
            ends.push(report.time);
            force = force.max(report.force);
            forces.push((report.time, force));
        }
        drop(run);
        let schedule = ends.windows(2).filter(|pair| pair[1] > pair[0]).map(|pair| pair[1]).collect();
        let (forces, shortening) = (forces.into(), accuracy.sqrt());
        Ok((GradedRun { origin, accuracy, schedule, forces, shortening, by_force }, greatest))
    }

    /// The run on other elastic states of the same surface.
    pub(super) fn on(&self, states: Arc<ElasticStates>) -> GradedRun {
        GradedRun { origin: StatesContact { states, ..self.origin.clone() }, ..self.clone() }
    }

    /// The contact at a time, in steps that are halved until they leave so little of the pressure, and what they leave.
    pub(super) fn in_short_steps(
        &mut self,
        history: &dyn LoadHistory,
        at: (f64, bool),
        allowed: f64,
    ) -> Result<(StateAt, f64)> {
        for attempt in 1.. {
            let mut found = self.at(history, at.0, at.1)?;
            let error = found.distance(&mut self.by_longer_steps(history, at)?)? / REPEATED.of_longer;
            // bodies that just touch stay apart by nothing in steps of any length
            let is_unknown = error.is_infinite() && attempt > REPEATED.most_unknown;
            if error <= allowed || is_unknown || !self.halve() {
                return Ok((found, error));
            }
        }
        unreachable!("steps are not halved without end")
    }

    /// Halves its steps; false where they are too many already.
    fn halve(&mut self) -> bool {
        // the ends graded towards a time are about as many as steps of its shortening
        if self.schedule.len() > REPEATED.most_halved || self.shortening * (REPEATED.most_halved as f64) < 1.0 {
            return false;
        }
        let start = self.origin.time();
        let starts = std::iter::once(start).chain(self.schedule.iter().copied());
        let halves = starts.zip(&*self.schedule).flat_map(|(start, end)| [0.5 * (start + end), *end]);
        self.schedule = halves.collect();
        self.shortening *= 0.5;
        true
    }

    /// Ends of its steps to a time.
    fn ends(&self, time: f64) -> Vec<f64> {
        let (mut ends, mut left) = (self.schedule.to_vec(), 1.0);
        while left > REPEATED.last_step {
            left *= 1.0 - self.shortening;
            ends.push(time - (time - self.origin.time()) * left);
        }
        ends.sort_by(f64::total_cmp);
        ends
    }

    /// The contact at a time, after a jump of the load there or before it.
    pub(crate) fn at(&self, history: &dyn LoadHistory, time: f64, after: bool) -> Result<StateAt> {
        self.by_steps(history, &self.ends(time), (time, after))
    }

    /// The same in steps twice as long, except where they end at corners of the load.
    fn by_longer_steps(&self, history: &dyn LoadHistory, at: (f64, bool)) -> Result<StateAt> {
        let mut corner = self.next_corner(history, self.origin.time());
        let is_kept = |(k, end): &(usize, f64)| {
            let is_corner = corner.is_some_and(|corner| corner <= *end);
            corner = if is_corner { self.next_corner(history, *end) } else { corner };
            is_corner || k % 2 == 1
        };
        let kept = self.ends(at.0).into_iter().enumerate().filter(is_kept).map(|(_, end)| end);
        self.by_steps(history, &kept.collect::<Vec<_>>(), at)
    }

    /// The first corner of a load after a time, along the surface as well.
    fn next_corner(&self, history: &dyn LoadHistory, after: f64) -> Option<f64> {
        let along = self.origin.lateral_history().iter().filter_map(|along| along.next_breakpoint(after));
        along.chain(history.next_breakpoint(after)).reduce(f64::min)
    }

    /// The contact at a time, by steps with these ends.
    fn by_steps(&self, history: &dyn LoadHistory, ends: &[f64], (time, after): (f64, bool)) -> Result<StateAt> {
        let mut contact = self.origin.clone();
        let start = contact.time();
        let seen = self.forces.partition_point(|(end, _)| *end < time || after && *end == time);
        let mut force = seen.checked_sub(1).map_or(0.0, |k| self.forces[k].1);
        let mut corner = self.next_corner(history, start);
        let along = self.origin.lateral_history();
        let jump = |contact: &mut StatesContact, time: f64| {
            match contact.step_to(time, 0.0, history.checked_at(time, false)?) {
                // the run stays as it was
                Err(Error::Step(StepError::NoElasticResponse { .. })) => Ok(()),
                other => other.map(drop),
            }
        };
        jump(&mut contact, start)?;
        let shortest = REPEATED.shortest * (time - start);
        let inner = ends.iter().copied().filter(|end| *end > start && *end < time - shortest);
        for end in inner.chain((time > start).then_some(time)) {
            let now = contact.time();
            if end - now < shortest && corner.is_none_or(|corner| corner > end) {
                continue;
            }
            let before = history.checked_before(end, false)?;
            contact.step_to(end, end - now, before)?;
            force = force.max(contact.force());
            let jumps_along = || along.iter().any(|along| along.at(end) != along.before(end));
            if (end < time || after) && (history.checked_at(end, false)? != before || jumps_along()) {
                jump(&mut contact, end)?;
                force = force.max(contact.force());
            }
            while let Some(next) = corner.filter(|corner| *corner <= end) {
                contact.levels.reset_differences();
                corner = self.next_corner(history, next);
            }
        }
        Ok(StateAt { contact, force, by_force: self.by_force })
    }
}

impl StateAt {
    pub(super) fn size(&self) -> f64 {
        self.contact.force().max(REPEATED.least_force * self.force)
    }

    pub(super) fn profile(&self) -> Profile {
        Profile::new(self.contact.tractions())
    }

    /// How far the bodies are apart \[m\].
    fn clearance(&mut self) -> Result<f64> {
        let time = self.contact.time();
        Ok(self.contact.surface_at(time)? - self.contact.depth())
    }

    /// How far the pressures of two repetitions are apart, in L1 over the force: infinite where both are apart by less
    /// than they differ in that.
    pub(super) fn distance(&mut self, other: &mut StateAt) -> Result<f64> {
        if !self.by_force && self.contact.level().max(other.contact.level()) == 0.0 {
            let [own, other] = [self.clearance()?, other.clearance()?];
            return Ok(if (own - other).abs() < own { 0.0 } else { f64::INFINITY });
        }
        let (own, size) = (self.profile(), self.size());
        let off = own.distance(&other.profile(), &own.cuts(REPEATED.parts_compared));
        // where nothing has pressed yet, one of them may have touched
        Ok(if off == 0.0 { 0.0 } else { off / size })
    }
}
