//! Acceptance of a computed step, and its warnings.

use std::sync::Arc;

use crate::contact::read::limits::{DEEP, LONG_STEP};
use crate::contact::{Computation, Edge, Figures, Indenter, Scene, State, Step, TimeRule, Warnings};
use crate::extent::Extent;
use crate::observe::resolution::{Outline, Resolution};
use crate::solver::RigidMotion;

impl Computation {
    /// Number of cells of the region that are pressed in the trial, and the rectangle of the grid that holds them: of all ranks.
    pub(crate) fn pressed(&self) -> (usize, Option<Extent>) {
        let (region, pressure) = (&self.state.region, &self.trial.solution.pressure);
        (region.rows().count(pressure.iter().filter(|&&p| p > 0.0).count()), region.reach(pressure))
    }

    /// Whether any cell is pressed in the trial, of all ranks.
    pub(crate) fn presses(&self) -> bool {
        self.state.region.is_positive_anywhere(&self.trial.solution.pressure)
    }

    /// Makes the trial the state; `sum` is Σ p, `contact_cells` is the number of pressed cells of the region, and `sizes` are the
    /// means of displacement and v in contact.
    pub(super) fn accept(&mut self, step: Step<'_>, sum: f64, contact_cells: usize, sizes: [f64; 2]) {
        let Computation { state, trial, .. } = self;
        let (interval, datum) = (step.interval, step.indenter.gap().datum);
        let touched = !state.is_undisturbed() || contact_cells > 0 || state.attracts;
        let potentials = [&state.current.solution, &trial.solution].map(|solution| &solution.potential[..]);
        state.history.commit(interval, potentials, touched);
        if !Arc::ptr_eq(&step.indenter, &state.indenter) {
            // where the indenter was within the step is not known
            state.history.forget_start();
        }

        state.keep_start(interval.interpolant);
        std::mem::swap(&mut state.previous, &mut state.current);
        std::mem::swap(&mut state.current.solution, &mut trial.solution);
        (state.current.contact_cells, state.current.sum) = (state.region.images() * contact_cells, sum);
        for body in 0..step.loads.len() {
            let modes = state.region.modes(trial.free[body]);
            let free = modes.physical(state.current.solution.motions[body]);
            let RigidMotion { approach, tilt } = step.prescribed(body);
            state.current.motions[body] = RigidMotion { approach: datum + approach, tilt } + free;
        }
        state.loads.copy_from_slice(step.loads);
        (state.indenter, state.indenter_is_new) = (step.indenter, false);
        let pressed = if state.attracts { state.region.rows().sum(&state.current.solution.pressure) } else { sum };
        state.extrapolation.accept(interval.dt, pressed, trial.reach);
        (0..2).for_each(|which| state.greatest[which] = state.greatest[which].max(sizes[which]));
        state.clock.accept(interval, touched);
    }
}

/// Bodies whose cells are counted together.
const TOGETHER: usize = 8;

/// Where a step presses: found before the state changes, since all ranks take part.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pressed {
    /// Number of pressed cells of the region.
    pub(crate) cells: usize,
    /// The rectangle of the grid that holds them.
    pub(crate) reach: Option<Extent>,
    /// Cells across the contact of the body with the fewest, if they are few.
    pub(crate) few: Option<f64>,
}

impl Computation {
    /// Where the trial of a step of this `indenter` presses. A call of all ranks.
    pub(crate) fn pressed_under(&self, scene: &Scene, indenter: &Indenter) -> Pressed {
        let (cells, reach) = self.pressed();
        Pressed { cells, reach, few: reach.and_then(|reach| self.few_cells(scene, indenter, reach)) }
    }

