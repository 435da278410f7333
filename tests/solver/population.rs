//! The work of warm steps over a population of scenes drawn at random, on meshes finer than a dense reference could follow: no
//! step may stall. `POPULATION_SCENES` (14) and `POPULATION_SEED` (1) choose others.

use super::differential::scenes::{self, SIDE};
use crate::common::{Draws, Ratios, builder_of, from_environment};
use viscocontact::prelude::*;

/// Bumps that may repeat, or any other shape.
fn shape(draws: &mut Draws) -> (&'static str, Box<dyn Geometry>) {
    if draws.chance(0.8) {
        return scenes::shape(draws);
    }
    let (count, height) = (2.0 + draws.below(12) as f64, SIDE * draws.power_of_ten(-4.0, -2.5));
    let wave = move |x: f64| 1.0 - (count * std::f64::consts::TAU * x / SIDE).cos();
    ("bumps", Box::new(FnGeometry::new(move |x, y| height * (wave(x) + wave(y) + (0.3 * x + 0.1 * y) / SIDE))))
}

/// Warm steps of the scene of a seed, under a load that is held, grows, falls or moves.
fn run(seed: u64, costs: &mut Ratios) {
    let mut draws = Draws::new(seed);
    let cells = 48 + 2 * draws.below(60);
    let grid = Grid::square(cells, SIDE).unwrap();
    let part = draws.between(0.2, 0.85);
    let (shape, geometry) = shape(&mut draws);
    let periodic = matches!(shape, "bumps") && draws.chance(0.5);
    let symmetry = draws.chance(0.3);
    let settings = Settings::default().with_symmetry(symmetry).with_window(draws.chance(0.3)).with_edge(Edge::Allow);
    let material = scenes::Body::random(&mut draws).material();
    let build = |material: Material| {
        let mut builder = builder_of(&geometry, grid.clone(), material);
        if periodic {
            builder = builder.kernel(InfluenceKernel::periodic(&grid).unwrap());
        }
        builder.settings(settings).build().unwrap()
    };
    // the force with which an elastic body would touch over this part of the square, by bisection
    let (mut low, mut high) = (1e-2_f64, 1e8_f64);
    for _ in 0..12 {
        let force = (low * high).sqrt();
        let mut elastic = build(Material::incompressible(Elastic::new(1.0e6).unwrap()));
        elastic.step(0.0, Load::force(force)).unwrap();
        let cells = elastic.contact_cells() as f64;
        let wide = cells * elastic.grid().cell_area() > part * part * 0.8 * SIDE * SIDE;
        if wide { high = force } else { low = force }
    }
    let force = low;
    let tilting = !periodic && draws.chance(0.3);
    let (way, dt) = (draws.below(5), draws.power_of_ten(-3.0, -0.3));
    let reach = if tilting { 0.1 * part * SIDE } else { 0.0 };
    let mut contact = build(material);
    for step in 0..12 {
        let t = f64::from(step) / 12.0;
        let factor = [1.0, 0.3 + t, 1.2 - t, 1.0 + 0.3 * (7.0 * t).sin(), 1.0][way];
        let point = if way == 4 { [reach * t, -0.5 * reach * t] } else { [reach, 0.0] };
        let load = if tilting { Load::eccentric_force(factor * force, point) } else { Load::force(factor * force) };
        let name = || {
            format!(
                "seed {seed} step {step}: {shape} {cells}², way {way}, dt {dt:.1e}, tilting {tilting}, periodic {periodic}, symmetry {symmetry}"
            )
        };
        match contact.step(dt, load) {
            Ok(report) if step > 0 => costs.push(report.convolution_equivalents(), &name()),
            Ok(_) => {}
            Err(error) => panic!("{}: {error}", name()),
        }
    }
}

#[test]
fn warm_steps_do_not_stall() {
    let (scenes, first) = (from_environment("POPULATION_SCENES", 14), from_environment("POPULATION_SEED", 1));
    let mut costs = Ratios::default();
    (0..scenes).for_each(|k| run(first * 1_000_000 + k, &mut costs));
    println!("{} warm steps: {:.2} equivalents", costs.count(), costs.mean());
    costs.print("equivalents", 5);
    assert!(costs.mean() <= 10.0 && costs.quantile(1.0) <= 60.0, "{} {}", costs.mean(), costs.quantile(1.0));
}
