//! Small dense quadratic programmes: minimise ½ p·Hp + g·p over p ≥ 0 with Bᵀp = b.
//!
//! A primal-dual interior-point method (S. Mehrotra, SIAM J. Optim. 2, 1992) comes near; then the set of positive pressures is
//! solved exactly, and cells are exchanged until every sign is right.

use faer::linalg::solvers::Solve;
use faer::{ColMut, MatRef, Side};

/// Iterations of the interior-point method, and exchanges of the set.
const ITERATIONS: usize = 120;
const EXCHANGES: usize = 40;

/// p, and y with h = Hp + g − By ≥ 0, p h = 0; `matrix` is H row by row, `columns` are those of B. `None` if none is found.
pub fn minimum(matrix: &[f64], gap: &[f64], columns: &[Vec<f64>], right: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let n = gap.len();
    let (p, s) = interior(matrix, gap, columns, right)?;
    let mut inside: Vec<bool> = p.iter().zip(&s).map(|(p, s)| p > s).collect();
    let scale = p.iter().copied().fold(0.0, f64::max);
    for _ in 0..EXCHANGES {
        if right.iter().all(|b| *b == 0.0) && p.iter().fold(0.0, |most: f64, p| most.max(*p)) < 1e-3 {
            // a body held at a pivot beside which it touches swings clear
            return Some((vec![0.0; n], vec![f64::NAN; columns.len()]));
        }
        let Some((p, y)) = on_set(matrix, gap, columns, right, &inside) else {
            // too few cells determine the motion; the pressures are determined all the same
            return Some((p, vec![f64::NAN; columns.len()]));
        };
        let h = |k: usize| {
            let own: f64 = (0..n).map(|l| matrix[k * n + l] * p[l]).sum();
            own + gap[k] - columns.iter().zip(&y).map(|(column, y)| column[k] * y).sum::<f64>()
        };
        let rounding = 1e-13 * gap.iter().fold(scale, |most, g| most.max(g.abs()));
        let wrong: Vec<usize> = (0..n)
            .filter(|&k| if inside[k] { p[k] < -1e-11 * scale } else { h(k) < -1e-9 * scale.min(1.0) - rounding })
            .collect();
        if wrong.is_empty() {
            return Some((p.iter().map(|p| p.max(0.0)).collect(), y));
        }
        wrong.iter().for_each(|&k| inside[k] = !inside[k]);
    }
    None
}

