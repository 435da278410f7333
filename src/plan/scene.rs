//! The scene on coarse meshes: its domain, its elastic states, and runs.

use std::cell::RefCell;
use std::sync::Arc;

use crate::contact::{Builder, ViscoelasticContact, Warnings};
use crate::elastic::ElasticContact;
use crate::error::Result;
use crate::fields::Fields;
use crate::geometry::Geometry;
use crate::load::{Load, LoadHistory, load_point};
use crate::plan::Accuracy;
use crate::plan::domain::{Body, ContactSize, Side};
use crate::rheology::{Material, TemperatureHistory};
use crate::run::Stepping;
use crate::states::{Loading, Pressed};
use crate::{Grid, InfluenceKernel};

/// A pressure that falls by this share of the accuracy while the load grows counts for nothing.
const FALL_SHARE: f64 = 0.1;

/// What is asked of a plan.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) geometry: &'a dyn Geometry,
    /// In a scene with a series over the times of the run.
    pub(super) material: &'a Material,
    pub(super) temperature: Option<&'a TemperatureHistory>,
    pub(super) history: &'a dyn LoadHistory,
    pub(super) until: f64,
    pub(super) accuracy: Accuracy,
    pub(super) body: Body<'a>,
    /// Times at which the pressure is asked for.
    pub(super) fields: &'a [f64],
}

/// A scene to plan.
#[derive(Clone, Copy)]
pub(super) struct TrialScene<'a> {
    pub(super) asked: Asked<'a>,
    /// Called with the cells, the convolution equivalents and the time of each step, and of each elastic state at the
    /// time 0; its error ends the planning.
    pub(super) progress: &'a dyn Fn([usize; 2], f64, f64) -> Result<()>,
    /// Kernels made so far.
    pub(super) kernels: &'a RefCell<Vec<Arc<InfluenceKernel>>>,
}

/// A state at the end of a step, or an elastic state, whose force is its level.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepState {
    pub(super) time: f64,
    pub(super) approach: f64,
    /// Approach of the point about which the body tilts.
    pub(super) depth: f64,
    pub(super) force: f64,
    pub(super) radius: f64,
    pub(super) pressure: f64,
    /// Error of the greatest pressure, estimated from its neighbours; `None` if they do not resolve it.
    pub(super) peak: Option<f64>,
    /// First-order share of the error of the mesh, due to singular edges and estimated from the rim.
    pub(super) singular: f64,
    /// Errors of the pressure field and of its rim; `None` without an estimate.
    pub(super) field: Option<[f64; 2]>,
    /// Whether the contact is enough cells wide for radius and pressure to be resolved.
    pub(super) resolved: bool,
}

/// A run on a coarse mesh.
#[derive(Clone, Default)]
pub(super) struct Run {
    pub(super) size: ContactSize,
    /// Steps taken: their lengths, and the loads at their ends.
    pub(super) steps: Vec<(f64, Load)>,
    pub(super) states: Vec<StepState>,
    pub(super) convolutions: f64,
    /// Approach of the undisturbed contact at the first touch.
    pub(super) rest: f64,
    /// The pressures of elastic states.
    pressed: Vec<Pressed>,
}

impl Run {
    /// No steps yet.
    fn of(fields: Fields<'_>, sides: [Side; 2]) -> Run {
        Run { size: ContactSize::none(sides), rest: fields.approach(), ..Run::default() }
    }

    /// Adds a step of length `dt` to a load, after its convolutions.
    fn add(&mut self, fields: Fields<'_>, (dt, load): (f64, Load), convolutions: f64, warnings: Warnings) {
        let mesh = fields.mesh_error().unwrap_or_default();
        let field = mesh.map(|error| [error.pressure_field, error.rim_pressure]);
        self.convolutions += convolutions;
        self.steps.push((dt, load));
        let (at, [tilt1, tilt2]) = (load_point(load.tilt()), fields.tilt());
        self.states.push(StepState {
            time: fields.time().unwrap_or(0.0),
            approach: fields.approach(),
            depth: fields.approach() + tilt1 * at[0] + tilt2 * at[1],
            force: fields.force(),
            radius: (fields.contact_area() / std::f64::consts::PI).sqrt(),
            pressure: fields.max_pressure(),
            peak: mesh.and_then(|error| error.max_pressure),
            singular: mesh.map_or(0.0, |error| error.singular),
            field,
            resolved: !warnings.contains(Warnings::FEW_CELLS),
        });
        if let Some(extent) = fields.extent_of_contact() {
            self.size.include(fields.grid(), extent);
        }
    }

    /// The ends of its steps.
    pub(super) fn times(&self) -> Vec<f64> {
        self.states.iter().map(|state| state.time).collect()
    }

    /// With no states but those at the times of another run, at which some of its steps end.
    pub(super) fn at_the_times_of(mut self, other: &Run) -> Run {
        let mut own = self.states.iter();
        self.states = other.states.iter().filter_map(|state| own.find(|own| own.time == state.time).copied()).collect();
        self
    }

