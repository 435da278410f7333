//! Is a creeping contact the superposition of its own elastic states? The stepper in space is the reference.

use std::sync::Arc;

use crate::common::fields::gap;
use crate::common::{Draws, builder_of, from_environment};
use approx::assert_relative_eq;
use viscocontact::contact::{Edge, TimeRule};
use viscocontact::geometry::Sum;
use viscocontact::load::Tilt;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};
use viscocontact::states::{ElasticStates, Reach, StatesContact, Sweep};

/// A contact modulus E(t) [Pa] of an incompressible body, G = E/4.
fn body(equilibrium: f64, terms: &[(f64, f64)]) -> Material {
    let terms: Vec<(f64, f64)> = terms.iter().map(|&(modulus, time)| (modulus / 4.0, time)).collect();
    Material::incompressible(GeneralizedMaxwell::new(equilibrium / 4.0, &terms).unwrap())
}

fn ball_states() -> Arc<ElasticStates> {
    let grid = Grid::square(24, 4.0e-3).unwrap();
    Sweep::new(grid, &Sphere::new(10.0e-3).unwrap()).accuracy(1e-3).run(Reach::Level(5.0e-7)).unwrap()
}

/// The level under a given force depends on force and material alone: values of the integral equation, with E = ¼ + ¾ e^(−t).
#[test]
fn levels_under_a_force_do_not_depend_on_the_shape() {
    let (states, unit, steps) = (ball_states(), 3.0e-7, 400);
    let mut contact = StatesContact::new(&states, &body(0.25, &[(0.75, 1.0)])).unwrap();
    contact.step(0.0, Load::force(0.0)).unwrap();
    let expected =
        [(0.5, 0.5899628), (1.0, 1.3456094), (1.25, 1.2185243), (1.5, 0.9822654), (1.75, 0.5932171), (1.9, 0.2649620)];
    let mut compared = 0;
    for k in 1..=760 {
        let time = f64::from(k) / f64::from(steps);
        let force = unit * if time <= 1.0 { time } else { 2.0 - time };
        contact.step(1.0 / f64::from(steps), Load::force(force)).unwrap();
        if let Some((_, level)) = expected.iter().find(|(at, _)| (at - time).abs() < 1e-9) {
            assert_relative_eq!(contact.level() / unit, *level, max_relative = 1e-6);
            compared += 1;
        }
    }
    assert_eq!(compared, expected.len());

    let mut contact = StatesContact::new(&states, &body(0.25, &[(0.75, 1.0)])).unwrap();
    contact.step(0.0, Load::force(unit)).unwrap();
    let held = |contact: &mut StatesContact, time: f64, force: f64| {
        while contact.time() < time - 1e-9 {
            contact.step(2.5e-3, Load::force(force * unit)).unwrap();
        }
        contact.level() / unit
    };
    assert_relative_eq!(held(&mut contact, 1.0, 1.0), 1.6635977, max_relative = 1e-6);
    contact.step(0.0, Load::force(0.4 * unit)).unwrap();
    assert_relative_eq!(contact.level() / unit, 0.7605870, max_relative = 1e-6);
    for (time, level) in [(1.25, 0.8522827), (2.0, 1.0542604), (5.0, 1.3876905), (20.0, 1.5953345)] {
        assert_relative_eq!(held(&mut contact, time, 0.4), level, max_relative = 1e-6);
    }
}

/// A scene of which the elastic contact only grows.
struct Scene {
    name: String,
    grid: Grid,
    geometry: Box<dyn Geometry>,
    kernel: Arc<InfluenceKernel>,
    tilt: [Tilt; 2],
    nu: f64,
    depth: f64,
}

