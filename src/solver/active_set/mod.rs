//! The default solver: an active set of cells in contact, and preconditioned conjugate gradients on it.
//!
//! On the set A of cells in contact the problem is linear: r = −(c v + gap − motion) = 0, with the free
//! motion of each body fitted by least squares, and force and moments fixed. One iteration is
//!
//! z = P Eᵀ M E P r,  d = z + β d,  p += a d,  v += a K d
//!
//! with M ≈ K⁻¹ on residuals that E extends beyond A ([`Preconditioner`]), P the restriction to A less the free
//! motions, β from conjugacy z·Kd + β d·Kd = 0 (which remains exact when cells join A) and a the exact minimum along
//! d.
//!
//! An iteration costs one convolution, whatever happens to A:
//!
//! * Cells that penetrate join with p = 0, which changes no field. They do so when the penetration is large compared
//!   with the residual ([`Rules`]).
//! * Cells whose pressure is negative leave when their error is large compared with the residual. The *next*
//!   direction brings them to p = 0: it contains δ = −p on them, so that the convolution it needs anyway updates v. Its
//!   length is then 1, and z enters it with the usual length. Eᵀ moves their pressure to the cells around, which keeps
//!   the force. Cells whose pressure becomes negative by the move leave with them.
//! * Where the force is out of balance, p and v are scaled together. With moments to balance, or several bodies, the
//!   correction B y times a shape differs from cell to cell, and joins the next direction too.
//! * A guess extrapolated from earlier steps comes with its own v.
//! * Where the cells that remain cannot carry the load, the last step is cut where its first pressure vanished.
//!
//! docs/maintainers/measurements.md gives the gain of these rules.

mod balance;
mod fallback;
mod iteration;
mod membership;

use crate::kernel::{LocalKernel, Workspace};
use crate::solver::{Bands, ContactSet, ModeCoefficients, Outcome, PENETRATION_SLACK, Preconditioner, Search, Solve};
use crate::sum::greatest;

/// When A changes, and when the search for it ends.
struct Rules {
    /// Cells join A when the deepest penetration exceeds this many times rms |r|. It must be below the
    /// [slack](PENETRATION_SLACK) of penetration, or a state could neither improve nor converge.
    join_over_rms: f64,
    /// Cells leave A when rms (c p⁻/m), the gap equivalent to their negative pressure, exceeds this part of rms |r|.
    leave_over_rms: f64,
    /// c a of a direction that corrects the pressure and has no line search, unless the last search was shorter.
    correction_length: f64,
    /// Pressures that leave are moved to the cells around. Pressures that carry more than this part of the force are
    /// dropped instead: the contact is another one.
    moved_share: f64,
    /// So often cells may join without a gain: then the rest is rounding. So many iterations may pass without a new
    /// lowest residual before a search comes between corrections.
    tries_without_gain: usize,
    /// Iterations without a new lowest residual after which the fall-back takes over.
    iterations_without_gain: usize,
}

const RULES: Rules = Rules {
    join_over_rms: 0.2 * PENETRATION_SLACK,
    leave_over_rms: 0.1,
    correction_length: 0.9,
    moved_share: 0.1,
    tries_without_gain: 3,
    iterations_without_gain: 40,
};

#[derive(Debug, Clone)]
pub(crate) struct ActiveSet {
    preconditioner: Preconditioner,
    /// The active set A.
    set: ContactSet,
    bands: Bands,
    /// Rounding of c K p of the guess: where an approach is given, the pressure may fall far below the pressure of
    /// the guess.
    guess_rounding: f64,
    changes: PendingChanges,
    /// Whether the last step was cut short: cells that joined together may have held each other off, and the deepest
    /// one joins alone.
    was_cut: bool,
    search: Search,
    /// d·Kd; 0 if the next direction need not be conjugate to d.
    energy: f64,
    /// c a of the last search of this solve.
    search_length: f64,
    /// The fit of K d on A under each body that tilts.
    image_motions: Vec<ModeCoefficients>,
    /// The free motion of each body that is added to d.
    shifts: Vec<ModeCoefficients>,
    /// A field that a method fills and reads under a name of its own: z, moved pressures and so on. Its values do not
    /// outlive the method.
    buffer: Vec<f64>,
    /// The shape s of corrections of the balance, in the fall-back a second buffer: allocated by the first solve with
    /// a tilting load, several bodies or the fall-back.
    shape: Vec<f64>,
}

/// Changes of the pressure that the next direction makes.
#[derive(Debug, Clone)]
struct PendingChanges {
    /// Whether cells outside A carry pressure, which it brings to zero.
    leaving: bool,
    /// Whether it moves that pressure to the cells around.
    moves: bool,
    /// For each body the y of the change shape · B y that balances the pressure, where the pressure is out of balance.
    corrections: Vec<Option<ModeCoefficients>>,
}

impl PendingChanges {
    fn any(&self) -> bool {
        self.leaving || self.corrections.iter().any(Option::is_some)
    }

    fn clear(&mut self) {
        (self.leaving, self.moves) = (false, false);
        self.corrections.fill(None);
    }
}

/// The shape of a correction of the balance.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// The pressure itself: right for a load that changes as a whole.
    Pressure,
    /// Eᵀ 1, which is greater at the edge of A, like the pressure under a flat punch: nearly all of its displacement
    /// is rigid.
    Punch,
}

impl ActiveSet {
    /// A solver that works in the buffers of the kernel.
    pub(crate) fn new(kernel: &LocalKernel, bodies: usize, work: &mut Workspace) -> ActiveSet {
        let cells = kernel.grid().len();
        let motions = vec![ModeCoefficients::default(); bodies];
        ActiveSet {
            preconditioner: Preconditioner::new(kernel, work),
            set: ContactSet::new(cells, bodies),
            bands: Bands::new(kernel.rows(), bodies),
            guess_rounding: 0.0,
            was_cut: false,
            changes: PendingChanges { leaving: false, moves: false, corrections: vec![None; bodies] },
            search: Search::new(cells),
            energy: 0.0,
            search_length: f64::INFINITY,
            image_motions: motions.clone(),
            shifts: motions,
            buffer: vec![0.0; cells],
            shape: Vec::new(),
        }
    }

    /// Improves `solution` until its residual is below the tolerance or the iterations are spent. On
    /// entry `solution.potential` is K p of the guess, whose pressure may be negative on some cells; a body
    /// without any positive pressure gets a cold start.
    pub(crate) fn solve(&mut self, solve: &mut Solve<'_>) -> Outcome {
        let problem = solve.problem;
        let given = problem.bodies.iter().any(|freedom| !freedom.translation);
        let most = if given { problem.rows().greatest(greatest(&solve.solution.potential)) } else { 0.0 };
        self.guess_rounding = 4.0 * f64::EPSILON * problem.compliance * most;
        let outcome = match self.iterate(solve) {
            Ok(Outcome::Stagnated) => self.descend(solve),
            outcome => outcome,
        };
        if outcome != Ok(Outcome::Converged) || self.close_balance(solve) {
            return outcome.unwrap_or_else(Outcome::Unbalanced);
        }
        // the converged pressure does not carry the loads
        match self.descend(solve) {
            Ok(Outcome::Converged) if !self.close_balance(solve) => Outcome::Stagnated,
            outcome => outcome.unwrap_or_else(Outcome::Unbalanced),
        }
    }
}
