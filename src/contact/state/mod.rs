//! What a step changes.

pub(crate) mod snapshot;

use std::sync::Arc;

use crate::equilibrium::held::net_sum;
use crate::equilibrium::{Equilibrium, Held, Indenter, Region};
use crate::hereditary::{Field, History, Interpolant, Interval};
use crate::load::Load;

/// The state of a contact between two steps. A clone of it is a snapshot, its bytes are a checkpoint, and a step that
/// is tried on a larger region changes a copy.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    pub(crate) held: Held,
    pub(crate) clock: Clock,
    /// Whether the indenter has been replaced since the last step.
    pub(crate) indenter_is_new: bool,
    /// Displacement and past of the bodies.
    pub(crate) history: History,
    /// Whether the surfaces attract each other.
    pub(crate) attracts: bool,
    /// At the start of the last step.
    pub(crate) previous: Equilibrium,
    pub(crate) start: StepStart,
    /// The maximum means of displacement and v over the contact so far: errors of smaller ones are relative to parts
    /// of these.
    pub(crate) greatest: [f64; 2],
}

clone_by_fields! { State { held, clock, indenter_is_new, history, attracts, previous, start, greatest } }

#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Clock {
    pub(crate) time: f64,
    /// Length of the last step.
    pub(crate) last_length: f64,
    /// Time as it passes for the material; without a history of the temperature, the time.
    pub(crate) reduced_time: f64,
    /// Length of the last step in reduced time.
    pub(crate) last_dt: f64,
    /// The reduced time until which the bodies were undisturbed.
    pub(crate) undisturbed_until: f64,
}

impl Clock {
    /// After a step; `touched` is true if anything has ever been displaced.
    pub(crate) fn accept(&mut self, step: Interval, touched: bool) {
        (self.time, self.last_length) = (step.time, step.length);
        (self.reduced_time, self.last_dt) = (step.reduced, step.dt);
        if !touched {
            self.undisturbed_until = step.reduced;
        }
    }

    /// How long the bodies have been disturbed, in reduced time.
    pub(crate) fn age(&self) -> f64 {
        self.reduced_time - self.undisturbed_until
    }
}

/// The start of the last step, besides `previous` and the fields that the history keeps.
#[derive(Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct StepStart {
    pub(crate) clock: Clock,
    pub(crate) loads: Vec<Load>,
    /// How the last step took the displacement to change.
    pub(crate) interpolant: Interpolant,
    /// Whether the indenter of the last step was set just before it.
    pub(crate) indenter_was_new: bool,
    /// The indenter of the last step, where it has been replaced since.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(crate) replaced: Option<Arc<Indenter>>,
}

clone_by_fields! { StepStart { clock, loads, interpolant, indenter_was_new, replaced } }

impl State {
    /// Bodies without load, where they just touch, by the time rule of a history; without values.
    pub(crate) fn layout(indenter: Arc<Indenter>, region: Region, history: &History, attracts: bool) -> State {
        let held = Held::layout(indenter, region);
        State {
            clock: Clock::default(),
            start: StepStart { loads: held.loads.clone(), ..StepStart::default() },
            indenter_is_new: false,
            history: history.layout(!held.region.covers()),
            attracts,
            previous: held.current.clone(),
            held,
            greatest: [0.0; 2],
        }
    }

    /// Bodies without load, where they just touch, by the time rule of a history.
    pub(crate) fn at_rest(indenter: Arc<Indenter>, region: Region, history: &History, attracts: bool) -> State {
        let cells = region.len();
        State::layout(indenter, region.clone(), history, attracts)
            .map(&region, &mut |field| vec![0.0; cells * field.per_cell])
    }

    /// How many values the state has for each cell.
    pub(crate) fn values_per_cell(&self) -> usize {
        let mut values = 0;
        self.each(&mut |field| values += field.per_cell);
        values
    }

    /// A copy on `region`; `map` gives its fields, one for each field here. Its sums are to be found anew.
    pub(crate) fn map(&self, region: &Region, map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> State {
        State {
            held: self.held.map(region, self.attracts, map),
            previous: self.previous.map(self.attracts, map),
            history: self.history.map(region.cells(), !region.covers(), map),
            start: self.start.clone(),
            ..*self
        }
    }

    /// Visits all fields.
    pub(crate) fn each(&self, visit: &mut impl FnMut(Field<'_>)) {
        self.map(&self.held.region, &mut |field| {
            visit(field);
            Vec::new()
        });
    }

    /// Finds the sums that neither transfer nor file has.
    pub(crate) fn sum_up(&mut self) {
        let rows = self.held.region.rows();
        for equilibrium in [&mut self.held.current, &mut self.previous] {
            equilibrium.sum = net_sum(&rows, &equilibrium.solution);
        }
    }

    /// Keeps the start of a step that is accepted with this state still that before it.
    pub(crate) fn keep_start(&mut self, interpolant: Interpolant) {
        let StepStart { clock, loads, interpolant: kept, indenter_was_new, replaced } = &mut self.start;
        (*clock, *kept, *indenter_was_new, *replaced) = (self.clock, interpolant, self.indenter_is_new, None);
        loads.copy_from_slice(&self.held.loads);
    }

    /// Returns to the start of the last step, which the history must still keep.
    pub(crate) fn roll_back(&mut self) {
        self.history.roll_back();
        self.held.current.clone_from(&self.previous);
        self.clock = self.start.clock;
        self.held.loads.copy_from_slice(&self.start.loads);
        if let Some(replaced) = self.start.replaced.take() {
            self.held.indenter = replaced;
        }
        self.indenter_is_new = self.start.indenter_was_new;
        self.held.extrapolation.interrupt();
    }

    /// Whether no pressure has ever acted.
    pub(crate) fn is_undisturbed(&self) -> bool {
        self.clock.age() == 0.0 && self.held.current.contact_cells == 0
    }
}
