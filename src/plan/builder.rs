//! What a plan is made of.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;

use crate::axis::Axis;
use crate::contact::Builder;
use crate::error::{Error, Result, positive, within};
use crate::geometry::Geometry;
use crate::load::LoadHistory;
use crate::observe::mesh_error::MeshError;
use crate::plan::convergence::converge;
use crate::plan::domain::{Body, Side};
use crate::plan::meshes::{Laws, MOST_PLANNED_CELLS};
use crate::plan::scene::{Asked, TrialScene};
use crate::plan::{Accuracy, Plan};
use crate::rheology::{Material, TemperatureHistory};
use crate::run::Stepping;
use crate::{Grid, InfluenceKernel};

/// Fewest cells across the widest contact: fewer do not resolve it.
const FEWEST_ACROSS: f64 = 14.0;

/// The greatest pressure is as good as elastic where the greatest traction of a level, times the elastic pressure in the middle, is at most so
/// many times as great.
const AS_ELASTIC: f64 = 1.01;

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
    asked: Asked<'a>,
    area: bool,
}

/// How far planning has come: the state of a coarse mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PlanProgress {
    /// Number of steps and elastic contacts of all coarse meshes so far.
    pub steps: usize,
    /// Cells of the mesh.
    pub cells: [usize; 2],
    /// Time of the run \[s\]; 0 for an elastic contact.
    pub time: f64,
    /// Convolution equivalents so far, each times the cells of its mesh: compare with [`Plan::convolutions`] times the
    /// cells of the plan.
    pub work: f64,
}

impl Plan {
    /// Plans a run of one body from rest to the time `until` \[s\], when built.
    pub fn builder<'a>(
        geometry: &'a dyn Geometry,
        material: &'a Material,
        history: &'a dyn LoadHistory,
        until: f64,
    ) -> PlanBuilder<'a> {
        let (accuracy, body) = (Accuracy::default(), Body::default());
        let asked = Asked { geometry, material, temperature: None, history, until, accuracy, body, fields: &[] };
        PlanBuilder { asked, area: false }
    }
}

