//! Chains of three steady motions of one contact over all bodies: each state fulfils its contact problem with influences that share no code with the crate, resists
//! with the drag of these, and is the state of a contact that is built anew. `SLIDING_CHAINS` (40) random chains, `SLIDING_SEED` (1), `SLIDING_ONLY` one of them.

use std::f64::consts::TAU;

use crate::common::moving_bodies::{Base, Bodies, Creep, Influence, check_bessel_functions};
use crate::common::{Draws, Ratios, builder_of, from_environment};
use viscocontact::load::Tilt;
use viscocontact::prelude::*;
use viscocontact::sliding::SlidingReport;

/// C(0) of the bodies, about.
const GLASSY: f64 = 1e-6;

#[derive(Debug, Clone)]
struct Scene {
    bodies: Bodies,
    waves: Vec<[f64; 4]>,
    radius: f64,
    /// Center and radius of a hole in the surface of the indenter.
    hole: Option<[f64; 3]>,
    /// A face without waves and ball.
    flat: bool,
    tolerance: f64,
    edge: Edge,
    states: Vec<([f64; 2], Load)>,
}

fn draw_creep(draws: &mut Draws, periodic: bool) -> Creep {
    let count = if periodic || draws.chance(0.1) { 1 + draws.below(12) } else { 1 + draws.below(3) };
    let fold = draws.scale(0.1, 1e5) / count as f64;
    let terms = (0..count).map(|_| (fold * draws.scale(0.3, 3.0) * GLASSY, draws.power_of_ten(-7.5, 7.5))).collect();
    Creep { glassy: GLASSY, terms }
}

impl Scene {
    fn draw(draws: &mut Draws, number: usize) -> Scene {
        let periodic = [[true, true], [false, false], [false, true], [true, false], [false, true]][number % 5];
        let line = number % 5 == 4;
        let count = |draws: &mut Draws, periodic: bool| if periodic { 2 + draws.below(15) } else { 6 + draws.below(7) };
        let cells = match (periodic, line) {
            (_, true) => [12 + draws.below(30), 1],
            ([true, true], _) => [count(draws, true), count(draws, true)],
            _ => [0, 1].map(|axis| if periodic[axis] { 4 + draws.below(5) } else { count(draws, false) }),
        };
        let spacing = [draws.between(0.7, 1.4), draws.between(0.7, 1.4)];
        let creep = draw_creep(draws, periodic == [true; 2]);
        let is_soft = draws.chance(0.3);
        let base = match draws.below(if number.is_multiple_of(2) { 1 } else { 5 }) {
            0 => Base::None,
            1 => Base::Rigid,
            2 => Base::Frictionless,
            _ if is_soft => Base::Body(draws.scale(1.0, 5.0)),
            _ => Base::Body(draws.scale(0.05, 1.0)),
        };
        let bodies = Bodies {
            periodic,
            cells,
            spacing,
            creep,
            nu: if draws.chance(0.5) { 0.5 } else { draws.between(0.1, 0.49) },
            base,
            base_nu: draws.between(0.1, 0.5),
            thickness: draws.scale(2.0, 30.0),
            datum: 1e4,
            as_line: line && (number / 10).is_multiple_of(2),
        };
        let wave = |draws: &mut Draws| {
            let number = |draws: &mut Draws, axis: usize| if cells[axis] == 1 { 0.0 } else { draws.below(4) as f64 };
            [number(draws, 0), number(draws, 1), draws.between(0.0, TAU), 1e-2 * draws.between(0.1, 1.0)]
        };
        let mut waves: Vec<_> = (0..4).map(|_| wave(draws)).collect();
        waves[0][0] = 1.0;
        let lengths = bodies.lengths();
        let hole = (!line && draws.chance(0.15)).then(|| {
            [
                draws.between(-0.4, 0.4) * lengths[0],
                draws.between(-0.4, 0.4) * lengths[1],
                0.2 * lengths[0].min(lengths[1]),
            ]
        });
        let mut scene = Scene {
            bodies,
            waves,
            radius: draws.scale(20.0, 400.0) * lengths[0] / 20.0,
            hole,
            flat: periodic == [false; 2] && draws.chance(0.1),
            tolerance: draws.power_of_ten(-9.0, -4.0),
            edge: if draws.chance(0.5) { Edge::Allow } else { Edge::Refuse },
            states: Vec::new(),
        };
        scene.states = (0..3).map(|_| scene.draw_state(draws)).collect();
        scene
    }

