//! Loads that tilt, prescribe the approach, separate and come back, on elastic and creeping bodies.

use crate::common::{E_STAR, contact_of, elastic};
use approx::assert_abs_diff_eq;
use viscocontact::analytic::RigidPunch;
use viscocontact::prelude::*;

const RADIUS: f64 = 1.0e-3;

fn contact(grid: Grid, shape: &dyn Geometry, material: Material, tolerance: f64) -> ViscoelasticContact {
    contact_of(shape, grid, material, Settings::default().with_tolerance(tolerance))
}

fn punch(cells: usize) -> ViscoelasticContact {
    let grid = Grid::square(cells, 2.1 * RADIUS).unwrap();
    contact(grid, &FlatPunch::circular(RADIUS).unwrap(), elastic(), 1e-7)
}

/// Lur'e's punch on a 2.1 R square: pressure for r < 0.8 R, approach and tilt, and the work they took.
fn lure_errors(cells: usize, e: f64) -> [f64; 3] {
    let exact = RigidPunch::new(RADIUS, E_STAR, 1.0, e * RADIUS).unwrap();
    let mut contact = punch(cells);
    let report = contact.step(0.0, Load::eccentric_force(1.0, [e * RADIUS, 0.0])).unwrap();
    assert!(report.convolution_equivalents() <= 12.0 && report.iterations <= 13, "e = {e} R: {report}");
    assert_abs_diff_eq!(contact.force(), 1.0, epsilon = 1e-12);
    assert_abs_diff_eq!(contact.fields().moment()[0], e * RADIUS, epsilon = 1e-12 * RADIUS);
    assert_abs_diff_eq!(contact.fields().moment()[1], 0.0, epsilon = 1e-12 * RADIUS);
    let mut pressure: f64 = 0.0;
    for i in 0..cells {
        for j in 0..cells {
            let [x1, x2] = contact.grid().center(i, j);
            if x1.hypot(x2) < 0.8 * RADIUS {
                pressure = pressure.max((contact.pressure()[i * cells + j] / exact.pressure(x1, x2) - 1.0).abs());
            }
        }
    }
    [pressure, (contact.approach() / exact.approach - 1.0).abs(), (contact.tilt()[0] / exact.tilt - 1.0).abs()]
}

#[test]
fn eccentric_punch_is_lures() {
    for e in [0.1, 0.2, 0.3] {
        let [pressure, approach, tilt] = lure_errors(256, e);
        println!("e = {e} R: pressure {pressure:.2e}, approach {approach:.2e}, tilt {tilt:.2e}");
        assert!(pressure < 6e-3 && approach < 1.5e-3 && tilt < 3.5e-3);
    }
}

#[test]
fn approach_and_tilt_converge_at_first_order() {
    let [coarse, fine] = [64, 256].map(|cells| lure_errors(cells, 0.2));
    for (name, coarse, fine) in [("approach", coarse[1], fine[1]), ("tilt", coarse[2], fine[2])] {
        let order = (coarse / fine).log2() / 2.0;
        println!("{name}: {coarse:.2e} → {fine:.2e}, order {order:.2}");
        assert!(order > 0.9, "{name}: order {order}");
    }
}

/// Beyond R/3 the contact opens on the far side; the work stays bounded.
#[test]
fn eccentric_punch_opens() {
    let mut cells = usize::MAX;
    let mut tilt = 0.0;
    for e in [0.35, 0.45, 0.6, 0.75, 0.9] {
        let mut contact = punch(256);
        let report = contact.step(0.0, Load::eccentric_force(1.0, [0.0, -e * RADIUS])).unwrap();
        assert!(report.convolution_equivalents() <= 35.0 && report.iterations <= 13, "e = {e} R: {report}");
        assert_eq!(report.fallback_iterations, 0);
        assert!(report.contact_cells < cells && -report.tilt[1] > tilt);
        assert!(report.tilt[0].abs() < 1e-6 * -report.tilt[1], "the load is on the axis");
        (cells, tilt) = (report.contact_cells, -report.tilt[1]);
        assert_abs_diff_eq!(contact.fields().moment()[1], -e * RADIUS, epsilon = 1e-12 * RADIUS);
    }
}

#[test]
fn loads_that_would_topple_are_refused_at_once() {
    let mut contact = punch(64);
    let error = contact.step(0.0, Load::eccentric_force(1.0, [1.1 * RADIUS, 0.0])).unwrap_err();
    let Error::Step(StepError::LoadOutsideHull { body: 0, at, .. }) = error else { panic!("{error}") };
    assert_eq!(at, [1.1 * RADIUS, 0.0]);
    // what cannot tilt cannot topple
    contact.step(0.0, Load::Force { normal: 1.0, tilt: [Tilt::Fixed(0.0), Tilt::Free { at: 0.0 }] }).unwrap();
    let hinge = Load::Force { normal: 1.0, tilt: [Tilt::Free { at: 1.1 * RADIUS }, Tilt::Fixed(0.0)] };
    assert!(matches!(contact.step(0.0, hinge), Err(Error::Step(StepError::LoadOutsideHull { .. }))));
    // two feet hold what lies between them
    let feet = FnGeometry::new(|x: f64, _| if x.abs() > 0.5e-3 { 0.0 } else { f64::INFINITY });
    let settings = Settings::default().with_edge(Edge::Allow);
    let mut table = contact_of(&feet, Grid::square(32, 2.0e-3).unwrap(), elastic(), settings);
    table.step(0.0, Load::eccentric_force(1.0, [0.2e-3, 0.1e-3])).unwrap();
    assert!(table.tilt()[0] > 0.0);
}

/// More cycles than there are numbers for are a load all the same.
#[test]
fn a_sinusoid_of_endless_cycles_stays_between_its_ends() {
    for (frequency, t) in [(1e300, 1e10), (f64::MAX, f64::MAX), (1e200, 1e200), (1e-300, f64::MAX)] {
        let swing = Sinusoid::new(Load::force(1.0), Load::force(3.0), frequency).unwrap();
        let Load::Force { normal, .. } = swing.at(t) else { panic!("a force") };
        assert!((1.0..=3.0).contains(&normal), "{normal} at {t:e} s, {frequency:e} Hz");
    }
}

#[test]
fn loads_are_displayed_in_words() {
    let hinge = Load::Force { normal: 5.0, tilt: [Tilt::Free { at: 1.0e-3 }, Tilt::Fixed(0.1)] };
    assert_eq!(hinge.to_string(), "a force of 5 N, at x1 = 0.001 m, tilt along x2 0.1 rad");
    assert_eq!(Load::approach(2.0e-6).to_string(), "an approach of 0.000002 m");
}
