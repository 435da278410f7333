//! What does a step of surfaces that attract each other cost? A ball, smooth or wavy, that approaches and is retracted in 61 steps, at Tabor's
//! numbers 1, 2 and 3. `ADHESION_CELLS` (128) chooses the mesh, `ADHESION_SIDE` (100, tenths of the radius) the grid.

use crate::common::environment::from_environment;
use viscocontact::adhesion::ExponentialAttraction;
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
