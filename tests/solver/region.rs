//! What is computed is a matter of speed alone: on the cells that contact can reach, or on a quarter of them, the answer is the
//! same. Random scenes are in `properties::metamorphic`.

use crate::common::fields::gap;
use crate::common::{RADIUS, builder_of, elastic, maxwell};
use viscocontact::prelude::*;

/// The same scene with and without what spares cells.
fn pair(cells: [usize; 2], side: f64, geometry: &dyn Geometry, material: &Material) -> [ViscoelasticContact; 2] {
    [true, false].map(|sparing| {
        let [n1, n2] = cells;
        let settings = Settings::default()
            .with_tolerance(1e-11)
            .with_symmetry(sparing)
            .with_window(sparing)
            .with_edge(Edge::Allow);
        builder_of(geometry, Grid::new(cells, [side, side * n2 as f64 / n1 as f64]).unwrap(), material.clone())
            .times(1e-3..=1e5)
            .settings(settings)
            .build()
            .unwrap()
    })
}

/// The greatest differences of pressure, displacement, gap, approach and tilt, relative to their greatest values.
fn assert_same(contacts: &[ViscoelasticContact; 2], tolerance: f64, when: &str) {
    let [a, b] = contacts;
    let size = |field: &[f64]| field.iter().filter(|x| x.is_finite()).fold(0.0_f64, |size, x| size.max(x.abs()));
    // a displacement that went, or a gap that closed, leaves rounding
    let least = size(b.fields().displacement()).max(1e-3 * size(&gap(b.fields())));
    let compare = |what: &str, a: &[f64], b: &[f64]| {
        let is_length = what.contains("displacement") || what == "gap" || what == "approach";
        let scale = size(b).max(if is_length { least } else { f64::MIN_POSITIVE });
        for (k, (a, b)) in a.iter().zip(b).enumerate() {
            assert!(a == b || (a - b).abs() <= tolerance * scale, "{when}, {what} of cell {k}: {a} {b}, scale {scale}");
        }
    };
    compare("pressure", a.pressure(), b.pressure());
    compare("displacement", a.fields().displacement(), b.fields().displacement());
    compare("gap", &gap(a.fields()), &gap(b.fields()));
    compare("approach", &[a.approach()], &[b.approach()]);
    compare("force", &[a.force()], &[b.force()]);
    assert_eq!(a.contact_cells(), b.contact_cells(), "{when}");
    let area = (a.contact_area() / b.contact_area().max(f64::MIN_POSITIVE) - 1.0).abs();
    assert!(a.contact_cells() == 0 || area < 1e-5, "{when}: contact area off by {area:e}");
    assert!((0..2).all(|axis| (a.tilt()[axis] - b.tilt()[axis]).abs() < 1e-9), "{when}: {:?} {:?}", a.tilt(), b.tilt());
    // half way within the last step
    if let (Ok(a), Ok(b)) = (a.within_step(a.time() - 0.01), b.within_step(b.time() - 0.01)) {
        compare("displacement within the step", a.fields().displacement(), b.fields().displacement());
    }
}

/// Bodies, of a series that is exact or fitted.
fn bodies() -> [Material; 4] {
    let two = GeneralizedMaxwell::new(1.0e5, &[(1.0e6, 0.1), (5.0e5, 3.0)]).unwrap();
    let closure = FnRheology::new(|t: f64| 1.0e-6 * (1.0 + t.powf(0.4)));
    [maxwell(), Material::incompressible(two), elastic(), Material::incompressible(closure)]
}

/// Loads and shapes that were symmetric, and are no longer.
#[test]
fn sparing_cells_changes_nothing_where_symmetry_is_lost() {
    for body in bodies() {
        let mut contacts = pair([48, 64], 8.0e-3, &Sphere::new(RADIUS).unwrap(), &body);
        let mut step = |what: &str, dt: f64, load: Load, geometry: Option<&dyn Geometry>| {
            for contact in &mut contacts {
                if let Some(geometry) = geometry {
                    contact.set_geometries(&[geometry]).unwrap();
                    assert!(contact.within_step(contact.time() - 0.01).is_ok(), "{what}: the last step is still known");
                }
                contact.step(dt, load).unwrap();
            }
            assert_same(&contacts, 1e-8, what);
        };
        step("pressed", 0.0, Load::force(0.3), None);
        step("held", 0.3, Load::force(0.3), None);
        let moved = Shifted::new(Sphere::new(RADIUS).unwrap(), [0.7e-3, 0.0]).unwrap();
        step("moved along x1", 0.1, Load::force(0.3), Some(&moved));
        let moved = Shifted::new(Sphere::new(RADIUS).unwrap(), [0.9e-3, -0.6e-3]).unwrap();
        step("moved along both", 0.1, Load::force(0.3), Some(&moved));
        step("by its approach", 0.1, Load::approach(2.0e-5), None);
        step("lifted", 0.1, Load::approach(-1.0e-5), None);
        step("pressed again", 0.0, Load::force(0.5), None);
    }
    let punch = FlatPunch::circular(1.0e-3).unwrap();
    for body in bodies() {
        let mut contacts = pair([40, 40], 5.0e-3, &punch, &body);
        for (step, at) in [[0.0, 0.0], [0.0, 0.1e-3], [0.2e-3, 0.1e-3], [0.0, 0.0]].into_iter().enumerate() {
            for contact in &mut contacts {
                contact.step(if step == 0 { 0.0 } else { 0.2 }, Load::eccentric_force(1.0, at)).unwrap();
            }
            assert_same(&contacts, 1e-8, &format!("punch, step {step}"));
        }
    }
}
