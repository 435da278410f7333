//! A list of displacements that grows, splits and merges, each with a past of its own.

use pulp::{Arch, Simd, WithSimd};

use crate::hereditary::exponential_rule::{ExponentialRule, Interpolant, StepWeights};

/// Rounding of a displacement between 0 and 1.
const ROUNDING: f64 = 1e-12;

/// Displacements W of groups of elements that follow one [`ExponentialRule`]: 1 is the displacement of an element in
/// contact, 0 that of an undisturbed one. Where there is friction, the groups move along the surface too, by U.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct GroupHistory {
    rule: ExponentialRule,
    normal: Past,
    tangential: Option<Past>,
}

clone_by_fields! { GroupHistory { rule, normal, tangential } }

/// What one displacement of the groups was.
#[derive(Debug)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
struct Past {
    /// The displacement of each group, its differences d₁ and d₂, then q_i of each relaxation time.
    columns: Vec<Vec<f64>>,
    /// The third difference over the step being committed.
    twists: Vec<f64>,
}

clone_by_fields! { Past { columns, twists } }

/// Number of columns before the q_i.
const HEAD: usize = 3;

impl Past {
    fn new(rule: &ExponentialRule, groups: usize) -> Past {
        let columns = (0..HEAD + rule.branches()).map(|_| Vec::with_capacity(groups)).collect();
        Past { columns, twists: Vec::with_capacity(groups) }
    }

    /// Writes the displacements at the end of the step that the rule weighed last, if no stress acts any more.
    fn free_displacements(&self, rule: &ExponentialRule, free: &mut Vec<f64>) {
        let StepWeights { c, past: [kept, of_change, of_bend], branches, .. } = &rule.tried;
        let [displacements, changes, bends, stresses @ ..] = &self.columns[..] else { return };
        free.clone_from(displacements);
        combine(free, *kept, [*of_change, *of_bend, 0.0], [changes, bends, bends]);
        for (columns, weights) in stresses.chunks(3).zip(branches.chunks(3)) {
            let weight = |k: usize| weights.get(k).map_or(0.0, |[decay, ..]| -c * decay);
            let column = |k: usize| &columns[k.min(columns.len() - 1)][..];
            combine(free, 1.0, [weight(0), weight(1), weight(2)], [column(0), column(1), column(2)]);
        }
    }

    /// Writes the stress averaged over the step that the rule weighed last, E∞ (U + ½ ΔU) + Σ (φ₁ q_i + φ₂ E_i ΔU)
    /// + η ΔU/Δ, if U is linear on it and ends at `now`: q_i relaxes from its start as e^(−s/τ_i).
    fn mean_stress(&self, rule: &mut ExponentialRule, now: &[f64], mean: &mut Vec<f64>) {
        let [displacements, _, _, stresses @ ..] = &self.columns[..] else { return };
        let mut of_change = 0.5 * rule.equilibrium();
        // nothing moves in a jump of a body that has a dashpot alone
        of_change += if rule.tried.dt > 0.0 { rule.viscous() } else { 0.0 };
        mean.clear();
        mean.resize(now.len(), 0.0);
        for (first, columns) in (0..).step_by(3).zip(stresses.chunks(3)) {
            let mut weights = [0.0; 3];
            for (branch, weight) in weights.iter_mut().take(columns.len()).enumerate() {
                let [of_stress, of_moved] = rule.mean_of(first + branch);
                (*weight, of_change) = (of_stress, of_change + of_moved);
            }
            let column = |k: usize| &columns[k.min(columns.len() - 1)][..];
            combine(mean, 1.0, weights, [column(0), column(1), column(2)]);
        }
        combine(mean, 1.0, [rule.equilibrium() - of_change, of_change, 0.0], [displacements, now, now]);
    }

    /// Takes in the step that the rule has committed, which ends at the displacements `now`.
    fn commit(&mut self, rule: &ExponentialRule, now: &[f64]) {
        let Past { columns, twists } = self;
        let [displacements, changes, bends, stresses @ ..] = &mut columns[..] else { return };
        let [of_change, of_bend] = rule.committed.ratios;
        twists.resize(now.len(), 0.0);
        let differences = changes.iter_mut().zip(bends.iter_mut()).zip(twists.iter_mut());
        for ((&now, displacement), ((change, bend), twist)) in now.iter().zip(displacements).zip(differences) {
            let moved = now - *displacement;
            let bent = moved - of_change * *change;
            *twist = bent - of_bend * *bend;
            (*displacement, *change, *bend) = (now, moved, bent);
        }
        for (column, &[decay, one, two, three]) in stresses.iter_mut().zip(&rule.committed.branches) {
            combine(column, decay, [one, two, three], [changes, bends, twists]);
            rule.forget_relaxed(column);
        }
    }

