//! How a study proceeds: domain, first mesh, finer meshes until what is asked is met.

use std::ops::ControlFlow;

use super::domain::no_domain;
use crate::Grid;
use crate::error::{Error, Result, StepError, count_within};
use crate::observe::grid_convergence::{OfMesh, SINGULAR, SMOOTH};
use crate::study::domain::Domain;
use crate::study::level::{Level, Runs};
use crate::study::observable::{Observable, Observed, Reading};
use crate::study::result::{Growth, Mesh, Steps, StudyResult};
use crate::study::tuning::TUNING;
use crate::study::{Budget, Ending, Measured, Study, StudyProgress};

/// The first mesh: its run in the steps of the study, and its errors in time.
struct First {
    level: Level,
    domain: Domain,
    across: f64,
    steps: Steps,
    /// Error in time of each observable.
    in_time: Vec<f64>,
    /// Power of 1/tolerance with which the steps grow.
    steps_order: f64,
}

pub(super) fn run(study: Study<'_>, progress: &mut dyn FnMut(StudyProgress) -> ControlFlow<()>) -> Result<StudyResult> {
    let Study { scene, sides, observed, mut fields_at, budget, cancelled, .. } = study;
    fields_at.sort_by(f64::total_cmp);
    fields_at.dedup();
    let (scene, cancelled) = (&scene, cancelled.as_ref());
    let (observed, fields_at) = (&observed[..], &fields_at[..]);
    let runs = &mut Runs { scene, observed, fields_at, sides, cancelled, progress, runs: 0, work: 0.0, expected: None };
    let mut domain = match Domain::given(sides) {
        Some(domain) => domain,
        None => Domain::find(scene, sides)?,
    };
    for _ in 0..TUNING.most_grown {
        if let Some(result) = on_domain(runs, domain, &budget)? {
            return Ok(result);
        }
        domain = domain.grown();
    }
    Err(no_domain(domain.grid(TUNING.across)?.lengths()[0]))
}

/// Meshes on a domain until what is asked is met, or the budget ends it; nothing where the contact reaches the edge
/// of the domain on one of them.
fn on_domain(runs: &mut Runs<'_, '_>, domain: Domain, budget: &Budget) -> Result<Option<StudyResult>> {
    let (observed, accuracy) = (runs.observed, runs.scene.accuracy);
    let First { level, domain, mut across, steps, in_time, steps_order } = first_mesh(runs, domain, budget.cells)?;
    let on_finer = (TUNING.on_finer * steps.tolerance).min(TUNING.tolerances[1]);
    let mut meshes = vec![Mesh::of(&level, vec![None; observed.len()])];
    let (mut finest, mut steps, mut unconverged) = (level, steps, 0);
    loop {
        let measured = measured(observed, &meshes, &in_time, accuracy);
        let asked = || measured.iter().filter(|own| own.is_asked);
        let is_open = meshes.len() > 2 && asked().any(|own| own.error().is_none());
        unconverged = if is_open { unconverged + 1 } else { 0 };
        let ratio = asked().filter_map(|own| own.ratio(accuracy)).reduce(f64::max).unwrap_or(TUNING.ratio);
        let growth = Growth { steps: steps_order, convolutions: convolutions_order(&meshes) };
        let mut result = StudyResult::new(finest, meshes, measured, accuracy, steps, growth);
        runs.expected = result.cost(accuracy);
        let (next_across, next) = next_grid(&domain, across, ratio, budget.cells)?;
        let ending = match budget.ending(&result, &next, runs.work, unconverged) {
            Some(ending) => ending,
            // its steps end where those of the mesh before do
            None => match runs.level(next, on_finer, result.times()) {
                Err(Error::Step(StepError::ContactAtEdge { .. })) if !domain.is_given() => return Ok(None),
                Err(error @ Error::Cancelled { .. }) => return Err(error),
                Err(Error::OutOfMemory { .. }) => Ending::Memory,
                Err(error) => Ending::Failed(error),
                Ok(level) => {
                    across = next_across;
                    let differences = result.finest.differences(&level, observed).into_iter().map(Some).collect();
                    meshes = result.meshes;
                    meshes.push(Mesh::of(&level, differences));
                    steps = Steps { stops: result.finest.times, tolerance: on_finer };
                    finest = level;
                    continue;
                }
            },
        };
        (result.ending, result.work, result.runs) = (ending, runs.work, runs.runs);
        return Ok(Some(result));
    }
}

