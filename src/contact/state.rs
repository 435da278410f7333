//! The state of a contact between two steps.

use crate::contact::guess::Refresh;
use crate::load::Load;
use crate::solver::Solution;

/// What steps change, beside the past of the bodies: all that is kept where a state is saved, on the region that is computed.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct State {
    pub(super) time: f64,
    /// Length of the last step.
    pub(super) interval: f64,
    /// The bodies were undisturbed until then.
    pub(super) undisturbed_until: f64,
    /// Steps may not be shorter: the first step chose the times that the material's series was fitted over.
    pub(super) shortest: f64,
    /// The times that the first step fitted the material's series over, if it did.
    pub(super) fitted_over: Option<[f64; 2]>,
    /// Whether the region was chosen for a contact.
    pub(super) placed: bool,
    pub(super) loads: Vec<Load>,
    /// Whether the initial gap has been replaced since the last step.
    pub(super) gap_is_new: bool,
    pub(super) displacement: Vec<f64>,
    pub(super) current: Solution,
    /// (ω, α1, α2) of each body, ω at the origin.
    pub(super) motions: Vec<[f64; 3]>,
    /// Cells in contact of the whole grid.
    pub(super) contact_cells: usize,
    /// (ω, α1, α2) before the last step.
    pub(super) previous_motions: Vec<[f64; 3]>,
    /// Whether the contact still has the displacement before the last step.
    pub(super) before_is_kept: bool,
    /// The solution one step earlier, and how long before it was: what a guess extrapolates from.
    pub(super) previous: Solution,
    pub(super) last_dt: f64,
    pub(super) refresh: Refresh,
}

impl State {
    /// Bodies without load, where they just touch.
    pub(super) fn at_rest(cells: usize, motions: Vec<[f64; 3]>) -> State {
        let bodies = motions.len();
        let unloaded = Solution::zero(cells, bodies);
        State {
            time: 0.0,
            interval: 0.0,
            undisturbed_until: 0.0,
            shortest: 0.0,
            fitted_over: None,
            placed: false,
            loads: vec![Load::force(0.0); bodies],
            gap_is_new: false,
            displacement: vec![0.0; cells],
            current: unloaded.clone(),
            motions,
            contact_cells: 0,
            previous_motions: vec![[0.0; 3]; bodies],
            before_is_kept: true,
            previous: unloaded,
            last_dt: 0.0,
            refresh: Refresh::default(),
        }
    }

    /// Takes over another's values, in its own memory where the fields are as large.
    pub(super) fn copy_from(&mut self, other: &State) {
        // all are named, so that none that is added can be forgotten
        let State {
            time,
            interval,
            undisturbed_until,
            shortest,
            fitted_over,
            placed,
            loads,
            gap_is_new,
            displacement,
            current,
            motions,
            contact_cells,
            previous_motions,
            before_is_kept,
            previous,
            last_dt,
            refresh,
        } = self;
        (*time, *interval, *last_dt) = (other.time, other.interval, other.last_dt);
        (*undisturbed_until, *shortest, *fitted_over) = (other.undisturbed_until, other.shortest, other.fitted_over);
        (*placed, *contact_cells, *before_is_kept) = (other.placed, other.contact_cells, other.before_is_kept);
        (*refresh, *gap_is_new) = (other.refresh, other.gap_is_new);
        loads.clone_from(&other.loads);
        displacement.clone_from(&other.displacement);
        current.copy_from(&other.current);
        motions.clone_from(&other.motions);
        previous_motions.clone_from(&other.previous_motions);
        previous.copy_from(&other.previous);
    }
}
