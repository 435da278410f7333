//! Fourier transforms of planes, for surfaces and for the stress below them. The convolution of a contact has
//! padded and folded transforms that ranks share, in [`kernel`](crate::kernel).

use std::f64::consts::TAU;
use std::sync::Arc;

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};

use crate::Grid;
use crate::parallel::{Task, cut, for_each_share, fork, lanes};

/// Complex transforms of lines of one length that lie one after the other.
#[derive(Clone)]
pub(crate) struct Lines {
    forward: Arc<dyn Fft<f64>>,
    inverse: Arc<dyn Fft<f64>>,
}

impl Lines {
    pub(crate) fn new(length: usize) -> Lines {
        let mut planner = FftPlanner::new();
        Lines { forward: planner.plan_fft_forward(length), inverse: planner.plan_fft_inverse(length) }
    }

    /// Length of a line.
    pub(crate) fn len(&self) -> usize {
        self.forward.len()
    }

    /// Σ x_n e^(−2πi kn/N) of each line.
    pub(crate) fn forward(&self, lines: &mut [Complex64]) {
        self.process(&self.forward, lines);
    }

    /// The inverse of [`Lines::forward`], times the length.
    pub(crate) fn inverse(&self, lines: &mut [Complex64]) {
        self.process(&self.inverse, lines);
    }

    fn process(&self, plan: &Arc<dyn Fft<f64>>, lines: &mut [Complex64]) {
        if self.len() > 1 {
            for_each_line_share(lines, self.len(), &|_, share| plan.process(share));
        }
    }
}

/// Complex transforms of planes of one size, row-major.
#[derive(Clone)]
pub(crate) struct Plane {
    /// Transforms along x1 and x2.
    along: [Lines; 2],
}

debug_by!(self: Plane => periods: self.periods());

impl Plane {
    pub(crate) fn new(periods: [usize; 2]) -> Plane {
        Plane { along: periods.map(Lines::new) }
    }

    /// Lengths along x1 and x2.
    pub(crate) fn periods(&self) -> [usize; 2] {
        self.along.each_ref().map(Lines::len)
    }

    /// Number of values.
    pub(crate) fn len(&self) -> usize {
        self.periods().iter().product()
    }

    /// Transforms rows and columns in place; `work` has the same length.
    pub(crate) fn forward(&self, values: &mut [Complex64], work: &mut [Complex64]) {
        self.apply(Lines::forward, values, work);
    }

    /// The inverse of [`Plane::forward`], times [`Plane::len`].
    pub(crate) fn inverse(&self, values: &mut [Complex64], work: &mut [Complex64]) {
        self.apply(Lines::inverse, values, work);
    }

    fn apply(&self, transform: fn(&Lines, &mut [Complex64]), values: &mut [Complex64], work: &mut [Complex64]) {
        let [p1, p2] = self.periods();
        transform(&self.along[1], values);
        if p1 > 1 {
            transpose(values, work, [p1, p2]);
            transform(&self.along[0], work);
            transpose(work, values, [p2, p1]);
        }
    }
}

/// A transform of lines with one scratch for each lane.
struct InLanes<'a>(&'a dyn Fft<f64>);

impl Task for InLanes<'_> {
    type Lane = Vec<Complex64>;
    type Item = Complex64;

    #[inline(always)]
    fn run(&self, _: usize, scratch: &mut Vec<Complex64>, lines: &mut [Complex64]) {
        self.0.process_with_scratch(lines, scratch);
    }
}

