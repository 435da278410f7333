//! The smooth extension of a field from the contact to all cells, and its transpose.

mod halo;
mod passes;
mod weights;

#[cfg(test)]
mod tests;

use std::ops::Range;

use crate::parallel::{Rows, for_each_share, lanes};
pub(crate) use crate::solver::extension::halo::{HaloExchange, HaloRows};
use crate::solver::extension::passes::{Blocks, Known, Operation, Pass, RowBuffers, SharedRows};
use crate::solver::extension::weights::TRUST;

/// E: from the cells of a set A to all cells, by means over blocks of 2 × 2 cells, over blocks of such blocks and so
/// on, and bilinear interpolation back (a push–pull pyramid),
///
/// x_l = w_l m_l + (1 − w_l) up(x_(l+1)),  m_(l+1) = Σ w_l m_l / Σ w_l over the block,  w_(l+1) = κ s/(1 + (κ − 1) s),
///
/// where s is the mean of w_l over the block, and w_0 is 1 on A and 0 elsewhere; x = m on the coarsest level, a
/// single block. E reproduces constants. Its transpose moves the values of all cells to A, and keeps their sum.
/// Blocks hold the sums S = Σ w m over their parts, and the factor φ = κ/(4 + 4 (κ − 1) s). The weights are linear in
/// φ: w m = φ S, and w = (κ − 4 φ)/(κ − 1).
///
/// An [`Attenuation`] multiplies x of one level before the next finer one is computed: near A, within the reach, the
/// residual is extended as it is, beyond it times the factor.
///
/// Axes that are not periodic are mirrored at their ends, as the symmetric parts of a grid are.
///
/// Every row of a level is computed from finished rows of another one: threads share the rows, and the result does
/// not depend on their number.
///
/// Where ranks share the cells, their bands are whole rows of blocks of 16 × 16 cells. Of blocks of 2 × 2, 4 × 4 and
/// 8 × 8 cells a rank holds the local rows, and a halo row where a pass needs it. Larger blocks, a 256th as many
/// numbers as there are cells, are gathered, and every rank computes all of them.
#[derive(Debug, Clone)]
pub(crate) struct Extension {
    /// The cells, and which of their rows are local.
    rows: Rows,
    periodic: [bool; 2],
    levels: Vec<Level>,
    /// 1/Σ w over the coarsest block, 0 if nothing is known.
    share: f64,
    /// One set per thread.
    buffers: Vec<RowBuffers>,
    /// The halo rows of the cells.
    halo: HaloRows,
    exchange: Option<HaloExchange>,
    attenuation: Option<Attenuation>,
}

/// Range of an extension, and the factor that its values are multiplied by beyond it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attenuation {
    /// Range \[cells\].
    pub(crate) reach: f64,
    /// Factor, without unit; negative where the extended residual changes its sign.
    pub(crate) remains: f64,
}

impl Attenuation {
    /// The height of the blocks that are multiplied by `remains`: they are no longer than the reach.
    fn height(&self) -> usize {
        (self.reach.log2() as usize).max(1)
    }
}

/// Extension with or without attenuation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ExtensionKind {
    /// With its [`Attenuation`].
    Attenuated,
    /// Without one: constants are reproduced.
    Unbounded,
}

/// Blocks of cells.
#[derive(Debug, Clone)]
struct Level {
    /// A block has 2^`height` × 2^`height` cells.
    height: usize,
    /// Blocks of all ranks.
    cells: [usize; 2],
    /// The rows that this rank holds.
    kept: Range<usize>,
    /// φ.
    factor: Vec<f64>,
    /// S, then x.
    value: Vec<f64>,
    /// The halo rows, where a rank holds the local rows alone.
    halo: HaloRows,
    /// The values of the local rows, where the rows of other ranks are gathered.
    local: Option<Vec<f64>>,
}

/// Number of levels over so many cells: the last one is a single block.
fn count_levels(cells: [usize; 2]) -> usize {
    cells[0].max(cells[1]).next_power_of_two().ilog2() as usize
}

/// Whether a rank holds the local rows alone of blocks of this level: from the fourth on a block is as high as a band.
fn is_local(rows: &Rows, height: usize) -> bool {
    rows.are_shared() && height <= 3 && height < count_levels(rows.cells())
}

