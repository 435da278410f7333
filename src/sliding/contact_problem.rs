//! The contact problem of a steady motion: p ≥ 0, h ≥ 0, p h = 0 and the balance of the load.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::gmres::gmres;
use super::operator::MovingBodies;

/// Sets of cells in contact that are tried.
const MOST_SETS: usize = 60;
/// The first sets are solved to this part of the first residual, until the set no longer changes much.
const FIRST_SETS: usize = 4;
const ROUGHLY: f64 = 1e-2;
/// Restarts of the iteration on a set.
const CYCLES: usize = 3;
/// The part of the lowest cells that a first set takes.
const FIRST_PART: f64 = 0.3;
/// Penetration outside of the contact may exceed the root mean square of the residual so many times.
const SLACK: f64 = 10.0;
/// A negative pressure of this part of the greatest is rounding.
const ROUNDING: f64 = 1e-9;

/// Gap and load.
#[derive(Debug, Clone, Copy)]
pub(super) struct Problem<'a> {
    /// The gap before the bodies deform \[m\], +∞ where there is no surface; under a given approach less that approach.
    pub(super) gap: &'a [f64],
    /// Σ p \[Pa\] of a given force; `None` under a given approach.
    pub(super) total: Option<f64>,
    /// Residual allowed, over the range of the gap that the contact closes.
    pub(super) tolerance: f64,
}

