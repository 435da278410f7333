//! The run on the levels of its elastic states: its error in time, and where its pressure is greatest.
//!
//! Where the contact is a superposition of its elastic states ([`states`](crate::states)), the steps of a run on cells
//! and the same steps on levels give the same levels, whatever the mesh. So the error in time of a run is the difference
//! between its steps and finer ones on levels, which cost no contact problem.

use std::sync::Arc;

use crate::error::{Error, Result, StepError};
use crate::load::{Load, Tilt};
use crate::plan::steps::{Differences, relative};
use crate::plan::trial_runs::{Run, StepState, TrialScene};
use crate::states::{ElasticState, ElasticStates, Rest, StatesContact};

/// Number of parts of a step of the run that is taken as exact, fewer where all parts would be more than so many: their
/// groups of levels are as many.
const PARTS: usize = 16;
const MAX_PARTS: usize = 4096;
const MIN_PARTS: usize = 2;
/// Level of a curve beyond its last state, over the level of that state.
const BEYOND: f64 = 16.0;
/// Levels of a curve for any shape [m²].
const ANY_LEVELS: [f64; 2] = [1e-150, 1e150];
/// δ ∝ l^(2/3), A ∝ l^(2/3) of a paraboloid.
const PARABOLOID: f64 = 2.0 / 3.0;
/// Least force at which the radii of the contact on cells and on levels are compared, over the greatest force: less
/// does not determine an area.
const NEGLIGIBLE: f64 = 1e-6;
/// Greatest error of the radius at a growing rim over the greatest difference on the coarsest mesh, which has few states.
const RIM_MARGIN: f64 = 1.5;
/// Squared distances from the middle of the contact at which the pressure is compared, over the squared radius.
const PLACES: [f64; 7] = [0.1, 0.3, 0.6, 0.85, 0.95, 0.99, 0.999];

/// Depth and area of the elastic contact by its level, as powers between a few states.
pub(super) struct Curve {
    states: Arc<ElasticStates>,
    /// Whether the contact is a line, whose half width is proportional to the area.
    line: bool,
    /// ln l and ln A of the states.
    areas: Vec<[f64; 2]>,
}

impl Curve {
    fn new(points: &[[f64; 3]], rest: f64, tilt: [Tilt; 2], line: bool) -> Result<Curve> {
        let exponent = |k: usize| {
            let [before, next] = [&points[k.saturating_sub(1)], &points[(k + 1).min(points.len() - 1)]];
            (next[1] / before[1]).ln() / (next[0] / before[0]).ln()
        };
        // dl/dδ of a power l ∝ δ^(1/n)
        let stiffness = |k: usize, level: f64, depth: f64| level / (depth * exponent(k));
        let state = |(k, &[level, depth, area]): (usize, &[f64; 3])| ElasticState {
            level,
            approach: rest + depth,
            tilt: [0.0; 2],
            stiffness: stiffness(k, level, depth),
            load_stiffness: stiffness(k, level, depth),
            tilt_rate: [0.0; 2],
            area,
            cells: 0,
            patches: 0,
        };
        let states = points.iter().enumerate().map(state).collect();
        let states = ElasticStates::new(states, Rest { approach: rest, tilt: [0.0; 2] }, tilt).validated()?;
        let areas = points.iter().map(|[level, _, area]| [level.ln(), area.ln()]).collect();
        Ok(Curve { states: Arc::new(states), line, areas })
    }

    /// The curve of a paraboloid: the level under a given force does not depend on the shape.
    pub(super) fn of_any_shape(tilt: [Tilt; 2]) -> Result<Curve> {
        let point = |level: f64| [level, level.powf(PARABOLOID), level.powf(PARABOLOID)];
        Curve::new(&ANY_LEVELS.map(point), 0.0, tilt, false)
    }

