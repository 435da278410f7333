//! Friction in space against published and closed-form results.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use viscocontact::analytic::{CattaneoMindlin, Hertz, LubkinTorsion};
use viscocontact::friction::{Coulomb, FrictionContact, FrictionLimit, LateralWork, Outcome, ShearLoad};
use viscocontact::prelude::*;
use viscocontact::rheology::Elastic;
use viscocontact::states::{ElasticStates, StatesContact};

use super::dense::relaxation;
use super::space::pair;

pub fn tight() -> Settings {
    Settings::default().with_tolerance(1e-12).with_edge(Edge::Allow)
}

pub fn holds(outcome: Outcome) {
    assert!(matches!(outcome, Outcome::Holds(_)), "{outcome:?}");
}

/// CONTACT's example `cattaneo` (E. A. H. Vollebregt, CONTACT, open source, 2023): a sphere on 19² cells, ν = 0.42, whose
/// output has these digits.
#[test]
fn cattaneo_of_contact() {
    let (side, force, friction) = (19.0 * 0.133_333_3, 9.195, 0.4);
    let grid = Grid::square(19, side).unwrap();
    let body = || Material::constant_poisson(Elastic::new(200.0).unwrap(), 0.42).unwrap();
    let shape = FnGeometry::new(|x, y| 0.01 * (x * x + y * y));
    let scene = ViscoelasticContact::builder(grid.clone()).geometry(&shape).material(body().against(body()));
    let mut contact = FrictionContact::new(scene.settings(tight()), Coulomb::new(friction).unwrap()).unwrap();
    holds(contact.step(0.0, Load::force(force), ShearLoad::force([0.0; 2])).unwrap());
    holds(contact.step(0.0, Load::force(force), ShearLoad::force([0.875 * friction * force, 0.0])).unwrap());
    assert!((contact.normal().fields().max_pressure() - 4.393).abs() < 5e-4);
    assert!((contact.normal().approach() - 1.998e-2).abs() < 5e-6);
    assert!((contact.motion()[0] - 8.155e-3).abs() < 5e-7);
    let touching = contact.normal().contact_cells();
    assert_eq!([contact.stick_cells(), touching - contact.stick_cells()], [45, 132]);
    let at = (0..19 * 19)
        .find(|k| {
            let [x, y] = grid.center(k / 19, k % 19);
            x.abs() < 1e-9 && (y + 0.9333).abs() < 1e-3
        })
        .unwrap();
    let size = |fields: [Vec<f64>; 2]| fields[0][at].hypot(fields[1][at]);
    assert!((contact.normal().pressure()[at] - 1.44).abs() < 5e-3);
    assert!((size(contact.traction()) - 0.575).abs() < 5e-4);
    assert!((size(contact.slip()) - 3.13e-3).abs() < 5e-6);
}

/// Q = λ P from the start sticks everywhere, τ = λ p, whatever the bodies remember.
#[test]
fn oblique_loading_sticks_in_space() {
    for is_line in [false, true] {
        let (nu, grid) = if is_line {
            (0.5, Grid::new([96, 1], [4.0, 1.0]).unwrap())
        } else {
            (0.0, Grid::square(24, 4.0).unwrap())
        };
        let shape = FnGeometry::new(|x, y| 0.1 * (x * x + y * y) + 0.02 * (7.0 * x).sin() * (5.0 * y + 1.0).cos());
        let mut scene = ViscoelasticContact::builder(grid.clone()).geometry(&shape).material(pair(&relaxation(0), nu));
        if is_line {
            scene = scene.kernel(InfluenceKernel::line(&grid, 10.0).unwrap());
        }
        let mut contact = FrictionContact::new(scene.settings(tight()), Coulomb::new(0.5).unwrap()).unwrap();
        let direction = if is_line { [1.0, 0.0] } else { [0.6, 0.8] };
        for (dt, force) in [(0.0, 0.1), (0.2, 0.17), (0.2, 0.25), (0.3, 0.3), (1.0, 0.4), (1.0, 0.5), (2.0, 0.5)] {
            let along = direction.map(|part| 0.25 * force * part);
            holds(contact.step(dt, Load::force(force), ShearLoad::force(along)).unwrap());
            let (found, most) = (contact.traction(), contact.normal().fields().max_pressure());
            for (k, pressure) in contact.normal().pressure().iter().enumerate() {
                for axis in 0..2 {
                    let off = found[axis][k] - 0.25 * direction[axis] * pressure;
                    assert!(off.abs() < 1e-10 * most, "{is_line} {dt}: {:.1e}", off.abs() / most);
                }
            }
            assert_eq!(contact.stick_cells(), contact.normal().contact_cells());
            let work = contact.lateral_work();
            assert!(
                work.slip.abs() < 1e-10 * work.work && (dt > 0.0 || work.creep.abs() < 1e-10 * work.work),
                "{work:?}"
            );
        }
    }
}

