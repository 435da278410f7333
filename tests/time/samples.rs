//! Curves of runs of few steps: states sampled within steps, and steps that end at times of the user's choice.

use crate::common::contact_of;
use viscocontact::analytic::GrowingSphere;
use viscocontact::contact::StepReport;
use viscocontact::prelude::*;

const RADIUS: f64 = 10.0e-3;
const FORCE: f64 = 0.5;

fn rubber() -> Material {
    Material::incompressible(Zener::relaxing(1.0e6, 0.3e6, 0.5).unwrap())
}

fn contact() -> ViscoelasticContact {
    contact_of(&Sphere::new(RADIUS).unwrap(), Grid::square(64, 4.0e-3).unwrap(), rubber(), Settings::default())
}

/// A rise, a hold, a fall and a release.
fn protocol() -> PiecewiseLinear {
    let force = Load::force;
    PiecewiseLinear::new(&[(0.0, force(0.1)), (1.0, force(FORCE)), (50.0, force(FORCE)), (60.0, force(0.0))]).unwrap()
}

/// Samples leave the run bitwise as it is, cost one contact problem for each time inside a step, and miss no time.
#[test]
fn samples_leave_the_steps_as_they_are() {
    let history = protocol();
    let steps = |sampled: bool| {
        let mut contact = contact();
        let mut run = contact.follow(&history, Stepping::adaptive(1e-3), 80.0);
        if sampled {
            run = run.sample_at(Times::decades(1e-3, 10).and(Times::every(5.0)).and([0.77, 90.0])).unwrap();
        }
        assert_eq!(run.samples().count(), 0, "no step yet");
        let (mut reports, mut looks, mut asked, mut problems): (Vec<StepReport>, _, Vec<f64>, _) =
            (Vec::new(), 0, Vec::new(), 0);
        let mut time = 0.0;
        while let Some(report) = run.next_step().unwrap() {
            reports.push(report);
            let samples: Vec<_> = run.samples().map(Result::unwrap).collect();
            let (end, inside) = samples.split_last().unwrap();
            assert!(end.is_end_of_step() && *end.report() == report && std::ptr::eq(end.contact(), run.contact()));
            for sample in inside {
                let (now, contact) = (sample.report().time, sample.contact());
                assert!(time < now && now < report.time && now == contact.time());
                assert_eq!(sample.report().force, contact.force());
                assert_eq!(sample.report().time_error, report.time_error);
                assert!(!sample.is_end_of_step() && sample.is_asked_for());
                assert_eq!(run.within_step(now).unwrap().pressure(), contact.pressure());
                (time, looks, problems) = (now, looks + 1, problems + usize::from(sample.report().iterations > 0));
            }
            asked.extend(samples.iter().filter(|sample| sample.is_asked_for()).map(|sample| sample.report().time));
            time = report.time;
        }
        assert_eq!(run.samples().count(), 0, "the run is over");
        (reports, looks, asked, problems, contact.pressure().to_vec())
    };
    let (plain, none, ..) = steps(false);
    let (sampled, looks, asked, problems, pressure) = steps(true);
    assert_eq!(none, 0);
    assert_eq!(plain, sampled);
    assert_eq!(pressure, steps(false).4);
    // by hand: 49 decades from 1 ms to 63 s (the 50th is 79.4 s), 16 multiples of 5 s, 0.77 s; 10 s is both
    let mut times: Vec<f64> = (0..50).map(|k| 1e-3 * 10f64.powf(0.1 * f64::from(k))).collect();
    times.extend((1..=16).map(|k| 5.0 * f64::from(k)));
    times.push(0.77);
    times.sort_by(f64::total_cmp);
    times.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    assert_eq!(asked.len(), times.len(), "{asked:?}");
    for (found, expected) in asked.iter().zip(&times) {
        assert!((found - expected).abs() <= 1e-6 * expected, "{found} {expected}");
    }
    let ends = sampled.iter().filter(|report| times.iter().any(|time| (time - report.time).abs() < 1e-9)).count();
    println!("{} steps, {looks} samples within them, {problems} of them with iterations", sampled.len());
    // a time at the end of a step costs nothing; one at a jump is asked for once
    assert_eq!(looks, times.len() - ends);
}

