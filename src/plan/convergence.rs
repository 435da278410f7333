//! How the elastic states of a run, or its own states, converge with the mesh.

use std::f64::consts::SQRT_2;

use crate::error::{Error, Result, StatesError};
use crate::load::Load;
use crate::plan::difference::greatest;
use crate::plan::domain::{ContactSize, LEAST_ACROSS, Side};
use crate::plan::error_law::{ErrorLaw, ORDERS};
use crate::plan::fields::{FieldOnLevels, PlannedField};
use crate::plan::levels::Curve;
use crate::plan::loads::Loads;
use crate::plan::meshes::{Laws, Meshes, Wanted};
use crate::plan::scene::TrialScene;
use crate::plan::steps::Steps;
use crate::states::unless_refused;

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
/// Cells across a contact from which on the error of the approach does not depend on where the tip lies among them, and this error over the
/// depth of a contact whose radius is half the diagonal of a cell: cones and balls err by at most 0.27 and 0.15 of it where half a
/// cell is in contact, cones by up to 0.56 where less is.
const FEW: f64 = 1.6;
const OF_TIP: f64 = 0.3;
/// The part of it that is left where the contact is as wide: it falls with the width.
const OF_WIDER: f64 = 0.25;
/// Least width of the contact of a trial run, as a fraction of the expected width.
const MIN_WIDTH: f64 = 0.75;

