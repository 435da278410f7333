//! A contact: the object that users drive.

use std::any::Any;
use std::sync::Arc;

use crate::contact::{Computation, Scene, State, StepReport};
#[cfg(feature = "checkpoint")]
use crate::equilibrium::Indenter;
use crate::error::Result;
use crate::fields::{About, Fields, Surface, View};
use crate::geometry::Missed;
use crate::load::Load;

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
    /// What the grid misses of the waves of the shapes.
    pub(crate) missed: Missed,
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
    pub(crate) fn new(scene: Scene, computation: Computation, missed: Missed) -> ViscoelasticContact {
        let mut view = View::default();
        view.refresh(&computation.state.held);
        ViscoelasticContact {
            scene: Arc::new(scene),
            #[cfg(feature = "checkpoint")]
            built: Arc::clone(&computation.state.held.indenter),
            computation,
            missed,
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
        let about = About { time, reduced_time: clock.reduced_time, material, temperature };
        Fields { ground, held, surface, view: &self.view, kernel: Some(&window.kernel), about }
    }
}

/// A contact in space ([`ViscoelasticContact`]) or on elastic states
/// ([`StatesContact`](crate::states::StatesContact)): what tables, charts and equations of motion need of either.
///
/// ```
/// use viscocontact::contact::Contact;
/// use viscocontact::prelude::*;
///
/// /// Work that a motion to a depth and back takes.
/// fn loss(mut contact: impl Contact, depth: f64) -> viscocontact::Result<f64> {
///     let (mut work, mut before) = (0.0, [0.0; 2]);
///     for step in 1..=40 {
///         let approach = depth * (1.0 - f64::from(step - 20).abs() / 20.0);
///         let force = contact.step(0.05, Load::approach(approach))?.force;
///         work += 0.5 * (force + before[1]) * (approach - before[0]);
///         before = [approach, force];
///     }
///     Ok(work)
/// }
///
/// let (ball, body) = (10.0e-3, Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?));
/// let states = StatesContact::new(&ElasticStates::sphere(ball)?, &body)?;
/// let cells = ViscoelasticContact::builder(Grid::square(64, 4.0e-3)?).geometry(&Sphere::new(ball)?).material(body).build()?;
/// assert!((loss(cells, 2.0e-4)? / loss(states, 2.0e-4)? - 1.0).abs() < 1e-2);
/// # Ok::<(), Error>(())
/// ```
pub trait Contact: Clone {
    /// Advances by `dt` \[s\] to a load; `dt` = 0 is a jump.
    ///
    /// # Errors
    /// Those of the `step` of the type.
    fn step(&mut self, dt: f64, load: Load) -> Result<StepReport>;

    /// Time \[s\].
    fn time(&self) -> f64;

    /// Normal force \[N\].
    fn force(&self) -> f64;

    /// Approach of the origin \[m\].
    fn approach(&self) -> f64;

    /// Tilt along x1 and x2 \[rad\].
    fn tilt(&self) -> [f64; 2];

    /// Contact area \[m²\].
    fn contact_area(&self) -> f64;

    /// Whether the bodies are apart. [`StepReport::contact_cells`] does not tell: on states without cells it is
    /// always 0.
    fn is_separated(&self) -> bool;

    /// Force over contact area \[Pa\]; 0 without contact.
    fn mean_pressure(&self) -> f64 {
        let area = self.contact_area();
        if area > 0.0 { self.force() / area } else { 0.0 }
    }

    /// The fields of a contact in space; `None` for one on elastic states, which takes work to find them.
    fn in_space(&self) -> Option<Fields<'_>>;
}

impl<'a> From<&'a ViscoelasticContact> for Fields<'a> {
    fn from(contact: &'a ViscoelasticContact) -> Fields<'a> {
        contact.fields()
    }
}

impl Contact for ViscoelasticContact {
    fn step(&mut self, dt: f64, load: Load) -> Result<StepReport> {
        ViscoelasticContact::step(self, dt, load)
    }

    fn time(&self) -> f64 {
        ViscoelasticContact::time(self)
    }

    fn force(&self) -> f64 {
        self.fields().force()
    }

    fn approach(&self) -> f64 {
        self.fields().approach()
    }

    fn tilt(&self) -> [f64; 2] {
        self.fields().tilt()
    }

    fn contact_area(&self) -> f64 {
        self.fields().contact_area()
    }

    fn is_separated(&self) -> bool {
        self.fields().is_separated()
    }

    fn in_space(&self) -> Option<Fields<'_>> {
        Some(self.fields())
    }
}
