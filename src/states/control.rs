//! How the adaptive steps of a run on elastic states are judged.
//!
//! The difference of two outcomes at the end of a step is not enough: a body that parts and touches within the step,
//! or a surface that recovers while nothing presses on it, does not show there. So the free surface and the strains
//! of all levels are compared, and steps end where bodies touch and forces begin or end.

#[cfg(feature = "checkpoint")]
use std::path::Path;

use std::sync::atomic::AtomicBool;

use crate::contact::StepReport;
use crate::error::Result;
use crate::load::{Load, LoadHistory};
use crate::run::Contact;
#[cfg(feature = "checkpoint")]
use crate::run::doubled::SavedRun;
use crate::run::doubled::judge::{Judge, MAX_GROWTH, Record, SMALL, Tries, WITHOUT_ORDER};
use crate::run::passage::{Passage, Span};
use crate::run::trace::PARTS_OF_RUN;
use crate::states::contact::StatesContact;
use crate::states::levels::Demand;

/// How steps are judged: docs/maintainers/tuned_numbers.md has half and twice of each.
struct Aims {
    /// Share of the tolerance that the error of a step aims at: errors of several steps add up, and over taps.
    aim: f64,
    aim_of_force: f64,
    /// Further part of the aim for bodies without elastic response: nothing brings their level back.
    aim_of_rates: f64,
    /// Two halves err by a third of their difference to the whole, as where the order is two: the curve between states
    /// has kinks in its curvature.
    of_halves: f64,
    /// Levels that the edge swept in a step are resolved by its length alone: their error does not add up over the
    /// steps, but over the taps that come back to them, and counts so much, chosen on 300 random runs that tap and
    /// part; less where forces are given throughout.
    swept: f64,
    swept_by_force: f64,
    /// Along the surface, levels that slip or that the edge passed count so much: a level is off in the step in which it
    /// begins to slip, and right again once those below it slip.
    slipping: f64,
    /// What lasts along the surface adds up over all steps since the last corner: the difference of one times their
    /// number counts so much.
    lasting: f64,
    /// What hardly counts, in tolerances: the overshoot of a step that ends where bodies touch, and the merging of
    /// levels.
    slight: f64,
}

const AIMS: Aims = Aims {
    aim: 0.08,
    aim_of_force: 0.1,
    aim_of_rates: 0.2,
    of_halves: 1.0 / 3.0,
    swept: 0.2,
    swept_by_force: 0.05,
    slipping: 0.05,
    lasting: 0.3,
    slight: 0.01,
};

/// What the loads of a run make of elastic states.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct OnLevels {
    /// The longest time for which at least half of the greatest load acts.
    pressed: f64,
    /// How long loads act in all.
    loaded: f64,
    /// A load, and the time that it takes from nothing to there at its rate then, where a body
    /// without elastic response that is approached resists most.
    rise: [f64; 2],
}

impl OnLevels {
    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        [self.pressed, self.loaded, self.rise[0], self.rise[1]].iter().all(|&size| size >= 0.0)
    }
}

impl Judge<StatesContact> for OnLevels {
    /// That of a corrected step.
    const ORDER: f64 = 3.0;

    fn size(contact: &StatesContact, load: Load) -> Result<f64> {
        let (Demand::Force(value) | Demand::Depth { depth: value, .. }) = contact.demand(load)?;
        Ok(value)
    }

    fn rest(contact: &StatesContact) -> f64 {
        contact.states.rest.approach
    }

    fn look(record: &mut Record<OnLevels>, loads: &[(f64, f64)]) {
        let Record { greatest_load, start, until, .. } = record;
        // a body without elastic response has no depth as soon as the load acts
        let spells = loads.split(|load| load.1 < 0.5 * *greatest_load);
        let lengths = spells.filter_map(|spell| Some(spell.last()?.0 - spell.first()?.0));
        record.own.pressed = lengths.fold((*until - *start) / f64::from(PARTS_OF_RUN), f64::max);
        let pairs = || loads.windows(2).map(|pair| [pair[0], pair[1]]).filter(|[before, after]| after.0 > before.0);
        record.own.loaded = pairs().filter(|[_, after]| after.1 > 0.0).map(|[before, after]| after.0 - before.0).sum();
        // it resists by the rate of its level, about the square of the load
        let rises = pairs()
            .filter(|[before, after]| after.1 > before.1.max(0.0))
            .map(|[before, after]| [after.1, after.1 * (after.0 - before.0) / (after.1 - before.1.max(0.0))]);
        let resists = |[load, rise]: &[f64; 2]| load * load / rise;
        let steepest = rises.max_by(|a, b| resists(a).total_cmp(&resists(b)));
        record.own.rise = steepest.unwrap_or([greatest_load.max(0.0), *until - *start]);
    }

