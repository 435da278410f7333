//! Friction: what groups of levels do along the surface.
//!
//! Where bodies respond alike to normal and tangential loads, the traction along the surface is a sum of the same
//! elastic states as the pressure, with a second share for each level: τ = ∫ θ q dl, of which the body moves by
//! ∫ U dδ, U = C∗dθ. Levels below one s stick, so that their U stays; those between s and the edge slip, θ = ± f w;
//! free ones carry nothing. A step slips from the edge inwards until its demand is met. Levels that are met in a step
//! take one part of f w before any slips. Steps are linear in time: where slip begins or ends, U has a kink.
//!
//! θ and forces are divided by the coefficient f here, U and displacements by f times the ratio of the compliances
//! along the surface and normal to it, and works by both.

mod loss;

use std::ops::Range;

use crate::error::{Error, Result, StepError};
use crate::states::curve::ElasticStates;
use crate::states::levels::{Demand, GROUPS, Group, Levels, ROUNDING, Wanted};

/// Sums of as many terms as there are groups are rounded by about this part of them.
const ROUNDED: f64 = 64.0 * f64::EPSILON;

/// Works below this \[J\] are numbers, and their sums.
const MAX_WORK: f64 = 1e200;

/// What happens along the surface.
#[derive(Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::states) struct Shear {
    /// Whether levels that are met slip from the start of the step on, as if they had been in contact.
    whole: bool,
    /// Of the step being tried: U of each group if nothing shears it any more, then at its end.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    trial: Vec<f64>,
    /// θ of each group at its end.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    tractions: Vec<f64>,
    /// θ of each group, averaged over the step.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    mean: Vec<f64>,
    /// ∫ θ dl \[N\].
    pub(in crate::states) force: f64,
    /// ∫ U dδ \[m\].
    pub(in crate::states) motion: f64,
    /// How far the whole contact has slid \[m\].
    pub(in crate::states) slid: f64,
    /// Level up to which the contact sticks \[m²\].
    pub(in crate::states) stick: f64,
    /// Forces of a history along the surface below this are none \[N\].
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(in crate::states) least: f64,
    /// Maximum so far of |displacement|, of |force| and of |work|.
    pub(in crate::states) maxima: [f64; 3],
    /// Work that the body has done along the surface, and the part of it that slip has dissipated \[J\].
    pub(in crate::states) work: f64,
    pub(in crate::states) lost: f64,
}

clone_by_fields! { Shear { whole, trial, tractions, mean, force, motion, slid, stick, least, maxima, work, lost } }

impl Shear {
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        let Shear { force, motion, slid, stick, maxima: [far, most, done], work, lost, .. } = self;
        [force, motion, slid, work, lost].iter().all(|value| value.is_finite())
            && [stick, far, most, done].iter().all(|value| value.is_finite() && **value >= 0.0)
    }

    /// Of the body: that of the contact, and how far it has slid.
    pub(in crate::states) fn displacement(&self) -> f64 {
        self.motion + self.slid
    }

    /// U of each group at the end of the step.
    pub(super) fn displacements(&self) -> &[f64] {
        &self.trial
    }

    /// Splits a group, or adds one after the others.
    pub(super) fn cut(&mut self, group: usize) {
        for column in [&mut self.trial, &mut self.tractions] {
            column.insert(group, column.get(group).copied().unwrap_or_default());
        }
    }
}

/// What is prescribed along the surface: the sum of ∫ θ dl and ∫ U dδ with these weights.
#[derive(Debug, Clone, Copy)]
struct Wish {
    weights: [f64; 2],
    sum: f64,
}

impl Wish {
    fn new(demand: Demand) -> Wish {
        match demand {
            Demand::Force(force) => Wish { weights: [1.0, 0.0], sum: force },
            Demand::Depth { depth, give } => Wish { weights: [give, 1.0], sum: depth },
        }
    }

    /// What a group of these widths, in level and depth, has of it.
    fn of(&self, [level, depth]: [f64; 2], traction: f64, displacement: f64) -> f64 {
        self.weights[0] * level * traction + self.weights[1] * depth * displacement
    }
}

/// What a step does to the groups that it holds: the first ones `stick`, those `met` share a part of what they could
/// carry, those between slip. What is `left` of the wish moves the whole contact.
#[derive(Debug)]
struct Slipping {
    stick: usize,
    met: Range<usize>,
    share: f64,
    sense: f64,
    left: f64,
}

/// Width of a group in level and depth.
fn widths(groups: &[Group], k: usize) -> [f64; 2] {
    let (bottom, lower) = k.checked_sub(1).map_or((0.0, 0.0), |k| (groups[k].top, groups[k].motions.depth));
    [groups[k].top - bottom, groups[k].motions.depth - lower]
}

/// ∫ (δ(top) − δ) dl of a group of this width in level.
fn inner_work(groups: &[Group], k: usize, width: f64) -> f64 {
    let below = k.checked_sub(1).map_or(0.0, |k| groups[k].work);
    groups[k].motions.depth * width - (groups[k].work - below)
}

