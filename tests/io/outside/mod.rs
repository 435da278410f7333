//! Scenes outside the model: each is refused, or warns with its number, and says the cure. Scenes inside warn of nothing.

mod limits;
mod others;
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
    fn judge(self, name: &str, ended: Result<StepReport, Error>) {
        match (self, ended) {
            (Warned(warning, cure), Ok(report)) => {
                assert!(report.warnings.contains(warning), "{name}: {report}");
                let of_warning = warning.to_string();
                let message = report.messages().find(|message| message.starts_with(&of_warning)).unwrap();
                assert!(message.contains(cure), "{name}: {message}");
                let counted = number(warning, &report);
                let printed =
                    message.rsplit([' ', '(']).next().and_then(|word| word.trim_end_matches(')').parse::<f64>().ok());
                match (counted, printed) {
                    (Some(counted), Some(printed)) => {
                        assert!((printed - counted).abs() <= 1e-3 * counted.abs(), "{name}: {message}, {counted}");
                    }
                    (None, _) => assert!(WITHOUT_NUMBER.contains(warning), "{name}: {message}"),
                    (Some(counted), None) => panic!("{name}: {message} without {counted}"),
                }
            }
            (Refused(cure), Err(error)) => assert!(format!("{error:?}").contains(cure), "{name}: {error:?}"),
            (_, Ok(report)) => panic!("{name} is accepted: {report}"),
            (_, Err(error)) => panic!("{name} is refused: {error}"),
        }
    }
}

const WITHOUT_NUMBER: Warnings = Warnings::NEAR_EDGE
    .union(Warnings::FLAT)
    .union(Warnings::EXTRAPOLATED)
    .union(Warnings::FASTER_THAN_MATERIAL)
    .union(Warnings::NEAR_END_OF_MATERIAL);

/// The number of a warning, in the fields of its report.
fn number(warning: Warnings, report: &StepReport) -> Option<f64> {
    let Figures { max_slope, compression, cells_in_wave, periods, modulus, touch, .. } = report.figures;
    match warning {
        Warnings::STEEP => max_slope,
        Warnings::DEEP => compression,
        Warnings::SHORT_WAVES => cells_in_wave,
        Warnings::OTHER_PERIOD => periods,
        Warnings::MODULUS => modulus,
        Warnings::NO_CONTACT => touch,
        Warnings::LONG_STEP => report.time_error,
        Warnings::FEW_CELLS => Some(report.contact_cells as f64),
        _ => None,
    }
}
