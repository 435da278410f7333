//! Fields as superpositions of the pressures that a sweep kept.

use crate::error::{Result, StatesError};
use crate::states::curve::ElasticStates;

impl ElasticStates {
    /// Σ w_i (p_e(l_i) − p_e(l_i−1)) of the pressures that the sweep kept.
    pub(super) fn superposed_field(&self, tractions: impl Iterator<Item = (f64, f64)>) -> Result<Vec<f64>> {
        let grid = self.grid.as_ref().filter(|_| !self.pressures.is_empty()).ok_or(StatesError::NoPressures)?;
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
}
