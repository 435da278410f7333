//! Does every contact keep the same promises along a run? Each behaviour goes through a contact in space and one on elastic states.

use std::error::Error as _;
use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use viscocontact::adhesion::{Attraction, ExponentialAttraction};
use viscocontact::geometry::Sum;
use viscocontact::motion::{FnPath, Path, Straight, Travel};
use viscocontact::output::Format;
use viscocontact::prelude::*;
use viscocontact::rheology::TimeTemperature;

use viscocontact::{Error, UserError};

use crate::common::refused::refused;
use crate::common::{Draws, RADIUS, Temporary, builder_of, contact_of, from_environment, sphere_on, zener as rubber};

fn in_space() -> ViscoelasticContact {
    sphere_on(Grid::square(24, 4.0e-3).unwrap(), rubber(), Settings::default())
}

fn on_states() -> StatesContact {
    StatesContact::new(&ElasticStates::sphere(RADIUS).unwrap(), &rubber()).unwrap()
}

/// A kind of contact: a new one, and its runs.
struct Kind<C: Contact + 'static> {
    new: fn() -> C,
    resume: fn(&mut C, &std::path::Path) -> viscocontact::Result<()>,
    /// The approach at which the body touches.
    touch: f64,
}

impl<C: Contact + Send> Kind<C> {
    fn run(&self, load: impl LoadHistory + 'static, stepping: Stepping, until: f64) -> Run<'static, C> {
        (self.new)().into_follow(load, stepping, until)
    }
}

const STEPPINGS: [Stepping; 2] = [Stepping::Fixed { dt: 0.13 }, Stepping::Adaptive { tolerance: 1e-3 }];

fn hold(force: f64) -> StepLoad {
    StepLoad::new(Load::force(force)).unwrap()
}

/// Ends, forces and approaches of all steps.
fn steps<C: Contact>(mut run: Run<'static, C>) -> Vec<[f64; 3]> {
    let mut steps = Vec::new();
    while let Some(report) = run.next_step().unwrap() {
        steps.push([report.time, report.force, report.approach]);
    }
    steps
}

/// Runs the behaviours below through each kind of contact.
macro_rules! behaviours {
    ($($name:ident: $kind:ident, $generic:ident => $check:block)*) => {$(
        #[test]
        fn $name() {
            fn check<$generic: Contact + Send>($kind: &Kind<$generic>) $check
            let grid = Grid::square(24, 4.0e-3).unwrap();
            let touch = Sphere::new(RADIUS).unwrap().initial_gap(0.5 * grid.spacing()[0], 0.5 * grid.spacing()[1]);
            check(&Kind { new: in_space, resume: |contact, path| contact.resume(path), touch });
            check(&Kind { new: on_states, resume: |contact, path| contact.resume(path), touch: 0.0 });
        }
    )*};
}

behaviours! {
    steps_too_short_to_change_the_time_are_refused: kind, C => {
        for dt in [1e-30, 1e-22, 1e-18] {
            let mut contact = (kind.new)();
            contact.step(0.0, Load::force(0.5)).unwrap();
            contact.step(1.0, Load::force(0.5)).unwrap();
            let mut run = contact.into_follow(hold(0.5), Stepping::fixed(dt), 2.0);
            // a first step of length zero may apply the load
            let error = (0..2).find_map(|_| run.next_step().err()).unwrap();
            assert!(matches!(error, Error::OutOfRange { field: "fixed step", .. }), "{error}");
            assert_eq!(run.contact().time(), 1.0);
        }
    }

    invalid_runs_are_refused: kind, C => {
        let first = |stepping, until| kind.run(hold(0.5), stepping, until).next_step().err();
        for end in [-1.0, f64::NAN, f64::INFINITY] {
            refused([(first(Stepping::fixed(0.1), end), "end of the run")]);
        }
        for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            refused([(first(Stepping::fixed(dt), 1.0), "fixed step")]);
        }
        for tolerance in [0.0, -1.0, 1e-10, 0.2, f64::NAN] {
            refused([(first(Stepping::adaptive(tolerance), 1.0), "tolerance of the adaptive steps")]);
        }
        let run = || kind.run(hold(0.5), Stepping::fixed(0.1), 1.0);
        refused([
            (run().stop_at([f64::NAN]).err(), "time to stop at or to sample"),
            (run().sample_at(Times::every(0.0)).err(), "interval of times"),
            (run().stop_when(|contact| contact.force(), Crossing::Up(f64::NAN)).err(), "value of an event"),
        ]);
        let load = FnHistory::new(|t| Load::force(0.5 - t));
        let mut run = kind.run(load, Stepping::fixed(0.2), 1.0);
        let error = std::iter::from_fn(|| Some(run.next_step())).find_map(Result::err).unwrap();
        assert!(matches!(error, Error::LoadOutOfRange { .. }), "{error}");
    }

