//! The region that a step begins on, and its growth.

use std::f64::consts::PI;

use crate::Grid;
use crate::equilibrium::{Ground, Held, Indenter, Region, Request, Trial, Window};
use crate::error::{Result, coverage};
use crate::extent::Extent;
use crate::geometry::Gap;
use crate::load::{Load, Tilt};
use crate::quadrature::bisect;
use crate::solver::RigidMotion;

/// The region that a solution has to begin on, unless it is the one held: symmetric where the region is folded and
/// the indenter is not `moving` along that axis, and with the first contact within it, at the compliance `first` of
/// bodies that are yet to touch. Also returns whether it was chosen for a contact.
///
/// # Errors
/// If ranks share out the rows, and the load breaks a symmetry.
pub(crate) fn region_for(
    ground: &Ground,
    held: &Held,
    request: Request<'_>,
    moving: [bool; 2],
    first: Option<f64>,
) -> Result<Option<(Region, bool)>> {
    let upright = |axis: usize| {
        request.loads.iter().all(|load| match load.tilt()[axis] {
            Tilt::Fixed(angle) => angle == 0.0,
            Tilt::Free { at } => at == 0.0,
        })
    };
    let folded = held.region.folded();
    let even = request.indenter.keeps_folded(folded, &ground.grid);
    let still_folded = [0, 1].map(|axis| even[axis] && upright(axis) && !moving[axis]);
    coverage::BROKEN_SYMMETRY.refuse_if(|_| still_folded != folded && held.region.is_shared())?;
    let unfolded = (still_folded != folded).then(|| held.region.unfolded(still_folded));
    let region = unfolded.as_ref().unwrap_or(&held.region);
    if let Some(compliance) = first.filter(|_| !held.region_is_for_contact && !region.covers())
        && let Some(placed) = first_contact(ground, region, request, compliance)
    {
        return Ok(Some((placed, true)));
    }
    Ok(unfolded.map(|region| (region, held.region_is_for_contact)))
}

/// The region of a first contact, by an estimate of how deep the bodies sink in; `None` if nothing presses them.
fn first_contact(ground: &Ground, region: &Region, request: Request<'_>, compliance: f64) -> Option<Region> {
    let mut touched: Option<Extent> = None;
    for (body, load) in request.loads.iter().enumerate() {
        let free_tilt = |axis: usize| matches!(load.tilt()[axis], Tilt::Free { .. }) && !region.folded()[axis];
        let prescribed = request.prescribed(body);
        // twice the depth of the level at which the gap has risen by a²/2R, see the cold start of the solver
        let sunk = |normal: f64| {
            let [lowest, rest] = level(ground, &region.of_gap(), request.indenter, body, compliance * normal);
            lowest + 2.0 * rest
        };
        let motion = match *load {
            Load::Force { normal: 0.0, .. } => continue,
            _ if free_tilt(0) || free_tilt(1) => RigidMotion { approach: f64::INFINITY, tilt: [0.0; 2] },
            Load::Force { normal, .. } => RigidMotion { approach: sunk(normal), ..prescribed },
            Load::Approach { .. } => prescribed,
            // neither deeper than without a spring, nor than under the force of the spring if the body did not yield
            Load::Spring { stiffness, drive, .. } => {
                let [datum, lowest] = [request.indenter.gap().datum, sunk(0.0)];
                let approach = (drive - datum).min(sunk(stiffness * (drive - datum - lowest).max(0.0)));
                RigidMotion { approach, ..prescribed }
            }
        };
        let below = cells_below(&ground.grid, region.folded(), request.indenter.gap(), body, motion, |_, _| true);
        touched = Extent::hull(touched.into_iter().chain(below));
    }
    let lowest = Region::lowest_cells(&ground.grid, request.indenter.gap(), ground.bodies);
    touched.map(|touched| region_holding(&ground.grid, region.folded(), lowest.with(touched)))
}

