//! The scene on coarse meshes: its domain, its steps, and its states.

use std::cell::RefCell;
use std::sync::Arc;

use crate::contact::{Builder, StepReport, Stepping, ViscoelasticContact, Warnings};
use crate::error::{Error, Result, StepError};
use crate::geometry::Geometry;
use crate::load::{Load, LoadHistory};
use crate::plan::Accuracy;
use crate::plan::domain::{Body, ContactSize, Side};
use crate::rheology::{Material, TemperatureHistory};
use crate::{Grid, InfluenceKernel};

/// Cells along a side of the runs that find the domain.
const DOMAIN_CELLS: usize = 24;
/// Greatest number of domains tried, each at most ten times as large or as small as the last.
const MAX_DOMAINS: usize = 60;
/// A domain is accepted if the contact spans a fraction of it in this range.
const CONTACT_FRACTION: [f64; 2] = [0.45, 0.92];
/// Greatest number of halvings of a step in which the solver does not converge.
const MAX_HALVINGS: u32 = 5;

/// A greatest pressure in a contact smaller than the first fraction of the largest contact gets a separate domain,
/// which contains the contact until it has grown to the second fraction.
const SMALL_CONTACT: [f64; 2] = [1.0 / 3.0, 0.4];

/// Ratio of the tolerances of two runs whose difference estimates the error in time of the first, and the smallest
/// tolerance of a run.
const SHORTER: f64 = 0.125;
pub(super) const LEAST_TOLERANCE: f64 = 1e-9;

/// A scene to plan.
#[derive(Clone, Copy)]
pub(super) struct TrialScene<'a> {
    pub(super) geometry: &'a dyn Geometry,
    pub(super) material: &'a Material,
    pub(super) temperature: Option<&'a TemperatureHistory>,
    pub(super) history: &'a dyn LoadHistory,
    pub(super) until: f64,
    /// End of the run for which the material is fitted.
    pub(super) whole: f64,
    pub(super) accuracy: Accuracy,
    /// Tolerance of the steps.
    pub(super) tolerance: f64,
    /// Called with the cells and the time after each step, and after each elastic state; its error ends the planning.
    pub(super) progress: &'a dyn Fn([usize; 2], f64) -> Result<()>,
    pub(super) body: Body<'a>,
    /// Kernels made so far.
    pub(super) kernels: &'a RefCell<Vec<Arc<InfluenceKernel>>>,
}

/// A state at the end of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepState {
    pub(super) time: f64,
    pub(super) approach: f64,
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

/// A run on a coarse mesh.
#[derive(Clone, Default)]
pub(super) struct Run {
    pub(super) size: ContactSize,
    /// Steps taken: their lengths, and the loads at their ends.
    pub(super) steps: Vec<(f64, Load)>,
    pub(super) states: Vec<StepState>,
    pub(super) convolutions: f64,
}

impl Run {
    /// No steps yet, on a domain with these sides.
    pub(super) fn on(sides: [Side; 2]) -> Run {
        Run { size: ContactSize::none(sides), ..Run::default() }
    }