    quantities_that_are_no_number_end_the_run: kind, C => {
        for (number, stepping) in STEPPINGS.into_iter().cycle().take(8).enumerate() {
            let mut draws = Draws::new(number as u64 + 71_600_000);
            let (load, last) = (Sinusoid::about(Load::force(0.3), 0.2, 0.7).unwrap(), draws.between(0.1, 1.9));
            let mut run = kind.run(load, stepping, 2.0);
            // infinite before the load acts, which is allowed
            let quantity = move |contact: &C| if contact.time() > last { f64::NAN } else { 1.0 / contact.force() };
            run = run.stop_when(quantity, Crossing::Up(1e9)).unwrap();
            let mut state = [0.0; 3];
            let error = loop {
                match run.next_step() {
                    Ok(report) => state = report.map(|report| [report.time, report.force, report.approach]).unwrap(),
                    Err(error) => break error,
                }
            };
            assert!(matches!(error, Error::OutOfRange { field: "quantity of Run::stop_when", .. }), "{error}");
            let contact = run.contact();
            assert_eq!([contact.time(), contact.force(), contact.approach()], state);
            assert!(state[0] <= last, "a step to {} has passed {last}", state[0]);
        }
    }

    times_of_every_kind_are_met: kind, C => {
        let times = || Times::decades(1e-2, 3).and(Times::every(0.5)).and([0.77, 9.0]);
        let mut expected: Vec<f64> = (0..9).map(|k| 1e-2 * 10f64.powf(f64::from(k) / 3.0)).collect();
        expected.extend((1..=20).map(|k| 0.5 * f64::from(k)).chain([0.77]));
        expected.sort_by(f64::total_cmp);
        expected.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let are_near = |found: f64, expected: f64| (found - expected).abs() <= 1e-12 * expected;
        for stepping in STEPPINGS {
            let stopped = |times: Times| steps(kind.run(hold(0.5), stepping, 10.0).stop_at(times).unwrap());
            let ends = stopped(times());
            assert!(expected.iter().all(|time| ends.iter().any(|end| are_near(end[0], *time))), "{ends:?}");
            let mut run = kind.run(hold(0.5), stepping, 10.0).sample_at(times()).unwrap();
            let mut asked = Vec::new();
            assert_eq!(run.samples().count(), 0, "no step yet");
            while run.next_step().unwrap().is_some() {
                let samples = run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for());
                asked.extend(samples.map(|sample| sample.report().time));
            }
            assert_eq!(run.samples().count(), 0, "the run is over");
            assert!(asked.len() == expected.len() && asked.iter().zip(&expected).all(|(a, b)| are_near(*a, *b)), "{asked:?}");
            let given = [0.7, 0.31, 10.0];
            let found = stopped(Times::from(given));
            assert!([0.31, 0.7, 10.0].iter().all(|time| found.iter().any(|step| step[0] == *time)), "{found:?}");
            assert_eq!([stopped(Times::from(given.to_vec())), stopped(Times::from(&given[..]))], [found.clone(), found]);
        }
    }

    corners_jumps_and_multiples_are_met_exactly: kind, C => {
        // one of the contacts begins with a step over no time
        let table = [(0.0, 0.0), (0.3, 0.3), (0.7, 0.3), (0.7, 0.1), (2.0, 0.1)].map(|(time, force)| (time, Load::force(force)));
        let mut found = steps(kind.run(PiecewiseLinear::new(&table).unwrap(), Stepping::fixed(0.5), 1.2));
        found.retain(|step| step[0] > 0.0);
        let expected = [(0.3, 0.3), (0.5, 0.3), (0.7, 0.3), (0.7, 0.1), (1.0, 0.1), (1.2, 0.1)];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, (time, force)) in found.iter().zip(expected) {
            assert!(found[0] == time && (found[1] - force).abs() < 1e-9, "{found:?}, {time} {force}");
        }
        let ramp = Ramp::new(Load::force(0.0), Load::force(0.4), 0.7).unwrap();
        let ends: Vec<f64> = steps(kind.run(ramp, Stepping::fixed(0.1), 1.0)).iter().map(|step| step[0]).filter(|end| *end > 0.0).collect();
        assert_eq!(ends, [0.1, 0.2, 3.0 * 0.1, 0.4, 0.5, 6.0 * 0.1, 0.7, 0.8, 0.9, 1.0]);
        // another load than the last step's is a jump, and the end is the end
        let mut contact = (kind.new)();
        contact.step(0.35, Load::force(0.2)).unwrap();
        let mut run = contact.into_follow(hold(0.5), Stepping::fixed(0.25), 0.5);
        let lengths: Vec<f64> = std::iter::from_fn(|| run.next_step().unwrap()).map(|report| report.dt).collect();
        assert_eq!((lengths.len(), lengths[0], run.next_step()), (2, 0.0, Ok(None)));
    }

    samples_leave_the_steps_and_know_whether_they_were_asked_for: kind, C => {
        for stepping in STEPPINGS {
            let times = [1e-9, 0.05, 0.31, 0.62, 1.9];
            let load = || Sinusoid::about(Load::force(0.4), 0.3, 0.6).unwrap();
            let mut run = kind.run(load(), stepping, 2.0).sample_at(times).unwrap();
            let (mut found, mut ends, mut asked) = (Vec::new(), 0, Vec::new());
            while let Some(report) = run.next_step().unwrap() {
                found.push([report.time, report.force, report.approach]);
                for sample in run.samples() {
                    let sample = sample.unwrap();
                    let (report_of, contact) = (sample.report(), sample.contact());
                    assert_eq!([report_of.time, report_of.force], [contact.time(), contact.force()]);
                    assert_eq!(report_of.time_error, report.time_error);
                    let force = if let Load::Force { normal, .. } = load().at(contact.time()) { normal } else { f64::NAN };
                    assert!((contact.force() - force).abs() <= 1e-9, "{} {force}", contact.force());
                    ends += usize::from(report_of.time == report.time);
                    asked.extend(sample.is_asked_for().then_some(report_of.time));
                }
            }
            assert_eq!(ends, found.len());
            assert_eq!(asked, times);
            assert_eq!(found, steps(kind.run(load(), stepping, 2.0)));
        }
    }

    times_are_one_only_if_they_agree_but_for_rounding: kind, C => {
        // a jump at 0.4, and times beside it; the start, where the load does not jump; two that differ by rounding
        let rows = [(0.0, 0.0), (0.4, 0.1), (0.4, 0.3), (1.0, 0.2)].map(|(time, force)| (time, Load::force(force)));
        let load = || PiecewiseLinear::new(&rows).unwrap();
        let times = [0.0, 0.3999999999, 0.4, 0.4000000001, 0.7, 0.7 + 1e-16, 0.7 - 1e-12, 1.0];
        for stepping in [Stepping::fixed(0.5), Stepping::fixed(0.4), Stepping::adaptive(1e-3)] {
            let mut run = kind.run(load(), stepping, 1.0).sample_at(times).unwrap();
            let mut found = Vec::new();
            while run.next_step().unwrap().is_some() {
                let asked = run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for());
                found.extend(asked.map(|sample| [sample.report().time, sample.contact().force()]));
            }
            let expected = [
                [0.0, 0.0], [0.3999999999, 0.1], [0.4, 0.1], [0.4, 0.3], [0.4000000001, 0.3], [0.7 - 1e-12, 0.25], [0.7, 0.25],
                [1.0, 0.2],
            ];
            assert_eq!(found.len(), expected.len(), "{stepping:?}: {found:?}");
            for (found, expected) in found.iter().zip(&expected) {
                assert!(found[0] == expected[0] && (found[1] - expected[1]).abs() < 1e-6, "{found:?} {expected:?}");
            }
        }
        // times without a state are refused
        for time in [-1e-6, 1.0001, 1e300] {
            let run = || kind.run(load(), Stepping::fixed(0.5), 1.0);
            for refusal in [run().sample_at([0.5, time]).err(), run().stop_at(vec![time]).err()] {
                let text = refusal.expect("refused").to_string();
                assert!(text.contains("time to stop at or to sample") && text.contains("the end of the run"), "{text}");
            }
        }
        assert!(kind.run(load(), Stepping::fixed(0.5), 0.3).stop_at([3.0 * 0.1]).is_ok());
    }

    resumed_runs_sample_every_time_once: kind, C => {
        // corners at multiples of 0.3, and samples at multiples of 0.05, which differ by rounding
        let folder = Temporary::folder("resumed-samples");
        let rows: Vec<_> = (0..4).map(|k| (0.3 * f64::from(k), Load::force(0.02 + 0.01 * f64::from(k % 2)))).collect();
        let load = || PiecewiseLinear::new(&rows).unwrap();
        let samples = |run: &Run<'static, C>| -> Vec<(u64, bool)> {
            run.samples().map(|sample| { let sample = sample.unwrap(); (sample.report().time.to_bits(), sample.is_asked_for()) }).collect()
        };
        let path = folder.join("run");
        let whole = |contact: C| contact.into_follow(load(), Stepping::adaptive(1e-3), 0.9).sample_at(Times::every(0.05)).unwrap();
        let (mut run, mut all, mut cuts) = (whole((kind.new)()).autosave_to(&path, Duration::ZERO), Vec::new(), Vec::new());
        let mut taken = 0;
        while run.next_step().unwrap().is_some() {
            all.extend(samples(&run));
            taken += 1;
            fs::copy(&path, folder.join(format!("run-{taken}"))).unwrap();
            cuts.push(all.len());
        }
        for (k, cut) in cuts.iter().enumerate() {
            let mut contact = (kind.new)();
            (kind.resume)(&mut contact, &folder.join(format!("run-{}", k + 1))).unwrap();
            let (mut run, mut found) = (whole(contact), all[..*cut].to_vec());
            while run.next_step().unwrap().is_some() {
                found.extend(samples(&run));
            }
            assert_eq!(found, all, "resumed after {} steps", k + 1);
        }
        let asked = all.iter().filter(|sample| sample.1).count();
        assert!(cuts.len() > 10 && asked == 18, "{} {asked}", cuts.len());
    }

    fixed_steps_look_at_no_load_ahead: kind, C => {
        // the latest time at which a load is asked for; its breakpoints are those of a channel that is read a little ahead
        #[derive(Debug)]
        struct Channel(Arc<std::sync::Mutex<f64>>);
        impl LoadHistory for Channel {
            fn at(&self, t: f64) -> Load {
                let mut latest = self.0.lock().unwrap();
                *latest = latest.max(t);
                Load::force(0.2 + 0.1 * t)
            }
            fn next_breakpoint(&self, after: f64) -> Option<f64> {
                Some((10.0 * after).floor() * 0.1 + 0.1)
            }
        }
        let latest = Arc::new(std::sync::Mutex::new(0.0));
        let mut run = kind.run(Channel(Arc::clone(&latest)), Stepping::fixed(0.07), 2.0);
        let (mut steps, mut ends) = (0, 0.0);
        while let Some(report) = run.next_step().unwrap() {
            let asked = *latest.lock().unwrap();
            assert!(asked <= report.time && report.time >= ends, "{asked} after {}", report.time);
            (steps, ends) = (steps + 1, report.time);
        }
        assert!(steps > 30 && ends == 2.0);
    }

    a_flag_ends_a_step_and_the_run_goes_on: kind, C => {
        for stepping in STEPPINGS {
            let plain = steps(kind.run(hold(0.5), stepping, 2.0));
            let flag = Arc::new(AtomicBool::new(false));
            let mut run = kind.run(hold(0.5), stepping, 2.0).cancelled_by(Arc::clone(&flag));
            let mut found = Vec::new();
            loop {
                flag.store(true, Ordering::Relaxed);
                let now = run.contact().time();
                if found.len() < plain.len() {
                    assert!(matches!(run.next_step(), Err(Error::Cancelled { .. })));
                    assert_eq!((run.contact().time(), run.samples().count()), (now, 0));
                }
                flag.store(false, Ordering::Relaxed);
                let Some(report) = run.next_step().unwrap() else { break };
                found.push([report.time, report.force, report.approach]);
            }
            assert_eq!(found, plain);

            // raised within a step, by the load when it is asked for so many times
            let raised = |raises: &[usize]| {
                let (flag, asked) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
                let (sets, counts, raises) = (Arc::clone(&flag), Arc::clone(&asked), raises.to_vec());
                let load = FnHistory::new(move |t| {
                    if raises.contains(&counts.fetch_add(1, Ordering::Relaxed)) {
                        sets.store(true, Ordering::Relaxed);
                    }
                    Load::force(0.1 + 0.3 * (t / (1.0 + t)))
                });
                let mut run = kind.run(load, stepping, 20.0).cancelled_by(Arc::clone(&flag));
                let (mut steps, mut cancelled) = (Vec::new(), 0);
                loop {
                    match run.next_step() {
                        Ok(Some(report)) => steps.push([report.time, report.force, report.approach]),
                        Ok(None) => return (steps, cancelled, asked.load(Ordering::Relaxed)),
                        Err(error) => {
                            assert!(matches!(error, Error::Cancelled { .. }), "{error}");
                            assert_eq!(run.contact().time(), steps.last().map_or(0.0, |step| step[0]));
                            flag.store(false, Ordering::Relaxed);
                            cancelled += 1;
                        }
                    }
                }
            };
            let (plain, none, asked) = raised(&[]);
            let (found, cancelled, _) = raised(&[asked * 82 / 100, asked * 92 / 100]);
            // a step may be asked for at many times
            assert!(none == 0 && (1..=2).contains(&cancelled) && found == plain, "{cancelled}: {found:?}, {plain:?}");
        }
    }

    progress_counts_all_steps: kind, C => {
        for stepping in STEPPINGS {
            let mut run = kind.run(hold(0.5), stepping, 4.0);
            let mut count = 0;
            while let Some(report) = run.next_step().unwrap() {
                count += 1;
                let progress = run.progress();
                assert_eq!((progress.steps, progress.time, progress.share_of_time()), (count, report.time, report.time / 4.0));
                assert!(run.within_step(report.time + 1e-3).is_err() && run.within_step(-1e-3).is_err());
                if let Stepping::Adaptive { tolerance } = stepping {
                    assert!(report.time_error.is_some_and(|error| error <= tolerance));
                }
            }
            assert!(count > 3 && run.progress().share_of_decades() == 1.0);
            assert_eq!(run.into_contact().time(), 4.0);
        }
    }

    runs_that_were_saved_go_on_by_the_same_steps: kind, C => {
        let folder = Temporary::folder("saved-run");
        let load = || Sinusoid::about(Load::force(0.4), 0.3, 0.6).unwrap();
        for stepping in STEPPINGS {
            let whole = steps(kind.run(load(), stepping, 2.0));
            for taken in 1..whole.len() {
                let path = folder.join("run");
                let mut run = kind.run(load(), stepping, 2.0).autosave_to(&path, Duration::ZERO);
                for _ in 0..taken {
                    run.next_step().unwrap();
                }
                drop(run);
                let mut contact = (kind.new)();
                (kind.resume)(&mut contact, &path).unwrap();
                let run = contact.into_follow(load(), stepping, 2.0);
                assert_eq!(run.progress().steps as usize, taken);
                assert_eq!(steps(run), whole[taken..], "{stepping:?} after {taken} steps");
            }
            assert!(whole.len() > 8);
        }
    }

    crossings_within_a_step_are_not_missed: kind, C => {
        // all crossings of a dense look at the steps are at their ends, but for pairs within a 64th of a step
        let (mut found, mut missed, mut close) = (0, 0, 0);
        for number in 0..from_environment("EVENT_SCENES", 8) {
            let mut draws = Draws::new(number + 57_000_001);
            let (mean, period) = (draws.between(0.2, 0.4), draws.power_of_ten(-0.7, 0.5));
            let amplitude = mean * draws.between(0.1, 0.9);
            let load = Sinusoid::about(Load::force(mean), amplitude, 1.0 / period).unwrap();
            let stepping = if draws.chance(0.5) { Stepping::fixed(draws.between(0.1, 1.5)) } else { Stepping::adaptive(1e-3) };
            let level = mean + amplitude * draws.between(-1.02, 1.02);
            let by_force = draws.chance(0.5);
            let quantity = move |contact: &C| if by_force { contact.force() } else { contact.contact_area() * 1e6 };
            let value = if by_force { level } else { draws.between(0.2, 1.5) };
            let up = draws.chance(0.5);
            let crossing = if up { Crossing::Up(value) } else { Crossing::Down(value) };
            let beyond = |contact: &C| if up { quantity(contact) - value } else { value - quantity(contact) };
            let mut run = kind.run(load, stepping, 3.0).stop_when(quantity, crossing).unwrap();
            let mut start = 0.0;
            while let Some(report) = run.next_step().unwrap() {
                found += usize::from(run.events()[0].is_met());
                let looks: Vec<f64> = (1..128)
                    .map(|k| start + (report.time - start) * f64::from(k) / 128.0)
                    .filter(|time| start < *time && *time < report.time)
                    .map(|time| beyond(&run.within_step(time).unwrap()))
                    .collect();
                let is_beyond = |k: &usize| looks[*k] > 1e-5 && looks[*k - 1] < 0.0;
                for k in (1..looks.len()).filter(is_beyond) {
                    let width = looks[k..].iter().take_while(|beyond| **beyond > 0.0).count();
                    missed += 1;
                    close += usize::from(width <= 2);
                }
                start = report.time;
            }
        }
        println!("{found} crossings found, {missed} missed, {close} of them within a 64th of a step");
        assert!(found > 5 && missed == close, "{found} {missed} {close}");
    }

    touch_and_separation_are_events: kind, C => {
        // the body first touches at a known time; it parts where the force has just become 0
        let load = || Sinusoid::about(Load::approach(kind.touch), 20.0e-6, 0.5).unwrap();
        for stepping in STEPPINGS {
            let run = kind.run(load(), stepping, 8.0).stop_when(|contact| contact.force(), Crossing::Down(0.0)).unwrap();
            let run = run.stop_when(|contact| contact.force(), Crossing::Up(0.0)).unwrap();
            // a force that is rounding beside what acted before
            let mut run = run.stop_when(|contact| contact.force(), Crossing::Up(1e-12)).unwrap();
            let (mut parted, mut before, mut last) = (0, 0.0, 0.0);
            while let Some(report) = run.next_step().unwrap() {
                if run.events()[0].is_met() {
                    parted += 1;
                    assert!(report.force <= 1e-4 * before && before > 0.0, "{:e} {before}", report.force);
                    let just_before = run.within_step(last + (1.0 - 1e-4) * (report.time - last)).unwrap();
                    assert!(just_before.force() > 0.0, "{:e}", just_before.force());
                }
                (before, last) = (report.force, report.time);
            }
            assert_eq!((parted, run.events()[0].times().len()), (4, 4));
            let touches = run.events()[1].times();
            assert_eq!([touches.len(), run.events()[2].times().len()], [4; 2], "{touches:?}");
            assert!(touches[0] < 2e-3, "{touches:?}");
            for (touch, part) in touches.iter().skip(1).zip(run.events()[0].times()) {
                assert!(touch > part, "{touches:?}");
            }
        }
    }

    crossings_are_found_to_a_millionth_of_a_step: kind, C => {
        // forces are prescribed, so that all times are known: also of two crossings within a step, and at its start or end
        let (mean, amplitude) = (0.3, 0.2);
        let load = || Sinusoid::about(Load::force(mean), amplitude, 1.0).unwrap();
        for (dt, until) in [(0.5, 4.0), (0.07, 3.0), (0.25, 3.0)] {
            for level in [0.45, 0.3 + 0.2 * 0.7, 0.15, 0.3] {
                for crossing in [Crossing::Up(level), Crossing::Down(level)] {
                    let run = kind.run(load(), Stepping::fixed(dt), until);
                    let mut run = run.stop_when(|contact| contact.force(), crossing).unwrap();
                    while run.next_step().unwrap().is_some() {}
                    let angle = ((level - mean) / amplitude).asin() / std::f64::consts::TAU;
                    let phase = if let Crossing::Up(_) = crossing { angle } else { 0.5 - angle };
                    // the sine may begin and end at the value itself
                    let inside = |time: &f64| *time > 1e-5 && *time < until - 1e-5;
                    let expected: Vec<f64> = (-1..10).map(|k| f64::from(k) + phase).filter(inside).collect();
                    let found: Vec<f64> = run.events()[0].times().iter().copied().filter(inside).collect();
                    assert_eq!(found.len(), expected.len(), "{dt} {crossing:?}: {found:?} {expected:?}");
                    for (found, expected) in found.iter().zip(&expected) {
                        assert!((found - expected).abs() <= 2e-6 * dt, "{dt} {crossing:?}: {found} {expected}");
                    }
                }
            }
        }
    }

    events_of_free_quantities: kind, C => {
        // a body that sinks under a held force passes an approach once
        for stepping in STEPPINGS {
            let [first, .., end] = steps(kind.run(hold(0.5), stepping, 5.0))[..] else { panic!("few steps") };
            let value = first[2] + Draws::new(7).between(0.2, 0.8) * (end[2] - first[2]);
            let run = kind.run(hold(0.5), stepping, 5.0).stop_when(|contact| contact.approach(), Crossing::Up(value)).unwrap();
            // met never, and true from the beginning
            let run = run.stop_when(|contact| contact.approach(), Crossing::Down(value)).unwrap();
            let run = run.stop_when(|contact| contact.contact_area(), Crossing::Up(1.0)).unwrap();
            let mut run = run.stop_when(|contact| contact.force(), Crossing::Down(0.6)).unwrap();
            let mut at = f64::NAN;
            while run.next_step().unwrap().is_some() {
                if run.events()[0].is_met() {
                    at = run.contact().approach();
                }
            }
            // an adaptive step to the event is another step than the one in which it was found
            let allowed = if let Stepping::Adaptive { tolerance } = stepping { tolerance } else { 1e-6 };
            assert!((at - value).abs() <= allowed * value, "{at} {value}");
            let counts: Vec<usize> = run.events().iter().map(|event| event.times().len()).collect();
            assert_eq!(counts, [1, 0, 0, 0]);
            assert!(run.events()[3].is_beyond() && !run.events()[2].is_beyond());
        }
    }

    errors_of_users_come_out_of_the_step: kind, C => {
        #[derive(Debug, PartialEq)]
        struct Silent(f64);
        impl std::fmt::Display for Silent {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "the sensor gave nothing after {} s", self.0)
            }
        }
        impl std::error::Error for Silent {}
        for stepping in STEPPINGS {
            let load = FnHistory::fallible(|t| if t < 1.0 { Ok(Load::force(0.5)) } else { Err(Silent(1.0)) });
            // adaptive runs look at the whole history when they begin
            let mut run = kind.run(load, stepping, 2.0);
            let error = std::iter::from_fn(|| Some(run.next_step())).find_map(Result::err).unwrap();
            assert!(matches!(error, Error::User(_)), "{error}");
            assert_eq!(error.source().unwrap().downcast_ref(), Some(&Silent(1.0)));
            let (now, error) = (run.contact().time(), run.next_step().unwrap_err());
            assert_eq!((run.contact().time(), error.to_string()), (now, "the load history failed".to_owned()));
        }
    }
}