fn random_scene(number: u64) -> Scene {
    let mut draws = Draws::new(number.wrapping_add(7_000_003));
    let cells = 12 + draws.below(12);
    let grid = Grid::square(cells, 1.0).unwrap();
    let rough = |grid: &Grid, height: f64, seed: usize| {
        let spec = RoughSpec::new(0.5, 0.2, Roughness::RmsHeight(height)).with_seed(seed as u64);
        Rough::new(grid, spec).unwrap()
    };
    let (seed, height) = (draws.below(10_000), draws.power_of_ten(-3.5, -2.0));
    let ball = || Sum::new(Ellipsoid::new(2.0, 1.3).unwrap(), rough(&grid, height, seed));
    let (mut tilt, mut nu, kind) = ([Tilt::Fixed(0.0); 2], 0.5, draws.below(7));
    let half_space = || InfluenceKernel::half_space(&grid);
    let (name, geometry, kernel, depth): (&str, Box<dyn Geometry>, _, f64) = match kind {
        0 => ("rough ball", Box::new(ball()), half_space(), 0.04),
        1 => ("periodic", Box::new(rough(&grid, 0.02, seed)), InfluenceKernel::periodic(&grid), 0.03),
        2 => {
            nu = draws.between(0.0, 0.5);
            let layer = Layer::bonded_to_rigid(draws.between(0.3, 2.0), nu).unwrap();
            ("layer", Box::new(ball()), InfluenceKernel::layer(&grid, layer), 0.03)
        }
        3 => {
            let angle = draws.between(-0.02, 0.02);
            tilt = [Tilt::Fixed(angle), Tilt::Fixed(-0.5 * angle)];
            ("tilted ball", Box::new(ball()), half_space(), 0.04)
        }
        4 | 5 => {
            tilt = [Tilt::Free { at: draws.between(-0.05, 0.05) }, Tilt::Free { at: draws.between(-0.05, 0.05) }];
            let punch = Sum::new(FlatPunch::rectangular([0.7, 0.5]).unwrap(), rough(&grid, 1e-3, seed));
            ("rough punch, free tilt", Box::new(punch), half_space(), 0.04)
        }
        _ => ("cone", Box::new(Cone::new(0.1).unwrap()), half_space(), 0.06),
    };
    Scene { name: format!("{name} {number}"), geometry, kernel: Arc::new(kernel.unwrap()), tilt, nu, depth, grid }
}

impl Scene {
    fn settings() -> Settings {
        Settings::default().with_edge(Edge::Allow).with_tolerance(1e-11).with_time_rule(TimeRule::ExponentialLinear)
    }

    fn builder(&self, material: Material) -> Builder {
        let builder = builder_of(&*self.geometry, self.grid.clone(), material);
        builder.kernel(Arc::clone(&self.kernel)).settings(Scene::settings())
    }

    fn sweep(&self) -> viscocontact::Result<Arc<ElasticStates>> {
        let sweep = Sweep::new(self.grid.clone(), &*self.geometry).kernel(Arc::clone(&self.kernel));
        sweep.tilt(self.tilt).accuracy(1e-5).settings(Scene::settings()).run(Reach::Approach(self.depth))
    }

    fn of(&self, terms: &[(f64, f64)], equilibrium: f64, elastic_bulk: bool) -> Material {
        // C = (1 − ν) J/2
        let factor = 0.5 * (1.0 - self.nu);
        let terms: Vec<(f64, f64)> = terms.iter().map(|&(modulus, time)| (modulus * factor, time)).collect();
        let shear = GeneralizedMaxwell::new(equilibrium * factor, &terms).unwrap();
        if elastic_bulk && self.nu == 0.5 {
            return Material::elastic_bulk(shear, 3.0).unwrap();
        }
        Material::constant_poisson(shear, self.nu).unwrap()
    }
}

