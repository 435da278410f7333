//! Warnings of steps.

use crate::common::{builder_of, contact_of, elastic, maxwell, sphere, sphere_on};
use viscocontact::Error;
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;

fn contact(cells: usize, material: Material, settings: Settings) -> ViscoelasticContact {
    sphere_on(Grid::square(cells, 4.0e-3).unwrap(), material, settings)
}

#[test]
fn a_good_step_has_no_warnings() {
    for (symmetry, window) in [(true, true), (false, true), (true, false), (false, false)] {
        let settings = Settings::default().with_symmetry(symmetry).with_window(window);
        let mut contact = contact(64, maxwell(), settings);
        let report = contact.step(0.0, Load::force(0.5)).unwrap();
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
        assert!(contact.step(0.1, Load::force(0.5)).unwrap().warnings.is_empty());
    }
}

#[test]
fn contact_near_the_edge_is_warned_of_before_it_touches() {
    for (symmetry, window) in [(true, true), (false, true), (false, false)] {
        let settings = Settings::default().with_symmetry(symmetry).with_window(window);
        let mut contact = contact(32, maxwell(), settings);
        let (mut near, mut clear, mut force) = (0, 0, 0.1);
        loop {
            match contact.step(0.0, Load::force(force)) {
                Ok(report) if report.warnings.contains(Warnings::NEAR_EDGE) => near += 1,
                Ok(_) => {
                    assert_eq!(near, 0, "{force} N");
                    clear += 1;
                }
                Err(error) => {
                    assert!(matches!(error, Error::Step(StepError::ContactAtEdge { .. })), "{error}");
                    break;
                }
            }
            force *= 1.1;
        }
        assert!(near > 0 && clear > 0, "{near} {clear}");
    }
}

/// Below 8 cells across, contact is warned of, and errs by per cents; above, it is not, and errs by less.
#[test]
fn few_cells_are_warned_of_where_errors_are_large() {
    let hertz = viscocontact::analytic::Hertz::new(10.0e-3, 4.0e6, 1.0).unwrap();
    let a = hertz.contact_radius;
    // the greatest errors of approach, peak and area over places of the sphere within a cell; whether each was warned of
    let worst = |across: f64| {
        let side = 2.0 * a / across;
        let (mut errors, mut warned) = ([0.0_f64; 3], 0);
        for k in 0..10 {
            let off = [0.137, 0.311].map(|part| (f64::from(k) * part).fract() * side);
            let (shape, grid) = (Shifted::new(sphere(), off).unwrap(), Grid::square(24, 24.0 * side).unwrap());
            let mut contact = contact_of(&shape, grid, elastic(), Settings::default());
            let report = contact.step(0.0, Load::force(1.0)).unwrap();
            warned += u32::from(report.warnings.contains(Warnings::FEW_CELLS));
            let found = [contact.approach(), contact.fields().max_pressure(), contact.contact_area()];
            let exact = [hertz.approach, hertz.max_pressure, std::f64::consts::PI * a * a];
            errors = [0, 1, 2].map(|i| errors[i].max((found[i] / exact[i] - 1.0).abs()));
        }
        (errors, warned)
    };
    let ([approach, peak, area], warned) = worst(4.0);
    println!("4 cells across: {approach:.1e} {peak:.1e} {area:.1e}");
    assert!(warned == 10 && approach > 5e-3 && peak > 2e-2 && area > 2e-2);
    let ([approach, peak, area], warned) = worst(8.2);
    println!("8 cells across: {approach:.1e} {peak:.1e} {area:.1e}");
    assert!(warned == 0 && approach < 5e-3 && peak < 2e-2 && area < 3e-2);
}

/// Where hardly anything of the pressure is left and the body may turn, rounding of the gap hides it: the step warns.
#[test]
fn rounding_is_warned_of() {
    let mut contact = builder_of(&FlatPunch::circular(1.2e-3).unwrap(), Grid::square(40, 4.0e-3).unwrap(), maxwell())
        .build()
        .unwrap();
    let held = Load::Approach { approach: 1.0e-5, tilt: [Tilt::Free { at: 0.1e-3 }, Tilt::Fixed(0.0)] };
    let force = {
        let report = contact.step(0.0, held).unwrap();
        assert!(!report.warnings.contains(Warnings::ROUNDING), "{report}");
        report.force
    };
    for dt in [5.0, 30.0] {
        let report = contact.step(dt, held).unwrap();
        let error = (report.force / (force * (-report.time).exp()) - 1.0).abs();
        println!("{report}: force errs by {error:.1e}");
        assert_eq!(report.warnings.contains(Warnings::ROUNDING), dt > 10.0, "{report}");
        assert!(dt > 10.0 || error < 1e-4, "{report}");
    }
}

