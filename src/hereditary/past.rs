//! The memory of a field's past.

use std::ops::Range;

use educe::Educe;

#[cfg(feature = "checkpoint")]
use crate::hereditary::common_cells::CommonCells;
use crate::hereditary::exponential_rule::{ExponentialRule, Weights};
use crate::parallel::{BAND_CELLS, join, lanes, middle};

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
    /// The fields q_i by blocks of cells, within a block one branch after the other: one stream through memory.
    fields: Vec<f64>,
    /// d₁ and d₂ at the end of the step before the last, or of the last once that is taken in; empty if the rule keeps none.
    differences: [Vec<f64>; 2],
    /// Whether the last step has yet to be taken in.
    waiting: bool,
}

/// Cells processed together, so that what the branches share stays in the fastest cache. With 30 branches at 256² cells a
/// step takes 1.1 times as long as with one; 1.4 times if each branch is an array of its own, whose start must be fetched
/// from memory for every block.
const BLOCK: usize = 512;
const _: () = assert!(BAND_CELLS.is_multiple_of(BLOCK));

/// d₁, d₂ and d₃ of the step committed last, on the cells of a block.
type Steps = [[f64; BLOCK]; 3];

impl Past {
    /// Undisturbed, with so many relaxation times.
    pub(super) fn undisturbed(branches: usize, cells: usize) -> Past {
        Past { branches, fields: vec![0.0; cells * branches], differences: [Vec::new(), Vec::new()], waiting: false }
    }

    /// Makes room for so many differences.
    pub(super) fn keep(&mut self, kept: usize, cells: usize) {
        self.differences.iter_mut().take(kept).for_each(|own| own.resize(cells, 0.0));
    }

    /// Number of relaxation times.
    pub(super) fn branches(&self) -> usize {
        self.branches
    }

    /// Bytes per cell, with so many differences.
    pub(super) fn bytes_per_cell(&self, kept: usize) -> usize {
        8 * (self.branches + kept)
    }

    /// The step predicted last has been accepted.
    pub(super) fn commit(&mut self) {
        self.waiting = true;
    }

    /// Writes u_old over `u_old`, which after a commit must still hold the field before that step, as `field` holds the one
    /// after it.
    pub(super) fn predict(&mut self, rule: &ExponentialRule, field: &[f64], u_old: &mut [f64]) {
        self.keep(rule.kept(), field.len());
        let waiting = std::mem::take(&mut self.waiting);
        let [first, second] = self.differences.each_mut().map(|own| &mut own[..]);
        let part = Part { branches: self.branches, fields: &mut self.fields, first, second, field, u_old };
        part.share(lanes(field.len()) > 1, &|part: Part<'_>| part.predict(rule, waiting));
    }

    /// Takes in the step committed last, in which the field went from `before` to `field`.
    pub(super) fn apply_pending_step(&mut self, rule: &ExponentialRule, before: &[f64], field: &[f64]) {
        if !std::mem::take(&mut self.waiting) {
            return;
        }
        self.keep(rule.kept(), field.len());
        let (mut steps, mut nowhere) = ([[0.0; BLOCK]; 3], [0.0; BLOCK]);
        let [mut first, mut second] = self.differences.each_mut().map(|own| own.chunks_mut(BLOCK));
        let mut blocks = self.fields.chunks_mut((BLOCK * self.branches).max(1));
        for (old, new) in before.chunks(BLOCK).zip(field.chunks(BLOCK)) {
            let (first, second) = (first.next().unwrap_or_default(), second.next().unwrap_or_default());
            take_differences(&rule.committed, old, new, first, second, &mut steps);
            let branches = blocks.next().into_iter().flat_map(|fields| fields.chunks_mut(new.len()));
            for (q, gains) in branches.zip(&rule.committed.branches) {
                take_in(q, gains, rule.committed.terms, &steps, &mut nowhere, 0.0);
            }
        }
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

    /// Whether it has so many branches, and its fields so many cells.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self, branches: usize, kept: usize, cells: usize) -> bool {
        let differences = self.differences.iter().enumerate();
        self.branches == branches
            && Some(self.fields.len()) == cells.checked_mul(branches)
            && differences
                .into_iter()
                .all(|(k, own)| own.is_empty() && (k >= kept || self.waiting) || own.len() == cells)
    }

    /// The same on `cells` other cells, with every field zero.
    #[cfg(feature = "checkpoint")]
    pub(super) fn blank_on(&self, cells: usize) -> Past {
        let blank = |own: &Vec<f64>| if own.is_empty() { Vec::new() } else { vec![0.0; cells] };
        let Past { branches, waiting, differences, .. } = self;
        let fields = vec![0.0; cells * branches];
        Past { branches: *branches, fields, differences: differences.each_ref().map(blank), waiting: *waiting }
    }

    /// Copies the cells in common with another, which has as many branches; `here` and `there` are all cells of each.
    #[cfg(feature = "checkpoint")]
    pub(super) fn copy_common(&mut self, other: &Past, common: CommonCells, [here, there]: [usize; 2]) {
        for i in 0..self.branches {
            for k in 0..common.count {
                let from = other.place(i, common.there + k, there);
                let to = self.place(i, common.here + k, here);
                self.fields[to] = other.fields[from];
            }
        }
        self.differences.iter_mut().zip(&other.differences).for_each(|(own, other)| common.copy(other, own));
    }

    /// Where q_i of a cell is.
    #[cfg(feature = "checkpoint")]
    fn place(&self, i: usize, cell: usize, cells: usize) -> usize {
        let start = cell / BLOCK * BLOCK;
        start * self.branches + i * BLOCK.min(cells - start) + cell % BLOCK
    }

    /// The ranges of the field q_i.
    fn pieces(&self, i: usize, cells: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        let branches = self.branches;
        (0..cells.div_ceil(BLOCK)).map(move |block| {
            let width = BLOCK.min(cells - block * BLOCK);
            let start = block * BLOCK * branches + i * width;
            start..start + width
        })
    }

    /// Copies the field q_i to `field`.
    fn read_branch(&self, i: usize, field: &mut [f64]) {
        let pieces = self.pieces(i, field.len());
        field.chunks_mut(BLOCK).zip(pieces).for_each(|(out, piece)| out.copy_from_slice(&self.fields[piece]));
    }

    /// Replaces the field q_i.
    fn write_branch(&mut self, i: usize, field: &[f64]) {
        let pieces = self.pieces(i, field.len());
        field.chunks(BLOCK).zip(pieces).for_each(|(values, piece)| self.fields[piece].copy_from_slice(values));
    }

    /// Changes each of its fields, which have as many cells as `scratch`.
    pub(super) fn change(&mut self, scratch: &mut [f64], mut change: impl FnMut(&mut [f64])) {
        for i in 0..self.branches {
            self.read_branch(i, scratch);
            change(scratch);
            self.write_branch(i, scratch);
        }
        self.differences.iter_mut().filter(|own| !own.is_empty()).for_each(|own| change(own));
    }

    /// The same past, settled, on `to` instead of `from` cells. `carry` returns there each of its fields, given with the same
    /// field of `companion`.
    pub(super) fn carried(
        &self,
        [to, from]: [usize; 2],
        companion: Option<&Past>,
        mut carry: impl FnMut(&[f64], Option<&[f64]>) -> Vec<f64>,
    ) -> Past {
        let mut carried = Past::undisturbed(self.branches, to);
        let (mut own, mut source) = (vec![0.0; from], vec![0.0; from]);
        for i in 0..self.branches {
            self.read_branch(i, &mut own);
            if let Some(companion) = companion {
                companion.read_branch(i, &mut source);
            }
            carried.write_branch(i, &carry(&own, companion.map(|_| &source[..])));
        }
        for (k, own) in self.differences.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
            carried.differences[k] = carry(own, companion.map(|companion| &companion.differences[k][..]));
        }
        carried
    }
}

