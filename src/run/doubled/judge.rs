//! How the doubled steps of a kind of contact are judged, and what is known of their run.

use std::fmt::Debug;
#[cfg(feature = "checkpoint")]
use std::path::Path;

use std::sync::atomic::AtomicBool;

use crate::contact::StepReport;
use crate::error::{Error, Result};
use crate::load::{Load, LoadHistory};
use crate::run::Contact;
#[cfg(feature = "checkpoint")]
use crate::run::doubled::SavedRun;
use crate::run::passage::{Passage, Span};
use crate::run::trace::{bends, looks};

/// First step after a jump or a corner, over the time to the next one.
pub(in crate::run) const FIRST_STEP: f64 = 1e-4;
/// Limit of the ratio of a step to the one before.
pub(crate) const MAX_GROWTH: f64 = 4.0;
/// Where there is no order, as in a first step and where bodies touch or part, halves may be no better than the whole.
pub(crate) const WITHOUT_ORDER: f64 = 2.0;
/// Depths and forces below this part of their maximum, or of what is expected of it, count as if they were as large.
pub(crate) const SMALL: f64 = 0.1;

/// What a kind of contact knows of its steps, and keeps of a run, which a file holds as well.
pub(crate) trait Judge<C: Contact>: Default + Clone + Debug + Send + Sync + 'static {
    /// The power of its length with which the error of a step grows, by which the next one is chosen.
    const ORDER: f64;

    /// Force, or depth of the body or of the far end of its spring.
    fn size(contact: &C, load: Load) -> Result<f64>;

    /// The approach at which undisturbed bodies touch.
    fn rest(_: &C) -> f64 {
        0.0
    }

    /// Sees the times and sizes of the loads of the run, before the first step.
    fn look(_: &mut Record<Self>, _: &[(f64, f64)]) {}

    /// A contact that tries steps.
    fn trial(contact: &C) -> C {
        contact.clone()
    }

    /// Takes over the state of a contact.
    fn copy(to: &mut C, from: &C) {
        to.clone_from(from);
    }

    /// A step of a trial.
    fn take(contact: &mut C, time: f64, load: Load, cancelled: Option<&AtomicBool>) -> Result<StepReport> {
        contact.step_to_unless(cancelled, time, load)
    }

    /// Sees the state at the end of an accepted step.
    fn accept(_: &Record<Self>, _: &mut C) {}

    /// Starts differences of steps anew.
    fn turn(_: &mut C) {}

    /// The most that a step towards this load may be longer than the one before.
    fn longest_growth(_: &C, _: Load) -> f64 {
        MAX_GROWTH
    }

    /// Whether what a step did begins the time anew that aims count from, as a corner does.
    fn begins_anew(_before: &C, _after: &C) -> bool {
        false
    }

    /// The error that a step aims at, counted from the last corner.
    fn aim(record: &Record<Self>, contact: &C, span: Span, corner: f64) -> f64;

    /// The first time within a step at which it has to end: where bodies touch or part, or a force begins or ends.
    fn event(
        record: &Record<Self>,
        contact: &C,
        history: &dyn LoadHistory,
        passage: &Passage,
        scratch: &mut C,
    ) -> Result<Option<f64>>;

    /// The error of the halves of a step from the state of `contact`.
    fn error(
        record: &Record<Self>,
        contact: &C,
        tries: &mut Tries<C>,
        history: &dyn LoadHistory,
        span: Span,
        report: &StepReport,
    ) -> Result<f64>;

    /// Saves a contact with a run that continues from there.
    #[cfg(feature = "checkpoint")]
    fn save(contact: &C, run: SavedRun<Self>, path: &Path) -> Result<()>;

    /// Maximum approach and force of the run, the step that was tried included, for errors relative to them.
    fn greatest(record: &Record<Self>, halves: &C) -> [f64; 2];
}

/// Outcomes of one step: taken whole, in halves, and after the first half.
#[derive(Debug, Clone)]
pub(crate) struct Tries<C> {
    pub(crate) whole: C,
    pub(crate) halves: C,
    pub(crate) middle: C,
}

