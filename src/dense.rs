//! Dense matrices of a few dozen columns: least squares, and the extreme eigenvalues of a tridiagonal matrix.
//!
//! Series of a creep function need no more of dense algebra than this page, while a library for it
//! takes most of a first build. `faer` is the reference of the tests, and solves the larger
//! problems of `data` and `sliding`.

use std::ops::{Index, IndexMut};

/// Independent sums of a product of columns, so that it runs in lanes.
const LANES: usize = 8;
/// A square within these bounds has neither overflowed nor lost digits to underflow.
const SAFE_SQUARES: [f64; 2] = [1e-280, 1e280];

/// A matrix, stored column by column.
#[derive(Debug, Clone)]
pub(crate) struct Matrix {
    rows: usize,
    columns: usize,
    data: Vec<f64>,
}

impl Matrix {
    pub(crate) fn zeros(rows: usize, columns: usize) -> Matrix {
        Matrix { rows, columns, data: vec![0.0; rows * columns] }
    }

    pub(crate) fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Matrix {
        let mut matrix = Matrix::zeros(rows, columns);
        for j in 0..columns {
            matrix.column_mut(j).iter_mut().enumerate().for_each(|(i, value)| *value = entry(i, j));
        }
        matrix
    }

    /// The matrix of some columns of this one.
    pub(crate) fn of_columns(&self, columns: &[usize]) -> Matrix {
        let data = columns.iter().flat_map(|&j| self.column(j)).copied().collect();
        Matrix { rows: self.rows, columns: columns.len(), data }
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    pub(crate) fn column(&self, j: usize) -> &[f64] {
        &self.data[j * self.rows..][..self.rows]
    }

    fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.rows..][..self.rows]
    }

    /// The Frobenius norm.
    pub(crate) fn norm(&self) -> f64 {
        norm(&self.data)
    }

    /// The x of minimal |A x − b|, by Householder reflections with column pivoting (Golub & Van Loan,
    /// *Matrix Computations*, 2013, algorithm 5.4.1). Columns that depend on the others, except for
    /// rounding, get 0.
    pub(crate) fn least_squares(mut self, right: &[f64]) -> Vec<f64> {
        let (rows, columns) = (self.rows, self.columns);
        let (mut right, mut order) = (right.to_vec(), (0..columns).collect::<Vec<_>>());
        let dependent = f64::EPSILON * self.norm();
        let mut rank = 0;
        while rank < columns.min(rows) {
            // what is left of the columns below the rows that are reduced
            let rest = |j: usize| norm(&self.column(j)[rank..]);
            let remaining = (rank..columns).map(|j| (rest(j), j));
            let Some((length, pivot)) = remaining.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            // a NaN compares as above every number, and is not passed over
            if length <= dependent {
                break;
            }
            order.swap(rank, pivot);
            (0..rows).for_each(|i| self.data.swap(rank * rows + i, pivot * rows + i));
            let (reduced, others) = self.data.split_at_mut((rank + 1) * rows);
            let own = &mut reduced[rank * rows + rank..];
            // H = 1 − v vᵀ/(v₀ length), v = a + sign(a₀) length e₀, takes a to −sign(a₀) length e₀
            let diagonal = -length.copysign(own[0]);
            own[0] -= diagonal;
            let scale = -1.0 / (diagonal * own[0]);
            let reflect = |field: &mut [f64]| {
                let along = scale * product(own, field);
                field.iter_mut().zip(&*own).for_each(|(value, v)| *value -= along * v);
            };
            others.chunks_exact_mut(rows).for_each(|column| reflect(&mut column[rank..]));
            reflect(&mut right[rank..]);
            own[0] = diagonal;
            rank += 1;
        }
        let mut x = vec![0.0; columns];
        for k in (0..rank).rev() {
            let value = right[k] / self[(k, k)];
            x[order[k]] = value;
            right[..k].iter_mut().zip(self.column(k)).for_each(|(right, entry)| *right -= value * entry);
        }
        x
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.column(j)[i]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.column_mut(j)[i]
    }
}

