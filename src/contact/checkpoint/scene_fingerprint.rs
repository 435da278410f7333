//! Fingerprints of the scene: gap and material as built, and their comparison.

use std::sync::OnceLock;

use crc32fast::Hasher;
use serde::{Deserialize, Serialize};

use crate::contact::scene::Scene;
use crate::contact::settings::Settings;
use crate::contact::window::region::Region;
use crate::error::CheckpointError;
use crate::geometry::Gap;
use crate::rheology::Material;
use crate::sum::{MOMENTS, add_to_moments, moments};

/// Numbers of two scenes are the same if they differ by no more than this part: mathematical libraries round differently.
const RELATIVE_TOLERANCE: f64 = 1e-9;
/// Times at which materials without a series are compared: so many a decade, ...
const TIMES_PER_DECADE: i32 = 8;
/// ... so many decades before and after a second, as far as the material is known.
const DECADES: i32 = 12;

/// Fingerprint of gap and material as built.
#[derive(Debug, Default)]
pub(crate) struct Built {
    /// Sums over the gap.
    pub(super) shape: Vec<f64>,
    pub(super) owners: Owners,
    /// Computed at the first call: it may take many evaluations.
    creep: OnceLock<Creep>,
}

/// Which rigid body each cell belongs to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Owners {
    /// Cells of each body.
    cells: Vec<u64>,
    checksum: u32,
}

/// The contact compliance of a material, by numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Creep {
    /// Elastic part, fluidity, and strength and time of each term.
    Series(Vec<f64>),
    /// Its values at some times.
    Values(Vec<f64>),
}

impl Built {
    pub(crate) fn new(gap: &Gap, cells: [usize; 2]) -> Built {
        let known = gap.above.iter().map(|h| if h.is_finite() { *h } else { 0.0 });
        let open = gap.above.iter().map(|h| f64::from(h.is_infinite()));
        let mut shape = moments(known, cells[1]);
        shape.extend(moments(open, cells[1]));
        shape.push(gap.datum);
        Built { shape, owners: Owners::of(gap), creep: OnceLock::new() }
    }

    /// The same of a single body whose gap on a region of own rows is shared out: a call of all ranks.
    pub(crate) fn of_own_rows(gap: &Gap, region: &Region) -> Built {
        let (mut known, mut open, mut touchable) = ([0.0; MOMENTS], [0.0; MOMENTS], 0);
        let [_, n2] = region.whole_cells();
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
        let shape = known.into_iter().chain(open).chain([gap.datum]).collect();
        Built { shape, owners: Owners::of_one_body(rows.count(touchable)), creep: OnceLock::new() }
    }

    pub(super) fn creep(&self, material: &Material) -> &Creep {
        self.creep.get_or_init(|| match material.contact_spectrum() {
            Ok(Some(series)) => {
                let terms = series.terms().iter().flat_map(|&(c, lambda)| [c, lambda]);
                Creep::Series([series.glassy(), series.fluidity()].into_iter().chain(terms).collect())
            }
            _ => {
                let known = times().take_while(|&t| t <= material.known_until());
                Creep::Values(known.map(|t| material.contact_compliance(t)).collect())
            }
        })
    }
}

impl Owners {
    fn of(gap: &Gap) -> Owners {
        let (mut cells, mut hasher) = (Vec::new(), Hasher::new());
        // cells without anything to touch belong to no body
        for k in (0..gap.above.len()).filter(|&k| gap.above[k].is_finite()) {
            let body = gap.owner(k);
            cells.resize(cells.len().max(body + 1), 0);
            cells[body] += 1;
            hasher.update(&(body as u16).to_le_bytes());
        }
        Owners { cells, checksum: hasher.finalize() }
    }

    /// Those of a single body.
    fn of_one_body(cells: usize) -> Owners {
        // the checksum of as many zeros, from the checksums of powers of two
        let (mut hasher, mut zeros) = (Hasher::new(), Hasher::new());
        zeros.update(&0_u16.to_le_bytes());
        for bit in 0..usize::BITS - cells.leading_zeros() {
            if cells >> bit & 1 == 1 {
                hasher.combine(&zeros);
            }
            zeros.combine(&zeros.clone());
        }
        Owners { cells: vec![cells as u64; usize::from(cells > 0)], checksum: hasher.finalize() }
    }

    /// The cells of the first body that differs from `other`, in words.
    pub(super) fn difference(&self, other: &Owners) -> [String; 2] {
        let body = self.cells.iter().zip(&other.cells).position(|(one, two)| one != two);
        [self, other].map(|owners| match body {
            Some(body) => format!("{} to body {body}", owners.cells[body]),
            None => format!("one with checksum {:08x}", owners.checksum),
        })
    }
}

fn times() -> impl Iterator<Item = f64> {
    let steps = -TIMES_PER_DECADE * DECADES..=TIMES_PER_DECADE * DECADES;
    std::iter::once(0.0).chain(steps.map(|k| 10_f64.powf(f64::from(k) / f64::from(TIMES_PER_DECADE))))
}

/// The first entry that differs.
pub(super) fn difference(saved: &[f64], built: &[f64]) -> Option<usize> {
    let same = |a: f64, b: f64| {
        a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= RELATIVE_TOLERANCE * a.abs().max(b.abs())
    };
    let differing = saved.iter().zip(built).position(|(&a, &b)| !same(a, b));
    differing.or_else(|| (saved.len() != built.len()).then(|| saved.len().min(built.len())))
}

impl Creep {
    pub(super) fn difference(&self, other: &Creep) -> Option<usize> {
        match (self, other) {
            (Creep::Series(saved), Creep::Series(built)) | (Creep::Values(saved), Creep::Values(built)) => {
                difference(saved, built)
            }
            _ => Some(0),
        }
    }

