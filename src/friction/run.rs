//! Runs of contacts with friction.

#[cfg(feature = "checkpoint")]
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::contact::StepReport;
use crate::error::{Error, Result};
use crate::fields::Fields;
use crate::friction::contact::FrictionContact;
use crate::friction::load::{Component, ShearLoad, size};
use crate::friction::problem::Cell;
use crate::friction::report::Outcome;
use crate::friction::shear_history::ShearHistory;
use crate::friction::state::State;
use crate::load::{Load, LoadHistory};
use crate::rheology::TemperatureHistory;
use crate::run::control::Control;
use crate::run::doubled::judge::SMALL;
use crate::run::doubled::turned_back::turned_back;
#[cfg(feature = "checkpoint")]
use crate::run::doubled::{SavedRun, plain::Plain};
use crate::run::passage::Span;
use crate::run::progress::Progress;
use crate::run::{Contact, Stepping, doubled};

/// Tolerance of the solver over that of a run, in adaptive steps.
const SOLVER_SHARE: f64 = 1e-4;
/// Cells are met one by one, and how far each has slipped by then does not converge with the step: differences below
/// this part of the tolerance are not resolved.
const UNRESOLVED: f64 = 2e-3;
/// The most accurate solver of a run.
const MOST_ACCURATE: f64 = 1e-11;

impl FrictionContact {
    /// With what acts along the surface in steps of a [`Run`](crate::run::Run), which ends its steps at the corners and
    /// jumps of all histories; where pressure and shear jump at once, by oblique loading. Without it no force acts
    /// along the surface of a body that does not turn.
    ///
    /// Adaptive steps keep the error of motions and forces along the surface, relative to their maximum so far, of the
    /// work and of the loss by slip within the tolerance besides that of approach and force, and solve to 1e-4 of it.
    /// Forces along the surface below 2e-16 of the maximum of a run are none, as normal loads are.
    /// Work and loss count as at least a tenth of the largest motion times the largest force. More than friction carries
    /// ends the run with [`Error::Slides`]; [`FrictionContact::load_share`] tells before.
    ///
    /// ```
    /// use viscocontact::friction::{Coulomb, FrictionContact, ShearHistory};
    /// use viscocontact::prelude::*;
    ///
    /// let ball = ViscoelasticContact::builder(Grid::square(24, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?));
    /// let shear = ShearHistory::new(
    ///     Ramp::new(Load::force(0.0), Load::force(0.3), 1.0)?,
    ///     StepLoad::new(Load::force(0.0))?,
    /// );
    /// let mut contact = FrictionContact::new(ball, Coulomb::new(0.5)?)?.sheared_by(shear);
    /// let pressed = StepLoad::new(Load::force(1.0))?;
    /// let mut run = contact
    ///     .follow(&pressed, Stepping::adaptive(1.0e-2), 2.0)
    ///     .stop_when(|contact| contact.load_share(), Crossing::Up(0.5))?;
    /// while run.next_step()?.is_some() {}
    /// assert!((run.events()[0].times()[0] - 5.0 / 6.0).abs() < 1.0e-2); // 0.25 N of 0.5 N
    /// # Ok::<(), Error>(())
    /// ```
    pub fn sheared_by(mut self, history: ShearHistory) -> FrictionContact {
        self.loads_along = Some(history);
        self
    }

    /// What acts along the surface at the end of a step of length `dt` to a `time`: at a jump of no time, else before it.
    fn sheared_at(&self, time: f64, dt: f64) -> Result<ShearLoad> {
        match &self.loads_along {
            None => Ok(ShearLoad::force([0.0; 2])),
            Some(history) if dt > 0.0 => history.load(self.least, |history| history.checked_before(time, true)),
            Some(history) => history.load(self.least, |history| history.checked_at(time, true)),
        }
    }