    /// Through the elastic states of a scene.
    pub(super) fn through(elastic: &Run, tilt: [Tilt; 2], line: bool) -> Result<Curve> {
        let states = elastic.states.iter().filter(|state| state.force > 0.0 && state.depth > elastic.rest);
        let mut points: Vec<[f64; 3]> =
            states.map(|state| [state.force, state.depth - elastic.rest, state.radius * state.radius]).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        points.dedup_by(|b, a| b[0] <= a[0] || b[1] <= a[1]);
        points.iter_mut().fold(0.0, |least, point| {
            point[2] = point[2].max(least);
            point[2]
        });
        let last = *points.last().ok_or(Error::Missing { part: "elastic states" })?;
        let powers = match points[..] {
            [.., before, _] => [1, 2].map(|k| (last[k] / before[k]).ln() / (last[0] / before[0]).ln()),
            _ => [PARABOLOID; 2],
        };
        let [depth, area] = [0, 1].map(|k| last[k + 1] * BEYOND.powf(powers[k]));
        points.push([BEYOND * last[0], depth, area]);
        Curve::new(&points, elastic.rest, tilt, line)
    }

    /// The contact of a scene on this curve, by the rule of adaptive steps.
    pub(super) fn contact(&self, scene: &TrialScene<'_>) -> Result<StatesContact> {
        let interpolant = scene.accuracy.settings().adaptive_interpolant();
        let contact = StatesContact::new(&self.states, scene.material)?.with_interpolant(interpolant);
        Ok(match scene.temperature {
            Some(temperature) => contact.with_temperature(temperature.clone()),
            None => contact,
        })
    }

    /// Approach of the load point at a level [m].
    pub(super) fn approach(&self, level: f64) -> f64 {
        self.states.approach(level)
    }

    /// Contact radius √(A/π) at a level [m].
    pub(super) fn radius(&self, level: f64) -> f64 {
        if level <= 0.0 {
            return 0.0;
        }
        let level = level.ln();
        let upper = self.areas.partition_point(|[other, _]| *other < level).clamp(1, self.areas.len() - 1);
        let [[l0, a0], [l1, a1]] = [self.areas[upper - 1], self.areas[upper]];
        (0.5 * (a0 + (a1 - a0) / (l1 - l0) * (level - l0))).exp()
    }

    /// What is proportional to the radius of the contact, or to its half width on a line.
    fn edge(&self, level: f64) -> f64 {
        self.radius(level).powi(if self.line { 2 } else { 1 })
    }

    /// A pressure at a distance √(`share` a²) from the middle of the contact, in a unit of its own: Σ w ∫ q dl, with q =
    /// dp/dl ∝ 1/(a √(a² − r²)) and l ∝ a³ between two levels; on a line 1/√(a² − x²) and a².
    fn pressure(&self, levels: impl Iterator<Item = (f64, f64)>, edge: f64, share: f64) -> f64 {
        let (place, power) = (share * edge * edge, if self.line { 2 } else { 3 });
        let (mut bottom, mut inner, mut pressure) = (0.0, 0.0_f64, 0.0);
        for (level, traction) in levels {
            let outer = self.edge(level);
            let width = outer.powi(power) - inner.powi(power);
            if width > 0.0 {
                let [near, far] = [inner, outer].map(|radius| (radius * radius - place).max(0.0).sqrt());
                pressure += traction * (level - bottom) / width * (far - near);
            }
            (bottom, inner) = (level, outer);
        }
        pressure
    }

    /// Takes the steps of a trial run, each in so many parts; returns the states at their ends.
    fn follow(&self, scene: &TrialScene<'_>, steps: &[(f64, Load)], parts: u32) -> Result<Vec<LevelState>> {
        let mut contact = self.contact(scene)?;
        let (mut states, mut time) = (Vec::with_capacity(steps.len()), 0.0);
        let mut corner = scene.history.next_breakpoint(0.0).unwrap_or(f64::INFINITY);
        for &(dt, load) in steps {
            let start = time;
            time += dt;
            let parts = if dt > 0.0 { parts } else { 1 };
            for part in 1..=parts {
                let end = if part == parts { time } else { start + dt * f64::from(part) / f64::from(parts) };
                let load = if part == parts { load } else { scene.history.before(end).validated_at(end, false)? };
                match contact.step_to(end, end - contact.time(), load) {
                    // the run stays as it was
                    Err(Error::Step(StepError::NoElasticResponse { .. })) if dt == 0.0 => {}
                    other => drop(other?),
                }
            }
            let heated = contact.next_temperature_corner(start) <= time * (1.0 + f64::EPSILON);
            if time >= corner * (1.0 - 1e-12) || heated {
                contact.reset_differences();
                while corner <= time * (1.0 + 1e-12) {
                    corner = scene.history.next_breakpoint(corner).unwrap_or(f64::INFINITY);
                }
            }
            states.push(self.state(&contact));
        }
        Ok(states)
    }

