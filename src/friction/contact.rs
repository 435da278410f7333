//! A contact with friction, step by step.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::kernel::other_bodies;
use crate::contact::{Builder, Snapshot, Step, StepError, StepReport, TimeRule, ViscoelasticContact};
use crate::equilibrium::Held;
use crate::equilibrium::constraints::validate_loads;
use crate::error::{Error, Result, Special, UserError};
use crate::friction::kernel::{TangentialKernel, TangentialResponse};
use crate::friction::limit::FrictionLimit;
use crate::friction::load::{Component, LARGEST, ShearLoad, size};
use crate::friction::newton::{NEWTON, NewtonBuffers};
use crate::friction::problem::{Cell, Problem, Solution, not_found, take_motion};
use crate::friction::rectangle::extent;
use crate::friction::report::{FrictionReport, Outcome};
use crate::friction::shear_history::ShearHistory;
use crate::friction::state::State;
use crate::hereditary::Interpolant;
use crate::load::Load;
use crate::parallel::in_pool;
use crate::run::doubled::SavedRun;
use crate::run::doubled::plain::Plain;
use crate::solver::RigidMotion;

/// Loads beyond what friction carries by less than this part are carried: rounding.
const ROUNDING: f64 = 1e-9;

/// A contact that is pressed and sheared.
///
/// ```
/// use viscocontact::friction::{Coulomb, FrictionContact, Outcome, ShearLoad};
/// use viscocontact::prelude::*;
///
/// let ball = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?));
/// let mut contact = FrictionContact::new(ball, Coulomb::new(0.5)?)?;
/// contact.step(0.0, Load::force(1.0), ShearLoad::force([0.0; 2]))?;
/// // at 60 % of what friction carries the middle sticks
/// contact.step(0.0, Load::force(1.0), ShearLoad::force([0.3, 0.0]))?;
/// assert!(contact.stick_cells() > 0 && contact.stick_cells() < contact.normal().contact_cells());
/// let before = contact.motion()[0];
/// contact.step(1.0, Load::force(1.0), ShearLoad::force([0.3, 0.0]))?;
/// assert!(contact.motion()[0] > 1.2 * before); // it creeps
/// // more than friction carries: the contact would slide along x1, and stays as it is
/// let outcome = contact.step(0.0, Load::force(1.0), ShearLoad::force([0.6, 0.0]))?;
/// assert!(matches!(outcome, Outcome::Slides { direction: [1.0, ..], .. }));
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug)]
pub struct FrictionContact {
    pub(super) normal: ViscoelasticContact,
    /// The normal contact before the step being tried.
    pub(super) start: Snapshot,
    pub(super) limit: Arc<dyn FrictionLimit>,
    pub(super) response: TangentialResponse,
    pub(super) state: State,
    pub(super) kernel: TangentialKernel,
    pub(super) step: StepFields,
    /// Tolerance of the solver in a run.
    pub(super) tolerance: f64,
    /// Differences between outcomes of a step, over the maximum so far, that a run does not resolve.
    pub(super) unresolved: f64,
    /// Forces and torque of a history below these are none.
    pub(super) least: [f64; 3],
    pub(super) loads_along: Option<ShearHistory>,
    /// A run that was saved and resumed.
    pub(super) saved_run: Option<Arc<SavedRun<Plain>>>,
}

/// What a step needs, on the rectangle.
#[derive(Debug, Clone, Default)]
pub(super) struct StepFields {
    places: Vec<[f64; 2]>,
    pub(super) bound: Vec<f64>,
    entered: Vec<f64>,
    drift: Vec<f64>,
    free: Vec<f64>,
    /// Tractions, averaged over the step.
    mean: Vec<f64>,
    trial: Solution,
    buffers: NewtonBuffers,
}

