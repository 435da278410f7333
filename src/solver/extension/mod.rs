//! The smooth extension of a field from the contact to all cells, and its transpose.

mod neighbours;
mod passes;

#[cfg(test)]
mod tests;

use std::ops;

use crate::parallel::Rows;
use crate::parallel::{Task, for_each_share, lanes};
pub(crate) use crate::solver::extension::neighbours::{Ghosts, HaloExchange};
use crate::solver::extension::passes::{Blocks, Known, Pull, Push, Restrict, RowBuffers, Spread, Values, weight};

/// κ: how far the mean of a block of cells is trusted, of which only the share s is known, w = κ s/(1 + (κ − 1) s).
const TRUST: f64 = 1.5;

/// E: from the cells of a set A to all cells, by means over blocks of 2 × 2 cells, over blocks of such blocks and so on, and
/// bilinear interpolation back (a push–pull pyramid),
///
/// x_l = w_l m_l + (1 − w_l) up(x_(l+1)),  m_(l+1) = Σ w_l m_l / Σ w_l over the block,  w_(l+1) = κ s/(1 + (κ − 1) s),
///
/// where s is the mean of w_l over the block, and w_0 is 1 on A and 0 elsewhere; x = m on the coarsest level, a single block. E
/// reproduces constants. Its transpose brings what all cells hold to A, and keeps the sum.
/// Blocks hold the sums S = Σ w m over what they consist of, and the factor φ = κ/(4 + 4 (κ − 1) s), in which everything is
/// linear: w m = φ S, and w = (κ − 4 φ)/(κ − 1).
///
/// An [`Attenuation`] multiplies x of one level before the next finer one is made of it: near A everything remains, and far away little.
///
/// Axes that are not periodic are mirrored at their ends, which is what they are on the parts that symmetry leaves of a grid.
///
/// Every row of a level is computed from finished rows of another one: threads share the rows, and the result does not depend on
/// their number.
///
/// Where ranks share out the cells, their bands are whole rows of blocks of 16 × 16 cells. Blocks of 2 × 2, 4 × 4 and 8 × 8 are
/// they hold the local rows, and a halo row where a pass needs it. Larger ones, a 256th as many numbers as
/// there are cells, are gathered, and every rank computes all of them.
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
    /// Number of levels of which only own rows are kept.
    local: usize,
    /// Own blocks of the first level that is gathered.
    own: Vec<f64>,
    /// The halo rows of the cells.
    ghosts: Ghosts,
    neighbours: Option<HaloExchange>,
    /// Where E ebbs, the level of the blocks from which it does, and what remains.
    ebb: Option<(usize, f64)>,
}

/// How far a field is continued, and what of it remains beyond.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attenuation {
    /// In cells.
    pub(crate) reach: f64,
    /// Negative for a change of sign.
    pub(crate) remains: f64,
}

/// Which of two extensions: that which ebbs, or that which reproduces constants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Range {
    Attenuated,
    Unbounded,
}

/// Blocks of cells.
#[derive(Debug, Clone)]
struct Level {
    /// Of all ranks.
    cells: [usize; 2],
    /// The rows that are kept.
    kept: ops::Range<usize>,
    /// φ.
    factor: Vec<f64>,
    /// S, then x.
    value: Vec<f64>,
    /// The rows beside those kept.
    ghosts: Ghosts,
}

/// Most levels of which a rank keeps own rows alone: the next one has blocks as high as a band.
const MOST_LOCAL: usize = 3;

impl Level {
    fn blocks(&self) -> Blocks<'_> {
        Blocks { values: &self.value, first: self.kept.start, columns: self.cells[1], ghosts: &self.ghosts }
    }
}

impl Extension {
    pub(crate) fn new(rows: &Rows, periodic: [bool; 2], ebb: Option<Attenuation>) -> Extension {
        let cells = rows.cells();
        let local = if rows.are_shared() { MOST_LOCAL.min(sizes(cells).count().saturating_sub(1)) } else { 0 };
        let level = |(height, size): (usize, [usize; 2])| {
            let of = |rank: usize| blocks_of(rows.of(rank), height);
            let (kept, ghosts) = if height <= local {
                (blocks_of(rows.own(), height), Ghosts::beside(rows, of, size, periodic[0]))
            } else {
                (0..size[0], Ghosts::default())
            };
            let field = vec![0.0; kept.len() * size[1]];
            Level { cells: size, kept, factor: field.clone(), value: field, ghosts }
        };
        let levels: Vec<Level> = (1..).zip(sizes(cells)).map(level).collect();
        let own = match levels.get(local) {
            Some(gathered) if rows.are_shared() => blocks_of(rows.own(), local + 1).len() * gathered.cells[1],
            _ => 0,
        };
        let threads = lanes(rows.own().len() * cells[1]).min(rows.own().len()).max(1);
        // blocks of 2^(level + 1) cells that are no longer than the reach
        let from = |reach: f64| (reach.log2() as usize).max(1) - 1;
        Extension {
            ebb: ebb.map(|ebb| (from(ebb.reach), ebb.remains)),
            periodic,
            levels,
            share: 0.0,
            buffers: vec![RowBuffers::new(cells[1]); threads],
            local,
            own: vec![0.0; own],
            ghosts: Ghosts::beside(rows, |rank| rows.of(rank), cells, periodic[0]),
            neighbours: HaloExchange::new(rows, cells[1]),
            rows: rows.clone(),
        }
    }

