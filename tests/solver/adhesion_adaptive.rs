//! Adaptive steps of surfaces that attract each other, against many short steps of given length: random scenes through snap-in and pull-off.
//! `ADHESION_RUNS` (3) and `ADHESION_SEED` (1) choose others.

use std::sync::Arc;

use super::adhesion_population::{Drawn, SIDE, Scene};
use crate::common::draws::Draws;
use crate::common::environment::from_environment;
use viscocontact::adhesion::ExponentialAttraction;
use viscocontact::contact::Warnings;
use viscocontact::prelude::*;

const SPAN: f64 = 10.0;
const SHORT: f64 = 0.0025;
/// Loss of a great jump.
const GREAT: f64 = 0.05;
/// A jump's time, and that of a separation as fast, is known to so much of the run; the answer changes by so much in a short step.
const MOMENT: f64 = 1e-3;
const FAST: f64 = 5e-3;

struct History {
    name: String,
    scene: Scene,
    kind: usize,
    /// Times of the corners: pressed, held, pulled, held, pressed again, held.
    turns: [f64; 7],
    path: PiecewiseLinear,
}

impl History {
    fn draw(number: u64, seed: u64) -> History {
        let mut draws = Draws::new(1000 * seed + number);
        let scene = Scene::draw(
            &mut draws,
            &Drawn {
                side: SIDE,
                tabor: [0.3, 1.4],
                heights: [0.05, 0.3],
                waves: [3.0, 6.0],
                creeping: 1.0,
                periodic: 0.0,
            },
        );
        let (kind, stiffness) = (number as usize % 3, draws.scale(2.0, 30.0));
        let load = |at: f64| match kind {
            0 => Load::approach(at),
            1 => Load::spring(stiffness, at),
            _ => Load::force(if at > 0.0 { 5.0 * at } else { 0.4 * at }),
        };
        let [down, out, again] = [draws.between(0.3, 1.0), draws.between(-4.0, -2.0), draws.between(0.1, 0.6)];
        let at = [-1.0, down, down, out, out, again, again];
        let mut turns = [0.0; 7];
        for k in 1..7 {
            // multiples of the short steps
            turns[k] = turns[k - 1] + 0.01 * draws.between(30.0, 220.0).round();
        }
        let path: Vec<_> = turns.iter().zip(at).map(|(turn, at)| (*turn, load(at))).collect();
        let name = format!("scene {number}: {}, load {kind}", scene.name);
        History { name, scene, kind, turns, path: PiecewiseLinear::new(&path).unwrap() }
    }

    fn build(&self) -> ViscoelasticContact {
        self.scene.build(Settings::default())
    }

    /// What the load leaves free.
    fn answer(&self, report: &StepReport) -> f64 {
        if self.kind == 2 { report.approach } else { report.force }
    }

    fn is_held(&self, time: f64) -> bool {
        (0..3).any(|hold| time > self.turns[2 * hold + 1] && time <= self.turns[2 * hold + 2])
    }
}

/// What short steps of given length find.
struct Curve {
    points: Vec<(f64, f64)>,
    /// The greatest force, or the greatest change of the approach.
    scale: f64,
    /// Time and loss of great jumps.
    jumps: Vec<(f64, f64)>,
    /// Times at which the answer moves too fast for the short steps.
    fast: Vec<f64>,
}

impl Curve {
    fn of(scene: &History, short: f64) -> Curve {
        let (mut contact, end) = (scene.build(), scene.turns[6]);
        let (mut points, mut jumps, mut before) = (Vec::new(), Vec::new(), 0.0);
        let count = (end / short).round() as usize;
        for k in 0..=count {
            let time = end * k as f64 / count as f64;
            let report = contact.step(time - contact.time(), scene.path.at(time)).unwrap();
            let released = contact.passes().unwrap().released;
            // many times what is released before it: else fast creep leads into the jump
            let stands_out = released > GREAT.max(30.0 * std::mem::replace(&mut before, released.abs()));
            if report.warnings.contains(Warnings::JUMP) && stands_out {
                jumps.push((time, released));
            }
            points.push((time, scene.answer(&report)));
        }
        let [low, high] = [f64::min, f64::max].map(|of| points.iter().map(|point| point.1).reduce(of).unwrap());
        let scale = if scene.kind == 2 { high - low } else { high.max(-low) };
        let moves = points.windows(2).filter(|pair| (pair[1].1 - pair[0].1).abs() > FAST * scale);
        let fast = moves.map(|pair| pair[1].0).collect();
        Curve { points, scale, jumps, fast }
    }

