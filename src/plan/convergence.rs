//! How the states of a run converge with the mesh.

use crate::Grid;
use crate::error::{Error, Result};
use crate::load::Load;
use crate::plan::convergence_fit::{Convergence, MeshConvergence, ORDERS};
use crate::plan::steps::{Differences, Steps, relative};
use crate::plan::trial_runs::{Extent, Run, Scene, State, greatest};

/// Cells across the widest contact on the coarsest mesh, and on the finest that a plan computes.
const LEAST_ACROSS: f64 = 16.0;
const MOST_ACROSS: f64 = 128.0;
/// Cells across the widest contact where the steps are found.
const STEPS_ACROSS: f64 = 32.0;
/// Most cells along a side of a domain in which the contact is small, for example far off the centre.
const MOST_CELLS: usize = 2048;
/// A plan extrapolates to meshes at most this many times finer, unless `MOST_ACROSS` is reached.
const MAX_EXTRAPOLATION: f64 = 3.0;
/// Most domains for ever smaller contacts.
const MAX_ZOOMS: usize = 12;
/// Growth factor of a domain whose edge the contact reaches on a finer mesh, and the greatest number of growths.
const GROWTH: f64 = 1.2;
const MAX_GROWTHS: u32 = 5;
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
/// Ratio of the domain to the rectangle of the contact.
pub(super) const DOMAIN_TO_CONTACT: f64 = 1.12;

/// The grid with `across` cells across the widest contact.
pub(super) fn grid_with(extent: &Extent, across: f64) -> Result<Grid> {
    let lengths = extent.reach.map(|half| 2.0 * DOMAIN_TO_CONTACT * half);
    let cells = [0, 1].map(|axis| smooth_size((across * lengths[axis] / extent.width[axis]).ceil() as usize));
    Grid::new(cells, lengths)
}

impl Extent {
    /// Extent of the contact on a mesh that resolves it: a contact far off the middle is only a few cells wide on the
    /// coarsest mesh.
    pub(super) fn of(scene: &Scene<'_>) -> Result<Extent> {
        let extent = scene.extent()?;
        if [0, 1].iter().all(|&axis| extent.width[axis] > extent.reach[axis]) {
            return Ok(extent);
        }
        extent.held(|extent| {
            let finer = scene.follow(grid_with(extent, LEAST_ACROSS)?, &[])?.extent;
            // a contact may be a few cells wide on any mesh
            let width = [0, 1].map(|axis| finer.width[axis].max(MIN_NARROWING * extent.width[axis]));
            Ok(Extent { width, ..finer })
        })
    }

    /// Runs `compute` on domains that grow until they contain the contact.
    pub(super) fn held<T>(&self, compute: impl Fn(&Extent) -> Result<T>) -> Result<T> {
        let mut extent = *self;
        for _ in 0..MAX_GROWTHS {
            match compute(&extent) {
                Err(Error::ContactAtEdge { .. }) => extent.reach = extent.reach.map(|half| GROWTH * half),
                other => return other,
            }
        }
        compute(&extent)
    }
}

/// Runs on successive meshes, each twice as fine as the last.
struct Meshes {
    across: f64,
    /// Differences between each mesh and the one before.
    differences: Vec<Differences>,
    finest: Run,
    /// Power of the cells across with which the convolutions grow.
    work_order: f64,
}

