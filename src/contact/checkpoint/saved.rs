//! The content of a checkpoint but for its fields, and the checks of both.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::scene_fingerprint::Fingerprint;
use crate::contact::builder::memory::windowed;
use crate::contact::checkpoint::SavedRun;
use crate::contact::{Clock, State, ViscoelasticContact};
use crate::equilibrium::{Equilibrium, Held, Region};
use crate::error::CheckpointError;
use crate::geometry::Gap;
use crate::hereditary::Role;
use crate::rheology::TemperatureHistory;
use crate::rounded::texts_without_noise;

/// A state on no cells, and the fingerprint of its scene.
#[derive(Serialize, Deserialize)]
#[serde(bound(deserialize = "P: SavedRun"))]
pub(super) struct Saved<'a, P: SavedRun> {
    pub(super) scene: Fingerprint,
    /// On the region of all ranks, without values.
    pub(super) state: State,
    /// Axes along which the gap is even: the file has one half of it.
    pub(super) gap_folded: [bool; 2],
    pub(super) progress: Option<Cow<'a, P>>,
}

impl<'a, P: SavedRun> Saved<'a, P> {
    pub(super) fn of(contact: &ViscoelasticContact, progress: Option<&'a P>) -> Saved<'a, P> {
        let (state, grid) = (&contact.computation.state, &contact.scene.ground.grid);
        let folded = state.held.region.folded();
        let all = if state.held.region.is_shared() { Region::whole(grid, folded) } else { state.held.region.clone() };
        Saved {
            scene: Fingerprint::of(&contact.scene),
            state: state.map(&all, &mut |_| Vec::new()),
            gap_folded: state.held.indenter.keeps_folded(folded, grid),
            progress: progress.map(Cow::Borrowed),
        }
    }

    /// The part of the grid that the gap is saved on; the local rows of it if ranks share out the contact.
    pub(super) fn gap_region(&self, contact: &ViscoelasticContact) -> Region {
        Region::whole(&contact.scene.ground.grid, self.gap_folded).shared_like(&contact.computation.state.held.region)
    }

    /// Number of values that a file has after this.
    pub(super) fn values(&self, contact: &ViscoelasticContact) -> u64 {
        let mut per_cell = 0;
        self.state.each(&mut |field| {
            if !matches!(field.role, Role::Work) {
                per_cell += field.per_cell;
            }
        });
        (per_cell as u64).saturating_mul(self.state.held.region.len() as u64)
            + self.gap_region(contact).rows().len() as u64
    }

    /// Rejects what a contact cannot go on from.
    pub(super) fn check(&self, contact: &ViscoelasticContact) -> Result<(), CheckpointError> {
        self.scene.require(&contact.scene)?;
        check(&self.state, contact)?;
        let (cells, region) = (contact.scene.ground.grid.cells(), &self.state.held.region);
        if (0..2).any(|axis| self.gap_folded[axis] && !cells[axis].is_multiple_of(2)) {
            return malformed("a symmetry that its grid cannot have");
        }
        let Clock { time, reduced_time, .. } = self.state.clock;
        check_clocks(time, reduced_time, contact.scene.temperature.as_ref())?;
        if self.progress.as_deref().is_some_and(|progress| !progress.fits()) {
            return malformed("a run that no contact can continue");
        }
        if contact.computation.state.held.region.is_shared() {
            if !region.covers() {
                let saved = "a window of the grid (set Settings::window to false before it is saved)";
                return Err(other_scene("computed region", saved, "the whole grid, which ranks share out"));
            }
            if self.gap_folded != region.folded() {
                return Err(moved_indenter());
            }
        }
        Ok(())
    }
}

fn other_scene(what: &'static str, saved: &str, built: &str) -> CheckpointError {
    CheckpointError::OtherScene { what, saved: saved.into(), built: built.into() }
}

/// The error of ranks, which cannot go on with another gap than they have.
pub(super) fn moved_indenter() -> CheckpointError {
    other_scene("indenter", "one that has moved or changed", "where it was built, as ranks need it")
}

/// Both clocks of a checkpoint must agree to this part: closures of a temperature have no other mark, and rough ones
/// are integrated to five digits.
const CLOCKS_AGREE: f64 = 1e-9;
const CLOCKS_OF_CLOSURES_AGREE: f64 = 2e-5;

/// Rejects a reduced time at `time` that the temperature does not lead to.
pub(crate) fn check_clocks(
    time: f64,
    reduced: f64,
    temperature: Option<&TemperatureHistory>,
) -> Result<(), CheckpointError> {
    let built = temperature.map_or(time, |history| history.reduced_time(0.0, time).unwrap_or(f64::NAN));
    let is_closure = temperature.is_some_and(|history| history.course().is_err());
    let allowed = if is_closure { CLOCKS_OF_CLOSURES_AGREE } else { CLOCKS_AGREE };
    let agree = (reduced - built).abs() <= allowed * built;
    if agree {
        return Ok(());
    }
    let [saved, built] = texts_without_noise([reduced, built].map(|time| format!("reduced time {time:e} s")));
    Err(CheckpointError::OtherScene { what: "temperature", saved, built })
}

/// Rejects a state on no cells that is not one of the contact.
fn check(state: &State, contact: &ViscoelasticContact) -> Result<(), CheckpointError> {
    let (scene, built) = (&contact.scene, &contact.computation.state.history);
    let State { held: Held { loads, indenter, region, current, .. }, clock, history, previous, start, .. } = state;
    let (bodies, gap, covers) = (scene.ground.bodies, indenter.gap(), region.covers());
    if state.attracts != scene.ground.attraction.is_some() {
        return malformed("another attraction");
    }
    if !region.is_of(&scene.ground.grid) || !(covers || windowed(scene, built)) {
        return malformed("its region is not part of the grid");
    }
    let motions = |Equilibrium { solution, motions, .. }: &Equilibrium| [solution.motions.len(), motions.len()];
    let of_a_body = |&owner: &_| usize::from(owner) < bodies;
    let owners = match &gap.owner {
        Some(owner) => bodies > 1 && owner.len() == scene.ground.grid.len() && owner.iter().all(of_a_body),
        None => bodies == 1,
    };
    let fits = [loads.len(), start.loads.len(), indenter.bodies()] == [bodies; 3]
        && [motions(current), motions(previous)] == [[bodies; 2]; 2]
        && owners
        && history.fits(built, region.cells(), !covers);
    if !fits {
        return malformed("fields that do not fit its region, or another time rule");
    }
    let times_of =
        |clock: &Clock| [clock.time, clock.last_length, clock.reduced_time, clock.undisturbed_until, clock.last_dt];
    let motions = [current, previous].into_iter().flat_map(|of| &of.motions);
    let sound = [times_of(clock), times_of(&start.clock)].as_flattened().iter().all(|&t| t >= 0.0 && t.is_finite())
        && gap.datum.is_finite()
        && motions.flat_map(|motion| [motion.approach, motion.tilt[0], motion.tilt[1]]).all(f64::is_finite)
        && start.clock.time <= clock.time
        && start.loads.iter().all(|load| load.validate().is_ok());
    if sound { Ok(()) } else { unsound() }
}

/// Rejects fields of a state, and a gap, that no contact has.
pub(super) fn check_fields(state: &State, gap: &Gap) -> Result<(), CheckpointError> {
    let mut finite = true;
    state.each(&mut |field| {
        let counts = matches!(field.role, Role::Lasting { .. }) || state.history.start_is_kept();
        finite &= !counts || field.values.iter().all(|value| value.is_finite());
    });
    let pressures = state.held.current.solution.pressure.iter().all(|&p| p >= 0.0);
    if finite && pressures && gap.above.iter().all(|&gap| gap >= 0.0) { Ok(()) } else { unsound() }
}

fn unsound() -> Result<(), CheckpointError> {
    malformed("non-finite or negative numbers")
}

pub(super) fn malformed<T>(what: &str) -> Result<T, CheckpointError> {
    Err(CheckpointError::Malformed { what: what.into() })
}
