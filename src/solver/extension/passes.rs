//! The passes of the extension between two levels, row by row.

use std::ops::Range;

use crate::parallel::Task;
use crate::solver::extension::TRUST;
use crate::solver::extension::neighbours::Ghosts;

/// Row buffers of one thread: blocks with one neighbour at either end, cells of the finer level with two.
#[derive(Debug, Clone)]
pub(super) struct RowBuffers {
    blocks: Vec<f64>,
    fine: Vec<f64>,
    /// The first row of the share of a thread.
    pub(super) first: usize,
}

impl RowBuffers {
    /// For rows of `columns` cells.
    pub(super) fn new(columns: usize) -> RowBuffers {
        let blocks = columns.div_ceil(2);
        RowBuffers { blocks: vec![0.0; blocks + 2], fine: vec![0.0; 2 * blocks + 4], first: 0 }
    }

    /// Bytes that they take.
    pub(super) fn bytes(columns: usize) -> u128 {
        8 * (3 * columns.div_ceil(2) as u128 + 6) + size_of::<RowBuffers>() as u128
    }
}

/// What the blocks of a level are summed over.
#[derive(Debug, Clone, Copy)]
pub(super) enum Values<'a> {
    /// Ones on the cells of the set.
    Members(&'a [bool]),
    /// A field that is zero outside the set.
    Field(&'a [f64]),
    /// φ S of blocks.
    Weighted(&'a [f64], &'a [f64]),
}

/// The weights w of cells or blocks.
#[derive(Debug, Clone, Copy)]
pub(super) enum Known<'a> {
    Members(&'a [bool]),
    /// φ.
    Factors(&'a [f64]),
}

/// The rows that are kept of a level, and those beside them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blocks<'a> {
    pub(super) values: &'a [f64],
    /// The first row that is kept.
    pub(super) first: usize,
    pub(super) columns: usize,
    pub(super) ghosts: &'a Ghosts,
}

impl<'a> Blocks<'a> {
    #[inline(always)]
    fn row(&self, row: usize) -> &'a [f64] {
        self.kept(row).map_or_else(|| self.ghosts.row(row), |cells| &self.values[cells])
    }

    /// The cells of a row, if it is kept.
    #[inline(always)]
    fn kept(&self, row: usize) -> Option<Range<usize>> {
        let start = row.checked_sub(self.first)? * self.columns;
        (start < self.values.len()).then_some(start..start + self.columns)
    }
}

/// φ of blocks of which nothing is known: w is 0, and the whole value counts.
pub(super) const NOTHING_KNOWN: f64 = 0.25 * TRUST;

/// S of blocks from the level below.
pub(super) struct Push<'a> {
    pub(super) values: Values<'a>,
    pub(super) fine: [usize; 2],
    /// The first row that is kept of the level below.
    pub(super) first: usize,
}

impl Task for Push<'_> {
    type Lane = RowBuffers;
    type Item = f64;

    #[inline(always)]
    fn run(&self, _: usize, rows: &mut RowBuffers, sums: &mut [f64]) {
        let [n1, n2] = self.fine;
        for (i, out) in (rows.first..).zip(sums.chunks_exact_mut(n2.div_ceil(2))) {
            out.fill(0.0);
            for row in (2 * i..(2 * i + 2).min(n1)).map(|row| row - self.first).map(|row| row * n2..(row + 1) * n2) {
                match self.values {
                    Values::Members(member) => {
                        let ones = &mut rows.fine[..n2];
                        ones.iter_mut().zip(&member[row]).for_each(|(one, &m)| *one = f64::from(u8::from(m)));
                        add_pairs(out, ones);
                    }
                    Values::Field(field) => add_pairs(out, &field[row]),
                    Values::Weighted(values, factors) => add_weighted_pairs(out, &values[row.clone()], &factors[row]),
                }
            }
        }
    }
}

/// x = w m + (1 − w) up(x), from the x of the level above.
pub(super) struct Pull<'a> {
    pub(super) blocks: Blocks<'a>,
    pub(super) known: Known<'a>,
    pub(super) fine: [usize; 2],
    /// The first row that is kept of the level below.
    pub(super) first: usize,
    pub(super) periodic: [bool; 2],
}

