//! Exponential series with positive coefficients through samples of a material function.
//!
//! Three stages. Non-negative least squares of the relative misfit on log-spaced times finds the times with
//! non-zero strength; since exponentials are nearly dependent, neighbouring times share the strength of one in
//! between. Neighbours are then merged, the pair of least effect first, and after every merger strengths and
//! times are polished together, as long as the misfit allows it. The result is sparse: each term costs time in
//! every step of a contact.
//!
//! Functions are fitted within a tolerance, [`Search::within`]; measurements to within their noise,
//! [`Search::measured`].

mod basis;
mod polish;
mod report;

use crate::numeric::non_negative_least_squares;

pub use basis::MaterialFunction;
use basis::first_time;
pub(crate) use basis::{FittedSeries, Sample};
pub use report::{FitReport, FitSample, FitWarning};
pub(in crate::rheology) use report::{KNOWN, MOST_MISFIT};

pub(in crate::rheology) use polish::polish;
#[cfg(feature = "data")]
pub(in crate::rheology) use polish::{damped_step, linearise};

/// The class of series to search.
#[derive(Debug, Clone)]
pub(crate) struct Search {
    /// The constant, if known.
    pub(crate) constant: Option<f64>,
    /// Whether there may be a slope (flow, an immediate dashpot).
    pub(crate) slope: bool,
    /// Shortest and longest time of a term.
    pub(crate) times: [f64; 2],
    /// The largest modulus of a term at t = 0 over the first modulus of relaxation, if that is measured later.
    pub(crate) hidden: f64,
}

/// How long a series is sought, chosen as the samples of a function are (series.rs): half of it costs terms, and twice
/// as much saves few.
pub(in crate::rheology) struct Effort {
    /// Times per decade tried for a function: the error of the trapezoidal rule in ln λ is about e^(−π²/h), so that two
    /// or three suffice for 1e-4.
    densities: [f64; 4],
    /// Mergers tried, cheapest first, before the series of a function counts as the sparsest.
    tries: usize,
    /// Iterations of the polish between mergers, and at the end.
    brief: usize,
    pub(in crate::rheology) long: usize,
}

pub(in crate::rheology) const EFFORT: Effort =
    Effort { densities: [2.0, 3.0, 5.0, 8.0], tries: 3, brief: 12, long: 60 };

impl Search {
    /// The series of the fewest terms found whose misfit is at most `most` at every sample; else the one that comes
    /// nearest.
    pub(crate) fn within(&self, samples: &[Sample], most: f64) -> FittedSeries {
        let reached = |series: &FittedSeries| series.worst(samples) <= most;
        let fitted = |density| polish(&self.on_grid(samples, density), samples, self, EFFORT.long, &reached);
        let mut found = fitted(EFFORT.densities[0]);
        for density in &EFFORT.densities[1..] {
            if reached(&found) {
                break;
            }
            let series = fitted(*density);
            if series.worst(samples) < found.worst(samples) {
                found = series;
            }
        }
        let thinned = self.thinned(found, samples, EFFORT.tries, &|trial, _| reached(trial));
        // the polish of a merger stops early: complete it
        let polished = polish(&thinned, samples, self, EFFORT.long, &|_| false);
        if polished.worst(samples) <= thinned.worst(samples) { polished } else { thinned }
    }

    /// Non-negative least squares with `density` times per decade.
    pub(in crate::rheology) fn on_grid(&self, samples: &[Sample], density: f64) -> FittedSeries {
        let mut series = self.least_squares(samples, self.grid(density), |_| 1.0, 0.0);
        series.bound(samples, self.hidden);
        series
    }

