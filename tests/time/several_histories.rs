//! Do runs keep to their tolerance where each of several indenters follows a history of its own?
//!
//! By hand: `BODIES_SCENES=100 cargo test --all-features --test suite time::several_histories -- --nocapture`; `BODIES_SEED=7` draws
//! others, `BODIES_STEPS=20000` finds the truth of more scenes.

use crate::common::random_histories::{Control, RandomHistory, random_history};
use crate::common::{Draws, RADIUS, Ratios, Temporary, from_environment};
use viscocontact::contact::{Builder, TimeRule};
use viscocontact::prelude::*;
use viscocontact::run::Crossing;

/// Times at which the bodies are compared.
const SAMPLES: usize = 40;
/// The truth is known where two finenesses differ by less than this part of the tolerance.
const DOUBT: f64 = 0.25;

/// Balls side by side on a body that creeps.
struct Several {
    name: String,
    tolerance: f64,
    until: f64,
    body: Material,
    grid: Grid,
    places: Vec<f64>,
    controls: Vec<Control>,
    histories: Vec<RandomHistory>,
}

/// What each body leaves free at a time: its approach under a force, its force under an approach, both under a spring.
type Answers = Vec<[f64; 2]>;

fn draw(seed: u64, number: u64) -> Several {
    let draws = &mut Draws::new(seed.wrapping_mul(1_000_003) + number);
    let modulus = draws.power_of_ten(4.0, 7.0);
    let (memory, left) = (draws.power_of_ten(-1.5, 1.0), draws.power_of_ten(-2.0, 0.0).min(0.9));
    let (kind, body) = match draws.below(4) {
        0 => ("Maxwell", Material::incompressible(Maxwell::with_time(modulus, memory).unwrap())),
        _ => ("Zener", Material::incompressible(Zener::relaxing(modulus, left * modulus, memory).unwrap())),
    };
    let count = 2 + draws.below(2);
    let depth = draws.power_of_ten(-6.0, -4.0);
    let width = 2.6 * (depth * RADIUS).sqrt();
    let apart = draws.between(0.7, 1.5) * width;
    let places: Vec<f64> = (0..count).map(|k| (k as f64 - 0.5 * (count - 1) as f64) * apart).collect();
    let cells = 12 + 2 * draws.below(3);
    let rows = (cells as f64 * (1.0 + apart * (count - 1) as f64 / width)).round() as usize;
    let grid = Grid::new([rows, cells], [width * rows as f64 / cells as f64, width]).unwrap();
    let tolerance = 10f64.powi(-2 - draws.below(2) as i32);
    let force = 16.0 / 3.0 * left.max(0.1) * modulus * (RADIUS * depth.powi(3)).sqrt();
    let controls: Vec<Control> = (0..count)
        .map(|_| match draws.below(3) {
            0 => Control::Force(force * draws.between(0.2, 1.0)),
            1 => Control::Approach { touch: 0.0, depth: depth * draws.between(0.2, 1.0) },
            _ => Control::by_spring(draws, 0.0, 0.5 * depth, 0.5 * force),
        })
        .collect();
    let histories: Vec<_> = controls.iter().map(|&control| random_history(draws, control, 1.0, true)).collect();
    let names: Vec<_> =
        histories.iter().zip(&controls).map(|(history, own)| format!("{own:?} {}", history.name)).collect();
    let name = format!("{number}: {kind}, memory {memory:.3}, {tolerance:.0e}, {rows} × {cells}: {}", names.join("; "));
    Several { name, tolerance, until: 1.0, body, grid, places, controls, histories }
}

impl Several {
    fn builder(&self) -> Builder {
        let ball = |x1: f64| Shifted::new(Sphere::new(RADIUS).unwrap(), [x1, 0.0]).unwrap();
        let first = ViscoelasticContact::builder(self.grid.clone()).geometry(&ball(self.places[0]));
        self.places[1..]
            .iter()
            .fold(first, |builder, &place| builder.another_body(&ball(place)))
            .material(self.body.clone())
    }

    fn contact(&self, rule: TimeRule, tolerance: f64) -> ViscoelasticContact {
        let settings = Settings::default().with_edge(Edge::Allow).with_time_rule(rule).with_tolerance(tolerance);
        self.builder().settings(settings).build().unwrap()
    }

    fn histories(&self) -> Vec<&dyn LoadHistory> {
        self.histories.iter().map(|own| &*own.history).collect()
    }

    /// Times to compare, none at a corner, where loads may jump.
    fn times(&self) -> Vec<f64> {
        (1..=SAMPLES).map(|k| self.until * (k as f64 - 0.377) / SAMPLES as f64).collect()
    }

