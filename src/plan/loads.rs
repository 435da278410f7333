//! The loads of a scene, as loads of an elastic body of unit compliance.

use crate::error::{Error, Result};
use crate::load::Load;
use crate::plan::domain::Side;
use crate::plan::trial_runs::TrialScene;
use crate::states::{as_elastic, greatest};

/// Number of even parts of the run at whose ends the load is sampled.
const PARTS: u32 = 64;
/// Every so many samples give an elastic state where the tilt changes.
const THINNED: usize = 8;

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
        let all = course.sampled(PARTS)?;
        let tilt = all[0].tilt();
        let on_states = all.iter().all(|load| load.tilt() == tilt);
        let interpolant = scene.accuracy.settings().adaptive_interpolant();
        if on_states
            && all.iter().all(|load| matches!(load, Load::Force { .. }))
            && let Ok(normal) = course.greatest_level(tilt, interpolant, PARTS)
        {
            return Ok(Loads { largest: vec![Load::Force { normal, tilt }], on_states });
        }
        let compliance = course.softest_compliance()?;
        let thinned = all.iter().step_by(if on_states { all.len() } else { THINNED });
        let elastic = greatest(&all, compliance).chain(thinned.map(|load| as_elastic(*load, compliance)));
        Ok(Loads { largest: elastic.collect(), on_states })
    }

    /// Initial length L of the domain: a contact of half width L/4 is indented by the gap at its edge, at a level of about
    /// L times this gap.
    pub(super) fn first_length(scene: &TrialScene<'_>, loads: &[Load]) -> Result<f64> {
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
        let sides = scene.body.sides;
        if let Some(Side::Uniform(length)) = sides.iter().find(|side| matches!(side, Side::Uniform(_))) {
            level /= length;
        }
        let lowest = scene.geometry.initial_gap(0.0, 0.0);
        let rise = |length: f64| {
            let around = [(0, [1.0, 0.0]), (1, [0.0, 1.0]), (0, [-1.0, 0.0]), (1, [0.0, -1.0])];
            let found = around.into_iter().filter(|(axis, _)| sides[*axis] == Side::Found);
            let gaps = found.map(|(_, [x1, x2])| scene.geometry.initial_gap(0.25 * length * x1, 0.25 * length * x2));
            gaps.fold(f64::INFINITY, f64::min) - lowest
        };
        let depth = |length: f64| {
            let rise = rise(length);
            rise >= approach.max(level / length) || rise.is_nan() || rise == f64::INFINITY
        };
        let lengths = (-48..=36).map(|k| 10f64.powf(0.25 * f64::from(k)));
        lengths.into_iter().find(|&length| depth(length)).ok_or(Error::NoDomain { length: 1e9 })
    }
}
