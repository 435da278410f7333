//! Stress below waves of pressure on a periodic half-space.
//!
//! A wave p e^(i(q1 x1 + q2 x2)), q = |(q1, q2)|, has the potentials of [`rectangle`](super::rectangle) χ = −2π p
//! e^(−qz)/q² and V = 2π p e^(−qz)/q, and the stress, times p e^(−qz) and the wave,
//!
//! ```text
//! σ11 = −1 + z q1²/q + (1 − 2ν) q2²/q²      σ33 = −(1 + qz)                      σ13 = i q1 z
//! σ22 = −1 + z q2²/q + (1 − 2ν) q1²/q²      σ12 = q1 q2 (z/q − (1 − 2ν)/q²)      σ23 = i q2 z
//! ```
//!
//! The mean pressure p̄ has no wavelength. Below it σ33 = −p̄; the lateral stress depends on the constraint at the
//! sides of the body. Here every period keeps its lengths: the mean lateral strain is zero, and the mean lateral
//! stress −ν/(1 − ν) p̄.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::{Stress, Weights};
use crate::Grid;

/// A wave along one axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave {
    /// The wave number \[1/m\], negative for the second half of the coefficients.
    pub(super) q: f64,
    /// Whether it changes its sign from cell to cell: cos qx, whose slope vanishes at every centre.
    pub(super) alternates: bool,
}

impl Wave {
    /// The wave of the coefficient `k` of a period.
    pub(super) fn new(k: usize, cells: usize, side: f64) -> Wave {
        let signed = if 2 * k > cells { k as f64 - cells as f64 } else { k as f64 };
        Wave { q: TAU * signed / (cells as f64 * side), alternates: 2 * k == cells }
    }

    /// The wave and its slope over q at a distance from the first centre.
    fn at(self, distance: f64) -> [Complex64; 2] {
        let (sin, cos) = (self.q * distance).sin_cos();
        if self.alternates {
            [Complex64::from(cos), Complex64::from(-sin)]
        } else {
            [Complex64::new(cos, sin), Complex64::new(-sin, cos)]
        }
    }
}

/// The factors of the stress below a wave at a depth, for a unit pressure. The factors of σ13 and σ23 multiply its
/// slopes over q1 and q2, the factor of σ12 both slopes.
pub(super) fn below_wave(wave: [f64; 2], z: f64, [all, by_ratio]: Weights) -> Stress {
    let [q1, q2] = wave;
    let q = q1.hypot(q2);
    if q == 0.0 {
        // with r = 1 − 2ν, ν/(1 − ν) = (1 − r)/(1 + r)
        let lateral = -(all - by_ratio) / (all + by_ratio);
        return Stress::new([lateral, lateral, -all], [0.0; 3]);
    }
    let (c1, c2, qz) = (q1 / q, q2 / q, q * z);
    let normal = [qz * c1 * c1 * all + by_ratio * c2 * c2 - all, qz * c2 * c2 * all + by_ratio * c1 * c1 - all];
    let shear = [(by_ratio - all * qz) * c1 * c2, all * c1 * qz, all * c2 * qz];
    (-qz).exp() * Stress::new([normal[0], normal[1], -all * (1.0 + qz)], shear)
}

/// The stress at a point below the field with this spectrum.
pub(super) fn below_field(grid: &Grid, spectrum: &[Complex64], point: [f64; 3], weights: Weights) -> Stress {
    let [x, y, z] = point;
    let ([n1, n2], [d1, d2], start) = (grid.cells(), grid.spacing(), grid.center(0, 0));
    let second: Vec<_> = (0..n2).map(|k| Wave::new(k, n2, d2)).map(|wave| (wave.q, wave.at(y - start[1]))).collect();
    let mut sum = Stress::default();
    for (k1, row) in spectrum.chunks_exact(n2).enumerate() {
        let wave = Wave::new(k1, n1, d1);
        let [of_1, slope_1] = wave.at(x - start[0]);
        for (&amplitude, &(q2, [of_2, slope_2])) in row.iter().zip(&second) {
            let factors = below_wave([wave.q, q2], z, weights);
            let even = (amplitude * of_1 * of_2).re;
            sum += Stress {
                s11: factors.s11 * even,
                s22: factors.s22 * even,
                s33: factors.s33 * even,
                s12: factors.s12 * (amplitude * slope_1 * slope_2).re,
                s13: factors.s13 * (amplitude * slope_1 * of_2).re,
                s23: factors.s23 * (amplitude * of_1 * slope_2).re,
            };
        }
    }
    (1.0 / (n1 * n2) as f64) * sum
}
