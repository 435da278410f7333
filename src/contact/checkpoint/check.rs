//! Checks of what a file holds: with a right checksum it may still hold anything.

use super::fingerprint::other_scene;
use crate::contact::builder::memory::windowed;
use crate::contact::{Clock, State, ViscoelasticContact};
use crate::equilibrium::{Equilibrium, Held};
use crate::error::Refusal;
use crate::geometry::Gap;
use crate::hereditary::Role;
use crate::rheology::TemperatureHistory;

pub(crate) fn malformed(what: &str) -> Refusal {
    Refusal::file("checkpoint_malformed", format!("the checkpoint holds no state of a contact: {what}"), "")
}

/// Both clocks of a checkpoint must agree to this part: closures of a temperature have no other mark, and rough ones
/// are integrated to five digits.
const CLOCKS_AGREE: f64 = 2e-5;

/// Rejects a reduced time at `time` that the temperature does not lead to.
pub(crate) fn check_clocks(time: f64, reduced: f64, temperature: Option<&TemperatureHistory>) -> Result<(), Refusal> {
    let own = temperature.map_or(time, |history| history.reduced_time(0.0, time).unwrap_or(f64::NAN));
    let agree = (reduced - own).abs() <= CLOCKS_AGREE * own;
    if agree { Ok(()) } else { Err(other_scene("temperature")) }
}

impl ViscoelasticContact {
    /// Rejects a state without fields, and a gap, that this contact cannot have.
    pub(super) fn check(&self, state: &State, gap: Option<&Gap>) -> Result<(), Refusal> {
        let (ground, own) = (&self.scene.ground, &self.computation.state);
        let State { held: Held { loads, region, current, .. }, clock, history, previous, start, .. } = state;
        let (bodies, covers) = (ground.bodies, region.covers());
        if !region.is_of(&ground.grid) || !(covers || windowed(&self.scene, &own.history)) {
            return Err(malformed("its region is not part of the grid"));
        }
        let motions = |Equilibrium { solution, motions, .. }: &Equilibrium| [solution.motions.len(), motions.len()];
        let fits = [loads.len(), start.loads.len()] == [bodies; 2]
            && [motions(current), motions(previous)] == [[bodies; 2]; 2]
            && state.attracts == ground.attraction.is_some()
            && gap.is_none_or(|gap| is_gap(gap, ground.grid.len(), bodies))
            && history.fits(&own.history, region.cells(), !covers);
        if !fits {
            return Err(malformed("fields that do not fit its region, or another time rule"));
        }
        let times_of =
            |clock: &Clock| [clock.time, clock.last_length, clock.reduced_time, clock.undisturbed_until, clock.last_dt];
        let motions = [current, previous].into_iter().flat_map(|of| &of.motions);
        let sound = [times_of(clock), times_of(&start.clock)].as_flattened().iter().all(|&t| t >= 0.0 && t.is_finite())
            && motions.flat_map(|motion| [motion.approach, motion.tilt[0], motion.tilt[1]]).all(f64::is_finite)
            && start.clock.time <= clock.time
            && start.loads.iter().all(|load| load.validate().is_ok());
        if !sound {
            return Err(unsound());
        }
        let of_ranks = own.held.region.is_shared();
        if of_ranks && (gap.is_some() || !covers || region.folded() != own.held.region.folded()) {
            let what = "computed region (ranks need the whole grid, and symmetry and indenter as they were built: save \
                with Settings::window and symmetry set to false)";
            return Err(other_scene(what));
        }
        check_clocks(clock.time, clock.reduced_time, self.scene.temperature.as_ref())
    }
}

/// Whether it is the gap of so many bodies.
fn is_gap(Gap { datum, above, owner }: &Gap, cells: usize, bodies: usize) -> bool {
    let owners = match owner {
        Some(owner) => bodies > 1 && owner.len() == cells && owner.iter().all(|&owner| usize::from(owner) < bodies),
        None => bodies == 1,
    };
    datum.is_finite() && above.len() == cells && above.iter().all(|&height| height >= 0.0) && owners
}

/// Rejects fields that no contact has.
pub(super) fn check_fields(state: &State) -> Result<(), Refusal> {
    let mut finite = true;
    state.each(&mut |field| {
        let counts = matches!(field.role, Role::Lasting { .. }) || state.history.start_is_kept();
        finite &= !counts || field.values.iter().all(|value| value.is_finite());
    });
    let pressures = state.held.current.solution.pressure.iter().all(|&p| p >= 0.0);
    if finite && pressures { Ok(()) } else { Err(unsound()) }
}

fn unsound() -> Refusal {
    malformed("non-finite or negative numbers")
}