    fn draw_state(&self, draws: &mut Draws) -> ([f64; 2], Load) {
        let Bodies { periodic, cells, creep, .. } = &self.bodies;
        let lengths = self.bodies.lengths();
        let speed = if draws.chance(0.05) { 0.0 } else { draws.power_of_ten(-7.5, 7.5) };
        let sign = if draws.chance(0.5) { 1.0 } else { -1.0 };
        let velocity = if *periodic == [true; 2] {
            let angle = if draws.chance(0.3) { 0.25 * TAU * draws.below(4) as f64 } else { draws.between(0.0, TAU) };
            [speed * angle.cos(), speed * angle.sin()]
        } else if draws.chance(0.5) {
            [sign * speed, 0.0]
        } else {
            [0.0, sign * speed]
        };
        let tilt = [0, 1].map(|axis| {
            if periodic[axis] || cells[axis] == 1 || draws.chance(0.6) {
                return Tilt::Fixed(0.0);
            }
            let at = draws.between(-0.3, 0.3) * lengths[axis];
            if draws.chance(0.3) { Tilt::Fixed(1e-3 * at / lengths[axis]) } else { Tilt::Free { at } }
        });
        let gap = self.gap();
        let finite = || gap.iter().copied().filter(|gap| gap.is_finite());
        let [low, high] = [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)];
        let height = (high - low).max(1e-3);
        let part = draws.scale(1e-6, 1.0);
        let load = if draws.chance(0.6) {
            let soft = draws.scale(creep.glassy, creep.relaxed());
            Load::Force { normal: part * height / (2.0 * soft) * lengths[0].min(lengths[1]), tilt }
        } else {
            Load::Approach { approach: low + height * draws.scale(1e-3, 0.9), tilt }
        };
        (velocity, load)
    }

    fn gap_at(&self, x1: f64, x2: f64) -> f64 {
        let (x, lengths) = ([x1, x2], self.bodies.lengths());
        if self.hole.is_some_and(|[a, b, radius]| (x1 - a).hypot(x2 - b) < radius) {
            return f64::INFINITY;
        }
        if self.flat {
            return if x1.hypot(x2) < 0.4 * lengths[0].min(lengths[1]) { 0.0 } else { f64::INFINITY };
        }
        let damped = if self.bodies.periodic == [true; 2] { 1.0 } else { 0.1 };
        let wave = |[a, b, phase, h]: &[f64; 4]| {
            damped * h * (1.0 - (TAU * (a * x1 / lengths[0] + b * x2 / lengths[1]) + phase).cos())
        };
        let ball = (0..2).filter(|&k| !self.bodies.periodic[k]).map(|k| x[k] * x[k] / (2.0 * self.radius)).sum::<f64>();
        self.waves.iter().map(wave).sum::<f64>() + ball
    }

    fn gap(&self) -> Vec<f64> {
        let (grid, [n1, n2]) = (self.bodies.grid(), self.bodies.cells);
        let cells = (0..n1 * n2).map(|k| grid.center(k / n2, k % n2));
        cells.map(|[x1, x2]| self.gap_at(x1, x2)).collect()
    }

    fn build(&self) -> SteadySliding {
        let (scene, bodies) = (self.clone(), &self.bodies);
        let shape = FnGeometry::new(move |x1: f64, x2: f64| scene.gap_at(x1, x2));
        let settings = Settings::default().with_tolerance(self.tolerance).with_edge(self.edge);
        let builder = builder_of(&shape, bodies.grid(), bodies.creep.material(bodies.nu)).kernel(bodies.kernel());
        builder.settings(settings).build_sliding().unwrap()
    }
}

/// How far a state is from the contact problem of all influences together, in tolerances, and its drag from the sum of theirs.
#[derive(Debug, Default)]
pub(super) struct Errors {
    pub(super) gap: f64,
    pub(super) penetration: f64,
    balance: f64,
    pub(super) drag: f64,
    /// The length by which gaps are measured.
    unit: f64,
}

