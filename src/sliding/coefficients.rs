//! Influence coefficients of creeping bodies under a pressure that moves along a row of cells.
//!
//! A term C_k (1 − e^(−t/λ)) of the creep displaces by C_k f p,
//!
//! f(x) = ∫ e^(−s/l) K(x + s) ds/l over s > 0, l = v λ:
//!
//! the influence K of where the pressure has been. All parts are positive, so that f follows without cancellation
//! from one recursion against the motion, f(x) = I(x) + e^(−d/l) f(x + d), with the integral I over one cell. The
//! tail beyond the grid is taken in panels that double.
//!
//! The term resists the motion by the symmetric part of −∂f/∂x = (K − f)/l,
//!
//! S(x) = (K(x) − ½ (f(x) + f(−x)))/l = ∫ e^(−s/l) (K(x) − ½ (K(x + s) + K(x − s))) ds/l² over s > 0.
//!
//! Where l is much shorter than the distance of x from the sides of the cell, K and f agree in almost all digits.
//! There S follows from the expansion of the integrand in s², so that each S is accurate whatever the reach.

use std::sync::OnceLock;

use crate::kernel;
use crate::quadrature::GaussLegendre;

/// The influence of a cell on a row of points, and its values at the points of the panels: these serve all reaches,
/// and both sides of the cell.
pub(super) struct RowOfCells {
    own: kernel::Row,
    /// Cells along the row, and their side \[m\].
    n: usize,
    d: f64,
    /// The influence at the middle of each cell.
    elastic: Vec<f64>,
    /// The cell of each panel, counted from the source, the panel, and the influence at its points.
    panels: Vec<(usize, Panel)>,
    values: Vec<f64>,
    /// The expansion of the loss at each cell, computed where a reach is short.
    expansions: OnceLock<Vec<[f64; ORDERS]>>,
}

/// Numbers of points of a panel.
const POINTS: [usize; 5] = [6, 8, 12, 16, 20];
/// Error of a panel relative to its integral.
const EXACT: f64 = 1e-15;
/// A kink is enclosed in a panel of this part of a cell.
const LEAST_PANEL: f64 = 1.0 / (1_u64 << 46) as f64;
/// What is left of a term after its tail.
const NEGLIGIBLE: f64 = 1e-19;
/// The loss of a reach below this part of a cell takes its expansion where that holds. Without it the drag of a
/// contact of n cells is in error by about 1e-15 n (d/l)².
const SHORT: f64 = 0.25;
/// The expansion holds up to this part of the distance from the sides of the cell: the first order left out is 7! l⁶
/// of the whole, 5e-9, and K − f would lose four digits.
const EXPANDED: f64 = 0.01;
/// Orders of the expansion, in l, l³ and l⁵.
const ORDERS: usize = 3;
/// Points on each side from which it follows, and the distance from the sides of the cell over their spacing:
/// interpolation is then in error by Π k²/20² = 3e-12, and the rounding of K grows by 20².
const SIDE: usize = 8;
const SPACINGS: f64 = 20.0;

/// A part of an interval: its begin and length \[m\], and the number of its points, an index of [`POINTS`].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Panel {
    begin: f64,
    length: f64,
    points: usize,
}

impl RowOfCells {
    /// A row of n cells of the side d.
    pub(super) fn new(own: kernel::Row, n: usize, d: f64, rules: &Rules) -> RowOfCells {
        let elastic = (0..n).map(|i| (own.influence)(i as f64 * d)).collect();
        let (panels, values, expansions) = (Vec::new(), Vec::new(), OnceLock::new());
        let mut row = RowOfCells { own, n, d, elastic, panels, values, expansions };
        let mut panels = Vec::new();
        for m in 0..n {
            let begin = m as f64 * d;
            row.panels(begin, d, LEAST_PANEL * d, &mut panels);
            for panel in panels.drain(..) {
                rules.each(&panel, |x| row.values.push((row.own.influence)(x)));
                row.panels.push((m, Panel { begin: panel.begin - begin, ..panel }));
            }
        }
        row
    }

    /// The smallest number of points that integrates over a panel exactly, as an index of [`POINTS`]: the error is
    /// ρ^(−n), ρ of the maximum ellipse about the panel in which the influence is analytic.
    fn points(&self, begin: f64, length: f64) -> Option<usize> {
        let rho = |at: f64| {
            let [x, y] = [(at - begin - 0.5 * length) / (0.5 * length), self.own.aside / (0.5 * length)];
            // half of the sum of the distances from the foci, the ends of the panel
            let axis = 0.5 * ((x - 1.0).hypot(y) + (x + 1.0).hypot(y));
            axis + (axis * axis - 1.0).max(0.0).sqrt()
        };
        let rho = rho(0.5 * self.d).min(rho(-0.5 * self.d));
        POINTS.iter().position(|&points| rho.powi(-(points as i32)) < EXACT)
    }

