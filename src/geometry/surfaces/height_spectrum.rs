//! Surfaces as Fourier series.

use std::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::fft::{Lines, fourier_coefficients, real_rows};

/// Fourier coefficients of a real field on `cells` points: amplitudes of exp(2πi (k1 i/n1 + k2 j/n2)), normalised so
/// that the sum of all waves is the field. Coefficients of k2 ≥ 0 are stored; the others are their conjugates.
#[derive(Debug, Clone)]
pub(super) struct HeightSpectrum {
    cells: [usize; 2],
    /// For each k2 from 0 to n2/2 all k1, the negative ones after the positive.
    amplitudes: Vec<Complex64>,
}

impl HeightSpectrum {
    /// Bytes of the coefficients of a field on `cells` points.
    pub(super) fn bytes(cells: [usize; 2]) -> u128 {
        size_of::<Complex64>() as u128 * (cells[1] as u128 / 2 + 1) * cells[0] as u128
    }

    /// Zeros.
    pub(super) fn zero(cells: [usize; 2]) -> HeightSpectrum {
        HeightSpectrum { cells, amplitudes: vec![Complex64::ZERO; (cells[1] / 2 + 1) * cells[0]] }
    }

    /// The coefficients of a field without missing values, one value per point.
    pub(super) fn of(cells: [usize; 2], field: &[f64]) -> HeightSpectrum {
        HeightSpectrum { cells, amplitudes: fourier_coefficients(field, cells) }
    }

    /// The field, by the inverse transform.
    pub(super) fn heights(mut self) -> Vec<f64> {
        let [n1, n2] = self.cells;
        Lines::new(n1).inverse(&mut self.amplitudes);
        real_rows(n1, n2, |i, k2| self.amplitudes[k2 * n1 + i])
    }

    /// Sets the amplitude of a wave, and of its conjugate if the conjugate is stored.
    pub(super) fn set(&mut self, number: [i64; 2], amplitude: Complex64) {
        let n1 = self.cells[0] as i64;
        let index = |k1: i64| (number[1] * n1 + k1.rem_euclid(n1)) as usize;
        let (index, image) = (index(number[0]), index(-number[0]));
        self.amplitudes[index] = amplitude;
        if number[1] == 0 {
            self.amplitudes[image] = amplitude.conj();
        }
    }

    /// Multiplies all amplitudes by `factor`.
    pub(super) fn scale(&mut self, factor: f64) {
        self.amplitudes.iter_mut().for_each(|amplitude| *amplitude *= factor);
    }

    /// Shifts the field: each point gets the value at its index plus `by`.
    pub(super) fn shift(&mut self, by: [f64; 2]) {
        let cells = self.cells;
        let factor = |axis: usize, k: i64| {
            let n = cells[axis] as i64;
            // The Nyquist wave of an even number of points has no direction: only its real part remains.
            if 2 * k == n {
                Complex64::from((PI * by[axis]).cos())
            } else {
                Complex64::cis(TAU * k as f64 * by[axis] / n as f64)
            }
        };
        // the negative ones after the positive
        let signed = |k1: usize| if 2 * k1 > cells[0] { k1 as i64 - cells[0] as i64 } else { k1 as i64 };
        let along1: Vec<Complex64> = (0..cells[0]).map(|k1| factor(0, signed(k1))).collect();
        for (k2, row) in self.amplitudes.chunks_exact_mut(cells[0]).enumerate() {
            let along2 = factor(1, k2 as i64);
            row.iter_mut().zip(&along1).for_each(|(a, f)| *a *= f * along2);
        }
    }
}

/// Wave numbers \[rad/m\] of the wave with `number` periods along the `lengths` \[m\].
pub(super) fn wave_numbers(number: [i64; 2], lengths: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|axis| TAU * number[axis] as f64 / lengths[axis])
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;
    use crate::Grid;
    use crate::fft::waves;

    #[test]
    fn amplitudes_match_the_naive_sum_and_transform_back() {
        for cells in [[4, 6], [5, 3], [1, 4], [3, 1], [2, 2]] {
            let [n1, n2] = cells;
            let field: Vec<f64> = (0..n1 * n2).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
            let mut energy = 0.0;
            // a wave of one period has the wave number 1
            for ([a, b], amplitude, count) in waves(&Grid::new(cells, [TAU, TAU]).unwrap(), &field) {
                let naive: Complex64 = (0..n1 * n2)
                    .map(|k| {
                        let periods = a * (k / n2) as f64 / n1 as f64 + b * (k % n2) as f64 / n2 as f64;
                        field[k] * Complex64::cis(-TAU * periods) / (n1 * n2) as f64
                    })
                    .sum();
                assert!((amplitude - naive).norm() < 1e-14, "{a} {b}");
                energy += count * naive.norm_sqr();
            }
            let squares = field.iter().map(|z| z * z).sum::<f64>() / (n1 * n2) as f64;
            assert_abs_diff_eq!(energy, squares, epsilon = 1e-14);
            for (a, b) in HeightSpectrum::of(cells, &field).heights().iter().zip(&field) {
                assert_abs_diff_eq!(a, b, epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn a_real_amplitude_is_a_cosine() {
        for number in [[-2, 1], [2, 0]] {
            let mut spectrum = HeightSpectrum::zero([6, 5]);
            spectrum.set(number, Complex64::from(0.5));
            for (k, z) in spectrum.heights().iter().enumerate() {
                let periods = number[0] as f64 * (k / 5) as f64 / 6.0 + number[1] as f64 * (k % 5) as f64 / 5.0;
                assert_abs_diff_eq!(*z, (TAU * periods).cos(), epsilon = 1e-14);
            }
        }
    }
}
