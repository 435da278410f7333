//! Uncertainty of the creep compliance of a series fitted to measurements.
//!
//! Three causes add up. The samples scatter: tables drawn at random from the series, with the same scatter, are fitted
//! anew. The samples do not determine the curve between them: the series of least squares fits them as well as the
//! sparse one. Moduli measured after the load do not show the relaxation before the first of them: a term that has
//! decayed at the first sample does not change the fit, but slows the creep.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::measured::{FITTING, Measured};
use crate::error::Result;
use crate::rheology::fit::{FittedSeries, KNOWN, Sample, Search};
use crate::rheology::{CreepSpectrum, FitReport, FitWarning, MaterialFunction, RelaxationSpectrum};

/// The interval of a creep compliance, and what is warned of: chosen on tests/materials/intervals.rs.
pub(super) struct Interval {
    /// Number of tables drawn.
    drawn: usize,
    /// Half the width of the interval over the standard deviation of the tables drawn: with it 95 % of tables are
    /// inside.
    deviations: f64,
    /// A body relaxes before the first sample from at most so many times the modulus measured there, by terms of at
    /// least its time over the other number.
    pub(super) hidden: f64,
    pub(super) hidden_before: f64,
    /// Uncertainties and systematic misfits below this need no warning: half and twice do as well.
    pub(super) tolerable: f64,
    /// An uncertainty of more than this times the misfit is not due to the scatter of the samples: with one, tables are
    /// few for their noise alone; four does as well.
    over_scatter: f64,
    /// Mean square of the difference between neighbouring misfits over their mean square (von Neumann): 2 for noise,
    /// less for misfits that follow one another. With a half, creep that speeds up at the end is not seen.
    systematic: f64,
}

pub(super) const INTERVAL: Interval = Interval {
    drawn: 16,
    deviations: 2.2,
    hidden: 10.0,
    hidden_before: 10.0,
    tolerable: 5e-3,
    over_scatter: 2.0,
    systematic: 1.0,
};

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
    /// The interval of the creep compliance from the time `first` to `last`, at eight times per decade.
    pub(crate) fn uncertainty(
        &self,
        search: &Search,
        samples: &[Sample],
        [first, last]: [f64; 2],
    ) -> Result<Uncertainty> {
        let function = samples[0].function;
        let creep = self.series.creep(function)?;
        let other = self.least_squares.creep(function)?;
        let drawn = if self.noise > FITTING.floor { self.drawn(search, samples) } else { Vec::new() };
        let scale = INTERVAL.deviations * student(self.freedoms);
        let spread = |deviation: &dyn Fn(&CreepSpectrum) -> f64| {
            let squares: f64 = drawn.iter().map(|drawn| deviation(drawn).powi(2)).sum();
            scale * (squares / drawn.len().max(1) as f64).sqrt()
        };
        let unmeasured = function == MaterialFunction::Relaxation && samples[0].x > 0.0;
        let hidden = if unmeasured {
            let unseen = FITTING.floor + scale * self.noise / samples[0].weight.sqrt();
            let bodies = [self.with_hidden_term(first, unseen), self.with_slow_terms(samples, unseen)];
            bodies.iter().map(|series| series.creep(function)).collect::<Result<Vec<_>>>()?
        } else {
            Vec::new()
        };
        let steps = ((last / first).log10() * 8.0).ceil().max(1.0);
        let (mut interval, mut known_from) = (Vec::new(), first);
        for k in 0..=steps as usize {
            let time = first * (last / first).powf(k as f64 / steps);
            let apart = |other: &CreepSpectrum| (other.compliance(time) / creep.compliance(time)).ln().abs();
            let by_hidden = hidden.iter().map(apart).fold(0.0, f64::max);
            if by_hidden > KNOWN.ln_1p() {
                known_from = time;
            }
            interval.push((time, FITTING.floor + spread(&apart) + apart(&other) + by_hidden));
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
            search.on_grid(&table, FITTING.density).creep(samples[0].function).ok()
        };
        (0..INTERVAL.drawn).filter_map(|_| draw()).collect()
    }

    /// The series and a term that has decayed to the part `unseen` of the modulus at the time `first`.
    fn with_hidden_term(&self, first: f64, unseen: f64) -> FittedSeries {
        let mut series = self.series.clone();
        let modulus = INTERVAL.hidden * series.value(MaterialFunction::Relaxation, first);
        series.terms.push((modulus, first / (INTERVAL.hidden / unseen.min(1.0)).ln()));
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
        let warning = if ambiguity > INTERVAL.tolerable.max(INTERVAL.over_scatter * rms) {
            Some(FitWarning::FewSamples { uncertainty: ambiguity })
        } else if nearest.rms_misfit() > INTERVAL.tolerable && nearest.is_systematic() {
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
        changes < INTERVAL.systematic * pairs * self.rms_misfit().powi(2)
    }
}

/// Ratio of the 97.5 % quantiles of Student's and the normal distribution, within 3 %.
fn student(freedoms: f64) -> f64 {
    1.0 + 1.3 / freedoms + 4.0 / freedoms.powi(3)
}
