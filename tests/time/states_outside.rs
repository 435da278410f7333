//! Scenes that elastic states do not cover: each is refused by name, or, since the condition is only sufficient, right.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::{Draws, from_environment};
use viscocontact::contact::{Edge, TimeRule};
use viscocontact::geometry::Sum;
use viscocontact::load::Tilt;
use viscocontact::prelude::*;
use viscocontact::states::{Reach, StatesContact, Sweep};

/// Number of kinds of scenes.
const KINDS: u64 = 8;

struct Scene {
    name: &'static str,
    grid: Grid,
    geometry: Box<dyn Geometry>,
    kernel: Arc<InfluenceKernel>,
    tilt: [Tilt; 2],
    depth: f64,
    /// Whether tilt or load point change from step to step.
    turns: bool,
}

fn settings() -> Settings {
    Settings::default().with_edge(Edge::Allow).with_tolerance(1e-10).with_time_rule(TimeRule::ExponentialLinear)
}

fn scene(draws: &mut Draws, number: u64) -> Scene {
    let grid = Grid::square(14 + draws.below(8), 1.0).unwrap();
    let spec =
        |height: f64, seed: usize| RoughSpec::new(0.5, 0.15, Roughness::RmsHeight(height)).with_seed(seed as u64);
    let rough = |height: f64, seed: usize| Rough::new(&grid, spec(height, seed)).unwrap();
    let (seed, height) = (draws.below(10_000), draws.power_of_ten(-3.0, -2.0));
    let aside = [draws.between(-0.2, 0.2), draws.between(-0.2, 0.2)];
    let half_space = || InfluenceKernel::half_space(&grid);
    let upright = [Tilt::Fixed(0.0); 2];
    let free = aside.map(|at| Tilt::Free { at });
    let ball = || Box::new(Sum::new(Sphere::new(1.5).unwrap(), rough(height, seed)));
    let pyramid = FnGeometry::new(|x1: f64, x2: f64| 0.1 * x1.abs().max(0.7 * x2.abs()));
    let (name, geometry, kernel, tilt, depth, turns): (_, Box<dyn Geometry>, _, _, _, _) = match number % KINDS {
        0 => ("pyramid loaded aside", Box::new(pyramid), half_space(), free, 0.02, false),
        1 => {
            let face = FlatPunch::rectangular([0.8, 0.6]).unwrap();
            let shape = Box::new(Sum::new(face, rough(3.0 * height, seed)));
            ("very rough punch loaded aside", shape, half_space(), free, 0.02, false)
        }
        2 => {
            let layer = Layer::bonded_to_rigid(draws.between(0.04, 0.15), 0.5).unwrap();
            ("thin layer that bulges", ball(), InfluenceKernel::layer(&grid, layer), upright, 0.02, false)
        }
        3 => {
            let length = draws.between(0.05, 0.3);
            let plate = move |q1: f64, q2: f64| 1.0 / (1.0 + (length * f64::hypot(q1, q2)).powi(4)) + 1e-4;
            ("plate on a foundation", ball(), InfluenceKernel::from_spectrum(&grid, plate), upright, 0.02, false)
        }
        4 => ("load point that moves", ball(), half_space(), free, 0.02, true),
        5 => {
            let (radius, rise) = (draws.between(0.1, 0.35), draws.power_of_ten(-1.0, 0.5));
            let ring = FnGeometry::new(move |x1: f64, x2: f64| rise * (x1.hypot(x2) - radius).powi(2));
            let layer = Layer::bonded_to_half_space(draws.between(0.1, 0.4), 0.5, draws.power_of_ten(-1.0, 1.7), 0.5);
            let kernel = InfluenceKernel::layer(&grid, layer.unwrap());
            ("ring on a layer", Box::new(ring), kernel, upright, 0.02, false)
        }
        6 => {
            let face = Box::new(Sum::new(FlatPunch::circular(0.4).unwrap(), rough(0.3 * height, seed)));
            let coating = Layer::bonded_to_half_space(draws.between(0.1, 0.4), 0.5, draws.power_of_ten(0.7, 2.0), 0.5);
            ("punch on a stiff coating", face, InfluenceKernel::layer(&grid, coating.unwrap()), upright, 0.02, false)
        }
        _ => {
            let tilt = [draws.between(0.001, 0.02), 0.0].map(Tilt::Fixed);
            ("tilt that changes", ball(), half_space(), tilt, 0.02, true)
        }
    };
    Scene { name, grid, geometry, kernel: Arc::new(kernel.unwrap()), tilt, depth, turns }
}

/// How a sweep ends.
#[derive(Debug, Clone, Copy)]
enum End {
    Whole,
    /// By the limit of its states, or by its callback at so many.
    Limit(usize),
    Callback(usize),
}

