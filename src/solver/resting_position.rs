//! Where a body comes to rest on the undeformed surface.

use crate::linalg;
use crate::parallel::Rows;
use crate::solver::rigid_motion::{ModeCoefficients, Modes};

/// Pivots after which the search ends: its result is a guess, and any motion serves as one.
const MAX_PIVOTS: usize = 200;

/// Pivots of the elimination, of modes of order one, that count as zero.
const DEPENDENT_PIVOT: f64 = 1e-14;

/// A rigid body at rest on an undeformed surface.
pub(crate) struct RestingPosition {
    pub(crate) motion: ModeCoefficients,
    /// The own cells that it rests on, and the share of the load that each of them carries.
    pub(crate) supports: [Option<(usize, f64)>; 3],
}

/// The cell whose column enters the basis.
#[derive(Clone, Copy)]
struct Entering {
    cost: f64,
    column: [f64; 3],
    /// Above the lowest point.
    height: f64,
    /// `None` if another rank has it.
    cell: Option<usize>,
}

impl Entering {
    const NOTHING: Entering = Entering { cost: f64::INFINITY, column: [0.0; 3], height: 0.0, cell: None };

    /// The first of the cheapest on all ranks.
    fn of_all_ranks(self, rows: &Rows) -> Entering {
        let Some(group) = rows.group() else { return self };
        let [a, b, c] = self.column;
        let cheapest = |a: [f64; 6], b: [f64; 6]| if b[0].total_cmp(&a[0]).is_lt() { b } else { a };
        let [cost, a, b, c, height, rank] = rows.join([self.cost, a, b, c, self.height, group.rank() as f64], cheapest);
        Entering { cost, column: [a, b, c], height, cell: self.cell.filter(|_| rank == group.rank() as f64) }
    }
}

/// A column of the basis, B of a cell or of an artificial one, and its cost.
type Column = ([f64; 3], f64);

impl RestingPosition {
    /// The position in which a rigid body that is free to tilt rests on as many points of the undeformed surface as it has
    /// freedoms, with its load between them: the linear programme
    ///
    /// minimise Σ gap p   over   p ≥ 0 with force and moments in balance,
    ///
    /// whose dual is the motion. Solved by the revised simplex method on bases of three columns, begun from artificial
    /// columns that cost more than any cell. The column of a motion that is not free costs nothing, and never leaves.
    pub(crate) fn new(
        rows: &Rows,
        modes: &Modes<'_>,
        cells: impl Iterator<Item = usize> + Clone,
        gap: &[f64],
    ) -> RestingPosition {
        let heights = || cells.clone().map(|k| gap[k]);
        let lowest = rows.least(heights().fold(f64::INFINITY, f64::min));
        let highest = rows.greatest(heights().fold(f64::NEG_INFINITY, f64::max));
        let range = (highest - lowest).max(f64::MIN_POSITIVE);
        let artificial = 1e3 * range * rows.count(cells.clone().count()) as f64;

        // heights are taken from the lowest point
        let mut basis = [0, 1, 2].map(|m| (unit(m), if modes.free()[m] { artificial } else { 0.0 }));
        let mut cell_of_column = [None; 3];
        let mut dual = ModeCoefficients::default();
        for _ in 0..MAX_PIVOTS {
            let Some(next) = solve_dual(&basis) else { break };
            dual = ModeCoefficients(next);
            let cost = |k: usize| (gap[k] - lowest) - modes.displacement(dual, k);
            let entering = cells.clone().min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
            let entering = match entering {
                Some(k) => Entering { cost: cost(k), column: modes.at(k), height: gap[k] - lowest, cell: Some(k) },
                None => Entering::NOTHING,
            };
            let entering = entering.of_all_ranks(rows);
            if entering.cost >= -1e-12 * range {
                break;
            }
            let column = entering.column;
            // the first weight to reach zero, while the weight of the new column grows, leaves the basis
            let (Some(weights), Some(change)) = (solve_primal(&basis, modes.load()), solve_primal(&basis, column))
            else {
                break;
            };
            let ratio = |m: usize| weights[m].max(0.0) / change[m];
            let leaving = (0..3).filter(|&m| change[m] > 1e-12).min_by(|&a, &b| ratio(a).total_cmp(&ratio(b)));
            let Some(leaving) = leaving else { break };
            basis[leaving] = (column, entering.height);
            cell_of_column[leaving] = entering.cell;
        }
        if modes.translates() {
            dual.0[0] += lowest;
        }
        let shares = solve_primal(&basis, modes.load());
        let support = |m: usize| Some((cell_of_column[m]?, shares?[m].max(0.0)));
        RestingPosition { motion: dual, supports: [0, 1, 2].map(support) }
    }
}

fn unit(m: usize) -> [f64; 3] {
    let mut vector = [0.0; 3];
    vector[m] = 1.0;
    vector
}

/// y with column·y = cost for every column of the basis.
fn solve_dual(basis: &[Column; 3]) -> Option<[f64; 3]> {
    solve(basis.map(|(column, _)| column), basis.map(|(_, cost)| cost))
}

/// w with Σ w column = `right`.
fn solve_primal(basis: &[Column; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    solve([0, 1, 2].map(|m| basis.map(|(column, _)| column[m])), right)
}

/// `None` if the columns of the basis depend on each other.
fn solve(matrix: [[f64; 3]; 3], right: [f64; 3]) -> Option<[f64; 3]> {
    let (x, rank) = linalg::solve(matrix, right, DEPENDENT_PIVOT);
    (rank == 3).then_some(x)
}
