//! The stress below the surface, of whole contacts: against Hertz, and against the published places where bodies yield.

use crate::common::refused::says;
use crate::common::{G, builder_of, contact_of, maxwell};

use approx::assert_abs_diff_eq;
use viscocontact::analytic::Hertz;
use viscocontact::observe::{Stress, SubsurfaceStress};
use viscocontact::prelude::*;

const RADIUS: f64 = 10.0e-3;

fn elastic(nu: f64) -> Material {
    Material::constant_poisson(Elastic::new(G).unwrap(), nu).unwrap()
}

/// A ball on an elastic body, on a grid 2.6 contact radii wide.
fn ball(cells: usize, nu: f64) -> (ViscoelasticContact, Hertz) {
    let hertz = Hertz::new(RADIUS, 2.0 * G / (1.0 - nu), 0.5).unwrap();
    let grid = Grid::square(cells, 2.6 * hertz.contact_radius).unwrap();
    let mut contact = contact_of(&Sphere::new(RADIUS).unwrap(), grid, elastic(nu), Settings::default());
    contact.step(0.0, Load::force(0.5)).unwrap();
    (contact, hertz)
}

/// `count` depths in equal steps, the last of them `last`.
fn depths(count: usize, last: f64) -> Vec<f64> {
    (1..=count).map(|k| last * k as f64 / count as f64).collect()
}

/// Where a ball yields: von Mises 0.620041 p0 at 0.48087 a for ν = 0.3, 0.532697 p0 at 0.54787 a for ν = ½.
#[test]
fn a_ball_yields_where_hertz_says() {
    for (nu, value, depth) in [(0.3, 0.620_041, 0.480_87), (0.5, 0.532_697, 0.547_87)] {
        let (contact, hertz) = ball(256, nu);
        let (a, peak) = (hertz.contact_radius, hertz.pressure(0.0));
        let found = contact.fields().stress().unwrap().maximum(&depths(12, 1.2 * a), Stress::von_mises).unwrap();
        let error = found.value / (value * peak) - 1.0;
        let [x1, x2, x3] = found.position.map(|x| x / a);
        println!("ν = {nu}: von Mises {error:.1e}, depth {:.1e} a, aside {x1:.1e} {x2:.1e}", x3 - depth);
        assert!(error.abs() < 3e-5, "{nu}: {error:e}");
        assert!((x3 - depth).abs() < 1e-4 && x1.abs() < 1e-6 && x2.abs() < 1e-6, "{nu}: {:?}", found.position);
        assert!(!found.at_end_of_depths && found.stress.von_mises() == found.value);
        // on the axis two principal stresses are equal: Tresca is von Mises, and of the same place
        let tresca = contact.fields().stress().unwrap().maximum(&depths(12, 1.2 * a), Stress::tresca).unwrap();
        assert!((tresca.value / found.value - 1.0).abs() < 1e-6, "{}", tresca.value);
    }
}

/// The same on coarser grids: of second order in the cell, like the pressure.
#[test]
fn the_greatest_stress_converges() {
    let error = |cells: usize| {
        let (contact, hertz) = ball(cells, 0.3);
        let found = contact
            .fields()
            .stress()
            .unwrap()
            .maximum(&depths(12, 1.2 * hertz.contact_radius), Stress::von_mises)
            .unwrap();
        (found.value / (0.620_041 * hertz.pressure(0.0)) - 1.0).abs()
    };
    let errors = [32, 128].map(error);
    println!("von Mises at 32², 128²: {errors:?}");
    assert!(errors[0] < 6e-4 && errors[1] < 6e-5, "{errors:?}");
}

/// On the axis of a ball (K. L. Johnson, Contact Mechanics, 1985, (3.45)): σ33 = −p0/(1 + ζ²) and
/// σ11 = σ22 = −(1 + ν) p0 (1 − ζ atan 1/ζ) + ½ p0/(1 + ζ²) at ζ = z/a.
#[test]
fn stress_on_the_axis_is_hertzs() {
    for nu in [0.0, 0.3, 0.5] {
        let (contact, hertz) = ball(256, nu);
        let (a, peak) = (hertz.contact_radius, hertz.pressure(0.0));
        let stress = contact.fields().stress().unwrap();
        for zeta in [0.02, 0.1, 0.3, 0.5, 1.0, 2.0, 5.0, 30.0] {
            let found = stress.at(&[[0.0, 0.0, zeta * a]]).unwrap()[0];
            let normal = peak / (1.0 + zeta * zeta);
            let lateral = 0.5 * normal - (1.0 + nu) * peak * (1.0 - zeta * (1.0 / zeta).atan());
            for (found, exact) in [(found.s33, -normal), (found.s11, lateral), (found.s22, lateral)] {
                assert!((found - exact).abs() < 1e-3 * peak, "{nu} {zeta}: {found:e} {exact:e}");
                // far below, relative to the stress there: the force is exact
                assert!((found - exact).abs() < 2e-3 * normal, "{nu} {zeta}: {found:e} {exact:e}");
            }
            assert!([found.s12, found.s13, found.s23].iter().all(|shear| shear.abs() < 1e-6 * peak));
        }
    }
}

