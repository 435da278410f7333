//! Steps in which the indenter moves over the grid.

use crate::contact::settings::Frame;
use crate::contact::stepper::ViscoelasticContact;
use crate::error::{Error, Result};
use crate::geometry::Gap;
use crate::load::Load;
use crate::motion::{Travel, TravelReport};

impl ViscoelasticContact {
    /// A step at whose end the indenter is where `travel` says: the bodies stay where they are. The time is the contact's own:
    /// at its start the indenter should be at the path's position there.
    ///
    /// The sharper the shape, the shorter the steps: an indenter should not move by more than a part of the contact's
    /// length in each. With [`Settings::window`](crate::contact::Settings::window) what is computed grows with the track.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`], or if the path or a gap is not finite, there are several rigid bodies, or the grid is
    /// fixed to the indenter. The contact, its indenter included, is then where it was.
    pub fn step_along(&mut self, travel: &Travel, dt: f64, load: Load) -> Result<TravelReport> {
        if self.settings.frame != Frame::Bodies {
            return Err(Error::WrongFrame { what: "a step along a path" });
        }
        if self.loads.len() != 1 {
            return Err(Error::WrongNumberOfBodies { given: 1, bodies: self.loads.len() });
        }
        let (start, end) = (self.time, self.time + dt);
        let from = travel.position(start)?;
        let mut gap = vec![f64::INFINITY; self.grid.len()];
        travel.fill_gap(end, &self.grid, &mut gap, &mut Vec::new())?;
        let before = self.replace_gap(Gap::new(&[gap], &self.grid)?);
        match self.step(dt, load) {
            Ok(step) => {
                let position = travel.position(self.time)?;
                let lateral_force = self.lateral_force(&travel.shape_at(self.time)?);
                let work: f64 = (0..2).map(|axis| lateral_force[axis] * (position[axis] - from[axis])).sum();
                Ok(TravelReport { step, position, lateral_force, power: if dt > 0.0 { work / dt } else { 0.0 } })
            }
            Err(error) => {
                self.replace_gap(before);
                Err(error)
            }
        }
    }
}
