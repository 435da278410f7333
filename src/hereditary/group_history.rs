//! A list of displacements that grows, splits and merges, each with a past of its own.

use crate::hereditary::exponential_rule::{ExponentialRule, Interpolant, Weights};
use crate::parallel::combine;

/// Rounding of a displacement between 0 and 1.
const ROUNDING: f64 = 1e-12;
/// Pasts that differ by less are one.
const ALIKE: f64 = 1e-14;

/// Displacements W of groups of elements that follow one [`ExponentialRule`]: 1 is the displacement of an element in contact, 0 that of
/// an undisturbed one.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct GroupHistory {
    rule: ExponentialRule,
    /// W of each group, its differences d₁ and d₂, then q_i of each relaxation time.
    columns: Vec<Vec<f64>>,
    /// The third difference over the step being committed.
    twists: Vec<f64>,
}

/// Number of columns before the q_i.
const HEAD: usize = 3;

impl GroupHistory {
    /// No groups, with room for some.
    pub(crate) fn new(rule: ExponentialRule, groups: usize) -> GroupHistory {
        let columns = (0..HEAD + rule.branches()).map(|_| Vec::with_capacity(groups)).collect();
        GroupHistory { rule, columns, twists: Vec::with_capacity(groups) }
    }

    /// The rule; its compliance is that of the step predicted last.
    pub(crate) fn rule(&self) -> &ExponentialRule {
        &self.rule
    }

    /// The past does not determine how the displacements continue, as after a corner of the load.
    pub(crate) fn reset_differences(&mut self) {
        self.rule.reset_differences();
    }

    /// Copies another without reallocating where there is room.
    pub(crate) fn copy_from(&mut self, other: &GroupHistory) {
        self.rule.clone_from(&other.rule);
        self.columns.clone_from(&other.columns);
    }

    /// Writes the displacement of each group at the end of a step, if nothing presses on it, to `free`. A polynomial of lower degree is
    /// taken where a group would leave 0 ≤ W ≤ 1: an element that nothing presses on neither rises above the undisturbed surface nor
    /// sinks below the contact. Returns whether all are there.
    pub(crate) fn predict(&mut self, dt: f64, interpolant: Interpolant, free: &mut Vec<f64>) -> bool {
        self.rule.compute_weights(dt, interpolant);
        loop {
            self.free_displacements(free);
            let is_between = free.iter().all(|w| (-ROUNDING..=1.0 + ROUNDING).contains(w));
            if is_between || !self.rule.has_less() {
                return is_between;
            }
            self.rule.reduce_order();
        }
    }

    fn free_displacements(&self, free: &mut Vec<f64>) {
        let Weights { c, past: [kept, of_change, of_bend], branches, .. } = &self.rule.tried;
        let [displacements, changes, bends, stresses @ ..] = &self.columns[..] else { return };
        free.clone_from(displacements);
        combine(free, *kept, [*of_change, *of_bend, 0.0], [changes, bends, bends]);
        for (columns, weights) in stresses.chunks(3).zip(branches.chunks(3)) {
            let weight = |k: usize| weights.get(k).map_or(0.0, |[decay, ..]| -c * decay);
            let column = |k: usize| &columns[k.min(columns.len() - 1)][..];
            combine(free, 1.0, [weight(0), weight(1), weight(2)], [column(0), column(1), column(2)]);
        }
    }

    /// Accepts the step predicted last, which ends at the displacements `now`.
    pub(crate) fn commit(&mut self, now: &[f64]) {
        self.rule.commit();
        let GroupHistory { rule, columns, twists } = self;
        let [displacements, changes, bends, stresses @ ..] = &mut columns[..] else { return };
        let [of_change, of_bend] = rule.committed.ratios;
        twists.resize(now.len(), 0.0);
        for (k, &now) in now.iter().enumerate() {
            let change = now - displacements[k];
            let bend = change - of_change * changes[k];
            twists[k] = bend - of_bend * bends[k];
            (displacements[k], changes[k], bends[k]) = (now, change, bend);
        }
        for (column, &[decay, one, two, three]) in stresses.iter_mut().zip(&rule.committed.branches) {
            combine(column, decay, [one, two, three], [changes, bends, twists]);
        }
    }

    /// Whether it may be the history of so many groups by the rule of `other`; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &GroupHistory, groups: usize) -> bool {
        let is_whole = |column: &Vec<f64>| column.len() == groups && column.iter().all(|value| value.is_finite());
        self.rule.fits(&other.rule) && self.columns.len() == other.columns.len() && self.columns.iter().all(is_whole)
    }

    /// The displacement of each group.
    pub(crate) fn displacements(&self) -> &[f64] {
        &self.columns[0]
    }

    /// Adds an undisturbed group after the others.
    pub(crate) fn push(&mut self) {
        self.columns.iter_mut().for_each(|column| column.push(0.0));
    }

    /// Splits a group into two with the same past.
    pub(crate) fn split(&mut self, group: usize) {
        self.columns.iter_mut().for_each(|column| column.insert(group, column[group]));
    }

    /// Removes the past of a group.
    pub(crate) fn remove(&mut self, group: usize) {
        self.columns.iter_mut().for_each(|column| _ = column.remove(group));
    }

    /// Whether a group and the one before it have the same past to rounding, where their difference counts with a `share` only.
    pub(crate) fn is_like_the_one_before(&self, group: usize, share: f64) -> bool {
        let scales = [1.0; HEAD].into_iter().chain(self.rule.moduli());
        let mut columns = self.columns.iter().zip(scales);
        columns.all(|(column, scale)| (column[group] - column[group - 1]).abs() * share <= ALIKE * scale)
    }
}
