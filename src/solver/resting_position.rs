//! The position in which a rigid body rests on the undeformed surface.

use super::{ModeCoefficients, Modes};
use crate::linalg;
use crate::parallel::Rows;

/// A rigid body at rest on an undeformed surface.
pub(crate) struct RestingPosition {
    pub(crate) motion: ModeCoefficients,
    /// The local cells that it rests on, and the share of the load that each of them carries.
    pub(crate) supports: [Option<(usize, f64)>; 3],
}

/// A column of the basis, B of a cell or of an artificial one, and its cost.
type Column = ([f64; 3], f64);

impl RestingPosition {
    /// The position in which a rigid body that is free to tilt rests on as many points of the undeformed surface as
    /// it has freedoms, with its load between them: the linear programme
    ///
    /// minimise Σ gap p   over   p ≥ 0 with force and moments in balance,
    ///
    /// whose dual is the motion. Solved by the revised simplex method on bases of three columns, begun from artificial
    /// columns that cost more than any cell. The column of a motion that is not free costs nothing, and never leaves.
    /// Translation is free.
    pub(crate) fn new(rows: &Rows, modes: &Modes<'_>, gap: &[f64], cells: impl Iterator<Item = usize> + Clone) -> Self {
        let (heights, rank) = (cells.clone().map(|k| gap[k]), rows.group().map_or(0, |group| group.rank()) as f64);
        let lowest = rows.least(heights.clone().fold(f64::INFINITY, f64::min));
        let highest = rows.greatest(heights.fold(f64::NEG_INFINITY, f64::max));
        let range = (highest - lowest).max(f64::MIN_POSITIVE);
        let artificial = 1e3 * range * rows.count(cells.clone().count()) as f64;

        // heights are taken from the lowest point
        let unit = |m: usize| std::array::from_fn(|n| f64::from(u8::from(n == m)));
        let mut basis = [0, 1, 2].map(|m| (unit(m), if modes.free()[m] { artificial } else { 0.0 }));
        let mut cell_of_column = [None; 3];
        let mut dual = ModeCoefficients::default();
        // the result is a guess, and any motion serves as one
        for _ in 0..200 {
            // y with column·y = cost for every column of the basis
            let Some(next) = solve(basis.map(|(column, _)| column), basis.map(|(_, cost)| cost)) else { break };
            dual = ModeCoefficients(next);
            let cost = |k: usize| (gap[k] - lowest) - modes.displacement(dual, k);
            let cell = cells.clone().min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
            let entering = cell.map_or([f64::INFINITY, 0.0, 0.0, 0.0, 0.0, rank], |k| {
                let [a, b, c] = modes.at(k);
                [cost(k), a, b, c, gap[k] - lowest, rank]
            });
            // the first of the cheapest cells of all ranks enters the basis
            let cheapest = |a: [f64; 6], b: [f64; 6]| if b[0].total_cmp(&a[0]).is_lt() { b } else { a };
            let [cost, a, b, c, height, of_rank] = rows.join(entering, cheapest);
            if cost >= -1e-12 * range {
                break;
            }
            let column = [a, b, c];
            // the first weight to reach zero, while the weight of the new column grows, leaves the basis
            let (Some(weights), Some(change)) = (solve_primal(&basis, modes.load()), solve_primal(&basis, column))
            else {
                break;
            };
            let ratio = |m: usize| weights[m].max(0.0) / change[m];
            let leaving = (0..3).filter(|&m| change[m] > 1e-12).min_by(|&a, &b| ratio(a).total_cmp(&ratio(b)));
            let Some(leaving) = leaving else { break };
            basis[leaving] = (column, height);
            cell_of_column[leaving] = cell.filter(|_| of_rank == rank);
        }
        dual.0[0] += lowest;
        let shares = solve_primal(&basis, modes.load());
        let support = |m: usize| Some((cell_of_column[m]?, shares?[m].max(0.0)));
        RestingPosition { motion: dual, supports: [0, 1, 2].map(support) }
    }
}

/// w with Σ w column = `right`.
fn solve_primal(basis: &[Column; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    solve([0, 1, 2].map(|m| basis.map(|(column, _)| column[m])), right)
}

/// `None` if the columns of the basis depend on each other.
fn solve(matrix: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    // modes are of order one
    let (x, rank) = linalg::solve(matrix, right, 1e-14);
    (rank == 3).then_some(x)
}