    fn trial(contact: &StatesContact) -> StatesContact {
        contact.clone().with_quadratic_steps()
    }

    fn copy(to: &mut StatesContact, from: &StatesContact) {
        to.copy_from(from);
    }

    fn take(contact: &mut StatesContact, time: f64, load: Load, _: Option<&AtomicBool>) -> Result<StepReport> {
        contact.advance(time, time - contact.time(), load, None)
    }

    fn accept(record: &Record<OnLevels>, contact: &mut StatesContact) {
        contact.levels.merge(&contact.states, AIMS.slight * record.tolerance);
    }

    fn turn(contact: &mut StatesContact) {
        contact.levels.reset_differences();
    }

    /// Imprints need the short steps that come of rejections where nothing yields.
    fn longest_growth(contact: &StatesContact, load: Load) -> f64 {
        let yields = contact.levels.has_dashpot() || !matches!(load, Load::Approach { .. });
        if yields { contact.levels.longest_growth() } else { MAX_GROWTH }
    }

    fn aim(record: &Record<OnLevels>, contact: &StatesContact, _: Span, _: f64) -> f64 {
        let of_load = if record.by_force { AIMS.aim_of_force } else { AIMS.aim };
        let of_body = if contact.levels.has_dashpot() { AIMS.aim_of_rates } else { 1.0 };
        of_body * of_load * record.tolerance
    }

    /// The first time within a step at which bodies touch or part, or a force begins or ends.
    fn event(
        record: &Record<OnLevels>,
        contact: &StatesContact,
        history: &dyn LoadHistory,
        passage: &Passage,
        scratch: &mut StatesContact,
    ) -> Result<Option<f64>> {
        let mut load = |time: f64| OnLevels::size(contact, load_at(history, time)?);
        if load_at(history, passage.span().end)?.is_force() {
            return passage.first_change_of_force(&mut load);
        }
        let touch = contact.level() > 0.0;
        if touch && !passage.falls() {
            return Ok(None);
        }
        scratch.copy_from(contact);
        let scale = record.greatest[0].max(1e-3 * record.greatest_load);
        passage.first_event(
            touch,
            AIMS.slight * record.tolerance * scale,
            &mut |time| scratch.surface_at(time),
            &mut load,
        )
    }

