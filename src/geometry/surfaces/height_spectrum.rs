//! Surfaces as Fourier series.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use num_complex::Complex64;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

use crate::fft::{Lines, fourier_coefficients, real_rows};
use crate::parallel::{Rows, part};

/// Fourier coefficients of a real field on `cells` points: amplitudes of exp(2πi (k1 i/n1 + k2 j/n2)), normalised so
/// that the sum of all waves is the field. Coefficients of k2 ≥ 0 are stored; the others are their conjugates.
#[derive(Debug, Clone)]
pub(super) struct HeightSpectrum {
    cells: [usize; 2],
    /// The stored k2: 0 to n2/2, or the k2 of this rank.
    columns: Range<usize>,
    /// For each k2 all k1, the negative ones after the positive.
    amplitudes: Vec<Complex64>,
}

/// One wave of a [`HeightSpectrum`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave {
    /// Index of its amplitude.
    pub(super) index: usize,
    /// Number of periods along each axis.
    pub(super) number: [i64; 2],
    /// Number of waves of the field that it represents: 2 with its conjugate, otherwise 1.
    pub(super) count: f64,
}

impl HeightSpectrum {
    /// Bytes of the coefficients of a field on `cells` points.
    pub(super) fn bytes(cells: [usize; 2]) -> u128 {
        size_of::<Complex64>() as u128 * (cells[1] as u128 / 2 + 1) * cells[0] as u128
    }

    /// Zeros for the k2 in `columns`.
    pub(super) fn zero(cells: [usize; 2], columns: Range<usize>) -> HeightSpectrum {
        let amplitudes = vec![Complex64::ZERO; columns.len() * cells[0]];
        HeightSpectrum { cells, columns, amplitudes }
    }

    /// The coefficients of a field without missing values, one value per point.
    pub(super) fn of(cells: [usize; 2], field: &[f64]) -> HeightSpectrum {
        HeightSpectrum { cells, columns: 0..cells[1] / 2 + 1, amplitudes: fourier_coefficients(field, cells) }
    }

    /// The field, by the inverse transform.
    pub(super) fn heights(mut self) -> Vec<f64> {
        let [n1, n2] = self.cells;
        Lines::new(n1).inverse(&mut self.amplitudes);
        real_rows(n1, n2, |i, k2| self.amplitudes[k2 * n1 + i])
    }

    /// The local rows of the field, where each rank holds some k2. A call of all ranks.
    pub(super) fn local_heights(mut self, rows: &Rows) -> Vec<f64> {
        if !rows.are_shared() {
            return self.heights();
        }
        let ([n1, n2], own) = (self.cells, rows.own().len());
        Lines::new(n1).inverse(&mut self.amplitudes);
        let ranks = 0..rows.ranks();
        let mut send = Vec::with_capacity(self.amplitudes.len());
        for rank in ranks.clone() {
            self.amplitudes.chunks_exact(n1).for_each(|column| send.extend_from_slice(&column[rows.of(rank)]));
        }
        drop(self.amplitudes);
        let sent: Vec<usize> = ranks.clone().map(|rank| 2 * self.columns.len() * rows.of(rank).len()).collect();
        let counts: Vec<usize> = ranks.map(|rank| 2 * own * part(n2 / 2 + 1, rank, rows.ranks()).len()).collect();
        let mut received = vec![Complex64::ZERO; (n2 / 2 + 1) * own];
        rows.exchange_into((cast_slice(&send), &sent), (cast_slice_mut(&mut received), &counts));
        drop(send);
        real_rows(own, n2, |i, k2| received[k2 * own + i])
    }

    /// All waves stored.
    pub(super) fn waves(&self) -> impl Iterator<Item = Wave> + use<> {
        let [n1, n2] = self.cells;
        (0..(n2 / 2 + 1) * n1).map(move |index| {
            let (k1, k2) = (index % n1, index / n1);
            let k1 = if 2 * k1 <= n1 { k1 as i64 } else { k1 as i64 - n1 as i64 };
            Wave { index, number: [k1, k2 as i64], count: if k2 == 0 || 2 * k2 == n2 { 1.0 } else { 2.0 } }
        })
    }

    /// Amplitude of a wave.
    pub(super) fn at(&self, wave: Wave) -> Complex64 {
        self.amplitudes[wave.index]
    }

    /// Sets the amplitude of a wave, and of its conjugate if the conjugate is stored.
    pub(super) fn set(&mut self, number: [i64; 2], amplitude: Complex64) {
        let n1 = self.cells[0] as i64;
        let index = |k1: i64| ((number[1] - self.columns.start as i64) * n1 + k1.rem_euclid(n1)) as usize;
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
        let waves = self.waves();
        let along1: Vec<Complex64> = waves.take(cells[0]).map(|wave| factor(0, wave.number[0])).collect();
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

    #[test]
    fn amplitudes_match_the_naive_sum_and_transform_back() {
        for cells in [[4, 6], [5, 3], [1, 4], [3, 1], [2, 2]] {
            let [n1, n2] = cells;
            let field: Vec<f64> = (0..n1 * n2).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
            let spectrum = HeightSpectrum::of(cells, &field);
            let mut energy = 0.0;
            for wave in spectrum.waves() {
                let naive: Complex64 = (0..n1 * n2)
                    .map(|k| {
                        let [a, b] = wave.number.map(|k| k as f64);
                        let periods = a * (k / n2) as f64 / n1 as f64 + b * (k % n2) as f64 / n2 as f64;
                        field[k] * Complex64::cis(-TAU * periods) / (n1 * n2) as f64
                    })
                    .sum();
                assert!((spectrum.at(wave) - naive).norm() < 1e-14, "{wave:?}");
                energy += wave.count * naive.norm_sqr();
            }
            let squares = field.iter().map(|z| z * z).sum::<f64>() / (n1 * n2) as f64;
            assert_abs_diff_eq!(energy, squares, epsilon = 1e-14);
            for (a, b) in spectrum.heights().iter().zip(&field) {
                assert_abs_diff_eq!(a, b, epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn a_real_amplitude_is_a_cosine() {
        for number in [[-2, 1], [2, 0]] {
            let mut spectrum = HeightSpectrum::zero([6, 5], 0..3);
            spectrum.set(number, Complex64::from(0.5));
            for (k, z) in spectrum.heights().iter().enumerate() {
                let periods = number[0] as f64 * (k / 5) as f64 / 6.0 + number[1] as f64 * (k % 5) as f64 / 5.0;
                assert_abs_diff_eq!(*z, (TAU * periods).cos(), epsilon = 1e-14);
            }
        }
    }
}
