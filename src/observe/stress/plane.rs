//! The stress on a plane, by convolution.

use num_complex::Complex64;

use super::waves::below_wave;
use super::{Source, Stress, SubsurfaceStress, Wave, Weights, corner};
use crate::Grid;
use crate::fft::{Plane, for_each_line_share};
use crate::kernel::HalfSpace;

/// Signs of the components 11, 22, 33, 12, 13, 23 where x1 or x2 changes its sign.
const SIGNS: [[f64; 6]; 2] = [[1.0, 1.0, 1.0, -1.0, -1.0, 1.0], [1.0, 1.0, 1.0, -1.0, 1.0, -1.0]];

/// Buffers for planes.
pub(super) struct Buffers {
    transform: Plane,
    /// Two components.
    pair: Vec<Complex64>,
    work: Vec<Complex64>,
    /// The stress below a cell under a unit load, at the distances of the grid.
    coefficients: Vec<Stress>,
}

impl SubsurfaceStress {
    pub(super) fn buffers(&self) -> Buffers {
        let empty = || vec![Complex64::default(); self.transform.len()];
        let coefficients = match self.body {
            HalfSpace::Periodic => Vec::new(),
            _ => vec![Stress::default(); self.grid.len()],
        };
        Buffers { transform: self.transform.clone(), pair: empty(), work: empty(), coefficients }
    }
}

impl Buffers {
    /// Writes the stress at a depth below each cell.
    pub(super) fn fill_plane(&mut self, stress: &SubsurfaceStress, depth: f64, plane: &mut [Stress]) {
        let SubsurfaceStress { grid, body, source, .. } = stress;
        if *body != HalfSpace::Periodic {
            let sides = stress.sides(depth).map(|side| side / depth);
            tabulate_rectangle(grid, sides, source.weights, &mut self.coefficients);
        }
        let (n2, p2) = (grid.cells()[1], self.transform.periods()[1]);
        for pair in 0..3 {
            if *body == HalfSpace::Periodic {
                write_waves(grid, depth, source, pair, &mut self.pair);
            } else {
                write_mirrored(grid, self.transform.periods(), &self.coefficients, pair, &mut self.pair);
                self.transform.forward(&mut self.pair, &mut self.work);
                for_each_line_share(&mut self.pair, p2, &|first, values| {
                    values.iter_mut().zip(&source.spectrum[first * p2..]).for_each(|(value, of)| *value *= of);
                });
            }
            self.transform.inverse(&mut self.pair, &mut self.work);
            let norm = 1.0 / self.transform.len() as f64;
            for_each_line_share(plane, n2, &|first, stresses| {
                let rows = self.pair[first * p2..].chunks_exact(p2);
                for (row, stresses) in rows.zip(stresses.chunks_exact_mut(n2)) {
                    row.iter().zip(stresses).for_each(|(value, stress)| set_pair(stress, pair, norm * value));
                }
            });
        }
    }
}

/// Sets the two components of a pair.
fn set_pair(stress: &mut Stress, pair: usize, Complex64 { re, im }: Complex64) {
    match pair {
        0 => (stress.s11, stress.s22) = (re, im),
        1 => (stress.s33, stress.s12) = (re, im),
        _ => (stress.s13, stress.s23) = (re, im),
    }
}

/// Writes a pair of components at all distances, positive and negative, within the period.
fn write_mirrored(grid: &Grid, [p1, p2]: [usize; 2], table: &[Stress], pair: usize, out: &mut [Complex64]) {
    let cells = grid.cells();
    // the distance of a row or column of the period, and whether it is negative
    let distance = |axis: usize, k: usize, period: usize| match period - k {
        _ if k < cells[axis] => Some((k, false)),
        back if back < cells[axis] => Some((back, true)),
        _ => None,
    };
    for_each_line_share(out, p2, &|first, rows| {
        for (row, out) in (first..).zip(rows.chunks_exact_mut(p2)) {
            out.fill(Complex64::default());
            let Some((i, up)) = distance(0, row, p1) else { continue };
            for (column, out) in out.iter_mut().enumerate() {
                let Some((j, left)) = distance(1, column, p2) else { continue };
                let mut values = table[i * cells[1] + j].components();
                for (axis, _) in [up, left].into_iter().enumerate().filter(|mirrored| mirrored.1) {
                    values.iter_mut().zip(SIGNS[axis]).for_each(|(value, sign)| *value *= sign);
                }
                *out = Complex64::new(values[2 * pair], values[2 * pair + 1]);
            }
        }
    });
}

/// Writes the stress at the distances of the grid from a rectangle with the sides of a cell, over the depth.
fn tabulate_rectangle(grid: &Grid, sides: [f64; 2], weights: Weights, table: &mut [Stress]) {
    let ([_, n2], [d1, d2]) = (grid.cells(), sides);
    let row = |i: usize, out: &mut Vec<Stress>| {
        out.clear();
        out.extend((0..=n2).map(|j| corner((i as f64 - 0.5) * d1, (j as f64 - 0.5) * d2, weights)));
    };
    for_each_line_share(table, n2, &|first, rows| {
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        row(first, &mut lower);
        for (i, out) in (first..).zip(rows.chunks_exact_mut(n2)) {
            row(i + 1, &mut upper);
            for (j, out) in out.iter_mut().enumerate() {
                *out = (upper[j + 1] + -1.0 * upper[j]) + -1.0 * (lower[j + 1] + -1.0 * lower[j]);
            }
            std::mem::swap(&mut lower, &mut upper);
        }
    });
}

/// Writes a pair of components below the waves of the pressure.
fn write_waves(grid: &Grid, depth: f64, source: &Source, pair: usize, out: &mut [Complex64]) {
    let ([n1, n2], [d1, d2]) = (grid.cells(), grid.spacing());
    for_each_line_share(out, n2, &|begin, rows| {
        for (k1, row) in (begin..).zip(rows.chunks_exact_mut(n2)) {
            let first = Wave::new(k1, n1, d1);
            for (k2, out) in row.iter_mut().enumerate() {
                let factors = pairs_below_wave([first, Wave::new(k2, n2, d2)], depth, source.weights);
                *out = factors[pair] * source.spectrum[k1 * n2 + k2];
            }
        }
    });
}

/// The factors of all pairs of components below a wave.
fn pairs_below_wave(waves: [Wave; 2], depth: f64, weights: Weights) -> [Complex64; 3] {
    let i = Complex64::i();
    let s = below_wave(waves.map(|wave| wave.q), depth, weights);
    // the slope of an alternating wave vanishes at the centres
    let slopes = waves.map(|wave| if wave.alternates { Complex64::default() } else { i });
    [
        Complex64::new(s.s11, s.s22),
        s.s33 + i * (s.s12 * slopes[0] * slopes[1]),
        s.s13 * slopes[0] + i * (s.s23 * slopes[1]),
    ]
}