    /// Panels that integrate over an interval, halved towards singular points.
    fn panels(&self, begin: f64, length: f64, least: f64, panels: &mut Vec<Panel>) {
        match self.points(begin, length) {
            Some(points) => panels.push(Panel { begin, length, points }),
            None if length <= least => panels.push(Panel { begin, length, points: 0 }),
            None => {
                let half = 0.5 * length;
                self.panels(begin, half, least, panels);
                self.panels(begin + half, half, least, panels);
            }
        }
    }

    /// The side of a cell \[m\].
    pub(super) fn side(&self) -> f64 {
        self.d
    }

    /// The distance of the cell m from the sides of the source, where K has its singular points.
    fn distance(&self, m: usize) -> f64 {
        ((m as f64 - 0.5) * self.d).hypot(self.own.aside)
    }

    /// S of a reach l at the cells 0 to n − 1, from f at the cells −(n − 1) to n − 1.
    pub(super) fn losses(&self, reach: f64, f: &[f64], rules: &Rules) -> Vec<f64> {
        let RowOfCells { n, d, ref elastic, .. } = *self;
        let short = (reach < SHORT * d).then(|| self.expansions.get_or_init(|| self.expand(rules)));
        let loss = |m: usize| match short {
            Some(orders) if reach < EXPANDED * self.distance(m) => {
                reach * orders[m].iter().rev().fold(0.0, |sum, order| order + reach * reach * sum)
            }
            _ => (elastic[m] - 0.5 * (f[n - 1 + m] + f[n - 1 - m])) / reach,
        };
        (0..n).map(loss).collect()
    }

    /// (2m)! times the coefficients of s^(2m) in K(x) − ½ (K(x + s) + K(x − s)), m = 1, 2, 3, at each cell: by
    /// interpolation between points whose spacing is as many cells as fit, or less than one beside the source.
    fn expand(&self, rules: &Rules) -> Vec<[f64; ORDERS]> {
        let RowOfCells { n, d, ref elastic, ref own, .. } = *self;
        let stride = |m: usize| ((self.distance(m) / (SPACINGS * d)) as usize).min(n / (2 * SIDE));
        let last = (0..n).map(|m| m + SIDE * stride(m)).max().unwrap_or(0);
        let beyond: Vec<f64> = (n..=last).map(|k| (own.influence)(k as f64 * d)).collect();
        let of_cell = |k: usize| elastic.get(k).copied().unwrap_or_else(|| beyond[k - n]);
        let expansion = |m: usize| {
            let stride = stride(m);
            let spacing = if stride > 0 { stride as f64 * d } else { self.distance(m) / SPACINGS };
            let at = |k: isize| match stride {
                0 => (own.influence)((m as f64 * d + k as f64 * spacing).abs()),
                _ => of_cell((m as isize + k * stride as isize).unsigned_abs()),
            };
            let mut orders = [0.0; ORDERS];
            for (k, weights) in (1..).zip(&rules.even) {
                let curved = (elastic[m] - 0.5 * (at(k) + at(-k))) / (k * k) as f64;
                orders.iter_mut().zip(weights).for_each(|(order, weight)| *order += weight * curved);
            }
            let mut unit = 1.0;
            for (order, factorial) in orders.iter_mut().zip([2.0, 24.0, 720.0]) {
                unit *= spacing * spacing;
                *order *= factorial / unit;
            }
            orders
        };
        (0..n).map(expansion).collect()
    }

    /// K at the cells −(n − 1) to n − 1.
    pub(super) fn elastic(&self) -> impl Iterator<Item = f64> {
        (0..2 * self.n - 1).map(|i| self.elastic[i.abs_diff(self.n - 1)])
    }

