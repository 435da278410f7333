//! What a checkpoint holds.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::scene::SceneMark;
use crate::contact::follow::Progress;
use crate::contact::region::Region;
use crate::contact::reside::Beyond;
use crate::contact::state::State;
use crate::contact::viscoelastic::{ViscoelasticContact, next_id};
use crate::error::CheckpointError;
use crate::geometry::Gap;
use crate::hereditary::{Exponential, History, Sources, Unfitted};
use crate::solver::Solution;

/// A contact without what its scene says again, borrowed from one or read from a file.
#[derive(Serialize, Deserialize)]
pub(super) struct Saved<'a> {
    scene: SceneMark,
    region: Cow<'a, Region>,
    beyond: Option<Cow<'a, Beyond>>,
    past: Past<'a>,
    gap: Cow<'a, Gap>,
    state: Cow<'a, State>,
    /// The displacement before the last step.
    before: Cow<'a, [f64]>,
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

impl<'a> Saved<'a> {
    pub(super) fn of(contact: &'a ViscoelasticContact, progress: Option<&'a Progress>) -> Saved<'a> {
        Saved {
            scene: SceneMark::of(contact),
            region: Cow::Borrowed(&contact.region),
            beyond: contact.beyond.as_ref().map(Cow::Borrowed),
            past: match &contact.history {
                History::Exponential(history) => Past::Exponential(Cow::Borrowed(history)),
                History::Direct(history) => Past::Direct(Cow::Borrowed(history.increments())),
                History::Unfitted(history) => Past::Unfitted { expected: history.expected },
                History::Sources(history) => Past::Sources(Cow::Borrowed(history)),
            },
            gap: Cow::Borrowed(&contact.initial_gap),
            state: Cow::Borrowed(&contact.state),
            before: Cow::Borrowed(&contact.trial_displacement),
            progress: progress.map(Cow::Borrowed),
        }
    }

    /// Puts the state into a contact of the same scene.
    pub(super) fn restore(self, contact: &mut ViscoelasticContact) -> Result<(), CheckpointError> {
        self.scene.require(&SceneMark::of(contact))?;
        self.check(contact)?;
        if self.state.fitted_over != contact.state.fitted_over {
            let built = &contact.built.material;
            contact.material = match self.state.fitted_over {
                // over the same times it is the same, bit by bit
                Some([first, last]) => built
                    .fitted(first..=last, contact.settings.series_tolerance)
                    .map_err(|error| malformed(&error.to_string()))?,
                None => built.clone(),
            };
        }
        contact.history = match (self.past, &contact.history) {
            (Past::Exponential(history), History::Exponential(_) | History::Unfitted(_)) => {
                History::Exponential(history.into_owned())
            }
            (Past::Sources(history), History::Sources(_)) => History::Sources(history.into_owned()),
            (Past::Direct(increments), History::Direct(history)) => {
                History::Direct(history.with(increments.into_owned()))
            }
            (Past::Unfitted { expected }, own)
                if matches!(own, History::Unfitted(_)) || contact.state.fitted_over.is_some() =>
            {
                let mut history = Unfitted::new(contact.built.material.clone(), contact.settings.series_tolerance);
                history.expected = expected;
                history.carry(self.region.len());
                History::Unfitted(Box::new(history))
            }
            _ => return Err(malformed("another kind of past")),
        };
        (contact.initial_gap, contact.gap_id) = (self.gap.into_owned(), next_id());
        contact.occupy(self.region.into_owned());
        contact.beyond = self.beyond.map(Cow::into_owned);
        contact.state = self.state.into_owned();
        contact.trial_displacement = self.before.into_owned();
        contact.progress = self.progress.map(|progress| Box::new(progress.into_owned()));
        contact.before_move = None;
        contact.hulls.fill(None);
        contact.survey();
        contact.show();
        Ok(())
    }

    /// Refuses fields that do not fit: a file may have a right checksum and be made by others all the same.
    fn check(&self, contact: &ViscoelasticContact) -> Result<(), CheckpointError> {
        let (whole, bodies) = (contact.grid.len(), contact.bodies());
        if !self.region.is_of(&contact.grid) {
            return Err(malformed("its region is none of the grid"));
        }
        let (cells, state) = (self.region.len(), &*self.state);
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
        let fits = [state.displacement.len(), self.before.len()] == [cells; 2]
            && [state.loads.len(), state.motions.len(), state.previous_motions.len()] == [bodies; 3]
            && solution(&state.current)
            && solution(&state.previous)
            && self.gap.above.len() == whole
            && owners
            && past
            && self.beyond.as_ref().is_none_or(|beyond| beyond.fits(cells));
        if !fits {
            return Err(malformed("fields that do not fit its region"));
        }
        let finite = |fields: &[&[f64]]| fields.iter().all(|field| field.iter().all(|value| value.is_finite()));
        let State { time, undisturbed_until, shortest, interval, last_dt, .. } = *state;
        let numbers = [time, undisturbed_until, shortest, interval, last_dt, self.gap.datum];
        let solutions = [&state.current, &state.previous];
        let sane = finite(&[&numbers, &state.displacement, &self.before])
            && solutions.iter().all(|solution| finite(&[&solution.pressure, &solution.potential]))
            && state.current.pressure.iter().all(|&p| p >= 0.0)
            && finite(&[state.motions.as_flattened(), state.previous_motions.as_flattened()])
            && self.gap.above.iter().all(|&gap| gap >= 0.0)
            && numbers[..5].iter().all(|&number| number >= 0.0);
        if sane { Ok(()) } else { Err(malformed("numbers that no contact has")) }
    }
}

fn malformed(what: &str) -> CheckpointError {
    CheckpointError::Malformed { what: what.into() }
}
