//! How a run looks at a load history: the one rule, by which all see a pulse that one sees.
//!
//! Before its first adaptive step a run looks at its load at equal parts of its time and at both sides of its
//! breakpoints, within a step at equal parts of the step, where the run has looked within it, and where the parabolas
//! through three looks turn ([`Passage`](crate::run::passage::Passage)).

use crate::error::Result;
use crate::load::{Load, LoadHistory};

/// Number of equal parts of a run: a load that acts for a shorter time is found only if its history names a breakpoint
/// there, or a step is short.
pub(crate) const PARTS_OF_RUN: u32 = 4096;
/// Maximum number of breakpoints that are looked at before the run; later ones are seen as steps come to them.
const MOST_BREAKPOINTS: usize = 100_000;

/// The load just before and at ascending times of a run.
pub(crate) fn looks(
    history: &dyn LoadHistory,
    [start, until]: [f64; 2],
    attracts: bool,
) -> impl Iterator<Item = Result<(f64, [Load; 2])>> {
    let part = move |k: u32| start + (until - start) * f64::from(k) / f64::from(PARTS_OF_RUN);
    let mut equal = (0..=PARTS_OF_RUN).map(part).peekable();
    let mut corners =
        history.breakpoints(start).take(MOST_BREAKPOINTS).take_while(move |next| *next <= until).peekable();
    let times = std::iter::from_fn(move || {
        let corner = corners.next_if(|corner| equal.peek().is_some_and(|time| corner <= time));
        equal.next_if(|time| corner.is_none_or(|corner| corner == *time)).or(corner)
    });
    times.map(move |time| Ok((time, [history.checked_before(time, attracts)?, history.checked_at(time, attracts)?])))
}
