//! The cells on which a rigid body rests before the bodies deform.

use super::contact_problem::SlidingProblem;
use crate::linalg;
use crate::parallel::Rows;
use crate::solver::{Freedom, ModeCoefficients, Modes, RigidMotion, dot};

/// Where a body rests when it is lowered and may tilt as its load leaves it free.
#[derive(Debug, Clone, Default)]
pub(super) struct Support {
    /// One cell for an upright body, two or three for one that tilts: the load point lies between them.
    pub(super) cells: Vec<usize>,
    /// The approach of the load point \[m\]: below 0 bodies of prescribed approach overlap however they tilt.
    pub(super) height: f64,
    /// The motion to it, without the approach.
    pub(super) tilt: RigidMotion,
}

/// A unit vector in place of a cell costs so many times the range of the gap.
const ARTIFICIAL: f64 = 1e6;
/// A gap below the plane by less than this part of the range is rounding.
const ROUNDING: f64 = 1e-12;
/// From this number of exchanges on the first cell below the plane enters in place of the lowest, which cannot cycle
/// (R. G. Bland, Math. Oper. Res. 2, 1977); the search ends at the second number.
const EXCHANGES: [usize; 2] = [60, 1000];

impl SlidingProblem<'_> {
    /// The lowest plane ω + α·x below the gap that is highest at the load point, and the cells that it touches: the
    /// linear program min Σ p h for p ≥ 0 with the force 1 at the load point, by the simplex method.
    pub(super) fn support(&self) -> Support {
        let modes = Modes::new(self.grid, &Rows::all(self.grid.cells()), Freedom { translation: true, ..self.free });
        let finite = || self.gap.iter().enumerate().filter(|(_, height)| height.is_finite());
        let [low, high] = [f64::min, f64::max].map(|pick| finite().map(|(_, h)| *h).reduce(pick).unwrap_or(0.0));
        let range = (high - low).max(f64::EPSILON * high.abs()).max(f64::MIN_POSITIVE);
        // heights from the lowest cell on; `None` is a unit vector
        let mut basis: [Option<usize>; 3] = [None; 3];
        let mut plane = [0.0; 3];
        let mut parts = modes.load();
        for exchange in 0..EXCHANGES[1] {
            let columns: [[f64; 3]; 3] = std::array::from_fn(|m| match basis[m] {
                Some(k) => modes.at(k),
                None => std::array::from_fn(|n| if n == m { 1.0 } else { 0.0 }),
            });
            let rows: [[f64; 3]; 3] = std::array::from_fn(|n| columns.map(|column| column[n]));
            let free = modes.free();
            let costs: [f64; 3] = std::array::from_fn(|m| match basis[m] {
                Some(k) => self.gap[k] - low,
                None if free[m] => ARTIFICIAL * range,
                None => 0.0,
            });
            (plane, _) = linalg::solve(columns, costs, 0.0);
            (parts, _) = linalg::solve(rows, modes.load(), 0.0);
            let below = |(k, height): (usize, &f64)| (height - low - dot(plane, modes.at(k)), k);
            let mut all = finite().map(below).filter(|(height, _)| *height < -ROUNDING * range);
            let next = if exchange < EXCHANGES[0] { all.min_by(|a, b| a.0.total_cmp(&b.0)) } else { all.next() };
            let Some((_, enters)) = next else { break };
            let (direction, _) = linalg::solve(rows, modes.at(enters), 0.0);
            let ratio = |m: usize| (parts[m].max(0.0) / direction[m], basis[m], m);
            let leaves = (0..3).filter(|&m| direction[m] > ROUNDING).map(ratio);
            let Some((_, _, leaves)) = leaves.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))) else { break };
            basis[leaves] = Some(enters);
        }
        let motion = modes.physical(ModeCoefficients(plane));
        let pressed = (0..3).filter(|&m| parts[m] > ROUNDING).filter_map(|m| basis[m]);
        let tilt = RigidMotion { approach: motion.approach - plane[0], tilt: motion.tilt };
        Support { cells: pressed.collect(), height: low + plane[0], tilt }
    }
}
