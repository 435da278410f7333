//! The smooth extension of a field from the contact to all cells, and its transpose.

use pulp::Arch;

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
/// Axes that are not periodic are mirrored at their ends, which is what they are on the parts that symmetry leaves of a grid.
#[derive(Debug, Clone)]
pub(crate) struct Extension {
    cells: [usize; 2],
    periodic: [bool; 2],
    levels: Vec<Level>,
    /// 1/Σ w over the coarsest block, 0 if nothing is known.
    share: f64,
    rows: Rows,
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

/// Single rows in work: of blocks, with a neighbour at either end, and of the finer level, with two.
#[derive(Debug, Clone)]
struct Rows {
    blocks: Vec<f64>,
    fine: Vec<f64>,
}

#[derive(Debug, Clone, Copy)]
enum Pass {
    Fit,
    Extend,
    Gather,
}

impl Extension {
    pub(crate) fn new(cells: [usize; 2], periodic: [bool; 2]) -> Extension {
        let mut levels = Vec::new();
        let mut size = cells;
        while size != [1, 1] {
            size = size.map(|n| n.div_ceil(2));
            let field = vec![0.0; size[0] * size[1]];
            levels.push(Level { cells: size, factor: field.clone(), value: field });
        }
        let blocks = cells[1].div_ceil(2);
        let rows = Rows { blocks: vec![0.0; blocks + 2], fine: vec![0.0; 2 * blocks + 4] };
        Extension { cells, periodic, levels, share: 0.0, rows }
    }

    /// Bytes that it takes.
    pub(crate) fn bytes(cells: [usize; 2]) -> u128 {
        let (mut size, mut blocks) = (cells, 0);
        while size != [1, 1] {
            size = size.map(|n| n.div_ceil(2));
            blocks += size[0] as u128 * size[1] as u128;
        }
        8 * (2 * blocks + 3 * cells[1].div_ceil(2) as u128 + 6)
    }

    /// Makes E that of the set of members.
    pub(crate) fn fit(&mut self, member: &[bool]) {
        self.run(Pass::Fit, &mut [], member);
    }

    /// Fills all cells outside the set, where `field` is zero.
    pub(crate) fn extend(&mut self, field: &mut [f64], member: &[bool]) {
        self.run(Pass::Extend, field, member);
    }

    /// The transpose: what all cells hold is brought to the set, and `field` is zero elsewhere.
    pub(crate) fn gather(&mut self, field: &mut [f64], member: &[bool]) {
        self.run(Pass::Gather, field, member);
    }

    /// Runs a pass compiled for the vector units of the machine.
    fn run(&mut self, pass: Pass, field: &mut [f64], member: &[bool]) {
        let arguments = (self, field, member);
        Arch::new().dispatch(
            #[inline(always)]
            move || {
                // a closure is inlined, and so compiled for these units, if it consumes what it captures
                let (extension, field, member) = arguments;
                match pass {
                    Pass::Fit => extension.find_factors(member),
                    Pass::Extend => extension.push_and_pull(field, member),
                    Pass::Gather => extension.transpose(field, member),
                }
            },
        );
    }

    #[inline(always)]
    fn find_factors(&mut self, member: &[bool]) {
        let Extension { cells, levels, rows, share, .. } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            // the values are Σ w here, the sums of a field of ones
            let Level { cells: [_, m2], factor, value } = &mut level[0];
            let fine = finer.last().map_or(*cells, |fine| fine.cells);
            for (i, (out, factors)) in value.chunks_exact_mut(*m2).zip(factor.chunks_exact_mut(*m2)).enumerate() {
                out.fill(0.0);
                for row in rows_under(i, fine) {
                    match finer.last() {
                        Some(fine) => add_weighted_pairs(out, &fine.value[row.clone()], &fine.factor[row]),
                        None => {
                            let ones = &mut rows.fine[..row.len()];
                            ones.iter_mut().zip(&member[row]).for_each(|(one, &m)| *one = f64::from(u8::from(m)));
                            add_pairs(out, ones);
                        }
                    }
                }
                let factors = factors.iter_mut().zip(out);
                factors.for_each(|(factor, &mut sum)| *factor = TRUST / (4.0 + (TRUST - 1.0) * sum));
            }
        }
        let known = levels.last().map_or(0.0, |coarsest| coarsest.value[0]);
        *share = if known > 0.0 { 1.0 / known } else { 0.0 };
    }

