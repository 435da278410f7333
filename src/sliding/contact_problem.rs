//! The contact problem of a steady motion: p ≥ 0, h ≥ 0, p h = 0 and the balance of the load.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::gmres::{dot, gmres, norm};
use super::operator::MovingBodies;
use super::watch::Watch;
use crate::Grid;
use crate::solver::{Freedom, RigidMotion};

/// Sets of cells in contact that are tried.
const MOST_SETS: usize = 60;
/// Until the set stands, its residual is brought down to this part of the first one.
const ROUGHLY: f64 = 3e-2;
/// A cell joins for no less penetration than so many root mean squares of the residual.
const CERTAIN: f64 = 3.0;
/// One of so many cells is many.
const MANY: usize = 4;
/// Restarts of the iteration on a set.
const CYCLES: usize = 3;
/// The part of the lowest cells that a first set takes.
const FIRST_PART: f64 = 0.3;
/// Penetration outside of the contact may exceed the root mean square of the residual so many times.
const SLACK: f64 = 10.0;
/// A negative pressure of this part of the greatest is rounding.
const ROUNDING: f64 = 1e-9;
/// The least range of the gap in contact, over the range of the whole gap.
const FLAT: f64 = 1e-4;

/// Gap and load.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub(super) grid: &'a Grid,
    /// The gap before the bodies deform \[m\], less the prescribed motion; +∞ where there is no surface.
    pub(super) gap: &'a [f64],
    /// The motion that the load leaves free, and its balance.
    pub(super) free: Freedom,
    /// Residual allowed, over the range of the gap that the contact closes.
    pub(super) tolerance: f64,
    pub(super) watch: &'a Watch,
}

/// The state of a contact problem.
#[derive(Debug, Clone, Default)]
pub(super) struct Found {
    pub(super) pressure: Vec<f64>,
    pub(super) displacement: Vec<f64>,
    /// The free part of the motion.
    pub(super) motion: RigidMotion,
    /// Root mean square of the gap in contact, over the range of the gap that the contact closes.
    pub(super) residual: f64,
    pub(super) sets: usize,
    pub(super) converged: bool,
}

impl Found {
    /// Bodies that do not press on each other.
    pub(super) fn apart(cells: usize) -> Found {
        Found { pressure: vec![0.0; cells], displacement: vec![0.0; cells], converged: true, ..Found::default() }
    }
}

/// The modes of the free motion on a set of cells, orthonormal, with what their balance requires.
struct Balance {
    /// Values on the set, Σ p of the mode, and the motion of a unit of the mode: ω and the tilts.
    modes: Vec<(Vec<f64>, f64, [f64; 3])>,
}

impl Balance {
    fn new(problem: &Problem<'_>, set: &[usize]) -> Balance {
        let Problem { grid, free, .. } = problem;
        let n2 = grid.cells()[1];
        let position = |k: usize| [grid.coordinate(0, k / n2), grid.coordinate(1, k % n2)];
        let mut modes: Vec<(Vec<f64>, f64, [f64; 3])> = Vec::new();
        for kind in 0..3 {
            if !(if kind == 0 { free.translation } else { free.tilt[kind - 1] }) {
                continue;
            }
            let value = |&k: &usize| if kind == 0 { 1.0 } else { position(k)[kind - 1] - free.point[kind - 1] };
            let mut values: Vec<f64> = set.iter().map(value).collect();
            let mut motion = [0.0; 3];
            motion[kind] = 1.0;
            if kind > 0 {
                motion[0] = -free.point[kind - 1];
            }
            let (mut total, whole) = (if kind == 0 { free.total } else { 0.0 }, norm(&values));
            for (other, own, of_other) in &modes {
                let part = dot(&values, other);
                values.iter_mut().zip(other).for_each(|(v, other)| *v -= part * other);
                total -= part * own;
                (0..3).for_each(|k| motion[k] -= part * of_other[k]);
            }
            let length = norm(&values);
            // on a set along a line a tilt about it is none
            if length > DEPENDENT * whole {
                values.iter_mut().for_each(|v| *v /= length);
                modes.push((values, total / length, motion.map(|own| own / length)));
            }
        }
        Balance { modes }
    }

