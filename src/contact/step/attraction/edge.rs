//! The attraction beyond the edge of the grid, which is not computed.

use super::Attracted;
use crate::attraction::Attraction;
use crate::contact::{Edge, Scene, Step};
use crate::equilibrium::Region;
use crate::error::{Refusal, Result};
use crate::rounded::{TIME, rounded};
use crate::solver::Solution;

/// The force that the attraction beyond the edge of the grid would add, over the sum of the tractions on the grid, or
/// over the work of separation of a length of the grid where this is more: about the force that pulls off a ball of
/// its size.
///
/// Over the lines of a sixteenth of the grid beside an edge the attraction falls at some rate, at which it is
/// continued, over no more than half a length of the grid: a surface that stays as near ends somewhere.
pub(super) fn attraction_beyond(scene: &Scene, law: &dyn Attraction, region: &Region, solution: &Solution) -> f64 {
    let (s, mut beyond) = (&solution.attraction, 0.0);
    let (cells, rows, periodic) = (region.cells(), region.rows(), scene.ground.kernel.periodic_axes());
    for axis in (0..2).filter(|&axis| !periodic[axis]) {
        let line = |at: usize| {
            let on_line = |k: usize| [k / cells[1], k % cells[1]][axis] == at;
            rows.sum_terms(|k| on_line(k).then(|| [s[k]]))[0]
        };
        let (last, inwards) = (cells[axis] - 1, (scene.ground.grid.cells()[axis] / 16).max(1).min(cells[axis] - 1));
        let high = (last, last - inwards);
        // the cells of a folded axis begin at its middle
        let low = (!region.folded()[axis]).then_some((0, inwards));
        for (edge, inner) in [high].into_iter().chain(low) {
            let (at_edge, inside) = (line(edge), line(inner));
            let longest = 0.5 * scene.ground.grid.cells()[axis] as f64;
            let rate = (inside / at_edge).ln() / inwards as f64;
            let length = if rate * longest > 1.0 { 1.0 / rate } else { longest };
            beyond += if at_edge > 0.0 { at_edge * length } else { 0.0 };
        }
    }
    let Solution { pressure, attraction, .. } = solution;
    let tractions = rows.sum_of_pairs(pressure, attraction, |z, s| (z - s).abs());
    let area = region.cell_area();
    let [length1, length2] = scene.ground.grid.lengths();
    area * beyond / (area * tractions).max(law.energy(0.0) * length1.min(length2))
}

impl Attracted {
    /// The part of the force that is left out beyond the edge, where it is more than a thousandth, or than the
    /// tolerance of the solver.
    pub(in crate::contact::step) fn beyond_edge(&self, scene: &Scene) -> Option<f64> {
        Some(self.report.beyond_edge).filter(|share| *share > f64::max(1e-3, scene.ground.settings.tolerance))
    }

    /// Refuses a step that leaves out too much.
    pub(in crate::contact::step) fn check_edge(&self, scene: &Scene, step: &Step<'_>) -> Result<()> {
        let (ground, share) = (&scene.ground, self.report.beyond_edge);
        if ground.settings.edge == Edge::Refuse && share > 0.05 {
            let (time, lengths) = (step.interval.time, ground.grid.lengths());
            let what = format!(
                "at t = {} s the attraction beyond the edge of the grid of {} × {} m would add {:.0} % of the force, \
                 where 5 % are allowed",
                rounded(time, TIME),
                rounded(lengths[0], 4),
                rounded(lengths[1], 4),
                100.0 * share
            );
            let remedy = ": enlarge the grid, give a surface that repeats a periodic body (InfluenceKernel::periodic), \
                or set Settings::edge to Edge::Allow if the body ends there";
            return Err(Refusal::value("adhesion_beyond_edge", what, remedy)
                .naming("part of the force beyond the edge")
                .valued(share)
                .into());
        }
        Ok(())
    }
}
