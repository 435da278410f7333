//! What limits the accuracy of a contact: its warnings, and their numbers.

use crate::equilibrium::pressed::Pressed;
use crate::equilibrium::{Edge, Ground, Held, Indenter, Region, Warnings};
use crate::extent::Extent;
use crate::rounded::rounded;
use crate::solver::RigidMotion;

/// Bodies that are pressed into a layer by more of its thickness strain it by more than is small.
pub(crate) const DEEP: f64 = 0.2;
/// Contact moduli E* outside this range are in other units than Pa \[Pa\].
const SOLID: std::ops::RangeInclusive<f64> = 10.0..=1e13;
/// The numbers behind [`Warnings`], each `None` where the scene is far from its limit; `Display` of a
/// [`StepReport`](crate::contact::StepReport) prints them with the warnings.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Figures {
    /// Maximum slope of the undeformed bodies in contact, where it is too steep for the model ([`Warnings::STEEP`]).
    pub max_slope: Option<f64>,
    /// Maximum displacement in contact over the thickness of a layer, of every contact on a [`Layer`](crate::Layer)
    /// ([`Warnings::DEEP`]). On a half-space it is the part of the displacement that the layer takes.
    pub compression: Option<f64>,
    /// Cells across the contact, if fewer than eight ([`Warnings::FEW_CELLS`]): 4/π times the mean length of its rows
    /// or columns, whichever are shorter, which is the diameter of a disc and the average one of many patches of
    /// contact; at most the extent of all contact. Of several bodies, that of the body with the fewest.
    pub cells_across: Option<f64>,
    /// Cells in the shortest wave of the shapes, if fewer than four ([`Warnings::SHORT_WAVES`]).
    pub cells_in_wave: Option<f64>,
    /// Periods of a shape in the period of the bodies, if no whole number ([`Warnings::OTHER_PERIOD`]).
    pub periods: Option<f64>,
    /// Cells in the zone in which an attraction acts, if fewer than four ([`Warnings::COARSE_ZONE`]).
    pub cells_in_zone: Option<f64>,
    /// The force that the attraction beyond the edge of the grid would add, over the force on it, if the part matters
    /// ([`Warnings::BEYOND_EDGE`]).
    pub beyond_edge: Option<f64>,
    /// The contact modulus at once \[Pa\], if no solid has it ([`Warnings::MODULUS`]).
    pub modulus: Option<f64>,
    /// The approach at which the upright bodies touch \[m\], at the end of a run that never brought them into contact
    /// ([`Warnings::NO_CONTACT`]).
    pub touch: Option<f64>,
    /// Part of the elastic energy of a steady motion, or of its part that can be lost, in waves
    /// that pass at frequencies at which the material was not measured, if more than a tenth
    /// ([`Warnings::FREQUENCIES`]).
    pub unmeasured: Option<f64>,
    /// Part of approach or lateral force by which traces that have left the grid could change it, if more than 1 %
    /// ([`Warnings::WAKE`]): a bound.
    pub wake: Option<f64>,
}

impl Figures {
    /// What the number of a warning is, and the number; of a step that is too long its relative
    /// error.
    fn of(&self, warning: Warnings, time_error: Option<f64>) -> Option<(&'static str, f64)> {
        let (name, figure) = match warning {
            Warnings::STEEP => ("maximum slope", self.max_slope),
            Warnings::DEEP => ("depth over thickness", self.compression),
            Warnings::FEW_CELLS => ("cells across:", self.cells_across),
            Warnings::SHORT_WAVES => ("cells in a wave:", self.cells_in_wave),
            Warnings::OTHER_PERIOD => ("periods:", self.periods),
            Warnings::COARSE_ZONE => ("cells in the zone:", self.cells_in_zone),
            Warnings::BEYOND_EDGE => ("part of the force:", self.beyond_edge),
            Warnings::MODULUS => ("E* in Pa:", self.modulus),
            Warnings::NO_CONTACT => ("they touch at an approach in m of", self.touch),
            Warnings::FREQUENCIES => ("part of the energy:", self.unmeasured),
            Warnings::WAKE => ("part of approach or lateral force:", self.wake),
            Warnings::LONG_STEP => ("relative error", time_error),
            _ => ("", None),
        };
        figure.map(|figure| (name, figure))
    }

