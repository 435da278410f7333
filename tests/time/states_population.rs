//! Adaptive runs on elastic states, drawn at random: is the error what the tolerance asks for, at the ends of steps and inside? The
//! references are steps of given length on graded meshes, which no control chooses. `STATES=400` for the whole population.

use std::sync::Arc;

use crate::common::random_bodies::{Body, body_of_twenty_decades, random_body};
use crate::common::random_histories::{Control, RandomHistory, parting_history, random_history, size};
use crate::common::random_returns::{returning_body, returning_history};
use crate::common::{Draws, Ratios, from_environment};
use viscocontact::prelude::*;
use viscocontact::states::{ElasticStates, StatesContact};

/// Runs longer than this fail, and only one run in a hundred may be long: of wide spectra that part and return, at 1e-5.
const MOST_STEPS: usize = 12_000;
const LONG: usize = 5000;
const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// A body, a shape and a history.
struct Scene {
    name: String,
    body: Body,
    states: Arc<ElasticStates>,
    history: RandomHistory,
    tolerance: f64,
    /// Times at which the history is not smooth, or a force begins or ends.
    corners: Vec<f64>,
}

impl Scene {
    fn new(seed: u64) -> Scene {
        let draws = &mut Draws::new(seed);
        let tolerance = TOLERANCES[draws.below(4)];
        let body = match draws.below(9) {
            0 => body_of_twenty_decades(draws),
            1 | 2 => returning_body(draws),
            _ => random_body(draws),
        };
        let states = match draws.below(4) {
            0 | 1 => ElasticStates::sphere(1.0),
            2 => ElasticStates::cone(0.3),
            _ => ElasticStates::power(1.0, 4.0),
        };
        let (states, depth) = (states.unwrap(), 0.3);
        let force = states.level_at(depth) / body.material.contact_compliance(body.until);
        let answers_at_once = body.is_elastic_at_once();
        let (control, by) = match if answers_at_once { draws.below(3) } else { 0 } {
            0 => (Control::Force(force), "force"),
            1 => (Control::Approach { touch: 0.0, depth }, "approach"),
            _ => (Control::by_spring(draws, 0.0, depth, force), "spring"),
        };
        let history = match draws.below(4) {
            0 => parting_history(draws, control, body.until),
            1 if answers_at_once => returning_history(draws, control, body.until),
            _ => random_history(draws, control, body.until, answers_at_once),
        };
        let creep = body.creep_ratio();
        let name = format!("{seed}: {} (creep {creep:.1e}), {} of the {by}, {tolerance:.0e}", body.name, history.name);
        let corners = corners(&history, body.until);
        Scene { name, body, states, history, tolerance, corners }
    }

    fn contact(&self) -> StatesContact {
        StatesContact::new(&self.states, &self.body.material).unwrap()
    }

    /// Times inside the run that are looked at.
    fn looks(&self) -> Vec<f64> {
        let equal = (1..400).map(|k| self.body.until * f64::from(k) / 400.0);
        let graded = |pair: &[f64]| {
            let [start, end] = [pair[0], pair[1]];
            (1..40).map(move |k| start + (end - start) * 10f64.powf(-f64::from(k) / 8.0))
        };
        let mut looks: Vec<f64> = equal.chain(self.corners.windows(2).flat_map(graded)).collect();
        looks.sort_by(f64::total_cmp);
        looks
    }
}

/// Start, corners and end of a run, and where forces begin and end.
fn corners(history: &RandomHistory, until: f64) -> Vec<f64> {
    let mut corners = vec![0.0];
    let (unnamed, history) = (&history.corners, &*history.history);
    while let Some(next) = history.next_breakpoint(corners[corners.len() - 1]).filter(|next| *next < until) {
        corners.push(next);
    }
    let is_new = |time: &f64, corners: &[f64]| corners.iter().all(|corner| (corner - time).abs() > 1e-6 * until);
    let unnamed = unnamed.iter().copied().filter(|time| *time < until && is_new(time, &corners));
    corners.extend(unnamed.collect::<Vec<_>>());
    let presses = |time: f64| !matches!(history.at(time), Load::Force { normal, .. } if normal == 0.0);
    for k in 0..4000 {
        let [mut low, mut high] = [k, k + 1].map(|k| until * f64::from(k) / 4000.0);
        let at_low = presses(low);
        if at_low == presses(high) {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if presses(middle) == at_low { &mut low } else { &mut high }) = middle;
        }
        if is_new(&high, &corners) {
            corners.push(high);
        }
    }
    corners.push(until);
    corners.sort_by(f64::total_cmp);
    corners
}

/// Force and approach at ends of steps of given length, corner by corner.
struct Reference(Vec<Vec<(f64, [f64; 2])>>);

