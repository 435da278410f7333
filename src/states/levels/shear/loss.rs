//! What a step does along the surface: how far its groups move, and what they lose by slip.

use super::{Shear, Slipping, inner_work, widths};
use crate::hereditary::GroupHistory;
use crate::run::doubled::turned_back::turned_back;
use crate::run::passage::Span;
use crate::states::curve::ElasticStates;
use crate::states::levels::{Demand, Group, Levels, ROUNDING};

/// What levels lose that begin to slip while the edge moves, over what they would lose if it stood where it ends. A zone
/// that slips is `now` so wide, was `before`, and its inner end went so far in the step; each level that it passes loses
/// about the square of its width then.
fn travelled(now: f64, before: f64, far: f64) -> f64 {
    // what hardly slips at the end is rounding, and tells nothing of the zone before
    if far <= 0.0 || now <= 0.1 * (before + far) {
        return 1.0;
    }
    // over the zone at the end: squares of lengths may be beyond f64
    let (before, far) = (before / now, far / now);
    let rest = (1.0 - far).max(0.0);
    (1.0 + before + before * before) * far / ((1.0 + rest + rest * rest) * far.min(1.0))
}

/// What the bodies take up in a step whose displacements are linear in time: ∫∫ θ(l) ΔU(l′) κ(max(l, l′)) dl dl′ with θ
/// averaged over it. Their springs and dashpots have no more and no less of it.
fn taken(history: &mut GroupHistory, groups: &[Group], Shear { trial, mean, .. }: &mut Shear) -> f64 {
    history.mean_shear(trial, mean);
    let Some(before) = history.tangential_displacements() else { return 0.0 };
    let (mut below, mut sum) = ([0.0; 2], 0.0);
    for k in 0..groups.len() {
        let ([width, depth], stress, moved) = (widths(groups, k), mean[k], trial[k] - before[k]);
        sum += depth * (stress * below[1] + moved * below[0]) + 2.0 * stress * moved * inner_work(groups, k, width);
        below = [below[0] + stress * width, below[1] + moved * width];
    }
    sum
}

impl Levels {
    /// Moves the groups by their tractions, and takes in what the step has done.
    pub(super) fn commit_shear(&mut self, along: Demand, edge: f64, slipping: &Slipping) {
        let Slipping { stick, ref met, share, sense, left } = *slipping;
        let (compliance, level) = (self.history.rule().compliance(), self.level);
        let Levels { history, groups, shear: Some(shear), .. } = self else { return };
        let Some(now) = history.tangential_displacements() else { return };
        let (before, stuck) = (shear.force, shear.stick);
        let (mut force, mut motion, mut lost, mut begun, mut from) = (0.0, 0.0, 0.0, 0.0, edge);
        // of the levels above, ∫ θ dl and ∫ θ dδ: in the mean of the step, and while those below begin to slip
        let mut above = [[0.0; 2]; 2];
        for k in (0..groups.len()).rev() {
            let ([width, depth], traction) = (widths(groups, k), shear.tractions[k]);
            shear.trial[k] = if k < stick { now[k] } else { shear.trial[k] + compliance * traction };
            // what is met has moved before it touched, and what is released moves after it touched
            let slips = shear.whole || (stick..met.start).contains(&k);
            let slipped = shear.whole || groups[k].top > stuck && sense * groups[k].shear > 0.0;
            let mean = 0.5 * (groups[k].shear + traction);
            let acts = if slips { [if slipped { mean } else { traction }; 2] } else { [mean, traction] };
            // ∫ ΔU (κ(l′) − κ(l)) θ dl dl′ over l > l′ with κ = dδ/dl: what slips below a level slips there
            if slips {
                let inner = depth * width - 2.0 * inner_work(groups, k, width);
                let [of_level, of_depth] = above[usize::from(!slipped)];
                let change = shear.trial[k] - now[k];
                let sum = if slipped { &mut lost } else { &mut begun };
                *sum += change * (of_level * depth - of_depth * width + acts[0] * inner);
            }
            if slipped && !shear.whole {
                from = stuck;
            }
            for (above, acts) in above.iter_mut().zip(acts) {
                *above = [above[0] + acts * width, above[1] + acts * depth];
            }
            (force, motion) = (force + traction * width, motion + shear.trial[k] * depth);
            groups[k].shear = traction;
        }
        let (taken, displaced) = (taken(history, groups, shear), shear.displacement());
        if let Demand::Force(wanted) = along {
            force = wanted;
        } else {
            shear.slid += left;
        }
        (shear.force, shear.motion) = (force, motion);
        // a contact that stuck slides from where what it carries rises to f P, as at the end, or where f P falls to it
        let held = stuck > 0.0 && !shear.whole;
        let at_first = if held && sense * before < sense * force { force } else { before };
        let sliding = 0.5 * (at_first + force);
        lost += if let Demand::Force(_) = along { 0.0 } else { sliding * left };
        let bottom = stick.checked_sub(1).map_or(0.0, |k| groups[k].top);
        lost += begun * travelled(level - bottom, edge - from, from - bottom);
        // where all of it parts, the force falls to nothing with the pressure: what bodies give back beyond its work is
        // dissipated by slip, unless they are let go
        if met.end == 0 && before != 0.0 && !matches!(along, Demand::Force(_)) {
            lost = f64::max(0.0, 0.5 * before * (shear.displacement() - displaced) - taken);
        }
        (shear.lost, shear.work) = (shear.lost + lost, shear.work + taken + lost);
        let now = [shear.displacement(), force, shear.work];
        shear.maxima.iter_mut().zip(now).for_each(|(most, now)| *most = most.max(now.abs()));
        let stick = if share.abs() < 1.0 && stick == met.start { met.end } else { stick };
        shear.stick = stick.checked_sub(1).map_or(0.0, |k| groups[k].top);
    }

