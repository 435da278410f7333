//! Is the state within a step as exact as one at the end of a step?
//!
//! The forge runs 300 scenes. By hand: `INSIDE_SCENES=300 cargo test --all-features --test suite time::inside -- --nocapture`; `INSIDE_SEED=7`
//! draws others, `INSIDE_FIRST=17` begins with that number, `INSIDE_LINES=1` prints every scene.

use std::sync::Arc;

use approx::assert_abs_diff_eq;
use viscocontact::Error;
use viscocontact::ErrorKind;
use viscocontact::prelude::*;
use viscocontact::rheology::{TemperatureHistory, TimeTemperature};

use crate::common::histories::{self, Scene};
use crate::common::runs::scenes;
use crate::common::scene::Scene as RandomScene;
use crate::common::{Draws, Features, Ratios, builder_on, from_environment};

/// A history that is one until a time, and another from then on.
#[derive(Debug)]
struct InTurn<'a> {
    first: &'a dyn LoadHistory,
    until: f64,
    then: Ramp,
}

impl LoadHistory for InTurn<'_> {
    fn at(&self, t: f64) -> Load {
        if t < self.until { self.first.at(t) } else { self.then.at(t) }
    }

    fn before(&self, t: f64) -> Load {
        if t <= self.until { self.first.before(t) } else { self.then.before(t) }
    }

    fn next_breakpoint(&self, after: f64) -> Option<f64> {
        let first = self.first.next_breakpoint(after).filter(|&time| time < self.until);
        first.or((after < self.until).then_some(self.until)).or_else(|| self.then.next_breakpoint(after))
    }
}

/// A run of so many steps does not end.
const MOST_STEPS: usize = 5000;

/// What is seen of a state.
struct Seen {
    /// Approach, force, tilt times half the length of the grid, greatest pressure.
    values: [f64; 4],
    pressure: Vec<f64>,
    /// The least displacement.
    least: f64,
}

/// On a mesh the contact area changes by whole cells: it is off by the cells that are in contact in one of two states only, and
/// so by the greatest pressure that acts on such a cell.
const QUANTITIES: [&str; 5] = ["approach", "force", "tilt", "maximum pressure", "contact area"];

fn seen(contact: &ViscoelasticContact) -> Seen {
    let [tilt1, tilt2] = contact.tilt();
    let half = 0.5 * contact.grid().lengths()[0];
    let values = [contact.approach(), contact.force(), half * (tilt1 + tilt2), contact.fields().max_pressure()];
    let least = contact.fields().displacement().iter().copied().fold(f64::INFINITY, f64::min);
    Seen { values, pressure: contact.pressure().to_vec(), least }
}

/// A state within a step, or at its end.
struct Look {
    time: f64,
    within: bool,
    seen: Seen,
}

struct Run {
    looks: Vec<Look>,
    steps: usize,
    rejected: u64,
    /// What the budget states of the error in time; at least what was asked for.
    stated: f64,
}

/// Follows a history in adaptive steps, and looks at the quarters and the ends of all steps.
fn run(
    mut contact: ViscoelasticContact,
    history: &dyn LoadHistory,
    until: f64,
    tolerance: f64,
) -> Result<Run, Box<dyn std::error::Error>> {
    let mut run = contact.follow(history, Stepping::adaptive(tolerance), until);
    let (mut looks, mut steps) = (Vec::new(), 0);
    while let Some(report) = run.next_step()? {
        steps += 1;
        if steps == MOST_STEPS {
            return Err(format!("endless at {:e} s", report.time).into());
        }
        for share in [0.25, 0.5, 0.75, 1.0].into_iter().filter(|_| report.dt > 0.0) {
            let (within, time) = (share < 1.0, report.time - (1.0 - share) * report.dt);
            if !within {
                looks.push(Look { time, within, seen: seen(run.contact()) });
            } else if time > report.time - report.dt && time < report.time {
                looks.push(Look { time, within, seen: seen(&run.within_step(time)?) });
            }
        }
    }
    let stated = run.error_budget().time.unwrap_or(0.0).max(tolerance);
    Ok(Run { looks, steps, rejected: run.rejected_steps(), stated })
}

