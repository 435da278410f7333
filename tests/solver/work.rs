//! Does the work of a solve stay the same, whatever the mesh, the number of contacts and the load? Counts, up to `WORK_CELLS`
//! cells along a side (256; the limits hold up to 2048).

use std::sync::Arc;

use crate::common::environment::from_environment;
use viscocontact::prelude::*;

/// Meshes from `least` cells along a side to the most that are asked for, each twice as fine as the one before.
fn meshes(least: usize) -> impl Iterator<Item = usize> {
    let most = from_environment("WORK_CELLS", 256) as usize;
    std::iter::successors(Some(least), |n| Some(2 * n)).take_while(move |&n| n <= most)
}

/// Equivalents of a warm step: the mean of `steps` steps under a constant load.
fn warm(geometry: &dyn Geometry, length: f64, n: usize, material: Material, dt: f64, steps: usize, load: Load) -> f64 {
    let settings = Settings::default().with_window(false).with_symmetry(false).with_edge(Edge::Allow);
    let builder = ViscoelasticContact::builder(Grid::square(n, length).unwrap()).geometry(geometry).material(material);
    let mut contact = builder.settings(settings).build().unwrap();
    contact.step(0.0, load).unwrap();
    let works = (0..steps).map(|_| contact.step(dt, load).unwrap().convolution_equivalents());
    works.sum::<f64>() / steps as f64
}

#[test]
fn a_creeping_sphere() {
    let sphere = Sphere::new(10.0e-3).unwrap();
    let maxwell = Material::incompressible(Maxwell::new(1.0e6, 1.0e6).unwrap());
    let zener = Material::incompressible(Zener::new(1.0e6, 1.0e6, 1.0e6).unwrap());
    for n in meshes(32) {
        let work = warm(&sphere, 4.0e-3, n, maxwell.clone(), 0.02, 100, Load::force(0.3));
        println!("Maxwell, 100 steps, {n}²: {work:.2} equivalents per step");
        assert!(work <= 4.2, "{work}");
    }
    for n in meshes(64) {
        let work = warm(&sphere, 4.0e-3, n, zener.clone(), 0.1, 20, Load::force(0.3));
        println!("Zener, 20 steps, {n}²: {work:.2} equivalents per step");
        assert!(work <= 5.0, "{work}");
    }
}

/// The gap before contact does not matter: a sphere far above the body is as much work as one that just touches it.
#[test]
fn a_sphere_from_far_above() {
    let zener = Material::incompressible(Zener::new(1.0e6, 1.0e6, 1.0e6).unwrap());
    let work = |height: f64| {
        let sphere = FnGeometry::new(move |x, y| height + (x * x + y * y) / 20.0e-3);
        warm(&sphere, 4.0e-3, 256, zener.clone(), 0.1, 20, Load::force(0.3))
    };
    let (near, far) = (work(0.0), work(1.0e-3));
    println!("Zener, 20 steps, 256²: {near:.2} equivalents a step, {far:.2} from far above");
    assert!((far / near - 1.0).abs() <= 0.05, "{near} {far}");
}

#[test]
fn a_rough_surface() {
    for n in meshes(128) {
        // the shortest wave in cells, the mean pressure, and how much is in contact
        for (shortest, mean) in [(8.0, 5.0e-3), (8.0, 3.0e-2), (8.0, 0.1), (8.0, 0.2), (32.0, 5.0e-3), (2.0, 1.0e-2)] {
            let grid = Grid::square(n, 1.0).unwrap();
            let (anisotropy, roughness) = (Anisotropy::default(), Roughness::RmsSlope(0.1));
            let shortest_wave = shortest / n as f64;
            let spec = RoughSpec::new(0.5, shortest_wave, roughness)
                .with_roll_off(0.25)
                .with_anisotropy(anisotropy)
                .with_seed(1);
            let mut contact = ViscoelasticContact::builder(grid.clone())
                .geometry(&Rough::new(&grid, spec).unwrap())
                .kernel(Arc::new(InfluenceKernel::periodic(&grid).unwrap()))
                .material(Material::incompressible(Elastic::new(0.375).unwrap()))
                .build()
                .unwrap();
            let report = contact.step(0.0, Load::force(mean)).unwrap();
            let share = 100.0 * report.contact_cells as f64 / grid.len() as f64;
            println!(
                "rough {n}², waves to {shortest} cells, {share:.0} % in contact: {} iterations",
                report.iterations
            );
            assert!(report.iterations <= 14 && report.fallback_iterations == 0, "{report}");
        }
    }
}

#[test]
fn an_eccentric_punch() {
    for n in meshes(128) {
        let iterations: Vec<usize> = (0..10)
            .map(|tenths| {
                let mut contact = ViscoelasticContact::builder(Grid::square(n, 2.4e-3).unwrap())
                    .geometry(&FlatPunch::circular(1.0e-3).unwrap())
                    .material(Material::incompressible(Elastic::new(1.0e6).unwrap()))
                    .build()
                    .unwrap();
                contact.step(0.0, Load::eccentric_force(1.0, [1.0e-4 * tenths as f64, 0.0])).unwrap().iterations
            })
            .collect();
        println!("punch {n}², e = 0 … 0.9 R: {iterations:?} iterations");
        assert!(iterations.iter().all(|&count| count <= 13), "{iterations:?}");
    }
}

/// A thousand asperities against a sphere that touches as many cells.
#[test]
fn many_contacts() {
    for n in meshes(256) {
        let wave = |x: f64| (32.0 * std::f64::consts::TAU * x).cos();
        let bumps = FnGeometry::new(move |x, y| 1.0e-3 * (2.0 - wave(x) - wave(y) + 0.5 * (x + 0.3 * y)));
        let maxwell = Material::incompressible(Maxwell::new(1.0e6, 1.0e6).unwrap());
        let many = warm(&bumps, 1.0, n, maxwell.clone(), 0.02, 20, Load::force(6.0e4));
        let one = warm(&Sphere::new(10.0).unwrap(), 1.0, n, maxwell, 0.02, 20, Load::force(4.0e3));
        println!("{n}²: {many:.2} equivalents per step of 1024 contacts, {one:.2} of one");
        assert!(many <= 1.5 * one, "{many} {one}");
    }
}
