//! A contact with friction, step by step.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contact::{Builder, Snapshot, StepError, StepReport, TimeRule, ViscoelasticContact};
use crate::error::{Error, FrictionError, Result, Special, UserError};
use crate::friction::history::ShearHistory;
use crate::friction::kernel::{TangentialKernel, TangentialResponse};
use crate::friction::limit::FrictionLimit;
use crate::friction::load::{Component, LARGEST, ShearLoad};
use crate::friction::newton::{NEGLIGIBLE, Work};
use crate::friction::problem::{Cell, Problem, Solution, take_motion};
use crate::friction::region::{Rectangle, extent};
use crate::friction::report::{FrictionReport, Outcome};
use crate::hereditary::{GroupHistory, Interpolant};
use crate::load::Load;
use crate::solver::RigidMotion;

/// Loads beyond what friction carries by less than this part are carried: rounding.
const ROUNDING: f64 = 1e-9;

/// The most accurate solver of a run.
const MOST_ACCURATE: f64 = 1e-11;

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
#[derive(Debug, Clone)]
pub struct FrictionContact {
    normal: ViscoelasticContact,
    /// The normal contact before the step being tried.
    start: Snapshot,
    limit: Arc<dyn FrictionLimit>,
    response: TangentialResponse,
    kernel: TangentialKernel,
    region: Rectangle,
    /// The past of U, of which K U is the displacement along the surface; both components one after the other.
    history: GroupHistory,
    /// Of the last step.
    solution: Solution,
    step: StepFields,
    motion: [f64; 3],
    force: [f64; 3],
    work: [f64; 2],
    /// The part of what friction carries that the prescribed forces take.
    load_share: f64,
    /// Maximum of the motion and of the force so far.
    pub(super) largest: [f64; 2],
    /// Differences between outcomes of a step, over that maximum, that a run does not resolve.
    pub(super) unresolved: f64,
    pub(super) history_along: Option<ShearHistory>,
}

/// What a step needs, on the rectangle but for the gap.
#[derive(Debug, Clone, Default)]
struct StepFields {
    /// The gap before the step, on the whole grid.
    gap: Vec<f64>,
    places: Vec<[f64; 2]>,
    bound: Vec<f64>,
    entered: Vec<f64>,
    drift: Vec<f64>,
    free: Vec<f64>,
    trial: Solution,
    work: Work,
}

impl FrictionContact {
    /// The contact of a builder with a limit of friction. Its steps are linear in time
    /// ([`TimeRule::ExponentialLinear`]): slip begins and ends in kinks.
    ///
    /// # Errors
    /// As [`Builder::build`]; [`FrictionError::OtherBodies`] of bodies whose response along the surface is not covered;
    /// [`Error::NotCovered`] of several bodies, attraction, ranks, and grids that are fixed to the indenter.
    pub fn new(mut builder: Builder, limit: impl FrictionLimit + 'static) -> Result<FrictionContact> {
        builder.is_covered(Special::Friction)?;
        builder.settings = builder.settings.with_time_rule(TimeRule::ExponentialLinear);
        let normal = builder.build()?;
        let material = &normal.scene.material;
        let ratios: Vec<_> = material.poisson_ratios().collect();
        let poisson = ratios[0].ok_or(FrictionError::OtherBodies)?;
        let is_uncoupled = ratios.iter().all(|ratio| *ratio == Some(0.5)) || ratios.len() == 2 && material.is_pair()?;
        if !is_uncoupled {
            return Err(FrictionError::OtherBodies.into());
        }
        let response = TangentialResponse::new(&normal.scene.ground.kernel, poisson)?;
        Ok(FrictionContact {
            start: normal.snapshot(),
            history: GroupHistory::new(normal.computation.state.history.rule().clone(), 0),
            // of no use before bodies touch
            kernel: TangentialKernel::new(&response, [1; 2]),
            region: Rectangle { start: [0; 2], cells: [0; 2] },
            step: StepFields { gap: vec![0.0; normal.grid().len()], ..StepFields::default() },
            normal,
            limit: Arc::new(limit),
            response,
            solution: Solution::default(),
            motion: [0.0; 3],
            force: [0.0; 3],
            work: [0.0; 2],
            load_share: 0.0,
            largest: [0.0; 2],
            unresolved: 0.0,
            history_along: None,
        })
    }