impl Task for Pull<'_> {
    type Lane = RowBuffers;
    type Item = f64;

    #[inline(always)]
    fn run(&self, _: usize, rows: &mut RowBuffers, values: &mut [f64]) {
        let n2 = self.fine[1];
        for (i, values) in (rows.first..).zip(values.chunks_exact_mut(n2)) {
            let up = self.interpolate(i, rows);
            let own = (i - self.first) * n2;
            match self.known {
                Known::Members(member) => {
                    for ((x, &inside), &up) in values.iter_mut().zip(&member[own..]).zip(up) {
                        *x = if inside { *x } else { up };
                    }
                }
                Known::Factors(factors) => {
                    for ((x, &factor), &up) in values.iter_mut().zip(&factors[own..]).zip(up) {
                        *x = factor * *x + (1.0 - weight(factor)) * up;
                    }
                }
            }
        }
    }
}

impl Pull<'_> {
    /// Row `i` of the level from the blocks: 9/16 of its own, 3/16 of two neighbours and 1/16 of the third.
    #[inline(always)]
    fn interpolate<'r>(&self, i: usize, rows: &'r mut RowBuffers) -> &'r [f64] {
        let [m1, m2] = self.fine.map(|n| n.div_ceil(2));
        let (near, last) = (i / 2, m1 - 1);
        let far = match (i.is_multiple_of(2), self.periodic[0]) {
            (true, true) => (near + last) % m1,
            (true, false) => near.saturating_sub(1),
            (false, true) => (near + 1) % m1,
            (false, false) => (near + 1).min(last),
        };
        let across = &mut rows.blocks[..m2 + 2];
        let [near, far] = [near, far].map(|i| &self.blocks.row(i)[..m2]);
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
        fine
    }
}

/// The transpose of the interpolation: what is open of the level below, brought to its blocks.
pub(super) struct Restrict<'a> {
    pub(super) values: Blocks<'a>,
    pub(super) known: Known<'a>,
    pub(super) fine: [usize; 2],
    pub(super) periodic: [bool; 2],
}

impl Task for Restrict<'_> {
    type Lane = RowBuffers;
    type Item = f64;

    #[inline(always)]
    fn run(&self, _: usize, RowBuffers { first, fine, .. }: &mut RowBuffers, blocks: &mut [f64]) {
        let (n2, m2) = (self.fine[1], self.fine[1].div_ceil(2));
        let fine = &mut fine[..2 * m2 + 4];
        for (i, out) in (*first..).zip(blocks.chunks_exact_mut(m2)) {
            let parts = self.parts(i);
            let shares = [parts[0].1, parts[1].1, parts[2].1, parts[3].1];
            let [a, b, c, d] = [parts[0].0, parts[1].0, parts[2].0, parts[3].0];
            let (rows, ghosts) = (self.values, self.values.ghosts);
            let values = [rows.row(a), rows.row(b), rows.row(c), rows.row(d)];
            let sums = &mut fine[2..n2 + 2];
            match self.known {
                Known::Members(member) => {
                    let known = |row: usize| rows.kept(row).map_or(ghosts.outside(), |cells| &member[cells]);
                    let known = [known(a), known(b), known(c), known(d)];
                    add_open(sums, shares, values, known, |inside, f| if inside { 0.0 } else { f });
                }
                Known::Factors(factors) => {
                    let known = |row: usize| rows.kept(row).map_or(ghosts.open(), |cells| &factors[cells]);
                    let known = [known(a), known(b), known(c), known(d)];
                    add_open(sums, shares, values, known, |factor, f| (1.0 - weight(factor)) * f);
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
    }
}

impl Restrict<'_> {
    /// The rows of the level that row `i` of blocks reaches, and what part of them it gets: none of rows beyond the end.
    #[inline(always)]
    fn parts(&self, i: usize) -> [(usize, f64); 4] {
        let (n1, rows) = (self.fine[0], 2 * self.fine[0].div_ceil(2));
        let [before, after] = match self.periodic[0] {
            true => [(2 * i + rows - 1) % rows, (2 * i + 2) % rows],
            false => [(2 * i).saturating_sub(1), (2 * i + 2).min(rows - 1)],
        };
        let part = |row: usize, part: f64| if row < n1 { (row, part) } else { (2 * i, 0.0) };
        [part(before, 0.25), part(2 * i, 0.75), part(2 * i + 1, 0.75), part(after, 0.25)]
    }
}

/// The transpose of the sums over blocks: what a block holds goes to what is known of its parts.
pub(super) struct Spread<'a> {
    pub(super) blocks: Blocks<'a>,
    pub(super) known: Known<'a>,
    pub(super) fine: [usize; 2],
    /// The first row that is kept of the level below.
    pub(super) first: usize,
}

