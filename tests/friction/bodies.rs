//! Bodies of few cells with dense matrices of influence, their elastic states, and Coulomb's law on their cells: the
//! reference, which shares nothing with the crate.

use crate::common::draws::Draws;
use crate::common::quadratic::solve_definite;

/// A body of few cells, and the gap above each.
pub struct Body {
    pub influence: Vec<Vec<f64>>,
    pub gap: Vec<f64>,
}

impl Body {
    /// A rough half-space, ν = 0.
    pub fn half_space(n: usize, draws: &mut Draws) -> Body {
        let place = |k: usize| [(k / n) as f64, (k % n) as f64];
        let corner = |x: f64, y: f64| x * (y / x.abs()).asinh() + y * (x / y.abs()).asinh();
        let of = |a: usize, b: usize| {
            let [x, y] = [0, 1].map(|axis| place(a)[axis] - place(b)[axis]);
            corner(x + 0.5, y + 0.5) - corner(x + 0.5, y - 0.5) - corner(x - 0.5, y + 0.5) + corner(x - 0.5, y - 0.5)
        };
        let middle = 0.5 * n as f64;
        let gap = |k: usize| {
            let [x, y] = place(k);
            ((x - middle + 0.3).powi(2) + (y - middle - 0.2).powi(2)) / n as f64 + draws.between(-1.0, 1.0)
        };
        Body::new(n * n, of, gap)
    }

    /// A rough line of a period, whose mean is compliant.
    pub fn line(n: usize, draws: &mut Draws) -> Body {
        let wave = |distance: usize| {
            let angle = std::f64::consts::TAU * distance as f64 / n as f64;
            let term = |q: usize| 2.0 * (q as f64 * angle).cos() / (std::f64::consts::TAU * q as f64);
            let last = if n.is_multiple_of(2) { 0.5 * term(n / 2) } else { term(n / 2) };
            (0.6 + (1..n / 2).map(term).sum::<f64>() + last) / n as f64
        };
        let mut height = 0.0;
        let gap = |k: usize| {
            height += draws.between(-0.01, 0.01);
            8.0 * (k as f64 / n as f64 - 0.5).powi(2) + height
        };
        Body::new(n, |a, b| wave(a.abs_diff(b)), gap)
    }

    fn new(cells: usize, of: impl Fn(usize, usize) -> f64, gap: impl FnMut(usize) -> f64) -> Body {
        let scale = of(0, 0);
        let influence = (0..cells).map(|a| (0..cells).map(|b| of(a, b) / scale).collect()).collect();
        Body { influence, gap: (0..cells).map(gap).collect() }
    }

    pub fn displacement(&self, traction: &[f64]) -> Vec<f64> {
        self.influence.iter().map(|row| row.iter().zip(traction).map(|(k, t)| k * t).sum()).collect()
    }

    /// A force that presses on a part of the cells.
    pub fn force(&self) -> f64 {
        let [low, high] = [f64::min, f64::max].map(|of| self.gap.iter().copied().reduce(of).unwrap());
        0.02 * (high - low) * self.gap.len() as f64
    }

    /// Tractions on cells that are `held`, and the motion of the body, at which c K t + `free` is the share of the motion
    /// there and their sum a `force`; other cells carry what they have.
    pub fn held(
        &self,
        c: f64,
        free: &[f64],
        (cells, shares): (&[usize], &[f64]),
        tractions: &mut [f64],
        force: f64,
    ) -> f64 {
        let others: Vec<f64> =
            (0..tractions.len()).map(|k| if cells.contains(&k) { 0.0 } else { tractions[k] }).collect();
        let of_others = self.displacement(&others);
        let matrix: Vec<f64> =
            cells.iter().flat_map(|&a| cells.iter().map(move |&b| c * self.influence[a][b])).collect();
        let right: Vec<f64> = cells.iter().map(|&k| -free[k] - c * of_others[k]).collect();
        let moves: Vec<f64> = cells.iter().map(|&k| shares[k]).collect();
        let [fixed, moved] = [right, moves].map(|right| solve_definite(&matrix, &right).unwrap());
        let motion = (force - others.iter().sum::<f64>() - fixed.iter().sum::<f64>()) / moved.iter().sum::<f64>();
        cells
            .iter()
            .zip(fixed.iter().zip(&moved))
            .for_each(|(&k, (t, by_motion))| tractions[k] = t + motion * by_motion);
        motion
    }

