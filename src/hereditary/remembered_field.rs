//! A field that follows the recursion of the displacement, with the memory of its past.

use crate::hereditary::exponential_rule::{ExponentialRule, StepWeights};
use crate::hereditary::field::{BLOCK, Field, Role, change};
use crate::parallel::{BAND_CELLS, Rows, for_each_band};
use crate::sum::greatest;

/// What lies below zero by less than this part of the maximum value is rounding.
const DIP: f64 = -1e-9;
/// So small a part of the side of a cell is what a convolution leaves of nothing.
const NOISE: f64 = -1e-14;

/// A field and the memory of its past. The bodies being linear, whatever the displacement is a convolution of follows
/// the recursion of the displacement itself.
///
/// What the step committed last adds to the past waits until the next one is predicted, so that every q_i passes
/// through the processor once per step: with many relaxation times this is the cost of a step besides its contact
/// problem.
#[derive(Debug, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RememberedField {
    /// Number of relaxation times.
    branches: usize,
    /// A field q_i for each relaxation time, interleaved as a [`Field`]: one stream through memory.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    relaxing: Vec<f64>,
    /// How many differences are kept.
    kept: usize,
    /// d₁ and d₂ at the end of the step before the last, or of the last once that is taken in; empty where not kept.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    differences: [Vec<f64>; 2],
    /// Whether the past has yet to take in the last step.
    waiting: bool,
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) now: Vec<f64>,
    /// At the end of the step being tried; between steps the field before the last one.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) trial: Vec<f64>,
}

clone_by_fields! { RememberedField { branches, relaxing, kept, differences, waiting, now, trial } }

const _: () = assert!(BAND_CELLS.is_multiple_of(BLOCK));

/// d₁, d₂ and d₃ of the step committed last, on the cells of a block.
type Steps = [[f64; BLOCK]; 3];

impl RememberedField {
    /// The undisturbed field of bodies with so many relaxation times.
    pub(super) fn new(branches: usize, cells: usize) -> RememberedField {
        let [now, trial, relaxing] = [1, 1, branches].map(|per_cell| vec![0.0; cells * per_cell]);
        RememberedField { branches, relaxing, now, trial, ..RememberedField::default() }
    }

    /// The undisturbed field of a rule, on no cells yet. It keeps the differences that steps of given length need, so
    /// that none of these steps allocates.
    pub(super) fn on_no_cells(rule: &ExponentialRule, branches: usize) -> RememberedField {
        RememberedField { kept: rule.least_kept(), ..RememberedField::new(branches, 0) }
    }

    /// Makes room for so many differences.
    fn keep(&mut self, kept: usize) {
        self.kept = self.kept.max(kept);
        self.differences.iter_mut().take(kept).for_each(|own| own.resize(self.now.len(), 0.0));
    }

    /// A copy; `map` gives its values, of which the values of `far` are the sources.
    pub(super) fn map(
        &self,
        far: Option<&RememberedField>,
        map: &mut impl FnMut(Field<'_>) -> Vec<f64>,
    ) -> RememberedField {
        let RememberedField { branches, kept, waiting, ref relaxing, ref differences, ref now, ref trial } = *self;
        let mut lasting = |values: &[f64], per_cell: usize, source: Option<&Vec<f64>>| {
            map(Field { values, per_cell, role: Role::Lasting { source: source.map(|source| &source[..]) } })
        };
        RememberedField {
            branches,
            relaxing: lasting(relaxing, branches, far.map(|far| &far.relaxing)),
            kept,
            differences: [0, 1]
                .map(|k| lasting(&differences[k], usize::from(k < kept), far.map(|far| &far.differences[k]))),
            waiting,
            now: lasting(now, 1, far.map(|far| &far.now)),
            trial: map(Field::single(trial, Role::OfStep)),
        }
    }

    /// Changes each of its values at the start of the step being tried; `scratch` has room for one value of each cell.
    pub(super) fn change_start(&mut self, scratch: &mut [f64], mut job: impl FnMut(&mut [f64])) {
        job(&mut self.now);
        (0..self.branches).for_each(|i| change(&mut self.relaxing, [self.branches, i], scratch, &mut job));
        self.differences.iter_mut().take(self.kept).for_each(|own| job(own));
    }

    /// Whether it has as many branches as another, and keeps as many differences as a rule, unless it has yet to take
    /// in a step.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self, other: &RememberedField, kept: usize) -> bool {
        self.branches == other.branches && self.kept <= 2 && (self.kept >= kept || self.waiting)
    }