    #[inline(always)]
    fn push_and_pull(&mut self, field: &mut [f64], member: &[bool]) {
        let Extension { cells, periodic, levels, share, rows } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            let Level { cells: [_, m2], value, .. } = &mut level[0];
            let fine = finer.last().map_or(*cells, |fine| fine.cells);
            for (i, out) in value.chunks_exact_mut(*m2).enumerate() {
                out.fill(0.0);
                for row in rows_under(i, fine) {
                    match finer.last() {
                        Some(fine) => add_weighted_pairs(out, &fine.value[row.clone()], &fine.factor[row]),
                        None => add_pairs(out, &field[row]),
                    }
                }
            }
        }
        let Some(coarsest) = levels.last_mut() else { return };
        coarsest.value[0] *= *share;
        for l in (1..levels.len()).rev() {
            let (finer, coarser) = levels.split_at_mut(l);
            let Level { cells: [_, n2], factor, value } = &mut finer[l - 1];
            for (i, (values, factors)) in value.chunks_exact_mut(*n2).zip(factor.chunks_exact(*n2)).enumerate() {
                let up = coarser[0].interpolate(i, *periodic, rows);
                for ((x, &factor), &up) in values.iter_mut().zip(factors).zip(up) {
                    *x = factor * *x + (1.0 - weight(factor)) * up;
                }
            }
        }
        for (i, (values, inside)) in field.chunks_exact_mut(cells[1]).zip(member.chunks_exact(cells[1])).enumerate() {
            let up = levels[0].interpolate(i, *periodic, rows);
            for ((x, &inside), &up) in values.iter_mut().zip(inside).zip(up) {
                *x = if inside { *x } else { up };
            }
        }
    }

    #[inline(always)]
    fn transpose(&mut self, field: &mut [f64], member: &[bool]) {
        let Extension { cells, periodic, levels, share, rows } = self;
        for l in 0..levels.len() {
            let (finer, level) = levels.split_at_mut(l);
            level[0].value.fill(0.0);
            match finer.last_mut() {
                None => {
                    let n2 = cells[1];
                    for (i, (values, inside)) in field.chunks_exact(n2).zip(member.chunks_exact(n2)).enumerate() {
                        let open = rows.fine[2..].iter_mut().zip(values.iter().zip(inside));
                        open.for_each(|(out, (&f, &inside))| *out = if inside { 0.0 } else { f });
                        level[0].restrict(i, n2, *periodic, rows);
                    }
                }
                Some(Level { cells: [_, n2], factor, value }) => {
                    for (i, (values, factors)) in value.chunks_exact(*n2).zip(factor.chunks_exact(*n2)).enumerate() {
                        let open = rows.fine[2..].iter_mut().zip(values.iter().zip(factors));
                        open.for_each(|(out, (&f, &factor))| *out = (1.0 - weight(factor)) * f);
                        level[0].restrict(i, *n2, *periodic, rows);
                    }
                }
            }
        }
        let Some(coarsest) = levels.last_mut() else { return };
        coarsest.value[0] *= *share;
        for l in (1..levels.len()).rev() {
            let (finer, coarser) = levels.split_at_mut(l);
            let Level { cells: [_, n2], factor, value } = &mut finer[l - 1];
            for (i, (values, factors)) in value.chunks_exact_mut(*n2).zip(factor.chunks_exact(*n2)).enumerate() {
                let sums = coarser[0].spread(i, rows);
                values.iter_mut().zip(factors).zip(sums).for_each(|((f, &factor), &sum)| *f = factor * (*f + sum));
            }
        }
        for (i, (values, inside)) in field.chunks_exact_mut(cells[1]).zip(member.chunks_exact(cells[1])).enumerate() {
            let sums = levels[0].spread(i, rows);
            for ((f, &inside), &sum) in values.iter_mut().zip(inside).zip(sums) {
                *f = if inside { *f + sum } else { 0.0 };
            }
        }
    }
}