    fn state(&self, contact: &StatesContact) -> LevelState {
        let (level, edge) = (contact.level(), self.edge(contact.level()));
        let at = |share: f64| self.pressure(contact.tractions(), edge, share);
        let (centre, traction) = (at(0.0), contact.tractions().map(|(_, traction)| traction).fold(0.0, f64::max));
        let elastic = self.pressure([(level, 1.0)].into_iter(), edge, 0.0);
        LevelState {
            level,
            depth: contact.depth(),
            force: contact.force(),
            radius: self.radius(level),
            centre,
            aside: PLACES.into_iter().map(at).fold(0.0, f64::max),
            traction,
            amplification: relative(traction * elastic, centre),
        }
    }

    /// Error in time of a trial run, and what its pressures are made of.
    pub(super) fn trace(&self, scene: &TrialScene<'_>, run: &Run) -> Result<Trace> {
        let parts = (MAX_PARTS / run.steps.len().max(1)).clamp(MIN_PARTS, PARTS);
        let [taken, exact] = [1, parts as u32].map(|parts| self.follow(scene, &run.steps, parts));
        let (taken, exact) = (taken?, exact?);
        let over = |of: fn(&LevelState) -> f64| {
            let most = exact.iter().map(|state| of(state).abs()).fold(0.0, f64::max);
            let off = taken.iter().zip(&exact).map(|(taken, exact)| (of(taken) - of(exact)).abs()).fold(0.0, f64::max);
            relative(off, most)
        };
        let greatest = |states: &[LevelState]| states.iter().map(|state| state.centre).fold(0.0, f64::max);
        let (centre, force) = (greatest(&exact), exact.iter().map(|state| state.force).fold(0.0, f64::max));
        let aside = exact.iter().map(|state| state.aside).fold(0.0, f64::max);
        let highest = exact.iter().find(|state| state.centre == centre);
        let widest = exact.iter().map(|state| state.radius).fold(0.0, f64::max);
        let counts = |(state, level): &(&StepState, &LevelState)| state.resolved && level.force > NEGLIGIBLE * force;
        let resolved = run.states.iter().zip(&taken).filter(counts);
        let rim = RIM_MARGIN * resolved.map(|(state, level)| (state.radius - level.radius).abs()).fold(0.0, f64::max);
        let loads = exact.iter().zip(&run.steps).filter(|(_, (_, load))| !matches!(load, Load::Force { .. }));
        let error = Differences {
            main: over(|state| state.depth).max(over(|state| state.force)),
            pressure: relative((greatest(&taken) - centre).abs(), centre),
            pressure_over_time: over(|state| state.centre),
            radius: over(|state| state.radius),
        };
        Ok(Trace {
            error,
            level: highest.map_or(0.0, |state| state.level),
            levels: exact
                .iter()
                .filter(|state| state.level > 0.0)
                .fold([f64::INFINITY, 0.0], |[least, greatest], state| {
                    [least.min(state.level), greatest.max(state.level)]
                }),
            pressure_amplification: highest.map_or(1.0, |state| state.amplification).max(1.0),
            force_amplification: loads
                .map(|(state, _)| relative(state.traction * state.level, force))
                .fold(1.0, f64::max),
            rim: relative(rim, widest),
            excess: relative((aside - centre).max(0.0), aside),
        })
    }
}

/// A state of a contact on levels.
struct LevelState {
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
