//! The passes of the extension between two levels, row by row.

use std::ops::Range;

use crate::parallel::Task;
use crate::solver::extension::halo::HaloRows;
use crate::solver::extension::weights::weight;

/// Row buffers of one thread: blocks with one neighbour at either end, cells of the finer level with two.
#[derive(Debug, Clone)]
pub(super) struct RowBuffers {
    blocks: Vec<f64>,
    fine: Vec<f64>,
}

impl RowBuffers {
    /// For rows of `columns` cells.
    pub(super) fn new(columns: usize) -> RowBuffers {
        let blocks = columns.div_ceil(2);
        RowBuffers { blocks: vec![0.0; blocks + 2], fine: vec![0.0; 2 * blocks + 4] }
    }

    /// Bytes of the buffers.
    pub(super) fn bytes(columns: usize) -> u128 {
        8 * (3 * columns.div_ceil(2) as u128 + 6) + size_of::<RowBuffers>() as u128
    }
}

/// The operation of a pass, which computes a level from the level below it (S) or above it (x).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operation {
    /// S = Σ w f over each block, of a field that is 1 on the set.
    SumOnes,
    /// S = Σ w f over each block.
    Sum,
    /// S: the transpose of `Interpolate`, of (1 − w) f.
    Restrict,
    /// x = w m + (1 − w) up(x).
    Interpolate,
    /// x = w (m + x of the block): the transpose of `Sum`.
    Repeat,
}

/// A pass between two levels.
pub(super) struct Pass<'a> {
    pub(super) operation: Operation,
    /// The level that is read.
    pub(super) read: Blocks<'a>,
    /// The weights of the finer level.
    pub(super) known: Known<'a>,
    /// The first row that the rank holds of the finer level.
    pub(super) first: usize,
    /// Rows and columns of the finer level.
    pub(super) fine: [usize; 2],
    pub(super) periodic: [bool; 2],
}

/// The rows that a pass computes, from the `first` on.
pub(super) struct SharedRows<'a> {
    pub(super) pass: &'a Pass<'a>,
    pub(super) first: usize,
    pub(super) columns: usize,
}

impl Task for SharedRows<'_> {
    type Lane = RowBuffers;
    type Item = f64;

    #[inline(always)]
    fn run(&self, start: usize, buffers: &mut RowBuffers, values: &mut [f64]) {
        for (i, row) in (self.first + start / self.columns..).zip(values.chunks_exact_mut(self.columns)) {
            match self.pass.operation {
                Operation::SumOnes | Operation::Sum => self.pass.sum(i, buffers, row),
                Operation::Restrict => self.pass.restrict(i, buffers, row),
                Operation::Interpolate => self.pass.interpolate(i, buffers, row),
                Operation::Repeat => self.pass.repeat(i, buffers, row),
            }
        }
    }
}

/// The weights w of cells or blocks.
#[derive(Debug, Clone, Copy)]
pub(super) enum Known<'a> {
    Members(&'a [bool]),
    /// φ.
    Factors(&'a [f64]),
}

impl Known<'_> {
    /// out ← (1 − w) f.
    pub(super) fn write_open(self, values: &[f64], out: &mut [f64]) {
        let values = out.iter_mut().zip(values);
        match self {
            Known::Members(member) => {
                values.zip(member).for_each(|((out, &f), &inside)| *out = if inside { 0.0 } else { f });
            }
            Known::Factors(factors) => {
                values.zip(factors).for_each(|((out, &f), &factor)| *out = (1.0 - weight(factor)) * f);
            }
        }
    }
}

/// The rows of a level that a rank holds, and the halo rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blocks<'a> {
    pub(super) values: &'a [f64],
    /// The first row that the rank holds.
    pub(super) first: usize,
    pub(super) columns: usize,
    pub(super) halo: &'a HaloRows,
}

impl<'a> Blocks<'a> {
    #[inline(always)]
    fn row(&self, row: usize) -> &'a [f64] {
        self.kept(row).map_or_else(|| self.halo.row(row), |cells| &self.values[cells])
    }

    /// The cells of a row, if the rank holds it.
    #[inline(always)]
    fn kept(&self, row: usize) -> Option<Range<usize>> {
        let start = row.checked_sub(self.first)? * self.columns;
        (start < self.values.len()).then_some(start..start + self.columns)
    }
}

