//! Times at which a load is greater than just before and just after.

use crate::error::{Error, Result};
use crate::load::{Load, LoadHistory, Tilt};

/// Number of equal parts of a run, at whose ends its load is looked at before the first step: a load that acts for a
/// shorter time is found only if its history names a breakpoint there.
const PARTS_OF_RUN: u32 = 4096;
/// Number of equal parts of a step, for runs whose parts are longer than what happens in them.
const PARTS_OF_STEP: usize = 64;
/// Loads that differ by less than this part of them are the same but for rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The prescribed approach of an upright body, or of the far end of its spring: of a body that is apart, where it is.
pub(super) fn approach(load: &Load) -> Option<f64> {
    match *load {
        Load::Approach { approach: at, tilt: [Tilt::Fixed(0.0), Tilt::Fixed(0.0)] }
        | Load::Spring { drive: at, tilt: [Tilt::Fixed(0.0), Tilt::Fixed(0.0)], .. } => Some(at),
        _ => None,
    }
}

/// The tops of a load over a whole run, ascending. Rejects invalid loads.
pub(super) fn tops_of_run(
    history: &dyn LoadHistory,
    ends: [f64; 2],
    corners: &[f64],
    attracts: bool,
) -> Result<Vec<f64>> {
    let load = |time: f64| Ok::<_, Error>(history.checked_at(time, attracts)?.main());
    let time = |k: u32| ends[0] + (ends[1] - ends[0]) * f64::from(k) / f64::from(PARTS_OF_RUN);
    let samples = (0..=PARTS_OF_RUN).map(|k| Ok((time(k), load(time(k))?))).collect::<Result<Vec<_>>>()?;
    // steps end at corners anyway
    let named = |top: &f64| {
        let part = (ends[1] - ends[0]) / f64::from(PARTS_OF_RUN);
        let after = corners.partition_point(|&corner| corner < top - part);
        corners.get(after).is_some_and(|&corner| corner <= top + part)
    };
    Ok(tops(&samples).filter(|top| !named(top)).collect())
}

/// The first of the tops of a load within a step, as equal parts of the step show, that `counts`.
pub(super) fn first_top_of_step(
    history: &dyn LoadHistory,
    [from, to]: [f64; 2],
    counts: impl Fn(&f64) -> bool,
) -> Option<f64> {
    let samples: [_; PARTS_OF_STEP + 1] = std::array::from_fn(|k| {
        let time = from + (to - from) * k as f64 / PARTS_OF_STEP as f64;
        (time, history.at(time).main())
    });
    tops(&samples).find(counts)
}

/// The tops of the parabolas through each three samples whose middle one is the maximum.
fn tops(samples: &[(f64, f64)]) -> impl Iterator<Item = f64> {
    samples.windows(3).filter_map(|three| {
        let [(start, before), (time, load), (end, after)] = three else { return None };
        let (rise, fall) = (load - before, load - after);
        let is_top = rise > ROUNDING * load.abs() && fall >= 0.0;
        is_top.then(|| time + 0.25 * (end - start) * (rise - fall) / (rise + fall))
    })
}
