//! Attraction on every kind of body: each state satisfies its equations, and neither symmetry, threads nor the unit of time change it.
//! `ADHESION_BODIES` (12) chooses the number of random scenes, and `ADHESION_SEED` (1) others.

use std::sync::Arc;

use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::fields::traction;
use crate::solver::adhesion_population::check;
use viscocontact::adhesion::{Attraction, ExponentialAttraction, LinearSoftening};
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};

const KINDS: [&str; 7] =
    ["half-space", "periodic", "bonded layer", "layer on a base", "periodic layer", "line", "line on a layer"];

/// The kernel of a kind of body on a grid of its own.
fn body(kind: usize, cells: usize, side: f64, thickness: f64) -> InfluenceKernel {
    let grid = if kind < 5 { Grid::square(cells, side) } else { Grid::new([cells, 1], [side, 1.0]) }.unwrap();
    let bonded = || Layer::bonded_to_rigid(thickness, 0.5).unwrap();
    match kind {
        0 => InfluenceKernel::half_space(&grid),
        1 => InfluenceKernel::periodic(&grid),
        2 => InfluenceKernel::layer(&grid, bonded()),
        3 => InfluenceKernel::layer(&grid, Layer::bonded_to_half_space(thickness, 0.5, 0.3, 0.5).unwrap()),
        4 => InfluenceKernel::layer_periodic(&grid, bonded()),
        5 => InfluenceKernel::line(&grid, 5.0 * side),
        _ => InfluenceKernel::layer_line(&grid, bonded(), None),
    }
    .unwrap()
}

/// A step that takes `dt` in reduced time, with the shift factor of a constant temperature.
struct Way {
    symmetry: bool,
    warm: bool,
    threads: usize,
}

const PLAIN: Way = Way { symmetry: false, warm: false, threads: 2 };

#[test]
fn neither_symmetry_threads_nor_the_unit_of_time_change_a_state() {
    let mut seen = [0; KINDS.len()];
    let mut worst = [0.0_f64; 2];
    for scene in 0..from_environment("ADHESION_BODIES", 12) {
        let mut draws = Draws::new(5000 * from_environment("ADHESION_SEED", 1) + scene);
        let kind = scene as usize % KINDS.len();
        let (cells, side) = (if kind < 5 { 36 } else { 72 }, 6.0);
        let kernel = Arc::new(body(kind, cells, side, draws.between(0.8, 3.0)));
        let range = draws.between(0.9, 1.5);
        let law: Arc<dyn Attraction> = if draws.chance(0.5) {
            Arc::new(ExponentialAttraction::new(1.0, range).unwrap())
        } else {
            Arc::new(LinearSoftening::new(1.0, range).unwrap())
        };
        let elastic = draws.chance(0.3);
        let terms = [(draws.scale(0.05, 1.0), draws.scale(0.1, 10.0))];
        let wave = Wavy::new(draws.between(0.02, 0.1), side / 3.0).unwrap();
        let shape = Sum::new(Sphere::new(draws.between(1.0, 2.0)).unwrap(), wave);
        let (step, down) = (draws.scale(0.1, 3.0), draws.between(0.3, 0.8));
        let name = format!("scene {scene}: {}, {law:?}, {}", KINDS[kind], if elastic { "elastic" } else { "creeping" });
        let time_law = TimeTemperature::wlf(8.0, 100.0, 300.0).unwrap();
        let warm = TemperatureHistory::table(time_law, &[(0.0, 310.0)]).unwrap();
        // seconds for each second of reduced time
        let shift = 1.0 / warm.reduced_time(0.0, 1.0).unwrap();
        let run = |way: Way| {
            let rheology: Box<dyn Rheology> = match elastic {
                true => Box::new(Elastic::new(0.25).unwrap()),
                false => Box::new(GeneralizedMaxwell::new(0.25, &terms).unwrap()),
            };
            let mut builder = ViscoelasticContact::builder(kernel.grid().clone())
                .geometry(&shape)
                .material(Material::incompressible(rheology))
                .kernel(Arc::clone(&kernel))
                .attraction(Arc::clone(&law))
                .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(way.symmetry).with_tolerance(1e-7));
            if way.warm {
                builder = builder.temperature(warm.clone());
            }
            let mut contact = builder.build().unwrap();
            let touch = contact.approach();
            let mut all = Vec::new();
            let steps = || {
                for k in 0..8 {
                    let approach = touch + down * [0.0, 0.5, 1.0, 0.7, 0.4, 0.1, -0.2, -0.5][k];
                    contact.step(if way.warm { step * shift } else { step }, Load::approach(approach)).unwrap();
                    check(&format!("{name}, step {k}"), &contact, &*law, elastic);
                    all.extend(traction(contact.fields()));
                }
            };
            rayon::ThreadPoolBuilder::new().num_threads(way.threads).build().unwrap().install(steps);
            all
        };
        let all = run(PLAIN);
        assert!(run(Way { threads: 1, ..PLAIN }) == all, "{name}: threads");
        let greatest = law.traction(0.0);
        for (which, way) in [Way { symmetry: true, ..PLAIN }, Way { warm: true, ..PLAIN }].into_iter().enumerate() {
            let other = run(way);
            let error = all.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / greatest;
            assert!(error < 3e-4, "{name}: way {which}, {error}");
            worst[which] = worst[which].max(error);
        }
        seen[kind] += 1;
    }
    println!(
        "{seen:?} scenes of each kind; symmetry changes a traction by {:.1e} of the greatest, time by {:.1e}",
        worst[0], worst[1]
    );
}
