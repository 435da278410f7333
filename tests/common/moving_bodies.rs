//! Bodies under a steady pressure that moves: a dense reference, by quadrature of the history of each pair of cells.
//!
//! A point x in the frame of the pressure was at x + v s a time s before. A term C (1 − e^(−t/λ)) of the creep displaces by
//! C ∫ e^(−t) K(x + l t) dt, l = v λ, and resists by the symmetric part of −∂u/∂x,
//!
//! −½ C ∫ e^(−t) (K′(x + l t) − K′(x − l t)) dt = −½ C l ∫ e^(−t) (K″(x + l t) + K″(x − l t)) dt,
//!
//! of which the second holds where no side of the cell is near. What layers add is smooth, and integrated over waves.

use std::f64::consts::{FRAC_2_PI, PI, TAU};

use super::gauss::points;
use super::love::love;
use viscocontact::Layer;
use viscocontact::num_complex::Complex64;
use viscocontact::prelude::*;

/// Contact compliance C(0) + Σ C_k (1 − e^(−t/λ_k)) \[1/Pa\].
#[derive(Debug, Clone)]
pub struct Creep {
    pub glassy: f64,
    pub terms: Vec<(f64, f64)>,
}

impl Creep {
    pub fn times(&self, factor: f64) -> Creep {
        Creep { glassy: factor * self.glassy, terms: self.terms.iter().map(|(c, time)| (factor * c, *time)).collect() }
    }

    /// The conjugate of the complex compliance: of waves that go with the motion.
    pub fn at(&self, omega: f64) -> Complex64 {
        let term = |&(c, time): &(f64, f64)| {
            let x = omega * time;
            let square = 1.0 + x * x;
            if x.abs() > 1e100 { Complex64::new(0.0, c / x) } else { Complex64::new(c / square, c * x / square) }
        };
        self.glassy + self.terms.iter().map(term).sum::<Complex64>()
    }

    pub fn relaxed(&self) -> f64 {
        self.glassy + self.terms.iter().map(|(c, _)| c).sum::<f64>()
    }

    /// Response and loss of a kernel with its derivatives, at a distance x.
    fn of_history(&self, kernel: &Kernel<'_>, x: f64, speed: f64) -> [f64; 2] {
        let terms =
            self.terms.iter().map(|&(c, time)| (c, kernel.moved(x, speed * time), kernel.lost(x, speed * time)));
        terms.fold([self.glassy * (kernel.value)(x), 0.0], |sum, (c, moved, lost)| {
            [sum[0] + c * moved, sum[1] + c * lost]
        })
    }

    /// A body of this Poisson's ratio: C is (1 − ν)/2 of J.
    pub fn material(&self, nu: f64) -> Material {
        let scale = 2.0 / (1.0 - nu);
        let terms: Vec<_> = self.terms.iter().map(|(c, time)| (scale * c, *time)).collect();
        Material::constant_poisson(GeneralizedKelvin::new(scale * self.glassy, 0.0, &terms).unwrap(), nu).unwrap()
    }
}

/// What lies below the layer.
#[derive(Debug, Clone)]
pub enum Base {
    /// More of the same.
    None,
    Rigid,
    Frictionless,
    /// A half-space that creeps alike, so many times as much.
    Body(f64),
}

/// A half-space or a layer, loaded on a grid.
#[derive(Debug, Clone)]
pub struct Bodies {
    pub periodic: [bool; 2],
    pub cells: [usize; 2],
    pub spacing: [f64; 2],
    pub creep: Creep,
    pub nu: f64,
    pub base: Base,
    pub base_nu: f64,
    pub thickness: f64,
    pub datum: f64,
    /// Whether cells that are periodic aside are a line contact.
    pub as_line: bool,
}

/// Influences by the distance of cells along x1 and x2.
#[derive(Debug, Clone)]
pub struct Influence {
    cells: [usize; 2],
    /// Displacement, and the symmetric parts of −∂u/∂x1 and −∂u/∂x2.
    of: Vec<[f64; 3]>,
}

