//! Drives a contact along a load history.

use crate::contact::report::StepReport;
use crate::contact::stepper::ViscoelasticContact;
use crate::error::{Error, Result, finite, positive, within};
use crate::load::LoadHistory;

/// Two times closer than this fraction of a step are the same time.
const SAME_TIME: f64 = 1e-6;

/// How long the steps are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Stepping {
    /// Equal steps, counted from the time at which following starts; cut where the load has a corner.
    Fixed {
        /// Length of a step \[s\].
        dt: f64,
    },
}

impl Stepping {
    /// Equal steps of `dt` \[s\], which must be finite and positive.
    pub fn fixed(dt: f64) -> Stepping {
        Stepping::Fixed { dt }
    }
}

/// A run along a load history, made by [`ViscoelasticContact::follow`]. Each call of
/// [`Follow::next_step`] takes one step.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(KelvinVoigt::new(1.0e6, 1.0e6)?))
///     .build()?;
/// let ramp = Ramp::new(Load::force(0.0), Load::force(0.5), 1.0)?;
/// let mut run = contact.follow(&ramp, Stepping::fixed(0.25), 2.0);
/// let mut steps = 0;
/// while let Some(report) = run.next_step()? {
///     steps += 1;
///     assert_eq!(report.time, 0.25 * steps as f64);
///     assert!(run.contact().contact_cells() > 0);
/// }
/// assert_eq!(steps, 8);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug)]
#[must_use = "a run takes no step until next_step is called"]
pub struct Follow<'a> {
    contact: &'a mut ViscoelasticContact,
    history: &'a dyn LoadHistory,
    stepping: Stepping,
    until: f64,
    start: f64,
    /// Steps of the fixed raster already behind.
    behind: u64,
}

impl<'a> Follow<'a> {
    pub(crate) fn new(
        contact: &'a mut ViscoelasticContact,
        history: &'a dyn LoadHistory,
        stepping: Stepping,
        until: f64,
    ) -> Follow<'a> {
        Follow { start: contact.time(), contact, history, stepping, until, behind: 0 }
    }

    /// Takes the next step and reports it; `None` when the end is reached.
    ///
    /// At the start, and wherever the history jumps, a step of length zero brings in the new load.
    /// Corners and jumps of the history are met exactly.
    ///
    /// # Errors
    /// If the end is not finite or lies before the contact's time, the fixed step is not finite and
    /// positive or too short to change the time, or a step fails; the contact is then as it was after
    /// the last good step, and the call may be repeated.
    pub fn next_step(&mut self) -> Result<Option<StepReport>> {
        let Stepping::Fixed { dt } = self.stepping;
        positive("fixed step", dt)?;
        finite("end of the run", self.until)?;
        within("end of the run", self.until, self.until >= self.start, "at or after the time of the contact")?;

        let now = self.contact.time();
        let load = self.history.at(now);
        if load != self.contact.load() {
            return self.contact.step_to(now, 0.0, &[load]).map(Some);
        }
        if now >= self.until {
            return Ok(None);
        }
        let time = self.next_time(now, dt)?;
        let report = self.contact.step_to(time, time - now, &[self.history.before(time)])?;
        Ok(Some(report))
    }

    /// The end of the next step: the raster, unless a corner or the end of the run comes first.
    fn next_time(&mut self, now: f64, dt: f64) -> Result<f64> {
        let same = SAME_TIME * dt;
        while self.raster(dt) <= now + same {
            self.behind += 1;
            if self.start + (self.behind + 1) as f64 * dt <= self.start + self.behind as f64 * dt {
                return Err(Error::OutOfRange {
                    field: "fixed step",
                    value: dt,
                    allowed: "long enough to change the time",
                });
            }
        }
        let corner = self.history.next_breakpoint(now).unwrap_or(f64::INFINITY);
        if corner <= now || corner.is_nan() {
            return Err(Error::InvalidBreakpoint { after: now, breakpoint: corner });
        }
        let corner = corner.min(self.until);
        Ok(if corner <= self.raster(dt) + same { corner } else { self.raster(dt) })
    }

    /// The end of the step of the fixed raster that is under way.
    fn raster(&self, dt: f64) -> f64 {
        self.start + (self.behind + 1) as f64 * dt
    }

    /// The contact as the last step left it.
    pub fn contact(&self) -> &ViscoelasticContact {
        self.contact
    }
}
