//! Contact stiffness against the slope of force over approach; that of a circle is in docs/validation.md.

use crate::common::{G, builder_of, elastic};
use approx::assert_abs_diff_eq;

use crate::common::rough::self_affine;
use viscocontact::prelude::*;

/// dW/dω of a rough surface, by differences of the approach, on a plane and on periodic bodies.
#[test]
fn stiffness_is_the_slope_of_the_force() {
    let grid = Grid::square(64, 1.0e-3).unwrap();
    let spec = self_affine(0.5e-3, 0.1e-3, 3);
    for kernel in [InfluenceKernel::periodic(&grid), InfluenceKernel::half_space(&grid)] {
        let mut contact = builder_of(&Rough::new(&grid, spec).unwrap(), grid.clone(), elastic())
            .kernel(kernel.unwrap())
            .settings(Settings::default().with_edge(Edge::Allow).with_tolerance(1e-10))
            .build()
            .unwrap();
        let mut at = |force: f64| {
            contact.step(0.0, Load::force(force)).unwrap();
            (contact.approach(), contact.fields().stiffness_over_modulus().unwrap())
        };
        let (low, high, middle) = (at(0.02 * 0.999), at(0.02 * 1.001), at(0.02));
        let slope = 0.02 * 2e-3 / (high.0 - low.0) / (4.0 * G);
        assert_abs_diff_eq!(slope, middle.1, epsilon = 2e-3 * middle.1);
    }
    let mut full = builder_of(&Wavy::new(1.0e-6, 1.0e-3).unwrap(), grid.clone(), elastic())
        .kernel(InfluenceKernel::periodic(&grid).unwrap())
        .build()
        .unwrap();
    full.step(0.0, Load::force(1.0)).unwrap();
    assert_eq!(full.fields().stiffness_over_modulus().unwrap(), f64::INFINITY);
}