impl Levels {
    /// With friction; nothing has acted along the surface yet.
    pub(in crate::states) fn with_shear(&mut self, states: &ElasticStates) {
        self.make_room_for_shear();
        self.shear.iter_mut().for_each(|shear| shear.stick = self.level);
        let (mut bottom, mut work) = (0.0, 0.0);
        for group in &mut self.groups {
            work += states.work(bottom, group.top);
            (bottom, group.work) = (group.top, work);
        }
    }

    pub(super) fn make_room_for_shear(&mut self) {
        self.history.add_tangential(GROUPS);
        let [trial, tractions, mean] = [(); 3].map(|()| Vec::with_capacity(GROUPS));
        self.shear = Some(Shear { trial, tractions, mean, ..Shear::default() });
    }

    /// Lets levels that are met slip from the start of the step on.
    pub(in crate::states) fn slip_from_start(&mut self) {
        self.shear.iter_mut().for_each(|shear| shear.whole = true);
    }

    /// The top of each group, and θ over the coefficient of friction.
    pub(in crate::states) fn shears(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.groups.iter().map(|group| (group.top, group.shear))
    }

    /// ½ Σ ∫∫ a(l) a(l′) κ(max(l, l′)) dl dl′, the energy of springs, with κ = dδ/dl and a = √E∞ U and q_i/√E_i.
    pub(in crate::states) fn stored_along(&self) -> f64 {
        let Some(now) = self.history.tangential_displacements() else { return 0.0 };
        let of = |a: &[f64]| {
            let (mut below, mut sum) = (0.0, 0.0);
            for (k, a) in a.iter().enumerate() {
                let [width, depth] = widths(&self.groups, k);
                sum += a * (below * depth + a * inner_work(&self.groups, k, width));
                below += a * width;
            }
            sum
        };
        self.history.rule().equilibrium() * of(now)
            + self.history.shear_stresses().map(|(modulus, q)| of(q) / modulus).sum::<f64>()
    }

    pub(super) fn predict_shear(&mut self) {
        let Levels { history, shear: Some(shear), .. } = self else { return };
        history.predict_shear(&mut shear.trial);
        shear.tractions.clear();
        shear.tractions.resize(shear.trial.len(), 0.0);
    }

    /// Whether all levels up to one that were held can stick, |θ| ≤ w, so that those that slip are the ones at the
    /// edge. If not, the maximum of |θ| over w.
    pub(super) fn sticks_to(&self, level: f64) -> Result<(), f64> {
        let (Some(now), Some(shear)) = (self.history.tangential_displacements(), &self.shear) else { return Ok(()) };
        let held = self.groups.partition_point(|group| group.top < self.level.min(level) * (1.0 - ROUNDING)) + 1;
        let over = |k: usize| {
            let (holds, presses) = ((now[k] - shear.trial[k]).abs(), 1.0 - self.trial[k]);
            if holds > presses + ROUNDING { holds / presses.max(ROUNDING) } else { 0.0 }
        };
        let worst = (0..held.min(self.groups.len())).map(over).fold(0.0, f64::max);
        if worst > 0.0 && level > 0.0 { Err(worst) } else { Ok(()) }
    }

    /// Fails where a demand along the surface cannot be met at the end of a step: a force beyond friction, a jump of a
    /// body without elastic response, or where the work is no number.
    pub(in crate::states) fn check_shear(
        &self,
        states: &ElasticStates,
        time: f64,
        along: Demand,
        Wanted { level, .. }: Wanted,
    ) -> Result<()> {
        let Some(shear) = &self.shear else { return Ok(()) };
        let (compliance, Wish { weights, sum }) = (self.history.rule().compliance(), Wish::new(along));
        if compliance == 0.0 && level > 0.0 {
            let parts = [weights[0] * shear.force, weights[1] * shear.displacement()];
            let size = parts[0].abs() + parts[1].abs() + sum.abs();
            let what = "a jump of the load along the surface";
            let is_met = (parts[0] + parts[1] - sum).abs() <= ROUNDING * size;
            return if is_met { Ok(()) } else { Err(StepError::NoElasticResponse { time, what }.into()) };
        }
        // a release in a jump of bodies without elastic response does no work
        let far = shear.displacement().abs() + sum.abs() + states.depth(level.max(self.level));
        let work = far * (self.force + level.max(self.level) / compliance.max(f64::MIN_POSITIVE));
        if compliance > 0.0 && (work.is_nan() || work >= MAX_WORK) {
            return Err(StepError::Overflow { time, what: "the work along the surface" }.into());
        }
        let Demand::Force(force) = along else { return Ok(()) };
        let carried =
            |(bottom, _, group, free): (f64, _, &Group, f64)| (1.0 - free) * (group.top.min(level) - bottom).max(0.0);
        let beyond = (level - self.bottom(self.groups.len()).0).max(0.0);
        let carried = self.spans().map(carried).sum::<f64>() + beyond;
        let limit = if level > 0.0 { carried / compliance } else { 0.0 };
        if force.abs() > limit * (1.0 + ROUNDING) {
            return Err(Error::Slides { time, over_limit: force.abs() / limit, direction: None });
        }
        Ok(())
    }

