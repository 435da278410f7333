//! The content of a checkpoint of one process, and its checks.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::redistribution::Assembled;
use super::scene_fingerprint::{Built, Fingerprint, difference};
use crate::contact::builder::build::windowed;
use crate::contact::run::progress::Progress;
use crate::contact::scene::Scene;
use crate::contact::state::{Clock, Equilibrium, State};
use crate::contact::stepper::ViscoelasticContact;
use crate::contact::window::region::Region;
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

/// Both clocks of a checkpoint must agree to this part: closures of a temperature have no other mark.
const CLOCKS_AGREE: f64 = 1e-9;

/// Rejects a reduced time that the temperature of the scene does not lead to, and a run that cannot be continued.
pub(super) fn check_run(clock: &Clock, run: Option<&Progress>, scene: &Scene) -> Result<(), CheckpointError> {
    if let Some(history) = &scene.temperature {
        let [saved, built] = [clock.reduced_time, history.reduced_time(0.0, clock.time).unwrap_or(f64::NAN)];
        let agree = (saved - built).abs() <= CLOCKS_AGREE * built;
        if !agree {
            let [saved, built] = [saved, built].map(|time| format!("reduced time {time:e} s"));
            return Err(CheckpointError::OtherScene { what: "temperature", saved, built });
        }
    }
    if run.is_some_and(|progress| !progress.fits()) {
        return malformed("a run that no contact can continue");
    }
    Ok(())
}

/// Rejects fields that do not fit a whole contact, or its `rows`.
pub(super) fn check(
    state: &State,
    contact: &ViscoelasticContact,
    rows: Option<&Region>,
) -> Result<(), CheckpointError> {
    let (scene, built) = (&contact.scene, &contact.computation.state.history);
    let State { clock, loads, indenter, region, history, current, previous, start, .. } = state;
    let (bodies, gap, cells) = (scene.bodies, indenter.gap(), region.len());
    let covers = rows.is_some() || region.covers();
    let allowed = match rows {
        Some(rows) => region == rows,
        None => region.is_of(&scene.grid) && (covers || windowed(&scene.settings, built, &scene.kernel)),
    };
    if !allowed {
        return malformed("its region is not part of the grid");
    }
    let gap_cells = if rows.is_some() { cells } else { scene.grid.len() };
    let complete = |Equilibrium { solution, motions, .. }: &Equilibrium| {
        [solution.pressure.len(), solution.potential.len()] == [cells; 2]
            && [solution.motions.len(), motions.len()] == [bodies; 2]
    };
    let of_a_body = |&owner: &_| usize::from(owner) < bodies;
    let owners = match &gap.owner {
        Some(owner) => bodies > 1 && owner.len() == gap_cells && owner.iter().all(of_a_body),
        None => bodies == 1,
    };
    let fits = [loads.len(), start.loads.len(), indenter.bodies()] == [bodies; 3]
        && complete(current)
        && complete(previous)
        && gap.above.len() == gap_cells
        && owners
        && history.fits(built, region.cells(), !covers);
    if !fits {
        return malformed("fields that do not fit its region, or another time rule");
    }
    let finite = |fields: &[&[f64]]| fields.iter().all(|field| field.iter().all(|value| value.is_finite()));
    let times_of =
        |clock: &Clock| [clock.time, clock.last_length, clock.reduced_time, clock.undisturbed_until, clock.last_dt];
    let times = [times_of(clock), times_of(&start.clock)].concat();
    let sound = |Equilibrium { solution, motions, .. }: &Equilibrium| {
        finite(&[&solution.pressure, &solution.potential])
            && motions.iter().all(|motion| finite(&[&[motion.approach], &motion.tilt]))
    };
    let start_of_step = if history.start_is_kept() { history.trial() } else { &[] };
    let sound = finite(&[&times, &[gap.datum], history.displacement(), start_of_step])
        && sound(current)
        && sound(previous)
        && start.clock.time <= clock.time
        && start.loads.iter().all(|load| load.validate().is_ok())
        && current.solution.pressure.iter().all(|&p| p >= 0.0)
        && gap.above.iter().all(|&gap| gap >= 0.0)
        && times.iter().all(|&time| time >= 0.0);
    if sound { Ok(()) } else { malformed("non-finite or negative numbers") }
}

fn malformed<T>(what: &str) -> Result<T, CheckpointError> {
    Err(CheckpointError::Malformed { what: what.into() })
}