    fn at(&self, time: f64) -> f64 {
        let after = self.points.partition_point(|point| point.0 < time).clamp(1, self.points.len() - 1);
        let [(t0, a0), (t1, a1)] = [self.points[after - 1], self.points[after]];
        a0 + (time - t0) / (t1 - t0) * (a1 - a0)
    }

    /// Errors of an answer: itself, and in answer or time.
    fn errors(&self, time: f64, answer: f64) -> [f64; 2] {
        let off = (self.at(time) - answer).abs() / self.scale;
        let span = self.points[self.points.len() - 1].0;
        let mut least = off;
        for pair in self.points.windows(2).filter(|pair| (pair[0].0 - time).abs() < 0.2 * span) {
            // a jump is a segment that rises at once: samples of it would miss answers next to it
            let [(t0, a0), (t1, a1)] = [pair[0], pair[1]];
            for share in [(time - t0) / (t1 - t0), if a0 == a1 { 0.0 } else { (answer - a0) / (a1 - a0) }] {
                let share = share.clamp(0.0, 1.0);
                let (t, a) = (t0 + share * (t1 - t0), a0 + share * (a1 - a0));
                least = least.min(((t - time).abs() / span).max((a - answer).abs() / self.scale));
            }
        }
        let is_fast = self.fast.iter().any(|at| (at - time).abs() < MOMENT * span);
        [if is_fast { least } else { off }, least]
    }
}

/// The answer, in itself while the load is held and else in answer or time, since a jump takes no time, is as exact as was asked: at the ends of
/// steps and within them. Every great jump is reported, with the energy that it loses; at its very moment a run to 1e-3 may err by more.
#[test]
fn adaptive_runs_follow_short_steps() {
    let [runs, seed, first] = [("ADHESION_RUNS", 8), ("ADHESION_SEED", 1), ("ADHESION_FIRST", 0)]
        .map(|(name, default)| from_environment(name, default));
    let (mut ratios, mut jumps, mut equivalents) = ([const { Vec::new() }; 2], 0, [0.0; 2]);
    for number in first..first + runs {
        let scene = History::draw(number, seed);
        let (mut curve, mut is_fine) = (Curve::of(&scene, SHORT), false);
        for (which, tolerance) in [1e-2, 1e-3].into_iter().enumerate() {
            let mut contact = scene.build();
            let span = scene.turns[6];
            let mut run = contact.follow(&scene.path, Stepping::adaptive(tolerance), span);
            let (mut found, mut steps, mut work) = (Vec::new(), 0, 0.0);
            let (mut looks, mut now) = (Vec::new(), 0.0);
            while let Some(report) = run.next_step().unwrap() {
                looks.push((report.time, scene.answer(&report)));
                for share in [0.3, 0.7] {
                    let time = now + share * (report.time - now);
                    if time > now && steps % 4 == 0 {
                        let within = run.within_step(time).unwrap();
                        looks.push((time, if scene.kind == 2 { within.approach() } else { within.force() }));
                    }
                }
                now = report.time;
                if report.warnings.contains(Warnings::JUMP) {
                    found.push((report.time, report.dt, run.contact().passes().unwrap().released));
                }
                (steps, work) = (steps + 1, work + report.convolution_equivalents());
            }
            // the greatest error over the tolerance, and the greatest before and after the moment of a jump
            let ratio = |curve: &Curve| {
                looks.iter().fold([0.0_f64; 2], |[all, smooth], &(time, answer)| {
                    let [off, either] = curve.errors(time, answer);
                    let ratio = (if scene.is_held(time) { off } else { either }) / tolerance;
                    let jumps = curve.jumps.iter().any(|(at, _)| (at - time).abs() < MOMENT * span);
                    [all.max(ratio), if jumps { smooth } else { smooth.max(ratio) }]
                })
            };
            let mut worst = ratio(&curve);
            if worst[0] > 1.0 || !curve.jumps.is_empty() && !is_fine {
                // the short steps may be too long, as for what a jump loses
                (curve, is_fine) = (Curve::of(&scene, 0.125 * SHORT), true);
                worst = ratio(&curve);
            }
            println!("{}, {tolerance}: {worst:.2?} tolerances, {steps} steps, {work} equivalents", scene.name);
            ratios[which].push(worst);
            equivalents[which] += work;
            for (time, released) in curve.jumps.iter().filter(|_| which == 1) {
                jumps += 1;
                let reach = 10.0 * tolerance * span;
                let near = |(at, length, _): &&(f64, f64, f64)| *at - length - reach < *time && at + reach > *time;
                let energy: f64 = found.iter().filter(near).map(|(.., energy)| energy).sum();
                assert!((energy - released).abs() < 0.1 * released, "{}: {released} {energy}", scene.name);
            }
        }
    }
    for (which, (ratios, tolerance)) in ratios.iter().zip([1e-2, 1e-3]).enumerate() {
        let beyond = |most: f64| ratios.iter().filter(|[all, _]| *all > most).count();
        let [worst, smooth] = ratios.iter().fold([0.0_f64; 2], |worst, ratio| [0, 1].map(|k| worst[k].max(ratio[k])));
        println!(
            "{tolerance}: of {} runs {} beyond 1, {} beyond 2, worst {worst:.2}, {smooth:.2} outside of jumps; {:.0} equivalents, {jumps} jumps",
            ratios.len(),
            beyond(1.0),
            beyond(2.0),
            equivalents[which]
        );
        let most = if which == 0 { worst <= 2.0 } else { smooth <= 6.0 };
        assert!(most && 20 * beyond(2.0) <= ratios.len(), "at {tolerance}");
    }
}

