//! The edge of a contact: the level up to which groups are held, and how levels follow it that it meets within a step.

use std::ops::Range;

use crate::states::curve::ElasticStates;
use crate::states::levels::{Demand, Levels, Wanted};

impl Levels {
    /// By how much Σ W Δl of the levels that the edge meets in a step is greater at its end, if nothing presses on
    /// them, because they move with the edge: it passes them one by one, and W of their mean is the part that it has
    /// passed. Continues what it passed in the steps before.
    pub(super) fn lead(&self) -> f64 {
        self.history.continued(self.passed).max(0.0)
    }

    /// Σ (1 − W) Δl of the levels between the edge at the start of the step and this one.
    pub(super) fn swept(&self, level: f64) -> f64 {
        let mut bottom = self.level;
        let displacements = self.history.displacements().iter().chain(std::iter::once(&0.0));
        let tops = self.groups.iter().map(|group| group.top.min(level)).chain(std::iter::once(level));
        let part = |(top, displacement): (f64, &f64)| {
            let width = (top - bottom).max(0.0);
            bottom = bottom.max(top);
            (1.0 - displacement) * width
        };
        tops.zip(displacements).map(part).sum()
    }

    /// Lets groups that the edge met in the step have moved with it before.
    pub(super) fn lead_groups(&mut self, groups: Range<usize>, lead: f64, swept: f64) {
        for k in groups {
            let part = (1.0 - self.history.displacements()[k]) / swept;
            self.history.lead(k, part, self.passed);
            self.trial[k] += part * lead;
        }
    }

    /// The level that meets a demand, if levels that are met have this lead.
    pub(super) fn level_of(&self, states: &ElasticStates, demand: Demand, lead: f64) -> Wanted {
        let compliance = self.history.rule().compliance();
        match demand {
            Demand::Force(force) => {
                Wanted { level: self.level_of_force(force * compliance + lead), give: f64::INFINITY, sum: 0.0, lead }
            }
            Demand::Depth { depth, give } => {
                let give = give / compliance;
                let [level, sum] = self.level_of_depth(states, give, depth + give * lead);
                Wanted { level, give, sum, lead }
            }
        }
    }

    /// The level c up to which groups are held where Σ (1 − W) Δl below c is `needed`, F c_Δ under a force F.
    fn level_of_force(&self, needed: f64) -> f64 {
        let mut carried = 0.0;
        for (bottom, _, group, free) in self.spans() {
            let more = (1.0 - free) * (group.top - bottom);
            if carried + more >= needed {
                return if needed > carried { bottom + (needed - carried) / (1.0 - free) } else { bottom };
            }
            carried += more;
        }
        self.bottom(self.groups.len()).0 + (needed - carried)
    }

    /// The level c up to which groups are held where D(c) + `give` Σ (1 − W) Δl = `depth`, with D(c) = δ(c) + Σ W Δδ
    /// above c; NaN beyond the sweep. And the sum that it is found by.
    fn level_of_depth(&self, states: &ElasticStates, give: f64, depth: f64) -> [f64; 2] {
        let mut reached: f64 =
            self.spans().map(|(_, lower, group, free)| free.min(1.0) * (group.motions.depth - lower.depth)).sum();
        if depth <= reached {
            return [0.0, 0.0];
        }
        for (bottom, lower, group, free) in self.spans() {
            let rise = (1.0 - free).max(0.0) * (group.motions.depth - lower.depth);
            let more = rise + (1.0 - free) * give * (group.top - bottom);
            if reached + more >= depth {
                let sum = lower.depth + give * bottom + (depth - reached) / (1.0 - free);
                return [states.level_where(give, sum).clamp(bottom, group.top), sum];
            }
            reached += more;
        }
        let (top, motions) = self.bottom(self.groups.len());
        let sum = motions.depth + give * top + (depth - reached);
        [states.level_where(give, sum), sum]
    }
}
