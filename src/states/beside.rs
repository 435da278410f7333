//! The pressure of a run in space at any time, from elastic contacts beside it.
//!
//! The run is repeated on levels, in steps graded towards the time: they cost no contact problem, and c(t) and w(l, t) are as those of the
//! bodies. Then a few elastic contacts give the pressure ([`twin`](crate::states::twin)). Under a given approach c(t) depends on the shape: the
//! curve δ(l) goes through a few elastic contacts at first, and through each that is solved for a field from then on.

use std::sync::Arc;

use crate::contact::ViscoelasticContact;
use crate::error::Result;
use crate::hereditary::Interpolant;
use crate::load::{Load, LoadHistory, Tilt};
use crate::run::Stepping;
use crate::states::contact::StatesContact;
use crate::states::curve::{ElasticStates, Rest};
use crate::states::elastic::ElasticContact;
use crate::states::pressed::Pressed;
use crate::states::reach::{Course, MARGIN, greatest};
use crate::states::twin::Profile;

/// Levels of the first elastic contacts, from the greatest of the run: so many, each over the next.
const FIRST_LEVELS: i32 = 5;
const RATIO: f64 = 8.0;
/// Number of even parts of a run at which its load and its level are sampled.
const PARTS: u32 = 512;
/// Parts of the accuracy: error of the level of the repeated run, of the elastic contacts, and of the level on the curve.
const OF_LEVEL: f64 = 0.03;
const OF_SOLVER: f64 = 1e-3;
const OF_CURVE: f64 = 0.05;
/// Fall of a pressure, over the greatest, that is taken for an error of a solver of this tolerance.
const FALL_OVER_TOLERANCE: f64 = 1e2;
/// The accuracy of a field holds relative to this part of the greatest force at least.
const LEAST_FORCE: f64 = 0.01;
/// Attempts to find the level on the curve.
const MOST_ATTEMPTS: u32 = 4;
/// States of the curve nearer than this factor of the level are one.
const NEAREST: f64 = 1e-6;
/// Amplification of bodies without elastic response, and levels of the curve beyond its last one, over that.
const WITHOUT_RESPONSE: f64 = 10.0;
const BEYOND: f64 = 16.0;
/// The last step before a time, over the time since the start.
const LAST_STEP: f64 = 1e-5;

/// Repeats a run on levels.
#[derive(Debug, Clone)]
pub struct Repeated {
    /// The contact at the start of the run.
    origin: StatesContact,
    accuracy: f64,
    /// Tolerance of its adaptive steps.
    tolerance: f64,
}

/// A contact on levels at a time, and the times and levels of its steps.
pub(crate) struct Found {
    pub(crate) contact: StatesContact,
    steps: Vec<(f64, f64)>,
    /// The greatest force so far.
    force: f64,
}

impl Repeated {
    /// A run from `origin`, whose level counts so many times in the pressure.
    pub(crate) fn new(origin: StatesContact, accuracy: f64, amplification: f64) -> Repeated {
        let tolerance = (OF_LEVEL * accuracy / amplification.max(1.0)).clamp(1e-8, 1e-4);
        Repeated { origin, accuracy, tolerance }
    }

    /// The contact at a time, after a jump of the load there or before it.
    pub(crate) fn at(&self, history: &dyn LoadHistory, time: f64, after: bool) -> Result<Found> {
        let (mut contact, start) = (self.origin.clone(), self.origin.time());
        let (mut stops, mut left, rest) = (Vec::new(), 1.0, 1.0 - self.accuracy.sqrt());
        while left > LAST_STEP {
            left *= rest;
            stops.push(time - (time - start) * left);
        }
        let mut run = contact.follow(history, Stepping::adaptive(self.tolerance), time).stop_at(stops)?;
        let (mut steps, mut force) = (vec![(start, 0.0)], 0.0);
        while let Some(report) = run.next_step()? {
            steps.push((report.time, run.contact().level()));
            force = report.force.max(force);
            if report.time >= time && report.dt > 0.0 && !after {
                break;
            }
        }
        drop(run);
        Ok(Found { contact, steps, force })
    }

    /// The contact at a time, by steps with these ends.
    fn by_steps(&self, history: &dyn LoadHistory, ends: &[f64], (time, after): (f64, bool)) -> Result<StatesContact> {
        let mut contact = self.origin.clone();
        contact.step_to(contact.time(), 0.0, history.checked_at(contact.time(), false)?)?;
        for end in ends.iter().copied().filter(|end| *end < time).chain([time]) {
            let now = contact.time();
            if end > now {
                contact.step_to(end, end - now, history.checked_before(end, false)?)?;
            }
            let (jump, before) = (history.checked_at(end, false)?, history.checked_before(end, false)?);
            if jump != before && (end < time || after) {
                contact.step_to(end, 0.0, jump)?;
            }
            if history.next_breakpoint(now).is_some_and(|corner| corner <= end) {
                contact.reset_differences();
            }
        }
        Ok(contact)
    }
}

