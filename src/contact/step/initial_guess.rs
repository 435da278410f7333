//! The initial guess of the pressure in a step.

use crate::contact::state::extrapolation::MAX_REACH;
use crate::contact::{Equilibrium, State, Step, Trial, Window};
use crate::parallel::{Rows, for_each_band};
use crate::solver::{Counts, Freedom, RigidMotion};

/// A guess is extrapolated only if it carries the force to within this factor: the remainder of a cancellation is noise.
const MAX_FORCE_RATIO: f64 = 1.5;

/// If motions are given and the pressure falls to less than this share in a step, its last change does not predict the next:
/// the guess is the last pressure times the share.
const MAX_SHARE_LEFT: f64 = 0.5;

/// Least distance, in cells, by which the edge of the contact must be expected to move for the next contact to be predicted.
const MIN_EDGE_SPEED: f64 = 0.5;

/// Least share of the cells in contact, now and in the next step, that must stay in contact: the law of the edge does not cover
/// the cells far from it.
const MIN_SHARE_STAYING: f64 = 0.5;

/// Fills the trial with a guess for a step of compliance `c`: p and K p extrapolated from the last step. Under bodies of given
/// motion whose pressure falls a lot, the last pressure is scaled: an extrapolated K p would keep the rounding of the greater
/// pressure.
pub(super) fn initial_guess(state: &State, window: &mut Window, trial: &mut Trial, step: &Step<'_>, c: f64) {
    begin(state, trial, step);
    let (now, before, rows) = (&state.current.solution, &state.previous.solution, state.region.rows());
    let held = trial.free.iter().all(|freedom| !freedom.translation);
    let given = held && trial.free.iter().all(|freedom| freedom.tilt == [false; 2]);
    if given && let Some(share) = share_left(state, trial, c) {
        return fill_guess(state, window, trial, |now, _| share * now);
    }
    let mut reach = state.extrapolation.reach(step.interval.dt);
    if let [Freedom { translation: true, tilt: [false, false], total, .. }] = trial.free[..]
        && reach > 0.0
        && let Some(best) = best_reach(state, &trial.gap, c, total)
    {
        reach = best;
    }
    let positive = |p: f64| if p > 0.0 { p } else { 0.0 };
    let guessed = rows.sum_of_pairs(&now.pressure, &before.pressure, |p, before| positive(p + reach * (p - before)));
    // a single force fixes the load of the guess; else the guess should not stray far from the last state
    let wanted = match trial.free[..] {
        [only] if only.translation => only.total,
        _ => state.current.sum,
    };
    let near = |sum: f64| (wanted / MAX_FORCE_RATIO..=wanted * MAX_FORCE_RATIO).contains(&sum);
    if !near(guessed) {
        reach = 0.0;
    }
    trial.reach = reach;
    // full contact of bodies whose mean is held does not fix the force of a given approach
    let full = state.region.covers() && state.current.contact_cells == state.region.images() * rows.len();
    if held && full && window.kernel.whole.mean_is_held() {
        return trial.solution.release();
    }
    if reach == 0.0 && wanted > 0.0 && !near(state.current.sum) {
        // another load altogether: the last contact is no guide, the solver starts afresh
        return trial.solution.release();
    }
    fill_guess(state, window, trial, |now, before| now + reach * (now - before));
    if reach > 0.0 && window.needs_potential() && step.interval.stride == [0; 2] {
        trial.predicted = predict_contact(state, window, trial, step, c);
    }
}

