//! The request for a step, and the trial that the step computes.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contact::Indenter;
use crate::contact::step::attraction::Attracted;
use crate::hereditary::Interval;
use crate::load::{Load, Tilt};
use crate::solver::{Freedom, ModeCoefficients, RigidMotion, Solution};

/// A step to be tried.
#[derive(Debug, Clone)]
pub(crate) struct Step<'a> {
    pub(crate) interval: Interval,
    /// The load of each body at its end.
    pub(crate) loads: &'a [Load],
    /// The indenter at its end.
    pub(crate) indenter: Arc<Indenter>,
    /// Tolerance of the solver.
    pub(crate) tolerance: f64,
    /// The end of a step of surfaces that attract each other, where it is known: nothing is solved.
    pub(crate) end: Option<&'a Solution>,
    /// Set by another thread to end the step.
    pub(crate) cancelled: Option<&'a AtomicBool>,
}

impl Step<'_> {
    /// The part of a body's motion that its load prescribes; zero for free components. The approach counts from the datum of
    /// the gap.
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
    pub(super) force: f64,
    /// By how much the body lies deeper than the spring under this force lets it \[m\].
    pub(super) excess: f64,
    /// By how much the force is to change yet \[N\].
    pub(super) missing: f64,
    /// The motion in which a body that tilts freely hangs on its spring without contact.
    pub(super) hanging: Option<ModeCoefficients>,
}

/// Everything that a step computes before it is accepted, except the displacement: the history holds the displacement at
/// both ends of a step. Dropped when the step fails.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// A guess, then the solution.
    pub(crate) solution: Solution,
    /// The gap before any pressure and free motion.
    pub(crate) gap: Vec<f64>,
    /// Free motions of each body.
    pub(crate) free: Vec<Freedom>,
    pub(crate) springs: Vec<TriedSpring>,
    /// What the passes of a step work in, from the first step of surfaces that attract each other.
    pub(crate) passes: Option<Box<Attracted>>,
    /// Length of the extrapolation of the guess, in last steps.
    pub(crate) reach: f64,
    /// Cells that are likely to be in contact, and whether they were predicted.
    pub(crate) likely: Vec<bool>,
    pub(crate) predicted: bool,
}

impl Trial {
    /// Two fields of the solution, the gap, and a mark.
    pub(crate) const BYTES_PER_CELL: usize = 8 + 8 + 8 + 1;

    pub(crate) fn new(cells: usize, bodies: usize) -> Trial {
        let nothing_free = Freedom { translation: false, tilt: [false; 2], point: [0.0; 2], total: 0.0 };
        Trial {
            solution: Solution::zero(cells, bodies),
            gap: vec![0.0; cells],
            free: vec![nothing_free; bodies],
            springs: vec![TriedSpring::default(); bodies],
            passes: None,
            reach: 0.0,
            likely: vec![false; cells],
            predicted: false,
        }
    }
}
