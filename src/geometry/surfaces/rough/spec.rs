//! Specification of a random rough surface.

use std::f64::consts::TAU;

use crate::error::{Refusal, Result, finite, positive, within};
use crate::rounded::rounded;
use crate::{Axis, Grid};

value! {
/// Specification of a self-affine random surface, [`Rough`](crate::geometry::Rough).
///
/// With the wave numbers q_l, q_r and q_s, 2π/λ of `longest`, `roll_off` and `shortest`, the power spectral density is
///
/// ```text
/// C(q) ∝ 1                     for q_l ≤ q < q_r
/// C(q) ∝ (q/q_r)^(−2(H + 1))   for q_r ≤ q < q_s
/// C(q) = 0                     elsewhere
/// ```
///
/// (Persson et al. 2005, *J. Phys.: Condens. Matter* 17). On a grid with a single row of cells the
/// surface is ridged; its profile has the exponent −(2H + 1) of a profile of such a surface.
///
/// ```
/// use viscocontact::geometry::{RoughSpec, Roughness};
///
/// // waves of 2 mm to 40 µm, the longest of the same strength down to 0.5 mm
/// let spec = RoughSpec::new(2.0e-3, 40.0e-6, Roughness::RmsHeight(1.0e-6)).with_roll_off(0.5e-3).with_seed(7);
/// assert_eq!(spec.hurst(), 0.8);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RoughSpec {
    /// Hurst exponent H, in (0, 1] (default: 0.8, as of many fractured, blasted and worn surfaces).
    hurst: f64, with_hurst;
    /// Longest wavelength \[m\].
    longest: f64;
    /// Wavelength \[m\] above which the spectrum is constant (default: `longest`, a spectrum without plateau).
    roll_off: f64, with_roll_off;
    /// Shortest wavelength \[m\], at least two cells of the grid.
    shortest: f64;
    /// Anisotropy of the spectrum (default: isotropic).
    anisotropy: Anisotropy, with_anisotropy;
    /// Roughness.
    roughness: Roughness;
    /// Seed of the random numbers (default: 0): the same seed and lengths give the same surface on every mesh that
    /// resolves it.
    seed: u64, with_seed;
}
}

value! {
/// Waves that are longer along one direction than across it, for instance after grinding. The spectrum is evaluated at
/// q = √((γ q_along)² + q_across²): the wavelengths of the [`RoughSpec`] are the wavelengths across.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Anisotropy {
    /// Ratio γ ≥ 1 of a wavelength along the direction to the wavelength across (default: 1).
    ratio: f64;
    /// Angle of the direction from x1 towards x2 \[rad\] (default: 0).
    direction: f64;
}
}

impl Anisotropy {
    /// Waves longer by `ratio` along the `direction` \[rad\] from x1 towards x2 than across it.
    pub const fn new(ratio: f64, direction: f64) -> Anisotropy {
        Anisotropy { ratio, direction }
    }
}

impl Default for Anisotropy {
    fn default() -> Anisotropy {
        Anisotropy::new(1.0, 0.0)
    }
}

/// Roughness of a surface, exact as a mean over its period.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Roughness {
    /// Root mean square of the height \[m\].
    RmsHeight(f64),
    /// Root mean square of the slope, the magnitude of the gradient.
    RmsSlope(f64),
}

/// Waves of 1 mm to 10 µm, with a height of 1 µm in the root mean square.
impl Default for RoughSpec {
    fn default() -> RoughSpec {
        RoughSpec::new(1.0e-3, 10.0e-6, Roughness::RmsHeight(1.0e-6))
    }
}

impl RoughSpec {
    /// Isotropic, of Hurst exponent 0.8 from the `longest` to the `shortest` wavelength \[m\], without plateau.
    /// Checked by
    /// [`Rough::new`](crate::geometry::Rough::new).
    pub const fn new(longest: f64, shortest: f64, roughness: Roughness) -> RoughSpec {
        let anisotropy = Anisotropy::new(1.0, 0.0);
        RoughSpec { hurst: 0.8, longest, roll_off: longest, shortest, anisotropy, roughness, seed: 0 }
    }

    /// Rejects values out of range or out of order, and waves that the grid does not resolve.
    pub(super) fn validate_on(&self, grid: &Grid) -> Result<()> {
        within("Hurst exponent", self.hurst, self.hurst > 0.0 && self.hurst <= 1.0, "in (0, 1]")?;
        positive("shortest wavelength", self.shortest)?;
        let in_order = self.longest >= self.shortest;
        within("longest wavelength", self.longest, in_order, "finite and >= the shortest wavelength")?;
        let in_order = self.roll_off >= self.shortest && self.roll_off <= self.longest;
        within("roll-off wavelength", self.roll_off, in_order, "between the shortest and the longest wavelength")?;
        let ratio = self.anisotropy.ratio;
        within("ratio of the anisotropy", ratio, ratio >= 1.0, "finite and >= 1")?;
        finite("direction of the anisotropy", self.anisotropy.direction)?;
        match self.roughness {
            Roughness::RmsHeight(height) => positive("rms height", height)?,
            Roughness::RmsSlope(slope) => positive("rms slope", slope)?,
        };
        let (cells, spacing) = (grid.cells(), grid.spacing());
        for axis in (0..2).filter(|&axis| cells[axis] > 1) {
            let (shortest, minimum) = (self.shortest, 2.0 * spacing[axis]);
            if shortest < minimum * (1.0 - 1e-12) {
                let needed = (minimum * cells[axis] as f64 / shortest * (1.0 - 1e-12)).ceil() as usize;
                let axis = Axis::BOTH[axis];
                let what = format!(
                    "shortest wavelength = {} m is not allowed: it must be at least two cells of the grid, which are \
                     {} m along {axis}",
                    rounded(shortest, 4),
                    rounded(minimum, 4)
                );
                let remedy = format!(": take a longer wavelength, or {needed} cells along {axis}");
                let range = "at least two cells of the grid";
                return Err(Refusal::value("map_too_fine", what, &remedy)
                    .naming("shortest wavelength")
                    .valued(shortest)
                    .allowing(range)
                    .into());
            }
        }
        Ok(())
    }

    /// Shortest wavelengths along x1 and x2 \[m\].
    pub(super) fn shortest_along_axes(&self) -> [f64; 2] {
        let (sin, cos) = self.anisotropy.direction.sin_cos();
        let ratio = self.anisotropy.ratio;
        [(cos / ratio).hypot(sin), (sin / ratio).hypot(cos)].map(|part| self.shortest / part)
    }

    /// Power spectral density at the wave numbers `q` \[rad/m\], 1 at the roll-off; for a profile if `line` is set.
    pub(super) fn density(&self, q: [f64; 2], line: bool) -> f64 {
        let (sin, cos) = self.anisotropy.direction.sin_cos();
        let (along, across) = (q[0] * cos + q[1] * sin, q[1] * cos - q[0] * sin);
        let q = (self.anisotropy.ratio * along).hypot(across);
        // Waves at the limits are treated alike on every mesh: the longest is included, the shortest is not.
        let rounding = 1e-12;
        if q < TAU / self.longest * (1.0 - rounding) || q > TAU / self.shortest * (1.0 - rounding) {
            return 0.0;
        }
        let exponent = if line { -(2.0 * self.hurst + 1.0) } else { -2.0 * (self.hurst + 1.0) };
        (q * self.roll_off / TAU).max(1.0).powf(exponent)
    }
}
