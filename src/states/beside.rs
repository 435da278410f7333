//! The pressure of a run in space at any time, from elastic contacts beside it.
//!
//! The run is repeated on levels, in steps graded towards the time: they cost no contact problem, and the bodies have
//! the same c(t) and w(l, t). Then a few elastic [contacts](crate::states::contacts) give the pressure. Under a given
//! approach c(t) depends on the shape: the curve δ(l) goes through all elastic contacts of the run so far. Steps
//! twice as long, and curves through every second contact, measure what both leave; steps are halved and contacts
//! added until that is a small part of what was asked.

use std::sync::Arc;

use crate::contact::ViscoelasticContact;
use crate::error::{Error, Result};
use crate::hereditary::Interpolant;
use crate::load::{Load, LoadHistory, Tilt};
use crate::solver::RigidMotion;
use crate::states::contact::StatesContact;
use crate::states::contacts::{Contacts, NEAREST, Solved};
use crate::states::curve::ElasticStates;
use crate::states::reach::{Loading, MARGIN, greatest, sampled};
use crate::states::repeated::{Found, Repeated, undisturbed};

/// Levels of the first elastic contacts, from the greatest of the run: so many, each over the next.
const FIRST_LEVELS: i32 = 5;
const RATIO: f64 = 8.0;
/// Parts of the accuracy that the solver of an elastic body may leave, steps and the curve may, and the change of the
/// level by the contacts of a field; the rest is for its levels.
const OF_SOLVER: f64 = 1e-2;
const OF_RUN: f64 = 0.3;
const OF_CHANGE: f64 = 0.15;
/// Greatest number of contacts that are added to the curve for a field, and times that the field is found anew.
const MOST_ADDED: usize = 64;
const MOST_ATTEMPTS: u32 = 12;
/// The slope of the curve turns by so much of the greatest turn where contacts are added.
const OF_GREATEST_TURN: f64 = 0.25;
/// Levels of the curve beyond its last one, over that.
const BEYOND: f64 = 16.0;

/// The fields of a run in space.
#[derive(Debug)]
pub(super) struct Beside {
    repeated: Repeated,
    pub(super) contacts: Contacts,
    /// Level, depth and area of the elastic contacts that the curve goes through.
    rows: Vec<[f64; 3]>,
    by_force: bool,
    rest: f64,
}

/// A pressure on the grid.
pub(crate) struct FoundPressure {
    pub(crate) pressure: Vec<f64>,
    /// Infinite where nothing tells it.
    pub(crate) error: f64,
    /// Elastic contacts solved, and convolutions.
    pub(crate) spent: [usize; 2],
}

impl Beside {
    /// For a run from undisturbed bodies at a `start`, with steps of this kind; `None` where levels give no field:
    /// tilts change, or are free under a given approach, the material has no series, or nothing presses.
    /// [`StatesError::Shrinks`](crate::states::StatesError::Shrinks) where an elastic contact shrinks as its load
    /// grows.
    pub(crate) fn new(
        contact: &ViscoelasticContact,
        course: &Loading<'_>,
        accuracy: f64,
        (interpolant, start): (Interpolant, f64),
    ) -> Result<Option<Beside>> {
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
        let tolerance = (OF_SOLVER * accuracy / creep.max(1.0)).max(1e-9);
        let mut elastic = contact.elastic(1.0, tolerance)?;
        elastic.solve(Load::Force { normal: 0.0, tilt })?;
        let rest = elastic.fields().approach();
        let mut top = 0.0_f64;
        if by_force {
            let mut states = ElasticStates::sphere(1.0)?;
            Arc::make_mut(&mut states).tilt = tilt;
            let origin = undisturbed(course, &states, interpolant, start)?;
            top = MARGIN * Repeated::new(origin, course.history, course.until, accuracy)?.1;
        } else {
            for load in greatest(&all, course.softest_compliance()?) {
                elastic.solve(load)?;
                top = top.max(MARGIN * elastic.fields().force());
            }
        }
        if top == 0.0 {
            return Ok(None);
        }
        let (rows, contacts) = (Vec::new(), Contacts::new(elastic, tilt, tolerance));
        let repeated = Repeated::unknown(StatesContact::new(&ElasticStates::sphere(1.0)?, course.material)?, accuracy);
        let mut beside = Beside { repeated, contacts, rows, by_force, rest };
        let mut below: Option<Solved> = None;
        for k in (0..FIRST_LEVELS).rev() {
            let next = beside.contacts.solve(top * RATIO.powi(-k))?;
            below.iter().try_for_each(|below| beside.contacts.check(below, &next))?;
            beside.add(&next);
            below = Some(next);
        }
        let origin = undisturbed(course, &beside.curve_through(&beside.rows)?, interpolant, start)?;
        beside.repeated = Repeated::new(origin, course.history, course.until, accuracy)?.0;
        Ok(Some(beside))
    }

