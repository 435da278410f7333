//! Friction in space against the conditions of Coulomb's law on dense bodies, which have one solution.

use std::f64::consts::PI;

use viscocontact::friction::{Component, Coulomb, FrictionContact, FrictionLimit, Lesser, Outcome, ShearLoad, Tresca};
use viscocontact::prelude::*;

use super::bodies::{Past, Relaxation};
use super::dense::relaxation;
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use crate::common::fields::gap;

/// Influences of one cell on another: xx, yy, xy.
pub type Influence = Box<dyn Fn([isize; 2]) -> [f64; 3]>;

/// Differences of corner functions, of a contact compliance 1.
pub fn half_space(side: f64, nu: f64) -> Influence {
    Box::new(move |at| {
        let [x, y] = at.map(|k| k as f64 * side);
        let r = f64::hypot;
        let log = |a: f64, b: f64| if a == 0.0 { 0.0 } else { a * (b + r(a, b)).ln() };
        let functions: [&dyn Fn(f64, f64) -> f64; 3] =
            [&|x, y| (1.0 - nu) * log(x, y) + log(y, x), &|x, y| (1.0 - nu) * log(y, x) + log(x, y), &|x, y| {
                -nu * r(x, y)
            }];
        let h = 0.5 * side;
        functions.map(|f| (f(x + h, y + h) - f(x + h, y - h) - f(x - h, y + h) + f(x - h, y - h)) / (PI * (1.0 - nu)))
    })
}

/// Sums of waves of a period of n cells.
pub fn periodic(n: usize, side: f64, nu: f64) -> Influence {
    let number = |k: usize| if 2 * k > n { k as f64 - n as f64 } else { k as f64 };
    let mut waves = Vec::new();
    for (k1, k2) in (0..n).flat_map(|k1| (0..n).map(move |k2| (k1, k2))).skip(1) {
        let q = [k1, k2].map(|k| 2.0 * PI * number(k) / (n as f64 * side));
        let size = q[0].hypot(q[1]);
        let shortest = 2 * k1 == n || 2 * k2 == n;
        let part = |a: usize, b: usize| nu * q[a] * q[b] / (size * size);
        let scale = 2.0 / (size * (1.0 - nu) * (n * n) as f64);
        let xy = if shortest { 0.0 } else { -part(0, 1) };
        waves.push((q, [1.0 - part(0, 0), 1.0 - part(1, 1), xy].map(|value| scale * value)));
    }
    Box::new(move |at| {
        let [x, y] = at.map(|k| k as f64 * side);
        waves.iter().fold([0.0; 3], |sum, (q, values)| {
            let wave = (q[0] * x + q[1] * y).cos();
            [0, 1, 2].map(|k| sum[k] + wave * values[k])
        })
    })
}

pub fn pair(Relaxation { equilibrium, terms }: &Relaxation, nu: f64) -> Material {
    let terms: Vec<_> = terms.iter().map(|&(modulus, time)| ((1.0 - nu) * modulus, time)).collect();
    let model = GeneralizedMaxwell::new((1.0 - nu) * equilibrium, &terms).unwrap();
    let body = || Material::constant_poisson(model.clone(), nu).unwrap();
    body().against(body())
}

#[derive(Debug, Clone, Copy)]
enum Law {
    Coulomb(f64),
    Tresca(f64),
    Lesser(f64, f64),
}

impl FrictionLimit for Law {
    fn limit(&self, p: f64) -> f64 {
        match *self {
            Law::Coulomb(f) => Coulomb::new(f).unwrap().limit(p),
            Law::Tresca(strength) => Tresca::new(strength).unwrap().limit(p),
            Law::Lesser(f, strength) => Lesser(Coulomb::new(f).unwrap(), Tresca::new(strength).unwrap()).limit(p),
        }
    }
}

pub struct Scene {
    pub contact: FrictionContact,
    law: Law,
    relaxation: Relaxation,
    influence: Influence,
    n: usize,
    force: f64,
}

