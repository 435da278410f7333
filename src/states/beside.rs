//! The pressure of a run in space at any time, from elastic contacts beside it.
//!
//! The run is repeated on levels, in steps graded towards the time: they cost no contact problem, and the bodies have
//! the same c(t) and w(l, t). Then a few elastic contacts give the pressure ([`twin`](crate::states::twin)). Under a
//! given approach c(t) depends on the shape: the curve δ(l) goes through a few elastic contacts at first, and through
//! each that is solved for a field from then on.

use std::sync::Arc;

use crate::contact::ViscoelasticContact;
use crate::elastic::ElasticContact;
use crate::error::{Error, Result};
use crate::hereditary::Interpolant;
use crate::load::{Load, LoadHistory, Tilt};
use crate::solver::RigidMotion;
use crate::states::contact::StatesContact;
use crate::states::curve::ElasticStates;
use crate::states::pressed::Pressed;
use crate::states::reach::{Loading, MARGIN, greatest, sampled};
use crate::states::repeated::{Found, NEAREST, Repeated, undisturbed};
use crate::states::twin::Profile;

/// Levels of the first elastic contacts, from the greatest of the run: so many, each over the next.
const FIRST_LEVELS: i32 = 5;
const RATIO: f64 = 8.0;
/// Number of even parts of a run at which its load is sampled.
const PARTS: u32 = 512;
/// Parts of the accuracy: error of the elastic contacts, of the level on the curve, and of the steps on levels.
const OF_SOLVER: f64 = 1e-3;
const OF_CURVE: f64 = 0.05;
const OF_STEPS: f64 = 0.1;
/// Steps on levels twice as long err by so many times more, the order being 2.
const OF_LONGER: f64 = 3.0;
/// Bodies that creep by more take elastic contacts of so many times less error, up to the last factor: their errors
/// count as many times in a difference of two, and in what is left of a given approach.
const MODERATE: f64 = 10.0;
const MOST_TIGHTENED: f64 = 1e3;
/// Fall of a pressure, over the greatest, that is taken for an error of a solver of this tolerance.
const FALL_OVER_TOLERANCE: f64 = 1e2;
/// Attempts to find the level on the curve, and most elastic contacts that refine it for one field.
const MOST_ATTEMPTS: u32 = 12;
const MOST_REFINED: usize = 64;
/// The curve is refined between levels that differ by more, in logarithms, and whose slope turns by this part of the
/// greatest turn; its error is the error of a curve through every second contact over this, as at kinks.
const FINEST: f64 = 2e-3;
const OF_GREATEST_TURN: f64 = 0.25;
const OF_SECOND: f64 = 3.0;
/// A kink between two contacts is off a smooth curve by its turn over this.
const OF_KINK: f64 = 8.0;
/// An error of the level counts so many times in the pressure, besides its amplification.
const OF_LEVEL: f64 = 2.0;
/// Levels of the curve beyond its last one, over that.
const BEYOND: f64 = 16.0;
/// Half of the levels err by so much more, the order being 3/2; twins, whose rims no mesh blurs, by so many times too
/// much at most.
const OF_HALF: f64 = 1.83;
const MOST_OVERSTATED: f64 = 3.0;

