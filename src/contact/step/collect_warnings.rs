//! The warnings of a step.

use crate::contact::read::report::{Warning, Warnings};
use crate::contact::scene::Scene;
use crate::contact::settings::{Edge, TimeRule};
use crate::contact::state::State;
use crate::extent::Extent;
use crate::rheology::is_known;

/// Contact this near to an edge is near it \[cells\].
const EDGE_MARGIN: usize = 2;
/// Fewer cells resolve no contact: across, and in all.
const MIN_CELLS_ACROSS: usize = 8;
const MIN_CELLS: usize = 50;

/// The warnings of the step accepted last.
pub(super) fn collect_warnings(scene: &Scene, state: &State) -> Warnings {
    let (axes, periodic) = (scene.grid.cells(), scene.kernel.periodic_axes());
    let (dt, material) = (state.clock.last_dt, &scene.material);
    let (solution, contact_cells) = (&state.current.solution, state.current.contact_cells);
    let (mut near, mut few) = (false, false);
    if let Some(Extent { low, high }) = state.region.reach(&solution.pressure) {
        let all_in_touch = contact_cells == scene.grid.len();
        let mut line = false;
        for axis in 0..2 {
            // across a line, or around a period, contact has no end that a mesh could miss
            if axes[axis] == 1 && periodic[axis] {
                line = true;
                continue;
            }
            few |= high[axis] + 1 - low[axis] < MIN_CELLS_ACROSS && !(periodic[axis] && all_in_touch);
            near |= !periodic[axis] && (low[axis] <= EDGE_MARGIN || high[axis] + EDGE_MARGIN + 1 >= axes[axis]);
        }
        few |= !line && contact_cells < MIN_CELLS && !(periodic == [true; 2] && all_in_touch);
    }
    let (age, [from, until]) = (state.clock.age(), material.measured());
    let has_memory = !state.is_undisturbed();
    let uncertain = material.fit_reports().any(|report| report.warning().is_some());
    // the rectangle rule oscillates where the bodies creep by more in a step than they yield at once
    let oscillates = matches!(scene.settings.time_rule, TimeRule::Rectangle | TimeRule::RectangleUncached)
        && material.contact_compliance(dt) > 2.0 * material.contact_compliance(0.0);
    Warnings::default()
        .with(Warning::NearEdge, near && scene.settings.edge == Edge::Refuse)
        .with(Warning::FewCells, few)
        .with(Warning::Extrapolated, has_memory && !is_known(age, until))
        .with(Warning::FasterThanMaterial, has_memory && dt > 0.0 && dt < from)
        .with(Warning::NearEndOfMaterial, has_memory && dt > 0.0 && !is_known(age + dt, material.known_until()))
        .with(Warning::Rings, oscillates)
        .with(Warning::FallBack, solution.counts.fallback_iterations > 0)
        .with(Warning::UncertainMaterial, has_memory && uncertain)
        .with(Warning::Rounding, solution.rounding > scene.settings.tolerance)
}
