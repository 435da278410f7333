//! How bodies creep under a pressure that moves.

use std::sync::Arc;

use num_complex::Complex64;

use crate::rheology::CreepSpectrum;

/// How a body creeps.
#[derive(Clone)]
pub(super) enum Creep {
    Series(CreepSpectrum),
    /// A complex contact modulus \[Pa\] at frequencies ≥ 0 \[rad/s\].
    Modulus(Arc<dyn Fn(f64) -> Complex64 + Send + Sync>),
}

/// Beyond this ωλ a term has only its imaginary part left, and squares overflow.
const FAST: f64 = 1e100;

/// A body of a smaller loss factor yields by less than 15 % in a decade, 2/π ln 10 of it.
const RELAXED: f64 = 0.1;

impl Creep {
    /// C(0) + Σ C_k/(1 − iω λ_k) \[1/Pa\].
    pub(super) fn at(&self, omega: f64) -> Complex64 {
        match self {
            Creep::Series(series) => {
                let term = |&(compliance, time): &(f64, f64)| {
                    let x = omega * time;
                    let fast = x.abs() > FAST;
                    if fast { Complex64::I * (compliance / x) } else { compliance / Complex64::new(1.0, -x) }
                };
                series.glassy() + series.terms().iter().map(term).sum::<Complex64>()
            }
            Creep::Modulus(modulus) => {
                let compliance = modulus(omega.abs()).inv();
                if omega < 0.0 { compliance } else { compliance.conj() }
            }
        }
    }

    /// Compliances, and the reach v λ of each \[m\]: 0 of what follows at once.
    pub(super) fn reaches(&self, speed: f64) -> Vec<(f64, f64)> {
        let Creep::Series(series) = self else { return Vec::new() };
        let terms = series.terms().iter().map(|&(compliance, time)| (compliance, speed * time));
        std::iter::once((series.glassy(), 0.0)).chain(terms).collect()
    }

    /// Whether a body hardly creeps any more `after` a time.
    pub(super) fn is_relaxed(&self, after: f64) -> bool {
        let own = self.at(1.0 / after);
        self.fluidity() == 0.0 && own.im <= RELAXED * own.re
    }

    pub(super) fn fluidity(&self) -> f64 {
        if let Creep::Series(series) = self { series.fluidity() } else { 0.0 }
    }
}
