//! Planned pressure fields of random balls and cones, as means over cells, against superposed closed forms. `PLANNED_FIELDS` and
//! `PLANS_SEED` choose how many plans and which.

use std::f64::consts::PI;

use viscocontact::prelude::*;

use super::plan_random::{Scene, Shape, scene};
use crate::common::{Draws, Ratios, from_environment};

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
                let error = profiles.next().unwrap().error(&plan.grid, sample.contact().pressure());
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