impl Task for Spread<'_> {
    type Lane = RowBuffers;
    type Item = f64;

    #[inline(always)]
    fn run(&self, _: usize, RowBuffers { first, fine, .. }: &mut RowBuffers, values: &mut [f64]) {
        let (n2, m2) = (self.fine[1], self.fine[1].div_ceil(2));
        let fine = &mut fine[..2 * m2];
        for (i, values) in (*first..).zip(values.chunks_exact_mut(n2)) {
            // both rows of a block get the same values
            if i == *first || i.is_multiple_of(2) {
                let pairs = fine.as_chunks_mut::<2>().0;
                pairs.iter_mut().zip(self.blocks.row(i / 2)).for_each(|(pair, &value)| *pair = [value; 2]);
            }
            let own = (i - self.first) * n2;
            match self.known {
                Known::Members(member) => {
                    for ((f, &inside), &sum) in values.iter_mut().zip(&member[own..]).zip(&*fine) {
                        *f = if inside { *f + sum } else { 0.0 };
                    }
                }
                Known::Factors(factors) => {
                    let known = factors[own..].iter();
                    values.iter_mut().zip(known).zip(&*fine).for_each(|((f, &factor), &sum)| *f = factor * (*f + sum));
                }
            }
        }
    }
}

/// w of a block with this φ.
#[inline(always)]
pub(super) fn weight(factor: f64) -> f64 {
    (TRUST - 4.0 * factor) / (TRUST - 1.0)
}

/// out = Σ part · open(known, value) over four rows.
#[inline(always)]
fn add_open<K: Copy>(
    out: &mut [f64],
    parts: [f64; 4],
    [a, b, c, d]: [&[f64]; 4],
    [ka, kb, kc, kd]: [&[K]; 4],
    open: impl Fn(K, f64) -> f64,
) {
    let values = a.iter().zip(b).zip(c.iter().zip(d));
    let known = ka.iter().zip(kb).zip(kc.iter().zip(kd));
    for ((out, ((&a, &b), (&c, &d))), ((&ka, &kb), (&kc, &kd))) in out.iter_mut().zip(values).zip(known) {
        let outer = parts[0] * open(ka, a) + parts[3] * open(kd, d);
        *out = outer + (parts[1] * open(kb, b) + parts[2] * open(kc, c));
    }
}

/// Adds pairs of values to each block.
#[inline(always)]
fn add_pairs(out: &mut [f64], row: &[f64]) {
    let (pairs, rest) = row.as_chunks::<2>();
    out.iter_mut().zip(pairs).for_each(|(out, [a, b])| *out += a + b);
    if let ([last], Some(out)) = (rest, out.last_mut()) {
        *out += last;
    }
}

#[inline(always)]
fn add_weighted_pairs(out: &mut [f64], values: &[f64], weights: &[f64]) {
    let ((f, last_f), (w, last_w)) = (values.as_chunks::<2>(), weights.as_chunks::<2>());
    out.iter_mut().zip(f.iter().zip(w)).for_each(|(out, (f, w))| *out += w[0] * f[0] + w[1] * f[1]);
    if let ([f], [w], Some(out)) = (last_f, last_w, out.last_mut()) {
        *out += w * f;
    }
}
