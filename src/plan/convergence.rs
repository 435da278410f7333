//! How the states of a run converge with the mesh.

use crate::error::{Error, Result};
use crate::load::Load;
use crate::plan::Accuracy;
use crate::plan::domain::{ContactSize, Side};
use crate::plan::error_law::{ErrorLaw, ORDERS};
use crate::plan::steps::{Differences, Steps, relative};
use crate::plan::trial_runs::{Run, StepState, TrialScene, greatest};

/// Cells across the widest contact on the coarsest mesh, and on the finest that a plan computes.
const LEAST_ACROSS: f64 = 16.0;
const MOST_ACROSS: f64 = 128.0;
/// Cells across the widest contact where the steps are found.
const STEPS_ACROSS: f64 = 32.0;
/// Most cells along a side of a domain in which the contact is small, for example far off the centre.
const MOST_TRIAL_CELLS: usize = 2048;
/// A plan extrapolates to meshes at most this many times finer, unless `MOST_ACROSS` is reached.
const MAX_EXTRAPOLATION: f64 = 3.0;
/// Most domains for ever smaller contacts.
const MAX_ZOOMS: usize = 12;
/// Greatest difference of the greatest pressure that counts as second order, over the estimate from the neighbours of
/// the peak. A difference of second order is three times the error on the finer mesh.
const MAX_DIFFERENCE_OVER_PEAK: f64 = 4.0;
/// Upper limit of the power of the number of cells across with which the convolutions of a run grow.
const MAX_WORK_ORDER: f64 = 0.4;
/// Fewest cells of an elastic contact whose greatest pressure serves as a bound, and the margin for its error.
const BOUNDING_CELLS: usize = 12;
const BOUNDING_MARGIN: f64 = 1.25;
/// Least width of the contact on a finer mesh, as a fraction of the width on a coarse one.
const MIN_NARROWING: f64 = 0.25;

impl ContactSize {
    /// Size of the contact on a mesh that resolves it: a contact far off the middle is only a few cells wide on the
    /// coarsest mesh.
    pub(super) fn of(scene: &TrialScene<'_>) -> Result<ContactSize> {
        let size = scene.size()?;
        if [0, 1].iter().all(|&axis| size.sides[axis] != Side::Found || size.width[axis] > size.reach[axis]) {
            return Ok(size);
        }
        size.on_growing_domain(|size| {
            let finer = scene.follow(size.grid(LEAST_ACROSS)?, &[])?.size;
            // a contact may be a few cells wide on any mesh
            let width = [0, 1].map(|axis| finer.width[axis].max(MIN_NARROWING * size.width[axis]));
            Ok(ContactSize { width, ..finer })
        })
    }
}

/// Runs on successive meshes, each twice as fine as the last. Cells are counted across the widest contact of the whole run.
pub(super) struct Meshes {
    /// Whether the shape has an edge, as a punch.
    punch: bool,
    across: f64,
    /// Differences between each mesh and the one before.
    differences: Vec<Differences>,
    finest: Run,
    /// Power of the cells across with which the convolutions grow.
    work_order: f64,
}

impl Meshes {
    /// Refines until the needed number of cells across is within the range of extrapolation.
    fn refine(
        scene: &TrialScene<'_>,
        size: &ContactSize,
        (base, punch): (Run, bool),
        needed: impl Fn(&Meshes) -> f64,
    ) -> Result<Meshes> {
        let mut meshes = Meshes { punch, across: LEAST_ACROSS, differences: Vec::new(), finest: base, work_order: 0.0 };
        loop {
            meshes.across *= 2.0;
            let grid = size.grid(meshes.across)?;
            let [n1, n2] = grid.cells();
            let finer = scene.repeat(grid, &meshes.finest.steps)?;
            meshes.differences.push(Differences::between(&meshes.finest.states, &finer.states));
            let growth = relative(finer.convolutions, meshes.finest.convolutions);
            meshes.work_order = growth.max(1.0).log2().min(MAX_WORK_ORDER);
            meshes.finest = finer;
            let reach = if meshes.differences.len() < 2 { 1.0 } else { MAX_EXTRAPOLATION };
            let last = meshes.across >= MOST_ACROSS || 2 * n1.max(n2) > MOST_TRIAL_CELLS;
            if last || needed(&meshes) <= reach * meshes.across {
                return Ok(meshes);
            }
        }
    }

    /// The differences of one quantity, from the coarsest mesh to the finest.
    fn each(&self, of: impl Fn(&Differences) -> f64) -> Vec<f64> {
        self.differences.iter().map(of).collect()
    }