    /// How far the whole differs from the halves, in depth and force, relative to values that are not small in this
    /// run.
    fn error(
        record: &Record<OnLevels>,
        contact: &StatesContact,
        Tries { whole, halves, middle }: &mut Tries<StatesContact>,
        history: &dyn LoadHistory,
        span: Span,
        report: &StepReport,
    ) -> Result<f64> {
        let Span { now, end } = span;
        let (half, last) = (0.5 * (end - now), load_at(history, end)?);
        let cuts = [middle.level(), halves.level()];
        let mut of_surface = whole.levels.distance(
            &whole.states,
            &halves.levels,
            contact.level(),
            cuts,
            (end - record.corner) / half,
            if record.by_force { AIMS.swept_by_force } else { AIMS.swept },
        );
        if record.by_force {
            of_surface[1] = 0.0;
        }
        let demand = contact.demand(last)?;
        let (Record { until, greatest_load, .. }, OnLevels { pressed, loaded, rise }) = (record, &record.own);
        let times = [*until, *pressed, rise[1]].map(|time| time / half);
        let expected = halves.levels.expected(&halves.states, demand, [*greatest_load, rise[0]], times);
        let reached = OnLevels::greatest(record, halves);
        let greatest = [0, 1].map(|k| reached[k].max(SMALL * expected[k]));
        let results = |contact: &StatesContact| [contact.depth(), contact.force()];
        let ended = [&*whole, &*halves].map(results);
        // rates of a prescribed approach resist at once, and leave nothing behind
        let is_local = halves.levels.has_dashpot() && matches!(last, Load::Approach { .. });
        let small = [SMALL, if is_local { 1.0 } else { SMALL }];
        let scales = [0, 1].map(|k| f64::abs(ended[1][k]).max(small[k] * greatest[k]));
        let mut worst = 0.0f64;
        let mut see = |differences: [f64; 2], scales: [f64; 2]| {
            for (difference, scale) in differences.into_iter().zip(scales).filter(|(_, scale)| *scale > 0.0) {
                worst = worst.max(difference.abs() / scale);
            }
        };
        see(of_surface, greatest);
        if whole.level() > 0.0 || halves.level() > 0.0 {
            see([0, 1].map(|k| ended[0][k] - ended[1][k]), scales);
        }
        let off = whole.levels.shear_distance(&halves.levels, contact.level(), AIMS.slipping);
        if let (Some(off), Some(shear)) = (off, &halves.levels.shear) {
            // early in a run, what acts along the surface is small beside what will act
            let along = SMALL * record.greatest_along[0] / halves.reached_along();
            let [along, pressed] =
                [along, greatest[1] / reached[1]].map(|ahead| if ahead.is_finite() { ahead.max(1.0) } else { 1.0 });
            let (pressed, [far, most, done]) = (along.max(pressed), shear.maxima.map(|most| SMALL * most));
            let scales = [shear.displacement().abs().max(far * along), shear.force.abs().max(most * pressed)];
            let asked = |time: f64| contact.along(time, time - now, None).ok().flatten();
            let stuck = halves.levels.stuck_again(&halves.states, [&contact.levels, &middle.levels], span, asked);
            // where slip ends within the step, the halves miss by about as much as the whole when it does
            let slips = |contact: &StatesContact| contact.stick_level() < contact.level();
            let order = if slips(contact) && !slips(halves) { WITHOUT_ORDER / AIMS.of_halves } else { 1.0 };
            see([order * off[0], order * off[2] + stuck / AIMS.of_halves], scales);
            // where bodies part, the halves agree although both pass over the slip: all that the last part loses is in
            // doubt
            let held = if middle.level() > 0.0 { &middle.levels } else { &contact.levels };
            let released = held.shear.as_ref().map_or(0.0, |held| shear.lost - held.lost);
            let in_doubt = if halves.level() > 0.0 { 0.0 } else { released };
            // what begins to slip has lost next to nothing yet
            let done = done.max(far * most) * along * pressed;
            // the loss is of no certain order where edges move in the step: the error of the halves is at most their
            // difference from the whole
            see([(off[3] + in_doubt) / AIMS.of_halves, off[4]], [shear.lost.max(done), done / SMALL]);
            // levels that stick keep what a step has moved them by, and a spring its force
            let lasting = |demand| lasting(AIMS.lasting, halves, demand, span, end - record.corner);
            let steps = asked(end).map_or(0.0, lasting);
            see([steps * off[1], steps * off[2]], scales);
            halves.levels.extrapolate_losses([contact, &*whole].map(|contact| &contact.levels), AIMS.of_halves);
        }
        // what steps like this one add since the last corner, and nothing brings back, may be as large as the
        // tolerance: to the depth under a spring, and to the surface of bodies apart that resist rates alone
        let acts = halves.level() > 0.0;
        let (time, off) = if acts { (*loaded, ended[0][0] - ended[1][0]) } else { (*until, of_surface[0]) };
        let by_spring = matches!(demand, Demand::Depth { give, .. } if give > 0.0);
        if acts && by_spring || !acts && halves.levels.has_dashpot() {
            let steps = lasting(AIMS.aim, halves, demand, span, time.min(end - record.corner));
            see([steps * off, 0.0], greatest);
        }
        let parts = report.force == 0.0 && contact.level() > 0.0;
        Ok(if record.next == 0.0 || record.touches || parts { WITHOUT_ORDER } else { AIMS.of_halves } * worst)
    }

    /// Depths without contact are no scale.
    fn greatest(record: &Record<OnLevels>, halves: &StatesContact) -> [f64; 2] {
        let force = halves.force();
        let depth = if force == 0.0 { 0.0 } else { halves.depth().abs() };
        [record.greatest[0].max(depth), record.greatest[1].max(force)]
    }

    #[cfg(feature = "checkpoint")]
    fn save(contact: &StatesContact, run: SavedRun<OnLevels>, path: &Path) -> Result<()> {
        contact.save_with(path, Some(run))
    }
}

/// What is left of a difference that each step like the one over a span makes for a `time`, over one such difference, as
/// much as it counts.
fn lasting(counts: f64, halves: &StatesContact, demand: Demand, Span { now, end }: Span, time: f64) -> f64 {
    let steps = (time / (end - now)).min(f64::from(PARTS_OF_RUN));
    counts * halves.levels.lasting(&halves.states, demand, time / (0.5 * (end - now))) * steps
}

/// The load at a time, or just before it where it jumps.
fn load_at(history: &dyn LoadHistory, time: f64) -> Result<Load> {
    history.checked_before(time, false)
}