impl Pass<'_> {
    /// The sums of w f over the blocks of row `i`.
    #[inline(always)]
    fn sum(&self, i: usize, RowBuffers { fine, .. }: &mut RowBuffers, out: &mut [f64]) {
        let [n1, n2] = self.fine;
        let (values, first) = (self.read.values, self.first);
        out.fill(0.0);
        for row in (2 * i..(2 * i + 2).min(n1)).map(|row| (row - first) * n2..(row - first + 1) * n2) {
            let terms = fine.iter_mut();
            match self.known {
                Known::Members(member) if self.operation == Operation::SumOnes => {
                    terms.zip(&member[row]).for_each(|(term, &inside)| *term = f64::from(u8::from(inside)));
                }
                // the field is zero outside the set
                Known::Members(_) => fine[..n2].copy_from_slice(&values[row]),
                Known::Factors(factors) => {
                    let weighted = values[row.clone()].iter().zip(&factors[row]);
                    terms.zip(weighted).for_each(|(term, (f, factor))| *term = factor * f);
                }
            }
            fine[n2..2 * n2.div_ceil(2)].fill(0.0);
            out.iter_mut().zip(fine.as_chunks::<2>().0).for_each(|(out, [a, b])| *out += a + b);
        }
    }

    /// The transpose of the interpolation: the open part of the level below, brought to row `i` of its blocks.
    #[inline(always)]
    fn restrict(&self, i: usize, buffers: &mut RowBuffers, out: &mut [f64]) {
        let read = self.read;
        let (n2, m2) = (self.fine[1], self.fine[1].div_ceil(2));
        let fine = &mut buffers.fine[..2 * m2 + 4];
        let (rows, shares) = self.parts(i);
        let sums = &mut fine[2..n2 + 2];
        match self.known {
            Known::Members(member) => {
                let known = |row| read.kept(row).map_or(&read.halo.no_members[..], |cells| &member[cells]);
                let open = |inside: bool, f: f64| if inside { 0.0 } else { f };
                add_open(sums, shares, rows, |row| (known(row), read.row(row)), open);
            }
            Known::Factors(factors) => {
                let known = |row| read.kept(row).map_or(&read.halo.nothing_known[..], |cells| &factors[cells]);
                add_open(sums, shares, rows, |row| (known(row), read.row(row)), |factor, f| (1.0 - weight(factor)) * f);
            }
        }
        fine[n2 + 2..2 * m2 + 2].fill(0.0);
        let [before, after] = if self.periodic[1] { [2 * m2 + 1, 2] } else { [2, 2 * m2 + 1] };
        (fine[1], fine[2 * m2 + 2]) = (fine[before], fine[after]);
        let pairs = fine.as_chunks::<2>().0;
        let (a, b, c) = (&pairs[..m2], &pairs[1..][..m2], &pairs[2..][..m2]);
        for (((out, a), b), c) in out.iter_mut().zip(a).zip(b).zip(c) {
            *out = 0.75 * (b[0] + b[1]) + 0.25 * (a[1] + c[0]);
        }
    }

    /// The rows of the level that row `i` of blocks reaches, and the part of each row that it gets: 0 for rows beyond
    /// the end.
    #[inline(always)]
    fn parts(&self, i: usize) -> ([usize; 4], [f64; 4]) {
        let (n1, rows) = (self.fine[0], 2 * self.fine[0].div_ceil(2));
        let [before, after] = match self.periodic[0] {
            true => [(2 * i + rows - 1) % rows, (2 * i + 2) % rows],
            false => [(2 * i).saturating_sub(1), (2 * i + 2).min(rows - 1)],
        };
        let (row, part) = (
            |row: usize| if row < n1 { row } else { 2 * i },
            |row: usize, part: f64| if row < n1 { part } else { 0.0 },
        );
        (
            [row(before), 2 * i, row(2 * i + 1), row(after)],
            [part(before, 0.25), 0.75, part(2 * i + 1, 0.75), part(after, 0.25)],
        )
    }

    /// Row `i` of x from the same value on all cells of a block.
    #[inline(always)]
    fn repeat(&self, i: usize, buffers: &mut RowBuffers, values: &mut [f64]) {
        let above = &mut buffers.fine[..2 * self.fine[1].div_ceil(2)];
        let pairs = above.as_chunks_mut::<2>().0;
        pairs.iter_mut().zip(self.read.row(i / 2)).for_each(|(pair, &value)| *pair = [value; 2]);
        let (known, values) = ((i - self.first) * self.fine[1], values.iter_mut().zip(above));
        match self.known {
            Known::Members(member) => {
                values.zip(&member[known..]).for_each(|((x, up), &inside)| *x = if inside { *x + *up } else { 0.0 });
            }
            Known::Factors(factors) => {
                values.zip(&factors[known..]).for_each(|((x, up), &factor)| *x = factor * (*x + *up));
            }
        }
    }

    /// Row `i` of x from 9/16 of the block of a cell, 3/16 of two neighbours and 1/16 of the third.
    #[inline(always)]
    fn interpolate(&self, i: usize, rows: &mut RowBuffers, values: &mut [f64]) {
        let (m1, m2) = (self.fine[0].div_ceil(2), self.fine[1].div_ceil(2));
        let (near, last) = (i / 2, m1 - 1);
        let far = match (i.is_multiple_of(2), self.periodic[0]) {
            (true, true) => (near + last) % m1,
            (true, false) => near.saturating_sub(1),
            (false, true) => (near + 1) % m1,
            (false, false) => (near + 1).min(last),
        };
        let across = &mut rows.blocks[..m2 + 2];
        let (near, far) = (&self.read.row(near)[..m2], &self.read.row(far)[..m2]);
        for ((a, &near), &far) in across[1..=m2].iter_mut().zip(near).zip(far) {
            *a = 0.75 * near + 0.25 * far;
        }
        let [before, after] = if self.periodic[1] { [m2, 1] } else { [1, m2] };
        (across[0], across[m2 + 1]) = (across[before], across[after]);
        let (a, b, c) = (&across[..m2], &across[1..][..m2], &across[2..][..m2]);
        let fine = &mut rows.fine[..2 * m2];
        for (((pair, a), b), c) in fine.as_chunks_mut::<2>().0.iter_mut().zip(a).zip(b).zip(c) {
            *pair = [0.75 * b + 0.25 * a, 0.75 * b + 0.25 * c];
        }
        let (known, values) = ((i - self.first) * self.fine[1], values.iter_mut().zip(fine));
        match self.known {
            Known::Members(member) => {
                values.zip(&member[known..]).for_each(|((x, up), &inside)| *x = if inside { *x } else { *up });
            }
            Known::Factors(factors) => {
                let values = values.zip(&factors[known..]);
                values.for_each(|((x, up), &factor)| *x = factor * *x + (1.0 - weight(factor)) * *up);
            }
        }
    }
}

/// out = Σ part · open(known, value) over four rows, of which `of` gives the weights and the values.
#[inline(always)]
fn add_open<'a, K: Copy + 'a>(
    out: &mut [f64],
    parts: [f64; 4],
    rows: [usize; 4],
    of: impl Fn(usize) -> (&'a [K], &'a [f64]),
    open: impl Fn(K, f64) -> f64,
) {
    let [(ka, a), (kb, b), (kc, c), (kd, d)] = [of(rows[0]), of(rows[1]), of(rows[2]), of(rows[3])];
    let values = a.iter().zip(b).zip(c.iter().zip(d));
    let known = ka.iter().zip(kb).zip(kc.iter().zip(kd));
    for ((out, ((&a, &b), (&c, &d))), ((&ka, &kb), (&kc, &kd))) in out.iter_mut().zip(values).zip(known) {
        let outer = parts[0] * open(ka, a) + parts[3] * open(kd, d);
        *out = outer + (parts[1] * open(kb, b) + parts[2] * open(kc, c));
    }
}
