//! What a plan is made of.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;

use crate::axis::Axis;
use crate::contact::Stepping;
use crate::error::{Error, Result, positive};
use crate::geometry::Geometry;
use crate::load::LoadHistory;
use crate::observe::mesh_error::MeshError;
use crate::plan::convergence::{ConvergedRun, converge};
use crate::plan::domain::{Body, ContactSize, Side};
use crate::plan::error_law::ErrorLaw;
use crate::plan::trial_runs::TrialScene;
use crate::plan::{Accuracy, Plan};
use crate::rheology::{Material, TemperatureHistory};
use crate::{Grid, InfluenceKernel};

/// Most cells along a side of a plan: more exceed the memory of a workstation.
const MOST_PLANNED_CELLS: usize = 1 << 13;
/// Fewest cells across the widest contact: fewer do not resolve it.
const FEWEST_ACROSS: f64 = 14.0;

/// The scene of a [`Plan`] and what is asked of it, from [`Plan::builder`].
///
/// ```
/// use viscocontact::prelude::*;
/// use viscocontact::rheology::{TemperatureHistory, TimeTemperature};
///
/// let (sphere, load) = (Sphere::new(10.0e-3)?, StepLoad::new(Load::force(1.0))?);
/// let body = Material::incompressible(Zener::with_time(1.0e7, 1.0e6, 10.0)?);
/// let law = TimeTemperature::wlf(17.44, 51.6, 263.15)?;
/// let warming = TemperatureHistory::table(law, &[(0.0, 263.15), (100.0, 273.15)])?;
/// let plan = Plan::builder(&sphere, &body, &load, 100.0).accuracy(Accuracy::COARSE).temperature(&warming).build()?;
/// let mut contact = plan.builder.build()?;
/// let mut run = contact.follow(&load, plan.stepping, 100.0);
/// while run.next_step()?.is_some() {}
/// let exact = viscocontact::analytic::GrowingSphere::step(10.0e-3, &body, 1.0)?;
/// assert!((contact.approach() / exact.approach(contact.reduced_time()) - 1.0).abs() < 1e-2);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
#[must_use = "nothing is planned until it is built"]
pub struct PlanBuilder<'a> {
    geometry: &'a dyn Geometry,
    material: &'a Material,
    history: &'a dyn LoadHistory,
    until: f64,
    accuracy: Accuracy,
    temperature: Option<&'a TemperatureHistory>,
    area: bool,
    body: Body<'a>,
}

/// How far planning has come: the state of a coarse run.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PlanProgress {
    /// Number of steps of all coarse runs so far.
    pub steps: usize,
    /// Cells of the run.
    pub cells: [usize; 2],
    /// Time of the run \[s\].
    pub time: f64,
}

impl Plan {
    /// Plans a run of one body from rest to the time `until` \[s\], when built.
    pub fn builder<'a>(
        geometry: &'a dyn Geometry,
        material: &'a Material,
        history: &'a dyn LoadHistory,
        until: f64,
    ) -> PlanBuilder<'a> {
        let (accuracy, temperature, area, body) = (Accuracy::default(), None, false, Body::default());
        PlanBuilder { geometry, material, history, until, accuracy, temperature, area, body }
    }
}

