//! What has left the grid behind an indenter that moves over bodies that do not come round.

use crate::contact::{Computation, Scene, State};
use crate::equilibrium::Held;
use crate::extent::Extent;
use crate::grid::Grid;

/// A change of approach or lateral force, over its value, that is told.
const TOLD: f64 = 0.01;
/// A dashpot flows as a term of this many times the time for which the bodies have been pressed.
const OF_FLOW: f64 = 1e3;

/// A contact after a step over the bodies.
#[derive(Clone, Copy)]
pub(in crate::contact) struct Wake<'a> {
    pub(in crate::contact) scene: &'a Scene,
    pub(in crate::contact) computation: &'a Computation,
    /// All pressed cells.
    pub(in crate::contact) reach: Extent,
    /// Cells by which the indenter moved in the step.
    pub(in crate::contact) stride: [isize; 2],
}

impl Wake<'_> {
    /// The part of approach or lateral force by which the traces that have left the grid could change it, where that is
    /// to be told: a bound that is 1.2 to 3 times what is missing where v λ is longer than the grid.
    pub(in crate::contact) fn missing(self) -> Option<f64> {
        let missing = |axis: usize| if self.stride[axis] == 0 { 0.0 } else { self.along(axis) };
        Some(missing(0).max(missing(1))).filter(|missing| *missing > TOLD)
    }

    /// At a distance s behind it a load W leaves the sources Σ C_k W e^(−s/l_k)/l_k ds, l_k = v λ_k, as far back as the
    /// indenter came at this speed since it touched. Those beyond the edge, at D behind the end of the contact, would
    /// lift the contact and tilt it. As their influence falls as 1/s, and its slope as 1/s², the exponential integrals
    /// E1(D/l_k) and E2(D/l_k) result; in line contact, of the slope 1/s, E1 for the tilt. Upper bounds of elementary
    /// functions take their place. From the end of the contact on, at most the whole load counts.
    fn along(self, axis: usize) -> f64 {
        let Scene { ground, creep, .. } = self.scene;
        let (kernel, grid, State { held, clock, history, .. }) =
            (&ground.kernel, &ground.grid, &self.computation.state);
        let (periodic, side, count) = (kernel.periodic_axes(), grid.spacing()[axis], grid.cells()[axis]);
        let Some(creep) = creep.as_ref().filter(|_| !periodic[axis] && clock.last_dt > 0.0) else { return 0.0 };
        let line = periodic[1 - axis];
        let cells = if self.stride[axis] > 0 { self.reach.low[axis] } else { count - 1 - self.reach.high[axis] };
        let speed = side * self.stride[axis].unsigned_abs() as f64 / clock.last_dt;
        let distance = (cells as f64 + 0.5) * side;
        let beyond = speed * clock.age() - distance;
        if beyond <= 0.0 || !history.has_left(axis, self.stride[axis] > 0) {
            return 0.0;
        }
        // displacement at a distance under a unit force, and how strongly its slope falls: a layer's base may be softer
        let influence = |cells: usize| {
            let mut at = [0; 2];
            at[axis] = cells as isize;
            kernel.coefficient(at[0], at[1]).unwrap_or(0.0) / grid.cell_area()
        };
        let strength = |cells: usize| {
            let slope = (influence(cells - 1) - influence(cells + 1)) / (2.0 * side);
            slope.abs() * (cells as f64 * side).powi(if line { 1 } else { 2 })
        };
        let far = count.saturating_sub(2).max(1);
        let near = cells.clamp(1, far);
        let (strength, lift) = (strength(near).max(strength(far)), influence(near));
        let force = held.current.sum * held.region.cell_area();
        let flow = OF_FLOW * clock.age();
        // Σ p |δu|, and Σ p |∂δu/∂x| along the motion
        let (mut lifts, mut slopes) = (0.0, 0.0);
        for (compliance, time) in creep.terms().iter().copied().chain([(creep.fluidity() * flow, flow)]) {
            let l = speed * time;
            let weight = -(-beyond / l).exp_m1() * compliance * force * held.current.sum;
            let decay = (-distance / l).exp();
            let e1 = decay * (l / distance).ln_1p();
            let (lifted, tilted) = if line {
                ((lift * decay - strength * e1).abs() + 0.58 * strength * decay, strength / l * e1)
            } else {
                (strength / l * e1, strength * decay / (distance * (l + distance)))
            };
            lifts += weight * lifted;
            slopes += weight * tilted;
        }
        let share = |part: f64, whole: f64| if part == 0.0 { 0.0 } else { part / whole };
        let approach = held.current.motions[0].approach - held.indenter.gap().datum;
        share(lifts, held.current.sum * approach.abs()).max(share(slopes, self.slope(grid, axis).abs()))
    }

    /// Σ p ∂u/∂x along an axis, which is the lateral force over the area of a cell.
    fn slope(self, grid: &Grid, axis: usize) -> f64 {
        let State { held: Held { region, current, .. }, history, .. } = &self.computation.state;
        let (count, unit, displacement) =
            (region.cells()[axis], if axis == 0 { region.cells()[1] } else { 1 }, history.displacement());
        let slope_at = |(k, p): (usize, &f64)| {
            let m = k / unit % count;
            let at = |other: usize| displacement[k + other * unit - m * unit];
            p * (at((m + 1).min(count - 1)) - at(m.max(1) - 1)) / (2.0 * grid.spacing()[axis])
        };
        current.solution.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0).map(slope_at).sum()
    }
}
