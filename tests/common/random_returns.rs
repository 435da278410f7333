//! Bodies that creep by factors of 1 to 1000, and load histories that go back and return, drawn at random.

use viscocontact::prelude::*;

use super::draws::Draws;
use super::random_bodies::{Body, terms};
use super::random_histories::{Control, RandomHistory};

/// A body with elastic response and one to four relaxation times, and a duration that shows its creep.
pub fn returning_body(draws: &mut Draws) -> Body {
    let (g, tau) = (draws.power_of_ten(5.0, 7.0), draws.power_of_ten(-3.0, 3.0));
    let ratio = draws.power_of_ten(0.0, 3.0).max(1.05);
    let (count, decades) = (1 + draws.below(4), draws.between(0.0, 3.0));
    let terms = terms(draws, count, tau, if count > 1 { decades } else { 0.0 });
    let scaled = |by: f64| terms.iter().map(|&(weight, time)| (weight * by, time)).collect::<Vec<_>>();
    let (name, material) = if draws.chance(0.5) {
        ("Kelvin", Material::incompressible(GeneralizedKelvin::new(1.0 / g, 0.0, &scaled((ratio - 1.0) / g)).unwrap()))
    } else {
        (
            "Maxwell",
            Material::incompressible(GeneralizedMaxwell::new(g / ratio, &scaled(g * (1.0 - 1.0 / ratio))).unwrap()),
        )
    };
    let creep = material.contact_spectrum().unwrap().unwrap();
    let longest = creep.terms().iter().map(|term| term.1).fold(0.0, f64::max);
    Body { name, material, until: longest * draws.power_of_ten(-1.0, 1.0) }
}

/// A history over `until` seconds that goes up, partly back, and up again: by ramps, holds and jumps.
pub fn returning_history(draws: &mut Draws, control: Control, until: f64) -> RandomHistory {
    // (duration, level at its end, whether the level is reached by a jump at its start)
    let mut legs = vec![(draws.power_of_ten(-2.0, 0.0), 1.0, draws.chance(0.3))];
    let kind = draws.below(12);
    let name = match kind {
        0 => {
            legs = vec![(1.0, 1.0, true)];
            "step"
        }
        1 => {
            legs = vec![(draws.power_of_ten(-3.0, -1.0), 1.0, false), (1.0, 1.0, false)];
            "ramp, hold"
        }
        _ => {
            let apart = if control.is_approach() { -draws.between(0.05, 0.3) } else { 0.0 };
            for _ in 0..1 + draws.below(3) {
                let hold = |draws: &mut Draws, level| (draws.power_of_ten(-1.5, 0.0), level, false);
                let top = legs[legs.len() - 1].1;
                if draws.chance(0.3) {
                    legs.push(hold(draws, top));
                }
                let back = if draws.chance(0.15) { apart } else { top * draws.between(0.05, 0.8) };
                legs.push((draws.power_of_ten(-1.5, 0.0), back, draws.chance(0.15)));
                if draws.chance(0.3) {
                    legs.push(hold(draws, back));
                }
                let again = back.max(0.0) + draws.between(0.2, 1.0) * (1.0 - back.max(0.0));
                legs.push((draws.power_of_ten(-1.5, 0.0), again, draws.chance(0.15)));
            }
            "back and again"
        }
    };
    let whole: f64 = legs.iter().map(|leg| leg.0).sum();
    let mut rows = vec![(0.0, 0.0)];
    let (mut time, mut text) = (0.0, String::new());
    for &(duration, level, jumps) in &legs {
        let before = rows[rows.len() - 1].1;
        if jumps {
            // a table that begins with a jump has no row before it
            if time == 0.0 { rows[0].1 = level } else { rows.push((time, level)) }
        }
        time += until * duration / whole;
        rows.push((time, level));
        text += &format!(" {}{level:.2}@{:.2}", if jumps && before != level { "!" } else { "" }, time / until);
    }
    let last = rows.len() - 1;
    rows[last].0 = 1.1 * until;
    if rows[last].1 != rows[last - 1].1 {
        let (start, end) = (rows[last - 1], rows[last]);
        rows[last].1 = start.1 + (end.1 - start.1) * (end.0 - start.0) / (until - start.0);
        rows[last].1 = rows[last].1.max(if control.is_approach() { f64::NEG_INFINITY } else { 0.0 });
    }
    control.tabled(format!("{name}{text}"), &rows)
}
