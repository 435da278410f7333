//! The cells that are likely to be in contact at the end of a step.

use crate::contact::{State, Step};
use crate::equilibrium::{Equilibrium, Trial, Window};
use crate::parallel::{Rows, for_each_band};

/// Least distance, in cells, by which the edge of the contact must be expected to move for the next contact to be
/// predicted.
const MIN_EDGE_SPEED: f64 = 0.5;

/// Least share of the cells in contact, now and in the next step, that must stay in contact: the law of the edge does
/// not cover the cells far from it.
const MIN_SHARE_STAYING: f64 = 0.5;

/// Finds the cells that are likely to be in contact at the end of a step a times as long as the last one. At a moving
/// edge the pressure goes to zero like the root of the distance, and the gap opens like its power 3/2 (Hertz): a
/// pressure that fell to less than √(a/(1 + a)) of itself vanishes, a gap that fell to less than the third power of
/// this factor closes.
///
/// False if the last two gaps are not known, if most cells would join or leave, or if the edge moves so slowly that
/// single cells join: their gaps fall evenly until they touch, which the extrapolated pressure predicts by itself.
pub(super) fn predict_contact(state: &State, window: &Window, trial: &mut Trial, step: &Step<'_>, c: f64) -> bool {
    let (now, before) = (&state.held.current, &state.previous);
    let elastic = !state.history.rule().has_memory();
    let (change, rows) = (state.history.last_change(), state.held.region.rows());
    if now.contact_cells == 0 || before.contact_cells == 0 {
        return false;
    }
    // a rank without cells has no changes
    if rows.any(change.is_none() && state.held.region.len() > 0) && !elastic {
        return false;
    }
    let ahead = state.held.extrapolation.reach(step.interval.dt);
    if ahead * edge_speed(&rows, now, before) < MIN_EDGE_SPEED {
        return false;
    }
    let share = (ahead / (1.0 + ahead)).sqrt();
    let share_open = share * share * share;
    let (initial, u) = (window.gap(&step.indenter), state.history.displacement());
    let datum = step.indenter.gap().datum;
    let still = now.motions.iter().chain(&before.motions).all(|motion| motion.tilt == [0.0; 2]);
    let motion = |k: usize, of: &Equilibrium| {
        let body = of.motions[initial.owner(k)];
        if still { body.approach } else { body.at(state.held.region.center(k)) }
    };
    let is_likely = |k: usize| {
        let (p, p_before) = (now.solution.pressure[k], before.solution.pressure[k]);
        if p > 0.0 {
            return p >= share * p_before;
        } else if p_before > 0.0 {
            return false;
        }
        let [motion, motion_before] = [motion(k, now), motion(k, before)];
        let receded = match change {
            Some(change) => change[k],
            None => c * (now.solution.potential[k] - before.solution.potential[k]),
        };
        let gap = datum + initial.above[k] + u[k] - motion;
        gap < share_open * (gap - receded + (motion - motion_before))
    };
    for_each_band([&mut trial.likely], |first, [likely]| {
        likely.iter_mut().zip(first..).for_each(|(likely, k)| *likely = is_likely(k));
    });
    let [touching, likely, staying] = rows.sum_terms(|k| {
        let (touching, likely) = (now.solution.pressure[k] > 0.0, trial.likely[k]);
        (touching || likely).then(|| [touching, likely, touching && likely].map(|counts| f64::from(u8::from(counts))))
    });
    staying >= MIN_SHARE_STAYING * touching.max(likely)
}

/// Mean distance in cells by which the edge of the contact moved in the last step: cells that joined or left, over
/// the length of the edge, the number of its sides along one axis or the other. Sides between bands of rows, of which
/// a rank may have one alone, do not count.
fn edge_speed(rows: &Rows, now: &Equilibrium, before: &Equilibrium) -> f64 {
    let columns = rows.cells()[1];
    let [now, before] = [now, before].map(|equilibrium| &equilibrium.solution.pressure);
    let [moved, across, down] = rows.sum_terms(|k| {
        let touching = now[k] > 0.0;
        let left = if k % columns > 0 { now[k - 1] > 0.0 } else { touching };
        let above = if k % rows.band_cells() >= columns { now[k - columns] > 0.0 } else { touching };
        let differ = [before[k] > 0.0, left, above].map(|other| other != touching);
        (differ != [false; 3]).then(|| differ.map(|differs| f64::from(u8::from(differs))))
    });
    moved / across.max(down).max(1.0)
}
