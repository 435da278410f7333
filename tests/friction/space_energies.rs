//! Where the work along the surface goes, against the springs and dashpots of a dense body.

use viscocontact::friction::{Coulomb, FrictionContact, LateralWork, ShearLoad};
use viscocontact::prelude::*;
use viscocontact::states::{Reach, StatesContact, Sweep};

use super::dense::relaxation;
use super::space::{half_space, pair, periodic};
use super::space_known::{holds, tight};

const N: usize = 12;
const STEPS: [u32; 3] = [32, 64, 128];

/// τ K τ′ of tractions whose components follow each other.
type Form = Box<dyn Fn(&[f64], &[f64]) -> f64>;

/// A spring E∞ beside a spring E1 in series with a dashpot E1 τ, in each cell: they carry E∞ U and q of the tractions.
struct Maxwell {
    form: Form,
    moduli: [f64; 2],
    time: f64,
    displacement: Vec<f64>,
    stress: Vec<f64>,
    dissipated: f64,
}

impl Maxwell {
    fn stored(&self) -> f64 {
        let Maxwell { form, moduli, displacement, stress, .. } = self;
        0.5 * (moduli[0] * form(displacement, displacement) + form(stress, stress) / moduli[1])
    }

    /// To these tractions, with U linear in time: q′ = E1 U′ − q/τ has q = a + b exp(−s/τ), whose square is integrated.
    fn step(&mut self, dt: f64, traction: &[f64]) {
        let Maxwell { form, moduli: [rest, more], time, displacement, stress, dissipated } = self;
        let (time, decay) = (*time, (-dt / *time).exp());
        let answer = if dt > 0.0 { *more * time * (1.0 - decay) / dt } else { *more };
        let (mut a, mut b) = (vec![0.0; stress.len()], vec![0.0; stress.len()]);
        for (k, now) in traction.iter().enumerate() {
            let change = (now - *rest * displacement[k] - decay * stress[k]) / (*rest + answer);
            displacement[k] += change;
            if dt > 0.0 {
                a[k] = *more * time * change / dt;
                b[k] = stress[k] - a[k];
            }
            stress[k] = decay * stress[k] + answer * change;
        }
        let integrals = [dt, 2.0 * time * (1.0 - decay), 0.5 * time * (1.0 - decay * decay)];
        let squares = [form(&a, &a), form(&a, &b), form(&b, &b)];
        *dissipated += integrals.iter().zip(squares).map(|(of, square)| of * square).sum::<f64>() / (*more * time);
    }
}

/// A ball on a body of one relaxation time, pressed and sheared at once, then sheared and turned in so many steps: work,
/// loss by slip, creep, and what it has beyond that of the dashpots.
fn balance(is_periodic: bool, is_pressed: bool, steps: u32) -> [f64; 4] {
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
    let (terms, zero) = (relaxation.terms[0], || vec![0.0; 2 * n]);
    let moduli = [relaxation.equilibrium, terms.0];
    let mut body =
        Maxwell { form: Box::new(form), moduli, time: terms.1, displacement: zero(), stress: zero(), dissipated: 0.0 };
    let force = 0.05;
    let pressed = |t: f64| if is_pressed { Load::force(force * (1.0 + 0.2 * t)) } else { Load::approach(0.06) };
    let (dt, mut largest) = (4.0 / f64::from(steps), 0.0f64);
    for step in 0..=steps {
        let t = f64::from(step) * dt;
        // a relaxing contact carries less and less
        let carried = if is_pressed { force } else { 0.4 * force * (0.3 + 0.7 * (-t).exp()) };
        let [q1, q2] = [0.8 * (1.5 * t + 0.2).sin(), 0.3 * (3.0 * t).sin()].map(|part| 0.35 * carried * part);
        let length = if step == 0 { 0.0 } else { dt };
        holds(contact.step(length, pressed(t), ShearLoad::force([q1, q2]).with_torque(0.1 * q1)).unwrap());
        body.step(length, &contact.traction().concat());
        let work = contact.lateral_work();
        largest = largest.max(work.stored);
        assert!((work.stored - body.stored()).abs() < 1e-9 * largest, "{step}: {} {}", work.stored, body.stored());
        assert_eq!(work.work - work.slip - work.stored, work.creep);
    }
    let work = contact.lateral_work();
    [work.work, work.slip, work.creep, work.creep - body.dissipated]
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
    let mut last = f64::INFINITY;
    for steps in [16, 64] {
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
        assert!(off < 0.4 * last);
        last = off;
    }
    assert!(last < 2e-3);
}

#[test]
fn work_is_stored_or_lost_by_slip_and_by_creep() {
    for (is_periodic, is_pressed) in [(false, false), (false, true), (true, false), (true, true)] {
        let found = STEPS.map(|steps| balance(is_periodic, is_pressed, steps));
        for ([work, slip, creep, off], steps) in found.iter().zip(STEPS) {
            println!("{is_periodic} {is_pressed} {steps}: {work:.4e} {slip:.3e} {creep:.3e} {:.2e}", off / work);
            assert!(*slip > 0.02 * work && *creep > 0.3 * work && off.abs() < 8.0 * work / f64::from(steps * steps));
        }
        for pair in found.windows(2) {
            let ratio = pair[0][3] / pair[1][3];
            assert!((3.6..4.4).contains(&ratio), "{is_periodic} {is_pressed}: {ratio}");
        }
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
