//! Fields that outlive their contact.

use crate::equilibrium::{Ground, Held};
use crate::fields::{About, Fields, Surface, View};
use crate::rheology::{Material, TemperatureHistory};

/// The fields of a contact as they were, made by [`Fields::keep`] and by what finds fields without a contact of their
/// own: about 24 bytes per computed cell, and the indenter is shared.
#[derive(Debug, Clone)]
pub struct KeptFields {
    pub(super) ground: Ground,
    pub(super) held: Held,
    pub(super) displacement: Vec<f64>,
    pub(super) far: Option<(f64, Vec<f64>)>,
    pub(super) view: View,
    pub(super) time: Option<f64>,
    pub(super) material: Option<Material>,
    pub(super) temperature: Option<TemperatureHistory>,
}

impl KeptFields {
    /// The fields, and what follows from them.
    pub fn fields(&self) -> Fields<'_> {
        let KeptFields { ground, held, displacement, far, view, time, material, temperature } = self;
        let surface = Surface { own: displacement, far: far.as_ref().map(|(factor, source)| (*factor, &source[..])) };
        let (material, temperature) = (material.as_ref(), temperature.as_ref());
        let about = About { time: *time, material, temperature };
        Fields { ground, held, surface, view, kernel: None, about }
    }
}

impl<'a> From<&'a KeptFields> for Fields<'a> {
    fn from(kept: &'a KeptFields) -> Fields<'a> {
        kept.fields()
    }
}

impl Fields<'_> {
    /// A copy that outlives the contact.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// let before = contact.fields().keep();
    /// contact.step(1.0, Load::force(0.5))?;
    /// assert!(contact.contact_area() > before.fields().contact_area());
    /// # Ok::<(), Error>(())
    /// ```
    pub fn keep(&self) -> KeptFields {
        let Fields { ground, held, surface, view, about, .. } = self;
        let mut held = Held::clone(held);
        // no solution begins from it
        held.current.solution.potential = Vec::new();
        KeptFields {
            ground: Ground::clone(ground),
            held,
            displacement: surface.own.to_vec(),
            far: surface.far.map(|(factor, source)| (factor, source.to_vec())),
            view: View::clone(view),
            time: about.time,
            material: about.material.cloned(),
            temperature: about.temperature.cloned(),
        }
    }
}
