use std::sync::Arc;

use crate::Grid;
use crate::error::UserError;
use crate::geometry::{Geometry, Waves};

/// Superposed shapes: the gap is the sum of the gaps of the shapes, and +∞ where a shape has nothing to touch.
///
/// ```
/// use viscocontact::geometry::{Geometry, Sphere, Sum, Wavy};
///
/// let wavy_sphere = Sum::new(Sphere::new(0.5)?, Wavy::new(1e-6, 1e-3)?);
/// assert_eq!(wavy_sphere.initial_gap(1e-3, 0.0), 1e-6);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Sum {
    parts: Vec<Arc<dyn Geometry>>,
}

impl Sum {
    /// The sum of two shapes.
    pub fn new(first: impl Geometry + 'static, second: impl Geometry + 'static) -> Sum {
        Sum { parts: vec![Arc::new(first), Arc::new(second)] }
    }

    /// The sum with another shape.
    #[must_use]
    pub fn and(mut self, shape: impl Geometry + 'static) -> Sum {
        self.parts.push(Arc::new(shape));
        self
    }
}

/// The sum of two gaps: nothing to touch where one shape has nothing, whatever the other is.
pub(crate) fn added(one: f64, other: f64) -> f64 {
    if one == f64::INFINITY || other == f64::INFINITY { f64::INFINITY } else { one + other }
}

impl Geometry for Sum {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        self.parts.iter().fold(0.0, |sum, shape| added(sum, shape.initial_gap(x1, x2)))
    }

    fn fill_gap_at(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
        gap.fill(0.0);
        let mut part = vec![0.0; gap.len()];
        for shape in &self.parts {
            shape.fill_gap_at(grid, by, &mut part);
            gap.iter_mut().zip(&part).for_each(|(sum, h)| *sum = added(*sum, *h));
        }
    }

    fn failure(&self) -> Option<UserError> {
        // the failures of all shapes are taken, and the first is returned
        self.parts.iter().fold(None, |first, shape| first.or(shape.failure()))
    }

    fn waves(&self) -> Vec<Waves> {
        self.parts.iter().flat_map(|shape| shape.waves()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{FlatPunch, FnGeometry, Sphere};

    #[test]
    fn gaps_add_up_and_infinity_prevails() {
        let sum =
            Sum::new(Sphere::new(0.5).unwrap(), FlatPunch::circular(1.0).unwrap()).and(FnGeometry::new(|x1, _| x1));
        assert_eq!(sum.initial_gap(0.5, 0.0), 0.75);
        assert_eq!(sum.initial_gap(1.5, 0.0), f64::INFINITY);
        let unknown = Sum::new(FnGeometry::new(|_, _| f64::NAN), FlatPunch::circular(1.0).unwrap());
        assert!(unknown.initial_gap(1.5, 0.0) == f64::INFINITY && unknown.initial_gap(0.5, 0.0).is_nan());
        let grid = Grid::square(4, 4.0).unwrap();
        let mut gap = vec![f64::NAN; 16];
        sum.fill_gap(&grid, &mut gap);
        assert_eq!((gap[0], gap[6]), (f64::INFINITY, sum.initial_gap(-0.5, 0.5)));
    }
}
