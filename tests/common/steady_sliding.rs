//! Steady sliding and rolling as one contact problem, without steps and without history: a dense reference.
//!
//! In the frame of the indenter a steady pressure p displaces the surface by u = ∫ Σ C_k e^(−s/l_k) V(x + s) ds/l_k + C0 V, V = K p,
//! l_k = v λ_k. Each term multiplies the wave q along the motion by 1/(1 − i q l_k); of bodies that end it gives influence
//! coefficients by a recursion against the motion. The contact problem p ≥ 0, h ≥ 0, p h = 0 is solved by an active set.

use std::collections::HashSet;
use std::f64::consts::{FRAC_2_PI, PI, TAU};

use super::gauss::points;
use super::rolling::eliminate;

/// What lies below, on cells along the motion and across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Below {
    /// Periodic along both axes, the mean of the surface being the datum.
    Periodic,
    HalfSpace,
    /// In plane strain, with the datum at a distance \[m\].
    Line(f64),
}

/// How the response along the motion is found from its values at the centers of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along {
    /// Exactly.
    Exact,
    /// As if V were linear from cell to cell.
    Linear,
}

/// The indenter moves along the first axis, towards greater indices.
#[derive(Debug, Clone)]
pub struct SteadySliding {
    pub below: Below,
    /// Cells that may touch, along the motion and across it; the whole period of periodic bodies.
    pub cells: [usize; 2],
    pub spacing: [f64; 2],
    pub glassy: f64,
    /// Compliance, and v times the retardation time \[m\], of each term.
    pub terms: Vec<(f64, f64)>,
    /// At the center of each cell, the cells of a row across the motion together.
    pub gap: Vec<f64>,
    /// Rise of the gap along the motion over each cell.
    pub rise: Vec<f64>,
    /// Σ p times the area of a cell.
    pub force: f64,
}

#[derive(Debug, Clone)]
pub struct SteadyState {
    pub pressure: Vec<f64>,
    pub approach: f64,
    /// Lateral over normal force.
    pub friction: f64,
}

impl SteadySliding {
    /// The steady state; `None` if the active set finds none.
    pub fn solve(&self, along: Along) -> Option<SteadyState> {
        let [m, n] = self.cells;
        let table = match self.below {
            Below::Periodic => self.of_waves(along),
            _ => self.of_recursion(along),
        };
        // row after row of the distance across the motion, 2 m − 1 distances along it
        let influence = |k: usize, l: usize| {
            let ([i, j], [a, b]) = ([k / n, k % n], [l / n, l % n]);
            table[j.abs_diff(b)][m - 1 + i - a]
        };
        let total = self.force / (self.spacing[0] * self.spacing[1]);
        let mut sorted = self.gap.clone();
        sorted.sort_by(f64::total_cmp);
        let range = sorted[sorted.len() - 1] - sorted[0];
        let first = sorted[sorted.len() / 8];
        let mut active: Vec<usize> = (0..m * n).filter(|&k| self.gap[k] <= first).collect();
        let mut seen = HashSet::new();
        for _ in 0..200 {
            let last = active.len();
            let row = |i: usize| -> Vec<f64> {
                let left = active.iter().map(|&l| if i == last { 1.0 } else { influence(active[i], l) });
                let end = if i == last { [0.0, total] } else { [-1.0, -self.gap[active[i]]] };
                left.chain(end).collect()
            };
            let solution = eliminate((0..=last).map(row).collect());
            let (approach, greatest) = (solution[last], solution[..last].iter().copied().fold(0.0, f64::max));
            let mut pressure = vec![0.0; m * n];
            active.iter().zip(&solution).for_each(|(&k, &p)| pressure[k] = p);
            let held: HashSet<usize> = active.iter().copied().collect();
            let depth =
                |k: usize| approach - self.gap[k] - active.iter().map(|&l| influence(k, l) * pressure[l]).sum::<f64>();
            let mut leave: Vec<(usize, f64)> = active.iter().map(|&k| (k, -pressure[k])).collect();
            leave.retain(|(_, pull)| *pull > 1e-11 * greatest);
            let mut join: Vec<(usize, f64)> = (0..m * n).filter(|k| !held.contains(k)).map(|k| (k, depth(k))).collect();
            join.retain(|(_, depth)| *depth > 1e-10 * range);
            if leave.is_empty() && join.is_empty() {
                let lateral: f64 = pressure.iter().zip(&self.rise).map(|(p, rise)| p * rise).sum();
                let friction = lateral / self.spacing[0] / total;
                return Some(SteadyState { pressure, approach, friction });
            }
            // a set that comes back: only the worse half changes
            let mut sorted = active.clone();
            sorted.sort_unstable();
            if !seen.insert(sorted) {
                for list in [&mut leave, &mut join] {
                    list.sort_by(|a, b| b.1.total_cmp(&a.1));
                    list.truncate(list.len().div_ceil(2));
                }
            }
            active.retain(|k| leave.iter().all(|(left, _)| left != k));
            active.extend(join.iter().map(|(k, _)| k));
            if active.is_empty() {
                active = (0..m * n).filter(|&k| self.gap[k] <= first).collect();
            }
        }
        None
    }

    /// For a term of length `l`: what is left over a cell, and the weights of the near and the far center where V is linear.
    fn linear(&self, l: f64) -> [f64; 3] {
        let z = self.spacing[0] / l;
        let (decay, mean) = ((-z).exp(), -(-z).exp_m1() / z);
        [decay, 1.0 - mean, mean - decay]
    }

