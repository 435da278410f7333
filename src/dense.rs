//! Dense matrices of a few dozen columns: least squares.
//!
//! Series of a creep function need no more of dense algebra than this page, while a library for it
//! takes most of a first build. `faer` is the reference of the tests, and solves the larger
//! problems of `data`.

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
        // columns may differ in size by any factor: each is measured by itself
        let mut sizes: Vec<f64> = (0..columns).map(|j| norm(self.column(j))).collect();
        let mut rank = 0;
        while rank < columns.min(rows) {
            // what is left of the columns below the rows that are reduced
            let rest = |j: usize| norm(&self.column(j)[rank..]) / sizes[j];
            let remaining = (rank..columns).filter(|&j| sizes[j] != 0.0).map(|j| (rest(j), j));
            let Some((part, pivot)) = remaining.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            // a NaN compares as above every number, and is not passed over
            if part <= f64::EPSILON {
                break;
            }
            let length = part * sizes[pivot];
            order.swap(rank, pivot);
            sizes.swap(rank, pivot);
            (0..rows).for_each(|i| self.data.swap(rank * rows + i, pivot * rows + i));
            let (reduced, others) = self.data.split_at_mut((rank + 1) * rows);
            let own = &mut reduced[rank * rows + rank..];
            // H = 1 − τ v vᵀ, v = (a − r e₀)/(a₀ − r), τ = (r − a₀)/r takes a to r e₀, r = −sign(a₀) |a|
            let diagonal = -length.copysign(own[0]);
            let first = own[0] - diagonal;
            let tau = -first / diagonal;
            own.iter_mut().for_each(|value| *value /= first);
            own[0] = 1.0;
            let reflect = |field: &mut [f64]| {
                let along = tau * product(own, field);
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

// against faer, which `data` brings
#[cfg(all(test, feature = "data"))]
mod tests;
