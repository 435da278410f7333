//! Sums over the states of a sweep: fields of the pressures that it kept, and work.

use crate::error::{Refusal, Result};
use crate::states::curve::ElasticStates;

impl ElasticStates {
    /// Σ w_i (p_e(l_i) − p_e(l_i−1)) of the pressures that the sweep kept.
    pub(super) fn superposed_field(&self, tractions: impl Iterator<Item = (f64, f64)>) -> Result<Vec<f64>> {
        let remedy = ": call Sweep::keep_pressures before the sweep";
        let none = || Refusal::unsupported("states_no_pressures", "the states hold no pressures", remedy);
        let grid = self.grid.as_ref().filter(|_| !self.pressures.is_empty()).ok_or_else(none)?;
        // by the share of each state in it
        let mut shares = vec![0.0; self.pressures.len()];
        let mut last = 0.0;
        for (top, traction) in tractions {
            self.share(top, traction, &mut shares);
            self.share(last, -traction, &mut shares);
            last = top;
        }
        let mut field = vec![0.0; grid.len()];
        self.pressures.iter().zip(shares).for_each(|(pressed, share)| pressed.add_to(share, &mut field));
        Ok(field)
    }

    /// Adds the shares of the states in `weight` times the pressure at a level.
    fn share(&self, level: f64, weight: f64, shares: &mut [f64]) {
        let upper = self.states.partition_point(|state| state.level < level).min(self.states.len() - 1);
        let [below, above] = [upper.checked_sub(1).map_or(0.0, |k| self.states[k].level), self.states[upper].level];
        let share = (level - below) / (above - below);
        shares[upper] += weight * share;
        if upper > 0 {
            shares[upper - 1] += weight * (1.0 - share);
        }
    }

    /// ∫ δ dl from one level to a greater one \[m³\], with δ a power of the level between two states: the work of an
    /// elastic contact, over its modulus, is δ l less this.
    pub(super) fn work(&self, from: f64, to: f64) -> f64 {
        let [low, high] = [from, to].map(|level| self.states.partition_point(|state| state.level <= level));
        let inner = self.states.get(low..high).unwrap_or_default().iter().map(|state| state.level);
        let (mut sum, mut bottom, mut lower) = (0.0, from, self.depth(from));
        for top in inner.chain(std::iter::once(to)).filter(|top| *top > from) {
            // below the first state it is a power, too
            let below = if bottom > 0.0 { [bottom, lower] } else { [0.5 * top, self.depth(0.5 * top)] };
            let depth = self.depth(top);
            let exponent = (depth / below[1]).ln() / (top / below[0]).ln();
            // levels as near as rounding
            sum += if exponent.is_finite() { (top * depth - bottom * lower) / (1.0 + exponent) } else { 0.0 };
            (bottom, lower) = (top, depth);
        }
        sum
    }
}
