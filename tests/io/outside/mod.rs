//! Scenes outside the model: each is refused, or warns with its number, and says the cure. Scenes inside warn of nothing.

mod limits;
mod motions;
mod others;
mod silent;
mod surfaces;

use viscocontact::Error;
use viscocontact::contact::{Figures, StepReport, Warnings};

/// What a scene must end in: a warning, or an error; and words of its cure.
#[derive(Clone, Copy)]
enum End {
    Warned(Warnings, &'static str),
    Refused(&'static str),
}
use End::{Refused, Warned};

impl End {
    /// Whether a scene ended so; what it did instead.
    fn judge(self, ended: Result<StepReport, Error>) -> Result<(), String> {
        let report = match (self, ended) {
            (Warned(..), Ok(report)) => report,
            (Refused(cure), Err(error)) if format!("{error:?}").contains(cure) => return Ok(()),
            (_, Ok(report)) => return Err(format!("accepted: {report}")),
            (_, Err(error)) => return Err(format!("refused: {error}")),
        };
        let Warned(warning, cure) = self else { return Ok(()) };
        let of_warning = warning.to_string();
        let message = report.messages().find(|message| message.starts_with(&of_warning));
        let Some(message) = message.filter(|message| message.contains(cure)) else {
            return Err(format!("not warned of: {report}"));
        };
        // the number stands at the end, in brackets
        let printed = message.rsplit(' ').next().and_then(|word| word.trim_end_matches(')').parse::<f64>().ok());
        match (number(warning, &report), printed) {
            (Some(number), Some(printed)) if (printed - number).abs() <= 1e-3 * number.abs() => Ok(()),
            (None, None) if WITHOUT_NUMBER.contains(warning) => Ok(()),
            (number, _) => Err(format!("{message} for {number:?}")),
        }
    }
}

/// Judges scenes by their names, and fails with all that ended otherwise.
fn judge_all<'a>(scenes: impl Iterator<Item = (String, End, Result<StepReport, Error>)> + 'a, least: usize) {
    let mut count = 0;
    let wrong: Vec<String> = scenes
        .inspect(|_| count += 1)
        .filter_map(|(name, end, ended)| end.judge(ended).err().map(|wrong| format!("{name}: {wrong}")))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count >= least, "{count}");
}

const WITHOUT_NUMBER: Warnings = Warnings::NEAR_EDGE
    .union(Warnings::FLAT)
    .union(Warnings::EXTRAPOLATED)
    .union(Warnings::FASTER_THAN_MATERIAL)
    .union(Warnings::NEAR_END_OF_MATERIAL);

/// The number of a warning, in the fields of its report.
fn number(warning: Warnings, report: &StepReport) -> Option<f64> {
    let Figures { max_slope, compression, cells_across, cells_in_wave, periods, modulus, touch, .. } = report.figures;
    match warning {
        Warnings::STEEP => max_slope,
        Warnings::DEEP => compression,
        Warnings::SHORT_WAVES => cells_in_wave,
        Warnings::OTHER_PERIOD => periods,
        Warnings::MODULUS => modulus,
        Warnings::NO_CONTACT => touch,
        Warnings::LONG_STEP => report.time_error,
        Warnings::FEW_CELLS => cells_across,
        _ => None,
    }
}
