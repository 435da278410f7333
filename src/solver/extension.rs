//! The smooth extension of a field from the contact to all cells, and its transpose.

use pulp::Arch;

/// κ: how far the mean of a block of cells is trusted, of which only the share s is known, w = κ s/(1 + (κ − 1) s).
const TRUST: f64 = 1.5;

/// E: from the cells of a set A to all cells, by means over blocks of 2 × 2 cells, over blocks of such blocks and so on, and
/// bilinear interpolation back (a push–pull pyramid),
///
/// x_l = w_l m_l + (1 − w_l) up(x_(l+1)),  m_(l+1) = Σ w_l m_l / Σ w_l over the block,  w_(l+1) = κ s/(1 + (κ − 1) s),
///
/// where s is the mean of w_l over the block, and w_0 is 1 on A and 0 elsewhere. The coarsest weight is 1, so that constants are
/// reproduced. Its transpose brings what all cells hold to A, and keeps the sum.
///
/// Axes that are not periodic are mirrored at their ends, which is what they are on the parts that symmetry leaves of a grid.
#[derive(Debug, Clone)]
pub(crate) struct Extension {
    cells: [usize; 2],
    periodic: [bool; 2],
    levels: Vec<Level>,
    /// One row of a level while it is interpolated.
    row: Vec<f64>,
}

/// Blocks of cells.
#[derive(Debug, Clone)]
struct Level {
    cells: [usize; 2],
    /// w_l.
    weight: Vec<f64>,
    /// 1/Σ w of the blocks that each block is made of, 0 where none is known.
    share: Vec<f64>,
    /// m_l, then x_l.
    value: Vec<f64>,
}

impl Extension {
    pub(crate) fn new(cells: [usize; 2], periodic: [bool; 2]) -> Extension {
        let mut levels = Vec::new();
        let mut size = cells;
        while size != [1, 1] {
            size = size.map(|n| n.div_ceil(2));
            let field = vec![0.0; size[0] * size[1]];
            levels.push(Level { cells: size, weight: field.clone(), share: field.clone(), value: field });
        }
        Extension { cells, periodic, levels, row: vec![0.0; 2 * cells[1] + 8] }
    }

    /// Bytes that it takes.
    pub(crate) fn bytes(cells: [usize; 2]) -> u128 {
        let (mut size, mut blocks) = (cells, 0);
        while size != [1, 1] {
            size = size.map(|n| n.div_ceil(2));
            blocks += size[0] as u128 * size[1] as u128;
        }
        8 * (3 * blocks + 2 * cells[1] as u128 + 8)
    }

    /// Makes E that of the set of members.
    pub(crate) fn fit(&mut self, member: &[bool]) {
        Arch::new().dispatch(
            #[inline(always)]
            || self.find_weights(member),
        );
    }

    /// Fills all cells outside the set, where `field` is zero.
    pub(crate) fn extend(&mut self, field: &mut [f64], member: &[bool]) {
        Arch::new().dispatch(
            #[inline(always)]
            || self.push_and_pull(field, member),
        );
    }

    /// The transpose: what all cells hold is brought to the set, and `field` is zero elsewhere.
    pub(crate) fn gather(&mut self, field: &mut [f64], member: &[bool]) {
        Arch::new().dispatch(
            #[inline(always)]
            || self.transpose(field, member),
        );
    }

