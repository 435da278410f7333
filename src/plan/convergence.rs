//! How the elastic states of a run, or its own states, converge with the mesh.

use crate::error::{Error, Result, StatesError};
use crate::load::Load;
use crate::plan::Accuracy;
use crate::plan::domain::{ContactSize, Side};
use crate::plan::error_law::{ErrorLaw, ORDERS};
use crate::plan::levels::Curve;
use crate::plan::loads::Loads;
use crate::plan::steps::{Differences, Steps, relative};
use crate::plan::trial_runs::{Probe, Run, StepState, TrialScene, greatest};

/// Cells across the widest contact on the coarsest mesh, where the steps are found, and on the finest that a plan computes, unless it
/// could not be planned then.
const LEAST_ACROSS: f64 = 16.0;
const MOST_ACROSS: f64 = 128.0;
/// Most cells along a side of a domain in which the contact is small, for example far off the centre.
const MOST_TRIAL_CELLS: f64 = 2048.0;
/// Most cells along a side of a plan: more exceed the memory of a workstation.
pub(super) const MOST_PLANNED_CELLS: f64 = 8192.0;
/// A plan extrapolates to meshes at most this many times finer, unless `MOST_ACROSS` is reached.
const MAX_EXTRAPOLATION: f64 = 3.0;
/// Greatest difference of the greatest pressure that counts as second order, over the estimate from the neighbours of
/// the peak. A difference of second order is three times the error on the finer mesh.
const MAX_DIFFERENCE_OVER_PEAK: f64 = 4.0;
/// Upper limit of the power of the number of cells across with which the convolutions of a run grow.
const MAX_WORK_ORDER: f64 = 0.4;
/// Least width of the contact on a finer mesh, as a fraction of the width on a coarse one.
const MIN_NARROWING: f64 = 0.25;
/// Levels of the states of a curve over the greatest, and their depths over the greatest, as of a paraboloid.
const LEVELS: [f64; 3] = [1.0 / 4.0, 1.0 / 16.0, 1.0 / 64.0];
const DEPTHS: [f64; 3] = [0.4, 0.16, 0.064];
/// Ratio of the levels at which meshes are compared, and the most of them.
const RATIO: f64 = 1.6;
const MAX_LEVELS: usize = 8;
const LARGEST_RATIO: f64 = 2.5;
/// A contact of greatest pressure narrower than this fraction of the largest contact gets a separate domain.
const SMALL_CONTACT: f64 = 1.0 / 3.0;
/// Levels nearer than this fraction are one.
const SAME_LEVEL: f64 = 1e-2;
/// Least width of the contact of a trial run, as a fraction of the expected width.
const MIN_WIDTH: f64 = 0.75;

impl ContactSize {
    /// Size of the elastic contacts under these loads on a mesh that resolves them: a contact far off the middle is only a
    /// few cells wide on the coarsest mesh.
    fn of(scene: &TrialScene<'_>, loads: &[Load]) -> Result<ContactSize> {
        let size = scene.size(loads)?;
        if [0, 1].iter().all(|&axis| size.sides[axis] != Side::Found || size.width[axis] > size.reach[axis]) {
            return Ok(size);
        }
        size.on_growing_domain(|size| {
            let finer = scene.elastic(size.grid(LEAST_ACROSS)?, loads)?.size;
            // a contact may be a few cells wide on any mesh
            let width = [0, 1].map(|axis| finer.width[axis].max(MIN_NARROWING * size.width[axis]));
            Ok(ContactSize { width, ..finer })
        })
    }
}

/// States on successive meshes, each twice as fine as the last. Cells are counted across the widest contact of the whole run.
pub(super) struct Meshes {
    /// Whether the shape has an edge, as a punch.
    punch: bool,
    across: f64,
    /// Differences between each mesh and the one before.
    differences: Vec<Differences>,
    finest: Run,
    /// Index of the state with the greatest pressure, if it is known.
    highest: Option<usize>,
    /// Error of the contact radius due to creep at the rim.
    rim: ErrorLaw,
    /// Power of the cells across with which the convolutions grow.
    work_order: f64,
}

impl Meshes {
    /// The coarsest mesh.
    fn coarsest(finest: Run, punch: bool) -> Meshes {
        let (across, differences, work_order) = (LEAST_ACROSS, Vec::new(), 0.0);
        Meshes { punch, across, differences, finest, highest: None, rim: ErrorLaw::NONE.times(0.0), work_order }
    }

