//! Samples that contradict all others: a step of the strain that rings or lasts, a knock, a slip of the pen.
//!
//! Left in, one would not only be off itself. The first modulus of relaxation, a little high, is followed by a term that
//! has a large modulus at t = 0, which nothing else bounds and which slows the creep.

use super::data::DEVIATIONS;
use crate::rheology::fit::{Sample, Search};
use crate::rheology::table::measured::FLOOR;

/// Relative deviations below this are not worth a warning.
pub(super) const TOLERABLE: f64 = 5e-3;
/// A fit of all samples leaves less of an outlier inside than a fit of the others, but at least this many deviations.
const SUSPECT: f64 = 2.0;
/// Of so many samples, one may be an outlier: more are a property of the table, and fewer do not tell their scatter.
const SAMPLES_PER_OUTLIER: usize = 20;

impl Search {
    /// The samples that do not contradict all others, and those that do, with their relative deviation from the fit of
    /// the others. `scatter` is the relative standard deviation of a value, if it is stated.
    pub(super) fn without_outliers(
        &self,
        samples: &[Sample],
        scatter: Option<f64>,
    ) -> (Vec<Sample>, Vec<(Sample, f64)>) {
        let (mut kept, mut outliers) = (samples.to_vec(), Vec::new());
        while kept.len() >= SAMPLES_PER_OUTLIER * (outliers.len() + 1) {
            let whole = self.nearest(&kept);
            let noise = whole.noise(&kept).max(FLOOR);
            let left = |k: usize| whole.misfit(&kept[k]).abs() * kept[k].weight.sqrt();
            // terms follow rows at the ends, whatever they are
            let is_first = |k: usize| k == 0 && kept[0].x > 0.0;
            let is_end = |k: usize| is_first(k) || kept.get(k + 1).is_none_or(|next| next.x < kept[k].x);
            let worst = (0..kept.len()).max_by(|&a, &b| left(a).total_cmp(&left(b)));
            let worst = worst.filter(|&k| left(k) > SUSPECT * noise && !is_end(k));
            let excess = |k: usize| {
                let (excess, deviation) = self.excess(&kept, k, scatter);
                let inner: Vec<&Sample> = if is_first(k) {
                    kept[1..].iter().take(3).collect()
                } else {
                    kept[..k].iter().rev().take(3).collect()
                };
                let share = if is_end(k) { (continued(&inner, &kept[k]) / deviation).abs().min(1.0) } else { 1.0 };
                (excess * share, deviation)
            };
            let tried = (0..kept.len()).filter(|&k| is_end(k)).chain(worst).map(|k| (k, excess(k)));
            let found = tried.max_by(|a, b| a.1.0.total_cmp(&b.1.0));
            let Some((k, (_, deviation))) = found.filter(|(_, (excess, _))| *excess > 1.0) else { break };
            outliers.push((kept.remove(k), deviation));
        }
        (kept, outliers)
    }

    /// How far a sample deviates from the fit of the others, over what their scatter explains; and relatively.
    fn excess(&self, samples: &[Sample], k: usize, scatter: Option<f64>) -> (f64, f64) {
        let mut others = samples.to_vec();
        let sample = others.remove(k);
        let fit = self.nearest(&others);
        let parameters = fit.parameters() as f64;
        let noise = scatter.unwrap_or(0.0).max(fit.noise(&others));
        // the curve itself is uncertain, and few samples tell their scatter poorly: of Student's t, whose square exceeds
        // six deviations' as rarely, by a factor of about 1 + 12/n
        let spread = (1.0 + 2.0 * parameters / others.len() as f64) * (1.0 + 12.0 / fit.freedoms(&others));
        let explained = (DEVIATIONS * noise * (spread / sample.weight).sqrt()).max(TOLERABLE);
        let deviation = 1.0 / (1.0 + fit.misfit(&sample)) - 1.0;
        (deviation.abs() / explained, deviation)
    }
}

/// The relative deviation of an end from the parabola through its neighbours, on logarithmic axes: of coarse tables, no
/// series of positive strengths can be continued so well.
fn continued(neighbours: &[&Sample], end: &Sample) -> f64 {
    let log: f64 = neighbours
        .iter()
        .map(|of| {
            let others = neighbours.iter().filter(|other| other.x != of.x);
            let weight: f64 = others.map(|other| (end.x / other.x).ln() / (of.x / other.x).ln()).product();
            weight * of.value.ln()
        })
        .sum();
    end.value / log.exp() - 1.0
}
