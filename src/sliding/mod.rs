//! Steady sliding and rolling as one contact problem for each velocity.
//!
//! In the frame of an indenter that moves steadily over creeping bodies nothing changes, and no time step is needed:
//! a wave of the pressure displaces by the compliance of the bodies at the frequency at which it passes a point.
//! [`SteadySliding`] finds the one state of contact of a velocity and a load, however long the relaxation times are.
//! To step there ([`ViscoelasticContact::step_over`](crate::ViscoelasticContact::step_over)) takes as many steps as the
//! longest of them.
//!
//! All friction comes from hysteresis: the surfaces have none.

mod bodies;
mod build;
mod coefficients;
mod contact_problem;
mod coverage;
mod creep;
mod csv;
mod gmres;
mod operator;
mod report;
mod search;
mod sweep;

pub use crate::motion::CounterMotion;
pub use report::SlidingReport;
pub use sweep::{SlidingSweep, SlidingTable, SweptState};

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contact::{Edge, Figures, Scene, Warnings};
use crate::equilibrium::constraints::{find_free_motions, validate_loads};
use crate::equilibrium::pressed::Pressed;
use crate::equilibrium::{Held, Request, Trial};
use crate::error::{Error, Refusal, Result, StepError, finite};
use crate::fields::{About, Fields, Surface, View};
use crate::load::Load;
use crate::rounded::rounded;
use crate::solver::{Freedom, RigidMotion};
use bodies::Bodies;
use contact_problem::{FoundMotion, SlidingProblem};
use operator::MovingBodies;

/// A contact that moves steadily over creeping bodies, made by
/// [`Builder::build_sliding`](crate::contact::Builder::build_sliding).
///
/// ```
/// use viscocontact::prelude::*;
///
/// // a wavy indenter of 1 mm period slides over a rubber
/// let grid = Grid::square(64, 1.0e-3)?;
/// let shape = FnGeometry::new(|x1, x2| 4.0e-6 * (2.0 - (6283.2 * x1).cos() - (6283.2 * x2).cos()));
/// let rubber = GeneralizedMaxwell::new(1.0e6, &[(1.0e7, 1.0e-5), (1.0e7, 1.0e-3), (3.0e6, 0.1)])?;
/// let mut sliding = ViscoelasticContact::builder(grid.clone())
///     .geometry(&shape)
///     .material(Material::incompressible(rubber))
///     .kernel(InfluenceKernel::periodic(&grid)?)
///     .build_sliding()?;
/// for speed in [1.0e-4, 1.0e-2, 1.0, 1.0e2, 1.0e4] {
///     let report = sliding.at([speed, 0.0], Load::force(0.02))?;
///     println!("{report}");
///     assert!(report.friction() > 0.0);
/// }
/// assert!(sliding.fields().contact_area() < 1.0e-6);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SteadySliding {
    scene: Arc<Scene>,
    /// The state found last.
    held: Held,
    displacement: Vec<f64>,
    view: View,
    bodies: Arc<Bodies>,
    cancelled: Option<Arc<AtomicBool>>,
}

/// A state warns where waves that hold a greater part of its energy pass at frequencies at which
/// the material was not measured.
const UNMEASURED: f64 = 0.1;
/// A drag that drives by less than this part of what it is summed from is rounding.
const ROUNDING: f64 = 1e-9;

/// The drag along each axis of bodies that dissipate \[N/m²\], for a pressure with this `spectrum`:
/// negative by rounding it is 0.
///
/// # Errors
/// If the bodies drive by more than rounding: influences that are sampled at cells longer than what
/// they resolve.
fn passive_drag(bodies: &MovingBodies, spectrum: &[f64], velocity: [f64; 2]) -> Result<[f64; 2]> {
    let drag = bodies.drag(spectrum, |loss| loss);
    let most = velocity[0].abs().max(velocity[1].abs()).max(f64::MIN_POSITIVE);
    let along = velocity.map(|v| v / most);
    let power = drag[0] * along[0] + drag[1] * along[1];
    if power >= 0.0 {
        return Ok(drag);
    }
    let size = bodies.drag(spectrum, f64::abs);
    let part = -power / (size[0] * along[0].abs() + size[1] * along[1].abs());
    if part <= ROUNDING {
        let driving = power / (along[0] * along[0] + along[1] * along[1]);
        return Ok([0, 1].map(|axis| drag[axis] - driving * along[axis]));
    }
    let what = format!(
        "{} the bodies would drive the motion, by {} of the sum of what their waves resist and drive with: cells \
         longer than a layer is thick do not resolve its losses",
        at_velocity(velocity),
        rounded(part, 3)
    );
    Err(Refusal::search("sliding_drives", what, ": refine the mesh").naming("part of the power").valued(part).into())
}

fn at_velocity(velocity: [f64; 2]) -> String {
    format!("at a velocity of ({}, {}) m/s", rounded(velocity[0], 5), rounded(velocity[1], 5))
}