impl FrictionContact {
    /// The contact of a builder with a limit of friction. Its steps are linear in time
    /// ([`TimeRule::ExponentialLinear`]): slip begins and ends in kinks.
    ///
    /// # Errors
    /// As [`Builder::build`]; if the response of the bodies along the surface is not covered;
    /// [`Error::NotCovered`] of several bodies, attraction, ranks, and grids that are fixed to the indenter.
    pub fn new(mut builder: Builder, limit: impl FrictionLimit + 'static) -> Result<FrictionContact> {
        builder.is_covered(Special::Friction)?;
        builder.settings = builder.settings.with_time_rule(TimeRule::ExponentialLinear);
        let normal = builder.build()?;
        let material = &normal.scene.material;
        let ratios: Vec<_> = material.poisson_ratios().collect();
        let poisson = ratios[0].ok_or_else(other_bodies)?;
        let is_uncoupled = ratios.iter().all(|ratio| *ratio == Some(0.5)) || ratios.len() == 2 && material.is_pair()?;
        if !is_uncoupled {
            return Err(other_bodies());
        }
        let response = TangentialResponse::new(&normal.scene.ground.kernel, poisson)?;
        Ok(FrictionContact {
            start: normal.snapshot(),
            state: State::new(normal.computation.state.history.rule()),
            // of no use before bodies touch
            kernel: TangentialKernel::new(&response, [1; 2]),
            step: StepFields::default(),
            tolerance: normal.settings().tolerance,
            normal,
            limit: Arc::new(limit),
            response,
            unresolved: 0.0,
            least: [0.0; 3],
            loads_along: None,
            saved_run: None,
        })
    }

    /// Advances by `dt` \[s\] to a load, and to what acts along the surface; `dt` = 0 is a jump. What a step meets
    /// slips from its entry on: a step in which both loads rise together is oblique loading, which sticks if Q < f P:
    /// all of it at ν = 0 and in line contact, else as steps grow shorter. To press first and then to shear takes two
    /// steps, of no time if it happens at once.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`]; if the tractions are not found, a number is not finite, or the limit returns
    /// a negative number or none. The contact is then as it was.
    pub fn step(&mut self, dt: f64, load: Load, shear: ShearLoad) -> Result<Outcome> {
        self.step_unless(&AtomicBool::new(false), dt, load, shear)
    }

    /// [`FrictionContact::step`], ended within an iteration where another thread sets `cancelled`.
    ///
    /// # Errors
    /// As [`FrictionContact::step`], and [`Error::Cancelled`].
    pub fn step_unless(&mut self, cancelled: &AtomicBool, dt: f64, load: Load, shear: ShearLoad) -> Result<Outcome> {
        let to = (self.normal.time() + dt, dt);
        let outcome = self.advance(cancelled, to, load, shear, self.normal.settings().tolerance)?;
        self.saved_run = None; // a run that a file held does not know of it
        Ok(outcome)
    }

    /// Takes a step to a time, of this length, that is solved to a tolerance.
    pub(super) fn advance(
        &mut self,
        cancelled: &AtomicBool,
        (time, dt): (f64, f64),
        load: Load,
        shear: ShearLoad,
        tolerance: f64,
    ) -> Result<Outcome> {
        shear.validate()?;
        let normal = &mut self.normal;
        normal.snapshot_into(&mut self.start);
        let loads = [load];
        let step = Step { cancelled: Some(cancelled), tolerance, ..normal.plan_next_step(time, dt, &loads)? };
        validate_loads(&normal.scene.ground, step.request())?;
        let length = step.interval.dt;
        let report = normal.take(step)?;
        let cells = self.normal.grid().len();
        let outcome = in_pool(cells, || self.shear_to(cancelled, length, shear, report, tolerance));
        if !matches!(outcome, Ok(Outcome::Holds(_))) {
            self.normal.restore(&self.start)?;
        }
        outcome
    }

