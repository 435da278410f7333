//! Bodies that springs drive, against bodies whose approach or force is given.

use crate::common::{Draws, contact_of, from_environment};
use viscocontact::contact::TimeRule;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

const LENGTH: f64 = 1.0;

/// A scene of one body or two, of all kernels, and the tilts that its loads leave free.
struct Scene {
    name: String,
    contact: ViscoelasticContact,
    tilts: Vec<[Tilt; 2]>,
    depth: f64,
    tolerance: f64,
}

fn random_scene(number: u64) -> Scene {
    let mut draws = Draws::new(number.wrapping_add(5_100_001));
    let kind = draws.below(7);
    let line = kind == 4;
    let cells = if line { [96, 1] } else { [14 + draws.below(14), 14 + draws.below(14)] };
    let grid = Grid::new(cells, [LENGTH, if line { 1.0 } else { LENGTH }]).unwrap();
    let (name, kernel) = match kind {
        0..3 => ("half-space", InfluenceKernel::half_space(&grid)),
        3 => ("periodic", InfluenceKernel::periodic(&grid)),
        4 => ("line", InfluenceKernel::line(&grid, 1.0)),
        5 => ("layer", InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(0.5, 0.4).unwrap())),
        _ => ("strips", InfluenceKernel::periodic_along(&grid, Axis::X2, 1.0)),
    };
    let depth = 0.03;
    let rough = RoughSpec::new(0.5, 0.2, Roughness::RmsHeight(draws.power_of_ten(-3.5, -2.3))).with_seed(number);
    let ball = |x: f64, radius: f64| -> Box<dyn Geometry> {
        let ball = Shifted::new(Ellipsoid::new(radius, 1.3 * radius).unwrap(), [x, 0.0]).unwrap();
        if line { Box::new(ball) } else { Box::new(Sum::new(ball, Rough::new(&grid, rough).unwrap())) }
    };
    let two = kind < 3 && draws.chance(0.4);
    let free = !two && matches!(kind, 0..3 | 5) && draws.chance(0.4);
    let mut builder = ViscoelasticContact::builder(grid.clone());
    let mut tilts = vec![[Tilt::Fixed(0.0); 2]];
    if two {
        builder = builder.geometry(&ball(-0.25, 0.8)).another_body(&ball(0.2, 0.9));
        tilts.push([Tilt::Fixed(0.0); 2]);
    } else if free {
        builder =
            builder.geometry(&Sum::new(FlatPunch::rectangular([0.7, 0.5]).unwrap(), Rough::new(&grid, rough).unwrap()));
        tilts[0] = [Tilt::Free { at: draws.between(-0.05, 0.05) }, Tilt::Free { at: draws.between(-0.05, 0.05) }];
    } else {
        builder = builder.geometry(&ball(0.0, 1.0));
    }
    let (rule, solver) = (
        if draws.chance(0.5) { TimeRule::Exponential } else { TimeRule::Backward },
        if draws.chance(0.7) { Solver::ActiveSet } else { Solver::PolonskyKeer },
    );
    let tolerance = draws.power_of_ten(-10.0, -5.0);
    let terms: Vec<(f64, f64)> = (0..3).map(|_| (draws.between(0.05, 0.5), draws.power_of_ten(-1.0, 1.0))).collect();
    let body = GeneralizedMaxwell::new(draws.between(0.1, 0.5), &terms).unwrap();
    let material = Material::constant_poisson(body, if kind == 5 { 0.4 } else { 0.5 }).unwrap();
    let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(tolerance);
    let settings = settings.with_time_rule(rule).with_solver(solver).with_window(draws.chance(0.5));
    let contact = builder.material(material).kernel(kernel.unwrap()).settings(settings).build().unwrap();
    Scene { name: format!("{name} {number}, {rule:?}, {solver:?}"), contact, tilts, depth, tolerance }
}

/// Approach of the point about which a body tilts.
fn at_pivot(state: &viscocontact::contact::BodyState, tilt: [Tilt; 2]) -> f64 {
    let at = tilt.map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 });
    state.approach + state.tilt[0] * at[0] + state.tilt[1] * at[1]
}

/// In every step W = k (z − ω), and the contact is that under the approach which the spring leaves; soft springs are forces, and stiff
/// ones approaches.
#[test]
fn springs_carry_what_their_approach_leads_to() {
    let (mut steps, mut apart, mut worst, mut work) = (0, 0, 0.0f64, [0usize; 2]);
    for number in 0..from_environment("SPRING_SCENES", 60) {
        let Scene { name, mut contact, tilts, depth, tolerance } = random_scene(number);
        let mut draws = Draws::new(number);
        let softest = draws.power_of_ten(-4.0, 6.0);
        for step in 0..10 {
            let dt = if step % 5 == 0 { 0.0 } else { draws.power_of_ten(-2.0, 1.0) };
            let loads: Vec<Load> = tilts
                .iter()
                .map(|&tilt| {
                    let stiffness = softest * draws.power_of_ten(0.0, 1.0);
                    // as much depth as force that the spring gives up
                    let give = 1.0 + 1.0 / stiffness;
                    let drive = depth * if draws.chance(0.15) { -0.3 } else { draws.between(0.1, 1.0) * give };
                    Load::Spring { stiffness, drive, tilt }
                })
                .collect();
            let mut given = contact.clone();
            let report = contact.step(dt, &loads).unwrap_or_else(|error| panic!("{name} step {step}: {error}"));
            let bodies: Vec<_> = (0..loads.len()).map(|body| contact.body(body).unwrap()).collect();
            let mut approaches = Vec::new();
            for ((load, state), &tilt) in loads.iter().zip(&bodies).zip(&tilts) {
                let Load::Spring { stiffness, drive, .. } = *load else { unreachable!() };
                let approach = at_pivot(state, tilt);
                let off = (approach + state.force / stiffness - drive).abs();
                // the spring and the surface yield together
                let yielding = state.force / stiffness + approach.abs();
                assert!(off <= 2.0 * tolerance * yielding + 1e-14, "{name} step {step}: {off:e} of {yielding:e}");
                approaches.push(Load::Approach { approach, tilt });
                apart += usize::from(state.force == 0.0);
            }
            work[0] += report.convolutions;
            let Ok(reference) = given.step(dt, &approaches) else { continue };
            work[1] += reference.convolutions;
            let most = given.max_pressure().max(contact.max_pressure());
            if report.force == 0.0 || most == 0.0 {
                continue;
            }
            let pairs = contact.pressure().iter().zip(given.pressure());
            let (differ, all) = pairs.fold((0.0, 0.0), |(sum, all), (a, b)| (sum + (a - b).powi(2), all + a * a));
            let relative = f64::sqrt(differ / all);
            worst = worst.max(relative / tolerance);
            assert!(relative < 1e3 * tolerance, "{name} step {step}: {relative:e} at {tolerance:e}");
            steps += 1;
        }
    }
    println!("{steps} steps, {apart} apart, pressures differ by {worst:.0} tolerances, convolutions {work:?}");
    assert!(steps > 100 && apart > 20);
}