/// Where a cylinder yields: greatest shear stress 0.300283 p0 at 0.78615 a, whatever ν.
#[test]
fn a_cylinder_yields_where_hertz_says() {
    let (per_length, nu) = (500.0, 0.3);
    let modulus = 2.0 * G / (1.0 - nu);
    let a = (4.0 * per_length * RADIUS / (std::f64::consts::PI * modulus)).sqrt();
    let peak = 2.0 * per_length / (std::f64::consts::PI * a);
    for axis in [0, 1] {
        let along = |of_axis: f64, other: f64| if axis == 0 { [of_axis, other] } else { [other, of_axis] };
        let cells = if axis == 0 { [256, 1] } else { [1, 256] };
        let grid = Grid::new(cells, along(2.6 * a, 1.0)).unwrap();
        let kernel = InfluenceKernel::periodic_along(&grid, Axis::BOTH[1 - axis], 1.0).unwrap();
        let shape = FnGeometry::new(move |x1, x2| [x1, x2][axis].powi(2) / (2.0 * RADIUS));
        let mut contact = builder_of(&shape, grid, elastic(nu)).kernel(kernel).build().unwrap();
        contact.step(0.0, Load::force(per_length)).unwrap();
        let stress = contact.fields().stress().unwrap();
        let found = stress.maximum(&depths(12, 1.5 * a), Stress::tresca).unwrap();
        let error = 0.5 * found.value / (0.300_283 * peak) - 1.0;
        assert!(error.abs() < 1e-3, "{error:e}");
        let [depth, aside] = [found.position[2] / a, found.position[axis] / a];
        assert!((depth - 0.786_15).abs() < 2e-3 && aside.abs() < 1e-3, "{depth} {aside}");
        // on the axis (Johnson (4.46)), and plane strain everywhere
        for zeta in [0.1, 0.5, 2.0, 10.0] {
            let root = f64::sqrt(1.0 + zeta * zeta);
            let stress = stress.at(&[[0.0, 0.0, zeta * a]]).unwrap()[0];
            let (across, along) = if axis == 0 { (stress.s11, stress.s22) } else { (stress.s22, stress.s11) };
            assert_abs_diff_eq!(across, -peak * ((1.0 + 2.0 * zeta * zeta) / root - 2.0 * zeta), epsilon = 1e-3 * peak);
            assert_abs_diff_eq!(stress.s33, -peak / root, epsilon = 1e-3 * peak);
            assert_abs_diff_eq!(along, nu * (across + stress.s33), epsilon = 1e-9 * peak);
        }
    }
}

/// A plane carries the force, but for what a point force puts beyond the grid: between that beyond the circles in and around
/// the grid, F (1 + c²/z²)^(−3/2).
#[test]
fn a_plane_carries_the_force() {
    let (contact, hertz) = ball(64, 0.3);
    let grid = Grid::square(192, 24.0 * hertz.contact_radius).unwrap();
    let mut wide = contact_of(&Sphere::new(RADIUS).unwrap(), grid, contact.material().clone(), Settings::default());
    wide.step(0.0, Load::force(0.5)).unwrap();
    let stress = wide.fields().stress().unwrap();
    for over_a in [0.5, 1.0, 2.0] {
        let z = over_a * hertz.contact_radius;
        let plane = stress.on_plane(z).unwrap();
        let force = -plane.iter().map(|s| s.s33).sum::<f64>() * wide.grid().cell_area();
        let beyond = |c: f64| (1.0 + (c / z).powi(2)).powf(-1.5);
        let half = 12.0 * hertz.contact_radius;
        let missing = 1.0 - force / wide.force();
        assert!(missing < 1.02 * beyond(half) && missing > 0.98 * beyond(2f64.sqrt() * half), "{over_a}: {missing:e}");
    }
}