    /// Takes from a field what the free motion can close.
    fn project(&self, field: &mut [f64]) {
        for (values, ..) in &self.modes {
            let part = dot(field, values);
            field.iter_mut().zip(values).for_each(|(own, value)| *own -= part * value);
        }
    }

    /// Adds to a pressure what it lacks of the load.
    fn satisfy(&self, pressure: &mut [f64]) {
        for (values, total, _) in &self.modes {
            let missing = total - dot(pressure, values);
            pressure.iter_mut().zip(values).for_each(|(p, value)| *p += missing * value);
        }
    }

    /// The motion that closes a gap on the set best.
    fn motion(&self, gap: &[f64]) -> RigidMotion {
        let mut sum = [0.0; 3];
        for (values, _, motion) in &self.modes {
            let part = dot(gap, values);
            (0..3).for_each(|k| sum[k] += part * motion[k]);
        }
        RigidMotion { approach: sum[0], tilt: [sum[1], sum[2]] }
    }
}

/// A mode of which the others leave less than this part is one of them.
const DEPENDENT: f64 = 1e-8;

impl Problem<'_> {
    /// The state, from the `guess` of a pressure, where it is positive somewhere.
    ///
    /// A primal–dual active set: on each set of cells the pressure follows from a linear equation, which GMRES solves with the
    /// inverse of the bodies' response, restricted to the set, as preconditioner. Cells that pull leave the set, cells that penetrate join.
    pub(super) fn solve(&self, bodies: &mut MovingBodies, guess: &[f64]) -> Found {
        let Problem { gap, tolerance, grid, .. } = *self;
        let (cells, n2) = (gap.len(), grid.cells()[1]);
        let mut pressed: Vec<bool> = guess.iter().map(|&p| p > 0.0).collect();
        if !pressed.contains(&true) {
            pressed = self.lowest();
        }
        let mut found = Found { pressure: guess.to_vec(), displacement: vec![0.0; cells], ..Found::default() };
        let (mut tried, mut stands) = (HashSet::new(), false);
        while found.sets < MOST_SETS && !self.watch.has_ended() {
            found.sets += 1;
            if !pressed.contains(&true) {
                if !self.free.translation {
                    return Found { sets: found.sets, ..Found::apart(cells) };
                }
                let low = gap.iter().copied().fold(f64::INFINITY, f64::min);
                pressed = gap.iter().map(|&h| h <= low).collect();
            }
            let set: Vec<usize> = (0..cells).filter(|&k| pressed[k]).collect();
            let balance = Balance::new(self, &set);
            let mut p: Vec<f64> = set.iter().map(|&k| found.pressure[k]).collect();
            balance.satisfy(&mut p);
            let allowed = tolerance * self.unit(&set, &balance) * (set.len() as f64).sqrt();
            let part = if stands { 0.0 } else { ROUGHLY };
            let residual = self.solve_on(&set, &balance, [allowed, part], bodies, &mut p, &mut found.displacement);
            let left = norm(&residual);
            let open = |k: usize| found.displacement[k] + gap[k];
            found.motion = balance.motion(&set.iter().map(|&k| open(k)).collect::<Vec<_>>());
            found.residual = tolerance * left / allowed;
            self.watch.tried(found.residual);
            let height = |k: usize| open(k) - found.motion.at([grid.coordinate(0, k / n2), grid.coordinate(1, k % n2)]);
            let most = p.iter().fold(0.0_f64, |most, p| most.max(p.abs()));
            let deep = -(SLACK * allowed).max(CERTAIN * left) / (set.len() as f64).sqrt();
            let mut pulls: Vec<(f64, usize)> =
                p.iter().zip(&set).filter(|(p, _)| **p < -ROUNDING * most).map(|(p, k)| (*p, *k)).collect();
            let outside = (0..cells).filter(|&k| !pressed[k]).map(|k| (height(k), k));
            let penetrates: Vec<(f64, usize)> = outside.filter(|(h, _)| *h < deep).collect();
            // until the set stands, cells in doubt leave only if no other joins, or if many do: else they come back
            if !stands && !penetrates.is_empty() && pulls.len() < set.len() / MANY {
                let mut closing = vec![0.0; cells];
                scatter(&residual, &set, &mut closing);
                bodies.inverse.apply(&closing.clone(), &mut closing);
                let doubt = norm(&set.iter().map(|&k| closing[k]).collect::<Vec<_>>()) / (set.len() as f64).sqrt();
                pulls.retain(|(p, _)| *p < -doubt);
            }
            let mut changes: [Vec<(f64, usize)>; 2] = [pulls, penetrates];
            found.pressure.fill(0.0);
            p.iter().zip(&set).for_each(|(&p, &k)| found.pressure[k] = p.max(0.0));
            if changes.iter().all(Vec::is_empty) {
                found.converged = left <= 1.5 * allowed;
                if found.converged || stands {
                    break;
                }
                stands = true;
                continue;
            }
            let changed = |changes: &[Vec<(f64, usize)>; 2]| {
                let mut next = pressed.clone();
                (0..2).for_each(|kind| changes[kind].iter().for_each(|&(_, k)| next[k] = kind == 1));
                next
            };
            let mut next = changed(&changes);
            let mut hasher = DefaultHasher::new();
            next.hash(&mut hasher);
            if !tried.insert(hasher.finish()) {
                // where a set comes back, the worse half changes
                for own in &mut changes {
                    own.sort_by(|a, b| a.0.total_cmp(&b.0));
                    own.truncate(own.len().div_ceil(2));
                }
                next = changed(&changes);
            }
            pressed = next;
        }
        found
    }

    /// Solves for the pressure on a set down to a residual allowed, or to a part of the first one. Returns the residual left, and writes the
    /// displacement.
    fn solve_on(
        &self,
        set: &[usize],
        balance: &Balance,
        [allowed, part]: [f64; 2],
        bodies: &mut MovingBodies,
        pressure: &mut [f64],
        displacement: &mut [f64],
    ) -> Vec<f64> {
        let cells = self.gap.len();
        let (mut full, mut image) = (vec![0.0; cells], vec![0.0; cells]);
        let (mut goal, mut cycle) = (0.0, 0);
        loop {
            cycle += 1;
            scatter(pressure, set, &mut full);
            bodies.response.apply(&full, displacement);
            let mut residual: Vec<f64> = set.iter().map(|&k| -(displacement[k] + self.gap[k])).collect();
            balance.project(&mut residual);
            let left = norm(&residual);
            if cycle == 1 {
                goal = allowed.max(part * left);
            }
            if left <= goal || cycle == CYCLES || self.watch.has_ended() {
                return residual;
            }
            gmres(pressure, &residual, goal, |direction| {
                if !self.watch.goes_on() {
                    return None;
                }
                scatter(direction, set, &mut full);
                bodies.inverse.apply(&full, &mut image);
                let mut better: Vec<f64> = set.iter().map(|&k| image[k]).collect();
                balance.project(&mut better);
                scatter(&better, set, &mut full);
                bodies.response.apply(&full, &mut image);
                let mut own: Vec<f64> = set.iter().map(|&k| image[k]).collect();
                balance.project(&mut own);
                Some([better, own])
            });
        }
    }

    /// The length by which residuals are measured: the root mean square of the gap that the contact closes, or of a small part of all gaps
    /// where the contact is flat.
    fn unit(&self, set: &[usize], balance: &Balance) -> f64 {
        let mut heights: Vec<f64> = set.iter().map(|&k| self.gap[k]).collect();
        balance.project(&mut heights);
        let finite = || self.gap.iter().copied().filter(|h| h.is_finite());
        let [low, high] = [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)];
        (norm(&heights) / (set.len() as f64).sqrt()).max(FLAT * (high - low)).max(ROUNDING * high.abs())
    }

    /// The cells of a first set: the lowest ones, those below zero under a given approach.
    fn lowest(&self) -> Vec<bool> {
        let mut heights: Vec<f64> = self.gap.iter().copied().filter(|h| h.is_finite()).collect();
        let level = if self.free.translation {
            let place = ((FIRST_PART * heights.len() as f64) as usize).min(heights.len() - 1);
            *heights.select_nth_unstable_by(place, f64::total_cmp).1
        } else {
            0.0
        };
        self.gap.iter().map(|&h| h <= level).collect()
    }
}

fn scatter(values: &[f64], set: &[usize], field: &mut [f64]) {
    field.fill(0.0);
    values.iter().zip(set).for_each(|(&value, &k)| field[k] = value);
}
