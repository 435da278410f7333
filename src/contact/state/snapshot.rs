//! Copies of a contact in memory: snapshots for callers that try steps and take them back, and the state within a step.

use std::sync::Arc;

use crate::contact::{Scene, State, ViscoelasticContact};
use crate::equilibrium::pressed::Pressed;
use crate::error::{Result, of_other_contact, within};
use crate::load::{Load, Tilt, load_point};

/// What is left of the last step where its start is lost.
const START_LOST: &str = "the end of that step, whose start is lost once another step was tried, even if that one \
    failed, and where the indenter moved: look inside a step before the next, or restore a snapshot and step again";

/// The state of a contact in memory, made by [`ViscoelasticContact::snapshot`]: what steps change, without kernel and
/// work space. About 48 bytes per computed cell and what the history takes ([`Memory`](crate::contact::Memory));
/// where a window is computed, 16 and the history again.
#[derive(Clone)]
pub struct Snapshot {
    scene: Arc<Scene>,
    pub(crate) state: State,
}

impl Snapshot {
    /// The time of the state \[s\].
    pub fn time(&self) -> f64 {
        self.state.clock.time
    }
}

debug_by!(self: Snapshot => time: self.state.clock.time);

impl ViscoelasticContact {
    /// The state as it is, to come back to.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
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
    /// same.
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        if Arc::ptr_eq(&snapshot.scene, &self.scene) {
            snapshot.state.clone_from(&self.computation.state);
        } else {
            *snapshot = self.snapshot();
        }
    }

    /// Goes back to a state, with the indenter where it was then: the steps that follow are the same as they were,
    /// bitwise. A run of adaptive steps ([`Contact::follow`](crate::run::Contact::follow)) begins anew, with steps of its
    /// own. Allocates nothing while the region that is computed stays the same.
    ///
    /// # Errors
    /// If the snapshot was made of another contact; a contact and its clones may exchange theirs.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        if !Arc::ptr_eq(&snapshot.scene, &self.scene) {
            return Err(of_other_contact());
        }
        self.go_to(&snapshot.state);
        self.saved_run = None;
        Ok(())
    }

    /// Goes to a state of this contact.
    pub(crate) fn go_to(&mut self, state: &State) {
        self.computation.restore(&self.scene, state);
        self.view.refresh(&self.computation.state.held);
    }
}

impl ViscoelasticContact {
    /// The contact at a time within the last step, its ends included. So a user may look at other times than the ends
    /// of steps.
    ///
    /// It is the contact at the start of the step, advanced by a shorter step of the same rule: its state is as exact
    /// as one at the end of a step. This contact stays as it is. The load is taken to be linear between the ends of
    /// the step; a run has the loads in between, and [`Run::within_step`](crate::run::Run::within_step) takes them
    /// from there.
    ///
    /// This costs a copy of the contact and a contact problem. Where ranks share out the contact, all of them call it.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// contact.step(0.2, Load::force(0.5))?;
    /// let middle = contact.within_step(0.1)?;
    /// assert_eq!(middle.time(), 0.1);
    /// assert!(middle.approach() < contact.approach());
    /// assert!((middle.force() - 0.5).abs() < 1e-12);
    /// assert!(contact.within_step(0.3).is_err()); // not there yet
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the time does not lie within the last step, or the contact problem fails like one of
    /// [`ViscoelasticContact::step`]. Only the end of the last step is left after a step that failed, one over the bodies
    /// ([`ViscoelasticContact::step_over`]) or along a path ([`ViscoelasticContact::step_along`]).
    pub fn within_step(&self, time: f64) -> Result<ViscoelasticContact> {
        self.advanced_within_step(time, self.settings().tolerance, None, |start| {
            let share = (time - start.time()) / (self.time() - start.time());
            let ends = self.computation.state.held.loads.iter().enumerate();
            Ok(ends.map(|(body, end)| start.load_like(body, end).towards(end, share)).collect())
        })
        .map(|(contact, _)| contact)
    }

    /// The contact at a `time` within the last step, under the loads that are found for the contact at its start, and
    /// where it presses if it was advanced. Before the last step from there on, if the state `before` is given.
    pub(crate) fn advanced_within_step(
        &self,
        time: f64,
        tolerance: f64,
        before: Option<&State>,
        loads: impl FnOnce(&ViscoelasticContact) -> Result<Vec<Load>>,
    ) -> Result<(ViscoelasticContact, Pressed)> {
        let state = &self.computation.state;
        let start = if state.history.start_is_kept() { state.start.clock.time } else { state.clock.time };
        let before = before.filter(|_| state.history.start_is_kept() && time < start);
        let from = before.map_or(start, |before| before.clock.time);
        // the start may come out a little off where it is found from the end
        let slack = 1e-12 * state.clock.last_length;
        let is_lost = time >= state.start.clock.time - slack && time < start - slack;
        within("time within the last step", time, !is_lost || before.is_some(), START_LOST)?;
        let inside = time >= from - slack && time <= state.clock.time;
        within("time within the last step", time, inside, "between its start and its end")?;
        let mut contact = self.clone();
        contact.saved_run = None;
        if time == state.clock.time {
            return Ok((contact, Pressed::default()));
        }
        match before {
            Some(before) => contact.computation.restore(&self.scene, before),
            None => contact.computation.state.roll_back(),
        }
        contact.view.refresh(&contact.computation.state.held);
        let mut pressed = Pressed::default();
        if time > from {
            let loads = loads(&contact)?;
            pressed = contact.take_part(time, &loads, tolerance, state.start.interpolant)?;
        }
        Ok((contact, pressed))
    }

    /// The load of a body at present, as one of the kind of `other`.
    pub(in crate::contact) fn load_like(&self, body: usize, other: &Load) -> Load {
        let load = self.computation.state.held.loads[body];
        let Some(now) = self.fields().body(body).filter(|_| !load.is_like(other)) else { return load };
        let tilt = [0, 1].map(|axis| match other.tilt()[axis] {
            Tilt::Fixed(_) => Tilt::Fixed(now.tilt[axis]),
            free => free,
        });
        let at = load_point(tilt);
        let approach = now.approach + now.tilt[0] * at[0] + now.tilt[1] * at[1];
        match *other {
            Load::Force { .. } => Load::Force { normal: now.force, tilt },
            Load::Approach { .. } => Load::Approach { approach, tilt },
            Load::Spring { stiffness, .. } => Load::Spring { stiffness, drive: approach + now.force / stiffness, tilt },
        }
    }
}
