//! What a unit pressure displaces at any distance along an axis, for bodies in steady motion.

use std::f64::consts::PI;
use std::sync::Arc;

use super::InfluenceKernel;
use super::influence::Body;
use super::layer::Remainder;
use super::line_load::{Strip, wave_number};
use super::love::{Love, rod_potential};

/// From so many thicknesses on a layer displaces as its base.
const FARTHEST: f64 = 1e12;

/// What a unit pressure on a cell displaces along a row of points.
pub(crate) struct Row {
    /// At a distance along the row \[m\].
    pub(crate) influence: Box<dyn Fn(f64) -> f64 + Send + Sync>,
    /// How far the cell is from the row \[m\].
    pub(crate) aside: f64,
}

impl InfluenceKernel {
    /// Distance from a line load at which the displacement is zero \[m\].
    pub(crate) fn datum(&self) -> Option<f64> {
        self.datum
    }

    /// Whether [`InfluenceKernel::rows_along`] the axis are known: bodies end there, and are not of coefficients.
    pub(crate) fn has_rows_along(&self, axis: usize) -> bool {
        self.body != Body::User && !self.periodic[axis]
    }

    /// What a unit pressure displaces at any distance along `axis`, in rows aside of it: at the distances of cells,
    /// or of each wave where bodies are periodic along the other axis. `None` for bodies that are periodic along the
    /// axis, and of coefficients.
    pub(crate) fn rows_along(&self, axis: usize) -> Option<Vec<Row>> {
        let (spacing, cells, layer) = (self.grid.spacing(), self.grid.cells()[1 - axis], self.layer_of().copied());
        if !self.has_rows_along(axis) {
            return None;
        }
        // the layer is a half-space beyond
        let far = layer.map_or(0.0, |layer| FARTHEST * layer.thickness());
        let added = |wave: Option<f64>| match (layer, wave) {
            (Some(layer), None) => Some(Remainder::of_cells(&layer, far)),
            (Some(layer), Some(0.0)) => Some(Remainder::of_lines(&layer, far, self.datum)),
            (Some(layer), Some(kappa)) => Remainder::of_wave(&layer, far, kappa),
            (None, _) => None,
        };
        let longest = layer.map_or(1.0, |layer| layer.longest_over_half_space());
        if self.periodic[1 - axis] {
            let datum = self.datum.or_else(|| Some(2.0 * layer?.thickness()))?;
            let strip = Strip { side: spacing[axis], datum };
            let row = |k: usize| {
                let kappa = wave_number(k, cells, spacing[1 - axis]);
                let added = added(Some(kappa));
                let influence = move |x: f64| match &added {
                    Some(_) if x > far => longest * strip.at(x, kappa),
                    Some(added) => strip.at(x, kappa) + added.on_line(x, strip.side),
                    None => strip.at(x, kappa),
                };
                Row { influence: Box::new(influence), aside: 0.0 }
            };
            return Some((0..=cells / 2).map(row).collect());
        }
        let (love, added) = (Arc::new(Love::new(spacing)), added(None).map(Arc::new));
        let row = |j: usize| {
            let (y, love, added) = (j as f64 * spacing[1 - axis], Arc::clone(&love), added.clone());
            let at = move |x: f64| if axis == 0 { [x, y] } else { [y, x] };
            let influence = move |x: f64| match &added {
                Some(_) if x > far => longest * love.at(at(x)),
                Some(added) => love.at(at(x)) + added.on_cell(at(x), spacing),
                None => love.at(at(x)),
            };
            Row { influence: Box::new(influence), aside: (y - 0.5 * spacing[1 - axis]).max(0.0) }
        };
        Some((0..cells).map(row).collect())
    }
}

impl Love {
    /// The displacement at the distance x along x1 and y along x2 from the middle of the cell \[m\].
    pub(crate) fn at(&self, distance: [f64; 2]) -> f64 {
        let [x, y] = distance.map(|own| own.abs() / self.scale);
        let (x, y) = if self.long_first { (x, y) } else { (y, x) };
        let [a, b] = self.half;
        if y.hypot((x - a).max(0.0)) >= FAR * b {
            let rule = &self.rules[2].1;
            return self.scale * b / PI * rule.sum(|s| rod_potential(x, y + b * s, a));
        }
        // the closed form: near the cell little cancels
        let term = |x: f64, y: f64| if x == 0.0 { 0.0 } else { x * (y / x.abs()).asinh() };
        let corner = |x: f64, y: f64| term(x, y) + term(y, x);
        self.scale / PI * (corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b))
    }
}

/// Six points along the shorter side are enough from so many of its halves on.
const FAR: f64 = 12.0;
