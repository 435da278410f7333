//! The gap of a step before any pressure, and the surface after it.

use crate::contact::step::constraints::Prescribed;
use crate::contact::step::request::Trial;
use crate::contact::window::region::Region;
use crate::geometry::Gap;
use crate::hereditary::History;
use crate::parallel::for_each_band;
use crate::solver::{Freedom, RigidMotion};

/// The rigid bodies over the region of a step.
#[derive(Clone, Copy)]
pub(super) struct RigidBodies<'a> {
    pub(super) region: &'a Region,
    /// Their gap there, hi.
    pub(super) initial: &'a Gap,
    pub(super) prescribed: Prescribed<'a>,
}

impl RigidBodies<'_> {
    /// The gap before any pressure and free motion, hi + u_old − what is prescribed of ω + α·x (Eq. 1 of the paper).
    pub(super) fn fill_gap(&self, u_old: &[f64], gap: &mut [f64]) {
        let bodies = self.prescribed.bodies();
        let upright = bodies == 1 && self.prescribed.motion(0).tilt == [0.0; 2];
        let approach = if upright { self.prescribed.motion(0).approach } else { 0.0 };
        for_each_band([&mut *gap], |first, [gap]| {
            for ((gap, &initial), &u_old) in gap.iter_mut().zip(&self.initial.above[first..]).zip(&u_old[first..]) {
                *gap = (initial + u_old) - approach;
            }
        });
        if upright {
            return;
        }
        for body in 0..bodies {
            let motion = self.prescribed.motion(body);
            if motion != RigidMotion::default() {
                for k in (0..gap.len()).filter(|&k| self.initial.owner(k) == body) {
                    gap[k] -= motion.at(self.region.center(k));
                }
            }
        }
    }

    /// The gap in contact under bodies whose motion is prescribed: hi + u is their motion at the start of the step, so that
    /// the gap is their retraction less u − u_old, by how much the surface recedes. Computed as a part of
    /// hi + u_old − ω, that would be lost in rounding once the pressure has relaxed by many decades.
    pub(super) fn refine_gap(&self, history: &History, pressure: &[f64], gap: &mut [f64]) {
        for body in 0..self.prescribed.bodies() {
            let Some(retraction) = self.prescribed.retraction(body) else { continue };
            let pressed = |k: usize| pressure[k] > 0.0 && self.initial.owner(k) == body;
            history.recovery(pressed, |k, recovery| gap[k] = retraction.at(self.region.center(k)) - recovery);
        }
    }

    /// u = u_old + c K p. Where the displacement is `integrated`, the surface in contact is then laid on the rigid body:
    /// the residual of this step would otherwise stay in u, and count many times over when a later step is much stiffer than
    /// this one, as a jump after a long hold is.
    pub(super) fn displace(&self, c: f64, integrated: bool, trial: &Trial, u: &mut [f64]) {
        let Trial { solution, gap, free, .. } = trial;
        if let (true, &[Freedom { tilt: [false, false], .. }]) = (integrated, &free[..]) {
            let motion = self.region.modes(free[0]).displacement(solution.motions[0], 0);
            for_each_band([u], |first, [u]| {
                let state = solution.pressure[first..].iter().zip(&solution.potential[first..]).zip(&gap[first..]);
                for (u, ((&p, &v), &gap)) in u.iter_mut().zip(state) {
                    let cv = c * v;
                    let h = gap + cv - motion;
                    *u = (*u + cv) - if (p > 0.0) | (h < 0.0) { h } else { 0.0 };
                }
            });
            return;
        }
        for_each_band([&mut *u], |first, [u]| {
            u.iter_mut().zip(&solution.potential[first..]).for_each(|(u, &v)| *u += c * v);
        });
        if !integrated {
            return;
        }
        for (body, &freedom) in free.iter().enumerate() {
            let (modes, motion) = (self.region.modes(freedom), solution.motions[body]);
            for k in (0..gap.len()).filter(|&k| self.initial.owner(k) == body && gap[k].is_finite()) {
                // u_old + c v with the gap h less the same: gap = hi + u_old − prescribed
                let h = gap[k] + c * solution.potential[k] - modes.displacement(motion, k);
                if solution.pressure[k] > 0.0 || h < 0.0 {
                    u[k] -= h;
                }
            }
        }
    }

    /// Lets the surface in contact follow bodies whose motion is prescribed to the last bit, from the displacement `before`:
    /// its rounding would feed the branches of the past, and outlive the pressure.
    pub(super) fn follow_prescribed(&self, [old, new]: [&[f64]; 2], before: &[f64], u: &mut [f64]) {
        for body in 0..self.prescribed.bodies() {
            let Some(retraction) = self.prescribed.retraction(body) else { continue };
            let displacements = u.iter_mut().zip(before);
            for (k, ((u, &before), (&old, &new))) in displacements.zip(old.iter().zip(new)).enumerate() {
                if old > 0.0 && new > 0.0 && self.initial.owner(k) == body {
                    *u = before - retraction.at(self.region.center(k));
                }
            }
        }
    }
}