/// The states of a much more exact run at the times of the looks, where it ends steps.
fn truth(
    mut contact: ViscoelasticContact,
    history: &dyn LoadHistory,
    until: f64,
    tolerance: f64,
    looks: &[Look],
) -> Result<Vec<Seen>, Error> {
    let times: Vec<f64> = looks.iter().map(|look| look.time).collect();
    let mut run = contact.follow(history, Stepping::adaptive(tolerance), until).stop_at(&times)?;
    let mut states = Vec::new();
    while let Some(report) = run.next_step()? {
        if report.dt > 0.0 && times.binary_search_by(|time| time.total_cmp(&report.time)).is_ok() {
            states.push(seen(run.contact()));
        }
    }
    assert_eq!(states.len(), looks.len(), "the run stops at every time");
    Ok(states)
}

/// By how much two states differ.
fn differences(one: &Seen, other: &Seen) -> [f64; 5] {
    let by = |which: usize| (one.values[which] - other.values[which]).abs();
    let cells = one.pressure.iter().zip(&other.pressure).filter(|(one, other)| (**one > 0.0) != (**other > 0.0));
    [by(0), by(1), by(2), by(3), cells.fold(0.0, |most, (one, other)| most.max(one.max(*other)))]
}

/// In given steps: the state is the one of a shorter step from the same start, whatever is computed and by whichever rule.
/// Where the indenter or the bodies move in a step, only its end is left.
#[test]
fn a_state_within_a_given_step_is_a_shorter_step() {
    for (name, build, step) in scenes() {
        let mut contact = build();
        for k in 0..7 {
            let start = contact.clone();
            let report = step(&mut contact, k);
            let time = report.time - 0.3 * report.dt;
            if name.contains("rolling") || name.contains("sliding") {
                assert!(
                    report.dt == 0.0 || matches!(contact.within_step(time), Err(Error::OutOfRange { .. })),
                    "{name}"
                );
                continue;
            }
            assert_eq!(contact.within_step(report.time).unwrap().pressure(), contact.pressure());
            if report.dt == 0.0 {
                continue;
            }
            let at_start = contact.within_step(start.time());
            assert!(at_start.is_ok_and(|found| found.pressure() == start.pressure()), "{name}, start of step {k}");
            let within = contact.within_step(time).unwrap();
            let mut twin = start.clone();
            let share = (time - start.time()) / report.dt;
            let between = |a: f64, b: f64| a + share * (b - a);
            let loads: Vec<Load> = (0..contact.fields().bodies())
                .map(|body| {
                    if let Load::Approach { approach, .. } = contact.fields().load() {
                        return Load::approach(between(start.approach(), approach));
                    }
                    let [before, after] = [&start, &contact].map(|contact| contact.fields().body(body).unwrap().force);
                    match (start.fields().load().tilt(), contact.fields().load().tilt()) {
                        (
                            [Tilt::Free { at: a1 }, Tilt::Free { at: a2 }],
                            [Tilt::Free { at: b1 }, Tilt::Free { at: b2 }],
                        ) => Load::eccentric_force(between(before, after), [between(a1, b1), between(a2, b2)]),
                        (_, [Tilt::Free { at: b1 }, Tilt::Free { at: b2 }]) => {
                            Load::eccentric_force(between(before, after), [b1, b2])
                        }
                        _ => Load::force(between(before, after)),
                    }
                })
                .collect();
            twin.step(time - start.time(), &loads).unwrap();
            let off = differences(&seen(&within), &seen(&twin));
            let [approach, force, tilt, most] = seen(&contact).values;
            let greatest = [approach, force, approach + tilt.abs(), most, most];
            // the passes of an attraction end at a change of 1e-4
            let bound = if name == "attracted" { 1e-3 } else { 1e-4 };
            for (which, quantity) in QUANTITIES.iter().enumerate() {
                assert!(
                    off[which] <= bound * greatest[which].abs(),
                    "{name}, step {k}: {quantity} {off:?} of {greatest:?}"
                );
            }
            // it can be stepped like any other contact
            let mut further = within.clone();
            further.step(report.time - time, &loads).unwrap();
            assert!(further.within_step(report.time).is_ok());
        }
    }
}