    /// f of each of the `reaches` l at the cells −(n − 1) to n − 1.
    pub(super) fn terms(&self, reaches: &[f64], rules: &Rules) -> Vec<Vec<f64>> {
        let RowOfCells { n, d, .. } = *self;
        let mut ahead = vec![vec![0.0; n]; reaches.len()];
        let mut behind = ahead.clone();
        let mut weights: Vec<Vec<[Vec<f64>; 2]>> = Vec::new();
        let mut known = Vec::new();
        let mut values = &self.values[..];
        for cell in self.panels.chunk_by(|a, b| a.0 == b.0) {
            let (m, same) = (cell[0].0, cell.iter().map(|(_, panel)| *panel).collect::<Vec<_>>());
            // far from the singular points all cells have the same single panel
            if m == 0 || same.len() > 1 || known != same {
                weights =
                    reaches.iter().map(|&l| same.iter().map(|panel| rules.weights(panel, d, l)).collect()).collect();
                known = same;
            }
            let count = known.iter().map(|panel| POINTS[panel.points]).sum();
            let (own, rest) = values.split_at(count);
            values = rest;
            let sum = |weights: &[[Vec<f64>; 2]], side: usize| -> f64 {
                own.iter().zip(weights.iter().flat_map(|both| &both[side])).map(|(v, w)| v * w).sum()
            };
            for (k, weights) in weights.iter().enumerate() {
                (ahead[k][m], behind[k][m]) = (sum(weights, 0), sum(weights, 1));
            }
        }
        let tails = self.tails(n as f64 * d, reaches, rules);
        let each = reaches.iter().zip(tails).zip(ahead.iter().zip(&behind));
        each.map(|((&l, tail), (ahead, behind))| {
            let (decay, mut sum, mut row) = ((-d / l).exp(), tail, vec![0.0; 2 * n - 1]);
            for m in (0..n).rev() {
                sum = ahead[m] + decay * sum;
                row[n - 1 + m] = sum;
            }
            for m in 0..n - 1 {
                sum = behind[m] + decay * sum;
                row[n - 2 - m] = sum;
            }
            row
        })
        .collect()
    }

    /// f of each reach at the distance `from` \[m\].
    fn tails(&self, from: f64, reaches: &[f64], rules: &Rules) -> Vec<f64> {
        let (mut begin, mut length, mut panels) = (from, from, Vec::new());
        let mut tails = vec![0.0; reaches.len()];
        loop {
            let left: Vec<f64> = reaches.iter().map(|l| (-(begin - from) / l).exp()).collect();
            if left.iter().all(|&left| left < NEGLIGIBLE) {
                return tails;
            }
            panels.clear();
            self.panels(begin, length, LEAST_PANEL * from, &mut panels);
            for panel in &panels {
                let mut values = Vec::new();
                rules.each(panel, |x| values.push((self.own.influence)(x)));
                for (k, &l) in reaches.iter().enumerate().filter(|(k, _)| left[*k] >= NEGLIGIBLE) {
                    let own = Panel { begin: panel.begin - begin, ..*panel };
                    let [weights, _] = rules.weights(&own, length, l);
                    tails[k] += left[k] * values.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>();
                }
            }
            (begin, length) = (begin + length, 2.0 * length);
        }
    }
}

/// Gauss points of the panels with weights for an exponential times a polynomial, and weights of an expansion.
#[derive(Debug)]
pub(super) struct Rules {
    gauss: [GaussLegendre; POINTS.len()],
    /// The first coefficients of the polynomial in s² that is 1 at s = k and 0 at the other ones of 1 to [`SIDE`].
    even: [[f64; ORDERS]; SIDE],
}

/// From this half length over the reach on, the end of the panel alone has moments.
const STEEP: f64 = 1e5;
/// Below it a constant and a straight line alone have moments.
const FLAT: f64 = 1e-9;
/// The last panel of a cell is longer than this part of it: its ends are far from those of the source.
const LEAST_PART: f64 = 1e-3;

impl Rules {
    pub(super) fn new() -> Rules {
        let square = |k: usize| (k * k) as f64;
        let even = std::array::from_fn(|k| {
            let mut product = [1.0, 0.0, 0.0];
            for root in (1..=SIDE).filter(|root| *root != k + 1).map(square) {
                let scale = 1.0 / (square(k + 1) - root);
                let [a, b, c] = product;
                product = [-root * a, a - root * b, b - root * c].map(|value| scale * value);
            }
            product
        });
        Rules { gauss: POINTS.map(GaussLegendre::new), even }
    }

    /// Visits the points of a panel.
    fn each(&self, panel: &Panel, mut visit: impl FnMut(f64)) {
        for &(t, _) in self.gauss[panel.points].points() {
            visit(panel.begin + 0.5 * panel.length * (1.0 + t));
        }
    }

