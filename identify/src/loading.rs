//! The elastic law fitted to the loading of a curve.

use viscocontact::numeric::least;

use crate::experiment::Curve;
use crate::statistics::{line, range};

/// Contact points that are tried first.
const POINTS: usize = 60;
/// Drives that differ from the greatest one by less than this share of the range belong to its hold.
const SAME_DRIVE: f64 = 1e-3;

impl Curve {
    /// First and last sample at which the drive differs from the greatest one by less than a `share` of its range.
    pub(crate) fn top(&self, share: f64) -> (usize, usize) {
        let drive = self.experiment.protocol.drive();
        let [low, high] = range(drive);
        let is_near = |z: &f64| *z >= high - share * (high - low);
        (drive.iter().position(is_near).unwrap_or(0), drive.iter().rposition(is_near).unwrap_or(0))
    }

    /// First and last sample of the hold at the greatest drive.
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
        least(lowest - 0.1 * travel, lowest + 0.9 * travel, POINTS, misfit)
    }
}
