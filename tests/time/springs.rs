//! Bodies that springs drive, against bodies whose approach or force is given.

use crate::common::{Draws, from_environment};
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
    let rule = if draws.chance(0.5) { TimeRule::Exponential } else { TimeRule::ExponentialLinear };
    let tolerance = draws.power_of_ten(-10.0, -5.0);
    let terms: Vec<(f64, f64)> = (0..3).map(|_| (draws.between(0.05, 0.5), draws.power_of_ten(-1.0, 1.0))).collect();
    let body = GeneralizedMaxwell::new(draws.between(0.1, 0.5), &terms).unwrap();
    let material = Material::constant_poisson(body, if kind == 5 { 0.4 } else { 0.5 }).unwrap();
    let settings = Settings::default().with_edge(Edge::Allow).with_tolerance(tolerance);
    let settings = settings.with_time_rule(rule).with_window(draws.chance(0.5));
    let contact = builder.material(material).kernel(kernel.unwrap()).settings(settings).build().unwrap();
    Scene { name: format!("{name} {number}, {rule:?}"), contact, tilts, depth, tolerance }
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
        let softest = draws.power_of_ten(-9.0, 8.0);
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
            let bodies: Vec<_> = (0..loads.len()).map(|body| contact.fields().body(body).unwrap()).collect();
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
            let most = given.fields().max_pressure().max(contact.fields().max_pressure());
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
