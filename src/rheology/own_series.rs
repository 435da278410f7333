//! Whether the series of a rheology is that of its creep.

use std::sync::Arc;

use crate::error::{Refusal, Result};
use crate::rheology::{Rheology, is_known};
use crate::rounded::rounded;

/// Rejects a rheology with a series of another function than its creep, at t = 0 and about each retardation time: a
/// contact takes steps by the series, and its elastic response by J(t). They may differ by a thousandth.
pub(super) fn series_is_creep(rheology: &Arc<dyn Rheology>) -> Result<()> {
    let Some(spectrum) = rheology.creep_spectrum() else { return Ok(()) };
    let until = rheology.known_until();
    let flow = Some(spectrum.glassy() / spectrum.fluidity()).filter(|time| time.is_finite() && *time > 0.0);
    let scales = spectrum.terms().iter().map(|(_, time)| *time).chain(flow);
    let times = scales.flat_map(|scale| [0.1, 1.0, 10.0].map(|part| part * scale)).filter(|&t| is_known(t, until));
    for time in std::iter::once(0.0).chain(times) {
        let [creep, series] = [rheology.creep_compliance(time), spectrum.compliance(time)];
        // what is no compliance is refused where it is used
        if (series - creep).abs() > 1e-3 * creep.abs() {
            let [time, creep, series] = [time, creep, series].map(|number| rounded(number, 5));
            let what = format!(
                "Rheology::creep_spectrum is the series of another body: J({time} s) = {series} 1/Pa by the series, \
                 but {creep} 1/Pa by Rheology::creep_compliance"
            );
            let remedy = "; return the series of the same function, or None";
            return Err(Refusal::value("material_other_series", what, remedy).into());
        }
    }
    Ok(())
}
