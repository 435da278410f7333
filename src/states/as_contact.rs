//! A contact on elastic states, as one of either kind.

use crate::contact::{Contact, StepReport};
use crate::error::Result;
use crate::fields::Fields;
use crate::load::Load;
use crate::states::contact::StatesContact;

impl Contact for StatesContact {
    fn step(&mut self, dt: f64, load: Load) -> Result<StepReport> {
        StatesContact::step(self, dt, load)
    }

    fn time(&self) -> f64 {
        StatesContact::time(self)
    }

    fn force(&self) -> f64 {
        StatesContact::force(self)
    }

    fn approach(&self) -> f64 {
        StatesContact::approach(self)
    }

    fn tilt(&self) -> [f64; 2] {
        StatesContact::tilt(self)
    }

    fn contact_area(&self) -> f64 {
        StatesContact::contact_area(self)
    }

    fn is_separated(&self) -> bool {
        StatesContact::is_separated(self)
    }

    fn in_space(&self) -> Option<Fields<'_>> {
        None
    }
}
