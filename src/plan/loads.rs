//! The loads of a scene, as loads of an elastic body of unit compliance.

use crate::ascending::Times;
use crate::error::{Error, Result};
use crate::load::Load;
use crate::plan::domain::Side;
use crate::plan::levels::Curve;
use crate::plan::trial_runs::TrialScene;
use crate::run::Stepping;

/// Number of even parts of the run at whose ends the load is sampled, and most corners of the load sampled.
const PARTS: u32 = 64;
const MAX_CORNERS: usize = 1000;
/// Every so many samples give an elastic state where the tilt changes.
const THINNED: usize = 8;
/// Tolerance of the steps that find the greatest level.
const LEVEL_TOLERANCE: f64 = 1e-4;

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
        let all = sampled(scene)?;
        let tilt = all[0].tilt();
        let on_states = all.iter().all(|load| load.tilt() == tilt);
        let kind = |load: &Load| match *load {
            Load::Force { normal, .. } => (0, normal),
            Load::Approach { approach, .. } => (1, approach),
            Load::Spring { drive, .. } => (2, drive),
        };
        if on_states
            && all.iter().all(|load| kind(load).0 == 0)
            && let Ok(normal) = greatest_level(scene)
        {
            return Ok(Loads { largest: vec![Load::Force { normal, tilt }], on_states });
        }
        let compliance = scene.softest_compliance()?;
        let of_kind = |which| all.iter().filter(move |load| kind(load).0 == which);
        let greatest = (0..3).filter_map(|which| of_kind(which).max_by(|a, b| kind(a).1.total_cmp(&kind(b).1)));
        let thinned = all.iter().step_by(if on_states { all.len() } else { THINNED });
        let elastic = greatest.chain(thinned).map(|load| match *load {
            Load::Force { normal, tilt } => Load::Force { normal: normal * compliance, tilt },
            Load::Spring { stiffness, drive, tilt } => Load::Spring { stiffness: stiffness * compliance, drive, tilt },
            approach => approach,
        });
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

/// Loads at even times, and at the corners and jumps of the history.
fn sampled(scene: &TrialScene<'_>) -> Result<Vec<Load>> {
    let TrialScene { history, until, .. } = *scene;
    let mut all = Vec::new();
    for k in 0..=PARTS {
        let time = until * f64::from(k) / f64::from(PARTS);
        all.push(history.at(time).validated_at(time, false)?);
    }
    let mut corner = 0.0;
    for _ in 0..MAX_CORNERS {
        match history.next_breakpoint(corner) {
            Some(next) if next > corner && next <= until => corner = next,
            _ => break,
        }
        all.extend([
            history.before(corner).validated_at(corner, false)?,
            history.at(corner).validated_at(corner, false)?,
        ]);
    }
    Ok(all)
}

/// The greatest level under a given force.
fn greatest_level(scene: &TrialScene<'_>) -> Result<f64> {
    let mut contact = Curve::of_any_shape(scene.history.at(0.0).tilt())?.contact(scene)?;
    let run = contact.follow(scene.history, Stepping::adaptive(LEVEL_TOLERANCE), scene.until);
    let mut run = run.sample_at(Times::every(scene.until / f64::from(PARTS)))?;
    let mut greatest = 0.0_f64;
    while run.next_step()?.is_some() {
        for sample in run.samples() {
            greatest = greatest.max(sample?.level());
        }
    }
    Ok(greatest)
}
