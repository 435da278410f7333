//! Plans on all bodies: random shapes on layers, periodic bodies, lines and half-spaces, under steps, ramps, holds and
//! sines of force and approach, compared with a run on finer cells in shorter steps. `PLANS_KERNELS`, `PLANS_FIRST` and
//! `PLANS_SEED` choose how many and which, `PLANS_CELLS` the side of the largest mesh that is run.

use std::ops::ControlFlow;
use std::time::Instant;

use viscocontact::geometry::Sum;
use viscocontact::prelude::*;
use viscocontact::{Axis, Error};

use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::ratios::Ratios;

/// Greatest work of planning over the work of the run, in the median, in convolutions times cells.
const MOST_PLANNING: f64 = 3.0;

type Kernel = Box<dyn Fn(&Grid) -> viscocontact::Result<InfluenceKernel>>;

struct Scene {
    name: String,
    geometry: Box<dyn Geometry>,
    kernel: Kernel,
    /// The period along both axes, or the length of a line.
    period: Option<f64>,
    line: Option<f64>,
    material: Material,
    history: Box<dyn LoadHistory>,
    by_force: bool,
    accuracy: Accuracy,
}

fn scene(seed: u64, number: u64) -> Scene {
    let draws = &mut Draws::new(seed.wrapping_mul(1_000_033).wrapping_add(number));
    let ratio = draws.power_of_ten(0.3, 2.0);
    let time = draws.power_of_ten(-2.0, 0.3);
    // E* = 4 G is 1 Pa at once
    let creep = GeneralizedKelvin::new(4.0, 0.0, &[(4.0 * (ratio - 1.0), time)]).unwrap();
    let material = Material::incompressible(creep);
    let rough = |height: f64| {
        let grid = Grid::square(64, 1.0).unwrap();
        let spec = RoughSpec::new(0.5, 0.12, Roughness::RmsHeight(height)).with_seed(number);
        Rough::new(&grid, spec).unwrap()
    };
    let thickness = draws.power_of_ten(-1.0, 0.5);
    let layer = Layer::bonded_to_rigid(thickness, 0.5).unwrap();
    let half_space = || -> Kernel { Box::new(InfluenceKernel::half_space) };
    let (kind, geometry, kernel, period, line, force): (_, Box<dyn Geometry>, Kernel, _, _, f64) = match draws.below(6)
    {
        0 => {
            let kernel: Kernel = Box::new(move |grid| InfluenceKernel::layer(grid, layer));
            ("ball on a layer", Box::new(Sphere::new(1.0).unwrap()), kernel, None, None, 0.01)
        }
        1 => {
            let kernel: Kernel = Box::new(InfluenceKernel::periodic);
            ("periodic rough", Box::new(rough(0.01)), kernel, Some(1.0), None, 0.005)
        }
        2 => {
            let wave = |x1: f64, x2: f64| {
                let turn = std::f64::consts::TAU;
                0.01 * (2.0 - (turn * x1).cos() - (turn * x2).cos())
            };
            let kernel: Kernel = Box::new(InfluenceKernel::periodic);
            ("periodic wave", Box::new(FnGeometry::new(wave)), kernel, Some(1.0), None, 0.005)
        }
        3 => {
            let kernel: Kernel = Box::new(|grid| InfluenceKernel::line(grid, 100.0));
            let cylinder = FnGeometry::new(|x1: f64, _| 0.5 * x1 * x1);
            ("cylinder", Box::new(cylinder), kernel, None, Some(2.0), 0.02)
        }
        4 => {
            let kernel: Kernel = Box::new(move |grid| InfluenceKernel::layer_line(grid, layer, None));
            let cylinder = FnGeometry::new(|x1: f64, _| 0.5 * x1 * x1);
            ("cylinder on a layer", Box::new(cylinder), kernel, None, Some(1.0), 0.02)
        }
        _ => {
            let tip = Sum::new(Sphere::new(1.0).unwrap(), rough(draws.power_of_ten(-4.0, -3.0)));
            ("rough tip", Box::new(tip), half_space(), None, None, 0.005)
        }
    };
    let by_force = draws.chance(0.5);
    let (force, depth) = (force * draws.power_of_ten(-1.0, 0.0) / ratio, 0.01 * draws.power_of_ten(-0.7, 0.3));
    // the approach of a periodic body and of a line is measured from another datum
    let by_force = by_force || period.is_some() || line.is_some();
    let full = |share: f64| if by_force { Load::force(share * force) } else { Load::approach(share * depth) };
    let (history_name, history): (_, Box<dyn LoadHistory>) = match draws.below(4) {
        0 => ("step", Box::new(StepLoad::new(full(1.0)).unwrap())),
        1 => ("ramp", Box::new(Ramp::new(full(0.0), full(1.0), 1.001).unwrap())),
        2 => ("ramp and hold", Box::new(Ramp::new(full(0.0), full(1.0), draws.power_of_ten(-1.5, 0.0)).unwrap())),
        _ => {
            let (low, periods) = (draws.between(0.2, 0.8), draws.between(0.3, 3.0));
            if low < 0.35 {
                ("square", Box::new(Periodic::square(full(1.0), full(low), 1.0 / periods, 0.5).unwrap()))
            } else {
                ("sine", Box::new(Sinusoid::new(full(low), full(1.0), periods).unwrap()))
            }
        }
    };
    let accuracy = if draws.chance(0.7) { Accuracy::COARSE } else { Accuracy::STANDARD };
    let by = if by_force { "force" } else { "approach" };
    let name = format!(
        "{seed}:{number} {kind} (layer {thickness:.2}), creep ×{ratio:.1} in {time:.2}, {history_name} of {by}, {accuracy:?}"
    );
    Scene { name, geometry, kernel, period, line, material, history, by_force, accuracy }
}

