//! The pressure of a run in space at any time, from elastic contacts beside it.
//!
//! The run is repeated on levels, in steps graded towards the time: they cost no contact problem, and the bodies have
//! the same c(t) and w(l, t). Then a few elastic [contacts](crate::states::contacts) give the pressure. Under a given
//! approach c(t) depends on the shape: the curve δ(l) goes through all elastic contacts of the run so far. Steps
//! twice as long, and curves through every second contact, measure what both leave; steps are halved and contacts
//! added until that is a small part of what was asked.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::does_not_superpose;
use crate::contact::ViscoelasticContact;
use crate::elastic::ElasticContact;
use crate::equilibrium::Ground;
use crate::error::Result;
use crate::hereditary::Interpolant;
use crate::load::{Load, LoadHistory, Tilt};
use crate::states::contacts::{Contacts, SolvedContact};
use crate::states::reach::{Loading, MARGIN, greatest, sampled, states_of};
use crate::states::repeated::{GradedRun, StateAt};
use crate::states::solved_curve::SolvedCurve;

/// How levels are found for the fields of a run in cells.
struct Beside {
    /// Levels of the first elastic contacts, from the maximum of the run: so many, each over the next.
    first_levels: i32,
    ratio: f64,
    /// Parts of the accuracy that the solver of an elastic body may leave, steps and the curve may, and the change of
    /// the level by the contacts of a field; the rest is for its levels.
    of_solver: f64,
    of_run: f64,
    of_change: f64,
    /// Maximum number of contacts that are added to the curve for a field, and times that the field is found anew.
    most_added: usize,
    most_attempts: u32,
}

const BESIDE: Beside = Beside {
    first_levels: 5,
    ratio: 8.0,
    of_solver: 1e-2,
    of_run: 0.3,
    of_change: 0.15,
    most_added: 64,
    most_attempts: 12,
};

impl ViscoelasticContact {
    /// An elastic contact of this compliance with the same rigid bodies, solved to `tolerance` on the whole grid, but
    /// for mirror images.
    ///
    /// # Errors
    /// If there is no memory for it.
    fn elastic(&self, compliance: f64, tolerance: f64) -> Result<ElasticContact> {
        let own = &self.scene.ground;
        let settings = own.settings.with_tolerance(tolerance).with_window(false);
        let ground = Ground { settings, attraction: None, softening: 0.0, ..own.clone() };
        let indenter = Arc::clone(&self.computation.state.held.indenter);
        ElasticContact::new(Arc::new(ground), compliance, indenter)
    }
}

/// The fields of a run in space.
#[derive(Debug)]
pub(super) struct FieldsByLevels {
    repeated: GradedRun,
    pub(super) curve: SolvedCurve,
}

/// A pressure on the grid.
pub(crate) struct FoundPressure {
    pub(crate) pressure: Vec<f64>,
    /// Infinite where nothing tells it.
    pub(crate) error: f64,
    /// Elastic contacts solved, and convolutions.
    pub(crate) spent: [usize; 2],
}

