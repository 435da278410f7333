//! What a step on elastic states costs: 64 groups of levels, one to thirty relaxation times, steps of given length and
//! adaptive ones. `cargo bench -p viscocontact-benches --bench states`

use std::time::Instant;

use viscocontact::prelude::*;

/// A body with this number of relaxation times over three decades.
fn body(times: usize) -> Material {
    let share = 0.9e6 / times as f64;
    let time = |k: usize| 10f64.powf(-1.5 + 3.0 * (k as f64 + 0.5) / times as f64);
    let terms: Vec<(f64, f64)> = (0..times).map(|k| (share, time(k))).collect();
    Material::incompressible(GeneralizedMaxwell::new(0.1e6, &terms).unwrap())
}

/// A contact that grew in 64 steps, and so has 64 groups.
fn grown(times: usize) -> StatesContact {
    let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3).unwrap(), &body(times)).unwrap();
    contact = contact.with_merge_error(0.0).unwrap();
    for step in 1..=64 {
        contact.step(0.01, Load::force(0.01 * f64::from(step))).unwrap();
    }
    assert!((60..=64).contains(&contact.groups()), "{}", contact.groups());
    contact
}

/// Least time of a job over some repetitions [s].
fn least(mut job: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        job();
        start.elapsed().as_secs_f64()
    };
    (0..200).map(time).fold(f64::INFINITY, f64::min)
}

/// Steps of 1 ms under a sine of the force: what they cost after so many.
fn long_runs() {
    println!("µs per step of 1 ms under a sine of the force, after 20 000 steps, and groups of levels");
    for times in [1, 5, 30] {
        for error in [1e-4, 1e-6] {
            let contact = StatesContact::new(&ElasticStates::sphere(10.0e-3).unwrap(), &body(times)).unwrap();
            let mut contact = contact.with_merge_error(error).unwrap();
            let mut run = |steps: std::ops::Range<u32>| {
                let start = Instant::now();
                for step in steps {
                    contact.step(1e-3, Load::force(0.5 + 0.45 * (0.0459 * f64::from(step)).sin())).unwrap();
                }
                start.elapsed().as_secs_f64()
            };
            run(0..20_000);
            let each = run(20_000..40_000) / 20_000.0;
            println!("{times:>17} {error:10.0e} {:10.2} {:>10}", 1e6 * each, contact.groups());
        }
    }
}

fn main() {
    long_runs();
    println!("µs per step on a sphere's elastic states with 64 groups of levels");
    println!("{:>17} {:>10} {:>10} {:>10} {:>10}", "relaxation times", "force", "approach", "copy", "adaptive");
    for times in [1, 3, 10, 20, 30] {
        let start = grown(times);
        let mut contact = start.clone();
        let copy = least(|| (0..100).for_each(|_| contact.restore(&start).unwrap())) / 100.0;
        let depth = start.approach();
        // the last groups recede and grow again, so that their number stays
        let mut steps = |load: &dyn Fn(u32) -> Load| {
            let all = least(|| {
                contact.restore(&start).unwrap();
                (0..20).for_each(|step| assert!(contact.step(0.01, load(step)).is_ok()));
            });
            (all - copy) / 20.0
        };
        let force = steps(&|step| Load::force(0.64 - 0.002 * f64::from(step % 2)));
        let approach = steps(&|step| Load::approach(depth * (1.0 - 0.002 * f64::from(step % 2))));
        let load = FnHistory::new(|t: f64| Load::force(0.64 - 0.1 * (t - 0.64)));
        let (mut taken, mut groups) = (0, 0);
        let adaptive = least(|| {
            contact.restore(&start).unwrap();
            let mut run = contact.follow(&load, Stepping::adaptive(1e-4), 2.0);
            taken = 0;
            while run.next_step().unwrap().is_some() {
                taken += 1;
            }
            groups = run.contact().groups();
        });
        let each = adaptive / f64::from(taken);
        println!(
            "{times:>17} {:10.2} {:10.2} {:10.2} {:10.2} ({taken} steps to {groups} groups)",
            1e6 * force,
            1e6 * approach,
            1e6 * copy,
            1e6 * each
        );
    }
}