    /// What each warning says, with its number.
    pub(crate) fn messages(self, warnings: Warnings, time_error: Option<f64>) -> impl Iterator<Item = String> {
        warnings.iter().map(move |warning| match self.of(warning, time_error) {
            Some((name, figure)) => format!("{warning} ({name} {})", rounded(figure, 3)),
            None => warning.to_string(),
        })
    }
}

/// The contact modulus \[Pa\] of a compliance, if no solid has it. A body without elastic response has no modulus at
/// once.
pub(crate) fn modulus_of_no_solid(compliance: f64) -> Option<f64> {
    Some(1.0 / compliance).filter(|e| e.is_finite() && !SOLID.contains(e))
}

impl Held {
    /// The numbers of an elastic contact that presses so. A call of all ranks.
    pub(crate) fn figures(&self, ground: &Ground, pressed: &Pressed) -> Figures {
        let Held { indenter, region, current, .. } = self;
        let (pressure, datum) = (&current.solution.pressure, indenter.gap().datum);
        let motion = |body: usize| RigidMotion { approach: -datum, tilt: [0.0; 2] } + current.motions[body];
        Figures {
            max_slope: indenter.steepest(&ground.grid, region, pressure),
            compression: ground.compression(indenter, region, pressure, motion),
            cells_across: pressed.few,
            cells_in_wave: indenter.missed.cells,
            periods: indenter.missed.periods,
            ..Figures::default()
        }
    }

    /// The warnings of these numbers and of the solver, with all pressed cells in `reach`.
    pub(crate) fn warnings(&self, ground: &Ground, reach: Option<Extent>, figures: &Figures) -> Warnings {
        let Ground { grid, kernel, settings, .. } = ground;
        let (axes, periodic, solution) = (grid.cells(), kernel.periodic_axes(), &self.current.solution);
        let near = reach.is_some_and(|Extent { low, high }| {
            let at_end = |axis: usize| low[axis] <= 2 || high[axis] + 3 >= axes[axis];
            (0..2).any(|axis| !periodic[axis] && at_end(axis))
        });
        let is_rounded = solution.relative_rounding > settings.tolerance || self.heights_are_lost(ground);
        let reasons = [
            (Warnings::NEAR_EDGE, near && settings.edge == Edge::Refuse),
            (Warnings::FEW_CELLS, figures.cells_across.is_some()),
            (Warnings::FALL_BACK, solution.counts.fallback_iterations > 0),
            (Warnings::ROUNDING, is_rounded),
            (Warnings::MODULUS, figures.modulus.is_some()),
            (Warnings::STEEP, figures.max_slope.is_some()),
            (Warnings::DEEP, figures.compression > Some(DEEP)),
            (Warnings::OTHER_PERIOD, figures.periods.is_some()),
            (Warnings::SHORT_WAVES, figures.cells_in_wave.is_some()),
            (Warnings::FLAT, self.indenter.is_too_flat(grid)),
        ];
        Warnings::of(&reasons)
    }
}

impl Ground {
    /// Maximum displacement in contact over the thickness of a layer, as far as the layer and not its base is
    /// displaced; `None` without layer or contact. `motions` count from the datum of the gap. A call of all ranks.
    pub(crate) fn compression(
        &self,
        indenter: &Indenter,
        region: &Region,
        pressure: &[f64],
        motions: impl Fn(usize) -> RigidMotion,
    ) -> Option<f64> {
        let (layer, rows) = (self.kernel.layer_of()?, region.rows());
        let in_contact = || (0..pressure.len()).filter(|&k| pressure[k] > 0.0);
        let displaced = |k: usize| {
            let at = indenter.index(&self.grid, region, k);
            motions(indenter.gap().owner(at)).at(region.center(k)) - indenter.gap().above[at]
        };
        let cells = region.images() * rows.count(in_contact().count());
        let deepest = rows.greatest(in_contact().map(displaced).fold(0.0, f64::max));
        let share = layer.share(cells as f64 * self.grid.cell_area());
        (cells > 0).then(|| share * deepest / layer.thickness())
    }
}
