//! Does the work of a solve stay the same, whatever the mesh, the number of contacts and the load? Counts, up to `WORK_CELLS`
//! cells along a side (256; the limits hold up to 2048).

use crate::common::{
    E_STAR, StepLoadedSphere, builder_of, contact_of, elastic, from_environment, maxwell, sphere, zener,
};
use viscocontact::analytic::Hertz;
use viscocontact::prelude::*;

/// Meshes from `least` cells along a side to the most that are asked for, each twice as fine as the one before.
fn meshes(least: usize) -> impl Iterator<Item = usize> {
    let most = from_environment("WORK_CELLS", 256) as usize;
    std::iter::successors(Some(least), |n| Some(2 * n)).take_while(move |&n| n <= most)
}

/// Equivalents of a warm step: the mean of `steps` steps under a constant load.
fn warm(geometry: &dyn Geometry, length: f64, n: usize, material: Material, dt: f64, steps: usize, load: Load) -> f64 {
    let settings = Settings::default().with_window(false).with_symmetry(false).with_edge(Edge::Allow);
    let builder = builder_of(geometry, Grid::square(n, length).unwrap(), material);
    let mut contact = builder.settings(settings).build().unwrap();
    contact.step(0.0, load).unwrap();
    let works = (0..steps).map(|_| contact.step(dt, load).unwrap().convolution_equivalents());
    works.sum::<f64>() / steps as f64
}

/// The gap before contact does not matter: a sphere far above the body is as much work as one that just touches it.
#[test]
fn the_gap_before_contact_does_not_change_the_work() {
    let work = |height: f64| {
        let sphere = FnGeometry::new(move |x, y| height + (x * x + y * y) / 20.0e-3);
        warm(&sphere, 4.0e-3, 256, zener(), 0.1, 20, Load::force(0.3))
    };
    let (near, far) = (work(0.0), work(1.0e-3));
    println!("Zener, 20 steps, 256²: {near:.2} equivalents a step, {far:.2} from far above");
    assert!((far / near - 1.0).abs() <= 0.05, "{near} {far}");
}

#[test]
fn a_rough_surface_takes_as_much_work_on_every_mesh() {
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
                .kernel(InfluenceKernel::periodic(&grid).unwrap())
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

/// A thousand asperities against a sphere that touches as many cells.
#[test]
fn a_thousand_contacts_take_half_as_much_work_again_as_one() {
    for n in meshes(256) {
        let wave = |x: f64| (32.0 * std::f64::consts::TAU * x).cos();
        let bumps = FnGeometry::new(move |x, y| 1.0e-3 * (2.0 - wave(x) - wave(y) + 0.5 * (x + 0.3 * y)));
        let many = warm(&bumps, 1.0, n, maxwell(), 0.02, 20, Load::force(6.0e4));
        let one = warm(&Sphere::new(10.0).unwrap(), 1.0, n, maxwell(), 0.02, 20, Load::force(4.0e3));
        println!("{n}²: {many:.2} equivalents per step of 1024 contacts, {one:.2} of one");
        assert!(many <= 1.5 * one, "{many} {one}");
    }
}

/// From 128² to 1024² cells: of a cold start by a third at most, of a warm step less than twofold, where an edge that moved a
/// ninth of a cell a step moves a whole one.
#[test]
fn iterations_hardly_grow_with_the_mesh() {
    let iterations = |cells: usize| {
        let scene = StepLoadedSphere::maxwell();
        let mut contact = scene.contact(cells, Settings::default()).unwrap();
        contact.step(0.0, Load::force(scene.force)).unwrap();
        let reports = (0..14).map(|_| contact.step(0.02, Load::force(scene.force)).unwrap());
        let warm = reports.skip(4).map(|report| report.iterations).sum::<usize>() as f64 / 10.0;
        let cold = |shape: &dyn Geometry, side: f64, load: Load| {
            let settings = Settings::default().with_tolerance(1e-7);
            let mut contact = contact_of(shape, Grid::square(cells, side).unwrap(), elastic(), settings);
            contact.step(0.0, load).unwrap().iterations as f64
        };
        // off the centre of a cell, so that the guess is not the answer
        let ball = Shifted::new(sphere(), [0.11e-3, -0.07e-3]).unwrap();
        let side = 2.6 * Hertz::new(10.0e-3, E_STAR, 1.0).unwrap().contact_radius;
        let punch = FlatPunch::circular(1.0e-3).unwrap();
        let eccentric = Load::eccentric_force(1.0, [0.2e-3, 0.0]);
        [cold(&ball, side, Load::force(0.9)), cold(&punch, 2.1e-3, eccentric), warm]
    };
    let (coarse, fine) = (iterations(128), iterations(1024));
    println!("iterations of cold sphere, cold punch, warm sphere at 128² {coarse:?}, at 1024² {fine:?}");
    for ((coarse, fine), most) in coarse.into_iter().zip(fine).zip([1.3, 1.3, 2.0]) {
        assert!(fine <= most * coarse, "{coarse} → {fine}");
    }
}
