//! States of a contact on levels, and what cells lose of their greatest pressure.

use crate::plan::error_law::ErrorLaw;
use crate::plan::rings::Rings;

/// Cells across the widest contact that are tried for a pressure at a growing rim, and a factor on what they are found to lose of it.
const TRIED_ACROSS: [f64; 2] = [14.0, 256.0];
const TRIES: i32 = 17;
const SAFETY: f64 = 2.0;
/// The pressure of an outermost cell is at most so many times the mean over its width: it is the greatest just before the next cell joins.
const OVERSHOOT: f64 = 2.0;
/// By how much a contact of few cells exceeds the levels holds for contacts of up to so many times as many cells. The excess counts where a contact is
/// smaller than this part of the contact of the greatest pressure.
const SIMILAR: f64 = 1.2;
const SMALLER: f64 = 0.5;
/// Where a pressure beside the middle comes as near the greatest as this, cells that join one after another scatter it: with 85 and 92 of them
/// across by up to 2.9e-3, twice this factor times their number to the power −3/2.
const BESIDE: f64 = 0.98;
const OF_JOINS: f64 = 1.25;

/// A state of a contact on levels.
pub(super) struct LevelState {
    pub(super) time: f64,
    /// Whether it is the state at the end of a step, not within one.
    pub(super) is_end: bool,
    pub(super) is_by_force: bool,
    pub(super) level: f64,
    /// What is proportional to its radius.
    pub(super) edge: f64,
    pub(super) depth: f64,
    pub(super) force: f64,
    pub(super) radius: f64,
    /// The greatest pressure, in a unit of its own, and where it is not in the middle the groups that it is made of.
    pub(super) peak: f64,
    /// Its distance from the middle, as an edge of levels.
    pub(super) place: f64,
    pub(super) rings: Option<Rings>,
    /// Greatest w of a level.
    pub(super) traction: f64,
    /// This w times the pressure in the middle of the elastic contact, over the greatest pressure.
    pub(super) amplification: f64,
}

/// Cells across a contact of a run, and its greatest pressure over that on levels in the same steps.
pub(super) struct FewCells {
    pub(super) across: f64,
    pub(super) excess: f64,
}

/// What cells lose of the `highest` pressure of a run, on a domain whose widest contact is so `wide`: up to the fewest that lose no more than
/// is allowed, and whose outermost cells never exceed the highest pressure. Neither may the cells of small contacts: contacts of as few cells in a
/// run `beside` the levels tell their excess. In the middle cells lose what they lose of an elastic contact.
pub(super) fn cells(
    all: &[LevelState],
    highest: Option<&LevelState>,
    beside: &[FewCells],
    wide: f64,
    allowed: f64,
) -> ErrorLaw {
    let Some(highest) = highest else { return ErrorLaw::ZERO };
    let of_rim =
        || all.iter().filter(|state| OVERSHOOT * state.peak > highest.peak).filter_map(|state| state.rings.as_ref());
    let of_few = |cells: f64| {
        let similar = beside.iter().filter(|few| SIMILAR * few.across >= cells);
        similar.map(|few| few.excess).fold(1.0, f64::max)
    };
    let of_small = || all.iter().filter(|state| state.edge < SMALLER * highest.edge);
    let is_beside = all.iter().any(|state| state.rings.is_some() && state.peak > BESIDE * highest.peak);
    let law = |across: f64| {
        let width = wide / across;
        let blurred = highest.blurred(width);
        let exceeds = of_rim().any(|rings| OVERSHOOT * rings.outermost(width) > highest.peak)
            || of_small().any(|state| {
                let cells = 2.0 * state.edge / width;
                cells >= 1.0 && state.peak * of_few(cells) > (1.0 + allowed) * highest.peak
            });
        let of_joins = if is_beside { OF_JOINS * across.powf(-1.5) } else { 0.0 };
        let (error, converges) = ((SAFETY * (1.0 - blurred / highest.peak)).max(of_joins), !exceeds);
        ErrorLaw { error, order: 1.0, across, converges: converges && error <= allowed }
    };
    let [fewest, most] = TRIED_ACROSS;
    let mut tried = (0..=TRIES).map(|k| law(fewest * (most / fewest).powf(f64::from(k) / f64::from(TRIES))));
    tried.find(|law| law.converges).unwrap_or(ErrorLaw { converges: false, ..ErrorLaw::ZERO })
}

impl LevelState {
    /// The greatest pressure, beside the middle as a mean over a width.
    pub(super) fn blurred(&self, width: f64) -> f64 {
        self.rings.as_ref().map_or(self.peak, |rings| rings.peak(width).pressure)
    }
}

/// The first state with the greatest pressure.
pub(super) fn highest_of(states: &[LevelState]) -> Option<&LevelState> {
    states.iter().reduce(|highest, state| if state.peak > highest.peak { state } else { highest })
}
