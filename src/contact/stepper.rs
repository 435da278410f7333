//! A contact: the object that users drive.

use std::any::Any;
use std::sync::Arc;

use crate::contact::{Computation, Scene, State};
#[cfg(feature = "checkpoint")]
use crate::equilibrium::Indenter;
use crate::fields::{About, Fields, Surface, View};

/// A rigid indenter pressed onto a creeping half-space: the pressure between them, the area they touch
/// on, and how both change with time.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let grid = Grid::square(64, 4.0e-3)?;
/// let mut contact = ViscoelasticContact::builder(grid)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
///     .build()?;
/// contact.step(0.0, Load::force(1.0))?; // Δ = 0: the load jumps
/// let before = contact.contact_area();
/// contact.step(0.5, Load::force(1.0))?; // hold it
/// assert!(contact.contact_area() > before);
/// assert!((contact.force() - 1.0).abs() < 1e-12);
/// # Ok::<(), viscocontact::Error>(())
/// ```
///
/// Force and approach may take turns, from step to step:
///
/// ```
/// # use viscocontact::prelude::*;
/// # let mut contact = ViscoelasticContact::builder(Grid::square(64, 4.0e-3)?)
/// #     .geometry(&Sphere::new(10.0e-3)?)
/// #     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
/// #     .build()?;
/// contact.step(0.0, Load::force(1.0))?;
/// let depth = contact.approach();
/// contact.step(1.0, Load::approach(depth))?; // hold the approach: the force relaxes
/// assert!(contact.force() < 0.5);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone)]
pub struct ViscoelasticContact {
    /// Grid, kernel, material and settings, which never change.
    pub(crate) scene: Arc<Scene>,
    /// The state, and the window and the trial that compute steps.
    pub(crate) computation: Computation,
    /// Fields on the whole grid, for users to read.
    pub(crate) view: View,
    /// The indenter as built, by which checkpoints tell scenes apart.
    #[cfg(feature = "checkpoint")]
    pub(crate) built: Arc<Indenter>,
    /// Progress of a run that was saved and resumed, for the next run to continue. Its type belongs to runs, which
    /// use contacts.
    pub(crate) saved_run: Option<Arc<dyn Any + Send + Sync>>,
}

impl ViscoelasticContact {
    pub(crate) fn new(scene: Scene, computation: Computation) -> ViscoelasticContact {
        let mut view = View::default();
        view.refresh(&computation.state.held);
        ViscoelasticContact {
            scene: Arc::new(scene),
            #[cfg(feature = "checkpoint")]
            built: Arc::clone(&computation.state.held.indenter),
            computation,
            view,
            saved_run: None,
        }
    }

    /// Its fields, and what follows from them.
    pub fn fields(&self) -> Fields<'_> {
        let (Scene { ground, material, temperature, .. }, Computation { state, window, .. }) =
            (&*self.scene, &self.computation);
        let State { held, history, clock, .. } = state;
        let surface = Surface { own: history.displacement(), far: history.far_source().map(|source| (1.0, source)) };
        let (time, material, temperature) = (Some(clock.time), Some(material), temperature.as_ref());
        let about = About { time, material, temperature };
        Fields { ground, held, surface, view: &self.view, kernel: Some(&window.kernel), about }
    }
}

impl<'a> From<&'a ViscoelasticContact> for Fields<'a> {
    fn from(contact: &'a ViscoelasticContact) -> Fields<'a> {
        contact.fields()
    }
}
