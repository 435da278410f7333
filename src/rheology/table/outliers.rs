//! Samples that contradict all others: a step of the strain that rings or lasts, a knock, a slip of the pen.
//!
//! Left in, one would not only be off itself. The first modulus of relaxation, a little high, is followed by a term
//! that has a large modulus at t = 0, which nothing else bounds and which slows the creep.

use super::data::SCATTER;
use crate::rheology::fit::{FittedSeries, Sample, Search, damped_step, linearise};
use crate::rheology::table::measured::FITTING;

impl Search {
    /// The samples that do not contradict all others, and those that do, with their relative deviation from the fit of
    /// the others; or, kept, the end that does so by [less](Scatter::doubtful). `scatter` is the relative
    /// standard deviation of a value, if it is stated.
    pub(super) fn without_outliers(
        &self,
        samples: &[Sample],
        scatter: Option<f64>,
    ) -> (Vec<Sample>, Vec<(Sample, f64)>) {
        let (mut kept, mut outliers) = (samples.to_vec(), Vec::new());
        let rows = |kept: &[Sample]| kept.iter().filter(|sample| sample.function == kept[0].function).count();
        while rows(&kept) >= SCATTER.per_outlier * (outliers.len() + 1) {
            let whole = self.nearest(&kept);
            let noise = whole.noise(&kept).max(FITTING.floor);
            let left = |k: usize| whole.misfit(&kept[k]).abs() * kept[k].weight.sqrt();
            // terms follow rows at the ends, whatever they are
            let is_end = |k: usize| {
                k == 0 && kept[0].x > 0.0 || kept.get(k + 1).is_none_or(|next| next.function != kept[k].function)
            };
            let worst = (0..kept.len()).max_by(|&a, &b| left(a).total_cmp(&left(b)));
            let worst = worst.filter(|&k| left(k) > SCATTER.suspect * noise && !is_end(k));
            let tried = (0..kept.len()).filter(|&k| is_end(k)).chain(worst);
            let excess = |k: usize| (k, self.excess(&kept, k, is_end(k), scatter, leverage(&whole, &kept, self, k)));
            let found = tried.map(excess).max_by(|a, b| a.1.0.total_cmp(&b.1.0));
            let Some((k, (excess, deviation))) = found else { break };
            if excess > 1.0 && deviation.abs() < SCATTER.most {
                outliers.push((kept.remove(k), deviation));
                continue;
            }
            // ends of relaxation have warnings of their own
            let is_doubtful = self.slope && excess > SCATTER.doubtful && deviation.abs() > SCATTER.least;
            if is_doubtful && is_end(k) && outliers.is_empty() {
                return (kept.clone(), vec![(kept[k], deviation)]);
            }
            break;
        }
        (kept, outliers)
    }

    /// How far a sample deviates from the fit of the others, over what their scatter explains; and relatively. An end
    /// must deviate as far from a parabola through its neighbours, and twice as far as the sample next to it deviates
    /// from the fit of the rest: few curves can be continued. `leverage` is the share of the sample in its own fit.
    fn excess(&self, samples: &[Sample], k: usize, is_end: bool, scatter: Option<f64>, leverage: f64) -> (f64, f64) {
        let (fit, others, deviation) = self.left_out(samples, k);
        let noise = scatter.unwrap_or(0.0).max(fit.noise(&others));
        // the curve of the others is uncertain, mostly at the ends, and few samples tell their scatter poorly: of
        // Student's t, whose square exceeds six deviations' as rarely, by a factor of about 1 + 12/n
        let spread = (1.0 + 12.0 / fit.freedoms(&others)) / (1.0 - leverage).max(f64::MIN_POSITIVE);
        let mut explained = (SCATTER.deviations * noise * (spread / samples[k].weight).sqrt()).max(SCATTER.least);
        let mut found = deviation.abs();
        if is_end && found > explained {
            let own = |other: &&Sample| other.function == samples[k].function;
            let neighbours: Vec<&Sample> = if k == 0 {
                samples[1..].iter().take(3).collect()
            } else {
                samples[..k].iter().rev().filter(own).take(3).collect()
            };
            // both scatter too
            let scattered = SCATTER.suspect * noise / samples[k].weight.sqrt();
            found = found.min(continued(&neighbours, &samples[k]).abs() + scattered);
            let next = self.left_out(&others, if k == 0 { 0 } else { k - 1 }).2;
            explained = explained.max(2.0 * (next.abs() - scattered));
        }
        (found / explained, deviation)
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

/// The share of a sample in its own fitted value, at a minimum: by the strengths, of given times.
fn leverage(series: &FittedSeries, samples: &[Sample], search: &Search, k: usize) -> f64 {
    let (all, _) = linearise(series, samples, search);
    let ends = all.columns() - 2 * series.terms.len();
    let strengths: Vec<usize> = (0..ends).chain((ends..all.columns()).step_by(2)).collect();
    let (jacobian, mut unit) = (all.of_columns(&strengths), vec![0.0; samples.len()]);
    unit[k] = -1.0;
    damped_step(&jacobian, &unit, 1e-12).iter().enumerate().map(|(j, step)| jacobian[(k, j)] * step).sum()
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
