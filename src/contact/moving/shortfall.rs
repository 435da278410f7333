//! What the state of a moving contact lacks of its steady state.

use crate::contact::{Computation, State, ViscoelasticContact};
use crate::error::Unsteady;
use crate::extent::Extent;
use crate::rheology::CreepSpectrum;

/// A motion by one cell in each step, whose steady state is approached.
#[derive(Debug)]
pub(crate) struct Approaching {
    /// Creep of the contact, without a free dashpot.
    pub(crate) creep: CreepSpectrum,
    pub(crate) stride: [isize; 2],
}

/// Changes of the displacement, as they change the approach, and as they change the lateral force.
#[derive(Debug, Clone, Copy)]
struct Change {
    /// Σ p |δu| \[Pa m\].
    lift: f64,
    /// Σ p |∂δu/∂x| along the motion \[Pa\].
    slope: f64,
}

impl Approaching {
    fn axis(&self) -> usize {
        usize::from(self.stride[0] == 0)
    }

    /// The change that the bodies on the grid still have to go through under the present pressure, relative to approach and lateral
    /// force. A change δu of the displacement lifts the indenter by its mean over the pressure, and changes the lateral force by the
    /// pressure on its slope.
    ///
    /// It is the sum over all waves and terms of creep of what each is short of its own limit. Absolute values are taken cell by cell:
    /// what is left of a slow term moves through the contact, and its mean passes through zero.
    pub(crate) fn outstanding(&self, contact: &mut ViscoelasticContact) -> f64 {
        let Computation { state, window, .. } = &mut contact.computation;
        let pressure = &state.current.solution.pressure;
        let Some(source) = state.history.outstanding(&self.creep, self.stride, pressure) else { return 0.0 };
        let mut change = vec![0.0; source.len()];
        window.kernel.apply(&source, &mut change, &mut window.work);
        self.relative(contact, self.change(contact, &change, f64::abs))
    }

    /// The least term of which most is left after some distance: its time \[s\], and the distance in which it falls by the factor e.
    pub(crate) fn slowest(&self, contact: &ViscoelasticContact, distance: f64) -> (f64, f64) {
        let left = |&(compliance, time): &(f64, f64)| compliance * (-distance / self.reach(contact, time)).exp();
        let slowest = self.creep.terms().iter().max_by(|a, b| left(a).total_cmp(&left(b)));
        slowest.map_or((0.0, 0.0), |&(_, time)| (time, self.reach(contact, time)))
    }

    /// The distance \[m\] travelled in a time of the material.
    fn reach(&self, contact: &ViscoelasticContact, time: f64) -> f64 {
        time * contact.grid().spacing()[self.axis()] / contact.computation.state.clock.last_dt
    }

    /// Whether more than `tolerance` of approach or lateral force would come from pressures whose traces have left the grid; then why,
    /// and how long the grid should be behind the contact.
    ///
    /// A load W leaves behind, at the distance s, the sources Σ C_k W e^(−s/l_k)/l_k ds with l_k = v λ_k. Beyond the edge, at D behind
    /// the end of the contact, they would lift the contact and tilt it. With an influence falling as 1/s the exponential integrals
    /// E1(D/l_k) and E2(D/l_k) result, in line contact E1 for the slope; each is replaced by its upper bound of elementary
    /// functions. From the end of the contact on, and by these bounds, half as much again to three times as much is counted.
    pub(crate) fn lost(&self, contact: &ViscoelasticContact, tolerance: f64) -> Option<Unsteady> {
        let (axis, kernel) = (self.axis(), &contact.scene.kernel);
        let (side, line) = (contact.grid().spacing()[axis], kernel.periodic_axes()[1 - axis]);
        if kernel.periodic_axes()[axis] {
            return None;
        }
        let count = contact.grid().cells()[axis];
        let Extent { low, high } = contact.extent_of_contact()?;
        let behind = if self.stride[axis] > 0 { low[axis] } else { count - 1 - high[axis] };
        // displacement at a distance under a unit force
        let influence = |cells: usize| {
            let at = [cells as isize, 0];
            kernel.coefficient(at[axis], at[1 - axis]).unwrap_or(0.0) / contact.grid().cell_area()
        };
        // its slope falls as 1/s², in line contact as 1/s; the base of a layer may be softer
        let near = behind.min(count.saturating_sub(2)).max(1);
        let strength = |cells: usize| {
            let slope = (influence(cells - 1) - influence(cells + 1)) / (2.0 * side);
            slope.abs() * (cells as f64 * side).powi(if line { 1 } else { 2 })
        };
        let strength = strength(near).max(strength(count.saturating_sub(2).max(1)));
        let (lifted, from) = (influence(near).abs(), (behind as f64 + 0.5) * side);
        let pressure: f64 = contact.computation.state.current.solution.pressure.iter().sum();
        let missing = |distance: f64| {
            let mut change = Change { lift: 0.0, slope: 0.0 };
            for &(compliance, time) in self.creep.terms() {
                let l = self.reach(contact, time);
                let z = distance / l;
                let (decay, e1) = ((-z).exp(), (-z).exp() * (1.0 / z).ln_1p());
                let weight = compliance * contact.force() * pressure;
                let source = weight * strength / l;
                change.lift += if line { weight * lifted * decay + weight * strength * e1 } else { source * e1 };
                change.slope += source * if line { e1 } else { decay / (1.0 + z) / distance };
            }
            self.relative(contact, change)
        };
        let missed = missing(from);
        let mut needed = from;
        while missing(needed) > tolerance {
            needed *= 1.1;
        }
        (missed > tolerance).then_some(Unsteady::LeftGrid { missing: missed, behind: from, needed })
    }

    /// Change of approach or lateral force, whichever changes more in relation.
    fn relative(&self, contact: &ViscoelasticContact, by: Change) -> f64 {
        let pressure: f64 = contact.computation.state.current.solution.pressure.iter().sum();
        let lateral = self.change(contact, contact.computation.state.history.displacement(), |slope| slope).slope.abs();
        let share = |part: f64, whole: f64| if part == 0.0 { 0.0 } else { part / whole };
        share(by.lift, pressure * contact.approach().abs()).max(share(by.slope, lateral))
    }

    /// What a change of the displacement does to approach and lateral force, by a measure of its values and slopes.
    fn change(&self, contact: &ViscoelasticContact, displacement: &[f64], measure: impl Fn(f64) -> f64) -> Change {
        let State { region, current, .. } = &contact.computation.state;
        let (axis, periodic) = (self.axis(), contact.kernel().periodic_axes()[self.axis()]);
        let (count, unit) = (region.cells()[axis], if axis == 0 { region.cells()[1] } else { 1 });
        let twice = 2.0 * contact.grid().spacing()[axis];
        let mut change = Change { lift: 0.0, slope: 0.0 };
        for (k, &p) in current.solution.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            let m = k / unit % count;
            let at = |other: usize| displacement[k + other * unit - m * unit];
            let [before, after] = if periodic {
                [m + count - 1, m + 1].map(|m| m % count)
            } else {
                [m.max(1) - 1, (m + 1).min(count - 1)]
            };
            change.lift += p * measure(displacement[k]);
            change.slope += p * measure((at(after) - at(before)) / twice);
        }
        change
    }
}
