//! Jumps of the load on bodies without elastic response.

use crate::contact::loads::lowered;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::Result;
use crate::load::Load;
use crate::solver::Modes;

/// Penetration outside the contact may exceed the residual by this factor, as in the solver.
const PENETRATION_SLACK: f64 = 10.0;
/// Rounding of the gap of a cell, relative to the numbers that it is the sum of.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

impl ViscoelasticContact {
    /// Writes the end of a jump to the trial where the compliance of the step is 0, so that the displacement stays: with
    /// the pressure as it is if that satisfies the loads, else with none if none is needed. Other loads are refused.
    pub(super) fn jump_without_response(&mut self, time: f64, loads: &[Load], tolerance: f64) -> Result<()> {
        self.begin_trial();
        let greatest = |pressed: bool| {
            let residuals = loads.iter().enumerate().map(|(body, load)| self.residual_of_jump(body, load, pressed));
            residuals.fold(0.0, f64::max)
        };
        let residual = greatest(true);
        if residual <= tolerance {
            self.extrapolate(0.0);
            self.trial.residual = residual;
        } else if greatest(false) <= tolerance {
            self.trial.release();
        } else {
            return Err(self.history.no_elastic_response(time));
        }
        Ok(())
    }

    /// How far `body`, `pressed` as it is or not at all, is from satisfying `load` without any change of the displacement:
    /// gap and penetration relative to the displacement in contact, force and moments relative to the force.
    fn residual_of_jump(&self, body: usize, load: &Load, pressed: bool) -> f64 {
        let freedom = self.freedoms[body];
        let (modes, motion) = (Modes::new(self.region.grid(), freedom), self.trial.motions[body]);
        let released = freedom.translation && freedom.total == 0.0;
        let initial = self.gap_here.as_ref().unwrap_or(&self.initial_gap);
        let prescribed = lowered(load, initial.datum)[0].abs() + initial.datum.abs();
        let (mut cells, mut square, mut displacement, mut penetration) = (0_usize, 0.0, 0.0, 0.0_f64);
        let (mut pressures, mut balance) = (0.0, [0.0; 3]);
        for k in (0..self.gap.len()).filter(|&k| initial.owner(k) == body && initial.above[k].is_finite()) {
            let p = if pressed { self.state.current.pressure[k] } else { 0.0 };
            let (u, moved) = (self.trial_displacement[k], modes.displacement(motion, k));
            let h = self.gap[k] - moved;
            if !h.is_finite() {
                return f64::INFINITY;
            }
            let rounding = ROUNDING * (prescribed + initial.above[k] + u.abs() + self.gap[k].abs() + moved.abs());
            if p > 0.0 {
                let (distance, mode) = ((h.abs() - rounding).max(0.0), modes.at(k));
                (cells, square, displacement) = (cells + 1, square + distance * distance, displacement + u * u);
                pressures += p;
                (0..3).for_each(|m| balance[m] += p * mode[m]);
            } else if !released {
                penetration = penetration.max(-h - rounding);
            }
        }
        let force = pressures.max(freedom.total);
        let imbalance = (0..3).map(|m| (balance[m] - modes.load()[m] * freedom.total).abs() / force);
        let root_mean = |sum: f64| (sum / cells.max(1) as f64).sqrt();
        let distance = root_mean(square).max(penetration / PENETRATION_SLACK) / root_mean(displacement);
        // nothing over nothing is nothing, but numbers that left their range satisfy no load
        let parts =
            imbalance.filter(|_| force > 0.0).chain([distance].into_iter().filter(|_| square + penetration > 0.0));
        parts.fold(0.0, |most, part| if part.is_nan() { f64::INFINITY } else { part.max(most) })
    }
}