#[test]
fn scenes_outside_the_statement_are_refused_or_right() {
    let (counts, worst) = outcomes(from_environment("STATES_OUTSIDE", 32), |_| End::Whole);
    println!("refused and right, by kind: {counts:?}; the right ones err by {worst:.1e} at most");
    // thin layers bulge, but their contacts grow
    let of = |kinds: &[usize], outcome: usize| kinds.iter().map(|&kind| counts[kind][outcome]).sum::<u32>();
    assert!(of(&[0, 1, 3], 0) > 0 && of(&[4, 7], 0) > 0 && of(&[4, 7], 1) == 0, "{counts:?}");
}

/// A sweep that ends early is checked as a whole one is.
#[test]
fn sweeps_that_end_early_are_refused_or_right() {
    let end = |number: u64| match number / KINDS % 4 {
        0 => End::Limit(12),
        1 => End::Limit(20),
        2 => End::Callback(20),
        _ => End::Limit(40),
    };
    let (counts, worst) = outcomes(from_environment("STATES_EARLY", 64), end);
    println!("refused and right, by kind: {counts:?}; the right ones err by {worst:.1e} at most");
    assert!(
        counts.iter().map(|count| count[0]).sum::<u32>() > 10 && counts.iter().map(|count| count[1]).sum::<u32>() > 10,
        "{counts:?}"
    );
}

/// Compares contacts on so many scenes with the stepper, on states of sweeps that end as `end` gives for each scene. Returns how many
/// scenes of each kind were refused and were right, and the greatest error.
fn outcomes(scenes: u64, end: impl Fn(u64) -> End) -> ([[u32; 2]; KINDS as usize], f64) {
    let material = Material::incompressible(GeneralizedMaxwell::new(0.05, &[(0.1, 0.1), (0.1, 2.0)]).unwrap());
    let (mut counts, mut worst) = ([[0u32; 2]; KINDS as usize], 0.0f64);
    for number in 0..scenes {
        let draws = &mut Draws::new(number.wrapping_add(41_000_011));
        let scene = scene(draws, number);
        let of_kind = &mut counts[(number % KINDS) as usize];
        let sweep = Sweep::new(scene.grid.clone(), &*scene.geometry).kernel(Arc::clone(&scene.kernel));
        let sweep = sweep.tilt(scene.tilt).settings(settings()).accuracy(1e-3);
        let reach = Reach::Level(3e-3);
        let swept = match end(number) {
            End::Whole => sweep.run(reach),
            End::Limit(most) => sweep.max_states(most).run(reach),
            End::Callback(most) => sweep.run_with(reach, |states| {
                if states.len() < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            }),
        };
        let states = match swept {
            Ok(states) => states,
            Err(Error::Shrinks { .. }) => {
                of_kind[0] += 1;
                continue;
            }
            Err(error) => panic!("{} {number}: {error}", scene.name),
        };
        let mut contact =
            StatesContact::new(&states, &material).unwrap().with_linear_steps().with_exact_states().unwrap();
        let builder = ViscoelasticContact::builder(scene.grid.clone()).geometry(&*scene.geometry);
        let builder = builder.material(material.clone()).kernel(Arc::clone(&scene.kernel)).settings(settings());
        let mut full = builder.build().unwrap();
        let last = states.states().last().unwrap().level * 0.2;
        let mut is_refused = false;
        for step in 0..10 {
            let turn = |tilt: Tilt| match tilt {
                Tilt::Fixed(angle) => Tilt::Fixed(angle * (1.0 - 0.1 * f64::from(step))),
                Tilt::Free { at } => Tilt::Free { at: at * (1.0 - 0.1 * f64::from(step)) },
                other => panic!("{other:?}"),
            };
            let tilt = if scene.turns { scene.tilt.map(turn) } else { scene.tilt };
            let load = Load::Force { normal: last * draws.between(0.02, 0.98), tilt };
            let dt = draws.power_of_ten(-2.0, 1.0);
            let before = format!("{contact:?}");
            match contact.step(dt, load) {
                Ok(_) => {}
                Err(error) if error.code().starts_with("states_") => {
                    assert_ne!(error.code(), "states_beyond", "{} {number}: {error}", scene.name);
                    assert_eq!(format!("{contact:?}"), before);
                    is_refused = true;
                    break;
                }
                Err(error) => panic!("{} {number}: {error}", scene.name),
            }
            full.step(dt, load).unwrap();
            let off = (full.approach() - contact.approach()).abs() / scene.depth;
            let peak = contact.fields(0.0).unwrap().fields().max_pressure();
            let off = off.max((peak / full.fields().max_pressure() - 1.0).abs());
            worst = worst.max(off);
            assert!(off < 1e-3, "{} {number} step {step}: {off:.1e}", scene.name);
        }
        assert!(is_refused || !scene.turns, "{} {number}", scene.name);
        of_kind[usize::from(!is_refused)] += 1;
    }
    (counts, worst)
}
