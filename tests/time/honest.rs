//! Whether the error that a run was asked for is the one it makes: random scenes against fine steps on the same mesh.
//!
//! The forge runs 300 scenes. By hand:
//! `HONEST_SCENES=3000 HONEST_SEED=7 cargo test --release --test suite time::honest -- --nocapture`; `HONEST_FIRST=17` begins
//! with that number, `HONEST_STEPS=300000` finds the truth of more scenes, and `HONEST_TRUTHS=/tmp/truths` keeps it in that
//! file for the next time.

use crate::common::watched_runs::{Stopped, Watched, watch};
use crate::common::{Features, Ratios, Scene, Truth, from_environment};
use viscocontact::prelude::*;

const TOLERANCES: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];
const QUANTITIES: [&str; 4] = ["approach or force", "maximum pressure", "central pressure", "over the budget"];
/// A run of so many contact problems does not end.
const MOST_PROBLEMS: u64 = 20_000;
/// Steps of the finest run for the truth.
const MOST_GIVEN_STEPS: u64 = 20_000;
/// So many times more, where a run seems to err by too much.
const MORE_STEPS: u64 = 16;

/// What the runs at one tolerance came to.
#[derive(Default)]
struct Tally {
    /// True error over the one asked for, of each quantity, and that of the first over what the budget states of it; of scenes
    /// whose truth is known well enough.
    ratios: [Ratios; 4],
    problems: Ratios,
    rejected: u64,
    equivalents: f64,
    /// Runs that did not end.
    failures: Vec<String>,
}

impl Tally {
    fn take(&mut self, scene: &Scene, truth: &Truth, tolerance: f64, run: Result<Watched, Stopped>) {
        let run = match run {
            Ok(run) => run,
            Err(stopped) => return self.failures.push(format!("{}: {stopped}", scene.name)),
        };
        let errors = truth.errors(&run);
        // an error far beyond what was asked for is known well enough by a poorer truth
        let known =
            |k: usize| (truth.uncertainty[k] <= 0.1 * tolerance.max(errors[k])).then_some(errors[k] / tolerance);
        // an error below what was asked for in approach or force is no news
        let of_time = known(0).map(|ratio| ratio * tolerance / run.time_budget.max(0.3 * tolerance));
        let name = format!("in {} problems: {}", run.problems(), scene.name);
        let all = [known(0), known(1), known(2), of_time];
        for (ratios, ratio) in self.ratios.iter_mut().zip(all) {
            ratio.into_iter().for_each(|ratio| ratios.push(ratio, &name));
        }
        self.problems.push(run.problems() as f64, &scene.name);
        self.rejected += run.rejected;
        self.equivalents += run.equivalents;
    }

    fn print(&self, tolerance: f64) {
        let Tally { problems, rejected, equivalents, failures, .. } = self;
        println!(
            "\n{tolerance:.0e}: {} runs ended, {rejected} steps rejected, {equivalents:.0} equivalents",
            problems.count()
        );
        for (ratios, name) in self.ratios.iter().zip(QUANTITIES) {
            ratios.print(name, 3);
        }
        problems.print("contact problems", 0);
        failures.iter().take(8).for_each(|failure| println!("    not ended: {failure}"));
    }
}

/// Whether a run seems to err by more than twice what was asked, and the truth is not known well enough to decide.
fn is_doubtful(truth: &Truth, tolerance: f64, run: &Result<Watched, Stopped>) -> bool {
    let errs = run.as_ref().is_ok_and(|run| truth.errors(run)[0] > 2.0 * tolerance);
    errs && truth.uncertainty[0] > 0.1 * tolerance
}

