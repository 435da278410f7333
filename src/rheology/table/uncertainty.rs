//! Uncertainty of the creep compliance of a series fitted to measurements.
//!
//! Three causes add up. The samples scatter: tables drawn at random from the series, with the same scatter, are fitted
//! anew. The samples do not determine the curve between them: the series of least squares fits them as well as the
//! sparse one. Moduli measured after the load do not show the relaxation before the first of them: a term that has
//! decayed at the first sample does not change the fit, but slows the creep.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::measured::{DENSITY, FLOOR, Measured};
use super::outliers::TOLERABLE;
use crate::error::Result;
use crate::rheology::fit::{FittedSeries, KNOWN, Sample, Search};
use crate::rheology::{CreepSpectrum, FitReport, FitWarning, MaterialFunction, RelaxationSpectrum};

/// Number of tables drawn.
const DRAWN: usize = 16;
/// Half the width of the interval over the standard deviation of the tables drawn: with it 95 % of tables are inside,
/// as tests/materials/intervals.rs shows.
const DEVIATIONS: f64 = 2.2;
/// Times per decade at which the interval is computed.
const PER_DECADE: f64 = 8.0;
/// A body relaxes before the first sample from at most so many times the modulus measured there.
pub(super) const HIDDEN_MODULUS: f64 = 10.0;
/// An uncertainty of more than this times the misfit is not due to the scatter of the samples.
const OVER_SCATTER: f64 = 2.0;
/// Mean square of the difference between neighbouring misfits over their mean square (von Neumann): 2 for noise, less
/// for misfits that follow one another.
const SYSTEMATIC: f64 = 1.0;

/// An interval of the creep compliance of a table.
#[derive(Debug, Clone)]
pub(crate) struct Uncertainty {
    /// Times \[s\], ascending, and the logarithm of the factor by which J may differ from the fit, either way.
    pub(crate) interval: Vec<(f64, f64)>,
    /// The time from which creep does not depend on relaxation before the first sample.
    pub(crate) known_from: f64,
}

impl FittedSeries {
    /// The creep of the series, which represents `function`.
    pub(crate) fn creep(&self, function: MaterialFunction) -> Result<CreepSpectrum> {
        match function {
            MaterialFunction::Creep => CreepSpectrum::new(self.constant, self.slope, &self.terms),
            _ => Ok(RelaxationSpectrum::new(self.constant, 0.0, &self.terms)?.creep()),
        }
    }
}

impl Measured {
    /// The interval of the creep compliance from the time `first` to `last`.
    pub(crate) fn uncertainty(
        &self,
        search: &Search,
        samples: &[Sample],
        [first, last]: [f64; 2],
    ) -> Result<Uncertainty> {
        let function = samples[0].function;
        let creep = self.series.creep(function)?;
        let other = self.least_squares.creep(function)?;
        let drawn = if self.noise > FLOOR { self.drawn(search, samples) } else { Vec::new() };
        let scale = DEVIATIONS * student(self.freedoms);
        let spread = |deviation: &dyn Fn(&CreepSpectrum) -> f64| {
            let squares: f64 = drawn.iter().map(|drawn| deviation(drawn).powi(2)).sum();
            scale * (squares / drawn.len().max(1) as f64).sqrt()
        };
        let unmeasured = function == MaterialFunction::Relaxation && samples[0].x > 0.0;
        let hidden = if unmeasured {
            let unseen = FLOOR + scale * self.noise / samples[0].weight.sqrt();
            let bodies = [self.with_hidden_term(first, unseen), self.with_slow_terms(samples, unseen)];
            bodies.iter().map(|series| series.creep(function)).collect::<Result<Vec<_>>>()?
        } else {
            Vec::new()
        };
        let steps = ((last / first).log10() * PER_DECADE).ceil().max(1.0);
        let (mut interval, mut known_from) = (Vec::new(), first);
        for k in 0..=steps as usize {
            let time = first * (last / first).powf(k as f64 / steps);
            let apart = |other: &CreepSpectrum| (other.compliance(time) / creep.compliance(time)).ln().abs();
            let by_hidden = hidden.iter().map(apart).fold(0.0, f64::max);
            if by_hidden > KNOWN.ln_1p() {
                known_from = time;
            }
            interval.push((time, FLOOR + spread(&apart) + apart(&other) + by_hidden));
        }
        Ok(Uncertainty { interval, known_from })
    }