impl Found {
    fn size(&self) -> f64 {
        self.contact.force().max(LEAST_FORCE * self.force)
    }

    /// The time from which on the contact has been larger than at this level.
    fn since(&self, level: f64) -> f64 {
        let after = self.steps.iter().rposition(|step| step.1 < level * (1.0 - NEAREST));
        after.map_or(self.steps[0].0, |k| self.steps.get(k + 1).unwrap_or(&self.steps[k]).0)
    }
}

/// The fields of a run in space.
#[derive(Debug)]
pub struct Beside {
    repeated: Repeated,
    elastic: ElasticContact,
    tilt: [Tilt; 2],
    /// Level, depth and area of the elastic contacts that the curve goes through, and whether it matters.
    rows: Vec<[f64; 3]>,
    by_force: bool,
    rest: f64,
    allowed_fall: f64,
    /// Elastic contacts solved since the last field.
    spent: usize,
    serves: bool,
}

/// A pressure on the grid.
pub(crate) struct FoundPressure {
    pub(crate) pressure: Vec<f64>,
    pub(crate) error: f64,
    /// Elastic contacts solved, and convolutions.
    pub(crate) contacts: usize,
    pub(crate) convolutions: usize,
}

impl Beside {
    /// For a run from the undisturbed contact, with steps of this kind; `None` where elastic contacts give no field: tilts change, the
    /// material has no series, or a contact shrinks somewhere as its load grows.
    pub(crate) fn new(
        contact: &ViscoelasticContact,
        course: &Course<'_>,
        accuracy: f64,
        interpolant: Interpolant,
    ) -> Result<Option<Beside>> {
        let all = course.sampled(PARTS)?;
        let (tilt, start) = (all[0].tilt(), contact.time());
        let is_force = |load: &Load| matches!(load, Load::Force { .. });
        let (by_force, is_free) = (all.iter().all(is_force), tilt.iter().any(|tilt| matches!(tilt, Tilt::Free { .. })));
        if course.material.contact_spectrum()?.is_none() || all.iter().any(|load| load.tilt() != tilt) {
            return Ok(None);
        }
        if !by_force && is_free {
            return Ok(None);
        }
        let tolerance = (OF_SOLVER * accuracy).max(1e-9);
        let mut elastic = ElasticContact::of(contact.of_unit_compliance(tolerance)?);
        let rest = elastic.under(Load::Force { normal: 0.0, tilt })?.approach();
        let mut top = 0.0_f64;
        if by_force {
            top = course.greatest_level(tilt, interpolant, PARTS)?;
        } else {
            for load in greatest(&all, course.softest_compliance()?) {
                top = top.max(MARGIN * elastic.under(load)?.force());
            }
        }
        if top == 0.0 {
            return Ok(None);
        }
        let (glassy, softest) = (course.material.contact_compliance(0.0), course.softest_compliance()?);
        let amplification = match by_force {
            true if glassy > 0.0 => softest / glassy,
            true => WITHOUT_RESPONSE,
            false => 1.0,
        };
        let origin = StatesContact::new(&ElasticStates::sphere(1.0)?, course.material)?;
        let mut beside = Beside {
            repeated: Repeated::new(origin, accuracy, amplification),
            elastic,
            tilt,
            rows: Vec::new(),
            by_force,
            rest,
            allowed_fall: FALL_OVER_TOLERANCE * tolerance,
            spent: 0,
            serves: true,
        };
        let mut below: Option<Solved> = None;
        for k in (0..FIRST_LEVELS).rev() {
            let level = top * RATIO.powi(-k);
            let next = beside.solve(level)?;
            let shrinks = below.is_some_and(|below| beside.check(&below, &next).is_err());
            beside.serves &= !shrinks;
            below = Some(next);
        }
        let mut origin = course.contact(&beside.curve()?, interpolant)?;
        if start > 0.0 {
            origin.step_to(start, start, Load::Force { normal: 0.0, tilt })?;
        }
        beside.repeated.origin = origin;
        Ok(Some(beside))
    }

    /// Solves an elastic contact, and adds it to the curve.
    fn solve(&mut self, level: f64) -> Result<Solved> {
        self.spent += 1;
        let (pressure, approach, area, convolutions) = self.elastic.pressed(Load::Force { normal: level, tilt: self.tilt })?;
        let depth = if self.by_force { level.powf(2.0 / 3.0) } else { approach - self.rest };
        let at = self.rows.partition_point(|row| row[0] < level);
        let is_new = |row: &[f64; 3]| (row[0] / level - 1.0).abs() > NEAREST && (row[1] > depth) == (row[0] > level);
        let fits = self.rows[at.saturating_sub(1)..].iter().take(2).all(is_new);
        if fits && depth > 0.0 {
            self.rows.insert(at, [level, depth, area]);
        }
        Ok(Solved { level, pressure, convolutions })
    }

