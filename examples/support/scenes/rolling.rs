//! A cylinder that rolls, without friction, over a standard linear solid, in its steady state: an independent formulation.

use std::f64::consts::FRAC_2_PI;

use faer::linalg::solvers::Solve;
use faer::{ColMut, Mat};

/// A cylinder of radius R under P on a unit of length, rolling along x1 at v over a half-plane of contact compliance
/// C(t) = C0 + C1 (1 − e^(−t/λ)), everything a function of v λ alone.
#[derive(Debug, Clone, Copy)]
pub struct RollingCylinder {
    pub radius: f64,
    pub per_length: f64,
    pub glassy: f64,
    pub delayed: f64,
    /// v λ \[m\].
    pub reach: f64,
}

/// The steady state.
#[derive(Debug, Clone)]
pub struct Steady {
    pub positions: Vec<f64>,
    pub pressure: Vec<f64>,
    pub side: f64,
}

impl Steady {
    pub fn peak(&self) -> f64 {
        self.pressure.iter().copied().fold(0.0, f64::max)
    }

    /// Ends of contact, where p² of the last cells extrapolates to zero.
    pub fn ends(&self) -> [f64; 2] {
        let touched: Vec<usize> = (0..self.pressure.len()).filter(|&i| self.pressure[i] > 0.0).collect();
        let (first, last) = (touched[0], touched[touched.len() - 1]);
        let beyond = |end: usize, inner: usize| {
            let [p, q] = [end, inner].map(|i| self.pressure[i].powi(2));
            (p / (q - p)).clamp(0.0, 1.0)
        };
        [
            self.positions[first] - beyond(first, first + 1) * self.side,
            self.positions[last] + beyond(last, last - 1) * self.side,
        ]
    }

    /// Lateral over normal force: ∫ p x/R over ∫ p.
    pub fn friction(&self, radius: f64) -> f64 {
        let moment: f64 = self.positions.iter().zip(&self.pressure).map(|(x, p)| x * p).sum();
        moment / self.pressure.iter().sum::<f64>() / radius
    }
}

impl RollingCylinder {
    /// Half the width of the contact of an elastic body of this compliance, and its greatest pressure (Hertz).
    pub fn hertz(&self, compliance: f64) -> (f64, f64) {
        let a = (4.0 * self.per_length * self.radius * compliance / std::f64::consts::PI).sqrt();
        (a, FRAC_2_PI * self.per_length / a)
    }

    /// u at y beyond a unit line load, less what is the same everywhere: the load passed y/v ago. With
    /// u = C0 V + (C1/vλ) ∫ e^(−s/vλ) V(y + s) ds and V = −(2/π) ln|y|.
    fn displacement(&self, y: f64) -> f64 {
        let z = y / self.reach;
        let memory = if z > 0.0 { scaled_e1(z) } else { -scaled_ei(-z) };
        -FRAC_2_PI * ((self.glassy + self.delayed) * y.abs().ln() + self.delayed * memory)
    }

