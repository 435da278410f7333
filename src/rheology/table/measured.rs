//! Series through measurements, which are noisy and may be few.
//!
//! The noise is the residual of non-negative least squares: positive strengths already smooth the data. With many
//! values per parameter, the sparsest series with the best prediction is chosen. With few values of little noise, which
//! determine as many parameters as there are values, the sparsest series ripples between the rows; then the smoothest
//! spectrum that explains the data is computed, and a sparse series is fitted to its curve.

use crate::rheology::MaterialFunction;
use crate::rheology::fit::{EFFORT, FittedSeries, Sample, Search, polish};

/// How series are fitted to measurements: chosen on tests/materials/sparse_tables.rs, clean and with noise.
pub(super) struct Fitting {
    /// Accuracy of the best measurements: misfits below this need no further term.
    pub(super) floor: f64,
    /// Times per decade of the first fit.
    pub(super) density: f64,
    /// Denser tables are averaged to this many values per decade, over thirty decades or fewer.
    pub(super) means: f64,
    /// Factor by which the times of the terms extend beyond the data.
    pub(super) beyond: f64,
    /// The largest modulus of a term at t = 0 over the first of relaxation moduli. With 1 a steep power law is off by
    /// more than 1e-3; with 3 a first modulus that is a little high makes the creep of 2 % of tables a fifth too small.
    pub(super) hidden: f64,
    /// A fit is better by this number of variances of the scatter, or more.
    noticeable: f64,
    /// Mergers tried, cheapest first: with noise the first-order cost is a poor estimate.
    tries: usize,
    /// With fewer values per parameter than this a smooth spectrum is preferred to a sparse one.
    few: usize,
}

pub(super) const FITTING: Fitting =
    Fitting { floor: 3e-5, density: 6.0, means: 24.0, beyond: 3.0, hidden: 2.0, noticeable: 12.0, tries: 6, few: 3 };

/// Smooth spectra, and the sparse series that follow them: chosen on the same tables.
struct Smoothing {
    /// A smooth spectrum explains data within this misfit, in the root mean square, or their noise.
    misfit: f64,
    /// Times per decade, and in all, since the cost grows with their third power: a bound over twelve decades and more.
    density: f64,
    times: f64,
    /// Factor by which it extends beyond the times of the search.
    beyond: f64,
    /// A sparse series follows the curve within this, or within a fifth of the noise, ...
    follows: f64,
    /// ... at this many points per decade, and at most in all over the samples of a table, over eight decades and more.
    followed: f64,
    in_all: f64,
}

const SMOOTHING: Smoothing =
    Smoothing { misfit: 1e-4, density: 4.0, times: 48.0, beyond: 10.0, follows: 5e-4, followed: 8.0, in_all: 64.0 };

/// A series fitted to measurements.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    /// The series with the best prediction.
    pub(crate) series: FittedSeries,
    /// The series of least squares, which fits the samples equally well.
    pub(crate) least_squares: FittedSeries,
    /// Relative deviation of the two, at or between the samples.
    pub(crate) ambiguity: f64,
    /// Relative standard deviation of one measurement, and the degrees of freedom of its estimate.
    pub(crate) noise: f64,
    pub(crate) freedoms: f64,
}

impl FittedSeries {
    /// Degrees of freedom that samples leave.
    pub(super) fn freedoms(&self, samples: &[Sample]) -> f64 {
        samples.len().saturating_sub(self.parameters()).max(1) as f64
    }

    /// The relative standard deviation of a single value from the series.
    pub(super) fn noise(&self, samples: &[Sample]) -> f64 {
        (self.squares(samples) / self.freedoms(samples)).sqrt()
    }
}

impl Search {
    /// The series of least squares.
    pub(super) fn nearest(&self, samples: &[Sample]) -> FittedSeries {
        let enough = |series: &FittedSeries| series.worst(samples) <= 0.1 * FITTING.floor;
        polish(&self.on_grid(samples, FITTING.density), samples, self, EFFORT.long, &enough)
    }

    /// Whether a wider search fits samples better by [`Fitting::noticeable`].
    pub(super) fn misses(&self, wider: &Search, samples: &[Sample]) -> bool {
        let [own, other] = [self, wider].map(|search| search.nearest(samples));
        own.squares(samples) > other.squares(samples) + FITTING.noticeable * other.noise(samples).powi(2)
    }