/// The main result at each time, and the greatest one and the greatest pressure of the run.
fn run(scene: &Scene, builder: Builder, stepping: Stepping, [times, stops]: [&[f64]; 2]) -> (Vec<f64>, [f64; 2]) {
    let mut contact = builder.build().unwrap();
    let run = contact.follow(&scene.history, stepping, 1.0).stop_at(times).unwrap();
    let mut run = run.stop_at(stops).unwrap();
    let (mut found, mut greatest) = (Vec::new(), [0.0_f64; 2]);
    while let Some(report) = run.next_step().unwrap() {
        let main = if scene.by_force { report.approach } else { report.force };
        greatest = [greatest[0].max(main.abs()), greatest[1].max(run.contact().max_pressure())];
        if times.get(found.len()) == Some(&report.time) {
            found.push(main);
        }
    }
    (found, greatest)
}

/// Whether the shape meets nothing at any approach of the history, as 400² points over ten times the width of any contact show.
fn stays_apart(scene: &Scene) -> bool {
    let approach = |k: u32| match scene.history.at(f64::from(k) / 1000.0) {
        Load::Approach { approach, .. } => approach,
        _ => f64::INFINITY,
    };
    let deepest = (0..=1000).map(approach).fold(f64::NEG_INFINITY, f64::max);
    let places = (0..400 * 400).map(|k| [k / 400, k % 400].map(|k| 0.005 * (f64::from(k) - 199.5)));
    places.into_iter().all(|[x1, x2]| scene.geometry.initial_gap(x1, x2) > deepest)
}

#[test]
fn plans_on_all_bodies_keep_their_promises() {
    let (seed, most) = (from_environment("PLANS_SEED", 1), from_environment("PLANS_CELLS", 220) as usize);
    let (mut worst, mut peak, mut ratios, mut larger, mut promised) = (0.0f64, 0.0f64, Ratios::default(), 0, 0);
    let mut refused = Vec::new();
    let first = from_environment("PLANS_FIRST", 0);
    for number in first..first + from_environment("PLANS_KERNELS", 8) {
        let scene = scene(seed, number);
        let started = Instant::now();
        let builder = Plan::builder(&scene.geometry, &scene.material, &scene.history, 1.0).accuracy(scene.accuracy);
        let mut builder = builder.kernel(&scene.kernel);
        if let Some(period) = scene.period {
            builder = builder.period(Axis::X1, period).period(Axis::X2, period);
        }
        if let Some(length) = scene.line {
            builder = builder.line(length);
        }
        let mut work = 0.0;
        let plan = builder.build_with(|progress| {
            work = progress.work;
            ControlFlow::Continue(())
        });
        let plan = match plan {
            Ok(plan) => plan,
            // a rough tip may stay above the body
            Err(Error::NoDomain { .. }) if stays_apart(&scene) => continue,
            Err(error) => {
                println!("{}: {error}", scene.name);
                refused.push(scene.name);
                continue;
            }
        };
        let planning = started.elapsed();
        let [n1, n2] = plan.grid.cells();
        let ratio = work / (plan.convolutions * plan.grid.len() as f64);
        ratios.push(ratio, &scene.name);
        if n1 * n2 > most * most {
            larger += 1;
            continue;
        }
        let times = [0.01, 0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0];
        let started = Instant::now();
        let mut own = plan.builder.clone().build().unwrap();
        let mut follow = own.follow(&scene.history, plan.stepping, 1.0);
        while follow.next_step().unwrap().is_some() {}
        let running = started.elapsed();
        let (found, [_, highest]) = run(&scene, plan.builder.clone(), plan.stepping, [&times, &plan.stops]);
        let finer = Grid::new([2 * n1, if n2 == 1 { 1 } else { 2 * n2 }], plan.grid.lengths()).unwrap();
        let kernel = (scene.kernel)(&finer).unwrap();
        let reference = ViscoelasticContact::builder(finer).geometry(&*scene.geometry).material(scene.material.clone());
        let reference = reference.kernel(kernel).settings(Settings::default().with_tolerance(1e-7));
        let stepping = Stepping::adaptive(0.036 * scene.accuracy.target());
        let (exact, [scale, exact_highest]) = run(&scene, reference, stepping, [&times, &[]]);
        let off = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale;
        let off = off / scene.accuracy.target();
        worst = worst.max(off);
        let mut off_peak = 0.0;
        if plan.pressure_converges() {
            promised += 1;
            off_peak = (highest / exact_highest - 1.0).abs() / scene.accuracy.target();
            peak = peak.max(off_peak);
        }
        println!(
            "{}: {n1} × {n2}, {off:.2}, {off_peak:.2}, planned in {:.2} of the work of the run, {:.2} of its time",
            scene.name,
            ratio,
            planning.as_secs_f64() / running.as_secs_f64()
        );
    }
    println!(
        "{} plans, {larger} larger, {} refused; worst error over the accuracy {worst:.2}, of {promised} peaks {peak:.2}",
        ratios.count(),
        refused.len()
    );
    ratios.print("planning over the run", 3);
    assert!(refused.is_empty(), "{refused:?}");
    assert!(worst < 2.0 && peak < 2.0, "{worst} {peak}");
    // a few scenes have no median to speak of
    assert!(ratios.count() < 8 || ratios.quantile(0.5) <= MOST_PLANNING, "{}", ratios.quantile(0.5));
}