/// The rows of blocks of this height in rows of cells.
fn blocks_of(rows: Range<usize>, height: usize) -> Range<usize> {
    if rows.is_empty() { 0..0 } else { rows.start >> height..rows.end.div_ceil(1 << height) }
}

/// The rows of blocks of this height that a rank holds.
fn kept(rows: &Rows, height: usize) -> Range<usize> {
    blocks_of(if is_local(rows, height) { rows.own() } else { 0..rows.cells()[0] }, height)
}

impl Level {
    fn new(rows: &Rows, height: usize, periodic: bool) -> Level {
        let cells = rows.cells().map(|n| n.div_ceil(1 << height));
        let local_blocks = |rank: usize| blocks_of(rows.of(rank), height);
        let halo = if is_local(rows, height) {
            HaloRows::new(rows, local_blocks, cells, periodic)
        } else {
            HaloRows::default()
        };
        let is_gathered = !is_local(rows, height) && (height == 1 || is_local(rows, height - 1));
        let local =
            (rows.are_shared() && is_gathered).then(|| vec![0.0; blocks_of(rows.own(), height).len() * cells[1]]);
        let kept = kept(rows, height);
        let field = vec![0.0; kept.len() * cells[1]];
        Level { height, cells, kept, factor: field.clone(), value: field, halo, local }
    }

    fn blocks(&self) -> Blocks<'_> {
        Blocks { values: &self.value, first: self.kept.start, columns: self.cells[1], halo: &self.halo }
    }

    /// Computes all values by a pass.
    fn compute(&mut self, pass: &Pass<'_>, rows: &Rows, buffers: &mut [RowBuffers]) {
        let Level { height, cells: [_, columns], ref kept, ref mut value, ref mut local, .. } = *self;
        let Some(local) = local else { return compute_rows(pass, buffers, value, kept.start, columns) };
        compute_rows(pass, buffers, local, blocks_of(rows.own(), height).start, columns);
        let count = |rank| columns * blocks_of(rows.of(rank), height).len();
        rows.gather(local.iter().copied(), count, |all| value.copy_from_slice(all));
    }

    /// Multiplies all values by the factor of the attenuation, if it acts on this level.
    fn attenuate(&mut self, attenuation: Option<Attenuation>) {
        if let Some(Attenuation { remains, .. }) = attenuation.filter(|of| of.height() == self.height) {
            self.value.iter_mut().for_each(|value| *value *= remains);
        }
    }

    /// Fetches the halo rows: the values, or their `open` part.
    fn fetch_halo(&mut self, rows: &Rows, exchange: &mut Option<HaloExchange>, open: bool) {
        if let (Some(exchange), true) = (exchange, is_local(rows, self.height)) {
            let Level { cells: [_, columns], ref kept, ref factor, ref value, ref mut halo, .. } = *self;
            exchange.fetch(halo, columns, kept.len(), |row, out| {
                let cells = row * columns..(row + 1) * columns;
                if open {
                    Known::Factors(&factor[cells.clone()]).write_open(&value[cells], out);
                } else {
                    out.copy_from_slice(&value[cells]);
                }
            });
        }
    }
}

impl Extension {
    pub(crate) fn new(rows: &Rows, periodic: [bool; 2], attenuation: Option<Attenuation>) -> Extension {
        let cells = rows.cells();
        let threads = lanes(rows.own().len() * cells[1]).min(rows.own().len()).max(1);
        Extension {
            attenuation,
            periodic,
            levels: (1..=count_levels(cells)).map(|height| Level::new(rows, height, periodic[0])).collect(),
            share: 0.0,
            buffers: vec![RowBuffers::new(cells[1]); threads],
            halo: HaloRows::new(rows, |rank| rows.of(rank), cells, periodic[0]),
            exchange: HaloExchange::new(rows, cells[1]),
            rows: rows.clone(),
        }
    }

    /// Bytes of an extension on the local rows.
    pub(crate) fn bytes(rows: &Rows) -> u128 {
        let [n1, n2] = rows.cells();
        let blocks = |height: usize| kept(rows, height).len() as u128 * n2.div_ceil(1 << height) as u128;
        let threads = lanes(rows.own().len().saturating_mul(n2)).min(rows.own().len());
        16 * (1..=count_levels([n1, n2])).map(blocks).sum::<u128>() + threads as u128 * RowBuffers::bytes(n2)
    }