    /// Adds an elastic contact to the curve.
    fn add(&mut self, Solved { level, motion, area, .. }: &Solved) {
        let depth = if self.by_force { level.powf(2.0 / 3.0) } else { motion.approach - self.rest };
        let at = self.rows.partition_point(|row| row[0] < *level);
        let is_new = |row: &[f64; 3]| (row[0] / level - 1.0).abs() > NEAREST && (row[1] > depth) == (row[0] > *level);
        let fits = self.rows[at.saturating_sub(1)..].iter().take(2).all(is_new);
        if fits && depth > 0.0 {
            self.rows.insert(at, [*level, depth, *area]);
        }
    }

    /// δ(l) through all elastic contacts, with the slopes of parabolas of the logarithms.
    fn curve_through(&self, rows: &[[f64; 3]]) -> Result<Arc<ElasticStates>> {
        let slope = |k: usize| {
            let chord = |k: usize| {
                let [a, b] = [rows[k], rows[k + 1]];
                let width = (b[0] / a[0]).ln();
                ((b[1] / a[1]).ln() / width, width)
            };
            let last = rows.len() - 1;
            let ((below, left), (above, right)) = (chord(k.saturating_sub(1).min(last - 1)), chord(k.min(last - 1)));
            (below * right + above * left) / (left + right)
        };
        let row = |k: usize| {
            let ([level, depth, area], slope) = (rows[k], slope(k));
            (level, self.rest + depth, level / (depth * slope), area)
        };
        let last = rows.len() - 1;
        let ([level, depth, area], power) = (rows[last], slope(last));
        let (ratio, beyond) = (BEYOND.powf(power), BEYOND * level);
        let end = (beyond, self.rest + depth * ratio, beyond / (depth * ratio * power), area * ratio);
        let rows = (0..=last).map(row).chain([end]);
        let rest = RigidMotion { approach: self.rest, tilt: [0.0; 2] };
        let mut states = ElasticStates::from_rows(rows, rest, [Tilt::Fixed(0.0); 2])?;
        Arc::make_mut(&mut states).tilt = self.contacts.tilt;
        Ok(states)
    }

    /// Adds at most so many elastic contacts in the middle of others where the slope of the curve changes most: where
    /// cells join. Returns their number.
    fn refine_curve(&mut self, most_added: usize) -> Result<usize> {
        let width = |k: usize| (self.rows[k + 1][0] / self.rows[k][0]).ln();
        let slope = |k: usize| (self.rows[k + 1][1] / self.rows[k][1]).ln() / width(k);
        let last = self.rows.len() - 2;
        // the depth by which the slope turns
        let turn = |k: usize| {
            let beside = [k.saturating_sub(1), (k + 1).min(last)].map(|other| (slope(other) - slope(k)).abs());
            beside[0].max(beside[1]) * width(k) * self.rows[k + 1][1]
        };
        let turns: Vec<f64> = (0..=last).map(turn).collect();
        let most = turns.iter().copied().fold(0.0, f64::max);
        let middle = |k: usize| (self.rows[k][0] * self.rows[k + 1][0]).sqrt();
        let mut turning: Vec<usize> = (0..=last).filter(|k| turns[*k] >= OF_GREATEST_TURN * most).collect();
        turning.sort_by(|a, b| turns[*b].total_cmp(&turns[*a]));
        turning.truncate(most_added);
        let middles: Vec<f64> = turning.into_iter().map(middle).collect();
        for level in &middles {
            let solved = self.contacts.keep(*level)?;
            self.add(&solved);
        }
        Ok(middles.len())
    }

