//! Steady sliding and rolling as one contact problem, without steps and without history: a dense reference.
//!
//! In the frame of the indenter a steady pressure p displaces the surface by u = ∫ Σ C_k e^(−s/l_k) V(x + s) ds/l_k + C0 V, V = K p,
//! l_k = v λ_k. Each term multiplies the wave q along the motion by 1/(1 − i q l_k); of bodies that end it gives influence
//! coefficients by a recursion against the motion. The contact problem p ≥ 0, h ≥ 0, p h = 0 is solved by an active set.

use std::collections::HashSet;
use std::f64::consts::{FRAC_2_PI, PI, TAU};

use super::gauss::points;
use super::love::love;
use super::rolling::eliminate;
use viscocontact::num_complex::Complex64;
use viscocontact::rheology::CreepSpectrum;

/// What lies below, on cells along the motion and across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Below {
    /// Periodic along both axes, the mean of the surface being the datum.
    Periodic,
    HalfSpace,
    /// In plane strain, with the datum at a distance \[m\].
    Line(f64),
}

/// How time is resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Time {
    /// Exactly.
    Exact,
    /// As by steps over one cell in which u is linear in time (`TimeRule::ExponentialLinear`).
    Steps,
    /// As by steps in which u is linear, and on all steps but the last quadratic, through the node after it too
    /// (`TimeRule::Exponential`); of periodic bodies only.
    Corrected,
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
    pub fn solve(&self, time: Time) -> Option<SteadyState> {
        self.solve_by(&match self.below {
            Below::Periodic => self.of_waves(time),
            _ => self.of_recursion(time),
        })
    }

    /// The steady state from influence coefficients, for each distance across the motion 2 m − 1 distances along it.
    pub fn solve_by(&self, table: &[Vec<f64>]) -> Option<SteadyState> {
        let [m, n] = self.cells;
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

    /// The response of steps over one cell to a pressure: at once, and a part of it that decays, for each term: its value one cell
    /// behind, and 1 − ρ of the factor ρ of a cell.
    ///
    /// v = E∞ u + Σ E_i w_i (x − 1)/(x − a_i) u for a shift by x a cell, a_i = e^(−z_i), w_i = (1 − a_i)/z_i. The poles ρ of u/v lie
    /// between the a_i, the last below 1.
    fn steps(&self) -> (f64, Vec<(f64, f64)>) {
        let relaxation = CreepSpectrum::new(self.glassy, 0.0, &self.terms).unwrap().relaxation();
        // E_i w_i and 1 − a_i, slow terms first
        let branch = |&(e, l): &(f64, f64)| {
            let past = -(-self.spacing[0] / l).exp_m1();
            (e * past * l / self.spacing[0], past)
        };
        let branches: Vec<(f64, f64)> = relaxation.terms().iter().rev().map(branch).collect();
        let stiffness =
            |y: f64| relaxation.equilibrium() + branches.iter().map(|(e, past)| -e * y / (past - y)).sum::<f64>();
        let pole = |k: usize| {
            // D falls from E∞ at y = 0, or +∞, to −∞ at the pole
            let (mut low, mut high) = (if k == 0 { 1e-9 * branches[0].1 } else { branches[k - 1].1 }, branches[k].1);
            for _ in 0..200 {
                let middle = (low * high).sqrt();
                if stiffness(middle) > 0.0 { low = middle } else { high = middle }
            }
            let y = (low * high).sqrt();
            let slope: f64 = branches.iter().map(|(e, past)| e * past / (past - y).powi(2)).sum();
            (1.0 / slope, y)
        };
        let at_once = 1.0 / (relaxation.equilibrium() + branches.iter().map(|(e, _)| e).sum::<f64>());
        (at_once, (0..branches.len()).map(pole).collect())
    }

    /// Coefficients of periodic bodies: 2/q for each wave of the grid, times its creep.
    fn of_waves(&self, time: Time) -> Vec<Vec<f64>> {
        let [m, n] = self.cells;
        let wave = |k: usize, count: usize, axis: usize| {
            let k = if 2 * k > count { k as f64 - count as f64 } else { k as f64 };
            TAU * k / (count as f64 * self.spacing[axis])
        };
        let (at_once, decaying) = self.steps();
        let relaxation = CreepSpectrum::new(self.glassy, 0.0, &self.terms).unwrap().relaxation();
        // the indenter comes from the side of small indices: what is behind it was under it before
        let creep = |q: f64| match time {
            Time::Exact => {
                self.glassy + self.terms.iter().map(|&(c, l)| c / Complex64::new(1.0, -q * l)).sum::<Complex64>()
            }
            Time::Steps => {
                // 1/(x − ρ), x the shift by a cell back
                let back = Complex64::cis(-q * self.spacing[0]) - 1.0;
                at_once + decaying.iter().map(|&(next, y)| next / (back + y)).sum::<Complex64>()
            }
            // v = E∞ u + Σ E_i [w_i (1 − ζ) + a_i k_i (1 − ζ)²]/(1 − a_i ζ) u, ζ the shift by a cell ahead
            Time::Corrected => {
                let ahead = Complex64::cis(q * self.spacing[0]);
                let change = 1.0 - ahead;
                let stiffness = |&(e, l): &(f64, f64)| {
                    let z = self.spacing[0] / l;
                    let (a, w) = ((-z).exp(), -(-z).exp_m1() / z);
                    // ∫ e^(−σ/τ) (Δ − 2 σ) dσ/2Δ², in series where it cancels
                    let series = z / 12.0 - z * z / 24.0 + z.powi(3) / 80.0;
                    let k = if z < 1e-2 { series } else { 0.5 * w - (1.0 - a * (1.0 + z)) / (z * z) };
                    e * (w * change + a * k * change * change) / (1.0 - a * ahead)
                };
                (relaxation.equilibrium() + relaxation.terms().iter().map(stiffness).sum::<Complex64>()).inv()
            }
        };
        let symbols: Vec<Vec<Complex64>> = (0..m)
            .map(|k| {
                let q1 = wave(k, m, 0);
                let own = creep(q1);
                // the shortest wave along the motion is its own mirror image
                let own = if 2 * k == m { Complex64::from(own.re) } else { own };
                let each = |j: usize| {
                    let q = q1.hypot(wave(j, n, 1));
                    if q > 0.0 { 2.0 / q * own } else { Complex64::ZERO }
                };
                (0..n).map(each).collect()
            })
            .collect();
        let coefficient = |i: isize, j: usize| {
            let of = |(k, row): (usize, &Vec<Complex64>)| {
                let phase = TAU * ((k as isize * i).rem_euclid(m as isize)) as f64 / m as f64;
                let across = |l: usize| (TAU * (l * j % n) as f64 / n as f64).cos();
                let sum: Complex64 = row.iter().enumerate().map(|(l, own)| across(l) * own).sum();
                (sum * Complex64::cis(phase)).re
            };
            symbols.iter().enumerate().map(of).sum::<f64>() / (m * n) as f64
        };
        let m = m as isize;
        (0..n).map(|j| (1 - m..m).map(|i| coefficient(i, j)).collect()).collect()
    }

    /// Coefficients of bodies that end, as for [`SteadySliding::solve_by`].
    pub fn coefficients(&self) -> Vec<Vec<f64>> {
        self.of_recursion(Time::Exact)
    }

    /// Coefficients of bodies that end: f(x) = ∫ e^(−s/l) K(x + s) ds/l = I(x) + e^(−d/l) f(x + d), and the like of sums for steps.
    fn of_recursion(&self, time: Time) -> Vec<Vec<f64>> {
        (0..self.cells[1]).map(|j| self.row_of(time, &|x| self.influence(x, j))).collect()
    }

    fn row_of(&self, time: Time, kernel: &dyn Fn(f64) -> f64) -> Vec<f64> {
        let ([m, _], [d, _]) = (self.cells, self.spacing);
        let last = m as isize - 1;
        let far = (last + 1) as f64 * d;
        let at = |i: isize| kernel(i as f64 * d);
        // ∫ e^(−s/l) K(far + s) ds from `start`
        let tail = |l: f64, start: f64| {
            let (mut sum, mut from, mut width) = (0.0, start, (0.5 * far).min(l));
            while from < 45.0 * l {
                sum += points(from, from + width, 1).map(|(s, w)| w * (-s / l).exp() * kernel(far + s)).sum::<f64>();
                (from, width) = (from + width, (2.0 * width).min(2.0 * l));
            }
            sum
        };
        let mut row = vec![0.0; (2 * last + 1) as usize];
        let mut add = |weight: f64, mut sum: f64, decay: f64, own: &dyn Fn(isize) -> f64| {
            for i in (-last..=last).rev() {
                sum = own(i) + decay * sum;
                row[(last + i) as usize] += weight * sum;
            }
        };
        match time {
            Time::Exact => {
                add(self.glassy, 0.0, 0.0, &at);
                for &(c, l) in &self.terms {
                    // the kernel has its kinks at the sides of its cell, half way
                    let own = |i: isize| {
                        let weighted = |s: f64| (-s / l).exp() / l * kernel(i as f64 * d + s);
                        points(0.0, d, 4).map(|(s, w)| w * weighted(s)).sum::<f64>()
                    };
                    add(c, tail(l, 0.0) / l, (-d / l).exp(), &own);
                }
            }
            Time::Corrected => panic!("of periodic bodies only"),
            Time::Steps => {
                let (at_once, decaying) = self.steps();
                add(at_once, 0.0, 0.0, &at);
                for (next, y) in decaying {
                    // Σ ρ^(k − 1) K(far + k d) from k = 1, by the integral from 1/2 on
                    let l = -d / (-y).ln_1p();
                    add(next, tail(l, 0.5 * d) / d / (1.0 - y), 1.0 - y, &|i| at(i + 1));
                }
            }
        }
        row
    }

    /// K at x along the motion from a cell, j cells across it: Love's integral, or of ln(D/|x|) over a side.
    pub fn influence(&self, x: f64, j: usize) -> f64 {
        let [a, b] = self.spacing.map(|side| 0.5 * side);
        if let Below::Line(datum) = self.below {
            let primitive = |x: f64| if x == 0.0 { 0.0 } else { x * ((x.abs() / datum).ln() - 1.0) };
            return -FRAC_2_PI * (primitive(x + a) - primitive(x - a));
        }
        let y = j as f64 * self.spacing[1];
        if x.hypot(y) > 1e3 * a.max(b) {
            return 4.0 * a * b / (PI * x.hypot(y)); // where the differences cancel
        }
        love([x, y], self.spacing)
    }
}
