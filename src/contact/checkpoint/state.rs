//! What changes from step to step, as it is saved.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::CheckpointError;
use super::scene::SceneMark;
use crate::contact::follow::Progress;
use crate::contact::guess::Refresh;
use crate::contact::region::Region;
use crate::contact::reside::Beyond;
use crate::contact::stepper::{ViscoelasticContact, next_id};
use crate::error::{Error, Result};
use crate::geometry::Gap;
use crate::hereditary::{Exponential, History, Sources};
use crate::load::Load;
use crate::solver::Solution;

/// The state of a contact, borrowed from one or read from a file.
#[derive(Serialize, Deserialize)]
pub(super) struct State<'a> {
    scene: SceneMark,
    /// The times over which the first step fitted the material's series, if it did.
    fitted_over: Option<[f64; 2]>,
    region: Cow<'a, Region>,
    beyond: Option<Cow<'a, Beyond>>,
    placed: bool,
    past: Past<'a>,
    undisturbed_until: f64,
    shortest: f64,
    gap: Cow<'a, Gap>,
    time: f64,
    loads: Cow<'a, [Load]>,
    displacement: Cow<'a, [f64]>,
    before: Cow<'a, [f64]>,
    before_is_kept: bool,
    current: Cow<'a, Solution>,
    previous: Cow<'a, Solution>,
    motions: Cow<'a, [[f64; 3]]>,
    previous_motions: Cow<'a, [[f64; 3]]>,
    contact_cells: usize,
    interval: f64,
    last_dt: f64,
    refresh: Cow<'a, Refresh>,
    progress: Option<Cow<'a, Progress>>,
}

