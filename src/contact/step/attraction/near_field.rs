//! Steps on the grid without padding.
//!
//! K = N + F. The near field N takes the grid as periodic, without padding: an application costs a quarter of one of K, it equals K between
//! cells that are less than half of the grid apart, and it has an inverse, wave by wave. The far field F is smooth, and zero where contact and attraction take no
//! more than half of the grid. So bodies that end [descend](super::descent) with N, in the gap that c F (z − s) of the beginning opens, and K (z − s) is computed
//! once when they end: a defect correction (Stetter, Numer. Math. 29, 1978). Rounds of descents follow until the new F (z − s) changes
//! nothing any more. What is left of an error after a round is about the share of F in the potential.

use super::{Attracted, AttractedStep};
use crate::contact::step::request::Trial;
use crate::contact::window::Window;
use crate::error::{Error, Result};
use crate::kernel::PeriodInverse;
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
/// A change of F (z − s) of no more than so many times what may be left is one of the error of the descents along a soft direction, if it falls no more:
/// they go on, each time more exact by this factor.
const NEARLY: f64 = 10.0;
const MORE_EXACT: f64 = 0.1;

impl AttractedStep<'_> {
    /// Finishes z, s and K (z − s) of the trial by descents in the gap. Returns whether that sufficed; else they are at least nearer.
    pub(super) fn solve_in_gap(
        &self,
        own: &mut Attracted,
        window: &mut Window,
        trial: &mut Trial,
        counts: &mut Counts,
    ) -> Result<bool> {
        let Some(mut inverse) = window.inverse.take() else { return Ok(false) };
        self.begin_in_gap(window, trial);
        (own.softness, own.exactness) = (0.0, 1.0);
        let solved = if window.has_near_field() {
            self.descend_in_rounds(&mut inverse, own, window, trial, counts)
        } else {
            self.descend_in_gap(&mut inverse, own, window, trial, counts).map(|()| true)
        };
        window.inverse = Some(inverse);
        solved
    }

    /// Rounds of descents with the near field.
    fn descend_in_rounds(
        &self,
        inverse: &mut PeriodInverse,
        own: &mut Attracted,
        window: &mut Window,
        trial: &mut Trial,
        counts: &mut Counts,
    ) -> Result<bool> {
        if self.extent(trial) > MAX_EXTENT {
            return Ok(false);
        }
        self.split(own, window, trial, counts);
        let (c, mut pays, mut last) = (self.given[0], true, f64::INFINITY);
        while pays {
            self.open_gap(window, trial);
            for_each_band([&mut trial.gap], |first, [gap]| {
                gap.iter_mut().zip(&own.far[first..]).for_each(|(gap, far)| *gap += c * far);
            });
            let before = counts.convolutions;
            let passed = window.with_near_field(|window| self.descend_in_gap(inverse, own, window, trial, counts));
            counts.preconditioner_applications += self.near_price() * (counts.convolutions - before);
            counts.convolutions = before;
            match passed {
                Err(Error::Cancelled { what }) => return Err(Error::Cancelled { what }),
                Err(_) => {
                    // perhaps there is a state with K
                    self.begin_in_gap(window, trial);
                    return Ok(false);
                }
                Ok(()) => {}
            }
            let [change, most] = self.correct(own, window, trial, counts);
            let most = c * most * self.scene.softening / self.law.traction(0.0);
            let allowed = MOST_CHANGE * self.tolerance(own.softness);
            if most <= allowed {
                trial.solution.potential.iter_mut().zip(&own.far).for_each(|(v, far)| *v += far);
                return Ok(true);
            }
            pays = change <= LEAST_GAIN * last;
            if !pays && most <= NEARLY * allowed && own.exactness > MORE_EXACT * MORE_EXACT {
                (own.exactness, pays) = (MORE_EXACT * own.exactness, true);
            }
            last = change;
        }
        trial.solution.potential.iter_mut().zip(&own.far).for_each(|(v, far)| *v += far);
        Ok(false)
    }

    /// Convolutions with N, in quarters of one with K: along an axis that is periodic, or a single cell, nothing is padded.
    fn near_price(&self) -> usize {
        if self.scene.kernel.periodic_axes() == [false; 2] { 1 } else { 2 }
    }

    /// The greatest distance along an axis between cells that act, over the length of the grid.
    fn extent(&self, trial: &Trial) -> f64 {
        let (region, Solution { pressure, attraction, .. }) = (&self.state.region, &trial.solution);
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

    /// F (z − s) anew; returns Σ (z + s) |ΔF (z − s)|, and the greatest |ΔF (z − s)|.
    fn correct(&self, own: &mut Attracted, window: &mut Window, trial: &Trial, counts: &mut Counts) -> [f64; 2] {
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
    fn split(&self, own: &mut Attracted, window: &mut Window, trial: &mut Trial, counts: &mut Counts) {
        let (near, far) = window.with_near_field(|window| own.image_of_net(&trial.solution, window));
        counts.preconditioner_applications += self.near_price();
        std::mem::swap(far, &mut trial.solution.potential);
        far.iter_mut().zip(near).for_each(|(far, near)| *far -= near);
        trial.solution.potential.copy_from_slice(near);
    }
}
