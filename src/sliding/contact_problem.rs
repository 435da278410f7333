//! The contact problem of a steady motion: p ≥ 0, h ≥ 0, p h = 0 and the balance of the load.
//!
//! It is not left to the solver of equilibria: bodies that lose energy respond by an operator that is not symmetric,
//! under which there is no energy to descend in and conjugate gradients do not end. GMRES solves on a set of cells,
//! and sets follow each other until one stands.

use std::collections::HashSet;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::sync::atomic::{AtomicBool, Ordering};

use super::gmres::{gmres, norm};
use super::operator::MovingBodies;
use crate::Grid;
use crate::parallel::Rows;
use crate::solver::{Freedom, Gram, ModeCoefficients, Modes, RestingPosition, RigidMotion, dot};

/// How the set of cells in contact is found.
struct Search {
    /// Sets of cells in contact that are tried.
    most_sets: usize,
    /// Until the set stands, its residual is brought down to this part of the first one.
    roughly: f64,
    /// A cell joins for no less penetration than so many root mean squares of the residual, or than it may have.
    certain: f64,
    /// Restarts of the iteration on a set.
    cycles: usize,
    /// The part of the lowest cells that a first set takes.
    first_part: f64,
    /// The residual may exceed the tolerance so many times: it was brought down to it before the displacement was
    /// computed anew.
    below: f64,
    /// A negative pressure of this part of the largest is rounding.
    rounding: f64,
    /// The least range of the gap in contact, over the range of the whole gap, or of the displacement.
    flat: f64,
    /// No residual is brought below this part of the maximum displacement that the pressure could have.
    least: f64,
}

const SEARCH: Search = Search {
    most_sets: 60,
    roughly: 3e-2,
    certain: 3.0,
    cycles: 3,
    first_part: 0.3,
    below: 1.5,
    rounding: 1e-9,
    flat: 1e-4,
    least: 4.0 * f64::EPSILON,
};

/// Gap and load.
#[derive(Clone, Copy)]
pub(super) struct SlidingProblem<'a> {
    pub(super) grid: &'a Grid,
    /// The gap before the bodies deform \[m\], less the prescribed motion; +∞ where there is no surface.
    pub(super) gap: &'a [f64],
    /// The motion that the load leaves free, and its balance.
    pub(super) free: Freedom,
    /// Residual allowed, over the range of the gap that the contact closes.
    pub(super) tolerance: f64,
    /// Set by another thread to end the search.
    pub(super) cancelled: Option<&'a AtomicBool>,
}

/// The state of a contact problem.
#[derive(Debug, Clone, Default)]
pub(super) struct FoundMotion {
    pub(super) pressure: Vec<f64>,
    pub(super) displacement: Vec<f64>,
    /// The free part of the motion.
    pub(super) motion: RigidMotion,
    /// Root mean square of the gap in contact, over the range of the gap that the contact closes.
    pub(super) residual: f64,
    /// What rounding leaves of it.
    pub(super) rounding: f64,
    pub(super) sets: usize,
    pub(super) converged: bool,
}

impl FoundMotion {
    /// Bodies that do not press on each other.
    pub(super) fn apart(cells: usize) -> FoundMotion {
        FoundMotion {
            pressure: vec![0.0; cells],
            displacement: vec![0.0; cells],
            converged: true,
            ..FoundMotion::default()
        }
    }
}

/// A set of cells, and the free motion on it with its balance.
struct SetBalance<'a> {
    set: Vec<usize>,
    modes: Modes<'a>,
    /// The modes on the cells of the set, and their products.
    values: Vec<[f64; 3]>,
    gram: Gram,
}