    /// The series with the best prediction for measurements.
    pub(crate) fn measured(&self, samples: &[Sample]) -> Measured {
        let start = self.nearest(samples);
        let (noise, freedoms) = (start.noise(samples), start.freedoms(samples));
        // the floor holds for single measurements: a mean of many is not fitted more closely
        let root = (samples.iter().map(|sample| sample.weight).sum::<f64>() / samples.len() as f64).sqrt();
        let few = samples.len() < FITTING.few * start.parameters();
        let smooth = if few { self.smooth(samples, noise.max(SMOOTHING.misfit * root)) } else { None };
        let series = match smooth {
            Some(curve) => self.within(&along(&curve, samples), SMOOTHING.follows.max(0.2 * noise)),
            None => self.sparse(&start, samples, noise.max(FITTING.floor * root)),
        };
        let ambiguity = series.worst(&along(&start, samples));
        Measured { series, least_squares: start, ambiguity, noise, freedoms }
    }

    /// The terms that improve the prediction, by the criterion of Mallows (Technometrics 15, 1973).
    ///
    /// Criteria for the true number of terms (Bayesian ones) identify three or six discrete times equally reliably, but
    /// leave ripples in a continuous spectrum: with 2 % noise, the rms error of J of a fractional Zener body is 0.95 %
    /// instead of 0.68 %, and of three retardation times 0.38 % instead of 0.40 %.
    fn sparse(&self, start: &FittedSeries, samples: &[Sample], noise: f64) -> FittedSeries {
        let criterion = |series: &FittedSeries| {
            series.squares(samples) / (noise * noise) + 2.0 * (series.ends() + 2 * series.terms.len()) as f64
        };
        let prefers = |trial: &FittedSeries, current: &FittedSeries| criterion(trial) <= criterion(current);
        let thinned = self.thinned(start.clone(), samples, FITTING.tries, &prefers);
        polish(&thinned, samples, self, EFFORT.long, &|_| false)
    }

    /// The smoothest spectrum that explains the samples; `None` if none does, as for a few discrete times without
    /// noise.
    fn smooth(&self, samples: &[Sample], noise: f64) -> Option<FittedSeries> {
        let [first, last] = self.times;
        let wide = Search { times: [first / SMOOTHING.beyond, last * SMOOTHING.beyond], ..self.clone() };
        let enough = noise.powi(2) * samples.len() as f64;
        // weights of the curvature, with which the misfit grows
        let weight = |k: i32| 1e3 * 0.1_f64.powi(k);
        let (mut smoothest, mut low, mut high) = (None, 0, 16);
        while low < high {
            let middle = (low + high) / 2;
            let series = wide.regularised(samples, weight(middle));
            if series.squares(samples) <= enough {
                (smoothest, high) = (Some(series), middle);
            } else {
                low = middle + 1;
            }
        }
        smoothest
    }

    /// A smooth spectrum. Its curvature is the second difference relative to the data at the same time, which vanishes
    /// for a power law.
    fn regularised(&self, samples: &[Sample], weight: f64) -> FittedSeries {
        let decades = (self.times[1] / self.times[0]).log10();
        let times = self.grid(SMOOTHING.density.min(SMOOTHING.times / decades));
        self.least_squares(samples, times, |time| level(samples, time), weight)
    }
}

/// The first material function of the samples at `time`: log-linear between the samples, and constant beyond them.
fn level(samples: &[Sample], time: f64) -> f64 {
    let function = samples[0].function;
    let x = match function {
        MaterialFunction::Creep | MaterialFunction::Relaxation => time,
        MaterialFunction::Storage | MaterialFunction::Loss => 1.0 / time,
    };
    let known: Vec<&Sample> = samples.iter().filter(|sample| sample.function == function && sample.x > 0.0).collect();
    let next = known.partition_point(|sample| sample.x < x);
    match (next.checked_sub(1).map(|before| known[before]), known.get(next)) {
        (Some(before), Some(next)) => {
            before.value * (next.value / before.value).powf((x / before.x).ln() / (next.x / before.x).ln())
        }
        (Some(nearest), None) => nearest.value,
        (None, nearest) => nearest.map_or(1.0, |nearest| nearest.value),
    }
}

/// The values of `curve` at and between the samples.
fn along(curve: &FittedSeries, samples: &[Sample]) -> Vec<Sample> {
    let known = || samples.iter().map(|sample| sample.x).filter(|x| *x > 0.0);
    let decades = (known().fold(0.0, f64::max) / known().fold(f64::INFINITY, f64::min)).log10().max(1.0);
    let followed = SMOOTHING.followed.min(SMOOTHING.in_all / decades);
    let mut points = Vec::new();
    let mut push = |function, x| points.push(Sample { function, x, value: curve.value(function, x), weight: 1.0 });
    for (k, &Sample { function, x, .. }) in samples.iter().enumerate() {
        push(function, x);
        if let Some(next) = samples.get(k + 1).filter(|next| next.function == function && x > 0.0) {
            let between = ((next.x / x).log10() * followed).ceil() as usize;
            for part in 1..between {
                push(function, x * (next.x / x).powf(part as f64 / between as f64));
            }
        }
    }
    points
}
