//! Steps of periodic bodies: conjugate gradients in the gap.
//!
//! On a period K has an inverse M, wave by wave. With the lift x = h − z of the surface over its gap z before any
//! traction, the creep of the past included, the net traction of a state in balance is q = M x/c + p, and its energy
//! E = Σ ½ x (q + p) − ∫ₕ^∞ s. Only the stiffness of the mean and p differ between loads: a force fixes the mean of
//! q, a spring sets its stiffness in series with the bodies, and a given approach of bodies whose mean is held fixes
//! the mean of h, with a multiplier λ. Free tilts are two more [modes](super::balance::Tilts) beside the mean. So the loads are in
//! balance in every iteration.
//!
//! E falls along conjugate directions (Polak & Ribière, Rev. Fr. Inform. Rech. Opér. 16, 1969) of the gradient
//! r = q + s(h) − λ on the cells that are open or open, with K as their preconditioner; the wall is a bound
//! (two-metric projection, Bertsekas, SIAM J. Control Optim. 20, 1982). A step along them is exact without
//! transforms. Where E bends down along a direction, surfaces jump: far from balance the step follows the convex part
//! of E, which stays in the valley of the state before, and near balance it leads to the first minimum.

use std::sync::atomic::Ordering;

use super::balance::Balance;
use super::front::{Front, Moved};
use super::passes::InGap;
use super::{Attracted, AttractedStep};
use crate::equilibrium::Trial;
use crate::equilibrium::window::Window;
use crate::error::{AdhesionError, Error, Result, StepError};
use crate::kernel::PeriodInverse;
use crate::load::Load;
use crate::parallel::for_each_band;
use crate::solver::{Counts, ModeCoefficients, Solution};

/// Greatest number of iterations.
const MAX_ITERATIONS: usize = 2000;
/// A step that raises E is shortened by this factor, so many times.
const SHORTER: f64 = 0.4;
const SHORTENINGS: usize = 12;
/// Rounding of E, over the sum of its parts.
const ROUNDING: f64 = 1e-13;
/// At this curvature over the curvature of the convex part the tolerance of r is what was asked; below, r is to be
/// smaller by the same factor, since the error is r over the curvature. The least of so many iterations counts.
const SOFT: f64 = 0.2;
const REMEMBERED: usize = 8;
/// A mode that is soft shows in the curvature once stiff ones are out of r: after so many iterations.
const LEAST_MEASURED: usize = 3;
const SMALLEST: f64 = 1e-3;
/// Before any iteration r may be smooth, as what the far field has left is, and is worth more: it is to be smaller by
/// this factor.
const SMOOTH: f64 = 0.1;
/// Where the curvature was less than this along some direction, the softest one is looked for before the step ends;
/// and so often at most, as long as it is softer than this at its end. Where the state before was stiffer than this,
/// and the attraction no steeper since, none is looked for.
const SUSPECT: f64 = 0.85;
const VERY_SOFT: f64 = 0.005;
const NEAR_FOLD: f64 = 0.25;
const LOOKS: usize = 4;
/// A state whose energy bends down by more than this is none.
const UNSTABLE: f64 = -1e-5;
/// q is computed afresh after so many iterations.
const FRESH: usize = 50;
/// Bodies without contact whose attraction carries this part of the load, or less, fly apart.
const CARRIED: f64 = 0.5;

/// A descent in the gap: what it reads, and what it writes. In the trial x takes the place of the potential, q of the
/// attraction, and r of the pressure.
pub(super) struct Descent<'a> {
    pub(super) problem: &'a AttractedStep<'a>,
    pub(super) balance: Balance,
    pub(super) inverse: &'a mut PeriodInverse,
    pub(super) own: &'a mut Attracted,
    pub(super) window: &'a mut Window,
    pub(super) trial: &'a mut Trial,
    pub(super) counts: &'a mut Counts,
}

