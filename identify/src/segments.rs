//! Parts of a curve, the pull-off that a fit does not describe, and the elastic law fitted to the loading.

use std::ops::Range;

use viscocontact::numeric::minimum;

use crate::error::{Result, count_within};
use crate::experiment::{Curve, Experiment};
use crate::protocol::Protocol;
use crate::statistics::{line, mean, means, range, scatter};

/// Drives that differ from the largest by less than this share of the range are at the top of a segment.
const TOP: f64 = 1e-2;
/// Drives that differ from the largest one by less than this share of the range belong to its hold.
const SAME_DRIVE: f64 = 1e-3;
/// Contact points that are tried first.
const POINTS: usize = 60;
/// Samples of a mean.
pub(crate) const BLOCK: usize = 5;
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
        self.samples(if times.start.is_nan() { 0..0 } else { from..to })
    }

    /// The curve until the drive first comes near its maximum value.
    ///
    /// # Errors
    /// As [`Curve::within`].
    pub fn approach(&self) -> Result<Curve> {
        self.samples(0..self.top(TOP).0 + 1)
    }

    /// The curve until the drive leaves its maximum value: approach and hold.
    ///
    /// # Errors
    /// As [`Curve::within`].
    pub fn loading(&self) -> Result<Curve> {
        self.samples(0..self.top(TOP).1 + 1)
    }

    /// The curve until the force returns to the base line before the contact: without the pull-off of an adhesive tip.
    ///
    /// # Errors
    /// As [`Curve::within`].
    pub fn until_release(&self) -> Result<Curve> {
        let (base, last) = (self.base_line(), self.top(TOP).1);
        let is_released = |block: &[f64]| mean(block) <= base;
        let end = self.force[last..].windows(BLOCK).position(is_released).map_or(self.force.len(), |at| last + at);
        self.samples(0..end)
    }

    /// The force below the base line \[N\], where the tip is drawn back to the sample by more than noise explains: no fit of this crate describes
    /// it, and [`Curve::until_release`] leaves it out. A drag, a drift or a tilt is taken for a pull, too; [`FitWarning::PullOff`](crate::FitWarning::PullOff) is
    /// told without those that the fit has found.
    pub fn pull_off(&self) -> Option<f64> {
        self.pull_below(self.base_line(), 0.0)
    }

    /// The maximum force below a base line after the top, if it is more than noise explains, whose means of blocks scatter by at least `wander`.
    pub(crate) fn pull_below(&self, base: f64, wander: f64) -> Option<f64> {
        let after = &self.force[self.top(TOP).1..];
        let pull = after.windows(BLOCK).map(|block| base - mean(block)).fold(0.0, f64::max);
        let scatter = (scatter(&self.force) / (BLOCK as f64).sqrt()).max(wander);
        // less than a hundredth of the force is a base line that is not straight
        (pull > (PULL * scatter).max(0.01 * (range(&self.force)[1] - base))).then_some(pull)
    }

    /// Mean force of the first twentieth of the samples up to the top.
    fn base_line(&self) -> f64 {
        mean(&self.force[..(self.top(TOP).0 / 20).max(1)])
    }

    /// Means of so many neighbouring samples of time, drive and force: for drives whose noise is an error of measurement.
    ///
    /// # Errors
    /// If there are not two means of at least one sample.
    pub fn averaged(&self, neighbours: usize) -> Result<Curve> {
        let allowed = "from 1 to half the samples of the curve";
        count_within("samples of a mean", neighbours, (1..=self.force.len() / 2).contains(&neighbours), allowed)?;
        Ok(self.means(self.force.len() / neighbours))
    }

    /// So many means of neighbours.
    pub(crate) fn means(&self, count: usize) -> Curve {
        let Protocol { times, drive } = &self.experiment.protocol;
        let protocol = Protocol { times: means(times, count), drive: means(drive, count) };
        Curve { experiment: Experiment { protocol, ..self.experiment.clone() }, force: means(&self.force, count) }
    }

    fn samples(&self, samples: Range<usize>) -> Result<Curve> {
        count_within("samples of the segment", samples.len(), samples.len() > 1, "2 or more")?;
        let Protocol { times, drive } = &self.experiment.protocol;
        let protocol = Protocol::new(times[samples.clone()].to_vec(), drive[samples.clone()].to_vec())?;
        let experiment = Experiment { protocol, ..self.experiment.clone() };
        Curve::new(experiment, self.force[samples].to_vec())
    }

    /// First and last sample at which the drive differs from the largest one by less than a `share` of its range.
    pub(crate) fn top(&self, share: f64) -> (usize, usize) {
        let drive = self.experiment.protocol.drive();
        let [low, high] = range(drive);
        let is_near = |z: &f64| *z >= high - share * (high - low);
        (drive.iter().position(is_near).unwrap_or(0), drive.iter().rposition(is_near).unwrap_or(0))
    }

    /// First and last sample of the hold at the maximum drive.
    pub(crate) fn hold(&self) -> (usize, usize) {
        self.top(SAME_DRIVE)
    }

    /// Offset, modulus and sum of squares of the elastic law that fits the forces up to the hold best, for a contact point and a spring of
    /// `give` 1/k; an infinite sum where there is none.
    pub(crate) fn elastic_law(&self, contact_point: f64, give: f64, has_offset: bool) -> [f64; 3] {
        let (drive, force) = (&self.experiment.protocol.drive[..=self.hold().0], &self.force[..=self.hold().0]);
        let depth = |(z, force): (&f64, &f64)| z - contact_point - give * force.max(0.0);
        let levels: Vec<f64> = drive.iter().zip(force).map(|pair| self.experiment.level(depth(pair))).collect();
        let [offset, modulus, sum] = line(&levels, force, has_offset);
        if modulus > 0.0 && sum.is_finite() { [offset, modulus, sum] } else { [0.0, 0.0, f64::INFINITY] }
    }

    /// The contact point for which the elastic law fits best: also a little before the first point, and a contact over a tenth of the drive at least.
    pub(crate) fn elastic_contact_point(&self, give: f64, has_offset: bool) -> f64 {
        let drive = &self.experiment.protocol.drive[..=self.hold().0];
        let (lowest, last) = (range(drive)[0], drive[drive.len() - 1]);
        let travel = last - lowest;
        let misfit = |point: f64| self.elastic_law(point, give, has_offset)[2];
        minimum(lowest - 0.1 * travel, lowest + 0.9 * travel, POINTS, misfit)
    }
}
