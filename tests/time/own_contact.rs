//! Does a run lead a contact of a user's own as it leads those of the crate: adaptive steps, samples, events, stops, cancelling, failed steps?

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use viscocontact::contact::StepReport;
use viscocontact::prelude::*;
use viscocontact::{Error, UserError};

use crate::common::{Draws, Ratios, from_environment};

/// A spring beside a spring and a dashpot in series, F = k₀ x + k₁ (x − z), τ ż = x − z, which presses where F > 0 and may be made to fail.
#[derive(Debug, Clone)]
pub(super) struct Own {
    stiffness: [f64; 2],
    relaxation: f64,
    /// Weight of the end of the step: 1 is of order one, ½ of order two.
    implicit: f64,
    time: f64,
    approach: f64,
    force: f64,
    strain: f64,
    /// What the next steps do: fail after this many, and set a flag after this many.
    fails: Arc<AtomicUsize>,
    raises: Option<(Arc<AtomicUsize>, Arc<AtomicBool>)>,
}

/// Counts down to 0; true when it comes there.
fn counted(count: &AtomicUsize) -> bool {
    let left = |left: usize| (left != usize::MAX).then(|| left.saturating_sub(1));
    count.fetch_update(Ordering::Relaxed, Ordering::Relaxed, left) == Ok(1)
}

const NEVER: usize = usize::MAX;

impl Own {
    pub(super) fn new(stiffness: [f64; 2], relaxation: f64, implicit: f64) -> Own {
        let fails = Arc::new(AtomicUsize::new(NEVER));
        Own { stiffness, relaxation, implicit, time: 0.0, approach: 0.0, force: 0.0, strain: 0.0, fails, raises: None }
    }

    /// ż = gain · (force or approach) − rate · z.
    fn coefficients(&self, by_force: bool) -> [f64; 2] {
        let [k0, k1] = self.stiffness;
        if by_force {
            [1.0 / (self.relaxation * (k0 + k1)), k0 / (self.relaxation * (k0 + k1))]
        } else {
            [1.0 / self.relaxation; 2]
        }
    }
}

impl Contact for Own {
    fn step_to(&mut self, time: f64, load: Load) -> viscocontact::Result<StepReport> {
        let (dt, by_force) = (time - self.time, matches!(load, Load::Force { .. }));
        let (drive, before) = match load {
            Load::Force { normal, .. } => (normal, self.force),
            Load::Approach { approach, .. } => (approach, self.approach),
            _ => return Err(UserError::new("the contact", "no springs").into()),
        };
        let [gain, rate] = self.coefficients(by_force);
        let w = self.implicit;
        let rest = self.strain + dt * ((1.0 - w) * (gain * before - rate * self.strain) + w * gain * drive);
        self.strain = rest / (1.0 + dt * w * rate);
        if counted(&self.fails) {
            self.approach = f64::NAN;
            return Err(UserError::new("the contact", "made to fail").into());
        }
        if let Some((count, flag)) = &self.raises
            && counted(count)
        {
            flag.store(true, Ordering::Relaxed);
        }
        let [k0, k1] = self.stiffness;
        if by_force {
            (self.force, self.approach) = (drive, (drive + k1 * self.strain) / (k0 + k1));
        } else {
            (self.force, self.approach) = (k0 * drive + k1 * (drive - self.strain), drive);
        }
        self.time = time;
        Ok(self.report(dt, load))
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn force(&self) -> f64 {
        self.force
    }

    fn approach(&self) -> f64 {
        self.approach
    }

    fn contact_area(&self) -> f64 {
        if self.force > 0.0 { 1e-6 } else { 0.0 }
    }

    fn attracts(&self) -> bool {
        true
    }
}

/// A random body under mean + amplitude · sin ωt from rest, whose course is known.
struct Scene {
    own: Own,
    by_force: bool,
    mean: f64,
    amplitude: f64,
    omega: f64,
    tolerance: f64,
}

const UNTIL: f64 = 10.0;

impl Scene {
    fn new(seed: u64) -> Scene {
        let draws = &mut Draws::new(seed);
        let stiffness = [draws.power_of_ten(-1.0, 1.0), draws.power_of_ten(-1.0, 1.0)];
        let own = Own::new(stiffness, draws.power_of_ten(-2.0, 1.5), [1.0, 0.5][draws.below(2)]);
        let by_force = draws.below(2) == 0;
        let (mean, share) = (draws.power_of_ten(-3.0, 3.0), [0.0, draws.between(0.0, 0.9)][draws.below(2)]);
        let omega = draws.power_of_ten(-1.0, 0.7);
        // steps of order one are many
        let tolerance = draws.power_of_ten(if own.implicit == 1.0 { -3.0 } else { -5.0 }, -2.0);
        Scene { own, by_force, mean, amplitude: share * mean, omega, tolerance }
    }