    /// The creep of series fitted to tables drawn from this one. The signs of the errors are random.
    fn drawn(&self, search: &Search, samples: &[Sample]) -> Vec<CreepSpectrum> {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut table = samples.to_vec();
        let mut draw = || {
            for sample in &mut table {
                let sign = if random.next_u32() & 1 == 0 { 1.0 } else { -1.0 };
                let error = sign * (self.noise / sample.weight.sqrt()).min(0.5);
                sample.value = self.series.value(sample.function, sample.x) * (1.0 + error);
            }
            search.on_grid(&table, DENSITY).creep(samples[0].function).ok()
        };
        (0..DRAWN).filter_map(|_| draw()).collect()
    }

    /// The series and a term that has decayed to the part `unseen` of the modulus at the time `first`.
    fn with_hidden_term(&self, first: f64, unseen: f64) -> FittedSeries {
        let mut series = self.series.clone();
        let modulus = HIDDEN_MODULUS * series.value(MaterialFunction::Relaxation, first);
        series.terms.push((modulus, first / (HIDDEN_MODULUS / unseen.min(1.0)).ln()));
        series
    }

    /// The series with terms that decay before the first sample replaced by slower ones, equal at the first sample, of
    /// which the part `unseen` of the modulus is left at the second.
    fn with_slow_terms(&self, samples: &[Sample], unseen: f64) -> FittedSeries {
        let mut series = self.series.clone();
        let [first, second] = [&samples[0], samples.get(1).unwrap_or(&samples[0])].map(|sample| sample.x);
        let least = unseen * series.value(MaterialFunction::Relaxation, first);
        for (strength, time) in &mut series.terms {
            let left = *strength * (-first / *time).exp();
            let slow = (second - first) / (left / least).ln();
            if left <= least {
                *strength = 0.0;
            } else if *time < first && *time < slow {
                (*strength, *time) = (left * (first / slow).exp(), slow);
            }
        }
        series
    }
}

impl FitReport {
    /// The report of measurements: their deviation from monotone, the deviation of two series that fit them, the
    /// interval of their creep, and the report of the nearest series, by which they are systematically off.
    pub(crate) fn of_measurements(
        self,
        wrong_way: f64,
        ambiguity: f64,
        uncertainty: Uncertainty,
        nearest: &FitReport,
        outlier: Option<FitWarning>,
    ) -> FitReport {
        let Uncertainty { interval, known_from: until } = uncertainty;
        let (rms, first) = (self.rms_misfit(), interval[0].0);
        let warning = if ambiguity > TOLERABLE.max(OVER_SCATTER * rms) {
            Some(FitWarning::FewSamples { uncertainty: ambiguity })
        } else if nearest.rms_misfit() > TOLERABLE && nearest.is_systematic() {
            Some(FitWarning::Systematic { rms: nearest.rms_misfit() })
        } else {
            outlier.or((until > first).then_some(FitWarning::BeginsLate { first, until }))
        };
        FitReport { wrong_way, interval, warning, ..self }
    }

    /// Whether the misfits of neighbouring samples are correlated.
    fn is_systematic(&self) -> bool {
        let neighbours = self.samples.windows(2).filter(|pair| pair[0].function == pair[1].function);
        let (changes, pairs) = neighbours
            .fold((0.0, 0.0), |(sum, count), pair| (sum + (pair[1].misfit() - pair[0].misfit()).powi(2), count + 1.0));
        changes < SYSTEMATIC * pairs * self.rms_misfit().powi(2)
    }
}

/// Ratio of the 97.5 % quantiles of Student's and the normal distribution, within 3 %.
fn student(freedoms: f64) -> f64 {
    1.0 + 1.3 / freedoms + 4.0 / freedoms.powi(3)
}
