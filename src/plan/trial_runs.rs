//! The scene on coarse meshes: its domain, its elastic states, and runs.

use std::cell::RefCell;
use std::sync::Arc;

use crate::contact::{Builder, StepReport, ViscoelasticContact, Warnings};
use crate::error::{Error, Result, StepError};
use crate::geometry::Geometry;
use crate::load::{Load, LoadHistory, Tilt};
use crate::plan::Accuracy;
use crate::plan::domain::{Body, ContactSize, Side};
use crate::plan::loads::Loads;
use crate::rheology::{Elastic, Material, TemperatureHistory};
use crate::run::Stepping;
use crate::states::{Course, Pressed};
use crate::{Grid, InfluenceKernel};

/// Cells along a side of the runs that find the domain.
const DOMAIN_CELLS: usize = 24;
/// Greatest number of domains tried, each at most ten times as large or as small as the last.
const MAX_DOMAINS: usize = 60;
/// A domain is accepted if the contact spans a fraction of it in this range.
const CONTACT_FRACTION: [f64; 2] = [0.45, 0.92];
/// Greatest number of halvings of a step in which the solver does not converge.
const MAX_HALVINGS: u32 = 5;
/// A pressure that falls by this share of the accuracy while the load grows counts for nothing.
const FALL_SHARE: f64 = 0.1;

/// Ratio of the tolerances of two runs whose difference estimates the error in time of the first, and the smallest
/// tolerance of a run.
const SHORTER: f64 = 0.125;
pub(super) const LEAST_TOLERANCE: f64 = 1e-9;

/// A scene to plan.
#[derive(Clone, Copy)]
pub(super) struct TrialScene<'a> {
    pub(super) geometry: &'a dyn Geometry,
    /// With a series over the times of the run.
    pub(super) material: &'a Material,
    pub(super) temperature: Option<&'a TemperatureHistory>,
    pub(super) history: &'a dyn LoadHistory,
    pub(super) until: f64,
    pub(super) accuracy: Accuracy,
    /// Tolerance of the steps.
    pub(super) tolerance: f64,
    /// Called with the cells, the convolution equivalents and the time of each step, and of each elastic state at the
    /// time 0; its error ends the planning.
    pub(super) progress: &'a dyn Fn([usize; 2], f64, f64) -> Result<()>,
    pub(super) body: Body<'a>,
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
    /// Whether the contact is enough cells wide for radius and pressure to be resolved.
    pub(super) resolved: bool,
}