    /// Coefficients of periodic bodies: 2/q for each wave of the grid, times its creep.
    fn of_waves(&self, along: Along) -> Vec<Vec<f64>> {
        let [m, n] = self.cells;
        let wave = |k: usize, count: usize, axis: usize| {
            let k = if 2 * k > count { k as f64 - count as f64 } else { k as f64 };
            TAU * k / (count as f64 * self.spacing[axis])
        };
        // the indenter comes from the side of small indices: what is behind it was under it before
        let creep = |q: f64| {
            self.terms.iter().fold([self.glassy, 0.0], |[real, imaginary], &(c, l)| {
                let (cos, sin) = ((q * self.spacing[0]).cos(), (q * self.spacing[0]).sin());
                // (near + far ζ)/(1 − decay ζ), ζ the shift by a cell ahead
                let ([up, up_i], [down, down_i]) = match along {
                    Along::Exact => ([1.0, 0.0], [1.0, -q * l]),
                    Along::Linear => {
                        let [decay, near, far] = self.linear(l);
                        ([near + far * cos, far * sin], [1.0 - decay * cos, -decay * sin])
                    }
                };
                let square = down * down + down_i * down_i;
                [real + c * (up * down + up_i * down_i) / square, imaginary + c * (up_i * down - up * down_i) / square]
            })
        };
        let symbols: Vec<Vec<[f64; 2]>> = (0..m)
            .map(|k| {
                let q1 = wave(k, m, 0);
                let [real, imaginary] = creep(q1);
                // the shortest wave along the motion is its own mirror image
                let imaginary = if 2 * k == m { 0.0 } else { imaginary };
                let each = |j: usize| {
                    let q = q1.hypot(wave(j, n, 1));
                    if q > 0.0 { [2.0 / q * real, 2.0 / q * imaginary] } else { [0.0; 2] }
                };
                (0..n).map(each).collect()
            })
            .collect();
        let coefficient = |i: isize, j: usize| {
            let mut sum = 0.0;
            for (k, row) in symbols.iter().enumerate() {
                let phase = TAU * ((k as isize * i).rem_euclid(m as isize)) as f64 / m as f64;
                let [real, imaginary] = row.iter().enumerate().fold([0.0; 2], |[a, b], (l, s)| {
                    let across = (TAU * (l * j % n) as f64 / n as f64).cos();
                    [a + across * s[0], b + across * s[1]]
                });
                sum += real * phase.cos() - imaginary * phase.sin();
            }
            sum / (m * n) as f64
        };
        let m = m as isize;
        (0..n).map(|j| (1 - m..m).map(|i| coefficient(i, j)).collect()).collect()
    }

    /// Coefficients of bodies that end: f(x) = ∫ e^(−s/l) K(x + s) ds/l = I(x) + e^(−d/l) f(x + d).
    fn of_recursion(&self, along: Along) -> Vec<Vec<f64>> {
        let ([m, n], [d, _]) = (self.cells, self.spacing);
        let last = m as isize - 1;
        let of_row = |j: usize| {
            let kernel = |x: f64| self.influence(x, j);
            let at = |i: isize| kernel(i as f64 * d);
            let mut row: Vec<f64> = (-last..=last).map(|i| self.glassy * at(i)).collect();
            for &(c, l) in &self.terms {
                let weighted = |x: f64, s: f64| (-s / l).exp() / l * kernel(x + s);
                let far = (last + 1) as f64 * d;
                let (mut sum, mut from, mut width) = (0.0, 0.0, (0.5 * far).min(l));
                while from < 45.0 * l {
                    sum += points(from, from + width, 1).map(|(s, w)| w * weighted(far, s)).sum::<f64>();
                    (from, width) = (from + width, (2.0 * width).min(2.0 * l));
                }
                let [decay, near, next] = self.linear(l);
                for i in (-last..=last).rev() {
                    let x = i as f64 * d;
                    // the kernel has its kinks at the sides of its cell, half way
                    let own = match along {
                        Along::Exact => points(0.0, d, 4).map(|(s, w)| w * weighted(x, s)).sum::<f64>(),
                        Along::Linear => near * at(i) + next * at(i + 1),
                    };
                    sum = own + decay * sum;
                    row[(last + i) as usize] += c * sum;
                }
            }
            row
        };
        (0..n).map(of_row).collect()
    }

    /// K at x along the motion from a cell, j cells across it: Love's integral, or of ln(D/|x|) over a side.
    fn influence(&self, x: f64, j: usize) -> f64 {
        let [a, b] = self.spacing.map(|side| 0.5 * side);
        if let Below::Line(datum) = self.below {
            let primitive = |x: f64| if x == 0.0 { 0.0 } else { x * ((x.abs() / datum).ln() - 1.0) };
            return -FRAC_2_PI * (primitive(x + a) - primitive(x - a));
        }
        let term = |x: f64, y: f64| if x == 0.0 { 0.0 } else { x * (y / x.abs()).asinh() };
        let corner = |x: f64, y: f64| term(x, y) + term(y, x);
        let y = j as f64 * self.spacing[1];
        if x.hypot(y) > 1e3 * a.max(b) {
            return 4.0 * a * b / (PI * x.hypot(y)); // where the differences cancel
        }
        (corner(x + a, y + b) - corner(x - a, y + b) - corner(x + a, y - b) + corner(x - a, y - b)) / PI
    }
}