/// Contiguous cells of a past and its field: whole blocks, except the last.
struct Part<'a> {
    branches: usize,
    fields: &'a mut [f64],
    first: &'a mut [f64],
    second: &'a mut [f64],
    field: &'a [f64],
    u_old: &'a mut [f64],
}

impl Part<'_> {
    /// Calls `job` with parts of this one, between threads where the work is `shared`.
    fn share(self, shared: bool, job: &(impl Fn(Part<'_>) + Sync)) {
        let cells = self.field.len();
        if !shared || cells <= BAND_CELLS {
            return job(self);
        }
        let middle = middle(cells);
        let Part { branches, fields, first, second, field, u_old } = self;
        let fields = fields.split_at_mut(middle * branches);
        let [first, second] = [first, second].map(|own| own.split_at_mut(middle.min(own.len())));
        let (field, u_old) = (field.split_at(middle), u_old.split_at_mut(middle));
        let before =
            Part { branches, fields: fields.0, first: first.0, second: second.0, field: field.0, u_old: u_old.0 };
        let after =
            Part { branches, fields: fields.1, first: first.1, second: second.1, field: field.1, u_old: u_old.1 };
        join(true, || before.share(true, job), || after.share(true, job));
    }

    /// See [`Past::predict`]; `waiting` is true while the last step has yet to be added.
    fn predict(self, rule: &ExponentialRule, waiting: bool) {
        let (tried, committed) = (&rule.tried, &rule.committed);
        let mut steps = [[0.0; BLOCK]; 3];
        let (mut first, mut second) = (self.first.chunks_mut(BLOCK), self.second.chunks_mut(BLOCK));
        let mut blocks = self.fields.chunks_mut((BLOCK * self.branches).max(1));
        for (old, new) in self.u_old.chunks_mut(BLOCK).zip(self.field.chunks(BLOCK)) {
            let (first, second) = (first.next().unwrap_or_default(), second.next().unwrap_or_default());
            if waiting {
                take_differences(committed, old, new, first, second, &mut steps);
            }
            let [kept, of_first, of_second] = tried.past;
            old.iter_mut().zip(new).for_each(|(old, &new)| *old = kept * new);
            if of_first != 0.0 {
                old.iter_mut().zip(&*first).for_each(|(old, &d)| *old += of_first * d);
            }
            if of_second != 0.0 {
                old.iter_mut().zip(&*second).for_each(|(old, &d)| *old += of_second * d);
            }
            let branches = blocks.next().into_iter().flat_map(|fields| fields.chunks_mut(new.len()));
            for ((q, weights), gains) in branches.zip(&tried.branches).zip(&committed.branches) {
                let weight = tried.c * weights[0];
                if waiting {
                    take_in(q, gains, committed.terms, &steps, old, weight);
                } else {
                    old.iter_mut().zip(&*q).for_each(|(old, &q)| *old -= weight * q);
                }
            }
        }
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
