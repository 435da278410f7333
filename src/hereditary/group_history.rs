//! A list of displacements that grows, splits and merges, each with a past of its own.

use crate::hereditary::exponential_rule::{ExponentialRule, Interpolant};

/// Rounding of a displacement between 0 and 1.
const ROUNDING: f64 = 1e-12;

/// Displacements W of groups of elements that follow one [`ExponentialRule`]: 1 is the displacement of an element in contact, 0 that of
/// an undisturbed one.
///
/// Each group has a row: W, its differences d₁ and d₂, then q_i for each relaxation time.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct GroupHistory {
    rule: ExponentialRule,
    rows: Vec<f64>,
}

/// Numbers of a row before its q_i.
const HEAD: usize = 3;

impl GroupHistory {
    /// No groups, with room for some.
    pub(crate) fn new(rule: ExponentialRule, groups: usize) -> GroupHistory {
        let rows = Vec::with_capacity(groups * (HEAD + rule.branches()));
        GroupHistory { rule, rows }
    }

    fn stride(&self) -> usize {
        HEAD + self.rule.branches()
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
        self.rows.clone_from(&other.rows);
    }

    /// Writes the displacement of each group at the end of a step, if nothing presses on it, to `free`. A polynomial of lower degree is
    /// taken where a group would leave 0 ≤ W ≤ 1: an element that nothing presses on neither rises above the undisturbed surface nor
    /// sinks below the contact.
    pub(crate) fn predict(&mut self, dt: f64, interpolant: Interpolant, free: &mut Vec<f64>) {
        self.rule.compute_weights(dt, interpolant);
        self.free_displacements(free);
        while self.rule.has_less() && free.iter().any(|w| !(-ROUNDING..=1.0 + ROUNDING).contains(w)) {
            self.rule.reduce_order();
            self.free_displacements(free);
        }
    }

    fn free_displacements(&self, free: &mut Vec<f64>) {
        let tried = &self.rule.tried;
        free.clear();
        free.extend(self.rows.chunks_exact(self.stride()).map(|row| {
            let (head, branches) = row.split_at(HEAD);
            let stress: f64 = branches.iter().zip(&tried.branches).map(|(q, weights)| weights[0] * q).sum();
            tried.past.iter().zip(head).map(|(weight, value)| weight * value).sum::<f64>() - tried.c * stress
        }));
    }

    /// Accepts the step predicted last, which ends at the displacements `now`.
    pub(crate) fn commit(&mut self, now: &[f64]) {
        self.rule.commit();
        let committed = &self.rule.committed;
        let stride = self.stride();
        for (row, &now) in self.rows.chunks_exact_mut(stride).zip(now) {
            let change = now - row[0];
            let bend = change - committed.ratios[0] * row[1];
            let twist = bend - committed.ratios[1] * row[2];
            row[..HEAD].copy_from_slice(&[now, change, bend]);
            for (q, &[decay, one, two, three]) in row[HEAD..].iter_mut().zip(&committed.branches) {
                *q = decay * *q + one * change + two * bend + three * twist;
            }
        }
    }

    /// Whether it may be the history of so many groups by the rule of `other`; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &GroupHistory, groups: usize) -> bool {
        let is_finite = self.rows.iter().all(|value| value.is_finite());
        self.rule.fits(&other.rule) && self.rows.len() == groups * self.stride() && is_finite
    }

    /// The displacement of each group.
    pub(crate) fn displacements(&self) -> impl Iterator<Item = f64> + '_ {
        self.rows.chunks_exact(self.stride()).map(|row| row[0])
    }

    /// Adds an undisturbed group after the others.
    pub(crate) fn push(&mut self) {
        self.rows.resize(self.rows.len() + self.stride(), 0.0);
    }

    /// Splits a group into two with the same past.
    pub(crate) fn split(&mut self, group: usize) {
        let (stride, end) = (self.stride(), self.rows.len());
        let start = group * stride;
        self.rows.resize(end + stride, 0.0);
        self.rows.copy_within(start..end, start + stride);
    }

    /// Merges a group into the one before it, whose past is kept.
    pub(crate) fn merge(&mut self, group: usize) {
        let stride = self.stride();
        self.rows.drain(group * stride..(group + 1) * stride);
    }

    /// Whether a group and the one before it have the same past to rounding.
    pub(crate) fn is_like_the_one_before(&self, group: usize) -> bool {
        let stride = self.stride();
        let [before, row] = [group - 1, group].map(|group| &self.rows[group * stride..(group + 1) * stride]);
        let same = |scale: f64, a: f64, b: f64| (a - b).abs() <= 1e-14 * scale;
        before[..HEAD].iter().zip(&row[..HEAD]).all(|(&a, &b)| same(1.0, a, b))
            && before[HEAD..]
                .iter()
                .zip(&row[HEAD..])
                .zip(self.rule.moduli())
                .all(|((&a, &b), modulus)| same(modulus, a, b))
    }
}
