//! Steps of periodic bodies: conjugate gradients in the gap.
//!
//! On a period K has an inverse M, wave by wave. With the lift x = h − g of the surface over its gap g before any
//! traction, the creep of the past included, the net traction of a state in balance is q = M x/c + b, and its energy
//! E = Σ ½ x (q + b) − ∫ₕ^∞ s. Only the stiffness of the mean and b differ between loads: a force fixes the mean of
//! q, a spring sets its stiffness in series with the bodies, and a given approach of bodies whose mean is held fixes
//! the mean of h, with a multiplier λ. Free tilts are two more [modes](super::balance::Tilts) beside the mean. So the loads are in
//! balance in every iteration.
//!
//! E falls along conjugate directions (Polak & Ribière, Rev. Fr. Inform. Rech. Opér. 16, 1969) of the gradient
//! r = q + s(h) − λ on the cells that are open, or that the gradient opens, with K as their preconditioner; the wall is a bound
//! (two-metric projection, Bertsekas, SIAM J. Control Optim. 20, 1982). A step along them is exact without
//! transforms. Where E bends down along a direction, surfaces jump: far from balance the step follows the convex part
//! of E, which stays in the valley of the state before, and near balance it leads to the first minimum.

use std::sync::atomic::Ordering;

use super::balance::Operators;
use super::front::{Front, Moved};
use super::passes::InGap;
use super::{Attracted, AttractedStep};
use crate::equilibrium::Trial;
use crate::error::{Error, Result, StepError};
use crate::load::Load;
use crate::parallel::for_each_band;
use crate::solver::Solution;

/// The numbers of a descent, and of its softest direction; curvatures are over those of the convex part. They were
/// chosen on `ADHESION_FOLDS`, `ADHESION_SCENES` and the steps of `adhesion_work`: what each changes there is in
/// docs/maintainers/tuned_numbers.md.
pub(super) struct DescentNumbers {
    /// A descent ends where r over the maximum traction, which is the error of the force, is below so many tolerances of
    /// the solver, but no more than this, unless the tolerance is coarse: then below this part of it.
    tolerances: f64,
    most_left: f64,
    part_left: f64,
    /// At this curvature r may be what was asked; below, it is to be smaller by the same factor, as far as a
    /// thousandth, since the error is r over the curvature.
    soft: f64,
    /// Before any iteration r may be smooth, as what the far field has left is, and is worth more: it is to be smaller
    /// by this factor.
    smooth: f64,
    /// Where the curvature was less than this along some direction, the softest one is looked for before the step ends,
    /// unless the state before was stiffer than this, and the attraction no steeper since; and so often at most, as
    /// long as it is softer than this at its end.
    suspect: f64,
    near_fold: f64,
    looks: usize,
    very_soft: f64,
    /// A point of balance where the energy bends down by more than this along a direction is a saddle.
    unstable: f64,
    /// Where r is less, over the maximum traction, a step of negative curvature leads to the first minimum; else it has
    /// the length of so many steps of the convex part.
    pub(super) near: f64,
    pub(super) longest: f64,
    /// What a line search leaves of the slope, and how often it, and other searches along a direction, try.
    pub(super) slope_left: f64,
    pub(super) tries: usize,
    /// The maximum change of the gap at first on the way from a state that is unstable, in ranges.
    pub(super) span: f64,
    /// The softest direction is looked for until its curvature is below this, or known to this part of it, and a
    /// direction of curvature 0 would have grown by half this power of e beyond it.
    pub(super) negative: f64,
    pub(super) precise: f64,
    pub(super) grown: f64,
}

pub(super) const DESCENT: DescentNumbers = DescentNumbers {
    tolerances: 100.0,
    most_left: 1e-4,
    part_left: 0.3,
    soft: 0.2,
    smooth: 0.1,
    suspect: 0.85,
    near_fold: 0.25,
    looks: 4,
    very_soft: 0.005,
    unstable: -1e-5,
    near: 0.1,
    longest: 4.0,
    slope_left: 0.1,
    tries: 10,
    span: 0.03,
    negative: -1e-2,
    precise: 0.2,
    grown: 8.0,
};

/// An energy over the area of a cell.
#[derive(Clone, Copy)]
pub(super) struct Energy {
    pub(super) value: f64,
    /// The sum of the magnitudes of its parts.
    pub(super) scale: f64,
}

/// The gradient of E on the cells that may move.
#[derive(Clone, Copy, Default)]
pub(super) struct Gradient {
    /// λ.
    pub(super) multiplier: f64,
    /// The largest |r|, over the maximum traction.
    pub(super) greatest: f64,
    /// Σ s, and the number of cells at the wall.
    pub(super) attraction: f64,
    pub(super) at_wall: f64,
}

/// A descent in the gap: what it reads, and what it writes, in these fields.
///
/// | field | in a descent | at a point that is tried | between steps |
/// |---|---|---|---|
/// | `solution.potential`, `attraction`, `pressure` | x, q, r | the same | K (z − s), s, z, the pressure of the wall |
/// | `in_gap.direction`, `image` | d, M d/c | the same | weights of the error now, and at the start |
/// | `in_gap.lift`, `traction` | K r, r of the iteration before | x, q | weights before; none |
pub(super) struct Descent<'a> {
    pub(super) problem: &'a AttractedStep<'a>,
    pub(super) operators: Operators<'a>,
    pub(super) own: &'a mut Attracted,
    pub(super) trial: &'a mut Trial,
}

