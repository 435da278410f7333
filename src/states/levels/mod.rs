//! The levels of a contact: groups with one past each, and the level up to which they are held.

mod distance;
mod edge;
mod merging;
mod refusals;
mod shear;

use crate::error::{Error, Result, StepError};
use crate::hereditary::{ExponentialRule, GroupHistory, Interpolant};
use crate::states::curve::{ElasticStates, Motions};
pub(super) use crate::states::levels::shear::Shear;
use refusals::{below, beyond, beyond_friction, out_of_order};

/// Rounding of a displacement between 0 and 1, and of levels that are one.
const ROUNDING: f64 = 1e-9;
const SAME_LEVEL: f64 = 1e-15;
/// Room for so many groups is made at once.
const GROUPS: usize = 256;

/// What is prescribed at the end of a step.
#[derive(Debug, Clone, Copy)]
pub(super) enum Demand {
    /// A force \[N\].
    Force(f64),
    /// A depth of the load point below the first touch of the undisturbed bodies \[m\], which a spring of the
    /// compliance `give` \[m/N\] prescribes: depth less give times force; 0 for a given approach.
    Depth { depth: f64, give: f64 },
}

/// A level c, and how it is found: δ(c) + `give` c = `sum`; `give` is infinite where it does not depend on the
/// states. Levels that the edge meets have this `lead`, 0 if they have none.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted {
    pub(super) level: f64,
    pub(super) give: f64,
    pub(super) sum: f64,
    lead: f64,
}

/// Levels from the top of the group before to its own, with one past.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Group {
    /// Level and motions at its top.
    top: f64,
    motions: Motions,
    /// w at the end of the last step \[Pa\]: 0 where the group is free.
    traction: f64,
    /// θ, along the surface, over the coefficient of friction.
    shear: f64,
    /// ∫ δ dl below its top \[m³\]; 0 without friction.
    work: f64,
}

/// Groups by ascending levels, their past, and the state that they make.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Levels {
    pub(super) history: GroupHistory,
    groups: Vec<Group>,
    /// Number of groups from which on they are merged.
    merge_from: usize,
    /// W of each group at the end of the step being tried.
    trial: Vec<f64>,
    /// Level up to which the groups are held \[m²\].
    pub(super) level: f64,
    /// Σ (1 − W) Δl of the levels that it passed in the last step, and its difference to the step before.
    passed: [f64; 2],
    /// Σ w Δl \[N\].
    pub(super) force: f64,
    /// Σ W Δy, less the lift.
    pub(super) motions: Motions,
    /// How far bodies of given approach are apart \[m\].
    pub(super) lift: f64,
    /// What happens along the surface, if there is friction.
    pub(super) shear: Option<Shear>,
}

/// With room for as many groups as another has.
impl Clone for Levels {
    fn clone(&self) -> Levels {
        let mut levels = Levels::new(self.history.rule().clone());
        if self.shear.is_some() {
            levels.make_room_for_shear();
        }
        levels.copy_from(self);
        levels
    }
}

impl Levels {
    pub(super) fn new(rule: ExponentialRule) -> Levels {
        Levels {
            history: GroupHistory::new(rule, GROUPS),
            groups: Vec::with_capacity(GROUPS),
            merge_from: 0,
            trial: Vec::with_capacity(GROUPS),
            level: 0.0,
            passed: [0.0; 2],
            force: 0.0,
            motions: Motions::default(),
            lift: 0.0,
            shear: None,
        }
    }

    /// Copies another without reallocating where there is room.
    pub(super) fn copy_from(&mut self, other: &Levels) {
        self.history.clone_from(&other.history);
        self.groups.clone_from(&other.groups);
        self.trial.clone_from(&other.trial);
        (self.merge_from, self.passed) = (other.merge_from, other.passed);
        (self.level, self.force, self.motions, self.lift) = (other.level, other.force, other.motions, other.lift);
        self.shear.clone_from(&other.shear);
    }