/// What shows the error of the mesh: the elastic states of a run, or a run itself where it is not made of them.
pub(super) enum Probe<'a> {
    Elastic(&'a [Load]),
    Steps(&'a [(f64, Load)]),
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
    fn of(contact: &ViscoelasticContact, sides: [Side; 2]) -> Run {
        Run { size: ContactSize::none(sides), rest: contact.approach(), ..Run::default() }
    }

    fn add(&mut self, contact: &ViscoelasticContact, report: &StepReport) {
        let mesh = contact.mesh_error().unwrap_or_default();
        self.convolutions += report.convolution_equivalents();
        self.steps.push((report.dt, contact.load()));
        let at = contact.load().tilt().map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 });
        self.states.push(StepState {
            time: report.time,
            approach: report.approach,
            depth: report.approach + contact.tilt()[0] * at[0] + contact.tilt()[1] * at[1],
            force: report.force,
            radius: (contact.contact_area() / std::f64::consts::PI).sqrt(),
            pressure: contact.max_pressure(),
            peak: mesh.and_then(|error| error.max_pressure),
            singular: mesh.map_or(0.0, |error| error.singular),
            resolved: !report.warnings.contains(Warnings::FEW_CELLS),
        });
        if let Some(extent) = contact.extent_of_contact() {
            self.size.include(contact.grid(), extent);
        }
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
    pub(super) fn course(&self) -> Course<'_> {
        let TrialScene { material, temperature, history, until, .. } = *self;
        Course { material, temperature, history, until }
    }

    pub(super) fn builder(&self, grid: Grid) -> Result<Builder> {
        let builder = self.builder_of(grid, self.material.clone())?;
        Ok(match self.temperature {
            Some(temperature) => builder.temperature(temperature.clone()),
            None => builder,
        })
    }

    fn builder_of(&self, grid: Grid, material: Material) -> Result<Builder> {
        let kernel = self.kernel(&grid)?;
        let builder = ViscoelasticContact::builder(grid).geometry(self.geometry).material(material);
        Ok(builder.kernel(kernel).settings(self.accuracy.settings()))
    }

    /// The elastic contacts of unit compliance under these loads, on a mesh.
    pub(super) fn elastic(&self, grid: Grid, loads: &[Load]) -> Result<Run> {
        let nu = self.material.poisson_ratios().flatten().next().unwrap_or(0.5);
        // C = (1 − ν) J/2 = 1 Pa⁻¹
        let unit = Material::constant_poisson(Elastic::new(0.5 * (1.0 - nu))?, nu)?;
        let mut contact = self.builder_of(grid, unit)?.build()?;
        let mut run = Run::of(&contact, self.body.sides);
        for &load in loads {
            let report = contact.step(0.0, load)?;
            run.add(&contact, &report);
            run.pressed.push(Pressed::new(contact.pressure()));
            (self.progress)(contact.grid().cells(), report.convolution_equivalents(), 0.0)?;
        }
        Ok(run)
    }

    /// The elastic contacts under loads that differ in size only, of which a run is made if they only grow with the load.
    pub(super) fn growing(&self, grid: Grid, loads: &[Load]) -> Result<Run> {
        let run = self.elastic(grid, loads)?;
        run.check_growth(FALL_SHARE * self.accuracy.target())?;
        Ok(run)
    }

    /// What is computed on each mesh.
    pub(super) fn probe(&self, grid: Grid, probe: &Probe<'_>) -> Result<Run> {
        match *probe {
            Probe::Elastic(loads) => self.growing(grid, loads),
            Probe::Steps(steps) => self.repeat(grid, steps),
        }
    }

    /// The first corner of the load or the temperature after a time, at which every run ends a step; infinite where there is none.
    pub(super) fn next_corner(&self, after: f64) -> f64 {
        let heated = self.temperature.and_then(|temperature| temperature.next_corner(after));
        let corners = [self.history.next_breakpoint(after), heated];
        corners.into_iter().flatten().fold(f64::INFINITY, f64::min)
    }

    /// The kernel on a grid, made once.
    fn kernel(&self, grid: &Grid) -> Result<Arc<InfluenceKernel>> {
        if let Some(made) = self.kernels.borrow().iter().find(|kernel| kernel.grid() == grid) {
            return Ok(Arc::clone(made));
        }
        let kernel = Arc::new(match self.body.kernel {
            Some(kernel) => kernel(grid)?,
            None => InfluenceKernel::half_space(grid)?,
        });
        self.kernels.borrow_mut().push(Arc::clone(&kernel));
        Ok(kernel)
    }

    /// Finds the elastic contacts under these loads on domains of several sizes until they fill one well; returns their
    /// size.
    pub(super) fn size(&self, loads: &[Load]) -> Result<ContactSize> {
        let sides = self.body.sides;
        let (is_found, first) = (sides.map(|side| side == Side::Found), Loads::first_length(self, loads)?);
        let mut lengths = sides.map(|side| match side {
            Side::Found => first,
            Side::Period(length) | Side::Uniform(length) => length,
        });
        let cells = sides.map(|side| if matches!(side, Side::Uniform(_)) { 1 } else { DOMAIN_CELLS });
        for _ in 0..MAX_DOMAINS {
            let factors = match self.elastic(Grid::new(cells, lengths)?, loads).map(|run| run.size) {
                Err(Error::Step(StepError::ContactAtEdge { .. })) => [1.7; 2],
                Err(Error::NothingToTouch { .. }) => [0.3; 2],
                Err(error) => return Err(error),
                Ok(size) => {
                    let filled = [0, 1].map(|axis| 2.0 * size.reach[axis] / lengths[axis]);
                    let fits = |axis: usize| (CONTACT_FRACTION[0]..=CONTACT_FRACTION[1]).contains(&filled[axis]);
                    if (0..2).all(|axis| !is_found[axis] || fits(axis)) && size.width != [0.0; 2] {
                        return Ok(size);
                    }
                    let least = 2.0 / DOMAIN_CELLS as f64;
                    filled.map(|filled| (filled.max(least) * 1.3).clamp(0.1, 1.7))
                }
            };
            if !is_found.contains(&true) {
                break;
            }
            lengths = [0, 1].map(|axis| if is_found[axis] { lengths[axis] * factors[axis] } else { lengths[axis] });
        }
        Err(Error::NoDomain { length: lengths[0].max(lengths[1]) })
    }

    /// The run in steps as long as the scene's tolerance allows; steps also end at the times `stops`.
    pub(super) fn follow(&self, grid: Grid, stops: &[f64]) -> Result<Run> {
        let mut contact = self.builder(grid)?.build()?;
        let mut follow = contact.follow(self.history, Stepping::adaptive(self.tolerance), self.until).stop_at(stops)?;
        let mut run = Run::of(follow.contact(), self.body.sides);
        while let Some(report) = follow.next_step()? {
            run.add(follow.contact(), &report);
            (self.progress)(follow.contact().grid().cells(), report.convolution_equivalents(), report.time)?;
        }
        Ok(run)
    }

    /// A run with shorter steps on the same mesh, some of which end at the times of `run`. `None` if the steps are too short for
    /// `f64` or the solver does not converge.
    pub(super) fn with_shorter_steps(&self, run: &Run, grid: Grid) -> Result<Option<Run>> {
        let times: Vec<f64> = run.states.iter().map(|state| state.time).collect();
        let tolerance = (SHORTER * self.tolerance).max(LEAST_TOLERANCE);
        // splits every step of the run, since its control may have missed an event within a step
        let middles = times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let stops: Vec<f64> = times.iter().copied().chain(middles).collect();
        match (TrialScene { tolerance, ..*self }.follow(grid, &stops)) {
            Err(Error::Step(StepError::StepTooShort { .. }) | Error::Step(StepError::NotConverged { .. })) => Ok(None),
            finer => finer.map(Some),
        }
    }

    /// The run in given steps.
    pub(super) fn repeat(&self, grid: Grid, steps: &[(f64, Load)]) -> Result<Run> {
        let mut contact = self.builder(grid)?.build()?;
        let mut run = Run::of(&contact, self.body.sides);
        for &(dt, load) in steps {
            let report = advance(&mut contact, dt, load, MAX_HALVINGS)?;
            run.add(&contact, &report);
            (self.progress)(contact.grid().cells(), report.convolution_equivalents(), report.time)?;
        }
        Ok(run)
    }

    /// Whether the shape has no surface in a part of the domain: the face of a punch ends.
    pub(super) fn has_edge(&self, grid: &Grid) -> bool {
        let [n1, n2] = grid.cells();
        let mut cells = (0..n1 * n2).map(|k| grid.center(k / n2, k % n2));
        cells.any(|[x1, x2]| self.geometry.initial_gap(x1, x2) == f64::INFINITY)
    }
}

/// Takes one step, in halves if the solver does not converge.
fn advance(contact: &mut ViscoelasticContact, dt: f64, load: Load, halvings: u32) -> Result<StepReport> {
    let before = contact.load();
    match contact.step(dt, load) {
        Err(Error::Step(StepError::NotConverged { .. })) if halvings > 0 && dt > 0.0 => {
            advance(contact, 0.5 * dt, before.towards(&load, 0.5), halvings - 1)?;
            advance(contact, 0.5 * dt, load, halvings - 1)
        }
        other => other,
    }
}

pub(super) fn greatest(states: &[StepState], of: impl Fn(&StepState) -> f64) -> f64 {
    states.iter().map(|state| of(state).abs()).fold(0.0, f64::max)
}