    /// Advances by `dt` \[s\] to a load, and to what acts along the surface; `dt` = 0 is a jump. What a step meets
    /// slips from its entry on: a step in which both loads rise together is oblique loading, all of which sticks if
    /// Q < f P. To press first and then to shear takes two steps, of no time if it happens at once.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`]; [`FrictionError::NotConverged`]; if a number is not finite, or the limit returns
    /// a negative number or none. The contact is then as it was.
    pub fn step(&mut self, dt: f64, load: Load, shear: ShearLoad) -> Result<Outcome> {
        self.step_unless(&AtomicBool::new(false), dt, load, shear)
    }

    /// [`FrictionContact::step`], ended within an iteration where another thread sets `cancelled`.
    ///
    /// # Errors
    /// As [`FrictionContact::step`], and [`Error::Cancelled`].
    pub fn step_unless(&mut self, cancelled: &AtomicBool, dt: f64, load: Load, shear: ShearLoad) -> Result<Outcome> {
        shear.validate()?;
        self.normal.snapshot_into(&mut self.start);
        self.normal.fields().gap_into(&mut self.step.gap)?;
        let (approach, reduced) = (self.placed(), self.normal.reduced_time());
        let is_first = self.normal.contact_cells() == 0;
        let normal = self.normal.step_unless(cancelled, dt, load)?;
        let change = self.placed() - approach;
        let met = |k: [f64; 2]| change.at(k);
        let outcome = self.shear_to(
            cancelled,
            if dt == 0.0 { 0.0 } else { self.normal.reduced_time() - reduced },
            shear,
            normal,
            is_first,
            &met,
        );
        if !matches!(outcome, Ok(Outcome::Holds(_))) {
            self.normal.restore(&self.start)?;
        }
        outcome
    }

    /// Where the body is.
    fn placed(&self) -> RigidMotion {
        self.normal.computation.state.held.current.motions[0]
    }

    /// Solves further steps to this tolerance, if it is less than that of the settings.
    pub(super) fn solve_to(&mut self, tolerance: f64) {
        let settings = &mut Arc::make_mut(&mut self.normal.scene).ground.settings;
        settings.tolerance = settings.tolerance.min(tolerance.max(MOST_ACCURATE));
    }

