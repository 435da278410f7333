//! Checks of a curve before it is fitted.

use std::f64::consts::PI;

use crate::data::error::DataError;
use crate::error::{Error, Result};
use crate::experiment::Curve;

/// Fewest points of a curve.
const LEAST_POINTS: usize = 10;
/// Blocks of points whose mean forces are compared.
const BLOCKS: usize = 20;
/// The range of the means of so many blocks of white noise over their standard deviation is less in all but 1 of 10⁴ curves.
const RANGE_OF_NOISE: f64 = 7.0;
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

/// The force along the curve, in numbers.
struct Summary {
    /// Standard deviation of white noise in the force, from its second differences.
    noise: f64,
    /// Mean force in the lowest and in the highest tenth of the range of the drive.
    ends: [f64; 2],
    /// Standard deviation of the force in the lowest tenth of the drive.
    scatter: f64,
    /// Range of the means of blocks in the lower and in the upper half of the drive.
    activity: [f64; 2],
    /// Least and greatest mean of a block.
    range: [f64; 2],
}

impl Curve {
    /// Checks that the curve shows a contact of this tip: enough points, a force above its scatter, signs, and units that
    /// fit each other and the size of the tip. [`Recording`](crate::Recording) checks every curve that it makes.
    ///
    /// The checks are coarse: each of them accepts every curve that some material can give, and a curve of two wrong units
    /// may pass.
    ///
    /// # Errors
    /// [`DataError`], [`Error::NoContact`] or [`Error::BeyondStates`], with what to change.
    pub fn check(&self) -> Result<()> {
        let points = self.force().len();
        if points < LEAST_POINTS {
            return Err(DataError::TooFewPoints { points, least: LEAST_POINTS }.into());
        }
        let Summary { noise, ends: [shallow, deep], scatter, activity, range: [least, greatest] } = self.summary();
        let per_block = (points / BLOCKS).max(1) as f64;
        let range = greatest - least;
        if range <= RANGE_OF_NOISE * noise / per_block.sqrt() {
            return Err(Error::NoContact { curve: 0 });
        }
        let ends = self.experiment().protocol().drive();
        if ends.iter().all(|drive| *drive == ends[0]) {
            // a jump before the first time
            return self.check_sizes(0.0, 1);
        }
        if shallow - deep > OPPOSITE * range {
            let is_at_low_drive = activity[0] > 2.0 * activity[1];
            return Err(if is_at_low_drive {
                DataError::DriveFlipped { shallow: activity[0], deep: activity[1] }.into()
            } else {
                DataError::ForceFlipped { fall: shallow - deep }.into()
            });
        }
        if greatest - shallow <= ABOVE_BASELINE * scatter {
            return Err(Error::NoContact { curve: 0 });
        }
        let wanted = (noise / (ALLOWED_NOISE * range)).powi(2).ceil();
        self.check_sizes(shallow, wanted.clamp(1.0, per_block) as usize)
    }

    /// Compares depth and force with the tip, in means of `width` points. The depth is counted from where the force has risen, so
    /// that it is hardly overestimated.
    fn check_sizes(&self, baseline: f64, width: usize) -> Result<()> {
        let means = |column: &[f64]| -> Vec<f64> {
            column.windows(width).map(|values| values.iter().sum::<f64>() / width as f64).collect()
        };
        let (drive, force) = (means(self.experiment().protocol().drive()), means(self.force()));
        let peak = (0..force.len()).max_by(|&a, &b| force[a].total_cmp(&force[b])).unwrap_or_default();
        let touched = baseline + TOUCHED * (force[peak] - baseline);
        let touch = (0..peak).rev().find(|&k| force[k] < touched).unwrap_or_default();
        let [rise, travel] = [force[peak] - force[touch], drive[peak] - drive[touch]];
        let (deflection, tip) = (rise / self.experiment.stiffness, &self.experiment.tip);
        if deflection > 1.1 * travel {
            return Err(DataError::SpringTooSoft { deflection, travel }.into());
        }
        let depth = travel - deflection;
        if depth <= 0.0 {
            // a jump at the first time, or a sample that is stiff next to the spring
            return Ok(());
        }
        let level = |depth: f64| tip.level_at(tip.approach(0.0) + depth);
        if level(depth).is_nan() {
            return Err(Error::BeyondStates { curve: 0, depth });
        }
        let radius = |depth: f64| (tip.area(level(depth)) / PI).sqrt();
        if depth > STEEPEST * radius(depth) && 1e-3 * depth < radius(1e-3 * depth) {
            return Err(DataError::DepthTooLarge { depth, radius: radius(depth) }.into());
        }
        let modulus = rise / level(depth);
        if !(MODULI[0]..=MODULI[1]).contains(&modulus) {
            return Err(DataError::Modulus { modulus }.into());
        }
        Ok(())
    }

    fn summary(&self) -> Summary {
        let (drive, force) = (self.experiment().protocol().drive(), self.force());
        let mut bends: Vec<f64> = force.windows(3).map(|three| (three[0] - 2.0 * three[1] + three[2]).abs()).collect();
        bends.sort_by(f64::total_cmp);
        // the median of |x| is 0.6745 standard deviations, and a second difference has √6 of those of a value
        let noise = bends[bends.len() / 2] / (0.6745 * 6.0_f64.sqrt());
        let all: Vec<usize> = (0..force.len()).collect();
        let [first, last] = drive.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| [a.min(*z), b.max(*z)]);
        // the points of a share of the range of the drive
        let part = |from: f64, to: f64| -> Vec<usize> {
            let [from, to] = [from, to].map(|share| (1.0 - share) * first + share * last);
            all.iter().copied().filter(|&k| (from..=to).contains(&drive[k])).collect()
        };
        let sum = |of: &[usize], value: &dyn Fn(f64) -> f64| of.iter().map(|&k| value(force[k])).sum::<f64>();
        let mean = |of: &[usize]| sum(of, &|force| force) / of.len() as f64;
        let (lowest, highest) = (part(0.0, 0.1), part(0.9, 1.0));
        let shallow = mean(&lowest);
        let scatter = (sum(&lowest, &|force| (force - shallow).powi(2)) / lowest.len() as f64).sqrt();
        let range = |mean_forces: &mut dyn Iterator<Item = f64>| {
            mean_forces.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], f| [low.min(f), high.max(f)])
        };
        let block = (force.len() / BLOCKS).max(1);
        let means = |of: &[usize]| range(&mut of.chunks_exact(block).map(mean));
        let activity = [part(0.0, 0.5), part(0.5, 1.0)].map(|half| {
            let [low, high] = means(&half);
            (high - low).max(0.0)
        });
        Summary { noise, ends: [shallow, mean(&highest)], scatter, activity, range: means(&all) }
    }
}
