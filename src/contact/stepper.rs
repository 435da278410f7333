//! A contact: the object that users drive.

use std::sync::Arc;

use crate::contact::moving::along_path::IndenterBuffer;
use crate::contact::read::accessors::View;
use crate::contact::{Computation, Progress, Scene};

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
    pub(super) scene: Arc<Scene>,
    /// The state, and the window and the trial that compute steps.
    pub(super) computation: Computation,
    /// Fields on the whole grid, for users to read.
    pub(super) view: View,
    /// Progress of a run that was saved and resumed, for the next run to continue.
    pub(super) progress: Option<Box<Progress>>,
    /// Buffers for the indenter of the next step along a path.
    pub(super) indenter_buffer: IndenterBuffer,
}

impl ViscoelasticContact {
    pub(super) fn new(scene: Scene, computation: Computation) -> ViscoelasticContact {
        let mut view = View::default();
        view.refresh(&computation.state);
        ViscoelasticContact {
            scene: Arc::new(scene),
            computation,
            view,
            progress: None,
            indenter_buffer: IndenterBuffer::default(),
        }
    }
}