    /// Refines until the needed number of cells across is within the range of extrapolation: `needed` without quantities that a plan
    /// may leave out, or with them.
    fn refine(
        mut self,
        scene: &TrialScene<'_>,
        size: &ContactSize,
        probe: &Probe<'_>,
        needed: impl Fn(&Meshes, bool) -> f64,
    ) -> Result<Meshes> {
        let meshes = &mut self;
        loop {
            meshes.across *= 2.0;
            let grid = size.grid(meshes.across)?;
            let [n1, n2] = grid.cells();
            let finer = scene.probe(grid, probe)?;
            meshes.differences.push(Differences::between(&meshes.finest.states, &finer.states, meshes.highest));
            let growth = relative(finer.convolutions, meshes.finest.convolutions);
            meshes.work_order = growth.max(1.0).log2().min(MAX_WORK_ORDER);
            meshes.finest = finer;
            let reach = if meshes.differences.len() < 2 { 1.0 } else { MAX_EXTRAPOLATION };
            let [n1, n2] = [n1, n2].map(|cells| cells as f64);
            let sides = size.cells(needed(meshes, false));
            let can_be_planned = sides[0].max(sides[1]) <= MOST_PLANNED_CELLS;
            let last = meshes.across >= MOST_ACROSS && can_be_planned || 2.0 * n1.max(n2) > MOST_TRIAL_CELLS;
            if last || needed(meshes, true) <= reach * meshes.across {
                return Ok(self);
            }
        }
    }

    /// The differences of one quantity, from the coarsest mesh to the finest.
    fn each(&self, of: impl Fn(&Differences) -> f64) -> Vec<f64> {
        self.differences.iter().map(of).collect()
    }

    /// Convergence of approach and force; for a punch, whose rim is resolved to a cell, by fractions of a cell.
    fn main(&self) -> ErrorLaw {
        let law = if self.punch { ErrorLaw::by_cells } else { ErrorLaw::smooth };
        law(&self.each(|differences| differences.main), self.across)
    }

    /// First-order part of the error, estimated from the rim. Creep raises the pressure at a growing rim too, but at
    /// edges of the shape the pressure is raised from the start.
    fn singular(&self) -> ErrorLaw {
        let states = &self.finest.states;
        let deepest = greatest(states, |state| state.approach);
        let shares = states.iter().map(|state| state.singular * relative(state.approach.abs(), deepest));
        let touching = states.iter().filter(|state| state.force > 0.0);
        let lasts = self.punch || touching.map(|state| state.singular).fold(f64::INFINITY, f64::min) > 0.0;
        let error = if lasts { shares.fold(0.0, f64::max) } else { 0.0 };
        ErrorLaw { error, order: 1.0, across: self.across, converges: true }
    }

    /// Convergence of the greatest pressure at any time.
    fn pressure_over_time(&self) -> ErrorLaw {
        ErrorLaw::smooth(&self.each(|differences| differences.pressure_over_time), self.across)
    }

    /// Convergence of the contact radius at any time.
    fn radius(&self) -> ErrorLaw {
        let law = ErrorLaw::by_cells(&self.each(|differences| differences.radius), self.across);
        ErrorLaw { error: law.error.max(self.rim.at(self.across)), ..law }
    }

    /// Convergence of the greatest pressure, which requires that the finest mesh resolves the peak. Differences of a
    /// single number may be small or large by chance: where they agree with the estimate from the neighbours of the peak,
    /// the pressure is as smooth as in an elastic contact.
    fn pressure(&self) -> ErrorLaw {
        let pressure = self.each(|differences| differences.pressure);
        let law = ErrorLaw::smooth(&pressure, self.across);
        let highest = match self.highest {
            Some(highest) => self.finest.states.get(highest),
            None => self.finest.highest_resolved(),
        };
        let Some(peak) = highest.and_then(|state| state.peak) else {
            return ErrorLaw { converges: false, ..law };
        };
        if pressure.last().is_some_and(|&last| last <= MAX_DIFFERENCE_OVER_PEAK * peak) {
            let error = ErrorLaw::second_order(&pressure).max(peak);
            return ErrorLaw { error, order: ORDERS[1], converges: true, ..law };
        }
        law
    }
}

impl Run {
    /// The state with the greatest pressure of a run, if the contact was resolved from the start until then.
    fn highest_resolved(&self) -> Option<&StepState> {
        let highest = self.states.iter().enumerate().max_by(|a, b| a.1.pressure.total_cmp(&b.1.pressure));
        highest.filter(|(k, _)| self.states[..=*k].iter().all(|state| state.resolved)).map(|(_, state)| state)
    }
}

/// How the errors of a run fall with its mesh.
pub(super) struct ConvergedRun {
    pub(super) steps: Steps,
    /// Convergence of approach and force, and the first-order part of it.
    pub(super) main: ErrorLaw,
    pub(super) singular: ErrorLaw,
    /// Convergence of the greatest pressure of the run, and of that at any time.
    pub(super) pressure: ErrorLaw,
    pub(super) pressure_over_time: ErrorLaw,
    pub(super) radius: ErrorLaw,
    /// Convolution equivalents of the run, which grow with the cells.
    pub(super) work: ErrorLaw,
    /// Size of the contact.
    pub(super) size: ContactSize,
}