    fn add(&mut self, contact: &ViscoelasticContact, report: &StepReport) {
        let mesh = contact.mesh_error().unwrap_or_default();
        self.convolutions += report.convolution_equivalents();
        self.steps.push((report.dt, contact.load()));
        self.states.push(StepState {
            time: report.time,
            approach: report.approach,
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
}

impl TrialScene<'_> {
    pub(super) fn builder(&self, grid: Grid) -> Result<Builder> {
        let kernel = self.kernel(&grid)?;
        let builder = ViscoelasticContact::builder(grid).geometry(self.geometry).material(self.material.clone());
        let builder = builder.kernel(kernel).settings(self.accuracy.settings()).times_of(self.history, self.whole);
        Ok(match self.temperature {
            Some(temperature) => builder.temperature(temperature.clone()),
            None => builder,
        })
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

    /// Finds the contact on domains of several sizes until it fills one well; returns the size of the contact.
    pub(super) fn size(&self) -> Result<ContactSize> {
        let sides = self.body.sides;
        let (is_found, first) = (sides.map(|side| side == Side::Found), self.first_length()?);
        let mut lengths = sides.map(|side| match side {
            Side::Found => first,
            Side::Period(length) | Side::Uniform(length) => length,
        });
        let cells = sides.map(|side| if matches!(side, Side::Uniform(_)) { 1 } else { DOMAIN_CELLS });
        for _ in 0..MAX_DOMAINS {
            let factors = match self.follow(Grid::new(cells, lengths)?, &[]).map(|run| run.size) {
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
        let mut run = Run::on(self.body.sides);
        while let Some(report) = follow.next_step()? {
            run.add(follow.contact(), &report);
            (self.progress)(follow.contact().grid().cells(), report.time)?;
        }
        Ok(run)
    }

    /// The states at the times of `run` from a run with shorter steps on the same mesh. `None` if the steps are too
    /// short for `f64` or the solver does not converge.
    pub(super) fn with_shorter_steps(&self, run: &Run, grid: Grid) -> Result<Option<Vec<StepState>>> {
        let times: Vec<f64> = run.states.iter().map(|state| state.time).collect();
        let tolerance = (SHORTER * self.tolerance).max(LEAST_TOLERANCE);
        // splits every step of the run, since its control may have missed an event within a step
        let middles = times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let stops: Vec<f64> = times.iter().copied().chain(middles).collect();
        match (TrialScene { tolerance, ..*self }.follow(grid, &stops)) {
            Err(Error::Step(StepError::StepTooShort { .. }) | Error::Step(StepError::NotConverged { .. })) => Ok(None),
            finer => {
                let mut states = finer?.states.into_iter();
                Ok(times.iter().map(|&time| states.find(|state| state.time == time)).collect())
            }
        }
    }

    /// The run in given steps.
    pub(super) fn repeat(&self, grid: Grid, steps: &[(f64, Load)]) -> Result<Run> {
        let mut contact = self.builder(grid)?.build()?;
        let mut run = Run::on(self.body.sides);
        for &(dt, load) in steps {
            let report = advance(&mut contact, dt, load, MAX_HALVINGS)?;
            run.add(&contact, &report);
            (self.progress)(contact.grid().cells(), report.time)?;
        }
        Ok(run)
    }

    /// Whether the shape has no surface in a part of the domain: the face of a punch ends.
    pub(super) fn has_edge(&self, grid: &Grid) -> bool {
        let [n1, n2] = grid.cells();
        let mut cells = (0..n1 * n2).map(|k| grid.center(k / n2, k % n2));
        cells.any(|[x1, x2]| self.geometry.initial_gap(x1, x2) == f64::INFINITY)
    }

    /// The time until which the contact stays small, if the pressure is greatest in a contact much smaller than the
    /// later one.
    pub(super) fn before_growth(&self, run: &Run) -> Option<f64> {
        let largest = greatest(&run.states, |state| state.radius);
        let highest = greatest(&run.states, |state| state.pressure);
        let peak = run.states.iter().position(|state| state.pressure == highest)?;
        let small = run.states.iter().take_while(|state| state.radius <= SMALL_CONTACT[1] * largest).count();
        if peak >= small || run.states[peak].radius > SMALL_CONTACT[0] * largest {
            return None;
        }
        let last = run.states[small - 1].time;
        let next = run.states.get(small).map_or(self.until, |state| state.time);
        let until = if last > 0.0 { last } else { 0.1 * next };
        (until < self.until).then_some(until)
    }

    /// Initial length L of the domain: a contact of half width L/4 is indented by the gap at its edge, under a force of
    /// about E* L times this gap.
    fn first_length(&self) -> Result<f64> {
        let (mut force, mut approach) = (0.0_f64, 0.0_f64);
        for k in 0..=64 {
            let time = self.until * f64::from(k) / 64.0;
            match self.history.at(time).validated_at(time, false)? {
                Load::Force { normal, .. } => force = force.max(normal),
                Load::Approach { approach: depth, .. } => approach = approach.max(depth),
                // either is a bound
                Load::Spring { drive: depth, .. } => approach = approach.max(depth),
            }
        }
        let creeping = self.temperature.map_or(Ok(self.until), |history| history.reduced_time(0.0, self.until))?;
        let mut compliance = self.material.contact_compliance(creeping.min(self.material.known_until()));
        if !compliance.is_finite() {
            compliance = self.material.contact_compliance(0.0);
        }
        if let Some(Side::Uniform(length)) = self.body.sides.iter().find(|side| matches!(side, Side::Uniform(_))) {
            force /= length;
        }
        let lowest = self.geometry.initial_gap(0.0, 0.0);
        let rise = |length: f64| {
            let around = [(0, [1.0, 0.0]), (1, [0.0, 1.0]), (0, [-1.0, 0.0]), (1, [0.0, -1.0])];
            let found = around.into_iter().filter(|(axis, _)| self.body.sides[*axis] == Side::Found);
            let gaps = found.map(|(_, [x1, x2])| self.geometry.initial_gap(0.25 * length * x1, 0.25 * length * x2));
            gaps.fold(f64::INFINITY, f64::min) - lowest
        };
        let depth = |length: f64| {
            let rise = rise(length);
            rise >= approach.max(force * compliance / length) || rise.is_nan() || rise == f64::INFINITY
        };
        let lengths = (-48..=36).map(|k| 10f64.powf(0.25 * f64::from(k)));
        lengths.into_iter().find(|&length| depth(length)).ok_or(Error::NoDomain { length: 1e9 })
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
