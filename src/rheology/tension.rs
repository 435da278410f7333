/// A rheology of a rod: what the rheology inside gives as J(t) is the strain D(t) under unit tension, 1/E for an
/// elastic one, and every modulus that a model takes is a Young's modulus.
///
/// It is no [`Rheology`](crate::rheology::Rheology), so that only
/// [`Material::from_tension`](crate::rheology::Material::from_tension) and
/// [`Material::from_tension_elastic_bulk`](crate::rheology::Material::from_tension_elastic_bulk) take it: taken for
/// shear, a rod makes a body up to three times too stiff. Tables become one by
/// [`Measurements::fit_tension`](crate::rheology::Measurements::fit_tension), other models by name:
///
/// ```
/// use viscocontact::rheology::{Material, Tension, Zener};
///
/// let silicone = Tension(Zener::relaxing(3.0e6, 1.5e6, 0.1)?); // E(t) from 3 MPa to 1.5 MPa
/// let body = Material::from_tension(silicone, 0.49)?;
/// # let _ = body;
/// # Ok::<(), viscocontact::Error>(())
/// ```
///
/// A rod in place of shear does not compile, nor does shear in place of a rod:
///
/// ```compile_fail,E0277
/// use viscocontact::rheology::{Material, Tension, Zener};
///
/// let silicone = Tension(Zener::relaxing(3.0e6, 1.5e6, 0.1)?);
/// let body = Material::incompressible(silicone);
/// # Ok::<(), viscocontact::Error>(())
/// ```
///
/// ```compile_fail,E0308
/// use viscocontact::rheology::{Material, Zener};
///
/// let body = Material::from_tension(Zener::relaxing(3.0e6, 1.5e6, 0.1)?, 0.49)?;
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tension<R>(
    /// The rheology, in tension.
    pub R,
);
