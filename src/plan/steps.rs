//! The steps of a trial run and their error in time, from its levels or from the difference to a run with shorter steps.

use crate::Grid;
use crate::error::{Error, Result, StepError};
use crate::plan::Accuracy;
use crate::plan::difference::{Differences, unseen};
use crate::plan::levels::{Curve, Trace};
use crate::plan::scene::{Run, TrialScene};
use crate::states::unless_refused;

/// Shares of the accuracy: greatest of the error in time, of the errors in time and of the mesh together, and least of
/// the error of the mesh.
const MAX_TIME_SHARE: f64 = 0.6;
const BOTH_SHARES: f64 = 0.9;
const MIN_MESH_SHARE: f64 = 0.2;
/// Greatest error in time of the greatest pressure, as a share of the accuracy: of a run on cells, and of one on levels. A run on coarse cells
/// shows less of it than the planned run will have, whose finer cells a growing edge crosses in a shorter time.
const MAX_PEAK_TIME_SHARE: f64 = 0.2;
const MAX_PEAK_TIME_SHARE_ON_LEVELS: f64 = 0.3;
/// Greatest number of times that steps are shortened.
const MAX_STEP_TRIES: u32 = 3;
/// Least factor of the tolerance at a time, and the greatest part of the error that may remain for a shortening to be
/// kept.
const MAX_SHORTENING: f64 = 0.2;
const MIN_GAIN: f64 = 0.8;
/// Ratio of the tolerances of two runs whose difference estimates the error in time of the first, and the smallest
/// tolerance of a run.
const SHORTER: f64 = 0.125;
const LEAST_TOLERANCE: f64 = 1e-9;

/// The steps of a trial run, and their error in time.
pub(super) struct Steps {
    pub(super) tolerance: f64,
    pub(super) run: Run,
    /// `None` where steps short enough for a comparison do not exist.
    pub(super) error: Option<Differences>,
    /// [`unseen`] of the greatest pressure of a run on cells.
    pub(super) unseen: f64,
    /// Times at which steps end besides, for the greatest pressure.
    pub(super) stops: Vec<f64>,
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
        let share = if self.trace.is_some() { MAX_PEAK_TIME_SHARE_ON_LEVELS } else { MAX_PEAK_TIME_SHARE };
        self.unseen <= MAX_TIME_SHARE * target && self.error.is_none_or(|error| error.pressure <= share * target)
    }

    /// Shortens the steps while the error of approach or force, or of the greatest pressure on cells, exceeds its share and falls with the
    /// steps. On levels [more steps before the greatest pressure](Steps::stop_before_peaks) are enough for that.
    pub(super) fn find(scene: &TrialScene<'_>, grid: &Grid, curve: Option<&Curve>) -> Result<Steps> {
        let target = scene.asked.accuracy.target();
        let mut steps = Steps::with_tolerance(scene, grid, curve, scene.asked.accuracy.step_tolerance())?;
        for _ in 0..MAX_STEP_TRIES {
            let worst = steps.worst();
            if worst <= MAX_TIME_SHARE * target {
                break;
            }
            let tolerance = (steps.tolerance * (0.5 * target / worst).max(MAX_SHORTENING)).max(LEAST_TOLERANCE);
            match Steps::with_tolerance(scene, grid, curve, tolerance) {
                Ok(shorter) if shorter.error.is_some() && shorter.worst() <= MIN_GAIN * worst => steps = shorter,
                Err(error @ Error::Step(StepError::ContactAtEdge { .. })) => return Err(error),
                // shorter steps gain nothing, or are too short
                Ok(_) | Err(Error::Step(_)) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(steps)
    }

    /// Ends more steps before the greatest pressure of a run on levels, on so many cells across the widest contact.
    pub(super) fn stop_before_peaks(&mut self, scene: &TrialScene<'_>, curve: &Curve, across: f64) -> Result<()> {
        if let (Some(trace), Some(error)) = (&self.trace, self.error.as_mut()) {
            let found = curve.stops(scene, &self.run, trace, across);
            (self.stops, error.pressure) = unless_refused(found.map(Some))?.unwrap_or((Vec::new(), error.pressure));
        }
        Ok(())
    }

    /// Number of steps over the number in the trial run.
    pub(super) fn growth(&self) -> f64 {
        let taken = self.run.steps.len().max(1) as f64;
        (taken + self.stops.len() as f64) / taken
    }

    /// The greater of the errors of approach or force, and of the greatest pressure of a run on cells; 0 where nothing was estimated.
    fn worst(&self) -> f64 {
        let of_pressure = |error: Differences| if self.trace.is_none() { error.pressure.max(self.unseen) } else { 0.0 };
        self.error.map_or(0.0, |error| error.main.max(of_pressure(error)))
    }

    fn with_tolerance(scene: &TrialScene<'_>, grid: &Grid, curve: Option<&Curve>, tolerance: f64) -> Result<Steps> {
        let run = scene.follow(grid.clone(), tolerance, &[])?;
        // levels may leave their order, as if there were no states
        if let Some(trace) = unless_refused(curve.map(|curve| curve.trace(scene, &run)).transpose())? {
            let (error, trace) = (Some(trace.error), Some(trace));
            return Ok(Steps { tolerance, run, error, unseen: 0.0, stops: Vec::new(), trace });
        }
        // ends within every step of the run, since its control may have missed an event there
        let times = run.times();
        let middles = times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let stops: Vec<f64> = times.iter().copied().chain(middles).collect();
        match scene.follow(grid.clone(), (SHORTER * tolerance).max(LEAST_TOLERANCE), &stops) {
            Err(Error::Step(StepError::StepTooShort { .. } | StepError::NotConverged { .. })) => {
                Ok(Steps { tolerance, run, error: None, unseen: 0.0, stops: Vec::new(), trace: None })
            }
            finer => {
                let finer = finer?;
                let over_time: Vec<[f64; 2]> = finer.states.iter().map(|state| [state.time, state.pressure]).collect();
                let unseen = unseen(scene, &run, &over_time);
                let error = Some(Differences::between(&run.states, &finer.at_the_times_of(&run).states, None));
                Ok(Steps { tolerance, run, error, unseen, stops: Vec::new(), trace: None })
            }
        }
    }
}