/// The state of a contact problem.
#[derive(Debug, Clone, Default)]
pub(super) struct Found {
    pub(super) pressure: Vec<f64>,
    pub(super) displacement: Vec<f64>,
    /// How far the rigid body is below the gap of the problem \[m\]: 0 under a given approach.
    pub(super) lowered: f64,
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

impl Problem<'_> {
    /// The state, from the `guess` of a pressure, where it is positive somewhere.
    ///
    /// A primal–dual active set: on each set of cells the pressure follows from a linear equation, which GMRES solves with the
    /// inverse of the bodies' response, restricted to the set, as preconditioner. Cells that pull leave the set, cells that penetrate join.
    pub(super) fn solve(&self, bodies: &mut MovingBodies, guess: &[f64]) -> Found {
        let Problem { gap, total, tolerance } = *self;
        let cells = gap.len();
        let mut pressed: Vec<bool> = guess.iter().map(|&p| p > 0.0).collect();
        if !pressed.contains(&true) {
            pressed = self.lowest();
        }
        let mut found = Found { pressure: guess.to_vec(), displacement: vec![0.0; cells], ..Found::default() };
        let (mut full, mut image) = (vec![0.0; cells], vec![0.0; cells]);
        let finite = gap.iter().copied().filter(|h| h.is_finite());
        let [low, high] = [finite.clone().fold(f64::INFINITY, f64::min), finite.fold(f64::NEG_INFINITY, f64::max)];
        let mut tried = HashSet::new();
        while found.sets < MOST_SETS {
            found.sets += 1;
            let set: Vec<usize> = (0..cells).filter(|&k| pressed[k]).collect();
            let count = set.len() as f64;
            // under a given force the rigid body moves: gaps count without their mean
            let project = |field: &mut [f64]| {
                if total.is_some() {
                    let mean = field.iter().sum::<f64>() / count;
                    field.iter_mut().for_each(|value| *value -= mean);
                }
            };
            let mut x: Vec<f64> = set.iter().map(|&k| found.pressure[k]).collect();
            if let Some(total) = total {
                let missing = (total - x.iter().sum::<f64>()) / count;
                x.iter_mut().for_each(|p| *p += missing);
            }
            let mut heights: Vec<f64> = set.iter().map(|&k| gap[k]).collect();
            project(&mut heights);
            let range = norm(&heights) / count.sqrt();
            let unit = range.max(1e-4 * (high - low)).max(1e-9 * high.abs());
            let target = tolerance * unit * count.sqrt();
            let mut residual = Vec::new();
            let mut left = f64::INFINITY;
            let mut goal = target;
            for cycle in 0..CYCLES {
                scatter(&x, &set, &mut full);
                bodies.response.apply(&full, &mut found.displacement);
                residual = set.iter().map(|&k| -(found.displacement[k] + gap[k])).collect();
                project(&mut residual);
                left = norm(&residual);
                if cycle == 0 && found.sets <= FIRST_SETS {
                    goal = target.max(ROUGHLY * left);
                }
                if left <= goal || cycle + 1 == CYCLES {
                    break;
                }
                gmres(&mut x, &residual, goal, |direction| {
                    scatter(direction, &set, &mut full);
                    bodies.inverse.apply(&full, &mut image);
                    let mut better: Vec<f64> = set.iter().map(|&k| image[k]).collect();
                    project(&mut better);
                    scatter(&better, &set, &mut full);
                    bodies.response.apply(&full, &mut image);
                    let mut own: Vec<f64> = set.iter().map(|&k| image[k]).collect();
                    project(&mut own);
                    [better, own]
                });
            }
            drop(residual);
            // under a given force the gap in contact is how far the body is to be lowered
            let open = |k: usize| found.displacement[k] + gap[k];
            found.lowered = if total.is_some() { set.iter().map(|&k| open(k)).sum::<f64>() / count } else { 0.0 };
            found.residual = left / (unit * count.sqrt());
            let most = x.iter().fold(0.0_f64, |most, p| most.max(p.abs()));
            let mut pulls: Vec<(f64, usize)> =
                x.iter().zip(&set).filter(|(p, _)| **p < -ROUNDING * most).map(|(p, k)| (*p, *k)).collect();
            let deep = -SLACK * tolerance * unit;
            let outside = (0..cells).filter(|&k| !pressed[k]);
            let mut penetrates: Vec<(f64, usize)> =
                outside.map(|k| (open(k) - found.lowered, k)).filter(|(h, _)| *h < deep).collect();
            found.pressure.fill(0.0);
            x.iter().zip(&set).for_each(|(&p, &k)| found.pressure[k] = p.max(0.0));
            if pulls.is_empty() && penetrates.is_empty() && left <= 1.5 * target {
                found.converged = true;
                break;
            }
            // where a set comes back, the worse half changes
            let mut next = pressed.clone();
            pulls.iter().for_each(|&(_, k)| next[k] = false);
            penetrates.iter().for_each(|&(_, k)| next[k] = true);
            let mut hasher = DefaultHasher::new();
            next.hash(&mut hasher);
            if !tried.insert(hasher.finish()) {
                for changes in [&mut pulls, &mut penetrates] {
                    changes.sort_by(|a, b| a.0.total_cmp(&b.0));
                    changes.truncate(changes.len().div_ceil(2));
                }
                next.copy_from_slice(&pressed);
                pulls.iter().for_each(|&(_, k)| next[k] = false);
                penetrates.iter().for_each(|&(_, k)| next[k] = true);
            }
            pressed = next;
            if !pressed.contains(&true) {
                if total.is_none() {
                    // nothing presses: the bodies are apart
                    found.pressure.fill(0.0);
                    found.displacement.fill(0.0);
                    found.converged = true;
                    break;
                }
                pressed = gap.iter().map(|&h| h <= low).collect();
            }
        }
        found
    }

    /// The cells of a first set: the lowest ones, those below zero under a given approach.
    fn lowest(&self) -> Vec<bool> {
        let mut heights: Vec<f64> = self.gap.iter().copied().filter(|h| h.is_finite()).collect();
        let level = if self.total.is_some() {
            let place = ((FIRST_PART * heights.len() as f64) as usize).min(heights.len() - 1);
            *heights.select_nth_unstable_by(place, f64::total_cmp).1
        } else {
            0.0
        };
        let lowest: Vec<bool> = self.gap.iter().map(|&h| h <= level).collect();
        lowest
    }
}

fn norm(field: &[f64]) -> f64 {
    field.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn scatter(values: &[f64], set: &[usize], field: &mut [f64]) {
    field.fill(0.0);
    values.iter().zip(set).for_each(|(&value, &k)| field[k] = value);
}