    /// Non-negative least squares of the misfit with terms at `times`, and of `smoothing` times the squared second
    /// differences of their strengths, each relative to `level` at its time.
    pub(in crate::rheology) fn least_squares(
        &self,
        samples: &[Sample],
        times: Vec<f64>,
        level: impl Fn(f64) -> f64,
        smoothing: f64,
    ) -> FittedSeries {
        let levels: Vec<f64> = times.iter().map(|&time| level(time)).collect();
        let ends = usize::from(self.constant.is_none()) + usize::from(self.slope);
        let (rows, root) = (samples.len(), smoothing.sqrt());
        let differences = if smoothing > 0.0 { times.len() - 2 } else { 0 };
        let entry = |i: usize, j: usize| {
            if let Some(Sample { function, x, value, weight }) = samples.get(i) {
                let entry = match j {
                    0 if self.constant.is_none() => function.constant(),
                    _ if j < ends => function.slope(*x),
                    _ => levels[j - ends] * function.term(*x, times[j - ends]).0,
                };
                return entry * weight.sqrt() / value;
            }
            match (j + rows).checked_sub(ends + i) {
                Some(0 | 2) => root,
                Some(1) => -2.0 * root,
                _ => 0.0,
            }
        };
        let known = self.constant.unwrap_or(0.0);
        let unknown = |sample: &Sample| 1.0 - known * sample.function.constant() / sample.value;
        let right = samples.iter().map(|sample| sample.weight.sqrt() * unknown(sample));
        let right: Vec<f64> = right.chain(std::iter::repeat(0.0)).take(rows + differences).collect();
        let strengths = non_negative_least_squares(&right, ends + times.len(), entry);
        let (at_ends, of_terms) = strengths.split_at(ends);
        let terms = of_terms.iter().zip(levels).map(|(part, level)| part * level).zip(times);
        FittedSeries {
            constant: self.constant.unwrap_or_else(|| at_ends[0]),
            slope: if self.slope { at_ends[ends - 1] } else { 0.0 },
            terms: terms.filter(|(strength, _)| *strength > 0.0).collect(),
        }
    }

    /// Merges terms while a series with one term fewer is preferred to the current one, trying the `tries` cheapest
    /// mergers.
    pub(in crate::rheology) fn thinned(
        &self,
        start: FittedSeries,
        samples: &[Sample],
        tries: usize,
        prefers: &dyn Fn(&FittedSeries, &FittedSeries) -> bool,
    ) -> FittedSeries {
        let mut best = start;
        loop {
            let mut mergers = self.mergers(&best, samples);
            mergers.sort_by(|a, b| a.0.total_cmp(&b.0));
            let next = mergers.iter().take(tries).find_map(|(_, merged)| {
                let trial = polish(merged, samples, self, EFFORT.brief, &|series| prefers(series, &best));
                prefers(&trial, &best).then_some(trial)
            });
            match next {
                Some(next) => best = next,
                None => return best,
            }
        }
    }

    /// Log-spaced times, `density` per decade.
    pub(in crate::rheology) fn grid(&self, density: f64) -> Vec<f64> {
        let [first, last] = self.times.map(f64::log10);
        let steps = ((last - first) * density).ceil().max(1.0) as usize;
        (0..=steps).map(|k| 10f64.powf(first + (last - first) * k as f64 / steps as f64)).collect()
    }

    /// Every series with one term fewer, and the cost of the merger to first order.
    fn mergers(&self, series: &FittedSeries, samples: &[Sample]) -> Vec<(f64, FittedSeries)> {
        let without = |k: usize| {
            let mut merged = series.clone();
            let term = merged.terms.remove(k);
            (merged, term)
        };
        let joined = |k: usize| {
            let (mut merged, (strength, lambda)) = without(k);
            let (other, shorter) = merged.terms[k - 1];
            let share = strength / (strength + other);
            merged.terms[k - 1] = (strength + other, shorter * (lambda / shorter).powf(share));
            merged
        };
        let mut mergers: Vec<FittedSeries> = (1..series.terms.len()).map(joined).collect();
        // terms faster than the first sample or slower than the last one become part of the constant or the slope,
        // depending on the function
        if let Some(last) = series.terms.len().checked_sub(1) {
            let creep = samples[0].function == MaterialFunction::Creep;
            let (of_constant, of_slope) = if creep { (0, last) } else { (last, 0) };
            if self.constant.is_none() {
                let (mut merged, (strength, _)) = without(of_constant);
                merged.constant += strength;
                mergers.push(merged);
            }
            if self.slope {
                let (mut merged, (strength, time)) = without(of_slope);
                merged.slope += if creep { strength / time } else { strength * time };
                mergers.push(merged);
            }
            mergers.extend([0, last].map(|k| without(k).0));
        }
        let cost = |merged: &FittedSeries| {
            samples.iter().map(|sample| (merged.misfit(sample) - series.misfit(sample)).powi(2)).sum::<f64>()
        };
        mergers.into_iter().map(|merged| (cost(&merged), merged)).collect()
    }
}
