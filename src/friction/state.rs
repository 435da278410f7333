//! What steps change besides the normal contact.

use crate::friction::problem::{Cell, Solution};
use crate::friction::rectangle::Rectangle;
use crate::hereditary::{ExponentialRule, GroupHistory};

/// Tractions along the surface and their past, on the rectangle of cells on which they have acted.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct State {
    pub(super) region: Rectangle,
    /// The past of U, of which K U is the displacement along the surface; both components one after the other.
    pub(super) history: GroupHistory,
    /// Of the last step.
    pub(super) solution: Solution,
    pub(super) motion: [f64; 3],
    pub(super) force: [f64; 3],
    /// Work done along the surface, and the part of it that slip dissipated \[J\].
    pub(super) work: [f64; 2],
    /// The part of what friction carries that the prescribed forces take.
    pub(super) load_share: f64,
    /// Maximum of the motion and of the force so far.
    pub(super) largest: [f64; 2],
}

clone_by_fields! { State { region, history, solution, motion, force, work, load_share, largest } }

impl State {
    pub(super) fn new(rule: &ExponentialRule) -> State {
        State {
            region: Rectangle::default(),
            history: GroupHistory::new(rule.clone(), 0),
            solution: Solution::default(),
            motion: [0.0; 3],
            force: [0.0; 3],
            work: [0.0; 2],
            load_share: 0.0,
            largest: [0.0; 2],
        }
    }

    /// Bodies part at once, without elastic response: nothing is carried any more, and the displacement stays.
    pub(super) fn release(&mut self, moved: [f64; 3]) {
        let Solution { traction, cells, gradient, .. } = &mut self.solution;
        [traction, gradient].into_iter().for_each(|field| field.fill(0.0));
        cells.fill(Cell::Apart);
        self.force = [0.0; 3];
        self.motion.iter_mut().zip(moved).for_each(|(motion, moved)| *motion += moved);
    }

    /// Takes its fields to a larger rectangle.
    pub(super) fn grow_to(&mut self, grown: Rectangle) {
        let (old, n) = (self.region, grown.len());
        let places: Vec<Option<usize>> = old.places_of(&grown).collect();
        let moved = |k: usize| places[k % n].map(|place| place + k / n * old.len());
        self.history.rearrange(2 * n, moved);
        let Solution { traction, gradient, cells, .. } = &mut self.solution;
        for field in [traction, gradient] {
            *field = (0..2 * n).map(|k| moved(k).map_or(0.0, |k| field[k])).collect();
        }
        *cells = places.iter().map(|place| place.map_or(Cell::Apart, |k| cells[k])).collect();
        self.region = grown;
    }

    /// Whether it may be of a contact on a grid of so many cells whose state is `own`; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self, own: &State, grid: [usize; 2]) -> bool {
        let State { region, history, solution: Solution { traction, gradient, cells, motion }, .. } = self;
        let Some(n) = region.cells[0].checked_mul(region.cells[1]) else { return false };
        let inside =
            |axis: usize| region.start[axis].checked_add(region.cells[axis]).is_some_and(|end| end <= grid[axis]);
        let numbers = [&traction[..], gradient, motion, &self.motion, &self.force, &self.work, &self.largest];
        inside(0)
            && inside(1)
            && [traction.len(), gradient.len(), 2 * cells.len()] == [2 * n; 3]
            && history.fits(&own.history, 2 * n)
            && numbers.into_iter().flatten().chain([&self.load_share]).all(|value| value.is_finite())
    }
}
