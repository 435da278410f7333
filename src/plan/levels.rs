//! The run on the levels of its elastic states: its error in time, and where its pressure is greatest.
//!
//! Where the contact is a superposition of its elastic states ([`states`](crate::states)), the steps of a run on cells
//! and the same steps on levels give the same levels, whatever the mesh. So the error in time of a run is the difference
//! between its steps and finer ones on levels, which cost no contact problem.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::error::{Error, Result, StepError};
use crate::load::{Load, Tilt};
use crate::plan::cells::{FewCells, LevelState, cells, highest_of};
use crate::plan::difference::{Differences, greatest, relative};
use crate::plan::domain::LEAST_ACROSS;
use crate::plan::error_law::ErrorLaw;
use crate::plan::rings::Rings;
use crate::plan::scene::{Run, StepState, TrialScene};
use crate::solver::RigidMotion;
use crate::states::{ElasticStates, StatesContact, unless_refused};

/// Number of parts of a step of the run that is taken as exact, fewer where all parts would be more than so many: their
/// groups of levels are as many.
const PARTS: usize = 64;
const MAX_PARTS: usize = 1536;
const MIN_PARTS: usize = 2;
/// Levels of a curve below its first state and beyond its last, over the levels of these states.
const BELOW: f64 = 1e-12;
const BEYOND: f64 = 16.0;
/// δ ∝ l^(2/3), A ∝ l^(2/3) of a paraboloid.
const PARABOLOID: f64 = 2.0 / 3.0;
/// Least force at which the radii of the contact on cells and on levels are compared, over the greatest force: less
/// does not determine an area.
const NEGLIGIBLE: f64 = 1e-6;
/// Greatest error of the radius at a growing rim over the greatest difference on the coarsest mesh, which has few states.
const RIM_MARGIN: f64 = 1.5;
/// Part of the accuracy that the steps may take of the greatest pressure of the run, and the cells of the same at a growing rim.
const STEPS_SHARE: f64 = 0.3;
const CELLS_SHARE: f64 = 0.4;
/// Most rounds in which steps are halved for the greatest pressure, steps of a round before each time, and factor and number of steps that
/// they may add.
const MOST_ROUNDS: usize = 12;
const HALVED: usize = 3;
/// Where a round leaves more than this part of the error, the greatest pressure is found anew in parts of its steps, so many times at most.
const STAGNANT: f64 = 0.7;
const MOST_REFERENCES: usize = 3;
/// Steps that end under a pressure greater than this part of the greatest of the run stay where they are, with the steps before.
const NEAR: f64 = 0.8;
const MOST_ADDED: usize = 6;
const ALWAYS_ADDED: usize = 48;
/// Part of the width of a cell over whose mean cells show a narrow peak beside the middle: trial runs show little more than this mean.
const BLUR: f64 = 0.1;

/// Depth and area of the elastic contact by its level, through a few states.
pub(super) struct Curve {
    states: Arc<ElasticStates>,
    /// Whether the contact is a line, whose half width is proportional to the area.
    pub(super) line: bool,
    /// Pressure in the middle of an elastic contact, over that of its rings.
    unit: f64,
    /// Power of the radius that the depth of large contacts is: 1 of a cone, 2 of a paraboloid.
    pub(super) order: f64,
}

