//! Errors measured from differences between runs: the grid convergence index.
//!
//! With the values f₀, f₁, f₂ of three meshes, cells of the sides s₀ > s₁ > s₂, an error C sᵖ gives the differences
//! d₁ = |f₀ − f₁| = C (s₀ᵖ − s₁ᵖ) and d₂ = C (s₁ᵖ − s₂ᵖ): their ratio gives the observed order p, and F
//! d₂/((s₁/s₂)ᵖ − 1) the index, an error band of the finest mesh. F is 1.25 where three meshes show the order, or two
//! are taken to have the first, and 3 where there is none (P. J. Roache, J. Fluids Eng. 116 (1994) 405; I. B. Celik
//! et al., J. Fluids Eng. 130 (2008) 078001).

use crate::numeric::root;

/// The factors of safety: where three meshes show the order, or two have the first one, the least of smooth shapes
/// and punches; and where the differences show no order.
const OBSERVED: f64 = 1.25;
const NOT_OBSERVED: f64 = 3.0;
/// Orders that count as observed. Approach and force are of the first order on punches, of the second on smooth
/// shapes; a greater order is chance, and a least order of ½ is that of a pressure at a singular edge.
const LEAST: f64 = 0.5;
pub(crate) const SINGULAR: f64 = 1.0;
pub(crate) const SMOOTH: f64 = 2.0;
/// A smaller difference, over the maximum value, is rounding.
const ROUNDING: f64 = 1e-12;
/// How exactly an order is found.
const ORDER: f64 = 1e-12;

/// What is known of the error of the finest mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OfMesh {
    /// The index; infinite from one mesh.
    pub(crate) error: f64,
    /// Observed order; `None` where it is assumed.
    pub(crate) order: Option<f64>,
}

impl OfMesh {
    /// From the sides of the cells of successive meshes and the differences between each two of them, with an order
    /// of at most this.
    pub(crate) fn of(sides: &[f64], differences: &[f64], most: f64) -> OfMesh {
        let Some((&last, before)) = differences.split_last() else {
            return OfMesh { error: f64::INFINITY, order: None };
        };
        let finest = &sides[sides.len() - differences.len() - 1..];
        let ratio = |k: usize| finest[k] / finest[k + 1];
        let (k, fine) = (before.len(), ratio(before.len()));
        let Some(&first) = before.last() else {
            return OfMesh { error: OBSERVED * last / (fine - 1.0), order: None };
        };
        if last == 0.0 && first == 0.0 {
            return OfMesh { error: 0.0, order: None };
        }
        let coarse = ratio(k - 1);
        // d₁/d₂ of an order, less the one found
        let excess = |p: f64| (coarse.powf(p) - 1.0) / (1.0 - fine.powf(-p)) * last - first;
        if excess(LEAST) > 0.0 {
            // the differences hardly fall: no order is observed
            let worst = last.max(first);
            return OfMesh { error: NOT_OBSERVED * worst / (fine.powf(LEAST) - 1.0), order: None };
        }
        let order = if excess(most) <= 0.0 { most } else { root([LEAST, most], LEAST, ORDER, |p| [excess(p), 0.0]) };
        // both differences speak of the same C: a small last one may be chance
        let [by_last, by_first] =
            [last / (fine.powf(order) - 1.0), first / ((coarse.powf(order) - 1.0) * fine.powf(order))];
        OfMesh { error: OBSERVED * by_last.max(by_first), order: Some(order) }
    }
}