/// The error of a contact at the edge estimates the width that holds the contact.
#[test]
fn contact_at_the_edge_estimates_the_width_that_it_needs() {
    let (length, modulus) = (4.0e-3, 4.0e6);
    let refused = |shape: &dyn Geometry, load: Load| {
        let mut contact = builder_of(shape, Grid::square(48, length).unwrap(), elastic()).build().unwrap();
        let Err(Error::Step(StepError::ContactAtEdge { lengths, needed, .. })) = contact.step(0.0, load) else {
            panic!("no contact at the edge")
        };
        assert_eq!(lengths, [length; 2]);
        needed
    };
    for wider in [1.2, 2.0, 4.0] {
        let radius = 0.5 * length * wider;
        let sphere = Sphere::new(10.0e-3).unwrap();
        let cone = Cone::new(0.1).unwrap();
        let force = [
            4.0 / 3.0 * modulus * radius.powi(3) / 10.0e-3,
            std::f64::consts::FRAC_PI_2 * 0.1 * modulus * radius.powi(2),
        ];
        let depth = [radius.powi(2) / 10.0e-3, std::f64::consts::FRAC_PI_2 * 0.1 * radius];
        for (shape, which) in [(&sphere as &dyn Geometry, 0), (&cone, 1)] {
            for load in [Load::force(force[which]), Load::approach(depth[which])] {
                for needed in refused(shape, load).expect("an estimate") {
                    assert!((needed / (2.0 * radius) - 1.0).abs() < 0.12, "{needed} {radius} {load:?}");
                }
            }
        }
    }
    let flat = Wavy::in_two_directions([1.0e-9; 2], [length / 8.0; 2]).unwrap();
    assert_eq!(refused(&flat, Load::force(1.0e3)), None);
}

/// The gap of a plane is constant but for rounding.
#[test]
fn a_plane_is_neither_steep_nor_flat() {
    let plane = FnGeometry::new(|x1: f64, _: f64| if x1 < 0.0 { 0.1 + 0.2 } else { 0.3 });
    let settings = Settings::default().with_edge(Edge::Allow);
    let report =
        contact_of(&plane, Grid::square(64, 1.0e-3).unwrap(), elastic(), settings).step(0.0, Load::approach(0.31));
    assert!(!report.unwrap().warnings.intersects(Warnings::STEEP | Warnings::FLAT));
}

/// The one cell across a line contact is a unit of length, in which bodies rise by little.
#[test]
fn a_small_cylinder_is_not_flat() {
    let grid = Grid::new([64, 1], [0.25e-3, 1.0]).unwrap();
    let settings = Settings::default().with_edge(Edge::Allow);
    for (radius, depth, is_flat) in [(0.2e-3, 1.0e-6, false), (1.0e3, 1.0e-12, true)] {
        let cylinder = Cylinder::new(radius).unwrap();
        let report = contact_of(&cylinder, grid.clone(), elastic(), settings).step(0.0, Load::approach(depth));
        assert_eq!(report.unwrap().warnings.contains(Warnings::FLAT), is_flat, "{radius}");
    }
}

/// The greatest slope in contact is the slope of the body there, whatever part of the grid is computed.
#[test]
fn the_slope_of_a_cone_is_reported() {
    for tan_beta in [0.3, 0.45, 0.55, 0.9] {
        for (symmetry, window) in [(true, true), (false, false)] {
            let settings = Settings::default().with_symmetry(symmetry).with_window(window);
            let cone = Cone::new(tan_beta).unwrap();
            let grid = Grid::square(64, 4.0e-3).unwrap();
            let mut contact = builder_of(&cone, grid, elastic()).settings(settings).build().unwrap();
            let slope = contact.step(0.0, Load::approach(1.0e-3 * tan_beta)).unwrap().figures.max_slope;
            assert_eq!(slope.is_some(), tan_beta > 0.5);
            assert!(slope.is_none_or(|slope| (slope / tan_beta - 1.0).abs() < 0.02), "{slope:?} {tan_beta}");
        }
    }
}
