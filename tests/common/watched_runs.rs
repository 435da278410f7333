//! What is seen of a contact, and of a run at given times.

use std::fmt;

use viscocontact::Error;
use viscocontact::prelude::*;

use super::random_histories::Control;
use super::scene::Scene;

/// States of a run at the times to look at, and what it took.
#[derive(Debug, Clone, Default)]
pub struct Watched {
    pub times: Vec<f64>,
    /// Force where the approach is given, otherwise the approach. The greatest approach by a spring is at most the greatest compression of
    /// the spring, so that errors relative to it are those of approach or force, whichever is greater.
    pub answer: Vec<f64>,
    pub pressure: Vec<Vec<f64>>,
    /// Greatest answer and pressure of the whole run.
    pub greatest: [f64; 2],
    pub steps: u64,
    pub rejected: u64,
    pub equivalents: f64,
    /// The error budget of the approach or force.
    pub time_budget: f64,
}

impl Watched {
    /// Contact problems, those of rejected steps included.
    pub fn problems(&self) -> u64 {
        self.steps + self.rejected
    }

    pub fn greatest_pressures(&self) -> Vec<f64> {
        self.pressure.iter().map(|field| field.iter().copied().fold(0.0, f64::max)).collect()
    }

    pub fn pressures_in(&self, cell: usize) -> Vec<f64> {
        self.pressure.iter().map(|field| field[cell]).collect()
    }

    /// The cell that is in contact at most of the times, with the greatest pressure among those.
    pub fn central_cell(&self) -> usize {
        let cells = self.pressure.first().map_or(0, Vec::len);
        let held = |cell: usize| {
            let pressures = self.pressure.iter().map(|field| field[cell]);
            let touched = pressures.clone().filter(|&p| p > 0.0).count() as f64;
            touched + pressures.sum::<f64>() / (1e-300 + self.greatest[1] * self.pressure.len() as f64)
        };
        (0..cells).max_by(|&a, &b| held(a).total_cmp(&held(b))).unwrap_or(0)
    }
}

/// Why a run did not come to its end.
#[derive(Debug)]
pub enum Stopped {
    Failed {
        time: f64,
        error: Error,
    },
    /// After so many steps.
    Endless {
        time: f64,
        steps: u64,
    },
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stopped::Failed { time, error } => write!(f, "at {time:e} s: {error:?}"),
            Stopped::Endless { time, steps } => write!(f, "only at {time:e} s after {steps} steps"),
        }
    }
}

/// Follows the history of a scene, and looks at it at its moments.
pub fn watch(
    scene: &Scene,
    contact: &mut ViscoelasticContact,
    history: &dyn LoadHistory,
    stepping: Stepping,
    stops: &[f64],
    most_steps: u64,
) -> Result<Watched, Stopped> {
    let moments = scene.moments();
    let by_approach = matches!(scene.control, Control::Approach { .. });
    let (mut deepest, mut compressed) = (0.0_f64, 0.0_f64);
    let mut run = contact.follow(history, stepping, scene.body.until).stop_at(stops).unwrap();
    let mut seen = Watched::default();
    loop {
        let report = match run.next_step() {
            Ok(Some(report)) => report,
            Ok(None) => break,
            Err(error) => return Err(Stopped::Failed { time: run.contact().time(), error }),
        };
        seen.steps += 1;
        seen.equivalents += report.convolution_equivalents();
        let answer = if by_approach { report.force } else { report.approach };
        let pressure = run.contact().pressure().iter().copied().fold(0.0, f64::max);
        let greatest = match scene.control {
            Control::Spring { touch, stiffness, .. } => {
                deepest = deepest.max(answer - touch);
                compressed = compressed.max(report.force / stiffness);
                deepest.min(compressed)
            }
            _ => seen.greatest[0].max(answer.abs()),
        };
        seen.greatest = [greatest, seen.greatest[1].max(pressure)];
        if report.time > 0.0 && moments.binary_search_by(|time| time.total_cmp(&report.time)).is_ok() {
            seen.times.push(report.time);
            seen.answer.push(answer);
            seen.pressure.push(run.contact().pressure().to_vec());
        }
        if seen.steps + run.rejected_steps() >= most_steps {
            return Err(Stopped::Endless { time: report.time, steps: seen.steps });
        }
    }
    seen.rejected = run.rejected_steps();
    seen.time_budget = run.error_budget().time.unwrap_or(0.0);
    Ok(seen)
}

/// Everything that a contact shows, to the last bit.
pub fn seen(contact: &ViscoelasticContact) -> String {
    let scalars =
        (contact.time(), contact.fields().load(), contact.approach(), contact.tilt(), contact.fields().moment());
    let (body, patches) =
        (contact.fields().body(0).unwrap(), contact.fields().patches().map(|patches| patches.all.len()));
    let fields = (contact.contact_area(), contact.pressure(), contact.fields().displacement());
    format!("{scalars:?} {body:?} {patches:?} {fields:?}")
}
