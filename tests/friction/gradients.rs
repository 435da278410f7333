//! Gradients with respect to the shape: of contacts on elastic states against dense steps that are differentiated as they are
//! taken, of elastic contacts against differences.

use std::sync::atomic::AtomicBool;

use viscocontact::prelude::*;
use viscocontact::states::{Reach, StatesContact, Sweep};

use super::bodies::{Body, Past};
use super::dense::{material, relaxation};
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::love::love;

const CELLS: usize = 12;
const SIDE: f64 = 1.0 / CELLS as f64;

/// A rough ball on a grid of the side 1, by its gap above each cell.
fn rough(draws: &mut Draws) -> Vec<f64> {
    let place = |k: usize| (k as f64 + 0.5) * SIDE - 0.5;
    let ball = |k: usize| 0.5 * (place(k / CELLS).powi(2) + place(k % CELLS).powi(2));
    (0..CELLS * CELLS).map(|k| ball(k) + 0.02 * draws.between(-1.0, 1.0)).collect()
}

fn geometry(gap: &[f64]) -> impl Geometry + '_ {
    let index = |x: f64| (((x + 0.5) * CELLS as f64) as usize).min(CELLS - 1);
    FnGeometry::new(move |x1, x2| gap[index(x1) * CELLS + index(x2)])
}

/// Press, hold, release in part and press again: lengths of steps and forces.
fn history(most: f64, draws: &mut Draws) -> Vec<(f64, f64)> {
    let mut steps = vec![(0.0, most * draws.between(0.5, 1.0))];
    for _ in 0..8 {
        steps.push((draws.power_of_ten(-1.0, 0.5), most * draws.between(0.05, 1.0)));
    }
    steps
}

#[test]
fn gradients_are_those_of_dense_steps() {
    let scenes = from_environment("GRADIENT_SCENES", 10);
    let (mut worst, mut sums, mut free) = (0.0f64, 0.0f64, 0);
    for seed in 0..scenes {
        let draws = &mut Draws::new(7000 + seed);
        let (gap, relaxation) = (rough(draws), relaxation(seed as usize % 3));
        let grid = Grid::square(CELLS, 1.0).unwrap();
        let steps = history(2e-2, draws);
        let settings = Settings::default().with_tolerance(1e-12).with_edge(Edge::Allow);
        let sweep = Sweep::new(grid.clone(), &geometry(&gap)).settings(settings);
        let states = sweep.run(Reach::Level(2e-2 * 200.0)).unwrap();
        let mut contact = StatesContact::new(&states, &material(&relaxation)).unwrap().with_linear_steps();
        contact = contact.with_merge_error(0.0).unwrap();
        let distance = |a: usize, b: usize, of: fn(usize) -> usize| (of(a) as f64 - of(b) as f64) * SIDE;
        let influence = |a: usize, b: usize| {
            love([distance(a, b, |k| k / CELLS), distance(a, b, |k| k % CELLS)], [SIDE; 2]) / (SIDE * SIDE)
        };
        let cells = gap.len();
        let influence = (0..cells).map(|a| (0..cells).map(|b| influence(a, b)).collect()).collect();
        let (body, direction) =
            (Body { influence, gap }, (0..cells).map(|_| draws.between(-1.0, 1.0)).collect::<Vec<_>>());
        let (mut past, mut tangent) = (Past::new(&relaxation, cells), Past::new(&relaxation, cells));
        for &(dt, force) in &steps {
            let (c, lifted) = relaxation.step(dt, &past);
            let (pressure, approach) = body.press(c, &lifted, force);
            let displaced = body.displacement(&pressure);
            relaxation.commit(dt, &mut past, (0..cells).map(|k| c * displaced[k] + lifted[k]).collect());
            // the same cells, whose pressure changes
            let (_, lifted) = relaxation.step(dt, &tangent);
            let right: Vec<f64> = lifted.iter().zip(&direction).map(|(lifted, gap)| lifted + gap).collect();
            let held: Vec<usize> = (0..cells).filter(|&k| pressure[k] > 0.0).collect();
            let mut changes = vec![0.0; cells];
            let change = body.held(c, &right, (&held, &vec![1.0; cells]), &mut changes, 0.0);
            let displaced = body.displacement(&changes);
            relaxation.commit(dt, &mut tangent, (0..cells).map(|k| c * displaced[k] + lifted[k]).collect());

            contact.step(dt, Load::force(force)).unwrap();
            assert!((contact.approach() / approach - 1.0).abs() < 1e-2, "{} {approach}", contact.approach());
            let gradient = contact.approach_gradient().unwrap();
            let found: f64 = gradient.iter().zip(&direction).map(|(gradient, direction)| gradient * direction).sum();
            let size = gradient.iter().map(|part| part.abs()).sum::<f64>();
            worst = worst.max((found - change).abs() / size);
            sums = sums.max((gradient.iter().sum::<f64>() - 1.0).abs());
            free += usize::from(contact.groups() > contact.tractions().count());
        }
    }
    println!("{scenes} scenes: off by {worst:.1e}, sum off 1 by {sums:.1e}, {free} with imprints");
    assert!(free > scenes as usize && worst < 1e-9 && sums < 1e-10);
}

/// The force of an elastic body that is held, as heights change by 1e-6 of the deepest.
#[test]
fn gradients_are_differences_of_elastic_contacts() {
    let mut worst = 0.0f64;
    for seed in 0..from_environment("GRADIENT_SCENES", 10) {
        let draws = &mut Draws::new(9000 + seed);
        let gap = rough(draws);
        let direction: Vec<f64> = (0..gap.len()).map(|_| draws.between(-1.0, 1.0)).collect();
        let level = |by: f64| {
            let moved: Vec<f64> = gap.iter().zip(&direction).map(|(gap, direction)| gap + by * direction).collect();
            let builder = ElasticContact::builder(Grid::square(CELLS, 1.0).unwrap()).geometry(&geometry(&moved));
            let settings = Settings::default().with_tolerance(1e-13).with_edge(Edge::Allow);
            let mut elastic = builder.modulus(1.0).settings(settings).build().unwrap();
            elastic.solve(Load::approach(0.05)).unwrap();
            elastic
        };
        let h = 1e-7;
        let (force, held) = ((level(h).fields().force() - level(-h).fields().force()) / (2.0 * h), level(0.0));
        let stiffness = held.fields().stiffness_over_modulus().unwrap();
        let gradient = held.fields().approach_gradient().unwrap();
        let found = -stiffness * gradient.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>();
        worst = worst.max((found - force).abs() / stiffness);
    }
    println!("off differences of the force by {worst:.1e}");
    assert!(worst < 1e-6);
}

#[test]
fn a_gradient_ends_where_it_is_cancelled() {
    let states = Sweep::new(Grid::square(16, 4.0e-3).unwrap(), &Sphere::new(10.0e-3).unwrap())
        .run(Reach::Level(3.0e-7))
        .unwrap();
    let rubber = Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap());
    let mut contact = StatesContact::new(&states, &rubber).unwrap();
    contact.step(0.0, Load::force(0.5)).unwrap();
    let error = contact.approach_gradient_unless(&AtomicBool::new(true)).unwrap_err();
    assert!(matches!(error, Error::Cancelled { .. }), "{error}");
    let plain = contact.approach_gradient().unwrap();
    assert_eq!(contact.approach_gradient_unless(&AtomicBool::new(false)).unwrap(), plain);
}