impl<'a> PlanBuilder<'a> {
    /// The accuracy (default: [`Accuracy::STANDARD`]).
    pub fn accuracy(self, accuracy: Accuracy) -> PlanBuilder<'a> {
        PlanBuilder { asked: Asked { accuracy, ..self.asked }, ..self }
    }

    /// A temperature that changes ([`Builder::temperature`](crate::contact::Builder::temperature)): the times of the
    /// plan and of the load are times, the body creeps in reduced time.
    pub fn temperature(self, temperature: &'a TemperatureHistory) -> PlanBuilder<'a> {
        PlanBuilder { asked: Asked { temperature: Some(temperature), ..self.asked }, ..self }
    }

    /// Whether the mesh gives the contact radius, √(area/π), this accuracy too, at all times at which the contact is at least
    /// 8 cells across (default: no). The radius of a growing contact errs by a fraction of a cell.
    pub fn area(self, area: bool) -> PlanBuilder<'a> {
        PlanBuilder { area, ..self }
    }

    /// Times \[s\] at which the pressure field has this accuracy too, in L1 over its load (default: none): by the mesh, and by
    /// [`Run::fields_to`](crate::run::Run::fields_to) with [`Plan::fields`]. Nearly all of its error is at the rim and falls with the power 3/2
    /// of the cells across, on punches with the root: fields take finer meshes than approach and force.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let (sphere, load) = (Sphere::new(10.0e-3)?, StepLoad::new(Load::force(1.0))?);
    /// let body = Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?);
    /// let times = [0.5, 2.0];
    /// let plan = Plan::builder(&sphere, &body, &load, 2.0).accuracy(Accuracy::COARSE).fields_at(&times).build()?;
    /// let mut contact = plan.builder.build()?;
    /// let run = contact.follow(&load, plan.stepping, 2.0).sample_at(times)?;
    /// let mut run = run.fields_to(plan.fields.expect("asked for"))?;
    /// while run.next_step()?.is_some() {
    ///     for sample in run.samples() {
    ///         println!("{:.3e} Pa", sample?.fields().max_pressure());
    ///     }
    /// }
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn fields_at(self, times: &'a [f64]) -> PlanBuilder<'a> {
        PlanBuilder { asked: Asked { fields: times, ..self.asked }, ..self }
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
    pub fn kernel(mut self, kernel: &'a dyn Fn(&Grid) -> Result<InfluenceKernel>) -> PlanBuilder<'a> {
        self.asked.body.kernel = Some(kernel);
        self
    }

    /// A side of the domain that is a period of the body, of this length \[m\]. Other sides are as long as the contact needs.
    pub fn period(mut self, axis: Axis, length: f64) -> PlanBuilder<'a> {
        self.asked.body.sides[usize::from(axis == Axis::X2)] = Side::Period(length);
        self
    }

    /// A line contact: one cell along x2, of this length \[m\], on which the force acts.
    pub fn line(mut self, length: f64) -> PlanBuilder<'a> {
        self.asked.body.sides[1] = Side::Uniform(length);
        self
    }

    /// Plans the run.
    ///
    /// # Errors
    /// If the end of the run is not finite and positive, a part is invalid, there is a period or a line without a kernel, no domain holds the contact, a contact problem
    /// on a coarse mesh fails, a time of a field is not in the run, or approach, force and fields need more than 8192 cells along a side; for a temperature of the run as
    /// [`TimeTemperature::shift_factor`](crate::rheology::TimeTemperature::shift_factor).
    pub fn build(self) -> Result<Plan> {
        self.build_with(|_| ControlFlow::Continue(()))
    }

    /// As [`PlanBuilder::build`], calling `progress` after each contact problem on a coarse mesh; it may end the planning. A contact
    /// problem under way is not interrupted: coarse meshes have few cells.
    ///
    /// # Errors
    /// As [`PlanBuilder::build`]; [`Error::Cancelled`] if `progress` ends it.
    pub fn build_with(self, progress: impl FnMut(PlanProgress) -> ControlFlow<()>) -> Result<Plan> {
        let PlanBuilder { asked, area } = self;
        let Asked { material, temperature, history, until, accuracy, body, fields, .. } = asked;
        positive("end of the run", until)?;
        for (side, field) in body.sides.into_iter().zip(["period along x1", "period or line along x2"]) {
            if let Side::Period(length) | Side::Uniform(length) = side {
                within(
                    field,
                    length,
                    length > 0.0 && body.kernel.is_some(),
                    "> 0, with the kernel of a body that has it (PlanBuilder::kernel)",
                )?;
            }
        }
        for &time in fields {
            within(
                "time of a pressure field",
                time,
                (0.0..=until).contains(&time),
                "from the start of the run to its end",
            )?;
        }
        let (counts, progress) = (Cell::new((0, 0.0)), RefCell::new(progress));
        let progress = |cells: [usize; 2], convolutions: f64, time: f64| {
            let (steps, work) = counts.get();
            counts.set((steps + 1, work + convolutions * (cells[0] * cells[1]) as f64));
            let (steps, work) = counts.get();
            match progress.borrow_mut()(PlanProgress { steps, cells, time, work }) {
                ControlFlow::Continue(()) => Ok(()),
                ControlFlow::Break(()) => Err(Error::Cancelled { what: "a plan" }),
            }
        };
        let (progress, kernels) = (&progress, &RefCell::default());
        if let Some(temperature) = temperature {
            // before the fit, whose error would name a shift factor
            temperature.reduced_time(0.0, until)?;
        }
        let fitted = &Builder::material_of_run(material, history, until, temperature, &accuracy.settings())?;
        let scene = TrialScene { asked: Asked { material: fitted, ..asked }, progress, kernels };
        let converged = converge(&scene, area)?;
        let size = &converged.size;
        let needed = |laws: &Laws| {
            let across = laws.across_for(&converged.wanted).max(FEWEST_ACROSS);
            (across, size.cells(across))
        };
        let (laws, steps) = (converged.laws, &converged.steps);
        // rings of a half-space tell what cells lose of a peak; what cells lose of an elastic pressure is seen on any body
        let is_known =
            body.kernel.is_none() || steps.trace.is_none_or(|trace| trace.pressure_amplification <= AS_ELASTIC);
        let at_rim = steps.trace.is_some_and(|trace| !trace.cells.converges);
        let sides_for_pressure = needed(&laws).1;
        let doubt = match () {
            () if sides_for_pressure[0].max(sides_for_pressure[1]) > MOST_PLANNED_CELLS => {
                Some("it needs more than 8192 cells along a side")
            }
            () if !is_known => Some(
                "the body is no half-space and has crept: what cells lose of its pressure is known of elastic contacts alone",
            ),
            () if at_rim => Some("it is at the rim of a contact that grows fast, narrower than cells"),
            () if !laws.pressure.converges => {
                Some("it is no smooth peak, as at an edge, a tip or a contact of few cells")
            }
            () if steps.resolve_pressure(accuracy) => None,
            () => Some("it is a peak in time, or at a fast rim, that steps do not resolve"),
        };
        let (laws, stops) = match doubt {
            None => (laws, steps.stops.clone()),
            Some(_) => (laws.without_pressure(), Vec::new()),
        };
        let (across, sides) = needed(&laws);
        let wanted = sides[0].max(sides[1]);
        if wanted.is_nan() || wanted > MOST_PLANNED_CELLS {
            let (field, allowed) = ("cells along a side for this accuracy", "at most 8192: choose a lower accuracy");
            return Err(Error::CountOutOfRange { field, value: wanted.min(1e18) as usize, allowed });
        }
        let grid = size.grid(across)?;
        let across = across * grid.cells()[0] as f64 / sides[0];
        let mesh_error = MeshError {
            approach: laws.main.at(across).max(laws.singular.at(across)),
            max_pressure: doubt.is_none().then(|| laws.pressure.at(across) + laws.at_rim.at(across)),
            pressure_field: laws.field.at(across).min(1.0),
            rim_pressure: laws.field_rim.at(across).min(1.0),
            area: 2.0 * laws.radius.at(across),
            singular: laws.singular.at(across),
        };
        let mut builder = scene.builder(grid.clone())?.material(material.clone()).times_of(history, until);
        builder.planned = true;
        let memory = builder.memory()?;
        Ok(Plan {
            builder,
            stepping: Stepping::adaptive(steps.tolerance),
            grid,
            accuracy,
            fields: (!fields.is_empty()).then(|| accuracy.fields()),
            reach: size.reach,
            steps: steps.run.steps.len() + stops.len(),
            stops,
            convolutions: converged.work(across),
            // adaptive steps keep the rate of the displacement
            bytes: memory.total() + 8 * memory.computed_cells as u64,
            time_error: steps.error.map(|error| error.main),
            doubt,
            mesh_error,
            pressure_error_at_all_times: laws.pressure_over_time.at(across)
                + steps.error.map_or(0.0, |error| error.pressure_over_time),
        })
    }
}