impl AttractedStep<'_> {
    /// Writes z, s, K (z − s) and the motion of the guess of a descent: extrapolated, or of undeformed bodies, which
    /// just touch under a force.
    pub(super) fn begin_in_gap(&self, window: &Window, trial: &mut Trial) {
        let (state, step, rows) = (self.state, self.step, self.state.held.region.rows());
        self.open_gap(window, trial);
        trial.free[0] = self.wanted;
        self.extrapolate(trial);
        let datum = step.indenter.gap().datum;
        let motion = if state.is_undisturbed() {
            let lowest = rows.least(trial.gap.iter().fold(f64::INFINITY, |low, &h| low.min(h)));
            if let Load::Spring { drive, .. } = step.loads[0] { lowest.min(drive - datum) } else { lowest }
        } else {
            let [now, before] = [&state.held.current, &state.previous].map(|state| state.motions[0].approach);
            now + trial.reach * (now - before) - datum
        };
        trial.solution.motions[0] = ModeCoefficients([if self.wanted.translation { motion } else { 0.0 }, 0.0, 0.0]);
        if self.wanted.tilts() && !state.is_undisturbed() {
            let modes = state.held.region.modes(self.wanted);
            let [now, before] =
                [&state.held.current, &state.previous].map(|at| modes.coefficients(self.free_motion(at)));
            trial.solution.motions[0] = now.plus(trial.reach, now.plus(-1.0, before));
        }
    }

    /// The greatest |r| that ends a descent, over the greatest traction: the error is r over the curvature.
    pub(super) fn tolerance(&self, softness: f64) -> f64 {
        self.limit() * (softness / SOFT).clamp(SMALLEST, 1.0)
    }
}