/// A ball of the contact radius 1 on two elastic bodies of G = 1, f = 0.4, on so many cells.
fn ball(cells: usize, nu: f64) -> (FrictionContact, Hertz) {
    let radius = 10.0;
    // E* of two bodies is G/(1 − ν)
    let modulus = 1.0 / (1.0 - nu);
    let force = 4.0 / 3.0 * modulus / radius;
    let body = || Material::constant_poisson(Elastic::new(1.0).unwrap(), nu).unwrap();
    let shape = FnGeometry::new(move |x, y| 0.5 * (x * x + y * y) / radius);
    let scene = ViscoelasticContact::builder(Grid::square(cells, 2.4).unwrap())
        .geometry(&shape)
        .material(body().against(body()))
        .settings(tight());
    let mut contact = FrictionContact::new(scene, Coulomb::new(0.4).unwrap()).unwrap();
    holds(contact.step(0.0, Load::force(force), ShearLoad::force([0.0; 2])).unwrap());
    (contact, Hertz::new(radius, modulus, force).unwrap())
}

/// Errors on meshes of ratio 2 fall by more than first order over all of them.
fn converges(errors: &[f64], last: f64) {
    println!("{errors:?}");
    let (first, end) = (errors[0], errors[errors.len() - 1]);
    assert!(end < last && end < first * 0.45_f64.powi(errors.len() as i32 - 1), "{errors:?}");
}

#[test]
fn torsion_of_a_ball_converges() {
    for (stick, nu, last) in [(0.813_568_13, 0.0, 1e-3), (0.495_895_05, 0.3, 3e-3)] {
        let errors = [24, 48, 96].map(|cells| {
            let (mut contact, hertz) = ball(cells, nu);
            let force = contact.normal().force();
            // two bodies turn as one of half the modulus
            let exact = LubkinTorsion::new([0.4 * hertz.max_pressure, 0.5], hertz.contact_radius, stick).unwrap();
            let load = ShearLoad::force([0.0; 2]).with_torque(exact.moment);
            holds(contact.step(0.0, Load::force(force), load).unwrap());
            (contact.motion()[2] / exact.angle - 1.0).abs()
        });
        converges(&errors, last);
    }
}

#[test]
fn shear_of_a_ball_converges() {
    let errors = [24, 48, 96].map(|cells| {
        let (mut contact, hertz) = ball(cells, 0.0);
        let force = contact.normal().force();
        let exact = CattaneoMindlin::new(&hertz, force, 0.4, 1.0).unwrap();
        let mut worst = 0.0_f64;
        let mut turns = Vec::new();
        for part in [0.5, -0.2, 0.3] {
            turns.push(part * 0.4 * force);
            let along = ShearLoad::force([0.6 * turns[turns.len() - 1], 0.8 * turns[turns.len() - 1]]);
            holds(contact.step(0.0, Load::force(force), along).unwrap());
            let [x, y, _] = contact.motion();
            worst = worst.max((0.6 * x + 0.8 * y - exact.displacement(&turns)).abs() / exact.displacement(&turns[..1]));
        }
        worst
    });
    converges(&errors, 2e-3);
}