    /// About the most that a contact that sticks resists a motion along the surface \[N/m\]: as a circle about all cells
    /// does; what is periodic yields between its contacts alone.
    fn most_stiffness(&self) -> f64 {
        let (State { region, history, .. }, grid) = (&self.state, self.normal().grid());
        let [x1, x2] = [0, 1].map(|axis| region.cells[axis] as f64 * grid.spacing()[axis]);
        let touches = self.contact_area() / (grid.lengths()[0] * grid.lengths()[1]);
        let yields = if self.response.periodic().contains(&true) { 1.0 - touches } else { 1.0 };
        x1.hypot(x2) / (history.rule().compliance() * yields.max(SMALL))
    }
}

impl Contact for FrictionContact {
    fn step_to(&mut self, time: f64, load: Load) -> Result<StepReport> {
        self.step_to_unless(None, time, load)
    }

    fn step_to_unless(&mut self, cancelled: Option<&AtomicBool>, time: f64, load: Load) -> Result<StepReport> {
        let (dt, never) = (time - self.normal().time(), AtomicBool::new(false));
        let shear = self.sheared_at(time, dt)?;
        self.saved_run = None;
        match self.advance(cancelled.unwrap_or(&never), (time, dt), load, shear, self.tolerance)? {
            Outcome::Holds(report) => Ok(report.normal),
            Outcome::Slides { direction, over_limit } => {
                Err(Error::Slides { time, over_limit, direction: Some(direction) })
            }
        }
    }

    fn report(&self, dt: f64, _: Load) -> StepReport {
        let computation = &self.normal.computation;
        let time_error = (dt == 0.0).then_some(0.0);
        StepReport { dt, ..self.normal.report(time_error, computation.pressed(&self.normal.scene)) }
    }

    fn time(&self) -> f64 {
        self.normal().time()
    }

    fn force(&self) -> f64 {
        self.normal().fields().force()
    }

    fn approach(&self) -> f64 {
        self.normal().fields().approach()
    }

    fn tilt(&self) -> [f64; 2] {
        self.normal().fields().tilt()
    }

    fn contact_area(&self) -> f64 {
        self.normal().fields().contact_area()
    }

    fn is_separated(&self) -> bool {
        self.normal().fields().is_separated()
    }

