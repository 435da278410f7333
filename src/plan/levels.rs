//! The run on the levels of its elastic states: its error in time, and where its pressure is greatest.
//!
//! Where the contact is a superposition of its elastic states ([`states`](crate::states)), the steps of a run on cells
//! and the same steps on levels give the same levels, whatever the mesh. So the error in time of a run is the difference
//! between its steps and finer ones on levels, which cost no contact problem.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::error::{Error, Result, StepError};
use crate::load::{Load, Tilt};
use crate::plan::difference::{Differences, relative, unseen};
use crate::plan::scene::{Run, StepState, TrialScene};
use crate::states::{ElasticStates, Rest, StatesContact};

/// Number of parts of a step of the run that is taken as exact, fewer where all parts would be more than so many: their
/// groups of levels are as many.
const PARTS: usize = 16;
const MAX_PARTS: usize = 4096;
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
/// Squared distances from the middle of the contact at which the pressure is compared, over the squared radius.
const PLACES: [f64; 7] = [0.1, 0.3, 0.6, 0.85, 0.95, 0.99, 0.999];

/// Depth and area of the elastic contact by its level, through a few states.
pub(super) struct Curve {
    states: Arc<ElasticStates>,
    /// Whether the contact is a line, whose half width is proportional to the area.
    line: bool,
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
        let beyond = |end: [f64; 3], other: Option<&[f64; 3]>, ratio: f64| {
            let [depth, area] = [1, 2].map(|k| other.map_or(PARABOLOID, |other| power([other, &end], k)));
            [ratio * end[0], end[1] * ratio.powf(depth), end[2] * ratio.powf(area)]
        };
        let lowest = beyond(first, points.get(1), BELOW);
        let highest = beyond(last, points.iter().rev().nth(1), BEYOND);
        points.insert(0, lowest);
        points.push(highest);
        let row = |(k, &[level, depth, area]): (usize, &[f64; 3])| {
            let around = [&points[k.saturating_sub(1)], &points[(k + 1).min(points.len() - 1)]];
            // dl/dδ of a power l ∝ δ^(1/n)
            (level, elastic.rest + depth, level / (depth * power(around, 1)), area)
        };
        let at_rest = Rest { approach: elastic.rest, tilt: [0.0; 2] };
        let states = ElasticStates::from_rows(points.iter().enumerate().map(row), at_rest, tilt)?;
        Ok(Curve { states, line })
    }

    /// The contact of a scene on this curve, by the rule of adaptive steps.
    pub(super) fn contact(&self, scene: &TrialScene<'_>) -> Result<StatesContact> {
        scene.course().contact(&self.states, scene.accuracy.settings().adaptive_interpolant())
    }

    /// Approach of the load point at a level [m].
    pub(super) fn approach(&self, level: f64) -> f64 {
        self.states.approach(level)
    }

    /// Contact radius √(A/π) at a level [m].
    pub(super) fn radius(&self, level: f64) -> f64 {
        (self.states.area(level) / PI).sqrt()
    }

    /// What is proportional to the radius of the contact, or to its half width on a line.
    fn edge(&self, level: f64) -> f64 {
        self.radius(level).powi(if self.line { 2 } else { 1 })
    }

    /// What the groups of a contact add to its pressure: q = dp/dl ∝ 1/(a √(a² − r²)) and l ∝ a³ between two levels, on a
    /// line 1/√(a² − x²) and a². `edges` holds the last levels with their radii: most groups stay from step to step.
    fn rings(&self, levels: impl Iterator<Item = (f64, f64)>, edges: &mut Vec<[f64; 2]>) -> Vec<Ring> {
        let power = if self.line { 2 } else { 3 };
        let (mut bottom, mut inner) = (0.0, 0.0_f64);
        let ring = |(k, (level, traction)): (usize, (f64, f64))| {
            if edges.get(k).is_none_or(|[last, _]| *last != level) {
                edges.truncate(k);
                edges.push([level, self.edge(level)]);
            }
            let outer = edges[k][1];
            let width = outer.powi(power) - inner.powi(power);
            let ring = Ring { share: traction * (level - bottom) / width, squares: [inner, outer].map(|a| a * a) };
            (bottom, inner) = (level, outer);
            (width > 0.0).then_some(ring)
        };
        levels.enumerate().filter_map(ring).collect()
    }

    /// Takes the steps of a trial run, each in so many parts; returns the states at the ends of all parts.
    fn follow(&self, scene: &TrialScene<'_>, run: &Run, parts: u32) -> Result<Vec<LevelState>> {
        let mut contact = self.contact(scene)?;
        let (mut states, mut edges) = (Vec::with_capacity(run.steps.len() * parts as usize), Vec::new());
        for (&(dt, load), &StepState { time, .. }) in run.steps.iter().zip(&run.states) {
            let start = contact.time();
            let parts = if dt > 0.0 { parts } else { 1 };
            for part in 1..=parts {
                let end = if part == parts { time } else { start + dt * f64::from(part) / f64::from(parts) };
                let load = if part == parts { load } else { scene.history.checked_before(end, false)? };
                match contact.step_to(end, end - contact.time(), load) {
                    // the run stays as it was
                    Err(Error::Step(StepError::NoElasticResponse { .. })) if dt == 0.0 => {}
                    other => drop(other?),
                }
                let is_by_force = matches!(load, Load::Force { .. });
                states.push(LevelState { is_end: part == parts, is_by_force, ..self.state(&contact, &mut edges) });
            }
            if scene.next_corner(start) <= time {
                contact.reset_differences();
            }
        }
        Ok(states)
    }

    fn state(&self, contact: &StatesContact, edges: &mut Vec<[f64; 2]>) -> LevelState {
        let (level, rings) = (contact.level(), self.rings(contact.tractions(), edges));
        let square = self.edge(level).powi(2);
        let (centre, traction) = (pressure(&rings, 0.0), contact.tractions().map(|(_, w)| w).fold(0.0, f64::max));
        let elastic = pressure(&self.rings([(level, 1.0)].into_iter(), &mut Vec::new()), 0.0);
        LevelState {
            time: contact.time(),
            is_end: true,
            is_by_force: true,
            level,
            depth: contact.depth(),
            force: contact.force(),
            radius: self.radius(level),
            centre,
            aside: PLACES.into_iter().map(|place| pressure(&rings, place * square)).fold(0.0, f64::max),
            traction,
            amplification: relative(traction * elastic, centre),
        }
    }

    /// Error in time of a trial run, and what its pressures are made of.
    pub(super) fn trace(&self, scene: &TrialScene<'_>, run: &Run) -> Result<Trace> {
        let parts = (MAX_PARTS / run.steps.len().max(1)).clamp(MIN_PARTS, PARTS);
        let [taken, exact] = [1, parts as u32].map(|parts| self.follow(scene, run, parts));
        let (taken, exact) = (taken?, exact?);
        // greatest values hold between the ends of steps, too
        let most = |of: fn(&LevelState) -> f64| exact.iter().map(|state| of(state).abs()).fold(0.0, f64::max);
        let ends = || exact.iter().filter(|state| state.is_end);
        let over = |of: fn(&LevelState) -> f64| {
            let off = taken.iter().zip(ends()).map(|(taken, exact)| (of(taken) - of(exact)).abs()).fold(0.0, f64::max);
            relative(off, most(of))
        };
        let (centre, force, aside) = (most(|state| state.centre), most(|state| state.force), most(|state| state.aside));
        let highest = exact.iter().find(|state| state.centre == centre);
        let of_steps = [
            taken.iter().map(|state| state.centre).fold(0.0, f64::max),
            ends().map(|state| state.centre).fold(0.0, f64::max),
        ];
        let over_time: Vec<[f64; 2]> = exact.iter().map(|state| [state.time, state.centre]).collect();
        let counts = |(state, level): &(&StepState, &LevelState)| state.resolved && level.force > NEGLIGIBLE * force;
        let resolved = run.states.iter().zip(&taken).filter(counts);
        let rim = RIM_MARGIN * resolved.map(|(state, level)| (state.radius - level.radius).abs()).fold(0.0, f64::max);
        let error = Differences {
            main: over(|state| state.depth).max(over(|state| state.force)),
            pressure: relative((of_steps[0] - of_steps[1]).abs(), centre),
            pressure_over_time: over(|state| state.centre),
            radius: over(|state| state.radius),
        };
        let others = exact.iter().filter(|state| !state.is_by_force);
        Ok(Trace {
            error,
            unseen: unseen(scene, run, &over_time),
            level: highest.map_or(0.0, |state| state.level),
            levels: [
                ends().map(|state| state.level).filter(|level| *level > 0.0).fold(f64::INFINITY, f64::min),
                most(|state| state.level),
            ],
            pressure_amplification: highest.map_or(1.0, |state| state.amplification).max(1.0),
            force_amplification: others.map(|state| relative(state.traction * state.level, force)).fold(1.0, f64::max),
            rim: relative(rim, most(|state| state.radius)),
            excess: relative((aside - centre).max(0.0), aside),
        })
    }
}

