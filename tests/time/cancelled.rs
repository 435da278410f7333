//! Does a run end when its caller asks, leave the contact as it was, and go on as if nothing had happened?

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use viscocontact::Error;
use viscocontact::contact::Solver;
use viscocontact::prelude::*;

use crate::common::spheres::{builder_on, sphere_on};

fn rubber() -> Material {
    Material::incompressible(Zener::relaxing(1.0e6, 0.3e6, 0.5).unwrap())
}

fn grid(cells: usize) -> Grid {
    Grid::square(cells, 4.0e-3).unwrap()
}

/// Ends of steps, with force and approach.
type Steps = Vec<[f64; 3]>;

#[test]
fn a_cancelled_run_goes_on_with_the_same_steps() {
    for stepping in [Stepping::adaptive(1e-3), Stepping::fixed(0.5)] {
        // the history sets the flag when it is asked for so many times
        let steps = |cancels: &[usize]| -> (Steps, [usize; 2]) {
            let (flag, asked) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
            let (sets, counts, cancels) = (Arc::clone(&flag), Arc::clone(&asked), cancels.to_vec());
            let history = FnHistory::new(move |t| {
                if cancels.contains(&counts.fetch_add(1, Ordering::Relaxed)) {
                    sets.store(true, Ordering::Relaxed);
                }
                Load::force(0.1 + 0.3 * (t / (1.0 + t)))
            });
            let mut contact = builder_on(grid(32), rubber()).build().unwrap();
            let mut run = contact.follow(&history, stepping, 20.0).cancelled_by(Arc::clone(&flag));
            let (mut steps, mut cancelled) = (Vec::new(), 0);
            loop {
                match run.next_step() {
                    Ok(Some(report)) => steps.push([report.time, report.force, report.approach]),
                    Ok(None) => return (steps, [cancelled, asked.load(Ordering::Relaxed)]),
                    Err(Error::Cancelled { .. }) => {
                        let before = steps.last().map_or(0.0, |step: &[f64; 3]| step[0]);
                        assert_eq!(run.contact().time(), before);
                        assert!(matches!(run.next_step(), Err(Error::Cancelled { .. })), "as long as the flag is set");
                        flag.store(false, Ordering::Relaxed);
                        cancelled += 1;
                    }
                    Err(error) => panic!("{error}"),
                }
            }
        };
        let (plain, [none, asked]) = steps(&[]);
        let (resumed, [cancelled, _]) = steps(&[asked * 82 / 100, asked * 92 / 100]);
        println!("{} steps, cancelled {cancelled} times", plain.len());
        assert_eq!((none, cancelled), (0, 2));
        assert_eq!(plain, resumed);
    }
}

/// A step of seconds, by the slowest solver, ends within its iterations.
#[test]
fn a_long_step_is_cancelled_within_it() {
    let settings = Settings::default().with_solver(Solver::PolonskyKeer).with_tolerance(1e-13);
    let settings = settings.with_symmetry(false).with_window(false);
    let mut contact = sphere_on(grid(512), rubber(), settings);
    let load = StepLoad::new(Load::force(0.5)).unwrap();
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
