//! A contact: the object that users drive.

use std::any::Any;
use std::sync::Arc;

use crate::contact::read::view::View;
use crate::contact::{Computation, Figures, Scene, State, StepReport, Warnings};
use crate::error::Result;
use crate::geometry::{Gap, Missed};
use crate::load::Load;
use crate::solver::RigidMotion;

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
    /// Progress of a run that was saved and resumed, for the next run to continue. Its type belongs to runs, which use contacts.
    pub(crate) saved_run: Option<Arc<dyn Any + Send + Sync>>,
}

impl ViscoelasticContact {
    pub(crate) fn new(scene: Scene, computation: Computation, missed: Missed) -> ViscoelasticContact {
        let mut view = View::default();
        view.refresh(&computation.state);
        ViscoelasticContact { scene: Arc::new(scene), computation, missed, view, saved_run: None }
    }

    /// The gap before the bodies deform.
    pub(crate) fn initial_gap(&self) -> &Gap {
        self.computation.state.indenter.gap()
    }

    /// The same contact with a pressure on the whole grid in the place of its own; `None` where it does not compute all of these cells.
    pub(crate) fn with_pressure(&self, pressure: &[f64]) -> Option<ViscoelasticContact> {
        let mut contact = self.clone();
        let State { region, current, .. } = &mut contact.computation.state;
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
        contact.computation.state.extrapolation.renew();
        contact.computation.state.sum_up();
        contact.view.refresh(&contact.computation.state);
        Some(contact)
    }

    /// Takes over the state of a steady motion, of which it has the fields but not the past.
    /// Returns the warnings of a step to it.
    pub(crate) fn show_steady(
        &mut self,
        load: Load,
        motion: RigidMotion,
        pressure: Vec<f64>,
        displacement: Vec<f64>,
    ) -> (Warnings, Figures) {
        let state = &mut self.computation.state;
        state.loads[0] = load;
        state.current.motions[0] = motion;
        self.computation.trial.solution.pressure.clone_from(&pressure);
        state.current.solution.pressure = pressure;
        state.history.show(displacement);
        state.sum_up();
        self.view.refresh(state);
        let pressed = self.computation.pressed(&self.scene, &self.computation.state.indenter);
        self.computation.state.current.contact_cells = pressed.cells;
        let StepReport { warnings, figures, .. } = self.report(None, pressed);
        (warnings | self.scene.limits.warnings(0.0, 0.0), figures)
    }

    /// Scales the pressure of a steady motion to that under `load`, of a body with moduli `factor` times as great.
    pub(crate) fn scale_steady(&mut self, load: Load, factor: f64) {
        if factor != 1.0 {
            let state = &mut self.computation.state;
            state.loads[0] = load;
            state.current.solution.pressure.iter_mut().for_each(|p| *p *= factor);
            state.sum_up();
            self.view.refresh(state);
        }
    }
}

/// A contact in space ([`ViscoelasticContact`]) or on elastic states ([`StatesContact`](crate::states::StatesContact)): what
/// tables, charts and equations of motion need of either.
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

    /// Whether the bodies are apart. [`StepReport::contact_cells`] does not tell: on states without cells it is always 0.
    fn is_separated(&self) -> bool;

    /// Force over contact area \[Pa\]; 0 without contact.
    fn mean_pressure(&self) -> f64 {
        let area = self.contact_area();
        if area > 0.0 { self.force() / area } else { 0.0 }
    }

    /// The contact in space, with pressures and cells; `None` for one on elastic states.
    fn in_space(&self) -> Option<&ViscoelasticContact>;
}

/// Implements [`Contact`] by methods of the type of the same names.
macro_rules! impl_contact {
    ($contact:ty, $in_space:expr) => {
        impl_contact!($contact, $in_space; time -> f64, force -> f64, approach -> f64, tilt -> [f64; 2], contact_area -> f64,
            is_separated -> bool);
    };
    ($contact:ty, $in_space:expr; $($read:ident -> $value:ty),*) => {
        impl $crate::contact::Contact for $contact {
            fn step(&mut self, dt: f64, load: $crate::load::Load) -> $crate::Result<$crate::contact::StepReport> {
                <$contact>::step(self, dt, load)
            }
            $(fn $read(&self) -> $value {
                <$contact>::$read(self)
            })*
            fn in_space(&self) -> Option<&$crate::ViscoelasticContact> {
                ($in_space)(self)
            }
        }
    };
}
pub(crate) use impl_contact;

impl_contact!(ViscoelasticContact, Some);