impl Influence {
    fn new(cells: [usize; 2], of: impl Fn(isize, isize) -> [f64; 3]) -> Influence {
        let [e1, e2] = cells.map(|n| n as isize);
        let all = (1 - e1..e1).flat_map(|i| (1 - e2..e2).map(move |j| (i, j)));
        Influence { cells, of: all.map(|(i, j)| of(i, j)).collect() }
    }

    fn sum(&self, part: usize, p: &[f64]) -> Vec<f64> {
        let [n1, n2] = self.cells;
        let pressed: Vec<usize> = (0..p.len()).filter(|&k| p[k] != 0.0).collect();
        let at =
            |k: usize, l: usize| self.of[(n1 - 1 + k / n2 - l / n2) * (2 * n2 - 1) + n2 - 1 + k % n2 - l % n2][part];
        (0..p.len()).map(|k| pressed.iter().map(|&l| at(k, l) * p[l]).sum()).collect()
    }

    pub fn displacement(&self, p: &[f64]) -> Vec<f64> {
        self.sum(0, p)
    }

    /// −∬ p ∇u over the area of a cell.
    pub fn drag(&self, p: &[f64]) -> [f64; 2] {
        [1, 2].map(|part| self.sum(part, p).iter().zip(p).map(|(own, p)| own * p).sum())
    }

    /// Rounding of the sums of the drag.
    pub fn rounding_of_drag(&self, p: &[f64]) -> f64 {
        let sizes: Vec<[f64; 3]> = self.of.iter().map(|of| of.map(f64::abs)).collect();
        let sizes = Influence { cells: self.cells, of: sizes }.drag(p);
        1e-13 * sizes[0].max(sizes[1])
    }
}