    /// The pressure on cells of a thousandth of the relaxed contact's width or so, from a dense system: on the cells in
    /// contact u = ω − x²/2R and ∫ p = P; cells that pull leave, cells that penetrate join.
    pub fn steady(&self, cells: usize) -> Steady {
        let (widest, _) = self.hertz(self.glassy + self.delayed);
        let side = 2.6 * widest / cells as f64;
        let positions: Vec<f64> = (0..cells).map(|i| (i as f64 + 0.5) * side - 1.3 * widest).collect();
        // the mean over the source's cell: the logarithm's own near it, Gauss' points elsewhere
        let log_cell = |y: f64| {
            let primitive = |x: f64| if x == 0.0 { 0.0 } else { x * x.abs().ln() - x };
            (primitive(y + 0.5 * side) - primitive(y - 0.5 * side)) / side
        };
        let points = [-0.5, -0.3, -0.1, 0.1, 0.3, 0.5].map(|x: f64| 0.94 * x);
        let influence: Vec<f64> = (0..2 * cells - 1)
            .map(|k| {
                let y = (k as f64 - (cells - 1) as f64) * side;
                // u has a logarithm of weight C0 at its source: the rest is smooth but for y ln|y|
                let smooth = |y: f64| self.displacement(y) + FRAC_2_PI * self.glassy * y.abs().ln();
                let rest: f64 = points.iter().map(|x| smooth(y + x * side)).sum::<f64>() / points.len() as f64;
                rest - FRAC_2_PI * self.glassy * log_cell(y)
            })
            .collect();
        let at = |i: usize, j: usize| influence[i + cells - 1 - j] * side;
        let (mut active, mut approach) = ((0..cells).filter(|&i| positions[i].abs() < widest).collect::<Vec<_>>(), 0.0);
        let mut pressure = vec![0.0; cells];
        for _ in 0..200 {
            let n = active.len();
            let parabola = |i: usize| positions[i] * positions[i] / (2.0 * self.radius);
            // [influence, −1; side, 0] [p; ω] = [−parabola; P]
            let row = |i: usize| -> Vec<f64> {
                let left = active.iter().map(|&j| if i == n { side } else { at(active[i], j) });
                let end = if i == n { [0.0, self.per_length] } else { [-1.0, -parabola(active[i])] };
                left.chain(end).collect()
            };
            let solution = eliminate((0..=n).map(row).collect());
            approach = solution[n];
            pressure.fill(0.0);
            active.iter().enumerate().for_each(|(i, &k)| pressure[k] = solution[i]);
            let before = active.clone();
            active = (0..cells)
                .filter(|&i| {
                    let u = || before.iter().map(|&j| at(i, j) * pressure[j]).sum::<f64>();
                    if pressure[i] != 0.0 { pressure[i] > 0.0 } else { u() + parabola(i) - approach < 0.0 }
                })
                .collect();
            if active == before {
                break;
            }
        }
        assert!(pressure.iter().all(|p| *p >= 0.0) && approach.is_finite());
        Steady { positions, pressure, side }
    }
}

/// The solution of a linear system, the right-hand side in the last column.
pub fn eliminate(rows: Vec<Vec<f64>>) -> Vec<f64> {
    let matrix = Mat::from_fn(rows.len(), rows.len(), |i, j| rows[i][j]);
    let mut solution: Vec<f64> = rows.iter().map(|row| row[rows.len()]).collect();
    matrix.partial_piv_lu().solve_in_place(ColMut::from_slice_mut(&mut solution).as_mat_mut());
    solution
}

/// e^z E1(z) for z > 0: the series of E1 or its continued fraction (Abramowitz & Stegun 5.1.11, 5.1.22).
pub fn scaled_e1(z: f64) -> f64 {
    if z < 2.0 {
        let (mut sum, mut term) = (0.0, 1.0);
        for n in 1..60 {
            term *= -z / f64::from(n);
            sum -= term / f64::from(n);
        }
        return z.exp() * (sum - z.ln() - EULER);
    }
    let depth = 40 + (200.0 / z) as i32;
    let mut fraction = 0.0;
    for n in (1..=depth).rev() {
        let n = f64::from(n);
        fraction = n / (1.0 + n / (z + fraction));
    }
    1.0 / (z + fraction)
}

/// e^(−z) Ei(z) for z > 0: its series, or where that is long the asymptotic one.
pub fn scaled_ei(z: f64) -> f64 {
    if z < 40.0 {
        let (mut sum, mut term) = (0.0, 1.0);
        for n in 1..200 {
            term *= z / f64::from(n);
            sum += term / f64::from(n);
        }
        return (-z).exp() * (sum + z.ln() + EULER);
    }
    let (mut sum, mut term) = (0.0, 1.0);
    for n in 1..=30 {
        sum += term;
        term *= f64::from(n) / z;
    }
    sum / z
}

const EULER: f64 = 0.577_215_664_901_532_9;
