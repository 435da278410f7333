//! Do adaptive runs on elastic states keep to their tolerance where bodies touch and part again, on
//! surfaces that keep an imprint? The reference marches the elements of a foundation.
//!
//! By hand: `STATES_TAPS=300 cargo test --all-features -p viscocontact-tests --test suite
//! time::taps_on_states -- --nocapture`; `STATES_TAPS_FIRST=17` begins with that number,
//! `STATES_TAPS_LINES=1` prints every run.

use crate::common::random_taps::{Point, Taps};
use crate::common::{Ratios, from_environment};
use viscocontact::prelude::*;
use viscocontact::states::StatesContact;

/// Runs longer than this fail.
const MOST_STEPS: usize = 50_000;
/// Equal parts of a run, and of each step, at whose ends the results are compared.
const SAMPLES: u32 = 300;
const PARTS_OF_STEP: u32 = 4;

/// Force and approach of an adaptive run at the ends of its steps and within, and how many steps it
/// took; or why it ended early.
fn run(taps: &Taps) -> Result<(Vec<Point>, usize), String> {
    let mut contact = StatesContact::new(&taps.states, &taps.material).unwrap();
    let mut run = contact.follow(&*taps.history, Stepping::adaptive(taps.tolerance), taps.until);
    let (mut points, mut steps) = (Vec::new(), 0);
    while let Some(report) = run.next_step().map_err(|error| error.to_string())? {
        if report.dt == 0.0 {
            continue;
        }
        steps += 1;
        if steps > MOST_STEPS {
            return Err(format!("{} of {} after {steps} steps", report.time, taps.until));
        }
        let start = report.time - report.dt;
        let own = (1..PARTS_OF_STEP).map(|k| start + report.dt * f64::from(k) / f64::from(PARTS_OF_STEP));
        let even = (1..SAMPLES).map(|k| taps.until * f64::from(k) / f64::from(SAMPLES));
        let mut times: Vec<f64> = own.chain(even).filter(|time| start < *time && *time < report.time).collect();
        times.sort_by(f64::total_cmp);
        for time in times {
            let within = run.within_step(time).map_err(|error| format!("inside: {error}"))?;
            points.push((time, [within.force(), within.approach()]));
        }
        points.push((report.time, [report.force, report.approach]));
    }
    Ok((points, steps))
}

/// True errors of tapped bodies are at most twice what was asked in 99 % of random runs, and at most
/// four times in all.
#[test]
fn taps_on_states_are_honest() {
    let (count, first) = (from_environment("STATES_TAPS", 10), from_environment("STATES_TAPS_FIRST", 0));
    let prints = from_environment("STATES_TAPS_LINES", 0) == 1;
    let (mut ratios, mut lengths) = (Ratios::default(), Ratios::default());
    let (mut failed, mut unknown) = (Vec::new(), 0);
    for seed in first..first + count {
        let taps = Taps::new(seed);
        let (points, steps) = match run(&taps) {
            Ok(found) => found,
            Err(error) => {
                if prints {
                    println!("  {}: {error}", taps.name);
                }
                failed.push(format!("{}: {error}", taps.name));
                continue;
            }
        };
        let errors = taps.errors(&points);
        let worst = errors.map(|errors| errors.into_iter().zip(&points).fold((0.0, 0.0), |worst, (error, point)| {
            assert!(!error.is_nan(), "{}: no number at {}", taps.name, point.0);
            if error > worst.0 { (error, point.0 / taps.until) } else { worst }
        }));
        if prints {
            println!("  {worst:.2?} in {steps} steps: {}", taps.name);
        }
        lengths.push(steps as f64, &taps.name);
        match worst {
            Some((error, time)) => ratios.push(error, &format!("at {time:.4} in {steps} steps: {}", taps.name)),
            None => unknown += 1,
        }
    }
    println!("{count} runs, {unknown} without a truth, {} failed:", failed.len());
    failed.iter().for_each(|failed| println!("    {failed}"));
    lengths.print("steps", 3);
    ratios.print("true over asked", 8);
    assert!(failed.is_empty(), "{failed:?}");
    assert!(ratios.quantile(0.99) <= 2.0 && ratios.greatest() <= 4.0, "beyond what was asked: {ratios:?}");
    assert!(5 * unknown <= count, "{unknown} of {count} without a truth");
}