/// a·b.
pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut lanes = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        (0..LANES).for_each(|n| lanes[n] += a[n] * b[n]);
    }
    lanes.into_iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>()
}

/// |a|, without overflow or underflow on the way.
pub(crate) fn norm(values: &[f64]) -> f64 {
    let square = product(values, values);
    if (SAFE_SQUARES[0]..SAFE_SQUARES[1]).contains(&square) {
        return square.sqrt();
    }
    let largest = values.iter().fold(0.0, |largest, value| f64::max(largest, value.abs()));
    if largest == 0.0 || !largest.is_finite() || square.is_nan() {
        return if square.is_nan() { square } else { largest };
    }
    largest * values.iter().map(|value| (value / largest).powi(2)).sum::<f64>().sqrt()
}

/// The minimum and maximum eigenvalue of a symmetric tridiagonal matrix, by bisection of the number of
/// negative pivots of A − x (Sturm's sequence: Golub & Van Loan, 2013, section 8.4.1).
pub(crate) fn extreme_eigenvalues(diagonal: &[f64], beside: &[f64]) -> (f64, f64) {
    let beside = |k: usize| beside.get(k).copied().filter(|_| k + 1 < diagonal.len()).unwrap_or(0.0);
    let before = |k: usize| k.checked_sub(1).map_or(0.0, beside);
    // Gershgorin's bound
    let bound = (0..diagonal.len()).map(|k| diagonal[k].abs() + beside(k).abs() + before(k).abs()).fold(0.0, f64::max);
    let below = |x: f64| {
        let mut pivot = 1.0;
        let negative = diagonal.iter().enumerate().filter(|&(k, own)| {
            pivot = own - x - before(k) * (before(k) / pivot);
            // a pivot of 0 counts as a small negative one
            pivot = if pivot == 0.0 { -f64::EPSILON * bound } else { pivot };
            pivot < 0.0
        });
        negative.count()
    };
    // the eigenvalue with so many below it
    let find = |number: usize| {
        let (mut low, mut high) = (-bound, bound);
        loop {
            let middle = 0.5 * low + 0.5 * high;
            if middle <= low || middle >= high {
                return middle;
            }
            if below(middle) > number { high = middle } else { low = middle }
        }
    };
    (find(0), find(diagonal.len().saturating_sub(1)))
}

#[cfg(test)]
mod tests {
    use faer::linalg::solvers::SolveLstsqCore;
    use faer::{Conj, Mat, Side};

    use super::*;

    /// A uniform random number in −1 … 1.
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// The x of faer's factorisation with pivots.
    fn by_faer(a: &Matrix, b: &[f64]) -> Vec<f64> {
        let matrix = Mat::from_fn(a.rows(), a.columns(), |i, j| a[(i, j)]);
        let mut right = Mat::from_fn(b.len(), 1, |i, _| b[i]);
        matrix.col_piv_qr().solve_lstsq_in_place_with_conj(Conj::No, right.as_mut());
        (0..a.columns()).map(|j| right[(j, 0)]).collect()
    }

    /// Σ over rows of A x − b, and Aᵀ of it.
    fn left(a: &Matrix, x: &[f64], b: &[f64]) -> (f64, f64) {
        let residual: Vec<f64> =
            (0..a.rows()).map(|i| b[i] - (0..a.columns()).map(|j| a[(i, j)] * x[j]).sum::<f64>()).collect();
        let slopes: Vec<f64> = (0..a.columns()).map(|j| product(a.column(j), &residual) / norm(a.column(j))).collect();
        (norm(&residual), norm(&slopes))
    }