impl Bodies {
    pub fn lengths(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.cells[axis] as f64 * self.spacing[axis])
    }

    pub fn grid(&self) -> Grid {
        Grid::new(self.cells, self.lengths()).unwrap()
    }

    pub fn layer(&self) -> Option<Layer> {
        let made = match &self.base {
            Base::None => return None,
            Base::Rigid => Layer::bonded_to_rigid(self.thickness, self.nu),
            Base::Frictionless => Layer::frictionless_on_rigid(self.thickness, self.nu),
            Base::Body(times) => {
                let shear_ratio = times * (1.0 - self.nu) / (1.0 - self.base_nu);
                Layer::bonded_to_half_space(self.thickness, self.nu, shear_ratio, self.base_nu)
            }
        };
        Some(made.unwrap())
    }

    pub fn kernel(&self) -> InfluenceKernel {
        let grid = self.grid();
        let along = if self.periodic[0] { Axis::X1 } else { Axis::X2 };
        let datum = matches!(self.base, Base::Body(_)).then_some(self.datum);
        match (self.layer(), self.periodic) {
            (None, _) if self.as_line => InfluenceKernel::line(&grid, self.datum),
            (Some(layer), _) if self.as_line => InfluenceKernel::layer_line(&grid, layer, datum),
            (None, [true, true]) => InfluenceKernel::periodic(&grid),
            (None, [false, false]) => InfluenceKernel::half_space(&grid),
            (None, _) => InfluenceKernel::periodic_along(&grid, along, self.datum),
            (Some(layer), [true, true]) => InfluenceKernel::layer_periodic(&grid, layer),
            (Some(layer), [false, false]) => InfluenceKernel::layer(&grid, layer),
            (Some(layer), _) => InfluenceKernel::layer_periodic_along(&grid, layer, along, datum),
        }
        .unwrap()
    }

    /// The influences of a motion with this velocity: along an axis unless the bodies are periodic along both.
    pub fn influence(&self, velocity: [f64; 2]) -> Influence {
        if self.periodic == [true; 2] {
            return self.of_waves(velocity);
        }
        // in plane strain a motion along the lines changes nothing
        let lines = (0..2).find(|&axis| self.periodic[axis] && self.cells[axis] == 1);
        let axis = lines.map_or(usize::from(velocity[0] == 0.0), |lines| 1 - lines);
        let (forward, speed) = (velocity[axis] >= 0.0, velocity[axis].abs());
        let [n, m] = [self.cells[axis], self.cells[1 - axis]];
        let rows: Vec<Vec<[f64; 2]>> = match [self.periodic[axis], self.periodic[1 - axis]] {
            [false, false] => self.of_cells(axis, speed),
            [false, true] => {
                let waves: Vec<_> = (0..=m / 2).map(|k| self.of_wave_aside(axis, k, speed)).collect();
                let mean = |j: usize, i: usize| {
                    (0..waves.len()).fold([0.0; 2], |[response, loss], k| {
                        let count = if k == 0 || 2 * k == m { 1.0 } else { 2.0 };
                        let part = count * (TAU * (k * j % m) as f64 / m as f64).cos() / m as f64;
                        [response + part * waves[k][i][0], loss + part * waves[k][i][1]]
                    })
                };
                (0..m).map(|j| (0..2 * n - 1).map(|i| mean(j, i)).collect()).collect()
            }
            _ => (0..m).map(|j| self.along_period(axis, j, speed)).collect(),
        };
        Influence::new(self.cells, |i, j| {
            let (along, aside) = if axis == 0 { (i, j) } else { (j, i) };
            let along = if forward { along } else { -along };
            let [response, loss] = rows[aside.unsigned_abs()][(n as isize - 1 + along) as usize];
            let mut both = [0.0; 2];
            both[axis] = if forward { loss } else { -loss };
            [response, both[0], both[1]]
        })
    }

    /// L of the wave q (D. M. Burmister, 1945; Lebedev & Ufliand, 1958).
    fn response(&self, q: f64) -> f64 {
        let t = q * self.thickness;
        // Burmister's (1 + 4tθκ − λκθ²) / (1 − (λ + κ(1 + 4t²)) θ + λκθ²), θ = e^(−2t), as sums of positive numbers: a stiff
        // layer leaves no digits of the denominator
        let bonded = |mu: f64| {
            let [k1, k2] = [3.0 - 4.0 * self.nu, 3.0 - 4.0 * self.base_nu];
            let (kappa, a, b) = ((mu - 1.0) / (mu + k1), (1.0 + k1) / (1.0 + mu * k2), (1.0 + k1) / (mu + k1));
            let (theta, less) = ((-2.0 * t).exp(), -(-2.0 * t).exp_m1());
            let bends = theta * 4.0 * sinh_less(t) * (t.sinh() + t);
            let top = -(-4.0 * t).exp_m1() + theta * theta * (a + b - a * b) + 4.0 * t * theta * kappa;
            top / (bends + theta * less * (a + b) + a * b * theta * theta + 4.0 * t * t * theta * b)
        };
        match &self.base {
            _ if t > 60.0 => 1.0,
            Base::None => 1.0,
            Base::Rigid => {
                let k = 3.0 - 4.0 * self.nu;
                let sinh = 2.0 * k * (2.0 * t).sinh() - 4.0 * t;
                sinh / (2.0 * k * (2.0 * t).cosh() + k * k + 1.0 + 4.0 * t * t)
            }
            Base::Frictionless => 2.0 * t.sinh() * t.sinh() / ((2.0 * t).sinh() + 2.0 * t),
            Base::Body(times) => bonded(times * ((1.0 - self.nu) / (1.0 - self.base_nu))),
        }
    }

    /// The compliance of the base over that of the layer.
    fn below(&self) -> f64 {
        if let Base::Body(times) = self.base { times } else { 0.0 }
    }

    /// (2/q) C₁ (L − 1).
    fn added(&self, q: f64, omega: f64) -> Complex64 {
        2.0 / q * self.creep.at(omega) * (self.response(q) - 1.0)
    }

    fn of_waves(&self, velocity: [f64; 2]) -> Influence {
        let cells = self.cells;
        let unit = self.lengths().map(|length| TAU / length);
        // a wave of alternating cells moves both ways
        let numbers = |k: usize, n: usize| match (2 * k).cmp(&n) {
            std::cmp::Ordering::Less => vec![k as f64],
            std::cmp::Ordering::Equal => vec![k as f64, -(k as f64)],
            std::cmp::Ordering::Greater => vec![k as f64 - n as f64],
        };
        let wave = |k: [usize; 2]| {
            let all = [0, 1].map(|axis| numbers(k[axis], cells[axis]));
            let part = 1.0 / (all[0].len() * all[1].len()) as f64;
            let each = all[0].iter().flat_map(|a| all[1].iter().map(move |b| [a * unit[0], b * unit[1]]));
            each.fold((Complex64::ZERO, [0.0; 2]), |(sum, loss), q| {
                let (length, omega) = (q[0].hypot(q[1]), q[0] * velocity[0] + q[1] * velocity[1]);
                let own = part
                    * if length > 0.0 {
                        2.0 / length * self.creep.at(omega) * self.response(length)
                    } else {
                        let rigid = matches!(self.base, Base::Rigid | Base::Frictionless);
                        let mean = self.thickness * (1.0 - 2.0 * self.nu) / (1.0 - self.nu).powi(2);
                        self.creep.at(0.0) * if rigid { mean } else { 0.0 }
                    };
                (sum + own, [0, 1].map(|axis| loss[axis] + q[axis] * own.im))
            })
        };
        let waves: Vec<_> =
            (0..cells[0]).flat_map(|k| (0..cells[1]).map(move |l| [k, l])).map(|k| (k, wave(k))).collect();
        let all = cells.map(|n| n as isize);
        let phase = |k: usize, i: isize, n: isize| TAU * (k as isize * i).rem_euclid(n) as f64 / n as f64;
        let at = |i: isize, j: isize| {
            let sum = waves.iter().fold([0.0; 3], |sum, ([k, l], (own, loss))| {
                let (sin, cos) = (phase(*k, i, all[0]) + phase(*l, j, all[1])).sin_cos();
                [sum[0] + own.re * cos - own.im * sin, sum[1] + loss[0] * cos, sum[2] + loss[1] * cos]
            });
            sum.map(|value| value / (cells[0] * cells[1]) as f64)
        };
        let period: Vec<Vec<[f64; 3]>> = (0..all[0]).map(|i| (0..all[1]).map(|j| at(i, j)).collect()).collect();
        Influence::new(cells, |i, j| period[i.rem_euclid(all[0]) as usize][j.rem_euclid(all[1]) as usize])
    }

    fn of_cells(&self, axis: usize, speed: f64) -> Vec<Vec<[f64; 2]>> {
        let [(n, d), (m, side)] = [axis, 1 - axis].map(|axis| (self.cells[axis], self.spacing[axis]));
        let row = |j: usize| {
            let y = j as f64 * side;
            let corners = |x: f64, of: &dyn Fn(f64, f64) -> f64| {
                let [a, b] = [0.5 * d, 0.5 * side];
                (of(x + a, y + b) - of(x + a, y - b) - of(x - a, y + b) + of(x - a, y - b)) / PI
            };
            let far = |x: f64| x.hypot(y) > 1e3 * d.max(side);
            let area = d * side / PI;
            // with the second moments of the cell: the history of fast motions lies far away
            let from_afar = |x: f64| {
                let r = x.hypot(y);
                let moments = d * d * (2.0 * x * x - y * y) + side * side * (2.0 * y * y - x * x);
                area / r * (1.0 + moments / r / r / r / r / 24.0)
            };
            let kernel = Kernel {
                half: 0.5 * d,
                aside: (y - 0.5 * side).max(0.0),
                value: &|x| if far(x) { from_afar(x) } else { love([x, y], [d, side]) },
                slope: &|x| {
                    let of = |x: f64, y: f64| (y / x.abs().max(1e-300)).asinh();
                    if far(x) { -area * x / x.hypot(y).powi(3) } else { corners(x, &of) }
                },
                curvature: &|x| {
                    let of = |x: f64, y: f64| -y / (x * x.hypot(y));
                    let r = x.hypot(y);
                    if far(x) { area * (2.0 * x * x - y * y) / r / r / r.powi(3) } else { corners(x, &of) }
                },
            };
            (0..2 * n - 1).map(|i| self.creep.of_history(&kernel, (i as f64 - (n - 1) as f64) * d, speed)).collect()
        };
        let mut rows: Vec<Vec<[f64; 2]>> = (0..m).map(row).collect();
        if !matches!(self.base, Base::None) {
            self.add_rings(axis, speed, &mut rows);
        }
        rows
    }

    /// What the layer adds, over rings of waves: bounded at their middle.
    fn add_rings(&self, axis: usize, speed: f64, rows: &mut [Vec<[f64; 2]>]) {
        let [(n, d), (_, side)] = [axis, 1 - axis].map(|axis| (self.cells[axis], self.spacing[axis]));
        let reach = self.longest(axis, speed);
        let last = 20.0 / self.thickness;
        let mut rings: Vec<(f64, f64)> = Vec::new();
        // stiff layers on soft bases change within waves much longer than all
        let mut end = 1e-9 / reach;
        rings.extend(points(0.0, end, 1));
        while end < last {
            let next = (2.0 * end).min(end + 6.0 / (n as f64 * d)).min(last);
            rings.extend(points(end, next, 1));
            end = next;
        }
        let mut waves = vec![[0.0; 2]; 2 * n - 1];
        for (q, weight) in rings {
            // finer where waves pass slowly
            let mut angles: Vec<(f64, f64)> = Vec::new();
            let mut from = 0.0;
            let mut end = (1e-3 / (q * reach)).min(0.1);
            while from < PI / 2.0 {
                angles.extend(points(from, end, 1));
                (from, end) = (end, (2.0 * end).min(end + 0.2).min(PI / 2.0));
            }
            for (angle, part) in angles {
                let [along, aside] = [q * angle.sin(), q * angle.cos()];
                let own = self.added(q, along * speed)
                    * (q * weight * part / (PI * PI) * d * side)
                    * (of_cell(along, d) * of_cell(aside, side));
                for (i, wave) in waves.iter_mut().enumerate() {
                    let (sin, cos) = (along * (i as f64 - (n - 1) as f64) * d).sin_cos();
                    *wave = [own.re * cos - own.im * sin, along * own.im * cos];
                }
                for (j, row) in rows.iter_mut().enumerate() {
                    let cos = (aside * side * j as f64).cos();
                    for (value, wave) in row.iter_mut().zip(&waves) {
                        (0..2).for_each(|part| value[part] += cos * wave[part]);
                    }
                }
            }
        }
    }

    /// The longest length on which anything changes along an axis.
    fn longest(&self, axis: usize, speed: f64) -> f64 {
        let reaches = self.creep.terms.iter().map(|(_, time)| speed * time);
        reaches.fold(self.thickness.max(self.lengths()[axis]), f64::max)
    }

    /// (1/π) ∫ over q > 0, along an axis, of what a wave adds to the half-space, times `wave` of q, and the loss of it. The
    /// wave κ aside, or along the motion. Of the mean, a load buried in either body is taken out, at another depth than the crate's.
    fn integral(&self, axis: usize, x: f64, kappa: f64, (moves, speed): (bool, f64)) -> (Complex64, f64) {
        if matches!(self.base, Base::None) {
            return (Complex64::ZERO, 0.0);
        }
        let (h, d) = (self.thickness, self.spacing[axis]);
        let (mut sum, mut loss) = (Complex64::ZERO, 0.0);
        let last = 20.0 / h;
        let reach = if moves { self.longest(axis, speed) } else { self.longest(axis, 0.0) };
        let (mut from, mut end) = (0.0, 1e-4 / reach.max(self.datum));
        while from < last {
            for (q, weight) in points(from, end, 1) {
                let total = q.hypot(kappa);
                let along = if moves { q } else { kappa };
                let part = weight * of_cell(q, d) * d / PI;
                let buried =
                    (self.below() - 1.0) * self.creep.at(along * speed) * (2.0 / total * (-DEPTH * total * h).exp());
                let own = self.added(total, along * speed) - if kappa > 0.0 { Complex64::ZERO } else { buried };
                let wave = if moves { Complex64::from_polar(1.0, q * x) } else { Complex64::from((q * x).cos()) };
                sum += own * wave * part;
                loss += along * own.im * (q * x).cos() * part;
            }
            (from, end) = (end, (2.0 * end).min(end + 3.0 / (x.abs() + self.spacing[axis])).min(last));
        }
        (sum, loss)
    }

    /// What is taken from the mean so that the relaxed bodies displace nothing at the datum; on a rigid base nothing.
    fn at_datum(&self, axis: usize) -> f64 {
        let Base::Body(_) = self.base else { return 0.0 };
        // −(2/π) ln is zero there, and so is the half-space; as of a line, at the datum
        let mut still = self.clone();
        still.creep = Creep { glassy: self.creep.relaxed(), terms: Vec::new() };
        still.spacing[axis] = 1e-3 * self.spacing[axis];
        let (h, side) = (self.thickness, still.spacing[axis]);
        let buried = (self.below() - 1.0) * still.creep.glassy * buried(self.datum, DEPTH * h, side, self.datum);
        (still.integral(axis, self.datum, 0.0, (true, 0.0)).0.re + buried) * 1e3
    }

    /// Response and loss of the wave k aside.
    fn of_wave_aside(&self, axis: usize, k: usize, speed: f64) -> Vec<[f64; 2]> {
        let (n, d) = (self.cells[axis], self.spacing[axis]);
        let kappa = TAU * k as f64 / self.lengths()[1 - axis];
        let (half, datum) = (0.5 * d, self.datum);
        let kernel = Kernel {
            half,
            aside: 0.0,
            value: &|x| strip(x, d, kappa, datum),
            slope: &|x| match kappa {
                // far away the ratio has no digits left of its difference from 1
                0.0 if x.abs() > 4.0 * half => -FRAC_2_PI * x.signum() * (2.0 * half / (x.abs() - half)).ln_1p(),
                0.0 => -FRAC_2_PI * ((x + half).abs().max(1e-300) / (x - half).abs().max(1e-300)).ln(),
                _ => FRAC_2_PI * (k0(kappa * (x + half).abs()) - k0(kappa * (x - half).abs())),
            },
            curvature: &|x| match kappa {
                0.0 => -FRAC_2_PI * (1.0 / (x + half) - 1.0 / (x - half)),
                _ => {
                    let k1 = |x: f64| kappa * k1(kappa * x.abs()) * x.signum();
                    FRAC_2_PI * (k1(x - half) - k1(x + half))
                }
            },
        };
        let at_datum = if k == 0 { self.at_datum(axis) } else { 0.0 };
        let z = DEPTH * self.thickness;
        let layered = k == 0 && !matches!(self.base, Base::None);
        // of the half-space less the load buried in it nothing is left far away
        let less = Kernel {
            value: &|x| (kernel.value)(x) - buried(x, z, d, datum),
            slope: &|x| (kernel.slope)(x) + slope_below(x, half, z),
            curvature: &|x| {
                let part = |x: f64| x / (x * x + z * z);
                (kernel.curvature)(x) + FRAC_2_PI * (part(x + half) - part(x - half))
            },
            ..kernel
        };
        let below = Kernel {
            half,
            aside: z,
            value: &|x| buried(x, z, d, datum),
            slope: &|x| -slope_below(x, half, z),
            curvature: &|x| {
                let part = |x: f64| x / (x * x + z * z);
                FRAC_2_PI * (part(x - half) - part(x + half))
            },
        };
        let at = |i: usize| {
            let x = (i as f64 - (n - 1) as f64) * d;
            let (rest, lost) = self.integral(axis, x, kappa, (true, speed));
            let mut both = self.creep.of_history(if layered { &less } else { &kernel }, x, speed);
            if layered {
                let of_base = self.creep.times(self.below()).of_history(&below, x, speed);
                (0..2).for_each(|part| both[part] += of_base[part]);
            }
            [both[0] + rest.re - at_datum, both[1] + lost]
        };
        (0..2 * n - 1).map(at).collect()
    }

    /// Response and loss along a periodic axis, j cells aside.
    fn along_period(&self, axis: usize, j: usize, speed: f64) -> Vec<[f64; 2]> {
        let (n, side) = (self.cells[axis], self.spacing[1 - axis]);
        let x = j as f64 * side;
        let wave = |k: usize| {
            let kappa = TAU * k as f64 / self.lengths()[axis];
            let mut own = self.creep.at(kappa * speed) * strip(x, side, kappa, self.datum);
            let (rest, lost) = self.integral(1 - axis, x, kappa, (false, speed));
            let lost = kappa * own.im + lost;
            if k == 0 && !matches!(self.base, Base::None) {
                own +=
                    (self.below() - 1.0) * self.creep.relaxed() * buried(x, DEPTH * self.thickness, side, self.datum);
                own -= self.at_datum(1 - axis);
            }
            (own + rest, lost)
        };
        let waves: Vec<_> = (0..=n / 2).map(wave).collect();
        let at = |i: usize| {
            waves.iter().enumerate().fold([0.0; 2], |[response, loss], (k, (own, lost))| {
                let (sin, cos) = (TAU * (k * (i + 1) % n) as f64 / n as f64).sin_cos();
                let (count, sin) = if k > 0 && 2 * k < n { (2.0 / n as f64, sin) } else { (1.0 / n as f64, 0.0) };
                [response + count * (own.re * cos - own.im * sin), loss + count * lost * cos]
            })
        };
        (0..2 * n - 1).map(at).collect()
    }
}

