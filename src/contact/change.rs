//! Between steps: runs along histories, other geometries, and the state within the last step.

use crate::contact::follow::{Follow, Stepping};
use crate::contact::reside::symmetry;
use crate::contact::viscoelastic::{ViscoelasticContact, next_id};
use crate::error::{Error, Result};
use crate::geometry::{Gap, Geometry, evaluate};
use crate::load::LoadHistory;

impl ViscoelasticContact {
    /// Follows a load history to the time `until` \[s\], step by step as `stepping` says.
    pub fn follow<'a>(&'a mut self, history: &'a dyn LoadHistory, stepping: Stepping, until: f64) -> Follow<'a> {
        Follow::new(self, history, stepping, until)
    }

    /// Replaces the indenter, moved or changed, between two steps; the bodies keep their deformation,
    /// and touch the new one from the next step on.
    ///
    /// # Errors
    /// If a gap is NaN or −∞, or none is finite, or there are several rigid bodies, or there is no memory for what is no longer
    /// symmetric; the contact then keeps the old one.
    pub fn set_geometry(&mut self, geometry: &dyn Geometry) -> Result<()> {
        self.set_geometries(&[geometry])
    }

    /// [`ViscoelasticContact::set_geometry`] with a geometry for each rigid body.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::set_geometry`], or if there is not one geometry a body.
    pub fn set_geometries(&mut self, geometries: &[&dyn Geometry]) -> Result<()> {
        if geometries.len() != self.state.loads.len() {
            return Err(Error::WrongNumberOfBodies { given: geometries.len(), bodies: self.state.loads.len() });
        }
        let gaps = geometries.iter().map(|geometry| evaluate(*geometry, &self.grid)).collect::<Result<Vec<_>>>()?;
        self.move_back();
        let gap = Gap::new(gaps, &self.grid)?;
        let still = self.still_even(&gap);
        if still != self.region.folded() {
            self.check_room(&self.unfolded(still))?;
        }
        self.initial_gap = gap;
        self.gap_here = self.region.cut_gap(&self.initial_gap);
        self.take_in_the_gap(still);
        self.state.last_dt = 0.0; // the last change of the pressure says nothing about the next
        Ok(())
    }

    /// Brings what hangs on the gap up to date with a new one, which is even about the axes `still` folded.
    pub(super) fn take_in_the_gap(&mut self, still: [bool; 2]) {
        self.gap_id = next_id();
        self.state.gap_is_new = true;
        if let Some(here) = &mut self.gap_here {
            self.region.cut_into(&self.initial_gap.above, &mut here.above);
            here.datum = self.initial_gap.datum;
        }
        self.survey();
        if still != self.region.folded() {
            self.reside(self.unfolded(still));
        }
        self.hulls.fill(None);
    }

    /// Folded axes about which a gap is even.
    pub(super) fn still_even(&self, gap: &Gap) -> [bool; 2] {
        let folded = self.region.folded();
        if folded == [false; 2] {
            return folded;
        }
        let even = symmetry(gap, self.grid.cells());
        [0, 1].map(|axis| folded[axis] && even[axis])
    }
}
