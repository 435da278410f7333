//! States kept in memory, for callers that try steps and take them back.

use std::fmt;
use std::sync::Arc;

use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::contact::stepper::ViscoelasticContact;
use crate::error::{Error, Result};

/// The state of a contact in memory, made by [`ViscoelasticContact::snapshot`]: what steps change, without kernel and work
/// space. About 48 bytes per computed cell and what the history takes ([`Memory`](crate::contact::Memory)); where a window is
/// computed, 16 and the history again.
#[derive(Clone)]
pub struct Snapshot {
    scene: Arc<Scene>,
    state: State,
}

impl Snapshot {
    /// The time of the state \[s\].
    pub fn time(&self) -> f64 {
        self.state.clock.time
    }
}

impl fmt::Debug for Snapshot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Snapshot").field("time", &self.state.clock.time).finish_non_exhaustive()
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
        Snapshot { scene: Arc::clone(&self.scene), state: self.computation.state.clone() }
    }

    /// [`ViscoelasticContact::snapshot`] into one made before. Allocates nothing while the region that is computed stays the
    /// same and no direct sum grows.
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        if Arc::ptr_eq(&snapshot.scene, &self.scene) {
            snapshot.state.copy_from(&self.computation.state);
        } else {
            *snapshot = self.snapshot();
        }
    }

    /// Goes back to a state, with the indenter where it was then: the steps that follow are the same as they were, bitwise. A
    /// run of adaptive steps ([`ViscoelasticContact::follow`]) begins anew, with steps of its own. Allocates nothing while the
    /// region that is computed stays the same and no direct sum grows.
    ///
    /// # Errors
    /// If the snapshot was made of another contact; a contact and its clones may exchange theirs.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        if !Arc::ptr_eq(&snapshot.scene, &self.scene) {
            return Err(Error::OtherContact);
        }
        self.computation.restore(&self.scene, &snapshot.state);
        self.view.refresh(&self.computation.state);
        self.progress = None;
        Ok(())
    }
}
