//! Several rigid indenters on one creeping body, against exact statements.

use approx::{assert_abs_diff_eq, assert_relative_eq};

use crate::common::indenters::{ClosedFaces, Indenters};
use crate::common::{three_times, zener};
use viscocontact::prelude::*;

const SCENE: Indenters = Indenters { punch: 0.3e-3, sphere: 10.0e-3, distance: 1.0e-3, cells: 48 };

fn approaches(contact: &ViscoelasticContact) -> Vec<f64> {
    (0..contact.fields().bodies()).map(|body| contact.fields().body(body).unwrap().approach).collect()
}

/// Held forces on three punches and a sphere: no contact shrinks, so that the approaches are those of an elastic body of
/// compliance C(t) (correspondence principle). The sum of lone indenters is close, and not the answer.
#[test]
fn held_indenters_creep_as_elastic_ones_of_the_compliance_of_the_time() {
    let forces = [0.05, 0.05, 0.05, 0.02];
    let (material, loads) = (zener(), forces.map(Load::force));
    let mut contact = SCENE.on(&material, 4).unwrap();
    contact.step(0.0, loads).unwrap();
    let mut furthest = 0.0_f64;
    for k in 1..=20 {
        contact.step(0.1, loads).unwrap();
        if k % 10 == 0 {
            let compliance = material.contact_compliance(contact.time());
            let elastic = approaches(&SCENE.elastic(compliance, &forces).unwrap());
            for (body, (computed, exact)) in approaches(&contact).iter().zip(elastic).enumerate() {
                assert!((computed / exact - 1.0).abs() < 2e-4, "body {body}: {computed} {exact}");
                let sum = SCENE.sum_of_lone(SCENE.center(body), &forces, compliance);
                assert!((sum / exact - 1.0).abs() < 0.02, "body {body}: {sum} {exact}");
                furthest = furthest.max((sum / exact - 1.0).abs());
            }
        }
    }
    println!("the sum of lone indenters is {furthest:.1e} off");
    assert!(furthest > 1e-3, "{furthest}");
}

/// Punches whose faces stay closed are linear: their approaches are a matrix times the creep of their forces, the matrix is
/// symmetric (Betti), and the pressure is the elastic one of the forces of the moment, whatever came before.
#[test]
fn punches_pressed_in_turn_superpose() {
    let (least, most) = (0.0125, 0.05);
    let faces = ClosedFaces::new(&SCENE, least, most).unwrap();
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        assert_relative_eq!(faces.compliances[i][j], faces.compliances[j][i], epsilon = 0.0, max_relative = 1e-6);
    }
    let material = three_times();
    let mut contact = SCENE.on(&material, 3).unwrap();
    let (mut jumps, mut before) = (Vec::new(), [0.0; 3]);
    for turn in 0..4 {
        let forces = [0, 1, 2].map(|body| if body == turn % 3 { most } else { least });
        jumps.push((contact.time(), [0, 1, 2].map(|body| forces[body] - before[body])));
        before = forces;
        let loads = forces.map(Load::force);
        contact.step(0.0, loads).unwrap();
        for k in 0..40 {
            contact.step(if k < 20 { 0.005 } else { 0.02 }, loads).unwrap();
        }
        let exact = faces.approaches(&material, &jumps, contact.time());
        for (computed, exact) in approaches(&contact).iter().zip(exact) {
            assert!((computed / exact - 1.0).abs() < 2e-4, "turn {turn}: {computed} {exact}");
        }
        let elastic = SCENE.elastic(1.0e-6, &forces).unwrap();
        let greatest = elastic.fields().max_pressure();
        for (computed, exact) in contact.pressure().iter().zip(elastic.pressure()) {
            assert!((computed - exact).abs() < 1e-5 * greatest, "turn {turn}: {computed} {exact}");
        }
    }
}

/// What two indenters do to each other along the surface is equal and opposite: ∬ p ∇u over both vanishes, because the response
/// of an elastic body is even.
#[test]
fn lateral_forces_of_two_indenters_are_opposite() {
    let grid = Grid::new([96, 48], [4.0e-3, 2.0e-3]).unwrap();
    let ball = |radius: f64, x: f64| {
        let ball = Shifted::new(Sphere::new(radius).unwrap(), [x, 0.0]).unwrap();
        move |x1: f64, x2: f64| if (x1 > 0.0) == (x > 0.0) { ball.initial_gap(x1, x2) } else { f64::INFINITY }
    };
    let lateral = |own: [f64; 3], other: [f64; 3]| {
        let [own, other] = [own, other].map(|[radius, x, force]| (ball(radius, x), radius, x, force));
        let mut contact = ViscoelasticContact::builder(grid.clone())
            .geometry(&FnGeometry::new(own.0))
            .another_body(&FnGeometry::new(other.0))
            .material(Material::incompressible(Elastic::new(1.0e6).unwrap()))
            .build()
            .unwrap();
        contact.step(0.0, [own.3, other.3].map(Load::force)).unwrap();
        contact.fields().slope_force(&Shifted::new(Sphere::new(own.1).unwrap(), [own.2, 0.0]).unwrap())
    };
    let (left, right) = ([5.0e-3, -0.6e-3, 0.1], [10.0e-3, 0.6e-3, 0.2]);
    let (on_left, on_right) = (lateral(left, right), lateral(right, left));
    println!("lateral forces {on_left:?} N and {on_right:?} N");
    assert!(on_left[0].abs() > 1e-3 * 0.1);
    assert_relative_eq!(on_left[0], -on_right[0], epsilon = 0.0, max_relative = 1e-2);
    assert_abs_diff_eq!([on_left[1], on_right[1]][..], [0.0; 2][..], epsilon = 1e-9);
}