    /// Random matrices, some of them of neighbouring exponentials with conditions to beyond 1/ε, in
    /// units from 1e-150 to 1e150: the residual is that of faer, and orthogonal to the columns.
    #[test]
    fn least_squares_are_those_of_faer() {
        let mut state = 1;
        let mut compared = 0;
        for case in 0..400 {
            let columns = 1 + case % 23;
            let rows = columns + (case * 7) % 60;
            let unit = 10f64.powf(150.0 * random(&mut state));
            let near = 10f64.powf(1.0 + random(&mut state));
            let noise: Vec<f64> = (0..rows * columns).map(|_| random(&mut state)).collect();
            let of_series = |i: usize, j: usize| (-(i as f64 + 1.0) / near.powf(j as f64 / 3.0)).exp();
            let entry = |i: usize, j: usize| unit * if case % 2 == 0 { noise[i * columns + j] } else { of_series(i, j) };
            let a = Matrix::from_fn(rows, columns, entry);
            let b: Vec<f64> = (0..rows).map(|i| 1.0 + 0.1 * random(&mut state) * i as f64).collect();
            let (own, other) = (a.clone().least_squares(&b), by_faer(&a, &b));
            let ((residual, slope), (reference, _)) = (left(&a, &own, &b), left(&a, &other, &b));
            // units cancel
            let size = norm(&b) + a.norm() * norm(&own);
            assert!(residual <= reference * (1.0 + 1e-12) + 1e-13 * size, "{case}: {residual:e} {reference:e}");
            assert!(slope <= 1e-13 * size, "{case}: {slope:e} of {size:e}");
            if case % 2 == 0 && rows > columns + 5 {
                let off: Vec<f64> = own.iter().zip(&other).map(|(a, b)| a - b).collect();
                assert!(norm(&off) <= 1e-11 * norm(&other), "{case}: {own:?} {other:?}");
                compared += 1;
            }
        }
        assert!(compared > 100, "{compared}");
    }

    #[test]
    fn dependent_columns_get_nothing() {
        let mut state = 5;
        let noise: Vec<f64> = (0..40).map(|_| random(&mut state)).collect();
        // the third column is twice the first, the fourth is empty
        let a = Matrix::from_fn(10, 4, |i, j| [noise[i], noise[10 + i], 2.0 * noise[i], 0.0][j]);
        let b: Vec<f64> = (0..10).map(|i| 3.0 * noise[i] - noise[10 + i]).collect();
        let x = a.clone().least_squares(&b);
        assert!(left(&a, &x, &b).0 < 1e-14 && x[3] == 0.0 && (x[0] == 0.0) != (x[2] == 0.0), "{x:?}");
        assert!(Matrix::from_fn(3, 1, |_, _| f64::NAN).least_squares(&[1.0; 3])[0].is_nan());
        assert_eq!(Matrix::zeros(3, 0).least_squares(&[1.0; 3]), []);
    }

    /// Random tridiagonal matrices, some with decoupled blocks, in units from 1e-100 to 1e100.
    #[test]
    fn extreme_eigenvalues_are_those_of_faer() {
        let mut state = 3;
        for case in 0..200 {
            let (n, unit) = (1 + case % 40, 10f64.powf(100.0 * random(&mut state)));
            let diagonal: Vec<f64> = (0..n).map(|_| unit * random(&mut state)).collect();
            let of_pair = |value: f64| if value.abs() < 0.1 { 0.0 } else { unit * value };
            let beside: Vec<f64> = (0..n - 1).map(|_| of_pair(random(&mut state))).collect();
            let entry = |i: usize, j: usize| match i.abs_diff(j) {
                0 => diagonal[i],
                1 => beside[i.min(j)],
                _ => 0.0,
            };
            let values = Mat::from_fn(n, n, entry).self_adjoint_eigenvalues(Side::Lower).unwrap();
            let (lowest, highest) = extreme_eigenvalues(&diagonal, &beside);
            let off = (lowest - values[0]).abs().max((highest - values[n - 1]).abs());
            assert!(off <= 1e-13 * unit, "{case}: {lowest:e} {highest:e} {values:?}");
        }
    }

    #[test]
    fn norms_neither_overflow_nor_vanish() {
        for (values, expected) in
            [([3e-200, 4e-200], 5e-200), ([3e200, 4e200], 5e200), ([0.0, 0.0], 0.0), ([3.0, -4.0], 5.0)]
        {
            assert!((norm(&values) - expected).abs() <= 1e-15 * expected, "{values:?}");
        }
        assert_eq!(norm(&[f64::INFINITY, 1.0]), f64::INFINITY);
        assert!(norm(&[f64::NAN, 1.0]).is_nan());
    }
}