    /// Whether these may be levels of the contact of `other`; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self, other: &Levels) -> bool {
        let tops = || self.groups.iter().map(|group| group.top);
        let of_motions = |Motions { depth, tilt: [tilt1, tilt2] }: Motions| [depth, tilt1, tilt2];
        let of_groups = self.groups.iter().flat_map(|group| {
            let Group { top, motions, traction, shear, work } = *group;
            of_motions(motions).into_iter().chain([top, traction, shear, work])
        });
        let numbers = of_motions(self.motions).into_iter().chain([self.level, self.force, self.lift]);
        let is_finite = of_groups.chain(numbers).chain(self.passed).all(f64::is_finite);
        let is_sheared = match &self.shear {
            Some(shear) => other.shear.is_some() && shear.fits(),
            None => other.shear.is_none(),
        };
        self.history.fits(&other.history, self.groups.len()) && is_finite && tops().is_sorted() && is_sheared
    }

    /// Whether the body has no elastic response.
    pub(super) fn has_dashpot(&self) -> bool {
        self.history.rule().has_dashpot()
    }

    /// Number of groups.
    pub(super) fn count(&self) -> usize {
        self.groups.len()
    }

    /// The top of each group, w and W.
    pub(super) fn groups(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        let displacements = self.history.displacements();
        self.groups.iter().zip(displacements).map(|(group, &displacement)| (group.top, group.traction, displacement))
    }

    /// The past does not determine how the groups continue, as after a corner of the load.
    pub(super) fn reset_differences(&mut self) {
        self.history.reset_differences();
    }

    /// The level up to which groups are held at the end of a step, and the sum δ(c) + `give` c/C_Δ that a demand for a
    /// depth finds it by. Writes only the prediction: groups and past stay.
    pub(super) fn wanted(
        &mut self,
        states: &ElasticStates,
        (time, dt): (f64, f64),
        interpolant: Interpolant,
        demand: Demand,
    ) -> Result<Wanted> {
        let is_between = self.history.predict(dt, interpolant, &mut self.trial);
        self.predict_shear();
        let compliance = self.history.rule().compliance();
        if compliance == 0.0 {
            let what = "a jump of the load that changes the pressure";
            let level = self.level_without_response(demand);
            let level = level.ok_or(Error::Step(StepError::NoElasticResponse { time, what }))?;
            return Ok(Wanted { level, give: f64::INFINITY, sum: 0.0, lead: 0.0 });
        }
        if !compliance.is_finite() {
            return Err(Error::Step(StepError::Overflow { time, what: "the compliance" }));
        }
        let mut has_order = is_between;
        let wanted = loop {
            let plain = self.level_of(states, demand, 0.0);
            let lead = if plain.level > self.level { self.lead() } else { 0.0 };
            let led = if lead > 0.0 { self.level_of(states, demand, lead) } else { plain };
            // levels that would pull: the edge has slowed down by more than a quadratic describes
            if lead == 0.0 || lead <= self.swept(led.level) {
                break led;
            }
            if !self.history.reduce_order(&mut self.trial) {
                break plain;
            }
            has_order = false;
        };
        if !has_order {
            self.check_order(time)?;
        }
        let level = wanted.level;
        self.sticks_to(level).map_err(|share| beyond_friction(time, share))?;
        if level.is_nan() {
            return Err(Error::Step(StepError::Overflow { time, what: "the level" }));
        }
        if let Demand::Force(force) = demand
            && force > 0.0
            && level < f64::MIN_POSITIVE
        {
            let allowed = "0, or so great that the force times the compliance is a number";
            return Err(Error::OutOfRange { field: "normal force", value: force, allowed });
        }
        if level > states.last_level() {
            let (needed, last) = match demand {
                Demand::Force(_) => (format!("the level {level:.3e} m²"), states.last_level()),
                Demand::Depth { depth, .. } => (format!("the depth {depth:.3e} m"), states.last_depth()),
            };
            return Err(beyond(time, &needed, last));
        }
        if level > 0.0 && level < states.first_level() * (1.0 - ROUNDING) {
            return Err(below(time, level, states.first_level()));
        }
        Ok(wanted)
    }

    /// The level after a jump of a body without elastic response, which moves no surface: the present level if the
    /// demand is met already, 0 if nothing presses on the surface any more.
    fn level_without_response(&self, demand: Demand) -> Option<f64> {
        let is_met = |present: f64, wanted: f64| (present - wanted).abs() <= ROUNDING * present.abs().max(wanted.abs());
        let (is_met, presses) = match demand {
            Demand::Force(force) => (is_met(self.force, force), force > 0.0),
            Demand::Depth { depth, give } => {
                let surface = self.motions.depth + self.lift;
                (is_met(self.motions.depth + give * self.force, depth), depth > surface * (1.0 + ROUNDING))
            }
        };
        if is_met && self.level > 0.0 { Some(self.level) } else { (!presses).then_some(0.0) }
    }

    /// No group that nothing holds sinks below held ones.
    fn check_order(&self, time: f64) -> Result<()> {
        match self.trial.iter().find(|w| !w.is_finite() || **w > 1.0 + ROUNDING) {
            None => Ok(()),
            Some(w) if !w.is_finite() => Err(Error::Step(StepError::Overflow { time, what: "the displacement" })),
            Some(&share) => Err(out_of_order(time, share)),
        }
    }

    /// Accepts the step of [`Levels::wanted`], to a demand along the surface where there is friction.
    pub(super) fn accept(
        &mut self,
        states: &ElasticStates,
        demand: Demand,
        Wanted { level, lead, .. }: Wanted,
        along: Option<Demand>,
    ) {
        if self.history.rule().compliance() > 0.0 {
            let edge = self.level;
            let swept = if self.history.leads() { self.swept(level) } else { 0.0 };
            self.cut_at(states, level);
            if lead > 0.0 {
                self.lead_groups(self.groups_to(edge)..self.groups_to(level), lead, swept);
            }
            self.hold(level);
            along.into_iter().for_each(|along| self.shear_to(states, along, edge));
            let sheared = self.shear.as_ref().map_or(&[][..], Shear::displacements);
            self.history.commit(&self.trial, sheared);
            self.passed = self.history.differences_after(self.passed, swept);
        } else if level == 0.0 {
            self.release();
            self.release_shear(along);
        }
        match demand {
            Demand::Depth { depth, .. } if level == 0.0 => {
                self.lift = self.motions.depth - depth;
                self.motions.depth = depth;
            }
            // in place of the sum of tractions, which are rounded differences over the compliance of the step
            Demand::Force(force) if level > 0.0 => self.force = force,
            _ => {}
        }
    }

    /// The groups, each with its bottom, that of the first being 0, and its W if nothing holds it.
    fn spans(&self) -> impl Iterator<Item = (f64, Motions, &Group, f64)> {
        self.groups.iter().zip(&self.trial).enumerate().map(|(k, (group, &free))| {
            let (bottom, motions) = self.bottom(k);
            (bottom, motions, group, free)
        })
    }

    /// Level and motions at the bottom of a group.
    fn bottom(&self, group: usize) -> (f64, Motions) {
        group.checked_sub(1).map_or((0.0, Motions::default()), |k| (self.groups[k].top, self.groups[k].motions))
    }

    /// Splits the group that contains a level there, or adds a group up to it.
    fn cut_at(&mut self, states: &ElasticStates, level: f64) {
        let group = self.groups.partition_point(|group| group.top < level);
        let is_near = |other: f64| (other - level).abs() <= SAME_LEVEL * level;
        if is_near(self.bottom(group).0) || self.groups.get(group).is_some_and(|group| is_near(group.top)) {
            return;
        }
        let work = self.shear.as_ref().map_or(0.0, |_| {
            let below = group.checked_sub(1).map(|k| self.groups[k]);
            let (bottom, work) = below.map_or((0.0, 0.0), |below| (below.top, below.work));
            work + states.work(bottom, level)
        });
        let split = self.groups.get(group).copied();
        if split.is_some() {
            self.history.split(group);
            self.trial.insert(group, self.trial[group]);
        } else {
            self.history.push();
            self.trial.push(0.0);
        }
        self.shear.iter_mut().for_each(|shear| shear.cut(group));
        let (traction, shear) = split.map_or((0.0, 0.0), |split| (split.traction, split.shear));
        self.groups.insert(group, Group { top: level, motions: states.motions(level), traction, shear, work });
    }

    /// Releases all groups where they are; takes no step. As after any jump, the past does not determine how they
    /// continue.
    fn release(&mut self) {
        self.history.reset_differences();
        self.groups.iter_mut().for_each(|group| group.traction = 0.0);
        self.motions.depth += self.lift;
        (self.level, self.force, self.lift) = (0.0, 0.0, 0.0);
    }

    /// Holds the groups up to a level.
    fn hold(&mut self, level: f64) {
        let stiffness = 1.0 / self.history.rule().compliance();
        self.level = level;
        let held = self.held();
        let (mut force, mut motions, mut bottom, mut lower) = (0.0, Motions::default(), 0.0, Motions::default());
        for (k, (group, displacement)) in self.groups.iter_mut().zip(&mut self.trial).enumerate() {
            group.traction = if k < held { (1.0 - *displacement) * stiffness } else { 0.0 };
            *displacement = if k < held { 1.0 } else { displacement.min(1.0) };
            force += group.traction * (group.top - bottom);
            motions.add(*displacement, lower, group.motions);
            (bottom, lower) = (group.top, group.motions);
        }
        (self.force, self.motions, self.lift) = (force, motions, 0.0);
    }

    /// Number of groups that are held.
    pub(super) fn held(&self) -> usize {
        self.groups_to(self.level)
    }

    /// Number of groups up to a level.
    fn groups_to(&self, level: f64) -> usize {
        self.groups.partition_point(|group| group.top <= level * (1.0 + SAME_LEVEL))
    }

    /// Σ W Δδ at the end of a step in which all groups are free: the depth that a body must pass to touch.
    pub(super) fn surface_after(&mut self, dt: f64, interpolant: Interpolant) -> f64 {
        self.history.predict(dt, interpolant, &mut self.trial);
        self.spans().map(|(_, lower, group, free)| free.min(1.0) * (group.motions.depth - lower.depth)).sum()
    }
}
