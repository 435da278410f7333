//! Adaptive steps of surfaces that attract each other, against many short steps of given length: random scenes through snap-in and pull-off.
//! `ADHESION_RUNS` (3) and `ADHESION_SEED` (1) choose others.

use std::sync::Arc;

use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use viscocontact::adhesion::{AdhesionError, Attraction, ExponentialAttraction, LinearSoftening, VanDerWaals};
use viscocontact::contact::Warnings;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

const SIDE: f64 = 8.0;
const SPAN: f64 = 10.0;
const SHORT_STEPS: usize = 1000;

struct Scene {
    name: String,
    shape: Box<dyn Geometry>,
    material: Material,
    law: Arc<dyn Attraction>,
    cells: usize,
    path: PiecewiseLinear,
}

impl Scene {
    fn draw(number: u64, seed: u64) -> Scene {
        let mut draws = Draws::new(1000 * seed + number);
        let mu = draws.scale(0.3, 1.4);
        let law: Arc<dyn Attraction> = match draws.below(3) {
            0 => Arc::new(ExponentialAttraction::new(1.0, 1.0 / mu).unwrap()),
            1 => Arc::new(VanDerWaals::new(1.0, 1.0 / mu).unwrap()),
            _ => Arc::new(LinearSoftening::new(1.0, 1.0 / mu).unwrap()),
        };
        let sphere = Sphere::new(1.0).unwrap();
        let wavy = Wavy::new(draws.between(0.05, 0.3), SIDE / draws.between(3.0, 6.0)).unwrap();
        let shape: Box<dyn Geometry> =
            if draws.chance(0.6) { Box::new(sphere) } else { Box::new(Sum::new(sphere, wavy)) };
        let terms: Vec<_> = (0..1 + draws.below(2)).map(|_| (draws.scale(0.1, 2.0), draws.scale(0.1, 5.0))).collect();
        let material = Material::incompressible(GeneralizedMaxwell::new(0.25, &terms).unwrap());
        let (kind, stiffness) = (draws.below(2), draws.scale(2.0, 30.0));
        let load = |at: f64| if kind == 0 { Load::approach(at) } else { Load::spring(stiffness, at) };
        let [down, out] = [draws.between(0.3, 1.0), draws.between(-4.0, -2.0)];
        let turns = [0.3 * SPAN, 0.3 * SPAN + draws.between(0.1, 2.0)];
        let path = [(0.0, load(-1.0)), (turns[0], load(down)), (turns[1], load(down)), (SPAN, load(out))];
        Scene {
            name: format!("scene {number}: μ = {mu:.2}, {law:?}, load {kind}, {} terms", terms.len()),
            shape,
            material,
            law,
            cells: (2.0 * (2.2 * SIDE * mu * mu).ceil()).max(24.0) as usize,
            path: PiecewiseLinear::new(&path).unwrap(),
        }
    }

    fn build(&self) -> ViscoelasticContact {
        ViscoelasticContact::builder(Grid::square(self.cells, SIDE).unwrap())
            .geometry(&*self.shape)
            .material(self.material.clone())
            .attraction(Arc::clone(&self.law))
            .settings(Settings::default().with_edge(Edge::Allow))
            .build()
            .unwrap()
    }
}

