//! Checks of a curve before it is fitted.

use std::f64::consts::PI;

use crate::error::{Error, Result};
use crate::experiment::Curve;
use crate::statistics::{is_flat, mean, range, scatter};

/// Fewest points of a curve.
const LEAST_POINTS: usize = 10;
/// Blocks of points whose mean forces are compared.
const BLOCKS: usize = 20;
/// The greatest mean of a block rises above the scatter of the shallow end by this factor, if there is a contact: also where
/// the noise is correlated.
const ABOVE_BASELINE: f64 = 3.0;
/// Share of the range of the force by which it differs between the ends of the drive, if the contact is at one of them.
const OPPOSITE: f64 = 0.25;
/// Share of the greatest force from which on the tip has certainly touched.
const TOUCHED: f64 = 0.1;
/// Depths over the contact radius that steep pyramids do not reach.
const STEEPEST: f64 = 4.0;
/// Noise over the rise of the force, to which running means of at most a block reduce it.
const ALLOWED_NOISE: f64 = 0.03;
/// Contact moduli of materials \[Pa\].
const MODULI: [f64; 2] = [1.0, 1e13];

impl Curve {
    /// Checks that the curve shows a contact of this tip: enough points, a force above its scatter, signs, and units that
    /// fit each other and the size of the tip. [`Recording`](crate::Recording) checks every curve that it makes.
    ///
    /// The checks are coarse: each of them accepts every curve that some material can give, and a curve of two wrong units
    /// may pass.
    ///
    /// # Errors
    /// What is wrong and what to change, such as [`Error::ForceFlipped`] or [`Error::BeyondStates`].
    pub fn check(&self) -> Result<()> {
        let (drive, force) = (self.experiment.protocol.drive(), self.force());
        let (points, [first, last]) = (force.len(), range(drive));
        if points < LEAST_POINTS {
            return Err(Error::ShortCurve { points, least: LEAST_POINTS });
        }
        if is_flat(force) {
            return Err(Error::NoContact { curve: 0 });
        }
        if first == last {
            // a jump before the first time
            return self.check_sizes(0.0, 1);
        }
        // the forces in a part of the range of the drive, and the least and the greatest mean of a block
        let part = |from: f64, to: f64| -> Vec<f64> {
            let inside = |z: f64| (from..=to).contains(&((z - first) / (last - first)));
            drive.iter().zip(force).filter(|(z, _)| inside(**z)).map(|(_, force)| *force).collect()
        };
        let block = (points / BLOCKS).max(1);
        let means = |forces: &[f64]| range(&forces.chunks_exact(block).map(mean).collect::<Vec<_>>());
        let (lowest, [least, greatest]) = (part(0.0, 0.1), means(force));
        let shallow = mean(&lowest);
        let fall = shallow - mean(&part(0.9, 1.0));
        if fall > OPPOSITE * (greatest - least) {
            let [shallow, deep] = [part(0.0, 0.5), part(0.5, 1.0)].map(|half| {
                let [low, high] = means(&half);
                (high - low).max(0.0)
            });
            let is_at_low_drive = shallow > 2.0 * deep;
            let drive_flipped = is_at_low_drive.then_some(Error::DriveFlipped { shallow, deep });
            return Err(drive_flipped.unwrap_or(Error::ForceFlipped { fall }));
        }
        let squares: f64 = lowest.iter().map(|force| (force - shallow).powi(2)).sum();
        if greatest - shallow <= ABOVE_BASELINE * (squares / lowest.len() as f64).sqrt() {
            return Err(Error::NoContact { curve: 0 });
        }
        let wanted = (scatter(force) / (ALLOWED_NOISE * (greatest - least))).powi(2).ceil();
        self.check_sizes(shallow, wanted.clamp(1.0, block as f64) as usize)
    }

    /// Compares depth and force with the tip, in means of `width` points. The depth is counted from where the force has risen, so
    /// that it is hardly overestimated.
    fn check_sizes(&self, baseline: f64, width: usize) -> Result<()> {
        let means = |column: &[f64]| -> Vec<f64> { column.windows(width).map(mean).collect() };
        let (drive, force) = (means(self.experiment().protocol().drive()), means(self.force()));
        let peak = (0..force.len()).max_by(|&a, &b| force[a].total_cmp(&force[b])).unwrap_or_default();
        let touched = baseline + TOUCHED * (force[peak] - baseline);
        let touch = (0..peak).rev().find(|&k| force[k] < touched).unwrap_or_default();
        let [rise, travel] = [force[peak] - force[touch], drive[peak] - drive[touch]];
        let deflection = rise / self.experiment.stiffness;
        if deflection > 1.1 * travel {
            return Err(Error::SpringTooSoft { deflection, travel });
        }
        let depth = travel - deflection;
        if depth <= 0.0 {
            // a jump at the first time, or a sample that is stiff next to the spring
            return Ok(());
        }
        let level = self.experiment.level_within(depth)?;
        let radius = |depth: f64| (self.experiment.tip.area(self.experiment.level(depth)) / PI).sqrt();
        if depth > STEEPEST * radius(depth) && 1e-3 * depth < radius(1e-3 * depth) {
            return Err(Error::DepthTooLarge { depth, radius: radius(depth) });
        }
        let modulus = rise / level;
        if (MODULI[0]..=MODULI[1]).contains(&modulus) { Ok(()) } else { Err(Error::Modulus { modulus }) }
    }
}