/// A soft spring whose far end is far away is a force; a stiff one is an approach. Both within the solver's tolerance.
#[test]
fn soft_springs_are_forces_and_stiff_ones_approaches() {
    for number in 0..from_environment("SPRING_LIMITS", 30) {
        let Scene { name, contact, tilts, depth, tolerance } = random_scene(number);
        let mut draws = Draws::new(number);
        let [mut soft, mut pressed, mut stiff, mut lowered] = [(); 4].map(|()| contact.clone());
        let mut greatest = 1e-6f64;
        for step in 0..6 {
            let dt = if step == 0 { 0.0 } else { draws.power_of_ten(-2.0, 1.0) };
            let force = draws.between(0.1, 1.0) * depth * depth.sqrt();
            let approach = depth * draws.between(0.2, 1.0);
            let [low, high] = [1e-9, 1e9];
            let each = |load: &dyn Fn([Tilt; 2]) -> Load| tilts.iter().map(|&tilt| load(tilt)).collect::<Vec<_>>();
            let loads = [
                each(&|tilt| Load::Spring { stiffness: low, drive: force / low, tilt }),
                each(&|tilt| Load::Force { normal: force, tilt }),
                each(&|tilt| Load::Spring { stiffness: high, drive: approach, tilt }),
                each(&|tilt| Load::Approach { approach, tilt }),
            ];
            for (contact, loads) in [&mut soft, &mut pressed, &mut stiff, &mut lowered].into_iter().zip(&loads) {
                contact.step(dt, loads).unwrap_or_else(|error| panic!("{name} step {step}: {error}"));
            }
            for (one, other) in [(&soft, &pressed), (&stiff, &lowered)] {
                greatest = greatest.max(other.force());
                let forces = (one.force() - other.force()).abs() / greatest;
                let [here, there] = [one, other].map(|contact| at_pivot(&contact.body(0).unwrap(), tilts[0]));
                let approaches = (here - there).abs() / depth;
                // what tolerances leave accumulates in the history, and a stiff contact makes much of it
                let allowed = 30.0 * tolerance + 1e-6;
                assert!(forces < allowed && approaches < allowed, "{name} step {step}: {forces:e} {approaches:e}");
            }
        }
    }
}

/// What adaptive runs, states within a step and snapshots do with forces, they do with springs.
#[test]
fn springs_are_loads_like_others() {
    let build = || {
        contact_of(
            &Sphere::new(10.0e-3).unwrap(),
            Grid::square(24, 4.0e-3).unwrap(),
            Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 1.0).unwrap()),
            Settings::default(),
        )
    };
    let (mut contact, stiffness) = (build(), 3.0e4);
    let driven = Ramp::new(Load::spring(stiffness, -20.0e-6), Load::spring(stiffness, 60.0e-6), 1.0).unwrap();
    let mut run = contact.follow(&driven, Stepping::adaptive(1e-5), 3.0);
    let mut last = 0.0;
    while let Some(report) = run.next_step().unwrap() {
        last = report.dt;
    }
    let middle = run.contact().time() - 0.4 * last;
    let within = run.within_step(middle).unwrap();
    let mut fixed = build();
    let mut given = fixed.follow(&driven, Stepping::fixed(middle / 2000.0), middle);
    while given.next_step().unwrap().is_some() {}
    for (within, given) in [(within.force(), fixed.force()), (within.approach(), fixed.approach())] {
        assert!((within / given - 1.0).abs() < 1e-5, "{within} {given}");
    }
    // apart, the spring holds the body where its far end is
    let mut contact = build();
    let report = contact.step(0.5, driven.at(0.1)).unwrap();
    assert_eq!((report.force, report.approach), (0.0, -12.0e-6));
    let start = contact.snapshot();
    let first = contact.step(0.5, driven.at(1.0)).unwrap();
    contact.restore(&start).unwrap();
    assert_eq!(contact.step(0.5, driven.at(1.0)).unwrap(), first);
    for (stiffness, drive) in [(0.0, 1.0), (-1.0, 1.0), (f64::INFINITY, 1.0), (f64::NAN, 1.0), (1.0, f64::NAN)] {
        assert!(matches!(contact.step(0.1, Load::spring(stiffness, drive)), Err(Error::OutOfRange { .. })));
    }
}
