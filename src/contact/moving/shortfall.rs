//! What the state of a moving contact lacks of its steady state.

use crate::contact::{Computation, State, Unsteady, ViscoelasticContact};
use crate::equilibrium::Held;
use crate::rheology::CreepSpectrum;

/// A contact on its way to a steady state by steps of one cell.
#[derive(Debug)]
pub(crate) struct Shortfall<'a> {
    pub(crate) contact: &'a mut ViscoelasticContact,
    /// Creep of the contact, without a free dashpot.
    pub(crate) creep: &'a CreepSpectrum,
    /// The cell of the grid by which the indenter moves in a step.
    pub(crate) cell: [isize; 2],
}

/// What a change of the displacement does to approach and lateral force.
#[derive(Debug, Clone, Copy, Default)]
struct Change {
    /// Σ p |δu| \[Pa m\].
    lift: f64,
    /// Σ p |∂δu/∂x| along the motion \[Pa\].
    slope: f64,
}

impl Shortfall<'_> {
    fn axis(&self) -> usize {
        usize::from(self.cell[0] == 0)
    }

    /// The change that the bodies on the grid have still to go through under the present pressure, relative to
    /// approach and lateral force. A change δu of the displacement lifts the indenter by its mean over the pressure,
    /// and changes the lateral force by the pressure on its slope.
    ///
    /// It is the sum over all waves and terms of creep of what each is short of its limit. Absolute values are taken
    /// cell by cell: what is left of a slow term passes through the contact, and its mean through zero.
    pub(crate) fn outstanding(&mut self) -> f64 {
        let Computation { state, window, .. } = &mut self.contact.computation;
        let pressure = &state.held.current.solution.pressure;
        let Some(source) = state.history.outstanding(self.creep, self.cell, pressure) else { return 0.0 };
        let mut change = vec![0.0; source.len()];
        window.kernel.apply(&source, &mut change, &mut window.work);
        self.relative(self.change_by(&change, f64::abs))
    }

    /// The term of creep that is farthest from its limit after a distance \[m\]: its time \[s\], and the distance
    /// \[m\] in which what is left falls by the factor e. Where the bodies do not come round, nothing is left after
    /// one length of the grid.
    pub(crate) fn slowest(&self, distance: f64) -> (f64, f64) {
        let (axis, grid) = (self.axis(), self.contact.grid());
        let most =
            if self.contact.fields().kernel().periodic_axes()[axis] { f64::INFINITY } else { grid.lengths()[axis] };
        let left = |&(compliance, time): &(f64, f64)| compliance * (-distance / self.reach(time)).exp();
        let slowest = self.creep.terms().iter().max_by(|a, b| left(a).total_cmp(&left(b)));
        slowest.map_or((0.0, 0.0), |&(_, time)| (time, self.reach(time).min(most)))
    }

    /// The distance \[m\] travelled in a time of the material.
    fn reach(&self, time: f64) -> f64 {
        time * self.contact.grid().spacing()[self.axis()] / self.contact.computation.state.clock.last_dt
    }

    /// Why the motion has not arrived, if pressures whose traces have left the grid could change approach or lateral
    /// force by more than the `tolerance`.
    ///
    /// At a distance s behind it a load W leaves the sources Σ C_k W e^(−s/l_k)/l_k ds, l_k = v λ_k. Those beyond the
    /// edge, at D behind the end of the contact, would lift the contact and tilt it. As their influence falls as 1/s,
    /// and its slope as 1/s², the exponential integrals E1(D/l_k) and E2(D/l_k) result; in line contact, of the slope
    /// 1/s, E1 for the tilt. Upper bounds of elementary functions take their place. From the end of the contact on,
    /// at most the whole load counts: the bound is 1.2 to 3 times what is missing where v λ is longer than the grid.
    pub(crate) fn left_grid(&self, tolerance: f64) -> Option<Unsteady> {
        let (axis, contact) = (self.axis(), &*self.contact);
        let (side, count, kernel) =
            (contact.grid().spacing()[axis], contact.grid().cells()[axis], contact.fields().kernel());
        let (line, extent) = (kernel.periodic_axes()[1 - axis], contact.fields().extent_of_contact()?);
        if kernel.periodic_axes()[axis] {
            return None;
        }
        // displacement at a distance under a unit force, and how strongly its slope falls: a layer's base may be softer
        let influence = |cells: usize| {
            let at = self.cell.map(|cell| cell * cells as isize);
            kernel.coefficient(at[0], at[1]).unwrap_or(0.0) / contact.grid().cell_area()
        };
        let strength = |cells: usize| {
            let slope = (influence(cells - 1) - influence(cells + 1)) / (2.0 * side);
            slope.abs() * (cells as f64 * side).powi(if line { 1 } else { 2 })
        };
        let cells = if self.cell[axis] > 0 { extent.low[axis] } else { count - 1 - extent.high[axis] };
        let far = count.saturating_sub(2).max(1);
        let near = cells.clamp(1, far);
        let (strength, lift) = (strength(near).max(strength(far)), influence(near));
        let missing = |distance: f64| {
            let mut change = Change::default();
            for &(compliance, time) in self.creep.terms() {
                let (l, weight) =
                    (self.reach(time), compliance * contact.force() * contact.computation.state.held.current.sum);
                let decay = (-distance / l).exp();
                let e1 = decay * (l / distance).ln_1p();
                let (lifted, tilted) = if line {
                    ((lift * decay - strength * e1).abs() + 0.58 * strength * decay, strength / l * e1)
                } else {
                    (strength / l * e1, strength * decay / (distance * (l + distance)))
                };
                change.lift += weight * lifted;
                change.slope += weight * tilted;
            }
            self.relative(change)
        };
        let behind = (cells as f64 + 0.5) * side;
        let mut needed = behind;
        while missing(needed) > tolerance {
            needed *= 1.1;
        }
        (needed > behind).then(|| Unsteady::LeftGrid { missing: missing(behind), behind, needed })
    }

    /// Change of approach or lateral force, whichever changes more in relation.
    fn relative(&self, by: Change) -> f64 {
        let State { held: Held { current, .. }, history, .. } = &self.contact.computation.state;
        let whole = self.change_by(history.displacement(), |value| value).slope.abs();
        let share = |part: f64, whole: f64| if part == 0.0 { 0.0 } else { part / whole };
        share(by.lift, current.sum * self.contact.approach().abs()).max(share(by.slope, whole))
    }

    /// What a change of the displacement does, by a measure of its values and slopes.
    fn change_by(&self, displacement: &[f64], measure: impl Fn(f64) -> f64) -> Change {
        let Held { region, current, .. } = &self.contact.computation.state.held;
        let (axis, grid) = (self.axis(), self.contact.grid());
        let (count, unit) = (region.cells()[axis], if axis == 0 { region.cells()[1] } else { 1 });
        let periodic = self.contact.fields().kernel().periodic_axes()[axis];
        let mut change = Change::default();
        for (k, &p) in current.solution.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            let m = k / unit % count;
            let at = |other: usize| displacement[k + other * unit - m * unit];
            let inside = [m.max(1) - 1, (m + 1).min(count - 1)];
            let [before, after] = if periodic { [(m + count - 1) % count, (m + 1) % count] } else { inside };
            change.lift += p * measure(displacement[k]);
            change.slope += p * measure((at(after) - at(before)) / (2.0 * grid.spacing()[axis]));
        }
        change
    }
}
