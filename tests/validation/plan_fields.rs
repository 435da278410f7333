//! Planned pressure fields, as means over cells: of random balls and cones against superposed closed forms, and of random scenes against a
//! mesh twice as fine. `PLANNED_FIELDS`, `PLANNED_SCENES` and `PLANS_SEED` choose how many plans and which.

use std::f64::consts::PI;

use viscocontact::prelude::*;

use super::plan_random::{Scene, Shape, scene};
use crate::common::scene::Beneath;
use crate::common::{self, Draws, Features, Ratios, builder_of, from_environment};

/// Number of radii of a pressure, and points of a cell along a side.
const RADII: usize = 2000;
const POINTS: usize = 5;
/// Most cells along a side of a plan that is run.
const MOST_CELLS: usize = 150;

/// The pressure over the distance from the axis: its edge, and values at r = a (1 − s²), s = 0 … 1.
struct Profile {
    edge: f64,
    values: Vec<f64>,
}

impl Profile {
    fn of(shape: Shape, elastic: &ElasticStates, contact: &StatesContact) -> Profile {
        let edge = (contact.contact_area() / PI).sqrt();
        let at = |k: usize| edge * (1.0 - (k as f64 / RADII as f64).powi(2));
        // the tip of a cone has no pressure
        let at = |k: usize| at(k).max(1e-4 * edge);
        let pressure = |k: usize| contact.superposed(|level| shape.pressure(elastic, level, at(k)));
        Profile { edge, values: (0..=RADII).map(pressure).collect() }
    }

    fn at(&self, r: f64) -> f64 {
        let place = RADII as f64 * (1.0 - r / self.edge).max(0.0).sqrt();
        let k = (place as usize).min(RADII - 1);
        self.values[k] + (place - k as f64) * (self.values[k + 1] - self.values[k])
    }

    /// Σ |p − p′| / Σ p′, with p′ the means over the cells.
    fn error(&self, grid: &Grid, pressure: &[f64]) -> f64 {
        let (n2, sides, parts) = (grid.cells()[1], grid.spacing(), (POINTS * POINTS) as f64);
        let (mut off, mut sum) = (0.0, 0.0);
        for (k, found) in pressure.iter().enumerate() {
            let middle = grid.center(k / n2, k % n2);
            let point = |part: usize| {
                let places = [part / POINTS, part % POINTS].map(|k| (k as f64 + 0.5) / POINTS as f64 - 0.5);
                self.at((middle[0] + places[0] * sides[0]).hypot(middle[1] + places[1] * sides[1]))
            };
            let mean = (0..POINTS * POINTS).map(point).sum::<f64>() / parts;
            (off, sum) = (off + (found - mean).abs(), sum + mean);
        }
        off / sum
    }
}

/// The errors of the fields at the times over what was asked, and over what the plan expects of the mesh; nothing where the mesh is too large.
fn deliver(scene: &Scene, shape: Shape, times: &[f64]) -> Result<Option<Vec<[f64; 2]>>, Error> {
    let Scene { geometry, material, history, until, .. } = scene;
    let builder = Plan::builder(geometry, material, history, *until).accuracy(Accuracy::COARSE);
    let plan = builder.fields_at(times).build()?;
    assert!(plan.mesh_error.pressure_field <= 0.61 * plan.accuracy.target(), "{}: {plan}", scene.name);
    let alone = builder.build()?;
    assert!(alone.fields.is_none() && alone.grid.len() <= plan.grid.len());
    if plan.grid.cells().iter().any(|cells| *cells > MOST_CELLS) {
        return Ok(None);
    }
    let (elastic, _) = shape.states();
    let mut exact = StatesContact::new(&elastic, material)?;
    let run = exact.follow(history, Stepping::adaptive(1e-4), *until).sample_at(times)?;
    let (mut run, mut profiles) = (run.fields_to(1e-4)?, Vec::new());
    while run.next_step()?.is_some() {
        for sample in run.samples() {
            let sample = sample?;
            if sample.is_asked_for() {
                profiles.push(Profile::of(shape, &elastic, sample.contact()));
            }
        }
    }
    let (mut contact, mut profiles, mut errors) = (plan.builder.clone().build()?, profiles.iter(), Vec::new());
    let run = contact.follow(history, plan.stepping, *until).sample_at(times)?;
    let mut run = run.fields_to(plan.fields.unwrap())?;
    while run.next_step()?.is_some() {
        for sample in run.samples() {
            let sample = sample?;
            if sample.is_asked_for() {
                let error = profiles.next().unwrap().error(&plan.grid, sample.fields().pressure());
                errors.push([error / plan.accuracy.target(), error / plan.mesh_error.pressure_field]);
            }
        }
    }
    assert_eq!(errors.len(), times.len());
    Ok(Some(errors))
}

#[test]
fn planned_fields_are_as_exact_as_asked() {
    let (seed, count) = (from_environment("PLANS_SEED", 1), from_environment("PLANNED_FIELDS", 6));
    let (mut asked, mut told, mut large) = (Ratios::default(), Ratios::default(), 0);
    let scenes = (0..).map(|number| scene(seed.wrapping_add(1 << 30), number));
    let is_plain = |scene: &Scene| scene.aside == 0.0 && matches!(scene.shape, Some(Shape::Ball | Shape::Cone));
    for (number, scene) in
        scenes.filter(|scene| scene.ratio <= 30.0 && is_plain(scene)).take(count as usize).enumerate()
    {
        let draws = &mut Draws::new(seed.wrapping_mul(31).wrapping_add(number as u64));
        let mut times = [0.0; 2].map(|_| draws.between(0.1, 1.0) * scene.until);
        times.sort_by(f64::total_cmp);
        let Some(errors) =
            deliver(&scene, scene.shape.unwrap(), &times).unwrap_or_else(|error| panic!("{}: {error}", scene.name))
        else {
            large += 1;
            continue;
        };
        for [over, ratio] in errors {
            asked.push(over, &scene.name);
            told.push(ratio, &scene.name);
        }
    }
    println!("{large} plans of {count} have more than {MOST_CELLS} cells along a side");
    asked.print("error over asked", 3);
    told.print("over the mesh's", 3);
    assert!(asked.count() > 2 && asked.above(2.0) == 0);
}

