//! The loads of a scene, as loads of an elastic body of unit compliance.

use crate::Grid;
use crate::error::{Error, Result, StepError};
use crate::load::Load;
use crate::plan::domain::{ContactSize, Side};
use crate::plan::scene::TrialScene;
use crate::states::{as_elastic, greatest, unless_refused};

/// Number of even parts of the run at whose ends the load is sampled.
const PARTS: u32 = 64;
/// Every so many samples give an elastic state where the tilt changes.
const THINNED: usize = 8;
/// Cells along a side of the contacts that find the domain.
const DOMAIN_CELLS: usize = 24;
/// Greatest number of domains tried, each at most ten times as large or as small as the last.
const MAX_DOMAINS: usize = 60;
/// A domain is accepted if the contact spans a fraction of it in this range.
const CONTACT_FRACTION: [f64; 2] = [0.45, 0.92];

/// The loads of a scene.
pub(super) struct Loads {
    /// Loads of an elastic body of unit compliance whose contacts are as large as the largest contacts of the run.
    pub(super) largest: Vec<Load>,
    /// Whether every load has the same tilts or load point: the contact is a superposition of its elastic states.
    pub(super) on_states: bool,
}

impl Loads {
    /// The largest contacts under a given force are those at the greatest level, which does not depend on the shape.
    /// Under a given approach the largest contact is the elastic one at the greatest approach. Where the tilt changes,
    /// and the force is given at some times only, the compliance at the end of the run gives an upper bound.
    pub(super) fn of(scene: &TrialScene<'_>) -> Result<Loads> {
        let course = scene.course();
        let all = course.sampled(0.0, PARTS)?;
        let tilt = all[0].tilt();
        let on_states = all.iter().all(|load| load.tilt() == tilt);
        let interpolant = scene.asked.accuracy.settings().adaptive_interpolant();
        if on_states && all.iter().all(Load::is_force) {
            let level = course.greatest_level(tilt, interpolant, PARTS);
            if let Some(normal) = unless_refused(level.map(Some))? {
                return Ok(Loads { largest: vec![Load::Force { normal, tilt }], on_states });
            }
        }
        let compliance = course.softest_compliance()?;
        let thinned = all.iter().step_by(if on_states { all.len() } else { THINNED });
        let elastic = greatest(&all, compliance).chain(thinned.map(|load| as_elastic(*load, compliance)));
        Ok(Loads { largest: elastic.collect(), on_states })
    }
}

impl ContactSize {
    /// Finds the elastic contacts under these loads on domains of several sizes until they fill one well; returns their
    /// size.
    pub(super) fn around(scene: &TrialScene<'_>, loads: &[Load]) -> Result<ContactSize> {
        let sides = scene.asked.body.sides;
        let (is_found, first) = (sides.map(|side| side == Side::Found), first_length(scene, loads)?);
        let mut lengths = sides.map(|side| match side {
            Side::Found => first,
            Side::Period(length) | Side::Uniform(length) => length,
        });
        let cells = sides.map(|side| if matches!(side, Side::Uniform(_)) { 1 } else { DOMAIN_CELLS });
        for _ in 0..MAX_DOMAINS {
            let factors = match scene.elastic(Grid::new(cells, lengths)?, loads).map(|run| run.size) {
                Err(Error::Step(StepError::ContactAtEdge { .. })) => [1.7; 2],
                Err(Error::NothingToTouch { .. }) => [0.3; 2],
                Err(error) => return Err(error),
                Ok(size) => {
                    let filled = [0, 1].map(|axis| 2.0 * size.reach[axis] / lengths[axis]);
                    let fits = |axis: usize| (CONTACT_FRACTION[0]..=CONTACT_FRACTION[1]).contains(&filled[axis]);
                    if (0..2).all(|axis| !is_found[axis] || fits(axis)) && size.width != [0.0; 2] {
                        return Ok(size);
                    }
                    let least = 2.0 / DOMAIN_CELLS as f64;
                    filled.map(|filled| (filled.max(least) * 1.3).clamp(0.1, 1.7))
                }
            };
            if !is_found.contains(&true) {
                break;
            }
            lengths = [0, 1].map(|axis| if is_found[axis] { lengths[axis] * factors[axis] } else { lengths[axis] });
        }
        Err(Error::NoDomain { length: lengths[0].max(lengths[1]) })
    }
}

/// Initial length L of the domain: a contact of half width L/4 is indented by the gap at its edge, at a level of about
/// L times this gap.
fn first_length(scene: &TrialScene<'_>, loads: &[Load]) -> Result<f64> {
    let (mut level, mut approach) = (0.0_f64, 0.0_f64);
    for load in loads {
        match *load {
            Load::Force { normal, .. } => level = level.max(normal),
            // either is a bound
            Load::Approach { approach: depth, .. } | Load::Spring { drive: depth, .. } => {
                approach = approach.max(depth);
            }
        }
    }
    let sides = scene.asked.body.sides;
    if let Some(Side::Uniform(length)) = sides.iter().find(|side| matches!(side, Side::Uniform(_))) {
        level /= length;
    }
    let lowest = scene.asked.geometry.initial_gap(0.0, 0.0);
    let rise = |length: f64| {
        let around = [(0, [1.0, 0.0]), (1, [0.0, 1.0]), (0, [-1.0, 0.0]), (1, [0.0, -1.0])];
        let found = around.into_iter().filter(|(axis, _)| sides[*axis] == Side::Found);
        let gaps = found.map(|(_, [x1, x2])| scene.asked.geometry.initial_gap(0.25 * length * x1, 0.25 * length * x2));
        gaps.fold(f64::INFINITY, f64::min) - lowest
    };
    let depth = |length: f64| {
        let rise = rise(length);
        rise >= approach.max(level / length) || rise.is_nan() || rise == f64::INFINITY
    };
    let lengths = (-48..=36).map(|k| 10f64.powf(0.25 * f64::from(k)));
    lengths.into_iter().find(|&length| depth(length)).ok_or(Error::NoDomain { length: 1e9 })
}