    fn in_space(&self) -> Option<Fields<'_>> {
        Some(self.normal().fields())
    }

    /// Of approach and force, and as large a part of them as motion, force, work and loss along the surface are off by, over
    /// their maximum so far (angles times the square root of the contact area, torques over it).
    fn difference(&self, other: &Self) -> [f64; 2] {
        let off = |one: [f64; 3], other: [f64; 3]| [0, 1, 2].map(|k| one[k] - other[k]);
        let arm = self.contact_area().sqrt();
        let motion = size(off(self.motion(), other.motion()), arm);
        let force = size(off(FrictionContact::force(self), FrictionContact::force(other)), arm.recip());
        let ([work, lost], [far, most]) = (self.state.work, self.state.largest);
        let [off_work, off_loss] = [0, 1].map(|k| (self.state.work[k] - other.state.work[k]).abs());
        // what friction can carry, over what the solver leaves of motions
        let carried = self.normal.grid().cell_area() * self.step.bound.iter().sum::<f64>();
        let off_loss = off_loss - self.tolerance * far * carried;
        let least = SMALL * far * most;
        let parts = [(motion, far), (force, most), (off_loss, lost.max(least)), (off_work, work.abs().max(least))];
        let part =
            parts.into_iter().map(|(off, largest)| if off > 0.0 { off / largest } else { 0.0 }).fold(0.0, f64::max);
        let part = (part - self.unresolved).max(0.0);
        let sizes = [[self.approach(), other.approach()], [Contact::force(self), Contact::force(other)]];
        sizes.map(|[own, other]| {
            let (off, left) = ((own - other).abs(), self.tolerance * own.abs());
            (if off <= left { 0.0 } else { off - left }) + part * own.abs()
        })
    }

    fn neglect(&mut self, least: [f64; 3]) {
        self.least = least;
    }

    fn slides(&self) -> bool {
        self.stick_cells() == 0 && self.state.solution.cells.contains(&Cell::Slip)
    }

    /// Where a body that is moved and slides sticks again.
    fn unseen(&self, others: [&Self; 2]) -> [f64; 2] {
        let [before, middle] = others;
        if !middle.slides() || self.lateral().iter().all(|history| history.before(self.time()).is_force()) {
            return [0.0; 2];
        }
        let all = [before, middle, self];
        let (force, arm) = (FrictionContact::force(self), self.contact_area().sqrt());
        let [first, between, last] = all.map(|contact| size(FrictionContact::force(contact), arm.recip()));
        // while it slid
        let first = if before.slides() { first } else { between };
        let [start, half, end] = all.map(|contact| contact.state.work[1]);
        let slid = [(half - start) / (0.5 * (first + between)), (end - half) / (0.5 * (between + last))];
        let span = Span { now: before.time(), end: self.time() };
        // what moves the body towards the force, as that of its work
        let drive = |time: f64| {
            let Ok(load) = self.sheared_at(time, time - span.now) else { return f64::NAN };
            let along = |(component, force): (Component, f64)| {
                if let Component::Motion(to) = component { to * force } else { 0.0 }
            };
            load.components.into_iter().zip(force).map(along).sum::<f64>() / last
        };
        let back = turned_back(slid, span, drive);
        if !(back > 0.0 && back < f64::INFINITY) {
            return [0.0; 2];
        }
        let [far, most] = self.state.largest;
        let part = f64::max(back / far, (self.most_stiffness() * back).min(2.0 * last) / most);
        let part = (part - self.unresolved).max(0.0);
        [self.approach(), Contact::force(self)].map(|own| part * own.abs())
    }

    fn columns(&self) -> Vec<(&'static str, f64)> {
        let (motion, force, [work, slip]) = (self.motion(), FrictionContact::force(self), self.state.work);
        vec![
            ("force along 1 [N]", force[0]),
            ("force along 2 [N]", force[1]),
            ("torque [N m]", force[2]),
            ("motion along 1 [m]", motion[0]),
            ("motion along 2 [m]", motion[1]),
            ("angle [rad]", motion[2]),
            ("stick area [m2]", self.stick_cells() as f64 * self.normal().grid().cell_area()),
            ("work along [J]", work),
            ("loss by slip [J]", slip),
        ]
    }

    fn temperature(&self) -> Option<&TemperatureHistory> {
        self.normal().temperature()
    }

    fn lateral(&self) -> &[Arc<dyn LoadHistory>] {
        self.loads_along.as_ref().map_or(&[], |history| &history.components[..])
    }

    fn untouched(&self) -> Option<f64> {
        self.normal().untouched()
    }

    /// Adaptive steps are compared with halves of them, which must not differ by what the solver leaves.
    fn lead(&mut self, stepping: Stepping, until: f64) -> (Progress, Box<dyn Control<Self>>) {
        self.tolerance = self.normal.settings().tolerance;
        if let Stepping::Adaptive { tolerance } = stepping {
            self.unresolved = UNRESOLVED * tolerance;
            self.tolerance = self.tolerance.min((SOLVER_SHARE * tolerance).max(MOST_ACCURATE));
        }
        let saved = self.saved_run.take();
        doubled::lead(self, saved.as_deref(), stepping, until)
    }

    #[cfg(feature = "checkpoint")]
    fn save_run(&self, run: SavedRun<Plain>, path: &Path) -> Result<()> {
        self.save_with(path, Some(run))
    }

    fn is_beyond(&self, error: &Error) -> bool {
        matches!(error, Error::Slides { .. })
    }

    fn is_known_until(&self, end: f64) -> Result<()> {
        self.normal().is_known_until(end)
    }
}