/// Where contacts on elastic states are exact, they and the contact in space move alike: pressed, sheared, held while
/// they creep, sheared back, released in part.
#[test]
fn space_and_states_move_alike() {
    let steps = [
        (0.0, 0.1, 0.0),
        (0.0, 0.1, 0.5),
        (0.3, 0.1, 0.5),
        (1.0, 0.1, 0.5),
        (0.0, 0.1, -0.3),
        (0.0, 0.06, -0.3),
        (0.1, 0.03, 0.2),
    ];
    for is_line in [false, true] {
        let (nu, grid) = if is_line {
            (0.5, Grid::new([128, 1], [1.0, 1.0]).unwrap())
        } else {
            (0.0, Grid::square(24, 1.0).unwrap())
        };
        let shape = FnGeometry::new(|x, y| 2.0 * (x * x + y * y) + 0.02 * (17.0 * x).sin() * (9.0 * y + 1.0).cos());
        let material = pair(&relaxation(1), nu);
        let mut scene = ViscoelasticContact::builder(grid.clone()).geometry(&shape).material(material.clone());
        let mut elastic = ElasticContact::builder(grid.clone()).geometry(&shape).modulus(1.0).settings(tight());
        if is_line {
            scene = scene.kernel(InfluenceKernel::line(&grid, 3.0).unwrap());
            elastic = elastic.kernel(InfluenceKernel::line(&grid, 3.0).unwrap());
        }
        let mut elastic = elastic.build().unwrap();
        let mut space = FrictionContact::new(scene.settings(tight()), Coulomb::new(0.5).unwrap()).unwrap();
        // levels do not depend on the states under forces: those that the steps cut are found first
        let take = |table: &[(f64, f64, f64, f64)]| {
            let states = ElasticStates::from_table(table).unwrap();
            let contact = StatesContact::new(&states, &material).unwrap().with_linear_steps();
            // with the normal kernel along the surface, in the line: the ratio of the estimate is that of half-spaces
            contact.with_merge_error(0.0).unwrap().with_estimated_friction(0.5).unwrap()
        };
        let ratio = 0.5 * (2.0 - nu) / (1.0 - nu);
        let (mut first, mut levels) = (take(&[(1e-9, 1e-9, 1.0, 1.0), (50.0, 50.0, 1.0, 1.0)]), vec![1e-4, 5.0]);
        for (dt, force, part) in steps {
            first.step_sheared(dt, Load::force(force), Load::force(0.5 * force * part)).unwrap();
            levels.extend(first.tractions().map(|(level, _)| level));
            levels.extend([first.level(), first.stick_level()]);
        }
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|a, b| *a - *b <= 1e-11 * *b);
        let lowest = (0..grid.len())
            .map(|k| grid.center(k / grid.cells()[1], k % grid.cells()[1]))
            .map(|[x, y]| 2.0 * (x * x + y * y) + 0.02 * (17.0 * x).sin() * (9.0 * y + 1.0).cos())
            .fold(f64::INFINITY, f64::min);
        let mut table = Vec::new();
        for level in levels.into_iter().filter(|level| *level > 0.0) {
            elastic.solve(Load::force(level)).unwrap();
            table.push((level, elastic.fields().approach() - lowest, 1.0, elastic.fields().contact_cells() as f64));
        }
        let (mut by_levels, mut far) = (take(&table), 0.0_f64);
        for (step, (dt, force, part)) in steps.into_iter().enumerate() {
            let along = 0.5 * force * part;
            holds(space.step(dt, Load::force(force), ShearLoad::force([along, 0.0])).unwrap());
            by_levels.step_sheared(dt, Load::force(force), Load::force(along)).unwrap();
            let expected = by_levels.lateral_displacement() / ratio;
            far = far.max(expected.abs());
            let off = (space.motion()[0] - expected).abs();
            println!("{is_line} {step}: {:.1e}", off / far);
            assert!(off <= 1e-9 * far, "{is_line}, step {step}: {:.1e}", off / far);
        }
    }
}

/// Work along the surface is stored or lost by slip: what elastic bodies store is ½ Σ τ u, with u from motion and slip.
#[test]
fn work_is_stored_or_lost_by_slip() {
    let (mut contact, _) = ball(32, 0.3);
    let (force, grid) = (contact.normal().force(), contact.normal().grid().clone());
    let mut displaced = vec![[0.0; 2]; grid.len()];
    for step in 0..40 {
        let phase = 0.3 * f64::from(step);
        let before = contact.motion();
        let [q1, q2] = [0.8 * phase.sin(), 0.3 * (2.0 * phase).sin()].map(|part| 0.4 * force * part);
        holds(contact.step(0.1, Load::force(force), ShearLoad::force([q1, q2]).with_torque(0.1 * q1)).unwrap());
        let moved: [f64; 3] = std::array::from_fn(|k| contact.motion()[k] - before[k]);
        let (slip, traction) = (contact.slip(), contact.traction());
        let mut stored = 0.0;
        for (k, u) in displaced.iter_mut().enumerate() {
            let [x, y] = grid.center(k / 32, k % 32);
            let body = [moved[0] - y * moved[2], moved[1] + x * moved[2]];
            for axis in 0..2 {
                u[axis] += body[axis] - slip[axis][k];
                stored += 0.5 * grid.cell_area() * traction[axis][k] * u[axis];
            }
        }
        let found = contact.lateral_work();
        let size = 1e-9 * (found.work.abs() + found.slip);
        assert!((found.stored - stored).abs() <= size && found.creep.abs() <= size, "{step}: {found:?} {stored}");
        assert!(found.slip >= 0.0);
    }
    let LateralWork { work, slip, .. } = contact.lateral_work();
    assert!(slip > 0.1 * work);
}

