//! Whether contact has outgrown the region that is computed.

use std::f64::consts::PI;

use crate::Grid;
use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::contact::step::request::Step;
use crate::contact::step::trial::Trial;
use crate::contact::window::region::Region;
use crate::contact::window::window::Window;
use crate::extent::Extent;
use crate::geometry::Gap;
use crate::solver::RigidMotion;

/// Cells that a region holds beyond the reach of contact, so that it need not grow every step.
const MARGIN: f64 = 0.1;
/// A region that would be larger than this part of the grid is all of it.
pub(in crate::contact) const MAX_WINDOW_FRACTION: f64 = 0.7;

/// After a step was tried: a larger region, if the bodies might touch outside this one.
///
/// No convolution is needed to rule that out: at a distance r, K of a source U ≥ 0 within a distance ρ of a point is at least
/// ∫U/(π (r + ρ)). Where pressures released within long steps have left some U < 0, that takes away at most ∫|U|/(π (r − ρ)).
pub(in crate::contact) fn outgrown(
    scene: &Scene,
    state: &State,
    window: &Window,
    trial: &Trial,
    step: &Step<'_>,
) -> Option<Region> {
    let source = state.history.far_trial()?;
    let (region, gap) = (&state.region, step.indenter.gap());
    let [l1, l2] = scene.grid.lengths();
    let motions = || (0..scene.bodies).map(|body| motion_tried(region, trial, step, body));
    let deepest = |m: RigidMotion| m.approach + 0.5 * (m.tilt[0].abs() * l1 + m.tilt[1].abs() * l2);
    if motions().all(|motion| deepest(motion) <= window.lowest_outside()) {
        return None;
    }
    let (grid, folded) = (region.grid(), region.folded());
    let [m1, m2] = grid.cells();
    let (first, last) = (grid.center(0, 0), grid.center(m1 - 1, m2 - 1));
    let centre = [0, 1].map(|axis| if folded[axis] { 0.0 } else { 0.5 * (first[axis] + last[axis]) });
    let distance = |x: [f64; 2]| (x[0] - centre[0]).hypot(x[1] - centre[1]);
    let [side1, side2] = grid.spacing();
    let (mut positive, mut negative, mut radius) = (0.0, 0.0, 0.0_f64);
    for (k, &strength) in source.iter().enumerate().filter(|(_, strength)| **strength != 0.0) {
        if strength > 0.0 {
            positive += strength;
        } else {
            negative -= strength;
        }
        radius = radius.max(distance(grid.center(k / m2, k % m2)));
    }
    let radius = radius + 0.5 * side1.hypot(side2);
    let area = grid.cell_area() * region.images() as f64 / PI;
    let least = |r: f64| {
        let lowered = if negative > 0.0 { negative / (r - radius).max(0.0) } else { 0.0 };
        area * (positive / (r + radius) - lowered)
    };
    let touched = motions().enumerate().filter_map(|(body, motion)| {
        cells_below(&scene.grid, folded, gap, body, motion, |cell, depth| {
            let computed = state.region_is_placed && region.find(cell).is_some();
            !computed && depth > least(distance(scene.grid.center(cell[0], cell[1])))
        })
    });
    Extent::hull(touched).map(|touched| region_holding(&scene.grid, folded, region.extent().with(touched)))
}

/// The motion of a body at the end of the step being tried, from the datum of the gap.
pub(in crate::contact) fn motion_tried(region: &Region, trial: &Trial, step: &Step<'_>, body: usize) -> RigidMotion {
    let free = region.modes(trial.free[body]).physical(trial.solution.motions[body]);
    step.prescribed(body) + free
}

/// A region of suitable size that holds these cells, or the whole grid where it would be most of it.
pub(super) fn region_holding(grid: &Grid, folded: [bool; 2], held: Extent) -> Region {
    let whole = Region::whole(grid, folded);
    let region = Region::around(grid, folded, held, MARGIN);
    if region.len() as f64 > MAX_WINDOW_FRACTION * whole.len() as f64 { whole } else { region }
}

/// The least rectangle of the cells where the undeformed gap of a body in `motion` is negative, and which are `wanted`
/// with their depth.
pub(super) fn cells_below(
    grid: &Grid,
    folded: [bool; 2],
    gap: &Gap,
    body: usize,
    motion: RigidMotion,
    wanted: impl Fn([usize; 2], f64) -> bool,
) -> Option<Extent> {
    let [n1, n2] = grid.cells();
    let start = [0, 1].map(|axis| if folded[axis] { grid.cells()[axis] / 2 } else { 0 });
    let mut below: Option<Extent> = None;
    for i in start[0]..n1 {
        for j in start[1]..n2 {
            let k = i * n2 + j;
            let depth = motion.at(grid.center(i, j)) - gap.above[k];
            if depth > 0.0 && gap.owner(k) == body && wanted([i, j], depth) {
                let cell = Extent::of([i, j]);
                below = Some(below.map_or(cell, |below| below.with(cell)));
            }
        }
    }
    below
}