    #[inline(always)]
    fn find_weights(&mut self, member: &[bool]) {
        let Extension { cells, levels, .. } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let level = &mut level[0];
            let [m1, m2] = level.cells;
            for i in 0..m1 {
                let sums = &mut level.share[i * m2..][..m2];
                sums.fill(0.0);
                match finer.last() {
                    None => rows_of(i, *cells, member).for_each(|row| {
                        add_pairs(
                            sums,
                            row,
                            #[inline(always)]
                            |&m| f64::from(u8::from(m)),
                        )
                    }),
                    Some(fine) => rows_of(i, fine.cells, &fine.weight).for_each(|row| {
                        add_pairs(
                            sums,
                            row,
                            #[inline(always)]
                            |&w| w,
                        )
                    }),
                }
                for (share, weight) in sums.iter_mut().zip(&mut level.weight[i * m2..]) {
                    let s = 0.25 * *share;
                    *weight = TRUST * s / (1.0 + (TRUST - 1.0) * s);
                    *share = if *share > 0.0 { 1.0 / *share } else { 0.0 };
                }
            }
        }
        if let Some(coarsest) = levels.last_mut() {
            coarsest.weight[0] = 1.0;
        }
    }

    #[inline(always)]
    fn push_and_pull(&mut self, field: &mut [f64], member: &[bool]) {
        let Extension { cells, periodic, levels, row } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let Level { cells: [m1, m2], share, value, .. } = &mut level[0];
            for i in 0..*m1 {
                let out = &mut value[i * *m2..][..*m2];
                out.fill(0.0);
                match finer.last() {
                    None => rows_of(i, *cells, field).for_each(|row| {
                        add_pairs(
                            out,
                            row,
                            #[inline(always)]
                            |&f| f,
                        )
                    }),
                    Some(fine) => {
                        let rows = rows_of(i, fine.cells, &fine.value).zip(rows_of(i, fine.cells, &fine.weight));
                        rows.for_each(|(values, weights)| add_weighted_pairs(out, values, weights));
                    }
                }
                out.iter_mut().zip(&share[i * *m2..]).for_each(|(out, &share)| *out *= share);
            }
        }
        for l in (1..levels.len()).rev() {
            let (finer, coarser) = levels.split_at_mut(l);
            let Level { cells, weight, value, .. } = &mut finer[l - 1];
            let n2 = cells[1];
            for i in 0..cells[0] {
                let up = interpolate(&coarser[0], i, *periodic, row);
                for ((x, &w), &up) in value[i * n2..][..n2].iter_mut().zip(&weight[i * n2..]).zip(up) {
                    *x = w * *x + (1.0 - w) * up;
                }
            }
        }
        let Some(finest) = levels.first() else { return };
        let n2 = cells[1];
        for i in 0..cells[0] {
            let up = interpolate(finest, i, *periodic, row);
            for ((x, &inside), &up) in field[i * n2..][..n2].iter_mut().zip(&member[i * n2..]).zip(up) {
                *x = if inside { *x } else { up };
            }
        }
    }

    #[inline(always)]
    fn transpose(&mut self, field: &mut [f64], member: &[bool]) {
        let Extension { cells, periodic, levels, row } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let level = &mut level[0];
            match finer.last_mut() {
                None => spread(
                    level,
                    *cells,
                    *periodic,
                    row,
                    #[inline(always)]
                    |range, factor, out| {
                        for ((out, &f), &inside) in out.iter_mut().zip(&field[range.clone()]).zip(&member[range]) {
                            *out += if inside { 0.0 } else { factor * f };
                        }
                    },
                ),
                Some(Level { cells, weight, value, .. }) => {
                    spread(
                        level,
                        *cells,
                        *periodic,
                        row,
                        #[inline(always)]
                        |range, factor, out| {
                            for ((out, &f), &w) in out.iter_mut().zip(&value[range.clone()]).zip(&weight[range]) {
                                *out += factor * (1.0 - w) * f;
                            }
                        },
                    );
                    value.iter_mut().zip(&*weight).for_each(|(value, &w)| *value *= w);
                }
            }
        }
        for l in (1..levels.len()).rev() {
            let (finer, coarser) = levels.split_at_mut(l);
            let Level { cells: [n1, n2], weight, value, .. } = &mut finer[l - 1];
            for i in 0..*n1 {
                let (out, weights) = (&mut value[i * *n2..][..*n2], &weight[i * *n2..][..*n2]);
                add_shares(
                    &coarser[0],
                    i,
                    out,
                    #[inline(always)]
                    |j, f, x| f + weights[j] * x,
                );
            }
        }
        let Some(finest) = levels.first() else { return };
        let [n1, n2] = *cells;
        for i in 0..n1 {
            let (out, inside) = (&mut field[i * n2..][..n2], &member[i * n2..][..n2]);
            add_shares(
                finest,
                i,
                out,
                #[inline(always)]
                |j, f, x| if inside[j] { f + x } else { 0.0 },
            );
        }
    }
}

/// The rows of a finer level that row `i` of blocks covers.
#[inline(always)]
fn rows_of<T>(i: usize, [n1, n2]: [usize; 2], field: &[T]) -> impl Iterator<Item = &[T]> {
    field[2 * i * n2..(2 * i + 2).min(n1) * n2].chunks_exact(n2)
}