/// Gaps and creep functions that fail.
#[test]
fn errors_of_gaps_and_creep_come_out_as_themselves() {
    let build = |gap: bool, creep: bool| {
        let gap = FnGeometry::fallible(move |x1, x2| if gap { "x".parse() } else { Ok((x1 * x1 + x2 * x2) / 2.0e-2) });
        let creep =
            FnRheology::fallible(move |t| if creep && t > 0.0 { "x".parse() } else { Ok(1.0e-6 * (1.0 + t.ln_1p())) });
        // inside of another rheology
        let creep = TimeTemperature::arrhenius(1.0e5, 293.15)?.at(creep, 293.15)?;
        let builder = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?).geometry(&gap);
        let mut contact = builder.material(Material::incompressible(creep)).times(1e-3..=1e3).build()?;
        contact.step(0.0, Load::force(0.5))?;
        contact.step(0.1, Load::force(0.5))?;
        contact.step(0.1, Load::force(0.5))
    };
    build(false, false).unwrap();
    let own = |error: Error| {
        assert!(matches!(error, Error::User(_)), "{error}");
        assert!(error.source().unwrap().is::<std::num::ParseFloatError>());
    };
    [(true, false), (false, true)].into_iter().for_each(|(gap, creep)| own(build(gap, creep).unwrap_err()));
    // inside of other shapes
    let failing = || FnGeometry::fallible(|_, _| "x".parse::<f64>());
    let shapes: [Box<dyn Geometry>; 3] = [
        Box::new(Shifted::new(failing(), [1.0e-4, 0.0]).unwrap()),
        Box::new(Sum::new(Sphere::new(10.0e-3).unwrap(), failing())),
        Box::new(Repeated::new(failing(), [2.0e-3; 2]).unwrap()),
    ];
    for shape in &shapes {
        let builder = ViscoelasticContact::builder(Grid::square(16, 4.0e-3).unwrap()).geometry(shape);
        own(builder.material(Material::incompressible(Elastic::new(1.0e6).unwrap())).build().unwrap_err());
    }
}

