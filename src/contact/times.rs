//! The times over which a material is wanted.

use std::ops::RangeInclusive;

use crate::error::Result;
use crate::load::LoadHistory;
use crate::rheology::Material;

/// The shortest time that a run is taken to look at is this part of the shortest time between corners of its load, ...
const SHORTEST_PART: f64 = 1e-6;
/// ... of the first so many.
const MAX_CORNERS: usize = 1000;

/// The times over which the series of a material is fitted.
#[derive(Debug, Clone)]
pub(super) struct Times {
    range: RangeInclusive<f64>,
    /// Whether they were taken from a run, which fails where the material is not known.
    of_run: bool,
}

impl Times {
    pub(super) fn new(range: RangeInclusive<f64>) -> Times {
        Times { range, of_run: false }
    }

    /// Those of a run along `history` to the time `until`.
    pub(super) fn of_run(history: &dyn LoadHistory, until: f64) -> Times {
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

    /// The material with a series over these times, where it has no exact one.
    pub(super) fn fit(&self, material: &Material, tolerance: f64) -> Result<Material> {
        let (first, mut last) = (*self.range.start(), *self.range.end());
        if self.of_run {
            last = last.min(material.known_until()).max(first);
        }
        material.fitted(first..=last, tolerance)
    }
}
