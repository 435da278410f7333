//! The equations of a step in the gap: how the load enters them, and what they do to a field.

use super::AttractedStep;
use crate::equilibrium::window::Window;
use crate::kernel::{Mean, PeriodInverse};
use crate::linalg::{DEPENDENT, solve_normal_equations};
use crate::load::Load;
use crate::parallel::Rows;
use crate::solver::Counts;

/// The equations of a step: q = M x/c + b, where M gives the mean its stiffness.
pub(super) struct Balance {
    pub(super) compliance: f64,
    /// The stiffness of the mean of x, which replaces the one in M.
    pub(super) of_mean: f64,
    /// b.
    pub(super) offset: f64,
    /// Compliance of the mean, in the preconditioner.
    pub(super) soft: f64,
    /// Whether the mean of x is given.
    pub(super) held: bool,
    pub(super) mean: Mean,
    pub(super) tilts: Option<Tilts>,
}

/// What applies the equations to fields, and counts it.
pub(super) struct Operators<'a> {
    pub(super) balance: Balance,
    pub(super) inverse: &'a mut PeriodInverse,
    pub(super) window: &'a mut Window,
    pub(super) counts: &'a mut Counts,
}

/// Motions m of a body that tilts freely, with the modes B: x = c N q − B m, and Bᵀ q + D m carries the load, D being the
/// stiffness of a spring. So q = M x/c + W m with W = M B/c, and m follows from x.
pub(super) struct Tilts {
    images: [Vec<f64>; 3],
    /// Bᵀ W + D.
    gram: [[f64; 3]; 3],
    load: [f64; 3],
    /// The motion of x = 0.
    carried: [f64; 3],
}

impl Tilts {
    /// m of the lift x, or of a change of it.
    pub(super) fn motion(&self, rows: &Rows, x: &[f64], linear: bool) -> [f64; 3] {
        let held = rows.sum_terms(|k| Some([0, 1, 2].map(|j| self.images[j][k] * x[k])));
        let load = if linear { [0.0; 3] } else { self.load };
        self.solve([0, 1, 2].map(|j| load[j] - held[j]))
    }

    fn solve(&self, right: [f64; 3]) -> [f64; 3] {
        solve_normal_equations(&self.gram, right, DEPENDENT)
    }

    /// W m of a cell.
    fn at(&self, motion: [f64; 3], k: usize) -> f64 {
        (0..3).map(|j| self.images[j][k] * motion[j]).sum()
    }
}

impl Operators<'_> {
    pub(super) fn rows(&self) -> &Rows {
        self.window.kernel.rows()
    }

    /// Writes q of the lift x.
    pub(super) fn tractions(&mut self, x: &[f64], q: &mut [f64]) {
        self.apply(x, q, false);
    }

    /// Writes M d/c, by which q changes with the lift.
    pub(super) fn stiffen(&mut self, d: &[f64], image: &mut [f64]) {
        self.apply(d, image, true);
    }

    fn apply(&mut self, x: &[f64], q: &mut [f64], linear: bool) {
        let Operators { balance, inverse, window, counts } = self;
        counts.convolutions += 1;
        inverse.apply(x, q, &mut window.work);
        let rows = window.kernel.rows();
        let mean = rows.sum(x) / x.len() as f64;
        let stiffness = balance.of_mean - balance.mean.stiffness / balance.compliance;
        let add = stiffness * mean + if linear { 0.0 } else { balance.offset };
        q.iter_mut().for_each(|q| *q = *q / balance.compliance + add);
        if let Some(tilts) = &balance.tilts {
            let motion = tilts.motion(rows, x, linear);
            q.iter_mut().enumerate().for_each(|(k, q)| *q += tilts.at(motion, k));
        }
    }

    /// Applies c K, which is about the inverse of M/c.
    pub(super) fn precondition(&mut self, field: &mut [f64]) {
        let Operators { balance: Balance { compliance: c, soft, mean, .. }, window, counts, .. } = self;
        counts.convolutions += 1;
        let add = (*soft - *c * mean.compliance) * window.kernel.rows().sum(field) / field.len() as f64;
        window.kernel.apply_in_place(field, &mut window.work);
        field.iter_mut().for_each(|y| *y = *c * *y + add);
    }

    /// Moves x to what the wall and the load allow ([`Balance::project`]).
    pub(super) fn project(&self, gap: &[f64], x: &mut [f64]) -> bool {
        self.balance.project(self.rows(), gap, x)
    }

    /// Gives the balance the free tilts of the body, with the kernel that the window has.
    pub(super) fn free_tilts(&mut self, problem: &AttractedStep<'_>) {
        let AttractedStep { state, step, wanted, .. } = *problem;
        let region = &state.held.region;
        let modes = region.modes(wanted);
        let mut load = modes.load().map(|unit| wanted.total * unit);
        // M with the stiffness of the mean that the bodies have
        let balance = &mut self.balance;
        (balance.of_mean, balance.offset) = (1.0 / (balance.compliance * balance.mean.compliance), 0.0);
        let images = [0, 1, 2].map(|j| {
            let mode: Vec<f64> = (0..region.len()).map(|k| modes.at(k)[j]).collect();
            let mut image = vec![0.0; mode.len()];
            if modes.free()[j] {
                self.stiffen(&mode, &mut image);
            }
            image
        });
        let rows = self.window.kernel.rows();
        let mut gram = [0, 1, 2].map(|i| rows.sum_terms(|k| Some([0, 1, 2].map(|j| modes.at(k)[i] * images[j][k]))));
        if let Load::Spring { stiffness, drive, .. } = step.loads[0] {
            let stiffness = stiffness / region.cell_area();
            gram[0][0] += stiffness;
            load[0] = stiffness * (drive - step.indenter.gap().datum);
        }
        let mut tilts = Tilts { images, gram, load, carried: [0.0; 3] };
        tilts.carried = tilts.solve(load);
        self.balance.tilts = Some(tilts);
    }
}

