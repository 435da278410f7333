//! Steps of surfaces that attract each other.
//!
//! With the attraction s(h) the step has h = gap + c K (z − s(h)) − motion ≥ 0, z ≥ 0, z h = 0, and z − s carries the
//! load: z is the pressure of the wall. Since s never grows with h, the energy is a convex function plus a concave
//! one, −Σ ∫ₕ^∞ s. A pass takes s from the gap of the pass before, a tangent of the concave part, and solves the
//! contact problem of the gap − c K s under the load + Σ s: it lowers the energy (Le Thi & Pham, Ann. Oper. Res. 133,
//! 2005), and where no pass changes s any more, the state is stationary.
//!
//! Passes are extrapolated by Anderson's method (J. ACM 12, 1965) from the one before. An extrapolated s is kept only
//! where the energy falls; else the plain pass follows. Next to a jump an inexact pass does not determine the energy:
//! an extrapolation that leads uphill is reversed there, in place of plain passes that would creep. So a step
//! descends from the state before it, and ends in the valley that this state belongs to.
//!
//! Passes take the steps of bodies that tilt freely, and of bodies that end where contact and attraction take nearly
//! all of the grid. All others [descend in the gap](descent), bodies that end with the [near field](near_field) of K.

mod descent;
mod energy;
mod front;
mod gap_direction;
mod near_field;
mod passes;
mod split;

pub(in crate::contact) use passes::Attracted;
pub use passes::PassReport;
use passes::{Extrapolation, InPasses};

use crate::adhesion::Attraction;
use crate::contact::Edge;
use crate::contact::Step;
use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::contact::step::edge::attraction_beyond;
use crate::equilibrium::RigidBodies;
use crate::equilibrium::Trial;
use crate::equilibrium::constraints::converged;
use crate::equilibrium::guess::{begin, fill};
use crate::equilibrium::held::net_sum;
use crate::equilibrium::request::TriedSpring;
use crate::equilibrium::spring::solve_with_springs;
use crate::equilibrium::window::Window;
use crate::error::{AdhesionError, Result, StepError};
use crate::load::Load;
use crate::parallel::for_each_band;
use crate::solver::{Counts, Freedom, Outcome, PENETRATION_SLACK, Solution, Stop};

/// Greatest number of passes of a round.
const MAX_PASSES: usize = 2000;
/// A step ends where a pass changes s, over the greatest traction, by less than a limit, by which the force errs: so
/// many tolerances of the solver.
const CHANGE: f64 = 100.0;
/// The limit is no more than this,
const MOST_CHANGE: f64 = 1e-4;
/// unless the tolerance is coarse: then it is this part of the tolerance.
const SHARE: f64 = 0.3;
/// The tolerance of the solver in a pass, over the last change of s, and its greatest value.
const INNER: f64 = 0.003;
const LOOSEST: f64 = 1e-3;
/// Where the wall displaces the surfaces by more than these ranges of the attraction, passes are solved more exactly,
/// as far as to this part.
const EXACT: f64 = 10.0;
const LEAST_EXACT: f64 = 1e-3;
/// The energy of a pass is known to this many tolerances of its solver, relative to the sum of its parts: cells
/// outside the contact may penetrate by so much.
const UNSURE: f64 = PENETRATION_SLACK;
/// The greatest error of s after the first pass, over what the pass changed.
const MOST_ERROR: f64 = 100.0;
/// Traction of a cell that changed by more than this part of the greatest in the last step is not extrapolated to the
/// next.
const GREATEST_CHANGE: f64 = 0.5;

