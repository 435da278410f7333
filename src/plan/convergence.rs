//! How the states of a run converge with the mesh.

use crate::Grid;
use crate::error::Result;
use crate::plan::coarse::{Extent, Run, Scene, State};

/// Cells across the contact on the coarsest mesh.
const LEAST_ACROSS: usize = 16;
/// Cells across the contact on the finest mesh that a plan computes.
const MOST_ACROSS: usize = 128;
/// A plan extrapolates to meshes at most this many times finer, unless that takes more than `MOST_ACROSS`.
const MAX_EXTRAPOLATION: f64 = 3.0;
/// Orders of convergence that are believed.
const ORDERS: [f64; 2] = [0.5, 2.0];

/// Ratio of the domain to the rectangle of the contact.
pub(super) const DOMAIN_TO_CONTACT: f64 = 1.12;

/// The error of a quantity on the finest mesh, relative to the greatest value of the run, and its order.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Convergence {
    error: f64,
    order: f64,
}

impl Convergence {
    /// From the differences between three meshes, or the last two of them.
    fn new(first: Option<f64>, second: f64) -> Convergence {
        let order = first.map_or(1.0, |first| (first / second).log2());
        let order = if order.is_nan() { ORDERS[1] } else { order.clamp(ORDERS[0], ORDERS[1]) };
        Convergence { error: second / (2f64.powf(order) - 1.0), order }
    }

    /// The error on a mesh `finer` times as fine.
    pub(super) fn at(&self, finer: f64) -> f64 {
        self.error * finer.powf(-self.order)
    }

    /// How much finer the mesh must be for a given error.
    fn finer(&self, target: f64) -> f64 {
        (self.error / target).powf(1.0 / self.order)
    }
}

/// What the coarse runs found.
pub(super) struct Found {
    /// Cells across the contact on the finest mesh.
    pub(super) across: f64,
    /// Of approach or force, greatest pressure, and contact radius.
    pub(super) main: Convergence,
    pub(super) pressure: Convergence,
    pub(super) radius: Convergence,
    /// First-order share of the error of approach or force.
    pub(super) singular: Convergence,
    pub(super) steps: usize,
    /// Convolution equivalents on the finest mesh, and by which power they grow with its cells across.
    pub(super) convolutions: f64,
    pub(super) growth: f64,
}

impl Found {
    /// How much finer the mesh must be for approach, force and greatest pressure to err by `target`.
    pub(super) fn finer(&self, target: f64) -> f64 {
        let singular = self.singular.error > 0.0;
        let pressure = if singular { 0.0 } else { self.pressure.finer(target) };
        self.main.finer(target).max(self.singular.finer(target)).max(pressure)
    }
}

/// The grid with so many cells across the widest contact.
pub(super) fn grid_with(extent: &Extent, across: f64) -> Result<Grid> {
    let lengths = extent.reach.map(|half| 2.0 * DOMAIN_TO_CONTACT * half);
    let cells = [0, 1].map(|axis| smooth_size((across * lengths[axis] / extent.width[axis]).ceil() as usize));
    Grid::new(cells, lengths)
}

/// Refines the mesh until the differences between three of them show how fine it must be.
pub(super) fn converge(scene: &Scene<'_>, extent: &Extent) -> Result<Found> {
    let mut across = LEAST_ACROSS;
    let base = scene.follow(grid_with(extent, across as f64)?)?;
    let target = scene.accuracy.space();
    let (mut last, mut before): (Run, Option<[f64; 3]>) = (base, None);
    loop {
        across *= 2;
        let finer = scene.repeat(grid_with(extent, across as f64)?, &last.steps)?;
        let now = differences(&last.states, &finer.states);
        let of = |which: usize| Convergence::new(before.map(|before| before[which]), now[which]);
        let deepest = greatest(&finer.states, |state| state.approach);
        let singular = finer.states.iter().map(|state| state.singular * (state.approach / deepest).clamp(0.0, 1.0));
        let singular = Convergence { error: singular.fold(0.0, f64::max), order: 1.0 };
        let found = Found {
            across: across as f64,
            main: of(0),
            pressure: of(1),
            radius: of(2),
            singular,
            steps: finer.steps.len(),
            convolutions: finer.convolutions,
            growth: (finer.convolutions / last.convolutions).log2().clamp(0.0, 1.0),
        };
        if std::env::var("PLAN_DEBUG").is_ok() {
            println!("   {across}: {now:.5?} main {:.5?} p {:.5?} r {:.5?} s {:.1e} work {:.0} from {:.0}", found.main, found.pressure, found.radius, found.singular.error, finer.convolutions, last.convolutions);
        }
        let needed = found.finer(target);
        let enough = if before.is_none() { needed <= 1.0 } else { needed <= MAX_EXTRAPOLATION };
        if enough || across >= MOST_ACROSS {
            return Ok(found);
        }
        (last, before) = (finer, Some(now));
    }
}

fn greatest(states: &[State], of: impl Fn(&State) -> f64) -> f64 {
    states.iter().map(|state| of(state).abs()).fold(0.0, f64::max)
}

/// Greatest differences of approach or force, greatest pressure, and radius, relative to the greatest values of the run.
fn differences(coarse: &[State], fine: &[State]) -> [f64; 3] {
    let over = |of: fn(&State) -> f64, all: bool| {
        let pairs = coarse.iter().zip(fine).filter(|(state, _)| all || state.resolved);
        let most = pairs.map(|(coarse, fine)| (of(coarse) - of(fine)).abs()).fold(0.0, f64::max);
        let scale = greatest(fine, of);
        if scale > 0.0 { most / scale } else { 0.0 }
    };
    let of_pressure: fn(&State) -> f64 = |state| state.pressure;
    let [highest, before] = [fine, coarse].map(|states| greatest(states, of_pressure));
    let highest = if highest > 0.0 { (highest - before).abs() / highest } else { 0.0 };
    let main = over(|state| state.approach, true).max(over(|state| state.force, true));
    [main, over(of_pressure, false).max(highest), over(|state| state.radius, false)]
}

/// The next number of cells whose double has no prime factor above 5, for fast transforms.
fn smooth_size(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n == 1
    };
    (least..).find(|&n| n.is_multiple_of(2) && smooth(n)).unwrap_or(least)
}
