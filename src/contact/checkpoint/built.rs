//! Fingerprints of the gap and the material as built.

use std::sync::OnceLock;

use crc32fast::Hasher;
use serde::{Deserialize, Serialize};

use crate::equilibrium::Region;
use crate::geometry::Gap;
use crate::rheology::Material;
use crate::sum::{MOMENTS, add_to_moments};

/// Times at which materials without a series are compared: so many a decade, ...
const TIMES_PER_DECADE: i32 = 8;
/// ... so many decades before and after a second, as far as the material is known.
const DECADES: i32 = 12;

/// Fingerprint of gap and material as built.
#[derive(Debug, Clone, Default)]
pub(crate) struct Built {
    /// Sums over the gap.
    pub(super) shape: Vec<f64>,
    /// How many cells each rigid body has, and a checksum of whose they are.
    pub(super) owners: String,
    /// Computed at the first call: it may take many evaluations.
    creep: OnceLock<Mark>,
}

/// The value of a property by which scenes are compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Mark {
    Text(String),
    Numbers(Vec<f64>),
    /// A contact compliance: elastic part, fluidity, and strength and time of each term.
    Series(Vec<f64>),
    /// A contact compliance at some times.
    Values(Vec<f64>),
}

impl Built {
    /// Of a gap on the whole grid, or on a region of local rows: a call of all ranks.
    pub(crate) fn new(gap: &Gap, region: &Region) -> Built {
        let (mut known, mut open, mut touchable) = ([0.0; MOMENTS], [0.0; MOMENTS], 0);
        let [_, n2] = region.whole.cells();
        for (k, &h) in gap.above.iter().enumerate() {
            for [i, j] in region.images_of(k) {
                let [own, infinite] = if h.is_finite() { [h, 0.0] } else { [0.0, 1.0] };
                add_to_moments(&mut known, own, i * n2 + j, n2);
                add_to_moments(&mut open, infinite, i * n2 + j, n2);
                touchable += usize::from(h.is_finite());
            }
        }
        let rows = region.rows();
        let [known, open] = [known, open].map(|own| rows.join(own, |a, b| std::array::from_fn(|n| a[n] + b[n])));
        let owners = match &gap.owner {
            None => format!("{} cells of one body", rows.count(touchable)),
            Some(owner) => owners_of(gap, owner),
        };
        Built { shape: known.into_iter().chain(open).chain([gap.datum]).collect(), owners, creep: OnceLock::new() }
    }

    pub(super) fn creep(&self, material: &Material) -> &Mark {
        self.creep.get_or_init(|| match material.contact_spectrum() {
            Ok(Some(series)) => {
                let terms = series.terms().iter().flat_map(|&(c, lambda)| [c, lambda]);
                Mark::Series([series.glassy(), series.fluidity()].into_iter().chain(terms).collect())
            }
            _ => {
                let known = times().take_while(|&t| t <= material.known_until());
                Mark::Values(known.map(|t| material.contact_compliance(t)).collect())
            }
        })
    }
}

/// The cells of several bodies in words; cells without anything to touch belong to no body.
fn owners_of(gap: &Gap, owner: &[u16]) -> String {
    let (mut cells, mut hasher) = (Vec::new(), Hasher::new());
    for (body, _) in owner.iter().zip(&gap.above).filter(|(_, h)| h.is_finite()) {
        cells.resize(cells.len().max(usize::from(*body) + 1), 0);
        cells[usize::from(*body)] += 1;
        hasher.update(&body.to_le_bytes());
    }
    format!("{cells:?} cells of each body, with checksum {:08x}", hasher.finalize())
}

pub(super) fn times() -> impl Iterator<Item = f64> {
    let steps = -TIMES_PER_DECADE * DECADES..=TIMES_PER_DECADE * DECADES;
    std::iter::once(0.0).chain(steps.map(|k| 10_f64.powf(f64::from(k) / f64::from(TIMES_PER_DECADE))))
}