impl Balance {
    /// b of a cell.
    pub(super) fn offset_at(&self, k: usize) -> f64 {
        self.offset + self.tilts.as_ref().map_or(0.0, |tilts| tilts.at(tilts.carried, k))
    }

    /// Moves x to h ≥ 0, and to its given mean by a shift; returns whether any cell moved.
    pub(super) fn project(&self, rows: &Rows, gap: &[f64], x: &mut [f64]) -> bool {
        let below = x.iter().zip(gap).any(|(x, g)| g + x < 0.0);
        if !self.held {
            if below {
                x.iter_mut().zip(gap).for_each(|(x, g)| *x = x.max(-g));
            }
            return below;
        }
        let scale: f64 = rows.sum_of_pairs(x, x, |x, _| x.abs()) * 1e-14 + f64::MIN_POSITIVE;
        // cells at the wall stay there, unless no other is left
        let (mut shift, mut lifts) = (0.0, false);
        for _ in 0..48 {
            let [sum, free] = rows.sum_terms(|k| {
                let h = gap[k] + x[k];
                let moves = (lifts || h > 0.0) && h + shift > 0.0;
                Some(if moves { [x[k] + shift, 1.0] } else { [-gap[k], 0.0] })
            });
            if sum.abs() <= scale || free == 0.0 && sum > 0.0 {
                break;
            }
            lifts |= free == 0.0;
            shift -= sum / if free > 0.0 { free } else { rows.len() as f64 };
        }
        if below || shift != 0.0 {
            for (x, g) in x.iter_mut().zip(gap) {
                *x = if lifts || g + *x > 0.0 { (*x + shift).max(-g) } else { -g };
            }
        }
        below || shift != 0.0
    }
}

impl AttractedStep<'_> {
    pub(super) fn balance(&self, window: &Window, inverse: &PeriodInverse) -> Balance {
        let (c, cells, wanted) = (self.compliance, window.kernel.rows().len() as f64, self.wanted);
        let mean @ Mean { stiffness, compliance } = inverse.mean;
        let held = compliance == 0.0 && !wanted.translation;
        let [of_mean, offset] = match self.step.loads[0] {
            Load::Approach { .. } if held => [0.0, 0.0],
            Load::Approach { .. } => [1.0 / (c * compliance), 0.0],
            Load::Force { .. } => [0.0, wanted.total / cells],
            Load::Spring { stiffness, drive, .. } => {
                let of_mean = 1.0 / (c * compliance + cells * self.state.held.region.cell_area() / stiffness);
                [of_mean, of_mean * (drive - self.step.indenter.gap().datum)]
            }
        };
        let soft = 1.0 / (of_mean + 0.5 * stiffness / c);
        Balance { compliance: c, of_mean, offset, soft, held, mean, tilts: None }
    }
}
