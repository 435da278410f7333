//! Specification of a random rough surface.

use std::f64::consts::TAU;

use crate::error::{Result, finite, positive, within};

/// Specification of a self-affine random surface, [`Rough`](crate::geometry::Rough).
///
/// With the wave numbers q_l, q_r and q_s, 2π/λ of `longest`, `roll_off` and `shortest`, the power spectral density is
///
/// $$ C(q) \propto \begin{cases} 1 & q_l \le q < q_r \\\\ (q/q_r)^{-2(H+1)} & q_r \le q < q_s \\\\
///    0 & \text{else} \end{cases} $$
///
/// (Persson et al. 2005, *J. Phys.: Condens. Matter* 17). On a grid with a single row of cells the
/// surface is ridged; its profile has the exponent −(2H + 1) of a profile of such a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughSpec {
    /// Hurst exponent H, in (0, 1]; 0.8 for many fractured, blasted and worn surfaces.
    pub hurst: f64,
    /// Longest wavelength \[m\].
    pub longest: f64,
    /// Wavelength \[m\] above which the spectrum is constant; `longest` for a spectrum without plateau.
    pub roll_off: f64,
    /// Shortest wavelength \[m\], at least two cells of the grid.
    pub shortest: f64,
    /// Anisotropy of the spectrum; `Anisotropy::default()` is isotropic.
    pub anisotropy: Anisotropy,
    /// Roughness.
    pub roughness: Roughness,
    /// Seed of the random numbers: the same seed and lengths give the same surface on every mesh that resolves it.
    pub seed: u64,
}

/// Waves that are longer along one direction than across it, for instance after grinding. The spectrum is evaluated at
/// q = √((γ q_along)² + q_across²), so that the wavelengths of the [`RoughSpec`] are those across.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anisotropy {
    /// Ratio γ ≥ 1 of a wavelength along the direction to the one across (default: 1).
    pub ratio: f64,
    /// Angle of the direction from x1 towards x2 \[rad\] (default: 0).
    pub direction: f64,
}

impl Default for Anisotropy {
    fn default() -> Anisotropy {
        Anisotropy { ratio: 1.0, direction: 0.0 }
    }
}

/// Roughness of a surface, which it has exactly as a mean over its period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Roughness {
    /// Root mean square of the height \[m\].
    RmsHeight(f64),
    /// Root mean square of the slope, the magnitude of the gradient.
    RmsSlope(f64),
}

impl RoughSpec {
    /// Checks the ranges and the order of the values.
    pub(super) fn validate(&self) -> Result<()> {
        within("Hurst exponent", self.hurst, self.hurst > 0.0 && self.hurst <= 1.0, "in (0, 1]")?;
        positive("shortest wavelength", self.shortest)?;
        let in_order = self.roll_off >= self.shortest;
        within("roll-off wavelength", self.roll_off, in_order, "finite and >= the shortest wavelength")?;
        let in_order = self.longest >= self.roll_off;
        within("longest wavelength", self.longest, in_order, "finite and >= the roll-off wavelength")?;
        let ratio = self.anisotropy.ratio;
        within("ratio of the anisotropy", ratio, ratio >= 1.0, "finite and >= 1")?;
        finite("direction of the anisotropy", self.anisotropy.direction)?;
        match self.roughness {
            Roughness::RmsHeight(height) => positive("rms height", height)?,
            Roughness::RmsSlope(slope) => positive("rms slope", slope)?,
        };
        Ok(())
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
