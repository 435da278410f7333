//! The memory of a field's past.

use educe::Educe;

use crate::hereditary::exponential_rule::{ExponentialRule, Weights};
use crate::hereditary::field::{BLOCK, Field, Role, change};
use crate::parallel::{BAND_CELLS, for_each_band};

/// The past of a field that follows the exponential rule: q_i for each relaxation time, and its differences over the last
/// steps.
///
/// What the step committed last adds waits until the next one is predicted, so that every q_i passes through the processor once
/// per step: with many relaxation times this is the cost of a step besides its contact problem.
#[derive(Debug, Educe)]
#[educe(Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Past {
    branches: usize,
    /// The fields q_i, interleaved as a [`Field`]: one stream through memory.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    fields: Vec<f64>,
    /// How many differences are kept.
    kept: usize,
    /// d₁ and d₂ at the end of the step before the last, or of the last once that is taken in; empty where not kept.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    differences: [Vec<f64>; 2],
    /// Whether the last step has yet to be taken in.
    waiting: bool,
}

const _: () = assert!(BAND_CELLS.is_multiple_of(BLOCK));

/// d₁, d₂ and d₃ of the step committed last, on the cells of a block.
type Steps = [[f64; BLOCK]; 3];

impl Past {
    /// Undisturbed, with so many relaxation times.
    pub(super) fn undisturbed(branches: usize, cells: usize) -> Past {
        let fields = vec![0.0; cells * branches];
        Past { branches, fields, kept: 0, differences: [Vec::new(), Vec::new()], waiting: false }
    }

    /// Makes room for so many differences.
    pub(super) fn keep(&mut self, kept: usize, cells: usize) {
        self.kept = self.kept.max(kept);
        self.differences.iter_mut().take(kept).for_each(|own| own.resize(cells, 0.0));
    }

    /// A past whose fields are what `map` makes of these; the fields of `far` are the sources of these.
    pub(super) fn map(&self, far: Option<&Past>, map: &mut impl FnMut(Field<'_>) -> Vec<f64>) -> Past {
        let Past { branches, kept, waiting, ref fields, ref differences } = *self;
        let mut map = |values: &[f64], per_cell: usize, source: Option<&Vec<f64>>| {
            map(Field { values, per_cell, role: Role::Lasting { source: source.map(|source| &source[..]) } })
        };
        let fields = map(fields, branches, far.map(|far| &far.fields));
        let differences =
            [0, 1].map(|k| map(&differences[k], usize::from(k < kept), far.map(|far| &far.differences[k])));
        Past { branches, fields, kept, differences, waiting }
    }

    /// The step predicted last has been accepted.
    pub(super) fn commit(&mut self) {
        self.waiting = true;
    }

    /// Writes u_old over `u_old`, which after a commit must still hold the field before that step, as `field` holds the one
    /// after it.
    pub(super) fn predict(&mut self, rule: &ExponentialRule, field: &[f64], u_old: &mut [f64]) {
        self.advance(rule, Some(&rule.tried), field, u_old);
    }

    /// Takes in the step committed last, in which the field went from `before` to `field`.
    pub(super) fn apply_pending_step(&mut self, rule: &ExponentialRule, before: &mut [f64], field: &[f64]) {
        if self.waiting {
            self.advance(rule, None, field, before);
        }
    }

    /// Takes in the step committed last, if it waits, and predicts the step of weights `tried`, if any: then the field before the
    /// last step gives way to u_old.
    fn advance(&mut self, rule: &ExponentialRule, tried: Option<&Weights>, field: &[f64], old: &mut [f64]) {
        self.keep(rule.kept(), field.len());
        let waiting = std::mem::take(&mut self.waiting);
        let (branches, [first, second]) = (self.branches, self.differences.each_mut().map(|own| &mut own[..]));
        for_each_band([old, first, second, &mut self.fields], |start, [old, first, second, fields]| {
            let (mut first, mut second) = (first.chunks_mut(BLOCK), second.chunks_mut(BLOCK));
            let mut blocks = fields.chunks_mut((BLOCK * branches).max(1));
            let (committed, mut steps) = (&rule.committed, [[0.0; BLOCK]; 3]);
            for (old, new) in old.chunks_mut(BLOCK).zip(field[start..].chunks(BLOCK)) {
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
                let branches = blocks.next().into_iter().flat_map(|fields| fields.chunks_mut(new.len()));
                for (i, (q, gains)) in branches.zip(&committed.branches).enumerate() {
                    let weight = tried.map_or(0.0, |tried| tried.c * tried.branches[i][0]);
                    if waiting {
                        take_in(q, gains, committed.terms, &steps, old, weight);
                    } else {
                        old.iter_mut().zip(&*q).for_each(|(old, &q)| *old -= weight * q);
                    }
                }
            }
        });
    }

    /// d₁ and d₂ at the end of the last step once that is taken in; empty where the rule keeps none.
    pub(super) fn differences(&self) -> [&[f64]; 2] {
        [&self.differences[0], &self.differences[1]]
    }

    /// Drops the step committed last, which has not been taken in.
    pub(super) fn roll_back(&mut self) {
        self.waiting = false;
    }

    /// Calls `take` with c Σ e^(−z_i) q_i less the share of the differences, for each cell that is `wanted`; after
    /// [`Past::predict`].
    pub(super) fn recovery(
        &self,
        tried: &Weights,
        cells: usize,
        wanted: impl Fn(usize) -> bool,
        mut take: impl FnMut(usize, f64),
    ) {
        let [first, second] = self.differences();
        let mut blocks = self.fields.chunks((BLOCK * self.branches).max(1));
        for start in (0..cells).step_by(BLOCK) {
            let (fields, width) = (blocks.next().unwrap_or_default(), BLOCK.min(cells - start));
            for k in (0..width).filter(|k| wanted(start + k)) {
                let branches = fields.chunks(width).zip(&tried.branches);
                let stress: f64 = branches.map(|(q, weights)| weights[0] * q[k]).sum();
                let of = |weight: f64, own: &[f64]| if weight != 0.0 { weight * own[start + k] } else { 0.0 };
                take(start + k, tried.c * stress - of(tried.past[1], first) - of(tried.past[2], second));
            }
        }
    }

    /// Whether it has as many branches as another, and keeps as many differences as a rule, unless it has yet to take in a step.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self, other: &Past, kept: usize) -> bool {
        self.branches == other.branches && self.kept <= 2 && (self.kept >= kept || self.waiting)
    }

    /// Changes each of its fields, which have as many cells as `scratch`.
    pub(super) fn change(&mut self, scratch: &mut [f64], mut job: impl FnMut(&mut [f64])) {
        for i in 0..self.branches {
            change(&mut self.fields, [self.branches, i], scratch, &mut job);
        }
        self.differences.iter_mut().take(self.kept).for_each(|own| job(own));
    }
}

/// Finds the differences over the step committed last, from `old` to `new`, and keeps as many as are kept.
fn take_differences(
    committed: &Weights,
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