impl<'a> PlanBuilder<'a> {
    /// The accuracy (default: [`Accuracy::STANDARD`]).
    pub fn accuracy(self, accuracy: Accuracy) -> PlanBuilder<'a> {
        PlanBuilder { accuracy, ..self }
    }

    /// A temperature that changes ([`Builder::temperature`](crate::contact::Builder::temperature)): the times of the
    /// plan and of the load are times, the body creeps in reduced time.
    pub fn temperature(self, temperature: &'a TemperatureHistory) -> PlanBuilder<'a> {
        PlanBuilder { temperature: Some(temperature), ..self }
    }

    /// Whether the mesh gives the contact radius, √(area/π), this accuracy too, at all times at which the contact is at least
    /// 8 cells across (default: no). The radius of a growing contact errs by a fraction of a cell.
    pub fn area(self, area: bool) -> PlanBuilder<'a> {
        PlanBuilder { area, ..self }
    }

    /// Another body than a half-space, by its kernel on a grid: the plan chooses the grid.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// // a gel of 2 mm on glass
    /// let layer = Layer::bonded_to_rigid(2.0e-3, 0.5)?;
    /// let on_glass = |grid: &Grid| InfluenceKernel::layer(grid, layer);
    /// let (sphere, load) = (Sphere::new(10.0e-3)?, StepLoad::new(Load::force(0.1))?);
    /// let gel = Material::incompressible(Zener::new(1.0e4, 1.0e4, 1.0e4)?);
    /// let plan = Plan::builder(&sphere, &gel, &load, 10.0).accuracy(Accuracy::COARSE).kernel(&on_glass).build()?;
    /// println!("{plan}");
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn kernel(self, kernel: &'a dyn Fn(&Grid) -> Result<InfluenceKernel>) -> PlanBuilder<'a> {
        PlanBuilder { body: Body { kernel: Some(kernel), ..self.body }, ..self }
    }

    /// A side of the domain that is a period of the body, of this length \[m\]. Other sides are as long as the contact needs.
    pub fn period(mut self, axis: Axis, length: f64) -> PlanBuilder<'a> {
        self.body.sides[usize::from(axis == Axis::X2)] = Side::Period(length);
        self
    }

    /// A line contact: one cell along x2, of this length \[m\], on which the force acts.
    pub fn line(mut self, length: f64) -> PlanBuilder<'a> {
        self.body.sides[1] = Side::Uniform(length);
        self
    }

    /// Plans the run.
    ///
    /// # Errors
    /// If the end of the run is not finite and positive, a part is invalid, no domain holds the contact, the coarse
    /// runs fail, or approach and force need more than 8192 cells along a side; for a temperature of the run as
    /// [`TimeTemperature::shift_factor`](crate::rheology::TimeTemperature::shift_factor).
    pub fn build(self) -> Result<Plan> {
        self.build_with(|_| ControlFlow::Continue(()))
    }

    /// As [`PlanBuilder::build`], calling `progress` after each step of a coarse run; it may end the planning. A step under way
    /// is not interrupted: coarse runs have few cells.
    ///
    /// # Errors
    /// As [`PlanBuilder::build`]; [`Error::Cancelled`] if `progress` ends it.
    pub fn build_with(self, progress: impl FnMut(PlanProgress) -> ControlFlow<()>) -> Result<Plan> {
        let PlanBuilder { geometry, material, history, until, accuracy, temperature, area, body } = self;
        positive("end of the run", until)?;
        let (steps, progress) = (Cell::new(0), RefCell::new(progress));
        let progress = |cells: [usize; 2], time: f64| {
            steps.set(steps.get() + 1);
            let progressed = PlanProgress { steps: steps.get(), cells, time };
            match progress.borrow_mut()(progressed) {
                ControlFlow::Continue(()) => Ok(()),
                ControlFlow::Break(()) => Err(Error::Cancelled { what: "a plan" }),
            }
        };
        let (tolerance, progress) = (accuracy.step_tolerance(), &progress);
        let (whole, kernels) = (until, &RefCell::default());
        let scene = TrialScene {
            geometry,
            material,
            temperature,
            history,
            until,
            whole,
            accuracy,
            tolerance,
            progress,
            body,
            kernels,
        };
        let size = ContactSize::of(&scene)?;
        let converged = size.on_growing_domain(|size| converge(&scene, size, area))?;
        let ConvergedRun { steps, meshes, mut pressure, reach } = converged;
        let size = ContactSize { reach, ..size };
        let needed = |pressure: ErrorLaw| {
            let across = meshes.across_for(pressure, steps.left_for_mesh(accuracy), accuracy, area).max(FEWEST_ACROSS);
            (across, size.cells(across))
        };
        let (mut across, mut sides) = needed(pressure);
        if sides[0].max(sides[1]) > MOST_PLANNED_CELLS as f64 {
            pressure = ErrorLaw::NONE;
            (across, sides) = needed(pressure);
        }
        let wanted = sides[0].max(sides[1]);
        if wanted.is_nan() || wanted > MOST_PLANNED_CELLS as f64 {
            let (field, allowed) = ("cells along a side for this accuracy", "at most 8192: choose a lower accuracy");
            return Err(Error::CountOutOfRange { field, value: wanted.min(1e18) as usize, allowed });
        }
        let grid = size.grid(across)?;
        let across = across * grid.cells()[0] as f64 / sides[0];
        let converges = pressure.converges && steps.resolve_pressure(accuracy);
        let mesh_error = MeshError {
            approach: meshes.main().at(across).max(meshes.singular().at(across)),
            max_pressure: converges.then(|| pressure.at(across)),
            area: 2.0 * meshes.radius().at(across),
            singular: meshes.singular().at(across),
        };
        let builder = scene.builder(grid.clone())?;
        let memory = builder.memory()?;
        Ok(Plan {
            builder,
            stepping: Stepping::adaptive(steps.tolerance),
            grid,
            accuracy,
            reach,
            steps: steps.run.steps.len(),
            convolutions: meshes.work().at(across),
            // adaptive steps keep the rate of the displacement
            bytes: memory.total() + 8 * memory.computed_cells as u64,
            time_error: steps.error.map(|error| error.main),
            mesh_error,
            pressure_error_at_all_times: meshes.pressure_over_time().at(across)
                + steps.error.map_or(0.0, |error| error.pressure_over_time),
        })
    }
}