    /// Pressures and approach under a force on a surface displaced by `free`.
    pub fn press(&self, c: f64, free: &[f64], force: f64) -> (Vec<f64>, f64) {
        let n = self.gap.len();
        let above: Vec<f64> = self.gap.iter().zip(free).map(|(gap, u)| gap + u).collect();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| above[a].total_cmp(&above[b]));
        let mut active = vec![false; n];
        order[..(n / 4).max(3)].iter().for_each(|&k| active[k] = true);
        for round in 0..400 {
            let cells: Vec<usize> = (0..n).filter(|&k| active[k]).collect();
            let mut pressure = vec![0.0; n];
            let approach = self.held(c, &above, (&cells, &vec![1.0; n]), &mut pressure, force);
            let most = pressure.iter().fold(0.0f64, |most, p| most.max(p.abs()));
            let displaced = self.displacement(&pressure);
            let pulls: Vec<usize> = cells.iter().copied().filter(|&k| pressure[k] < -1e-13 * most).collect();
            let inside = |k: &usize| !active[*k] && c * displaced[*k] + above[*k] - approach < -1e-12;
            let met: Vec<usize> = (0..n).filter(inside).collect();
            if pulls.is_empty() && met.is_empty() {
                return (pressure, approach);
            }
            pulls.iter().for_each(|&k| active[k] = false);
            if pulls.is_empty() || round < 5 || round % 3 == 0 {
                met.iter().for_each(|&k| active[k] = true);
            }
            if !active.contains(&true) {
                active[order[0]] = true;
            }
        }
        panic!("no contact found");
    }

    /// Tractions of Coulomb's law with a bound on each cell, and the motion of the body, where c K t + `free` is the
    /// motion of the surface, and each cell meets it for a share of the step.
    pub fn rub(&self, c: f64, free: &[f64], bound: &[f64], shares: &[f64], force: f64) -> (Vec<f64>, f64) {
        let n = bound.len();
        let mut slips = vec![0.0; n];
        for round in 0..500 {
            let mut traction: Vec<f64> = (0..n).map(|k| slips[k] * bound[k]).collect();
            let cells: Vec<usize> = (0..n).filter(|&k| bound[k] > 0.0 && slips[k] == 0.0).collect();
            let motion = self.held(c, free, (&cells, shares), &mut traction, force);
            let displaced = self.displacement(&traction);
            let most = bound.iter().copied().fold(0.0, f64::max);
            let slip = |k: usize| shares[k] * motion - free[k] - c * displaced[k];
            let far = (0..n).filter(|&k| bound[k] > 0.0).map(|k| slip(k).abs()).fold(1e-30, f64::max);
            let over: Vec<usize> =
                cells.iter().copied().filter(|&k| traction[k].abs() > bound[k] + 1e-12 * most).collect();
            let back: Vec<usize> = (0..n).filter(|&k| slips[k] * slip(k) < -1e-12 * far).collect();
            if over.is_empty() && back.is_empty() {
                return (traction, motion);
            }
            let (takes, leaves) = (round < 40 || round % 3 < 2, round < 40 || round % 3 != 1);
            over.iter().filter(|_| takes).for_each(|&k| slips[k] = traction[k].signum());
            back.iter().filter(|_| leaves).for_each(|&k| slips[k] = 0.0);
        }
        panic!("no slip found");
    }
}

/// A relaxation modulus E∞ + Σ E_i e^(−t/τ_i).
#[derive(Clone)]
pub struct Relaxation {
    pub equilibrium: f64,
    pub terms: Vec<(f64, f64)>,
}

/// One field times the displacement by another.
pub type Form<'a> = dyn Fn(&[f64], &[f64]) -> f64 + 'a;

/// Displacements that follow it, linear in each step, and v = E∗du.
#[derive(Clone)]
pub struct Past {
    pub now: Vec<f64>,
    stresses: Vec<Vec<f64>>,
}

impl Past {
    pub fn new(relaxation: &Relaxation, cells: usize) -> Past {
        Past { now: vec![0.0; cells], stresses: vec![vec![0.0; cells]; relaxation.terms.len()] }
    }
}

impl Relaxation {
    fn weights(&self, dt: f64) -> Vec<[f64; 2]> {
        let weight = |&(modulus, time): &(f64, f64)| {
            let z = dt / time;
            [(-z).exp(), modulus * if z > 0.0 { -(-z).exp_m1() / z } else { 1.0 }]
        };
        self.terms.iter().map(weight).collect()
    }

    /// The compliance of a step, and the displacement at its end if no v acts.
    pub fn step(&self, dt: f64, past: &Past) -> (f64, Vec<f64>) {
        let weights = self.weights(dt);
        let sum: f64 = weights.iter().map(|weight| weight[1]).sum();
        let c = 1.0 / (self.equilibrium + sum);
        let free = |k: usize| {
            let kept: f64 = weights.iter().zip(&past.stresses).map(|(weight, q)| weight[0] * q[k]).sum();
            c * (sum * past.now[k] - kept)
        };
        (c, (0..past.now.len()).map(free).collect())
    }

    /// What dashpots dissipate in a step that ends at `now`, with the displacements of `form`: q′ = E U′ − q/τ has
    /// q = a + b exp(−s/τ), whose square is integrated.
    pub fn dissipated(&self, dt: f64, past: &Past, now: &[f64], form: &Form<'_>) -> f64 {
        let of_term = |(&(modulus, time), q): (&(f64, f64), &Vec<f64>)| {
            let rate = |k: usize| modulus * time * (now[k] - past.now[k]) / dt;
            let a: Vec<f64> = (0..now.len()).map(rate).collect();
            let b: Vec<f64> = q.iter().zip(&a).map(|(q, a)| q - a).collect();
            let decay = (-dt / time).exp();
            let integrals = [dt, 2.0 * time * (1.0 - decay), 0.5 * time * (1.0 - decay * decay)];
            let squares = [form(&a, &a), form(&a, &b), form(&b, &b)];
            integrals.iter().zip(squares).map(|(of, square)| of * square).sum::<f64>() / (modulus * time)
        };
        if dt == 0.0 { 0.0 } else { self.terms.iter().zip(&past.stresses).map(of_term).sum() }
    }

    pub fn stored(&self, past: &Past, form: &Form<'_>) -> f64 {
        let springs = self.terms.iter().zip(&past.stresses).map(|(&(modulus, _), q)| form(q, q) / modulus);
        0.5 * (self.equilibrium * form(&past.now, &past.now) + springs.sum::<f64>())
    }

    pub fn commit(&self, dt: f64, past: &mut Past, now: Vec<f64>) {
        for ([decay, response], q) in self.weights(dt).into_iter().zip(&mut past.stresses) {
            q.iter_mut().enumerate().for_each(|(k, q)| *q = decay * *q + response * (now[k] - past.now[k]));
        }
        past.now = now;
    }
}
