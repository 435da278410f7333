//! Scenes outside the model: each is refused, or warns with its number, and says the remedy. Scenes inside warn of nothing.

mod limits;
mod motions;
mod silent;
mod surfaces;

use viscocontact::Result;
use viscocontact::contact::{Figures, StepReport, Warnings};

/// What a step tells of its warnings; the number of each, where it has one, stands at the end of its message, in brackets.
fn told(report: StepReport) -> String {
    let Figures { max_slope, compression, cells_across, cells_in_wave, periods, modulus, touch, .. } = report.figures;
    for (warning, number) in [
        (Warnings::STEEP, max_slope),
        (Warnings::DEEP, compression),
        (Warnings::SHORT_WAVES, cells_in_wave),
        (Warnings::OTHER_PERIOD, periods),
        (Warnings::MODULUS, modulus),
        (Warnings::NO_CONTACT, touch),
        (Warnings::LONG_STEP, report.time_error),
        (Warnings::FEW_CELLS, cells_across),
    ] {
        if report.warnings.contains(warning) {
            let name = warning.to_string();
            let message = report.messages().find(|message| message.starts_with(&name)).unwrap_or_default();
            let printed = message.rsplit(' ').next().and_then(|word| word.trim_end_matches(')').parse::<f64>().ok());
            let is_printed =
                number.zip(printed).is_some_and(|(own, printed)| (printed - own).abs() <= 1e-3 * own.abs());
            assert!(is_printed, "{name} of {number:?}: {message}");
        }
    }
    report.messages().collect::<Vec<_>>().join("; ")
}

/// What a scene says instead of its words.
fn judge(name: &str, said: Result<String>, words: &str) -> Option<String> {
    let found = said.unwrap_or_else(|error| format!("{error:?}"));
    let ends = if found.is_empty() { "silent" } else { found.as_str() };
    (!found.contains(words)).then(|| format!("{name}: {ends}"))
}

type Scene = (&'static str, fn() -> Result<String>, &'static str);

/// Fails with all scenes that say something else than their words.
fn judge_all(scenes: &[Scene]) {
    let wrong: Vec<String> = scenes.iter().filter_map(|(name, scene, words)| judge(name, scene(), words)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
