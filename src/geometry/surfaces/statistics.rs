//! Statistics of rough surfaces.

use std::f64::consts::{PI, TAU};

use crate::error::{Refusal, Result, finite, positive};
use crate::fft::waves;
use crate::geometry::HeightMap;

/// Statistics of a surface over its known points.
///
/// Slopes and curvatures of a periodic map without missing points follow from its Fourier series. On other maps they
/// are central differences over two cells, wherever all the points needed are known; they underestimate the slope of
/// waves a few cells long.
///
/// ```
/// use viscocontact::geometry::HeightMap;
///
/// let wave = (0..32).map(|i| 1e-6 * (i as f64 * std::f64::consts::TAU / 32.0).sin()).collect();
/// let statistics = HeightMap::new([32, 1], [1e-3, 1e-3], wave)?.periodic().statistics()?;
/// assert!((statistics.rms_height / (1e-6 / 2_f64.sqrt()) - 1.0).abs() < 1e-12);
/// assert!((statistics.kurtosis - 1.5).abs() < 1e-12);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SurfaceStatistics {
    /// Mean height \[m\].
    pub mean: f64,
    /// Root mean square of the height above the mean, S_q \[m\].
    pub rms_height: f64,
    /// Skewness of the heights, S_sk; 0 for a Gaussian surface, negative if valleys dominate over peaks.
    pub skewness: f64,
    /// Kurtosis of the heights, S_ku; 3 for a Gaussian surface.
    pub kurtosis: f64,
    /// Root mean square of the slope |∇z|, S_dq.
    pub rms_slope: f64,
    /// Root mean squares of ∂z/∂x1 and ∂z/∂x2; 0 along an axis without differences.
    pub rms_slopes: [f64; 2],
    /// Root mean square of the mean curvature, (∂²z/∂x1² + ∂²z/∂x2²)/2 \[1/m\].
    pub rms_curvature: f64,
}

/// An rms height below this, relative to the mean, is rounding.
const FLAT: f64 = 1e-14;

/// Mean squares of the derivatives ∂z/∂x1 and ∂z/∂x2 and of the mean curvature.
type MeanSquares = [f64; 3];

impl HeightMap {
    /// Statistics of the known points.
    ///
    /// # Errors
    /// If no height is known, all heights are equal, so that there is no distribution, or a statistic overflows `f64`.
    pub fn statistics(&self) -> Result<SurfaceStatistics> {
        self.require_known()?;
        let count = self.known().count() as f64;
        let mean = self.known().map(|z| z / count).sum::<f64>();
        let rms_height = self.known().map(|z| (z - mean).powi(2) / count).sum::<f64>().sqrt();
        // the rms height of equal heights is rounding
        let rms_height = positive("rms height", if rms_height <= FLAT * mean.abs() { 0.0 } else { rms_height })?;
        // In units of the rms height, whose fourth power may underflow.
        let scaled = |power: i32| self.known().map(|z| ((z - mean) / rms_height).powi(power) / count).sum::<f64>();
        let [slope1, slope2, curvature] = if self.is_periodic() && self.missing() == 0 {
            spectral_derivatives(self)
        } else {
            central_differences(self)
        };
        let rms_slopes = [finite("rms slope along x1", slope1.sqrt())?, finite("rms slope along x2", slope2.sqrt())?];
        Ok(SurfaceStatistics {
            mean,
            rms_height,
            skewness: finite("skewness of the heights", scaled(3))?,
            kurtosis: finite("kurtosis of the heights", scaled(4))?,
            rms_slope: rms_slopes[0].hypot(rms_slopes[1]),
            rms_slopes,
            rms_curvature: finite("rms curvature", curvature.sqrt())?,
        })
    }
}

/// From the Fourier series of a periodic map.
fn spectral_derivatives(map: &HeightMap) -> MeanSquares {
    waves(&map.grid(), map.heights()).fold([0.0; 3], |[a, b, c], (q, amplitude, count)| {
        let [q1, q2] = q.map(|q| q * q);
        let power = count * amplitude.norm_sqr();
        [a + power * q1, b + power * q2, c + power * (0.5 * (q1 + q2)).powi(2)]
    })
}

