//! Fields where levels do not give them: a run beside in steps twice as long tells the error of a field, and where it
//! is more than was asked, the steps so far are halved until the field changes by less.

use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

use crate::contact::ViscoelasticContact;
use crate::equilibrium::Ground;
use crate::error::{Error, Result};
use crate::fields::{Fields, KeptFields};
use crate::hereditary::{Interpolant, Outlook};
use crate::load::{Load, LoadHistory};
use crate::states::repeated::REPEATED;

/// Times that steps are halved.
const MOST_HALVINGS: usize = 4;

#[derive(Debug)]
pub(super) struct Refined {
    accuracy: f64,
    origin: Box<ViscoelasticContact>,
    /// In steps twice as long; `None` once one has failed.
    coarse: Option<Box<ViscoelasticContact>>,
    interpolant: Interpolant,
    /// Times at which both runs end a step.
    times: Vec<f64>,
    /// Whether the run takes its steps in two halves: then the coarse one takes the same steps as a whole.
    in_halves: bool,
    /// The greatest force of the run so far.
    force: f64,
    /// Steps of the run so far.
    taken: Vec<RunPart>,
    /// In steps of a half, a quarter and so on: made where a field asks for it.
    finer: Mutex<Vec<Finer>>,
}

/// A step of the run.
#[derive(Debug, Clone, Copy)]
struct RunPart {
    start: f64,
    end: f64,
    load: Load,
    is_corner: bool,
}

/// The run in shorter steps, and how many steps of the run it has followed.
#[derive(Debug)]
struct Finer {
    contact: Box<ViscoelasticContact>,
    followed: usize,
    /// Whether a step has failed: it stays where it was.
    failed: bool,
}

impl Refined {
    /// For a run that begins with this contact.
    pub(super) fn new(contact: &ViscoelasticContact, times: &[f64], is_adaptive: bool, accuracy: f64) -> Refined {
        let Ground { settings, attraction, .. } = &contact.scene.ground;
        let interpolant = if is_adaptive { settings.adaptive_interpolant() } else { settings.interpolant() };
        Refined {
            accuracy,
            origin: Box::new(contact.clone()),
            coarse: Some(Box::new(contact.clone())),
            interpolant,
            times: times.to_vec(),
            in_halves: is_adaptive && attraction.is_some(),
            force: 0.0,
            taken: Vec::new(),
            finer: Mutex::default(),
        }
    }

    /// Takes the step of the run from `start` on, together with the one before, unless that ended at a corner, a jump
    /// or a field.
    pub(super) fn follow(&mut self, run: &ViscoelasticContact, history: &dyn LoadHistory, start: f64) {
        self.force = self.force.max(run.force());
        let end = run.time();
        let is_corner = history.next_breakpoint(start).is_some_and(|corner| corner <= end);
        let step = RunPart { start, end, load: run.fields().load(), is_corner };
        self.taken.push(step);
        let Some(contact) = &mut self.coarse else { return };
        let (is_second, jumps) = (contact.time() < start, end == start);
        if !(is_second || jumps || is_corner || self.in_halves || self.times.contains(&end)) {
            return;
        }
        if take(contact, step, self.interpolant, None).is_err() {
            self.coarse = None;
        }
    }

    /// How far the pressure of a contact is from that of one in steps twice as long, as its error.
    fn error(&self, contact: &ViscoelasticContact, longer: &ViscoelasticContact) -> Option<f64> {
        let [off, sum] = contact.fields().pressure_beside(longer.fields());
        let [off, sum] = [off, sum].map(|sum| sum * contact.grid().cell_area());
        let size = sum.max(REPEATED.least_force * self.force);
        (size > 0.0).then(|| off / size)
    }

    /// The error of the pressure of the run where both have ended a step and something has pressed; and the fields of
    /// shorter steps where it is more than was asked.
    pub(super) fn fields(
        &self,
        run: &ViscoelasticContact,
        history: &dyn LoadHistory,
        cancelled: Option<&AtomicBool>,
    ) -> Result<(Option<KeptFields>, Option<f64>)> {
        let coarse = self.coarse.as_ref().filter(|coarse| coarse.time() == run.time());
        let mut error = coarse.and_then(|coarse| self.error(run, coarse));
        let mut finer = self.finer.lock().unwrap_or_else(PoisonError::into_inner);
        let mut fields = None;
        for k in 0..MOST_HALVINGS {
            if error.is_none_or(|error| error <= self.accuracy) {
                break;
            }
            if finer.len() == k {
                finer.push(Finer { contact: self.origin.clone(), followed: 0, failed: false });
            }
            let own = &mut finer[k];
            let advanced = if own.failed { Ok(()) } else { self.advance(own, 2 << k, history, cancelled) };
            // a step that was cancelled is taken when the field is asked for again
            own.failed |= advanced.as_ref().is_err_and(|error| !matches!(error, Error::Cancelled { .. }));
            match advanced {
                Err(error) if !matches!(error, Error::Step(_)) => return Err(error),
                // the fields of longer steps stay
                _ if own.failed => break,
                _ => {}
            }
            let contact = &finer[k].contact;
            error = self.error(contact, k.checked_sub(1).map_or(run, |before| &finer[before].contact));
            fields = Some(contact.fields().keep());
        }
        Ok((fields, error))
    }

    /// Follows the run to its last step, in so many parts of each step.
    fn advance(
        &self,
        finer: &mut Finer,
        parts: u32,
        history: &dyn LoadHistory,
        cancelled: Option<&AtomicBool>,
    ) -> Result<()> {
        let parts = if self.in_halves { 2 * parts } else { parts };
        while let Some(step @ RunPart { start, end, .. }) = self.taken.get(finer.followed).copied() {
            let inner = (1..parts).map(|k| start + (end - start) * f64::from(k) / f64::from(parts));
            for time in inner {
                // parts that were taken before the flag was set
                if time > finer.contact.time() {
                    let part =
                        RunPart { start, end: time, load: history.checked_before(time, true)?, is_corner: false };
                    take(&mut finer.contact, part, self.interpolant, cancelled)?;
                }
            }
            take(&mut finer.contact, step, self.interpolant, cancelled)?;
            finer.followed += 1;
        }
        Ok(())
    }
}

/// A step of a contact to the end of one of the run.
fn take(
    contact: &mut ViscoelasticContact,
    step: RunPart,
    interpolant: Interpolant,
    cancelled: Option<&AtomicBool>,
) -> Result<()> {
    let RunPart { end, load, is_corner, .. } = step;
    let loads = [load];
    let mut request = contact.request(end, end - contact.time(), &loads, contact.settings().tolerance)?;
    (request.interval.interpolant, request.cancelled) = (interpolant, cancelled);
    contact.take_expecting(request, &Outlook::default())?;
    if is_corner {
        contact.computation.state.history.reset_differences();
    }
    Ok(())
}

impl Fields<'_> {
    /// Σ |p − p′| and Σ p over the whole grid, with the p′ of another contact of the scene. A call of all ranks.
    fn pressure_beside(&self, other: Fields<'_>) -> [f64; 2] {
        let ([n1, n2], own) = (self.grid().cells(), self.rows());
        self.sum_of_rows(|i, row| {
            let computed = if own.contains(&i) { i } else { n1 - 1 - i };
            let others = &other.pressure()[(computed - own.start) * n2..];
            let off = row.iter().zip(others).map(|(one, other)| (one - other).abs());
            [off.sum(), row.iter().sum()]
        })
    }
}
