//! What tells a scene from others: the parts that its results depend on, each by some numbers. Tolerance and limits of
//! the solver are no part of it.

use std::fmt::Debug;

use crate::attraction::Attraction;
use crate::contact::{Scene, Settings, ViscoelasticContact};
use crate::equilibrium::{Ground, Indenter, Region};
use crate::error::Refusal;
use crate::hereditary::ExponentialRule;
use crate::sum::scattered;

/// What tells a scene from others: its parts by name.
pub(crate) type Fingerprint = [(&'static str, Vec<f64>)];

/// Numbers of two scenes are the same if they differ by no more than this part: mathematical libraries round
/// differently.
const ROUNDING: f64 = 1e-9;

/// Rejects the saved parts of another scene, and names the first that differs.
pub(crate) fn require_same_scene(saved: &[Vec<f64>], scene: &Fingerprint) -> Result<(), Refusal> {
    let is_same = |(a, b): (&f64, &f64)| a == b || (a - b).abs() <= ROUNDING * a.abs().max(b.abs());
    let are_same = |a: &Vec<f64>, b: &Vec<f64>| a.len() == b.len() && a.iter().zip(b).all(is_same);
    let mut parts = scene.iter().enumerate();
    match parts.find(|(k, (_, own))| !saved.get(*k).is_some_and(|saved| are_same(saved, own))) {
        Some((_, &(what, _))) => Err(other_scene(what)),
        None => Ok(()),
    }
}

/// The error of a checkpoint of another scene, by what differs first.
pub(super) fn other_scene(what: &'static str) -> Refusal {
    let message = format!("the checkpoint is of another scene: its {what} differs from that of the contact");
    Refusal::file("checkpoint_other_scene", message, ": build the contact as it was saved").naming(what)
}

/// Recognises a value by its `Debug` text. The hash is split in two, so that different ones differ by more than
/// [`ROUNDING`]: halves are below 2¹⁶. A change of a `Debug` text refuses older files: the version is raised with it.
pub(crate) fn of_debug_text(text: &impl Debug) -> Vec<f64> {
    let hash = crc32fast::hash(format!("{text:?}").as_bytes());
    vec![f64::from(hash >> 16), f64::from(hash & 0xFFFF)]
}

/// The material, by the series that its rule follows.
pub(crate) fn of_rule(rule: &ExponentialRule) -> Vec<f64> {
    let relaxation = rule.relaxation();
    let terms = relaxation.terms().iter().flat_map(|&(modulus, time)| [modulus, time]);
    [relaxation.equilibrium(), relaxation.viscosity()].into_iter().chain(terms).collect()
}

/// Range, traction and energy at some gaps.
fn of_attraction(law: &dyn Attraction) -> Vec<f64> {
    let gaps = [0.0, 0.5, 1.0, 2.0].map(|ranges| ranges * law.range());
    gaps.into_iter().flat_map(|gap| [gap, law.traction(gap), law.energy(gap)]).collect()
}

/// The gap, with the bodies of its cells, by a sum whose weights have no symmetry. A call of all ranks.
fn of_gap(indenter: &Indenter, region: &Region) -> Vec<f64> {
    let ([n1, n2], gap) = (region.whole.cells(), indenter.gap());
    let sums = region.rows().sum_terms(|k| {
        let ([i, j], place) = (region.cell(k), indenter.index(&region.whole, region, k));
        let (height, weight) = (gap.above[place], scattered((gap.owner(place) * n1 + i) * n2 + j));
        height.is_finite().then_some([height * weight, weight])
    });
    sums.into_iter().chain([gap.datum]).collect()
}

impl ViscoelasticContact {
    /// A call of all ranks.
    pub(super) fn parts(&self, kind: &str) -> Vec<(&'static str, Vec<f64>)> {
        let Scene { ground, temperature, .. } = &*self.scene;
        let Ground { grid, kernel, bodies, attraction, .. } = ground;
        let Settings { time_rule, frame, symmetry, window, series_tolerance, .. } = ground.settings;
        let region = &self.computation.state.held.region;
        // the half or quarter that counts, whatever the region is by now
        let folded = if symmetry { self.built.even_axes(grid) } else { [false; 2] };
        let of_gap = of_gap(&self.built, &Region::whole(grid, folded).shared_like(region));
        vec![
            ("kind of contact", of_debug_text(&kind)),
            ("grid", [grid.cells().map(|n| n as f64), grid.spacing()].concat()),
            ("kernel", [of_debug_text(&kernel.to_string()), kernel.mark()].concat()),
            ("time rule, frame, symmetry or window", of_debug_text(&(time_rule, frame, symmetry, window))),
            ("series tolerance", vec![series_tolerance]),
            ("temperature", of_debug_text(temperature)),
            ("material", of_rule(self.computation.state.history.rule())),
            ("attraction", attraction.as_deref().map(of_attraction).unwrap_or_default()),
            ("geometry", [of_gap, vec![*bodies as f64]].concat()),
        ]
    }
}
