//! What a checkpoint holds.

use std::borrow::Cow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::fingerprint::Fingerprint;
use crate::contact::computation::Computation;
use crate::contact::run::progress::Progress;
use crate::contact::scene::Scene;
use crate::contact::state::{Clock, Equilibrium, State};
use crate::contact::time_rule::windowed;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::CheckpointError;

/// A state, and the fingerprint of its scene; borrowed from a contact or read from a file.
#[derive(Serialize, Deserialize)]
pub(super) struct Saved<'a> {
    scene: Fingerprint,
    state: Cow<'a, State>,
    progress: Option<Cow<'a, Progress>>,
}

impl<'a> Saved<'a> {
    pub(super) fn of(contact: &'a ViscoelasticContact, progress: Option<&'a Progress>) -> Saved<'a> {
        Saved {
            scene: Fingerprint::of(&contact.scene),
            state: Cow::Borrowed(&contact.computation.state),
            progress: progress.map(Cow::Borrowed),
        }
    }

    /// Puts the state into a contact of the same scene.
    pub(super) fn restore(self, contact: &mut ViscoelasticContact) -> Result<(), CheckpointError> {
        let scene = Arc::clone(&contact.scene);
        self.scene.require(&Fingerprint::of(&scene))?;
        check(&self.state, &contact.computation.state, &scene)?;
        check_temperature(&self.state.clock, &scene)?;
        if self.progress.as_ref().is_some_and(|progress| !progress.fits()) {
            return Err(CheckpointError::Malformed { what: "a run that no contact can continue".into() });
        }
        let mut state = self.state.into_owned();
        state.sum_up();
        contact.computation = Computation::new(&scene, state);
        contact.view.refresh(&contact.computation.state);
        contact.progress = self.progress.map(|progress| Box::new(progress.into_owned()));
        Ok(())
    }
}

/// Both clocks of a checkpoint must agree to this part: closures of a temperature have no other mark.
const CLOCKS_AGREE: f64 = 1e-9;

/// Rejects a reduced time that the temperature of the scene does not lead to.
fn check_temperature(clock: &Clock, scene: &Scene) -> Result<(), CheckpointError> {
    let Some(history) = &scene.temperature else { return Ok(()) };
    let [saved, built] = [clock.reduced_time, history.reduced_time(0.0, clock.time).unwrap_or(f64::NAN)];
    if (saved - built).abs() <= CLOCKS_AGREE * built {
        return Ok(());
    }
    let [saved, built] = [saved, built].map(|time| format!("reduced time {time:e} s"));
    Err(CheckpointError::OtherScene { what: "temperature", saved, built })
}

/// Rejects fields that do not fit: a file may have a right checksum and be written by another program all the same.
fn check(state: &State, built: &State, scene: &Scene) -> Result<(), CheckpointError> {
    let malformed = |what: &str| Err(CheckpointError::Malformed { what: what.into() });
    let State { clock, loads, indenter, region, history, current, previous, earlier, .. } = state;
    let (whole, bodies, gap) = (scene.grid.len(), scene.bodies, indenter.gap());
    let allowed = region.covers() || windowed(&scene.settings, &built.history, &scene.kernel);
    if !region.is_of(&scene.grid) || !allowed {
        return malformed("its region is not part of the grid");
    }
    let cells = region.len();
    let complete = |Equilibrium { solution, motions, .. }: &Equilibrium| {
        [solution.pressure.len(), solution.potential.len()] == [cells; 2]
            && [solution.motions.len(), motions.len()] == [bodies; 2]
    };
    let of_a_body = |&owner: &_| usize::from(owner) < bodies;
    let owners = match &gap.owner {
        Some(owner) => bodies > 1 && owner.len() == whole && owner.iter().all(of_a_body),
        None => bodies == 1,
    };
    let fits = [loads.len(), indenter.bodies()] == [bodies; 2]
        && complete(current)
        && complete(previous)
        && gap.above.len() == whole
        && owners
        && history.fits(&built.history, region.cells(), !region.covers());
    if !fits {
        return malformed("fields that do not fit its region, or another time rule");
    }
    let finite = |fields: &[&[f64]]| fields.iter().all(|field| field.iter().all(|value| value.is_finite()));
    let times = [clock.time, clock.last_length, clock.reduced_time, clock.undisturbed_until, clock.last_dt];
    let sound = |Equilibrium { solution, motions, .. }: &Equilibrium| {
        finite(&[&solution.pressure, &solution.potential])
            && motions.iter().all(|motion| finite(&[&[motion.approach], &motion.tilt]))
    };
    let sound =
        finite(&[&times, &[gap.datum], history.displacement(), history.displacement_before().unwrap_or_default()])
            && sound(current)
            && sound(previous)
            && earlier.is_none_or(|earlier| earlier.is_sound())
            && current.solution.pressure.iter().all(|&p| p >= 0.0)
            && gap.above.iter().all(|&gap| gap >= 0.0)
            && times.iter().all(|&time| time >= 0.0);
    if sound { Ok(()) } else { malformed("non-finite or negative numbers") }
}
