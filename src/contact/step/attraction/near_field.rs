//! Steps on the grid without padding.
//!
//! K = N + F. The near field N takes the grid as periodic, without padding: an application costs a quarter of one of
//! K, it equals K between cells that are less than half of the grid apart, and it has an inverse, wave by wave. The
//! far field F is smooth, and zero where contact and attraction take no more than half of the grid. So bodies that
//! end [descend](super::descent) with N, in the gap that c F (z − s) of the beginning opens, and K (z − s) is
//! computed once when they end: a defect correction (Stetter, Numer. Math. 29, 1978). Rounds of descents follow until
//! the new F (z − s) changes nothing any more. What is left of an error after a round is about the share of F in the
//! potential.

use super::balance::Operators;
use super::descent::Descent;
use super::{Attracted, AttractedStep};
use crate::equilibrium::Trial;
use crate::equilibrium::window::Window;
use crate::error::{Error, Refusal, Result};
use crate::parallel::for_each_band;
use crate::rounded::{TIME, rounded};
use crate::solver::{Counts, Solution};

/// How rounds go on, and end.
struct Rounds {
    /// Where the new F (z − s) changes s by this part of what the tolerance allows, and after so many.
    change: f64,
    most: usize,
    /// What a round takes in of a change of F (z − s), at least and at most.
    relaxation: [f64; 2],
    /// They may fail where cells that act span more than this part of the grid along an axis.
    extent: f64,
}

const ROUNDS: Rounds = Rounds { change: 0.3, most: 60, relaxation: [0.1, 3.0], extent: 0.8 };

impl AttractedStep<'_> {
    /// Finishes z, s and K (z − s) of the trial by descents in the gap.
    pub(super) fn solve_in_gap(
        &self,
        own: &mut Attracted,
        window: &mut Window,
        trial: &mut Trial,
        counts: &mut Counts,
    ) -> Result<()> {
        let Some(mut inverse) = own.inverse.take() else { return Err(self.not_converged(own, f64::INFINITY)) };
        self.begin_in_gap(window, trial);
        (own.softness, own.softest) = (0.0, None);
        let (near, balance) = (own.near.is_some(), self.balance(window, &inverse));
        let operators = Operators { balance, inverse: &mut inverse, window, counts };
        let mut descent = Descent { problem: self, operators, own: &mut *own, trial };
        let solved = if near { descent.run_in_rounds() } else { descent.run() };
        own.inverse = Some(inverse);
        solved
    }

    /// Convolutions with N, in quarters of one with K: along an axis that is periodic, or a single cell, nothing is
    /// padded.
    fn near_price(&self) -> usize {
        if self.scene.ground.kernel.periodic_axes() == [false; 2] { 1 } else { 2 }
    }

    /// The maximum distance along an axis between cells that touch, or act with a tenth of the maximum attraction, over
    /// the length of the grid.
    fn extent(&self, trial: &Trial) -> f64 {
        let (region, Solution { pressure, attraction, .. }) = (&self.state.held.region, &trial.solution);
        let least = 0.1 * self.law.traction(0.0);
        let columns = region.cells()[1];
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for k in (0..pressure.len()).filter(|&k| pressure[k] > 0.0 || attraction[k] > least) {
            for ([low, high], at) in ends.iter_mut().zip([(k / columns) as f64, (k % columns) as f64]) {
                (*low, *high) = (low.min(at), high.max(at));
            }
        }
        // along a folded axis the mirror image lies before its beginning
        let begin = |axis: usize| if region.folded()[axis] { 0.0 } else { ends[axis][0] };
        let [along1, along2] = [0, 1].map(|axis| (ends[axis][1] - begin(axis)) / region.cells()[axis] as f64);
        along1.max(along2)
    }

    /// The error of a descent that leaves such a change.
    pub(super) fn not_converged(&self, own: &Attracted, change: f64) -> Error {
        let (time, tolerance) = (self.step.interval.time, self.limit());
        let what = format!(
            "at t = {} s {} passes left a change of the traction of {change:.1e} of its maximum, where \
             {tolerance:.1e} is allowed",
            rounded(time, TIME),
            own.report.passes
        );
        Refusal::search("adhesion_not_converged", what, ": take a shorter step").into()
    }
}