impl SteadySliding {
    /// Finds the state of contact under `load`, a force or an approach, of the indenter that moves over the bodies
    /// with `velocity` \[m/s\] along x1 and x2. At velocity 0 it is the relaxed contact, at a great one the one of
    /// the elastic response. The search begins at the state found last, so that sweeps over velocities or loads cost
    /// less.
    ///
    /// Another temperature is the same as the velocity times its shift factor
    /// ([`TimeTemperature::shift_factor`](crate::rheology::TimeTemperature::shift_factor)).
    ///
    /// # Errors
    /// If the velocity is not finite, or follows neither axis of a half-space; if the load is a
    /// spring, cannot be balanced, tilts a periodic body, or is an approach beyond full contact, or
    /// one in line contact whose datum is too near; if a modulus does not resist or gives energy
    /// away, or the bodies drive the motion; if contact reaches the edge of the grid, or the state is not
    /// found or lost in rounding, or another thread ends the search. The state found last is then kept.
    pub fn at(&mut self, velocity: [f64; 2], load: Load) -> Result<SlidingReport> {
        finite("velocity along x1", velocity[0])?;
        finite("velocity along x2", velocity[1])?;
        coverage::SPRING.refuse_if(|_| matches!(load, Load::Spring { .. }))?;
        let (free, lowered) = self.freedom(load)?;
        let mut bodies = self.moving(velocity, load)?;
        let ground = &self.scene.ground;
        let (grid, tolerance) = (ground.grid.clone(), ground.settings.tolerance);
        let (gap, n2) = (self.held.indenter.gap(), grid.cells()[1]);
        let datum = gap.datum;
        let lower = |(k, height): (usize, &f64)| height - lowered.at(grid.center(k / n2, k % n2));
        let heights: Vec<f64> = gap.above.iter().enumerate().map(lower).collect();
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        if !free.translation && mean <= 0.0 && ground.kernel.mean_is_held() {
            let approach = lowered.approach + datum;
            return Err(Error::Step(StepError::BeyondFullContact { time: 0.0, approach, maximum: approach + mean }));
        }
        let cancelled = self.cancelled.as_deref();
        let problem = SlidingProblem { grid: &grid, gap: &heights, free, tolerance, cancelled };
        let found = if free.translation && free.total == 0.0 {
            FoundMotion::apart(heights.len())
        } else {
            problem.search(&mut bodies, &self.held.current.solution.pressure)
        };
        let FoundMotion { pressure, mut displacement, mut motion, residual, rounding, sets, converged } = found;
        if problem.is_cancelled() {
            return Err(Error::Cancelled { what: "a steady motion" });
        }
        if !converged && rounding > tolerance {
            let what = format!(
                "{} the rounding of the displacement is {rounding:.1e} of the gap that the contact closes, where \
                 {tolerance:.1e} is allowed",
                at_velocity(velocity)
            );
            let remedy = ": take a lower velocity, bodies that creep less, or a greater Settings::tolerance";
            return Err(Refusal::search("sliding_rounding", what, remedy).into());
        }
        if !converged {
            let what = format!(
                "{} {sets} sets of cells left a residual of {residual:.1e}, where {tolerance:.1e} is allowed",
                at_velocity(velocity)
            );
            let remedy = ": come from a velocity nearby, or allow a greater Settings::tolerance";
            return Err(Refusal::search("sliding_not_converged", what, remedy).into());
        }
        self.check_edge(&pressure)?;
        let (cell_area, transforms) = (grid.cell_area(), bodies.transforms);
        let spectrum = bodies.spectrum(&pressure);
        let lateral_force = passive_drag(&bodies, &spectrum, velocity)?.map(|force| force * cell_area);
        let unmeasured =
            bodies.unmeasured(&spectrum, velocity, grid.spacing(), (self.bodies.measured, self.bodies.relaxed));
        let excess = self.bodies.excess(velocity, cell_area * pressure.iter().sum::<f64>());
        displacement.iter_mut().for_each(|u| *u -= excess);
        motion.approach -= excess;
        let motion = RigidMotion { approach: datum, tilt: [0.0; 2] } + lowered + motion;
        let (mut warnings, mut figures) = self.take(load, motion, pressure, displacement);
        figures.unmeasured = Some(unmeasured.max(self.bodies.unmeasured_at_rest)).filter(|part| *part > UNMEASURED);
        warnings.set(Warnings::FREQUENCIES, figures.unmeasured.is_some());
        let fields = self.fields();
        let gaps: Vec<f64> = fields.gap()?.into_iter().filter(|gap| gap.is_finite()).collect();
        Ok(SlidingReport {
            velocity,
            force: fields.force(),
            approach: motion.approach,
            lateral_force,
            contact_cells: fields.contact_cells(),
            contact_area: fields.contact_area(),
            mean_gap: gaps.iter().sum::<f64>() / gaps.len() as f64,
            residual,
            sets,
            transforms,
            warnings,
            figures,
        })
    }