/// A population of scenes, and what is promised of it.
pub(super) struct Promise {
    pub features: &'static [Features],
    /// What whoever runs the test may choose, with its default: the number of scenes, the seed, the first scene, and the steps of
    /// the finest run for the truth.
    pub chosen: [(&'static str, u64); 4],
    /// A run of so many contact problems does not end.
    pub most_problems: u64,
    /// The first tolerances of all, which are run.
    pub tolerances: usize,
    /// What a share of the errors is at most, over these tolerances, and what all are below.
    pub share: f64,
    pub high: [f64; 4],
    pub most: [f64; 4],
    /// Whether 98 % of the errors are at most twice what the budget states, of approach or force.
    pub by_budget: bool,
}

const HONEST: Promise = Promise {
    features: &[Features::ANY],
    chosen: [("HONEST_SCENES", 24), ("HONEST_SEED", 1), ("HONEST_FIRST", 0), ("HONEST_STEPS", MOST_GIVEN_STEPS)],
    most_problems: MOST_PROBLEMS,
    tolerances: 4,
    share: 0.99,
    high: [2.0; 4],
    most: [3.0; 4],
    by_budget: false,
};

/// True errors of the approach (or of the force, where the approach is given) are at most twice what was asked for in 99 %
/// of random scenes, and below three times in all of them; no run ends in an error.
#[test]
fn errors_are_honest_on_random_scenes() {
    HONEST.check();
}

/// The same of bodies that springs drive: of approach and force.
#[test]
fn errors_under_springs_are_honest() {
    let [_, seed, first, steps] = HONEST.chosen;
    Promise { features: &[Features::SPRING], chosen: [("HONEST_SPRINGS", 10), seed, first, steps], ..HONEST }.check();
}

/// What surfaces attract each other: at 1e-2 every error of approach or force is at most twice what was asked; at 1e-3 95 % are, and all are below six
/// times. Loads of all kinds, springs, and loads that go back and return, at times within steps, too.
#[test]
fn errors_of_surfaces_that_attract_are_honest() {
    const LOADS: [Features; 4] = [Features::ANY, Features::SPRING, Features::RETURNING, Features::RETURNING_BY_SPRING];
    const ATTRACTED: [Features; 4] =
        [LOADS[0].attracted(), LOADS[1].attracted(), LOADS[2].attracted(), LOADS[3].attracted()];
    let [_, seed, first, _] = HONEST.chosen;
    Promise {
        features: &ATTRACTED,
        chosen: [("HONEST_ATTRACTED", 2), seed, first, ("HONEST_STEPS", 2000)],
        tolerances: 2,
        share: 0.95,
        most: [2.0, 6.0, 0.0, 0.0],
        ..HONEST
    }
    .check();
}

impl Promise {
    pub(super) fn check(&self) {
        let [scenes, seed, first, most_steps] = self.chosen.map(|(name, default)| from_environment(name, default));
        let kept = std::env::var_os("HONEST_TRUTHS").map(std::path::PathBuf::from);
        let tolerances = &TOLERANCES[..self.tolerances];
        let mut tallies: [Tally; 4] = Default::default();
        let mut without_truth = 0;
        let (numbers, drawn) = (first..first + scenes, scenes * self.features.len() as u64);
        for (number, &features) in numbers.flat_map(|number| self.features.iter().map(move |of| (number, of))) {
            let scene = Scene::draw(seed, number, features);
            let mut truth =
                match Truth::kept_in(kept.as_deref(), &scene, 0.1 * tolerances[tolerances.len() - 1], most_steps) {
                    Ok(truth) => truth,
                    Err(stopped) => {
                        println!("without truth: {}: {stopped}", scene.name);
                        without_truth += 1;
                        continue;
                    }
                };
            let run = |&tolerance: &f64| {
                let mut contact = scene.contact(Settings::default().tolerance());
                let stepping = Stepping::adaptive(tolerance);
                watch(&scene, &mut contact, scene.load(), stepping, &scene.stops, self.most_problems)
            };
            let runs: Vec<_> = tolerances.iter().map(run).collect();
            if tolerances.iter().zip(&runs).any(|(&tolerance, run)| is_doubtful(&truth, tolerance, run)) {
                truth = Truth::of(&scene, 1e-6, MORE_STEPS * most_steps).unwrap_or(truth);
            }
            for ((&tolerance, run), tally) in tolerances.iter().zip(runs).zip(&mut tallies) {
                tally.take(&scene, &truth, tolerance, run);
            }
        }
        println!("seed {seed}, scenes {first} to {}", first + scenes);
        tolerances.iter().zip(&tallies).for_each(|(&tolerance, tally)| tally.print(tolerance));
        assert!(100 * without_truth <= drawn);
        for (k, (tolerance, tally)) in tolerances.iter().zip(&tallies).enumerate() {
            assert!(tally.failures.is_empty(), "at {tolerance:e} {} runs do not end", tally.failures.len());
            let [high, most] = [self.share, 1.0].map(|part| tally.ratios[0].quantile(part));
            assert!(high <= self.high[k] && most < self.most[k], "at {tolerance:e}: {high} {most}");
            assert!(2 * tally.ratios[0].count() as u64 > drawn, "of {} the truth is known", tally.ratios[0].count());
        }
        if self.by_budget {
            let of_all = Ratios::of(tallies.iter().map(|tally| &tally.ratios[3]));
            assert!(of_all.quantile(0.98) <= 2.0, "{}: {}", QUANTITIES[3], of_all.quantile(0.98));
        }
    }
}
