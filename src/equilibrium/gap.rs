//! The gap before any pressure, and the surface under it.

use crate::Grid;
use crate::equilibrium::{Region, Request, Trial};
use crate::geometry::Gap;
use crate::load::{Load, Tilt};
use crate::parallel::for_each_band;
use crate::solver::{Freedom, RigidMotion};

/// The rigid bodies over a region, and the motions that their loads prescribe.
#[derive(Clone, Copy)]
pub(crate) struct RigidBodies<'a> {
    pub(crate) request: Request<'a>,
    pub(crate) region: &'a Region,
    /// Loads and motions at the start of the step, if hi + u in contact is the motion there to the last bit.
    pub(crate) start: Option<(&'a [Load], &'a [RigidMotion])>,
}

impl RigidBodies<'_> {
    /// The retraction of a body in a step that prescribes all of its motion; zero for a held body. `None` unless
    /// hi + u in contact is its motion at the start.
    fn retraction(&self, body: usize) -> Option<RigidMotion> {
        let load = self.request.loads[body];
        let Load::Approach { approach, tilt: [Tilt::Fixed(tilt1), Tilt::Fixed(tilt2)] } = load else { return None };
        let (loads, motions) = self.start?;
        if load == loads[body] {
            return Some(RigidMotion::default());
        }
        let start = motions[body];
        Some(RigidMotion { approach: start.approach - approach, tilt: [start.tilt[0] - tilt1, start.tilt[1] - tilt2] })
    }

    /// The bodies whose retraction is known.
    pub(crate) fn retractions(&self) -> impl Iterator<Item = (usize, RigidMotion)> {
        (0..self.request.loads.len()).filter_map(|body| Some((body, self.retraction(body)?)))
    }

    /// The largest |ω + α·x| on the grid that is taken from a gap: of the retraction where it is known, else of the
    /// prescribed motion.
    pub(crate) fn greatest_motion(&self, grid: &Grid) -> f64 {
        let [l1, l2] = grid.lengths();
        let taken = |body: usize| self.retraction(body).unwrap_or(self.request.prescribed(body));
        let reach = |m: RigidMotion| m.approach.abs() + 0.5 * (m.tilt[0].abs() * l1 + m.tilt[1].abs() * l2);
        (0..self.request.loads.len()).map(|body| reach(taken(body))).fold(0.0, f64::max)
    }

    /// Writes the gap before any pressure and free motion: hi + u_old − (prescribed part of ω + α·x), Eq. 1 of the
    /// paper; of a surface that nothing has displaced where u_old is not given.
    pub(crate) fn fill_gap(&self, initial: &Gap, u_old: Option<&[f64]>, gap: &mut [f64]) {
        let (bodies, first) = (self.request.loads.len(), self.request.prescribed(0));
        let upright = bodies == 1 && first.tilt == [0.0; 2];
        let approach = if upright { first.approach } else { 0.0 };
        for_each_band([&mut *gap], |first, [gap]| {
            let heights = gap.iter_mut().zip(&initial.above[first..]);
            match u_old {
                Some(u_old) => heights.zip(&u_old[first..]).for_each(|((gap, h), u_old)| *gap = (h + u_old) - approach),
                None => heights.for_each(|(gap, h)| *gap = h - approach),
            }
        });
        let motions = (0..bodies).map(|body| (body, self.request.prescribed(body)));
        for (body, motion) in motions.filter(|(_, motion)| !upright && *motion != RigidMotion::default()) {
            for k in (0..gap.len()).filter(|&k| initial.owner(k) == body) {
                gap[k] -= motion.at(self.region.center(k));
            }
        }
    }

    /// u = u_old + c K p. Where the displacement is `integrated`, the surface in contact is then set to the surface
    /// of the rigid body. Otherwise the residual of this step would stay in u, and a later, much stiffer step, such
    /// as a jump after a long hold, would amplify it.
    pub(crate) fn displace(&self, initial: &Gap, c: f64, integrated: bool, trial: &Trial, u: &mut [f64]) {
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
            for k in (0..gap.len()).filter(|&k| initial.owner(k) == body && gap[k].is_finite()) {
                // the gap after the step, h = (hi + u_old − prescribed) + c v − free
                let h = gap[k] + c * solution.potential[k] - modes.displacement(motion, k);
                if solution.pressure[k] > 0.0 || h < 0.0 {
                    u[k] -= h;
                }
            }
        }
    }
}
