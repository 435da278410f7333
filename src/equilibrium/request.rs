//! What an elastic contact is asked for, and the trial that answers it.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::equilibrium::{Indenter, Region};
use crate::load::{Load, Tilt};
use crate::solver::{Freedom, ModeCoefficients, RigidMotion, Solution};

/// Loads on rigid bodies, to be balanced.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Request<'a> {
    /// The time, and the length of the step that ends there, for errors to tell.
    pub(crate) time: f64,
    pub(crate) length: f64,
    /// The load of each body.
    pub(crate) loads: &'a [Load],
    pub(crate) indenter: &'a Arc<Indenter>,
    /// Tolerance of the solver.
    pub(crate) tolerance: f64,
    /// Set by another thread to end the search.
    pub(crate) cancelled: Option<&'a AtomicBool>,
}

impl Request<'_> {
    /// The part of a body's motion that its load prescribes; zero for free components. The approach counts from the
    /// datum of the gap.
    pub(crate) fn prescribed(&self, body: usize) -> RigidMotion {
        let (load, datum) = (&self.loads[body], self.indenter.gap().datum);
        let approach = match load {
            Load::Approach { approach, .. } => approach - datum,
            Load::Force { .. } | Load::Spring { .. } => 0.0,
        };
        let tilt = load.tilt().map(|tilt| if let Tilt::Fixed(angle) = tilt { angle } else { 0.0 });
        RigidMotion { approach, tilt }
    }
}

/// The last force tried of a body that a spring drives.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TriedSpring {
    pub(crate) force: f64,
    /// By how much the body lies deeper than the spring under this force lets it \[m\].
    pub(crate) excess: f64,
    /// By how much the force is to change yet \[N\].
    pub(crate) missing: f64,
    /// The motion in which a body that tilts freely hangs on its spring without contact.
    pub(crate) hanging: Option<ModeCoefficients>,
}

/// Everything that is computed before it is accepted, except the displacement. Dropped when the solution fails.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// A guess, then the solution.
    pub(crate) solution: Solution,
    /// The gap before any pressure and free motion.
    pub(crate) gap: Vec<f64>,
    /// Free motions of each body.
    pub(crate) free: Vec<Freedom>,
    pub(crate) springs: Vec<TriedSpring>,
    /// Length of the extrapolation of the guess, in last steps.
    pub(crate) reach: f64,
    /// Cells that are likely to be in contact, and whether they were predicted.
    pub(crate) likely: Vec<bool>,
    pub(crate) predicted: bool,
}

impl Trial {
    /// Two fields of the solution, the gap, and a mark.
    pub(crate) const BYTES_PER_CELL: usize = 8 + 8 + 8 + 1;

    pub(crate) const NOTHING_FREE: Freedom =
        Freedom { translation: false, tilt: [false; 2], point: [0.0; 2], total: 0.0 };

    pub(crate) fn new(cells: usize, bodies: usize) -> Trial {
        Trial {
            solution: Solution::zero(cells, bodies),
            gap: vec![0.0; cells],
            free: vec![Trial::NOTHING_FREE; bodies],
            springs: vec![TriedSpring::default(); bodies],
            reach: 0.0,
            likely: vec![false; cells],
            predicted: false,
        }
    }

    /// The motion of a body at the end, from the datum of the gap.
    pub(crate) fn motion(&self, region: &Region, request: Request<'_>, body: usize) -> RigidMotion {
        request.prescribed(body) + region.modes(self.free[body]).physical(self.solution.motions[body])
    }
}
