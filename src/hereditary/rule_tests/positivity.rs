//! How often a prediction lies above the undeformed surface, and what is done about it.

use super::foundation::{Foundation, Given};
use super::{Random, bodies};
use crate::hereditary::Interpolant;

/// Random forces, also none, over random steps of given length.
#[test]
fn predictions_that_rise_above_the_surface_are_rare_and_made_again() {
    let mut random = Random(5);
    for (interpolant, most) in
        [(Interpolant::Linear, 0.0), (Interpolant::CorrectedLinear, 0.5), (Interpolant::CorrectedQuadratic, 0.5)]
    {
        let (mut steps, mut repeated, mut lowest) = (0_u32, 0, 0.0_f64);
        for (_, body) in bodies() {
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
                    let field = &foundation.field;
                    let greatest = field.now.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
                    let least = field.now.iter().copied().fold(0.0, f64::min);
                    lowest = lowest.min(least / greatest);
                    steps += 1;
                }
                repeated += foundation.rule.repeated;
            }
        }
        let share = repeated as f64 / f64::from(steps);
        println!("{interpolant:?}: {repeated} of {steps} predictions made again, least u {lowest:.1e}");
        assert!(share <= most && lowest > -1e-8, "{share} {lowest:e}");
    }
}