    /// Bytes that it takes: of own rows, and of all where they are gathered.
    pub(crate) fn bytes(rows: &Rows) -> u128 {
        let cells = rows.cells();
        let own = |(height, size): (usize, [usize; 2])| {
            let kept =
                if rows.are_shared() && height <= MOST_LOCAL { blocks_of(rows.own(), height).len() } else { size[0] };
            kept as u128 * size[1] as u128
        };
        let blocks: u128 = (1..).zip(sizes(cells)).map(own).sum();
        let threads = lanes(rows.own().len().saturating_mul(cells[1])).min(rows.own().len());
        16 * blocks + threads as u128 * RowBuffers::bytes(cells[1])
    }

    /// Builds E for the set of members.
    pub(crate) fn fit(&mut self, member: &[bool]) {
        // the values are Σ w here, the sums of a field of ones
        self.push(Values::Members(member), |level| {
            let factors = level.factor.iter_mut().zip(&level.value);
            factors.for_each(|(factor, &sum)| *factor = TRUST / (4.0 + (TRUST - 1.0) * sum));
        });
        let known = self.levels.last().map_or(0.0, |coarsest| coarsest.value[0]);
        self.share = if known > 0.0 { 1.0 / known } else { 0.0 };
    }

    /// Fills all cells outside the set, where `field` is zero, ebbing.
    pub(crate) fn extend(&mut self, field: &mut [f64], member: &[bool]) {
        self.push(Values::Field(field), |_| ());
        let periodic = self.periodic;
        self.descend(field, member, true, self.ebb, |blocks, known, fine, first, buffers, values| {
            run(&Pull { blocks, known, fine, first, periodic }, buffers, values, first, fine[1]);
        });
    }