/// The past without what the scene says again.
#[derive(Serialize, Deserialize)]
enum Past<'a> {
    Exponential(Cow<'a, Exponential>),
    Direct(Cow<'a, [(f64, Vec<f64>)]>),
    Unfitted { expected: f64 },
    Sources(Cow<'a, Box<Sources>>),
}

impl<'a> State<'a> {
    pub(super) fn of(contact: &'a ViscoelasticContact, progress: Option<&'a Progress>) -> State<'a> {
        State {
            scene: SceneMark::of(contact),
            fitted_over: contact.fitted_over,
            region: Cow::Borrowed(&contact.region),
            beyond: contact.beyond.as_ref().map(Cow::Borrowed),
            placed: contact.placed,
            past: match &contact.history {
                History::Exponential(history) => Past::Exponential(Cow::Borrowed(history)),
                History::Direct(history) => Past::Direct(Cow::Borrowed(history.increments())),
                History::Unfitted(history) => Past::Unfitted { expected: history.expected },
                History::Sources(history) => Past::Sources(Cow::Borrowed(history)),
            },
            undisturbed_until: contact.undisturbed_until,
            shortest: contact.shortest,
            gap: Cow::Borrowed(&contact.initial_gap),
            time: contact.time,
            loads: Cow::Borrowed(&contact.loads),
            displacement: Cow::Borrowed(&contact.displacement),
            before: Cow::Borrowed(&contact.trial_displacement),
            before_is_kept: contact.before_is_kept,
            current: Cow::Borrowed(&contact.current),
            previous: Cow::Borrowed(&contact.previous),
            motions: Cow::Borrowed(&contact.motions),
            previous_motions: Cow::Borrowed(&contact.previous_motions),
            contact_cells: contact.contact_cells,
            interval: contact.interval,
            last_dt: contact.last_dt,
            refresh: Cow::Borrowed(&contact.refresh),
            progress: progress.map(Cow::Borrowed),
        }
    }

    /// Puts the state into a contact of the same scene.
    pub(super) fn restore(self, contact: &mut ViscoelasticContact) -> Result<()> {
        self.scene.require(&SceneMark::of(contact))?;
        self.check(contact)?;
        if let (Some(times), None) = (self.fitted_over, contact.fitted_over) {
            contact.material = contact.material.fitted(times[0]..=times[1], contact.settings.series_tolerance)?;
            contact.fitted_over = Some(times);
        }
        contact.history = match (self.past, &contact.history) {
            (Past::Exponential(history), History::Exponential(_) | History::Unfitted(_)) => {
                History::Exponential(history.into_owned())
            }
            (Past::Sources(history), History::Sources(_)) => History::Sources(history.into_owned()),
            (Past::Direct(increments), History::Direct(history)) => {
                History::Direct(history.with(increments.into_owned()))
            }
            (Past::Unfitted { expected }, History::Unfitted(history)) => {
                let mut history = history.clone();
                history.expected = expected;
                history.carry(self.region.len());
                History::Unfitted(history)
            }
            _ => return Err(malformed("another kind of past")),
        };
        (contact.initial_gap, contact.gap_id) = (self.gap.into_owned(), next_id());
        contact.loads.copy_from_slice(&self.loads);
        contact.occupy(self.region.into_owned());
        contact.beyond = self.beyond.map(Cow::into_owned);
        contact.placed = self.placed;
        contact.undisturbed_until = self.undisturbed_until;
        contact.shortest = self.shortest;
        contact.time = self.time;
        contact.displacement = self.displacement.into_owned();
        contact.trial_displacement = self.before.into_owned();
        contact.before_is_kept = self.before_is_kept;
        contact.current = self.current.into_owned();
        contact.previous = self.previous.into_owned();
        contact.motions = self.motions.into_owned();
        contact.previous_motions = self.previous_motions.into_owned();
        contact.contact_cells = self.contact_cells;
        contact.interval = self.interval;
        contact.last_dt = self.last_dt;
        contact.refresh = self.refresh.into_owned();
        contact.progress = self.progress.map(|progress| Box::new(progress.into_owned()));
        contact.before_move = None;
        contact.hulls.fill(None);
        contact.survey();
        contact.show();
        Ok(())
    }

    /// Refuses fields that do not fit: a file may have a right checksum and be made by others all the same.
    fn check(&self, contact: &ViscoelasticContact) -> Result<()> {
        let (whole, bodies) = (contact.grid.len(), contact.loads.len());
        if !self.region.is_of(&contact.grid) {
            return Err(malformed("its region is none of the grid"));
        }
        let cells = self.region.len();
        let solution = |solution: &Solution| {
            [solution.pressure.len(), solution.potential.len()] == [cells; 2] && solution.motions.len() == bodies
        };
        let of_a_body = |&owner: &_| usize::from(owner) < bodies;
        let owners = self.gap.owner.as_ref().is_none_or(|owner| owner.len() == whole && owner.iter().all(of_a_body));
        let past = match &self.past {
            Past::Exponential(history) => history.fits(cells),
            Past::Direct(increments) => increments.iter().all(|(_, field)| field.len() == cells),
            Past::Unfitted { .. } => true,
            Past::Sources(history) => history.fits(self.region.cells()),
        };
        let fits = [self.displacement.len(), self.before.len()] == [cells; 2]
            && [self.loads.len(), self.motions.len(), self.previous_motions.len()] == [bodies; 3]
            && solution(&self.current)
            && solution(&self.previous)
            && self.gap.above.len() == whole
            && owners
            && past
            && self.beyond.as_ref().is_none_or(|beyond| beyond.fits(cells));
        if !fits {
            return Err(malformed("fields that do not fit its region"));
        }
        let finite = |fields: &[&[f64]]| fields.iter().all(|field| field.iter().all(|value| value.is_finite()));
        let numbers = [self.time, self.undisturbed_until, self.shortest, self.interval, self.last_dt, self.gap.datum];
        let solutions = [&*self.current, &*self.previous];
        let sane = finite(&[&numbers, &self.displacement, &self.before])
            && solutions.iter().all(|solution| finite(&[&solution.pressure, &solution.potential]))
            && self.current.pressure.iter().all(|&p| p >= 0.0)
            && finite(&[self.motions.as_flattened(), self.previous_motions.as_flattened()])
            && self.gap.above.iter().all(|&gap| gap >= 0.0)
            && numbers[..5].iter().all(|&number| number >= 0.0);
        if sane { Ok(()) } else { Err(malformed("numbers that no contact has")) }
    }
}

fn malformed(what: &str) -> Error {
    Error::Checkpoint(CheckpointError::Malformed { what: what.into() })
}
