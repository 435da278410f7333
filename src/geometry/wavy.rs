use std::f64::consts::PI;

use crate::error::{Result, length, positive};
use crate::geometry::{Geometry, Waves};

/// A wavy surface, A (1 − cos 2πx1/λ), or the sum of a wave along x1 and one along x2. A crest touches at the origin.
///
/// ```
/// use viscocontact::geometry::{Geometry, Wavy};
///
/// let wave = Wavy::new(1e-6, 1e-3)?;
/// assert_eq!(wave.initial_gap(0.0, 0.3e-3), 0.0);
/// assert_eq!(wave.initial_gap(0.5e-3, 0.0), 2e-6);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wavy {
    amplitude: [f64; 2],
    wavelength: [f64; 2],
}

impl Wavy {
    /// A wave along x1 of `amplitude` A \[m\], half the height from trough to crest, and `wavelength` λ \[m\].
    ///
    /// # Errors
    /// If amplitude or wavelength is not finite and positive, or the amplitude more than 1e300 m.
    pub fn new(amplitude: f64, wavelength: f64) -> Result<Wavy> {
        let amplitude = [length("amplitude along x1", amplitude)?, 0.0];
        Ok(Wavy { amplitude, wavelength: [positive("wavelength along x1", wavelength)?, f64::INFINITY] })
    }

    /// The sum of a wave along x1 and one along x2, with their amplitudes \[m\] and wavelengths \[m\].
    ///
    /// # Errors
    /// If an amplitude or wavelength is not finite and positive, or an amplitude more than 1e300 m.
    pub fn in_two_directions(amplitudes: [f64; 2], wavelengths: [f64; 2]) -> Result<Wavy> {
        let amplitude = [length("amplitude along x1", amplitudes[0])?, length("amplitude along x2", amplitudes[1])?];
        let wavelength =
            [positive("wavelength along x1", wavelengths[0])?, positive("wavelength along x2", wavelengths[1])?];
        Ok(Wavy { amplitude, wavelength })
    }
}

impl Geometry for Wavy {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        // 1 − cos 2a = 2 sin² a avoids cancellation near the crest.
        let wave = |axis: usize, x: f64| {
            let periods = x / self.wavelength[axis];
            // the number of periods overflows, and the phase is lost: any value of the wave serves
            let periods = if periods.is_finite() { periods } else { x % self.wavelength[axis] / self.wavelength[axis] };
            2.0 * self.amplitude[axis] * (PI * (periods - periods.round())).sin().powi(2)
        };
        wave(0, x1) + wave(1, x2)
    }

    fn waves(&self) -> Vec<Waves> {
        vec![Waves { period: self.wavelength, shortest: self.wavelength }]
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;
    use crate::error::Error;

    #[test]
    fn waves_match_their_formula() {
        let (a, b) = (2.0, 0.5);
        let wave = Wavy::in_two_directions([a, b], [3.0, 7.0]).unwrap();
        for (x1, x2) in [(0.3, -0.4), (100.1, 55.5), (-1.5, 3.5)] {
            let tau = 2.0 * PI;
            let expected = a * (1.0 - (tau * x1 / 3.0).cos()) + b * (1.0 - (tau * x2 / 7.0).cos());
            assert_abs_diff_eq!(wave.initial_gap(x1, x2), expected, epsilon = 1e-12);
        }
        let ridge = Wavy::new(a, 3.0).unwrap();
        assert_abs_diff_eq!(
            ridge.initial_gap(1e-9, 5.0) / (a * (2.0 * PI * 1e-9 / 3.0).powi(2) / 2.0),
            1.0,
            epsilon = 1e-12
        );
    }

    #[test]
    fn waves_stay_in_range_when_the_number_of_periods_overflows() {
        for (wavelength, x) in [(5e-324, 1.0), (1e-310, 1e10), (1e-200, f64::MAX), (5e-324, f64::MAX)] {
            let gap = Wavy::new(2.0, wavelength).unwrap().initial_gap(x, 0.0);
            assert!((0.0..=4.0).contains(&gap), "{gap} at {x:e} m of {wavelength:e} m");
        }
    }

    #[test]
    fn bad_waves_are_refused_by_name() {
        let field = |result: Result<Wavy>| match result.unwrap_err() {
            Error::OutOfRange { field, .. } => field,
            other => panic!("unexpected {other}"),
        };
        assert_eq!(field(Wavy::new(0.0, 1.0)), "amplitude along x1");
        // the height from trough to crest would overflow
        assert_eq!(field(Wavy::new(1e308, 1.0)), "amplitude along x1");
        assert_eq!(field(Wavy::new(1.0, f64::INFINITY)), "wavelength along x1");
        assert_eq!(field(Wavy::in_two_directions([1.0, f64::NAN], [1.0, 1.0])), "amplitude along x2");
        assert_eq!(field(Wavy::in_two_directions([1.0, 1.0], [1.0, -1.0])), "wavelength along x2");
    }
}