/// Adds pairs of values to each block.
#[inline(always)]
fn add_pairs<T>(out: &mut [f64], row: &[T], value: impl Fn(&T) -> f64) {
    let (pairs, rest) = row.as_chunks::<2>();
    out.iter_mut().zip(pairs).for_each(|(out, [a, b])| *out += value(a) + value(b));
    if let ([last], Some(out)) = (rest, out.last_mut()) {
        *out += value(last);
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

/// Row `i` of the finer level, interpolated from a level: 9/16 of the block, 3/16 of two neighbours and 1/16 of the third.
#[inline(always)]
fn interpolate<'a>(level: &Level, i: usize, periodic: [bool; 2], row: &'a mut [f64]) -> &'a [f64] {
    let [m1, m2] = level.cells;
    let near = i / 2;
    let far = match (i % 2, periodic[0]) {
        (0, true) => (near + m1 - 1) % m1,
        (0, false) => near.saturating_sub(1),
        (_, true) => (near + 1) % m1,
        (_, false) => (near + 1).min(m1 - 1),
    };
    let (across, fine) = row.split_at_mut(m2 + 2);
    let (near, far) = (&level.value[near * m2..][..m2], &level.value[far * m2..][..m2]);
    for ((a, &near), &far) in across[1..=m2].iter_mut().zip(near).zip(far) {
        *a = 0.75 * near + 0.25 * far;
    }
    let [before, after] = if periodic[1] { [m2, 1] } else { [1, m2] };
    (across[0], across[m2 + 1]) = (across[before], across[after]);
    let (a, b, c) = (&across[..m2], &across[1..][..m2], &across[2..][..m2]);
    let fine = &mut fine[..2 * m2];
    for (((pair, a), b), c) in fine.as_chunks_mut::<2>().0.iter_mut().zip(a).zip(b).zip(c) {
        *pair = [0.75 * b + 0.25 * a, 0.75 * b + 0.25 * c];
    }
    fine
}

/// The transpose of [`interpolate`] for all rows: `add` adds a multiple of a range of the finer level.
#[inline(always)]
fn spread(
    level: &mut Level,
    [n1, n2]: [usize; 2],
    periodic: [bool; 2],
    row: &mut [f64],
    add: impl Fn(std::ops::Range<usize>, f64, &mut [f64]),
) {
    let [m1, m2] = level.cells;
    // the fine row, a pair before it and a pair after it
    let row = &mut row[..2 * m2 + 4];
    let ends = if periodic[0] { [2 * m1 - 1, 0] } else { [0, 2 * m1 - 1] };
    for j in 0..m1 {
        row.fill(0.0);
        let before = if j > 0 { 2 * j - 1 } else { ends[0] };
        let after = if j + 1 < m1 { 2 * j + 2 } else { ends[1] };
        for (i, factor) in [(2 * j, 0.75), (2 * j + 1, 0.75), (before, 0.25), (after, 0.25)] {
            if i < n1 {
                add(i * n2..(i + 1) * n2, factor, &mut row[2..n2 + 2]);
            }
        }
        let [first, last] = [row[2], row[2 * m2 + 1]];
        let out = &mut level.value[j * m2..][..m2];
        let pairs = row.as_chunks::<2>().0;
        let (a, b, c) = (&pairs[..m2], &pairs[1..][..m2], &pairs[2..][..m2]);
        for (((out, a), b), c) in out.iter_mut().zip(a).zip(b).zip(c) {
            *out = 0.75 * (b[0] + b[1]) + 0.25 * (a[1] + c[0]);
        }
        let [at_first, at_last] = if periodic[1] { [m2 - 1, 0] } else { [0, m2 - 1] };
        out[at_first] += 0.25 * first;
        out[at_last] += 0.25 * last;
    }
}