    /// Shears the groups that a step holds to a demand. Those that were held stick, those that were met share what is
    /// needed, then the held ones slip from the edge inwards.
    pub(super) fn shear_to(&mut self, states: &ElasticStates, along: Demand, edge: f64) {
        let held = self.held();
        let met =
            if self.shear.as_ref().is_some_and(|shear| shear.whole) { held } else { self.groups_to(edge).min(held) };
        let (wish, met) = (Wish::new(along), met..held);
        let needed = self.stick_and_need(wish, met.start);
        let (sense, part) = (if needed < 0.0 { -1.0 } else { 1.0 }, self.part_of_met(wish, met.clone(), needed));
        let share = sense * part.min(1.0);
        let Some(shear) = &mut self.shear else { return };
        met.clone().for_each(|k| shear.tractions[k] = share * self.groups[k].traction);
        let left = if part < 1.0 { 0.0 } else { needed - needed / part };
        let mut slipping = Slipping { stick: met.start, met, share, sense, left };
        self.slip(states, wish, &mut slipping);
        self.commit_shear(along, edge, &slipping);
    }

    /// Lets the groups that were held stick, and nothing act on the others. Returns what is lacking of a wish.
    fn stick_and_need(&mut self, wish: Wish, stick: usize) -> f64 {
        let Levels { history, groups, shear: Some(shear), .. } = self else { return 0.0 };
        let compliance = history.rule().compliance();
        let slid = wish.weights[1] * shear.slid;
        let (mut needed, mut size) = (wish.sum - slid, wish.sum.abs() + slid.abs());
        let Some(now) = history.tangential_displacements() else { return 0.0 };
        let moved = now.iter().zip(&shear.trial).zip(&mut shear.tractions);
        for (k, ((&now, &free), traction)) in moved.enumerate() {
            let (acts, displacement) = if k < stick { ((now - free) / compliance, now) } else { (0.0, free) };
            *traction = acts;
            let has = wish.of(widths(groups, k), acts, displacement);
            (needed, size) = (needed - has, size + has.abs());
        }
        if needed.abs() <= ROUNDED * size { 0.0 } else { needed }
    }

    /// What is needed over what the groups that were met add if they slip; infinite without any.
    fn part_of_met(&self, wish: Wish, met: Range<usize>, needed: f64) -> f64 {
        let compliance = self.history.rule().compliance();
        let room = |k: usize| {
            let traction = self.groups[k].traction;
            wish.of(widths(&self.groups, k), traction, compliance * traction)
        };
        let all = met.map(room).sum::<f64>();
        if needed == 0.0 {
            0.0
        } else if all > 0.0 {
            needed.abs() / all
        } else {
            f64::INFINITY
        }
    }

    /// Lets groups that were held slip, from the edge inwards, until nothing is left of a wish; cuts the last one.
    fn slip(&mut self, states: &ElasticStates, wish: Wish, slipping: &mut Slipping) {
        let compliance = self.history.rule().compliance();
        while slipping.left != 0.0 && slipping.stick > 0 {
            let Some(shear) = &mut self.shear else { return };
            let k = slipping.stick - 1;
            let more = slipping.sense * self.groups[k].traction - shear.tractions[k];
            let gain = wish.of(widths(&self.groups, k), more, compliance * more);
            if slipping.sense * gain < slipping.sense * slipping.left {
                shear.tractions[k] += more;
                (slipping.stick, slipping.left) = (k, slipping.left - gain);
                continue;
            }
            // where the weighted sum of level and depth is this much less than at the top
            let (Group { top, motions, .. }, [a, b]) =
                (self.groups[k], [wish.weights[0], wish.weights[1] * compliance]);
            let sum = a * top + b * motions.depth - slipping.left / more;
            let level = if b == 0.0 { sum / a } else { states.level_where(a / b, sum / b) };
            let (level, before) = (level.min(top).max(self.bottom(k).0), self.groups.len());
            self.cut_at(states, level);
            let (added, stick) = (self.groups.len() - before, self.groups_to(level));
            slipping.met = slipping.met.start + added..slipping.met.end + added;
            (slipping.stick, slipping.left) = (stick, 0.0);
            let Some(shear) = &mut self.shear else { return };
            (stick..k + 1 + added).for_each(|k| shear.tractions[k] = slipping.sense * self.groups[k].traction);
        }
    }

    /// Releases all groups in a jump of a body without elastic response.
    pub(super) fn release_shear(&mut self, along: Option<Demand>) {
        let (Some(shear), Some(along)) = (&mut self.shear, along) else { return };
        self.groups.iter_mut().for_each(|group| group.shear = 0.0);
        (shear.force, shear.stick) = (0.0, 0.0);
        if let Demand::Depth { depth, .. } = along {
            shear.slid = depth - shear.motion;
        }
    }
}