/// Paths and laws of attraction that fail after a while, on bodies of both kinds of solver for attraction.
#[test]
fn errors_of_paths_and_attraction_come_out_as_themselves() {
    // once, when it has been asked so many times
    #[derive(Debug)]
    struct Once(ExponentialAttraction, Arc<AtomicUsize>, AtomicBool);
    impl Attraction for Once {
        fn traction(&self, gap: f64) -> f64 {
            let fails = self.1.fetch_sub(1, Ordering::Relaxed) == 0;
            self.2.fetch_or(fails, Ordering::Relaxed);
            if fails { f64::NAN } else { self.0.traction(gap) }
        }
        fn energy(&self, gap: f64) -> f64 {
            self.0.energy(gap)
        }
        fn failure(&self) -> Option<UserError> {
            let failed = self.2.swap(false, Ordering::Relaxed);
            failed.then(|| UserError::new("the law", "x".parse::<f64>().unwrap_err()))
        }
    }
    let (left, never) = (Arc::new(AtomicUsize::new(usize::MAX)), usize::MAX);
    let law =
        |range: f64| Once(ExponentialAttraction::new(1.0, range).unwrap(), Arc::clone(&left), AtomicBool::default());
    let (grid, ball) = (Grid::square(32, 4.0e-3).unwrap(), Sphere::new(10.0e-3).unwrap());
    let material = || Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0).unwrap());
    let own = |error: Error| {
        assert!(matches!(error, Error::User(_)), "{error}");
        assert!(error.source().unwrap().is::<std::num::ParseFloatError>());
    };
    for periodic in [false, true] {
        let builder = || {
            let builder = builder_of(&ball, grid.clone(), material());
            let builder = if periodic { builder.kernel(InfluenceKernel::periodic(&grid).unwrap()) } else { builder };
            builder.attraction(law(1.0e-5))
        };
        left.store(0, Ordering::Relaxed);
        own(builder().build().unwrap_err());
        left.store(never, Ordering::Relaxed);
        let mut contact = builder().build().unwrap();
        contact.step(0.1, Load::approach(1.0e-5)).unwrap();
        let before = (contact.time(), contact.force().to_bits());
        left.store(0, Ordering::Relaxed);
        own(contact.step(0.1, Load::approach(1.1e-5)).unwrap_err());
        assert_eq!((contact.time(), contact.force().to_bits()), before);
    }
    let path = FnPath::fallible(|t| if t < 0.15 { Ok([1.0e-3 * t, 0.0]) } else { "x".parse().map(|x1| [x1, 0.0]) });
    // anywhere in a step that snaps: its jump is looked for in parts
    let (small, fine) = (Sphere::new(1.0e-3).unwrap(), Grid::square(128, 1.0e-3).unwrap());
    let exact = Settings::default().with_tolerance(1e-9);
    let mut contact = builder_of(&small, fine, material()).settings(exact).attraction(law(2.0e-6)).build().unwrap();
    // so that the first guess of a step is extrapolated from two
    contact.step(0.1, Load::approach(-1.5e-5)).unwrap();
    contact.step(0.1, Load::approach(-1.4e-5)).unwrap();
    let start = contact.snapshot();
    left.store(never, Ordering::Relaxed);
    contact.step(0.1, Load::approach(0.0)).unwrap();
    assert!(contact.passes().unwrap().jumped);
    let (force, calls) = (contact.force(), never - left.load(Ordering::Relaxed));
    let pressure = contact.pressure().to_vec();
    for part in 0..16 {
        contact.restore(&start).unwrap();
        let before = (contact.time(), contact.force().to_bits());
        left.store(calls * part / 16, Ordering::Relaxed);
        own(contact.step(0.1, Load::approach(0.0)).unwrap_err());
        assert_eq!((contact.time(), contact.force().to_bits()), before, "{part}");
        contact.step(0.1, Load::approach(0.0)).unwrap();
        assert_eq!(contact.force().to_bits(), force.to_bits(), "{part}: {} {force}", contact.force());
        assert_eq!(contact.pressure(), pressure, "{part}");
    }
    // a shape on a path, or its track, is not known everywhere
    let scan = |most: f64| {
        let gap = move |x1: f64, x2: f64| if x1 > most { "x".parse() } else { Ok((x1 * x1 + x2 * x2) / 2.0e-2) };
        FnGeometry::fallible(gap)
    };
    let along = || Box::new(Straight::new([0.0; 2], [-1.0e-3, 0.0]).unwrap()) as Box<dyn Path>;
    let travels =
        [Travel::new(ball, path), Travel::new(scan(2.0e-3), along()), Travel::new(ball, along()).over(scan(1.0e-3))];
    for (travel, steps) in travels.iter().zip([1, 0, 0]) {
        let mut contact = contact_of(&ball, grid.clone(), material(), Settings::default());
        for _ in 0..steps {
            contact.step_along(travel, 0.1, Load::force(0.5)).unwrap();
        }
        own(contact.step_along(travel, 0.1, Load::force(0.5)).unwrap_err());
        assert_eq!(contact.time(), 0.1 * f64::from(steps));
    }
    // what failed elsewhere, before, does not matter here
    let scan = Arc::new(scan(2.05e-3));
    assert!(scan.initial_gap(3.0e-3, 0.0).is_nan());
    builder_of(&Sum::new(ball, scan), grid, material()).build().unwrap();
}