    /// Takes the step along the surface, after that of the normal contact.
    fn shear_to(
        &mut self,
        cancelled: &AtomicBool,
        dt: f64,
        shear: ShearLoad,
        normal: StepReport,
        tolerance: f64,
    ) -> Result<Outcome> {
        self.cover_contact();
        self.find_bounds_and_shares()?;
        let FrictionContact { kernel, state, step, .. } = self;
        let State { history, solution, motion, region, .. } = state;
        let StepFields { places, bound, entered, drift, free, mean, trial, buffers } = step;
        let (time, cells) = (normal.time, region.len());
        let area = self.normal.grid().cell_area();
        history.predict(dt, Interpolant::Linear, free);
        let compliance = history.rule().compliance();
        kernel.applications = [0; 2];
        // K (U_old − U_before), less the motion that is prescribed
        trial.gradient.iter_mut().zip(&*free).zip(history.displacements()).for_each(|((d, free), now)| *d = free - now);
        kernel.apply(&trial.gradient, drift);
        let (forces, given) = shear.prescribed(*motion);
        let wanted = forces.map(|force| force.map(|force| force / area));
        take_motion(drift, 0..cells, entered, places, given);
        let side = self.response.self_influence();
        let problem = Problem { self_influence: side, compliance, bound, drift, places, entered, wanted, cancelled };
        let (factor, direction) = problem.load_factor();
        if problem.is_cancelled() {
            return Err(Error::Cancelled { what: "a step" });
        }
        if factor < 1.0 - ROUNDING {
            return Ok(Outcome::Slides { direction, over_limit: 1.0 / factor });
        }
        if compliance == 0.0 && cells > 0 {
            // a jump of bodies without elastic response: they part, or keep what they carry
            let is_met = problem.balance(problem.missing_loads(&solution.traction)) <= tolerance
                && (0..3).all(|k| given[k].abs() <= ROUNDING * motion[k].abs());
            match problem.touching().next() {
                None => state.release(given),
                Some(_) if is_met => {}
                _ => {
                    return Err(StepError::NoElasticResponse { time, what: "a jump of a contact with friction" }.into());
                }
            }
            return Ok(Outcome::Holds(FrictionReport {
                normal,
                iterations: 0,
                convolution_equivalents: 0.0,
                residual: 0.0,
            }));
        }
        trial.traction.copy_from_slice(&solution.traction);
        trial.cells.copy_from_slice(&solution.cells);
        let found = trial.find(&problem, kernel, tolerance, buffers);
        let (iterations, residual) = (found.iterations, found.residual);
        if !found.is_solved {
            if problem.is_cancelled() {
                return Err(Error::Cancelled { what: "a step" });
            }
            return Err(not_found(time, residual, tolerance, iterations));
        }
        let mut change = given;
        problem.driven().for_each(|k| change[k] = trial.motion[k]);
        for k in 0..3 {
            motion[k] = if let Component::Motion(to) = shear.components[k] { to } else { motion[k] + change[k] };
            state.force[k] = area * problem.carried(k, &trial.traction);
        }
        // what parts slips as its traction falls
        let parting = (0..cells).filter(|&i| bound[i] == 0.0 && solution.cells[i] != Cell::Apart);
        problem.gradient(parting, &buffers.stress, trial.motion, &mut trial.gradient);
        free.iter_mut().zip(&trial.traction).for_each(|(u, traction)| *u += compliance * traction);
        history.mean_stress(free, mean);
        let works = problem.works(solution, trial, given, mean, &buffers.stress);
        state.work.iter_mut().zip(works).for_each(|(work, of_step)| *work += area * of_step);
        state.load_share = 1.0 / factor;
        // beside what friction could cause
        let (carried, count) = (problem.reach(0), problem.touching().count().max(1) as f64);
        let could = [compliance * side * carried / count.sqrt(), area * carried];
        let arm = self.normal.fields().contact_area().sqrt();
        let now = [size(*motion, arm), size(state.force, arm.recip())];
        (0..2).for_each(|k| state.largest[k] = state.largest[k].max(now[k]).max(NEWTON.negligible * could[k]));
        history.commit(free, &[]);
        std::mem::swap(solution, trial);
        let convolution_equivalents = kernel.equivalents(self.normal.grid().cells());
        Ok(Outcome::Holds(FrictionReport { normal, iterations, convolution_equivalents, residual }))
    }

    /// Lets the rectangle cover the contact.
    fn cover_contact(&mut self) {
        let grid = self.normal.grid();
        let Some(touching) = extent(self.normal.pressure(), grid.cells()[1]) else { return };
        let grown = self.state.region.grown_to(touching, grid, self.response.periodic());
        if grown != self.state.region {
            self.state.grow_to(grown);
            self.fit_to_region();
        }
    }

    /// Makes what belongs to the rectangle.
    pub(super) fn fit_to_region(&mut self) {
        let (grid, region) = (self.normal.grid(), self.state.region);
        let ([_, columns], n) = (grid.cells(), region.len());
        let StepFields { places, bound, entered, drift, free, mean, trial, buffers } = &mut self.step;
        if n > 0 {
            self.kernel = TangentialKernel::new(&self.response, region.cells);
        }
        *places = region.on_grid(columns).map(|k| grid.center(k / columns, k % columns)).collect();
        [bound, entered].into_iter().for_each(|field| field.resize(n, 0.0));
        [drift, free, mean].into_iter().for_each(|field| field.resize(2 * n, 0.0));
        trial.resize(n);
        buffers.resize(n);
    }

