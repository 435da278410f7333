//! The step being tried.

use crate::solver::{Freedom, Solution};

/// Everything that a step computes before it is accepted, but for the displacement, which the history holds
/// at both ends of a step. Dropped when the step fails.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// A guess, then the solution.
    pub(in crate::contact) solution: Solution,
    /// The gap before any pressure and free motion.
    pub(in crate::contact) gap: Vec<f64>,
    /// What the loads leave free of each body.
    pub(in crate::contact) free: Vec<Freedom>,
    /// How many times the last step the guess reaches ahead.
    pub(in crate::contact) reach: f64,
    /// Cells that are likely to be in contact, and whether that is known.
    pub(in crate::contact) likely: Vec<bool>,
    pub(in crate::contact) foreseen: bool,
}

impl Trial {
    pub(in crate::contact) fn new(cells: usize, bodies: usize) -> Trial {
        let nothing_free = Freedom { translation: false, tilt: [false; 2], point: [0.0; 2], total: 0.0 };
        Trial {
            solution: Solution::zero(cells, bodies),
            gap: vec![0.0; cells],
            free: vec![nothing_free; bodies],
            reach: 0.0,
            likely: vec![false; cells],
            foreseen: false,
        }
    }
}