pub(super) fn errors(
    influences: &[Influence],
    gap: &[f64],
    load: Load,
    sliding: &SteadySliding,
    report: &SlidingReport,
) -> Errors {
    let contact = sliding.fields();
    let (p, grid, tolerance) = (contact.pressure(), contact.grid(), contact.settings().tolerance());
    let n2 = grid.cells()[1];
    assert!(p.iter().all(|p| *p >= 0.0));
    let each: Vec<Vec<f64>> = influences.iter().map(|own| own.displacement(p)).collect();
    let u: Vec<f64> = (0..p.len()).map(|k| each.iter().map(|own| own[k]).sum()).collect();
    let tilt = contact.tilt();
    let center = |k: usize| grid.center(k / n2, k % n2);
    let height = |k: usize| u[k] + gap[k] - report.approach - tilt[0] * center(k)[0] - tilt[1] * center(k)[1];
    let on: Vec<usize> = (0..p.len()).filter(|&k| p[k] > 0.0).collect();
    let range = |values: &[f64]| {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min)
    };
    let (force, tilts) = match load {
        Load::Force { normal, tilt } => (Some(normal), tilt),
        Load::Approach { tilt, .. } => (None, tilt),
        _ => unreachable!(),
    };
    // the gap that the contact closes, less the free motions that fit it best
    let free = |axis: usize| matches!(tilts[axis], Tilt::Free { .. });
    let mut modes: Vec<Vec<f64>> = Vec::new();
    let prescribed = |k: usize| match load {
        Load::Approach { approach, .. } => {
            let fixed = [0, 1].map(|axis| if free(axis) { 0.0 } else { tilt[axis] });
            approach + fixed[0] * center(k)[0] + fixed[1] * center(k)[1]
        }
        _ => (0..2).filter(|&axis| !free(axis)).map(|axis| tilt[axis] * center(k)[axis]).sum(),
    };
    let mut closed: Vec<f64> = on.iter().map(|&k| gap[k] - prescribed(k)).collect();
    let candidates = [force.is_some(), free(0), free(1)];
    for (mode, _) in candidates.iter().enumerate().filter(|(_, free)| **free) {
        let point = if let Tilt::Free { at } = tilts[mode.max(1) - 1] { at } else { 0.0 };
        let mut own: Vec<f64> = on.iter().map(|&k| if mode == 0 { 1.0 } else { center(k)[mode - 1] - point }).collect();
        let scale = own.iter().map(|v| v * v).sum::<f64>();
        let project = |own: &mut Vec<f64>, other: &Vec<f64>| {
            let part: f64 = own.iter().zip(other).map(|(a, b)| a * b).sum();
            own.iter_mut().zip(other).for_each(|(a, b)| *a -= part * b);
        };
        modes.iter().for_each(|other| project(&mut own, other));
        let norm = own.iter().map(|v| v * v).sum::<f64>();
        if norm > 1e-10 * scale {
            own.iter_mut().for_each(|v| *v /= norm.sqrt());
            project(&mut closed, &own);
            modes.push(own);
        }
    }
    let rms = |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt();
    let unit = rms(&closed).max(1e-4 * range(gap)).max(1e-4 * range(&u));
    // the influences are right to so many digits of the displacement, which may exceed all gaps
    let digits = 1e-11 * u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    let per = |value: f64| (value - digits).max(0.0) / unit / tolerance;
    let outside = (0..p.len()).filter(|&k| p[k] == 0.0).map(|k| -height(k)).fold(0.0, f64::max);
    let sum = |of: &dyn Fn(usize) -> f64| on.iter().map(|&k| p[k] * of(k)).sum::<f64>();
    let mut balance: f64 = 0.0;
    let area = grid.cell_area();
    if let Some(force) = force {
        balance = (sum(&|_| area) / force - 1.0).abs();
    }
    for (axis, tilt) in tilts.iter().enumerate() {
        if let Tilt::Free { at } = tilt {
            let [moment, size] = [sum(&|k| center(k)[axis] - at), sum(&|k| (center(k)[axis] - at).abs())];
            balance = balance.max(if size > 0.0 { (moment / size).abs() } else { 0.0 });
        }
    }
    if force.is_none() {
        let at: f64 = (0..2).map(|axis| if let Tilt::Free { at } = tilts[axis] { at * tilt[axis] } else { 0.0 }).sum();
        let Load::Approach { approach, .. } = load else { unreachable!() };
        balance = balance.max((report.approach + at - approach).abs() / range(gap).max(1e-3));
    }
    let drags = influences.iter().map(|own| own.drag(p).map(|own| own * area));
    let drag = drags.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
    let most = drag[0].abs().max(drag[1].abs());
    let differ = (0..2).map(|axis| (drag[axis] - report.lateral_force[axis]).abs()).fold(0.0, f64::max);
    // of rows that press alike all along a period nothing is left
    let rounding = influences.iter().map(|own| own.rounding_of_drag(p) * area).sum();
    Errors {
        gap: per(rms(&on.iter().map(|&k| height(k)).collect::<Vec<_>>())),
        penetration: per(outside),
        balance: balance / tolerance,
        drag: if differ > rounding { differ / most } else { 0.0 },
        unit,
    }
}