/// The influence of a cell along an axis, with its derivatives; singular at the sides of the cell where none is `aside`.
struct Kernel<'a> {
    half: f64,
    aside: f64,
    value: &'a dyn Fn(f64) -> f64,
    slope: &'a dyn Fn(f64) -> f64,
    curvature: &'a dyn Fn(f64) -> f64,
}

/// e^(−t) is negligible from here on.
const LAST: f64 = 40.0;

impl Kernel<'_> {
    /// ∫ e^(−t) K(x + l t) dt.
    fn moved(&self, x: f64, l: f64) -> f64 {
        self.history(x, l, 1e-7, &|t| (self.value)(x + l * t))
    }

    /// The symmetric part of −∂/∂x of it.
    fn lost(&self, x: f64, l: f64) -> f64 {
        if LAST * l < (x.abs() - self.half).abs().hypot(self.aside) {
            return -0.5 * l * self.history(x, l, 1.0, &|t| (self.curvature)(x + l * t) + (self.curvature)(x - l * t));
        }
        -0.5 * self.history(x, l, 1e-11, &|t| (self.slope)(x + l * t) - (self.slope)(x - l * t))
    }

    /// ∫ e^(−t) g dt in panels as long as singular points are away, down to the `least` length of a panel.
    fn history(&self, x: f64, l: f64, least: f64, g: &dyn Fn(f64) -> f64) -> f64 {
        if l == 0.0 {
            return g(0.0);
        }
        let places = [x - self.half, x + self.half].map(|s| s.abs() / l);
        let (mut sum, mut open) = (0.0, vec![[0.0, LAST]]);
        while let Some([from, to]) = open.pop() {
            let away = |s: f64| (s - to).max(from - s).max(0.0).hypot(self.aside / l);
            let gap = places.into_iter().map(away).fold(f64::INFINITY, f64::min);
            if to - from > gap.max(least * to).min(3.0) {
                let middle = 0.5 * (from + to);
                open.extend([[from, middle], [middle, to]]);
            } else {
                sum += points(from, to, 1).map(|(t, weight)| weight * (-t).exp() * g(t)).sum::<f64>();
            }
        }
        sum
    }
}

