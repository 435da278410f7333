//! Plans of random scenes: balls, cones, ellipsoids and punches under steps, ramps, holds and sines of force and approach, each
//! against its equivalent foundation of independent springs. `PLANS` and `PLANS_SEED` choose how many scenes and which,
//! `PLANS_CELLS` the side of the largest mesh that is run.

use std::time::Instant;

use viscocontact::analytic::{AxisymmetricContact, Hertz, HertzEllipse, Profile};
use viscocontact::prelude::*;

use crate::common::draws::Draws;
use crate::common::environment::from_environment;

const RADIUS: f64 = 10.0e-3;
const SLOPE: f64 = 0.05;
const PUNCH: f64 = 1.0e-3;
/// Modulus at once [Pa]: E* is four times that.
const MODULUS: f64 = 1.0e6;
/// Elements of a foundation.
const ELEMENTS: usize = 3000;

#[derive(Debug, Clone, Copy)]
enum Shape {
    Ball,
    Cone,
    Ellipsoid(f64),
    Punch,
}

impl Shape {
    fn geometry(self) -> Box<dyn Geometry> {
        match self {
            Shape::Ball => Box::new(Sphere::new(RADIUS).unwrap()),
            Shape::Cone => Box::new(Cone::new(SLOPE).unwrap()),
            Shape::Ellipsoid(other) => Box::new(Ellipsoid::new(RADIUS, other).unwrap()),
            Shape::Punch => Box::new(FlatPunch::circular(PUNCH).unwrap()),
        }
    }

    /// Profile of the foundation, and what multiplies its approach and its pressure. Ellipses of contact keep their shape: they
    /// behave as the sphere whose contact radius is their semi-axis a.
    fn foundation(self) -> (Profile, [f64; 2]) {
        match self {
            Shape::Ball => (Profile::sphere(RADIUS).unwrap(), [1.0; 2]),
            Shape::Cone => (Profile::cone(SLOPE).unwrap(), [1.0; 2]),
            Shape::Punch => (Profile::punch(PUNCH).unwrap(), [1.0; 2]),
            Shape::Ellipsoid(other) => {
                let ellipse = HertzEllipse::new([RADIUS, other], 4.0 * MODULUS, 1.0).unwrap();
                let [a, b] = ellipse.semi_axes;
                let radius = a.powi(3) * 4.0 * MODULUS / 0.75;
                let sphere = Hertz::new(radius, 4.0 * MODULUS, 1.0).unwrap();
                (Profile::sphere(radius).unwrap(), [ellipse.approach / sphere.approach, a / b])
            }
        }
    }

    /// Approach and force of elastic bodies of a compliance whose contact is as large as a circle of this radius.
    fn elastic(self, radius: f64, compliance: f64) -> [f64; 2] {
        match self {
            Shape::Ball => [radius * radius / RADIUS, radius.powi(3) / (0.75 * RADIUS * compliance)],
            Shape::Cone => {
                let depth = 0.5 * std::f64::consts::PI * SLOPE * radius;
                [depth, depth * radius / compliance]
            }
            Shape::Ellipsoid(other) => {
                let unit = HertzEllipse::new([RADIUS, other], 1.0 / compliance, 1.0).unwrap();
                let force = (radius / unit.semi_axes[0]).powi(3);
                [unit.approach * force.powf(2.0 / 3.0), force]
            }
            Shape::Punch => [0.02 * PUNCH, 0.04 * PUNCH * PUNCH / compliance],
        }
    }
}

struct Scene {
    name: String,
    shape: Shape,
    material: Material,
    history: Box<dyn LoadHistory>,
    until: f64,
    by_force: bool,
    accuracy: Accuracy,
    /// Contact radius at the greatest load, roughly.
    radius: f64,
}

