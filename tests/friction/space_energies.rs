//! Where the work along the surface goes, against the springs and dashpots of a dense body.

use viscocontact::friction::{Coulomb, FrictionContact, LateralWork, ShearLoad};
use viscocontact::prelude::*;
use viscocontact::states::{Reach, StatesContact, Sweep};

use super::bodies::Past;
use super::dense::relaxation;
use super::space::{half_space, pair, periodic};
use super::space_known::{holds, tight};

const N: usize = 12;
const STEPS: [u32; 3] = [32, 64, 128];

/// A ball on a body of one relaxation time, pressed and sheared at once, then sheared and turned in so many steps: work,
/// loss by slip, creep, what it has beyond that of the dashpots, and what the work has beyond ∫ Q dd by trapezia.
fn balance(is_periodic: bool, is_pressed: bool, steps: u32) -> [f64; 5] {
    let (nu, side, relaxation) = (0.3, 1.0 / N as f64, relaxation(0));
    let grid = Grid::square(N, 1.0).unwrap();
    let shape = FnGeometry::new(|x, y| 0.5 * (x * x + y * y));
    let mut scene =
        ViscoelasticContact::builder(grid.clone()).geometry(&shape).material(pair(&relaxation, nu)).settings(tight());
    if is_periodic {
        scene = scene.kernel(InfluenceKernel::periodic(&grid).unwrap());
    }
    let mut contact = FrictionContact::new(scene, Coulomb::new(0.5).unwrap()).unwrap();
    let influence = if is_periodic { periodic(N, side, nu) } else { half_space(side, nu) };
    let n = N * N;
    let apart = |i: usize, j: usize| [(i / N) as isize - (j / N) as isize, (i % N) as isize - (j % N) as isize];
    let dense: Vec<[f64; 3]> = (0..n * n).map(|k| influence(apart(k / n, k % n))).collect();
    let form = move |one: &[f64], two: &[f64]| {
        let at = |i: usize, j: usize| {
            let [xx, yy, xy] = dense[i * n + j];
            one[i] * (xx * two[j] + xy * two[n + j]) + one[n + i] * (xy * two[j] + yy * two[n + j])
        };
        side * side * (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| at(i, j)).sum::<f64>()
    };
    let (mut body, mut dissipated) = (Past::new(&relaxation, 2 * n), 0.0);
    let force = 0.05;
    let pressed = |t: f64| if is_pressed { Load::force(force * (1.0 + 0.2 * t)) } else { Load::approach(0.06) };
    let (dt, mut largest) = (4.0 / f64::from(steps), 0.0f64);
    let (mut outside, mut last) = (0.0, [[0.0; 3]; 2]);
    for step in 0..=steps {
        let t = f64::from(step) * dt;
        // a relaxing contact carries less and less
        let carried = if is_pressed { force } else { 0.4 * force * (0.3 + 0.7 * (-t).exp()) };
        let [q1, q2] = [0.8 * (1.5 * t + 0.2).sin(), 0.3 * (3.0 * t).sin()].map(|part| 0.35 * carried * part);
        let length = if step == 0 { 0.0 } else { dt };
        holds(contact.step(length, pressed(t), ShearLoad::force([q1, q2]).with_torque(0.1 * q1)).unwrap());
        let (c, free) = relaxation.step(length, &body);
        let traction = contact.traction().concat();
        let moved: Vec<f64> = free.iter().zip(traction).map(|(free, traction)| free + c * traction).collect();
        dissipated += relaxation.dissipated(length, &body, &moved, &form);
        relaxation.commit(length, &mut body, moved);
        let (work, stored) = (contact.lateral_work(), relaxation.stored(&body, &form));
        largest = largest.max(work.stored);
        assert!((work.stored - stored).abs() < 1e-9 * largest, "{step}: {} {stored}", work.stored);
        assert_eq!(work.work - work.slip - work.stored, work.creep);
        let now = [contact.force(), contact.motion()];
        let of_step: f64 = (0..3).map(|k| 0.5 * (last[0][k] + now[0][k]) * (now[1][k] - last[1][k])).sum();
        // the cells of a jump are met one after the other while the force rises
        (outside, last) = (if step == 0 { work.work } else { outside + of_step }, now);
    }
    let work = contact.lateral_work();
    [work.work, work.slip, work.creep, work.creep - dissipated, work.work - outside]
}