/// A step of surfaces that attract each other.
pub(super) struct AttractedStep<'a> {
    pub(super) scene: &'a Scene,
    pub(super) law: &'a dyn Attraction,
    pub(super) state: &'a State,
    pub(super) step: &'a Step<'a>,
    pub(super) bodies: RigidBodies<'a>,
    /// The compliance of the step, and the greatest motion taken from its gap.
    pub(super) given: [f64; 2],
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
        if self.given[0] == 0.0 {
            let what = "a jump of surfaces that attract each other (take a short step instead)";
            return Err(StepError::NoElasticResponse { time, what }.into());
        }
        begin(&self.state.held, trial, self.step.request());
        let cells = trial.gap.len();
        trial.solution.attraction.resize(cells, 0.0);
        self.iterate(attracted.get_or_insert_with(|| Box::new(Attracted::new(cells))), window, trial)
    }

    fn iterate(&self, own: &mut Attracted, window: &mut Window, trial: &mut Trial) -> Result<()> {
        let (state, scene, mut counts) = (self.state, self.scene, Counts::default());
        own.report = PassReport::default();
        trial.solution.stiffness = 0.0;
        if let Some(end) = self.step.end {
            trial.solution.clone_from(end);
        } else if self.wanted.tilts() || !self.solve_in_gap(own, window, trial, &mut counts)? {
            self.solve_by_passes(own, window, trial, &mut counts)?;
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

    /// Finishes z, s and K (z − s) of the trial by passes, from a guess.
    fn solve_by_passes(
        &self,
        own: &mut Attracted,
        window: &mut Window,
        trial: &mut Trial,
        counts: &mut Counts,
    ) -> Result<()> {
        trial.solution.stiffness = 0.0;
        own.error = (1.0 / self.softness(trial) - 1.0).clamp(1.0, MOST_ERROR);
        trial.free[0] = self.wanted;
        self.open_gap(window, trial);
        begin(&self.state.held, trial, self.step.request());
        if self.state.is_undisturbed() {
            self.first_guess(window, trial, counts);
        } else {
            self.extrapolate(trial);
        }
        let Window { kernel, work, .. } = &mut *window;
        let Solution { pressure, attraction, potential, .. } = &mut trial.solution;
        let InPasses { image, .. } = own.in_passes();
        kernel.apply(attraction, image, work);
        counts.convolutions += 1;
        if self.state.held.extrapolation.refresh_is_due() {
            kernel.apply(pressure, potential, work);
            counts.convolutions += 1;
        } else {
            potential.iter_mut().zip(&*image).for_each(|(v, image)| *v += image);
        }
        self.descend(own, window, trial, counts)?;
        let InPasses { image, .. } = own.in_passes();
        trial.solution.potential.iter_mut().zip(&*image).for_each(|(v, image)| *v -= image);
        Ok(())
    }

    /// Passes until one changes s no more, from z, s, K z and K s of the trial.
    fn descend(&self, own: &mut Attracted, window: &mut Window, trial: &mut Trial, counts: &mut Counts) -> Result<()> {
        let AttractedStep { step, wanted, stop, given: [c, _], .. } = *self;
        let (greatest, limit) = (self.law.traction(0.0), self.limit());
        own.has_last = false;
        let (mut least, mut inner, mut plain, mut convolved, mut reversed) =
            (f64::INFINITY, LOOSEST, true, true, false);
        let (mut change, mut exactness, mut exact) = (f64::INFINITY, 0.0, 1.0);
        // plain passes that are to follow, and after the next extrapolation that gains nothing
        let (mut wait, mut penalty) = (0_usize, 1_usize);
        for _ in 0..MAX_PASSES {
            self.open_gap(window, trial);
            own.report.passes += 1;
            if !std::mem::replace(&mut convolved, false) {
                let Window { kernel, work, .. } = &mut *window;
                kernel.apply(&trial.solution.attraction, own.in_passes().image, work);
                counts.convolutions += 1;
            }
            let InPasses { image, .. } = own.in_passes();
            for_each_band([&mut trial.gap], |first, [gap]| {
                gap.iter_mut().zip(&image[first..]).for_each(|(gap, image)| *gap -= c * image);
            });
            let pulled = self.add_to_load(trial);
            let carried = !matches!(step.loads[0], Load::Force { .. }) || trial.free[0].total > 0.0;
            let tolerance = inner.max(exact * stop.tolerance.min(limit / CHANGE));
            let outcome = if carried { self.pass(tolerance, pulled, window, trial) } else { Outcome::Stagnated };
            add(counts, trial.solution.counts);
            // no wall holds what pulls, or what turns a body off that tilts freely: it peels
            let peels = matches!(outcome, Outcome::Unbalanced(_)) && wanted.total <= 0.0;
            if plain && (!carried || peels) {
                let force = wanted.total * self.state.held.region.cell_area();
                return Err(AdhesionError::PulledOff { time: step.interval.time, force }.into());
            }
            if plain || matches!(outcome, Outcome::NotANumber | Outcome::Cancelled) {
                trial.solution.counts = *counts;
                converged(outcome, &self.scene.ground, &trial.solution, step.request())?;
            }
            let found = if outcome == Outcome::Converged { Some(self.find(own, trial)) } else { None };
            let unsure = UNSURE * tolerance.max(std::mem::replace(&mut exactness, tolerance));
            let kept = found.filter(|found| plain || found.energy <= least + unsure * found.scale);
            let Some(found) = kept else {
                // the plain pass from the last state that was kept
                own.report.rejected += 1;
                trial.solution.attraction.copy_from_slice(own.in_passes().last_g);
                plain = true;
                (wait, penalty) = (penalty, penalty.saturating_mul(2));
                continue;
            };
            if least.is_finite() {
                own.report.rise = own.report.rise.max((found.energy - least) / found.scale - unsure);
            }
            if !plain && !reversed && found.change >= change {
                // it gained nothing: the more often, the more plain passes follow
                (wait, penalty) = (penalty, penalty.saturating_mul(2));
            }
            (least, change) = (found.energy, found.change);
            exact = (EXACT * self.law.range() / found.displaced).clamp(LEAST_EXACT, 1.0);
            inner = (INNER * exact * change).min(LOOSEST);
            // the force of the spring, too
            let scale = (trial.free[0].total * self.state.held.region.cell_area()).max(pulled);
            trial.solution.residual = trial.solution.residual.max(trial.springs[0].missing / scale);
            let (s, g) = (&mut trial.solution.attraction, &trial.gap);
            let next = own.extrapolation(self.state, s, g);
            own.error = if own.has_last { next.error } else { own.error };
            let ends = change * own.error <= limit;
            if ends && trial.solution.residual <= stop.tolerance {
                return Ok(());
            }
            if ends {
                // the same pass, more exactly
                (inner, convolved) = (0.0, true);
                continue;
            }
            let weight;
            Extrapolation { weight, reversed, .. } = next;
            // where a stable state has just vanished, plain passes would creep
            plain = !own.has_last || wait > 0 && !reversed;
            wait = wait.saturating_sub(1);
            own.go_on(if plain { 0.0 } else { weight }, greatest, s, g);
        }
        let (time, passes) = (step.interval.time, own.report.passes);
        Err(AdhesionError::NotConverged { time, passes, change, tolerance: limit }.into())
    }

    /// Writes the gap before any traction.
    fn open_gap(&self, window: &Window, trial: &mut Trial) {
        let (state, initial) = (self.state, window.gap(&self.step.indenter));
        self.bodies.fill_gap_of_step(initial, &state.history, &state.held.current.solution.pressure, &mut trial.gap);
    }

    /// Writes z, s and K (z − s) extrapolated from the last two states, or of the last state where s has changed much.
    fn extrapolate(&self, trial: &mut Trial) {
        let (state, step) = (self.state, self.step);
        let (now, before) = (&state.held.current.solution, &state.previous.solution);
        let mut reach = state.held.extrapolation.reach(step.interval.dt);
        let changes = now.attraction.iter().zip(&before.attraction).map(|(now, before)| (now - before).abs());
        if changes.fold(0.0, f64::max) > GREATEST_CHANGE * self.law.traction(0.0) {
            reach = 0.0;
        }
        trial.reach = reach;
        let (solution, extrapolated) = (&mut trial.solution, |now: f64, before: f64| now + reach * (now - before));
        fill(&mut solution.pressure, [&now.pressure, &before.pressure], &extrapolated);
        fill(&mut solution.attraction, [&now.attraction, &before.attraction], &extrapolated);
        fill(&mut solution.potential, [&now.potential, &before.potential], &extrapolated);
    }

    /// Writes the guess of a first step: no pressure, and s of undeformed bodies, which just touch under a force.
    fn first_guess(&self, window: &mut Window, trial: &mut Trial, counts: &mut Counts) {
        let lowest = self.state.held.region.rows().least(trial.gap.iter().fold(f64::INFINITY, |low, &h| low.min(h)));
        let motion = match self.step.loads[0] {
            Load::Approach { .. } => 0.0,
            _ => lowest,
        };
        let Solution { pressure, attraction, potential, .. } = &mut trial.solution;
        pressure.fill(0.0);
        for (s, &open) in attraction.iter_mut().zip(&trial.gap) {
            *s = if open.is_finite() { self.law.traction((open - motion).max(0.0)) } else { 0.0 };
        }
        let Window { kernel, work, .. } = &mut *window;
        kernel.apply(attraction, potential, work);
        counts.convolutions += 1;
        potential.iter_mut().for_each(|v| *v = -*v);
    }

    /// Adds Σ s to the load that the wall carries, and its moments; returns the force of the attraction \[N\].
    fn add_to_load(&self, trial: &mut Trial) -> f64 {
        let (state, wanted, s) = (self.state, self.wanted, &trial.solution.attraction);
        let region = &state.held.region;
        let [sum, moment1, moment2] = if wanted.tilts() {
            region.rows().sum_terms(|k| {
                let x = region.center(k);
                Some([s[k], s[k] * x[0], s[k] * x[1]])
            })
        } else {
            [region.rows().sum(s), 0.0, 0.0]
        };
        let motion = region.modes(trial.free[0]).physical(trial.solution.motions[0]);
        let total = wanted.total + sum;
        trial.free[0] = wanted;
        trial.springs[0] = TriedSpring::default();
        match self.step.loads[0] {
            Load::Force { .. } => {
                trial.free[0].total = total;
                if wanted.tilts() && total > 0.0 {
                    let moments = [moment1, moment2];
                    trial.free[0].point =
                        [0, 1].map(|axis| (wanted.total * wanted.point[axis] + moments[axis]) / total);
                }
            }
            // the search for the force of the wall begins at its present pressure
            Load::Spring { .. } => trial.free[0].total = region.rows().sum(&trial.solution.pressure).max(0.0),
            Load::Approach { .. } => {}
        }
        if wanted.tilts() {
            trial.solution.motions[0] = region.modes(trial.free[0]).coefficients(motion);
        }
        sum * self.state.held.region.cell_area()
    }

    /// One contact problem with the attraction of the trial, which pulls with the force `pulled` \[N\].
    fn pass(&self, tolerance: f64, pulled: f64, window: &mut Window, trial: &mut Trial) -> Outcome {
        let stop = Stop { tolerance, ..self.stop };
        trial.solution.counts = Counts::default();
        trial.solution.trace.clear();
        let solve = |trial: &mut Trial| window.solve(&self.step.indenter, self.given, stop, trial);
        // a spring holds the wall against load and attraction: as if its end were nearer
        let loads = match self.step.loads[0] {
            Load::Spring { stiffness, drive, tilt } => {
                [Load::Spring { stiffness, drive: drive + pulled / stiffness, tilt }]
            }
            load => [load],
        };
        let step = Step { loads: &loads, tolerance, ..self.step.clone() };
        solve_with_springs(&self.scene.ground, &self.state.held, step.request(), self.given[0], trial, solve)
    }

    /// Lays a body on its spring: what is left of the imbalance becomes an error of the gap, which a stiff spring
    /// would multiply.
    fn hold_by_spring(&self, trial: &mut Trial) {
        let Load::Spring { stiffness, drive, .. } = self.step.loads[0] else { return };
        let force = self.state.held.region.cell_area() * net_sum(&self.state.held.region.rows(), &trial.solution);
        trial.solution.motions[0].0[0] = drive - self.step.indenter.gap().datum - force / stiffness;
    }

    /// The change of s over the greatest traction that ends a step.
    fn limit(&self) -> f64 {
        let tolerance = self.stop.tolerance;
        (CHANGE * tolerance).min((SHARE * tolerance).max(MOST_CHANGE))
    }
}

/// Adds the work of a pass.
fn add(counts: &mut Counts, more: Counts) {
    counts.iterations += more.iterations;
    counts.convolutions += more.convolutions;
    counts.preconditioner_applications += more.preconditioner_applications;
    counts.fallback_iterations += more.fallback_iterations;
}