/// What a group of levels adds to the pressure of a contact.
struct Ring {
    share: f64,
    /// Squares of its inner and outer radius [m²].
    squares: [f64; 2],
}

/// The pressure where the squared distance from the middle of the contact is `place`, in a unit of its own: Σ w ∫ q dl.
fn pressure(rings: &[Ring], place: f64) -> f64 {
    let part = |ring: &Ring| {
        let [near, far] = ring.squares.map(|square| (square - place).max(0.0).sqrt());
        ring.share * (far - near)
    };
    rings.iter().map(part).sum()
}

/// A state of a contact on levels.
struct LevelState {
    time: f64,
    /// Whether it is the state at the end of a step, not within one.
    is_end: bool,
    is_by_force: bool,
    level: f64,
    depth: f64,
    force: f64,
    radius: f64,
    /// Pressure in the middle of the contact, and the greatest at [`PLACES`], in the same unit.
    centre: f64,
    aside: f64,
    /// Greatest w of a level.
    traction: f64,
    /// This w times the pressure in the middle of the elastic contact, over the pressure there.
    amplification: f64,
}

/// A run on levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trace {
    pub(super) error: Differences,
    /// [`unseen`] of the pressure in the middle.
    pub(super) unseen: f64,
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
    /// By which share of itself the greatest pressure aside of the middle of the contact exceeds the greatest in the
    /// middle, as under moving edges of bodies that creep fast.
    pub(super) excess: f64,
}