impl Meshes {
    /// Refines until the needed number of cells across is within the range of extrapolation.
    fn refine(scene: &Scene<'_>, extent: &Extent, base: Run, needed: impl Fn(&Meshes) -> f64) -> Result<Meshes> {
        let mut meshes = Meshes { across: LEAST_ACROSS, differences: Vec::new(), finest: base, work_order: 0.0 };
        loop {
            meshes.across *= 2.0;
            let grid = grid_with(extent, meshes.across)?;
            let [n1, n2] = grid.cells();
            let finer = scene.repeat(grid, &meshes.finest.steps)?;
            meshes.differences.push(Differences::between(&meshes.finest.states, &finer.states));
            let growth = relative(finer.convolutions, meshes.finest.convolutions);
            meshes.work_order = growth.max(1.0).log2().min(MAX_WORK_ORDER);
            meshes.finest = finer;
            let reach = if meshes.differences.len() < 2 { 1.0 } else { MAX_EXTRAPOLATION };
            let last = meshes.across >= MOST_ACROSS || 2 * n1.max(n2) > MOST_CELLS;
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
    fn main(&self, punch: bool) -> Convergence {
        let law = if punch { Convergence::by_cells } else { Convergence::smooth };
        law(&self.each(|differences| differences.main), self.across)
    }

    /// First-order part of the error, estimated from the rim. Creep raises the pressure at a growing rim too, but at
    /// edges of the shape the pressure is raised from the start.
    fn singular(&self, punch: bool) -> Convergence {
        let states = &self.finest.states;
        let deepest = greatest(states, |state| state.approach);
        let shares = states.iter().map(|state| state.singular * relative(state.approach.abs(), deepest));
        let touching = states.iter().filter(|state| state.force > 0.0);
        let lasts = punch || touching.map(|state| state.singular).fold(f64::INFINITY, f64::min) > 0.0;
        let error = if lasts { shares.fold(0.0, f64::max) } else { 0.0 };
        Convergence { error, order: 1.0, across: self.across, converges: true }
    }

    fn work(&self) -> Convergence {
        let (error, order) = (self.finest.convolutions, -self.work_order);
        Convergence { error, order, across: self.across, converges: true }
    }

    /// Convergence of the greatest pressure of the run, which requires that the finest mesh resolves the peak.
    /// Differences of a single number may be small or large by chance: where they agree with the estimate from the
    /// neighbours of the peak, the pressure is as smooth as in an elastic contact.
    fn pressure(&self) -> Convergence {
        let pressure = self.each(|differences| differences.pressure);
        let law = Convergence::smooth(&pressure, self.across);
        let Some(peak) = self.highest().and_then(|state| state.peak) else {
            return Convergence { converges: false, ..law };
        };
        if pressure.last().is_some_and(|&last| last <= MAX_DIFFERENCE_OVER_PEAK * peak) {
            let error = Convergence::second_order(&pressure).max(peak);
            return Convergence { error, order: ORDERS[1], converges: true, ..law };
        }
        law
    }

    /// Whether the pressure was no greater while the contact was too small to be resolved, as under a ramp on a body
    /// that creeps fast. The pressure on elastic bodies under the same loads is an upper bound.
    fn bounds_small_contacts(&self, scene: &Scene<'_>, extent: &Extent) -> Result<bool> {
        let Run { states, steps, .. } = &self.finest;
        let Some(highest) = self.highest() else { return Ok(false) };
        let small = |state: &State| !state.resolved || state.radius == 0.0;
        let starts = std::iter::once(true).chain(states.iter().map(small));
        let ends =
            starts.zip(states).zip(steps).filter(|((start, state), _)| *start && !small(state) && state.time > 0.0);
        let normal = |load: &Load| match *load {
            Load::Approach { approach, .. } => (false, approach),
            Load::Force { normal, .. } => (true, normal),
        };
        for by_force in [true, false] {
            let loads = ends.clone().map(|(_, (_, load))| load).filter(|load| normal(load).0 == by_force);
            let Some(&load) = loads.max_by(|a, b| normal(a).1.total_cmp(&normal(b).1)) else { continue };
            let mut elastic = scene.builder(grid_with(extent, self.across)?).build()?;
            let resolved = elastic.step(0.0, load).is_ok() && elastic.contact_cells() >= BOUNDING_CELLS;
            if !resolved || BOUNDING_MARGIN * elastic.max_pressure() > highest.pressure {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The state with the greatest pressure.
    fn highest(&self) -> Option<&State> {
        self.finest.states.iter().max_by(|a, b| a.pressure.total_cmp(&b.pressure))
    }
}

/// Finds the steps, and the convergence of approach, force, radius and greatest pressure with the mesh; `area` states
/// whether the radius has to be resolved.
pub(super) fn converge(scene: &Scene<'_>, extent: &Extent, area: bool) -> Result<MeshConvergence> {
    let mut first = grid_with(extent, STEPS_ACROSS)?;
    if first.cells().into_iter().any(|cells| cells > MOST_CELLS) {
        first = grid_with(extent, LEAST_ACROSS)?;
    }
    let punch = scene.has_edge(&first);
    let steps = Steps::find(scene, &first)?;
    let scene = &Scene { tolerance: steps.tolerance, ..*scene };
    let zoomed = match scene.before_growth(&steps.run).map(|until| small_contact(scene, until, extent)) {
        Some(Err(error @ Error::OutOfMemory { .. })) => return Err(error),
        // the run succeeds without a separate domain for this part
        Some(law) => Some(law.unwrap_or(Convergence::NONE)),
        None => None,
    };
    let base = scene.repeat(grid_with(extent, LEAST_ACROSS)?, &steps.run.steps)?;
    let found = |meshes: &Meshes| MeshConvergence {
        reach: [0, 1].map(|axis| extent.reach[axis].max(meshes.finest.extent.reach[axis])),
        main: meshes.main(punch),
        singular: meshes.singular(punch),
        pressure: zoomed.unwrap_or_else(|| meshes.pressure()),
        pressure_over_time: Convergence::smooth(
            &meshes.each(|differences| differences.pressure_over_time),
            meshes.across,
        ),
        radius: Convergence::by_cells(&meshes.each(|differences| differences.radius), meshes.across),
        work: meshes.work(),
        steps: steps.clone(),
    };
    let needed = |meshes: &Meshes| {
        let mut found = found(meshes);
        // a pressure on a separate domain does not determine the cells of these meshes
        found.pressure.converges &= zoomed.is_none();
        found.across_for(scene.accuracy, area)
    };
    let meshes = Meshes::refine(scene, extent, base, needed)?;
    let mut found = found(&meshes);
    if zoomed.is_none() && found.pressure.converges && !meshes.bounds_small_contacts(scene, extent)? {
        found.pressure = Convergence::NONE;
    }
    Ok(found)
}

/// Convergence of a greatest pressure that occurs before the contact grows much: from the run to `until` on a separate
/// domain.
fn small_contact(scene: &Scene<'_>, until: f64, whole: &Extent) -> Result<Convergence> {
    let (mut until, mut zooms) = (until, 0);
    let (part, extent, base) = loop {
        let part = Scene { until, ..*scene };
        let (extent, base) =
            Extent::of(&part)?.held(|extent| Ok((*extent, part.follow(grid_with(extent, LEAST_ACROSS)?, &[])?)))?;
        zooms += 1;
        match part.before_growth(&base).filter(|_| zooms < MAX_ZOOMS) {
            Some(earlier) => until = earlier,
            None => break (part, extent, base),
        }
    };
    let (meshes, bounded) = extent.held(|extent| {
        let base = part.repeat(grid_with(extent, LEAST_ACROSS)?, &base.steps)?;
        let meshes = Meshes::refine(&part, extent, base, |meshes| {
            let pressure = meshes.pressure();
            if pressure.converges {
                pressure.across_for(scene.accuracy.space())
            } else if meshes.highest().is_some_and(|state| state.resolved) {
                0.0
            } else {
                f64::INFINITY
            }
        })?;
        let bounded = meshes.bounds_small_contacts(&part, extent)?;
        Ok((meshes, bounded))
    })?;
    if !bounded {
        return Ok(Convergence::NONE);
    }
    let larger = [0, 1].map(|axis| whole.width[axis] / extent.width[axis]);
    let across = meshes.across * larger[0].max(larger[1]);
    Ok(Convergence { across, ..meshes.pressure() })
}

/// The next even number of cells without prime factors above 5, for fast transforms.
fn smooth_size(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (least..).find(|&n| n.is_multiple_of(2) && smooth(n)).unwrap_or(least)
}