/// Transforms of real planes, row-major, of one size, which allocate nothing. Coefficients: for each k2 from 0 to n2/2
/// all k1, the negative ones after the positive; the other k2 have the conjugate coefficients.
#[derive(Clone)]
pub(crate) struct RealPlane {
    along1: Lines,
    /// The scratch of lines along x1, for each lane.
    scratch1: Vec<Vec<Complex64>>,
    forward2: Arc<dyn RealToComplex<f64>>,
    inverse2: Arc<dyn ComplexToReal<f64>>,
    /// A row, its coefficients, and the scratch of either transform.
    row: Vec<f64>,
    half_row: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

debug_by!(self: RealPlane => cells: [self.along1.len(), self.row.len()]);

impl RealPlane {
    pub(crate) fn new([n1, n2]: [usize; 2]) -> RealPlane {
        let mut planner = RealFftPlanner::new();
        let (forward2, inverse2) = (planner.plan_fft_forward(n2), planner.plan_fft_inverse(n2));
        let scratch = vec![Complex64::ZERO; forward2.get_scratch_len().max(inverse2.get_scratch_len())];
        let (row, half_row) = (forward2.make_input_vec(), forward2.make_output_vec());
        let along1 = Lines::new(n1);
        let of_lane = along1.forward.get_inplace_scratch_len().max(along1.inverse.get_inplace_scratch_len());
        let scratch1 = vec![vec![Complex64::ZERO; of_lane]; lanes(n1 * half_row.len())];
        RealPlane { along1, scratch1, forward2, inverse2, row, half_row, scratch }
    }

    /// Lengths along x1 and x2.
    pub(crate) fn periods(&self) -> [usize; 2] {
        [self.along1.len(), self.row.len()]
    }

    /// The number of coefficients.
    pub(crate) fn coefficients(&self) -> usize {
        self.along1.len() * self.half_row.len()
    }

    /// The coefficients Σ x e^(−2πi (k1 i/n1 + k2 j/n2)) of rows, of which those after the last are zero.
    pub(crate) fn forward<'a>(&mut self, rows: impl Iterator<Item = &'a [f64]>, coefficients: &mut [Complex64]) {
        let n1 = self.along1.len();
        let mut count = 0;
        for (i, row) in rows.enumerate() {
            self.row[..row.len()].copy_from_slice(row);
            self.row[row.len()..].fill(0.0);
            let done = self.forward2.process_with_scratch(&mut self.row, &mut self.half_row, &mut self.scratch);
            debug_assert!(done.is_ok());
            self.half_row.iter().enumerate().for_each(|(k2, value)| coefficients[k2 * n1 + i] = *value);
            count = i + 1;
        }
        coefficients.chunks_exact_mut(n1).for_each(|line| line[count..].fill(Complex64::ZERO));
        self.transform_lines(false, coefficients);
    }

    fn transform_lines(&mut self, is_inverse: bool, coefficients: &mut [Complex64]) {
        let RealPlane { along1: Lines { forward, inverse }, scratch1, half_row, .. } = self;
        let plan = if is_inverse { inverse } else { forward };
        if plan.len() > 1 {
            let of_lane = half_row.len().div_ceil(scratch1.len()) * plan.len();
            for_each_share(&InLanes(&**plan), scratch1, coefficients, of_lane);
        }
    }

    /// The inverse of [`RealPlane::forward`], times the number of values; of the first rows, and of the first values
    /// of each.
    pub(crate) fn inverse<'a>(&mut self, coefficients: &mut [Complex64], rows: impl Iterator<Item = &'a mut [f64]>) {
        let n1 = self.along1.len();
        self.transform_lines(true, coefficients);
        for (i, row) in rows.enumerate() {
            let of = |k2: usize| coefficients[k2 * n1 + i];
            real_row(&*self.inverse2, &of, &mut self.half_row, &mut self.row, &mut self.scratch);
            row.copy_from_slice(&self.row[..row.len()]);
        }
    }
}

/// The Fourier coefficients of a real field on `cells` points, in the order of a [`RealPlane`], normalised so that
/// the sum of all waves is the field.
pub(crate) fn fourier_coefficients(field: &[f64], cells: [usize; 2]) -> Vec<Complex64> {
    let mut plane = RealPlane::new(cells);
    let mut coefficients = vec![Complex64::ZERO; plane.coefficients()];
    plane.forward(field.chunks_exact(cells[1]), &mut coefficients);
    coefficients.iter_mut().for_each(|value| *value /= field.len() as f64);
    coefficients
}