    fn load(&self) -> impl LoadHistory + 'static {
        let Scene { by_force, mean, amplitude, omega, .. } = *self;
        FnHistory::new(move |t: f64| {
            let size = mean + amplitude * (omega * t).sin();
            if by_force { Load::force(size) } else { Load::approach(size) }
        })
    }

    /// Approach and force at a time.
    fn exact(&self, t: f64) -> [f64; 2] {
        let [gain, rate] = self.own.coefficients(self.by_force);
        let (w, decay) = (self.omega, (-rate * t).exp());
        let steady = rate * (w * t).sin() - w * (w * t).cos() + w * decay;
        let strain = gain * (self.mean / rate * (1.0 - decay) + self.amplitude * steady / (rate * rate + w * w));
        let ([k0, k1], size) = (self.own.stiffness, self.mean + self.amplitude * (w * t).sin());
        if self.by_force { [(size + k1 * strain) / (k0 + k1), size] } else { [size, k0 * size + k1 * (size - strain)] }
    }
}

/// A body that touches in the first step, towards a load that rises in a small part of the run, and one that recovers apart.
#[test]
fn what_touches_and_what_is_apart_are_judged() {
    for (implicit, tolerance) in [(1.0, 1e-3), (0.5, 1e-4)] {
        let own = Own::new([1.0, 3.0], 0.7, implicit);
        let [gain, rate] = own.coefficients(true);
        let off = |history: Box<dyn LoadHistory>,
                   until: f64,
                   times: &[f64],
                   strain: &dyn Fn(f64) -> f64,
                   force: &dyn Fn(f64) -> f64| {
            let run = own.clone().into_follow(history, Stepping::adaptive(tolerance), until);
            let mut run = run.sample_at(times.to_vec()).unwrap();
            let mut worst = vec![];
            while run.next_step().unwrap().is_some() {
                for sample in run.samples().map(Result::unwrap).filter(|sample| sample.is_asked_for()) {
                    let t = sample.contact().time;
                    let exact = (force(t) + 3.0 * strain(t)) / 4.0;
                    worst.push((sample.contact().approach - exact).abs() / tolerance);
                }
            }
            assert_eq!(worst.len(), times.len());
            worst.into_iter().max_by(f64::total_cmp).unwrap()
        };
        let slow = Box::new(FnHistory::new(|t: f64| Load::force(1.0 - (-t).exp())));
        let rises =
            |t: f64| gain * ((1.0 - (-rate * t).exp()) / rate - ((-t).exp() - (-rate * t).exp()) / (rate - 1.0));
        let times: Vec<f64> = (1..=60).map(|k| 0.05 * 1.22_f64.powi(k)).collect();
        let touched = off(slow, 2e4, &times, &rises, &|t| 1.0 - (-t).exp());
        let corners = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (4.0, 0.0)].map(|(time, force)| (time, Load::force(force)));
        let released = Box::new(PiecewiseLinear::new(&corners).unwrap());
        let held = |t: f64| gain / rate * (1.0 - (-rate * t).exp());
        let left = |t: f64| if t < 1.0 { held(t) } else { held(1.0) * (-rate * (t - 1.0)).exp() };
        let times: Vec<f64> = (1..=40).map(|k| 1.0 + 0.05 * f64::from(k)).collect();
        let apart = off(released, 3.0, &times, &left, &|_| 0.0);
        println!("order {implicit}: touched {touched:.2}, apart {apart:.2}");
        assert!(touched < 2.0 && apart < 2.0);
    }
}