/// The next mesh, so many times as fine as one with so many cells across; the finest one that is allowed, where that
/// is finer enough.
fn next_grid(domain: &Domain, across: f64, ratio: f64, most_cells: usize) -> Result<(f64, Grid)> {
    let ratio = ratio.clamp(TUNING.ratios[0], TUNING.ratios[1]);
    let next = domain.grid(ratio * across)?;
    if next.len() <= most_cells {
        return Ok((ratio * across, next));
    }
    // sizes of grids go by steps of up to a tenth
    let allowed = 0.9 * ratio * (most_cells as f64 / next.len() as f64).powf(1.0 / axes(&next));
    let finer = allowed.clamp(TUNING.ratios[0], ratio) * across;
    Ok((finer, domain.grid(finer)?))
}

/// Axes along which a grid has more than one cell.
fn axes(grid: &Grid) -> f64 {
    grid.cells().iter().filter(|n| **n > 1).count().max(1) as f64
}

impl Budget {
    /// Why a study ends with what it has, before the next mesh.
    fn ending(&self, result: &StudyResult, next: &Grid, work: f64, unconverged: usize) -> Option<Ending> {
        let accuracy = result.accuracy;
        let mut asked = result.quantities.iter().filter(|own| own.is_asked);
        // what the next mesh takes by what the last one took
        let size = next.len() as f64 / result.finest.grid.len() as f64;
        let expected = result.work_of_finest() * size.powf(1.0 + result.growth.convolutions / axes(next));
        let bytes = (result.bytes() as f64 * size) as u64;
        if asked.clone().all(|own| own.error().is_some_and(|error| error <= accuracy)) {
            Some(Ending::Reached)
        } else if asked.any(|own| own.time >= accuracy) {
            Some(Ending::Time)
        } else if unconverged >= TUNING.most_unconverged {
            Some(Ending::NoConvergence)
        } else if next.len() > self.cells {
            Some(Ending::Cells)
        } else if self.bytes.is_some_and(|most| bytes > most) {
            Some(Ending::Memory)
        } else if self.work.is_some_and(|most| work + expected > most) {
            Some(Ending::Work)
        } else {
            None
        }
    }
}

/// Runs the first mesh on a domain that holds the contact, in steps that are short enough.
fn first_mesh(runs: &mut Runs<'_, '_>, mut domain: Domain, most_cells: usize) -> Result<First> {
    let accuracy = runs.scene.accuracy;
    // the run in shorter steps has one that a run may be asked for
    let least = TUNING.shorter * TUNING.tolerances[0];
    let mut tolerance = (TUNING.tolerance * accuracy).clamp(least, TUNING.tolerances[1]);
    let mut across = if domain.is_given() { TUNING.across_given } else { TUNING.across };
    let mut tries = 0;
    let level = loop {
        tries += 1;
        let grid = domain.grid(across)?;
        let allowed = "those of the first mesh that resolves the scene, or more";
        count_within("cells of a study", most_cells, grid.len() <= most_cells, allowed)?;
        match runs.level(grid, tolerance, &[]) {
            Err(Error::Step(StepError::ContactAtEdge { .. })) if !domain.is_given() && tries < TUNING.most_grown => {
                domain = domain.grown();
            }
            // the first mesh that resolves the attraction
            Err(Error::ZoneNotResolved { .. }) => across *= TUNING.ratio,
            Err(error) => return Err(error),
            Ok(level) if level.footprint.is_narrower(&domain, TUNING.narrower) && tries < TUNING.most_grown => {
                domain = level.footprint
            }
            Ok(level) => break level,
        }
    };
    let mut base = level;
    let (common, mut stops, mut steps_order) = (base.times.clone(), Vec::new(), 0.0);
    let mut in_time = Vec::new();
    // the run in shorter steps has an eighth of the error of the first, which is thus 8/7 of their difference
    let of_both = TUNING.shorter / (TUNING.shorter - 1.0);
    for tries in 0..=TUNING.most_shortened {
        let fine = runs.level(base.grid.clone(), tolerance / TUNING.shorter, &common)?;
        if tries == 0 {
            let more = fine.steps() as f64 / base.steps().max(1) as f64;
            steps_order = (more.ln() / TUNING.shorter.ln()).clamp(0.0, 1.0);
        }
        let differences = base.differences(&fine, runs.observed);
        in_time = differences.into_iter().map(|difference| of_both * difference).collect::<Vec<_>>();
        // pressures of both are of one accuracy, and their errors in their difference are none
        if tolerance < TUNING.shorter * TUNING.least_of_fields {
            let of_pressure = |own: &Observed<'_>| matches!(own.reading, Reading::Pressure);
            let errors = runs.observed.iter().zip(&mut in_time).filter(|(own, _)| of_pressure(own));
            errors.for_each(|(_, error)| *error = error.max(base.field_error));
        }
        let worst = worst_asked(runs.observed, &in_time);
        if worst <= TUNING.in_time * accuracy || tries == TUNING.most_shortened || tolerance <= least {
            break;
        }
        tolerance = (tolerance * (TUNING.aim_in_time * accuracy / worst).max(1.0 / TUNING.shorter)).max(least);
        base = runs.level(base.grid.clone(), tolerance, &common)?;
        stops.clone_from(&common);
    }
    Ok(First { level: base, domain, across, steps: Steps { stops, tolerance }, in_time, steps_order })
}

