use crate::values::Counted;
use std::fmt;

use super::{FittedSeries, MaterialFunction, Sample};

/// One given value and the value of the fitted series.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FitSample {
    /// The material function.
    pub function: MaterialFunction,
    /// Time \[s\] or angular frequency \[rad/s\].
    pub x: f64,
    /// The value given: \[1/Pa\] for creep, otherwise \[Pa\].
    pub given: f64,
    /// The value of the series.
    pub fitted: f64,
}

impl FitSample {
    /// Relative misfit, fitted/given − 1.
    pub fn misfit(&self) -> f64 {
        self.fitted / self.given - 1.0
    }
}

/// Maximum root mean square misfit of the nearest series to measurements that are accepted; and maximum scatter of
/// short tables, of rows that repeat one another, and of rows that go the wrong way.
pub(crate) const MOST_MISFIT: f64 = 0.1;
/// Creep that is less uncertain than this is known.
pub(in crate::rheology) const KNOWN: f64 = 0.05;

/// Why a series fitted to measurements should be inspected before use. `Display` explains it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum FitWarning {
    /// There are too few samples to determine the curve between them: measure more per decade.
    FewSamples {
        /// Relative deviation, between the samples, of another series that fits them equally well.
        uncertainty: f64,
    },
    /// Relaxation moduli have no value at t = 0, and do not show what relaxed before the first of them, which slows
    /// the creep for many times as long: give the modulus at t = 0, or measure earlier. A contact warns of steps that
    /// are this short ([`Warnings::FASTER_THAN_MATERIAL`](crate::contact::Warnings::FASTER_THAN_MATERIAL)).
    BeginsLate {
        /// The first time measured \[s\].
        first: f64,
        /// The creep is uncertain by more than 5 % until this time \[s\].
        until: f64,
    },
    /// A sample contradicts the others: check it. It was left out of the fit or counts little, unless it is an end of a
    /// noisy creep curve, which may be right and is kept. The first row of a relaxation is often off, where the strain
    /// rings or takes its time.
    Outlier {
        /// Its time \[s\] or angular frequency \[rad/s\].
        x: f64,
        /// Its relative deviation from the curve of the others.
        deviation: f64,
    },
    /// No series fits the samples within their scatter: the body is not linear, it ages, or the specimen slipped.
    Systematic {
        /// [`FitReport::rms_misfit`].
        rms: f64,
    },
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, by, unit) = match self {
            FitWarning::FewSamples { uncertainty } => {
                ("too few samples per decade: between them the curve is uncertain", uncertainty, "%")
            }
            FitWarning::BeginsLate { first, until } => {
                return write!(
                    f,
                    "what relaxed before {first:.3e} s is not in the table, so that its creep is uncertain by more than \
                     {:.0} % until {until:.3e} s: add the modulus at t = 0, or measure earlier",
                    100.0 * KNOWN
                );
            }
            FitWarning::Outlier { x, deviation } => {
                return write!(
                    f,
                    "the sample at {x:.3e} is {:.1} % off the curve of the others: check it",
                    100.0 * deviation
                );
            }
            FitWarning::Systematic { rms } => {
                ("the samples deviate systematically from those of any linear body,", rms, "% rms")
            }
        };
        write!(f, "{what} by {:.1} {unit}", 100.0 * by)
    }
}

/// The error of an exponential series against the data or the function to which it was fitted. `Display` is one line;
/// the samples are for plots.
///
/// ```
/// use viscocontact::rheology::{PowerLaw, Rheology};
///
/// let creep = PowerLaw::new(1.0e-6, 1.0, 0.3)?.series(1.0e-3..=1.0e3, 1.0e-4)?;
/// println!("{}", creep.report());
/// assert!(creep.report().max_misfit() <= 1.0e-4);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FitReport {
    pub(in crate::rheology) samples: Vec<FitSample>,
    pub(in crate::rheology) terms: usize,
    pub(in crate::rheology) averaged: usize,
    pub(in crate::rheology) wrong_way: f64,
    pub(in crate::rheology) interval: Vec<(f64, f64)>,
    pub(in crate::rheology) warning: Option<FitWarning>,
}

debug_by! {
    self: FitReport =>
    samples: Counted(&self.samples), terms: self.terms, averaged: self.averaged, wrong_way: self.wrong_way,
    interval: Counted(&self.interval), warning: self.warning
}

impl FitReport {
    /// The misfit of `series` at `samples`.
    pub(crate) fn new(series: &FittedSeries, samples: &[Sample]) -> FitReport {
        let fitted = |sample: &Sample| FitSample {
            function: sample.function,
            x: sample.x,
            given: sample.value,
            fitted: series.value(sample.function, sample.x),
        };
        FitReport { samples: samples.iter().map(fitted).collect(), ..FitReport::exact(series.terms.len()) }
    }

    /// The report of an exact series.
    pub(crate) fn exact(terms: usize) -> FitReport {
        FitReport { samples: Vec::new(), terms, averaged: 0, wrong_way: 0.0, interval: Vec::new(), warning: None }
    }

    /// Whether the series is exact and nothing was fitted.
    pub(in crate::rheology) fn is_exact(&self) -> bool {
        self.samples.is_empty()
    }

    /// The values given and fitted, in ascending order of time or frequency within each function.
    pub fn samples(&self) -> &[FitSample] {
        &self.samples
    }