#[test]
fn errors_are_what_was_asked_for() {
    let (mut ratios, mut steps) = (Ratios::default(), Ratios::default());
    for seed in 0..from_environment("OWN_SCENES", 60) {
        let scene = Scene::new(seed);
        let run = scene.own.clone().into_follow(scene.load(), Stepping::adaptive(scene.tolerance), UNTIL);
        let mut run = run.sample_at(Times::every(0.01 * UNTIL)).unwrap();
        let (mut worst, mut greatest, mut taken) = (0.0_f64, [0.0_f64; 2], 0);
        while let Some(report) = run.next_step().unwrap() {
            taken += 1;
            assert!(report.time_error.is_some() && taken < 100_000, "{seed}: {report}");
            for sample in run.samples() {
                let sample = sample.unwrap();
                let (contact, report) = (sample.contact(), sample.report());
                assert_eq!(
                    [report.time, report.force, report.approach],
                    [contact.time, contact.force, contact.approach]
                );
                let exact = scene.exact(contact.time);
                for (k, found) in [contact.approach, contact.force].into_iter().enumerate() {
                    greatest[k] = greatest[k].max(exact[k].abs());
                    worst = worst.max((found - exact[k]).abs() / exact[k].abs().max(0.1 * greatest[k]));
                }
            }
        }
        assert_eq!(run.contact().time, UNTIL);
        assert!(matches!(run.save("a run of one's own"), Err(Error::NotCovered { .. })));
        assert!(run.error_budget().time.unwrap() <= scene.tolerance, "{seed}");
        ratios.push(worst / scene.tolerance, &format!("{seed}: {:.0e} in {taken} steps", scene.tolerance));
        steps.push(taken as f64, &format!("{seed}"));
    }
    steps.print("steps", 3);
    ratios.print("true over asked", 5);
    assert!(ratios.greatest() <= 2.0 && ratios.quantile(0.5) > 1e-3, "{ratios:?}");
}

fn scene() -> Scene {
    Scene {
        own: Own::new([1.0, 2.0], 0.5, 0.5),
        by_force: true,
        mean: 1.0,
        amplitude: 0.5,
        omega: 3.0,
        tolerance: 1e-3,
    }
}

fn states(run: &mut Run<'static, Own>) -> Vec<[f64; 3]> {
    std::iter::from_fn(|| run.next_step().unwrap()).map(|report| [report.time, report.force, report.approach]).collect()
}

/// A step that fails leaves a broken state behind: the run goes back, and takes the same steps when it is called again. So does one that is
/// cancelled from within.
#[test]
fn failed_and_cancelled_steps_leave_no_trace() {
    for stepping in [Stepping::adaptive(1e-3), Stepping::fixed(0.13)] {
        let plain = states(&mut scene().own.into_follow(scene().load(), stepping, 2.0));
        assert!(plain.len() > 10);
        for after in 1..=12 {
            let (mut own, flag) = (scene().own, Arc::new(AtomicBool::new(false)));
            let (fails, raised) = (Arc::clone(&own.fails), Arc::new(AtomicUsize::new(NEVER)));
            own.raises = Some((Arc::clone(&raised), Arc::clone(&flag)));
            let mut run = own.into_follow(scene().load(), stepping, 2.0).cancelled_by(Arc::clone(&flag));
            let (mut found, mut failed) = (Vec::new(), [0; 2]);
            loop {
                let now = run.contact().clone();
                // fails at one call, is cancelled at the next
                [&fails, &raised][found.len() % 2].store(after, Ordering::Relaxed);
                match run.next_step() {
                    Ok(None) => break,
                    Ok(Some(report)) => found.push([report.time, report.force, report.approach]),
                    Err(error) => {
                        let which = usize::from(matches!(error, Error::Cancelled { .. }));
                        assert!(which == 1 || matches!(error, Error::User(_)), "{error}");
                        failed[which] += 1;
                        let state = |own: &Own| [own.time, own.force, own.approach, own.strain];
                        assert_eq!(state(run.contact()), state(&now));
                        flag.store(false, Ordering::Relaxed);
                        [&fails, &raised].iter().for_each(|count| count.store(NEVER, Ordering::Relaxed));
                        found.extend(
                            run.next_step().unwrap().map(|report| [report.time, report.force, report.approach]),
                        );
                    }
                }
                flag.store(false, Ordering::Relaxed);
                [&fails, &raised].iter().for_each(|count| count.store(NEVER, Ordering::Relaxed));
            }
            assert_eq!(found, plain);
            assert!(after > 1 || failed[0] > 3, "{failed:?}");
            // a flag that the last part of a step sets is seen by the next one
            let counts_parts = matches!(stepping, Stepping::Adaptive { .. });
            assert!(!counts_parts || after > 2 || failed[1] > 3, "{failed:?}");
        }
    }
}
