//! Random rough surfaces.

mod spec;

pub use spec::{Anisotropy, RoughSpec, Roughness};

use std::f64::consts::TAU;

use num_complex::Complex64;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::error::{Error, Result, within};
use crate::geometry::surfaces::height_map::not_finite;
use crate::geometry::surfaces::height_spectrum::{HeightSpectrum, wave_numbers};
use crate::geometry::{Geometry, HeightMap, Waves};
use crate::{Grid, memory};

/// A self-affine random surface: a sum of waves with Gaussian random amplitudes and the spectrum of a [`RoughSpec`].
///
/// The mean height is 0. The gap is the height of the highest point of the mesh above the surface. On the grid that it
/// was created for, the surface can be shifted exactly by any distance, because it has no waves that the grid does not
/// resolve; on other grids it is interpolated like a [`HeightMap`].
///
/// ```
/// use viscocontact::{geometry::Sum, prelude::*};
///
/// let grid = Grid::square(64, 1e-3)?;
/// let spec = RoughSpec::new(1e-3, 0.05e-3, Roughness::RmsHeight(1e-6)).with_roll_off(0.25e-3).with_seed(1);
/// let rough = Rough::new(&grid, spec)?;
/// let statistics = rough.height_map().statistics()?;
/// assert!((statistics.rms_height - 1e-6).abs() < 1e-15);
///
/// let rough_sphere = Sum::new(Sphere::new(0.1)?, rough);
/// # let _ = rough_sphere;
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rough {
    spec: RoughSpec,
    map: HeightMap,
}

impl Rough {
    /// A surface whose periods are the lengths of `grid`.
    ///
    /// # Errors
    /// If a value of the spec is out of range, the shortest wavelength is below two cells, or no wave of the spectrum
    /// fits the lengths. If there is no memory for waves and heights, 16 bytes per cell.
    pub fn new(grid: &Grid, spec: RoughSpec) -> Result<Rough> {
        let map = HeightMap::on(&Grid::of_spacing(grid.cells(), grid.spacing()), heights(grid, &spec)?);
        Ok(Rough { spec, map: map.periodic() })
    }

    /// A surface with a `period` \[m\] longer than the grid. The grid contains a part of it, which is not periodic.
    ///
    /// # Errors
    /// As [`Rough::new`], and if a period is shorter than the grid or not a whole number of its cells.
    pub fn windowed(grid: &Grid, spec: RoughSpec, period: [f64; 2]) -> Result<Rough> {
        let fields = ["period along x1", "period along x2"];
        let mut cells = [0; 2];
        for axis in 0..2 {
            let count = period[axis] / grid.spacing()[axis];
            let whole = (count - count.round()).abs() <= 1e-9 * count && count.round() >= grid.cells()[axis] as f64;
            within(fields[axis], period[axis], whole, "a whole number of cells and at least the length of the grid")?;
            cells[axis] = count.round() as usize;
        }
        // Checks the numbers of cells.
        Grid::new(cells, period)?;
        Rough::new(&Grid::of_spacing(cells, grid.spacing()), spec)
    }

    /// The specification of the surface.
    pub fn spec(&self) -> &RoughSpec {
        &self.spec
    }

    /// The heights of a whole period, as a periodic map.
    pub fn height_map(&self) -> &HeightMap {
        &self.map
    }
}

impl Geometry for Rough {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        self.map.initial_gap(x1, x2)
    }

    fn fill_gap_at(&self, grid: &Grid, by: [f64; 2], gap: &mut [f64]) {
        self.map.fill_gap_at(grid, by, gap);
    }

    fn waves(&self) -> Vec<Waves> {
        vec![Waves { period: self.map.lengths(), shortest: self.spec.shortest_along_axes() }]
    }
}

/// The heights of a whole period.
fn heights(grid: &Grid, spec: &RoughSpec) -> Result<Vec<f64>> {
    spec.validate_on(grid)?;
    memory::check("a rough surface", HeightSpectrum::bytes(grid.cells()) + 8 * grid.len() as u128)?;
    let (mut spectrum, sums) = waves(grid, spec);
    spectrum.scale(scale(spec, &sums)?);
    let heights = spectrum.heights();
    match heights.iter().position(|z| !z.is_finite()) {
        Some(entry) => Err(not_finite(entry, heights[entry])),
        None => Ok(heights),
    }
}

