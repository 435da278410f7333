//! Layers of finite thickness.

mod oscillation;
mod remainder;
mod table;
mod wave;

// against matrices of faer, which `data` brings
#[cfg(all(test, feature = "data"))]
mod tests;

use std::fmt;

pub(super) use remainder::Remainder;
use wave::Response;

use crate::error::{Result, length, poisson_ratio, within};

/// Ratio of the shear moduli of a layer and its base.
const SHEAR_RATIOS: std::ops::RangeInclusive<f64> = 1e-6..=1e6;
/// Compliance in the mean, over the thickness, below which a layer yields mostly by being squeezed out.
const SQUEEZED: f64 = 0.02;

/// A layer of finite thickness on a base: a rubber sheet on steel, a gel on glass, a coating.
///
/// Its thickness h and Poisson's ratio ν, and what holds it below. C(t) belongs to the layer's material; the layer's
/// [`InfluenceKernel`](crate::InfluenceKernel) K holds the rest: a wave of pressure q displaces the surface by C
/// (2/q) L(qh), where L = 1 is a half-space ([`Layer::compliance`]).
///
/// | base | long waves, L → | in the mean, K = |
/// |---|---|---|
/// | [`Layer::bonded_to_rigid`] | (1 − 2ν)/(2 (1 − ν)²) qh, 2 (qh)³/3 if ν = ½ | h (1 − 2ν)/(1 − ν)² |
/// | [`Layer::frictionless_on_rigid`] | qh/2 | the same |
/// | [`Layer::bonded_to_half_space`] | (G₁/G₂)(1 − ν₂)/(1 − ν₁) | unbounded |
///
/// Kernels are made of it by [`InfluenceKernel::layer`](crate::InfluenceKernel::layer), loaded on the grid alone,
/// [`layer_periodic`](crate::InfluenceKernel::layer_periodic) along both axes,
/// [`layer_periodic_along`](crate::InfluenceKernel::layer_periodic_along) one of them, and
/// [`layer_line`](crate::InfluenceKernel::layer_line) in plane strain.
///
/// On a rigid base the surface far from a load is at rest, and the approach of the indenter is measured from there,
/// in line contact too. The mean belongs to a layer compressed everywhere, with no free side: its oedometric
/// compliance, zero for an incompressible one.
///
/// Layer and base creep by one function C(t). A base that is much stiffer than the layer, as steel below rubber, is
/// rigid; one that creeps as the layer does is a half-space ([`Layer::bonded_to_half_space`]). The layer's ν must equal
/// the material's, and constant: the contact is refused with another one, with
/// [`Material::elastic_bulk`](crate::rheology::Material::elastic_bulk), and with a counter body that deforms.
///
/// A layer must be modelled where the contact radius is more than a tenth of its thickness: at a/h = 0.1 a bonded
/// incompressible layer is 12 % stiffer under a ball than a half-space at the same depth (docs/accuracy.md).
///
/// ```
/// use viscocontact::prelude::*;
///
/// // a gel of 100 µm on glass under a ball of 50 µm
/// let grid = Grid::square(64, 60.0e-6)?;
/// let layer = Layer::bonded_to_rigid(100.0e-6, 0.5)?;
/// let kernel = InfluenceKernel::layer(&grid, layer)?;
/// let mut contact = ViscoelasticContact::builder(grid)
///     .geometry(&Sphere::new(50.0e-6)?)
///     .material(Material::incompressible(Zener::with_time(1.0e3, 1.0e3, 1.0)?))
///     .kernel(kernel)
///     .build()?;
/// contact.step(0.0, Load::force(50.0e-9))?;
/// contact.step(1.0, Load::force(50.0e-9))?;
/// assert!(contact.approach() > 0.0);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    thickness: f64,
    poisson: f64,
    base: Base,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Base {
    Bonded,
    Frictionless,
    HalfSpace { shear_ratio: f64, poisson: f64 },
}

impl Layer {
    /// A layer bonded to a rigid base: no point of its lower side moves. `thickness` \[m\], Poisson's ratio `nu`.
    ///
    /// # Errors
    /// If the thickness is not finite, > 0 and at most 1e300 m, or `nu` is outside (−1, ½].
    pub fn bonded_to_rigid(thickness: f64, nu: f64) -> Result<Layer> {
        Layer::new(thickness, nu, Base::Bonded)
    }

    /// A layer on a rigid base along which it slides without friction, and from which it is not lifted. `thickness`
    /// \[m\], Poisson's ratio `nu`, on which only the response in the mean depends.
    ///
    /// # Errors
    /// As [`Layer::bonded_to_rigid`].
    pub fn frictionless_on_rigid(thickness: f64, nu: f64) -> Result<Layer> {
        Layer::new(thickness, nu, Base::Frictionless)
    }

