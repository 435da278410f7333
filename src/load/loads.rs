//! The loads of the bodies in a step.

use crate::load::Load;

/// The loads at the end of a step: one [`Load`], or a slice with a load for each rigid body, in the order in which the builder
/// was given them. Methods take `impl Into<Loads<'_>>`: a load, or a reference to an array, a slice or a vector of loads.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let ball = |at: f64| Shifted::new(Sphere::new(5.0e-3)?, [at, 0.0]);
/// let mut contact = ViscoelasticContact::builder(Grid::new([64, 32], [8.0e-3, 4.0e-3])?)
///     .geometry(&ball(-2.0e-3)?)
///     .another_body(&ball(2.0e-3)?)
///     .material(Material::incompressible(KelvinVoigt::with_time(1.0e6, 1.0)?))
///     .build()?;
/// contact.step(0.1, &[Load::force(0.2), Load::approach(10.0e-6)])?;
/// assert!((contact.body(0).expect("the first").force - 0.2).abs() < 1.0e-12);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Loads<'a>(Of<'a>);

#[derive(Debug, Clone, Copy)]
enum Of<'a> {
    One([Load; 1]),
    Each(&'a [Load]),
}

impl Loads<'_> {
    pub(crate) fn as_slice(&self) -> &[Load] {
        match &self.0 {
            Of::One(load) => load,
            Of::Each(loads) => loads,
        }
    }
}

impl From<Load> for Loads<'_> {
    fn from(load: Load) -> Self {
        Loads(Of::One([load]))
    }
}

impl<'a, T: AsRef<[Load]> + ?Sized> From<&'a T> for Loads<'a> {
    fn from(loads: &'a T) -> Self {
        Loads(Of::Each(loads.as_ref()))
    }
}