    #[cfg(feature = "checkpoint")]
    fn fits(&self, branches: usize, groups: usize) -> bool {
        let is_whole = |column: &Vec<f64>| column.len() == groups && column.iter().all(|value| value.is_finite());
        self.columns.len() == HEAD + branches && self.columns.iter().all(is_whole)
    }

    /// [`GroupHistory::differ_at_most`].
    fn differs_at_most(&self, rule: &ExponentialRule, [a, b]: [usize; 2], most: f64) -> bool {
        let [displacements, changes, _, stresses @ ..] = &self.columns[..] else { return true };
        let difference = displacements[a] - displacements[b];
        let (mut greatest, mut raised) = (0.0f64, 0.0);
        let mut strains = stresses.iter().rev().zip(rule.influences());
        difference.abs() <= most
            && (changes[a] - changes[b]).abs() <= most
            && strains.all(|(column, (modulus, influence))| {
                let strain = (difference - (column[a] - column[b]) / modulus).abs();
                greatest = greatest.max(strain);
                raised += influence * strain;
                greatest.min(raised) <= most
            })
    }
}

impl GroupHistory {
    /// No groups, with room for some.
    pub(crate) fn new(rule: ExponentialRule, groups: usize) -> GroupHistory {
        GroupHistory { normal: Past::new(&rule, groups), tangential: None, rule }
    }

    /// Lets the groups move along the surface too.
    pub(crate) fn add_tangential(&mut self, groups: usize) {
        let mut past = Past::new(&self.rule, groups);
        past.columns.iter_mut().for_each(|column| column.resize(self.normal.columns[0].len(), 0.0));
        self.tangential = Some(past);
    }

    fn pasts(&mut self) -> impl Iterator<Item = &mut Past> {
        std::iter::once(&mut self.normal).chain(&mut self.tangential)
    }

    /// Every column.
    fn columns(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        self.pasts().flat_map(|past| &mut past.columns)
    }

    /// The rule; its compliance belongs to the step predicted last.
    pub(crate) fn rule(&self) -> &ExponentialRule {
        &self.rule
    }

    /// The past does not determine how the displacements continue, as after a corner of the load.
    pub(crate) fn reset_differences(&mut self) {
        self.rule.reset_differences();
    }

    /// The mean response of a displacement that grows for the time of so many steps, each as long as the one
    /// predicted last.
    pub(crate) fn stiffness_over(&self, steps: f64) -> f64 {
        self.rule.equilibrium() + (self.rule.relaxing(steps) + self.rule.viscous()) / steps
    }

    /// Writes the displacement of each group at the end of a step, if nothing presses on it, to `free`. A polynomial
    /// of lower degree is taken where a group would leave 0 ≤ W ≤ 1: an element that nothing presses on neither rises
    /// above the undisturbed surface nor sinks below the contact. A body without elastic response resists the rate
    /// alone, whose quadratic overshoots 1 in the groups that the last step met: this is as it must be, and W of
    /// groups that stay free is 1. Returns whether all are there.
    pub(crate) fn predict(&mut self, dt: f64, interpolant: Interpolant, free: &mut Vec<f64>) -> bool {
        self.rule.compute_weights(dt, interpolant);
        let most = if self.rule.has_dashpot() { f64::MAX } else { 1.0 + ROUNDING };
        loop {
            self.normal.free_displacements(&self.rule, free);
            let is_between = free.iter().all(|w| (-ROUNDING..=most).contains(w));
            if is_between || !self.rule.has_less() {
                return is_between;
            }
            self.rule.reduce_order();
        }
    }

    /// U of each group at the end of the step predicted last, if nothing shears it any more.
    pub(crate) fn predict_shear(&self, free: &mut Vec<f64>) {
        self.tangential.iter().for_each(|past| past.free_displacements(&self.rule, free));
    }

    /// The stress of each group, averaged over the step predicted last, whose linear displacements end at `now`.
    #[cfg(feature = "friction")]
    pub(crate) fn mean_stress(&mut self, now: &[f64], mean: &mut Vec<f64>) {
        self.normal.mean_stress(&mut self.rule, now, mean);
    }

    /// The same along the surface.
    #[cfg(feature = "states")]
    pub(crate) fn mean_shear(&mut self, now: &[f64], mean: &mut Vec<f64>) {
        self.tangential.iter().for_each(|past| past.mean_stress(&mut self.rule, now, mean));
    }

