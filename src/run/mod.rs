//! Runs along a load history, of every contact.
//!
//! [`Run`] leads a contact in space ([`ViscoelasticContact`](crate::ViscoelasticContact)), on elastic states
//! ([`StatesContact`](crate::states::StatesContact)), or one of your own ([`Contact`]).

// `follow` takes the next step of any contact by its `control`: of given length, or as long as its error allows. Most
// contacts take steps twice (`doubled`), judged by what is known of their kind (`plain`, and in states). In space
// (`in_space`) `step_control` alone owns the length of a step: `adaptive_step` has it proposed, tries it, has it
// judged by its error (`accept_or_shorten`; the exceptions, tops of the load, jumps and what is not resolved, are in
// `StepSearch::judge`), and accepts it or tries again. Doubled steps are judged in `Doubled::step`, by a `Judge`. The error depends on the loads within the step (`track`, one
// for each body) and on what lies ahead and behind (`outlook`): the greatest loads and displacements of the run
// (`run_scale`), and what the steps so far leave (`past_steps`).

mod adaptive_step;
#[cfg(feature = "checkpoint")]
mod autosave;
pub(crate) mod control;
#[cfg(feature = "contacts")]
pub(crate) mod doubled;
mod error_budget;
mod event;
mod events;
mod extremes;
#[cfg(feature = "states")]
pub(crate) mod fields;
#[cfg(not(feature = "states"))]
#[path = "no_fields.rs"]
mod fields;
mod follow;
#[cfg(feature = "adhesion")]
mod halves;
#[cfg(not(feature = "adhesion"))]
#[path = "no_halves.rs"]
mod halves;
pub(crate) mod histories;
mod in_space;
mod outlook;
pub(crate) mod passage;
mod past_steps;
pub(crate) mod progress;
mod rises;
mod run_scale;
mod samples;
#[cfg(feature = "checkpoint")]
mod saving;
mod step_control;
pub(crate) mod trace;
mod track;

pub use crate::ascending::Times;
pub use control::FieldReport;
pub use error_budget::ErrorBudget;
pub use event::{Crossing, Event};
pub use follow::Run;
pub use progress::{RunProgress, Stepping};
pub use samples::Sample;

use std::fmt::Debug;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contact::StepReport;
use crate::error::{Error, Result};
use crate::fields::Fields;
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use control::Control;
use progress::Progress;