impl Reference {
    /// By about `steps` steps, graded towards both ends of each smooth piece.
    fn new(scene: &Scene, steps: f64) -> Option<Reference> {
        let history = &scene.history.history;
        let mut contact = scene.contact().with_merge_error(1e-2 * scene.tolerance).unwrap();
        if size(history.at(0.0)) > 0.0 {
            contact.step(0.0, history.at(0.0)).ok()?;
        }
        let (mut pieces, mut now) = (Vec::new(), 0.0);
        // the force of a body that resists rates alone is a change of its strain over the step: shorter steps round it by more than is asked
        let body = &scene.body;
        let first =
            if body.is_elastic_at_once() { 1e-13f64.min(1e-3 * body.shortest_time() / body.until) } else { 1e-9 };
        for pair in scene.corners.windows(2) {
            let (start, end) = (pair[0], pair[1]);
            let longest = 1.0 / (steps * (end - start) / scene.body.until).max(steps / 50.0);
            let growth = 10f64.powf(1.0 / (steps / 300.0).max(8.0)) - 1.0;
            let grow = |part: &f64| Some(part + longest.min(growth * part)).filter(|part| *part < 0.5);
            let parts: Vec<f64> = std::iter::successors(Some(first), grow).collect();
            let rest = parts.iter().rev().map(|part| 1.0 - part);
            if now > 0.0 && history.before(start) != history.at(start) {
                contact.step(0.0, history.at(start)).ok()?;
            }
            let mut piece = vec![(start, [contact.force(), contact.approach()])];
            for part in parts.iter().copied().chain(rest).chain([1.0]) {
                let next = if part < 1.0 { start + (end - start) * part } else { end };
                if next > now {
                    let load = if next == end { history.before(end) } else { history.at(next) };
                    contact.step(next - now, load).ok()?;
                    piece.push((next, [contact.force(), contact.approach()]));
                    now = next;
                }
            }
            pieces.push(piece);
        }
        Some(Reference(pieces))
    }

    /// Greatest force and approach.
    fn greatest(&self) -> [f64; 2] {
        let all = || self.0.iter().flatten();
        [0, 1].map(|k| all().fold(0.0, |most: f64, (_, values)| most.max(values[k].abs())))
    }

    /// Before a jump at that time, by the cubic through four ends of steps.
    fn at(&self, time: f64) -> [f64; 2] {
        let last = self.0.len() - 1;
        let piece = self.0.iter().find(|piece| time <= piece[piece.len() - 1].0).unwrap_or(&self.0[last]);
        let next = piece.partition_point(|point| point.0 < time).min(piece.len() - 1);
        if piece[next].0 == time || next == 0 {
            return piece[next].1;
        }
        let first = next.saturating_sub(2).min(piece.len().saturating_sub(4));
        let nodes = &piece[first..(first + 4).min(piece.len())];
        let weight = |k: usize| -> f64 {
            let others = nodes.iter().enumerate().filter(|(other, _)| *other != k);
            others.map(|(_, other)| (time - other.0) / (nodes[k].0 - other.0)).product()
        };
        [0, 1].map(|axis| (0..nodes.len()).map(|k| weight(k) * nodes[k].1[axis]).sum())
    }
}

/// Force and approach at times of a run.
type Points = Vec<(f64, [f64; 2])>;

/// What an adaptive run gives at ends of steps and inside; or why it ended early.
fn run(scene: &Scene) -> std::result::Result<[Points; 2], String> {
    let mut contact = scene.contact();
    let (looks, [mut ends, mut inside]) = (scene.looks(), [(); 2].map(|()| Vec::new()));
    let mut run = contact.follow(&*scene.history.history, Stepping::adaptive(scene.tolerance), scene.body.until);
    while let Some(report) = run.next_step().map_err(|error| error.to_string())? {
        if report.dt == 0.0 {
            continue;
        }
        ends.push((report.time, [report.force, report.approach]));
        let start = report.time - report.dt;
        let own = (0..4).map(|k| report.time - report.dt * (0.125 + 0.25 * f64::from(k)));
        let looks = looks.iter().copied().filter(|look| (start..report.time).contains(look));
        for time in own.chain(looks).filter(|time| start < *time && *time < report.time) {
            let within = run.within_step(time).map_err(|error| format!("inside: {error}"))?;
            inside.push((time, [within.force(), within.approach()]));
        }
        if ends.len() > MOST_STEPS {
            return Err(format!("{} of {} after {MOST_STEPS} steps", report.time, scene.body.until));
        }
    }
    Ok([ends, inside])
}