/// A run that is interrupted at any step and resumed writes the files of one that is not: rows and frames after the save are cut off.
#[test]
fn a_resumed_run_continues_its_files() {
    let load = PiecewiseLinear::new(&[
        (0.0, Load::force(0.2)),
        (0.5, Load::force(0.6)),
        (0.5, Load::force(0.3)),
        (1.0, Load::force(0.3)),
    ])
    .unwrap();
    let (metadata, fields) = (Metadata::new("Ball on rubber"), [Field::Pressure]);
    for format in [Format::Vtk, Format::Npz] {
        for stepping in STEPPINGS {
            let folder = Temporary::folder("resumed-run");
            // runs to the end, or saves before the step `interrupted` and takes some more
            let go_on = |name: &str, interrupted: Option<usize>| {
                let (saved, table, frames) =
                    (folder.join(format!("{name}.state")), folder.join(format!("{name}.csv")), folder.join(name));
                let mut contact = in_space();
                if saved.exists() {
                    contact.resume(&saved).unwrap();
                }
                let mut table = CsvHistory::create(table, &metadata, &contact, &["force "], Earlier::Continue).unwrap();
                let mut series =
                    FrameSeries::create(frames, format, &metadata, &contact, &fields, Earlier::Continue).unwrap();
                let mut run = contact.follow(&load, stepping, 1.0);
                let mut steps = run.progress().steps as usize;
                loop {
                    if Some(steps) == interrupted {
                        run.save(&saved).unwrap();
                    }
                    let Some(report) = run.next_step().unwrap() else { break };
                    steps += 1;
                    table.record(run.contact(), &report, &[report.force]).unwrap();
                    series.record(run.contact()).unwrap();
                    if interrupted.is_some_and(|step| steps == step + 3) {
                        break;
                    }
                }
                assert_eq!(run.progress().steps as usize, steps);
                (run.progress(), run.error_budget())
            };
            let whole = go_on("whole", None);
            assert!(whole.0.steps > 8);
            for step in 1..whole.0.steps as usize {
                let name = format!("resumed-{step}");
                go_on(&name, Some(step));
                assert_eq!(go_on(&name, None), whole);
                let read = |path: String| fs::read(folder.join(path)).unwrap();
                for end in ["csv", "csv.json"] {
                    assert_eq!(read(format!("{name}.{end}")), read(format!("whole.{end}")), "after {step} steps");
                }
                let frames = |name: &str| {
                    let mut paths: Vec<_> =
                        fs::read_dir(folder.join(name)).unwrap().map(|entry| entry.unwrap().file_name()).collect();
                    paths.sort();
                    paths
                };
                assert_eq!(frames(&name), frames("whole"));
                for frame in frames(&name) {
                    let of = |name: &str| fs::read(folder.join(name).join(&frame)).unwrap();
                    assert!(of(&name) == of("whole"), "{frame:?} after {step} steps");
                }
            }
        }
    }
}