/// By central differences.
fn central_differences(map: &HeightMap) -> MeanSquares {
    let ([n1, n2], [s1, s2]) = (map.cells(), map.spacing());
    let (z, periodic) = (map.heights(), map.is_periodic());
    let neighbours = |index: usize, n: usize| {
        let inside = index > 0 && index + 1 < n;
        (n > 2 && (inside || periodic)).then(|| ((index + n - 1) % n, (index + 1) % n))
    };
    let (mut sums, mut counts) = ([0.0; 3], [0_usize; 3]);
    let mut add = |which: usize, value: f64| {
        if !value.is_nan() {
            sums[which] += value * value;
            counts[which] += 1;
        }
    };
    for i in 0..n1 {
        for j in 0..n2 {
            let here = z[i * n2 + j];
            let along1 = neighbours(i, n1).map(|(a, b)| (z[a * n2 + j], z[b * n2 + j]));
            let along2 = neighbours(j, n2).map(|(a, b)| (z[i * n2 + a], z[i * n2 + b]));
            let axes = [(along1, s1, n1), (along2, s2, n2)];
            for (axis, (pair, s, _)) in axes.into_iter().enumerate() {
                pair.into_iter().for_each(|(a, b)| add(axis, (b - a) / (2.0 * s)));
            }
            // A single row of points has no curvature across.
            let curvatures = axes
                .map(|(pair, s, n)| if n == 1 { Some(0.0) } else { pair.map(|(a, b)| (a - 2.0 * here + b) / (s * s)) });
            if let [Some(a), Some(b)] = curvatures {
                add(2, 0.5 * (a + b));
            }
        }
    }
    [0, 1, 2].map(|which| if counts[which] > 0 { sums[which] / counts[which] as f64 } else { 0.0 })
}

impl HeightMap {
    /// Power spectral density of the heights about their mean: wave numbers q \[rad/m\] and the radial mean of C \[m⁴\]
    /// at each, normalised so that
    ///
    /// ```text
    /// ∫ C(q) 2π q dq = ⟨(z − ⟨z⟩)²⟩,    0 < q < ∞
    /// ```
    ///
    /// except for the width 2π/L of the rings, where L is the shorter side, and for the waves in the corners beyond the
    /// last ring, whose wavelength is two cells of the coarser side. For a single row of points it is the spectrum of a
    /// profile \[m³\], with 2 ∫ C dq as the mean square. A map that is not periodic is weighted by a Hann window and
    /// corrected for the power lost; level the map first ([`HeightMap::leveled`]).
    ///
    /// # Errors
    /// If heights are missing: fill them or crop the map.
    pub fn power_spectrum(&self) -> Result<Vec<(f64, f64)>> {
        if self.missing() > 0 {
            let what = format!("{} heights of the map are missing", self.missing());
            let remedy = ": fill them with HeightMap::filled, or crop the map";
            return Err(Refusal::value("map_incomplete", what, remedy).into());
        }
        let (cells, lengths) = (self.cells(), self.lengths());
        let count = self.heights().len() as f64;
        let mean = self.heights().iter().map(|z| z / count).sum::<f64>();
        let mut field: Vec<f64> = self.heights().iter().map(|z| z - mean).collect();
        if !self.is_periodic() {
            let window = cells.map(hann);
            field.iter_mut().enumerate().for_each(|(k, z)| *z *= window[0][k / cells[1]] * window[1][k % cells[1]]);
        }
        let axes = || (0..2).filter(|&axis| cells[axis] > 1);
        // Each wave covers 2π/L1 by 2π/L2: its power over this area is the density.
        let area: f64 = axes().map(|axis| lengths[axis] / TAU).product();
        let width = axes().map(|axis| TAU / lengths[axis]).fold(0.0, f64::max);
        let last = axes().map(|axis| PI / self.spacing()[axis]).fold(f64::INFINITY, f64::min);
        if width == 0.0 {
            return Ok(Vec::new()); // a single point
        }
        let rings = (last / width * (1.0 + 1e-12)) as usize;
        let mut sums = vec![[0.0; 3]; rings + 1];
        for ([q1, q2], amplitude, number) in waves(&self.grid(), &field) {
            let q = q1.hypot(q2);
            if let Some(sum) = sums.get_mut((q / width).round() as usize) {
                let power = amplitude.norm_sqr();
                sum.iter_mut().zip([1.0, q, area * power]).for_each(|(s, value)| *s += number * value);
            }
        }
        let rings = sums.into_iter().skip(1).filter(|[count, ..]| *count > 0.0);
        Ok(rings.map(|[count, q, c]| (q / count, c / count)).collect())
    }
}

