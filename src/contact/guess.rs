//! The first guess of a step.

use crate::contact::viscoelastic::{ContactSolver, ViscoelasticContact};
use crate::solver::{Counts, Modes, RigidMotion};
use crate::sum::{sum, sum_of_pairs};

/// A guess reaches at most this many times the length of the last step ahead.
const FARTHEST_GUESS: f64 = 2.0;

/// A guess is extrapolated only if it carries the force to within this factor: what is left after a
/// cancellation is noise.
const FARTHEST_FORCE: f64 = 1.5;

/// The first guess of a step extrapolates p and K p alike, which saves a convolution but lets the rounding
/// of K p accumulate, step by step linearly. After so many steps it is computed afresh, in two steps
/// running: extrapolation reads two states, and one left stale would feed its error back, multiplied. This
/// costs a thirty-second of a convolution a step.
const STEPS_WITHOUT_REFRESH: usize = 62;

/// It is computed afresh, too, when the force has fallen by this factor: the rounding was that of the
/// larger force.
const FALL_WITHOUT_REFRESH: f64 = 8.0;

/// And when steps that grow have multiplied the rounding by this: a guess that reaches a times the last step ahead
/// takes the difference of the errors of the last two states a times along.
const GROWTH_WITHOUT_REFRESH: f64 = 1e3;

/// When K p was last computed afresh.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Refresh {
    /// Steps still to compute it afresh.
    due: usize,
    /// Steps since then.
    stale: usize,
    /// The greatest Σ p since then.
    greatest: f64,
    /// How much larger the rounding has grown since then.
    growth: f64,
    /// How far ahead the guess under way reaches.
    ahead: f64,
}

impl Default for Refresh {
    fn default() -> Refresh {
        Refresh { due: 0, stale: 0, greatest: 0.0, growth: 1.0, ahead: 0.0 }
    }
}

impl Refresh {
    /// After a step with Σ p = `sum`.
    pub(super) fn count(&mut self, sum: f64) {
        if self.due > 0 {
            *self = Refresh { due: self.due - 1, greatest: sum, ..Refresh::default() };
            return;
        }
        self.stale = self.stale.saturating_add(1);
        self.greatest = self.greatest.max(sum);
        self.growth *= self.ahead.max(1.0);
        if self.growth > GROWTH_WITHOUT_REFRESH
            || self.stale >= STEPS_WITHOUT_REFRESH
            || sum < self.greatest / FALL_WITHOUT_REFRESH
        {
            self.due = 2;
        }
    }
}

/// Where motions are given and the pressure falls to less than this share in a step, what has passed is no guide: the last
/// pressure is scaled by what is left.
const RELAXES_SLOWLY: f64 = 0.5;

impl ViscoelasticContact {
    /// Fills the trial with a guess: the state extrapolated from the last step, p and K p alike. Bodies of given motion whose
    /// pressure falls a lot in this step of compliance `c` get the last one scaled: K p would keep the rounding of a greater one.
    pub(super) fn guess(&mut self, dt: f64, c: f64) {
        self.begin_trial();
        let given = self.freedoms.iter().all(|freedom| !freedom.translation && freedom.tilt == [false; 2]);
        if given && let Some(share) = self.left_of_pressure(c) {
            for (trial, state) in [
                (&mut self.trial.pressure, &self.state.current.pressure),
                (&mut self.trial.potential, &self.state.current.potential),
            ] {
                trial.iter_mut().zip(state).for_each(|(trial, &value)| *trial = share * value);
            }
            return self.refresh_if_due();
        }
        let mut ahead = if self.state.last_dt > 0.0 { (dt / self.state.last_dt).min(FARTHEST_GUESS) } else { 0.0 };
        let positive = |p: f64| if p > 0.0 { p } else { 0.0 };
        let guess = |p: f64, before: f64| positive(p + ahead * (p - before));
        let guessed = sum_of_pairs(&self.state.current.pressure, &self.state.previous.pressure, guess);
        // a single force says what the guess must carry; else it should not stray far from the last state
        let wanted = if self.freedoms.len() == 1 && self.freedoms[0].translation {
            self.freedoms[0].total
        } else {
            sum(&self.state.current.pressure)
        };
        let near = |sum: f64| (wanted / FARTHEST_FORCE..=wanted * FARTHEST_FORCE).contains(&sum);
        if !near(guessed) {
            ahead = 0.0;
        }
        self.state.refresh.ahead = ahead;
        // full contact of bodies whose mean is held does not tell how hard a given approach presses
        let held = self.freedoms.iter().all(|freedom| !freedom.translation);
        if held && self.state.contact_cells == self.grid.len() && self.kernel_here.mean_is_held() {
            return self.trial.release();
        }
        if ahead == 0.0 && wanted > 0.0 && !near(sum(&self.state.current.pressure)) {
            // another load altogether: the last contact is no guide, the solver starts afresh
            return self.trial.release();
        }
        self.extrapolate(ahead);
    }

    /// The share of the last pressure that best closes the gap of the step, if it is small. On a fixed contact a single
    /// relaxation time leaves exactly that, and so does a punch that is lifted from an elastic body.
    fn left_of_pressure(&self, c: f64) -> Option<f64> {
        let (mut overlap, mut square) = (0.0, 0.0);
        let state = self.state.current.pressure.iter().zip(&self.state.current.potential);
        for ((_, &v), &gap) in state.zip(&self.gap).filter(|((p, _), _)| **p > 0.0) {
            (overlap, square) = (overlap - gap * c * v, square + c * v * (c * v));
        }
        let share = overlap / square;
        (share < RELAXES_SLOWLY).then_some(share.max(0.0))
    }

    /// Counts nothing yet, and leaves the bodies where they are, as far as their loads leave them free.
    pub(super) fn begin_trial(&mut self) {
        self.trial.counts = Counts::default();
        self.trial.rounding = 0.0;
        self.trial.trace.clear();
        self.state.refresh.ahead = 0.0;
        for (body, motion) in self.trial.motions.iter_mut().enumerate() {
            let [omega, alpha1, alpha2] = self.state.motions[body];
            let modes = Modes::new(self.region.grid(), self.freedoms[body]);
            *motion =
                modes.coefficients(RigidMotion { approach: omega - self.initial_gap.datum, tilt: [alpha1, alpha2] });
        }
    }

    /// Writes p and K p to the trial, `ahead` times the last step ahead; K p computed afresh where that is due.
    pub(super) fn extrapolate(&mut self, ahead: f64) {
        let extrapolate = |trial: &mut [f64], current: &[f64], previous: &[f64]| {
            for ((guess, &now), &before) in trial.iter_mut().zip(current).zip(previous) {
                *guess = now + ahead * (now - before);
            }
        };
        extrapolate(&mut self.trial.pressure, &self.state.current.pressure, &self.state.previous.pressure);
        if self.state.refresh.due == 0 {
            extrapolate(&mut self.trial.potential, &self.state.current.potential, &self.state.previous.potential);
        }
        self.refresh_if_due();
    }

    /// Computes K p of the guess afresh where that is due, and the solver does not do so itself.
    fn refresh_if_due(&mut self) {
        if self.state.refresh.due > 0 && matches!(self.solver, ContactSolver::ActiveSet(_)) {
            self.kernel_here.apply(&self.trial.pressure, &mut self.trial.potential, &mut self.work);
            self.trial.counts.convolutions += 1;
        }
    }
}