impl Scene {
    pub fn new(seed: u64, n: usize, tolerance: f64) -> Scene {
        let draws = &mut Draws::new(seed);
        let nu = [0.0, 0.3, 0.5][draws.below(3)];
        let (is_periodic, relaxation) = (draws.chance(0.4), relaxation(draws.below(3)));
        let side = 1.0 / n as f64;
        let grid = Grid::square(n, 1.0).unwrap();
        let modes: Vec<[f64; 4]> = (0..24)
            .map(|_| {
                let k = [0, 1].map(|_| 1.0 + draws.below(n / 3) as f64);
                let height = (k[0] * k[0] + k[1] * k[1]).powf(-0.9) * draws.between(0.0, 1.0);
                [2.0 * PI * k[0], 2.0 * PI * k[1], height, draws.between(0.0, 2.0 * PI)]
            })
            .collect();
        let ([x0, y0], curved) = ([0, 1].map(|_| draws.between(-0.1, 0.1)), draws.between(0.5, 6.0));
        let rough = draws.between(0.05, 0.5);
        let height = move |x: f64, y: f64| {
            let waves = modes.iter().map(|[q1, q2, height, phase]| height * (q1 * x + phase).cos() * (q2 * y).cos());
            rough * waves.sum::<f64>() + if is_periodic { 0.0 } else { curved * ((x - x0).powi(2) + (y - y0).powi(2)) }
        };
        let lowest = (0..n * n)
            .map(|k| {
                let [x, y] = grid.center(k / n, k % n);
                height(x, y)
            })
            .fold(f64::INFINITY, f64::min);
        let shape = FnGeometry::new(move |x, y| height(x, y) - lowest);
        let mut builder = ViscoelasticContact::builder(grid.clone())
            .geometry(&shape)
            .material(pair(&relaxation, nu))
            .settings(Settings::default().with_tolerance(tolerance).with_edge(Edge::Allow));
        if is_periodic {
            builder = builder.kernel(InfluenceKernel::periodic(&grid).unwrap());
        }
        let f = draws.between(0.1, 1.2);
        let force = draws.scale(0.02, 0.5) * if is_periodic { 0.3 } else { 1.0 };
        let law = match draws.below(4) {
            0 => Law::Tresca(f * force * 3.0),
            1 => Law::Lesser(f, f * force * 5.0),
            _ => Law::Coulomb(f),
        };
        let influence = if is_periodic { periodic(n, side, nu) } else { half_space(side, nu) };
        Scene { contact: FrictionContact::new(builder, law).unwrap(), law, relaxation, influence, n, force }
    }

    pub fn name(&self) -> String {
        format!("{:?}, {}", self.law, self.contact.normal().grid().len())
    }

    /// Lengths of steps, forces, and what acts along the surface as a part of what friction carries about.
    pub fn steps(&self, draws: &mut Draws, count: usize) -> Vec<(f64, f64, [f64; 3], u8)> {
        let (mut angle, mut force, kind) = (draws.between(0.0, 2.0 * PI), self.force, draws.below(4) as u8);
        (0..count)
            .map(|k| {
                if k == 0 || draws.chance(0.4) {
                    force = self.force * draws.between(0.3, 1.5);
                }
                if k > 2 && draws.chance(0.05) {
                    force = 0.0;
                }
                angle += draws.between(-1.2, 1.2);
                let part = draws.between(0.0, 1.05);
                let dt = if k == 0 || draws.chance(0.15) { 0.0 } else { draws.power_of_ten(-2.0, 1.5) };
                (dt, force, [part * angle.cos(), part * angle.sin(), draws.between(-0.5, 0.5)], kind)
            })
            .collect()
    }

    /// The load along the surface: forces, forces and a torque, motions, or one of each.
    pub fn along(&self, force: f64, part: [f64; 3], kind: u8) -> ShearLoad {
        let capacity =
            self.law.limit(force.max(1e-3 * self.force)) * if let Law::Coulomb(_) = self.law { 1.0 } else { 0.2 };
        let [q1, q2, turn] = [capacity * part[0], capacity * part[1], 0.1 * capacity * part[2]];
        let far = 0.5 * self.law.limit(self.force);
        match kind {
            0 => ShearLoad::force([q1, q2]),
            1 => ShearLoad::force([0.6 * q1, 0.6 * q2]).with_torque(turn),
            2 => ShearLoad::motion([far * part[0], far * part[1]]).with_angle(far * part[2]),
            _ => {
                let mut load = ShearLoad::force([0.0, q2]);
                load.components[0] = Component::Motion(far * part[0]);
                load
            }
        }
    }
}

/// The bodies on dense matrices, and what they were.
struct Dense {
    matrix: Vec<Vec<f64>>,
    past: Past,
    motion: [f64; 3],
    pressed: Vec<bool>,
}

impl Dense {
    fn new(scene: &Scene) -> Dense {
        let n = scene.n;
        let cells = n * n;
        let entry = |row: usize, column: usize| {
            let [a, b] = [row % cells, column % cells];
            let at = [(a / n) as isize - (b / n) as isize, (a % n) as isize - (b % n) as isize];
            let [xx, yy, xy] = (scene.influence)(at);
            match (row < cells, column < cells) {
                (true, true) => xx,
                (false, false) => yy,
                _ => xy,
            }
        };
        let matrix = (0..2 * cells).map(|row| (0..2 * cells).map(|column| entry(row, column)).collect()).collect();
        Dense { matrix, past: Past::new(&scene.relaxation, 2 * cells), motion: [0.0; 3], pressed: vec![false; cells] }
    }
}

