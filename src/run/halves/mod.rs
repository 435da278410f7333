//! Steps of surfaces that attract each other, in two halves.
//!
//! Next to surfaces that attract each other the displacement leaves every polynomial within a step: the zone at the
//! edge of the contact runs over cells, and bodies open and close. So the step is taken as a whole and again in two
//! halves, which are kept. Their error is the whole difference where the rule has the order one, the least that is
//! left there, and a third of it at the order two of most steps. Half of it counts.

mod search;

use crate::contact::step::Attempt;
use crate::contact::step::error_in_time::{error_in_time, least_sizes};
use crate::contact::{Computation, State, Step, ViscoelasticContact};
use crate::equilibrium::Region;
use crate::error::{Error, Result};
use crate::hereditary::{ERROR_FACTORS, Interval, Outlook, TimeError};
use crate::load::LoadHistory;

/// The step that was divided last.
#[derive(Debug, Clone)]
pub struct Halves {
    /// The state at its start.
    start: State,
    /// The time at its middle.
    middle: f64,
    /// z − s, u and v at the end of the whole step.
    whole: [Vec<f64>; 3],
}

/// A step whose first half is the state, and whose second half was tried.
struct Divided {
    attempt: Attempt,
    /// By how much they differ from the whole step, relative as [`TimeError::relative`].
    difference: f64,
    /// The errors of each.
    errors: [TimeError; 2],
}

impl Halves {
    fn new(state: &State) -> Halves {
        let field = || vec![0.0; state.held.region.len()];
        Halves { start: state.clone(), middle: f64::NAN, whole: [field(), field(), field()] }
    }

    /// Takes the first half of a step whose `whole` was tried, and tries the second, which takes the place of the `step`.
    fn divide(
        &mut self,
        contact: &mut ViscoelasticContact,
        whole: Attempt,
        step: &mut Step<'_>,
        history: &dyn LoadHistory,
        outlook: &Outlook,
        wasted: &mut [usize; 2],
    ) -> Result<Divided> {
        contact.move_to_region_of(whole);
        self.keep(&contact.computation);
        contact.computation.add_work(wasted);
        let passes = |contact: &ViscoelasticContact| contact.passes().unwrap_or_default();
        let (time, from, of_whole) = (step.interval.time, contact.time(), passes(contact));
        self.middle = from + 0.5 * (time - from);
        let loads = [history.checked_before(self.middle, true)?];
        let first = Step { loads: &loads, ..step.clone() };
        let first = Step { interval: until(contact, step, self.middle)?, ..first };
        let attempt = contact.attempt_on_its_region(&first)?;
        let of_first = error_in_time(&contact.scene, &contact.computation, &first, outlook);
        contact.computation.add_work(wasted);
        let of_first_half = passes(contact);
        contact.adopt(attempt, first, of_first.sizes)?;
        step.interval = until(contact, step, time)?;
        let attempt = contact.attempt_on_its_region(step)?;
        let of_second = error_in_time(&contact.scene, &contact.computation, step, outlook);
        if let Some(passes) = contact.computation.attracted.as_mut() {
            passes.report = passes.report.after(of_first_half, of_whole);
        }
        self.whole_on(&contact.computation.state.held.region);
        let difference = ERROR_FACTORS.halves * self.difference(contact, outlook);
        Ok(Divided { attempt, difference, errors: [of_first, of_second] })
    }

    /// Goes back to the start of the step.
    pub(super) fn undo(&self, contact: &mut ViscoelasticContact) {
        contact.go_to(&self.start);
    }

    /// Its start, where the second half begins at this time.
    pub(super) fn start_of(&self, second: f64) -> Option<&State> {
        (self.middle == second).then_some(&self.start)
    }

    fn keep(&mut self, tried: &Computation) {
        let Computation { state, trial, .. } = tried;
        self.start.clone_from(state);
        let [net, displacement, potential] = &mut self.whole;
        net.clone_from(&trial.solution.pressure);
        net.iter_mut().zip(&trial.solution.attraction).for_each(|(q, s)| *q -= s);
        displacement.clear();
        displacement.extend_from_slice(state.history.tried_displacement());
        potential.clone_from(&trial.solution.potential);
    }

    /// Where the halves needed another region, the whole step gets to it as well.
    fn whole_on(&mut self, region: &Region) {
        let from = &self.start.held.region;
        if region.len() != from.len() {
            self.whole.iter_mut().for_each(|field| *field = from.transfer(field, region, |_| 0.0));
        }
    }

    /// The mean difference of u or v from the whole step, weighted by |z − s|, over their means.
    fn difference(&self, contact: &ViscoelasticContact, outlook: &Outlook) -> f64 {
        let Computation { state, trial, .. } = &contact.computation;
        let ([net, u_whole, v_whole], solution) = (&self.whole, &trial.solution);
        let (u, v) = (state.history.tried_displacement(), &solution.potential);
        let [weight, of_u, of_v, off_u, off_v] = state.held.region.rows().sum_terms(|k| {
            let w = net[k].abs() + (solution.pressure[k] - solution.attraction[k]).abs();
            Some([1.0, u[k].abs(), v[k].abs(), (u[k] - u_whole[k]).abs(), (v[k] - v_whole[k]).abs()].map(|x| w * x))
        });
        let least = least_sizes(&self.start, outlook);
        let over = |off: f64, of: f64, least: f64| if off != 0.0 { off / of.max(least * weight) } else { 0.0 };
        greater(over(off_u, of_u, least[0]), over(off_v, of_v, least[1]))
    }
}

/// Whether a step failed because its load pulls the bodies off.
pub(super) fn is_pulled_off(error: &Error) -> bool {
    matches!(error, Error::PulledOff { .. })
}

/// The interval from now to `time` of a part of a step.
fn until(contact: &ViscoelasticContact, whole: &Step<'_>, time: f64) -> Result<Interval> {
    let part = contact.request(time, time - contact.time(), whole.loads, whole.tolerance)?;
    Ok(Interval { interpolant: whole.interval.interpolant, ..part.interval })
}

/// The greater of two errors; NaN, which is an overflow, where one is.
fn greater(one: f64, other: f64) -> f64 {
    if one.is_nan() || one > other { one } else { other }
}
