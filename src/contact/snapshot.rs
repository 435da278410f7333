//! States kept in memory, for callers that try steps and take them back.

use std::fmt;

use crate::contact::region::Region;
use crate::contact::reside::Beyond;
use crate::contact::state::State;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Error, Result};
use crate::geometry::Gap;
use crate::hereditary::History;
use crate::rheology::Material;

/// The state of a contact in memory, made by [`ViscoelasticContact::snapshot`]: what steps change, without kernel and work
/// space. About 60 bytes a computed cell, 8 more for each relaxation time.
#[derive(Clone)]
pub struct Snapshot {
    region: Region,
    beyond: Option<Beyond>,
    history: History,
    material: Material,
    gap: Gap,
    gap_id: u64,
    state: State,
    /// The displacement before the last step.
    before: Vec<f64>,
    contact: u64,
}

impl Snapshot {
    /// The time of the state \[s\].
    pub fn time(&self) -> f64 {
        self.state.time
    }
}

impl fmt::Debug for Snapshot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Snapshot").field("time", &self.state.time).finish_non_exhaustive()
    }
}

impl ViscoelasticContact {
    /// The state as it is, to come back to.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// let mut start = contact.snapshot();
    /// // an outer solver looks for the approach that carries 0.4 N after a step of 0.1 s
    /// let (mut low, mut high) = (0.0, 2.0 * contact.approach());
    /// for _ in 0..20 {
    ///     contact.restore(&start)?;
    ///     let middle = 0.5 * (low + high);
    ///     contact.step(0.1, Load::approach(middle))?;
    ///     if contact.force() < 0.4 { low = middle } else { high = middle }
    /// }
    /// assert!((contact.force() - 0.4).abs() < 1.0e-3);
    /// contact.snapshot_into(&mut start); // on from here, in the same memory
    /// # Ok::<(), Error>(())
    /// ```
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            region: self.region.clone(),
            beyond: self.beyond.clone(),
            history: self.history.clone(),
            material: self.material.clone(),
            gap: self.initial_gap.clone(),
            gap_id: self.gap_id,
            state: self.state.clone(),
            before: self.trial_displacement.clone(),
            contact: self.id,
        }
    }

    /// [`ViscoelasticContact::snapshot`] in the memory of one made before: allocates nothing while the region that is
    /// computed and the indenter stay where they are, and no direct sum grows.
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        if snapshot.contact != self.id || snapshot.region != self.region {
            *snapshot = self.snapshot();
            return;
        }
        if snapshot.gap_id != self.gap_id {
            (snapshot.gap, snapshot.gap_id) = (self.initial_gap.clone(), self.gap_id);
        }
        if snapshot.state.fitted_over != self.state.fitted_over {
            snapshot.material = self.material.clone();
        }
        match (&mut snapshot.beyond, &self.beyond) {
            (Some(own), Some(beyond)) => own.copy_from(beyond),
            (own, beyond) => *own = beyond.clone(),
        }
        snapshot.history.copy_from(&self.history);
        snapshot.state.copy_from(&self.state);
        snapshot.before.clone_from(&self.trial_displacement);
    }

    /// Goes back to a state, the indenter where it was then: the steps that follow are the same as they were, bit by bit. A run of
    /// adaptive steps ([`ViscoelasticContact::follow`]) begins anew, with steps of its own. Allocates nothing while the region that is computed and the indenter stay where they are.
    ///
    /// # Errors
    /// If the snapshot was made of another contact; a contact and its clones may exchange theirs.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        if snapshot.contact != self.id {
            return Err(Error::OtherContact);
        }
        self.before_move = None;
        let moved = snapshot.gap_id != self.gap_id;
        if moved {
            (self.initial_gap, self.gap_id) = (snapshot.gap.clone(), snapshot.gap_id);
            self.hulls.fill(None);
        }
        if snapshot.region != self.region {
            self.occupy(snapshot.region.clone());
        } else if moved {
            self.gap_here = self.region.cut_gap(&self.initial_gap);
        }
        if snapshot.state.fitted_over != self.state.fitted_over {
            self.material = snapshot.material.clone();
        }
        match (&mut self.beyond, &snapshot.beyond) {
            (Some(own), Some(beyond)) => own.copy_from(beyond),
            (own, beyond) => *own = beyond.clone(),
        }
        self.history.copy_from(&snapshot.history);
        self.state.copy_from(&snapshot.state);
        self.trial_displacement.clone_from(&snapshot.before);
        self.progress = None;
        if moved {
            self.survey();
        }
        self.show();
        Ok(())
    }
}
