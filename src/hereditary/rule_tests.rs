//! The exponential rule against what it claims: the integral itself, orders, stability.

mod exactness;
mod foundation;
mod integral;
mod orders;
mod positivity;
mod stability;

use crate::hereditary::Interpolant;
use crate::rheology::CreepSpectrum;

const INTERPOLANTS: [Interpolant; 3] =
    [Interpolant::Linear, Interpolant::CorrectedLinear, Interpolant::CorrectedQuadratic];

/// Independent numbers between 0 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        // xorshift64*
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Evenly on a logarithmic axis.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

fn creep(glassy: f64, fluidity: f64, terms: &[(f64, f64)]) -> CreepSpectrum {
    CreepSpectrum::new(glassy, fluidity, terms).unwrap()
}

/// Half of the relaxation is left in the end.
fn zener() -> CreepSpectrum {
    creep(1.0, 0.0, &[(2.0, 1.0)])
}

fn kelvin_voigt() -> CreepSpectrum {
    creep(0.0, 0.0, &[(1.0, 1.0)])
}

/// Solids, fluids and bodies without elastic response, with one time or several.
fn bodies() -> Vec<(&'static str, CreepSpectrum)> {
    let zener = |rest: f64| creep(1.0, 0.0, &[((1.0 - rest) / rest, 1.0 / rest)]);
    let decades: Vec<(f64, f64)> = (-8..=8).map(|k| (3f64.powi(k), 10f64.powi(k))).collect();
    vec![
        ("Zener, 1e-6 of the modulus is left", zener(1e-6)),
        ("Zener, 0.05 is left", zener(0.05)),
        ("Zener, 0.3 is left", zener(0.3)),
        ("Zener, 0.7 is left", zener(0.7)),
        ("Zener, 0.97 is left", zener(0.97)),
        ("Maxwell", creep(1.0, 1.0, &[])),
        ("Kelvin-Voigt", kelvin_voigt()),
        ("two Kelvin-Voigt", creep(0.0, 0.0, &[(1.0, 1.0), (1.0, 30.0)])),
        ("Jeffreys", creep(0.0, 1.0, &[(1.0, 1.0)])),
        ("seventeen decades", creep(1.0, 0.0, &decades)),
    ]
}