/// A step of seconds ends within its iterations.
#[test]
fn a_long_step_is_cancelled_within_it() {
    let settings = Settings::default().with_tolerance(1e-13).with_symmetry(false).with_window(false);
    let mut contact = sphere_on(Grid::square(1024, 4.0e-3).unwrap(), rubber(), settings);
    let load = hold(0.5);
    let flag = Arc::new(AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(100));
            flag.store(true, Ordering::Relaxed);
        });
        let mut run = contact.follow(&load, Stepping::fixed(0.5), 1.0).cancelled_by(Arc::clone(&flag));
        assert!(matches!(run.next_step(), Err(Error::Cancelled { .. })));
        assert_eq!((run.contact().time(), run.contact().force(), run.progress().steps), (0.0, 0.0, 0));
    });
}

/// A tolerance of the solver that was set counts in adaptive runs, too: stricter than the default, it is kept in every step.
#[test]
fn a_strict_tolerance_of_the_solver_counts_in_adaptive_runs() {
    let solved_to = |settings: Settings| {
        let mut contact = sphere_on(Grid::square(24, 4.0e-3).unwrap(), rubber(), settings);
        let load = Ramp::new(Load::force(0.1), Load::force(0.5), 1.0).unwrap();
        let mut run = contact.follow(&load, Stepping::adaptive(1e-2), 10.0);
        while run.next_step().unwrap().is_some() {}
        run.error_budget().solver
    };
    let [strict, default, loose] = [1e-9, 1e-6, 1e-2].map(|set| solved_to(Settings::default().with_tolerance(set)));
    assert!(
        strict <= 1e-9 && default > 1e-6 && default <= 3e-4 && loose >= default,
        "{strict:e} {default:e} {loose:e}"
    );
    assert_eq!(default, solved_to(Settings::default()));
}