    /// The field at the end of the step being tried.
    #[cfg(test)]
    pub(super) fn trial(&self) -> &[f64] {
        &self.trial
    }

    /// d₁ and d₂ at the end of the last step once that is taken in; empty where the rule keeps none.
    pub(super) fn differences(&self) -> [&[f64]; 2] {
        self.differences.each_ref().map(|own| &own[..])
    }

    /// Writes u_old of the step whose weights were computed last to the trial. After a commit the trial must still be
    /// the field before that step.
    pub(super) fn predict(&mut self, rule: &ExponentialRule) {
        self.advance(rule, Some(&rule.tried));
    }

    /// Lets the past take in the last step, so that nothing depends on the field before it any more.
    pub(super) fn apply_pending_step(&mut self, rule: &ExponentialRule) {
        if self.waiting {
            self.advance(rule, None);
        }
    }

    /// Takes in the step committed last, if it waits, and predicts the step of weights `tried`, if any: then the
    /// trial is u_old.
    fn advance(&mut self, rule: &ExponentialRule, tried: Option<&StepWeights>) {
        self.keep(rule.kept());
        let RememberedField { branches, relaxing, differences, waiting, now, trial, .. } = self;
        let (branches, waiting) = (*branches, std::mem::take(waiting));
        let [first, second] = differences.each_mut().map(|own| &mut own[..]);
        for_each_band([trial, first, second, relaxing], |start, [old, first, second, relaxing]| {
            let (mut first, mut second) = (first.chunks_mut(BLOCK), second.chunks_mut(BLOCK));
            let mut blocks = relaxing.chunks_mut((BLOCK * branches).max(1));
            let (committed, mut steps) = (&rule.committed, [[0.0; BLOCK]; 3]);
            for (old, new) in old.chunks_mut(BLOCK).zip(now[start..].chunks(BLOCK)) {
                let (first, second) = (first.next().unwrap_or_default(), second.next().unwrap_or_default());
                if waiting {
                    take_differences(committed, old, new, first, second, &mut steps);
                }
                if let Some(tried) = tried {
                    let [kept, of_first, of_second] = tried.past;
                    old.iter_mut().zip(new).for_each(|(old, &new)| *old = kept * new);
                    for (weight, difference) in [(of_first, first), (of_second, second)] {
                        if weight != 0.0 {
                            old.iter_mut().zip(&*difference).for_each(|(old, &d)| *old += weight * d);
                        }
                    }
                }
                let branches = blocks.next().into_iter().flat_map(|block| block.chunks_mut(new.len()));
                for (i, (q, gains)) in branches.zip(&committed.branches).enumerate() {
                    let weight = tried.map_or(0.0, |tried| tried.c * tried.branches[i][0]);
                    if waiting {
                        take_in(q, gains, committed.terms, &steps, old, weight);
                        rule.forget_relaxed(q);
                    } else {
                        old.iter_mut().zip(&*q).for_each(|(old, &q)| *old -= weight * q);
                    }
                }
            }
        });
    }

    /// Predicts the end of the step whose weights were computed last. No pressure has pulled the surface up yet: if
    /// the field would fall below zero, and `sign_counts`, a polynomial of lower degree is taken. `side` \[m\] is the
    /// width of a cell.
    pub(super) fn predict_non_negative(
        &mut self,
        rule: &mut ExponentialRule,
        side: f64,
        rows: &Rows,
        sign_counts: impl Fn() -> bool,
    ) {
        self.predict(rule);
        while rule.has_less() && self.falls_below_zero(rule, side, rows) && sign_counts() {
            rule.reduce_order();
            self.predict(rule);
        }
    }