/// Under a force that pulls, the moment of separation is known to five tolerances of the time of the run: near it, bodies move fast.
#[test]
fn the_moment_of_separation() {
    let scene = History::draw(0, 1);
    let pull = |scene: &History, stepping| {
        let path = [(0.0, Load::force(1.0)), (1.0, Load::force(1.0)), (SPAN, Load::force(-9.0))];
        let path = PiecewiseLinear::new(&path).unwrap();
        let mut contact = scene.build();
        let mut run = contact.follow(&path, stepping, SPAN);
        loop {
            match run.next_step() {
                Ok(Some(_)) => {}
                Err(Error::PulledOff { time, .. }) => return time,
                other => panic!("{other:?}"),
            }
        }
    };
    let short = pull(&scene, Stepping::fixed(0.005));
    for tolerance in [1e-2, 1e-3] {
        let found = pull(&scene, Stepping::adaptive(tolerance));
        println!("{tolerance}: separates at {found:.4}, in short steps at {short:.3}");
        assert!((found - short).abs() < 0.01 + 5.0 * tolerance * SPAN, "{found} {short}");
    }
}

/// A ball that begins to tilt within a run, and comes back, is no longer symmetric: the run goes on as one whose ball was never upright.
#[test]
fn a_ball_that_begins_to_tilt_is_no_longer_symmetric() {
    for law in [1.0, 0.6].map(|range| Arc::new(ExponentialAttraction::new(1.0, range).unwrap())) {
        for tilted in [[0.05, 0.0], [0.02, -0.04]] {
            let path = |least: f64| {
                let points = [
                    (0.0, -1.0, 0.0),
                    (2.0, 0.5, 0.0),
                    (4.0, 0.6, 1.0),
                    (6.0, 0.5, 0.0),
                    (9.0, -1.0, 0.0),
                    (10.0, -1.5, 0.5),
                ];
                let load =
                    |at: f64, part: f64| Load::approach_and_tilt(at, tilted.map(|tilt: f64| tilt * part.max(least)));
                PiecewiseLinear::new(&points.map(|(time, at, part)| (time, load(at, part)))).unwrap()
            };
            let [folded, whole] = [0.0, 1e-9].map(|least| {
                let body = GeneralizedMaxwell::new(0.25, &[(0.5, 1.0), (0.25, 4.0)]).unwrap();
                let mut contact = ViscoelasticContact::builder(Grid::square(24, SIDE).unwrap())
                    .geometry(&Sphere::new(4.0).unwrap())
                    .material(Material::incompressible(body))
                    .attraction(law.clone())
                    .settings(Settings::default().with_tolerance(1e-7).with_edge(Edge::Allow))
                    .build()
                    .unwrap();
                let path = path(least);
                let mut run = contact.follow(&path, Stepping::adaptive(1e-2), SPAN);
                let mut states = Vec::new();
                while let Some(report) = run.next_step().unwrap() {
                    states.push([report.time, report.force, report.approach]);
                }
                states
            });
            let greatest = whole.iter().fold(0.0, |most: f64, state| most.max(state[1].abs()));
            println!("{} and {} steps", folded.len(), whole.len());
            assert_eq!(folded.len(), whole.len());
            for (folded, whole) in folded.iter().zip(&whole) {
                assert!(
                    (folded[0] - whole[0]).abs() < 1e-4 * SPAN && (folded[1] - whole[1]).abs() < 1e-3 * greatest,
                    "{folded:?} {whole:?}"
                );
            }
        }
    }
}