#[test]
fn bodies_that_friction_does_not_cover_are_refused() {
    let grid = Grid::square(16, 1.0e-3).unwrap();
    let ball = Sphere::new(1.0e-3).unwrap();
    let scene = |material: Material| ViscoelasticContact::builder(grid.clone()).geometry(&ball).material(material);
    let law = || Coulomb::new(0.5).unwrap();
    let coupled = Material::constant_poisson(Elastic::new(1.0e6).unwrap(), 0.3).unwrap();
    let rubber = || Material::incompressible(Elastic::new(1.0e6).unwrap());
    let other = |error: Error| assert!(error.code() == "friction_other_bodies", "{error}");
    other(FrictionContact::new(scene(coupled), law()).unwrap_err());
    let layer = InfluenceKernel::layer(&grid, Layer::bonded_to_rigid(1.0e-3, 0.5).unwrap()).unwrap();
    other(FrictionContact::new(scene(rubber()).kernel(layer), law()).unwrap_err());
    let error = FrictionContact::new(scene(rubber()).another_body(&ball), law()).unwrap_err();
    assert!(matches!(error, Error::NotCovered { .. }), "{error}");
    assert!(Coulomb::new(-0.1).is_err() && Coulomb::new(f64::NAN).is_err());
    let mut contact = FrictionContact::new(scene(rubber()), law()).unwrap();
    assert!(contact.step(0.0, Load::force(0.1), ShearLoad::force([f64::NAN, 0.0])).is_err());
    let outcome = contact.step(0.0, Load::force(0.1), ShearLoad::force([0.06, 0.0])).unwrap();
    assert!(matches!(outcome, Outcome::Slides { over_limit, .. } if (over_limit - 1.2).abs() < 1e-9), "{outcome:?}");
    assert_eq!(contact.normal().force(), 0.0);
    assert_eq!(contact.motion(), [0.0; 3]);
}

/// Coulomb's law with f = 1/2 that cancels the step once it is asked, while it is armed: the normal contact is solved then.
#[derive(Debug)]
struct Cancelling {
    armed: Arc<AtomicBool>,
    cancelled: Arc<AtomicBool>,
}

impl FrictionLimit for Cancelling {
    fn limit(&self, pressure: f64) -> f64 {
        self.cancelled.fetch_or(self.armed.load(Ordering::Relaxed), Ordering::Relaxed);
        0.5 * pressure
    }
}

#[test]
fn a_step_that_is_cancelled_changes_nothing() {
    let grid = Grid::square(16, 1.0e-3).unwrap();
    let rubber = Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap());
    let ball = ViscoelasticContact::builder(grid).geometry(&Sphere::new(1.0e-3).unwrap()).material(rubber);
    let [armed, cancelled] = [(); 2].map(|()| Arc::new(AtomicBool::new(false)));
    let law = Cancelling { armed: Arc::clone(&armed), cancelled: Arc::clone(&cancelled) };
    let mut contact = FrictionContact::new(ball, law).unwrap();
    let (load, shear) = (Load::force(0.1), ShearLoad::force([0.03, 0.01]).with_torque(1.0e-6));
    holds(contact.step(0.0, load, ShearLoad::force([0.0; 2])).unwrap());
    let mut other = contact.clone();
    armed.store(true, Ordering::Relaxed);
    for _ in 0..2 {
        // at first in the search along the surface, then in the normal contact
        let error = contact.step_unless(&cancelled, 0.5, load, shear).unwrap_err();
        assert!(matches!(error, Error::Cancelled { .. }), "{error}");
        assert_eq!([contact.normal().time(), contact.force()[0]], [0.0; 2]);
    }
    armed.store(false, Ordering::Relaxed);
    cancelled.store(false, Ordering::Relaxed);
    for contact in [&mut contact, &mut other] {
        holds(contact.step_unless(&cancelled, 0.5, load, shear).unwrap());
    }
    assert_eq!(contact.traction(), other.traction());
    assert_eq!(contact.motion(), other.motion());
}
