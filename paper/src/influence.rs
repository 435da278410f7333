//! Influence coefficients, and the displacement of a pressure.

use std::f64::consts::PI;
use std::sync::Arc;

use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// N × N cells of a side Δ \[m\], the origin in their middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    pub cells: usize,
    pub side: f64,
}

impl Grid {
    /// Coordinates of the centre of cell k.
    pub fn center(&self, k: usize) -> [f64; 2] {
        [k / self.cells, k % self.cells].map(|i| (i as f64 + 0.5 - 0.5 * self.cells as f64) * self.side)
    }

    /// N².
    pub fn len(&self) -> usize {
        self.cells * self.cells
    }

    /// Whether it has no cells.
    pub fn is_empty(&self) -> bool {
        self.cells == 0
    }
}

/// K(i, j) of Eq. 8 and 12 without the material: the displacement at the distance of i and j cells under 1 Pa on one cell,
/// ∬ dx′/(π r), so that K_el = (1 − ν)/(2G) K and K_vs = C(t_k) K with C = (1 − ν) Φ(t).
pub struct Influence {
    pub grid: Grid,
    /// For distances of 0 … N − 1 cells along each axis.
    coefficients: Vec<f64>,
    /// Transform of the coefficients on 2N × 2N cells, where those of negative distances follow the others (wrap-around).
    spectrum: Vec<Complex64>,
    forward: Arc<dyn Fft<f64>>,
    backward: Arc<dyn Fft<f64>>,
}

impl Influence {
    pub fn new(grid: Grid) -> Influence {
        let n = grid.cells;
        let coefficients: Vec<f64> = (0..n * n).map(|k| over_cell(grid.side, [k / n, k % n])).collect();
        let mut planner = FftPlanner::new();
        let (forward, backward) = (planner.plan_fft_forward(2 * n), planner.plan_fft_inverse(2 * n));
        let distance = |i: usize| if i <= n { i } else { 2 * n - i };
        // the row and the column at the distance N meet no pressure
        let at = |k: usize| [distance(k / (2 * n)), distance(k % (2 * n))];
        let value = |[i, j]: [usize; 2]| if i < n && j < n { coefficients[i * n + j] } else { 0.0 };
        let mut spectrum: Vec<Complex64> = (0..4 * n * n).map(|k| Complex64::new(value(at(k)), 0.0)).collect();
        transform(&mut spectrum, 2 * n, &forward);
        Influence { grid, coefficients, spectrum, forward, backward }
    }

    /// Eq. 7 without the material: Σ_k Σ_l K(i − k, j − l) p(k, l), by FFT on twice the cells along each axis, filled with
    /// zeros (DC-FFT).
    pub fn displacement(&self, pressure: &[f64]) -> Vec<f64> {
        let n = self.grid.cells;
        let mut field = vec![Complex64::default(); 4 * n * n];
        for (k, &p) in pressure.iter().enumerate() {
            field[k / n * 2 * n + k % n].re = p;
        }
        transform(&mut field, 2 * n, &self.forward);
        field.iter_mut().zip(&self.spectrum).for_each(|(value, of)| *value *= of);
        transform(&mut field, 2 * n, &self.backward);
        let scale = 1.0 / (4 * n * n) as f64;
        (0..n * n).map(|k| scale * field[k / n * 2 * n + k % n].re).collect()
    }

    /// The same by the sum over all pairs of cells.
    pub fn displacement_by_sums(&self, pressure: &[f64]) -> Vec<f64> {
        let n = self.grid.cells;
        let coefficient = |a: usize, b: usize| self.coefficients[(a / n).abs_diff(b / n) * n + (a % n).abs_diff(b % n)];
        let at = |a: usize| pressure.iter().enumerate().map(|(b, p)| coefficient(a, b) * p).sum::<f64>();
        (0..n * n).map(at).collect()
    }
}

/// Eq. 8: the integral of 1/(π r) over a cell at a distance of so many cells (Love 1929).
fn over_cell(side: f64, [i, j]: [usize; 2]) -> f64 {
    let corner = |x: f64, y: f64| x * (y / x.abs()).asinh() + y * (x / y.abs()).asinh();
    let (x, y) = (i as f64, j as f64);
    let sum = corner(x + 0.5, y + 0.5) + corner(x - 0.5, y - 0.5) - corner(x + 0.5, y - 0.5) - corner(x - 0.5, y + 0.5);
    side * sum / PI
}

/// Transforms rows, then columns.
fn transform(field: &mut [Complex64], n: usize, line: &Arc<dyn Fft<f64>>) {
    for _ in 0..2 {
        line.process(field);
        for i in 0..n {
            for j in 0..i {
                field.swap(i * n + j, j * n + i);
            }
        }
    }
}