/// The force stays within three tolerances of the curve in 95 % of the runs and ten in all of short steps, in force or in time: a jump takes no time, so that the force itself has no error
/// there. Every great jump of the short steps is reported, with the energy that it loses.
#[test]
fn adaptive_runs_follow_short_steps() {
    let (runs, seed) = (from_environment("ADHESION_RUNS", 3), from_environment("ADHESION_SEED", 1));
    let (mut worst, mut beyond, mut jumps) = ([0.0f64; 2], 0, 0);
    for number in 0..runs {
        let scene = Scene::draw(number, seed);
        let (mut contact, dt) = (scene.build(), SPAN / SHORT_STEPS as f64);
        let mut curve = vec![(0.0, contact.step(0.0, scene.path.at(0.0)).unwrap().force)];
        let mut great = Vec::new();
        for k in 1..=SHORT_STEPS {
            let time = dt * k as f64;
            let report = contact.step(dt, scene.path.at(time)).unwrap();
            let passes = contact.passes().unwrap();
            if passes.response > 50.0 && passes.released > 0.05 {
                great.push((time, passes.released));
            }
            curve.push((time, report.force));
        }
        let most = curve.iter().fold(0.0f64, |most, (_, force)| most.max(force.abs()));
        for (which, tolerance) in [1e-2, 1e-3].into_iter().enumerate() {
            let mut contact = scene.build();
            let mut run = contact.follow(&scene.path, Stepping::adaptive(tolerance), SPAN);
            let (mut ratio, mut found, mut steps, mut work) = (0.0f64, Vec::new(), 0, 0.0);
            while let Some(report) = run.next_step().unwrap() {
                let off = |(time, force): (f64, f64)| {
                    ((time - report.time).abs() / SPAN).max((force - report.force).abs() / most) / tolerance
                };
                let between = |pair: &[(f64, f64)]| {
                    let at = |share: f64| {
                        (pair[0].0 + share * (pair[1].0 - pair[0].0), pair[0].1 + share * (pair[1].1 - pair[0].1))
                    };
                    (0..=20).map(|k| off(at(f64::from(k) / 20.0))).fold(f64::INFINITY, f64::min)
                };
                ratio = ratio.max(curve.windows(2).map(between).fold(f64::INFINITY, f64::min));
                if report.warnings.contains(Warnings::JUMP) {
                    found.push((report.time, report.dt, run.contact().passes().unwrap().released));
                }
                (steps, work) = (steps + 1, work + report.convolution_equivalents());
            }
            println!(
                "{}, {tolerance}: {ratio:.2} tolerances, {steps} steps, {work} equivalents, jumps {found:?}",
                scene.name
            );
            worst[which] = worst[which].max(ratio);
            beyond += u64::from(ratio > 3.0);
            assert!(ratio < 10.0, "{}: {ratio} tolerances", scene.name);
            for (time, released) in &great {
                jumps += 1;
                let near = |(at, length, _): &&(f64, f64, f64)| {
                    *at - length - 10.0 * tolerance * SPAN < *time && at + 10.0 * tolerance * SPAN > *time
                };
                let energy: f64 = found.iter().filter(near).map(|(.., energy)| energy).sum();
                println!("  jump at {time:.3}: {released:.4}, found {energy:.4}");
                assert!(
                    which == 0 || (energy - released).abs() < 0.1 * released,
                    "{}: {released} {energy}",
                    scene.name
                );
            }
        }
    }
    assert!(20 * beyond <= 2 * runs, "{beyond} of {} beyond 3 tolerances", 2 * runs);
    println!("{runs} scenes: worst {worst:.2?} tolerances, {beyond} beyond 3, {jumps} great jumps");
}

/// Under a force that pulls, the moment of separation is known to five tolerances of the time of the run: near it, bodies move fast.
#[test]
fn the_moment_of_separation() {
    let scene = Scene::draw(0, 1);
    let pull = |scene: &Scene, stepping| {
        let path = [(0.0, Load::force(1.0)), (1.0, Load::force(1.0)), (SPAN, Load::force(-9.0))];
        let path = PiecewiseLinear::new(&path).unwrap();
        let mut contact = scene.build();
        let mut run = contact.follow(&path, stepping, SPAN);
        loop {
            match run.next_step() {
                Ok(Some(_)) => {}
                Err(Error::Adhesion(AdhesionError::PulledOff { time, .. })) => return time,
                other => panic!("{other:?}"),
            }
        }
    };
    let short = pull(&scene, Stepping::fixed(0.005));
    for tolerance in [1e-2, 1e-3] {
        let found = pull(&scene, Stepping::adaptive(tolerance));
        println!("{tolerance}: separates at {found:.4}, in short steps at {short:.3}");
        assert!((found - short).abs() < 0.01 + 5.0 * tolerance * SPAN, "{found} {short}");
    }
}
