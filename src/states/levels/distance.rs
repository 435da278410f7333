//! How far apart two outcomes of one step are, and what an error is measured against.

use crate::states::curve::ElasticStates;
use crate::states::levels::{Demand, Group, Levels, ROUNDING};

/// Strains of levels that were swept count as far as they last for so many halves of the step.
const LASTING: i32 = 8;

impl Levels {
    /// Depth and force of an undisturbed contact under the maximum load of a run, of the kind of
    /// the demand: under a force the depth as soon as it acts or, without elastic response, under
    /// half of it when it has pressed for its spell; under an approach or a spring the force at the
    /// end of the run, or that of the steepest load where a body without elastic response is
    /// approached, which rises from nothing in a time of its own. Times, of the run, the spell and
    /// the rise, are in steps like the last one.
    pub(in crate::states) fn expected(
        &self,
        states: &ElasticStates,
        demand: Demand,
        [most, steepest]: [f64; 2],
        [run, spell, rise]: [f64; 3],
    ) -> [f64; 2] {
        let rule = self.history.rule();
        match demand {
            Demand::Force(_) => {
                let soon = if rule.has_dashpot() { 0.5 / self.history.stiffness_over(spell) } else { 0.0 };
                [states.depth(most * soon.max(rule.compliance())), most]
            }
            Demand::Depth { give, .. } => {
                let pressed = |load: f64, time: f64| {
                    let stiffness = self.history.stiffness_over(time);
                    let level = states.level_where(give * stiffness, load);
                    [states.depth(level), stiffness * level]
                };
                let [depth, force] = pressed(most, run);
                let at_rise = if rule.has_dashpot() && give == 0.0 { pressed(steepest, rise)[1] } else { 0.0 };
                [depth, force.max(at_rise)]
            }
        }
    }

    /// How much of a change of the depth is left after so many steps like the last one, about: all of it where a
    /// fluid is under a force or apart; the elastic response that is left and a spring bring it back.
    pub(in crate::states) fn lasting(&self, states: &ElasticStates, demand: Demand, steps: f64) -> f64 {
        let (mean, left) = (self.history.stiffness_over(steps), self.history.rule().equilibrium());
        match demand {
            Demand::Depth { give, .. } if self.level > 0.0 => {
                let [mean, left] = [mean, left].map(|modulus| states.stiffness(self.level) * modulus);
                give * (mean - left) / (1.0 + give * mean)
            }
            _ => 1.0 - left / mean,
        }
    }

    /// The most that a step may be longer than the one before, both taken whole and in halves, so that the rule has
    /// the same order in both: the whole follows half of the step before.
    pub(in crate::states) fn longest_growth(&self) -> f64 {
        0.499 * self.history.rule().longest_continued()
    }

    /// How far apart two outcomes of one step are, the other one taken in parts: the greatest |∫ δX dδ| from above,
    /// and the greatest |∫ δX dl| from below over the compliance, for X = W and X the strains as far as they can
    /// raise a free surface. This is the most that the difference can ever add to a depth and to a force. The `cuts`
    /// belong to the other outcome. Levels that were `swept` count so much.
    pub(in crate::states) fn distance(
        &mut self,
        states: &ElasticStates,
        other: &Levels,
        start: f64,
        cuts: [f64; 2],
        steps: f64,
        swept: f64,
    ) -> [f64; 2] {
        cuts.into_iter().for_each(|level| self.cut_at(states, level));
        let all = [start, self.level, cuts[0], cuts[1]];
        let [from, to] = [all.into_iter().fold(start, f64::min), all.into_iter().fold(start, f64::max)];
        let mut worst = [0.0f64; 2];
        for ((_, own), ([weight, decay], others)) in self.history.strains().zip(other.history.strains()) {
            let swept = swept * decay.powi(LASTING);
            let (mut k, mut sums) = (0, [0.0f64; 2]);
            // least and greatest sum over the depth below a level, of levels that were swept and of others
            let mut range = [[0.0f64; 2]; 2];
            for (group, Group { top, motions, .. }) in self.groups.iter().enumerate() {
                let (bottom, lower) = self.bottom(group);
                while other.groups.get(k).is_some_and(|group| group.top < top * (1.0 - ROUNDING)) {
                    k += 1;
                }
                let difference = weight * (own(group) - if k < other.groups.len() { others(k) } else { 0.0 });
                sums[0] += difference * (motions.depth - lower.depth);
                sums[1] += difference * (top - bottom);
                let is_swept = from * (1.0 + ROUNDING) < *top && *top < to * (1.0 - ROUNDING);
                worst[1] = worst[1].max(if is_swept { swept } else { 1.0 } * sums[1].abs());
                let [least, most] = &mut range[usize::from(is_swept)];
                (*least, *most) = (least.min(sums[0]), most.max(sums[0]));
            }
            for ([least, most], weight) in range.into_iter().zip([1.0, swept]) {
                worst[0] = worst[0].max(weight * (sums[0] - least).max(most - sums[0]));
            }
        }
        [worst[0], worst[1] * other.history.stiffness_over(steps)]
    }
}
