//! Material functions that are linear in the strengths of an exponential series.

/// The material function of a sample; the abscissa x is a time or an angular frequency.
///
/// Each is constant · a + slope · b(x) + Σ c_k φ(x, λ_k), with the coefficients of a creep series (glassy
/// compliance, fluidity, retarded compliances) or of a relaxation series (equilibrium modulus,
/// immediate viscosity, relaxing moduli).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MaterialFunction {
    /// Creep compliance J(t) \[1/Pa\] over the time \[s\].
    Creep,
    /// Relaxation modulus G(t) \[Pa\] over the time \[s\].
    Relaxation,
    /// Storage modulus G′(ω) \[Pa\] over the angular frequency \[rad/s\].
    Storage,
    /// Loss modulus G″(ω) \[Pa\] over the angular frequency \[rad/s\].
    Loss,
}

impl MaterialFunction {
    /// Contribution of a unit constant at `x`.
    pub(crate) fn constant(self) -> f64 {
        if self == MaterialFunction::Loss { 0.0 } else { 1.0 }
    }

    /// Contribution of a unit slope at `x`.
    pub(crate) fn slope(self, x: f64) -> f64 {
        match self {
            MaterialFunction::Creep | MaterialFunction::Loss => x,
            MaterialFunction::Relaxation | MaterialFunction::Storage => 0.0,
        }
    }

    /// φ(x, λ) and ∂φ/∂ln λ.
    pub(crate) fn term(self, x: f64, lambda: f64) -> (f64, f64) {
        match self {
            MaterialFunction::Creep => {
                let z = x / lambda;
                (-(-z).exp_m1(), -z * (-z).exp())
            }
            MaterialFunction::Relaxation => {
                let z = x / lambda;
                ((-z).exp(), z * (-z).exp())
            }
            // y = ωτ; y² is avoided, so that neither end overflows
            MaterialFunction::Storage => {
                let (stored, lost) = debye(x * lambda);
                (stored, 2.0 * lost * lost)
            }
            MaterialFunction::Loss => {
                let (stored, lost) = debye(x * lambda);
                (lost, lost * (1.0 - 2.0 * stored))
            }
        }
    }
}

/// y²/(1 + y²) and y/(1 + y²).
fn debye(y: f64) -> (f64, f64) {
    let lost = 1.0 / (y + 1.0 / y);
    (y * lost, lost)
}

/// One measured or computed value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    pub(crate) function: MaterialFunction,
    pub(crate) x: f64,
    pub(crate) value: f64,
    /// Number of measurements averaged in this value.
    pub(crate) weight: f64,
}

/// The time at which the strength of a term is seen: that of the first modulus of relaxation, 0 otherwise.
pub(super) fn first_time(samples: &[Sample]) -> f64 {
    if samples[0].function == MaterialFunction::Relaxation { samples[0].x } else { 0.0 }
}

/// An exponential series under construction.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FittedSeries {
    pub(crate) constant: f64,
    pub(crate) slope: f64,
    /// (strength, time), times ascending.
    pub(crate) terms: Vec<(f64, f64)>,
}

impl FittedSeries {
    /// Number of its strengths that are not zero: each is a parameter of non-negative least squares (Meyer & Woodroofe,
    /// Ann. Statist. 28, 2000).
    pub(in crate::rheology) fn parameters(&self) -> usize {
        self.ends() + self.terms.len()
    }

    /// Number of non-zero ends, constant and slope.
    pub(in crate::rheology) fn ends(&self) -> usize {
        usize::from(self.constant > 0.0) + usize::from(self.slope > 0.0)
    }

    pub(crate) fn value(&self, function: MaterialFunction, x: f64) -> f64 {
        let terms: f64 = self.terms.iter().map(|&(c, lambda)| c * function.term(x, lambda).0).sum();
        // a zero slope contributes zero even where its function is infinite (0 · ∞ is NaN)
        let slope = if self.slope > 0.0 { self.slope * function.slope(x) } else { 0.0 };
        self.constant * function.constant() + slope + terms
    }

    /// Slows terms of relaxation that have decayed before the first sample, until the modulus of none at t = 0 is more
    /// than `hidden` times the first sample: no sample bounds it, and the viscosity of such a term would stop the
    /// creep.
    pub(super) fn bound(&mut self, samples: &[Sample], hidden: f64) {
        let (first, most) = (first_time(samples), hidden * samples[0].value);
        if first == 0.0 {
            return;
        }
        for (strength, time) in &mut self.terms {
            if *strength > most {
                // the modulus at the first sample stays
                let left = strength.ln() - first / *time;
                *time = first / (most.ln() - left);
                *strength = most;
            }
        }
    }

    /// fitted/value − 1.
    pub(crate) fn misfit(&self, sample: &Sample) -> f64 {
        self.value(sample.function, sample.x) / sample.value - 1.0
    }

    pub(crate) fn worst(&self, samples: &[Sample]) -> f64 {
        samples.iter().map(|sample| self.misfit(sample).abs()).fold(0.0, f64::max)
    }

    /// Σ weight · misfit².
    pub(crate) fn squares(&self, samples: &[Sample]) -> f64 {
        samples.iter().map(|sample| sample.weight * self.misfit(sample).powi(2)).sum()
    }
}
