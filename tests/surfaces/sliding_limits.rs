//! Steady motions against Hunter's closed form, and against the limits of slow and fast motion.

use crate::common::builder_of;
use std::f64::consts::PI;

use viscocontact::analytic::{RigidPunch, SlidingLimits};
use viscocontact::prelude::*;

/// A rolling cylinder against its closed form, at memories from a hundredth of the contact to 10⁵ times its length; the error falls with the mesh.
#[test]
fn a_rolling_cylinder_is_hunters() {
    let (radius, c0, c1, force) = (1.0, 0.25e-6, 2.25e-6, 5.0e3);
    let half = (4.0_f64 * radius * (c0 + c1) * force / PI).sqrt();
    let body = || GeneralizedKelvin::new(4.0 * c0, 0.0, &[(4.0 * c1, 1.0)]).unwrap();
    let friction = |cells: usize, reach: f64, axis: Axis| {
        let grid = Grid::new([cells, 1], [3.0 * half, 1.0]).unwrap();
        let cylinder = Cylinder::new(radius).unwrap();
        let mut sliding = builder_of(&cylinder, grid.clone(), Material::incompressible(body()))
            .kernel(InfluenceKernel::line(&grid, 100.0).unwrap())
            .settings(Settings::default().with_tolerance(1e-9))
            .build_sliding()
            .unwrap();
        let velocity = if axis == Axis::X1 { [reach, 0.0] } else { [0.0, reach] };
        let report = sliding.at(velocity, Load::force(force)).unwrap();
        println!("l/w {}, {cells} cells: {} sets, {} transforms", reach / half, report.sets, report.transforms);
        assert!(report.transforms <= 600);
        [report.friction(), sliding.fields().slope_force(&cylinder)[0] / force]
    };
    // the closed form (`RollingCylinder`) with 40 digits: of a long memory most cancel
    for (over_half, exact, most) in [
        (0.01, 0.00112916499941, 5e-5),
        (0.05, 0.0055210009519, 2e-5),
        (0.5, 0.0417296683762, 2e-5),
        (5.0, 0.0350524117689, 2e-5),
        (100.0, 0.00347562378807, 2e-5),
        (1e3, 0.000478290020837, 2e-5),
        (1e5, 7.39727865853e-6, 3e-3),
    ] {
        let reach = over_half * half;
        let errors = [256, 2048].map(|cells| friction(cells, reach, Axis::X1).map(|found| found / exact - 1.0));
        println!("l/w {over_half}: {errors:?}");
        assert!(errors[1].iter().all(|error| error.abs() < most), "{over_half}: {errors:?}");
    }
    // along the lines nothing resists
    assert!(friction(256, half, Axis::X2).iter().all(|friction| friction.abs() < 1e-12));
}

/// The friction of a ball and of a cylinder, over three retardation times, reaches the closed forms of slow and fast motion in the order of their remainders.
#[test]
fn balls_and_cylinders_reach_the_slow_and_the_fast_limit_in_order() {
    let (radius, terms) = (10e-3, [(3e-6, 0.3), (2e-6, 1.0), (1e-6, 2.0)]);
    let body = || Material::incompressible(GeneralizedKelvin::new(1e-6, 0.0, &terms).unwrap());
    // the reach of the longest time over half the contact with the relaxed body, of the shortest with the glassy one; the order, and the greatest remainder
    for (line, fast, [far, near], orders, most) in [
        (true, false, [0.2, 0.025], 0.98..1.02, 0.012),
        (false, false, [0.2, 0.05], 0.98..1.08, 0.027),
        (true, true, [16.0, 128.0], 1.98..2.08, 5e-5),
        // but for the logarithm
        (false, true, [64.0, 512.0], 0.98..1.08, 8e-3),
    ] {
        let (compliance, time, length) = if fast { (0.25e-6, 0.3, 4.0) } else { (1.75e-6, 2.0, 2.6) };
        let (force, half) = if line {
            (500.0, f64::sqrt(4.0 * 500.0 * radius * compliance / PI))
        } else {
            (1.0, f64::cbrt(0.75 * radius * compliance))
        };
        let (counts, shape): ([usize; 2], Box<dyn Geometry>) = if line {
            ([2048, 1], Box::new(Cylinder::new(radius).unwrap()))
        } else {
            ([128; 2], Box::new(Sphere::new(radius).unwrap()))
        };
        let grid = Grid::new(counts, [length * half, if line { 1.0 } else { length * half }]).unwrap();
        let kernel = if line { InfluenceKernel::line(&grid, 1.0) } else { InfluenceKernel::half_space(&grid) };
        let mut sliding = builder_of(&shape, grid, body())
            .kernel(kernel.unwrap())
            .settings(Settings::default().with_tolerance(1e-9))
            .build_sliding()
            .unwrap();
        let limits = match line {
            true => SlidingLimits::cylinder(radius, &body(), force),
            false => SlidingLimits::ellipsoid([radius; 2], &body(), force),
        };
        let limits = limits.unwrap();
        let [greater, less] = [far, near].map(|reach| {
            let speed = reach * half / time;
            let exact = if fast { limits.fast(speed) } else { limits.slow(speed) };
            (sliding.at([speed, 0.0], Load::force(force)).unwrap().friction() / exact - 1.0).abs()
        });
        let log = if fast && !line { f64::ln(far) / f64::ln(near) } else { 1.0 };
        let order = (greater / less / log).ln() / f64::ln(far / near).abs();
        println!("line {line}, fast {fast}: remainders {greater:e} {less:e}, order {order}");
        assert!(orders.contains(&order) && less < most, "line {line}, fast {fast}: {greater:e} {less:e} {order}");
    }
}