    /// Convergence of approach and force; for a punch, whose rim is resolved to a cell, by fractions of a cell.
    pub(super) fn main(&self) -> ErrorLaw {
        let law = if self.punch { ErrorLaw::by_cells } else { ErrorLaw::smooth };
        law(&self.each(|differences| differences.main), self.across)
    }

    /// First-order part of the error, estimated from the rim. Creep raises the pressure at a growing rim too, but at
    /// edges of the shape the pressure is raised from the start.
    pub(super) fn singular(&self) -> ErrorLaw {
        let states = &self.finest.states;
        let deepest = greatest(states, |state| state.approach);
        let shares = states.iter().map(|state| state.singular * relative(state.approach.abs(), deepest));
        let touching = states.iter().filter(|state| state.force > 0.0);
        let lasts = self.punch || touching.map(|state| state.singular).fold(f64::INFINITY, f64::min) > 0.0;
        let error = if lasts { shares.fold(0.0, f64::max) } else { 0.0 };
        ErrorLaw { error, order: 1.0, across: self.across, converges: true }
    }

    /// Convergence of the greatest pressure at any time.
    pub(super) fn pressure_over_time(&self) -> ErrorLaw {
        ErrorLaw::smooth(&self.each(|differences| differences.pressure_over_time), self.across)
    }

    /// Convergence of the contact radius at any time.
    pub(super) fn radius(&self) -> ErrorLaw {
        ErrorLaw::by_cells(&self.each(|differences| differences.radius), self.across)
    }

    /// Convolution equivalents of the run, which grow with the cells.
    pub(super) fn work(&self) -> ErrorLaw {
        let (error, order) = (self.finest.convolutions, -self.work_order);
        ErrorLaw { error, order, across: self.across, converges: true }
    }

    /// Convergence of the greatest pressure of the run, which requires that the finest mesh resolves the peak.
    /// Differences of a single number may be small or large by chance: where they agree with the estimate from the
    /// neighbours of the peak, the pressure is as smooth as in an elastic contact.
    fn pressure(&self) -> ErrorLaw {
        let pressure = self.each(|differences| differences.pressure);
        let law = ErrorLaw::smooth(&pressure, self.across);
        let Some(peak) = self.highest().and_then(|state| state.peak) else {
            return ErrorLaw { converges: false, ..law };
        };
        if pressure.last().is_some_and(|&last| last <= MAX_DIFFERENCE_OVER_PEAK * peak) {
            let error = ErrorLaw::second_order(&pressure).max(peak);
            return ErrorLaw { error, order: ORDERS[1], converges: true, ..law };
        }
        law
    }

