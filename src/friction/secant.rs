//! What motions of the body do to a step whose cells are met in it.

use crate::linalg;

/// What motions do to the gradient, as the loads feel it: P.
#[derive(Debug, Clone, Copy)]
pub(super) struct Secant {
    matrix: [[f64; 3]; 3],
    left: [f64; 3],
    change: [f64; 3],
}

impl Secant {
    pub(super) fn new(columns: [[f64; 3]; 3]) -> Secant {
        let matrix = std::array::from_fn(|a| std::array::from_fn(|b| columns[b][a]));
        Secant { matrix, left: [0.0; 3], change: [0.0; 3] }
    }

    /// Takes in what the last motion left.
    pub(super) fn learn(&mut self, left: [f64; 3]) {
        let size: f64 = self.change.iter().map(|change| change * change).sum();
        if size > 0.0 {
            for (a, row) in self.matrix.iter_mut().enumerate() {
                let predicted: f64 = row.iter().zip(self.change).map(|(entry, change)| entry * change).sum();
                let off = self.left[a] - left[a] - predicted;
                row.iter_mut().zip(self.change).for_each(|(entry, change)| *entry += off * change / size);
            }
        }
    }

    /// The motion that leaves nothing.
    pub(super) fn motion(&mut self, left: [f64; 3]) -> [f64; 3] {
        (self.left, self.change) = (left, linalg::solve(self.matrix, left, 0.0).0);
        self.change
    }
}