/// A flat face has no gap that the contact closes: under a force it is in the state of the approach that is found, whatever the bodies, at rest and in
/// motion, and at rest on a half-space in the closed form, eccentric or not.
#[test]
fn a_flat_face_under_a_force_is_that_under_its_approach() {
    let (radius, force, modulus) = (1e-3, 1.0, 4.0e6);
    let body = || Material::incompressible(Zener::relaxing(2.0e6, 1.0e6, 0.01).unwrap());
    let square = Grid::square(40, 4e-3).unwrap();
    let (line, strip) =
        (Grid::new([96, 1], [4e-3, 1.0]).unwrap(), FlatPunch::rectangular([2.0 * radius, 2.0]).unwrap());
    let round = FlatPunch::circular(radius).unwrap();
    let layer = Layer::bonded_to_rigid(1e-3, 0.5).unwrap();
    let bodies: [(&Grid, InfluenceKernel, &dyn Geometry); 5] = [
        (&square, InfluenceKernel::half_space(&square).unwrap(), &round),
        (&square, InfluenceKernel::periodic(&square).unwrap(), &round),
        (&square, InfluenceKernel::periodic_along(&square, Axis::X1, 1.0).unwrap(), &round),
        (&square, InfluenceKernel::layer(&square, layer).unwrap(), &round),
        (&line, InfluenceKernel::line(&line, 100.0).unwrap(), &strip),
    ];
    for (number, (grid, kernel, punch)) in bodies.into_iter().enumerate() {
        for tolerance in [1e-6, 1e-10] {
            let mut sliding = builder_of(punch, grid.clone(), body())
                .kernel(kernel.clone())
                .settings(Settings::default().with_tolerance(tolerance))
                .build_sliding()
                .unwrap();
            for speed in [0.0, 1e-3, 0.1, 1e3] {
                let mut at = |load: Load| {
                    sliding.at([speed, 0.0], load).unwrap_or_else(|e| panic!("{number} {speed} {load}: {e}"))
                };
                let found = at(Load::force(force));
                let same = at(Load::approach(found.approach));
                println!("{number}, {speed} m/s: {found} {}, {} {}", found.approach, found.sets, found.transforms);
                assert!((same.force / force - 1.0).abs() < 1e-6, "{number} {speed}: {same}");
                assert!((same.friction() - found.friction()).abs() < 1e-6, "{number} {speed}: {found} {same}");
                assert!((0.0..=1.5 * tolerance).contains(&found.residual), "{found:?}");
                assert_eq!(found.contact_cells, same.contact_cells);
            }
        }
    }
    // a face all over a period closes without displacement
    let flat = FnGeometry::new(|_, _| 0.0);
    let mut sliding = builder_of(&flat, square.clone(), body())
        .kernel(InfluenceKernel::periodic(&square).unwrap())
        .build_sliding()
        .unwrap();
    for speed in [0.0, 0.1] {
        let found = sliding.at([speed, 0.0], Load::force(force)).unwrap();
        assert!(found.contact_cells == 1600 && found.friction().abs() < 1e-9, "{found:?}");
    }
    // relaxed, with the modulus 4 G
    let grid = Grid::square(128, 2.5e-3).unwrap();
    let mut sliding = builder_of(&round, grid, body()).build_sliding().unwrap();
    for eccentricity in [0.0, 0.2e-3] {
        let exact = RigidPunch::new(radius, modulus, force, eccentricity).unwrap();
        let report = sliding.at([0.0; 2], Load::eccentric_force(force, [eccentricity, 0.0])).unwrap();
        let tilt = sliding.fields().tilt()[0];
        println!("{eccentricity}: {} {}, {tilt} {}", report.approach, exact.approach, exact.tilt);
        assert!((report.approach / exact.approach - 1.0).abs() < 0.02, "{report:?}");
        assert!((tilt.abs() - exact.tilt.abs()).abs() <= 0.05 * exact.tilt.abs() + 1e-12, "{tilt} {exact:?}");
    }
}
