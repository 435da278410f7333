//! The initial guess of the pressure.

use crate::equilibrium::extrapolation::MAX_REACH;
use crate::equilibrium::{Equilibrium, Held, Request, Trial, Window};
use crate::parallel::{Rows, for_each_band};
use crate::solver::{Counts, Freedom, RigidMotion, Solution};

/// Fills the trial with a guess at the compliance `c`: p and K p extrapolated from the equilibrium `before` the last
/// one, as far as `longest` times its distance. Under bodies of given motion whose pressure falls a lot, the last
/// pressure is scaled: an extrapolated K p would keep the rounding of the greater pressure. Returns whether the guess
/// is extrapolated.
pub(crate) fn initial_guess(
    held: &Held,
    (before, longest): (&Equilibrium, f64),
    window: &mut Window,
    trial: &mut Trial,
    request: Request<'_>,
    c: f64,
) -> bool {
    begin(held, trial, request);
    let (now, before, rows) = (&held.current.solution, &before.solution, held.region.rows());
    let still = trial.free.iter().all(|freedom| !freedom.translation);
    let given = still && trial.free.iter().all(|freedom| freedom.tilt == [false; 2]);
    if given && let Some(share) = share_left(held, trial, c) {
        fill_guess(held, before, window, trial, |now, _| share * now);
        return false;
    }
    let mut reach = longest;
    if let [Freedom { translation: true, tilt: [false, false], total, .. }] = trial.free[..]
        && reach > 0.0
        && let Some(best) = best_reach([now, before], &rows, &trial.gap, c, total)
    {
        reach = best;
    }
    let positive = |p: f64| if p > 0.0 { p } else { 0.0 };
    let guessed = rows.sum_of_pairs(&now.pressure, &before.pressure, |p, before| positive(p + reach * (p - before)));
    // a single force fixes the load of the guess; else the guess should not stray far from the last state
    let wanted = match trial.free[..] {
        [only] if only.translation => only.total,
        _ => held.current.sum,
    };
    // what carries another force is the remainder of a cancellation, and noise
    let near = |sum: f64| (wanted / 1.5..=wanted * 1.5).contains(&sum);
    if !near(guessed) {
        reach = 0.0;
    }
    trial.reach = reach;
    // full contact of bodies whose mean is held does not fix the force of a given approach
    let full = held.region.covers() && held.current.contact_cells == held.region.images() * rows.len();
    // another load altogether: the last contact is no guide, the solver starts afresh
    let afresh = reach == 0.0 && wanted > 0.0 && !near(held.current.sum);
    if still && full && window.kernel.whole.mean_is_held() || afresh {
        trial.solution.release();
        return false;
    }
    fill_guess(held, before, window, trial, |now, before| now + reach * (now - before));
    reach > 0.0
}

/// The share of the last pressure that best closes the gap of the step, if it is less than half: then its last change
/// does not predict the next. It is exact on a fixed contact with a single relaxation time, and under a punch that is
/// retracted from an elastic body.
fn share_left(held: &Held, trial: &Trial, c: f64) -> Option<f64> {
    let (now, rows) = (&held.current.solution, held.region.rows());
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
    (share < 0.5).then_some(share.max(0.0))
}

/// The reach a of the guess p₀ + a (p₀ − p₁), scaled to Σ p = `wanted`, with the least energy ½ c p·K p + gap·p. It
/// costs no convolution, since K p₀ and K p₁ are known. It predicts a creep that slows down better than the length of
/// the step does.
fn best_reach([now, before]: [&Solution; 2], rows: &Rows, gap: &[f64], c: f64, wanted: f64) -> Option<f64> {
    let [p, dp, gap_p, gap_dp, pv, pdv, dpdv] = rows.sum_terms(|k| {
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

/// Resets the trial; the free motions of the bodies start at their present values.
pub(crate) fn begin(held: &Held, trial: &mut Trial, request: Request<'_>) {
    trial.solution.counts = Counts::default();
    trial.solution.relative_rounding = 0.0;
    (trial.reach, trial.predicted) = (0.0, false);
    let datum = request.indenter.gap().datum;
    for (body, motion) in trial.solution.motions.iter_mut().enumerate() {
        let RigidMotion { approach, tilt } = held.current.motions[body];
        let modes = held.region.modes(trial.free[body]);
        *motion = modes.coefficients(RigidMotion { approach: approach - datum, tilt });
    }
}

/// Writes p and K p of the guess, each a `prediction` from its values now and `before`. Where that is due, K p is
/// computed afresh, unless the solver does so itself.
pub(crate) fn fill_guess(
    held: &Held,
    before: &Solution,
    window: &mut Window,
    trial: &mut Trial,
    prediction: impl Fn(f64, f64) -> f64 + Sync,
) {
    let (now, guess) = (&held.current.solution, &mut trial.solution);
    fill(&mut guess.pressure, [&now.pressure, &before.pressure], &prediction);
    if !held.extrapolation.refresh_is_due() {
        fill(&mut guess.potential, [&now.potential, &before.potential], &prediction);
    } else {
        let (kernel, work) = (&window.kernel, &mut window.work);
        kernel.apply(&guess.pressure, &mut guess.potential, work);
        guess.counts.convolutions += 1;
    }
}

/// Writes the prediction of each cell from its values in the last two states.
pub(crate) fn fill(guess: &mut [f64], [now, before]: [&[f64]; 2], prediction: &(impl Fn(f64, f64) -> f64 + Sync)) {
    for_each_band([guess], |first, [guesses]| {
        for ((guess, &now), &before) in guesses.iter_mut().zip(&now[first..]).zip(&before[first..]) {
            *guess = prediction(now, before);
        }
    });
}