    /// Nowhere may the pressure fall while the load grows.
    fn check(&self, below: &Solved, above: &Solved) -> Result<()> {
        below.pressure.check_growth(&above.pressure, [below.level, above.level], self.allowed_fall)
    }

    /// δ(l) through all elastic contacts, with the slopes of parabolas of the logarithms.
    fn curve(&self) -> Result<Arc<ElasticStates>> {
        let slope = |k: usize| {
            let chord = |k: usize| {
                let [a, b] = [self.rows[k], self.rows[k + 1]];
                let width = (b[0] / a[0]).ln();
                ((b[1] / a[1]).ln() / width, width)
            };
            let last = self.rows.len() - 1;
            let ((below, left), (above, right)) = (chord(k.saturating_sub(1).min(last - 1)), chord(k.min(last - 1)));
            (below * right + above * left) / (left + right)
        };
        let row = |k: usize| {
            let ([level, depth, area], slope) = (self.rows[k], slope(k));
            (level, self.rest + depth, level / (depth * slope), area)
        };
        let last = self.rows.len() - 1;
        let ([level, depth, area], power) = (self.rows[last], slope(last));
        let (ratio, beyond) = (BEYOND.powf(power), BEYOND * level);
        let end = (beyond, self.rest + depth * ratio, beyond / (depth * ratio * power), area * ratio);
        let rows = (0..=last).map(row).chain([end]);
        let rest = Rest { approach: self.rest, tilt: [0.0; 2] };
        let mut states = ElasticStates::from_rows(rows, rest, [Tilt::Fixed(0.0); 2])?;
        Arc::make_mut(&mut states).tilt = self.tilt;
        Ok(states)
    }

    /// The pressure at a time, after a jump of the load there or before it.
    pub(crate) fn pressure(&mut self, history: &dyn LoadHistory, time: f64, after: bool) -> Result<FoundPressure> {
        let mut found = self.repeated.at(history, time, after)?;
        let mut solved: Vec<Solved> = Vec::new();
        let (mut convolutions, mut error) = (0, 0.0);
        for attempt in 1.. {
            let profile = Profile::new(found.contact.tractions());
            let top = found.contact.level();
            if attempt == 1 {
                let (levels, of_cuts) = profile.cuts(found.size(), self.repeated.accuracy);
                error = of_cuts;
                for level in levels {
                    solved.push(self.solve(level)?);
                }
            } else {
                solved.retain(|solved| solved.level < top * (1.0 - NEAREST));
                solved.push(self.solve(top)?);
            }
            if self.by_force || attempt == MOST_ATTEMPTS {
                break;
            }
            self.repeated.origin.exchange(self.curve()?);
            found = self.repeated.at(history, time, after)?;
            let change = (found.contact.level() - top).abs();
            if change * profile.amplification() <= OF_CURVE * self.repeated.accuracy * top {
                break;
            }
        }
        let mut pressure = vec![0.0; self.elastic.grid().len()];
        for pair in solved.windows(2) {
            self.check(&pair[0], &pair[1])?;
        }
        let levels: Vec<f64> = solved.iter().map(|solved| solved.level).collect();
        let shares: Vec<f64> = Profile::new(found.contact.tractions()).means(&levels).map(|(_, share)| share).collect();
        for (k, Solved { pressure: pressed, convolutions: of_level, .. }) in solved.iter().enumerate() {
            pressed.add_to(shares[k] - shares.get(k + 1).unwrap_or(&0.0), &mut pressure);
            convolutions += of_level;
        }
        Ok(FoundPressure { pressure, error, contacts: std::mem::take(&mut self.spent), convolutions })
    }

    /// Whether the elastic contacts give fields: none shrinks.
    pub(crate) fn serves(&self) -> bool {
        self.serves
    }

    /// Times before a time at which steps should end for the field there, and by how many times an error of the level counts in it.
    pub(crate) fn stops(&self, history: &dyn LoadHistory, time: f64) -> Result<(Vec<f64>, f64)> {
        let found = self.repeated.at(history, time, false)?;
        let profile = Profile::new(found.contact.tractions());
        let (levels, _) = profile.cuts(found.size(), self.repeated.accuracy);
        let amplification = if self.by_force { profile.amplification() } else { 1.0 };
        Ok((levels.into_iter().map(|level| found.since(level)).collect(), amplification))
    }

    /// The error of the pressure at a time by steps with these ends.
    pub(crate) fn error_of_steps(
        &self,
        history: &dyn LoadHistory,
        ends: &[f64],
        (time, after): (f64, bool),
    ) -> Result<f64> {
        let found = self.repeated.at(history, time, after)?;
        let taken = self.repeated.by_steps(history, ends, (time, after))?;
        Ok(Profile::new(found.contact.tractions()).distance(&Profile::new(taken.tractions()), found.size()))
    }
}

/// An elastic contact at a level.
struct Solved {
    level: f64,
    pressure: Pressed,
    convolutions: usize,
}
