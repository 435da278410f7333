//! Steps of surfaces that attract each other.
//!
//! With the attraction s(h) the step has h = gap + c K (z − s(h)) − motion ≥ 0, z ≥ 0, z h = 0, and z − s carries the
//! load: z is the pressure of the wall. Since s never grows with h, the energy is a convex function plus a concave
//! one, −Σ ∫ₕ^∞ s, and may have several minima. A step [descends in the gap](descent) from the state before it, and
//! ends in the valley that this state belongs to; bodies that end descend with the [near field](near_field) of K.

mod balance;
mod descent;
mod edge;
mod energy;
mod front;
mod gap_direction;
mod jump_search;
mod lift;
mod near_field;
mod passes;
mod softest;
mod zone;

pub(in crate::contact) use passes::Attracted;
pub use passes::PassReport;
pub(in crate::contact::step) use zone::coarse_zone;
pub(in crate::contact) use zone::resolved_softening;

use crate::attraction::Attraction;
use crate::contact::Edge;
use crate::contact::Step;
use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::equilibrium::RigidBodies;
use crate::equilibrium::Trial;
use crate::equilibrium::guess::{begin, fill};
use crate::equilibrium::held::net_sum;
use crate::equilibrium::window::Window;
use crate::error::{Result, StepError};
use crate::load::Load;
use crate::solver::{Counts, Freedom, Stop};
use edge::attraction_beyond;

/// A step of surfaces that attract each other.
pub(super) struct AttractedStep<'a> {
    pub(super) scene: &'a Scene,
    pub(super) law: &'a dyn Attraction,
    pub(super) state: &'a State,
    pub(super) step: &'a Step<'a>,
    pub(super) bodies: RigidBodies<'a>,
    pub(super) compliance: f64,
    pub(super) stop: Stop<'a>,
    /// The free motions, and the load that they carry without attraction.
    pub(super) wanted: Freedom,
}

impl AttractedStep<'_> {
    /// Computes wall pressure, attraction and motion of the trial; its potential is K (z − s) at the end.
    pub(super) fn solve(
        &self,
        window: &mut Window,
        trial: &mut Trial,
        attracted: &mut Option<Box<Attracted>>,
    ) -> Result<()> {
        let time = self.step.interval.time;
        if self.compliance == 0.0 {
            let what = "a jump of surfaces that attract each other (take a short step instead)";
            return Err(StepError::NoElasticResponse { time, what }.into());
        }
        begin(&self.state.held, trial, self.step.request());
        let cells = trial.gap.len();
        trial.solution.attraction.resize(cells, 0.0);
        self.solve_and_report(
            attracted.get_or_insert_with(|| Box::new(Attracted::new(cells, &window.kernel))),
            window,
            trial,
        )
    }

    fn solve_and_report(&self, own: &mut Attracted, window: &mut Window, trial: &mut Trial) -> Result<()> {
        let (state, scene, mut counts) = (self.state, self.scene, Counts::default());
        own.report = PassReport::default();
        trial.solution.stiffness = 0.0;
        if let Some(end) = self.step.end {
            trial.solution.clone_from(end);
        } else {
            self.solve_in_gap(own, window, trial, &mut counts)?;
        }
        trial.solution.counts = counts;
        self.hold_by_spring(trial);
        self.open_gap(window, trial);
        self.report_release(own, trial);
        if scene.ground.settings.edge == Edge::Refuse {
            own.report.beyond_edge = attraction_beyond(scene, self.law, &state.held.region, &trial.solution);
        }
        own.keep_weights([&trial.solution, &state.held.current.solution, &state.previous.solution]);
        Ok(())
    }

    /// Writes the gap before any traction.
    fn open_gap(&self, window: &Window, trial: &mut Trial) {
        let (state, initial) = (self.state, window.gap(&self.step.indenter));
        self.bodies.fill_gap_of_step(initial, &state.history, &state.held.current.solution.pressure, &mut trial.gap);
    }

    /// Writes z, s and K (z − s) extrapolated from the last two states, or of the last state where s of a cell has
    /// changed by more than half of its maximum.
    fn extrapolate(&self, trial: &mut Trial) {
        let (state, step) = (self.state, self.step);
        let (now, before) = (&state.held.current.solution, &state.previous.solution);
        let mut reach = state.held.extrapolation.reach(step.interval.dt);
        let changes = now.attraction.iter().zip(&before.attraction).map(|(now, before)| (now - before).abs());
        if changes.fold(0.0, f64::max) > 0.5 * self.law.traction(0.0) {
            reach = 0.0;
        }
        trial.reach = reach;
        let (solution, extrapolated) = (&mut trial.solution, |now: f64, before: f64| now + reach * (now - before));
        fill(&mut solution.pressure, [&now.pressure, &before.pressure], &extrapolated);
        fill(&mut solution.attraction, [&now.attraction, &before.attraction], &extrapolated);
        fill(&mut solution.potential, [&now.potential, &before.potential], &extrapolated);
    }

    /// Lays a body on its spring: what is left of the imbalance becomes an error of the gap, which a stiff spring
    /// would multiply.
    fn hold_by_spring(&self, trial: &mut Trial) {
        let Load::Spring { stiffness, drive, .. } = self.step.loads[0] else { return };
        let force = self.state.held.region.cell_area() * net_sum(&self.state.held.region.rows(), &trial.solution);
        trial.solution.motions[0].0[0] = drive - self.step.indenter.gap().datum - force / stiffness;
    }
}

/// Adds the work of a pass.
fn add(counts: &mut Counts, more: Counts) {
    counts.iterations += more.iterations;
    counts.convolutions += more.convolutions;
    counts.preconditioner_applications += more.preconditioner_applications;
    counts.fallback_iterations += more.fallback_iterations;
}