impl FieldsByLevels {
    /// For a run from undisturbed bodies at a `start`, with steps of this kind; `None` where levels give no field:
    /// tilts change, or are free under a given approach, the material has no series, or nothing presses.
    /// [`Error::Shrinks`](crate::Error::Shrinks) where an elastic contact shrinks as its load
    /// grows.
    pub(crate) fn new(
        contact: &ViscoelasticContact,
        course: &Loading<'_>,
        accuracy: f64,
        (interpolant, start): (Interpolant, f64),
        cancelled: Option<&Arc<AtomicBool>>,
    ) -> Result<Option<FieldsByLevels>> {
        let all = sampled(course.history, [start, course.until])?;
        let tilt = all[0].tilt();
        let (by_force, is_free) =
            (all.iter().all(Load::is_force), tilt.iter().any(|tilt| matches!(tilt, Tilt::Free { .. })));
        let is_other = |load: &Load| load.tilt() != tilt;
        if course.material.contact_spectrum()?.is_none() || all.iter().any(is_other) || !by_force && is_free {
            return Ok(None);
        }
        // errors of two contacts count in their difference as many times as the bodies creep
        let creep = course.softest_compliance()? / course.material.contact_compliance(0.0);
        let tolerance = (BESIDE.of_solver * accuracy / creep.max(1.0)).max(1e-9);
        let mut contacts = Contacts::new(contact.elastic(1.0, tolerance)?, tilt, tolerance);
        contacts.cancelled = cancelled.cloned();
        contacts.solve_under(Load::Force { normal: 0.0, tilt })?;
        let rest = contacts.elastic.fields().approach();
        let mut top = 0.0_f64;
        if by_force {
            let origin = course.undisturbed(&states_of(tilt)?, interpolant, start)?;
            top = MARGIN * GradedRun::new(origin, course.history, course.until, (by_force, accuracy))?.1;
        } else {
            for load in greatest(&all, course.softest_compliance()?) {
                contacts.solve_under(load)?;
                top = top.max(MARGIN * contacts.elastic.fields().force());
            }
        }
        if top == 0.0 {
            return Ok(None);
        }
        let mut curve = SolvedCurve::new(contacts, by_force, rest);
        let mut below: Option<SolvedContact> = None;
        for k in (0..BESIDE.first_levels).rev() {
            let next = curve.contacts.solve(top * BESIDE.ratio.powi(-k))?;
            below.iter().try_for_each(|below| curve.contacts.check(below, &next))?;
            curve.add(&next);
            below = Some(next);
        }
        let origin = course.undisturbed(&curve.through(1, 0)?, interpolant, start)?;
        let (repeated, _) = GradedRun::new(origin, course.history, course.until, (by_force, accuracy))?;
        Ok(Some(FieldsByLevels { repeated, curve }))
    }

    /// The run to a time and what its steps and the curve leave, once that is a small part of what was asked or the
    /// curve has so many more contacts.
    fn settled(
        &mut self,
        history: &dyn LoadHistory,
        at: (f64, bool),
        most_added: &mut usize,
    ) -> Result<(StateAt, f64)> {
        let allowed = 0.5 * BESIDE.of_run * self.repeated.accuracy;
        loop {
            let (mut found, of_steps) = self.repeated.in_short_steps(history, at, allowed)?;
            if self.curve.by_force {
                return Ok((found, of_steps));
            }
            let mut of_curve = 0.0_f64;
            for first in 0..2 {
                let fewer = self.repeated.on(self.curve.through(2, first)?);
                of_curve = of_curve.max(match fewer.at(history, at.0, at.1) {
                    // curves through fewer contacts may leave the order of levels
                    Err(error) if does_not_superpose(&error) => f64::INFINITY,
                    other => found.distance(&mut other?)?,
                });
            }
            if of_curve <= allowed || *most_added == 0 {
                return Ok((found, of_steps + of_curve));
            }
            *most_added -= self.curve.refine(*most_added)?;
            self.repeated = self.repeated.on(self.curve.through(1, 0)?);
        }
    }

    /// The pressure at a time, after a jump of the load there or before it.
    pub(crate) fn pressure(&mut self, history: &dyn LoadHistory, time: f64, after: bool) -> Result<FoundPressure> {
        let accuracy = self.repeated.accuracy;
        // a field does not depend on the ones before
        self.curve.contacts.forget();
        let mut most_added = BESIDE.most_added;
        for attempt in 1.. {
            let (mut found, mut left) = self.settled(history, (time, after), &mut most_added)?;
            let (profile, size) = (found.profile(), found.size());
            let of_change = if self.curve.by_force { 0.0 } else { BESIDE.of_change };
            let rest = (1.0 - BESIDE.of_solver - of_change).mul_add(accuracy, -left).max(0.5 * accuracy);
            let superposition = self.curve.contacts.superpose(&[(&profile, size)], rest)?;
            let mut is_settled = true;
            if !self.curve.by_force {
                // the contact at the level of the old curve is on the new one
                superposition.solved.iter().for_each(|solved| self.curve.add(solved));
                self.repeated = self.repeated.on(self.curve.through(1, 0)?);
                let change = found.distance(&mut self.repeated.at(history, time, after)?)?;
                is_settled = change <= BESIDE.of_change * accuracy || attempt == BESIDE.most_attempts;
                left += change;
            }
            if is_settled {
                left += if superposition.solved.is_empty() { 0.0 } else { BESIDE.of_solver * accuracy };
                let [pressure] = superposition.fields.try_into().expect("one profile");
                let (error, spent) = (superposition.error + left, std::mem::take(&mut self.curve.contacts.spent));
                return Ok(FoundPressure { pressure, error, spent });
            }
        }
        unreachable!("the last attempt returns")
    }
}
