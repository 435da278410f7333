//! The smooth extension of a field from the contact to all cells, and its transpose.

mod passes;

#[cfg(test)]
mod tests;

use crate::kernel::{Task, for_each_share, lanes};
use crate::solver::extension::passes::{Known, Pull, Push, Restrict, Rows, Spread, Values};

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
/// An [`Ebb`] multiplies x of one level before the next finer one is made of it: near A everything remains, and far away little.
///
/// Axes that are not periodic are mirrored at their ends, which is what they are on the parts that symmetry leaves of a grid.
///
/// Every row of a level is computed from finished rows of another one: threads share the rows, and the answer does not depend on
/// their number.
#[derive(Debug, Clone)]
pub(crate) struct Extension {
    cells: [usize; 2],
    periodic: [bool; 2],
    levels: Vec<Level>,
    /// 1/Σ w over the coarsest block, 0 if nothing is known.
    share: f64,
    /// Row buffers, one set per thread.
    rows: Vec<Rows>,
    /// Where E ebbs, the level of the blocks from which it does, and what remains.
    ebb: Option<(usize, f64)>,
}

/// How far a field is continued, and what of it remains beyond.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ebb {
    /// In cells.
    pub(crate) reach: f64,
    /// Negative for a change of sign.
    pub(crate) remains: f64,
}

/// Which of two extensions: that which ebbs, or that which reproduces constants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Range {
    Ebbing,
    Endless,
}

/// Blocks of cells.
#[derive(Debug, Clone)]
struct Level {
    cells: [usize; 2],
    /// φ.
    factor: Vec<f64>,
    /// S, then x.
    value: Vec<f64>,
}

impl Extension {
    pub(crate) fn new(cells: [usize; 2], periodic: [bool; 2], ebb: Option<Ebb>) -> Extension {
        let mut levels = Vec::new();
        let mut size = cells;
        while size != [1, 1] {
            size = size.map(|n| n.div_ceil(2));
            let field = vec![0.0; size[0] * size[1]];
            levels.push(Level { cells: size, factor: field.clone(), value: field });
        }
        let rows = vec![Rows::new(cells[1]); lanes(cells[0] * cells[1]).min(cells[0])];
        // blocks of 2^(level + 1) cells that are no longer than the reach
        let level = |reach: f64| (reach.log2() as usize).max(1) - 1;
        let ebb = ebb.map(|ebb| (level(ebb.reach), ebb.remains));
        Extension { cells, periodic, levels, share: 0.0, rows, ebb }
    }

    /// Bytes that it takes.
    pub(crate) fn bytes(cells: [usize; 2]) -> u128 {
        let (mut size, mut blocks) = (cells, 0);
        while size != [1, 1] {
            size = size.map(|n| n.div_ceil(2));
            blocks += size[0] as u128 * size[1] as u128;
        }
        let threads = lanes(cells[0].saturating_mul(cells[1])).min(cells[0]);
        16 * blocks + threads as u128 * Rows::bytes(cells[1])
    }

    /// Makes E that of the set of members.
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
        self.descend(field, member, self.ebb, |blocks, known, fine, rows, values| {
            run(&Pull { blocks, known, fine, periodic }, rows, values, fine);
        });
    }

    /// The transpose: what all cells hold is brought to the set, and `field` is zero elsewhere. The endless one keeps the sum.
    pub(crate) fn gather(&mut self, field: &mut [f64], member: &[bool], range: Range) {
        let ebb = self.ebb.filter(|_| range == Range::Ebbing);
        let Extension { cells, periodic, levels, rows, .. } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let (values, known, fine) = match finer.last() {
                None => (&*field, Known::Members(member), *cells),
                Some(Level { cells, factor, value }) => (&value[..], Known::Factors(factor), *cells),
            };
            let restrict = Restrict { values, known, fine, periodic: *periodic };
            run(&restrict, rows, &mut level[0].value, level[0].cells);
            fade(ebb, l, &mut level[0].value);
        }
        self.descend(field, member, None, |blocks, known, fine, rows, values| {
            run(&Spread { blocks, known, fine }, rows, values, fine);
        });
    }

    /// Finds S level by level, and calls `finish` with each of them.
    fn push(&mut self, values: Values<'_>, finish: impl Fn(&mut Level)) {
        let Extension { cells, levels, rows, .. } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let (values, fine) = match finer.last() {
                None => (values, *cells),
                Some(Level { cells, factor, value }) => (Values::Weighted(value, factor), *cells),
            };
            run(&Push { values, fine }, rows, &mut level[0].value, level[0].cells);
            finish(&mut level[0]);
        }
    }

    /// From the coarsest level down to the cells: calls `pass` with the blocks of a level, what is known of the next finer one,
    /// the size of that, row buffers and its values.
    fn descend(
        &mut self,
        field: &mut [f64],
        member: &[bool],
        ebb: Option<(usize, f64)>,
        pass: impl Fn(&[f64], Known<'_>, [usize; 2], &mut [Rows], &mut [f64]),
    ) {
        let Extension { cells, levels, share, rows, .. } = self;
        let Some(coarsest) = levels.last_mut() else { return };
        coarsest.value[0] *= *share;
        for l in (1..levels.len()).rev() {
            let (finer, coarser) = levels.split_at_mut(l);
            fade(ebb, l, &mut coarser[0].value);
            let Level { cells, factor, value } = &mut finer[l - 1];
            pass(&coarser[0].value, Known::Factors(factor), *cells, rows, value);
        }
        fade(ebb, 0, &mut levels[0].value);
        pass(&levels[0].value, Known::Members(member), *cells, rows, field);
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

/// Runs a pass over the rows of a level, each thread with some of them.
fn run<T: Task<Lane = Rows, Item = f64> + Sync>(task: &T, rows: &mut [Rows], values: &mut [f64], [n1, n2]: [usize; 2]) {
    let threads = rows.len().min(lanes(n1 * n2));
    let share = n1.div_ceil(threads);
    for (k, rows) in rows.iter_mut().enumerate() {
        rows.first = k * share;
    }
    for_each_share(task, &mut rows[..threads], values, share * n2);
}
