use std::fmt;

use super::basis::{Quantity, Sample, Series};

/// One value that a series was fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FitSample {
    /// What the value is.
    pub quantity: Quantity,
    /// Time \[s\] or angular frequency \[rad/s\].
    pub x: f64,
    /// The value given: \[1/Pa\] for creep, else \[Pa\].
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

/// How well an exponential series stands for what it was fitted to. `Display` tells it in a line; the
/// samples are there to be plotted.
///
/// ```
/// use viscocontact::rheology::{PowerLaw, Rheology};
///
/// let creep = PowerLaw::new(1.0e-6, 1.0, 0.3)?.series(1.0e-3..=1.0e3, 1.0e-4)?;
/// println!("{}", creep.report());
/// assert!(creep.report().max_misfit() <= 1.0e-4);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FitReport {
    samples: Vec<FitSample>,
    terms: usize,
    exact: bool,
    wrong_way: f64,
    open: f64,
}

impl FitReport {
    /// The misfit of `series` at `samples`.
    pub(crate) fn new(series: &Series, samples: &[Sample]) -> FitReport {
        let fitted = |sample: &Sample| FitSample {
            quantity: sample.quantity,
            x: sample.x,
            given: sample.value,
            fitted: series.value(sample.quantity, sample.x),
        };
        FitReport {
            samples: samples.iter().map(fitted).collect(),
            terms: series.terms.len(),
            exact: false,
            wrong_way: 0.0,
            open: 0.0,
        }
    }

    /// Of a series that is the function itself.
    pub(crate) fn exact(terms: usize) -> FitReport {
        FitReport { samples: Vec::new(), terms, exact: true, wrong_way: 0.0, open: 0.0 }
    }

    /// The same, of data that turn back by so much.
    pub(crate) fn with_wrong_way(self, wrong_way: f64) -> FitReport {
        FitReport { wrong_way, ..self }
    }

    /// The same, of data that leave the curve open by so much.
    pub(crate) fn with_open(self, open: f64) -> FitReport {
        FitReport { open, ..self }
    }

    /// Whether the series is the function itself and nothing was fitted.
    pub fn is_exact(&self) -> bool {
        self.exact
    }

    /// The values given and fitted, in ascending order of time or frequency within each quantity.
    pub fn samples(&self) -> &[FitSample] {
        &self.samples
    }

    /// The greatest relative misfit in absolute value.
    pub fn max_misfit(&self) -> f64 {
        self.samples.iter().map(|sample| sample.misfit().abs()).fold(0.0, f64::max)
    }

    /// The root mean square of the relative misfit.
    pub fn rms_misfit(&self) -> f64 {
        let squares: f64 = self.samples.iter().map(|sample| sample.misfit().powi(2)).sum();
        (squares / self.samples.len().max(1) as f64).sqrt()
    }

    /// The sample with the greatest misfit; `None` if nothing was fitted.
    pub fn worst(&self) -> Option<FitSample> {
        self.samples.iter().copied().max_by(|a, b| a.misfit().abs().total_cmp(&b.misfit().abs()))
    }

    /// The least and greatest positive time \[s\] or angular frequency \[rad/s\] fitted; `None` if nothing
    /// was.
    pub fn range(&self) -> Option<[f64; 2]> {
        let positive = || self.samples.iter().map(|sample| sample.x).filter(|x| *x > 0.0);
        let least = positive().fold(f64::INFINITY, f64::min);
        (least < f64::INFINITY).then(|| [least, positive().fold(0.0, f64::max)])
    }

    /// How far the data stray, relatively, from the nearest curve that does not turn back, which was taken for
    /// noise. 0 for monotone data.
    pub fn wrong_way(&self) -> f64 {
        self.wrong_way
    }

    /// Relaxation or retardation times that were kept.
    pub fn terms(&self) -> usize {
        self.terms
    }
}

impl fmt::Display for FitReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Some(worst), Some([first, last])) = (self.worst(), self.range()) else {
            return write!(f, "exact, {} terms", self.terms);
        };
        let unit = match worst.quantity {
            Quantity::Creep | Quantity::Relaxation => "s",
            Quantity::Storage | Quantity::Loss => "rad/s",
        };
        write!(
            f,
            "{} terms for {} samples from {first:.3e} to {last:.3e} {unit}: relative misfit {:.1e} rms, {:.1e} at most \
             (at {:.3e} {unit})",
            self.terms,
            self.samples.len(),
            self.rms_misfit(),
            self.max_misfit(),
            worst.x
        )?;
        if self.wrong_way > 0.0 {
            write!(f, "; the data turn back by {:.1e} at most, taken for noise", self.wrong_way)?;
        }
        Ok(())
    }
}