    /// Finds the bounds, and the share of the step for which each cell is in contact.
    fn find_bounds_and_shares(&mut self) -> Result<()> {
        let StepFields { places, bound, entered, .. } = &mut self.step;
        let ([_, columns], pressure, region) = (self.normal.grid().cells(), self.normal.pressure(), self.state.region);
        let normal = &self.normal.computation.state;
        let (Held { region: computed, indenter, current, .. }, before) = (&normal.held, &normal.previous);
        let (initial, [start, end]) = (indenter.gap(), [before, current].map(|state| state.motions[0]));
        // by how much the body came nearer at a place
        let change = end - start;
        let closed = |k: usize| change.at(places[k]).max(f64::MIN_POSITIVE);
        // the gap before the step; what is not computed is not met
        let lowered = RigidMotion { approach: start.approach - initial.datum, tilt: start.tilt };
        let gap = |k: usize, at: usize| {
            let own = computed.find([at / columns, at % columns]);
            own.map_or(f64::INFINITY, |own| {
                initial.above[at] + normal.history.tried_displacement()[own] - lowered.at(places[k])
            })
        };
        // bodies that were apart touch first where their gap less what closes it is least
        let was_apart = before.solution.pressure.iter().all(|p| *p == 0.0);
        let touched = if was_apart {
            let left = region.on_grid(columns).enumerate().map(|(k, at)| gap(k, at) / closed(k));
            left.fold(f64::INFINITY, f64::min).clamp(0.0, 1.0)
        } else {
            0.0
        };
        for (k, at) in region.on_grid(columns).enumerate() {
            let p = pressure[at];
            bound[k] = if p > 0.0 { self.limit.limit(p) } else { 0.0 };
            if !(0.0..=LARGEST).contains(&bound[k]) {
                return Err(not_a_limit(bound[k]));
            }
            let waited = (gap(k, at).max(0.0) / closed(k) - touched) / (1.0 - touched);
            let is_met = p > 0.0 && self.state.solution.cells[k] == Cell::Apart;
            entered[k] = if is_met { 1.0 - waited.clamp(0.0, 1.0) } else { 1.0 };
        }
        Ok(())
    }

    /// The contact in the normal direction.
    pub fn normal(&self) -> &ViscoelasticContact {
        &self.normal
    }

    /// How far the body has moved along x1 and x2 \[m\] and turned \[rad\].
    pub fn motion(&self) -> [f64; 3] {
        self.state.motion
    }

    /// Forces along x1 and x2 \[N\] and torque \[N m\] that act on it.
    pub fn force(&self) -> [f64; 3] {
        self.state.force
    }

    /// The part of what friction can carry that the forces prescribed in the last step take: the body slides beyond 1.
    /// 0 where motions are prescribed alone.
    pub fn load_share(&self) -> f64 {
        self.state.load_share
    }

    /// Number of cells that stick.
    pub fn stick_cells(&self) -> usize {
        self.state.solution.cells.iter().filter(|cell| **cell == Cell::Stick).count()
    }

    /// Tractions along x1 and x2 \[Pa\], one value for each cell of the grid.
    pub fn traction(&self) -> [Vec<f64>; 2] {
        self.whole(&self.state.solution.traction, 1.0)
    }

    /// Slip of the body over the surface in the last step along x1 and x2 \[m\]; 0 where bodies are apart.
    pub fn slip(&self) -> [Vec<f64>; 2] {
        self.whole(&self.state.solution.gradient, -1.0)
    }

    /// Which cells stick.
    pub fn sticks(&self) -> Vec<bool> {
        let mut sticks = vec![false; self.normal.grid().len()];
        let cells = self.state.region.on_grid(self.normal.grid().cells()[1]).zip(&self.state.solution.cells);
        cells.for_each(|(at, cell)| sticks[at] = *cell == Cell::Stick);
        sticks
    }

    fn whole(&self, field: &[f64], factor: f64) -> [Vec<f64>; 2] {
        let n = self.state.region.len();
        [0, n].map(|start| {
            let mut whole = vec![0.0; self.normal.grid().len()];
            let cells = self.state.region.on_grid(self.normal.grid().cells()[1]).zip(&field[start..]);
            cells.for_each(|(at, value)| whole[at] = factor * value);
            whole
        })
    }
}

fn not_a_limit(value: f64) -> Error {
    let cause = format!("it returned {value} Pa where a number between 0 and 1e100 is needed");
    UserError::new("a limit of friction", cause).into()
}