    /// Elastic states superpose only where the pressure falls nowhere from the least level to the greatest, but by this share of the
    /// greatest pressure.
    fn check_growth(&self, allowed: f64) -> Result<()> {
        let mut order: Vec<usize> = (0..self.pressed.len()).collect();
        order.sort_by(|&a, &b| self.states[a].force.total_cmp(&self.states[b].force));
        order.windows(2).try_for_each(|pair| {
            let levels = [pair[0], pair[1]].map(|k| self.states[k].force);
            self.pressed[pair[0]].check_growth(&self.pressed[pair[1]], levels, allowed)
        })
    }
}

impl TrialScene<'_> {
    pub(super) fn course(&self) -> Loading<'_> {
        let Asked { material, temperature, history, until, .. } = self.asked;
        Loading { material, temperature, history, until }
    }

    pub(super) fn builder(&self, grid: Grid) -> Result<Builder> {
        let (kernel, material) = (self.kernel(&grid)?, self.asked.material.clone());
        let builder = ViscoelasticContact::builder(grid).geometry(self.asked.geometry).material(material);
        let builder = builder.kernel(kernel).settings(self.asked.accuracy.settings());
        Ok(match self.asked.temperature {
            Some(temperature) => builder.temperature(temperature.clone()),
            None => builder,
        })
    }

    /// The elastic contacts of unit compliance under these loads, on a mesh.
    pub(super) fn elastic(&self, grid: Grid, loads: &[Load]) -> Result<Run> {
        let cells = grid.cells();
        let kernel = self.kernel(&grid)?;
        let builder = ElasticContact::builder(grid).geometry(self.asked.geometry).kernel(kernel).modulus(1.0);
        let mut contact = builder.settings(self.asked.accuracy.settings()).build()?;
        let mut run = Run::of(contact.fields(), self.asked.body.sides);
        for &load in loads {
            let report = contact.solve(load)?;
            run.add(contact.fields(), (0.0, load), report.convolution_equivalents(), report.warnings);
            run.pressed.push(Pressed::new(contact.fields().pressure()));
            (self.progress)(cells, report.convolution_equivalents(), 0.0)?;
        }
        Ok(run)
    }

    /// The elastic contacts under loads that differ in size only, of which a run is made if they only grow with the load.
    pub(super) fn growing(&self, grid: Grid, loads: &[Load]) -> Result<Run> {
        let run = self.elastic(grid, loads)?;
        run.check_growth(FALL_SHARE * self.asked.accuracy.target())?;
        Ok(run)
    }

    /// The first corner of the load or the temperature after a time, at which every run ends a step; infinite where there is none.
    pub(super) fn next_corner(&self, after: f64) -> f64 {
        let heated = self.asked.temperature.and_then(|temperature| temperature.next_corner(after));
        let corners = [self.asked.history.next_breakpoint(after), heated];
        corners.into_iter().flatten().fold(f64::INFINITY, f64::min)
    }

    /// The kernel on a grid, made once.
    fn kernel(&self, grid: &Grid) -> Result<Arc<InfluenceKernel>> {
        if let Some(made) = self.kernels.borrow().iter().find(|kernel| kernel.grid() == grid) {
            return Ok(Arc::clone(made));
        }
        let kernel = Arc::new(match self.asked.body.kernel {
            Some(kernel) => kernel(grid)?,
            None => InfluenceKernel::half_space(grid)?,
        });
        self.kernels.borrow_mut().push(Arc::clone(&kernel));
        Ok(kernel)
    }

    /// The run in steps as long as the tolerance allows; steps also end at the times `stops`.
    pub(super) fn follow(&self, grid: Grid, tolerance: f64, stops: &[f64]) -> Result<Run> {
        let mut contact = self.builder(grid)?.build()?;
        let mut follow =
            contact.follow(self.asked.history, Stepping::adaptive(tolerance), self.asked.until).stop_at(stops)?;
        let mut run = Run::of(follow.contact().fields(), self.asked.body.sides);
        while let Some(report) = follow.next_step()? {
            let (contact, convolutions) = (follow.contact(), report.convolution_equivalents());
            run.add(contact.fields(), (report.dt, contact.load()), convolutions, report.warnings);
            (self.progress)(follow.contact().grid().cells(), report.convolution_equivalents(), report.time)?;
        }
        Ok(run)
    }

    /// Whether the shape has no surface in a part of the domain: the face of a punch ends.
    pub(super) fn has_edge(&self, grid: &Grid) -> bool {
        let [n1, n2] = grid.cells();
        let mut cells = (0..n1 * n2).map(|k| grid.center(k / n2, k % n2));
        cells.any(|[x1, x2]| self.asked.geometry.initial_gap(x1, x2) == f64::INFINITY)
    }
}