impl<'a> SetBalance<'a> {
    fn new(problem: &SlidingProblem<'a>, set: Vec<usize>) -> SetBalance<'a> {
        let modes = Modes::new(problem.grid, &Rows::all(problem.grid.cells()), problem.free);
        let values: Vec<_> = set.iter().map(|&k| modes.at(k)).collect();
        let mut gram = Gram::default();
        for of in &values {
            (0..9).for_each(|n| gram.entries[n / 3][n % 3] += of[n / 3] * of[n % 3]);
        }
        SetBalance { set, modes, values, gram }
    }

    /// Adds the motion to a field on the set that brings its force and moments to these sums, and returns it.
    fn bring(&self, field: &mut [f64], sums: [f64; 3]) -> ModeCoefficients {
        let mut missing = sums;
        for (of, value) in self.values.iter().zip(&*field) {
            (0..3).for_each(|m| missing[m] -= of[m] * value);
        }
        let motion = self.gram.solve(missing);
        self.values.iter().zip(field).for_each(|(of, value)| *value += dot(*of, motion));
        ModeCoefficients(motion)
    }

    /// Whether a pressure on the set has this force, and no moment about the load point.
    fn holds(&self, field: &[f64], total: f64, tolerance: f64) -> bool {
        (0..3).all(|m| {
            let parts = || self.values.iter().zip(field).map(|(of, value)| of[m] * value);
            let (sum, size) = (parts().sum::<f64>(), parts().map(f64::abs).sum::<f64>());
            (sum - self.modes.load()[m] * total).abs() <= tolerance * if m == 0 { total } else { size }
        })
    }

    /// The values of a field on the set.
    fn of(&self, field: &[f64]) -> Vec<f64> {
        self.set.iter().map(|&k| field[k]).collect()
    }

    /// The field with these values on the set.
    fn field(&self, values: &[f64], cells: usize) -> Vec<f64> {
        let mut field = vec![0.0; cells];
        self.set.iter().zip(values).for_each(|(&k, value)| field[k] = *value);
        field
    }

    /// The root mean square of values on the set.
    fn rms(&self, values: &[f64]) -> f64 {
        norm(values) / (self.set.len() as f64).sqrt()
    }
}

/// Cells that leave a set, with their pressures, and others that join, with their heights.
struct Changes {
    leave: Vec<(f64, usize)>,
    join: Vec<(f64, usize)>,
}

impl Changes {
    fn of(&self, pressed: &[bool]) -> Vec<bool> {
        let mut next = pressed.to_vec();
        self.leave.iter().for_each(|&(_, k)| next[k] = false);
        self.join.iter().for_each(|&(_, k)| next[k] = true);
        next
    }

    /// Where a set comes back, the worse half changes.
    fn keep_worse_half(&mut self) {
        for own in [&mut self.leave, &mut self.join] {
            own.sort_by(|a, b| a.0.total_cmp(&b.0));
            own.truncate(own.len().div_ceil(2));
        }
    }
}

/// The least and the largest finite value.
fn range(values: &[f64]) -> [f64; 2] {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)]
}

/// Where a body rests when it is lowered and may tilt as its load leaves it free.
struct Support {
    /// One cell for an upright body, two or three for one that tilts.
    cells: Vec<usize>,
    /// Of the load point \[m\]: below 0 bodies of prescribed approach overlap however they tilt.
    height: f64,
    /// The motion to it, without the approach.
    tilt: RigidMotion,
}