/// How far a descent has come.
struct Trail {
    iteration: usize,
    energy: Energy,
    /// y·r of the last direction, to which the next one is conjugate; 0 where it is to none.
    last: f64,
    /// Curvatures along the last directions, and the least along any.
    recent: [f64; 8],
    least: f64,
    /// The curvature along the softest direction, where it was looked for, and how often it was.
    softest: Option<f64>,
    looks: usize,
    front: Front,
}

/// A step along the direction, and the curvature of E there over the one of its convex part.
#[derive(Clone, Copy)]
pub(super) struct Along {
    pub(super) length: f64,
    pub(super) curvature: f64,
}

/// What a point of a descent turns out to be.
enum Place {
    Minimum,
    /// A state that is unstable: the softest direction leads out.
    Saddle(Along),
    /// Neither: the descent goes on.
    Slope,
}

impl AttractedStep<'_> {
    /// The largest |r| that ends a descent, over the maximum traction: the error is r over the curvature.
    pub(super) fn tolerance(&self, softness: f64) -> f64 {
        self.limit() * (softness / DESCENT.soft).clamp(1e-3, 1.0)
    }

    /// The change of s over the maximum traction that ends a step.
    pub(super) fn limit(&self) -> f64 {
        let tolerance = self.stop.tolerance;
        (DESCENT.tolerances * tolerance).min((DESCENT.part_left * tolerance).max(DESCENT.most_left))
    }
}

