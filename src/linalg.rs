//! Small dense systems of linear equations.

/// Weight of entries off the diagonal in the search for a pivot: above the rounding of the smallest pivots.
const OFF_DIAGONAL_WEIGHT: f64 = 0.999;

/// Solves A x = b by Gaussian elimination with complete pivoting; returns x and the rank. Elimination ends when no
/// remaining entry exceeds `dependent`: unknowns without a pivot are zero, and equations that depend on others are
/// left out.
pub(crate) fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N], dependent: f64) -> ([f64; N], usize) {
    let (mut open_rows, mut open_columns) = ([true; N], [true; N]);
    let (mut pivots, mut rank) = ([(0, 0); N], 0);
    while rank < N {
        let (mut largest, mut pivot) = (dependent, None);
        // a symmetric positive semi-definite matrix has its largest entry on the diagonal, but for rounding, and
        // keeps it there
        let diagonal = (0..N).map(|m| (m, m));
        let others = (0..N * N).map(|m| (m / N, m % N)).filter(|(row, column)| row != column);
        for (row, column) in diagonal.chain(others).filter(|&(row, column)| open_rows[row] && open_columns[column]) {
            let entry = a[row][column].abs() * if row == column { 1.0 } else { OFF_DIAGONAL_WEIGHT };
            if entry > largest || (entry == largest && row == column && pivot.is_some()) {
                (largest, pivot) = (entry, Some((row, column)));
            }
        }
        let Some((row, column)) = pivot else { break };
        (open_rows[row], open_columns[column]) = (false, false);
        pivots[rank] = (row, column);
        rank += 1;
        let (of_pivot, right) = (a[row], b[row]);
        for other in (0..N).filter(|&other| open_rows[other]) {
            let factor = a[other][column] / of_pivot[column];
            for n in (0..N).filter(|&n| open_columns[n]) {
                a[other][n] -= factor * of_pivot[n];
            }
            b[other] -= factor * right;
        }
    }
    let mut x = [0.0; N];
    for step in (0..rank).rev() {
        let (row, column) = pivots[step];
        let known: f64 = pivots[step + 1..rank].iter().map(|&(_, later)| a[row][later] * x[later]).sum();
        x[column] = (b[row] - known) / a[row][column];
    }
    (x, rank)
}

/// Fraction of the square of a function, independent of the others, that counts as zero.
pub(crate) const DEPENDENT: f64 = 1e-11;