    /// A layer bonded to a half-space of another stiffness: `thickness` \[m\], Poisson's ratio `nu`, the shear
    /// modulus of the layer over the modulus of the base, G₁/G₂ at all times, and Poisson's ratio of the base
    /// `base_nu`.
    ///
    /// # Errors
    /// As [`Layer::bonded_to_rigid`]; if `shear_ratio` is not in \[1e-6, 1e6\], or `base_nu` is outside (−1, ½].
    pub fn bonded_to_half_space(thickness: f64, nu: f64, shear_ratio: f64, base_nu: f64) -> Result<Layer> {
        let inside = SHEAR_RATIOS.contains(&shear_ratio);
        within("shear modulus of a layer over that of its base", shear_ratio, inside, "in [1e-6, 1e6]")?;
        let poisson = poisson_ratio("Poisson's ratio of the base", base_nu)?;
        Layer::new(thickness, nu, Base::HalfSpace { shear_ratio, poisson })
    }

    fn new(thickness: f64, nu: f64, base: Base) -> Result<Layer> {
        let thickness = length("thickness of a layer", thickness)?;
        Ok(Layer { thickness, poisson: poisson_ratio("Poisson's ratio of a layer", nu)?, base })
    }

    /// The thickness h \[m\].
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Poisson's ratio of the layer.
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson
    }

    /// The displacement of the surface, over C, under a unit wave of pressure of wave number `q` \[1/m\] ≥ 0: (2/q)
    /// L(qh) \[m\], right to rounding. At q = 0 the response in the mean, +∞ on a half-space; NaN for a negative q.
    ///
    /// ```
    /// use viscocontact::Layer;
    ///
    /// let sheet = Layer::bonded_to_rigid(1.0e-3, 0.3)?;
    /// // waves shorter than the thickness meet a half-space, 2/q
    /// assert!((sheet.compliance(2.0e4) - 1.0e-4).abs() < 1e-14);
    /// // and a uniform pressure compresses the sheet
    /// assert!((sheet.compliance(0.0) - 1.0e-3 * 0.4 / 0.49).abs() < 1e-18);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn compliance(&self, q: f64) -> f64 {
        if q > 0.0 {
            2.0 / q * self.response().at(q * self.thickness)
        } else if q == 0.0 {
            self.mean()
        } else {
            f64::NAN
        }
    }

    /// The response to a uniform pressure on the whole endless surface.
    pub(super) fn mean(&self) -> f64 {
        match self.base {
            Base::Bonded | Base::Frictionless => {
                self.thickness * (1.0 - 2.0 * self.poisson) / ((1.0 - self.poisson) * (1.0 - self.poisson))
            }
            Base::HalfSpace { .. } => f64::INFINITY,
        }
    }

    /// Whether the surface is at rest far from a load.
    pub(crate) fn is_on_rigid(&self) -> bool {
        !matches!(self.base, Base::HalfSpace { .. })
    }

    /// How much softer than the half-space of its own material it is for the longest waves: zero on a rigid base.
    pub(crate) fn longest_over_half_space(&self) -> f64 {
        self.response().at(0.0)
    }

    /// The part of the displacement under a contact of this `area` \[m²\] that the layer takes, and not its base. A
    /// square of side L yields like the wave 2.1/L.
    pub(crate) fn share(&self, area: f64) -> f64 {
        let yields = self.response().at(2.1 / area.sqrt() * self.thickness);
        if self.is_on_rigid() { 1.0 } else { (1.0 - self.longest_over_half_space() / yields).max(0.0) }
    }

    /// Whether the layer yields to long waves only by being squeezed out.
    pub(super) fn is_squeezed(&self) -> bool {
        self.base == Base::Bonded && self.mean() < SQUEEZED * self.thickness
    }

    fn response(&self) -> Response {
        match self.base {
            Base::Bonded => Response::bonded(self.poisson, 0.5, 0.0),
            Base::Frictionless => Response::Frictionless,
            Base::HalfSpace { shear_ratio, poisson } => Response::bonded(self.poisson, poisson, shear_ratio),
        }
    }
}

/// "layer of 1e-4 m, ν = 0.5, bonded to a rigid base".
impl fmt::Display for Layer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "layer of {:e} m, ν = {}, ", self.thickness, self.poisson)?;
        match self.base {
            Base::Bonded => write!(f, "bonded to a rigid base"),
            Base::Frictionless => write!(f, "sliding on a rigid base"),
            Base::HalfSpace { shear_ratio, poisson } => {
                write!(f, "bonded to a half-space, G₁/G₂ = {shear_ratio:e}, ν₂ = {poisson}")
            }
        }
    }
}
