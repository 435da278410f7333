//! Fields of a contact on elastic states.

use crate::error::{Result, StatesError, within};
use crate::fields::KeptFields;
use crate::load::Load;
use crate::states::contact::StatesContact;
use crate::states::curve::ElasticStates;
use crate::states::twin::Profile;

impl StatesContact {
    /// The pressure \[Pa\] from the states that the sweep kept
    /// ([`Sweep::keep_pressures`](crate::states::Sweep::keep_pressures)), linear in the level between them: one value
    /// for each cell of the grid, to the accuracy of the sweep.
    ///
    /// # Errors
    /// [`StatesError::NoPressures`] if none were kept.
    pub fn pressure(&self) -> Result<Vec<f64>> {
        let states = self.states();
        let grid = states.grid.as_ref().filter(|_| !states.pressures.is_empty()).ok_or(StatesError::NoPressures)?;
        // Σ w (p_e(l_i) − p_e(l_i−1)) by the share of each state in it
        let mut shares = vec![0.0; states.pressures.len()];
        let mut last = 0.0;
        for (top, traction) in self.tractions() {
            states.share(top, traction, &mut shares);
            states.share(last, -traction, &mut shares);
            last = top;
        }
        let mut field = vec![0.0; grid.len()];
        states.pressures.iter().zip(shares).for_each(|(pressed, share)| pressed.add_to(share, &mut field));
        Ok(field)
    }

    /// All fields to an `accuracy`, the error of the pressure in L1 over the force: from elastic contacts at a few
    /// levels, chosen by what the same levels leave of the error on a ball and on a cone, from the smallest to the
    /// largest. Measured over random scenes, they are 7 contacts for 1e-2 and 20 for 1e-3 in the median, each some 5
    /// convolutions from the one before, and five fields of memory. The L2 error is about twice as large, relative to
    /// the field, and the error of the greatest pressure five times. An accuracy of 0 takes every group of levels.
    /// The steps that were taken count as exact: a run has
    /// [`Run::fields_to`](crate::run::Run::fields_to).
    ///
    /// # Errors
    /// If the accuracy is outside \[0, 0.1\]; [`StatesError::NoScene`] if the states were read from a file or given
    /// as a table; as
    /// [`ElasticContact::solve`](crate::elastic::ElasticContact::solve).
    pub fn fields(&self, accuracy: f64) -> Result<KeptFields> {
        within("accuracy of the fields", accuracy, (0.0..=0.1).contains(&accuracy), "in [0, 0.1]")?;
        let states = self.states();
        let mut elastic = states.elastic_contact()?;
        elastic.solve(Load::Force { normal: 0.0, tilt: states.tilt })?;
        let cells = elastic.fields().grid().len();
        let mut sums = [vec![0.0; cells], vec![0.0; cells]];
        let (mut before, mut motion) = (sums.clone(), elastic.fields().motion(0));
        let mut motion_before = motion;
        let (tractions, displacements) =
            (Profile::new(self.tractions()), Profile::new(self.levels.groups().map(|(top, _, w)| (top, w))));
        let mut levels = tractions.cuts(0.0, accuracy).0;
        levels.extend(displacements.cuts(0.0, accuracy).0);
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let shares = tractions.means(&levels).zip(displacements.means(&levels));
        for ((level, traction), (_, displacement)) in shares {
            elastic.solve(Load::Force { normal: level, tilt: states.tilt })?;
            let fields = elastic.fields();
            let parts = [(traction, fields.pressure()), (displacement, fields.displacement())];
            for ((share, now), (sum, before)) in parts.into_iter().zip(sums.iter_mut().zip(&mut before)) {
                for ((sum, before), now) in sum.iter_mut().zip(before).zip(now) {
                    *sum += share * (now - *before);
                    *before = *now;
                }
            }
            let now = fields.motion(0);
            motion.approach += displacement * (now.approach - motion_before.approach);
            (0..2).for_each(|axis| motion.tilt[axis] += displacement * (now.tilt[axis] - motion_before.tilt[axis]));
            motion_before = now;
        }
        motion.approach -= self.levels.lift;
        let [pressure, displacement] = sums;
        Ok(elastic.fields().keep_with(pressure, displacement, motion, self.time()))
    }
}

impl ElasticStates {
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