    /// The maximum relative misfit in absolute value.
    pub fn max_misfit(&self) -> f64 {
        self.samples.iter().map(|sample| sample.misfit().abs()).fold(0.0, f64::max)
    }

    /// The root mean square of the relative misfit.
    pub fn rms_misfit(&self) -> f64 {
        let squares: f64 = self.samples.iter().map(|sample| sample.misfit().powi(2)).sum();
        (squares / self.samples.len().max(1) as f64).sqrt()
    }

    /// The sample with the maximum misfit; `None` if nothing was fitted.
    pub fn worst(&self) -> Option<FitSample> {
        self.samples.iter().copied().max_by(|a, b| a.misfit().abs().total_cmp(&b.misfit().abs()))
    }

    /// The minimum and maximum positive time \[s\] or angular frequency \[rad/s\] fitted; `None` if nothing
    /// was.
    pub fn range(&self) -> Option<[f64; 2]> {
        let positive = || self.samples.iter().map(|sample| sample.x).filter(|x| *x > 0.0);
        let least = positive().fold(f64::INFINITY, f64::min);
        (least < f64::INFINITY).then(|| [least, positive().fold(0.0, f64::max)])
    }

    /// Number of rows at the time or frequency of the row before them, which were averaged with it.
    pub fn averaged(&self) -> usize {
        self.averaged
    }

    /// Maximum relative deviation of the data from the nearest monotone curve, taken as noise. 0 for monotone data.
    pub fn wrong_way(&self) -> f64 {
        self.wrong_way
    }

    /// The relative error ε of the creep compliance J that is not exceeded at any measured time, for 95 % of tables
    /// with noise: the compliance of the body is between J/(1 + ε) and J (1 + ε). The largest of
    /// [`FitReport::uncertainties`]. 0 for a function, which is sampled as finely as needed.
    pub fn uncertainty(&self) -> f64 {
        self.uncertainties().map(|(_, uncertainty)| uncertainty).fold(0.0, f64::max)
    }

    /// Times \[s\] from the first measured one to the last, and the uncertainty ε of the creep compliance J there: at
    /// each time the compliance of the body is between J/(1 + ε) and J (1 + ε) for 95 % of tables whose errors are
    /// independent, and a fixed part of each value. None for a function.
    ///
    /// The interval includes the creep of other series that fit the samples equally well. For relaxation moduli
    /// without a value at t = 0 these are bodies which have relaxed, before the first sample, from up to ten times
    /// its value: no measurement shows it, and it slows the creep for many times as long.
    pub fn uncertainties(&self) -> impl ExactSizeIterator<Item = (f64, f64)> + '_ {
        self.interval.iter().map(|&(time, logarithm)| (time, logarithm.exp_m1()))
    }

    /// The warning, if any; for measurements only. Steps of a contact with such a material, but for one that begins
    /// late, have
    /// [`Warnings::UNCERTAIN_MATERIAL`](crate::contact::Warnings::UNCERTAIN_MATERIAL).
    pub fn warning(&self) -> Option<FitWarning> {
        self.warning
    }

    /// Number of relaxation or retardation times.
    pub fn terms(&self) -> usize {
        self.terms
    }
}

impl fmt::Display for FitReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Some(worst), Some([first, last])) = (self.worst(), self.range()) else {
            return write!(f, "exact, {} terms", self.terms);
        };
        let unit = match worst.function {
            MaterialFunction::Creep | MaterialFunction::Relaxation => "s",
            MaterialFunction::Storage | MaterialFunction::Loss => "rad/s",
        };
        let (rms, most, x, samples) = (self.rms_misfit(), self.max_misfit(), worst.x, self.samples.len());
        write!(f, "{} terms for {samples} samples from {first:.3e} to {last:.3e} {unit}: ", self.terms)?;
        write!(f, "relative misfit {rms:.1e} rms, {most:.1e} at most (at {x:.3e} {unit})")?;
        if rms > MOST_MISFIT {
            f.write_str("; the series that is nearest to the samples, less smooth than this one, is within the limit")?;
        }
        if self.averaged > 0 {
            write!(f, "; {} rows at the time or frequency of the row before averaged with it", self.averaged)?;
        }
        if self.wrong_way > 0.0 {
            write!(f, "; the data deviate from a monotone curve by at most {:.1e}, taken as noise", self.wrong_way)?;
        }
        if self.uncertainty() > 0.0 {
            match self.uncertainty() {
                // beyond a factor of eleven the number would say nothing
                uncertainty if uncertainty > 10.0 => write!(f, "; creep unknown at some times")?,
                uncertainty => write!(f, "; creep uncertain by {:.1} % at most", 100.0 * uncertainty)?,
            }
            let known: Vec<(f64, bool)> = self.uncertainties().map(|(time, by)| (time, by <= KNOWN)).collect();
            let longest = known.chunk_by(|a, b| a.1 == b.1).filter(|part| part[0].1).max_by_key(|part| part.len());
            if let Some([first, .., last]) = longest.filter(|part| part.len() < known.len()) {
                write!(f, ", by less than {:.0} % from {:.3e} s to {:.3e} s", 100.0 * KNOWN, first.0, last.0)?;
            }
        }
        if let Some(warning) = self.warning {
            write!(f, "; {warning}")?;
        }
        Ok(())
    }
}
