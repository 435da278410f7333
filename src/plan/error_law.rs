//! Errors of the mesh as powers of the cell width.

/// Range of accepted orders of convergence. Below the first the quantity counts as not converging.
pub(super) const ORDERS: [f64; 2] = [0.7, 2.0];
/// Ratio of the greatest difference between two meshes to the error on the finer one, for errors that are fractions of
/// a cell and have either sign.
const DIFFERENCE_OVER_ERROR: f64 = 1.25;

/// The error of a quantity, relative to the greatest value of the run, as a power of the number of cells across.
#[derive(Debug, Clone, Copy)]
pub(super) struct ErrorLaw {
    pub(super) error: f64,
    pub(super) order: f64,
    /// Cells across the widest contact at which the error is `error`.
    pub(super) across: f64,
    /// Whether the differences fall with the mesh.
    pub(super) converges: bool,
}

impl ErrorLaw {
    /// The fit of a quantity that does not converge.
    pub(super) const NONE: ErrorLaw = ErrorLaw { error: 1.0, order: 1.0, across: 1.0, converges: false };

    /// No error on any mesh.
    pub(super) const ZERO: ErrorLaw = ErrorLaw { error: 0.0, order: 1.0, across: 1.0, converges: true };

    /// Fit of a smooth quantity to the differences between successive meshes, the finest with `across` cells.
    pub(super) fn smooth(differences: &[f64], across: f64) -> ErrorLaw {
        let (error, order, converges) = match *differences {
            [] => (1.0, 1.0, true),
            [only] => (only, 1.0, true),
            [.., before, last] => {
                let last = last.max(before * 0.5f64.powf(ORDERS[1]));
                let order = if last > 0.0 { (before / last).log2() } else { ORDERS[1] };
                let believed = order.clamp(ORDERS[0], ORDERS[1]);
                (last / (2f64.powf(believed) - 1.0), believed, order >= ORDERS[0])
            }
        };
        ErrorLaw { error, order, across, converges }
    }

    /// The error on the finest mesh if the order is two.
    pub(super) fn second_order(differences: &[f64]) -> f64 {
        let finest = 2f64.powf(ORDERS[1]);
        let last = differences.last().copied().unwrap_or(1.0);
        let before = differences.iter().rev().nth(1).map_or(0.0, |before| before / finest);
        last.max(before) / (finest - 1.0)
    }

    /// Fit of a quantity that errs by a fraction of a cell.
    pub(super) fn by_cells(differences: &[f64], across: f64) -> ErrorLaw {
        let last = match *differences {
            [] => 1.0,
            [only] => only,
            [.., before, last] => last.max(0.5 * before),
        };
        ErrorLaw { error: last / DIFFERENCE_OVER_ERROR, order: 1.0, across, converges: true }
    }

    /// The law of an error that is `factor` times this one.
    pub(super) fn times(self, factor: f64) -> ErrorLaw {
        ErrorLaw { error: factor * self.error, ..self }
    }

    /// The error with `across` cells across.
    pub(super) fn at(&self, across: f64) -> f64 {
        self.error * (self.across / across).powf(self.order)
    }

    /// Cells across for the error `target`.
    pub(super) fn across_for(&self, target: f64) -> f64 {
        self.across * (self.error / target).powf(1.0 / self.order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that are a power of the cells have differences from which that power and the error are found.
    #[test]
    fn a_power_of_the_cells_is_found() {
        for order in [0.8, 1.0, 1.5, 2.0] {
            let error = |mesh: i32| 0.3 * 2f64.powf(-order * f64::from(mesh));
            let differences = [0, 1, 2].map(|mesh| error(mesh) - error(mesh + 1));
            let law = ErrorLaw::smooth(&differences, 32.0);
            let found = [law.error, law.at(64.0), law.order, law.across_for(error(4))];
            let exact = [error(3), error(4), order, 64.0];
            assert!(found.iter().zip(exact).all(|(found, exact)| (found / exact - 1.0).abs() < 1e-12), "{law:?}");
            let second = ErrorLaw::second_order(&differences);
            assert!(order < 2.0 || (second / error(3) - 1.0).abs() < 1e-12, "{second}");
        }
    }
}
