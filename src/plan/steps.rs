//! The steps of a trial run and their error in time, from its levels or from the difference to a run with shorter steps.

use crate::Grid;
use crate::error::{Error, Result, StepError};
use crate::plan::Accuracy;
use crate::plan::levels::{Curve, Trace};
use crate::plan::trial_runs::{LEAST_TOLERANCE, Run, StepState, TrialScene, greatest};

/// Shares of the accuracy: greatest of the error in time, of the errors in time and of the mesh together, and least of
/// the error of the mesh.
const MAX_TIME_SHARE: f64 = 0.6;
const BOTH_SHARES: f64 = 0.9;
const MIN_MESH_SHARE: f64 = 0.2;
/// Greatest error in time of the greatest pressure, as a share of the accuracy. A greater error grows on finer meshes,
/// whose cells a growing edge crosses faster: then the pressure is not promised.
const MAX_PEAK_TIME_SHARE: f64 = 0.2;
/// Greatest number of times that steps are shortened.
const MAX_STEP_TRIES: u32 = 3;
/// Least factor of the tolerance at a time, and the greatest part of the error that may remain for a shortening to be
/// kept.
const MAX_SHORTENING: f64 = 0.2;
const MIN_GAIN: f64 = 0.8;

/// The steps of a trial run, and their error in time.
pub(super) struct Steps {
    pub(super) tolerance: f64,
    pub(super) run: Run,
    /// `None` where steps short enough for a comparison do not exist.
    pub(super) error: Option<Differences>,
    /// [`unseen`] of the greatest pressure.
    pub(super) unseen: f64,
    /// The run on levels, where it is made of elastic states.
    pub(super) trace: Option<Trace>,
}

impl Steps {
    /// Allowed error of approach and force due to the mesh, given the error in time.
    pub(super) fn left_for_mesh(&self, accuracy: Accuracy) -> f64 {
        let target = accuracy.target();
        let left = BOTH_SHARES * target - self.error.map_or(0.0, |error| error.main);
        left.clamp(MIN_MESH_SHARE * target, accuracy.space())
    }

    /// Whether the greatest pressure of the run hardly depends on the steps, wherever they end.
    pub(super) fn resolve_pressure(&self, accuracy: Accuracy) -> bool {
        let target = accuracy.target();
        self.unseen <= MAX_TIME_SHARE * target
            && self.error.is_none_or(|error| error.pressure <= MAX_PEAK_TIME_SHARE * target)
    }

    /// Shortens the steps while the error of approach, force or greatest pressure exceeds its share and falls with the
    /// steps.
    pub(super) fn find(scene: &TrialScene<'_>, grid: &Grid, curve: Option<&Curve>) -> Result<Steps> {
        let target = scene.accuracy.target();
        let mut steps = Steps::with_tolerance(scene, grid, curve)?;
        for _ in 0..MAX_STEP_TRIES {
            let worst = steps.worst();
            if worst <= MAX_TIME_SHARE * target {
                break;
            }
            let tolerance = (steps.tolerance * (0.5 * target / worst).max(MAX_SHORTENING)).max(LEAST_TOLERANCE);
            match Steps::with_tolerance(&TrialScene { tolerance, ..*scene }, grid, curve) {
                Ok(shorter) if shorter.error.is_some() && shorter.worst() <= MIN_GAIN * worst => steps = shorter,
                Err(
                    error @ (Error::Step(StepError::ContactAtEdge { .. })
                    | Error::OutOfMemory { .. }
                    | Error::Cancelled { .. }),
                ) => {
                    return Err(error);
                }
                _ => break,
            }
        }
        Ok(steps)
    }

    /// The greater of the errors of approach or force and of the greatest pressure of the run, if that may be promised; 0
    /// where nothing was estimated.
    fn worst(&self) -> f64 {
        let promised = self.trace.is_none_or(|trace| trace.excess == 0.0);
        let of_pressure = |error: Differences| if promised { error.pressure.max(self.unseen) } else { 0.0 };
        self.error.map_or(0.0, |error| error.main.max(of_pressure(error)))
    }

    fn with_tolerance(scene: &TrialScene<'_>, grid: &Grid, curve: Option<&Curve>) -> Result<Steps> {
        let (run, tolerance) = (scene.follow(grid.clone(), &[])?, scene.tolerance);
        // a trace fails where levels leave their order, as if there were no states
        if let Some(trace) = curve.and_then(|curve| curve.trace(scene, &run).ok()) {
            return Ok(Steps { tolerance, run, error: Some(trace.error), unseen: trace.unseen, trace: Some(trace) });
        }
        let finer = scene.with_shorter_steps(&run, grid.clone())?;
        let (mut error, mut found) = (None, 0.0);
        if let Some(finer) = finer {
            let mut all = finer.states.iter();
            let same = run.states.iter().map(|state| all.find(|other| other.time == state.time).copied());
            error = same.collect::<Option<Vec<_>>>().map(|same| Differences::between(&run.states, &same, None));
            let over_time: Vec<[f64; 2]> = finer.states.iter().map(|state| [state.time, state.pressure]).collect();
            found = unseen(scene, &run, &over_time);
        }
        Ok(Steps { tolerance, run, error, unseen: found, trace: None })
    }
}