impl Descent<'_> {
    /// Finishes z, s and K (z − s) of the trial from their guess, in the gap of the trial.
    pub(super) fn run(&mut self) -> Result<()> {
        let AttractedStep { state, step, stop, wanted, .. } = *self.problem;
        let (limit, time, region) = (self.problem.limit(), step.interval.time, &state.held.region);
        if self.lift() || state.held.extrapolation.refresh_is_due() {
            let Descent { balance, inverse, window, trial, counts, .. } = self;
            let Solution { potential: x, attraction: q, .. } = &mut trial.solution;
            balance.tractions(inverse, window, x, q, false);
            counts.convolutions += 1;
        }
        let mut energy = self.energy();
        let (mut steepest, mut has_last) = (0.0, false);
        // of the last iterations, of all, and of the direction that was looked for
        let (mut measured, mut least) = ([1.0_f64; REMEMBERED], 1.0_f64);
        let mut softest = self.own.softest;
        let (mut plain, mut front) = (false, Front::new(region.cells(), region.folded()));
        let mut looks = if self.own.looks { 0 } else { LOOKS };
        for iteration in 0..=MAX_ITERATIONS {
            let mut gradient = self.gradient();
            if !(gradient.greatest.is_finite() && energy[0].is_finite()) {
                let what = "the residual of the contact problem";
                return Err(Error::Step(StepError::Overflow { time, what }));
            }
            let recent = measured.iter().fold(1.0_f64, |least, &soft| least.min(soft));
            let soft = if iteration < LEAST_MEASURED { self.own.softness } else { recent }.min(softest.unwrap_or(1.0));
            let mut leaves = None;
            let share = if iteration == 0 { SMOOTH } else { 1.0 };
            if gradient.greatest <= share * self.own.exactness * self.problem.tolerance(soft) {
                let stiffness = softest.unwrap_or_else(|| self.least_stiffness());
                let suspected = match softest {
                    Some(_) => stiffness < VERY_SOFT && self.ends(gradient, soft, softest),
                    None => (least < SUSPECT || iteration < LEAST_MEASURED) && stiffness < NEAR_FOLD,
                };
                if suspected && looks < LOOKS {
                    let softness = self.softest(looks);
                    looks += 1;
                    (gradient, energy) = (self.gradient(), self.energy());
                    (softest, has_last) = (Some(softness), false);
                    if softness < UNSTABLE {
                        leaves = Some((self.way_out(gradient), softness));
                        softest = None;
                    }
                }
                let soft = soft.min(softest.unwrap_or(1.0));
                if leaves.is_none() && self.ends(gradient, soft, softest) {
                    self.own.softness = if iteration == 0 { self.own.softness } else { soft };
                    self.own.softest = softest;
                    self.trial.solution.stiffness = softest.unwrap_or(stiffness.min(recent));
                    self.trial.solution.residual = gradient.greatest / limit * stop.tolerance;
                    self.finish(gradient.multiplier);
                    return Ok(());
                }
            }
            if stop.cancelled.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
                return Err(Error::Cancelled { what: "a step" });
            }
            let pull = -wanted.total;
            if matches!(step.loads[0], Load::Force { .. })
                && pull > 0.0
                && gradient.at_wall == 0.0
                && gradient.attraction <= CARRIED * pull
            {
                return Err(AdhesionError::PulledOff {
                    time,
                    force: -pull * self.problem.state.held.region.cell_area(),
                }
                .into());
            }
            self.own.report.passes += 1;
            self.counts.iterations += 1;
            let (mut length, curvature) = if let Some(leaves) = leaves {
                leaves
            } else {
                if plain {
                    let opposite = self.own.in_gap().direction.iter_mut().zip(&self.trial.solution.pressure);
                    opposite.for_each(|(direction, r)| *direction = -r);
                    steepest = 0.0;
                } else {
                    steepest = self.turn(steepest, has_last);
                }
                let Descent { balance, inverse, own, window, counts, .. } = self;
                let InGap { direction, image, .. } = own.in_gap();
                balance.tractions(inverse, window, direction, image, true);
                counts.convolutions += 1;
                self.length(gradient)
            };
            measured[iteration % REMEMBERED] = curvature;
            least = least.min(curvature);
            let mut kept = false;
            let (whole, shortenings) = (length, if leaves.is_some() { 2 * SHORTENINGS } else { SHORTENINGS });
            for shortening in 0..if length > 0.0 { shortenings } else { 0 } {
                if shortening == SHORTENINGS {
                    // beside a corner of the law E may fall on the other side
                    let InGap { direction, image, .. } = self.own.in_gap();
                    direction.iter_mut().chain(image).for_each(|value| *value = -*value);
                    length = whole;
                }
                self.go_along(length, iteration % FRESH == FRESH - 1);
                let tried = self.swap_energy();
                let rise = (tried[0] - energy[0]) / energy[1];
                if rise <= ROUNDING {
                    self.own.report.rise = self.own.report.rise.max(rise - ROUNDING);
                    (energy, kept) = (tried, true);
                    break;
                }
                self.own.report.rejected += 1;
                self.swap_energy();
                length *= SHORTER;
            }
            if !kept && plain {
                break;
            }
            if !kept && leaves.is_some() {
                // on neither side: a state, or a mix of directions at a corner of the law
                measured[iteration % REMEMBERED] = 1.0;
                continue;
            }
            // where the wall turns the direction of the preconditioner uphill, the gradient itself leads down
            plain = !kept && !has_last;
            has_last = kept && leaves.is_none();
            self.own.in_gap().traction.copy_from_slice(&self.trial.solution.pressure);
            let Trial { gap, solution, .. } = &*self.trial;
            let x = &solution.potential;
            if let Some(moved) = front.look(gradient.greatest, gap.len(), |k| gap[k] + x[k] <= 0.0) {
                let tried = self.move_front(&moved);
                front.learn(tried[0] < energy[0]);
                if tried[0] < energy[0] {
                    (energy, has_last) = (tried, false);
                } else {
                    self.swap_energy();
                    let InGap { image, traction, .. } = self.own.in_gap();
                    std::mem::swap(image, traction);
                }
            }
        }
        let change = self.gradient().greatest;
        Err(self.problem.not_converged(self.own, change))
    }

    /// Writes x + `length` d, kept to h ≥ 0, and its q to what is tried; where the wall or the mean changed it, or on demand, q is computed afresh.
    fn go_along(&mut self, length: f64, afresh: bool) {
        let Descent { balance, inverse, own, window, trial, counts, .. } = self;
        let Solution { potential: x, attraction: q, .. } = &trial.solution;
        let InGap { direction, image, lift, traction } = own.in_gap();
        for_each_band([&mut *lift], |first, [lift]| {
            lift.iter_mut().zip(first..).for_each(|(lift, k)| *lift = x[k] + length * direction[k]);
        });
        if balance.project(window.kernel.rows(), &trial.gap, lift) || afresh {
            balance.tractions(inverse, window, lift, traction, false);
            counts.convolutions += 1;
        } else {
            let tractions = q.iter().zip(&*image);
            traction.iter_mut().zip(tractions).for_each(|(next, (q, image))| *next = q + length * image);
        }
    }

    /// Tries the profile beside a running edge further on; returns its energy. r of the last iteration stays, in the place of M d.
    fn move_front(&mut self, moved: &Moved) -> [f64; 2] {
        let Descent { balance, inverse, own, window, trial, counts, .. } = self;
        let (gap, x) = (&trial.gap, &trial.solution.potential);
        let InGap { lift, image, traction, .. } = own.in_gap();
        for (k, tried) in lift.iter_mut().enumerate() {
            let from = moved.source(k, gap.len());
            let rise = gap[from] - gap[k];
            *tried = x[from] + if rise.is_finite() { rise } else { 0.0 };
        }
        balance.project(window.kernel.rows(), gap, lift);
        balance.tractions(inverse, window, lift, image, false);
        counts.convolutions += 1;
        std::mem::swap(image, traction);
        self.swap_energy()
    }

    /// Exchanges x and q of the trial for the tried ones; returns their energy.
    fn swap_energy(&mut self) -> [f64; 2] {
        let InGap { lift, traction, .. } = self.own.in_gap();
        std::mem::swap(lift, &mut self.trial.solution.potential);
        std::mem::swap(traction, &mut self.trial.solution.attraction);
        self.energy()
    }

    /// Writes the lift x of z, s, K (z − s) and the motion of the trial, and its q but for what the wall changes; returns whether that is so.
    fn lift(&mut self) -> bool {
        let Descent { problem, balance, trial, .. } = self;
        let (rows, Trial { gap, solution, .. }) = (problem.state.held.region.rows(), &mut **trial);
        let Solution { pressure, attraction: q, potential: x, motions, .. } = solution;
        let (c, motion, modes) = (balance.compliance, motions[0], problem.state.held.region.modes(problem.wanted));
        for_each_band([&mut *x, &mut *q], |first, [x, q]| {
            for (((x, q), z), k) in x.iter_mut().zip(q).zip(&pressure[first..]).zip(first..) {
                (*x, *q) = (c * *x - modes.displacement(motion, k), z - *q);
            }
        });
        let [of_x, of_q] = [&*x, &*q].map(|field| rows.sum(field) / field.len() as f64);
        let shift = balance.of_mean * of_x + balance.offset - of_q;
        q.iter_mut().for_each(|q| *q += shift);
        let mut opens = balance.tilts.is_some();
        // cells under pressure stay in contact
        for ((x, _), gap) in x.iter_mut().zip(&*pressure).zip(&*gap).filter(|((_, z), _)| **z > 0.0) {
            opens |= gap + *x != 0.0;
            *x = -gap;
        }
        balance.project(&rows, gap, x) || opens
    }

    /// From x and q of the trial its z, s and K (z − s), and its motion.
    fn finish(&mut self, multiplier: f64) {
        let Descent { problem, balance, trial, .. } = self;
        let (c, cells) = (balance.compliance, trial.gap.len() as f64);
        let rows = problem.state.held.region.rows();
        let Trial { solution, gap, .. } = &mut **trial;
        let (x, q) = (&mut solution.potential, &mut solution.attraction);
        q.iter_mut().for_each(|q| *q -= multiplier);
        let mean = |field: &[f64]| rows.sum(field) / cells;
        let motion = if problem.wanted.translation { c * balance.inverse[1] * mean(q) - mean(x) } else { 0.0 };
        let upright = ModeCoefficients([motion, 0.0, 0.0]);
        let motion = balance.tilts.as_ref().map_or(upright, |tilts| ModeCoefficients(tilts.motion(&rows, x, false)));
        let modes = problem.state.held.region.modes(problem.wanted);
        let greatest = problem.law.traction(0.0);
        for ((((x, q), z), gap), k) in x.iter_mut().zip(q).zip(&mut solution.pressure).zip(gap).zip(0..) {
            *z = if *gap + *x <= 0.0 { (*q + greatest).max(0.0) } else { 0.0 };
            (*x, *q) = ((*x + modes.displacement(motion, k)) / c, *z - *q);
        }
        solution.motions[0] = motion;
    }
}
