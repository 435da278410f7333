//! Passes on the grid without padding.
//!
//! K = N + F. The near field N takes the grid as periodic, without padding: an application costs a quarter of one of K, and equals it between
//! cells that are less than half of the grid apart. The far field F is smooth, and zero where contact and attraction take no more than half of the
//! grid. So passes work with N, in the gap that c F (z − s) of their beginning opens, and K (z − s) is computed once when they end: a defect
//! correction (Stetter, Numer. Math. 29, 1978). Rounds of passes follow until the new F (z − s) changes nothing any more. What is left of an
//! error after a round is about the share of F in the potential.

use super::{AttractedStep, Passes};
use crate::contact::step::request::Trial;
use crate::contact::window::Window;
use crate::error::{Error, Result};
use crate::solver::{Counts, Solution};

/// The share of F in the potential up to which the rounds gain.
const MAX_SHARE: f64 = 0.2;
/// Rounds of passes after which a step begins again with K alone.
const MAX_ROUNDS: usize = 10;

impl AttractedStep<'_> {
    /// The step with the near field; false where that does not suffice.
    pub(super) fn solve_near(
        &self,
        own: &mut Passes,
        window: &mut Window,
        trial: &mut Trial,
        counts: &mut Counts,
    ) -> Result<bool> {
        if !window.has_near_field() {
            return Ok(false);
        }
        self.guess(window, trial, counts);
        own.far.copy_from_slice(&trial.solution.potential);
        self.split(own, window, trial, counts);
        if std::env::var("DBG").is_ok() { eprintln!("share {:.3}", self.share(own, trial)); }
        if self.share(own, trial) > std::env::var("SHARE").map_or(MAX_SHARE, |l| l.parse().unwrap()) {
            return Ok(false);
        }
        for round in 0..MAX_ROUNDS {
            let before = counts.convolutions;
            let changed = window.with_near_field(|window| self.descend(own, window, trial, counts));
            counts.preconditioner_applications += counts.convolutions - before;
            counts.convolutions = before;
            match changed {
                Err(Error::Cancelled { what }) => return Err(Error::Cancelled { what }),
                // perhaps there is a state with K
                Err(_) => return Ok(false),
                Ok(false) if round > 0 => {
                    let near = own.image.iter().zip(&own.far);
                    trial.solution.potential.iter_mut().zip(near).for_each(|(v, (image, far))| *v += far - image);
                    return Ok(true);
                }
                Ok(_) => {}
            }
            let Solution { pressure, attraction, potential, .. } = &trial.solution;
            let net = &mut own.last[0];
            net.iter_mut().zip(pressure.iter().zip(attraction)).for_each(|(net, (z, s))| *net = z - s);
            let Window { kernel, work, .. } = &mut *window;
            kernel.apply(net, &mut own.far, work);
            counts.convolutions += 1;
            let near = potential.iter().zip(&own.image);
            own.far.iter_mut().zip(near).for_each(|(far, (v, image))| *far -= v - image);
        }
        Ok(false)
    }

    /// Writes N z and N s to the potential and the image, and takes N (z − s) from K (z − s).
    fn split(&self, own: &mut Passes, window: &mut Window, trial: &mut Trial, counts: &mut Counts) {
        let Solution { pressure, attraction, potential, .. } = &mut trial.solution;
        window.with_near_field(|Window { kernel, work, .. }| {
            kernel.apply(pressure, potential, work);
            kernel.apply(attraction, &mut own.image, work);
        });
        counts.preconditioner_applications += 2;
        let near = potential.iter().zip(&own.image);
        own.far.iter_mut().zip(near).for_each(|(far, (v, image))| *far -= v - image);
    }

    /// The share of F (z − s) in the potential, where z and s act.
    fn share(&self, own: &Passes, trial: &Trial) -> f64 {
        let Solution { pressure, attraction, potential, .. } = &trial.solution;
        let [far, near] = self.state.region.rows().sum_terms(|k| {
            let acts = pressure[k].abs() + attraction[k];
            Some([acts * own.far[k].abs(), acts * (potential[k].abs() + own.image[k])])
        });
        far / near
    }
}