    fn answers(&self, contact: &ViscoelasticContact) -> Answers {
        let bodies = (0..self.places.len()).map(|body| contact.fields().body(body).unwrap());
        bodies.map(|state| [state.force, state.approach]).collect()
    }

    /// The answers by steps that are taken one by one, and the greatest of each quantity: so many between two times, finer after
    /// corners.
    fn marched(&self, parts: usize) -> Option<(Vec<Answers>, [f64; 2])> {
        let mut contact = self.contact(TimeRule::ExponentialLinear, 1e-9);
        let (times, histories) = (self.times(), self.histories());
        let mut ends: Vec<f64> = times.clone();
        ends.extend(self.histories.iter().flat_map(|own| own.corners.iter().copied()));
        ends.retain(|time| *time > 0.0 && *time <= self.until);
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|later, earlier| *later - *earlier <= 1e-9 * self.until);
        let (mut found, mut greatest, mut now) = (Vec::new(), [0.0_f64; 2], 0.0);
        let at = |time: f64| histories.iter().map(|history| history.at(time)).collect::<Vec<_>>();
        contact.step(0.0, at(0.0)).ok()?;
        for end in ends {
            for k in 1..=parts {
                // quadratically graded towards the corner that may have been passed
                let next = now + (end - now) * (k as f64 / parts as f64).powi(2);
                let next = if k == parts { end } else { next };
                let before: Vec<_> = histories.iter().map(|history| history.before(next)).collect();
                contact.step(next - contact.time(), before).ok()?;
                for [force, approach] in self.answers(&contact) {
                    greatest =
                        [greatest[0].max(force), if force > 0.0 { greatest[1].max(approach) } else { greatest[1] }];
                }
            }
            if times.contains(&end) {
                found.push(self.answers(&contact));
            }
            let loads = at(end);
            if histories.iter().any(|history| history.before(end) != history.at(end)) {
                contact.step(0.0, loads).ok()?;
            }
            now = end;
        }
        Some((found, greatest))
    }

    /// Greatest difference over the tolerance: of the forces over the greatest force of any body, of the approaches over the greatest
    /// approach, each where the load leaves them free, and a body that is apart has no approach of its own.
    fn difference(&self, one: &[Answers], other: &[Answers], greatest: [f64; 2]) -> f64 {
        assert_eq!((one.len(), other.len()), (SAMPLES, SAMPLES), "{}", self.name);
        let of = |(a, b): (&Answers, &Answers)| {
            let bodies = a.iter().zip(b).zip(&self.controls).map(|((a, b), control)| {
                let force = (a[0] - b[0]).abs() / greatest[0];
                let approach = (a[1] - b[1]).abs() / greatest[1];
                match control {
                    Control::Approach { .. } => force,
                    Control::Force(_) | Control::EccentricForce(..) if a[0] == 0.0 => 0.0,
                    Control::Force(_) | Control::EccentricForce(..) => approach,
                    Control::Spring { .. } => force.max(approach),
                }
            });
            bodies.fold(0.0, f64::max)
        };
        one.iter().zip(other).map(of).fold(0.0, f64::max) / self.tolerance
    }

    /// The answers by an adaptive run, and its convolutions.
    fn run(&self) -> (Vec<Answers>, f64) {
        let mut contact = self.contact(TimeRule::Exponential, Settings::default().tolerance());
        let run = contact.follow_each(&self.histories(), Stepping::adaptive(self.tolerance), self.until).unwrap();
        let (mut run, mut found, mut work) = (run.sample_at(self.times()).unwrap(), Vec::new(), 0.0);
        while let Some(report) = run.next_step().unwrap_or_else(|error| panic!("{}: {error}", self.name)) {
            work += report.convolution_equivalents();
            for sample in run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for()) {
                found.push(self.answers(sample.contact()));
            }
        }
        (found, work)
    }
}

/// True errors of several indenters are at most twice what was asked in 99 % of random runs, and at most four times in all.
#[test]
fn each_body_follows_its_own_history() {
    let [scenes, seed, most] = [("BODIES_SCENES", 4), ("BODIES_SEED", 1), ("BODIES_STEPS", 5_000)]
        .map(|(name, default)| from_environment(name, default));
    let (mut ratios, mut unknown, mut total) = (Ratios::default(), 0, 0.0);
    for number in 0..scenes {
        let scene = draw(seed, number);
        let (found, work) = scene.run();
        total += work;
        let mut parts = 4;
        let error = loop {
            let [coarse, fine] = [parts, 2 * parts].map(|parts| scene.marched(parts));
            let Some(((coarse, _), (fine, greatest))) = coarse.zip(fine) else { break None };
            if scene.difference(&coarse, &fine, greatest) <= DOUBT {
                break Some(scene.difference(&fine, &found, greatest));
            }
            parts *= 2;
            if 2 * parts * SAMPLES > most as usize {
                break None;
            }
        };
        if from_environment("BODIES_LINES", 0) > 0 {
            println!("{}: {error:.2?} at {work:.0}", scene.name);
        }
        match error {
            Some(error) => ratios.push(error, &scene.name),
            None => unknown += 1,
        }
    }
    ratios.print("true over asked", 5);
    println!("{unknown} without a truth; {total:.0} equivalents");
    assert!(ratios.quantile(0.99) <= 2.0 && ratios.greatest() <= 4.0);
    assert!(3 * unknown <= scenes, "{unknown} of {scenes} without a truth");
}