impl Curve {
    /// Through the elastic states of a scene: powers between two of them, below the first and beyond the last.
    pub(super) fn through(elastic: &Run, tilt: [Tilt; 2], line: bool) -> Result<Curve> {
        let states = elastic.states.iter().filter(|state| state.force > 0.0 && state.depth > elastic.rest);
        let mut points: Vec<[f64; 3]> =
            states.map(|state| [state.force, state.depth - elastic.rest, PI * state.radius * state.radius]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        points.dedup_by(|b, a| b[0] <= a[0] || b[1] <= a[1]);
        for k in 1..points.len() {
            points[k][2] = points[k][2].max(points[k - 1][2]);
        }
        let [first, last] =
            [points.first(), points.last()].map(|end| end.ok_or(Error::Missing { part: "elastic states" }));
        let (first, last) = (*first?, *last?);
        // dln of a quantity over dln l
        let power = |[before, next]: [&[f64; 3]; 2], k: usize| (next[k] / before[k]).ln() / (next[0] / before[0]).ln();
        let powers = |end, other: Option<&_>| [1, 2].map(|k| other.map_or(PARABOLOID, |other| power([other, end], k)));
        let beyond = |end: [f64; 3], [depth, area]: [f64; 2], ratio: f64| {
            [ratio * end[0], end[1] * ratio.powf(depth), end[2] * ratio.powf(area)]
        };
        let of_large = powers(&last, points.iter().rev().nth(1));
        let lowest = beyond(first, powers(&first, points.get(1)), BELOW);
        let highest = beyond(last, of_large, BEYOND);
        points.insert(0, lowest);
        points.push(highest);
        let row = |(k, &[level, depth, area]): (usize, &[f64; 3])| {
            let around = [&points[k.saturating_sub(1)], &points[(k + 1).min(points.len() - 1)]];
            // dl/dδ of a power l ∝ δ^(1/n)
            (level, elastic.rest + depth, level / (depth * power(around, 1)), area)
        };
        let at_rest = RigidMotion { approach: elastic.rest, tilt: [0.0; 2] };
        let states = ElasticStates::from_rows(points.iter().enumerate().map(row), at_rest, tilt)?;
        let mut curve = Curve { states, line, unit: 1.0, order: 2.0 * of_large[0] / of_large[1] };
        curve.unit =
            greatest(&elastic.states, |state| state.pressure) / curve.rings([(last[0], 1.0)].into_iter()).centre();
        Ok(curve)
    }

    /// The contact of a scene on this curve, by the rule of adaptive steps.
    pub(super) fn contact(&self, scene: &TrialScene<'_>) -> Result<StatesContact> {
        scene.course().contact(&self.states, scene.asked.accuracy.settings().adaptive_interpolant())
    }

    /// Approach of the load point at a level [m].
    pub(super) fn approach(&self, level: f64) -> f64 {
        self.states.approach(level)
    }

    /// Contact radius √(A/π) at a level [m].
    pub(super) fn radius(&self, level: f64) -> f64 {
        (self.states.area(level) / PI).sqrt()
    }

    /// What is proportional to the radius of the contact of a ball, or to its half width on a line. The areas of a few cells would make
    /// another pressure of the same tractions in long steps than in short ones.
    fn edge(&self, level: f64) -> f64 {
        if self.line { level.sqrt() } else { level.cbrt() }
    }

    /// Takes steps, each in so many parts, or as `cells` of this width do; returns the states at the ends of all parts.
    fn follow(&self, scene: &TrialScene<'_>, legs: &[Leg], parts: u32, cells: Option<f64>) -> Result<Vec<LevelState>> {
        let contact = self.contact(scene)?;
        let mut contact = if cells.is_some() { contact.with_steps_of_cells() } else { contact };
        let mut states = Vec::with_capacity(legs.len() * parts as usize);
        for &Leg { end: last, dt, load } in legs {
            let start = contact.time();
            let parts = if dt > 0.0 { parts } else { 1 };
            for part in 1..=parts {
                let end = if part == parts { last } else { start + dt * f64::from(part) / f64::from(parts) };
                let load = if part == parts { load } else { scene.asked.history.checked_before(end, false)? };
                match contact.step_to(end, end - contact.time(), load) {
                    // the run stays as it was
                    Err(Error::Step(StepError::NoElasticResponse { .. })) if dt == 0.0 => {}
                    other => drop(other?),
                }
                states.push(LevelState {
                    is_end: part == parts,
                    is_by_force: load.is_force(),
                    ..self.state(&contact, BLUR * cells.unwrap_or(0.0))
                });
            }
            if scene.next_corner(start) <= last {
                contact.reset_differences();
            }
        }
        Ok(states)
    }

    fn rings(&self, groups: impl Iterator<Item = (f64, f64)>) -> Rings {
        Rings::new(groups.map(|(level, traction)| (level, traction, self.edge(level))), self.line)
    }

    fn state(&self, contact: &StatesContact, width: f64) -> LevelState {
        let (level, rings) = (contact.level(), self.rings(contact.tractions()));
        let (peak, traction) = (rings.peak(width), contact.tractions().map(|(_, w)| w).fold(0.0, f64::max));
        let elastic = self.rings([(level, 1.0)].into_iter()).centre();
        LevelState {
            time: contact.time(),
            is_end: true,
            is_by_force: true,
            level,
            edge: self.edge(level),
            depth: contact.depth(),
            force: contact.force(),
            radius: self.radius(level),
            peak: peak.pressure,
            place: peak.place,
            rings: if peak.is_central { None } else { Some(rings) },
            traction,
            amplification: relative(traction * elastic, peak.pressure),
        }
    }

    /// Error in time of a trial run, and what its pressures are made of.
    pub(super) fn trace(&self, scene: &TrialScene<'_>, run: &Run) -> Result<Trace> {
        let legs = run.legs();
        let [taken, exact] = [1, parts_of(legs.len())].map(|parts| self.follow(scene, &legs, parts, None));
        let (taken, exact) = (taken?, exact?);
        // greatest values hold between the ends of steps, too
        let most = |of: fn(&LevelState) -> f64| exact.iter().map(|state| of(state).abs()).fold(0.0, f64::max);
        let ends = || exact.iter().filter(|state| state.is_end);
        let over = |of: fn(&LevelState) -> f64| {
            let off = taken.iter().zip(ends()).map(|(taken, exact)| (of(taken) - of(exact)).abs()).fold(0.0, f64::max);
            relative(off, most(of))
        };
        let (peak, force, wide) = (most(|state| state.peak), most(|state| state.force), 2.0 * most(|state| state.edge));
        let (highest, width) = (highest_of(&exact), wide / LEAST_ACROSS);
        let of_cells = unless_refused(self.follow(scene, &legs, 1, Some(width)).map(Some))?.unwrap_or_default();
        let beside = run.states.iter().zip(&of_cells).filter(|(_, level)| level.peak > 0.0).map(|(state, level)| {
            FewCells { across: 2.0 * level.edge / width, excess: state.pressure / (self.unit * level.peak) }
        });
        let beside: Vec<FewCells> = beside.collect();
        let counts = |(state, level): &(&StepState, &LevelState)| state.resolved && level.force > NEGLIGIBLE * force;
        let resolved = run.states.iter().zip(&taken).filter(counts);
        let rim = RIM_MARGIN * resolved.map(|(state, level)| (state.radius - level.radius).abs()).fold(0.0, f64::max);
        let error = Differences {
            main: over(|state| state.depth).max(over(|state| state.force)),
            pressure: relative((taken.iter().map(|state| state.peak).fold(0.0, f64::max) - peak).abs(), peak),
            pressure_over_time: over(|state| state.peak),
            radius: over(|state| state.radius),
        };
        let others = exact.iter().filter(|state| !state.is_by_force);
        Ok(Trace {
            error,
            central: highest.filter(|state| state.rings.is_none()).map(|state| [state.time, state.peak]),
            level: highest.map_or(0.0, |state| state.level),
            levels: [
                ends().map(|state| state.level).filter(|level| *level > 0.0).fold(f64::INFINITY, f64::min),
                most(|state| state.level),
            ],
            pressure_amplification: highest.map_or(1.0, |state| state.amplification).max(1.0),
            force_amplification: others.map(|state| relative(state.traction * state.level, force)).fold(1.0, f64::max),
            rim: relative(rim, most(|state| state.radius)),
            cells: cells(&exact, highest, &beside, wide, CELLS_SHARE * scene.asked.accuracy.target()),
        })
    }

    /// Times at which the steps of a run end besides, so that its greatest pressure is right, and what is left of its error: a rim that
    /// joins in a long step carries too much. Steps before the greatest pressure are halved, and before every pressure that exceeds it, on so
    /// many cells across the widest contact.
    pub(super) fn stops(
        &self,
        scene: &TrialScene<'_>,
        run: &Run,
        trace: &Trace,
        across: f64,
    ) -> Result<(Vec<f64>, f64)> {
        let (mut legs, mut stops, width) = (run.legs(), Vec::new(), 2.0 * self.edge(trace.levels[1]) / across);
        let highest_in_parts = |legs: &[Leg]| {
            let exact = self.follow(scene, legs, parts_of(legs.len()), None)?;
            Ok::<_, Error>(highest_of(&exact).map_or([0.0; 2], |state| [state.time, state.blurred(BLUR * width)]))
        };
        let [mut time, mut peak] = trace.central.map_or_else(|| highest_in_parts(&legs), Ok)?;
        let (allowed, most) =
            (STEPS_SHARE * scene.asked.accuracy.target(), (1 + MOST_ADDED) * run.steps.len() + ALWAYS_ADDED);
        let (mut error, mut references) = (f64::INFINITY, 0);
        for round in 0..MOST_ROUNDS {
            let taken = self.follow(scene, &legs, 1, Some(width))?;
            let highest = taken.iter().map(|state| state.peak).fold(0.0, f64::max);
            let before = std::mem::replace(&mut error, relative((highest - peak).abs(), peak));
            if round > 1 && error > STAGNANT * before.max(allowed) && references < MOST_REFERENCES {
                // the parts of the first steps were too long themselves
                [time, peak] = highest_in_parts(&legs)?;
                error = relative((highest - peak).abs(), peak);
                references += 1;
            }
            if error <= allowed || legs.len() > most {
                break;
            }
            let exceeds = |k: &usize| taken[*k].peak > (1.0 + allowed) * peak;
            let mut ends: Vec<usize> = (0..legs.len()).filter(exceeds).collect();
            let mut new = Vec::new();
            if ends.is_empty() {
                new.extend(legs.iter().all(|leg| leg.end != time).then_some(time));
                ends.extend(legs.iter().position(|leg| leg.end >= time));
            }
            for end in ends {
                let before = legs[..=end].iter().rev().filter(|leg| leg.dt > 0.0).take(HALVED);
                // the steps in which what bounds the greatest pressure joined: their traction is one, and what follows stands out
                let inside = |k: &usize| self.edge(taken[*k].level) < taken[end].place;
                let joined = (0..end).rev().find(inside).map_or(0, |k| k + 1);
                let around = legs[joined.saturating_sub(1)..].iter().take(HALVED).filter(|leg| leg.dt > 0.0);
                new.extend(before.chain(around).map(|leg| leg.end - 0.5 * leg.dt));
            }
            new.sort_by(f64::total_cmp);
            new.dedup();
            for &stop in &new {
                Leg::split(&mut legs, scene, stop)?;
            }
            stops.append(&mut new);
        }
        if error > allowed {
            return Ok((Vec::new(), error));
        }
        // adaptive steps on other cells end elsewhere: steps before great pressures stay where they are
        for (end, _) in
            self.follow(scene, &legs, 1, Some(width))?.iter().enumerate().filter(|(_, state)| state.peak >= NEAR * peak)
        {
            stops.extend(legs[..=end].iter().rev().filter(|leg| leg.dt > 0.0).take(HALVED).map(|leg| leg.end));
        }
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        Ok((stops, error))
    }
}

/// Number of parts of each of so many steps.
fn parts_of(steps: usize) -> u32 {
    (MAX_PARTS / steps.max(1)).clamp(MIN_PARTS, PARTS) as u32
}

/// A step: its end, its length and the load there.
#[derive(Debug, Clone, Copy)]
struct Leg {
    end: f64,
    dt: f64,
    load: Load,
}

impl Leg {
    /// Ends a step at a time within one.
    fn split(legs: &mut Vec<Leg>, scene: &TrialScene<'_>, stop: f64) -> Result<()> {
        let at = legs.partition_point(|leg| leg.end <= stop);
        if let Some(leg) = legs.get_mut(at).filter(|leg| leg.end - leg.dt < stop) {
            let first = Leg {
                end: stop,
                dt: stop - (leg.end - leg.dt),
                load: scene.asked.history.checked_before(stop, false)?,
            };
            leg.dt = leg.end - stop;
            legs.insert(at, first);
        }
        Ok(())
    }
}

impl Run {
    fn legs(&self) -> Vec<Leg> {
        let leg = |(&(dt, load), state): (&(f64, Load), &StepState)| Leg { end: state.time, dt, load };
        self.steps.iter().zip(&self.states).map(leg).collect()
    }
}

/// A run on levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trace {
    pub(super) error: Differences,
    /// Time and size of the greatest pressure, if it is in the middle.
    central: Option<[f64; 2]>,
    /// The level at which the pressure is greatest, and the least and the greatest level of a contact.
    pub(super) level: f64,
    pub(super) levels: [f64; 2],
    /// p = w(c) p_e(c) − ∫ p_e dw: errors of the elastic pressure and the elastic force, relative to their values, times
    /// these factors are bounds of the errors of the pressure and the force of the run.
    pub(super) pressure_amplification: f64,
    pub(super) force_amplification: f64,
    /// Difference of the contact radius between the run on cells and its elastic states, over the greatest: the pressures
    /// at a growing rim, which give the fractions of cells, are others than elastic ones.
    pub(super) rim: f64,
    /// What cells lose of a greatest pressure at a growing rim.
    pub(super) cells: ErrorLaw,
}
