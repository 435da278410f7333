//! What does a step of surfaces that attract each other cost? A ball, smooth or wavy, that approaches and is retracted in 61 steps, at Tabor's
//! numbers 1, 2 and 3. `ADHESION_CELLS` (128) chooses the mesh, `ADHESION_SIDE` (100, tenths of the radius) the grid. And a periodic rough surface in and
//! out of full contact, of `ADHESION_ROWS` (32) cells a side.

use std::sync::Arc;

use crate::common::environment::from_environment;
use viscocontact::adhesion::{Attraction, Dugdale, ExponentialAttraction, VanDerWaals};
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

/// Convolution equivalents of each step, sorted.
fn work(cells: usize, side: f64, tabor: f64, waves: f64, material: Material) -> Vec<f64> {
    let shape = Sum::new(Sphere::new(1.0).unwrap(), Wavy::new(waves, 2.0).unwrap());
    let mut contact = ViscoelasticContact::builder(Grid::square(cells, side).unwrap())
        .geometry(&shape)
        .material(material)
        .attraction(ExponentialAttraction::new(1.0, 1.0 / tabor).unwrap())
        .settings(Settings::default().with_edge(Edge::Allow).with_symmetry(false))
        .build()
        .unwrap();
    let approach = (0..=12).map(|k| -1.0 + 0.25 * f64::from(k));
    let retraction = (1..=48).map(|k| 2.0 - 0.125 * f64::from(k));
    let step = |approach| contact.step(0.2, Load::approach(approach)).unwrap().convolution_equivalents();
    let mut work: Vec<f64> = approach.chain(retraction).map(step).collect();
    work.sort_by(f64::total_cmp);
    work
}

#[test]
fn a_step_takes_few_convolutions() {
    let (cells, side) =
        (from_environment("ADHESION_CELLS", 128) as usize, from_environment("ADHESION_SIDE", 100) as f64 / 10.0);
    let elastic = || Material::incompressible(Elastic::new(0.25).unwrap());
    let creeping = || Material::incompressible(GeneralizedMaxwell::new(0.025, &[(0.225, 1.0)]).unwrap());
    for (tabor, most) in [(1.0, 12.0), (2.0, 20.0), (3.0, 30.0)] {
        // the zone must be resolved
        if side / cells as f64 * tabor * tabor > 0.5 {
            continue;
        }
        for (name, waves, material) in
            [("smooth", 1e-9, elastic()), ("wavy", 0.1, elastic()), ("smooth, creeping", 1e-9, creeping())]
        {
            let work = work(cells, side, tabor, waves, material);
            let [median, nine_tenths] = [0.5, 0.9].map(|part| work[(part * work.len() as f64) as usize]);
            println!("μ = {tabor}, {name}: median {median}, 90 % {nine_tenths}, all {}", work.iter().sum::<f64>());
            assert!(side < 10.0 || median <= most, "μ = {tabor}, {name}: {median}");
        }
    }
}

/// Convolutions of each of 24 steps, sorted, but for those beyond full contact; a transform of periodic bodies has no padding, whatever it is for.
fn of_rough(cells: usize, tabor: f64, height: f64, law: Arc<dyn Attraction>) -> Vec<usize> {
    let side = (0.12 * cells as f64 / tabor.max(1.0).powi(2)).min(8.0);
    let grid = Grid::square(cells, side).unwrap();
    let mut state = 7_u64.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0xd1b5_4a32_d192_ed03;
    let mut next = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    };
    for _ in 0..4 {
        next();
    }
    let amplitude = height * side / 4.0;
    let mut waves = Vec::new();
    for _ in 0..12 {
        let [a, b] = [0, 1].map(|_| (next() % 11) as f64 - 5.0);
        let mut unit = || (next() >> 11) as f64 / (1_u64 << 53) as f64;
        waves.push([a, b, amplitude * (0.2 + 0.8 * unit()), 6.3 * unit()]);
    }
    let turn = std::f64::consts::TAU / side;
    let shape = FnGeometry::new(move |x: f64, y: f64| {
        waves.iter().map(|[a, b, height, phase]| height * (turn * (a * x + b * y) + phase).cos()).sum::<f64>()
    });
    let mut contact = ViscoelasticContact::builder(grid.clone())
        .geometry(&shape)
        .kernel(InfluenceKernel::periodic(&grid).unwrap())
        .material(Material::incompressible(Elastic::new(0.25).unwrap()))
        .attraction(law)
        .settings(Settings::default().with_edge(Edge::Allow))
        .build()
        .unwrap();
    let touch = contact.approach();
    let mut work = Vec::new();
    for k in 0..24 {
        let way = if k < 10 { -0.3 + 0.08 * f64::from(k) } else { 0.5 - 0.1 * f64::from(k - 9) };
        let step = contact.step(1.0, Load::approach(touch + 10.0 * amplitude * way));
        work.extend(step.map(|report| report.convolutions + report.preconditioner_applications));
    }
    work.sort_unstable();
    work
}

#[test]
fn periodic_steps_take_few_convolutions() {
    let cells = from_environment("ADHESION_ROWS", 32) as usize;
    let (mut all, mut greatest) = (0, 0);
    for law in ["exponential", "van der Waals", "Dugdale"] {
        for (tabor, height) in [(1.0, 0.15), (1.0, 0.02), (2.0, 0.15), (2.0, 0.02)] {
            let range = 1.0 / tabor;
            let attraction: Arc<dyn Attraction> = match law {
                "exponential" => Arc::new(ExponentialAttraction::new(1.0, range).unwrap()),
                "van der Waals" => Arc::new(VanDerWaals::new(1.0, range).unwrap()),
                _ => Arc::new(Dugdale::new(1.0, range).unwrap().with_width(0.5).unwrap()),
            };
            let work = of_rough(cells, tabor, height, attraction);
            let (sum, most) = (work.iter().sum::<usize>(), work[work.len() - 1]);
            let [median, nine_tenths] = [5, 9].map(|tenths| work[tenths * work.len() / 10]);
            println!("{cells}², μ = {tabor}, heights {height}, {law}: {median}/{nine_tenths}/{most}, sum {sum}");
            all += sum;
            greatest = greatest.max(most);
        }
    }
    println!("{cells}²: {all} convolutions");
    assert!(greatest <= 600);
}