    /// Accepts the step predicted last, which ends at the displacements `now`, and along the surface at `sheared`.
    pub(crate) fn commit(&mut self, now: &[f64], sheared: &[f64]) {
        self.rule.commit();
        self.normal.commit(&self.rule, now);
        if let Some(past) = &mut self.tangential {
            past.commit(&self.rule, sheared);
        }
        // a group that was met is at rest from now on
        if self.leads() {
            let [_, changes, bends, ..] = &mut self.normal.columns[..] else { return };
            let held = now.iter().enumerate().filter(|(_, now)| **now == 1.0);
            held.for_each(|(k, _)| (changes[k], bends[k]) = (0.0, 0.0));
        }
    }

    /// Whether groups that are met in a step follow the edge that meets them, as in quadratic steps. On a body
    /// without elastic response the groups of the last step share the response to the slope at the end, so that none
    /// has to follow.
    pub(crate) fn leads(&self) -> bool {
        self.rule.kept() > 1 && !self.rule.has_dashpot()
    }

    /// W at the end of the step predicted last, if nothing presses on it, of what stood at 0 and moved by these
    /// differences before.
    pub(crate) fn continued(&self, differences: [f64; 2]) -> f64 {
        let [_, of_change, of_bend] = self.rule.tried.past;
        if self.leads() { of_change * differences[0] + of_bend * differences[1] } else { 0.0 }
    }

    /// Lets a group have moved by such a part of these differences besides its own.
    pub(crate) fn lead(&mut self, group: usize, part: f64, differences: [f64; 2]) {
        let columns = self.normal.columns[1..HEAD].iter_mut().zip(differences);
        columns.for_each(|(column, difference)| column[group] += part * difference);
    }

    /// The differences after the step accepted last of what moved by `differences` before, and by `change` in it.
    pub(crate) fn differences_after(&self, differences: [f64; 2], change: f64) -> [f64; 2] {
        [change, change - self.rule.committed.ratios[0] * differences[0]]
    }

    /// Weighs the step predicted last with less degree, if it has any.
    pub(crate) fn reduce_order(&mut self, free: &mut Vec<f64>) -> bool {
        let has_less = self.rule.has_less();
        if has_less {
            self.rule.reduce_order();
            self.normal.free_displacements(&self.rule, free);
        }
        has_less
    }

    /// Whether it may be the history of so many groups by the rule of `other`; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(crate) fn fits(&self, other: &GroupHistory, groups: usize) -> bool {
        let mut pasts = std::iter::once(&self.normal).chain(&self.tangential);
        self.rule.fits(&other.rule)
            && self.tangential.is_some() == other.tangential.is_some()
            && pasts.all(|past| past.fits(self.rule.branches(), groups))
    }

    /// The displacement of each group.
    pub(crate) fn displacements(&self) -> &[f64] {
        &self.normal.columns[0]
    }

    /// The displacement of each group along the surface, if there is friction.
    pub(crate) fn tangential_displacements(&self) -> Option<&[f64]> {
        self.tangential.as_ref().map(|past| &past.columns[0][..])
    }

    /// The modulus of each relaxation time, the longest first, and the stress of each group.
    pub(crate) fn stresses(&self) -> impl Iterator<Item = (f64, &[f64])> {
        self.stresses_of(Some(&self.normal))
    }

    /// The same along the surface.
    pub(crate) fn shear_stresses(&self) -> impl Iterator<Item = (f64, &[f64])> {
        self.stresses_of(self.tangential.as_ref())
    }

    fn stresses_of<'a>(&'a self, past: Option<&'a Past>) -> impl Iterator<Item = (f64, &'a [f64])> {
        let stresses = past.into_iter().flat_map(|past| past.columns[HEAD..].iter().rev());
        self.rule.influences().map(|(modulus, _)| modulus).zip(stresses.map(Vec::as_slice))
    }

    /// As many groups as `count`, each of which has the past of an old one or none.
    pub(crate) fn rearrange(&mut self, count: usize, old: impl Fn(usize) -> Option<usize>) {
        self.columns().for_each(|column| {
            *column = (0..count).map(|k| old(k).map_or(0.0, |k| column[k])).collect();
        });
    }

    /// Adds an undisturbed group after the others.
    pub(crate) fn push(&mut self) {
        self.columns().for_each(|column| column.push(0.0));
    }

    /// Splits a group into two with the same past.
    pub(crate) fn split(&mut self, group: usize) {
        self.columns().for_each(|column| column.insert(group, column[group]));
    }

    /// W of each group and its strains W − q_i/E_i, the strain of the dashpot of each relaxation time: with the most
    /// that they can ever raise a free surface, and what the last step left of older ones.
    pub(crate) fn strains(&self) -> impl Iterator<Item = ([f64; 2], impl Fn(usize) -> f64 + '_)> + '_ {
        let displacements = &self.normal.columns[0];
        let decays = self.rule.committed.branches.iter().rev().map(|weights| weights[0]);
        let branches = self.normal.columns[HEAD..].iter().rev().zip(self.rule.influences()).zip(decays);
        let all = branches.map(|((column, (modulus, influence)), decay)| ([influence, decay], Some((column, modulus))));
        std::iter::once(([1.0; 2], None)).chain(all).map(move |(weights, branch)| {
            let strain = move |group: usize| {
                displacements[group] - branch.map_or(0.0, |(column, modulus): (&Vec<f64>, f64)| column[group] / modulus)
            };
            (weights, strain)
        })
    }

    /// Whether W of two groups, its first difference and what their strains can ever add to W differ by `most` at
    /// most. Strains of groups that are held together, or free together, approach each other ever after, and W of a
    /// free group is a mean of them: so their maximum difference is never passed, nor is the sum of what each of
    /// them alone can raise ([`ExponentialRule::influences`]).
    pub(crate) fn differ_at_most(&self, a: usize, b: usize, most: f64) -> bool {
        let mut pasts = std::iter::once(&self.normal).chain(&self.tangential);
        pasts.all(|past| past.differs_at_most(&self.rule, [a, b], most))
    }

    /// Mixes a share of the past of group `b` into the past of group `a`.
    pub(crate) fn mix(&mut self, a: usize, b: usize, share: f64) {
        self.columns().for_each(|column| column[a] += share * (column[b] - column[a]));
    }

    /// Puts the past of one group in the place of another.
    pub(crate) fn copy_within(&mut self, from: usize, to: usize) {
        self.columns().for_each(|column| column[to] = column[from]);
    }

    /// Removes the pasts of all groups after the first few.
    pub(crate) fn truncate(&mut self, groups: usize) {
        self.columns().for_each(|column| column.truncate(groups));
    }
}

