//! How often a prediction lies above the undeformed surface, and what is done about it.

use super::foundation::{Foundation, Given};
use super::{Random, bodies};
use crate::hereditary::Interpolant;
use crate::hereditary::remembered_field::RememberedField;

/// Random forces, also none, over random steps of given length.
#[test]
fn predictions_that_rise_above_the_surface_are_rare_and_made_again() {
    let mut random = Random(5);
    for (interpolant, most) in
        [(Interpolant::Linear, 0.0), (Interpolant::CorrectedLinear, 0.5), (Interpolant::CorrectedQuadratic, 0.5)]
    {
        let (mut steps, mut repeated, mut falls_below_zero, mut lowest) = (0_u32, 0, 0, 0.0_f64);
        for (name, body) in bodies() {
            let fastest = body.terms().first().map_or(1.0, |term| term.1);
            for _ in 0..20 {
                let mut foundation = Foundation::new(&body, 64, interpolant);
                // so that the greatest force fits
                let mut dt = fastest * random.decades(1e-3, 1e3);
                for _ in 0..30 {
                    dt *= random.decades(0.3, 3.0);
                    let deepest = 0.9 * random.next();
                    let given = if random.next() < 0.2 { Given::Force(0.0) } else { Given::Approach(deepest) };
                    foundation.step(dt, given);
                    // between steps the trial is the field before the last one
                    let RememberedField { now, trial, .. } = &foundation.field;
                    let greatest = now.iter().chain(trial).copied().fold(f64::MIN_POSITIVE, f64::max);
                    let least = now.iter().copied().fold(0.0, f64::min) / greatest;
                    if least < -1e-9 {
                        falls_below_zero += 1;
                        println!("  {interpolant:?} {name} {least:.1e} dt {dt:.1e}");
                    }
                    lowest = lowest.min(least);
                    steps += 1;
                }
                repeated += foundation.rule.repeated;
            }
        }
        let share = repeated as f64 / f64::from(steps);
        println!(
            "{interpolant:?}: {repeated} of {steps} predictions made again, {falls_below_zero} falls_below_zero, \
            least u {lowest:.1e}"
        );
        assert!(share <= most && lowest > -1e-8, "{share} {lowest:e}");
    }
}
