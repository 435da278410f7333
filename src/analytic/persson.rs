use num_complex::Complex64;

use crate::Grid;
use crate::error::{Result, finite, positive, within};
use crate::fft::waves;
use crate::geometry::{Geometry, evaluate};

/// Friction of a rubber on a rough surface by hysteresis, and its contact area, by Persson's theory (B. N. J.
/// Persson, J. Chem. Phys. 115, 2001, eqs. 24 to 28), summed over the waves h_q of a surface instead of integrated
/// over an isotropic spectrum:
///
/// μ = Σ |h_q|² |q| (q·v/v) S P Im E*(q·v)/2p₀, with P(q) = erf(1/(2√G)), G(q) = Σ |h_q′|² q′² |E*(q′·v)|²/8p₀² over
/// |q′| < |q|, and S = γ + (1 − γ) P².
///
/// It assumes that the area in contact shrinks with every finer wave as by a diffusion of the pressure, exactly so in
/// full contact; that what is in contact deforms as in full contact, but for the factor S, of which γ ≈ ½ is usual
/// and 1 the theory without it; and that waves have no correlation. So it is an estimate: contact problems of the
/// same surface differ from it by tens of percent, and by more at small contact areas. In full contact it is exact.
///
/// ```
/// use viscocontact::analytic::PerssonFriction;
/// use viscocontact::geometry::{Rough, RoughSpec, Roughness};
/// use viscocontact::num_complex::Complex64;
/// use viscocontact::prelude::*;
///
/// let grid = Grid::square(64, 1.0e-3)?;
/// let road = Rough::new(&grid, RoughSpec::new(5.0e-4, 6.0e-5, Roughness::RmsSlope(0.2)))?;
/// let rubber = GeneralizedMaxwell::new(1.0e6, &[(1.0e7, 1.0e-4)])?.creep_spectrum().unwrap().relaxation();
/// let modulus = |omega: f64| 4.0 * rubber.complex_modulus(omega);
/// let theory = PerssonFriction::new(&grid, &road, modulus, 1.0e5, [0.1, 0.0], 0.5)?;
/// assert!(theory.friction > 0.0 && theory.contact_share < 1.0);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PerssonFriction {
    /// Coefficient of friction μ.
    pub friction: f64,
    /// Part of the surface in contact: P of the finest wave.
    pub contact_share: f64,
}

/// Waves of which the lengths differ by less belong together.
const SAME: f64 = 1e-9;

impl PerssonFriction {
    /// Of a periodic `surface`, of which the grid is one period, on a body of the complex contact `modulus` E* \[Pa\]
    /// at frequencies ≥ 0 \[rad/s\] (4 G* if incompressible), under the mean `pressure` p₀ \[Pa\], with `velocity`
    /// \[m/s\] and the number γ.
    ///
    /// # Errors
    /// If the surface has no height somewhere, the pressure is not finite and positive, γ outside \[0, 1\], or
    /// velocity or friction not finite.
    pub fn new(
        grid: &Grid,
        surface: &dyn Geometry,
        modulus: impl Fn(f64) -> Complex64,
        pressure: f64,
        velocity: [f64; 2],
        gamma: f64,
    ) -> Result<PerssonFriction> {
        let heights = evaluate(surface, grid)?;
        heights.iter().try_for_each(|&height| finite("height of a rough surface", height).map(drop))?;
        positive("mean pressure", pressure)?;
        within("the number γ", gamma, (0.0..=1.0).contains(&gamma), "in [0, 1]")?;
        finite("velocity along x1", velocity[0])?;
        finite("velocity along x2", velocity[1])?;
        let speed = velocity[0].hypot(velocity[1]);
        // |q|, what the wave adds to G, and to the friction in full contact
        let wave = |(q, h, count): ([f64; 2], Complex64, f64)| {
            let (omega, length) = (q[0] * velocity[0] + q[1] * velocity[1], q[0].hypot(q[1]));
            let (square, stiffness) = (count * h.norm_sqr() / pressure, modulus(omega.abs()));
            let loss = if speed > 0.0 { length * (omega / speed) * stiffness.im * omega.signum() } else { 0.0 };
            [length, square * length * length * stiffness.norm_sqr() / (8.0 * pressure), 0.5 * square * loss]
        };
        let mut waves: Vec<[f64; 3]> = waves(grid, &heights).skip(1).map(wave).collect();
        waves.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let share = |g: f64| libm::erf(0.5 / g.sqrt());
        let (mut coarser, mut friction) = (0.0, 0.0);
        for same in waves.chunk_by(|a, b| b[0] - a[0] <= SAME * b[0]) {
            let own: f64 = same.iter().map(|wave| wave[1]).sum();
            let p = share(coarser + 0.5 * own);
            friction += (gamma + (1.0 - gamma) * p * p) * p * same.iter().map(|wave| wave[2]).sum::<f64>();
            coarser += own;
        }
        Ok(PerssonFriction {
            friction: finite("friction of a rough surface", friction)?,
            contact_share: share(coarser),
        })
    }
}