    /// Whether the trial is negative somewhere, by more than the rounding of the maximum field so far, or of a
    /// convolution that leaves nothing.
    pub(super) fn falls_below_zero(&self, rule: &mut ExponentialRule, side: f64, rows: &Rows) -> bool {
        rule.greatest = rule.greatest.max(rows.greatest(greatest(&self.now)));
        let least = (DIP * rule.greatest).min(NOISE * side);
        rows.any(self.trial.iter().any(|&value| value < least))
    }

    /// Adds c times a source to the trial.
    pub(super) fn add(&mut self, c: f64, source: &[f64]) {
        self.trial.iter_mut().zip(source).for_each(|(value, &source)| *value += c * source);
    }

    /// Accepts the step predicted last.
    pub(super) fn commit(&mut self) {
        self.waiting = true;
        std::mem::swap(&mut self.now, &mut self.trial);
    }

    /// Returns to the start of the step accepted last; only before anything else is predicted.
    pub(super) fn roll_back(&mut self) {
        self.waiting = false;
        std::mem::swap(&mut self.now, &mut self.trial);
    }

    /// Calls `take` with c Σ e^(−z_i) q_i less the share of the differences, for each cell that is `wanted`; after
    /// [`RememberedField::predict`].
    pub(super) fn recovery(
        &self,
        tried: &StepWeights,
        wanted: impl Fn(usize) -> bool,
        mut take: impl FnMut(usize, f64),
    ) {
        let [first, second] = self.differences();
        let mut blocks = self.relaxing.chunks((BLOCK * self.branches).max(1));
        for start in (0..self.now.len()).step_by(BLOCK) {
            let (block, width) = (blocks.next().unwrap_or_default(), BLOCK.min(self.now.len() - start));
            for k in (0..width).filter(|k| wanted(start + k)) {
                let branches = block.chunks(width).zip(&tried.branches);
                let stress: f64 = branches.map(|(q, weights)| weights[0] * q[k]).sum();
                let of = |weight: f64, own: &[f64]| if weight != 0.0 { weight * own[start + k] } else { 0.0 };
                take(start + k, tried.c * stress - of(tried.past[1], first) - of(tried.past[2], second));
            }
        }
    }
}

/// Finds the differences over the step committed last, from `old` to `new`, and keeps as many as are kept.
fn take_differences(
    committed: &StepWeights,
    old: &[f64],
    new: &[f64],
    first: &mut [f64],
    second: &mut [f64],
    steps: &mut Steps,
) {
    let [one, two, three] = steps;
    for ((step, &old), &new) in one.iter_mut().zip(old).zip(new) {
        *step = new - old;
    }
    let [to_first, to_second] = committed.ratios;
    for ((step, &change), first) in two.iter_mut().zip(&*one).zip(first) {
        *step = change - to_first * *first;
        *first = change;
    }
    for ((step, &bend), second) in three.iter_mut().zip(&*two).zip(second) {
        *step = bend - to_second * *second;
        *second = bend;
    }
}

/// q ← decay q + Σ γ_k d_k, and u_old −= weight q, in one pass.
fn take_in(
    q: &mut [f64],
    &[decay, one, two, three]: &[f64; 4],
    terms: usize,
    [first, second, third]: &Steps,
    u_old: &mut [f64],
    weight: f64,
) {
    let cells = q.iter_mut().zip(u_old).zip(first);
    match terms {
        0 | 1 => cells.for_each(|((q, old), &d)| {
            *q = decay * *q + one * d;
            *old -= weight * *q;
        }),
        2 => cells.zip(second).for_each(|(((q, old), &d), &bend)| {
            *q = decay * *q + one * d + two * bend;
            *old -= weight * *q;
        }),
        _ => cells.zip(second.iter().zip(third)).for_each(|(((q, old), &d), (&bend, &twist))| {
            *q = decay * *q + one * d + two * bend + three * twist;
            *old -= weight * *q;
        }),
    }
}
