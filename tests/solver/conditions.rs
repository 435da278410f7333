//! The conditions of contact, and scenes in which they are hard to keep.

use crate::common::fields::gap;
use crate::common::{StepLoadedSphere, builder_of, contact_of, figures, maxwell};
use viscocontact::contact::BodyState;
use viscocontact::geometry::Sum;
use viscocontact::prelude::*;

/// By how much the surface and the bodies have moved: gaps are differences of such lengths.
pub(super) fn moved(contact: &ViscoelasticContact, bodies: usize) -> f64 {
    let lengths = contact.grid().lengths();
    let lowered = |body| {
        let BodyState { approach, tilt, .. } = contact.fields().body(body).unwrap();
        approach.abs() + tilt[0].abs() * lengths[0] + tilt[1].abs() * lengths[1]
    };
    let deepest = contact.fields().displacement().iter().copied().fold(0.0, f64::max);
    deepest + (0..bodies).map(lowered).fold(0.0, f64::max)
}

/// p ≥ 0, h = 0 in contact and h ≥ 0 outside to the tolerance, and the conditions of the load of each body, but for the rounding of lengths
/// up to `moved`.
pub(super) fn assert_contact_conditions(
    contact: &ViscoelasticContact,
    loads: &[Load],
    tolerance: f64,
    moved: f64,
    name: &str,
) {
    let gap = gap(contact.fields());
    let cells = contact.contact_cells().max(1) as f64;
    let (mut closed, mut scale) = (0.0, 0.0);
    for ((&p, &h), &u) in contact.pressure().iter().zip(&gap).zip(contact.fields().displacement()) {
        assert!(p >= 0.0, "{name}");
        if p > 0.0 {
            closed += h * h;
            scale += u * u;
        }
    }
    let (closed, scale) = ((closed / cells).sqrt(), (scale / cells).sqrt());
    let lengths = contact.grid().lengths();
    // a few units in the last place
    let rounding = 1e-15 * moved;
    assert!(closed <= tolerance * scale + rounding, "{name}: gap in contact {closed:e}, displacement {scale:e}");
    let deepest = gap.iter().copied().fold(0.0, f64::min);
    assert!(deepest >= -10.0 * tolerance * scale - rounding, "{name}: penetration {deepest:e}, displacement {scale:e}");
    for (body, load) in loads.iter().enumerate() {
        let BodyState { approach, tilt, force, moment, .. } = contact.fields().body(body).unwrap();
        match *load {
            Load::Force { normal, .. } => assert!((force - normal).abs() <= 1e-12 * normal, "{name}: {force} {load}"),
            Load::Approach { approach: given, tilt: at } => {
                let point = at.map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 });
                let held = approach + tilt[0] * point[0] + tilt[1] * point[1];
                let most = 1e-12 * given.abs().max(approach.abs()) + 1e-300;
                assert!((held - given).abs() <= most, "{name}: {held} {load}");
            }
            _ => unreachable!(),
        }
        for axis in [0, 1] {
            match load.tilt()[axis] {
                Tilt::Fixed(angle) => assert_eq!(tilt[axis], angle, "{name}"),
                Tilt::Free { .. } if force == 0.0 => {}
                Tilt::Free { at } => {
                    let moment = moment[axis] - at * force;
                    // a body that has turned away may keep pressures of 1e-38 where others are of order one
                    assert!(
                        moment.abs() <= 1e-12 * lengths[axis] * force + 1e-30,
                        "{name}: moment {moment:e} of {load}"
                    );
                }
                tilt => unreachable!("{tilt:?}"),
            }
        }
    }
}

/// The work of the scene that users are shown, pinned to catch silent drift of the algorithm: it may
/// fall, and then the figures in the documents change with it.
#[test]
fn work_is_what_the_documents_say() {
    let scene = StepLoadedSphere::maxwell();
    let work = |cells, tolerance| scene.run(cells, 100, Settings::default().with_tolerance(tolerance)).unwrap().1;
    let measured = [work(64, 1e-6), work(128, 1e-6), work(256, 1e-6), work(256, 1e-4)];
    println!("{measured:?}");
    figures::figure("convolutions per step", &format!("{:.1}", measured[2])).unwrap();
    for (work, most) in measured.into_iter().zip([3.1, 3.2, 4.0, 1.6]) {
        assert!(work < most && work > 0.6 * most, "{measured:?}");
    }
}

/// A thousand isolated spots, and what their neighbours make of them.
#[test]
fn a_thousand_spots_keep_the_conditions() {
    let grid = Grid::square(256, 1.0).unwrap();
    let wave = |x: f64| (32.0 * std::f64::consts::TAU * x).cos();
    let bumps = FnGeometry::new(move |x, y| 1.0e-3 * (wave(x) + wave(y) + x + 0.3 * y));
    for load in [Load::force(2.0e-3), Load::eccentric_force(2.0e-3, [0.1, -0.2])] {
        let mut contact = builder_of(&bumps, grid.clone(), Material::incompressible(Elastic::new(0.25).unwrap()))
            .settings(Settings::default().with_tolerance(1e-7).with_edge(Edge::Allow))
            .build()
            .unwrap();
        let report = contact.step(0.0, load).unwrap();
        println!("{} cells, {} equivalents", report.contact_cells, report.convolution_equivalents());
        assert_contact_conditions(&contact, &[load], 1e-7, moved(&contact, 1), &format!("{load}"));
        assert!(report.fallback_iterations == 0 && report.convolution_equivalents() < 80.0);
    }
}

/// A state that still pulls somewhere is no solution, however small its residual is when the iterations run out.
#[test]
fn pressures_are_never_negative_when_iterations_run_out() {
    let wavy = Sum::new(Sphere::new(5.0e-3).unwrap(), Wavy::new(2.0e-5, 0.7e-3).unwrap());
    let (mut solved, mut given_up) = (0, 0);
    for max_iterations in 1..12 {
        for tolerance in [1e-4, 1e-3, 1e-2, 0.1] {
            let settings = Settings::default()
                .with_max_iterations(max_iterations)
                .with_tolerance(tolerance)
                .with_edge(Edge::Allow);
            let mut contact = contact_of(&wavy, Grid::square(16, 2.0e-3).unwrap(), maxwell(), settings);
            for (dt, force) in [(0.0, 0.5), (0.1, 0.3), (0.1, 0.05), (1.0, 0.4), (0.3, 0.01), (0.0, 0.2)] {
                match contact.step(dt, Load::force(force)) {
                    Ok(_) => {
                        assert!(contact.pressure().iter().all(|&p| p >= 0.0), "{max_iterations} {tolerance:e}");
                        assert!((contact.force() / force - 1.0).abs() < 1e-9, "{max_iterations} {tolerance:e}");
                        solved += 1;
                    }
                    Err(Error::Step(StepError::NotConverged { .. })) => given_up += 1,
                    Err(error) => panic!("unexpected {error}"),
                }
            }
        }
    }
    assert!(solved > 20 && given_up > 20, "{solved} solved, {given_up} given up");
}
