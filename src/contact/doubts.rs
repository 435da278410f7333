//! Finds what a step should be looked at for, from what it has at hand.

use crate::contact::extent::Extent;
use crate::contact::settings::Edge;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::contact::warning::{Warning, Warnings};
use crate::rheology::is_known;

/// Contact this near to an edge is near it \[cells\].
const MARGIN: usize = 2;
/// Fewer cells resolve no contact: across, and in all.
const ACROSS: usize = 8;
const IN_ALL: usize = 50;

impl ViscoelasticContact {
    /// The warnings of the step accepted last, of length `dt`.
    pub(super) fn doubts(&self, dt: f64, rings: bool) -> Warnings {
        let (axes, periodic) = (self.grid.cells(), self.kernel.periodic_axes());
        let (mut near, mut few) = (false, false);
        if let Some(Extent { low, high }) = self.region.reach(&self.state.current.pressure) {
            let all_in_touch = self.state.contact_cells == self.grid.len();
            let mut line = false;
            for axis in 0..2 {
                // across a line, or around a period, contact has no end that a mesh could miss
                if axes[axis] == 1 && periodic[axis] {
                    line = true;
                    continue;
                }
                few |= high[axis] + 1 - low[axis] < ACROSS && !(periodic[axis] && all_in_touch);
                near |= !periodic[axis] && (low[axis] < MARGIN + 1 || high[axis] + MARGIN + 1 >= axes[axis]);
            }
            few |= !line && self.state.contact_cells < IN_ALL && !(periodic == [true; 2] && all_in_touch);
        }
        let (age, [from, until]) = (self.age(), self.material.measured());
        let remembers = !self.is_undisturbed();
        let uncertain = self.material.fit_reports().any(|report| report.warning().is_some());
        Warnings::default()
            .with(Warning::NearEdge, near && self.settings.edge == Edge::Refuse)
            .with(Warning::FewCells, few)
            .with(Warning::Extrapolated, remembers && !is_known(age, until))
            .with(Warning::FasterThanMaterial, remembers && dt > 0.0 && dt < from)
            .with(Warning::NearEndOfMaterial, remembers && dt > 0.0 && !is_known(age + dt, self.material.known_until()))
            .with(Warning::Rings, rings)
            .with(Warning::FallBack, self.state.current.counts.fallback_iterations > 0)
            .with(Warning::UncertainMaterial, remembers && uncertain)
            .with(Warning::Rounding, self.state.current.rounding > self.settings.tolerance)
    }
}