#[test]
fn states_are_those_of_their_problem_whatever_came_before() {
    check_bessel_functions();
    let (chains, seed) = (from_environment("SLIDING_CHAINS", 16), from_environment("SLIDING_SEED", 1));
    let only = from_environment("SLIDING_ONLY", u64::MAX);
    let mut all: [Ratios; 6] = Default::default();
    let (mut failures, mut refused, mut infeasible, mut strong) = (Vec::new(), [0; 2], 0, [0; 2]);
    for number in 0..chains {
        if only != u64::MAX && only != number {
            continue;
        }
        let scene = Scene::draw(&mut Draws::new(9_000_000 * seed + number), number as usize);
        let fold = scene.bodies.creep.relaxed() / scene.bodies.creep.glassy;
        let mut chain = scene.build();
        for (place, &(velocity, load)) in scene.states.iter().enumerate() {
            let name = format!("{number}.{place}");
            let found = chain.at(velocity, load);
            let mut anew = scene.build();
            let fresh = anew.at(velocity, load);
            let not_found = |error: &Error| ["sliding_not_converged", "sliding_rounding"].contains(&error.code());
            strong[usize::from(fold > 1e3)] += 1;
            let (report, fresh) = match (found, fresh) {
                (Ok(found), Ok(fresh)) => (found, fresh),
                (Err(a), Err(b)) if !not_found(&a) && !not_found(&b) => {
                    infeasible += 1;
                    continue;
                }
                (a, b) => {
                    refused[usize::from(fold > 1e3)] += 1;
                    let text = |own: viscocontact::Result<SlidingReport>| {
                        own.map_or_else(|e| e.to_string(), |r| r.to_string())
                    };
                    println!(
                        "refused {name}: fold {fold:.1e}, {velocity:?} {load}: {:.110} | {:.110}",
                        text(a),
                        text(b)
                    );
                    continue;
                }
            };
            let influences = [scene.bodies.influence(velocity)];
            let own = errors(&influences, &scene.gap(), load, &chain, &report);
            // two states within ε of their problem differ by d with d·A d ≤ ε (Σ p + Σ p′)
            let differ: Vec<f64> =
                chain.fields().pressure().iter().zip(anew.fields().pressure()).map(|(a, b)| a - b).collect();
            let energy: f64 = influences[0].displacement(&differ).iter().zip(&differ).map(|(u, p)| u * p).sum();
            let sums: f64 = [&chain, &anew].map(|own| own.fields().pressure().iter().sum::<f64>()).iter().sum();
            let same = if sums > 0.0 { energy / (sums * own.unit * scene.tolerance) } else { 0.0 };
            let force = if report.force == fresh.force {
                0.0
            } else {
                (report.force / fresh.force - 1.0).abs() / scene.tolerance
            };
            let energies = [0, 1].map(|axis| report.velocity[axis] * report.lateral_force[axis]);
            assert!(energies[0] + energies[1] >= 0.0, "{name}: {report:?}");
            let measures = [own.gap, own.penetration, own.balance, own.drag * 1e6, same, force];
            for (measure, list) in measures.iter().zip(&mut all) {
                list.push(*measure, &name);
            }
            let limits = [3.0, 3.0, 3.0, 1.0, 3.0, f64::INFINITY];
            if measures.iter().zip(limits).any(|(measure, limit)| *measure > limit) {
                println!(
                    "FAIL {name}: {measures:?} fold {fold:.1e} flat {} {:?} {velocity:?} {load} {report} residual {:e} tol {:e} | anew {fresh}",
                    scene.flat, scene.bodies.base, report.residual, scene.tolerance
                );
                failures.push(name);
            }
        }
    }
    for (list, what) in all.iter().zip(["gap", "penetration", "balance", "drag", "chain and anew", "force of them"]) {
        list.print(what, 2);
    }
    println!("{} compared, {infeasible} infeasible, refused {refused:?} of {strong:?}", all[0].count());
    assert!(failures.is_empty(), "{failures:?}");
    assert!(refused[0] == 0 && 100 * refused[1] <= strong[1], "{refused:?}");
    assert!(only != u64::MAX || 2 * all[0].count() as u64 > chains, "{}", all[0].count());
}