/// After a jump no earlier step predicts the next: half of a long step is a step of half its length, not half of what
/// happens in it. The ends are the states themselves, and other times are refused.
#[test]
fn a_state_within_a_long_step_follows_the_relaxation() {
    let zener = Material::incompressible(Zener::with_time(1.0e6, 0.1e6, 1.0).unwrap());
    let mut contact = builder_on(Grid::square(32, 4.0e-3).unwrap(), zener).build().unwrap();
    contact.step(0.0, Load::approach(2.0e-5)).unwrap();
    let (start, instant) = (contact.clone(), contact.force());
    contact.step(10.0, Load::approach(2.0e-5)).unwrap();
    let relaxed = contact.force();
    let time = 0.5;
    // G(t) = G∞ + (G − G∞) e^(−t/τ): the force under a held approach follows it
    let (rubbery, tau) = (0.1 / 1.1, 0.1 / 1.1);
    let modulus = |t: f64| rubbery + (1.0 - rubbery) * (-t / tau).exp();
    let within = contact.within_step(time).unwrap();
    assert_abs_diff_eq!(within.force(), instant * modulus(time), epsilon = 1e-5 * instant);
    assert_abs_diff_eq!(relaxed, instant * rubbery, epsilon = 1e-5 * instant);
    assert_eq!(within.approach(), 2.0e-5);
    assert_eq!(contact.within_step(0.0).unwrap().pressure(), start.pressure());
    for outside in [-0.1, 10.1, f64::NAN] {
        assert!(matches!(contact.within_step(outside), Err(Error::OutOfRange { .. })), "{outside}");
    }
    // a load that is refused changes nothing, a step that fails has overwritten the start of the last one
    assert_eq!(contact.step(1.0, Load::force(f64::NAN)).unwrap_err().kind(), ErrorKind::Value);
    assert_eq!(contact.within_step(time).unwrap().force(), within.force());
    assert_eq!(contact.step(1.0, Load::force(1.0e6)).unwrap_err().kind(), ErrorKind::Value);
    let lost = contact.within_step(time).unwrap_err();
    assert!(lost.to_string().contains("whose start is lost"), "{lost}");
    assert!(contact.within_step(10.0).is_ok());
    let outside = contact.within_step(-0.1).unwrap_err();
    assert!(outside.to_string().ends_with("between its start and its end"), "{outside}");
}

/// Greatest and mean error of approach and force inside the steps of an adaptive run, relative to their greatest values; and the
/// number of steps.
fn errors_inside(scene: &Scene, tolerance: f64) -> ([[f64; 2]; 2], usize) {
    let Run { mut looks, steps, .. } =
        run(scene.contact(24, 1e-4 * tolerance), &*scene.history, scene.until, tolerance).unwrap();
    looks.retain(|look| look.within);
    assert!(looks.iter().all(|look| look.seen.least >= 0.0), "{}", scene.name);
    let fine = (1e-2 * tolerance).min(1e-5);
    let exact = truth(scene.contact(24, 1e-10), &*scene.history, scene.until, fine, &looks).unwrap();
    let errors = [0, 1].map(|which| {
        let greatest = exact.iter().map(|exact| exact.values[which].abs()).fold(0.0, f64::max);
        let off = |(look, exact): (&Look, &Seen)| (look.seen.values[which] - exact.values[which]).abs() / greatest;
        let off = looks.iter().zip(&exact).map(off);
        off.fold([0.0, 0.0], |[most, mean]: [f64; 2], off| [most.max(off), mean + off / looks.len() as f64])
    });
    (errors, steps)
}

/// Third where all is smooth; kinks of the cells that join take a part of it.
#[test]
fn the_order_inside_adaptive_steps_is_above_that_of_a_line() {
    let scene = histories::scenes().into_iter().find(|scene| scene.name.contains("sine")).unwrap();
    let [(coarse, few), (fine, many)] = [1e-3, 1e-5].map(|tolerance| errors_inside(&scene, tolerance));
    let [approach, force] = [0, 1];
    let order = (coarse[approach][1] / fine[approach][1]).ln() / (many as f64 / few as f64).ln();
    println!("{few} and {many} steps, order {order:.2}");
    assert!(order > 2.9, "{order}");
    // the force is given, inside as at the ends
    assert!(coarse[force][0] < 1e-12 && fine[force][0] < 1e-12);
}

