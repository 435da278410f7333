//! A control of steps in a file.

use super::StepControl;
use crate::states::contact::StatesContact;

/// A control in a file.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(in crate::states) struct SavedControl {
    until: f64,
    next: f64,
    corner: f64,
    by_force: bool,
    greatest: [f64; 2],
    loads: Vec<(f64, f64)>,
    greatest_load: f64,
    pressed: f64,
    rejected: u64,
}

impl SavedControl {
    pub(in crate::states) fn of(control: &StepControl) -> SavedControl {
        let StepControl { until, next, corner, by_force, greatest, greatest_load, pressed, rejected, .. } = *control;
        let loads = control.loads.clone();
        SavedControl { until, next, corner, by_force, greatest, loads, greatest_load, pressed, rejected }
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    pub(in crate::states) fn fits(&self) -> bool {
        let sizes = [self.until, self.next, self.greatest[0], self.greatest[1], self.greatest_load, self.pressed];
        let times = self.loads.iter().flat_map(|(time, load)| [*time, *load]);
        sizes.iter().all(|&size| size >= 0.0) && times.chain([self.next, self.corner]).all(f64::is_finite)
    }

    /// The control of a run that continues from this `contact`.
    pub(in crate::states) fn resumed(self, contact: &StatesContact) -> StepControl {
        let SavedControl { until, next, corner, by_force, greatest, loads, greatest_load, pressed, rejected } = self;
        let new = StepControl::new(contact, until);
        StepControl { next, corner, by_force, greatest, loads, greatest_load, pressed, rejected, ..new }
    }
}
