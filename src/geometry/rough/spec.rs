//! What a random surface is asked to be.

use std::f64::consts::TAU;

use crate::error::{Result, finite, positive, within};

/// What a self-affine random surface ([`Rough`](crate::geometry::Rough)) is asked to be.
///
/// With q_l, q_r and q_s the wave numbers 2π/λ of `longest`, `roll_off` and `shortest`, the power spectral density is
///
/// $$ C(q) \propto \begin{cases} 1 & q_l \le q < q_r \\\\ (q/q_r)^{-2(H+1)} & q_r \le q < q_s \\\\
///    0 & \text{else} \end{cases} $$
///
/// (Persson et al. 2005, *J. Phys.: Condens. Matter* 17). On a grid of a single row of cells the surface is a ridged
/// one, whose profile has the exponent −(2H + 1) instead, that of a profile of such a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughSpec {
    /// Hurst exponent H, in (0, 1]; 0.8 for many fractured, blasted and worn surfaces.
    pub hurst: f64,
    /// Longest wavelength \[m\].
    pub longest: f64,
    /// Wavelength \[m\] above which the spectrum no longer grows; `longest` for one without a plateau.
    pub roll_off: f64,
    /// Shortest wavelength \[m\], two cells of the grid at least.
    pub shortest: f64,
    /// Whether waves are longer along one direction; not for `Anisotropy::default()`.
    pub anisotropy: Anisotropy,
    /// How rough it is.
    pub roughness: Roughness,
    /// Which of all such surfaces: the same seed and lengths give the same surface on every mesh that resolves it.
    pub seed: u64,
}

/// Waves longer along one direction than across, as left by grinding: the spectrum is that of
/// q = √((γ q_along)² + q_across²), so that the wavelengths of the [`RoughSpec`] are those across.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anisotropy {
    /// Ratio γ of a wavelength along the direction to the one across, 1 or more (default: 1).
    pub ratio: f64,
    /// Angle of the direction from x1 towards x2 \[rad\] (default: 0).
    pub direction: f64,
}

impl Default for Anisotropy {
    fn default() -> Anisotropy {
        Anisotropy { ratio: 1.0, direction: 0.0 }
    }
}

/// How rough a surface is: what it gets exactly, as a mean over its period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Roughness {
    /// Root mean square of the height \[m\].
    RmsHeight(f64),
    /// Root mean square of the slope, of the absolute value of its gradient.
    RmsSlope(f64),
}

impl RoughSpec {
    /// Refuses what is no spectrum.
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

    /// The power spectral density at wave numbers \[rad/m\], 1 at the roll-off; of a profile where `line` says so.
    pub(super) fn density(&self, q: [f64; 2], line: bool) -> f64 {
        let (sin, cos) = self.anisotropy.direction.sin_cos();
        let (along, across) = (q[0] * cos + q[1] * sin, q[1] * cos - q[0] * sin);
        let q = (self.anisotropy.ratio * along).hypot(across);
        // Waves on the limits count alike on every mesh: the longest does, the shortest does not.
        let rounding = 1e-12;
        if q < TAU / self.longest * (1.0 - rounding) || q > TAU / self.shortest * (1.0 - rounding) {
            return 0.0;
        }
        let exponent = if line { -(2.0 * self.hurst + 1.0) } else { -2.0 * (self.hurst + 1.0) };
        (q * self.roll_off / TAU).max(1.0).powf(exponent)
    }
}