/// Solves the normal equations Σ w f fᵀ x = `right` of a least-squares fit of functions f, scaled to a unit diagonal.
/// The coefficient of a function is 0 if at most the fraction `dependent` of its square is independent of the others.
pub(crate) fn solve_normal_equations<const N: usize>(
    gram: &[[f64; N]; N],
    right: [f64; N],
    dependent: f64,
) -> [f64; N] {
    let scale: [f64; N] = std::array::from_fn(|m| if gram[m][m] > 0.0 { 1.0 / gram[m][m].sqrt() } else { 0.0 });
    let scaled: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| gram[i][j] * scale[i] * scale[j]));
    let (x, _) = solve(scaled, std::array::from_fn(|m| right[m] * scale[m]), dependent);
    std::array::from_fn(|m| x[m] * scale[m])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from −1 to 1, the same on every machine.
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn random_matrix<const N: usize>(state: &mut u64) -> [[f64; N]; N] {
        std::array::from_fn(|_| std::array::from_fn(|_| random(state)))
    }

    fn product<const N: usize>(a: &[[f64; N]; N], x: &[f64; N]) -> [f64; N] {
        std::array::from_fn(|row| (0..N).map(|column| a[row][column] * x[column]).sum())
    }

    /// By expansion along the first row.
    fn determinant(a: &[Vec<f64>]) -> f64 {
        let Some(first) = a.first() else { return 1.0 };
        let minor = |column: usize| -> Vec<Vec<f64>> {
            a[1..].iter().map(|row| [&row[..column], &row[column + 1..]].concat()).collect()
        };
        let sign = |column: usize| if column.is_multiple_of(2) { 1.0 } else { -1.0 };
        first.iter().enumerate().map(|(column, entry)| sign(column) * entry * determinant(&minor(column))).sum()
    }

    /// By Cramer's rule.
    fn reference<const N: usize>(a: &[[f64; N]; N], b: &[f64; N]) -> ([f64; N], f64) {
        let rows = || a.iter().map(|row| row.to_vec()).collect::<Vec<_>>();
        let whole = determinant(&rows());
        let replaced = |column: usize| {
            let mut rows = rows();
            rows.iter_mut().zip(b).for_each(|(row, b)| row[column] = *b);
            determinant(&rows) / whole
        };
        (std::array::from_fn(replaced), whole)
    }

    fn check_regular<const N: usize>() {
        let mut state = N as u64;
        for _ in 0..100 {
            let (a, b) = (random_matrix::<N>(&mut state), std::array::from_fn(|_| random(&mut state)));
            let (expected, determinant) = reference(&a, &b);
            let (x, rank) = solve(a, b, DEPENDENT);
            assert_eq!(rank, N);
            for (x, expected) in x.into_iter().zip(expected) {
                let scale = 1.0 + expected.abs();
                assert!((x - expected).abs() < 1e-12 / determinant.abs().min(1.0) * scale, "{a:?}: {x} {expected}");
            }
        }
    }

    #[test]
    fn regular_systems_are_solved_as_by_cramers_rule() {
        check_regular::<1>();
        check_regular::<2>();
        check_regular::<3>();
        check_regular::<6>();
    }

    /// A of rank r from r products of random vectors, and b = A y: the rank is found, and A x = b.
    fn check_singular<const N: usize>(symmetric: bool) {
        let mut state = 17 + N as u64;
        for round in 0..500 {
            let wanted = round % (N + 1);
            let left = random_matrix::<N>(&mut state);
            let right = if symmetric { left } else { random_matrix::<N>(&mut state) };
            let entry = |i: usize, j: usize| (0..wanted).map(|m| left[m][i] * right[m][j]).sum();
            let a: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
            let b = product(&a, &std::array::from_fn(|_| random(&mut state)));
            let (x, rank) = solve(a, b, DEPENDENT);
            assert_eq!(rank, wanted, "{a:?}");
            assert!(x.iter().filter(|x| **x == 0.0).count() >= N - wanted);
            let solutions = if symmetric { vec![x, solve_normal_equations(&a, b, DEPENDENT)] } else { vec![x] };
            for x in solutions {
                let size = 1.0 + x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                for (found, b) in product(&a, &x).into_iter().zip(b) {
                    assert!((found - b).abs() < 1e-9 * size, "{a:?}: {found} {b}");
                }
            }
        }
    }

    #[test]
    fn of_singular_systems_the_independent_part_is_solved() {
        check_singular::<3>(false);
        check_singular::<3>(true);
        check_singular::<6>(true);
    }

    #[test]
    fn scales_of_the_functions_do_not_matter() {
        let mut state = 3;
        for _ in 0..100 {
            let functions: [[f64; 3]; 3] = random_matrix(&mut state);
            let scale = [1e-120, 1.0, 1e90];
            let gram = |scale: [f64; 3]| -> [[f64; 3]; 3] {
                let entry = |i: usize, j: usize| functions.iter().map(|f| f[i] * scale[i] * f[j] * scale[j]).sum();
                std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
            };
            let (plain, scaled) = (gram([1.0; 3]), gram(scale));
            let b = [0.3, -0.7, 0.2];
            let x = solve_normal_equations(&plain, b, DEPENDENT);
            let y = solve_normal_equations(&scaled, [0, 1, 2].map(|m| b[m] * scale[m]), DEPENDENT);
            for m in 0..3 {
                assert!((y[m] * scale[m] - x[m]).abs() <= 1e-6 * x[m].abs().max(1.0), "{x:?} {y:?}");
            }
        }
    }
}