/// The mean of a wave over a cell.
fn of_cell(q: f64, side: f64) -> f64 {
    let half = 0.5 * q * side;
    if half < 1e-5 { 1.0 } else { half.sin() / half }
}

/// Depth of a buried load over the thickness of the layer.
const DEPTH: f64 = 1.3;

/// −(1/π) ∫ ln((s² + z²)/D²) ds over a side.
fn buried(x: f64, z: f64, side: f64, datum: f64) -> f64 {
    let own = |s: f64| -((x + s).hypot(z) / datum).ln() * 2.0 / PI;
    points(-0.5 * side, 0.5 * side, if x.hypot(z) > 4.0 * side { 1 } else { 4 }).map(|(s, w)| w * own(s)).sum()
}

/// (2/π) ln of the ratio of the distances from both ends of a side, at a depth.
fn slope_below(x: f64, half: f64, z: f64) -> f64 {
    let near = x.abs() - half;
    0.5 * FRAC_2_PI * x.signum() * (4.0 * x.abs() * half / (near * near + z * z)).ln_1p()
}

/// (2/π) ∫ K0(κ |x − s|) ds over a side, or of −ln(|x − s|/D).
fn strip(x: f64, side: f64, kappa: f64, datum: f64) -> f64 {
    let (x, half) = (x.abs(), 0.5 * side);
    if kappa == 0.0 {
        if x > 1e3 * side {
            return -FRAC_2_PI * side * ((x / datum).ln() - (half / x).powi(2) / 6.0);
        }
        let primitive = |x: f64| if x == 0.0 { 0.0 } else { x * ((x.abs() / datum).ln() - 1.0) };
        return -FRAC_2_PI * (primitive(x + half) - primitive(x - half));
    }
    FRAC_2_PI / kappa * (k0_beyond(kappa * (x - half)) - k0_beyond(kappa * (x + half)))
}