impl Descent<'_> {
    /// Finishes z, s and K (z − s) of the trial from their guess, in the gap of the trial.
    pub(super) fn run(&mut self) -> Result<()> {
        let mut trail = self.begin();
        for iteration in 0..=self.problem.stop.max_iterations.saturating_mul(2) {
            trail.iteration = iteration;
            let mut gradient = self.gradient();
            self.may_go_on(gradient, trail.energy)?;
            let point = self.look(&mut trail, &mut gradient);
            if let Place::Minimum = point {
                self.finish(gradient.multiplier);
                return Ok(());
            }
            self.own.report.passes += 1;
            self.operators.counts.iterations += 1;
            let (along, steepest) = match point {
                Place::Saddle(along) => (along, None),
                _ => {
                    let steepest = self.turn(trail.last);
                    (self.length(gradient), Some(steepest))
                }
            };
            let last = iteration % trail.recent.len();
            trail.recent[last] = along.curvature;
            trail.least = trail.least.min(along.curvature);
            trail.last = match (self.go(along, &mut trail), steepest) {
                (true, steepest) => steepest.unwrap_or(0.0),
                (false, Some(_)) if trail.last > 0.0 => 0.0,
                (false, Some(_)) => break,
                (false, None) => {
                    // a state, or a mix of directions at a corner of the law
                    trail.recent[last] = 1.0;
                    continue;
                }
            };
            self.follow_front(&mut trail);
        }
        let change = self.gradient().greatest;
        Err(self.problem.not_converged(self.own, change))
    }

    fn begin(&mut self) -> Trail {
        let held = &self.problem.state.held;
        if self.lift() || held.extrapolation.refresh_is_due() {
            let Solution { potential: x, attraction: q, .. } = &mut self.trial.solution;
            self.operators.tractions(x, q);
        }
        Trail {
            iteration: 0,
            energy: self.energy(),
            last: 0.0,
            recent: [1.0; 8],
            least: 1.0,
            softest: self.own.softest,
            looks: if self.own.looks { 0 } else { DESCENT.looks },
            front: Front::new(held.region.cells(), held.region.folded()),
        }
    }

    /// Decides what the point is. Near a state that may be unstable it looks for the softest direction.
    fn look(&mut self, trail: &mut Trail, gradient: &mut Gradient) -> Place {
        let recent = trail.recent.iter().fold(1.0_f64, |least, &soft| least.min(soft));
        let soft = if trail.iteration == 0 { self.own.softness } else { recent };
        let soft = soft.min(trail.softest.unwrap_or(1.0));
        let share = if trail.iteration == 0 { DESCENT.smooth } else { 1.0 };
        if gradient.greatest > share * self.problem.tolerance(soft) {
            return Place::Slope;
        }
        let stiffness = trail.softest.unwrap_or_else(|| self.least_stiffness());
        let is_suspect = match trail.softest {
            Some(_) => stiffness < DESCENT.very_soft && self.ends(*gradient, soft),
            None => (trail.least < DESCENT.suspect || trail.iteration == 0) && stiffness < DESCENT.near_fold,
        };
        if is_suspect && trail.looks < DESCENT.looks {
            let curvature = self.find_softest(trail.looks);
            trail.looks += 1;
            (*gradient, trail.energy, trail.last) = (self.gradient(), self.energy(), 0.0);
            if curvature < DESCENT.unstable {
                trail.softest = None;
                return Place::Saddle(Along { length: self.way_out(*gradient), curvature });
            }
            trail.softest = Some(curvature);
        }
        let soft = soft.min(trail.softest.unwrap_or(1.0));
        if !self.ends(*gradient, soft) {
            return Place::Slope;
        }
        self.own.softest = trail.softest;
        if trail.iteration > 0 {
            self.own.softness = soft;
        }
        let solution = &mut self.trial.solution;
        solution.stiffness = trail.softest.unwrap_or(stiffness.min(recent));
        solution.residual = gradient.greatest / self.problem.limit() * self.problem.stop.tolerance;
        Place::Minimum
    }

    /// Ends the descent where a number overflows, the step is cancelled, or a force pulls off bodies that it has parted.
    fn may_go_on(&self, gradient: Gradient, energy: Energy) -> Result<()> {
        let AttractedStep { state, step, stop, wanted, .. } = *self.problem;
        let time = step.interval.time;
        if !(gradient.greatest.is_finite() && energy.value.is_finite()) {
            return Err(Error::Step(StepError::Overflow { time, what: "the residual of the contact problem" }));
        }
        if stop.cancelled.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Err(Error::Cancelled { what: "a step" });
        }
        // bodies without contact whose attraction carries less than half of the load fly apart
        let (pull, by_force) = (-wanted.total, matches!(step.loads[0], Load::Force { .. }));
        if by_force && pull > 0.0 && gradient.at_wall == 0.0 && gradient.attraction <= 0.5 * pull {
            return Err(Error::PulledOff { time, force: -pull * state.held.region.cell_area() });
        }
        Ok(())
    }

    /// Goes along the direction as far as E falls; returns whether it does.
    fn go(&mut self, along: Along, trail: &mut Trail) -> bool {
        let mut length = along.length;
        for _ in 0..if length > 0.0 { DESCENT.tries } else { 0 } {
            self.go_along(length);
            let tried = self.swap();
            let rise = (tried.value - trail.energy.value) / trail.energy.scale;
            // but for rounding
            if rise <= 1e-13 {
                self.own.report.rise = self.own.report.rise.max(rise - 1e-13);
                trail.energy = tried;
                return true;
            }
            self.own.report.rejected += 1;
            self.swap();
            length *= 0.5;
        }
        false
    }

    /// Writes x + `length` d, kept to h ≥ 0, and its q to what is tried; where the wall or the mean changed it, q is
    /// computed afresh.
    fn go_along(&mut self, length: f64) {
        let Descent { operators, own, trial, .. } = self;
        let Solution { potential: x, attraction: q, .. } = &trial.solution;
        let InGap { direction, image, lift, traction } = &mut own.in_gap;
        for_each_band([&mut *lift], |first, [lift]| {
            lift.iter_mut().zip(first..).for_each(|(lift, k)| *lift = x[k] + length * direction[k]);
        });
        if operators.project(&trial.gap, lift) {
            operators.tractions(lift, traction);
        } else {
            let tractions = q.iter().zip(&*image);
            traction.iter_mut().zip(tractions).for_each(|(next, (q, image))| *next = q + length * image);
        }
    }

    /// Keeps r for the next direction, and tries the profile beside a running edge further on, where E falls.
    fn follow_front(&mut self, trail: &mut Trail) {
        self.own.in_gap.traction.copy_from_slice(&self.trial.solution.pressure);
        let Trial { gap, solution, .. } = &*self.trial;
        let x = &solution.potential;
        let moved = trail.front.look(gap.len(), |k| gap[k] + x[k] <= 0.0);
        let Some(moved) = moved else { return };
        let tried = self.move_front(&moved);
        let falls = tried.value < trail.energy.value;
        trail.front.learn(falls);
        if falls {
            (trail.energy, trail.last) = (tried, 0.0);
        } else {
            self.swap();
            let InGap { image, traction, .. } = &mut self.own.in_gap;
            std::mem::swap(image, traction);
        }
    }

    /// Tries the profile beside a running edge further on; returns its energy. r of the last iteration stays, in the
    /// place of M d.
    fn move_front(&mut self, moved: &Moved) -> Energy {
        let Descent { operators, own, trial, .. } = self;
        let (gap, x) = (&trial.gap, &trial.solution.potential);
        let InGap { lift, image, traction, .. } = &mut own.in_gap;
        for (k, tried) in lift.iter_mut().enumerate() {
            let from = moved.source(k, gap.len());
            let rise = gap[from] - gap[k];
            *tried = x[from] + if rise.is_finite() { rise } else { 0.0 };
        }
        operators.project(gap, lift);
        operators.tractions(lift, image);
        std::mem::swap(image, traction);
        self.swap()
    }

    /// Exchanges x and q of the trial for the tried ones; returns their energy.
    fn swap(&mut self) -> Energy {
        let InGap { lift, traction, .. } = &mut self.own.in_gap;
        std::mem::swap(lift, &mut self.trial.solution.potential);
        std::mem::swap(traction, &mut self.trial.solution.attraction);
        self.energy()
    }
}