/// Finds the cells that are likely to be in contact at the end of a step a times as long as the last one. At a moving edge the
/// pressure goes to zero like the root of the distance, and the gap opens like its power 3/2 (Hertz): a pressure that fell to
/// less than √(a/(1 + a)) of itself vanishes, a gap that fell to less than the third power of this factor closes.
///
/// False if the last two gaps are not known, if most cells would join or leave, or if the edge moves so slowly that single
/// cells join: their gaps fall evenly until they touch, which the extrapolated pressure predicts by itself.
fn predict_contact(state: &State, window: &Window, trial: &mut Trial, step: &Step<'_>, c: f64) -> bool {
    let (now, before) = (&state.current, &state.previous);
    let elastic = state.history.exponential_rule().is_some_and(|rule| !rule.has_memory());
    let (change, rows) = (state.history.last_change(), state.region.rows());
    if now.contact_cells == 0 || before.contact_cells == 0 {
        return false;
    }
    // a rank without cells has no changes
    if rows.any(change.is_none() && state.region.len() > 0) && !elastic {
        return false;
    }
    let ahead = state.extrapolation.reach(step.interval.dt);
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
        if still { body.approach } else { body.at(state.region.center(k)) }
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

/// Mean distance in cells by which the edge of the contact moved in the last step: cells that joined or left, over the length of
/// the edge, the number of its sides along one axis or the other. Sides between bands of rows, of which a rank may have one alone,
/// do not count.
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

/// The share of the last pressure that best closes the gap of the step, if it is small. It is exact on a fixed contact with a
/// single relaxation time, and under a punch that is retracted from an elastic body.
fn share_left(state: &State, trial: &Trial, c: f64) -> Option<f64> {
    let (now, rows) = (&state.current.solution, state.region.rows());
    let pressed = |k: usize| now.pressure[k] > 0.0;
    // a pressure that has relaxed by many decades has no square
    let displacements = (0..trial.gap.len()).filter(|&k| pressed(k)).map(|k| (c * now.potential[k]).abs());
    let greatest = rows.greatest(displacements.fold(f64::MIN_POSITIVE, f64::max));
    let [overlap, square] = rows.sum_terms(|k| {
        pressed(k).then(|| {
            let (u, gap) = (c * now.potential[k] / greatest, trial.gap[k] / greatest);
            [-gap * u, u * u]
        })
    });
    let share = overlap / square;
    (share < MAX_SHARE_LEFT).then_some(share.max(0.0))
}

/// The reach a of the guess p₀ + a (p₀ − p₁), scaled to Σ p = `wanted`, with the least energy ½ c p·K p + gap·p. It costs no
/// convolution, since K p₀ and K p₁ are known. It predicts a creep that slows down better than the length of the step does.
fn best_reach(state: &State, gap: &[f64], c: f64, wanted: f64) -> Option<f64> {
    let (now, before) = (&state.current.solution, &state.previous.solution);
    let [p, dp, gap_p, gap_dp, pv, pdv, dpdv] = state.region.rows().sum_terms(|k| {
        let (p, v) = (now.pressure[k], now.potential[k]);
        let (dp, dv) = (p - before.pressure[k], v - before.potential[k]);
        // outside a punch, where the gap is infinite, nothing presses
        (p != 0.0 || dp != 0.0).then(|| [p, dp, gap[k] * p, gap[k] * dp, p * v, p * dv, dp * dv])
    });
    // the direction is p₀ − p₁ minus the multiple of p₀ that makes its force zero
    let (scale, share) = (wanted / p, dp / p);
    let slope = gap_dp - share * gap_p + c * scale * (pdv - share * pv);
    let curvature = c * (dpdv - share * (2.0 * pdv - share * pv));
    let best = -slope / curvature;
    best.is_finite().then_some(best.clamp(0.0, MAX_REACH))
}

/// Resets the trial for a new step; the free motions of the bodies start at their present values.
pub(super) fn begin(state: &State, trial: &mut Trial, step: &Step<'_>) {
    trial.solution.counts = Counts::default();
    trial.solution.relative_rounding = 0.0;
    trial.solution.trace.clear();
    (trial.reach, trial.predicted) = (0.0, false);
    let datum = step.indenter.gap().datum;
    for (body, motion) in trial.solution.motions.iter_mut().enumerate() {
        let RigidMotion { approach, tilt } = state.current.motions[body];
        let modes = state.region.modes(trial.free[body]);
        *motion = modes.coefficients(RigidMotion { approach: approach - datum, tilt });
    }
}

/// Writes p and K p of the guess, each a `prediction` from its values now and before the last step. Where that is due, K p is
/// computed afresh, unless the solver does so itself.
pub(super) fn fill_guess(
    state: &State,
    window: &mut Window,
    trial: &mut Trial,
    prediction: impl Fn(f64, f64) -> f64 + Sync,
) {
    let (now, before, guess) = (&state.current.solution, &state.previous.solution, &mut trial.solution);
    fill(&mut guess.pressure, [&now.pressure, &before.pressure], &prediction);
    if !state.extrapolation.refresh_is_due() {
        fill(&mut guess.potential, [&now.potential, &before.potential], &prediction);
    } else if window.needs_potential() {
        let (kernel, work) = (&window.kernel, &mut window.work);
        kernel.apply(&guess.pressure, &mut guess.potential, work);
        guess.counts.convolutions += 1;
    }
}

/// Writes the prediction of each cell from its values in the last two states.
pub(super) fn fill(guess: &mut [f64], [now, before]: [&[f64]; 2], prediction: &(impl Fn(f64, f64) -> f64 + Sync)) {
    for_each_band([guess], |first, [guesses]| {
        for ((guess, &now), &before) in guesses.iter_mut().zip(&now[first..]).zip(&before[first..]) {
            *guess = prediction(now, before);
        }
    });
}