/// Differences between two runs of the same steps or times, or of two lists of elastic states, relative to the greatest values of the finer run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Differences {
    /// Of approach or force at any time.
    pub(super) main: f64,
    /// Of the greatest pressure of the run, or of one state.
    pub(super) pressure: f64,
    /// Of the greatest pressure at any time at which the coarse run resolves the contact.
    pub(super) pressure_over_time: f64,
    /// Of the contact radius at these times.
    pub(super) radius: f64,
}

impl Differences {
    /// The pressure is compared in the state with the index `highest`, or between the greatest ones of all states.
    pub(super) fn between(coarse: &[StepState], fine: &[StepState], highest: Option<usize>) -> Differences {
        let over = |of: fn(&StepState) -> f64, all: bool| difference(coarse, fine, of, all);
        let [before, now] = [coarse, fine].map(|states| {
            let of_one = highest.and_then(|highest| states.get(highest)).map(|state| state.pressure);
            of_one.unwrap_or_else(|| greatest(states, |state| state.pressure))
        });
        Differences {
            main: over(|state| state.approach, true).max(over(|state| state.force, true)),
            pressure: relative((before - now).abs(), now),
            pressure_over_time: over(|state| state.pressure, false),
            radius: over(|state| state.radius, false),
        }
    }
}

/// The greatest difference between the states of two runs at the same times, relative to the greatest value: over all
/// states, or over the states that `coarse` resolves.
fn difference(coarse: &[StepState], fine: &[StepState], of: impl Fn(&StepState) -> f64, all: bool) -> f64 {
    let pairs = coarse.iter().zip(fine).filter(|(state, _)| all || state.resolved);
    let most = pairs.map(|(coarse, fine)| (of(coarse) - of(fine)).abs()).fold(0.0, f64::max);
    relative(most, greatest(fine, of))
}

/// The share of the greatest of values, given with their times, that a run in steps of these lengths misses where its steps end least
/// luckily: two of them around the greatest value.
pub(super) fn unseen(scene: &TrialScene<'_>, run: &Run, values: &[[f64; 2]]) -> f64 {
    let Some(&[at, greatest]) = values.iter().max_by(|a, b| a[1].total_cmp(&b[1])) else { return 0.0 };
    // every run ends a step at a corner, and at its end
    let (mut start, mut end) = (0.0, scene.next_corner(0.0));
    while end <= at {
        (start, end) = (end, scene.next_corner(end));
    }
    if at <= start || at >= scene.until {
        return 0.0;
    }
    let end = end.min(scene.until);
    let step = run.states.partition_point(|state| state.time < at);
    let around = run.steps.iter().skip(step.saturating_sub(1)).take(3);
    let length = around.map(|(dt, _)| *dt).fold(0.0, f64::max);
    missed(values, [at, greatest], [start, end], length)
}

/// The share of the greatest value that steps of this length miss, wherever they end between two corners.
fn missed(values: &[[f64; 2]], [at, greatest]: [f64; 2], [start, end]: [f64; 2], length: f64) -> f64 {
    let within = values.iter().filter(|[time, _]| *time > start && (at - length..=at).contains(time));
    let shown = within.map(|&[time, before]| {
        let next = values.iter().find(|[next, _]| *next >= end.min(time + length));
        next.map_or(before, |[_, after]| before.max(*after))
    });
    relative(greatest - shown.fold(greatest, f64::min), greatest)
}

pub(super) fn relative(value: f64, scale: f64) -> f64 {
    if scale > 0.0 { value / scale } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::missed;

    /// A parabola 1 − (t/2)² is missed most by a step that lies evenly about its vertex; a corner beside the vertex ends a step.
    #[test]
    fn what_steps_miss_of_a_peak() {
        let values: Vec<[f64; 2]> =
            (-1000..=1000).map(|k| f64::from(k) * 1e-3).map(|t| [t, 1.0 - 0.25 * t * t]).collect();
        for length in [0.1_f64, 0.4, 0.8] {
            let found = missed(&values, [0.0, 1.0], [-1.0, 1.0], length);
            assert!((found - 0.0625 * length * length).abs() < 2e-3 * length, "{length}: {found}");
            let beside = missed(&values, [0.0, 1.0], [-1.0, 0.1 * length], length);
            assert!((beside - 0.0025 * length * length).abs() < 2e-3 * length, "{length}: {beside}");
        }
    }
}
