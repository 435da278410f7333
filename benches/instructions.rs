//! Small scenes whose instructions are counted: `benches/instructions` runs this under callgrind and compares the
//! counts with those in `benches/instructions.csv`. Called with the number of a scene.

use viscocontact::prelude::*;

fn main() {
    let scene = std::env::args().find_map(|argument| argument.parse::<usize>().ok());
    let Some(scene) = scene else { return };
    let (mut contact, load, dt, steps) = match scene {
        0 => held_sphere(),
        1 => eccentric_punch(),
        2 => wavy_surface(),
        3 => relaxation_times(1),
        _ => relaxation_times(30),
    };
    contact.step(0.0, load(0)).unwrap();
    println!("{} convolution equivalents", measured(&mut contact, load, dt, steps));
}

/// Only what happens in here is counted.
#[inline(never)]
fn measured(contact: &mut ViscoelasticContact, load: fn(usize) -> Load, dt: f64, steps: usize) -> f64 {
    (1..=steps).map(|step| contact.step(dt, load(step)).unwrap().convolution_equivalents()).sum()
}

/// A contact, the load of each step, the length of a step, and how many there are.
type Scene = (ViscoelasticContact, fn(usize) -> Load, f64, usize);

/// The paper's scene, as it is computed by default.
fn held_sphere() -> Scene {
    let contact = ViscoelasticContact::builder(Grid::square(64, 2.0e-3).unwrap())
        .geometry(&Sphere::new(10.0e-3).unwrap())
        .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0).unwrap()))
        .settings(Settings::default().with_window(false));
    (contact.build().unwrap(), |_| Load::force(0.3), 0.02, 20)
}

/// The load wanders, and the punch tilts.
fn eccentric_punch() -> Scene {
    let contact = ViscoelasticContact::builder(Grid::new([48, 60], [1.0e-3, 1.0e-3]).unwrap())
        .geometry(&FlatPunch::circular(0.4e-3).unwrap())
        .material(Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap()));
    let load = |step: usize| Load::eccentric_force(1.0, [0.1e-3 + 0.01e-3 * step as f64, 0.05e-3]);
    (contact.build().unwrap(), load, 0.1, 10)
}

/// No symmetry, ten relaxation times.
fn wavy_surface() -> Scene {
    let wave = |x: f64, y: f64| 50.0 * (x * x + y * y) + 1.0e-6 * (2.0e4 * x + 1.0).sin() * (1.5e4 * y + 2.0).cos();
    let terms: Vec<_> = (0..10).map(|k| (1.0e5, 10f64.powi(k - 5))).collect();
    let contact = ViscoelasticContact::builder(Grid::square(64, 2.0e-3).unwrap())
        .geometry(&FnGeometry::new(wave))
        .material(Material::incompressible(GeneralizedMaxwell::new(1.0e5, &terms).unwrap()))
        .settings(Settings::default().with_window(false));
    (contact.build().unwrap(), |_| Load::force(0.05), 0.05, 10)
}

/// Bodies that creep the same, with few or many relaxation times: the contact problems are the same.
fn relaxation_times(count: usize) -> Scene {
    let terms: Vec<_> = (0..count).map(|k| (1.0e-6 / count as f64, 1.0 + 1e-4 * k as f64)).collect();
    let contact = ViscoelasticContact::builder(Grid::square(64, 2.0e-3).unwrap())
        .geometry(&Sphere::new(10.0e-3).unwrap())
        .material(Material::incompressible(GeneralizedKelvin::new(0.5e-6, 0.0, &terms).unwrap()))
        .settings(Settings::default().with_window(false));
    (contact.build().unwrap(), |_| Load::force(0.1), 0.02, 20)
}
