//! The surface in contact with bodies of prescribed motion, from one step to the next.

use crate::equilibrium::RigidBodies;
use crate::geometry::Gap;
use crate::hereditary::History;

impl RigidBodies<'_> {
    /// Writes the gap of a step before any pressure and free motion, after [`History::predict`].
    ///
    /// In contact under bodies of prescribed motion, hi + u is their motion at the start of the step. The gap there
    /// is their retraction minus the recovery u − u_old of the surface. The difference hi + u_old − ω would lose the
    /// recovery in rounding once the pressure has relaxed by many decades.
    pub(super) fn fill_gap_of_step(&self, initial: &Gap, history: &History, pressure: &[f64], gap: &mut [f64]) {
        self.fill_gap(initial, Some(history.tried_displacement()), gap);
        for (body, retraction) in self.retractions() {
            let pressed = |k: usize| pressure[k] > 0.0 && initial.owner(k) == body;
            history.recovery(pressed, |k, recovery| gap[k] = retraction.at(self.region.center(k)) - recovery);
        }
    }

    /// Moves the surface in contact, from the displacement `before`, with bodies of prescribed motion, to the last bit:
    /// rounding would enter the branches of the past, and outlive the pressure.
    pub(super) fn follow_prescribed(&self, initial: &Gap, [old, new]: [&[f64]; 2], before: &[f64], u: &mut [f64]) {
        for (body, retraction) in self.retractions() {
            let displacements = u.iter_mut().zip(before);
            for (k, ((u, &before), (&old, &new))) in displacements.zip(old.iter().zip(new)).enumerate() {
                if old > 0.0 && new > 0.0 && initial.owner(k) == body {
                    *u = before - retraction.at(self.region.center(k));
                }
            }
        }
    }
}
