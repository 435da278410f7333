//! How a run chooses its steps, and how far it has come.

use std::fmt;

use crate::contact::StepReport;
use crate::error::{Error, Result, finite, positive, within};
use crate::rounded::rounded;

/// A step that would end closer than this fraction of it before another end of a step ends there, and events are
/// found as closely.
pub(crate) const SAME_TIME: f64 = 1e-6;

/// How far times may be apart that agree but for rounding, as 0.3 and 3 · 0.1 do.
pub(super) fn rounding(time: f64) -> f64 {
    8.0 * f64::EPSILON * time.abs()
}

/// The rule for the length of steps.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Stepping {
    /// Equal steps, counted from the start of the run. Steps are shortened to end at corners of the load.
    Fixed {
        /// Length of a step \[s\].
        dt: f64,
    },
    /// Steps as long as the error in time allows: short after jumps and corners of the load, long while the state
    /// changes slowly.
    Adaptive {
        /// Error in time of approach or force.
        tolerance: f64,
    },
}

impl Stepping {
    /// Equal steps of `dt` \[s\], which must be finite and positive.
    pub fn fixed(dt: f64) -> Stepping {
        Stepping::Fixed { dt }
    }

    /// Steps whose estimated error in time is at most `tolerance`, in \[1e-9, 0.1\]: the error of the approach under
    /// a given force, the error of the force under a given approach, of both under a spring. It is relative to the
    /// displacement or force; for small values it is relative to a fraction of the largest of the run. Errors of the
    /// pressure at a point may be larger where a body meets cells faster than the steps resolve. The tolerance of the
    /// solver is 0.03 of `tolerance`, 1e-6 at least, or
    /// [`Settings::tolerance`](crate::contact::Settings::tolerance) where that is set below 1e-6.
    ///
    /// Such a run looks at the whole history before its first step, at 4096 equal parts and at its breakpoints: a
    /// load that acts for a shorter time than a part needs a breakpoint.
    pub fn adaptive(tolerance: f64) -> Stepping {
        Stepping::Adaptive { tolerance }
    }

    /// Length of equal steps, and tolerance of adaptive ones; 0 where it is not that kind.
    pub(crate) fn lengths(self) -> (f64, f64) {
        match self {
            Stepping::Fixed { dt } => (dt, 0.0),
            Stepping::Adaptive { tolerance } => (0.0, tolerance),
        }
    }

    /// Accepts steps and tolerances in range, and a run that does not end before its `start`.
    pub(crate) fn validate_run(&self, start: f64, until: f64) -> Result<()> {
        match *self {
            Stepping::Fixed { dt } => positive("fixed step", dt)?,
            Stepping::Adaptive { tolerance } => {
                let inside = (1e-9..=0.1).contains(&tolerance);
                within("tolerance of the adaptive steps", tolerance, inside, "in [1e-9, 0.1]")?
            }
        };
        finite("end of the run", until)?;
        let allowed = "no earlier than the time of the contact: give the time at which the run ends, not its length";
        within("end of the run", until, until >= start, allowed).map(drop)
    }
}

/// How far a run has come.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Progress {
    pub(super) start: f64,
    /// Time of the contact that belongs to this progress.
    pub(super) now: f64,
    /// Number of equal steps taken, and their length, 0 for adaptive steps.
    pub(super) equal_steps: u64,
    pub(super) dt: f64,
    /// Tolerance of adaptive steps; 0 for equal ones.
    tolerance: f64,
    /// Number of steps taken, and the length of the first one that took time.
    steps: u64,
    first_step: f64,
}

impl Progress {
    pub(crate) fn begin(now: f64, stepping: Stepping) -> Progress {
        let (dt, tolerance) = stepping.lengths();
        Progress { start: now, now, equal_steps: 0, dt, tolerance, steps: 0, first_step: 0.0 }
    }

    /// Whether a run that begins `now` continues this one.
    pub(crate) fn continues(&self, now: f64, stepping: Stepping, until: f64) -> bool {
        self.now == now && (self.dt, self.tolerance) == stepping.lengths() && until >= now
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self) -> bool {
        self.dt == 0.0 || (self.now - self.start - self.equal_steps as f64 * self.dt).abs() <= 2.0 * self.dt
    }

    /// Whether no step has been taken.
    pub(super) fn is_new(&self) -> bool {
        self.steps == 0
    }

    /// Counts a step.
    pub(super) fn count(&mut self, report: &StepReport) {
        self.steps += 1;
        if self.first_step == 0.0 {
            self.first_step = report.dt;
        }
    }

    /// The end of the next equal step, or a `stop` before it.
    pub(super) fn next_time(&mut self, now: f64, dt: f64, stop: f64) -> Result<f64> {
        let (same, start) = (SAME_TIME * dt, self.start);
        let end = |steps: u64| start + (steps + 1) as f64 * dt;
        while end(self.equal_steps) <= now + same {
            self.equal_steps += 1;
            if end(self.equal_steps) <= end(self.equal_steps - 1) {
                let allowed = "long enough to change the time";
                return Err(Error::OutOfRange { field: "fixed step", value: dt, allowed });
            }
        }
        let end = end(self.equal_steps);
        Ok(if stop <= end + same { stop } else { end })
    }

    pub(super) fn report(&self, time: f64, until: f64) -> RunProgress {
        let Progress { start, steps, first_step, .. } = *self;
        RunProgress { steps, start, time, until, first_step }
    }
}

/// How far a run has come, from [`Run::progress`](crate::run::Run::progress). The number of steps to come is not
/// known: take the share, of time or of its decades, along which the steps are spread.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Zener::relaxing(1.0e6, 0.5e6, 1.0)?))
///     .build()?;
/// let load = StepLoad::new(Load::force(0.5))?;
/// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-2), 1.0e4);
/// while run.next_step()?.is_some() {
///     println!("{:3.0} %: {}", 100.0 * run.progress().share_of_decades(), run.progress());
/// }
/// assert_eq!(run.progress().share_of_decades(), 1.0);
/// assert_eq!(run.progress().share_of_time(), 1.0);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RunProgress {
    /// Steps taken from the beginning of the run, those before a resumption included.
    pub steps: u64,
    /// Time at the start of the run \[s\].
    pub start: f64,
    /// Time of the contact \[s\].
    pub time: f64,
    /// Time at the end of the run \[s\].
    pub until: f64,
    /// Length of the first step that took time \[s\]; 0 before.
    first_step: f64,
}

impl RunProgress {
    /// The part of the time that is over, 0 to 1: for steps of given length, and for loads that keep changing.
    pub fn share_of_time(&self) -> f64 {
        if self.until > self.start {
            ((self.time - self.start) / (self.until - self.start)).clamp(0.0, 1.0)
        } else {
            1.0
        }
    }

    /// The part of the decades of time that is over, 0 to 1: ln(1 + t/δ) over its value at the end, t counted from
    /// the start and δ the first step. For adaptive steps under a load that is held, which grow in proportion to the
    /// time since it was applied.
    pub fn share_of_decades(&self) -> f64 {
        let decades = |time: f64| ((time - self.start) / self.first_step).ln_1p();
        if self.first_step > 0.0 && self.until > self.start {
            (decades(self.time) / decades(self.until)).clamp(0.0, 1.0)
        } else {
            self.share_of_time()
        }
    }
}

/// One line: `12 steps, t = 0.5 s of 10 s`.
impl fmt::Display for RunProgress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let RunProgress { steps, time, until, .. } = *self;
        let s = if steps == 1 { "" } else { "s" };
        write!(f, "{steps} step{s}, t = {} s of {} s", rounded(time, 4), rounded(until, 4))
    }
}
