//! The region that a step begins on.

use std::f64::consts::PI;

use crate::contact::indenter::Indenter;
use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::contact::step::request::Step;
use crate::contact::window::growth::{cells_below, region_holding};
use crate::contact::window::region::Region;
use crate::error::{RanksError, Result};
use crate::extent::Extent;
use crate::load::{Load, Tilt};
use crate::solver::RigidMotion;

/// Bisections for the approach at first contact, an estimate.
const HALVINGS: usize = 24;

/// The region that a step has to begin on, unless the state has it already: symmetric where the region is folded, and with
/// the first contact within it. Told with it is whether it was chosen for a contact.
///
/// # Errors
/// If ranks share out the rows, and the step breaks a symmetry.
pub(in crate::contact) fn region_for(scene: &Scene, state: &State, step: &Step<'_>) -> Result<Option<(Region, bool)>> {
    let upright = |axis: usize| {
        step.loads.iter().all(|load| match load.tilt()[axis] {
            Tilt::Fixed(angle) => angle == 0.0,
            Tilt::Free { at } => at == 0.0,
        })
    };
    let folded = state.region.folded();
    let moving = step.interval.stride;
    let even = step.indenter.keeps_folded(folded, &scene.grid);
    let still_folded = [0, 1].map(|axis| even[axis] && upright(axis) && moving[axis] == 0);
    if still_folded != folded && state.region.is_shared() {
        let what = "a load that breaks the symmetry of the scene (unless Settings::symmetry is false)";
        return Err(RanksError::NotShared { what }.into());
    }
    let unfolded = (still_folded != folded).then(|| state.region.unfolded(still_folded));
    let region = unfolded.as_ref().unwrap_or(&state.region);
    let to_be_placed = state.is_undisturbed() && !state.region_is_placed && state.history.far_source().is_some();
    if to_be_placed
        && !region.covers()
        && let Some(placed) = first_contact(scene, region, step)
    {
        return Ok(Some((placed, true)));
    }
    Ok(unfolded.map(|region| (region, state.region_is_placed)))
}

/// The region of a first contact, by an estimate of how deep the bodies sink in; `None` if nothing presses them.
fn first_contact(scene: &Scene, region: &Region, step: &Step<'_>) -> Option<Region> {
    let mut touched: Option<Extent> = None;
    for (body, load) in step.loads.iter().enumerate() {
        let free_tilt = |axis: usize| matches!(load.tilt()[axis], Tilt::Free { .. }) && !region.folded()[axis];
        let prescribed = step.prescribed(body);
        let motion = match *load {
            Load::Force { normal: 0.0, .. } => continue,
            _ if free_tilt(0) || free_tilt(1) => RigidMotion { approach: f64::INFINITY, tilt: [0.0; 2] },
            Load::Force { normal, .. } => RigidMotion { approach: depth(scene, step, body, normal), ..prescribed },
            Load::Approach { .. } => prescribed,
        };
        let below = cells_below(&scene.grid, region.folded(), step.indenter.gap(), body, motion, |_, _| true);
        touched = Extent::hull(touched.into_iter().chain(below));
    }
    let lowest = Region::lowest_cells(&scene.grid, step.indenter.gap(), scene.bodies);
    touched.map(|touched| region_holding(&scene.grid, region.folded(), lowest.with(touched)))
}

/// A depth at which a body pressed by `normal` about comes to rest, above the datum: twice the depth of the level at which the
/// gap has risen by a²/2R, see the cold start of the solver.
fn depth(scene: &Scene, step: &Step<'_>, body: usize, normal: f64) -> f64 {
    let [lowest, rest] = level(
        scene,
        &Region::whole(&scene.grid, [false; 2]),
        &step.indenter,
        body,
        scene.material.contact_compliance(step.interval.dt) * normal,
    );
    lowest + 2.0 * rest
}

/// The depth below first touch at which the first body about comes to rest, under the product of a force and a contact
/// compliance.
pub(in crate::contact) fn resting_depth(scene: &Scene, state: &State, force_times_compliance: f64) -> f64 {
    let all = if state.region.is_shared() { state.region.clone() } else { Region::whole(&scene.grid, [false; 2]) };
    level(scene, &all, &state.indenter, 0, force_times_compliance)[1]
}

/// The lowest gap of a body, above the datum, and how far above it the level lies at which the gap has risen by a²/2R; `all`
/// is the region that the gap is on.
fn level(scene: &Scene, all: &Region, indenter: &Indenter, body: usize, force_times_compliance: f64) -> [f64; 2] {
    let (gap, rows, images) = (indenter.gap(), all.rows(), all.images());
    let heights =
        || gap.above.iter().enumerate().filter(|(k, h)| h.is_finite() && gap.owner(*k) == body).map(|(_, h)| *h);
    let lowest = rows.least(heights().fold(f64::INFINITY, f64::min));
    let (mut low, mut high) = (lowest, rows.greatest(heights().fold(lowest, f64::max)));
    let force = 0.375 * PI.sqrt() * force_times_compliance;
    let cells_below = |level: f64| (images * rows.count(heights().filter(|&h| h <= level).count())) as f64;
    let rise = |level: f64| force / (cells_below(level) * scene.grid.cell_area()).sqrt();
    if high - lowest < rise(high) {
        return [lowest, rise(high)]; // all of it is pressed
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle - lowest < rise(middle) { low = middle } else { high = middle }
    }
    [lowest, high - lowest]
}