    /// The transpose: what all cells hold is brought to the set, and `field` is zero elsewhere. The endless one keeps the sum.
    pub(crate) fn gather(&mut self, field: &mut [f64], member: &[bool], range: Range) {
        let ebb = self.ebb.filter(|_| range == Range::Attenuated);
        let Extension { rows, periodic, levels, buffers, local, own, ghosts, neighbours, .. } = self;
        let columns = rows.cells()[1];
        if let Some(neighbours) = neighbours {
            neighbours.fetch(ghosts, columns, rows.own().len(), |row, out| {
                let open = field[row * columns..].iter().zip(&member[row * columns..]);
                out.iter_mut().zip(open).for_each(|(out, (&f, &inside))| *out = if inside { 0.0 } else { f });
            });
        }
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let (values, known, fine) = match finer.last() {
                None => {
                    let values = Blocks { values: field, first: rows.own().start, columns, ghosts };
                    (values, Known::Members(member), rows.cells())
                }
                Some(finer) => (finer.blocks(), Known::Factors(&finer.factor), finer.cells),
            };
            raise(
                &Restrict { values, known, fine, periodic: *periodic },
                rows,
                buffers,
                (l == *local).then_some(l + 1),
                own,
                &mut level[0],
            );
            fade(ebb, l, &mut level[0].value);
            if let (true, Some(neighbours)) = (l < *local, neighbours.as_mut()) {
                let Level { cells: [_, columns], kept, factor, value, ghosts } = &mut level[0];
                neighbours.fetch(ghosts, *columns, kept.len(), |row, out| {
                    let blocks = value[row * *columns..].iter().zip(&factor[row * *columns..]);
                    out.iter_mut().zip(blocks).for_each(|(out, (&f, &factor))| *out = (1.0 - weight(factor)) * f);
                });
            }
        }
        self.descend(field, member, false, None, |blocks, known, fine, first, buffers, values| {
            run(&Spread { blocks, known, fine, first }, buffers, values, first, fine[1]);
        });
    }

    /// Finds S level by level, and calls `finish` with each of them.
    fn push(&mut self, values: Values<'_>, finish: impl Fn(&mut Level)) {
        let Extension { rows, levels, buffers, local, own, .. } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let (values, fine, first) = match finer.last() {
                None => (values, rows.cells(), rows.own().start),
                Some(Level { cells, kept, factor, value, .. }) => (Values::Weighted(value, factor), *cells, kept.start),
            };
            raise(&Push { values, fine, first }, rows, buffers, (l == *local).then_some(l + 1), own, &mut level[0]);
            finish(&mut level[0]);
        }
    }

    /// From the coarsest level down to the cells: calls `pass` with the blocks of a level, what is known of the next finer one,
    /// the size of that and the first row kept of it, row buffers and its values. A `smooth` pass needs blocks beside, too.
    fn descend(
        &mut self,
        field: &mut [f64],
        member: &[bool],
        smooth: bool,
        ebb: Option<(usize, f64)>,
        pass: impl Fn(Blocks<'_>, Known<'_>, [usize; 2], usize, &mut [RowBuffers], &mut [f64]),
    ) {
        let Extension { rows, levels, share, buffers, local, neighbours, .. } = self;
        let Some(coarsest) = levels.last_mut() else { return };
        coarsest.value[0] *= *share;
        // what remains of a level, and the halo rows of the levels that are kept
        let mut finish = |level: &mut Level, l: usize| {
            fade(ebb, l, &mut level.value);
            if let (true, Some(neighbours)) = (smooth && l < *local, neighbours.as_mut()) {
                let Level { cells: [_, columns], kept, value, ghosts, .. } = level;
                neighbours.fetch(ghosts, *columns, kept.len(), |row, out| {
                    out.copy_from_slice(&value[row * *columns..][..*columns]);
                });
            }
        };
        for l in (1..levels.len()).rev() {
            let (finer, coarser) = levels.split_at_mut(l);
            finish(&mut coarser[0], l);
            let Level { cells, kept, factor, value, .. } = &mut finer[l - 1];
            pass(coarser[0].blocks(), Known::Factors(factor), *cells, kept.start, buffers, value);
        }
        finish(&mut levels[0], 0);
        pass(levels[0].blocks(), Known::Members(member), rows.cells(), rows.own().start, buffers, field);
    }
}

/// Leaves what remains of the values of the level from which an extension ebbs.
fn fade(ebb: Option<(usize, f64)>, level: usize, values: &mut [f64]) {
    if let Some((from, remains)) = ebb
        && from == level
    {
        values.iter_mut().for_each(|value| *value *= remains);
    }
}

/// The sizes of all levels.
fn sizes(cells: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    let coarser = |size: &[usize; 2]| (*size != [1, 1]).then(|| size.map(|n| n.div_ceil(2)));
    std::iter::successors(coarser(&cells), coarser)
}

/// The rows of blocks of 2^`height` cells that rows of cells consist of.
fn blocks_of(rows: ops::Range<usize>, height: usize) -> ops::Range<usize> {
    if rows.is_empty() { 0..0 } else { rows.start >> height..rows.end.div_ceil(1 << height) }
}

/// Runs a pass from a level to the next one; where blocks of this height are to be `gathered`, on own rows.
fn raise<T: Task<Lane = RowBuffers, Item = f64> + Sync>(
    task: &T,
    rows: &Rows,
    buffers: &mut [RowBuffers],
    gathered: Option<usize>,
    own: &mut [f64],
    level: &mut Level,
) {
    let columns = level.cells[1];
    let Some(height) = gathered.filter(|_| rows.are_shared()) else {
        return run(task, buffers, &mut level.value, level.kept.start, columns);
    };
    let of = |rank: usize| blocks_of(rows.of(rank), height);
    let first = of(rows.rank()).start;
    run(task, buffers, own, first, columns);
    rows.gather_rows(own, &mut level.value, |rank| columns * of(rank).len());
}

/// Runs a pass over rows of a level from the `first` on, each thread with some of them.
fn run<T: Task<Lane = RowBuffers, Item = f64> + Sync>(
    task: &T,
    buffers: &mut [RowBuffers],
    values: &mut [f64],
    first: usize,
    columns: usize,
) {
    let threads = buffers.len().min(lanes(values.len()));
    let share = (values.len() / columns).div_ceil(threads).max(1);
    for (k, rows) in buffers.iter_mut().enumerate() {
        rows.first = first + k * share;
    }
    for_each_share(task, &mut buffers[..threads], values, share * columns);
}