    /// Lets another thread end the search under way in [`SteadySliding::at`], and the searches of a sweep, as
    /// [`Run::cancelled_by`](crate::run::Run::cancelled_by): the call ends in [`Error::Cancelled`], and the state
    /// found last is kept.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use std::sync::atomic::{AtomicBool, Ordering};
    ///
    /// use viscocontact::prelude::*;
    ///
    /// let cancel = Arc::new(AtomicBool::new(false));
    /// let mut sliding = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 0.01)?))
    ///     .build_sliding()?
    ///     .cancelled_by(Arc::clone(&cancel));
    /// sliding.at([0.1, 0.0], Load::force(0.5))?;
    /// cancel.store(true, Ordering::Relaxed); // by another thread
    /// assert!(matches!(sliding.at([0.2, 0.0], Load::force(0.5)), Err(Error::Cancelled { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    #[must_use]
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> SteadySliding {
        self.cancelled = Some(flag);
        self
    }

    /// The bodies under a pressure with this velocity, where a load has a steady state.
    fn moving(&self, velocity: [f64; 2], load: Load) -> Result<MovingBodies> {
        let (kernel, creep, forced) = (&self.scene.ground.kernel, &self.bodies.creep, load.is_force());
        let drifts = creep.fluidity() > 0.0 && !(forced && velocity != [0.0; 2]);
        coverage::DRIFT.refuse_if(|_| drifts)?;
        let bodies = self.bodies.moving(velocity)?;
        let (axis, lengths) = (self.bodies.axis(velocity).unwrap_or(0), self.scene.ground.grid.lengths());
        let speed = if kernel.periodic_axes()[axis] { 0.0 } else { velocity[axis].abs() };
        let farthest = creep.reaches(speed).into_iter().map(|(_, reach)| reach).fold(0.0, f64::max);
        let near = !forced && kernel.datum().is_some_and(|datum| datum < lengths[axis] + farthest);
        coverage::NEAR_DATUM.refuse_if(|_| near)?;
        Ok(bodies)
    }

    /// The fields of the state found last, to read, draw and write. Moduli over frequency have no material to tell of.
    pub fn fields(&self) -> Fields<'_> {
        let (Scene { ground, material, .. }, held) = (&*self.scene, &self.held);
        let surface = Surface { own: &self.displacement, far: None };
        let about = About { material: Some(material), ..About::default() };
        Fields { ground, held, surface, view: &self.view, kernel: None, about }
    }

    /// The motion that a load leaves free to the body, if it can be balanced, and the part that it prescribes, whose
    /// approach counts from the datum of the gap.
    fn freedom(&self, load: Load) -> Result<(Freedom, RigidMotion)> {
        let (ground, Held { indenter, region, .. }) = (&self.scene.ground, &self.held);
        let tolerance = ground.settings.tolerance;
        let request = Request { time: 0.0, length: 0.0, loads: &[load], indenter, tolerance, cancelled: None };
        validate_loads(ground, request)?;
        let mut free = [Trial::NOTHING_FREE];
        find_free_motions(ground, region, request, &mut free);
        Ok((free[0], request.prescribed(0)))
    }

    /// Rejects a pressure at an edge of the grid that is not periodic, unless the settings allow it.
    fn check_edge(&self, pressure: &[f64]) -> Result<()> {
        let ground = &self.scene.ground;
        let cells = self.held.region.positive_on_edge(pressure, ground.kernel.periodic_axes());
        if cells == 0 || ground.settings.edge == Edge::Allow {
            return Ok(());
        }
        let lengths = ground.grid.lengths();
        Err(Error::Step(StepError::ContactAtEdge { time: 0.0, cells, lengths, needed: None }))
    }

    /// Makes a state the one found last; returns its warnings.
    fn take(
        &mut self,
        load: Load,
        motion: RigidMotion,
        pressure: Vec<f64>,
        displacement: Vec<f64>,
    ) -> (Warnings, Figures) {
        let (Scene { ground, limits, .. }, held) = (&*self.scene, &mut self.held);
        (held.loads[0], held.current.motions[0], self.displacement) = (load, motion, displacement);
        held.current.solution.pressure = pressure;
        let pressed = Pressed::by(&held.current.solution.pressure, ground, &held.region, &held.indenter);
        held.current.contact_cells = pressed.cells;
        held.sum_up();
        self.view.refresh(held);
        let figures = Figures { modulus: limits.modulus, ..held.figures(ground, &pressed) };
        (held.warnings(ground, pressed.reach, &figures) | limits.warnings(0.0, 0.0), figures)
    }

    /// Scales the pressure to that under `load`, of a body with moduli `factor` times as great.
    fn scale(&mut self, load: Load, factor: f64) {
        if factor != 1.0 {
            self.held.loads[0] = load;
            self.held.current.solution.pressure.iter_mut().for_each(|p| *p *= factor);
            self.held.sum_up();
            self.view.refresh(&self.held);
        }
    }
}