/// A cylinder on a body of one relaxation time that is pressed and sheared to and fro by forces: on cells and on states,
/// whose losses are found in other ways.
#[test]
fn energies_in_space_are_those_on_states() {
    let (grid, material) = (Grid::new([192, 1], [1.0, 1.0]).unwrap(), pair(&relaxation(0), 0.5));
    let shape = FnGeometry::new(|x, _| 2.0 * x * x);
    let kernel = InfluenceKernel::line(&grid, 3.0).unwrap();
    let force = 0.05;
    let states = Sweep::new(grid.clone(), &shape).kernel(kernel.clone()).run(Reach::Level(8.0 * force)).unwrap();
    // with more steps and cells, what is between the states of the sweep is left, 1 % of the slip
    for (steps, most) in [(16, 5e-4), (64, 2e-4)] {
        let scene = ViscoelasticContact::builder(grid.clone()).geometry(&shape).material(material.clone());
        let scene = scene.kernel(kernel.clone()).settings(tight());
        let mut space = FrictionContact::new(scene, Coulomb::new(0.5).unwrap()).unwrap();
        let mut levels = StatesContact::new(&states, &material).unwrap().with_friction(0.5).unwrap();
        let mut energies = [[0.0; 4]; 2];
        for step in 0..=steps {
            let phase = 3.0 * f64::from(step) / f64::from(steps);
            let (dt, pressed) = (if step == 0 { 0.0 } else { 3.0 / f64::from(steps) }, force * (1.0 + 0.3 * phase));
            let along = 0.3 * force * (2.5 * phase + 0.1).sin();
            holds(space.step(dt, Load::force(pressed), ShearLoad::force([along, 0.0])).unwrap());
            levels.step_sheared(dt, Load::force(pressed), Load::force(along)).unwrap();
            energies = [space.lateral_work(), levels.lateral_work()]
                .map(|LateralWork { work, slip, stored, creep, .. }| [work, slip, stored, creep]);
        }
        let [by_cells, by_levels] = energies;
        let off = (0..4).map(|k| (by_cells[k] - by_levels[k]).abs() / by_cells[0]).fold(0.0, f64::max);
        println!("{steps}: {by_cells:?} {by_levels:?} {off:.1e}");
        assert!(off < most);
    }
}

#[test]
fn work_is_stored_or_lost_by_slip_and_by_creep() {
    for (is_periodic, is_pressed) in [(false, false), (false, true), (true, false), (true, true)] {
        let found = STEPS.map(|steps| balance(is_periodic, is_pressed, steps));
        for ([work, slip, creep, off, outside], steps) in found.iter().zip(STEPS) {
            let off = off / work;
            println!(
                "{is_periodic} {is_pressed} {steps}: {work:.4e} {slip:.3e} {creep:.3e} {off:.1e} {:.2e}",
                outside / work
            );
            assert!(*slip > 0.02 * work && *creep > 0.3 * work && off.abs() < 1e-9);
            assert!(outside.abs() < 8.0 * work / f64::from(steps * steps));
        }
        let ratio = found[0][4] / found[2][4];
        assert!(ratio > 12.0, "{is_periodic} {is_pressed}: {ratio}");
    }
}

/// To and fro at once: what slips carries its bound while it does, however far it goes. Without ν every step on the way
/// slips in one direction.
#[test]
fn losses_at_once_do_not_depend_on_steps_in_space() {
    for (nu, most) in [(0.0, 1e-8), (0.3, 2e-3)] {
        let works = [1, 30].map(|parts: u32| {
            let scene = ViscoelasticContact::builder(Grid::square(24, 1.0).unwrap()).settings(tight());
            let scene = scene.geometry(&Sphere::new(1.0).unwrap()).material(pair(&relaxation(0), nu));
            let (mut contact, mut from) = (FrictionContact::new(scene, Coulomb::new(0.5).unwrap()).unwrap(), 0.0);
            let (force, mut works) = (0.05, Vec::new());
            holds(contact.step(0.0, Load::force(force), ShearLoad::force([0.0; 2])).unwrap());
            for to in [0.8, -0.5, 0.6].map(|part| 0.5 * force * part) {
                for k in 1..=parts {
                    let along = from + (to - from) * f64::from(k) / f64::from(parts);
                    holds(contact.step(0.0, Load::force(force), ShearLoad::force([along, 0.0])).unwrap());
                }
                from = to;
                let LateralWork { work, slip, creep, .. } = contact.lateral_work();
                assert!(creep.abs() < 1e-9 * work, "{creep} of {work} in no time");
                works.push([work, slip]);
            }
            works
        });
        for (one, many) in works[0].iter().flatten().zip(works[1].iter().flatten()) {
            println!("{nu}: {one:.6e} {many:.6e} {:.1e}", one / many - 1.0);
            assert!((one / many - 1.0).abs() < most);
        }
    }
}
