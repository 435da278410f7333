//! Where a body comes to rest on the undeformed surface.

use crate::solver::rigid_motion::{ModeCoefficients, Modes};

/// Pivots after which the search is given up: its result is a guess, and any motion is one.
const PIVOTS: usize = 200;

/// The motion in which a rigid body that is free to tilt rests on as many points of the undeformed
/// surface as it has freedoms, with its load between them: the linear programme
///
/// minimise Σ gap p   over   p ≥ 0 with force and moments in balance,
///
/// whose dual is the motion. Solved by the revised simplex method on bases of three columns at most, begun
/// from artificial columns that cost more than any cell.
///
/// Returned with the cells it rests on and the share of the load that each of them carries.
pub(crate) fn rest(modes: &Modes<'_>, cells: &[u32], gap: &[f64]) -> (ModeCoefficients, Vec<(u32, f64)>) {
    let rows: Vec<usize> = modes.free().into_iter().enumerate().filter(|(_, free)| *free).map(|(m, _)| m).collect();
    let heights = || cells.iter().map(|&k| gap[k as usize]);
    let lowest = heights().fold(f64::INFINITY, f64::min);
    let highest = heights().fold(f64::NEG_INFINITY, f64::max);
    let range = (highest - lowest).max(f64::MIN_POSITIVE);
    let artificial = 1e3 * range * cells.len() as f64;

    // columns of the basis and their cost, heights taken from the lowest point
    let mut basis: Vec<([f64; 3], f64)> = rows.iter().map(|&m| (unit(m), artificial)).collect();
    let mut supports: Vec<Option<u32>> = vec![None; rows.len()];
    let mut dual = ModeCoefficients::default();
    for _ in 0..PIVOTS {
        let Some(next) = solve_dual(&rows, &basis) else { break };
        dual = ModeCoefficients(next);
        let cost = |k: u32| (gap[k as usize] - lowest) - modes.displacement(dual, k as usize);
        let entering = cells.iter().copied().min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        let Some(entering) = entering.filter(|&k| cost(k) < -1e-12 * range) else { break };
        let column = modes.at(entering as usize);
        // how the basis makes way for the new column: the first weight to reach zero leaves
        let (Some(weights), Some(change)) =
            (solve_primal(&rows, &basis, modes.load()), solve_primal(&rows, &basis, column))
        else {
            break;
        };
        let ratio = |m: usize| weights[m].max(0.0) / change[m];
        let leaving = (0..rows.len()).filter(|&m| change[m] > 1e-12).min_by(|&a, &b| ratio(a).total_cmp(&ratio(b)));
        let Some(leaving) = leaving else { break };
        basis[leaving] = (column, gap[entering as usize] - lowest);
        supports[leaving] = Some(entering);
    }
    if modes.free()[0] {
        dual.0[0] += lowest;
    }
    let shares = solve_primal(&rows, &basis, modes.load()).unwrap_or_default();
    let carried = supports.iter().zip(shares).filter_map(|(cell, share)| Some(((*cell)?, share.max(0.0))));
    (dual, carried.collect())
}

fn unit(m: usize) -> [f64; 3] {
    let mut vector = [0.0; 3];
    vector[m] = 1.0;
    vector
}

/// y with column·y = cost for every column of the basis.
fn solve_dual(rows: &[usize], basis: &[([f64; 3], f64)]) -> Option<[f64; 3]> {
    let matrix: Vec<Vec<f64>> = basis.iter().map(|(column, _)| rows.iter().map(|&m| column[m]).collect()).collect();
    let solution = solve(matrix, basis.iter().map(|(_, cost)| *cost).collect())?;
    let mut dual = [0.0; 3];
    rows.iter().zip(solution).for_each(|(&m, y)| dual[m] = y);
    Some(dual)
}

/// w with Σ w column = `right`.
fn solve_primal(rows: &[usize], basis: &[([f64; 3], f64)], right: [f64; 3]) -> Option<Vec<f64>> {
    let matrix = rows.iter().map(|&m| basis.iter().map(|(column, _)| column[m]).collect()).collect();
    solve(matrix, rows.iter().map(|&m| right[m]).collect())
}

/// Gaussian elimination with row pivoting, for three unknowns at most.
fn solve(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = right.len();
    for column in 0..n {
        let pivot = (column..n).max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))?;
        if matrix[pivot][column].abs() < 1e-14 {
            return None;
        }
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let (above, below) = matrix.split_at_mut(column + 1);
        for (row, b) in below.iter_mut().zip(column + 1..n) {
            let factor = row[column] / above[column][column];
            row.iter_mut().zip(&above[column]).for_each(|(entry, pivot)| *entry -= factor * pivot);
            right[b] -= factor * right[column];
        }
    }
    for column in (0..n).rev() {
        let known: f64 = (column + 1..n).map(|m| matrix[column][m] * right[m]).sum();
        right[column] = (right[column] - known) / matrix[column][column];
    }
    Some(right)
}
