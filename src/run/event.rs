//! A quantity of the contact that crosses a value.

use crate::error::{Error, Result, finite};

/// Differences to the value below this part of the largest one so far count as none, just after an event.
const NOISE: f64 = 1e-6;
/// The value that a quantity crosses, and the direction, in [`Run::stop_when`](crate::run::Run::stop_when).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Crossing {
    /// From below the value to the value, or from the value to above it.
    Up(f64),
    /// From above the value to the value, or from the value to below it.
    Down(f64),
}

impl Crossing {
    fn value(self) -> f64 {
        let (Crossing::Up(value) | Crossing::Down(value)) = self;
        value
    }

    /// How far a quantity is beyond the value.
    fn beyond(self, quantity: f64) -> f64 {
        match self {
            Crossing::Up(value) => quantity - value,
            Crossing::Down(value) => value - quantity,
        }
    }
}

/// Where the quantity of an event is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    /// Before the value, or at it: the event is met as soon as the value is left.
    Before,
    /// At the value, just after the event.
    Met,
    Beyond,
}

/// What a run watches: whether and when a quantity has crossed a value ([`Run::events`](crate::run::Run::events)).
pub struct Event<C> {
    quantity: Box<dyn Fn(&C) -> f64 + Send + Sync>,
    crossing: Crossing,
    /// At the start of the step to be taken, unknown before the first.
    side: Option<Side>,
    /// At the end of the step tried; `None` if it has crossed.
    next: Option<Side>,
    /// Maximum distance of the quantity from the value.
    greatest: f64,
    times: Vec<f64>,
    is_met: bool,
}

impl<C> Event<C> {
    /// The value, and the direction in which it is crossed.
    pub fn crossing(&self) -> Crossing {
        self.crossing
    }

    /// Whether the last step ended at this event.
    pub fn is_met(&self) -> bool {
        self.is_met
    }

    /// The times of all crossings so far \[s\]: none if the event was not met.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Whether the quantity lies beyond the value, perhaps since the start of the run, in which case the event is not
    /// met before the quantity has come back.
    pub fn is_beyond(&self) -> bool {
        matches!(self.side, Some(Side::Met | Side::Beyond))
    }

    pub(super) fn new(quantity: impl Fn(&C) -> f64 + Send + Sync + 'static, crossing: Crossing) -> Result<Event<C>> {
        finite("value of an event", crossing.value())?;
        let (quantity, times) = (Box::new(quantity), Vec::new());
        Ok(Event { quantity, crossing, side: None, next: None, greatest: 0.0, times, is_met: false })
    }

    /// How far the quantity of a contact is beyond the value.
    pub(super) fn beyond(&self, contact: &C) -> Result<f64> {
        let quantity = (self.quantity)(contact);
        if quantity.is_nan() {
            let allowed = "a number in every state of the run, so return one for bodies that are apart as well";
            return Err(Error::OutOfRange { field: "quantity of Run::stop_when", value: quantity, allowed });
        }
        Ok(self.crossing.beyond(quantity))
    }

    /// Begins a step.
    pub(super) fn begin(&mut self) {
        self.is_met = false;
    }

    /// Follows the quantity through a step, looked at so many times, from its start to its end. Returns the number of
    /// the first look at which it has crossed.
    pub(super) fn follow(&mut self, beyond: &[f64]) -> Option<usize> {
        let finite = beyond.iter().map(|beyond| beyond.abs()).filter(|beyond| beyond.is_finite());
        self.greatest = finite.fold(self.greatest, f64::max);
        self.next = self.side.or_else(|| self.side_after(None, 0.0, beyond[0]));
        (1..beyond.len()).find(|&k| {
            self.next = self.side_after(self.next, beyond[k - 1], beyond[k]);
            self.next.is_none()
        })
    }

    /// The step tried ends at this event, as near as it can be found.
    pub(super) fn meet(&mut self) {
        self.next = None;
    }

    /// Accepts the step tried, which ends at `time`.
    pub(super) fn settle(&mut self, time: f64) {
        self.is_met = self.next.is_none();
        self.side = self.next.or(Some(Side::Met));
        self.times.extend(self.is_met.then_some(time));
    }

    /// The side of a quantity that is `now` so far beyond the value, after it was at `side`; `None` if it has crossed.
    fn side_after(&self, side: Option<Side>, start: f64, now: f64) -> Option<Side> {
        let noise = NOISE * self.greatest;
        // the force of bodies that are apart is no rounding, however small the value is beside what acted before
        let is_nothing = now < 0.0 && now == self.crossing.beyond(0.0);
        let crosses = if start == 0.0 { now > 0.0 } else { now >= 0.0 };
        match side {
            None if now > 0.0 => Some(Side::Beyond),
            None => Some(Side::Before),
            Some(Side::Before) if crosses => None,
            Some(Side::Met | Side::Beyond) if now < -noise || is_nothing => Some(Side::Before),
            Some(Side::Met) if now > noise => Some(Side::Beyond),
            Some(Side::Beyond) if now == 0.0 => Some(Side::Before),
            side => side,
        }
    }
}

debug_by!(self: Event<C> => crossing: self.crossing, times: self.times);