    /// Weights of ∫ e^(−s/l) g ds/l over a panel of the interval [0, `whole`], s from its begin, and from its end.
    fn weights(&self, panel: &Panel, whole: f64, reach: f64) -> [Vec<f64>; 2] {
        let moments = moments(panel.length / reach, POINTS[panel.points]);
        let of_point = |&(t, gauss): &(f64, f64)| {
            // Σ (k + 1/2) P_k(t) m_k
            let (mut before, mut now, mut sum) = (0.0, 1.0, 0.0);
            for (k, moment) in moments.iter().enumerate() {
                let k = k as f64;
                sum += (k + 0.5) * now * moment;
                (before, now) = (now, ((2.0 * k + 1.0) * t * now - k * before) / (k + 1.0));
            }
            gauss * sum
        };
        let own: Vec<f64> = self.gauss[panel.points].points().iter().map(of_point).collect();
        let after = whole - panel.begin - panel.length;
        // nothing is left after the last panel: rounding of it would count for a short reach
        let after = if after < LEAST_PART * whole { 0.0 } else { after };
        let [forward, mirrored] = [panel.begin, after].map(|s| (-s / reach).exp());
        [own.iter().map(|w| forward * w).collect(), own.iter().rev().map(|w| mirrored * w).collect()]
    }
}

/// λ ½ ∫ e^(−λ (1 + t)/2) P_k(t) dt over [−1, 1] = λ (−1)^k e^(−z) i_k(z), z = λ/2, i_k the modified spherical Bessel
/// functions (NIST Handbook of Mathematical Functions, 2010, 10.49 and 10.54).
fn moments(length_over_reach: f64, count: usize) -> Vec<f64> {
    let (lambda, z) = (length_over_reach, 0.5 * length_over_reach);
    let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    if z > STEEP {
        let end = |k: usize| {
            let a = (k * (k + 1)) as f64;
            sign(k) * (1.0 - a / (2.0 * z) * (1.0 - (a - 2.0) / (4.0 * z)))
        };
        return (0..count).map(end).collect();
    }
    let first = if z > 0.0 { -(-lambda).exp_m1() } else { 0.0 };
    if z < FLAT {
        return (0..count).map(|k| [first, -first * z / 3.0].get(k).copied().unwrap_or(0.0)).collect();
    }
    // i_k/i_(k−1) downwards from where it no longer matters
    let start = count + 20 + (9.0 * z.sqrt()) as usize;
    let mut ratios = vec![0.0; start + 1];
    for k in (1..start).rev() {
        ratios[k] = 1.0 / ((2 * k + 1) as f64 / z + ratios[k + 1]);
    }
    let mut value = first;
    let moment = |k: usize| {
        value *= if k == 0 { 1.0 } else { ratios[k] };
        sign(k) * value
    };
    (0..count).map(moment).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the integral by many points, from a constant weight to one at the begin.
    #[test]
    fn weights_integrate_an_exponential_times_a_polynomial() {
        let (rules, fine) = (Rules::new(), GaussLegendre::new(40));
        let reaches = [1e-9, 1e-6, 1e-5, 1e-3, 0.03, 0.3, 1.0, 50.0, 1e6, 1e12];
        for (begin, reach) in [0.0, 0.25, 0.5].into_iter().flat_map(|begin| reaches.map(|reach| (begin, reach))) {
            let panel = Panel { begin, length: 0.5, points: 1 };
            let g = |s: f64| 1.0 + s - 2.0 * s.powi(3) + s.powi(7);
            let pieces = |from: f64, to: f64, weight: &dyn Fn(f64) -> f64| {
                let (mut sum, mut begin, mut length) = (0.0, from, f64::min(0.1 * reach, to - from));
                while begin < to {
                    sum += fine.integrate(begin, begin + length, |s| weight(s) * g(s));
                    begin += length;
                    length = (2.0 * length).min(to - begin);
                }
                sum
            };
            let exact = [
                pieces(begin, begin + 0.5, &|s| (-s / reach).exp() / reach),
                // from the other end of the interval [0, 1], whose values are mirrored
                pieces(0.5 - begin, 1.0 - begin, &|s| (-s / reach).exp() / reach * g(1.0 - s) / g(s)),
            ];
            let mut values = Vec::new();
            rules.each(&panel, |s| values.push(g(s)));
            let weights = rules.weights(&panel, 1.0, reach);
            let found = [
                weights[0].iter().zip(&values).map(|(w, v)| w * v).sum::<f64>(),
                weights[1].iter().zip(&values).map(|(w, v)| w * v).sum::<f64>(),
            ];
            for k in 0..2 {
                assert!(
                    (found[k] - exact[k]).abs() <= 2e-12 * exact[k].abs() + 1e-300,
                    "{begin} {reach} {k}: {found:?} {exact:?}"
                );
            }
        }
    }
}