    /// Takes the step along the surface, after that of the normal contact; `closed` tells by how much the body came
    /// nearer at a place.
    fn shear_to(
        &mut self,
        cancelled: &AtomicBool,
        dt: f64,
        shear: ShearLoad,
        normal: StepReport,
        is_first: bool,
        closed: &dyn Fn([f64; 2]) -> f64,
    ) -> Result<Outcome> {
        self.cover_contact();
        self.bind(is_first, closed)?;
        let FrictionContact { kernel, history, solution, step, motion, region, .. } = self;
        let StepFields { places, bound, entered, drift, free, trial, work, .. } = step;
        let (time, cells) = (normal.time, region.len());
        let area = self.normal.grid().cell_area();
        history.predict(dt, Interpolant::Linear, free);
        let compliance = history.rule().compliance();
        if compliance == 0.0 && cells > 0 {
            return Err(StepError::NoElasticResponse { time, what: "a jump of a contact with friction" }.into());
        }
        kernel.applications = [0; 2];
        // K (U_old − U_before), less the motion that is prescribed
        trial.gradient.iter_mut().zip(&*free).zip(history.displacements()).for_each(|((d, free), now)| *d = free - now);
        kernel.apply(&trial.gradient, drift);
        let mut wanted = [None; 3];
        let mut given = [0.0; 3];
        for (k, component) in shear.components.iter().enumerate() {
            match *component {
                Component::Force(force) => wanted[k] = Some(force / area),
                Component::Motion(to) => given[k] = to - motion[k],
            }
        }
        take_motion(drift, 0..cells, entered, places, given);
        let side = self.response.self_influence();
        let problem = Problem { side, compliance, bound, drift, places, entered, wanted, cancelled };
        let (factor, direction) = problem.load_factor();
        if problem.is_cancelled() {
            return Err(Error::Cancelled { what: "a step" });
        }
        if factor < 1.0 - ROUNDING {
            return Ok(Outcome::Slides { direction, over_limit: 1.0 / factor });
        }
        let tolerance = self.normal.settings().tolerance;
        trial.traction.copy_from_slice(&solution.traction);
        trial.cells.copy_from_slice(&solution.cells);
        let found = trial.find(&problem, kernel, tolerance, work);
        let (iterations, residual) = (found.iterations, found.residual);
        if !found.is_solved {
            if problem.is_cancelled() {
                return Err(Error::Cancelled { what: "a step" });
            }
            return Err(FrictionError::NotConverged { time, iterations, residual, tolerance }.into());
        }
        let mut change = given;
        problem.driven().for_each(|k| change[k] = trial.motion[k]);
        let before = self.force;
        for k in 0..3 {
            motion[k] = if let Component::Motion(to) = shear.components[k] { to } else { motion[k] + change[k] };
            self.force[k] = area * problem.carried(k, &trial.traction);
            self.work[0] += 0.5 * (before[k] + self.force[k]) * change[k];
        }
        self.load_share = 1.0 / factor;
        // what friction could cause
        let (carried, count) = (problem.reach(0), problem.touching().count().max(1) as f64);
        let could = [compliance * side * carried / count.sqrt(), area * carried];
        let arm = self.normal.fields().contact_area().sqrt();
        let now = [size(*motion, arm), size(self.force, arm.recip())];
        for k in 0..2 {
            self.largest[k] = self.largest[k].max(now[k]).max(NEGLIGIBLE * could[k]);
        }
        let mean = trial.traction.iter().zip(&solution.traction).zip(&trial.gradient);
        self.work[1] -= area * mean.map(|((now, before), g)| 0.5 * (now + before) * g).sum::<f64>();
        free.iter_mut().zip(&trial.traction).for_each(|(u, traction)| *u += compliance * traction);
        history.commit(free, &[]);
        std::mem::swap(solution, trial);
        let convolution_equivalents = kernel.equivalents(self.normal.grid().cells());
        Ok(Outcome::Holds(Box::new(FrictionReport { normal, iterations, convolution_equivalents, residual })))
    }

    /// Lets the rectangle cover the contact.
    fn cover_contact(&mut self) {
        let grid = self.normal.grid().clone();
        let Some(touching) = extent(self.normal.pressure(), grid.cells()[1]) else { return };
        let grown = self.region.grown_to(touching, &grid, self.response.periodic());
        if grown == self.region {
            return;
        }
        let (old, n) = (self.region, grown.len());
        let places: Vec<Option<usize>> = old.places_of(&grown).collect();
        let moved = |k: usize| places[k % n].map(|place| place + k / n * old.len());
        self.history.rearrange(2 * n, moved);
        let traction = (0..2 * n).map(|k| moved(k).map_or(0.0, |k| self.solution.traction[k])).collect();
        let gradient = (0..2 * n).map(|k| moved(k).map_or(0.0, |k| self.solution.gradient[k])).collect();
        let cells = places.iter().map(|place| place.map_or(Cell::Apart, |k| self.solution.cells[k])).collect();
        (self.solution.traction, self.solution.gradient, self.solution.cells) = (traction, gradient, cells);
        self.region = grown;
        self.kernel = TangentialKernel::new(&self.response, grown.cells);
        let StepFields { places, bound, entered, drift, free, trial, work, .. } = &mut self.step;
        *places =
            grown.on_grid(grid.cells()[1]).map(|k| grid.center(k / grid.cells()[1], k % grid.cells()[1])).collect();
        [bound, entered].into_iter().for_each(|field| field.resize(n, 0.0));
        [drift, free].into_iter().for_each(|field| field.resize(2 * n, 0.0));
        trial.resize(n);
        work.resize(n);
    }