/// A random scene, in part with a layer, a temperature that changes, a spring, or force and approach in turn.
struct Inside {
    scene: RandomScene,
    what: &'static str,
    kernel: Option<Arc<InfluenceKernel>>,
    temperature: Option<TemperatureHistory>,
}

impl Inside {
    fn new(seed: u64, number: u64) -> Inside {
        let mut draws = Draws::new(seed.wrapping_mul(7_777_777).wrapping_add(number));
        let mut scene = RandomScene::draw(seed, number, Features::ANY);
        let (mut kernel, mut temperature, mut what) = (None, None, "");
        match draws.below(5) {
            0 => {
                let thickness = scene.grid().lengths()[0] * draws.power_of_ten(-1.0, 0.5);
                let layer = match draws.below(3) {
                    0 => Layer::bonded_to_rigid(thickness, 0.5),
                    1 => Layer::frictionless_on_rigid(thickness, 0.5),
                    _ => Layer::bonded_to_half_space(thickness, 0.5, draws.power_of_ten(-1.0, 1.0), 0.5),
                };
                let layered = Arc::new(InfluenceKernel::layer(scene.grid(), layer.unwrap()).unwrap());
                // a layer has a constant Poisson's ratio
                if scene.builder(Settings::default()).kernel(layered.clone()).build().is_ok() {
                    (kernel, what) = (Some(layered), "layer, ");
                }
            }
            1 => {
                let law = TimeTemperature::wlf(10.0, 60.0, 300.0).unwrap();
                let (colder, until) = (draws.between(-8.0, 0.0), scene.body.until);
                let table = [(0.0, 300.0), (0.4 * until, 300.0 + colder), (1.1 * until, 300.0)];
                temperature = Some(TemperatureHistory::table(law, &table).unwrap());
                what = "temperature, ";
            }
            2 if scene.body.is_elastic_at_once() => what = "in turn, ",
            3 => scene = RandomScene::draw(seed, number, Features::SPRING),
            _ => {}
        }
        Inside { scene, what, kernel, temperature }
    }

    fn contact(&self, tolerance: f64) -> ViscoelasticContact {
        let mut builder = self.scene.builder(Settings::default().with_tolerance(tolerance));
        if let Some(kernel) = &self.kernel {
            builder = builder.kernel(kernel.clone());
        }
        if let Some(temperature) = &self.temperature {
            builder = builder.temperature(temperature.clone());
        }
        builder.build().unwrap()
    }

    /// Force and approach in turn: from the state that the first half of the history leads to, the other is given.
    fn in_turn(&self) -> Result<InTurn<'_>, Error> {
        let (first, until) = (self.scene.load(), self.scene.body.until);
        let half = 0.5 * until;
        let mut contact = self.contact(1e-9);
        let mut run = contact.follow(first, Stepping::adaptive(1e-5), half);
        while run.next_step()?.is_some() {}
        let turned = |part: f64| match first.before(half) {
            Load::Force { .. } => Load::approach(contact.approach() + (part - 1.0) * contact.approach().abs()),
            _ => Load::force(part * contact.force()),
        };
        let then = Ramp::new(turned(1.0), turned(1.2), until)?;
        Ok(InTurn { first, until: half, then })
    }
}

/// Maximum error of each quantity, relative to the maximum of the run, in tolerances.
struct Errors {
    within: [f64; 5],
    ends: [f64; 5],
    /// What the budget states of the error in time, in tolerances.
    stated: f64,
}