/// The depth below first touch at which a body about comes to rest, under the product of a force and a contact
/// compliance.
pub(crate) fn resting_depth(ground: &Ground, held: &Held, body: usize, force_times_compliance: f64) -> f64 {
    level(ground, &held.region.of_gap(), &held.indenter, body, force_times_compliance)[1]
}

/// The lowest gap of a body, above the datum, and how far above it the level lies at which the gap has risen by
/// a²/2R; `all` is the region that the gap is on.
fn level(ground: &Ground, all: &Region, indenter: &Indenter, body: usize, force_times_compliance: f64) -> [f64; 2] {
    let (gap, rows, images) = (indenter.gap(), all.rows(), all.images());
    let heights =
        || gap.above.iter().enumerate().filter(|(k, h)| h.is_finite() && gap.owner(*k) == body).map(|(_, h)| *h);
    let lowest = rows.least(heights().fold(f64::INFINITY, f64::min));
    let highest = rows.greatest(heights().fold(lowest, f64::max));
    let force = 0.375 * PI.sqrt() * force_times_compliance;
    let cells_below = |level: f64| (images * rows.count(heights().filter(|&h| h <= level).count())) as f64;
    let rise = |level: f64| force / (cells_below(level) * ground.grid.cell_area()).sqrt();
    let is_low = |level: f64| level - lowest < rise(level);
    if is_low(highest) {
        return [lowest, rise(highest)]; // all of it is pressed
    }
    // an estimate
    [lowest, bisect(lowest, highest, 24, is_low)[1] - lowest]
}

/// A region that would be larger than this part of the grid is all of it.
pub(crate) const MAX_WINDOW_FRACTION: f64 = 0.7;

/// A larger region, if the bodies of a trial might touch outside this one, whose displacement is K
/// times a factor and a source.
///
/// No convolution is needed to rule that out: at a distance r, K of a source U ≥ 0 within a distance ρ of a point is
/// at least ∫U/(π (r + ρ)). Where pressures released within long steps have left some U < 0, that takes away at most
/// ∫|U|/(π (r − ρ)).
pub(crate) fn outgrown(
    ground: &Ground,
    held: &Held,
    window: &Window,
    trial: &Trial,
    request: Request<'_>,
    (factor, source): (f64, &[f64]),
) -> Option<Region> {
    let (region, gap) = (&held.region, request.indenter.gap());
    let [l1, l2] = ground.grid.lengths();
    let motions = || (0..ground.bodies).map(|body| trial.motion(region, request, body));
    let deepest = |m: RigidMotion| m.approach + 0.5 * (m.tilt[0].abs() * l1 + m.tilt[1].abs() * l2);
    if motions().all(|motion| deepest(motion) <= window.lowest_outside) {
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
    let area = factor * region.cell_area() / PI;
    let least = |r: f64| {
        let lowered = if negative > 0.0 { negative / (r - radius).max(0.0) } else { 0.0 };
        area * (positive / (r + radius) - lowered)
    };
    let touched = motions().enumerate().filter_map(|(body, motion)| {
        cells_below(&ground.grid, folded, gap, body, motion, |cell, depth| {
            let computed = held.region_is_for_contact && region.find(cell).is_some();
            !computed && depth > least(distance(ground.grid.center(cell[0], cell[1])))
        })
    });
    Extent::hull(touched).map(|touched| region_holding(&ground.grid, folded, region.extent().with(touched)))
}

/// A region that holds these cells and a tenth beyond, so that it need not grow every request, or the whole grid where
/// it would be most of it.
pub(crate) fn region_holding(grid: &Grid, folded: [bool; 2], held: Extent) -> Region {
    let whole = Region::whole(grid, folded);
    let region = Region::around(grid, folded, held, 0.1);
    if region.len() as f64 > MAX_WINDOW_FRACTION * whole.len() as f64 { whole } else { region }
}

/// The least rectangle of the cells where the undeformed gap of a body in `motion` is negative, and which are `wanted`
/// with their depth.
pub(crate) fn cells_below(
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