/// Pressures, motions and cells of both, step by step, in histories of force or approach with jumps, holds, separation
/// and renewed contact.
#[test]
fn random_contacts_are_superpositions_of_their_elastic_states() {
    let (mut compared, mut refused, mut apart, mut worst) = (0, 0, 0, [0.0; 2]);
    for number in 0..from_environment("STATES_SCENES", 28) {
        let scene = random_scene(number);
        let mut draws = Draws::new(number);
        let states = match scene.sweep() {
            Ok(states) => states,
            Err(Error::Shrinks { .. }) => {
                refused += 1;
                continue;
            }
            Err(error) => panic!("{}: {error}", scene.name),
        };
        let count = if draws.chance(0.7) { 1 + draws.below(6) } else { 1 + draws.below(40) };
        let terms: Vec<(f64, f64)> =
            (0..count).map(|_| (draws.between(0.1, 1.0) / count as f64, draws.power_of_ten(-2.0, 1.0))).collect();
        let equilibrium = draws.between(0.1, 0.5);
        let material = scene.of(&terms, equilibrium, draws.chance(0.2));
        let mut full = scene.builder(material.clone());
        let mut contact = StatesContact::new(&states, &material).unwrap().with_linear_steps();
        if draws.chance(0.3) {
            let law = TimeTemperature::wlf(10.0, 60.0, 300.0).unwrap();
            let (rate, by) = (draws.between(0.1, 1.0), draws.between(-8.0, 8.0));
            let warming = TemperatureHistory::function(law, move |t| 300.0 + by * (rate * t).sin(), &[]).unwrap();
            full = full.temperature(warming.clone());
            contact = contact.with_temperature(warming);
        }
        let mut full = full.build().unwrap();
        let last = states.states().last().unwrap();
        let (by_force, by_spring) = (draws.chance(0.5), draws.chance(0.5));
        let softer = draws.power_of_ten(-2.0, 2.0);
        // under a given force the level is exact without it
        let exact = !by_force || number % 3 == 0;
        if exact {
            contact = contact.with_exact_states().unwrap();
        }
        for step in 0..14 {
            let dt = if step % 6 == 0 { 0.0 } else { draws.power_of_ten(-2.0, 1.0) };
            let share = if draws.chance(0.12) { 0.0 } else { draws.between(0.05, 0.95) };
            let load = if by_force {
                Load::Force { normal: share * last.level * equilibrium, tilt: scene.tilt }
            } else if by_spring {
                let stiffness = softer * last.level * equilibrium / scene.depth;
                Load::Spring { stiffness, drive: share * scene.depth * (1.0 + 0.5 / softer), tilt: scene.tilt }
            } else {
                Load::Approach { approach: share * scene.depth, tilt: scene.tilt }
            };
            match contact.step(dt, load) {
                Err(error) if error.code() == "states_below" => {
                    refused += 1;
                    break;
                }
                other => assert_eq!(other.unwrap().force, contact.force()),
            }
            full.step(dt, load).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
            if contact.level() == 0.0 {
                assert_eq!(full.contact_cells(), 0, "{} step {step}", scene.name);
                apart += 1;
                continue;
            }
            // a part of the depth is much of a small contact
            let small = 0.03 * last.level * equilibrium / full.force();
            let tolerance = if by_force { 1e-7 } else { 1e-7 * small.max(1.0) };
            let off = (full.force() - contact.force()).abs() / full.force();
            worst[0] = f64::max(worst[0], off / tolerance);
            assert!(off < tolerance, "{} step {step}: force off by {off:.1e}", scene.name);
            // a state between two of the sweep errs by some 1e-5 of the greatest depth
            let allowed = if exact { 1e-8 } else { 5e-5 };
            let off = (full.approach() - contact.approach()).abs() / scene.depth;
            worst[1] = f64::max(worst[1], off / allowed);
            assert!(
                off < allowed,
                "{} step {step}: approach off by {off:.1e}, {} groups",
                scene.name,
                contact.groups()
            );
            let kept = contact.fields(0.0).unwrap();
            let fields = kept.fields();
            let greatest = |a: &[f64], b: &[f64]| {
                let both = a.iter().zip(b).filter(|(a, b)| a.is_finite() || b.is_finite());
                both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            let (most, differ) = (full.fields().max_pressure(), greatest(fields.pressure(), full.pressure()));
            assert!(differ < 3.0 * tolerance * most, "{} step {step}: {:.1e}", scene.name, differ / most);
            let gaps = greatest(&gap(fields), &gap(full.fields()));
            let differ = gaps.max(greatest(fields.displacement(), full.fields().displacement()));
            assert!(differ < allowed * scene.depth, "{} step {step}: {:.1e}", scene.name, differ / scene.depth);
            let pairs = fields.pressure().iter().zip(full.pressure());
            let cells = pairs.filter(|(a, b)| (**a > 1e-9 * most) != (**b > 1e-9 * most)).count();
            assert!(cells == 0, "{} step {step}: {cells} cells differ", scene.name);
            compared += 1;
        }
    }
    println!(
        "{compared} states compared, {apart} apart, {refused} scenes refused; worst \
         force and approach over what is allowed {worst:.1?}"
    );
    assert!(compared > 4 * refused && apart > 0, "{compared} {refused} {apart}");
}

/// The tractions of the groups carry the force in every step of 200 random histories of forces: the topmost group is among them where
/// its level and the edge are one but for rounding.
#[test]
fn tractions_carry_the_force() {
    let (states, mut compared) = (ElasticStates::sphere(10.0e-3).unwrap(), 0);
    for scene in 0..200 {
        let mut draws = Draws::new(7100 + scene);
        let terms: Vec<(f64, f64)> = (0..2).map(|_| (draws.between(0.1, 1.0), draws.power_of_ten(-1.0, 1.0))).collect();
        let mut contact = StatesContact::new(&states, &body(draws.between(0.05, 0.5), &terms)).unwrap();
        for _ in 0..30 {
            let force = if draws.chance(0.1) { 0.0 } else { draws.between(0.0, 1.0) };
            let dt = if draws.chance(0.2) { 0.0 } else { draws.power_of_ten(-2.0, 0.5) };
            contact.step(dt, Load::force(force)).unwrap();
            let mut below = 0.0;
            let carried: f64 =
                contact.tractions().map(|(top, traction)| traction * (top - std::mem::replace(&mut below, top))).sum();
            assert!((carried - force).abs() < 1e-9, "scene {scene}: {carried} of {force} N");
            compared += usize::from(force > 0.0);
        }
    }
    assert!(compared > 4000, "{compared}");
}