/// Most cells along a side of a plan that is run on a mesh twice as fine.
const MOST_HALVED: usize = 128;
/// A mesh has this part of the error of one with half as many cells along a side.
const OF_HALVED: f64 = 0.354;

/// The pressures of a run at the times.
fn fields(
    mut contact: ViscoelasticContact,
    scene: &common::Scene,
    (stepping, accuracy): (Stepping, f64),
    times: &[f64],
) -> Result<Vec<Vec<f64>>, Error> {
    let run = contact.follow(scene.load(), stepping, scene.body.until).sample_at(times)?;
    let (mut run, mut found) = (run.fields_to(accuracy)?, Vec::new());
    while run.next_step()?.is_some() {
        // after jumps
        for sample in run.samples() {
            let sample = sample?;
            if sample.is_asked_for() {
                found.push((sample.contact().time(), sample.fields().pressure().to_vec()));
            }
        }
    }
    found.dedup_by(|after, before| {
        after.0 == before.0 && {
            std::mem::swap(&mut after.1, &mut before.1);
            true
        }
    });
    Ok(found.into_iter().map(|field| field.1).collect())
}

/// Error over asked of each planned field with a load to speak of; nothing where the mesh is too large.
fn against_half(scene: &common::Scene, accuracy: Accuracy, times: &[f64]) -> Result<Option<Vec<f64>>, Error> {
    let kernel = |grid: &Grid| scene.beneath.kernel(grid);
    let material = &scene.body.material;
    let mut builder = Plan::builder(&*scene.geometry, material, scene.load(), scene.body.until).accuracy(accuracy);
    if !matches!(scene.beneath, Beneath::HalfSpace) {
        builder = builder.kernel(&kernel);
    }
    if matches!(scene.beneath, Beneath::Periodic) {
        let lengths = scene.grid().lengths();
        builder = builder.period(Axis::X1, lengths[0]).period(Axis::X2, lengths[1]);
    }
    let plan = builder.fields_at(times).build()?;
    let [n1, n2] = plan.grid.cells();
    if n1.max(n2) > MOST_HALVED {
        return Ok(None);
    }
    let fine = Grid::new([2 * n1, 2 * n2], plan.grid.lengths())?;
    let settings = Settings::default().with_tolerance(1e-6);
    let half = builder_of(&*scene.geometry, fine.clone(), material.clone()).kernel(kernel(&fine)?);
    let half = half.settings(settings).build()?;
    let (target, asked) = (plan.accuracy.target(), plan.fields.unwrap());
    let exact = fields(half, scene, (Stepping::adaptive(0.1 * target), 0.1 * asked), times)?;
    let found = fields(plan.builder.clone().build()?, scene, (plan.stepping, asked), times)?;
    let mut errors = Vec::new();
    let most = exact.iter().map(|exact| exact.iter().sum::<f64>()).fold(0.0, f64::max);
    for (found, exact) in found.iter().zip(&exact) {
        let mean = |k: usize| {
            let at = 4 * (k / n2) * n2 + 2 * (k % n2);
            0.25 * (exact[at] + exact[at + 1] + exact[at + 2 * n2] + exact[at + 2 * n2 + 1])
        };
        let off: f64 = found.iter().enumerate().map(|(k, pressure)| (pressure - mean(k)).abs()).sum();
        let sum = 0.25 * exact.iter().sum::<f64>();
        if 4.0 * sum > 0.05 * most {
            errors.push(off / sum / (1.0 - OF_HALVED) / target);
        }
    }
    Ok(Some(errors))
}

/// Springs, returns, layers, ellipsoids, waves and periodic rough planes as well.
#[test]
fn planned_fields_of_random_scenes_are_as_exact_as_asked() {
    let (seed, count) = (from_environment("PLANS_SEED", 1), from_environment("PLANNED_SCENES", 4));
    let (mut asked, mut large, mut refused) = (Ratios::default(), 0, 0);
    for number in from_environment("PLANS_FIRST", 0)..count {
        let kinds = [Features::ANY, Features::RETURNING, Features::SPRING, Features::PERIODIC];
        let scene = common::Scene::draw(seed, number, kinds[number as usize % 4]);
        if scene.body.creep_ratio() > 30.0 {
            continue;
        }
        let draws = &mut Draws::new(seed.wrapping_mul(31).wrapping_add(number));
        let mut times = [0.0; 2].map(|_| draws.between(0.1, 1.0) * scene.body.until);
        times.sort_by(f64::total_cmp);
        let accuracy = Accuracy::new(draws.scale(1e-2, 0.1)).unwrap();
        match against_half(&scene, accuracy, &times) {
            Ok(None) => large += 1,
            Ok(Some(errors)) => errors.into_iter().for_each(|error| asked.push(error, &scene.name)),
            // a plan is refused where it needs more cells than there may be
            Err(error @ (Error::CountOutOfRange { .. } | Error::NoDomain { .. })) => {
                println!("{}: {error}", scene.name);
                refused += 1;
            }
            Err(error) => panic!("{}: {error}", scene.name),
        }
    }
    println!("{large} plans have more than {MOST_HALVED} cells along a side, {refused} are refused");
    asked.print("error over asked", 5);
    assert!(asked.count() > 0 && asked.above(2.0) == 0);
}