/// The wave numbers of a grid along each axis \[1/m\], in the order of a [`RealPlane`].
pub(crate) fn wave_numbers(grid: &Grid) -> Vec<[f64; 2]> {
    let ([n1, n2], [length1, length2]) = (grid.cells(), grid.lengths());
    let number = |k1: usize| if 2 * k1 > n1 { k1 as f64 - n1 as f64 } else { k1 as f64 };
    let of = |k2: usize| (0..n1).map(move |k1| [TAU * number(k1) / length1, TAU * k2 as f64 / length2]);
    (0..=n2 / 2).flat_map(of).collect()
}

/// The waves of a real field on a grid, in the order of a [`RealPlane`]: wave numbers \[1/m\], Fourier coefficient, and
/// how many waves of the field it stands for, 2 with its conjugate.
pub(crate) fn waves(grid: &Grid, field: &[f64]) -> impl Iterator<Item = ([f64; 2], Complex64, f64)> + use<> {
    let [n1, n2] = grid.cells();
    let count = move |k2: usize| if k2 == 0 || 2 * k2 == n2 { 1.0 } else { 2.0 };
    let all = wave_numbers(grid).into_iter().zip(fourier_coefficients(field, [n1, n2])).enumerate();
    all.map(move |(k, (q, amplitude))| (q, amplitude, count(k / n1)))
}

/// Real rows of n2 values: `coefficient` returns the coefficient k2 of the row i.
pub(crate) fn real_rows(rows: usize, n2: usize, coefficient: impl Fn(usize, usize) -> Complex64) -> Vec<f64> {
    let along2 = RealFftPlanner::new().plan_fft_inverse(n2);
    let (mut input, mut scratch) = (along2.make_input_vec(), along2.make_scratch_vec());
    let mut field = vec![0.0; rows * n2];
    for (i, row) in field.chunks_exact_mut(n2).enumerate() {
        real_row(&*along2, &|k2| coefficient(i, k2), &mut input, row, &mut scratch);
    }
    field
}

/// A real row from its coefficients, which `input` takes.
fn real_row(
    plan: &dyn ComplexToReal<f64>,
    coefficient: &dyn Fn(usize) -> Complex64,
    input: &mut [Complex64],
    row: &mut [f64],
    scratch: &mut [Complex64],
) {
    for (k2, value) in input.iter_mut().enumerate() {
        *value = coefficient(k2);
        if k2 == 0 || 2 * k2 == row.len() {
            // real except for rounding, which the transform would reject
            value.im = 0.0;
        }
    }
    let done = plan.process_with_scratch(input, row, scratch);
    debug_assert!(done.is_ok());
}

/// Calls `job` with shares of the lines of `values` and the index of the first line of each share. There are as many
/// shares as threads for this number of values. The result of `job` for a line must not depend on other lines.
pub(crate) fn for_each_line_share<T: Send>(values: &mut [T], length: usize, job: &(impl Fn(usize, &mut [T]) + Sync)) {
    let lines = (values.len() / length).div_ceil(lanes(values.len())).max(1);
    let shares = values.len().div_ceil(lines * length);
    let job = |k: usize, [share]: [&mut [T]; 1]| job(k * lines, share);
    fork(0..shares, true, [values], &|values, k| cut(values, k * lines * length), &job);
}

/// Side of the blocks that are transposed at once: a block of either plane fits in the first cache.
const BLOCK: usize = 16;

fn transpose(from: &[Complex64], to: &mut [Complex64], [rows, columns]: [usize; 2]) {
    for_each_line_share(to, rows, &|begin, share| {
        let count = share.len() / rows;
        for second in (0..count).step_by(BLOCK) {
            for first in (0..rows).step_by(BLOCK) {
                for j in second..(second + BLOCK).min(count) {
                    for i in first..(first + BLOCK).min(rows) {
                        share[j * rows + i] = from[i * columns + begin + j];
                    }
                }
            }
        }
    });
}