    /// Cells across the contact of the body with the fewest, if they are few; `reach` holds all pressed cells.
    fn few_cells(&self, scene: &Scene, indenter: &Indenter, reach: Extent) -> Option<f64> {
        let (Scene { grid, kernel, bodies, .. }, region) = (scene, &self.state.region);
        let (rows, cells, periodic) = (region.rows(), grid.cells(), kernel.periodic_axes());
        let (pressure, ends, images) = (&self.trial.solution.pressure, region.ends(periodic), region.images());
        let outline = Outline { rows: &rows, pressure, ends, images };
        if *bodies == 1 {
            return outline.resolution().few(reach, cells, periodic);
        }
        let body = |k: usize| indenter.gap().owner(indenter.index(grid, region, k));
        let found = (0..*bodies).step_by(TOGETHER).flat_map(|first| outline.resolutions::<TOGETHER>(first, body));
        let few = |(resolution, extent): (Resolution, Option<Extent>)| {
            resolution.few(region.shown_extent(extent?), cells, periodic)
        };
        found.filter_map(few).reduce(f64::min)
    }
}

impl State {
    /// Whether the heights of the shapes are so far from 0 that their rounding counts, over the depth of the contact.
    pub(crate) fn heights_are_lost(&self, scene: &Scene) -> bool {
        let datum = self.indenter.gap().datum;
        let depth = self.current.motions.iter().map(|motion| motion.approach - datum).fold(0.0, f64::max);
        self.current.contact_cells > 0 && f64::EPSILON * datum.abs() > scene.settings.tolerance * depth
    }
}

/// Contact this near to an edge is near it \[cells\].
const EDGE_MARGIN: usize = 2;
/// Fewer cells resolve the zone of an attraction badly.
pub(super) const COARSE_ZONE: f64 = 4.0;

/// The warnings of the step accepted last, with all pressed cells in `reach`.
pub(super) fn collect_warnings(
    scene: &Scene,
    computation: &Computation,
    reach: Option<Extent>,
    figures: &Figures,
    time_error: Option<f64>,
) -> Warnings {
    let Computation { state, trial, .. } = computation;
    let (axes, periodic) = (scene.grid.cells(), scene.kernel.periodic_axes());
    let (dt, material) = (state.clock.last_dt, &scene.material);
    let solution = &state.current.solution;
    let near = reach.is_some_and(|Extent { low, high }| {
        let at_end = |axis: usize| low[axis] <= EDGE_MARGIN || high[axis] + EDGE_MARGIN + 1 >= axes[axis];
        (0..2).any(|axis| !periodic[axis] && at_end(axis))
    });
    let of_material =
        if state.is_undisturbed() { Warnings::empty() } else { scene.limits.warnings(state.clock.age(), dt) };
    // the rectangle rule oscillates where the bodies creep by more in a step than they yield at once
    let oscillates = scene.settings.time_rule == TimeRule::Rectangle
        && material.contact_compliance(dt) > 2.0 * material.contact_compliance(0.0);
    let reasons = [
        (Warnings::COARSE_ZONE, figures.cells_in_zone.is_some()),
        (Warnings::BEYOND_EDGE, figures.beyond_edge.is_some()),
        (Warnings::NEAR_EDGE, near && scene.settings.edge == Edge::Refuse),
        (Warnings::FEW_CELLS, figures.cells_across.is_some()),
        (Warnings::RINGS, oscillates),
        (Warnings::FALL_BACK, solution.counts.fallback_iterations > 0),
        (Warnings::ROUNDING, solution.relative_rounding > scene.settings.tolerance || state.heights_are_lost(scene)),
        (Warnings::MODULUS, figures.modulus.is_some()),
        (Warnings::STEEP, figures.max_slope.is_some()),
        (Warnings::DEEP, figures.compression > Some(DEEP)),
        (Warnings::OTHER_PERIOD, figures.periods.is_some()),
        (Warnings::SHORT_WAVES, figures.cells_in_wave.is_some()),
        (Warnings::LONG_STEP, time_error > Some(LONG_STEP)),
        (Warnings::JUMP, trial.passes.as_ref().is_some_and(|passes| passes.report.jumped)),
        (Warnings::FLAT, state.indenter.is_too_flat(&scene.grid)),
    ];
    of_material | Warnings::of(&reasons)
}
