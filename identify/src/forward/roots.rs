//! Roots of the balances of a contact, found once and used again for derivatives.

use crate::forward::Stop;
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
    /// Starts to find roots.
    pub(super) fn clear(&mut self) {
        self.found.clear();
        self.replayed = None;
    }

    /// Starts to replay the roots that were found.
    pub(super) fn rewind(&mut self) {
        self.replayed = Some(0);
    }

    /// The root of a function that falls between two values, as [`root`].
    pub(super) fn solve<T: Real>(
        &mut self,
        bracket: [T; 2],
        tolerance: f64,
        mut value: impl FnMut(T) -> Result<T, Stop>,
    ) -> Result<T, Stop> {
        let [low, high] = bracket.map(T::value);
        let at = match self.replayed {
            Some(next) => {
                self.replayed = Some(next + 1);
                *self.found.get(next).ok_or(Stop::NoRoot)?
            }
            None => {
                let root = root([low, high], tolerance, |at| Ok(value(T::from(at))?.value()))?;
                if root.is_nan() {
                    return Err(Stop::NoRoot);
                }
                self.found.push(root);
                root
            }
        };
        // an end is what it depends on; a root inside depends on what its equation depends on
        let end = bracket.into_iter().find(|end| end.value() == at);
        match end {
            Some(end) => Ok(end),
            None if T::DERIVES => Ok(T::implicit(at, value(T::unknown(at))?)),
            None => Ok(T::from(at)),
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
