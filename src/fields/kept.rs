//! Fields that outlive their contact.

use std::sync::Arc;

use crate::equilibrium::{Ground, Held, Region};
use crate::fields::{About, Fields, Surface, View};
use crate::rheology::{Material, TemperatureHistory};
use crate::solver::RigidMotion;

/// The fields of a contact as they were, made by [`Fields::keep`] and by what finds fields without a contact of their
/// own: about 24 bytes per computed cell, and the indenter is shared.
#[derive(Debug, Clone)]
pub struct KeptFields {
    ground: Ground,
    held: Held,
    displacement: Vec<f64>,
    far: Option<(f64, Vec<f64>)>,
    view: View,
    time: Option<f64>,
    reduced_time: f64,
    material: Option<Material>,
    temperature: Option<TemperatureHistory>,
}

impl KeptFields {
    /// The fields, and what follows from them.
    pub fn fields(&self) -> Fields<'_> {
        let KeptFields { ground, held, displacement, far, view, time, reduced_time, material, temperature } = self;
        let surface = Surface { own: displacement, far: far.as_ref().map(|(factor, source)| (*factor, &source[..])) };
        let (material, temperature) = (material.as_ref(), temperature.as_ref());
        let about = About { time: *time, reduced_time: *reduced_time, material, temperature };
        Fields { ground, held, surface, view, kernel: None, about }
    }

    /// The same with a pressure on the whole grid in the place of its own; `None` where not all of these cells are
    /// computed.
    pub(crate) fn with_pressure(mut self, pressure: &[f64]) -> Option<KeptFields> {
        let Held { region, current, .. } = &mut self.held;
        let n2 = region.whole.cells()[1];
        let pressed = |k: usize| pressure[k] > 0.0;
        if (0..pressure.len()).any(|k| pressed(k) && region.find([k / n2, k % n2]).is_none()) {
            return None;
        }
        current.contact_cells = (0..pressure.len()).filter(|k| pressed(*k)).count();
        for (k, own) in current.solution.pressure.iter_mut().enumerate() {
            let [i, j] = region.cell(k);
            *own = pressure[i * n2 + j];
        }
        self.held.sum_up();
        self.view.refresh(&self.held);
        Some(self)
    }
}

impl<'a> From<&'a KeptFields> for Fields<'a> {
    fn from(kept: &'a KeptFields) -> Fields<'a> {
        kept.fields()
    }
}

impl Fields<'_> {
    /// The fields of the same rigid body in a `motion`, under a pressure and over a displacement on the whole grid.
    pub(crate) fn keep_with(
        &self,
        pressure: Vec<f64>,
        displacement: Vec<f64>,
        motion: RigidMotion,
        time: f64,
    ) -> KeptFields {
        let Fields { ground, held: Held { indenter, .. }, .. } = self;
        let mut held = Held::layout(Arc::clone(indenter), Region::whole(&ground.grid, [false; 2]));
        held.current.contact_cells = pressure.iter().filter(|p| **p > 0.0).count();
        (held.current.solution.pressure, held.current.motions[0]) = (pressure, motion);
        held.sum_up();
        let (ground, far, view) = (Ground::clone(ground), None, View::default());
        let (material, temperature) = (None, None);
        KeptFields { ground, held, displacement, far, view, time: Some(time), reduced_time: 0.0, material, temperature }
    }

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
            reduced_time: about.reduced_time,
            material: about.material.cloned(),
            temperature: about.temperature.cloned(),
        }
    }
}