    /// Builds E for the set of members.
    pub(crate) fn fit(&mut self, member: &[bool]) {
        self.ascend(Operation::SumOnes, &[], member, None);
        let known = self.levels.last().map_or(0.0, |coarsest| coarsest.value[0]);
        self.share = if known > 0.0 { 1.0 / known } else { 0.0 };
    }

    /// Fills all cells outside the set, where `field` is zero, with attenuation.
    pub(crate) fn extend(&mut self, field: &mut [f64], member: &[bool]) {
        self.ascend(Operation::Sum, field, member, None);
        self.descend(Operation::Interpolate, field, member, self.attenuation);
    }

    /// The transpose: moves the values of all cells to the set, and leaves zero elsewhere. The unbounded one keeps
    /// the sum.
    pub(crate) fn gather(&mut self, field: &mut [f64], member: &[bool], kind: ExtensionKind) {
        let attenuation = self.attenuation.filter(|_| kind == ExtensionKind::Attenuated);
        self.ascend(Operation::Restrict, field, member, attenuation);
        self.descend(Operation::Repeat, field, member, None);
    }

    /// Computes S from level to level; with the factors φ, if the field is 1 on the set.
    fn ascend(&mut self, operation: Operation, field: &[f64], member: &[bool], attenuation: Option<Attenuation>) {
        let Extension { ref rows, periodic, ref mut levels, ref mut buffers, ref mut halo, ref mut exchange, .. } =
            *self;
        let columns = rows.cells()[1];
        if let (Operation::Restrict, Some(exchange)) = (operation, &mut *exchange) {
            exchange.fetch(halo, columns, rows.own().len(), |row, out| {
                let cells = row * columns..(row + 1) * columns;
                Known::Members(&member[cells.clone()]).write_open(&field[cells], out);
            });
        }
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let level = &mut level[0];
            let first = rows.own().start;
            let (read, known, fine) = match finer.last() {
                None => (Blocks { values: field, first, columns, halo }, Known::Members(member), rows.cells()),
                Some(finer) => (finer.blocks(), Known::Factors(&finer.factor), finer.cells),
            };
            let pass = Pass { operation, read, known, first: read.first, fine, periodic };
            level.compute(&pass, rows, buffers);
            if operation == Operation::SumOnes {
                let factors = level.factor.iter_mut().zip(&level.value);
                factors.for_each(|(factor, &sum)| *factor = TRUST / (4.0 + (TRUST - 1.0) * sum));
            }
            if operation == Operation::Restrict {
                level.attenuate(attenuation);
                level.fetch_halo(rows, exchange, true);
            }
        }
    }

    /// Computes x from level to level, down to the cells.
    fn descend(&mut self, operation: Operation, field: &mut [f64], member: &[bool], attenuation: Option<Attenuation>) {
        let Extension { ref rows, periodic, ref mut levels, share, ref mut buffers, ref mut exchange, .. } = *self;
        levels.last_mut().into_iter().for_each(|coarsest| coarsest.value[0] *= share);
        for l in (0..levels.len()).rev() {
            let (finer, coarser) = levels.split_at_mut(l);
            let coarser = &mut coarser[0];
            coarser.attenuate(attenuation);
            if operation == Operation::Interpolate {
                coarser.fetch_halo(rows, exchange, false);
            }
            let (values, known, first, fine) = match finer.last_mut() {
                None => (&mut *field, Known::Members(member), rows.own().start, rows.cells()),
                Some(Level { cells, kept, factor, value, .. }) => {
                    (&mut value[..], Known::Factors(factor), kept.start, *cells)
                }
            };
            let pass = Pass { operation, read: coarser.blocks(), known, first, fine, periodic };
            compute_rows(&pass, buffers, values, first, fine[1]);
        }
    }
}

/// Computes rows of a level from the `first` on by a pass, each thread some of them.
fn compute_rows(pass: &Pass<'_>, buffers: &mut [RowBuffers], values: &mut [f64], first: usize, columns: usize) {
    let threads = buffers.len().min(lanes(values.len()));
    let share = (values.len() / columns).div_ceil(threads).max(1);
    for_each_share(&SharedRows { pass, first, columns }, &mut buffers[..threads], values, share * columns);
}