/// A contact that is advanced in time: in space ([`ViscoelasticContact`](crate::ViscoelasticContact)), on elastic
/// states ([`StatesContact`](crate::states::StatesContact)), or one of your own. Tables, charts and equations of
/// motion take any of them, and a [`Run`] leads any of them along a load history, in given steps or adaptive ones,
/// with samples, events and cancelling.
///
/// ```
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
///
/// # A contact of your own
/// Needs the feature `contacts`. Five methods are required. Adaptive steps of a run are then taken whole and in two halves, of which the halves are
/// kept; how far both are apart tells the error ([`Contact::difference`]). A spring beside a dashpot, stepped
/// implicitly:
///
/// ```
/// use viscocontact::prelude::*;
///
/// #[derive(Debug, Clone)]
/// struct SpringAndDashpot {
///     stiffness: f64,
///     damping: f64,
///     time: f64,
///     approach: f64,
///     force: f64,
/// }
///
/// impl Contact for SpringAndDashpot {
///     fn step_to(&mut self, time: f64, load: Load) -> viscocontact::Result<viscocontact::contact::StepReport> {
///         let dt = time - self.time;
///         match load {
///             // a jump of the force moves nothing
///             Load::Force { normal, .. } => {
///                 self.approach = (self.damping * self.approach + dt * normal) / (self.damping + dt * self.stiffness);
///                 self.force = normal;
///             }
///             Load::Approach { approach, .. } => {
///                 let rate = if dt > 0.0 { (approach - self.approach) / dt } else { 0.0 };
///                 (self.force, self.approach) = (self.stiffness * approach + self.damping * rate, approach);
///             }
///             _ => return Err(UserError::new("the contact", "it has no springs in series").into()),
///         }
///         self.time = time;
///         Ok(self.report(dt, load))
///     }
///
///     fn time(&self) -> f64 { self.time }
///     fn force(&self) -> f64 { self.force }
///     fn approach(&self) -> f64 { self.approach }
///     fn contact_area(&self) -> f64 { if self.force > 0.0 { 1.0e-6 } else { 0.0 } }
/// }
///
/// # use viscocontact::UserError;
/// let mut contact = SpringAndDashpot { stiffness: 2.0e3, damping: 1.0e3, time: 0.0, approach: 0.0, force: 0.0 };
/// let load = StepLoad::new(Load::force(1.0))?;
/// let mut run = contact
///     .follow(&load, Stepping::adaptive(1.0e-3), 2.0)
///     .sample_at([0.5])?
///     .stop_when(|contact| contact.approach(), Crossing::Up(2.0e-4))?;
/// while run.next_step()?.is_some() {
///     for sample in run.samples() {
///         let contact = sample?.contact().clone();
///         let exact = 0.5e-3 * (1.0 - (-2.0 * contact.time()).exp());
///         assert!((contact.approach() - exact).abs() < 2.0e-3 * 0.5e-3);
///     }
/// }
/// assert!((run.events()[0].times()[0] - 0.5 * (5.0_f64 / 3.0).ln()).abs() < 1e-3);
/// # Ok::<(), Error>(())
/// ```
pub trait Contact: Clone + Debug + Send + Sync + 'static {
    /// Advances to a `time` \[s\] under a load; to its own time for a jump. It ends exactly at this time. What it is
    /// after an error does not matter to runs, which go back to the state before.
    ///
    /// # Errors
    /// Of a contact of your own any [`Error`], a [`UserError`](crate::UserError) among them; else those
    /// of the `step` of the type.
    fn step_to(&mut self, time: f64, load: Load) -> Result<StepReport>;

    /// [`Contact::step_to`], ended within where another thread sets `cancelled`.
    #[doc(hidden)]
    fn step_to_unless(&mut self, _cancelled: Option<&AtomicBool>, time: f64, load: Load) -> Result<StepReport> {
        self.step_to(time, load)
    }

    /// Time \[s\].
    fn time(&self) -> f64;

    /// Normal force \[N\].
    fn force(&self) -> f64;

    /// Approach of the origin \[m\].
    fn approach(&self) -> f64;

    /// Contact area \[m²\].
    fn contact_area(&self) -> f64;

    /// Advances by `dt` \[s\] to a load; `dt` = 0 is a jump.
    ///
    /// # Errors
    /// As [`Contact::step_to`].
    fn step(&mut self, dt: f64, load: Load) -> Result<StepReport> {
        self.step_to(self.time() + dt, load)
    }

    /// Tilt along x1 and x2 \[rad\].
    fn tilt(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Whether the bodies are apart. [`StepReport::contact_cells`] does not tell: on states without cells it is
    /// always 0.
    fn is_separated(&self) -> bool {
        self.contact_area() == 0.0
    }

    /// Force over contact area \[Pa\]; 0 without contact.
    fn mean_pressure(&self) -> f64 {
        let area = self.contact_area();
        if area > 0.0 { self.force() / area } else { 0.0 }
    }

    /// The fields of a contact in space; `None` for one without, as on elastic states, which takes work to find them.
    fn in_space(&self) -> Option<Fields<'_>> {
        None
    }

    /// Whether forces may pull: whether surfaces attract each other.
    fn attracts(&self) -> bool {
        self.in_space().is_some_and(|fields| fields.attraction().is_some())
    }

    /// How far this outcome of a step is from another one of the same step, in approach \[m\] and force \[N\].
    /// Adaptive steps of a contact of your own keep it below the tolerance of the run, relative to what approach and
    /// force are, or to a tenth of the maximum so far. Add what differences of inner states may add to them later:
    /// a surface that recovers while bodies are apart shows in neither before they meet again.
    fn difference(&self, other: &Self) -> [f64; 2] {
        [self.approach() - other.approach(), self.force() - other.force()].map(f64::abs)
    }

    /// By how much approach and force of this outcome may be off besides by what happened within the halves of its step
    /// and shows neither in them nor in the whole, given the state before and that between: nothing, but where a body
    /// that slides sticks again.
    #[doc(hidden)]
    fn unseen(&self, _: [&Self; 2]) -> [f64; 2] {
        [0.0; 2]
    }

    /// Whether all of the contact slides: where what moves it turns, it sticks and slips anew, and the next step is as
    /// short as after a corner.
    #[doc(hidden)]
    fn slides(&self) -> bool {
        false
    }

    /// Takes forces along the surface that a history prescribes below these for none: where all loads go through nothing,
    /// normal ones that are lost in rounding carry none.
    #[doc(hidden)]
    fn neglect(&mut self, _: [f64; 3]) {}

    /// The report of a step of length `dt` to this state, without work: what [`Contact::step_to`] of a contact of
    /// your own returns.
    #[cfg(feature = "contacts")]
    fn report(&self, dt: f64, load: Load) -> StepReport {
        doubled::report(self, dt, load)
    }

    /// Columns of its own, names with units and values, which tables of its history have after the standard ones
    /// ([`CsvHistory`](crate::output::CsvHistory)); of states with friction what acts along the surface. Which ones
    /// they are must not change.
    fn columns(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }

    /// Follows a load history to the time `until` \[s\], in steps chosen by `stepping`.
    fn follow<'a>(&'a mut self, history: &'a dyn LoadHistory, stepping: Stepping, until: f64) -> Run<'a, Self> {
        Run::new(OwnedOrBorrowed::Borrowed(self), OwnedOrBorrowed::Borrowed(history), stepping, until)
    }

    /// Like [`Contact::follow`], for a run that owns the contact and its history. Such a run can be stored or sent to
    /// another thread.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// struct Simulation {
    ///     run: Run<'static>,
    /// }
    ///
    /// let contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// let load = StepLoad::new(Load::force(0.5))?;
    /// let mut simulation = Simulation { run: contact.into_follow(load, Stepping::fixed(0.5), 1.0) };
    /// while simulation.run.next_step()?.is_some() {}
    /// let contact = simulation.run.into_contact();
    /// assert_eq!(contact.time(), 1.0);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    fn into_follow(self, history: impl LoadHistory + 'static, stepping: Stepping, until: f64) -> Run<'static, Self> {
        Run::new(OwnedOrBorrowed::Owned(Box::new(self)), OwnedOrBorrowed::Owned(Box::new(history)), stepping, until)
    }

    #[doc(hidden)]
    fn temperature(&self) -> Option<&TemperatureHistory> {
        None
    }

    /// What acts along the surface besides the load.
    #[doc(hidden)]
    fn lateral(&self) -> &[Arc<dyn LoadHistory>] {
        &[]
    }

    /// The approach at which the upright bodies touch \[m\], if they never have.
    #[doc(hidden)]
    fn untouched(&self) -> Option<f64> {
        None
    }

    /// Whether a step failed with this error since its load is more than the contact can bear: a shorter step may not
    /// come so far.
    #[doc(hidden)]
    fn is_beyond(&self, _error: &Error) -> bool {
        false
    }

    /// Saves the contact with a run of doubled steps that continues from there.
    #[cfg(all(feature = "checkpoint", feature = "contacts"))]
    #[doc(hidden)]
    fn save_run(&self, _run: doubled::SavedRun<doubled::plain::Plain>, _path: &std::path::Path) -> Result<()> {
        Err(crate::error::coverage::RUN_IN_FILE.error())
    }

    /// Fails if the material of bodies that touch is not known until the end of a run.
    #[doc(hidden)]
    fn is_known_until(&self, _end: f64) -> Result<()> {
        Ok(())
    }

    /// Progress and control of a run that begins here, or that continues from this saved contact.
    #[cfg(feature = "contacts")]
    #[doc(hidden)]
    fn lead(&mut self, stepping: Stepping, until: f64) -> (Progress, Box<dyn Control<Self>>) {
        doubled::lead::<Self, doubled::plain::Plain>(self, None, stepping, until)
    }

    /// Progress and control of a run that begins here, or that continues from this saved contact.
    #[cfg(not(feature = "contacts"))]
    #[doc(hidden)]
    fn lead(&mut self, stepping: Stepping, until: f64) -> (Progress, Box<dyn Control<Self>>);
}

/// A value that a run borrows as `B` or owns as `O`.
#[derive(Debug)]
pub(crate) enum OwnedOrBorrowed<B, O> {
    Borrowed(B),
    Owned(O),
}

impl<T: Clone> OwnedOrBorrowed<&mut T, Box<T>> {
    fn into_owned(self) -> T {
        match self {
            OwnedOrBorrowed::Borrowed(value) => value.clone(),
            OwnedOrBorrowed::Owned(value) => *value,
        }
    }
}

impl<B: Deref, O: Deref<Target = B::Target>> Deref for OwnedOrBorrowed<B, O> {
    type Target = B::Target;

    fn deref(&self) -> &B::Target {
        match self {
            OwnedOrBorrowed::Borrowed(value) => value,
            OwnedOrBorrowed::Owned(value) => value,
        }
    }
}

impl<B: DerefMut, O: DerefMut<Target = B::Target>> DerefMut for OwnedOrBorrowed<B, O> {
    fn deref_mut(&mut self) -> &mut B::Target {
        match self {
            OwnedOrBorrowed::Borrowed(value) => value,
            OwnedOrBorrowed::Owned(value) => value,
        }
    }
}
