//! Pressure, displacement, gap and net traction along a line of cells.

use crate::Grid;
use crate::error::{Result, within};
use crate::values::Counted;

/// The index of the line of cells that contains the coordinate `at` along `across`.
pub(crate) fn line_through(grid: &Grid, across: usize, (field, at): (&'static str, f64)) -> Result<usize> {
    let half = 0.5 * grid.lengths()[across];
    within(field, at, at.abs() <= half, "inside the grid")?;
    // the last line includes the edge of the grid
    Ok((((at + half) / grid.spacing()[across]) as usize).min(grid.cells()[across] - 1))
}

/// Pressure, displacement, gap and net traction along a line of cells, see
/// [`Fields::profile`](crate::fields::Fields::profile).
#[derive(Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LineProfile {
    /// The constant coordinate of the line, at the centres of its cells \[m\].
    pub at: f64,
    /// Cell centres along the line \[m\].
    pub positions: Vec<f64>,
    /// Pressure \[Pa\].
    pub pressure: Vec<f64>,
    /// Displacement \[m\].
    pub displacement: Vec<f64>,
    /// Gap \[m\]; +∞ where there is nothing to touch.
    pub gap: Vec<f64>,
    /// Net traction \[Pa\]: the pressure less the [attraction](crate::adhesion).
    pub traction: Vec<f64>,
}

debug_by! {
    self: LineProfile =>
    at: self.at, positions: Counted(&self.positions), pressure: Counted(&self.pressure),
    displacement: Counted(&self.displacement), gap: Counted(&self.gap), traction: Counted(&self.traction)
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use crate::axis::Axis;
    use crate::error::Error;
    use crate::observe::tests::sphere;

    #[test]
    fn profiles_are_lines_of_the_fields() {
        let contact = sphere([24, 32], [2.4e-3, 3.2e-3], [0.2e-3, -0.1e-3], 0.2);
        let mut gap = vec![0.0; 24 * 32];
        contact.fields().gap_into(&mut gap).unwrap();
        let profile = contact.fields().profile(Axis::X1, 0.26e-3).unwrap();
        assert_abs_diff_eq!(profile.at, 0.25e-3, epsilon = 1e-12);
        for i in 0..24 {
            let k = i * 32 + 18;
            assert_eq!(profile.positions[i], contact.grid().center(i, 18)[0]);
            let values = [contact.pressure()[k], contact.fields().displacement()[k], gap[k]];
            assert_eq!([profile.pressure[i], profile.displacement[i], profile.gap[i]], values);
        }
        let profile = contact.fields().profile(Axis::X2, -1.2e-3).unwrap();
        assert_eq!(profile.at, contact.grid().center(0, 0)[0]);
        assert_eq!(profile.gap, gap[..32]);
        assert_eq!(profile.positions[31], contact.grid().center(0, 31)[1]);
        assert_eq!(contact.fields().profile(Axis::X2, 1.2e-3).unwrap().gap, gap[23 * 32..]);
    }

    #[test]
    fn lines_outside_the_grid_are_refused() {
        let contact = sphere([8, 8], [4.0e-3; 2], [0.0; 2], 0.1);
        for at in [2.1e-3, f64::NAN, f64::NEG_INFINITY] {
            let error = contact.fields().profile(Axis::X1, at).unwrap_err();
            assert!(matches!(error, Error::OutOfRange { field: "coordinate of the profile", .. }));
        }
    }
}
