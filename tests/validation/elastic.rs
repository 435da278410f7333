//! Elastic contacts of every closed shape, against its closed form.

use std::f64::consts::PI;

use viscocontact::analytic::{Hertz, HertzEllipse};
use viscocontact::prelude::*;

const MODULUS: f64 = 2.0e6;

/// Approach and contact area of a shape under a force on a square of a side.
fn pressed(shape: &dyn Geometry, force: f64, side: f64, cells: usize) -> [f64; 2] {
    let builder = ElasticContact::builder(Grid::square(cells, side).unwrap()).geometry(shape).modulus(MODULUS);
    let mut contact = builder.build().unwrap();
    let report = contact.solve(Load::force(force)).unwrap();
    assert!((report.force / force - 1.0).abs() < 1e-12);
    [report.approach, contact.fields().contact_area()]
}

/// Sphere (Hertz), cone (Love 1939), flat punch (Boussinesq), ellipsoid (Hertz) and, on a line, a cylinder: approach and area to the error
/// of the mesh, which falls with it.
#[test]
fn elastic_contacts_of_closed_shapes_are_their_closed_forms() {
    let force = 0.5_f64;
    let radius = 10.0e-3_f64;
    let a = (0.75 * force * radius / MODULUS).cbrt();
    let slope = 0.1;
    let cone = (2.0 * force / (PI * MODULUS * slope)).sqrt();
    let punch = 0.5e-3;
    let ellipse = HertzEllipse::new([radius, 2.0 * radius], MODULUS, force).unwrap();
    let [a1, a2] = ellipse.semi_axes;
    type Scene = (&'static str, Box<dyn Geometry>, f64, [f64; 2], [f64; 2]);
    #[rustfmt::skip]
    let scenes: [Scene; 4] = [
        ("sphere", Box::new(Sphere::new(radius).unwrap()), 2.6 * a, [a * a / radius, PI * a * a], [2e-5, 1e-4]),
        ("cone", Box::new(Cone::new(slope).unwrap()), 2.6 * cone, [0.5 * PI * cone * slope, PI * cone * cone], [2e-3, 2e-3]),
        ("punch", Box::new(FlatPunch::circular(punch).unwrap()), 2.6 * punch, [0.5 * force / (MODULUS * punch), PI * punch * punch], [2e-3, 2e-4]),
        ("ellipsoid", Box::new(Ellipsoid::new(radius, 2.0 * radius).unwrap()), 2.6 * a1.max(a2), [ellipse.approach, PI * a1 * a2], [3e-5, 1e-4]),
    ];
    for (name, shape, side, exact, allowed) in scenes {
        let [coarse, fine] = [64, 256].map(|cells| {
            let found = pressed(&*shape, force, side, cells);
            [0, 1].map(|k| (found[k] / exact[k] - 1.0).abs())
        });
        println!("{name}: approach and area off by {coarse:?} on 64², {fine:?} on 256²");
        assert!((0..2).all(|k| fine[k] < allowed[k]), "{name}: {fine:?}");
        assert!(fine[0] < 0.5 * coarse[0], "{name}: {coarse:?} {fine:?}");
    }
    // b² = 4 W R/(π E*) a length, of a line
    let grid = Grid::new([512, 1], [4.0e-3, 1.0]).unwrap();
    let builder = ElasticContact::builder(grid.clone()).geometry(&Cylinder::new(radius).unwrap()).modulus(MODULUS);
    let mut contact = builder.kernel(InfluenceKernel::line(&grid, 1.0).unwrap()).build().unwrap();
    contact.solve(Load::force(200.0)).unwrap();
    let half = (4.0 * 200.0 * radius / (PI * MODULUS)).sqrt();
    let width = contact.fields().contact_area();
    assert!((0.5 * width / half - 1.0).abs() < 1e-3, "{width:e} {half:e}");
    let peak = 2.0 * 200.0 / (PI * half);
    assert!((contact.fields().max_pressure() / peak - 1.0).abs() < 1e-3, "{peak:e}");
}

/// A sphere on a grid 2.6 contact radii wide.
#[test]
fn approach_converges_with_the_mesh_at_second_order_on_average() {
    let sphere = Sphere::new(10.0e-3).unwrap();
    let exact = Hertz::new(10.0e-3, MODULUS, 1.0).unwrap();
    let error = |cells: usize| pressed(&sphere, 1.0, 2.6 * exact.contact_radius, cells)[0] / exact.approach - 1.0;
    let errors = [16, 32, 64, 128, 256].map(|cells| error(cells).abs());
    println!("{errors:?}");
    let order = (errors[0] / errors[4]).log2() / 4.0;
    assert!(order > 1.7, "order {order}: {errors:?}");
}
