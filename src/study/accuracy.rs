//! What an accuracy asks of a run.

use crate::contact::Settings;
use crate::error::{Result, within};
use crate::study::tuning::TUNING;

/// Accepts the accuracies that studies take.
pub(super) fn check(accuracy: f64) -> Result<()> {
    within("accuracy", accuracy, (1e-6..=0.1).contains(&accuracy), "in [1e-6, 0.1]").map(drop)
}

/// Settings with the tolerances of an accuracy; the other settings are default.
pub(super) fn settings(accuracy: f64) -> Settings {
    let tolerance = (TUNING.of_solver * accuracy).clamp(1e-12, 1e-3);
    let series_tolerance = (TUNING.of_series * accuracy).clamp(1e-7, 1e-2);
    Settings { tolerance, series_tolerance, ..Settings::default() }
}