/// Given steps of a run are those that one takes oneself, bit by bit, and end at the corners of all histories; events and saved
/// runs see all bodies.
#[test]
fn runs_of_several_bodies_have_what_others_have() {
    let scene = draw(3, 2);
    let start = || scene.contact(TimeRule::Exponential, 1e-6);
    let ramps_to = |end: fn(usize) -> f64| {
        let bodies = scene.controls.iter().enumerate();
        bodies.map(|(k, own)| Ramp::new(own.load(0.0), own.load(1.0), end(k)).unwrap()).collect::<Vec<_>>()
    };
    let [smooth, ramps] = [ramps_to(|_| 2.0), ramps_to(|k| 0.3 + 0.1 * k as f64)];
    let [smooth, histories] =
        [&smooth, &ramps].map(|ramps| ramps.iter().map(|ramp| ramp as &dyn LoadHistory).collect::<Vec<_>>());
    let (mut by_hand, mut led) = (start(), start());
    let mut run = led.follow_each(&smooth, Stepping::fixed(0.125), 1.0).unwrap();
    while let Some(report) = run.next_step().unwrap() {
        let loads: Vec<Load> = smooth.iter().map(|history| history.at(report.time)).collect();
        by_hand.step(report.time - by_hand.time(), loads).unwrap();
        assert_eq!(by_hand.pressure(), run.contact().pressure(), "at {}", report.time);
    }
    assert!(by_hand.time() == 1.0 && by_hand.contact_cells() > 0);

    let (mut contact, mut ends) = (start(), Vec::new());
    let mut run = contact.follow_each(&histories, Stepping::fixed(0.25), 1.0).unwrap();
    while let Some(report) = run.next_step().unwrap() {
        ends.push(report.time);
    }
    assert!((0..ramps.len()).all(|k| ends.contains(&(0.3 + 0.1 * k as f64))), "{ends:?}");

    // an event of the last body
    let last = scene.places.len() - 1;
    let force = move |contact: &ViscoelasticContact| contact.fields().body(last).unwrap().force;
    let most = force(&contact);
    let mut contact = start();
    let run = contact.follow_each(&histories, Stepping::adaptive(1e-2), 1.0).unwrap();
    let mut run = run.stop_when(force, Crossing::Up(0.25 * most)).unwrap();
    let mut met = None;
    while let Some(report) = run.next_step().unwrap() {
        met = met.or(run.events()[0].is_met().then_some(report.time));
    }
    assert!(met.is_some_and(|time| time > 0.0 && time < 0.5), "{met:?}, pressed to {most} N");

    // the same steps from a file
    let file = Temporary::file("several-histories");
    let mut through = start();
    let mut run = through.follow_each(&histories, Stepping::adaptive(1e-2), 1.0).unwrap();
    while run.next_step().unwrap().is_some_and(|report| report.time < 0.2) {}
    run.save(&*file).unwrap();
    while run.next_step().unwrap().is_some() {}
    let mut resumed = start();
    resumed.resume(&*file).unwrap();
    assert!(resumed.time() > 0.0 && resumed.time() < 1.0);
    let mut run = resumed.follow_each(&histories, Stepping::adaptive(1e-2), 1.0).unwrap();
    while run.next_step().unwrap().is_some() {}
    assert_eq!(resumed.pressure(), through.pressure());

    // one history for each body, and fields to an accuracy of one body alone
    let error = start().follow_each(&histories[1..], Stepping::fixed(0.1), 1.0).unwrap_err();
    let expected = matches!(error, Error::WrongLength { len, expected, .. } if (len, expected) == (last, last + 1));
    assert!(expected && error.to_string().contains("load histories"), "{error}");
    let mut contact = start();
    let run = contact.follow_each(&histories, Stepping::adaptive(1e-2), 1.0).unwrap();
    assert!(run.fields_to(1e-2).unwrap_err().to_string().contains("rigid bodies of a run with fields"));
}
