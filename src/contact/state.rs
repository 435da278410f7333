//! What a step changes.

use std::sync::Arc;

use crate::contact::extrapolation::Extrapolation;
use crate::contact::indenter::Indenter;
use crate::contact::window::region::Region;
use crate::hereditary::{History, Interval, MAX_GROWTH};
use crate::load::Load;
use crate::solver::{RigidMotion, Solution};

/// The state of a contact between two steps. A clone of it is a snapshot, its bytes are a checkpoint, and a step that is
/// tried on a larger region changes a copy.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    pub(super) clock: Clock,
    pub(super) loads: Vec<Load>,
    #[cfg_attr(feature = "checkpoint", serde(with = "crate::contact::indenter::saved"))]
    pub(super) indenter: Arc<Indenter>,
    /// Whether the indenter has been replaced since the last step.
    pub(super) indenter_is_new: bool,
    /// The part of the grid that is computed: every field lives there, except for the gap of the indenter.
    pub(super) region: Region,
    /// Whether the region was chosen for a contact, rather than for bodies apart.
    pub(super) region_is_placed: bool,
    /// Displacement and past of the bodies.
    pub(super) history: History,
    pub(super) current: Equilibrium,
    /// At the start of the last step.
    pub(super) previous: Equilibrium,
    /// At the start of the step before the last, where the last one follows the polynomial through it.
    pub(super) earlier: Option<Node>,
    /// Whether the last step tells how the next goes on: not after a jump, a corner or a step over the bodies, nor with a new
    /// indenter.
    pub(super) goes_on: bool,
    pub(super) extrapolation: Extrapolation,
    /// The greatest means of displacement and v over the contact so far, as far as errors were taken relative to them.
    pub(super) greatest: [f64; 2],
}

#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Clock {
    pub(super) time: f64,
    /// Length of the last step.
    pub(super) last_length: f64,
    /// Time as it passes for the material; without a history of the temperature, the time.
    pub(super) reduced_time: f64,
    /// Length of the last step in reduced time.
    pub(super) last_dt: f64,
    /// The reduced time until which the bodies were undisturbed.
    pub(super) undisturbed_until: f64,
}

impl Clock {
    /// After a step; `touched` tells whether anything has ever been displaced.
    pub(super) fn accept(&mut self, step: Interval, touched: bool) {
        (self.time, self.last_length) = (step.time, step.length);
        (self.reduced_time, self.last_dt) = (step.reduced, step.dt);
        if !touched {
            self.undisturbed_until = step.reduced;
        }
    }

    /// How long the bodies have been disturbed, in reduced time.
    pub(super) fn age(&self) -> f64 {
        self.reduced_time - self.undisturbed_until
    }
}

/// Pressure and motions in equilibrium with the loads.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Equilibrium {
    pub(super) solution: Solution,
    /// Motion of each body, prescribed and free parts together.
    pub(super) motions: Vec<RigidMotion>,
    /// Cells in contact on the whole grid.
    pub(super) contact_cells: usize,
    /// Σ p over the cells that are computed, of all ranks.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) sum: f64,
}

/// What is kept of the start of the step before the last.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Node {
    /// Length of the step before the last.
    pub(super) dt: f64,
    /// Motion of the first body.
    pub(super) motion: RigidMotion,
    /// Normal force on all bodies together.
    pub(super) force: f64,
}

#[cfg(feature = "checkpoint")]
impl Node {
    /// Whether it can be followed by a step: a file may hold anything.
    pub(super) fn is_sound(&self) -> bool {
        let Node { dt, motion: RigidMotion { approach, tilt: [tilt1, tilt2] }, force } = *self;
        dt > 0.0 && [dt, approach, tilt1, tilt2, force].iter().all(|value| value.is_finite())
    }
}

impl State {
    /// Bodies without load, where they just touch.
    pub(super) fn at_rest(indenter: Arc<Indenter>, region: Region, history: History) -> State {
        let motions = indenter.first_touch();
        let bodies = motions.len();
        let current =
            Equilibrium { solution: Solution::zero(region.len(), bodies), motions, contact_cells: 0, sum: 0.0 };
        State {
            clock: Clock::default(),
            loads: vec![Load::force(0.0); bodies],
            indenter,
            indenter_is_new: false,
            region,
            region_is_placed: false,
            history,
            previous: current.clone(),
            current,
            earlier: None,
            goes_on: false,
            extrapolation: Extrapolation::default(),
            greatest: [0.0; 2],
        }
    }

    /// Normal force on all bodies together \[N\].
    pub(super) fn force_of(&self, equilibrium: &Equilibrium) -> f64 {
        equilibrium.sum * self.region.grid().cell_area() * self.region.images() as f64
    }

    /// Finds the sums that are not saved.
    #[cfg(feature = "checkpoint")]
    pub(super) fn sum_up(&mut self) {
        let rows = self.region.rows();
        for equilibrium in [&mut self.current, &mut self.previous] {
            equilibrium.sum = rows.sum(&equilibrium.solution.pressure);
        }
    }

    /// The last step says nothing about how the state goes on, as at a corner of the load.
    pub(super) fn forget_slopes(&mut self) {
        self.history.forget_slopes();
        self.goes_on = false;
    }

    /// Keeps the start of the last step where the `next`, which the history has just committed, follows a quadratic through it.
    pub(super) fn keep_earlier(&mut self, next: Interval) {
        let (Equilibrium { motions, .. }, dt) = (&self.previous, self.clock.last_dt);
        let follows = self.goes_on && next.dt <= MAX_GROWTH * dt && self.history.followed_quadratic(next);
        self.earlier = follows.then(|| Node { dt, motion: motions[0], force: self.force_of(&self.previous) });
        self.goes_on = next.dt > 0.0 && next.stride == [0; 2];
    }

    /// Whether no pressure has ever acted.
    pub(super) fn is_undisturbed(&self) -> bool {
        self.clock.age() == 0.0 && self.current.contact_cells == 0
    }

    /// Copies another without reallocating where the regions are the same and no direct sum grows.
    pub(super) fn copy_from(&mut self, other: &State) {
        if self.region != other.region {
            *self = other.clone();
            return;
        }
        // all are named, so that none that is added can be forgotten
        let State {
            clock,
            loads,
            indenter,
            indenter_is_new,
            region: _,
            region_is_placed,
            history,
            current,
            previous,
            earlier,
            goes_on,
            extrapolation,
            greatest,
        } = self;
        (*clock, *extrapolation) = (other.clock, other.extrapolation);
        (*earlier, *goes_on, *greatest) = (other.earlier, other.goes_on, other.greatest);
        (*indenter_is_new, *region_is_placed) = (other.indenter_is_new, other.region_is_placed);
        loads.clone_from(&other.loads);
        indenter.clone_from(&other.indenter);
        history.copy_from(&other.history);
        current.copy_from(&other.current);
        previous.copy_from(&other.previous);
    }
}

impl Equilibrium {
    fn copy_from(&mut self, other: &Equilibrium) {
        self.solution.copy_from(&other.solution);
        self.motions.clone_from(&other.motions);
        (self.contact_cells, self.sum) = (other.contact_cells, other.sum);
    }
}
