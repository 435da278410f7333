//! What loads ask of the bodies in a step: what they leave free, the gap they start from, where the surface comes to lie.

use crate::Grid;
use crate::contact::hull::Hull;
use crate::contact::reside::upright;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Error, Result};
use crate::geometry::Gap;
use crate::hereditary::History;
use crate::load::{Load, Tilt};
use crate::solver::{Freedom, Modes};

impl ViscoelasticContact {
    /// Refuses loads that no pressure can balance.
    pub(super) fn admit(&mut self, time: f64, loads: &[Load]) -> Result<()> {
        if loads.len() != self.state.loads.len() {
            return Err(Error::WrongNumberOfLoads { loads: loads.len(), bodies: self.state.loads.len() });
        }
        for (body, load) in loads.iter().enumerate() {
            load.validate()?;
            let Freedom { translation, tilt, point, total } = freedom(load, &self.grid);
            let tilts = load.tilt().map(|tilt| tilt != Tilt::Fixed(0.0));
            if let Some(axis) = (0..2).find(|&axis| tilts[axis] && self.kernel.periodic_axes()[axis]) {
                return Err(Error::TiltOfPeriodic { time, axis });
            }
            let lost = total == 0.0 && matches!(load, Load::Force { normal, .. } if *normal > 0.0);
            if lost || !total.is_finite() {
                return Err(Error::Overflow { time, what: "the force over the area of a cell" });
            }
            if tilt != [false; 2] && !(translation && total == 0.0) {
                let gap = &self.initial_gap;
                let own = |k: usize| gap.owner(k) == body && gap.above[k].is_finite();
                let hull = self.hulls[body].get_or_insert_with(|| Hull::new(&self.grid, own));
                if !hull.admits(point, tilt) {
                    return Err(Error::LoadOutsideHull { time, body, at: point });
                }
            }
        }
        Ok(())
    }

    /// Sets what the loads leave free of each body.
    pub(super) fn free(&mut self, loads: &[Load]) {
        for (own, load) in self.freedoms.iter_mut().zip(loads) {
            *own = upright(freedom(load, &self.grid), self.region.folded());
            own.total /= self.region.images() as f64;
        }
    }

    /// The gap of the step before any pressure and free motion: hi + u_old − what is prescribed of ω + α·x.
    pub(super) fn fill_gap(&mut self, loads: &[Load]) {
        let initial_gap = self.gap_here.as_ref().unwrap_or(&self.initial_gap);
        for ((gap, &initial), &u_old) in self.gap.iter_mut().zip(&initial_gap.above).zip(&self.trial_displacement) {
            *gap = initial + u_old;
        }
        for (body, load) in loads.iter().enumerate() {
            let [omega, alpha1, alpha2] = lowered(load, self.initial_gap.datum);
            if loads.len() == 1 && [alpha1, alpha2] == [0.0; 2] && omega != 0.0 {
                self.gap.iter_mut().for_each(|gap| *gap -= omega);
                continue;
            }
            if [omega, alpha1, alpha2] == [0.0; 3] {
                continue;
            }
            let n2 = self.region.cells()[1];
            for k in (0..self.gap.len()).filter(|&k| initial_gap.owner(k) == body) {
                let [x1, x2] = self.region.grid().center(k / n2, k % n2);
                self.gap[k] -= omega + alpha1 * x1 + alpha2 * x2;
            }
        }
    }

    /// The greatest of what loads prescribe of ω + α·x on the grid, as far as it is taken from the gap: where [`Self::lifted`] is
    /// known, that is instead.
    pub(super) fn greatest_prescribed(&self, loads: &[Load]) -> f64 {
        let [l1, l2] = self.grid.lengths();
        let motions = loads
            .iter()
            .enumerate()
            .map(|(body, load)| self.lifted(body, load).unwrap_or_else(|| lowered(load, self.initial_gap.datum)));
        motions.map(|[w, a1, a2]| w.abs() + 0.5 * (a1.abs() * l1 + a2.abs() * l2)).fold(0.0, f64::max)
    }

    /// By how much (ω, α1, α2) of `body` falls in a step that prescribes all of it: by nothing if it is held. Only where hi + u
    /// in contact is known to be the motion at the start of the step.
    fn lifted(&self, body: usize, load: &Load) -> Option<[f64; 3]> {
        let Load::Approach { approach, tilt: [Tilt::Fixed(alpha1), Tilt::Fixed(alpha2)] } = *load else { return None };
        let known = matches!(&self.history, History::Exponential(history) if history.remembers());
        if !known || self.state.gap_is_new {
            return None;
        }
        if *load == self.state.loads[body] {
            return Some([0.0; 3]);
        }
        let [omega, old1, old2] = self.state.motions[body];
        Some([omega - approach, old1 - alpha1, old2 - alpha2])
    }

    /// The gap of a step in contact, of bodies whose motion is prescribed: hi + u is their motion at its start, so that the gap is
    /// by how much they are lifted less c (E∞ u + Σ e^(−z_i) q_i), what the past leaves. As a part of hi + u_old − ω that would be
    /// lost in rounding once the pressure has relaxed by many decades.
    pub(super) fn refine_gap(&mut self, c: f64, loads: &[Load]) {
        let n2 = self.region.cells()[1];
        for (body, load) in loads.iter().enumerate() {
            let Some([omega, alpha1, alpha2]) = self.lifted(body, load) else { continue };
            let History::Exponential(history) = &self.history else { continue };
            let (grid, owner) = (self.region.grid(), self.gap_here.as_ref().unwrap_or(&self.initial_gap));
            let pressed = |k: usize| self.state.current.pressure[k] > 0.0 && owner.owner(k) == body;
            let lifted = |k: usize| {
                let [x1, x2] = grid.center(k / n2, k % n2);
                omega + alpha1 * x1 + alpha2 * x2
            };
            history.recovery(c, &self.state.displacement, pressed, |k, recovery| self.gap[k] = lifted(k) - recovery);
        }
    }

