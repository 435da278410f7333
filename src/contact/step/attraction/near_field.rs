//! Passes on the grid without padding.
//!
//! K = N + F. The near field N takes the grid as periodic, without padding: an application costs a quarter of one of K, and equals it between
//! cells that are less than half of the grid apart. The far field F is smooth, and zero where contact and attraction take no more than half of the
//! grid. So passes work with N, in the gap that c F (z − s) of their beginning opens, and K (z − s) is computed once when they end: a defect
//! correction (Stetter, Numer. Math. 29, 1978). Rounds of passes follow until the new F (z − s) changes nothing any more. What is left of an
//! error after a round is about the share of F in the potential.

use super::{AttractedStep, Passes};
use crate::contact::step::initial_guess::begin;
use crate::contact::step::request::Trial;
use crate::contact::window::Window;
use crate::error::{Error, Result};
use crate::solver::{Counts, Solution};

/// Cells act where they touch, or with this share of the greatest attraction.
const LEAST_ACTION: f64 = 0.1;
/// The part of the grid that cells that act may span, along each axis.
const MAX_EXTENT: f64 = 0.8;
/// What a round may leave of the change of F (z − s) in the round before.
const LEAST_GAIN: f64 = 0.1;

impl AttractedStep<'_> {
    /// Improves z, s and K (z − s) of the trial by rounds of passes with the near field. Returns whether that sufficed.
    pub(super) fn solve_near(
        &self,
        own: &mut Passes,
        window: &mut Window,
        trial: &mut Trial,
        counts: &mut Counts,
    ) -> Result<bool> {
        if !window.has_near_field() || self.extent(trial) > MAX_EXTENT {
            return Ok(false);
        }
        self.split(own, window, trial, counts);
        let (mut solved, mut pays, mut last) = (false, true, f64::INFINITY);
        while pays && !solved {
            let before = counts.convolutions;
            let passed = window.with_near_field(|window| self.descend(own, window, trial, counts));
            counts.preconditioner_applications += counts.convolutions - before;
            counts.convolutions = before;
            match passed {
                Err(Error::Cancelled { what }) => return Err(Error::Cancelled { what }),
                Err(_) => {
                    // perhaps there is a state with K
                    trial.free[0] = self.wanted;
                    self.open_gap(window, trial);
                    begin(self.state, trial, self.step);
                    self.guess(window, trial, counts);
                    return Ok(false);
                }
                Ok(changed) => solved = !changed && last.is_finite(),
            }
            if !solved {
                let change = self.correct(own, window, trial, counts);
                pays = change <= LEAST_GAIN * last;
                last = change;
            }
        }
        let near = own.image.iter().zip(&own.far);
        trial.solution.potential.iter_mut().zip(near).for_each(|(v, (image, far))| *v += far - image);
        Ok(solved)
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

    /// F (z − s) anew; returns Σ (z + s) |ΔF (z − s)|.
    fn correct(&self, own: &mut Passes, window: &mut Window, trial: &Trial, counts: &mut Counts) -> f64 {
        let Solution { pressure, attraction, potential, .. } = &trial.solution;
        let Passes { last: [net, exact], far, image, .. } = own;
        net.iter_mut().zip(pressure.iter().zip(attraction)).for_each(|(net, (z, s))| *net = z - s);
        let Window { kernel, work, .. } = &mut *window;
        kernel.apply(net, exact, work);
        counts.convolutions += 1;
        let mut changed = 0.0;
        for (k, far) in far.iter_mut().enumerate() {
            let now = exact[k] - (potential[k] - image[k]);
            changed += (pressure[k] + attraction[k]) * (now - *far).abs();
            *far = now;
        }
        changed
    }

    /// Writes N z and N s to the potential and the image, and takes N (z − s) from K (z − s).
    fn split(&self, own: &mut Passes, window: &mut Window, trial: &mut Trial, counts: &mut Counts) {
        let Solution { pressure, attraction, potential, .. } = &mut trial.solution;
        own.far.copy_from_slice(potential);
        window.with_near_field(|Window { kernel, work, .. }| {
            kernel.apply(pressure, potential, work);
            kernel.apply(attraction, &mut own.image, work);
        });
        counts.preconditioner_applications += 2;
        let near = potential.iter().zip(&own.image);
        own.far.iter_mut().zip(near).for_each(|(far, (v, image))| *far -= v - image);
    }
}
