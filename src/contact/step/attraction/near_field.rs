//! Steps on the grid without padding.
//!
//! K = N + F. The near field N takes the grid as periodic, without padding: an application costs a quarter of one of
//! K, it equals K between cells that are less than half of the grid apart, and it has an inverse, wave by wave. The
//! far field F is smooth, and zero where contact and attraction take no more than half of the grid. So bodies that
//! end [descend](super::descent) with N, in the gap that c F (z − s) of the beginning opens, and K (z − s) is
//! computed once when they end: a defect correction (Stetter, Numer. Math. 29, 1978). Rounds of descents follow until
//! the new F (z − s) changes nothing any more. What is left of an error after a round is about the share of F in the
//! potential.

use super::descent::Descent;
use super::{Attracted, AttractedStep};
use crate::equilibrium::Trial;
use crate::equilibrium::window::Window;
use crate::error::{Error, Result};
use crate::parallel::for_each_band;
use crate::solver::{Counts, Solution};

/// Cells act where they touch, or with this share of the greatest attraction.
const LEAST_ACTION: f64 = 0.1;
/// The part of the grid that cells that act may span, along each axis.
const MAX_EXTENT: f64 = 0.8;
/// Rounds end where the new F (z − s) changes s by this part of what the tolerance allows.
const MOST_CHANGE: f64 = 0.3;
/// What a round may leave of the change of F (z − s) in the round before.
const LEAST_GAIN: f64 = 0.1;
/// A change of F (z − s) of no more than so many times what may be left is one of the error of the descents along a
/// soft direction, if it falls no more: they go on, each time more exact by this factor.
const NEARLY: f64 = 10.0;
const MORE_EXACT: f64 = 0.1;

impl AttractedStep<'_> {
    /// Finishes z, s and K (z − s) of the trial by descents in the gap. Returns whether that sufficed; else they are
    /// at least nearer.
    pub(super) fn solve_in_gap(
        &self,
        own: &mut Attracted,
        window: &mut Window,
        trial: &mut Trial,
        counts: &mut Counts,
    ) -> Result<bool> {
        let Some(mut inverse) = window.inverse.take() else { return Ok(false) };
        self.begin_in_gap(window, trial);
        (own.softness, own.exactness, own.softest) = (0.0, 1.0, None);
        let (near, balance) = (window.near.is_some(), self.balance(window, &inverse));
        let mut descent = Descent { problem: self, balance, inverse: &mut inverse, own, window, trial, counts };
        let solved = if near { descent.run_in_rounds() } else { descent.run().map(|()| true) };
        window.inverse = Some(inverse);
        solved
    }

    /// Convolutions with N, in quarters of one with K: along an axis that is periodic, or a single cell, nothing is
    /// padded.
    fn near_price(&self) -> usize {
        if self.scene.ground.kernel.periodic_axes() == [false; 2] { 1 } else { 2 }
    }

    /// The greatest distance along an axis between cells that act, over the length of the grid.
    fn extent(&self, trial: &Trial) -> f64 {
        let (region, Solution { pressure, attraction, .. }) = (&self.state.held.region, &trial.solution);
        let least = LEAST_ACTION * self.law.traction(0.0);
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
}

impl Descent<'_> {
    /// Rounds of descents with the near field.
    fn run_in_rounds(&mut self) -> Result<bool> {
        let problem = self.problem;
        if problem.extent(self.trial) > MAX_EXTENT {
            return Ok(false);
        }
        self.split();
        let (c, mut pays, mut last) = (self.balance.compliance, true, f64::INFINITY);
        while pays {
            problem.open_gap(self.window, self.trial);
            for_each_band([&mut self.trial.gap], |first, [gap]| {
                gap.iter_mut().zip(&self.own.far[first..]).for_each(|(gap, far)| *gap += c * far);
            });
            let before = self.counts.convolutions;
            self.window.trade_kernels();
            let passed = self.run();
            self.window.trade_kernels();
            self.counts.preconditioner_applications += problem.near_price() * (self.counts.convolutions - before);
            self.counts.convolutions = before;
            match passed {
                Err(Error::Cancelled { what }) => return Err(Error::Cancelled { what }),
                Err(_) => {
                    // perhaps there is a state with K
                    problem.begin_in_gap(self.window, self.trial);
                    return Ok(false);
                }
                Ok(()) => {}
            }
            let [change, most] = self.correct();
            let most = c * most * problem.scene.ground.softening / problem.law.traction(0.0);
            let allowed = MOST_CHANGE * problem.tolerance(self.own.softness);
            if most <= allowed {
                self.join();
                return Ok(true);
            }
            pays = change <= LEAST_GAIN * last;
            if !pays && most <= NEARLY * allowed && self.own.exactness > MORE_EXACT * MORE_EXACT {
                (self.own.exactness, pays) = (MORE_EXACT * self.own.exactness, true);
            }
            last = change;
        }
        self.join();
        Ok(false)
    }

    /// Adds the far field to N (z − s).
    fn join(&mut self) {
        self.trial.solution.potential.iter_mut().zip(&self.own.far).for_each(|(v, far)| *v += far);
    }

    /// F (z − s) anew; returns Σ (z + s) |ΔF (z − s)|, and the greatest |ΔF (z − s)|.
    fn correct(&mut self) -> [f64; 2] {
        let Descent { own, window, trial, counts, .. } = self;
        let Solution { pressure, attraction, potential, .. } = &trial.solution;
        let (exact, far) = own.image_of_net(&trial.solution, window);
        counts.convolutions += 1;
        let (mut changed, mut most) = (0.0, 0.0_f64);
        for (k, far) in far.iter_mut().enumerate() {
            let now = exact[k] - potential[k];
            let change = (now - *far).abs();
            (changed, most) = (changed + (pressure[k] + attraction[k]) * change, most.max(change));
            *far = now;
        }
        [changed, most]
    }

    /// Writes N (z − s) to the potential, and what it lacks of K (z − s) to the far field.
    fn split(&mut self) {
        let Descent { own, window, trial, counts, .. } = self;
        window.trade_kernels();
        let (near, far) = own.image_of_net(&trial.solution, window);
        window.trade_kernels();
        counts.preconditioner_applications += self.problem.near_price();
        std::mem::swap(far, &mut trial.solution.potential);
        far.iter_mut().zip(near).for_each(|(far, near)| *far -= near);
        trial.solution.potential.copy_from_slice(near);
    }
}