impl ConvergedRun {
    /// Cells across for an `accuracy` of which the steps leave a part as error of approach and force.
    pub(super) fn across_for(&self, pressure: ErrorLaw, accuracy: Accuracy, area: bool) -> f64 {
        let left = self.steps.left_for_mesh(accuracy);
        across_for([self.main, self.singular].map(|law| (law, left)), pressure, self.radius, accuracy, area)
    }
}

fn across_for(main: [(ErrorLaw, f64); 2], pressure: ErrorLaw, radius: ErrorLaw, accuracy: Accuracy, area: bool) -> f64 {
    let main = main.into_iter().map(|(law, left)| law.across_for(left)).fold(0.0, f64::max);
    let others = [Some(pressure).filter(|law| law.converges), area.then_some(radius)];
    others.into_iter().flatten().map(|law| law.across_for(accuracy.space())).fold(main, f64::max)
}

/// Finds domain, steps and meshes; `area` states whether the contact radius has to be resolved.
pub(super) fn converge(scene: &TrialScene<'_>, area: bool) -> Result<ConvergedRun> {
    let loads = Loads::of(scene)?;
    let size = ContactSize::of(scene, &loads.largest)?;
    match size.on_growing_domain(|size| converge_on(scene, &loads, size, area)) {
        // trial runs need no states
        Err(Error::States(StatesError::Shrinks { .. })) => {
            let loads = Loads { on_states: false, ..loads };
            size.on_growing_domain(|size| converge_on(scene, &loads, size, area))
        }
        other => other,
    }
}

fn converge_on(scene: &TrialScene<'_>, loads: &Loads, size: &ContactSize, area: bool) -> Result<ConvergedRun> {
    let grid = size.grid(LEAST_ACROSS)?;
    let curve = if loads.on_states { curve(scene, &loads.largest, grid.clone())? } else { None };
    let steps = Steps::find(scene, &grid, curve.as_ref())?;
    // an upper bound of the level is larger than the contact
    let is_found = |axis: usize| size.sides[axis] == Side::Found;
    let is_narrow = |axis: usize| is_found(axis) && steps.run.size.width[axis] < MIN_WIDTH * size.width[axis];
    if steps.run.size.width != [0.0; 2] && [0, 1].into_iter().any(is_narrow) && steps.run.size != *size {
        return converge_on(scene, loads, &steps.run.size, area);
    }
    let (punch, left) = (scene.has_edge(&grid), steps.left_for_mesh(scene.accuracy));
    let Some((curve, trace)) = curve.zip(steps.trace) else {
        let probe = Probe::Steps(&steps.run.steps);
        let meshes = Meshes::coarsest(steps.run.clone(), punch).refine(scene, size, &probe, |meshes, all| {
            let main = [meshes.main(), meshes.singular()].map(|law| (law, left));
            let pressure = if all { meshes.pressure() } else { ErrorLaw::NONE };
            across_for(main, pressure, meshes.radius(), scene.accuracy, area)
        })?;
        let pressure = meshes.pressure();
        return Ok(converged(steps, &meshes, meshes.main(), pressure, size));
    };
    let load = |level: f64| match loads.largest[0] {
        Load::Force { tilt, .. } => Load::Force { normal: level, tilt },
        other => Load::Approach { approach: curve.approach(level), tilt: other.tilt() },
    };
    let (mut levels, peak) = (levels(trace.levels), trace.level);
    let is_period = size.sides.iter().any(|side| matches!(side, Side::Period(_)));
    // a period holds all of its contacts
    let is_small = !is_period && curve.radius(peak) < SMALL_CONTACT * curve.radius(trace.levels[1]);
    let is_at = |level: &f64| (peak / level - 1.0).abs() < SAME_LEVEL;
    let highest = levels.iter().position(is_at).unwrap_or(levels.len());
    if highest == levels.len() && peak > 0.0 && !is_small {
        levels.push(peak);
    }
    let states: Vec<Load> = levels.into_iter().map(load).collect();
    // the levels of a punch are alike: their errors are in proportion to themselves, and so is the error of the run
    let amplification = if punch { 1.0 } else { trace.force_amplification };
    let main = |meshes: &Meshes| meshes.main().times(amplification);
    // a pressure on a separate domain does not determine the cells of these meshes
    let pressure = |meshes: &Meshes| match trace.excess == 0.0 && peak > 0.0 && !is_small {
        true => meshes.pressure().times(trace.pressure_amplification),
        false => ErrorLaw::NONE,
    };
    let (base, probe) = (scene.growing(grid, &states)?, Probe::Elastic(&states));
    let rim = ErrorLaw { error: trace.rim, order: 1.0, across: LEAST_ACROSS, converges: true };
    let coarsest = Meshes { highest: Some(highest), rim, ..Meshes::coarsest(base, punch) };
    let meshes = coarsest.refine(scene, size, &probe, |meshes, all| {
        let main = [main(meshes), meshes.singular()].map(|law| (law, left));
        let pressure = if all { pressure(meshes) } else { ErrorLaw::NONE };
        across_for(main, pressure, meshes.radius(), scene.accuracy, area)
    })?;
    let pressure = if is_small && trace.excess == 0.0 && peak > 0.0 {
        match small_contact(scene, load(peak), size) {
            Err(error @ (Error::OutOfMemory { .. } | Error::Cancelled { .. })) => return Err(error),
            // the run succeeds without a separate domain for this part
            law => law.map_or(ErrorLaw::NONE, |law| law.times(trace.pressure_amplification)),
        }
    } else {
        pressure(&meshes)
    };
    Ok(converged(steps, &meshes, main(&meshes), pressure, size))
}

