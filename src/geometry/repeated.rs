use std::sync::Arc;

use crate::error::{Error, Result, UserError};
use crate::geometry::{Geometry, Waves};

/// Another shape repeated periodically, for periodic domains: its part within half a period of the origin is repeated.
///
/// ```
/// use viscocontact::geometry::{Geometry, Repeated, Sphere};
///
/// let row = Repeated::new(Sphere::new(1.0)?, [0.5, f64::INFINITY])?;
/// assert_eq!(row.initial_gap(1.5, 0.0), 0.0);
/// assert_eq!(row.initial_gap(0.0, 1.0), 0.5);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Repeated {
    shape: Arc<dyn Geometry>,
    period: [f64; 2],
}

impl Repeated {
    /// `shape` repeated with a `period` \[m\] along x1 and x2; `+∞` along an axis without repetition.
    ///
    /// # Errors
    /// If a period is not positive.
    pub fn new(shape: impl Geometry + 'static, period: [f64; 2]) -> Result<Repeated> {
        for (field, value) in [("period along x1", period[0]), ("period along x2", period[1])] {
            if value.is_nan() || value <= 0.0 {
                return Err(Error::OutOfRange { field, value, allowed: "> 0, or +∞ for no repetition" });
            }
        }
        Ok(Repeated { shape: Arc::new(shape), period })
    }

    /// The coordinate relative to the nearest periodic image of the origin.
    fn wrapped(&self, axis: usize, x: f64) -> f64 {
        let period = self.period[axis];
        let periods = (x / period).round();
        if period.is_finite() && periods.is_finite() { x - period * periods } else { x }
    }
}

impl Geometry for Repeated {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        self.shape.initial_gap(self.wrapped(0, x1), self.wrapped(1, x2))
    }

    fn failure(&self) -> Option<UserError> {
        self.shape.failure()
    }

    fn waves(&self) -> Vec<Waves> {
        let period = |own: [f64; 2]| {
            [0, 1].map(|axis| if self.period[axis].is_finite() { self.period[axis] } else { own[axis] })
        };
        let none = Waves { period: [f64::INFINITY; 2], shortest: [f64::INFINITY; 2] };
        self.shape.waves().into_iter().chain([none]).map(|own| Waves { period: period(own.period), ..own }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::geometry::{Cone, Shifted};

    #[test]
    fn shifted_repetitions_are_periodic() {
        let grid = Grid::new([8, 2], [8.0, 2.0]).unwrap();
        let cones = Repeated::new(Cone::new(1.0).unwrap(), [8.0, f64::INFINITY]).unwrap();
        let gap_at = |by: f64| {
            let mut gap = vec![0.0; 16];
            Shifted::new(cones.clone(), [by, 0.0]).unwrap().fill_gap(&grid, &mut gap);
            gap
        };
        assert_eq!(gap_at(3.0), gap_at(-5.0));
        assert_eq!(gap_at(3.0), gap_at(19.0));
        // The cone at 3 m extends across the periodic boundary: the cell at −3.5 m is 1.5 m from it.
        assert_eq!(gap_at(3.0)[0], 1.5_f64.hypot(0.5));
    }

    #[test]
    fn bad_periods_are_refused_by_name() {
        for bad in [0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
            let refused = Repeated::new(Cone::new(1.0).unwrap(), [1.0, bad]).unwrap_err();
            assert!(matches!(refused, Error::OutOfRange { field: "period along x2", .. }));
        }
    }
}
