//! Limit states: loads on the rim of the hull, pivots that a touch balances, loads and steps at the ends of the numbers.
//! `LIMIT_SCENES` (120) scenes of each kind.

use crate::common::{Draws, builder_of, contact_of, from_environment};
use viscocontact::prelude::*;

fn bodies(draws: &mut Draws) -> Material {
    match draws.below(2) {
        0 => Material::incompressible(Elastic::new(1.0e6).unwrap()),
        _ => Material::incompressible(Zener::with_time(1.0e6, 1.0e5, 1.0).unwrap()),
    }
}

fn scenes() -> u64 {
    from_environment("LIMIT_SCENES", 120)
}

fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The corners of the convex hull, in order.
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while chain.len() > 1 && cross(chain[chain.len() - 2], chain[chain.len() - 1], point) <= 1e-16 {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut corners = half(&mut points.iter().copied());
    corners.extend(half(&mut points.iter().rev().copied()));
    corners
}

/// On an edge of the hull the cells of that edge carry the load, on a corner one cell: forces and moments balance, no cell
/// penetrates, and where there is pressure there is no gap. Beyond the rim the load is refused.
#[test]
fn loads_on_the_rim_of_the_hull_are_carried() {
    let (mut on_rim, mut solved) = (0, 0);
    for seed in 0..scenes() {
        let mut draws = Draws::new(seed + 1);
        let grid =
            Grid::new([6 + draws.below(14), 5 + draws.below(12)], [4.0e-3, 4.0e-3 * draws.between(0.5, 2.0)]).unwrap();
        let n2 = grid.cells()[1];
        let center = |k: usize| grid.center(k / n2, k % n2);
        let half = [draws.between(0.4e-3, 1.4e-3), draws.between(0.4e-3, 1.4e-3)];
        let shape = draws.below(4);
        let face = move |x: f64, y: f64| match shape {
            0 => x.abs() <= half[0] && y.abs() <= half[1],
            1 => x.hypot(y) <= half[0].max(6.0e-4),
            2 => x.abs() / half[0] + y.abs() / half[1] <= 1.0 || x.abs().max(y.abs()) < 5.0e-4,
            _ => true,
        };
        let slope = [draws.between(-1.0e-3, 1.0e-3), draws.between(-1.0e-3, 1.0e-3)];
        let curvature = if shape == 3 { draws.between(0.0, 50.0) } else { 0.0 };
        let gap = move |x: f64, y: f64| match face(x, y) {
            true => 0.5 * curvature * (x * x + y * y) + slope[0] * x + slope[1] * y,
            false => f64::INFINITY,
        };
        let corners = hull((0..grid.len()).map(center).filter(|[x, y]| face(*x, *y)).collect());
        if corners.len() < 3 {
            continue;
        }
        let edge = draws.below(corners.len());
        let (from, to) = (corners[edge], corners[(edge + 1) % corners.len()]);
        let share = [0.0, 0.5, draws.between(0.0, 1.0)][draws.below(3)];
        let inwards = [0.0, 0.0, 1e-13, draws.power_of_ten(-12.0, -3.0)][draws.below(4)];
        let middle = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / corners.len() as f64);
        let at = [0, 1].map(|axis| {
            let rim = from[axis] + share * (to[axis] - from[axis]);
            rim + inwards * (middle[axis] - rim)
        });
        on_rim += usize::from(inwards == 0.0);
        let mut contact = builder_of(&FnGeometry::new(gap), grid.clone(), bodies(&mut draws))
            .settings(Settings::default().with_edge(Edge::Allow))
            .build()
            .unwrap();
        let force = draws.power_of_ten(-4.0, 0.0);
        for dt in [0.0, 0.1] {
            let what = format!("seed {seed}, shape {shape}, {inwards:e} inwards, {share} along");
            let report =
                contact.step(dt, Load::eccentric_force(force, at)).unwrap_or_else(|error| panic!("{what}: {error}"));
            solved += 1;
            let [mut carried, mut moment] = [0.0, 0.0];
            let (mut apart, mut deepest) = (0.0_f64, 0.0_f64);
            for k in 0..grid.len() {
                let ([x, y], p) = (center(k), contact.pressure()[k]);
                carried += p * grid.cell_area();
                moment += p * grid.cell_area() * ((x - at[0]) + (y - at[1]));
                deepest = deepest.max(contact.fields().displacement()[k]);
                if face(x, y) {
                    let height = gap(x, y) + contact.fields().displacement()[k]
                        - (contact.approach() + contact.tilt()[0] * x + contact.tilt()[1] * y);
                    apart = apart.max(if p > 0.0 { height.abs() } else { -height });
                }
            }
            assert!((carried / force - 1.0).abs() < 1e-11 && moment.abs() < 1e-10 * force * 4.0e-3, "{what}");
            assert!(apart < 2e-5 * deepest, "{what}: {apart:e} of {deepest:e}; {report}");
        }
        let beyond =
            [0, 1].map(|axis| at[axis] + 1e-6 * (at[axis] - middle[axis]) - inwards * (middle[axis] - at[axis]));
        if inwards < 1e-9 {
            let refused = contact.step(0.1, Load::eccentric_force(force, beyond));
            assert!(matches!(refused, Err(Error::Step(StepError::LoadOutsideHull { .. }))), "seed {seed}");
        }
    }
    println!("{solved} steps, {on_rim} scenes exactly on the rim");
    assert!(on_rim as u64 > scenes() / 4);
}

