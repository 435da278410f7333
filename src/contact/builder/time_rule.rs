//! The history that a time rule needs.

use crate::contact::settings::{Frame, Settings, TimeRule};
use crate::error::{Error, Result};
use crate::hereditary::{History, Weighting};
use crate::kernel::InfluenceKernel;
use crate::rheology::Material;

/// Whether only a part of the grid is computed. Elsewhere than on a half-space nothing is known of the displacement outside
/// a window.
pub(in crate::contact) fn windowed(settings: &Settings, history: &History, kernel: &InfluenceKernel) -> bool {
    settings.window && history.has_far_field() && kernel.is_half_space()
}

/// The history of bodies of `material` by the time rule of the settings, on no cells yet.
pub(in crate::contact) fn history_by(settings: &Settings, material: &Material, periodic: [bool; 2]) -> Result<History> {
    let glassy = material.checked_compliance(0.0, (0.0, 0.0))?;
    match settings.time_rule {
        TimeRule::Exponential | TimeRule::ExponentialLinear => {
            let creep = material.contact_spectrum()?.ok_or_else(|| material.no_series("a contact"))?;
            Ok(match settings.frame {
                Frame::Bodies => History::exponential(&creep),
                Frame::Indenter => History::moving_frame(&creep, periodic),
            })
        }
        _ if settings.frame == Frame::Indenter => Err(Error::WrongFrame { what: "a direct sum" }),
        TimeRule::Rectangle | TimeRule::RectangleUncached if glassy == 0.0 => {
            Err(Error::NoElasticResponse { time: 0.0, what: "the rectangle rule" })
        }
        TimeRule::Rectangle => Ok(History::direct_sum(Weighting::End)),
        TimeRule::RectangleUncached => Ok(History::direct_sum(Weighting::EndUncached)),
        TimeRule::Backward => Ok(History::direct_sum(Weighting::Start)),
    }
}