    /// The surface in contact follows bodies whose motion is prescribed to the last bit: what it is rounded by would feed the
    /// branches of the past, and outlive the pressure.
    fn follow_prescribed(&mut self, loads: &[Load]) {
        let n2 = self.region.cells()[1];
        for (body, load) in loads.iter().enumerate() {
            let Some([omega, alpha1, alpha2]) = self.lifted(body, load) else { continue };
            let (grid, owner) = (self.region.grid(), self.gap_here.as_ref().unwrap_or(&self.initial_gap));
            let pressures = self.state.current.pressure.iter().zip(&self.trial.pressure);
            let displacements = self.trial_displacement.iter_mut().zip(&self.state.displacement);
            for (k, ((new, &old), (&before, &after))) in displacements.zip(pressures).enumerate() {
                if before > 0.0 && after > 0.0 && owner.owner(k) == body {
                    let [x1, x2] = grid.center(k / n2, k % n2);
                    *new = old - (omega + alpha1 * x1 + alpha2 * x2);
                }
            }
        }
    }

    /// Refuses an approach beyond that which closes every gap, where the mean displacement is held: Σ h = Σ gap ≥ 0.
    pub(super) fn stay_below_full_contact(&self, time: f64, loads: &[Load]) -> Result<()> {
        let held = loads.iter().all(|load| matches!(load, Load::Approach { .. }));
        let (true, true, &[Load::Approach { approach, .. }, ..]) = (held, self.kernel_here.mean_is_held(), loads)
        else {
            return Ok(());
        };
        let left = self.gap.iter().sum::<f64>() / self.gap.len() as f64;
        if left > 0.0 { Ok(()) } else { Err(Error::BeyondFullContact { time, approach, greatest: approach + left }) }
    }

    /// u = u_old + c K p; on a body with memory, the surface in contact is then laid on the rigid body. The
    /// residual of this step would otherwise stay in u, and count many times over when a later step is
    /// much stiffer than this one, as a jump after a long hold is.
    pub(super) fn displace(&mut self, c: f64, loads: &[Load]) {
        if let History::Sources(history) = &mut self.history {
            history.lay_from(&self.trial_displacement, c, &self.trial.potential);
        }
        self.lay(c);
        self.follow_prescribed(loads);
        if let History::Sources(history) = &mut self.history {
            history.lay_to(&self.trial_displacement);
        }
    }

    fn lay(&mut self, c: f64) {
        let keeps = self.history.keeps_displacement();
        if let (true, &[Freedom { tilt: [false, false], .. }]) = (keeps, &self.freedoms[..]) {
            let motion = self.trial.motions[0].0[0];
            let state = self.trial.pressure.iter().zip(&self.trial.potential).zip(&self.gap);
            for (u, ((&p, &v), &gap)) in self.trial_displacement.iter_mut().zip(state) {
                let cv = c * v;
                let h = gap + cv - motion;
                *u = (*u + cv) - if (p > 0.0) | (h < 0.0) { h } else { 0.0 };
            }
            return;
        }
        for (u, &v) in self.trial_displacement.iter_mut().zip(&self.trial.potential) {
            *u += c * v;
        }
        if !keeps {
            return;
        }
        for (body, &freedom) in self.freedoms.iter().enumerate() {
            let (modes, motion) = (Modes::new(self.region.grid(), freedom), self.trial.motions[body]);
            let owner = self.gap_here.as_ref().unwrap_or(&self.initial_gap);
            for k in 0..self.gap.len() {
                if owner.owner(k) == body && self.gap[k].is_finite() {
                    // u_old + c v with the gap h less the same: gap = hi + u_old − prescribed
                    let h = self.gap[k] + c * self.trial.potential[k] - modes.displacement(motion, k);
                    if self.trial.pressure[k] > 0.0 || h < 0.0 {
                        self.trial_displacement[k] -= h;
                    }
                }
            }
        }
    }
}

/// What a load prescribes of (ω, α1, α2), zero where it leaves them free; ω from the datum of the gap.
pub(super) fn lowered(load: &Load, datum: f64) -> [f64; 3] {
    let omega = if let Load::Approach { approach, .. } = load { approach - datum } else { 0.0 };
    let [alpha1, alpha2] = load.tilt().map(|tilt| if let Tilt::Fixed(angle) = tilt { angle } else { 0.0 });
    [omega, alpha1, alpha2]
}

/// What a load leaves free of a body.
fn freedom(load: &Load, grid: &Grid) -> Freedom {
    let tilt = load.tilt().map(|tilt| matches!(tilt, Tilt::Free { .. }));
    let point = load.tilt().map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 });
    let (translation, total) = match load {
        Load::Force { normal, .. } => (true, normal / grid.cell_area()),
        Load::Approach { .. } => (false, 0.0),
    };
    Freedom { translation, tilt, point, total }
}

/// The motion at which an upright body just touches the undeformed surface.
pub(super) fn first_touch(gap: &Gap, body: usize) -> [f64; 3] {
    let own = gap.above.iter().enumerate().filter(|(k, _)| gap.owner(*k) == body);
    [gap.datum + own.map(|(_, &h)| h).fold(f64::INFINITY, f64::min), 0.0, 0.0]
}