impl ExponentialRule {
    /// E_i of each relaxation time, the longest first, and the most by which its strain alone, 1, can ever raise a
    /// free surface, about: E_i over the sum of E∞ and the moduli of times at least as long.
    fn influences(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.relaxation.terms().iter().rev().scan(self.equilibrium(), |longer, &(modulus, _)| {
            *longer += modulus;
            Some((modulus, modulus / *longer))
        })
    }

    /// The parts of q_i averaged over the step predicted last that its start has, and a change of u that is linear on
    /// the step: φ₁ and E_i φ₂.
    fn mean_of(&mut self, branch: usize) -> [f64; 2] {
        let (modulus, tau) = self.relaxation.terms()[branch];
        let [first, second, ..] = self.relaxed.of(branch, self.tried.dt / tau).phi;
        [first, modulus * second]
    }
}

/// Sets `target` to `kept` target + Σ weight column, summed in this order: bitwise as one element after the other.
/// Written in vectors, since builds that are optimised a little only find none.
fn combine(target: &mut [f64], kept: f64, weights: [f64; 3], columns: [&[f64]; 3]) {
    Arch::new().dispatch(Combination { target, kept, weights, columns });
}

struct Combination<'a> {
    target: &'a mut [f64],
    kept: f64,
    weights: [f64; 3],
    columns: [&'a [f64]; 3],
}

impl WithSimd for Combination<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Combination { target, kept, weights: [a, b, c], columns: [first, second, third] } = self;
        let (vectors, rest) = S::as_mut_simd_f64s(target);
        let (firsts, first) = S::as_simd_f64s(first);
        let (seconds, second) = S::as_simd_f64s(second);
        let (thirds, third) = S::as_simd_f64s(third);
        let [all, of_first, of_second, of_third] =
            [simd.splat_f64s(kept), simd.splat_f64s(a), simd.splat_f64s(b), simd.splat_f64s(c)];
        for (((sum, x), y), z) in vectors.iter_mut().zip(firsts).zip(seconds).zip(thirds) {
            *sum = simd.add_f64s(simd.mul_f64s(all, *sum), simd.mul_f64s(of_first, *x));
            *sum = simd.add_f64s(*sum, simd.mul_f64s(of_second, *y));
            *sum = simd.add_f64s(*sum, simd.mul_f64s(of_third, *z));
        }
        for (((sum, x), y), z) in rest.iter_mut().zip(first).zip(second).zip(third) {
            *sum = kept * *sum + a * x + b * y + c * z;
        }
    }
}