/// Pressures and gaps near the minimum.
fn interior(matrix: &[f64], gap: &[f64], columns: &[Vec<f64>], right: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let (n, m) = (gap.len(), columns.len());
    let size = gap.iter().fold(1.0, |most: f64, g| most.max(g.abs()));
    let (mut p, mut s, mut y) = (vec![1.0; n], vec![size; n], vec![0.0; m]);
    for _ in 0..ITERATIONS {
        // residuals of the conditions
        let dual: Vec<f64> = (0..n)
            .map(|k| {
                let own: f64 = (0..n).map(|l| matrix[k * n + l] * p[l]).sum();
                own + gap[k] - s[k] - columns.iter().zip(&y).map(|(column, y)| column[k] * y).sum::<f64>()
            })
            .collect();
        let primal: Vec<f64> = columns.iter().zip(right).map(|(column, b)| b - dot(column, &p)).collect();
        let mu = dot(&p, &s) / n as f64;
        let load = right.iter().fold(1.0, |most: f64, b| most.max(b.abs()));
        let off = dual.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        if mu < 1e-14 && off < 1e-12 * size && primal.iter().all(|r| r.abs() < 1e-12 * load) {
            return Some((p, s));
        }
        let mut barred = matrix.to_vec();
        (0..n).for_each(|k| barred[k * n + k] += s[k] / p[k]);
        let Ok(factors) = MatRef::from_row_major_slice(&barred, n, n).llt(Side::Lower) else {
            // too near the boundary for its rounding: good enough to find the set
            return (mu < 1e-8).then_some((p, s));
        };
        let image: Vec<Vec<f64>> = columns.iter().map(|column| solved(&factors, column)).collect();
        // scaled to a unit diagonal: a body that hardly presses counts like any other
        let unit: Vec<f64> = (0..m).map(|k| dot(&columns[k], &image[k]).sqrt().recip()).collect();
        let schur: Vec<f64> =
            (0..m * m).map(|at| unit[at / m] * unit[at % m] * dot(&columns[at / m], &image[at % m])).collect();
        let direction = |complementarity: &dyn Fn(usize) -> f64| {
            let force: Vec<f64> = (0..n).map(|k| complementarity(k) / p[k] - dual[k]).collect();
            let plain = solved(&factors, &force);
            let wanted: Vec<f64> = (0..m).map(|k| unit[k] * (primal[k] - dot(&columns[k], &plain))).collect();
            let dy: Vec<f64> = gauss(&schur, &wanted)?.iter().zip(&unit).map(|(dy, unit)| unit * dy).collect();
            let dp: Vec<f64> = (0..n)
                .map(|k| plain[k] + image.iter().zip(&dy).map(|(image, dy)| image[k] * dy).sum::<f64>())
                .collect();
            let ds: Vec<f64> = (0..n).map(|k| (complementarity(k) - s[k] * dp[k]) / p[k]).collect();
            Some((dp, ds, dy))
        };
        let (dp, ds, _) = direction(&|k| -p[k] * s[k])?;
        let reach = |x: &[f64], dx: &[f64]| {
            x.iter().zip(dx).filter(|(_, dx)| **dx < 0.0).map(|(x, dx)| -x / dx).fold(1.0, f64::min)
        };
        let (a, b) = (reach(&p, &dp), reach(&s, &ds));
        let ahead: f64 = (0..n).map(|k| (p[k] + a * dp[k]) * (s[k] + b * ds[k])).sum::<f64>() / n as f64;
        let target = (ahead / mu).powi(3) * mu;
        let (dp, ds, dy) = direction(&|k| target - p[k] * s[k] - dp[k] * ds[k])?;
        let step = 0.995 * reach(&p, &dp).min(reach(&s, &ds));
        (0..n).for_each(|k| (p[k], s[k]) = (p[k] + step * dp[k], s[k] + step * ds[k]));
        (0..m).for_each(|k| y[k] += step * dy[k]);
    }
    Some((p, s))
}

/// The minimum over pressures of either sign on a set.
fn on_set(
    matrix: &[f64],
    gap: &[f64],
    columns: &[Vec<f64>],
    right: &[f64],
    inside: &[bool],
) -> Option<(Vec<f64>, Vec<f64>)> {
    let n = gap.len();
    let set: Vec<usize> = (0..n).filter(|&k| inside[k]).collect();
    let (a, m) = (set.len(), columns.len());
    let size = a + m;
    let mut system = vec![0.0; size * size];
    let mut known = vec![0.0; size];
    for (i, &k) in set.iter().enumerate() {
        for (j, &l) in set.iter().enumerate() {
            system[i * size + j] = matrix[k * n + l];
        }
        for (j, column) in columns.iter().enumerate() {
            system[i * size + a + j] = -column[k];
            system[(a + j) * size + i] = column[k];
        }
        known[i] = -gap[k];
    }
    known[a..].copy_from_slice(right);
    let solved = gauss(&system, &known)?;
    let mut p = vec![0.0; n];
    set.iter().zip(&solved).for_each(|(&k, &value)| p[k] = value);
    Some((p, solved[a..].to_vec()))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// x of A x = b by the factors of A.
fn solved(factors: &impl Solve<f64>, b: &[f64]) -> Vec<f64> {
    let mut x = b.to_vec();
    factors.solve_in_place(ColMut::from_slice_mut(&mut x).as_mat_mut());
    x
}

/// x of A x = b, A row by row; `None` if A is not positive definite.
pub fn solve_definite(a: &[f64], b: &[f64]) -> Option<Vec<f64>> {
    let factors = MatRef::from_row_major_slice(a, b.len(), b.len()).llt(Side::Lower).ok()?;
    Some(solved(&factors, b))
}

/// By row pivoting; `None` if a row depends on the others.
fn gauss(a: &[f64], b: &[f64]) -> Option<Vec<f64>> {
    let (n, scale) = (b.len(), a.iter().fold(0.0, |most: f64, a| most.max(a.abs())));
    let factors = MatRef::from_row_major_slice(a, n, n).partial_piv_lu();
    (0..n).all(|k| factors.U()[(k, k)].abs() > 1e-13 * scale).then(|| solved(&factors, b))
}