#[test]
fn adaptive_runs_on_states_err_by_what_was_asked() {
    let (count, first) = (from_environment("STATES", 9), from_environment("STATES_SEED", 304));
    let judges = from_environment("STATES_JUDGED", 1) == 1;
    let mut ratios: [[Ratios; 3]; 2] = Default::default();
    let mut steps: [Ratios; 4] = Default::default();
    let (mut failed, mut vague, mut refused) = (Vec::new(), 0, 0);
    for seed in first..first + count {
        let scene = Scene::new(seed);
        let found = run(&scene);
        if let (Ok([ends, _]), false) = (&found, !scene.body.is_elastic_at_once()) {
            let kind = TOLERANCES.iter().position(|tolerance| *tolerance == scene.tolerance).unwrap();
            steps[kind].push(ends.len() as f64, &scene.name);
        }
        match &found {
            Err(error) => failed.push(format!("{}: {error}", scene.name)),
            Ok(_) if !judges => {}
            Ok(found) => {
                let meshes = [6000.0, 12_000.0].map(|steps| Reference::new(&scene, steps));
                let [Some(coarse), Some(fine)] = &meshes else {
                    refused += 1;
                    continue;
                };
                let greatest = fine.greatest();
                let apart = |a: [f64; 2], b: [f64; 2]| {
                    let relative = |k: usize| if greatest[k] > 0.0 { (a[k] - b[k]).abs() / greatest[k] } else { 0.0 };
                    relative(0).max(relative(1)) / scene.tolerance
                };
                let doubt = |time: f64| apart(coarse.at(time), fine.at(time));
                let most =
                    (0..1000).map(|k| doubt(scene.body.until * (f64::from(k) + 0.37) / 1000.0)).fold(0.0, f64::max);
                if most > 0.5 {
                    vague += 1;
                    continue;
                }
                let off = |points: &Points| {
                    let known = points.iter().filter(|(time, _)| doubt(*time) <= 0.3);
                    known.map(|&(time, values)| apart(values, fine.at(time))).fold(0.0, f64::max)
                };
                let [ends, inside] = [off(&found[0]), off(&found[1])];
                let name = format!("{}, {} steps", scene.name, found[0].len());
                let kind = usize::from(!scene.body.is_elastic_at_once());
                ratios[kind][0].push(ends, &name);
                ratios[kind][1].push(inside, &name);
                ratios[kind][2].push(ends.max(inside), &name);
            }
        }
    }
    println!("{count} runs, {vague} with a vague reference, {refused} with none, {} failed:", failed.len());
    failed.iter().for_each(|failed| println!("    {failed}"));
    for (steps, tolerance) in steps.iter().zip(TOLERANCES) {
        steps.print(&format!("steps at {tolerance:.0e}"), 2);
    }
    for (ratios, body) in ratios.iter().zip(["", ", resisting rates"]) {
        for (ratios, place) in ratios.iter().zip(["ends", "inside", "both"]) {
            ratios.print(&format!("error over tolerance, {place}{body}"), 6);
        }
    }
    let long: u64 = steps.iter().map(|steps| steps.above(LONG as f64) as u64).sum();
    assert!(long <= count / 100, "{long} runs of more than {LONG} steps");
    let [both, resisting] = ratios.map(|[_, _, both]| both);
    assert!(!judges || both.count() as u64 > count / 2, "{} judged", both.count());
    assert!(!judges || count < 9 || resisting.count() > 0, "no body without elastic response judged");
    assert!(failed.is_empty(), "{failed:?}");
    assert!(resisting.above(5.0) == 0, "{resisting:?}");
    assert!(both.above(2.0) <= both.count() / 100 && both.above(3.0) == 0, "beyond what was asked: {both:?}");
}

/// A contact modulus E(t) of an incompressible body, G = E/4.
fn relaxing(equilibrium: f64, modulus: f64) -> Material {
    Material::incompressible(GeneralizedMaxwell::new(0.25 * equilibrium, &[(0.25 * modulus, 1.0)]).unwrap())
}

/// A breakpoint that is the end of the run but for the rounding of times.
#[test]
fn breakpoints_a_rounding_before_the_end_are_reached() {
    let until = 95.21f64;
    let load = |t: f64| Load::force((0.1 * t).sin().powi(2));
    for ulps in 1..=40 {
        let corner = f64::from_bits(until.to_bits() - ulps);
        let history = FnHistory::new(load).with_breakpoints(&[corner]).unwrap();
        let mut contact = StatesContact::new(&ElasticStates::sphere(1.0).unwrap(), &relaxing(0.1, 0.9)).unwrap();
        let mut run = contact.follow(&history, Stepping::adaptive(1e-3), until);
        while run.next_step().unwrap().is_some() {}
        assert_eq!(contact.time(), until);
    }
}