fn worst_asked(observed: &[Observed<'_>], errors: &[f64]) -> f64 {
    observed.iter().zip(errors).filter(|(own, _)| own.is_asked).map(|(_, error)| *error).fold(0.0, f64::max)
}

/// What the meshes so far tell of each observable.
fn measured(observed: &[Observed<'_>], meshes: &[Mesh], in_time: &[f64], accuracy: f64) -> Vec<Measured> {
    let sides: Vec<f64> = meshes.iter().map(Mesh::side).collect();
    let all = |k: usize| meshes.iter().filter_map(|mesh| mesh.changes[k]).collect::<Vec<f64>>();
    // a pressure that does not converge is infinite at an edge or a tip: nothing is of a higher order than the first
    // beside it
    let is_peak = |own: &Observed<'_>| own.name == Observable::MaxPressure.name();
    let peak = observed.iter().position(is_peak).map(&all).unwrap_or_default();
    let is_singular = peak.len() > 1 && OfMesh::of(&sides, &peak, SMOOTH).order.is_none();
    let most = if is_singular { SINGULAR } else { SMOOTH };
    let one = |(k, own): (usize, &Observed<'_>)| {
        let differences = all(k);
        let OfMesh { error, order } = OfMesh::of(&sides, &differences, most);
        let is_known = order.is_some() || differences.len() == 1 || in_time[k] + error <= accuracy;
        Measured {
            name: own.name.clone(),
            is_asked: own.is_asked,
            time: in_time[k],
            mesh: Some(error).filter(|error| is_known && error.is_finite()),
            order,
        }
    };
    observed.iter().enumerate().map(one).collect()
}

impl Measured {
    /// How many times as fine a mesh is expected to meet an accuracy; nothing where it is met or nothing is expected.
    fn ratio(&self, accuracy: f64) -> Option<f64> {
        let left = TUNING.aim * (accuracy - self.time).max(0.1 * accuracy);
        let mesh = self.mesh.filter(|mesh| *mesh > left)?;
        Some((mesh / left).powf(1.0 / self.order.unwrap_or(1.0)))
    }
}

/// Power of the cells along a side with which the convolutions of a run grow.
fn convolutions_order(meshes: &[Mesh]) -> f64 {
    let [first, .., last] = meshes else { return 0.0 };
    let of = |mesh: &Mesh| mesh.convolutions / mesh.steps.max(1) as f64;
    ((of(last) / of(first)).ln() / (first.side() / last.side()).ln()).clamp(0.0, 0.5)
}
