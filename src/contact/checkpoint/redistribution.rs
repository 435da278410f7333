//! A state on the rows of a contact, put together from files with other rows.

use std::ops::Range;
use std::sync::Arc;

use crate::contact::indenter::Indenter;
use crate::contact::state::{Equilibrium, State};
use crate::contact::stepper::ViscoelasticContact;
use crate::contact::window::region::Region;
use crate::geometry::Gap;
use crate::hereditary::CommonCells;
use crate::solver::Solution;

/// A state on the region of a contact. Its fields are zero until they are copied from others, which hold other rows.
pub(super) struct Assembled {
    state: State,
    /// The gap above the datum, on the region.
    above: Vec<f64>,
}

impl Assembled {
    /// With all of `state` but its fields, on the rows that a contact has.
    pub(super) fn on_rows_of(contact: &ViscoelasticContact, state: &State) -> Assembled {
        let (grid, own, folded) = (&contact.scene.grid, &contact.computation.state.region, state.region.folded());
        let region =
            if own.is_shared() { Region::shared(grid, folded, &own.rows()) } else { Region::whole(grid, folded) };
        let cells = region.len();
        let blank = |Equilibrium { solution, motions, contact_cells, sum }: &Equilibrium| {
            let [pressure, potential] = [vec![0.0; cells], vec![0.0; cells]];
            let solution = Solution { pressure, potential, motions: solution.motions.clone(), ..*solution };
            Equilibrium { solution, motions: motions.clone(), contact_cells: *contact_cells, sum: *sum }
        };
        let state = State {
            loads: state.loads.clone(),
            start: state.start.clone(),
            indenter: Arc::clone(&state.indenter),
            history: state.history.blank_on(cells),
            current: blank(&state.current),
            previous: blank(&state.previous),
            region,
            ..*state
        };
        Assembled { state, above: vec![0.0; cells] }
    }

    /// Whether it has some of these rows.
    pub(super) fn wants(&self, rows: &Range<usize>) -> bool {
        let own = self.state.region.computed_rows();
        own.start.max(rows.start) < own.end.min(rows.end)
    }

    /// Copies the rows in common with another state, whose gap above the datum is this on its region.
    pub(super) fn copy(&mut self, other: &State, above: &[f64]) {
        let Some(common) = common(&self.state.region, &other.region) else { return };
        let State { history, current, previous, .. } = &mut self.state;
        history.copy_common(&other.history, common);
        for (own, other) in [(current, &other.current), (previous, &other.previous)] {
            common.copy(&other.solution.pressure, &mut own.solution.pressure);
            common.copy(&other.solution.potential, &mut own.solution.potential);
        }
        common.copy(above, &mut self.above);
    }

    /// The state of the contact, once all of its rows are there.
    pub(super) fn finish(self, contact: &ViscoelasticContact) -> State {
        let Assembled { state, above } = self;
        let datum = state.indenter.gap().datum;
        let indenter = if state.region.is_shared() {
            let gap = Gap { datum, above, owner: None };
            contact.computation.state.indenter.with_gap_on(&state.region, gap)
        } else {
            let mut whole = vec![0.0; contact.scene.grid.len()];
            state.region.spread(&above, &mut whole);
            Indenter::new(Gap { datum, above: whole, owner: None }, contact.scene.bodies)
        };
        State { indenter: Arc::new(indenter), ..state }
    }
}

/// The cells that two regions of the same columns have in common.
fn common(here: &Region, there: &Region) -> Option<CommonCells> {
    let (own, other, columns) = (here.computed_rows(), there.computed_rows(), here.cells()[1]);
    let (start, end) = (own.start.max(other.start), own.end.min(other.end));
    (start < end).then(|| CommonCells {
        here: (start - own.start) * columns,
        there: (start - other.start) * columns,
        count: (end - start) * columns,
    })
}
