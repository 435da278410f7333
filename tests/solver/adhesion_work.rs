//! What does a step of surfaces that attract each other cost? A ball, smooth or wavy, that approaches and is retracted in 61 steps, at Tabor's
//! numbers 1 and 2. `ADHESION_CELLS` (128) chooses the mesh, `ADHESION_SIDE` (100, tenths of the radius) the grid. And a periodic rough surface in and
//! out of full contact, of `ADHESION_ROWS` (32) cells a side.

use std::sync::Arc;

use super::adhesion_population::rough;
use crate::common::sticky::{ball, elastic};
use crate::common::{Draws, from_environment};
use viscocontact::adhesion::{Attraction, Dugdale, ExponentialAttraction, VanDerWaals};
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

/// Convolution equivalents of each step, sorted.
fn work(cells: usize, side: f64, tabor: f64, waves: f64, material: Material) -> Vec<f64> {
    let shape = Sum::new(Sphere::new(1.0).unwrap(), Wavy::new(waves, 2.0).unwrap());
    let law = ExponentialAttraction::new(1.0, 1.0 / tabor).unwrap();
    let settings = Settings::default().with_edge(Edge::Allow).with_symmetry(false);
    let mut contact = ball(cells, side, material, law).geometry(&shape).settings(settings).build().unwrap();
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
    let creeping = || Material::incompressible(GeneralizedMaxwell::new(0.025, &[(0.225, 1.0)]).unwrap());
    for (tabor, most) in [(1.0, 12.0), (2.0, 20.0)] {
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
    let amplitude = height * side / 4.0;
    let shape = rough(&mut Draws::new(7), side, 5, [0.4 * amplitude, 2.0 * amplitude]);
    let kernel = InfluenceKernel::periodic(&Grid::square(cells, side).unwrap()).unwrap();
    let mut contact = ball(cells, side, elastic(), law).geometry(&shape).kernel(kernel).build().unwrap();
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
