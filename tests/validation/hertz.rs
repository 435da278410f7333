//! Elastic contacts against their closed forms, and how fast the mesh converges to them.

use crate::common::{E_STAR, contact_of, elastic};
use approx::assert_abs_diff_eq;
use viscocontact::analytic::Hertz;
use viscocontact::prelude::*;

fn press(grid: Grid, shape: &dyn Geometry, force: f64, settings: Settings) -> ViscoelasticContact {
    let mut contact = contact_of(shape, grid, elastic(), settings);
    contact.step(0.0, Load::force(force)).unwrap();
    contact
}

/// Relative errors of central pressure and approach of a sphere on a grid 2.6 contact radii wide.
fn sphere_errors(cells: usize) -> [f64; 2] {
    let exact = Hertz::new(10.0e-3, E_STAR, 1.0).unwrap();
    let grid = Grid::square(cells, 2.6 * exact.contact_radius).unwrap();
    let contact = press(grid, &Sphere::new(10.0e-3).unwrap(), 1.0, Settings::default().with_tolerance(1e-8));
    assert_abs_diff_eq!(contact.force(), 1.0, epsilon = 1e-12);
    let [x1, x2] = contact.grid().center(cells / 2, cells / 2);
    let center = contact.pressure()[cells / 2 * cells + cells / 2];
    [center / exact.pressure(x1.hypot(x2)) - 1.0, contact.approach() / exact.approach - 1.0]
}

#[test]
fn a_sphere_on_512_cells_is_hertzs() {
    let [pressure, approach] = sphere_errors(512);
    println!("central pressure {pressure:e}, approach {approach:e}");
    assert_abs_diff_eq!(pressure, 0.0, epsilon = 2e-5);
    assert_abs_diff_eq!(approach, 0.0, epsilon = 1e-5);
}

#[test]
fn approach_converges_with_the_mesh_at_second_order_on_average() {
    let errors = [16, 32, 64, 128, 256].map(|cells| sphere_errors(cells)[1].abs());
    println!("{errors:?}");
    let order = (errors[0] / errors[4]).log2() / 4.0;
    assert!(order > 1.7, "order {order}: {errors:?}");
}

#[test]
fn a_cone_is_loves() {
    let (slope, force) = (0.1, 1.0);
    let body = elastic();
    let mut exact = StatesContact::new(&ElasticStates::cone(slope).unwrap(), &body).unwrap();
    exact.step(0.0, Load::force(force)).unwrap();
    let a = (exact.contact_area() / std::f64::consts::PI).sqrt();
    // Love 1939: W = (π/2) a² E* tan β
    assert_abs_diff_eq!(force / (0.5 * std::f64::consts::PI * a * a * E_STAR * slope), 1.0, epsilon = 1e-12);
    let contact = press(Grid::square(256, 2.4 * a).unwrap(), &Cone::new(slope).unwrap(), force, Settings::default());
    assert_abs_diff_eq!(contact.approach() / exact.approach(), 1.0, epsilon = 2e-3);
    assert_abs_diff_eq!((contact.contact_area() / std::f64::consts::PI).sqrt() / a, 1.0, epsilon = 5e-3);
}
