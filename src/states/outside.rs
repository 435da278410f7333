//! What is outside the model in a contact on elastic states.

use std::f64::consts::PI;

use crate::contact::{Figures, Warnings};
use crate::equilibrium::{DEEP, STEEP, depth_of_power};
use crate::states::curve::ElasticStates;

/// Bodies of the shape c rⁿ with so great an exponent are flat, with an edge.
const LEAST_FLAT: f64 = 101.0;

impl ElasticStates {
    /// What is outside the model in a contact of this level and `depth`: as at [`ElasticStates::state_at`], where a
    /// body without cells has the slope of the shape c rⁿ at the edge of its contact, n δ/(κ a).
    pub(super) fn outside(&self, level: f64, depth: f64) -> (Warnings, Figures) {
        let Some(state) = self.state_at(level) else { return Default::default() };
        let (mut warnings, mut figures) = (state.warnings, state.figures);
        if self.grid.is_none() {
            let (depth, radius) = (self.depth(level), 0.5 * self.stiffness(level));
            let (exponent, ratio) = (1.0 / (2.0 * radius * depth / level - 1.0), depth / radius);
            // κ is no less than √(πn/2): most contacts need no more
            let may_be = exponent > 0.0 && exponent < LEAST_FLAT && 2.0 * exponent * ratio * ratio > PI * STEEP * STEEP;
            let slope = may_be.then(|| exponent * ratio / depth_of_power(exponent));
            figures.max_slope = slope.filter(|slope| *slope > STEEP);
            warnings.set(Warnings::STEEP, figures.max_slope.is_some());
        }
        figures.compression = figures.compression.map(|compression| compression * depth / self.depth_of(state));
        warnings.set(Warnings::DEEP, figures.compression > Some(DEEP));
        (warnings, figures)
    }
}