/// A Hann window over the points of an axis, normalised to a mean square of 1.
fn hann(n: usize) -> Vec<f64> {
    if n == 1 {
        return vec![1.0];
    }
    let window = (0..n).map(|i| 1.0 - (TAU * (i as f64 + 0.5) / n as f64).cos());
    let power = window.clone().map(|w| w * w).sum::<f64>() / n as f64;
    window.map(|w| w / power.sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;
    use crate::Grid;
    use crate::error::Error;
    use crate::geometry::{Anisotropy, Rough, RoughSpec, Roughness};

    fn rough(n: usize, hurst: f64, seed: u64) -> HeightMap {
        let spec = RoughSpec {
            hurst,
            longest: 2.0,
            roll_off: 0.25,
            shortest: 8.0 / n as f64,
            anisotropy: Anisotropy::default(),
            roughness: Roughness::RmsHeight(3e-3),
            seed,
        };
        Rough::new(&Grid::square(n, 2.0).unwrap(), spec).unwrap().height_map().clone()
    }

    /// Slope of log C over log q between two wave numbers, by least squares.
    fn slope(spectrum: &[(f64, f64)], from: f64, to: f64) -> f64 {
        let points = spectrum.iter().filter(|(q, _)| (from..to).contains(q)).map(|(q, c)| (q.ln(), c.ln()));
        let n = points.clone().count() as f64;
        let (x, y) = points.clone().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
        let (xy, xx) = points.fold((0.0, 0.0), |(a, b), (u, v)| (a + (u - x) * (v - y), b + (u - x) * (u - x)));
        xy / xx
    }

    #[test]
    fn a_wave_has_the_moments_of_a_wave() {
        let grid = Grid::new([32, 24], [1.0, 2.0]).unwrap();
        let (q1, q2) = (3.0 * TAU, 2.0 * PI);
        let heights = (0..grid.len()).map(|k| {
            let [x1, x2] = grid.center(k / 24, k % 24);
            5.0 + 0.1 * (q1 * x1 + q2 * x2).sin()
        });
        let map = HeightMap::new([32, 24], [1.0, 2.0], heights.collect()).unwrap();
        let exact = map.clone().periodic().statistics().unwrap();
        let rms = 0.1 / 2_f64.sqrt();
        assert_abs_diff_eq!(exact.mean, 5.0, epsilon = 1e-14);
        assert_abs_diff_eq!(exact.rms_height, rms, epsilon = 1e-14);
        assert_abs_diff_eq!(exact.skewness, 0.0, epsilon = 1e-12);
        assert_abs_diff_eq!(exact.kurtosis, 1.5, epsilon = 1e-12);
        assert_abs_diff_eq!(exact.rms_slopes[0], rms * q1, epsilon = 1e-12);
        assert_abs_diff_eq!(exact.rms_slopes[1], rms * q2, epsilon = 1e-12);
        assert_abs_diff_eq!(exact.rms_slope, rms * q1.hypot(q2), epsilon = 1e-12);
        assert_abs_diff_eq!(exact.rms_curvature, rms * 0.5 * (q1 * q1 + q2 * q2), epsilon = 1e-11);
        // Differences over two cells reduce slopes by sin(qs)/(qs), except at the ends, where they are missing.
        let seen = map.statistics().unwrap();
        assert_abs_diff_eq!(seen.rms_slopes[0], rms * (q1 / 32.0).sin() * 32.0, epsilon = 2e-2 * rms * q1);
        let curvature = 0.5 * (2.0 * (1.0 - (q1 / 32.0).cos()) * 1024.0 + 2.0 * (1.0 - (q2 / 12.0).cos()) * 144.0);
        assert_abs_diff_eq!(seen.rms_curvature, rms * curvature, epsilon = 2e-2 * rms * curvature);
        // With a missing point, a periodic map is differentiated by differences too.
        let mut holed = map.heights().to_vec();
        holed[100] = f64::NAN;
        let holed = HeightMap::new([32, 24], [1.0, 2.0], holed).unwrap().periodic();
        assert_abs_diff_eq!(holed.statistics().unwrap().rms_slopes[0], seen.rms_slopes[0], epsilon = 2e-2 * rms * q1);
    }

    #[test]
    fn spectra_of_rough_surfaces_have_their_exponent() {
        for (hurst, seed) in [(0.5, 1), (0.8, 2), (1.0, 3)] {
            let map = rough(256, hurst, seed);
            let (from, to) = (1.2 * TAU / 0.25, 0.9 * TAU * 32.0);
            let found = slope(&map.power_spectrum().unwrap(), from, to);
            assert!((found + 2.0 * (hurst + 1.0)).abs() < 0.15, "H = {hurst}: {found}");
            // A cropped map is not periodic.
            let part = map.cropped([20, 30], [160, 160]).unwrap();
            let found = slope(&part.power_spectrum().unwrap(), from, to);
            assert!((found + 2.0 * (hurst + 1.0)).abs() < 0.3, "window, H = {hurst}: {found}");
        }
    }

    #[test]
    fn spectra_integrate_to_the_mean_square() {
        let map = rough(128, 0.8, 4);
        let integral = |map: &HeightMap| {
            let (spectrum, width) = (map.power_spectrum().unwrap(), TAU / map.lengths()[0]);
            spectrum.iter().map(|(q, c)| c * TAU * q * width).sum::<f64>().sqrt()
        };
        assert!((integral(&map) / 3e-3 - 1.0).abs() < 0.05, "{}", integral(&map));
        // The mean over twenty surfaces, since the window weights the middle of each more.
        let seen = (0..20).map(|seed| integral(&rough(128, 0.8, seed).cropped([0, 0], [127, 127]).unwrap()));
        let mean = seen.sum::<f64>() / 20.0;
        assert!((mean / 3e-3 - 1.0).abs() < 0.05, "{mean}");
        let row: Vec<f64> = (0..64).map(|i| (TAU * 5.0 * i as f64 / 64.0).sin()).collect();
        let row = HeightMap::new([1, 64], [1.0, 2.0], row).unwrap().periodic().power_spectrum().unwrap();
        assert_abs_diff_eq!(row.iter().map(|(_, c)| 2.0 * c * PI).sum::<f64>(), 0.5, epsilon = 1e-13);
        assert!((row[4].0 - 5.0 * PI).abs() < 1e-12 && (row[4].1 - 0.25 / PI).abs() < 1e-13);
    }

    #[test]
    fn random_heights_are_gaussian() {
        // Many short waves: the fourth moment of their sum is the moment of a normal distribution.
        let map = rough(512, 0.3, 5);
        let statistics = map.statistics().unwrap();
        assert!(statistics.skewness.abs() < 0.2 && (statistics.kurtosis - 3.0).abs() < 0.3, "{statistics:?}");
        let (low, width) = (-12e-3, 0.6e-3);
        for bin in 0..40 {
            let from = low + width * f64::from(bin);
            let count = map.heights().iter().filter(|z| (from..from + width).contains(*z)).count();
            let density = count as f64 / map.heights().len() as f64 / width;
            let normal = |z: f64| (-0.5 * (z / 3e-3).powi(2)).exp() / (3e-3 * TAU.sqrt());
            let expected = normal(from + 0.5 * width);
            assert!((density - expected).abs() < 0.1 * normal(0.0), "{from}: {density} for {expected}");
        }
    }

    /// Slopes between points whose spacing is close to the smallest numbers overflow: an error by name, not NaN.
    #[test]
    fn overflowing_statistics_are_refused() {
        let heights = || vec![1.0, 3.0, -2.0, 7.0, 0.5, 4.0, 1.5, 2.0, 9.0];
        for lengths in [[1e-200, 1.0], [1.0, 1e-200], [1e-160, 1e-120]] {
            for map in [
                HeightMap::new([3, 3], lengths, heights()).unwrap(),
                HeightMap::new([3, 3], lengths, heights()).unwrap().periodic(),
            ] {
                let refused = map.statistics().unwrap_err();
                assert!(matches!(refused, Error::OutOfRange { field, .. } if field.starts_with("rms ")), "{refused}");
            }
        }
    }

    #[test]
    fn maps_without_statistics_are_refused() {
        let flat = HeightMap::new([3, 3], [1.0, 1.0], vec![0.1; 9]).unwrap();
        assert!(matches!(flat.statistics(), Err(Error::OutOfRange { field: "rms height", .. })));
        let empty = HeightMap::new([2, 1], [1.0, 1.0], vec![f64::NAN, 1.0]).unwrap();
        assert!(empty.power_spectrum().is_err_and(|error| error.code() == "map_incomplete"));
    }
}
