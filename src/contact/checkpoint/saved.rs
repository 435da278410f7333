//! What the checkpoint of one process holds.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::assembled::Assembled;
use super::built::{Built, difference};
use super::check::{check, check_run};
use super::fingerprint::Fingerprint;
use crate::contact::run::progress::Progress;
use crate::contact::state::State;
use crate::contact::stepper::ViscoelasticContact;
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

    /// The state, if a contact of this scene can go on from it, on the rows that it has.
    pub(super) fn state_for(self, contact: &ViscoelasticContact) -> Result<(State, Option<Progress>), CheckpointError> {
        self.scene.require(&Fingerprint::of(&contact.scene))?;
        check(&self.state, contact, None)?;
        check_run(&self.state.clock, self.progress.as_deref(), &contact.scene)?;
        let state = self.state.into_owned();
        let state = if contact.computation.state.region.is_shared() {
            require_whole(&state, &self.scene, contact)?;
            let mut own = Assembled::on_rows_of(contact, &state);
            own.copy(&state, &state.region.cut(&state.indenter.gap().above));
            own.finish(contact)
        } else {
            state
        };
        Ok((state, self.progress.map(Cow::into_owned)))
    }
}

/// Rejects a state that ranks cannot share out: on a window of the grid, or with an indenter that has moved.
fn require_whole(state: &State, scene: &Fingerprint, contact: &ViscoelasticContact) -> Result<(), CheckpointError> {
    let differ = |what: &'static str, saved: &str, built: &str| {
        Err(CheckpointError::OtherScene { what, saved: saved.into(), built: built.into() })
    };
    if !state.region.covers() {
        let saved = "a window of the grid (set Settings::window to false before it is saved)";
        return differ("computed region", saved, "the whole grid, which ranks share out");
    }
    let now = Built::new(state.indenter.gap(), contact.scene.grid.cells());
    if difference(&now.shape, &scene.shape).is_some() {
        return differ("indenter", "one that has moved or changed", "where it was built, as ranks need it");
    }
    Ok(())
}