#[derive(Default, Debug, Clone, Copy)]
struct Worst {
    stick: f64,
    slip: f64,
    bound: f64,
    balance: f64,
    motion: f64,
    steps: usize,
    slides: usize,
    failed: usize,
}

/// By how much a step is off the law, relative to the displacement and the bounds.
fn check(seed: u64, n: usize, worst: &mut Worst) {
    let mut scene = Scene::new(seed, n, 1e-10);
    let steps = scene.steps(&mut Draws::new(seed + 50_000), 8);
    let mut dense = Dense::new(&scene);
    let (grid, area) = (scene.contact.normal().grid().clone(), scene.contact.normal().grid().cell_area());
    let cells = n * n;
    for (dt, force, part, kind) in steps {
        let normal = scene.contact.normal();
        let (gap, before) = (gap(normal.fields()), normal.approach());
        let load = scene.along(force, part, kind);
        let state = format!("{:?}", (scene.contact.motion(), scene.contact.force(), scene.contact.traction()));
        let outcome = match scene.contact.step(dt, Load::force(force), load) {
            Ok(outcome) => outcome,
            Err(error) => {
                println!("{seed}: {}, {load:?}: {error}", scene.name());
                worst.failed += 1;
                return;
            }
        };
        match outcome {
            Outcome::Holds(_) => {}
            Outcome::Slides { direction, over_limit } => {
                assert!(over_limit > 1.0);
                // the direction proves it, on the pressures of the contact without friction's part
                assert_eq!(
                    state,
                    format!("{:?}", (scene.contact.motion(), scene.contact.force(), scene.contact.traction()))
                );
                let mut trial = scene.contact.normal().clone();
                trial.step(dt, Load::force(force)).unwrap();
                let place = |k: usize| grid.center(k / n, k % n);
                let speed = |k: usize| {
                    let [x, y] = place(k);
                    (direction[0] - y * direction[2]).hypot(direction[1] + x * direction[2])
                };
                let bound = |p: f64| if p > 0.0 { scene.law.limit(p) } else { 0.0 };
                // what is met at the very end of the step is not moved
                let closed = trial.approach() - before;
                let is_moved = |k: usize| dense.pressed[k] || gap[k] < closed;
                let pressures = trial.pressure().iter().enumerate().filter(|(k, _)| is_moved(*k));
                let carried: f64 = pressures.map(|(k, p)| area * bound(*p) * speed(k)).sum();
                let asked: f64 = (0..3)
                    .map(|k| if let Component::Force(q) = load.components[k] { q * direction[k] } else { 0.0 })
                    .sum();
                let held = (0..3).all(|k| matches!(load.components[k], Component::Force(_)) || direction[k] == 0.0);
                assert!(asked > carried && held, "{seed}: {asked} {carried} {direction:?}");
                worst.slides += 1;
                continue;
            }
            _ => unreachable!(),
        }
        worst.steps += 1;
        let contact = &scene.contact;
        let (closed, pressure) = (contact.normal().approach() - before, contact.normal().pressure());
        let [t1, t2] = contact.traction();
        let [s1, s2] = contact.slip();
        let traction = [t1, t2].concat();
        let slip = [s1, s2].concat();
        let (c, free) = scene.relaxation.step(dt, &dense.past);
        let now: Vec<f64> = (0..2 * cells)
            .map(|k| free[k] + c * dense.matrix[k].iter().zip(&traction).map(|(k, t)| k * t).sum::<f64>())
            .collect();
        let moved: [f64; 3] = std::array::from_fn(|k| contact.motion()[k] - dense.motion[k]);
        let was_apart = dense.pressed.iter().all(|pressed| !pressed);
        let touched = if was_apart { gap.iter().fold(f64::INFINITY, |least, h| least.min(*h)) / closed } else { 0.0 };
        let touched = touched.clamp(0.0, 1.0);
        let far = now.iter().chain(&moved).fold(1e-300, |most: f64, u| most.max(u.abs()));
        let most = pressure.iter().fold(1e-300, |most: f64, p| most.max(scene.law.limit(*p)));
        let mut sums = [0.0; 3];
        for k in 0..cells {
            let [x, y] = grid.center(k / n, k % n);
            let closed = closed.max(f64::MIN_POSITIVE);
            let waited = if dense.pressed[k] {
                0.0
            } else {
                ((gap[k].max(0.0) / closed - touched) / (1.0 - touched)).clamp(0.0, 1.0)
            };
            let a = 1.0 - waited;
            let bound = if pressure[k] > 0.0 { scene.law.limit(pressure[k]) } else { 0.0 };
            let t = [traction[k], traction[cells + k]];
            for (sum, value) in sums.iter_mut().zip([t[0], t[1], x * t[1] - y * t[0]]) {
                *sum += area * value;
            }
            worst.bound = worst.bound.max((t[0].hypot(t[1]) - bound) / most);
            if bound == 0.0 {
                continue;
            }
            let body = [moved[0] - y * moved[2], moved[1] + x * moved[2]];
            let found = [0, 1].map(|axis| {
                let at = axis * cells + k;
                a * body[axis] - (now[at] - dense.past.now[at])
            });
            let off = (found[0] - slip[k]).hypot(found[1] - slip[cells + k]);
            worst.motion = worst.motion.max(off / far);
            if contact.sticks()[k] {
                worst.stick = worst.stick.max(found[0].hypot(found[1]) / far);
            } else {
                let size = t[0].hypot(t[1]);
                worst.bound = worst.bound.max((size - bound).abs() / most);
                let along = (found[0] * t[0] + found[1] * t[1]) / size;
                let beside = (found[0] * t[1] - found[1] * t[0]).abs() / size;
                worst.slip = worst.slip.max(beside.max(-along) / far);
            }
        }
        for (k, sum) in sums.into_iter().enumerate() {
            if let Component::Force(wanted) = load.components[k] {
                let scale = area * most * (pressure.iter().filter(|p| **p > 0.0).count() as f64).max(1.0);
                worst.balance = worst.balance.max((sum - wanted).abs() / scale);
            } else if let Component::Motion(to) = load.components[k] {
                assert!((contact.motion()[k] - to).abs() <= 1e-15 * to.abs());
            }
            assert!((contact.force()[k] - sum).abs() <= 1e-12 * (sum.abs() + area * most));
        }
        scene.relaxation.commit(dt, &mut dense.past, now);
        dense.motion = contact.motion();
        dense.pressed = pressure.iter().map(|p| *p > 0.0 && scene.law.limit(*p) > 0.0).collect();
    }
}