    /// How far apart two outcomes of one step are along the surface: the maximum |∫ δU dδ| over neighbouring
    /// levels, the most that their displacements can ever differ by; the displacements; the forces; what slip has
    /// dissipated; and the work. In the first, levels above those that stick in both, and those between the `edge`
    /// before the step and the edges after it, count as `slipping`; it is no less than the second.
    pub(in crate::states) fn shear_distance(&self, other: &Levels, edge: f64, slipping: f64) -> Option<[f64; 5]> {
        let (one, two) = (self.shear.as_ref()?, other.shear.as_ref()?);
        let (own, others) = (self.history.tangential_displacements()?, other.history.tangential_displacements()?);
        let stick = one.stick.min(two.stick);
        let [least, most] = [f64::min, f64::max].map(|of| [self.level, other.level].into_iter().fold(edge, of));
        let passed = least * (1.0 + ROUNDING)..=most * (1.0 + ROUNDING);
        // the sum below a level, its minimum and its maximum so far, of levels that stick and of the others
        let (mut sums, mut k, mut lower) = ([[0.0f64; 3]; 2], 0, 0.0);
        for (group, now) in other.groups.iter().zip(others) {
            loop {
                let inside = self.groups.get(k).filter(|own| own.top < group.top);
                let Group { top, motions, .. } = *inside.unwrap_or(group);
                let [sum, low, high] = &mut sums[usize::from(top > stick || passed.contains(&top))];
                *sum += (now - own.get(k).copied().unwrap_or(0.0)) * (motions.depth - lower);
                (*low, *high, lower) = (low.min(*sum), high.max(*sum), motions.depth);
                if inside.is_none() {
                    break;
                }
                k += 1;
            }
        }
        let [held, slips] = sums.map(|[_, low, high]| high - low);
        let numbers = |shear: &Shear| [shear.displacement(), shear.force, shear.lost, shear.work];
        let (ends, others) = (numbers(one), numbers(two));
        let [motion, force, lost, work] = std::array::from_fn(|k| (ends[k] - others[k]).abs());
        let far = held + slipping * slips + (one.slid - two.slid).abs();
        Some([far.max(motion), motion, force, lost, work])
    }

    /// By how much force a contact that slides in both halves of a step, `others` being the states before it and
    /// between, may be off as it stuck in the second one; what drives it is a function of time.
    pub(in crate::states) fn stuck_again(
        &self,
        states: &ElasticStates,
        others: [&Levels; 2],
        span: Span,
        along: impl Fn(f64) -> Option<Demand>,
    ) -> f64 {
        let slid = |levels: &Levels| levels.shear.as_ref().map_or(0.0, |shear| shear.slid);
        let ([before, middle], Some(Demand::Depth { give, .. })) = (others.map(slid), along(span.end)) else {
            return 0.0;
        };
        let drive = |time: f64| if let Some(Demand::Depth { depth, .. }) = along(time) { depth } else { f64::NAN };
        let back = turned_back([middle - before, slid(self) - middle], span, drive);
        let compliance = give + self.history.rule().compliance() / states.stiffness(self.level);
        if back > 0.0 { (back / compliance).min(2.0 * self.force) } else { 0.0 }
    }

    /// What slip and creep have dissipated.
    fn dissipated(&self) -> Option<[f64; 2]> {
        self.shear.as_ref().map(|shear| [shear.lost, shear.work - shear.lost - self.stored_along()])
    }

    /// Continues what a step in halves dissipates by so much of its difference to that of the whole: the errors of
    /// all steps have one sign, and nothing brings it back.
    pub(in crate::states) fn extrapolate_losses(&mut self, [before, whole]: [&Levels; 2], share: f64) {
        let [Some(before), Some(own), Some(whole)] = [before, &*self, whole].map(Levels::dissipated) else { return };
        let [slip, creep] = [0, 1].map(|k| f64::max(before[k] - own[k], share * (own[k] - whole[k])));
        if let Some(shear) = &mut self.shear {
            (shear.lost, shear.work) = (shear.lost + slip, shear.work + slip + creep);
        }
    }
}
