//! The steps of a run, and the error in time that they leave.

use crate::Grid;
use crate::error::{Error, Result};
use crate::plan::Accuracy;
use crate::plan::trial_runs::{LEAST_TOLERANCE, Run, Scene, State, difference, greatest, relative};

/// The error in time may take this share of what was asked, both errors together the second, and that of the mesh at least
/// the third.
const MAX_TIME_SHARE: f64 = 0.6;
const BOTH_SHARES: f64 = 0.9;
const MIN_MESH_SHARE: f64 = 0.2;
/// How often steps are shortened.
const MAX_STEP_TRIES: u32 = 3;
/// The least factor of their tolerance at a time, and the most of the error that may remain for it to be of use.
const MAX_SHORTENING: f64 = 0.2;
const MIN_GAIN: f64 = 0.8;

/// Errors in time, relative to the greatest values of the run.
#[derive(Clone, Copy)]
pub(super) struct TimeError {
    /// Of approach or force.
    pub(super) main: f64,
    /// Of the greatest pressure of the run.
    pub(super) pressure: f64,
    /// Of the greatest pressure at any time.
    pub(super) pressure_over_time: f64,
}

/// The steps of a run, and the error in time that they leave.
#[derive(Clone)]
pub(super) struct Steps {
    pub(super) tolerance: f64,
    pub(super) run: Run,
    /// `None` where steps short enough to compare with do not exist.
    pub(super) error: Option<TimeError>,
}

impl Steps {
    /// The error of approach and force due to the mesh that the error in time leaves.
    pub(super) fn left_for_mesh(&self, accuracy: Accuracy) -> f64 {
        let target = accuracy.target();
        let left = BOTH_SHARES * target - self.error.map_or(0.0, |error| error.main);
        left.clamp(MIN_MESH_SHARE * target, accuracy.space())
    }

    /// Shortens the steps while the error of approach, force or greatest pressure is more than its share and falls with them.
    pub(super) fn find(scene: &Scene<'_>, grid: &Grid) -> Result<Steps> {
        let target = scene.accuracy.target();
        let mut steps = Steps::with_tolerance(scene, grid)?;
        for _ in 0..MAX_STEP_TRIES {
            let worst = steps.worst();
            if worst <= MAX_TIME_SHARE * target {
                break;
            }
            let tolerance = (steps.tolerance * (0.5 * target / worst).max(MAX_SHORTENING)).max(LEAST_TOLERANCE);
            match Steps::with_tolerance(&Scene { tolerance, ..*scene }, grid) {
                Ok(shorter) if shorter.error.is_some() && shorter.worst() <= MIN_GAIN * worst => steps = shorter,
                Err(error @ (Error::ContactAtEdge { .. } | Error::OutOfMemory { .. })) => return Err(error),
                _ => break,
            }
        }
        Ok(steps)
    }

    /// The greater error of approach or force and of the greatest pressure of the run, 0 where they are unknown.
    fn worst(&self) -> f64 {
        self.error.map_or(0.0, |error| error.main.max(error.pressure))
    }

    fn with_tolerance(scene: &Scene<'_>, grid: &Grid) -> Result<Steps> {
        let run = scene.follow(grid.clone())?;
        let error = scene.with_shorter_steps(&run, grid.clone())?.map(|finer| {
            let over = |of: fn(&State) -> f64, all: bool| difference(&run.states, &finer, of, all);
            let [highest, finest] = [&run.states, &finer].map(|states| greatest(states, |state| state.pressure));
            TimeError {
                main: over(|state| state.approach, true).max(over(|state| state.force, true)),
                pressure: relative((highest - finest).abs(), finest),
                pressure_over_time: over(|state| state.pressure, false),
            }
        });
        Ok(Steps { tolerance: scene.tolerance, run, error })
    }
}