/// The fields of a run in space.
#[derive(Debug)]
pub(super) struct Beside {
    repeated: Repeated,
    elastic: ElasticContact,
    tilt: [Tilt; 2],
    /// Level, depth and area of the elastic contacts that the curve goes through, and whether it matters.
    rows: Vec<[f64; 3]>,
    by_force: bool,
    /// w of a contact that is made.
    glass: f64,
    rest: f64,
    allowed_fall: f64,
    /// Elastic contacts solved since the last field, and their convolutions.
    spent: [usize; 2],
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
        let all = sampled(course.history, [start, course.until], PARTS)?;
        let tilt = all[0].tilt();
        let (by_force, is_free) =
            (all.iter().all(Load::is_force), tilt.iter().any(|tilt| matches!(tilt, Tilt::Free { .. })));
        let is_other = |load: &Load| load.tilt() != tilt;
        if course.material.contact_spectrum()?.is_none() || all.iter().any(is_other) || !by_force && is_free {
            return Ok(None);
        }
        let creep = course.softest_compliance()? / course.material.contact_compliance(0.0);
        let tolerance = (OF_SOLVER * accuracy / (creep / MODERATE).clamp(1.0, MOST_TIGHTENED)).max(1e-9);
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
        let origin = StatesContact::new(&ElasticStates::sphere(1.0)?, course.material)?;
        let mut beside = Beside {
            repeated: Repeated::unknown(origin, accuracy),
            elastic,
            tilt,
            rows: Vec::new(),
            by_force,
            glass: 1.0 / course.material.contact_compliance(0.0),
            rest,
            allowed_fall: FALL_OVER_TOLERANCE * tolerance,
            spent: [0; 2],
        };
        let mut below: Option<Solved> = None;
        for k in (0..FIRST_LEVELS).rev() {
            let level = top * RATIO.powi(-k);
            let next = beside.solve(level)?;
            below.iter().try_for_each(|below| beside.check(below, &next))?;
            below = Some(next);
        }
        let origin = undisturbed(course, &beside.curve_through(&beside.rows)?, interpolant, start)?;
        beside.repeated = Repeated::new(origin, course.history, course.until, accuracy)?.0;
        Ok(Some(beside))
    }

    /// Solves an elastic contact, and adds it to the curve.
    fn solve(&mut self, level: f64) -> Result<Solved> {
        let report = self.elastic.solve(Load::Force { normal: level, tilt: self.tilt })?;
        self.spent = [self.spent[0] + 1, self.spent[1] + report.convolutions];
        let depth = if self.by_force { level.powf(2.0 / 3.0) } else { self.elastic.fields().approach() - self.rest };
        let at = self.rows.partition_point(|row| row[0] < level);
        let is_new = |row: &[f64; 3]| (row[0] / level - 1.0).abs() > NEAREST && (row[1] > depth) == (row[0] > level);
        let fits = self.rows[at.saturating_sub(1)..].iter().take(2).all(is_new);
        if fits && depth > 0.0 {
            self.rows.insert(at, [level, depth, self.elastic.fields().contact_area()]);
        }
        Ok(Solved { level, pressure: Pressed::new(self.elastic.fields().pressure()) })
    }

    /// Nowhere may the pressure fall while the load grows.
    fn check(&self, below: &Solved, above: &Solved) -> Result<()> {
        below.pressure.check_growth(&above.pressure, [below.level, above.level], self.allowed_fall)
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
        Arc::make_mut(&mut states).tilt = self.tilt;
        Ok(states)
    }

    /// The run to a time on the curve through some of the elastic contacts.
    fn on_curve(&self, rows: &[[f64; 3]], history: &dyn LoadHistory, (time, after): (f64, bool)) -> Result<Found> {
        self.repeated.on(self.curve_through(rows)?).at(history, time, after)
    }

    /// The width in logarithms of the interval above each elastic contact of the curve, and the depth by which the
    /// slope turns there.
    fn turns(&self) -> Vec<(f64, f64)> {
        let width = |k: usize| (self.rows[k + 1][0] / self.rows[k][0]).ln();
        let slope = |k: usize| (self.rows[k + 1][1] / self.rows[k][1]).ln() / width(k);
        let last = self.rows.len() - 2;
        let turn = |k: usize| {
            let beside = [k.saturating_sub(1), (k + 1).min(last)].map(|other| (slope(other) - slope(k)).abs());
            (width(k), beside[0].max(beside[1]) * width(k) * self.rows[k + 1][1])
        };
        (0..=last).map(turn).collect()
    }

    /// Adds elastic contacts in the middle of others where the slope of the curve changes most: where cells join.
    /// Returns their number.
    fn refine(&mut self) -> Result<usize> {
        let turns = self.turns();
        let is_wide = |k: &usize| turns[*k].0 > FINEST;
        let most = (0..turns.len()).filter(is_wide).map(|k| turns[k].1).fold(0.0, f64::max);
        let middle = |k: usize| (self.rows[k][0] * self.rows[k + 1][0]).sqrt();
        let refined = (0..turns.len()).filter(is_wide).filter(|k| turns[*k].1 >= OF_GREATEST_TURN * most);
        let middles: Vec<f64> = refined.map(middle).collect();
        middles.iter().try_for_each(|level| self.solve(*level).map(drop))?;
        Ok(middles.len())
    }

    /// Errors of the pressure for the error of the level on the curve, and for its change since `before`; and the run
    /// on the curve as it is now.
    fn error_of_level(&self, before: &Found, history: &dyn LoadHistory, at: (f64, bool)) -> Result<([f64; 2], Found)> {
        let last = self.rows.len() - 1;
        let is_second = |k: usize, row: usize| (row + k).is_multiple_of(2) || row == 0 || row == last;
        let second =
            |k: usize| (0..=last).filter(|row| is_second(k, *row)).map(|row| self.rows[row]).collect::<Vec<_>>();
        let [mut even, mut odd] = [self.on_curve(&second(0), history, at)?, self.on_curve(&second(1), history, at)?];
        let mut found = self.repeated.at(history, at.0, at.1)?;
        // δp = w(c) δc at the rim, and as much less within; one of the curves may still touch where the others part
        let mut density = before.density().max(found.density()).max(even.density()).max(odd.density());
        let level = found.contact.level();
        let mut off = (level - even.contact.level()).abs().max((level - odd.contact.level()).abs());
        if level == 0.0 {
            // apart by less than what the curves may err by?
            let [own, even, odd] = [found.clearance()?, even.clearance()?, odd.clearance()?];
            let of_kinks = self.turns().into_iter().map(|(_, turn)| turn).fold(0.0, f64::max) / OF_KINK;
            let nearer = ((own - even).abs().max((own - odd).abs()) / OF_SECOND).max(of_kinks) - own;
            let touched = found.contact.states().level_where(0.0, nearer);
            (off, density) = (off.max(OF_SECOND * touched), density.max(self.glass));
        }
        let amplified = |off: f64| if off == 0.0 { 0.0 } else { OF_LEVEL * density * off.abs() / found.size() };
        let [of_curve, change] = [amplified(off) / OF_SECOND, amplified(level - before.contact.level())];
        Ok(([of_curve, change], found))
    }

    /// The run to a time on the curve as it is, in steps that are short enough, and the error that they leave.
    fn in_short_steps(&mut self, history: &dyn LoadHistory, at: (f64, bool)) -> Result<(Found, f64)> {
        loop {
            let found = self.repeated.at(history, at.0, at.1)?;
            let longer = self.repeated.by_longer_steps(history, at)?;
            let [own, longer] = [&found, &longer].map(|found| Profile::new(found.contact.tractions()));
            let error = own.distance(&longer, found.size()) / OF_LONGER;
            if error <= OF_STEPS * self.repeated.accuracy || !self.repeated.halve() {
                return Ok((found, error));
            }
        }
    }

    /// The pressure at a time, after a jump of the load there or before it.
    pub(crate) fn pressure(&mut self, history: &dyn LoadHistory, time: f64, after: bool) -> Result<FoundPressure> {
        let (mut found, of_steps) = self.in_short_steps(history, (time, after))?;
        let mut solved: Vec<Solved> = Vec::new();
        let (mut error, mut of_level, mut refined) = (0.0, 0.0, 0);
        // the bodies have not touched yet
        let most_attempts = if found.size() > 0.0 { MOST_ATTEMPTS } else { 0 };
        if most_attempts == 0 && !self.by_force {
            // unless they are apart by less than what the curve may err by
            of_level = match self.error_of_level(&found, history, (time, after)) {
                Err(Error::States(_) | Error::Step(_)) => f64::INFINITY,
                other => other?.0[0],
            };
        }
        for attempt in 1..=most_attempts {
            let profile = Profile::new(found.contact.tractions());
            let top = found.contact.level();
            solved.retain(|solved| solved.level < top * (1.0 - NEAREST));
            let levels: Vec<f64> = solved.iter().map(|solved| solved.level).chain([top]).collect();
            error = profile.distance(&Profile::new(profile.means(&levels)), found.size());
            if error <= self.repeated.accuracy {
                solved.extend((top > 0.0).then(|| self.solve(top)).transpose()?);
            } else {
                let (levels, of_cuts) = profile.cuts(found.size(), self.repeated.accuracy);
                (error, solved) = (of_cuts, levels.into_iter().map(|level| self.solve(level)).collect::<Result<_>>()?);
            }
            if self.by_force || attempt == most_attempts {
                break;
            }
            self.repeated = self.repeated.on(self.curve_through(&self.rows)?);
            let ([of_curve, change], next) = match self.error_of_level(&found, history, (time, after)) {
                // curves through fewer contacts may leave the order of levels
                Err(Error::States(_) | Error::Step(_)) => break,
                other => other?,
            };
            found = next;
            of_level = of_curve + change;
            let allowed = OF_LEVEL * OF_CURVE * self.repeated.accuracy;
            let more = if of_curve > allowed && refined < MOST_REFINED { self.refine()? } else { 0 };
            refined += more;
            if more > 0 {
                self.repeated = self.repeated.on(self.curve_through(&self.rows)?);
                found = self.repeated.at(history, time, after)?;
            } else if change <= allowed {
                break;
            }
        }
        for pair in solved.windows(2) {
            self.check(&pair[0], &pair[1])?;
        }
        let profile = Profile::new(found.contact.tractions());
        let pressure = self.superposed(&profile, &solved.iter().collect::<Vec<_>>());
        let half: Vec<&Solved> = solved.iter().rev().step_by(2).collect::<Vec<_>>().into_iter().rev().collect();
        if half.len() > 1 && half.len() < solved.len() {
            let coarse = self.superposed(&profile, &half);
            let off: f64 = pressure.iter().zip(&coarse).map(|(fine, coarse)| (fine - coarse).abs()).sum();
            let by_half = off / pressure.iter().sum::<f64>() / OF_HALF;
            error = by_half.clamp(error / MOST_OVERSTATED, error);
        }
        let error = error + of_level + of_steps;
        Ok(FoundPressure { pressure, error, spent: std::mem::take(&mut self.spent) })
    }

    /// Σ w (p_e(l_i) − p_e(l_i−1)) = Σ (w_i − w_i+1) p_e(l_i).
    fn superposed(&self, profile: &Profile, solved: &[&Solved]) -> Vec<f64> {
        let levels: Vec<f64> = solved.iter().map(|solved| solved.level).collect();
        let shares: Vec<f64> = profile.means(&levels).map(|(_, share)| share).collect();
        let mut field = vec![0.0; self.elastic.fields().grid().len()];
        for (k, solved) in solved.iter().enumerate() {
            solved.pressure.add_to(shares[k] - shares.get(k + 1).unwrap_or(&0.0), &mut field);
        }
        field
    }
}

/// An elastic contact at a level.
struct Solved {
    level: f64,
    pressure: Pressed,
}
