//! Parts of a curve, and the pull-off that a fit does not describe.

use std::ops::Range;

use crate::error::{Result, within};
use crate::experiment::{Curve, Experiment};
use crate::protocol::Protocol;
use crate::start::scatter;

/// Drives that differ from the greatest by less than this share of the range belong to its hold.
const SAME_DRIVE: f64 = 1e-2;
/// Samples of a mean.
const BLOCK: usize = 5;
/// Standard deviations by which the mean of a block is below the base line of a curve with pull-off.
const PULL: f64 = 5.0;

impl Curve {
    /// The samples within a range of times \[s\]: a segment of a recording.
    ///
    /// ```
    /// use viscocontact::states::ElasticStates;
    /// use viscocontact_identify::{Curve, Experiment, Protocol};
    ///
    /// let experiment = Experiment::new(Protocol::trapezoid(1.0e-6, [0.5, 1.0, 0.5], 0.1)?, ElasticStates::sphere(5.0e-6)?);
    /// let curve = Curve::new(experiment, (0..21).map(f64::from).collect())?;
    /// assert_eq!(curve.within(0.0..0.95)?.force().len(), 10);
    /// assert_eq!(curve.approach()?.force().len(), 6);
    /// assert_eq!(curve.loading()?.force().len(), 16);
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// If fewer than two samples are inside.
    pub fn within(&self, times: Range<f64>) -> Result<Curve> {
        let all = self.experiment.protocol.times();
        let [from, to] = [times.start, times.end].map(|end| all.partition_point(|time| *time < end));
        self.samples(from..to)
    }

    /// The curve until the drive first comes near its greatest value.
    ///
    /// # Errors
    /// As [`Curve::within`].
    pub fn approach(&self) -> Result<Curve> {
        self.samples(0..self.top().0 + 1)
    }

    /// The curve until the drive leaves its greatest value: approach and hold.
    ///
    /// # Errors
    /// As [`Curve::within`].
    pub fn loading(&self) -> Result<Curve> {
        self.samples(0..self.top().1 + 1)
    }

    /// The curve until the force returns to the base line before the contact: without the pull-off of an adhesive tip.
    ///
    /// # Errors
    /// As [`Curve::within`].
    pub fn until_release(&self) -> Result<Curve> {
        let (base, last) = (self.base_line(), self.top().1);
        let is_released = |block: &[f64]| block.iter().sum::<f64>() <= base * block.len() as f64;
        let end = self.force[last..].windows(BLOCK).position(is_released).map_or(self.force.len(), |at| last + at);
        self.samples(0..end)
    }

    /// The force below the base line \[N\], where the tip is drawn back to the sample by more than noise explains: no fit of this crate describes
    /// it, and [`Curve::until_release`] leaves it out.
    pub fn pull_off(&self) -> Option<f64> {
        let base = self.base_line();
        let after = &self.force[self.top().1..];
        let means = after.windows(BLOCK).map(|block| block.iter().sum::<f64>() / BLOCK as f64 - base);
        let least = means.fold(0.0, f64::min);
        let greatest = self.force.iter().fold(0.0, |most: f64, force| most.max(force - base));
        // less than a hundredth of the force is a base line that is not straight
        let is_felt = -least > PULL * scatter(&self.force) / (BLOCK as f64).sqrt() && -least > 0.01 * greatest;
        is_felt.then_some(-least)
    }

    /// First and last sample near the greatest drive.
    fn top(&self) -> (usize, usize) {
        let drive = self.experiment.protocol.drive();
        let [low, high] = drive.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| [a.min(*z), b.max(*z)]);
        let is_near = |z: &f64| *z >= high - SAME_DRIVE * (high - low);
        (drive.iter().position(is_near).unwrap_or(0), drive.iter().rposition(is_near).unwrap_or(0))
    }

    /// Mean force of the first twentieth of the samples up to the top.
    fn base_line(&self) -> f64 {
        let count = (self.top().0 / 20).max(1);
        self.force[..count].iter().sum::<f64>() / count as f64
    }

    fn samples(&self, samples: Range<usize>) -> Result<Curve> {
        let count = samples.len() as f64;
        within("samples of the segment", count, count >= 2.0, "at least 2")?;
        let protocol = &self.experiment.protocol;
        let protocol =
            Protocol::new(protocol.times()[samples.clone()].to_vec(), protocol.drive()[samples.clone()].to_vec())?;
        let experiment = Experiment { protocol, ..self.experiment.clone() };
        Curve::new(experiment, self.force[samples].to_vec())
    }
}