/// Adds to row `i` of the finer level what its blocks hold, each cell its share.
#[inline(always)]
fn add_shares(level: &Level, i: usize, out: &mut [f64], add: impl Fn(usize, f64, f64) -> f64) {
    let m2 = level.cells[1];
    let at = i / 2 * m2;
    let blocks = level.value[at..][..m2].iter().zip(&level.share[at..]);
    for (j, (pair, (&value, &share))) in out.chunks_mut(2).zip(blocks).enumerate() {
        let x = value * share;
        pair.iter_mut().enumerate().for_each(|(k, f)| *f = add(2 * j + k, *f, x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    /// E as its definition says, cell by cell.
    fn dense(member: &[bool], values: &[f64], cells: [usize; 2], periodic: [bool; 2]) -> Vec<f64> {
        pull(&member.iter().map(|&m| f64::from(u8::from(m))).collect::<Vec<_>>(), values, cells, periodic)
    }

    fn pull(weight: &[f64], mean: &[f64], [n1, n2]: [usize; 2], periodic: [bool; 2]) -> Vec<f64> {
        if [n1, n2] == [1, 1] {
            return mean.to_vec();
        }
        let [m1, m2] = [n1.div_ceil(2), n2.div_ceil(2)];
        let (mut sums, mut weights) = (vec![0.0; m1 * m2], vec![0.0; m1 * m2]);
        for k in 0..n1 * n2 {
            let block = k / n2 / 2 * m2 + k % n2 / 2;
            sums[block] += weight[k] * mean[k];
            weights[block] += weight[k];
        }
        let means: Vec<f64> = sums.iter().zip(&weights).map(|(s, w)| if *w > 0.0 { s / w } else { 0.0 }).collect();
        let trusts: Vec<f64> = weights.iter().map(|w| TRUST * 0.25 * w / (1.0 + (TRUST - 1.0) * 0.25 * w)).collect();
        let coarse = pull(&trusts, &means, [m1, m2], periodic);
        let along = |k: usize, m: usize, periodic: bool| {
            let side = if k.is_multiple_of(2) { -1 } else { 1 };
            let far = (k / 2) as isize + side;
            let far = if periodic { far.rem_euclid(m as isize) } else { far.clamp(0, m as isize - 1) };
            [(k / 2, 0.75), (far as usize, 0.25)]
        };
        let value = |k: usize| {
            let mut up = 0.0;
            for (i, a) in along(k / n2, m1, periodic[0]) {
                up += along(k % n2, m2, periodic[1]).map(|(j, b)| a * b * coarse[i * m2 + j]).iter().sum::<f64>();
            }
            weight[k] * mean[k] + (1.0 - weight[k]) * up
        };
        (0..n1 * n2).map(value).collect()
    }

    #[test]
    fn it_is_what_its_definition_says_and_has_an_exact_transpose() {
        let mut seed = 1;
        let sizes = [[16, 16], [13, 31], [20, 9], [32, 32], [1, 17], [17, 1], [1, 1], [2, 3], [64, 5]];
        for cells in sizes {
            for periodic in [[true; 2], [false; 2], [true, false], [false, true]] {
                for share in [0.02, 0.3, 0.9, 1.0] {
                    check(cells, periodic, share, &mut seed);
                }
            }
        }
    }

    fn check(cells: [usize; 2], periodic: [bool; 2], share: f64, seed: &mut u64) {
        let count = cells[0] * cells[1];
        let mut member: Vec<bool> = (0..count).map(|_| noise(seed) + 0.5 < share).collect();
        member[count / 2] = true;
        let mut extension = Extension::new(cells, periodic);
        extension.fit(&member);
        let only = |value: &mut dyn FnMut() -> f64| -> Vec<f64> {
            member.iter().map(|&m| if m { value() } else { 0.0 }).collect()
        };
        let mut ones = only(&mut || 1.0);
        extension.extend(&mut ones, &member);
        assert!(ones.iter().all(|x| (x - 1.0).abs() < 1e-14), "constants are reproduced");

        let values = only(&mut || noise(seed));
        let mut extended = values.clone();
        extension.extend(&mut extended, &member);
        let expected = dense(&member, &values, cells, periodic);
        for (k, (a, b)) in extended.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() < 1e-14, "{cells:?} {periodic:?}: {a} instead of {b} at {k}");
        }
        let field: Vec<f64> = (0..count).map(|_| noise(seed)).collect();
        let mut gathered = field.clone();
        extension.gather(&mut gathered, &member);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let [there, back] = [dot(&extended, &field), dot(&values, &gathered)];
        assert!((there - back).abs() < 1e-13 * (1.0 + there.abs()), "{there} {back}");
        assert!(member.iter().zip(&gathered).all(|(&m, &x)| m || x == 0.0));
    }
}
