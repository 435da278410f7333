use crate::error::{Result, positive};
use crate::load::{Load, PiecewiseLinear, forward_load};

/// A load that changes linearly from one value to another in a given time from t = 0, and is constant before and
/// after.
///
/// ```
/// use viscocontact::load::{Load, LoadHistory, Ramp};
///
/// let ramp = Ramp::new(Load::force(0.0), Load::force(8.0), 2.0)?;
/// assert_eq!(ramp.at(0.5), Load::force(2.0));
/// assert_eq!(ramp.at(9.0), Load::force(8.0));
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp {
    table: PiecewiseLinear,
}

impl Ramp {
    /// From `from` at t = 0 to `to` at t = `duration` \[s\].
    ///
    /// # Errors
    /// If the duration is not finite and positive, a load is invalid, or the loads are of different kinds.
    pub fn new(from: Load, to: Load, duration: f64) -> Result<Ramp> {
        positive("duration of the ramp", duration)?;
        Ok(Ramp { table: PiecewiseLinear::new(&[(0.0, from), (duration, to)])? })
    }
}

forward_load!(self: Ramp => self.table);
