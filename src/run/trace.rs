//! How a run looks at a load history: by one rule, so that a pulse that one part of it sees all see.
//!
//! Before its first adaptive step a run looks at its load at equal parts of its time and at both sides of its
//! breakpoints ([`looks`]). Within a step it is looked at in uneven parts of the step, where the load was found to bend
//! before the run, and where the parabolas through three looks turn ([`Passage`](crate::run::passage::Passage)).

use crate::error::Result;
use crate::load::{Load, LoadHistory};

/// Number of equal parts of a run: a load that acts for a shorter time is found only if its history names a breakpoint
/// there, or a step is short.
pub(crate) const PARTS_OF_RUN: u32 = 4096;
/// Maximum number of breakpoints that are looked at before the run; later ones are seen as steps come to them.
const MOST_BREAKPOINTS: usize = 100_000;
/// A load bends where it is off the line between its neighbours by more than this part of them.
pub(crate) const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The load just before and at ascending times of a run, of its start as it is there.
pub(crate) fn looks(
    history: &dyn LoadHistory,
    start: f64,
    until: f64,
    attracts: bool,
) -> impl Iterator<Item = Result<(f64, [Load; 2])>> {
    let part = move |k: u32| start + (until - start) * f64::from(k) / f64::from(PARTS_OF_RUN);
    let mut equal = (0..=PARTS_OF_RUN).map(part).peekable();
    let corners = history.breakpoints(start).take(MOST_BREAKPOINTS).take_while(move |next| *next <= until);
    let mut corners = corners.peekable();
    let times = std::iter::from_fn(move || {
        let corner = corners.next_if(|corner| equal.peek().is_some_and(|time| corner <= time));
        match corner {
            Some(corner) => {
                equal.next_if(|time| *time == corner);
                Some(corner)
            }
            None => equal.next(),
        }
    });
    times.map(move |time| {
        let at = history.checked_at(time, attracts)?;
        Ok((time, [if time > start { history.checked_before(time, attracts)? } else { at }, at]))
    })
}

/// The times of a run at which its load bends or jumps.
pub(crate) fn bends(samples: &[(f64, f64)]) -> Vec<f64> {
    let is_bent = |three: &&[(f64, f64)]| {
        let [(start, a), (time, b), (end, c)] = three[..] else { return false };
        let off = (a + (c - a) * (time - start) / (end - start) - b).abs();
        // a jump has no line
        off.is_nan() || off > ROUNDING * a.abs().max(b.abs()).max(c.abs())
    };
    let mut times: Vec<f64> = samples.windows(3).filter(is_bent).map(|three| three[1].0).collect();
    times.dedup();
    times
}