impl ContactSize {
    /// Size of the elastic contacts under these loads on a mesh that resolves them: a contact far off the middle is only a
    /// few cells wide on the coarsest mesh.
    fn of(scene: &TrialScene<'_>, loads: &[Load]) -> Result<ContactSize> {
        let size = ContactSize::around(scene, loads)?;
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

/// How the errors of a run fall with its mesh.
pub(super) struct ConvergedRun {
    pub(super) steps: Steps,
    pub(super) laws: Laws,
    pub(super) wanted: Wanted,
    /// Size of the contact.
    pub(super) size: ContactSize,
    /// Power of the number of cells across with which the convolutions grow.
    work_order: f64,
}

impl ConvergedRun {
    fn new(steps: Steps, meshes: &Meshes, laws: Laws, wanted: Wanted, size: &ContactSize) -> ConvergedRun {
        let reaches = [size.reach, steps.run.size.reach, meshes.finest.size.reach];
        let reach = [0, 1].map(|axis| reaches.map(|reach| reach[axis]).into_iter().fold(0.0, f64::max));
        ConvergedRun { steps, laws, wanted, size: ContactSize { reach, ..*size }, work_order: meshes.work_order }
    }

    /// Convolution equivalents of the run with so many cells across.
    pub(super) fn work(&self, across: f64) -> f64 {
        self.steps.growth() * self.steps.run.convolutions * (across / LEAST_ACROSS).powf(self.work_order)
    }
}

/// Finds domain, steps and meshes; `area` states whether the contact radius has to be resolved.
pub(super) fn converge(scene: &TrialScene<'_>, area: bool) -> Result<ConvergedRun> {
    let loads = Loads::of(scene)?;
    let size = ContactSize::of(scene, &loads.largest)?;
    match size.on_growing_domain(|size| converge_on(scene, &loads, size, area)) {
        // runs need no states
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
    let mut steps = Steps::find(scene, &grid, curve.as_ref())?;
    // an upper bound of the level is larger than the contact
    let is_found = |axis: usize| size.sides[axis] == Side::Found;
    let is_narrow = |axis: usize| is_found(axis) && steps.run.size.width[axis] < MIN_WIDTH * size.width[axis];
    if steps.run.size.width != [0.0; 2] && [0, 1].into_iter().any(is_narrow) && steps.run.size != *size {
        return converge_on(scene, loads, &steps.run.size, area);
    }
    let (punch, target) = (scene.has_edge(&grid), scene.asked.accuracy);
    let (is_asked, end) = (!scene.asked.fields.is_empty(), [scene.asked.until]);
    let (times, fields) = if is_asked { (scene.asked.fields, target.field_space()) } else { (&end[..], f64::INFINITY) };
    let wanted = Wanted { main: steps.left_for_mesh(target), others: target.space(), area, fields };
    let Some((curve, trace)) = curve.zip(steps.trace) else {
        // a finer run beside a coarser one
        let (coarse, times) = (steps.run.clone(), steps.run.times());
        let fields = times.iter().map(|time| PlannedField::of_run(&coarse, *time)).collect();
        let meshes = Meshes { fields, ..Meshes::coarsest(coarse.clone(), punch) }
            .refine(size, &wanted, |grid| Ok(scene.follow(grid, steps.tolerance, &times)?.at_the_times_of(&coarse)))?;
        let laws = meshes.laws();
        return Ok(ConvergedRun::new(steps, &meshes, laws, wanted, size));
    };
    let load = |level: f64| match loads.largest[0] {
        Load::Force { tilt, .. } => Load::Force { normal: level, tilt },
        other => Load::Approach { approach: curve.approach(level), tilt: other.tilt() },
    };
    let (mut levels, peak) = (levels(trace.levels[0], trace.levels[1]), trace.level);
    let is_period = size.sides.iter().any(|side| matches!(side, Side::Period(_)));
    // a period holds all of its contacts
    let is_small = !is_period && curve.radius(peak) < SMALL_CONTACT * curve.radius(trace.levels[1]);
    let has_peak = trace.cells.converges && peak > 0.0;
    let is_at = |level: &f64| (peak / level - 1.0).abs() < SAME_LEVEL;
    let highest = levels.iter().position(is_at).unwrap_or(levels.len());
    if highest == levels.len() && peak > 0.0 && !is_small {
        levels.push(peak);
    }
    let fields = FieldOnLevels::at(scene, &curve, trace.levels[1], times).map(Some);
    let fields = if is_asked { fields } else { unless_refused(fields) }?.unwrap_or_default();
    let fields = fields.into_iter().map(|field| {
        let off = |k: &usize| (field.level / levels[*k]).ln().abs();
        let nearest = (0..levels.len()).min_by(|one, other| off(one).total_cmp(&off(other)));
        let state = nearest.filter(|nearest| !is_asked || off(nearest) < SAME_LEVEL).unwrap_or(levels.len());
        levels.extend((state == levels.len()).then_some(field.level));
        PlannedField::on_levels(state, field, punch)
    });
    let fields = fields.collect();
    let states: Vec<Load> = levels.into_iter().map(load).collect();
    let coarsest = Meshes {
        highest: Some(highest),
        fields,
        rim: trace.rim,
        // the levels of a punch are alike: their errors are in proportion to themselves, and so is the error of the run
        force_amplification: if punch { 1.0 } else { trace.force_amplification },
        // a pressure on a separate domain does not determine the cells of these meshes
        pressure_amplification: (has_peak && !is_small).then_some(trace.pressure_amplification),
        ..Meshes::coarsest(scene.growing(grid, &states)?, punch)
    };
    let meshes = coarsest.refine(size, &wanted, |grid| scene.growing(grid, &states))?;
    let mut laws = meshes.laws();
    if is_small && has_peak {
        match small_contact(scene, load(peak), size) {
            Err(error @ (Error::OutOfMemory { .. } | Error::Cancelled { .. })) => return Err(error),
            // the run succeeds without a separate domain for this part
            Err(_) | Ok(None) => {}
            Ok(Some(law)) => laws.pressure = law.times(trace.pressure_amplification),
        }
    }
    laws.at_rim = trace.cells;
    if matches!(loads.largest[0], Load::Force { .. }) && size.sides == [Side::Found; 2] && !punch {
        let tip = tip(&curve, curve.radius(trace.levels[0]) / curve.radius(trace.levels[1]), wanted.main);
        laws.main = if tip.across_for(wanted.main) > laws.main.across_for(wanted.main) { tip } else { laws.main };
    }
    if laws.pressure.converges {
        steps.stop_before_peaks(scene, &curve, laws.across_for(&wanted))?;
    }
    Ok(ConvergedRun::new(steps, &meshes, laws, wanted, size))
}

/// The levels at which meshes are compared, the greatest first: the run is made of the states between its least level
/// and its greatest.
fn levels(least: f64, greatest: f64) -> Vec<f64> {
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
    let line = scene.asked.body.sides.iter().any(|side| matches!(side, Side::Uniform(_)));
    Ok(Curve::through(&base, loads[0].tilt(), line).ok())
}

/// The error of the approach while the contact is narrower than [`FEW`] cells, by where the tip lies among them: half the rise of the surface
/// within half the diagonal of a cell, a part of the depth of a contact of this radius. The least radius of the run is this part of the greatest.
fn tip(curve: &Curve, least: f64, allowed: f64) -> ErrorLaw {
    let order = curve.order.clamp(ORDERS[0], ORDERS[1]);
    let law =
        ErrorLaw { error: OF_TIP * (SQRT_2 / LEAST_ACROSS).powf(order), order, across: LEAST_ACROSS, converges: true };
    let few = FEW / least;
    let wider = ErrorLaw { error: OF_WIDER * law.at(few), order: order + 1.0, across: few, ..law };
    match () {
        () if law.at(few) <= allowed => law,
        () if wider.error <= allowed => ErrorLaw { error: allowed, across: few, ..law },
        () => wider,
    }
}

/// Convergence of the greatest pressure of an elastic contact on a separate domain.
fn small_contact(scene: &TrialScene<'_>, load: Load, whole: &ContactSize) -> Result<Option<ErrorLaw>> {
    let (loads, size) = ([load], ContactSize::of(scene, &[load])?);
    let wanted =
        Wanted { main: f64::INFINITY, others: scene.asked.accuracy.space(), area: false, fields: f64::INFINITY };
    size.on_growing_domain(|size| {
        let base = scene.elastic(size.grid(LEAST_ACROSS)?, &loads)?;
        // a tip
        if base.states[0].peak.is_none() {
            return Ok(None);
        }
        let coarsest = Meshes { highest: Some(0), ..Meshes::coarsest(base, false) };
        let meshes = coarsest.refine(size, &wanted, |grid| scene.elastic(grid, &loads))?;
        let larger = [0, 1].map(|axis| whole.width[axis] / size.width[axis]);
        let law = meshes.laws().pressure;
        Ok(Some(ErrorLaw { across: law.across * larger[0].max(larger[1]), ..law }))
    })
}
