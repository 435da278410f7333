//! What an elastic contact holds between two solutions: the rigid bodies, the part of the grid that is computed, and
//! the equilibrium found there.

use std::sync::Arc;

use crate::equilibrium::extrapolation::Extrapolation;
use crate::equilibrium::{Ground, Indenter, Region, Request, Trial};
use crate::hereditary::{Field, Role};
use crate::load::Load;
use crate::parallel::Rows;
use crate::solver::{RigidMotion, Solution};

/// The rigid bodies and what presses them.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Held {
    pub(crate) loads: Vec<Load>,
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(crate) indenter: Arc<Indenter>,
    /// The part of the grid that is computed: every field lives there, except for the gap of the indenter.
    pub(crate) region: Region,
    /// Whether the region was chosen for a contact, rather than for bodies apart.
    pub(crate) region_is_for_contact: bool,
    pub(crate) current: Equilibrium,
    pub(crate) extrapolation: Extrapolation,
}

clone_by_fields! { Held { loads, indenter, region, region_is_for_contact, current, extrapolation } }

/// Pressure and motions in equilibrium with the loads.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Equilibrium {
    pub(crate) solution: Solution,
    /// Motion of each body, prescribed and free parts together.
    pub(crate) motions: Vec<RigidMotion>,
    /// Cells in contact on the whole grid.
    pub(crate) contact_cells: usize,
    /// Σ p over the cells that are computed, of all ranks, less Σ s where surfaces attract each other.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(crate) sum: f64,
}

clone_by_fields! { Equilibrium { solution, motions, contact_cells, sum } }

impl Held {
    /// Bodies without load, where they just touch; without values.
    pub(crate) fn layout(indenter: Arc<Indenter>, region: Region) -> Held {
        let motions = indenter.first_touch();
        let (loads, solution) = (vec![Load::force(0.0); motions.len()], Solution::zero(0, motions.len()));
        let current = Equilibrium { solution, motions, contact_cells: 0, sum: 0.0 };
        Held { loads, indenter, region, region_is_for_contact: false, current, extrapolation: Extrapolation::default() }
    }

    /// Bodies without load, where they just touch.
    pub(crate) fn at_rest(indenter: Arc<Indenter>, region: Region) -> Held {
        let cells = region.len();
        Held::layout(indenter, region.clone()).map(&region, false, &mut |field| vec![0.0; cells * field.per_cell])
    }

    /// Finds the sum that a transfer does not have.
    pub(crate) fn sum_up(&mut self) {
        self.current.sum = net_sum(&self.region.rows(), &self.current.solution);
    }

    /// A copy on `region`; `map` gives its fields, one for each field here.
    pub(crate) fn map(&self, region: &Region, attracts: bool, map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> Held {
        Held {
            loads: self.loads.clone(),
            indenter: Arc::clone(&self.indenter),
            region: region.clone(),
            current: self.current.map(attracts, map),
            ..*self
        }
    }
}

impl Held {
    /// Makes the trial of a request what is held; `sum` is Σ p, `contact_cells` is the number of pressed cells of the
    /// region.
    pub(crate) fn take(&mut self, trial: &mut Trial, request: Request<'_>, sum: f64, contact_cells: usize) {
        let datum = request.indenter.gap().datum;
        std::mem::swap(&mut self.current.solution, &mut trial.solution);
        (self.current.contact_cells, self.current.sum) = (self.region.images() * contact_cells, sum);
        for body in 0..request.loads.len() {
            let modes = self.region.modes(trial.free[body]);
            let free = modes.physical(self.current.solution.motions[body]);
            let RigidMotion { approach, tilt } = request.prescribed(body);
            self.current.motions[body] = RigidMotion { approach: datum + approach, tilt } + free;
        }
        self.loads.copy_from_slice(request.loads);
        if !Arc::ptr_eq(&self.indenter, request.indenter) {
            self.indenter = Arc::clone(request.indenter);
        }
    }

    /// Whether a pressure on the region acts under a body. A call of all ranks.
    pub(crate) fn presses(&self, ground: &Ground, pressure: &[f64], body: usize) -> bool {
        let (region, indenter) = (&self.region, &self.indenter);
        if ground.bodies == 1 {
            return region.is_positive_anywhere(pressure);
        }
        let is_own = |k: usize| indenter.gap().owner(indenter.index(&ground.grid, region, k)) == body;
        pressure.iter().enumerate().any(|(k, &p)| p > 0.0 && is_own(k))
    }

    /// Whether the heights of the shapes are so far from 0 that their rounding counts, over the depth of the contact.
    pub(crate) fn heights_are_lost(&self, ground: &Ground) -> bool {
        let (datum, [l1, l2]) = (self.indenter.gap().datum, ground.grid.lengths());
        // of a body that tilts, or is held by attraction, the origin may be above the first touch
        let depth_of =
            |m: &RigidMotion| (m.approach - datum).abs() + 0.5 * (m.tilt[0].abs() * l1 + m.tilt[1].abs() * l2);
        let depth = self.current.motions.iter().map(depth_of).fold(0.0, f64::max);
        self.current.contact_cells > 0 && f64::EPSILON * datum.abs() > ground.settings.tolerance * depth
    }
}

impl Equilibrium {
    pub(crate) fn map(&self, attracts: bool, map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> Equilibrium {
        let Solution { pressure, potential, attraction, motions, .. } = &self.solution;
        let (kept, lasting) = (usize::from(attracts), Role::Lasting { source: None });
        let solution = Solution {
            pressure: map(Field::single(pressure, Role::Lasting { source: None })),
            potential: map(Field::single(potential, Role::Lasting { source: Some(pressure) })),
            attraction: map(Field { values: attraction, per_cell: kept, role: lasting }),
            motions: motions.clone(),
            ..self.solution
        };
        Equilibrium { solution, motions: self.motions.clone(), ..*self }
    }
}

/// Σ p, less Σ s where surfaces attract each other.
pub(crate) fn net_sum(rows: &Rows, solution: &Solution) -> f64 {
    let sum = rows.sum(&solution.pressure);
    if solution.attraction.is_empty() { sum } else { sum - rows.sum(&solution.attraction) }
}