/// The stress of a contact that computes a growing window equals the stress of the whole grid.
#[test]
fn stress_does_not_depend_on_the_window() {
    let scene = |window: bool| {
        contact_of(
            &Shifted::new(Sphere::new(RADIUS).unwrap(), [0.6e-3, -0.3e-3]).unwrap(),
            Grid::square(96, 6.0e-3).unwrap(),
            Material::incompressible(Maxwell::with_time(G, 1.0).unwrap()),
            Settings::default().with_tolerance(1e-10).with_window(window),
        )
    };
    let (mut part, mut whole) = (scene(true), scene(false));
    let mut sizes = Vec::new();
    for (dt, force) in [(0.0, 0.005), (0.5, 0.02), (0.0, 0.1), (2.0, 0.1), (4.0, 0.1)] {
        let [touched, _] = [&mut part, &mut whole].map(|c| c.step(dt, Load::force(force)).unwrap().contact_cells);
        sizes.push(touched);
        let peak = whole.fields().max_pressure();
        let [one, other] = [&part, &whole].map(|contact| contact.fields().stress().unwrap());
        let depths = [0.1e-3, 0.4e-3];
        let [one_volume, other_volume] = [&one, &other].map(|stress| stress.in_volume(&depths).unwrap());
        for (a, b) in one_volume.values.iter().zip(&other_volume.values) {
            let pairs = a.components().into_iter().zip(b.components());
            pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-7 * peak, "{touched} cells: {a:e} {b:e}"));
        }
        let [a, b] = [one, other].map(|stress| stress.maximum(&depths, Stress::von_mises).unwrap().value);
        assert!((a / b - 1.0).abs() < 1e-7, "{a:e} {b:e}");
    }
    assert!(10 * sizes[0] < sizes[4] && sizes[4] < 96 * 96 / 4, "{sizes:?}");
}

/// The second body has its own Poisson's ratio.
#[test]
fn the_counter_body_has_its_own_poisson_ratio() {
    let builder = builder_of(&Sphere::new(RADIUS).unwrap(), Grid::square(24, 2.0e-3).unwrap(), maxwell());
    let contact = builder.clone().build().unwrap();
    says(&contact.fields().stress_in_counter_body().unwrap_err(), "missing", "a contact needs counter_body: ");
    let other = Material::constant_poisson(Elastic::new(80.0e9).unwrap(), 0.3).unwrap();
    let mut contact = builder.counter_body(other).build().unwrap();
    contact.step(0.0, Load::force(0.1)).unwrap();
    let expected = |nu| {
        SubsurfaceStress::new(contact.fields().kernel(), contact.pressure(), nu).unwrap().on_plane(0.2e-3).unwrap()
    };
    let close = |one: Vec<Stress>, other: Vec<Stress>| {
        let peak = contact.fields().max_pressure();
        one.iter().zip(&other).all(|(a, b)| (a.s11 - b.s11).abs().max((a.s33 - b.s33).abs()) < 1e-13 * peak)
    };
    assert!(close(contact.fields().stress().unwrap().on_plane(0.2e-3).unwrap(), expected(0.5)));
    let below = contact.fields().stress_in_counter_body().unwrap().on_plane(0.2e-3).unwrap();
    assert!(close(below.clone(), expected(0.3)));
    assert!(!close(below, expected(0.5)));
}

/// The ratio of an elastic bulk is known where the body does not creep; else the stress depends on pressures of the past.
#[test]
fn the_ratio_of_an_elastic_bulk_counts_where_it_is_constant() {
    let bulk = 3.0 * G;
    let pressed = |material: Material| {
        let grid = Grid::square(24, 2.0e-3).unwrap();
        let mut contact = contact_of(&Sphere::new(RADIUS).unwrap(), grid, material, Settings::default());
        contact.step(0.0, Load::force(0.1)).unwrap();
        contact
    };
    let contact = pressed(Material::elastic_bulk(Elastic::new(G).unwrap(), bulk).unwrap());
    // (3B − 2G)/(6B + 2G)
    let exact = SubsurfaceStress::new(contact.fields().kernel(), contact.pressure(), 7.0 / 20.0).unwrap();
    let planes = [contact.fields().stress().unwrap(), exact].map(|stress| stress.on_plane(0.2e-3).unwrap());
    for (found, exact) in planes[0].iter().zip(&planes[1]) {
        for (found, exact) in found.components().iter().zip(exact.components()) {
            assert!((found - exact).abs() < 1e-13 * contact.fields().max_pressure(), "{found:e} {exact:e}");
        }
    }
    let creeping = pressed(Material::elastic_bulk(Maxwell::with_time(G, 2.0).unwrap(), bulk).unwrap());
    let error = creeping.fields().stress().unwrap_err();
    says(&error, "material_changing_poisson", "Poisson's ratio of body 0 changes");
    assert_eq!(error.remedy().as_deref(), Some("give the body a constant Poisson's ratio"));
}