/// What the control knows of the run: all that a run from a file needs.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Record<J> {
    /// The load that acts, and the one along the surface; unknown before the first step.
    pub(in crate::run) loads: Vec<Load>,
    pub(crate) tolerance: f64,
    pub(crate) start: f64,
    pub(crate) until: f64,
    /// Length of the next step; 0 after a jump or a corner.
    pub(crate) next: f64,
    /// Time of the last jump or corner.
    pub(crate) corner: f64,
    /// Whether the last step ended where bodies touched.
    pub(crate) touches: bool,
    /// Whether forces are given throughout the run.
    pub(crate) by_force: bool,
    pub(crate) greatest: [f64; 2],
    /// Times at which the load of the run bends, unknown before it was looked at, and its maximum.
    pub(in crate::run) bends: Option<Vec<f64>>,
    pub(crate) greatest_load: f64,
    /// The same of what acts along the surface.
    pub(in crate::run) bends_along: Vec<f64>,
    pub(crate) greatest_along: [f64; 3],
    /// Loads below this one are lost in rounding.
    pub(crate) least_load: f64,
    /// Maximum error of an adaptive step.
    pub(in crate::run) worst: Option<f64>,
    pub(in crate::run) rejected: u64,
    pub(crate) own: J,
}

impl<J> Record<J> {
    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self) -> bool {
        let sizes =
            [&[self.next, self.greatest_load, self.least_load][..], &self.greatest, &self.greatest_along].concat();
        let times = self.bends.iter().flatten().chain(&self.bends_along).copied();
        sizes.iter().all(|&size| size >= 0.0)
            && times.chain([self.start, self.until, self.next, self.corner]).all(f64::is_finite)
            && self.bends.as_ref().is_none_or(|bends| bends.is_sorted())
            && self.bends_along.is_sorted()
    }

    /// Forces along the surface below these are lost in the rounding of the forces of the run. A normal load that is lost
    /// carries none, and friction can carry about as much as presses.
    pub(in crate::run) fn least_along(&self) -> [f64; 3] {
        let most = if self.by_force { self.greatest_load } else { 0.0 };
        self.greatest_along.map(|greatest| if greatest > 0.0 { f64::EPSILON * greatest.max(most) } else { 0.0 })
    }

    /// Looks at the load of the run, which fails where there is none. A load that the contact has no size for fails
    /// the step to it.
    pub(in crate::run) fn look<C: Contact>(&mut self, contact: &C, history: &dyn LoadHistory) -> Result<()>
    where
        J: Judge<C>,
    {
        let (mut loads, mut forces, mut others) = (Vec::new(), false, false);
        for look in looks(history, contact.time(), self.until, contact.attracts()) {
            let (time, [before, at]) = look?;
            for load in [before, at].into_iter().skip(usize::from(before == at)) {
                (forces, others) = (forces || load.is_force(), others || !load.is_force());
                loads.extend(J::size(contact, load).ok().map(|load| (time, load)));
            }
        }
        (self.bends, self.by_force) = (Some(bends(&loads)), self.by_force && !others);
        // a run that goes on has had others
        self.greatest_load = loads.iter().fold(self.greatest_load, |most, load| load.1.max(most));
        // of forces or of depths
        self.least_load = if forces != others { f64::EPSILON * self.greatest_load } else { 0.0 };
        self.bends_along.clear();
        for (along, greatest) in contact.lateral().iter().zip(&mut self.greatest_along) {
            let looks = looks(&**along, contact.time(), self.until, true);
            let pairs = looks.map(|look| look.map(|(time, [before, at])| [(time, before.main()), (time, at.main())]));
            let seen = pairs.collect::<Result<Vec<_>>>().map_err(Error::along)?.concat();
            self.bends_along.extend(bends(&seen));
            *greatest = seen.iter().fold(*greatest, |most, (_, load)| load.abs().max(most));
        }
        self.bends_along.sort_by(f64::total_cmp);
        J::look(self, &loads);
        Ok(())
    }
}
