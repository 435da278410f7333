//! States kept in memory, for callers that try steps and take them back.

use crate::contact::guess::Refresh;
use crate::contact::region::Region;
use crate::contact::reside::Beyond;
use crate::contact::stepper::ViscoelasticContact;
use crate::error::{Error, Result};
use crate::geometry::Gap;
use crate::hereditary::History;
use crate::load::Load;
use crate::rheology::Material;
use crate::solver::Solution;

/// The state of a contact in memory, made by [`ViscoelasticContact::snapshot`]: what the others change from step to step, without
/// kernel and work space. About 60 bytes a computed cell, 8 more for each relaxation time.
#[derive(Debug, Clone)]
pub struct Snapshot {
    region: Region,
    beyond: Option<Beyond>,
    placed: bool,
    history: History,
    material: Material,
    fitted_over: Option<[f64; 2]>,
    undisturbed_until: f64,
    shortest: f64,
    gap: Gap,
    gap_id: u64,
    time: f64,
    loads: Vec<Load>,
    displacement: Vec<f64>,
    before: Vec<f64>,
    before_is_kept: bool,
    current: Solution,
    previous: Solution,
    motions: Vec<[f64; 3]>,
    previous_motions: Vec<[f64; 3]>,
    contact_cells: usize,
    interval: f64,
    last_dt: f64,
    refresh: Refresh,
    contact: u64,
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
            placed: self.placed,
            history: self.history.clone(),
            material: self.material.clone(),
            fitted_over: self.fitted_over,
            undisturbed_until: self.undisturbed_until,
            shortest: self.shortest,
            gap: self.initial_gap.clone(),
            gap_id: self.gap_id,
            time: self.time,
            loads: self.loads.clone(),
            displacement: self.displacement.clone(),
            before: self.trial_displacement.clone(),
            before_is_kept: self.before_is_kept,
            current: self.current.clone(),
            previous: self.previous.clone(),
            motions: self.motions.clone(),
            previous_motions: self.previous_motions.clone(),
            contact_cells: self.contact_cells,
            interval: self.interval,
            last_dt: self.last_dt,
            refresh: self.refresh,
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
        if snapshot.fitted_over != self.fitted_over {
            (snapshot.material, snapshot.fitted_over) = (self.material.clone(), self.fitted_over);
        }
        match (&mut snapshot.beyond, &self.beyond) {
            (Some(own), Some(beyond)) => own.copy_from(beyond),
            (own, beyond) => *own = beyond.clone(),
        }
        snapshot.history.copy_from(&self.history);
        snapshot.loads.clone_from(&self.loads);
        snapshot.displacement.clone_from(&self.displacement);
        snapshot.before.clone_from(&self.trial_displacement);
        snapshot.current.copy_from(&self.current);
        snapshot.previous.copy_from(&self.previous);
        snapshot.motions.clone_from(&self.motions);
        snapshot.previous_motions.clone_from(&self.previous_motions);
        snapshot.placed = self.placed;
        snapshot.undisturbed_until = self.undisturbed_until;
        snapshot.shortest = self.shortest;
        snapshot.time = self.time;
        snapshot.before_is_kept = self.before_is_kept;
        snapshot.contact_cells = self.contact_cells;
        snapshot.interval = self.interval;
        snapshot.last_dt = self.last_dt;
        snapshot.refresh = self.refresh;
    }

    /// Goes back to a state, the indenter where it was then: the steps that follow are the same as they were, bit by bit.
    /// Allocates nothing while the region that is computed and the indenter stay where they are.
    ///
    /// # Errors
    /// If the snapshot is of another contact; of a clone it is one's own.
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
        if snapshot.fitted_over != self.fitted_over {
            (self.material, self.fitted_over) = (snapshot.material.clone(), snapshot.fitted_over);
        }
        match (&mut self.beyond, &snapshot.beyond) {
            (Some(own), Some(beyond)) => own.copy_from(beyond),
            (own, beyond) => *own = beyond.clone(),
        }
        self.history.copy_from(&snapshot.history);
        self.loads.clone_from(&snapshot.loads);
        self.displacement.clone_from(&snapshot.displacement);
        self.trial_displacement.clone_from(&snapshot.before);
        self.current.copy_from(&snapshot.current);
        self.previous.copy_from(&snapshot.previous);
        self.motions.clone_from(&snapshot.motions);
        self.previous_motions.clone_from(&snapshot.previous_motions);
        self.placed = snapshot.placed;
        self.undisturbed_until = snapshot.undisturbed_until;
        self.shortest = snapshot.shortest;
        self.time = snapshot.time;
        self.before_is_kept = snapshot.before_is_kept;
        self.contact_cells = snapshot.contact_cells;
        self.interval = snapshot.interval;
        self.last_dt = snapshot.last_dt;
        self.refresh = snapshot.refresh;
        self.progress = None;
        if moved {
            self.survey();
        }
        self.show();
        Ok(())
    }
}