fn errors(inside: &Inside, tolerance: f64) -> Result<Errors, Box<dyn std::error::Error>> {
    let in_turn;
    let history: &dyn LoadHistory = if inside.what.starts_with("in turn") {
        in_turn = inside.in_turn()?;
        &in_turn
    } else {
        inside.scene.load()
    };
    let (until, solver) = (inside.scene.body.until, Settings::default().tolerance().min(0.01 * tolerance));
    let Run { looks, steps, rejected, stated } = run(inside.contact(solver), history, until, tolerance)?;
    if std::env::var("INSIDE_TRACE").is_ok() {
        let name = &inside.scene.name;
        println!("{}problems {} rejected {rejected} {tolerance:.0e} {name}", inside.what, steps as u64 + rejected);
    }
    let exact = truth(inside.contact(1e-9), history, until, (0.02 * tolerance).max(1e-8), &looks)?;
    let values = |which: usize| exact.iter().fold(0.0, |most: f64, seen| most.max(seen.values[which].abs()));
    // a tilt is a displacement at the end of the grid
    let greatest = [values(0), values(1), values(0).max(values(2)), values(3), values(3)];
    let mut worst = [[0.0_f64; 5]; 2];
    for (Look { within, seen, .. }, exact) in looks.iter().zip(&exact) {
        let off = differences(seen, exact);
        for which in 0..5 {
            let worst = &mut worst[usize::from(!within)][which];
            *worst = worst.max(off[which] / greatest[which].max(1e-300) / tolerance);
        }
    }
    let [within, ends] = worst;
    Ok(Errors { within, ends, stated: stated / tolerance })
}

/// States within the steps of adaptive runs err by at most twice what was asked for, in all but one of a hundred runs, and by at most
/// twice what the budget states in all. Errors of maximum pressures and areas are printed alone.
///
/// A body without elastic response answers each cell that it meets with a finite pressure at once, and the step control passes
/// over events shorter than its resolution: of such bodies the approach is compared alone.
#[test]
fn states_within_adaptive_steps_are_as_exact_as_the_ends_of_steps() {
    let (scenes, seed) = (from_environment("INSIDE_SCENES", 12), from_environment("INSIDE_SEED", 1));
    let first = from_environment("INSIDE_FIRST", 0);
    let lines = from_environment("INSIDE_LINES", 0) > 0;
    let mut all: [[Ratios; 5]; 2] = Default::default();
    let (mut worse, mut failed, mut beyond, mut unstated) = ([0; 3], 0, 0, 0);
    for number in first..first + scenes {
        let inside = Inside::new(seed, number);
        for tolerance in [1e-3, 1e-4] {
            let name = format!("{tolerance:.0e} {}{}", inside.what, inside.scene.name);
            let Errors { mut within, mut ends, stated } = match errors(&inside, tolerance) {
                Ok(errors) => errors,
                Err(error) => {
                    println!("{name}: {error}");
                    failed += 1;
                    continue;
                }
            };
            if !inside.scene.body.is_elastic_at_once() {
                within[1..].fill(0.0);
                ends[1..].fill(0.0);
            }
            beyond += usize::from(within[..3].iter().any(|&error| error > 2.0));
            unstated += usize::from(within[..3].iter().any(|&error| error > 2.0 * stated));
            if lines || within[..3].iter().any(|&error| error > 2.0) {
                println!("{within:.2?}, ends {ends:.2?}, stated {stated:.1} {name}");
            }
            for (worse, (within, end)) in worse.iter_mut().zip(within.into_iter().zip(ends)) {
                *worse += usize::from(within > f64::max(2.0, 1.5 * end));
            }
            for (all, errors) in all.iter_mut().zip([within, ends]) {
                all.iter_mut().zip(errors).for_each(|(all, error)| all.push(error, &name));
            }
        }
    }
    println!("true over asked, within steps and at their ends:");
    for ([within, ends], name) in (0..5).map(|which| [&all[0][which], &all[1][which]]).zip(QUANTITIES) {
        within.print(name, 0);
        ends.print("", 0);
    }
    let runs = all[0][0].count() + failed;
    println!("{beyond} of {runs} runs are beyond 2 in approach, force or tilt within steps");
    println!("{unstated} of {runs} runs are beyond twice what the budget states of them");
    println!("{failed} of {runs} runs failed; worse within steps than at their ends, of each quantity: {worse:?}");
    // three times as many looks see more of the moments just before a cell joins or leaves
    assert!(failed == 0 && worse.iter().all(|worse| 100 * worse <= runs));
    assert!(unstated == 0 && 100 * beyond <= runs);
}