/// Random waves before they are scaled to the specified roughness, and the mean squares of height and slope of the
/// waves of each k2.
fn waves(grid: &Grid, spec: &RoughSpec) -> (HeightSpectrum, Vec<[f64; 2]>) {
    let (cells, lengths) = (grid.cells(), grid.lengths());
    let line = cells[0] == 1 || cells[1] == 1;
    // Highest wave along each axis: within the spectrum and below the Nyquist wave of the grid.
    let highest = [0, 1].map(|axis| {
        let resolved = (cells[axis] as i64 - 1) / 2;
        resolved.min((lengths[axis] / spec.shortest).ceil() as i64)
    });
    let origin = grid.center(0, 0);
    let mut random = ChaCha8Rng::seed_from_u64(spec.seed);
    let mut sums = vec![[0.0; 2]; cells[1] / 2 + 1];
    let mut spectrum = HeightSpectrum::zero(cells);
    for k1 in -highest[0]..=highest[0] {
        // The position in the random stream depends on the wave alone, so that it is the same on every mesh.
        random.set_stream(if k1 < 0 { -2 * k1 - 1 } else { 2 * k1 } as u64);
        random.set_word_pos(0);
        for (k2, sums) in (0..=highest[1]).zip(&mut sums) {
            let amplitude = gaussian(&mut random);
            if k2 == 0 && k1 <= 0 {
                continue; // conjugates of waves with k1 > 0, and the mean
            }
            let q = wave_numbers([k1, k2], lengths);
            let density = spec.density(q, line);
            if density > 0.0 {
                // The phase is relative to the middle of the grid.
                let amplitude = amplitude * density.sqrt() * Complex64::cis(q[0] * origin[0] + q[1] * origin[1]);
                spectrum.set([k1, k2], amplitude);
                sums[0] += 2.0 * amplitude.norm_sqr();
                sums[1] += 2.0 * amplitude.norm_sqr() * (q[0] * q[0] + q[1] * q[1]);
            }
        }
    }
    (spectrum, sums)
}

/// The factor that scales waves of these mean squares to the specified roughness.
fn scale(spec: &RoughSpec, sums: &[[f64; 2]]) -> Result<f64> {
    let [height, slope] = sums.iter().fold([0.0; 2], |[height, slope], sums| [height + sums[0], slope + sums[1]]);
    if height == 0.0 {
        let allowed = "short enough that a wave between shortest and longest fits the period";
        return Err(Error::OutOfRange { field: "shortest wavelength", value: spec.shortest, allowed });
    }
    Ok(match spec.roughness {
        Roughness::RmsHeight(wanted) => wanted / height.sqrt(),
        Roughness::RmsSlope(wanted) => wanted / slope.sqrt(),
    })
}