    /// One of its numbers, in words.
    pub(super) fn entry(&self, entry: usize) -> String {
        let (Creep::Series(numbers) | Creep::Values(numbers)) = self;
        let Some(number) = numbers.get(entry) else { return format!("known by {} numbers", numbers.len()) };
        match self {
            Creep::Values(_) => format!("{number:e} 1/Pa at {:.3e} s", times().nth(entry).unwrap_or(f64::NAN)),
            Creep::Series(_) if entry == 0 => format!("{number:e} 1/Pa at 0 s"),
            Creep::Series(_) if entry == 1 => format!("one that flows by {number:e} 1/(Pa s)"),
            Creep::Series(_) if entry.is_multiple_of(2) => format!("{number:e} 1/Pa in term {}", entry / 2),
            Creep::Series(_) => format!("one with a time of {number:e} s in term {}", entry / 2),
        }
    }
}

/// What is compared in words.
const CHOICES: [&str; 8] = [
    "number of rigid bodies",
    "kernel",
    "Settings::time_rule",
    "Settings::frame",
    "Settings::symmetry",
    "Settings::window",
    "Settings::series_tolerance",
    "temperature",
];

/// A scene, as far as it must not change. Solver, tolerance and limits may.
#[derive(Serialize, Deserialize)]
pub(super) struct Fingerprint {
    cells: [usize; 2],
    spacing: [f64; 2],
    choices: [String; 8],
    /// Sums over the influence of the kernel.
    influence: Vec<f64>,
    creep: Creep,
    /// Sums over the gap.
    pub(super) shape: Vec<f64>,
    owners: Owners,
}

impl Fingerprint {
    pub(super) fn of(scene: &Scene) -> Fingerprint {
        let Settings { time_rule, frame, symmetry, window, series_tolerance, .. } = scene.settings;
        Fingerprint {
            cells: scene.grid.cells(),
            spacing: scene.grid.spacing(),
            choices: [
                scene.bodies.to_string(),
                scene.kernel.to_string(),
                format!("{time_rule:?}"),
                format!("{frame:?}"),
                symmetry.to_string(),
                window.to_string(),
                format!("{series_tolerance:e}"),
                format!("{:?}", scene.temperature),
            ],
            influence: scene.kernel.mark(),
            creep: scene.built.creep(&scene.material).clone(),
            shape: scene.built.shape.clone(),
            owners: scene.built.owners.clone(),
        }
    }

    /// Rejects another scene, and reports the first difference.
    pub(super) fn require(&self, built: &Fingerprint) -> Result<(), CheckpointError> {
        let differ =
            |what: &'static str, [saved, built]: [String; 2]| Err(CheckpointError::OtherScene { what, saved, built });
        let numbers = |what: &'static str, saved: &[f64], built: &[f64]| {
            let Some(k) = difference(saved, built) else { return Ok(()) };
            let entry = |numbers: &[f64]| numbers.get(k).map_or("another".into(), |x| format!("one of {x:e}"));
            differ(what, [saved, built].map(entry))
        };
        if self.cells != built.cells || difference(&self.spacing, &built.spacing).is_some() {
            let grid = |Fingerprint { cells: [n1, n2], spacing: [d1, d2], .. }: &Fingerprint| {
                format!("{n1} × {n2} cells of {d1:e} m × {d2:e} m")
            };
            return differ("grid", [self, built].map(grid));
        }
        if let Some(k) = (0..CHOICES.len()).find(|&k| self.choices[k] != built.choices[k]) {
            return differ(CHOICES[k], [self, built].map(|scene| scene.choices[k].clone()));
        }
        numbers("influence", &self.influence, &built.influence)?;
        if let Some(entry) = self.creep.difference(&built.creep) {
            return differ("contact compliance", [self, built].map(|scene| scene.creep.entry(entry)));
        }
        numbers("geometry", &self.shape, &built.shape)?;
        if self.owners == built.owners {
            return Ok(());
        }
        differ("assignment of cells to rigid bodies", self.owners.difference(&built.owners))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::parallel::{Rows, Threads};

    /// What ranks find of a gap, each on own rows, is what one process finds of the whole, folded or not.
    #[test]
    fn ranks_find_what_one_process_finds() {
        let grid = Grid::new([64, 384], [1.0e-3, 6.0e-3]).unwrap();
        for folded in [[false; 2], [true, false], [false, true], [true; 2]] {
            let about = |x: f64, folded: bool| if folded { x * x } else { (x - 0.1e-3) * (x - 0.1e-3) + 1.0e-9 * x };
            let above = (0..grid.len()).map(|k| {
                let [x1, x2] = grid.center(k / 384, k % 384);
                let h = about(x1, folded[0]) + about(x2, folded[1]);
                if h > 4.0e-6 { f64::INFINITY } else { h }
            });
            let gap = Gap { datum: 1.0e-6, above: above.collect(), owner: None };
            let expected = Built::new(&gap, grid.cells());
            assert!(expected.shape[5] > 0.0);
            for size in [1, 3, 5] {
                let found = Threads::run(size, |ranks| {
                    let region = Region::shared(&grid, folded, &Rows::of_rank(grid.cells(), ranks));
                    let own = Gap { datum: 1.0e-6, above: region.cut(&gap.above), owner: None };
                    Built::of_own_rows(&own, &region)
                });
                for found in found.unwrap() {
                    assert_eq!(found.owners, expected.owners);
                    assert_eq!(difference(&found.shape, &expected.shape), None, "{folded:?} {size}");
                }
            }
        }
        for cells in [0, 1, 2, 3, 1000, 4097] {
            let gap = Gap { datum: 0.0, above: vec![0.0; cells], owner: None };
            assert_eq!(Owners::of_one_body(cells), Owners::of(&gap));
        }
    }
}