/// The maximum difference of values over the largest of the finer ones; 0 where it is rounding, as of a force that
/// is given.
pub(crate) fn difference(coarse: &[f64], fine: &[f64]) -> f64 {
    let scale = fine.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let most = coarse.iter().zip(fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if most > ROUNDING * scale { most / scale } else { 0.0 }
}

/// Means over coarser cells of the same domain, and Σ |p − p′| / Σ p′ of the coarse field against them.
pub(crate) fn difference_of_fields((coarse, n): (&[f64], [usize; 2]), (fine, m): (&[f64], [usize; 2])) -> f64 {
    let columns = overlaps(n[1], m[1]);
    let mut along = vec![0.0; m[0] * n[1]];
    for (row, out) in fine.chunks_exact(m[1]).zip(along.chunks_exact_mut(n[1])) {
        columns.iter().for_each(|&(j, from, part)| out[j] += part * row[from]);
    }
    let mut means = vec![0.0; n[0] * n[1]];
    for (i, from, part) in overlaps(n[0], m[0]) {
        let row = &along[from * n[1]..][..n[1]];
        means[i * n[1]..][..n[1]].iter_mut().zip(row).for_each(|(mean, value)| *mean += part * value);
    }
    off_means(coarse, means.into_iter())
}

/// Σ |p − p′| / Σ |p′| of a field against means over its cells.
pub(crate) fn off_means(coarse: &[f64], means: impl Iterator<Item = f64>) -> f64 {
    let add = |(off, sum): (f64, f64), (p, mean): (&f64, f64)| (off + (p - mean).abs(), sum + mean.abs());
    let (off, sum) = coarse.iter().zip(means).fold((0.0, 0.0), add);
    if sum > 0.0 { off / sum } else { off }
}

/// The parts of coarse cells that finer ones cover, of n and m cells along the same length: coarse cell, fine cell,
/// part.
fn overlaps(n: usize, m: usize) -> Vec<(usize, usize, f64)> {
    let mut found = Vec::with_capacity(n + m);
    for i in 0..n {
        // in units of 1/(n m) of the length
        let [low, high] = [i * m, (i + 1) * m];
        for from in low / n..high.div_ceil(n) {
            let covered = high.min((from + 1) * n) - low.max(from * n);
            found.push((i, from, covered as f64 / m as f64));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of pure orders are found to the factor of safety, on meshes of unequal ratios.
    #[test]
    fn the_index_of_a_pure_order_is_its_error() {
        for order in [0.5, 0.8, 1.0, 1.5, 2.0] {
            let sides = [1.0 / 16.0, 1.0 / 24.0, 1.0 / 30.0, 1.0 / 54.0];
            let value = |s: f64| 2.0 + 3.0 * s.powf(order);
            let differences: Vec<f64> = sides.windows(2).map(|pair| (value(pair[0]) - value(pair[1])).abs()).collect();
            let found = OfMesh::of(&sides, &differences, SMOOTH);
            assert!((found.order.unwrap() - order).abs() < 1e-9, "{order}: {found:?}");
            let exact = 3.0 * sides[3].powf(order);
            assert!((found.error / (OBSERVED * exact) - 1.0).abs() < 1e-8, "{order}: {found:?}");
            // two meshes: the first order
            let found = OfMesh::of(&sides[2..], &differences[2..], SMOOTH);
            assert!(found.order.is_none() && (order < 1.0 || found.error > exact), "{order}: {found:?}");
        }
        assert_eq!(OfMesh::of(&[1.0], &[], SMOOTH).error, f64::INFINITY);
        // no convergence, and a last difference that is small by chance
        let sides = [1.0, 0.5, 0.25];
        assert!(OfMesh::of(&sides, &[0.1, 0.1], SMOOTH).order.is_none());
        let chance = OfMesh::of(&sides, &[0.1, 1e-6], SMOOTH);
        assert!((chance.error / (OBSERVED * 0.1 / 12.0) - 1.0).abs() < 1e-12, "{chance:?}");
    }

    /// Means over coarser cells keep the force, and a field that is constant over the fine cells of a coarse one.
    #[test]
    fn fields_are_compared_on_the_coarser_cells() {
        let mut draw = 1_u64;
        let mut next = || {
            draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (draw >> 11) as f64 / (1_u64 << 53) as f64
        };
        for (n, m) in [([4, 6], [4, 6]), ([4, 6], [8, 18]), ([16, 10], [24, 15]), ([5, 1], [7, 1])] {
            let fine: Vec<f64> = (0..m[0] * m[1]).map(|_| next()).collect();
            // by definition, on a raster that both meshes divide
            let mut means = vec![0.0; n[0] * n[1]];
            for a in 0..n[0] * m[0] {
                for b in 0..n[1] * m[1] {
                    means[a / m[0] * n[1] + b / m[1]] += fine[a / n[0] * m[1] + b / n[1]] / (m[0] * m[1]) as f64;
                }
            }
            assert!(difference_of_fields((&means, n), (&fine, m)) < 1e-14, "{n:?} {m:?}");
            let shifted: Vec<f64> = means.iter().map(|mean| 1.25 * mean).collect();
            assert!((difference_of_fields((&shifted, n), (&fine, m)) - 0.25).abs() < 1e-12);
        }
    }
}