/// A complex number with independent standard normal parts (Box and Muller 1958).
fn gaussian(random: &mut ChaCha8Rng) -> Complex64 {
    // 53 bits each; the radius argument is never 0.
    let unit = 1.0 / (1_u64 << 53) as f64;
    let radius = ((random.next_u64() >> 11) as f64 + 1.0) * unit;
    let angle = (random.next_u64() >> 11) as f64 * unit;
    Complex64::from_polar((-2.0 * radius.ln()).sqrt(), TAU * angle)
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    const SPEC: RoughSpec = RoughSpec {
        hurst: 0.8,
        longest: 1.0,
        roll_off: 0.25,
        shortest: 1.0 / 15.0,
        anisotropy: Anisotropy { ratio: 1.0, direction: 0.0 },
        roughness: Roughness::RmsHeight(0.02),
        seed: 7,
    };

    fn field(grid: &Grid, shape: &dyn Geometry, by: [f64; 2]) -> Vec<f64> {
        let mut gap = vec![0.0; grid.len()];
        shape.fill_gap_at(grid, by, &mut gap);
        gap
    }

    #[test]
    fn rough_surfaces_have_the_specified_roughness() {
        for grid in [Grid::square(64, 1.0).unwrap(), Grid::new([48, 81], [1.0, 2.0]).unwrap()] {
            let by_height = Rough::new(&grid, SPEC).unwrap();
            let heights = by_height.height_map().heights();
            let mean = heights.iter().sum::<f64>() / grid.len() as f64;
            let rms = (heights.iter().map(|z| z * z).sum::<f64>() / grid.len() as f64).sqrt();
            assert!(mean.abs() < 1e-16 && (rms / 0.02 - 1.0).abs() < 1e-13);
            let by_slope = Rough::new(&grid, RoughSpec { roughness: Roughness::RmsSlope(0.3), ..SPEC }).unwrap();
            let statistics = by_slope.height_map().statistics().unwrap();
            assert_abs_diff_eq!(statistics.rms_slope / 0.3, 1.0, epsilon = 1e-12);
        }
    }

    #[test]
    fn a_seed_gives_the_same_surface_on_every_mesh() {
        let surface =
            |n: usize, seed: u64| Rough::new(&Grid::square(n, 1.0).unwrap(), RoughSpec { seed, ..SPEC }).unwrap();
        // Each cell of the coarse mesh is the middle one of three on the fine mesh.
        let (coarse, fine) = (surface(31, 7), surface(93, 7));
        for k in 0..31 * 31 {
            let (i, j) = (k / 31, k % 31);
            let (a, b) = (coarse.map.heights()[k], fine.map.heights()[(3 * i + 1) * 93 + 3 * j + 1]);
            assert!((a - b).abs() < 1e-14, "{a} and {b}");
        }
        assert_ne!(surface(31, 8).map, coarse.map);
    }

    #[test]
    fn rough_surfaces_are_shifted_exactly() {
        let rough = Rough::new(&Grid::square(32, 1.0).unwrap(), SPEC).unwrap();
        let fine = Rough::new(&Grid::square(320, 1.0).unwrap(), SPEC).unwrap();
        // The gaps have different reference points.
        let (grid, of_fine) = (Grid::square(32, 1.0).unwrap(), Grid::square(320, 1.0).unwrap());
        let (a, b) =
            (field(&grid, &rough, [0.3 / 32.0, -0.4 / 32.0]), field(&of_fine, &fine, [3.5 / 320.0, -4.5 / 320.0]));
        let datum = rough.map.heights()[0] + rough.initial_gap(-15.5 / 32.0, -15.5 / 32.0)
            - fine.map.heights()[0]
            - fine.initial_gap(-159.5 / 320.0, -159.5 / 320.0);
        for (k, here) in a.into_iter().enumerate() {
            let (i, j) = (k / 32, k % 32);
            // After the shift, the centre of a coarse cell is the centre of a fine cell.
            let at = b[(10 * i + 5) * 320 + (10 * j + 4)];
            assert!((here - at - datum).abs() < 1e-12, "{} and {}", here, at + datum);
        }
    }

    #[test]
    fn waves_are_longer_along_the_direction() {
        let grid = Grid::square(128, 1.0).unwrap();
        let lay = Anisotropy { ratio: 4.0, direction: std::f64::consts::FRAC_PI_2 };
        let rough = Rough::new(&grid, RoughSpec { anisotropy: lay, shortest: 1.0 / 40.0, ..SPEC }).unwrap();
        let slopes = rough.height_map().statistics().unwrap().rms_slopes;
        assert!((3.0..5.5).contains(&(slopes[0] / slopes[1])), "{slopes:?}");
    }

    #[test]
    fn a_window_is_a_part_of_its_period() {
        let grid = Grid::square(32, 1.0).unwrap();
        let wide = Rough::windowed(&grid, RoughSpec { longest: 2.0, ..SPEC }, [2.0, 1.5]).unwrap();
        assert_eq!(wide.height_map().cells(), [64, 48]);
        let (window, whole) = (field(&grid, &wide, [0.0; 2]), field(&wide.map.grid(), &wide, [0.0; 2]));
        for k in 0..32 * 32 {
            assert_eq!(window[k], whole[(k / 32 + 16) * 48 + k % 32 + 8]);
        }
        let row = Grid::new([64, 1], [1.0, 1.0]).unwrap();
        assert!(Rough::new(&row, SPEC).is_ok());
    }

    #[test]
    fn bad_specs_are_refused_by_name() {
        let grid = Grid::square(32, 1.0).unwrap();
        let refused = |spec: RoughSpec| match Rough::new(&grid, spec).unwrap_err() {
            Error::OutOfRange { field, .. } => field,
            other => panic!("unexpected {other}"),
        };
        assert_eq!(refused(RoughSpec { hurst: 1.1, ..SPEC }), "Hurst exponent");
        assert_eq!(refused(RoughSpec { longest: 0.06, ..SPEC }), "longest wavelength");
        assert_eq!(refused(RoughSpec { longest: 0.2, ..SPEC }), "roll-off wavelength");
        assert_eq!(refused(RoughSpec { roll_off: 0.01, ..SPEC }), "roll-off wavelength");
        let fine = Rough::new(&grid, RoughSpec { shortest: 0.06, ..SPEC }).unwrap_err();
        assert!(fine.code() == "map_too_fine", "{fine}");
        assert_eq!(refused(RoughSpec { roughness: Roughness::RmsSlope(0.0), ..SPEC }), "rms slope");
        let lay = Anisotropy { ratio: 0.5, direction: 0.0 };
        assert_eq!(refused(RoughSpec { anisotropy: lay, ..SPEC }), "ratio of the anisotropy");
        // With a period of 1 no wavelength lies between 1/√2 and 1, except wavelengths that the spectrum excludes.
        let between = RoughSpec { longest: 0.99, roll_off: 0.99, shortest: 0.72, ..SPEC };
        assert_eq!(refused(between), "shortest wavelength");
        for period in [[0.5, 1.0], [1.01, 1.0], [f64::NAN, 1.0]] {
            assert!(matches!(
                Rough::windowed(&grid, SPEC, period),
                Err(Error::OutOfRange { field: "period along x1", .. })
            ));
        }
    }
}