    /// The run to a time and what its steps and the curve leave, once that is a small part of what was asked or the
    /// curve has so many more contacts.
    fn settled(&mut self, history: &dyn LoadHistory, at: (f64, bool), most_added: &mut usize) -> Result<(Found, f64)> {
        let allowed = 0.5 * OF_RUN * self.repeated.accuracy;
        loop {
            let (mut found, of_steps) = self.repeated.in_short_steps(history, at, allowed)?;
            if self.by_force {
                return Ok((found, of_steps));
            }
            let mut of_curve = 0.0_f64;
            for first in 0..2 {
                of_curve = of_curve.max(match self.on_every_second(first, history, at) {
                    // curves through fewer contacts may leave the order of levels
                    Err(Error::States(_) | Error::Step(_)) => f64::INFINITY,
                    other => found.distance(&mut other?)?,
                });
            }
            if of_curve <= allowed || *most_added == 0 {
                return Ok((found, of_steps + of_curve));
            }
            *most_added -= self.refine_curve(*most_added)?;
            self.repeated = self.repeated.on(self.curve_through(&self.rows)?);
        }
    }

    /// The run to a time on the curve through every second of the elastic contacts, and the last.
    fn on_every_second(&self, first: usize, history: &dyn LoadHistory, (time, after): (f64, bool)) -> Result<Found> {
        let last = self.rows.len() - 1;
        let is_kept = |k: &usize| (k + first).is_multiple_of(2) || *k == 0 || *k == last;
        let rows: Vec<[f64; 3]> = (0..=last).filter(is_kept).map(|k| self.rows[k]).collect();
        self.repeated.on(self.curve_through(&rows)?).at(history, time, after)
    }

    /// The pressure at a time, after a jump of the load there or before it.
    pub(crate) fn pressure(&mut self, history: &dyn LoadHistory, time: f64, after: bool) -> Result<FoundPressure> {
        let accuracy = self.repeated.accuracy;
        // a field does not depend on the ones before
        self.contacts.forget();
        let mut most_added = MOST_ADDED;
        for attempt in 1.. {
            let (mut found, mut left) = self.settled(history, (time, after), &mut most_added)?;
            let (profile, size) = (found.profile(), found.size());
            let of_change = if self.by_force { 0.0 } else { OF_CHANGE };
            let rest = (1.0 - OF_SOLVER - of_change).mul_add(accuracy, -left).max(0.5 * accuracy);
            let superposition = self.contacts.superpose(&[(&profile, size)], rest)?;
            let mut is_settled = true;
            if !self.by_force {
                // the contact at the level of the old curve is on the new one
                superposition.solved.iter().for_each(|solved| self.add(solved));
                self.repeated = self.repeated.on(self.curve_through(&self.rows)?);
                let change = found.distance(&mut self.repeated.at(history, time, after)?)?;
                is_settled = change <= OF_CHANGE * accuracy || attempt == MOST_ATTEMPTS;
                left += change;
            }
            if is_settled {
                left += if superposition.solved.is_empty() { 0.0 } else { OF_SOLVER * accuracy };
                let [pressure] = superposition.fields.try_into().expect("one profile");
                let (error, spent) = (superposition.error + left, std::mem::take(&mut self.contacts.spent));
                return Ok(FoundPressure { pressure, error, spent });
            }
        }
        unreachable!("the last attempt returns")
    }
}