impl SlidingProblem<'_> {
    /// Whether another thread ends the search.
    pub(super) fn is_cancelled(&self) -> bool {
        self.cancelled.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Where the body rests.
    fn support(&self) -> Support {
        let rows = Rows::all(self.grid.cells());
        let modes = Modes::new(self.grid, &rows, Freedom { translation: true, ..self.free });
        let cells = (0..self.gap.len()).filter(|&k| self.gap[k].is_finite());
        let RestingPosition { motion, supports } = RestingPosition::new(&rows, &modes, self.gap, cells);
        let pressed = supports.into_iter().flatten().filter(|(_, share)| *share > SEARCH.rounding);
        let (height, lowered) = (motion.0[0], modes.physical(motion));
        let tilt = RigidMotion { approach: lowered.approach - height, tilt: lowered.tilt };
        Support { cells: pressed.map(|(k, _)| k).collect(), height, tilt }
    }

    /// The gap of each cell under a motion.
    fn moved(&self, motion: RigidMotion) -> impl Iterator<Item = f64> {
        let n2 = self.grid.cells()[1];
        self.gap.iter().enumerate().map(move |(k, h)| h - motion.at(self.grid.center(k / n2, k % n2)))
    }

    /// The motion of a body of prescribed approach that touches nothing on its support, upright if it does not then
    /// either. The search for a support may have been given up: what it found is no proof.
    fn apart(&self, Support { height, tilt, .. }: &Support) -> Option<RigidMotion> {
        let most = self.gap.iter().filter(|h| h.is_finite()).fold(0.0, |most: f64, h| most.max(h.abs()));
        let clears = self.moved(*tilt).all(|h| h >= -SEARCH.rounding * most);
        let is_apart = !self.free.translation && *height >= 0.0 && clears;
        let is_upright = self.gap.iter().all(|h| *h >= 0.0);
        is_apart.then(|| if is_upright { RigidMotion::default() } else { *tilt })
    }

    /// The state, from the `guess` of a pressure, where it is positive somewhere.
    ///
    /// A primal–dual active set: on each set of cells the pressure follows from a linear equation, which GMRES solves
    /// with the inverse of the bodies' response, restricted to the set, as preconditioner. Cells that pull leave the
    /// set, cells that penetrate join.
    pub(super) fn solve(&self, bodies: &mut MovingBodies, guess: &[f64]) -> FoundMotion {
        let SlidingProblem { gap, tolerance, free, .. } = *self;
        let cells = gap.len();
        let mut pressed: Vec<bool> = guess.iter().map(|&p| p > 0.0).collect();
        if !pressed.contains(&true) {
            pressed = self.lowest();
        }
        let compliance = bodies.greatest_compliance();
        let mut found = FoundMotion { pressure: guess.to_vec(), ..FoundMotion::default() };
        let (mut tried, mut stands) = (HashSet::new(), false);
        while found.sets < SEARCH.most_sets && !self.is_cancelled() {
            found.sets += 1;
            if !pressed.contains(&true) {
                let support = self.support();
                if let Some(motion) = self.apart(&support) {
                    return FoundMotion { sets: found.sets, motion, ..FoundMotion::apart(cells) };
                }
                support.cells.iter().for_each(|&k| pressed[k] = true);
            }
            let (balance, mut p) = self.balance(&mut pressed, &found.pressure);
            found.displacement = bodies.displacement(&balance.field(&p, cells));
            let least = SEARCH.least * compliance * p.iter().fold(0.0_f64, |most, p| most.max(p.abs()));
            let unit = self.unit(&balance, &found.displacement, least);
            let allowed = (tolerance * unit).max(least);
            let part = if stands { 0.0 } else { SEARCH.roughly };
            let residual = self.solve_on(&balance, allowed, part, bodies, &mut p, &mut found);
            let left = balance.rms(&residual);
            let over_unit = |length: f64| if length > 0.0 { length / unit } else { 0.0 };
            (found.residual, found.rounding) = (over_unit(left), over_unit(least));
            let mut changes = self.changes(&balance, &p, &found, &pressed, SEARCH.certain * allowed.max(left));
            p.iter_mut().for_each(|p| *p = p.max(0.0));
            found.pressure = balance.field(&p, cells);
            if changes.leave.is_empty() && changes.join.is_empty() {
                let balanced = || balance.holds(&balance.of(&found.pressure), free.total, tolerance);
                found.converged = left <= SEARCH.below * tolerance * unit && (!free.moves() || balanced());
                if found.converged || stands {
                    break;
                }
                stands = true;
                continue;
            }
            let mut next = changes.of(&pressed);
            if !tried.insert(BuildHasherDefault::<DefaultHasher>::default().hash_one(&next)) {
                changes.keep_worse_half();
                next = changes.of(&pressed);
            }
            pressed = next;
        }
        found
    }

    /// The balance on the pressed cells, and the pressure on them that carries the load. Cells that cannot carry it, too
    /// few or all on a line, get those of the support.
    fn balance(&self, pressed: &mut [bool], pressure: &[f64]) -> (SetBalance<'_>, Vec<f64>) {
        let on = |pressed: &[bool]| {
            let balance = SetBalance::new(self, (0..pressed.len()).filter(|&k| pressed[k]).collect());
            let mut p = balance.of(pressure);
            balance.bring(&mut p, balance.modes.load().map(|unit| unit * self.free.total));
            (balance, p)
        };
        let (balance, p) = on(pressed);
        if !self.free.tilts() || balance.holds(&p, self.free.total, self.tolerance) {
            return (balance, p);
        }
        self.support().cells.iter().for_each(|&k| pressed[k] = true);
        on(pressed)
    }

    /// The cells of the set that pull, and those outside that are deeper than `certain`.
    fn changes(
        &self,
        balance: &SetBalance<'_>,
        p: &[f64],
        found: &FoundMotion,
        pressed: &[bool],
        certain: f64,
    ) -> Changes {
        let n2 = self.grid.cells()[1];
        let height = |k: usize| found.displacement[k] + self.gap[k] - found.motion.at(self.grid.center(k / n2, k % n2));
        let most = p.iter().fold(0.0_f64, |most, p| most.max(p.abs()));
        let pulls = p.iter().zip(&balance.set).map(|(p, k)| (*p, *k)).filter(|(p, _)| *p < -SEARCH.rounding * most);
        let outside = (0..pressed.len()).filter(|&k| !pressed[k]).map(|k| (height(k), k));
        Changes { leave: pulls.collect(), join: outside.filter(|(h, _)| *h < -certain).collect() }
    }

    /// Solves for the pressure on a set, of which the displacement is known, down to the root mean square of the
    /// residual that is `allowed`, or to a `part` of the first one. Returns the residual left, and writes
    /// displacement and motion.
    fn solve_on(
        &self,
        balance: &SetBalance<'_>,
        allowed: f64,
        part: f64,
        bodies: &mut MovingBodies,
        pressure: &mut [f64],
        found: &mut FoundMotion,
    ) -> Vec<f64> {
        let (cells, mut goal) = (self.gap.len(), 0.0);
        let mut cycle = 0;
        loop {
            cycle += 1;
            let mut residual = balance.of(self.gap);
            residual.iter_mut().zip(&balance.set).for_each(|(gap, &k)| *gap = -(found.displacement[k] + *gap));
            found.motion = balance.modes.physical(balance.bring(&mut residual, [0.0; 3]));
            let left = norm(&residual);
            if cycle == 1 {
                goal = (allowed * (pressure.len() as f64).sqrt()).max(part * left);
            }
            if left <= goal || cycle == SEARCH.cycles || self.is_cancelled() {
                return residual;
            }
            gmres(pressure, residual, goal, |direction| {
                let mut better = balance.of(&bodies.pressure(&balance.field(direction, cells)));
                balance.bring(&mut better, [0.0; 3]);
                let mut image = balance.of(&bodies.displacement(&balance.field(&better, cells)));
                balance.bring(&mut image, [0.0; 3]);
                (!self.is_cancelled()).then_some([better, image])
            });
            found.displacement = bodies.displacement(&balance.field(pressure, cells));
        }
    }

    /// The length by which residuals are measured: the root mean square of the gap that the contact closes, or of a
    /// small part of all gaps where the contact is flat, and of the displacement, where a face has no other gap; its
    /// rounding is `least`.
    fn unit(&self, balance: &SetBalance<'_>, displacement: &[f64], least: f64) -> f64 {
        let mut heights = balance.of(self.gap);
        balance.bring(&mut heights, [0.0; 3]);
        let [low, high] = range(self.gap);
        let [lowest, most] = range(displacement);
        let own = balance
            .rms(&heights)
            .max(SEARCH.flat * (high - low))
            .max(SEARCH.rounding * high.abs())
            .max(SEARCH.flat * (most - lowest));
        // a face without any gap closes without displacement where it fills a period
        if high > low { own } else { own.max(least / self.tolerance) }
    }

    /// The cells of a first set: the lowest ones, those below zero under a prescribed approach, of a body that leans
    /// on its support.
    fn lowest(&self) -> Vec<bool> {
        let tilt = if self.free.tilts() { self.support().tilt } else { RigidMotion::default() };
        let gap: Vec<f64> = self.moved(tilt).collect();
        let mut heights: Vec<f64> = gap.iter().copied().filter(|h| h.is_finite()).collect();
        let level = if self.free.translation {
            let place = ((SEARCH.first_part * heights.len() as f64) as usize).min(heights.len() - 1);
            *heights.select_nth_unstable_by(place, f64::total_cmp).1
        } else {
            0.0
        };
        gap.iter().map(|&h| h <= level).collect()
    }
}
