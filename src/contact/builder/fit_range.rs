//! The range of times over which the series of a material is fitted.

use std::ops::RangeInclusive;

use crate::error::{Error, Result};
use crate::load::LoadHistory;
use crate::rheology::{Material, TemperatureHistory};

/// Ratio of the shortest time of a run to the shortest time between corners of its load.
const SHORTEST_PART: f64 = 1e-6;
/// Number of corners of the load that are compared.
const MAX_CORNERS: usize = 1000;
/// Number of temperatures among which the slowest creep of a run is sought.
const TEMPERATURES: i32 = 64;

/// The times over which the series of a material is fitted.
#[derive(Debug, Clone)]
pub(in crate::contact) struct Times {
    pub(super) range: RangeInclusive<f64>,
    /// Whether the times come from a run; a run fails where the material is not known.
    pub(super) of_run: bool,
}

impl Times {
    /// The times of a run along `history` to the time `until`.
    pub(in crate::contact) fn of_run(history: &dyn LoadHistory, until: f64) -> Times {
        let (mut shortest, mut corner) = (until, 0.0);
        for _ in 0..MAX_CORNERS {
            match history.next_breakpoint(corner) {
                Some(next) if next > corner && next < until => {
                    shortest = shortest.min(next - corner);
                    corner = next;
                }
                _ => break,
            }
        }
        Times { range: SHORTEST_PART * shortest..=until, of_run: true }
    }

    /// The material, with a series over these times if it has no exact series.
    pub(in crate::contact) fn fit(
        &self,
        material: &Material,
        temperature: Option<&TemperatureHistory>,
        tolerance: f64,
    ) -> Result<Material> {
        let (mut first, mut last) = (*self.range.start(), *self.range.end());
        if self.of_run {
            if let Some(history) = temperature {
                let slowest = (0..=TEMPERATURES).try_fold(f64::INFINITY, |least: f64, k| {
                    let rate = history.rate(last * f64::from(k) / f64::from(TEMPERATURES))?;
                    Ok::<_, Error>(least.min(rate))
                })?;
                (first, last) = (first * slowest, history.reduced_time(0.0, last)?);
            }
            last = last.min(material.known_until()).max(first);
        }
        material.fitted(first..=last, tolerance)
    }
}