fn body(draws: &mut Draws, ratio: f64, until: f64) -> (&'static str, Material) {
    let glassy = 1.0 / MODULUS;
    let (name, creep) = match draws.below(3) {
        0 => {
            let viscosity = until / ((ratio - 1.0) * glassy);
            ("Maxwell", GeneralizedKelvin::new(glassy, 1.0 / viscosity, &[]))
        }
        1 => {
            let time = until * draws.power_of_ten(-2.0, 0.3);
            ("Zener", GeneralizedKelvin::new(glassy, 0.0, &[((ratio - 1.0) * glassy, time)]))
        }
        _ => {
            let count = 2 + draws.below(4);
            let mut term = || ((ratio - 1.0) * glassy / count as f64, until * draws.power_of_ten(-3.0, 0.3));
            let terms: Vec<_> = (0..count).map(|_| term()).collect();
            ("several times", GeneralizedKelvin::new(glassy, 0.0, &terms))
        }
    };
    (name, Material::incompressible(creep.unwrap()))
}

fn scene(seed: u64, number: u64) -> Scene {
    let draws = &mut Draws::new(seed.wrapping_mul(1_000_003).wrapping_add(number));
    let shape = match draws.below(4) {
        0 => Shape::Ball,
        1 => Shape::Cone,
        2 => Shape::Ellipsoid(RADIUS * draws.power_of_ten(-1.0, 1.0)),
        _ => Shape::Punch,
    };
    let (ratio, until) = (draws.power_of_ten(0.1, 3.0), draws.power_of_ten(-2.0, 1.0));
    let (body, material) = body(draws, ratio, until);
    let radius = draws.power_of_ten(-4.0, -2.8);
    let by_force = draws.chance(0.5);
    let [depth, force] = shape.elastic(radius, material.contact_compliance(until));
    let full = |share: f64| if by_force { Load::force(share * force) } else { Load::approach(share * depth) };
    let (kind, part) = (draws.below(4), draws.power_of_ten(-1.5, 0.0));
    let (history_name, history): (&str, Box<dyn LoadHistory>) = match kind {
        0 => ("step", Box::new(StepLoad::new(full(1.0)).unwrap())),
        1 => ("ramp", Box::new(Ramp::new(full(0.0), full(1.0), until * 1.001).unwrap())),
        2 => ("ramp and hold", Box::new(Ramp::new(full(0.0), full(1.0), part * until).unwrap())),
        _ => {
            let low = draws.between(0.2, 0.8);
            let periods = draws.between(0.3, 3.0);
            ("sine", Box::new(Sinusoid::new(full(low), full(1.0), periods / until).unwrap()))
        }
    };
    let accuracy = if draws.chance(0.7) { Accuracy::Coarse } else { Accuracy::Standard };
    let by = if by_force { "force" } else { "approach" };
    let name = format!(
        "{seed}:{number} {shape:?}, {body} ×{ratio:.1}, {history_name} ({part:.2}) of {by}, {until:.1e} s, {accuracy:?}"
    );
    Scene { name, shape, material, history, until, by_force, accuracy, radius }
}

/// Main quantity at the given times, the greatest pressure of all times, and the greatest main quantity.
fn truth(scene: &Scene, times: &[f64]) -> (Vec<f64>, Option<f64>) {
    let (profile, [approaches, pressures]) = scene.shape.foundation();
    let punch = matches!(scene.shape, Shape::Punch);
    // the last element lies beyond the face of the punch
    let reach = if punch { PUNCH * (1.0 + 1.0 / ELEMENTS as f64) } else { 1.6 * scene.radius };
    let mut foundation = AxisymmetricContact::new(&profile, &scene.material, ELEMENTS + 1, reach).unwrap();
    // steps are graded after the start: pressures may be greatest early
    let mut fine: Vec<f64> = (0..240).map(|k| scene.until * 10f64.powf(-6.0 + 6.0 * f64::from(k) / 239.0)).collect();
    fine.extend((1..=400).map(|k| scene.until * f64::from(k) / 400.0));
    fine.extend(times.iter().copied().chain([0.0]));
    let mut breakpoint = scene.history.next_breakpoint(0.0);
    while let Some(at) = breakpoint.filter(|&at| at <= scene.until) {
        fine.extend((0..20).map(|k| at + (scene.until - at) * 10f64.powf(-5.0 + 0.25 * f64::from(k))));
        fine.push(at);
        breakpoint = scene.history.next_breakpoint(at);
    }
    fine.retain(|&time| time <= scene.until);
    fine.sort_by(f64::total_cmp);
    fine.dedup();
    let (mut main, mut highest) = (Vec::new(), 0.0_f64);
    for time in fine {
        let dt = time - foundation.time();
        match scene.history.at(time) {
            Load::Force { normal, .. } => foundation.press(dt, normal).unwrap(),
            Load::Approach { approach, .. } => foundation.indent(dt, approach / approaches).unwrap(),
            load => panic!("{load:?}"),
        }
        if times.contains(&time) {
            main.push(if scene.by_force { approaches * foundation.approach() } else { foundation.force() });
        }
        if !punch {
            let edge = foundation.contact_radius();
            let radii = (0..24).map(|k| edge * (1.0 - 10f64.powf(-0.15 * f64::from(k))));
            highest = radii.map(|r| pressures * foundation.pressure(r)).fold(highest, f64::max);
        }
    }
    (main, (!punch).then_some(highest))
}