impl Descent<'_> {
    /// Rounds of descents with the near field.
    fn run_in_rounds(&mut self) -> Result<()> {
        let problem = self.problem;
        if problem.wanted.tilts() {
            self.with_near_field(|descent| descent.operators.free_tilts(problem));
        }
        self.split_off_far_field();
        let (c, mut last, mut relaxation) = (problem.compliance, f64::INFINITY, None);
        for _ in 0..ROUNDS.most {
            problem.open_gap(self.operators.window, self.trial);
            for_each_band([&mut self.trial.gap], |first, [gap]| {
                gap.iter_mut().zip(&self.own.far[first..]).for_each(|(gap, far)| *gap += c * far);
            });
            self.with_near_field(Descent::run)?;
            let (most, next) = self.correct_far_field(relaxation);
            let change = c * most * problem.scene.ground.softening / problem.law.traction(0.0);
            if change <= ROUNDS.change * problem.tolerance(self.own.softness) {
                self.add_far_field();
                return Ok(());
            }
            (last, relaxation) = (change, Some(next));
            self.own.relax(next);
        }
        let share = problem.extent(self.trial);
        if share <= ROUNDS.extent {
            return Err(problem.not_converged(self.own, last));
        }
        let (time, lengths) = (problem.step.interval.time, problem.scene.ground.grid.lengths());
        let what = format!(
            "at t = {} s no state was found: contact and attraction span {:.0} % of the grid of {} × {} m, where \
             steps end for certain up to {:.0} %",
            rounded(time, TIME),
            100.0 * share,
            rounded(lengths[0], 4),
            rounded(lengths[1], 4),
            100.0 * ROUNDS.extent
        );
        let remedy = ": enlarge the grid (beyond a body that ends the gap is infinite), or give a surface that \
            repeats a periodic body";
        Err(Refusal::search("adhesion_fills_grid", what, remedy).into())
    }

    /// Computes with N in the place of K.
    fn with_near_field<T>(&mut self, compute: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.operators.counts.convolutions;
        self.own.swap_near_field(self.operators.window);
        let done = compute(self);
        self.own.swap_near_field(self.operators.window);
        let counts = &mut self.operators.counts;
        counts.preconditioner_applications += self.problem.near_price() * (counts.convolutions - before);
        counts.convolutions = before;
        done
    }

    /// Adds the far field of z − s to N (z − s).
    fn add_far_field(&mut self) {
        let Attracted { far, change, .. } = &*self.own;
        let parts = far.iter().zip(change);
        self.trial.solution.potential.iter_mut().zip(parts).for_each(|(v, (far, change))| *v += far + change);
    }

    /// The change of F (z − s), and the part of it that Aitken's rule takes after two rounds (Irons & Tuck, Int. J. Numer.
    /// Methods Eng. 1, 1969): where contact and attraction take most of the grid, F is no small part. Returns
    /// the maximum |ΔF (z − s)| and the part; `relaxation` is that of the round before.
    fn correct_far_field(&mut self, relaxation: Option<f64>) -> (f64, f64) {
        let Descent { own, operators, trial, .. } = self;
        let potential = &trial.solution.potential;
        let (exact, far, changes) = own.image_of_net(&trial.solution, operators.window);
        operators.counts.convolutions += 1;
        let (mut most, mut along, mut square) = (0.0_f64, 0.0, 0.0);
        for (k, change) in changes.iter_mut().enumerate() {
            let before = std::mem::replace(change, exact[k] - potential[k] - far[k]);
            let less = *change - before;
            most = most.max(change.abs());
            (along, square) = (along + before * less, square + less * less);
        }
        let next = relaxation.map_or(1.0, |last| {
            if square > 0.0 { (-last * along / square).clamp(ROUNDS.relaxation[0], ROUNDS.relaxation[1]) } else { last }
        });
        (most, next)
    }

    /// Writes N (z − s) to the potential, and what it lacks of K (z − s) to the far field.
    fn split_off_far_field(&mut self) {
        self.with_near_field(|Descent { own, operators, trial, .. }| {
            let (near, far, _) = own.image_of_net(&trial.solution, operators.window);
            operators.counts.convolutions += 1;
            std::mem::swap(far, &mut trial.solution.potential);
            far.iter_mut().zip(near).for_each(|(far, near)| *far -= near);
            trial.solution.potential.copy_from_slice(near);
        });
    }
}