#[test]
fn steps_are_coulombs_law_on_dense_bodies() {
    let (scenes, first) = (from_environment("SPACE_SCENES", 12), from_environment("SPACE_FIRST", 0));
    let mut all = Worst::default();
    for seed in first..first + scenes {
        let mut worst = Worst::default();
        check(seed, 8 + seed as usize % 6, &mut worst);
        let off = worst.stick.max(worst.slip).max(worst.bound).max(worst.balance).max(worst.motion);
        if scenes < 20 || off > 1e-8 {
            println!("{seed}: {worst:?}");
        }
        for (all, own) in [
            (&mut all.stick, worst.stick),
            (&mut all.slip, worst.slip),
            (&mut all.bound, worst.bound),
            (&mut all.balance, worst.balance),
            (&mut all.motion, worst.motion),
        ] {
            *all = all.max(own);
        }
        all.steps += worst.steps;
        all.slides += worst.slides;
        all.failed += worst.failed;
    }
    println!("{scenes} scenes: {all:?}");
    assert_eq!(all.failed, 0);
    assert!(all.steps as u64 > 4 * scenes);
    assert!(all.stick < 1e-8 && all.slip < 1e-8 && all.bound < 1e-8 && all.balance < 1e-8 && all.motion < 1e-8);
}

/// Convolutions of pressures a warm step, in the median, at 90 % and at most; those of a step that starts cold.
#[test]
fn warm_steps_take_few_convolutions() {
    let (scenes, n) = (from_environment("SPACE_WARM", 6), from_environment("SPACE_CELLS", 32) as usize);
    let (mut warm, mut cold, mut newton, mut failed) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for seed in 0..scenes {
        let mut scene = Scene::new(1000 + seed, n, 1e-6);
        for (k, (dt, force, part, kind)) in scene.steps(&mut Draws::new(seed), 8).into_iter().enumerate() {
            let load = scene.along(force, part, kind);
            match scene.contact.step(dt, Load::force(force), load) {
                Ok(Outcome::Holds(report)) => {
                    let cost = report.convolution_equivalents;
                    if k == 0 {
                        cold.push(cost)
                    } else {
                        warm.push(cost)
                    }
                    newton.push(report.iterations as f64);
                }
                Ok(_) => {}
                Err(error) => {
                    println!("{seed} {} step {k}: {error}", scene.name());
                    failed += 1;
                }
            }
        }
    }
    let quantiles = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        [0.5, 0.9, 1.0].map(|q| values[((values.len() - 1) as f64 * q) as usize])
    };
    println!(
        "{scenes} scenes of {n}²: {failed} failed; warm {:?}, cold {:?}, Newton {:?}",
        quantiles(warm.clone()),
        quantiles(cold),
        quantiles(newton)
    );
    assert_eq!(failed, 0);
    assert!(quantiles(warm)[0] < 110.0);
}