/// ∫ e^(−z cosh t) cosh^n t dt over t > 0 by the trapezoidal rule, whose error is below e^(−π²/step) at any z.
fn waves_of(z: f64, n: i32) -> f64 {
    let step = 0.2;
    let term = |k: i32| (-z * (step * f64::from(k)).cosh()).exp() * (step * f64::from(k)).cosh().powi(n);
    step * (0.5 * term(0) + (1..).map(term).take_while(|term| *term > 1e-30).sum::<f64>())
}

fn k0(z: f64) -> f64 {
    waves_of(z.max(1e-300), 0)
}

fn k1(z: f64) -> f64 {
    waves_of(z, 1)
}

/// ∫ K0 from z on.
fn k0_beyond(z: f64) -> f64 {
    if z < 0.0 { PI - waves_of(-z, -1) } else { waves_of(z, -1) }
}

/// The Bessel functions against a table (Abramowitz & Stegun, table 9.8), and what they are at the ends.
pub fn check_bessel_functions() {
    let near = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    near(k0(1.0), 0.421_024_438_240_708_3);
    near(k1(1.0), 0.601_907_230_197_234_6);
    near(k0(1e-9), (2e9_f64).ln() - 0.577_215_664_901_532_9);
    near(1e-9 * k1(1e-9), 1.0);
    near(k0_beyond(0.0), 0.5 * PI);
    near(0.5 * PI - k0_beyond(1.0), 1.242_509_848_623_777_8);
}

/// sinh t − t.
fn sinh_less(t: f64) -> f64 {
    if t > 1.0 {
        return t.sinh() - t;
    }
    t * (1..12).rev().fold(0.0, |sum, k| (1.0 + sum) * t * t / f64::from(2 * k * (2 * k + 1)))
}