/// True errors over what was asked: of approach or force, and of the greatest pressure if that is promised.
struct Outcome {
    over: [Option<f64>; 2],
    note: String,
}

fn deliver(scene: &Scene) -> Result<Outcome, Error> {
    let Scene { material, history, until, accuracy, .. } = scene;
    let started = Instant::now();
    let geometry = scene.shape.geometry();
    let plan = Plan::new(&*geometry, material, &**history, *until, *accuracy)?;
    let planning = started.elapsed().as_secs_f64();
    let limit = from_environment("PLANS_CELLS", 150) as usize;
    let note = format!("{plan}; planned in {planning:.2} s");
    if plan.grid.len() > limit * limit {
        return Ok(Outcome { over: [None; 2], note });
    }
    let mut contact = plan.builder.clone().build()?;
    let mut run = contact.follow(&**history, plan.stepping, *until);
    let (mut times, mut main, mut highest) = (vec![], vec![], 0.0_f64);
    while let Some(report) = run.next_step()? {
        // of several states at a time, the last
        if times.last() == Some(&report.time) {
            main.pop();
        } else {
            times.push(report.time);
        }
        main.push(if scene.by_force { report.approach } else { report.force });
        highest = highest.max(run.contact().max_pressure());
    }
    let (exact, peak) = truth(scene, &times);
    assert_eq!(exact.len(), main.len());
    let greatest = exact.iter().copied().fold(0.0, f64::max);
    let worst = main.iter().zip(&exact).map(|(main, exact)| (main - exact).abs()).fold(0.0, f64::max) / greatest;
    let asked = accuracy.target().max(plan.time_error.unwrap_or(0.0));
    let pressure = peak.map(|peak| (highest / peak - 1.0).abs() / accuracy.target());
    let promised = pressure.filter(|_| plan.pressure_converges());
    let shown = pressure.map_or("-".into(), |over| format!("{over:.2}"));
    let note = format!("main {:.2}, pressure {shown}; {note}", worst / asked);
    Ok(Outcome { over: [Some(worst / asked), promised], note })
}

#[test]
fn no_plan_is_refused_and_none_breaks_its_promise() {
    let (seed, first, count) =
        (from_environment("PLANS_SEED", 1), from_environment("PLANS_FIRST", 0), from_environment("PLANS", 8));
    let (mut failed, mut promised, mut delivered) = (vec![], 0, 0);
    for number in first..first + count {
        let scene = scene(seed, number);
        match deliver(&scene) {
            Err(error) => failed.push(format!("{}: {error}", scene.name)),
            Ok(Outcome { over, note }) => {
                println!("{}: {note}", scene.name);
                delivered += usize::from(over[0].is_some());
                promised += usize::from(over[1].is_some());
                if over.iter().flatten().any(|&over| over > 2.0) {
                    failed.push(format!("{}: {over:.2?}, {note}", scene.name));
                }
            }
        }
    }
    println!("{delivered} of {count} plans run, {promised} with the greatest pressure promised");
    assert!(failed.is_empty(), "{} of {count} plans:\n{}", failed.len(), failed.join("\n"));
}