/// The levels at which meshes are compared, the greatest first: the run is made of the states between its least level
/// and its greatest.
fn levels([least, greatest]: [f64; 2]) -> Vec<f64> {
    let parts = ((greatest / least).ln() / RATIO.ln()).ceil().clamp(0.0, (MAX_LEVELS - 1) as f64);
    let ratio = if parts > 0.0 { (greatest / least).powf(1.0 / parts).min(LARGEST_RATIO) } else { 1.0 };
    let mut levels: Vec<f64> = (0..=parts as usize).map(|k| greatest / ratio.powf(k as f64)).collect();
    levels.extend(levels.last().filter(|last| least < (1.0 - SAME_LEVEL) * **last).map(|_| least));
    levels
}

/// A curve through elastic states on a mesh; `None` where they do not ascend.
fn curve(scene: &TrialScene<'_>, largest: &[Load], grid: crate::Grid) -> Result<Option<Curve>> {
    let mut loads = largest.to_vec();
    loads.dedup();
    let top = scene.elastic(grid.clone(), &loads)?;
    let depth = greatest(&top.states, |state| state.depth - top.rest);
    loads.extend(largest.iter().take(1).flat_map(|load| {
        (0..LEVELS.len()).map(|k| match *load {
            Load::Force { normal, tilt } => Load::Force { normal: LEVELS[k] * normal, tilt },
            _ => Load::Approach { approach: top.rest + DEPTHS[k] * depth, tilt: load.tilt() },
        })
    }));
    let base = scene.growing(grid, &loads)?;
    let line = scene.body.sides.iter().any(|side| matches!(side, Side::Uniform(_)));
    Ok(Curve::through(&base, loads[0].tilt(), line).ok())
}

fn converged(steps: Steps, meshes: &Meshes, main: ErrorLaw, pressure: ErrorLaw, size: &ContactSize) -> ConvergedRun {
    let reaches = [size.reach, steps.run.size.reach, meshes.finest.size.reach];
    let reach = [0, 1].map(|axis| reaches.map(|reach| reach[axis]).into_iter().fold(0.0, f64::max));
    let (error, order) = (steps.run.convolutions, -meshes.work_order);
    let work = ErrorLaw { error, order, across: LEAST_ACROSS, converges: true };
    ConvergedRun {
        steps,
        main,
        singular: meshes.singular(),
        pressure,
        pressure_over_time: meshes.pressure_over_time(),
        radius: meshes.radius(),
        work,
        size: ContactSize { reach, ..*size },
    }
}

/// Convergence of the greatest pressure of an elastic contact on a separate domain.
fn small_contact(scene: &TrialScene<'_>, load: Load, whole: &ContactSize) -> Result<ErrorLaw> {
    let (loads, size) = ([load], ContactSize::of(scene, &[load])?);
    let converged = size.on_growing_domain(|size| {
        let base = scene.elastic(size.grid(LEAST_ACROSS)?, &loads)?;
        // a tip
        if base.states[0].peak.is_none() {
            return Ok(None);
        }
        let coarsest = Meshes { highest: Some(0), ..Meshes::coarsest(base, false) };
        let meshes = coarsest.refine(scene, size, &Probe::Elastic(&loads), |meshes, all| {
            let pressure = meshes.pressure();
            if all && pressure.converges { pressure.across_for(scene.accuracy.space()) } else { 0.0 }
        })?;
        Ok(Some((*size, meshes)))
    })?;
    let Some((size, meshes)) = converged else { return Ok(ErrorLaw::NONE) };
    let larger = [0, 1].map(|axis| whole.width[axis] / size.width[axis]);
    let law = meshes.pressure();
    Ok(ErrorLaw { across: meshes.across * larger[0].max(larger[1]), ..law })
}