/// The curve through the samples is exact to the tolerance of the steps, though these are few.
#[test]
fn the_curve_of_a_held_ball_is_exact() {
    let exact = GrowingSphere::step(RADIUS, &rubber(), FORCE).unwrap();
    let load = StepLoad::new(Load::force(FORCE)).unwrap();
    let mut contact = contact();
    let mut run = contact.follow(&load, Stepping::adaptive(1e-3), 100.0).sample_at(Times::decades(1e-3, 10)).unwrap();
    // the error of the mesh, which all states share
    let mesh = exact.approach(0.0) / {
        run.next_step().unwrap();
        run.contact().approach()
    };
    let (mut steps, mut points, mut worst) = (0, 0, 0.0_f64);
    while run.next_step().unwrap().is_some() {
        steps += 1;
        for sample in run.samples() {
            let sample = sample.unwrap();
            let error = mesh * sample.contact().approach() / exact.approach(sample.contact().time()) - 1.0;
            worst = worst.max(error.abs());
            points += 1;
        }
    }
    println!("{steps} steps, {points} points, error at most {worst:.1e}");
    assert!(points >= 50 && 2 * steps < points);
    assert!(worst < 3e-3, "{worst:e}");
}

/// Steps end at multiples of an interval and at decades, in runs of either kind and of elastic states.
#[test]
fn steps_end_where_they_are_stopped() {
    let load = StepLoad::new(Load::force(FORCE)).unwrap();
    let multiples: Vec<f64> = (1..=20).map(|k| 0.5 * f64::from(k)).collect();
    let decades: Vec<f64> =
        (0..=9).map(|k| 1e-2 * 10f64.powf(f64::from(k) / 3.0)).filter(|time| *time <= 10.0).collect();
    let met = |times: &[f64], ends: &[f64]| {
        times.iter().all(|time| ends.iter().any(|end| (end - time).abs() <= 1e-12 * time))
    };
    for stepping in [Stepping::adaptive(1e-3), Stepping::fixed(0.3)] {
        let ends = |stop: &dyn Fn(viscocontact::run::Run<'static>) -> viscocontact::run::Run<'static>| {
            let mut run = stop(contact().into_follow(load, stepping, 10.0));
            let mut ends = Vec::new();
            while let Some(report) = run.next_step().unwrap() {
                ends.push(report.time);
            }
            ends
        };
        let free = ends(&|run| run);
        let every = ends(&|run| run.stop_at(Times::every(0.5)).unwrap());
        let at_decades = ends(&|run| run.stop_at(Times::decades(1e-2, 3)).unwrap());
        println!("{} steps, {} with stops at multiples, {} at decades", free.len(), every.len(), at_decades.len());
        assert!(met(&multiples, &every) && met(&decades, &at_decades));
        assert!(!met(&multiples, &free));
    }
    let states = Sweep::new(Grid::square(32, 4.0e-3).unwrap(), &Sphere::new(RADIUS).unwrap());
    let states = states.run(Reach::Level(6.0e-7)).unwrap();
    for stepping in [Stepping::adaptive(1e-3), Stepping::fixed(0.3)] {
        let mut contact = StatesContact::new(&states, &rubber()).unwrap();
        let mut run =
            contact.follow(&load, stepping, 10.0).stop_at(Times::every(0.5).and(Times::decades(1e-2, 3))).unwrap();
        let mut ends = Vec::new();
        while let Some(report) = run.next_step().unwrap() {
            ends.push(report.time);
            assert_eq!(run.samples().map(|sample| sample.unwrap().report().time).collect::<Vec<_>>(), [report.time]);
        }
        assert!(met(&multiples, &ends) && met(&decades, &ends), "{ends:?}");
    }
}
