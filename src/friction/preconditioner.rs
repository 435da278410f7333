//! An approximate inverse of the operator of a Newton step.

use crate::friction::operator::Operator;
use crate::friction::problem::{Cell, dot};
use crate::parallel::Rows;
use crate::solver::{Extension, ExtensionKind};

/// Stiffness of waves as short as a cell, over the mean one. Between half and twice of it the work differs by 5 %.
const SHORTEST: f64 = 2.0;

/// S Eᵀ (M⁻¹ + λ̄)⁻¹ E S ≈ (c K + λ)⁻¹ on what cells are free to do, with M ≈ (c K)⁻¹, a multiplication in wave space
/// on a grid without padding, and λ the curvature of the circles on which cells slip.
///
/// * E extends a field smoothly: from cells that stick to what those that slip are not free to do, and from cells in
///   contact to all others. Cut off there, M would be wrong over a strip along each edge.
/// * Cells of weak bounds that slip far have a λ beyond all stiffness: S² = (κ + λ̄)/(κ + λ), of the mean 1, with the
///   stiffness κ of short waves, so that neither they nor a contact all of which slips hold up the others.
#[derive(Debug, Clone)]
pub(super) struct Preconditioner {
    inverse: Operator,
    /// Of K⁻¹ and of what is applied: xx, yy, xy of each wave, over the number of values.
    stiffness: Vec<[f64; 3]>,
    /// Mean of both diagonal entries.
    mean: f64,
    to_slip: Extension,
    to_all: Extension,
    sticks: Vec<bool>,
    touches: Vec<bool>,
    /// Where each cell of the rectangle is.
    places: Vec<usize>,
    /// S/√c of each cell of the rectangle.
    weights: Vec<f64>,
    extended: Vec<f64>,
    answer: Vec<f64>,
}

impl Preconditioner {
    /// Of an inverse of K on a periodic grid of so many cells, of which the rectangle is a corner.
    pub(super) fn new(inverse: Operator, cells: [usize; 2]) -> Preconditioner {
        let [rows, columns] = inverse.cells;
        let whole = rows * columns;
        let extension = || Extension::new(&Rows::all(inverse.cells), [true; 2], None);
        let stiffness = inverse.spectrum.clone();
        let mean = stiffness.iter().map(|[xx, yy, _]| 0.5 * (xx + yy)).sum::<f64>() * whole as f64;
        Preconditioner {
            to_slip: extension(),
            to_all: extension(),
            sticks: vec![false; whole],
            touches: vec![false; whole],
            places: (0..cells[0]).flat_map(|i| (0..cells[1]).map(move |j| i * columns + j)).collect(),
            weights: vec![0.0; cells[0] * cells[1]],
            extended: vec![0.0; 2 * whole],
            answer: vec![0.0; 2 * whole],
            mean: mean / stiffness.len() as f64,
            stiffness,
            inverse,
        }
    }

    pub(super) fn values(&self) -> usize {
        self.sticks.len()
    }

    /// Fits it to what cells do, and to the curvatures of their circles.
    pub(super) fn fit(&mut self, cells: &[Cell], curvature: &[f64], compliance: f64) {
        for (&at, cell) in self.places.iter().zip(cells) {
            (self.sticks[at], self.touches[at]) = (*cell == Cell::Stick, *cell != Cell::Apart);
        }
        self.to_slip.fit(&self.sticks);
        self.to_all.fit(&self.touches);
        let shortest = SHORTEST * compliance / self.mean;
        let touching = || cells.iter().zip(curvature).filter(|(cell, _)| **cell != Cell::Apart);
        let yields = touching().map(|(_, curvature)| 1.0 / (shortest + curvature)).sum::<f64>();
        let both = touching().count() as f64 / yields;
        let weights = self.weights.iter_mut().zip(curvature);
        weights.for_each(|(weight, curvature)| *weight = (both / ((shortest + curvature) * compliance)).sqrt());
        let more = (both - shortest).max(0.0) / compliance * self.values() as f64;
        for (soft, &[xx, yy, xy]) in self.inverse.spectrum.iter_mut().zip(&self.stiffness) {
            // M (1 + λ̄ M)⁻¹
            let determinant = xx * yy - xy * xy;
            let all = 1.0 + more * (xx + yy + more * determinant);
            *soft = [(xx + more * determinant) / all, (yy + more * determinant) / all, xy / all];
        }
    }

    /// out ← what it makes of a field that is restricted to what cells are free to do.
    pub(super) fn apply(&mut self, field: &[f64], out: &mut [f64], cells: &[Cell], normals: &[[f64; 2]]) {
        let Preconditioner { inverse, to_slip, to_all, sticks, touches, places, weights, extended, answer, .. } = self;
        let (n, whole) = (cells.len(), sticks.len());
        extended.fill(0.0);
        for (half, field) in extended.chunks_exact_mut(whole).zip(field.chunks_exact(n)) {
            for (i, &at) in places.iter().enumerate().filter(|(i, _)| cells[*i] == Cell::Stick) {
                half[at] = weights[i] * field[i];
            }
            to_slip.extend(half, sticks);
        }
        for (i, &at) in places.iter().enumerate() {
            let own = [field[i], field[n + i]].map(|value| weights[i] * value);
            let along = dot(normals[i], [extended[at], extended[whole + at]]);
            (extended[at], extended[whole + at]) = match cells[i] {
                Cell::Apart => (0.0, 0.0),
                Cell::Stick => (own[0], own[1]),
                Cell::Slip => (own[0] + along * normals[i][0], own[1] + along * normals[i][1]),
            };
        }
        for half in extended.chunks_exact_mut(whole) {
            half.iter_mut().zip(&*touches).filter(|(_, touches)| !**touches).for_each(|(value, _)| *value = 0.0);
            to_all.extend(half, touches);
        }
        inverse.apply(extended, answer);
        answer.chunks_exact_mut(whole).for_each(|half| to_all.gather(half, touches, ExtensionKind::Unbounded));
        for (i, &at) in places.iter().enumerate() {
            let whole_answer = [answer[at], answer[whole + at]];
            // what those that slip are not free to do goes to those that stick
            let along = if cells[i] == Cell::Slip { dot(normals[i], whole_answer) } else { 0.0 };
            let rest = normals[i].map(|part| along * part);
            (out[i], out[n + i]) = (whole_answer[0] - rest[0], whole_answer[1] - rest[1]);
            (answer[at], answer[whole + at]) = (rest[0], rest[1]);
        }
        for (half, out) in answer.chunks_exact_mut(whole).zip(out.chunks_exact_mut(n)) {
            to_slip.gather(half, sticks, ExtensionKind::Unbounded);
            for (i, &at) in places.iter().enumerate() {
                out[i] = weights[i] * (out[i] + half[at]);
            }
        }
    }
}