    /// Whether the pressure was no greater while the contact was too small to be resolved, as under a ramp on a body
    /// that creeps fast. The pressure on elastic bodies under the same loads is an upper bound.
    fn bounds_small_contacts(&self, scene: &TrialScene<'_>, size: &ContactSize) -> Result<bool> {
        let Run { states, steps, .. } = &self.finest;
        let Some(highest) = self.highest() else { return Ok(false) };
        let small = |state: &StepState| !state.resolved || state.radius == 0.0;
        let starts = std::iter::once(true).chain(states.iter().map(small));
        let ends =
            starts.zip(states).zip(steps).filter(|((start, state), _)| *start && !small(state) && state.time > 0.0);
        let normal = |load: &Load| match *load {
            Load::Approach { approach, .. } | Load::Spring { drive: approach, .. } => (false, approach),
            Load::Force { normal, .. } => (true, normal),
        };
        for by_force in [true, false] {
            let loads = ends.clone().map(|(_, (_, load))| load).filter(|load| normal(load).0 == by_force);
            let Some(&load) = loads.max_by(|a, b| normal(a).1.total_cmp(&normal(b).1)) else { continue };
            let mut elastic = scene.builder(size.grid(self.across)?)?.build()?;
            let resolved = elastic.step(0.0, load).is_ok() && elastic.contact_cells() >= BOUNDING_CELLS;
            if !resolved || BOUNDING_MARGIN * elastic.max_pressure() > highest.pressure {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Cells across for an `accuracy` of which `left` is allowed as error of approach and force.
    pub(super) fn across_for(&self, pressure: ErrorLaw, left: f64, accuracy: Accuracy, area: bool) -> f64 {
        let main = self.main().across_for(left).max(self.singular().across_for(left));
        let others = [Some(pressure).filter(|law| law.converges), area.then(|| self.radius())];
        others.into_iter().flatten().map(|law| law.across_for(accuracy.space())).fold(main, f64::max)
    }

    /// The state with the greatest pressure.
    fn highest(&self) -> Option<&StepState> {
        self.finest.states.iter().max_by(|a, b| a.pressure.total_cmp(&b.pressure))
    }
}

/// A run whose steps are short enough, on meshes that show how it converges.
pub(super) struct ConvergedRun {
    pub(super) steps: Steps,
    pub(super) meshes: Meshes,
    /// Convergence of the greatest pressure of the run.
    pub(super) pressure: ErrorLaw,
    /// Half sides of the rectangle about the origin that contained the contact.
    pub(super) reach: [f64; 2],
}

/// Finds the steps and the meshes; `area` states whether the contact radius has to be resolved.
pub(super) fn converge(scene: &TrialScene<'_>, size: &ContactSize, area: bool) -> Result<ConvergedRun> {
    let mut first = size.grid(STEPS_ACROSS)?;
    if first.cells().into_iter().any(|cells| cells > MOST_TRIAL_CELLS) {
        first = size.grid(LEAST_ACROSS)?;
    }
    let punch = scene.has_edge(&first);
    let steps = Steps::find(scene, &first)?;
    let scene = &TrialScene { tolerance: steps.tolerance, ..*scene };
    // a period holds all of its contacts
    let is_period = size.sides.iter().any(|side| matches!(side, Side::Period(_)));
    let zoomed =
        match scene.before_growth(&steps.run).filter(|_| !is_period).map(|until| small_contact(scene, until, size)) {
            Some(Err(error @ (Error::OutOfMemory { .. } | Error::Cancelled { .. }))) => return Err(error),
            // the run succeeds without a separate domain for this part
            Some(law) => Some(law.unwrap_or(ErrorLaw::NONE)),
            None => None,
        };
    let base = scene.repeat(size.grid(LEAST_ACROSS)?, &steps.run.steps)?;
    let left = steps.left_for_mesh(scene.accuracy);
    let meshes = Meshes::refine(scene, size, (base, punch), |meshes| {
        // a pressure on a separate domain does not determine the cells of these meshes
        let pressure = if zoomed.is_some() { ErrorLaw::NONE } else { meshes.pressure() };
        meshes.across_for(pressure, left, scene.accuracy, area)
    })?;
    let mut pressure = zoomed.unwrap_or_else(|| meshes.pressure());
    if zoomed.is_none() && pressure.converges && !meshes.bounds_small_contacts(scene, size)? {
        pressure = ErrorLaw::NONE;
    }
    let reach = [0, 1].map(|axis| size.reach[axis].max(meshes.finest.size.reach[axis]));
    Ok(ConvergedRun { steps, meshes, pressure, reach })
}

/// Convergence of a greatest pressure that occurs before the contact grows much: from the run to `until` on a separate
/// domain.
fn small_contact(scene: &TrialScene<'_>, until: f64, whole: &ContactSize) -> Result<ErrorLaw> {
    let (mut until, mut zooms) = (until, 0);
    let (part, size, base) = loop {
        let part = TrialScene { until, ..*scene };
        let (size, base) = ContactSize::of(&part)?
            .on_growing_domain(|size| Ok((*size, part.follow(size.grid(LEAST_ACROSS)?, &[])?)))?;
        zooms += 1;
        match part.before_growth(&base).filter(|_| zooms < MAX_ZOOMS) {
            Some(earlier) => until = earlier,
            None => break (part, size, base),
        }
    };
    let (meshes, bounded) = size.on_growing_domain(|size| {
        let base = part.repeat(size.grid(LEAST_ACROSS)?, &base.steps)?;
        let meshes = Meshes::refine(&part, size, (base, false), |meshes| {
            let pressure = meshes.pressure();
            if pressure.converges {
                pressure.across_for(scene.accuracy.space())
            } else if meshes.highest().is_some_and(|state| state.resolved) {
                0.0
            } else {
                f64::INFINITY
            }
        })?;
        let bounded = meshes.bounds_small_contacts(&part, size)?;
        Ok((meshes, bounded))
    })?;
    if !bounded {
        return Ok(ErrorLaw::NONE);
    }
    let larger = [0, 1].map(|axis| whole.width[axis] / size.width[axis]);
    let across = meshes.across * larger[0].max(larger[1]);
    Ok(ErrorLaw { across, ..meshes.pressure() })
}
