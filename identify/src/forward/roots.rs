//! Roots of the balances of a contact, found once and used again for derivatives.

use crate::error::{Error, Result};
use crate::forward::real::Real;

/// Iterations of a root.
const MAX_ITERATIONS: usize = 80;

/// The roots of one evaluation in their order: found with plain numbers, and replayed with numbers that carry derivatives.
#[derive(Clone, Debug, Default)]
pub(crate) struct Roots {
    found: Vec<f64>,
    replayed: Option<usize>,
}

impl Roots {
    /// Starts to find roots, or to replay those that were found.
    pub(super) fn begin(&mut self, replays: bool) {
        self.replayed = replays.then_some(0);
        if !replays {
            self.found.clear();
        }
    }

    /// The root of a function that falls between two values, as [`root`].
    pub(super) fn solve<const N: usize>(
        &mut self,
        bracket: [Real<N>; 2],
        tolerance: f64,
        mut value: impl FnMut(Real<N>) -> Result<Real<N>>,
    ) -> Result<Real<N>> {
        let [low, high] = bracket.map(Real::value);
        let at = match self.replayed {
            Some(next) => {
                self.replayed = Some(next + 1);
                self.found.get(next).copied().unwrap_or(f64::NAN)
            }
            None => {
                let root = root([low, high], tolerance, |at| Ok::<_, Error>(value(Real::from(at))?.value()))?;
                self.found.push(root);
                root
            }
        };
        if at.is_nan() {
            let reason = "the spring and the contact do not balance: check the stiffness of the spring and the moduli";
            return Err(Error::NotConverged { iterations: 0, reason });
        }
        // an end is what it depends on; a root inside depends on what its equation depends on
        let end = bracket.into_iter().find(|end| end.value() == at);
        match end {
            Some(end) => Ok(end),
            None if N > 0 => Ok(Real::implicit(at, value(Real::unknown(at))?)),
            None => Ok(Real::from(at)),
        }
    }
}

/// The root of a function that falls between two values, by the Illinois rule; the end that is nearer to a root outside, NaN without one.
pub(crate) fn root<E>(
    [mut low, mut high]: [f64; 2],
    tolerance: f64,
    mut value: impl FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let (mut below, mut above) = (value(low)?, value(high)?);
    if below <= 0.0 || above >= 0.0 {
        return Ok(if below <= 0.0 { low } else { high });
    }
    let (mut last_side, mut last) = (None, f64::NAN);
    for _ in 0..MAX_ITERATIONS {
        let at = low + (high - low) * (below / (below - above));
        let here = value(at)?;
        if here == 0.0 || (at - last).abs() <= tolerance || high - low <= tolerance {
            return Ok(at);
        }
        last = at;
        let side = here > 0.0;
        let share = if last_side == Some(side) { 0.5 } else { 1.0 };
        if side {
            (low, below, above) = (at, here, above * share);
        } else {
            (high, above, below) = (at, here, below * share);
        }
        last_side = Some(side);
    }
    Ok(f64::NAN)
}