/// A body held at a pivot where it touches, or turns away, is pressed by nothing or by more than rounding.
#[test]
fn bodies_that_just_touch_at_a_pivot_carry_no_load() {
    let (mut touching, mut pressed) = (0, 0);
    for seed in 0..scenes() {
        let mut draws = Draws::new(seed + 1);
        let grid = Grid::square(12 + draws.below(20), 4.0e-3).unwrap();
        let shape: Box<dyn Geometry> = match draws.below(3) {
            0 => Box::new(Sphere::new(0.01).unwrap()),
            1 => Box::new(Cone::new(0.05).unwrap()),
            _ => Box::new(FlatPunch::circular(1.2e-3).unwrap()),
        };
        let at = [draws.between(-8.0e-4, 8.0e-4), draws.between(-8.0e-4, 8.0e-4)];
        let free = draws.below(3);
        let tilt =
            [0, 1].map(|axis| if free == axis || free == 2 { Tilt::Free { at: at[axis] } } else { Tilt::Fixed(0.0) });
        let settings = Settings::default().with_edge(Edge::Allow);
        let builder = builder_of(&shape, grid, bodies(&mut draws)).settings(settings);
        let mut contact = builder.build().unwrap();
        for dt in [0.0, 0.1, 0.1] {
            let below = 0.5 * (at[0] * at[0] + at[1] * at[1]) / 0.01;
            let approach =
                [0.0, draws.between(-1.0e-5, 3.0e-5), draws.power_of_ten(-12.0, -5.0), below * draws.between(0.9, 1.1)]
                    [draws.below(4)];
            contact.step(dt, Load::Approach { approach, tilt }).unwrap();
            let greatest = contact.fields().max_pressure();
            assert!(greatest == 0.0 || greatest > 1e-6, "seed {seed}, approach {approach:e}: {greatest:e}");
            touching += usize::from(greatest == 0.0);
            pressed += usize::from(greatest > 0.0);
        }
    }
    println!("{touching} touching, {pressed} pressed");
    assert!(touching > 20 && pressed > 20);
}

/// The least forces, approaches and moduli end in an answer or in an error, after few steps.
#[test]
fn runs_under_the_least_loads_end() {
    let (mut answers, mut refused) = (0, 0);
    for modulus in [1.0e-95, 1.0e6, 1.0e95] {
        let material = Material::incompressible(Zener::new(modulus, modulus, modulus).unwrap());
        let shapes: [Box<dyn Geometry>; 3] = [
            Box::new(Sphere::new(0.01).unwrap()),
            Box::new(Cone::new(0.05).unwrap()),
            Box::new(FlatPunch::circular(1.0e-3).unwrap()),
        ];
        for shape in &shapes {
            for size in [5e-324, 1e-310, 1e-300, 1e-200, 1e-100, 1e-30] {
                for load in [Load::force(size), Load::approach(size), Load::eccentric_force(size, [1.0e-4, 0.0])] {
                    let what = format!("{modulus:e} Pa, {load:?}");
                    let build = || {
                        builder_of(shape, Grid::square(12, 4.0e-3).unwrap(), material.clone())
                            .settings(Settings::default().with_edge(Edge::Allow))
                            .build()
                            .unwrap()
                    };
                    let mut contact = build();
                    contact.step(0.0, load).and_then(|_| contact.step(0.5, load)).unwrap();
                    let history = StepLoad::new(load).unwrap();
                    let mut contact = build();
                    let mut run = contact.follow(&history, Stepping::adaptive(1e-3), 1.0);
                    let mut steps = 0;
                    let ended = loop {
                        match run.next_step() {
                            Ok(Some(_)) => steps += 1,
                            ended => break ended,
                        }
                        assert!(steps < 1000, "{what}");
                    };
                    match ended {
                        Ok(_) => answers += 1,
                        Err(Error::OutOfRange {
                            field: "maximum force of the run" | "maximum depth of the run",
                            ..
                        }) => {
                            assert!(size < 1e-290, "{what}");
                            refused += 1;
                        }
                        Err(error) => panic!("{what}: {error}"),
                    }
                    if load.tilt()[0] == Tilt::Fixed(0.0) {
                        let scene = |grid, settings| Ok(builder_of(shape, grid, material.clone()).settings(settings));
                        let study = Study::new(scene, &history, 1.0).accuracy(1e-2).work(1e5);
                        let _ = study.run();
                    }
                }
            }
        }
    }
    println!("{answers} answers, {refused} refused");
    assert!(answers > 80 && refused > 50);
}

/// Steps whose lengths differ by more than squares of numbers follow each other.
#[test]
fn steps_of_any_ratio_follow_each_other() {
    for frame in [Frame::Indenter, Frame::Bodies] {
        for lengths in [[1e-300, 1e9], [1e9, 1e-300], [1e-300, 1e300], [1e-200, 1e9], [1e-150, 1e9], [1e-9, 1e9]] {
            let mut contact = contact_of(
                &Sphere::new(1.0e-2).unwrap(),
                Grid::new([24, 16], [24.0e-5, 16.0e-5]).unwrap(),
                Material::incompressible(GeneralizedMaxwell::new(1.0e6, &[(6.5e6, 0.7)]).unwrap()),
                Settings::default().with_frame(frame),
            );
            let load = Load::force(1.0e-5);
            contact.step(0.0, load).unwrap();
            for dt in [lengths[0], lengths[1], lengths[1]] {
                let stepped = match frame {
                    Frame::Indenter => contact.step_over([-1, 0], dt, load),
                    _ => contact.step(dt, load),
                };
                stepped.unwrap_or_else(|error| panic!("{frame:?}, {lengths:?}: {error}"));
            }
        }
    }
}
