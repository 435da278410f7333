//! The form of a surface, subtracted from its heights.

use super::HeightMap;
use crate::error::Result;
use crate::linalg;

/// The form that [`HeightMap::leveled`] subtracts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Form {
    /// The mean height.
    Mean,
    /// A plane.
    Tilt,
    /// A paraboloid with any axes, and the plane.
    Curvature,
}

/// Number of functions of the largest form.
const MOST: usize = 6;
/// Independent part of the square of a function below which the function is a combination of the others, to rounding.
const DEPENDENT_FRACTION: f64 = 1e-10;

impl Form {
    /// Number of functions, the first of 1, x1, x2, x1², x1 x2 and x2².
    fn terms(self) -> usize {
        match self {
            Form::Mean => 1,
            Form::Tilt => 3,
            Form::Curvature => MOST,
        }
    }
}

impl HeightMap {
    /// The map less the form that fits the known heights best, by least squares.
    ///
    /// # Errors
    /// If no height is known, or a leveled height is beyond ±1e300 m.
    pub fn leveled(mut self, form: Form) -> Result<HeightMap> {
        self.require_known()?;
        let terms = form.terms();
        // The second fit removes the rounding errors of the first, which count where the form is far larger than the
        // roughness.
        for _ in 0..2 {
            let (mut matrix, mut right) = ([[0.0; MOST]; MOST], [0.0; MOST]);
            for (k, &height) in self.heights.iter().enumerate().filter(|(_, height)| !height.is_nan()) {
                let basis = self.basis(k);
                for a in 0..terms {
                    right[a] += basis[a] * height;
                    for b in 0..terms {
                        matrix[a][b] += basis[a] * basis[b];
                    }
                }
            }
            // A function that depends on the others, such as the slope across a single row of points, gets the factor 0.
            let factors = linalg::solve_normal_equations(&matrix, right, DEPENDENT_FRACTION);
            for k in 0..self.heights.len() {
                self.heights[k] -= self.basis(k).iter().zip(&factors).map(|(b, f)| b * f).sum::<f64>();
            }
        }
        super::check_heights(&self.heights)?;
        Ok(self.summarized())
    }

    /// The functions at the point `k`, of coordinates from −1 to 1 so that they have like sizes.
    fn basis(&self, k: usize) -> [f64; MOST] {
        let at = |index: usize, n: usize| (2 * index + 1) as f64 / n as f64 - 1.0;
        let (x, y) = (at(k / self.cells[1], self.cells[0]), at(k % self.cells[1], self.cells[1]));
        [1.0, x, y, x * x, x * y, y * y]
    }
}

#[cfg(test)]
mod tests {
    use super::super::nothing_known;
    use super::super::tests::{map_of, waves};
    use super::*;

    fn greatest(map: &HeightMap) -> f64 {
        map.known().fold(0.0, |greatest, z| greatest.max(z.abs()))
    }

    #[test]
    fn leveling_the_greatest_heights_gives_finite_heights() {
        let steep = map_of([3, 3], |x1, x2| 2.9e300 * x1 + 1e299 * x2);
        for form in [Form::Mean, Form::Tilt, Form::Curvature] {
            assert!(greatest(&steep.clone().leveled(form).unwrap()) <= 1e300);
        }
    }

    #[test]
    fn a_surface_of_a_form_levels_to_zero() {
        let hole = |x1: f64, x2: f64| if x1 > 0.3 && x2 > 0.1 { f64::NAN } else { 0.0 };
        let forms = [
            (Form::Mean, [7.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            (Form::Tilt, [7.0, -2.0, 50.0, 0.0, 0.0, 0.0]),
            (Form::Curvature, [7.0, -2.0, 5.0, 1.0, -3.0, 40.0]),
        ];
        for (form, [a, b, c, d, e, f]) in forms {
            let surface = |x: f64, y: f64| a + b * x + c * y + d * x * x + e * x * y + f * y * y + hole(x, y);
            let left = map_of([11, 14], surface).leveled(form).unwrap();
            assert!(greatest(&left) < 1e-13, "{form:?}: {}", greatest(&left));
            assert!(left.missing() > 0);
        }
    }

    #[test]
    fn leveled_heights_are_orthogonal_to_the_form() {
        let map = map_of([10, 13], |x1, x2| waves(x1, x2) + 1e3 * x1 + 1e4);
        let left = map.leveled(Form::Curvature).unwrap();
        for term in 0..MOST {
            let share: f64 = (0..130).map(|k| left.basis(k)[term] * left.heights[k]).sum();
            assert!(share.abs() < 1e-10, "{term}: {share}");
        }
        assert!(greatest(&left) > 0.5);
    }

    #[test]
    fn single_rows_and_few_points_are_leveled() {
        let row = map_of([9, 1], |x1, _| 3.0 + x1 + x1 * x1).leveled(Form::Curvature).unwrap();
        assert!(greatest(&row) < 1e-14);
        let few = map_of([3, 3], |x1, x2| if x1 == 0.0 && x2 > -0.2 { 4.0 + x2 } else { f64::NAN });
        assert!(greatest(&few.leveled(Form::Curvature).unwrap()) < 1e-13);
        let nothing = map_of([2, 2], |_, _| f64::NAN);
        assert_eq!(nothing.leveled(Form::Mean), Err(nothing_known()));
    }
}
