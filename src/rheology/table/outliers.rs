//! Samples that contradict all others: a step of the strain that rings or lasts, a knock, a slip of the pen.
//!
//! Left in, one would not only be off itself. The first modulus of relaxation, a little high, is followed by a term that
//! has a large modulus at t = 0, which nothing else bounds and which slows the creep.

use super::data::{DEVIATIONS, FEW};
use crate::rheology::fit::{FittedSeries, Sample, Search};
use crate::rheology::table::measured::FLOOR;

/// Relative deviations below this are not worth a warning.
pub(super) const TOLERABLE: f64 = 5e-3;
/// A fit of all samples leaves less of an outlier inside than a fit of the others, but at least this many deviations.
const SUSPECT: f64 = 2.0;
/// What a fit misses of an end, over what it misses of the sample next to it, varies by less.
const CONTINUED: f64 = 3.0;
/// Of so many samples, one may be an outlier: more are a property of the table.
const SAMPLES_PER_OUTLIER: usize = 10;

impl Search {
    /// The samples that do not contradict all others, and those that do, with their relative deviation from the fit of
    /// the others. `scatter` is the relative standard deviation of a value, if it is stated.
    pub(super) fn without_outliers(
        &self,
        samples: &[Sample],
        scatter: Option<f64>,
    ) -> (Vec<Sample>, Vec<(Sample, f64)>) {
        let (mut kept, mut outliers) = (samples.to_vec(), Vec::new());
        while kept.len() >= FEW.max(SAMPLES_PER_OUTLIER * (outliers.len() + 1)) {
            let whole = self.nearest(&kept);
            let noise = whole.noise(&kept).max(FLOOR);
            let left = |k: usize| whole.misfit(&kept[k]).abs() * kept[k].weight.sqrt();
            // terms follow rows at the ends, whatever they are
            let inner = |k: usize| match kept.get(k + 1) {
                Some(next) if next.x > kept[k].x => (k == 0 && kept[0].x > 0.0).then_some(1),
                _ => k.checked_sub(1),
            };
            let worst = (0..kept.len()).max_by(|&a, &b| left(a).total_cmp(&left(b)));
            let worst = worst.filter(|&k| left(k) > SUSPECT * noise && inner(k).is_none());
            let ends = (0..kept.len()).filter(|&k| inner(k).is_some());
            let tried = ends.chain(worst).map(|k| (k, self.excess(&kept, k, inner(k), scatter)));
            let found = tried.max_by(|a, b| a.1.0.total_cmp(&b.1.0));
            let Some((k, (_, deviation))) = found.filter(|(_, (excess, _))| *excess > 1.0) else { break };
            outliers.push((kept.remove(k), deviation));
        }
        (kept, outliers)
    }

    /// How far a sample deviates from the fit of the others, over what their scatter explains, or, at an end, over what
    /// the fit of the rest misses of its `inner` neighbour: how well curves can be continued here; and relatively.
    fn excess(&self, samples: &[Sample], k: usize, inner: Option<usize>, scatter: Option<f64>) -> (f64, f64) {
        let (fit, others, deviation) = self.left_out(samples, k);
        let parameters = fit.parameters() as f64;
        let noise = scatter.unwrap_or(0.0).max(fit.noise(&others));
        // the curve itself is uncertain, and few samples tell their scatter poorly: of Student's t, whose square exceeds
        // six deviations' as rarely, by a factor of about 1 + 12/n
        let spread = (1.0 + 2.0 * parameters / others.len() as f64) * (1.0 + 12.0 / fit.freedoms(&others));
        let explained = (DEVIATIONS * noise * (spread / samples[k].weight).sqrt()).max(TOLERABLE);
        let continued = inner.filter(|_| deviation.abs() > explained).map_or(0.0, |inner| {
            let place = if inner > k { inner - 1 } else { inner };
            self.left_out(&others, place).2.abs()
        });
        (deviation.abs() / explained.max(CONTINUED * continued), deviation)
    }

    /// The fit of all samples but one, these, and the relative deviation of the one from it.
    fn left_out(&self, samples: &[Sample], k: usize) -> (FittedSeries, Vec<Sample>, f64) {
        let mut others = samples.to_vec();
        let sample = others.remove(k);
        let fit = self.nearest(&others);
        let deviation = 1.0 / (1.0 + fit.misfit(&sample)) - 1.0;
        (fit, others, deviation)
    }
}