    /// Finds the bounds, and the share of the step for which each cell is in contact.
    fn bind(&mut self, is_first: bool, closed: &dyn Fn([f64; 2]) -> f64) -> Result<()> {
        let StepFields { gap, places, bound, entered, .. } = &mut self.step;
        let (columns, pressure) = (self.normal.grid().cells()[1], self.normal.pressure());
        // bodies that were apart touch first where their gap less what closes it is least
        let touched = if is_first {
            let reach = |k: usize| closed(places[k]).max(f64::MIN_POSITIVE);
            let left = self.region.on_grid(columns).enumerate().map(|(k, at)| gap[at] / reach(k));
            left.fold(f64::INFINITY, f64::min).clamp(0.0, 1.0)
        } else {
            0.0
        };
        for (k, at) in self.region.on_grid(columns).enumerate() {
            let p = pressure[at];
            bound[k] = if p > 0.0 { self.limit.limit(p) } else { 0.0 };
            if !(0.0..=LARGEST).contains(&bound[k]) {
                return Err(not_a_limit(bound[k]));
            }
            let waited = (gap[at].max(0.0) / closed(places[k]).max(f64::MIN_POSITIVE) - touched) / (1.0 - touched);
            let is_met = p > 0.0 && self.solution.cells[k] == Cell::Apart;
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
        self.motion
    }

    /// Forces along x1 and x2 \[N\] and torque \[N m\] that act on it.
    pub fn force(&self) -> [f64; 3] {
        self.force
    }

    /// The work done along the surface, and the part of it that slip has dissipated \[J\].
    pub fn work(&self) -> [f64; 2] {
        self.work
    }

    /// The part of what friction can carry that the forces prescribed in the last step take: the body slides beyond 1.
    /// 0 where motions are prescribed alone.
    pub fn load_share(&self) -> f64 {
        self.load_share
    }

    /// Number of cells that stick.
    pub fn stick_cells(&self) -> usize {
        self.solution.cells.iter().filter(|cell| **cell == Cell::Stick).count()
    }

    /// Tractions along x1 and x2 \[Pa\], one value for each cell of the grid.
    pub fn traction(&self) -> [Vec<f64>; 2] {
        self.whole(&self.solution.traction, 1.0)
    }

    /// Slip of the body over the surface in the last step along x1 and x2 \[m\]; 0 where bodies are apart.
    pub fn slip(&self) -> [Vec<f64>; 2] {
        self.whole(&self.solution.gradient, -1.0)
    }

    /// Which cells stick.
    pub fn sticks(&self) -> Vec<bool> {
        let mut sticks = vec![false; self.normal.grid().len()];
        let cells = self.region.on_grid(self.normal.grid().cells()[1]).zip(&self.solution.cells);
        cells.for_each(|(at, cell)| sticks[at] = *cell == Cell::Stick);
        sticks
    }

    fn whole(&self, field: &[f64], factor: f64) -> [Vec<f64>; 2] {
        let n = self.region.len();
        [0, n].map(|start| {
            let mut whole = vec![0.0; self.normal.grid().len()];
            let cells = self.region.on_grid(self.normal.grid().cells()[1]).zip(&field[start..]);
            cells.for_each(|(at, value)| whole[at] = factor * value);
            whole
        })
    }
}

/// A motion as a length, or a force: angles times the arm, torques over it; nothing of bodies without contact.
pub(super) fn size(of: [f64; 3], arm: f64) -> f64 {
    of[0].hypot(of[1]).hypot(if arm.is_finite() { arm * of[2] } else { 0.0 })
}

fn not_a_limit(value: f64) -> Error {
    UserError::new(
        "a limit of friction",
        format!("it returned {value} Pa where a number between 0 and 1e100 is needed"),
    )
    .into()
}