impl Level {
    /// Row `i` of the finer level, interpolated from this one: 9/16 of the block, 3/16 of two neighbours and 1/16 of the third.
    #[inline(always)]
    fn interpolate<'a>(&self, i: usize, periodic: [bool; 2], rows: &'a mut Rows) -> &'a [f64] {
        let m2 = self.cells[1];
        let [near, far] = self.blocks_beside(i, periodic[0]).map(|i| &self.value[i * m2..][..m2]);
        let across = &mut rows.blocks[..m2 + 2];
        for ((a, &near), &far) in across[1..=m2].iter_mut().zip(near).zip(far) {
            *a = 0.75 * near + 0.25 * far;
        }
        let [before, after] = if periodic[1] { [m2, 1] } else { [1, m2] };
        (across[0], across[m2 + 1]) = (across[before], across[after]);
        let (a, b, c) = (&across[..m2], &across[1..][..m2], &across[2..][..m2]);
        let fine = &mut rows.fine[..2 * m2];
        for (((pair, a), b), c) in fine.as_chunks_mut::<2>().0.iter_mut().zip(a).zip(b).zip(c) {
            *pair = [0.75 * b + 0.25 * a, 0.75 * b + 0.25 * c];
        }
        fine
    }

    /// The transpose of [`Level::interpolate`]: adds what row `i` of the finer level, of length `n2`, holds.
    #[inline(always)]
    fn restrict(&mut self, i: usize, n2: usize, periodic: [bool; 2], rows: &mut Rows) {
        let m2 = self.cells[1];
        let fine = &mut rows.fine[..2 * m2 + 4];
        fine[n2 + 2..2 * m2 + 2].fill(0.0);
        let [before, after] = if periodic[1] { [2 * m2 + 1, 2] } else { [2, 2 * m2 + 1] };
        (fine[1], fine[2 * m2 + 2]) = (fine[before], fine[after]);
        let pairs = fine.as_chunks::<2>().0;
        let blocks = &mut rows.blocks[..m2];
        let (a, b, c) = (&pairs[..m2], &pairs[1..][..m2], &pairs[2..][..m2]);
        for (((out, a), b), c) in blocks.iter_mut().zip(a).zip(b).zip(c) {
            *out = 0.75 * (b[0] + b[1]) + 0.25 * (a[1] + c[0]);
        }
        for (i, factor) in self.blocks_beside(i, periodic[0]).into_iter().zip([0.75, 0.25]) {
            let out = &mut self.value[i * m2..][..m2];
            out.iter_mut().zip(&*blocks).for_each(|(out, &block)| *out += factor * block);
        }
    }

    /// Row `i` of the finer level with the value of each block on all of its parts.
    #[inline(always)]
    fn spread<'a>(&self, i: usize, rows: &'a mut Rows) -> &'a [f64] {
        let m2 = self.cells[1];
        let fine = &mut rows.fine[..2 * m2];
        // both rows of a block are the same
        if i.is_multiple_of(2) {
            let pairs = fine.as_chunks_mut::<2>().0;
            pairs.iter_mut().zip(&self.value[i / 2 * m2..]).for_each(|(pair, &value)| *pair = [value; 2]);
        }
        fine
    }

    /// The blocks that row `i` of the finer level lies between, the nearer one first.
    #[inline(always)]
    fn blocks_beside(&self, i: usize, periodic: bool) -> [usize; 2] {
        let (near, m1) = (i / 2, self.cells[0]);
        let far = match (i.is_multiple_of(2), periodic) {
            (true, true) => (near + m1 - 1) % m1,
            (true, false) => near.saturating_sub(1),
            (false, true) => (near + 1) % m1,
            (false, false) => (near + 1).min(m1 - 1),
        };
        [near, far]
    }
}

/// w of a block with this φ.
#[inline(always)]
fn weight(factor: f64) -> f64 {
    (TRUST - 4.0 * factor) / (TRUST - 1.0)
}

/// The rows of a finer level that row `i` of blocks covers.
#[inline(always)]
fn rows_under(i: usize, [n1, n2]: [usize; 2]) -> impl Iterator<Item = std::ops::Range<usize>> {
    (2 * i..(2 * i + 2).min(n1)).map(move |row| row * n2..(row + 1) * n2)
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
