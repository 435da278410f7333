//! Fingerprint of gap and material as built.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::geometry::Gap;
use crate::rheology::Material;
use crate::sum::moments;

/// Numbers of two scenes are the same if they differ by no more than this part: mathematical libraries round differently.
const RELATIVE_TOLERANCE: f64 = 1e-9;
/// Times at which materials without a series are compared: so many a decade, ...
const TIMES_PER_DECADE: i32 = 8;
/// ... so many decades before and after a second, as far as the material is known.
const DECADES: i32 = 12;

/// Fingerprint of gap and material as built.
#[derive(Debug)]
pub(crate) struct Built {
    /// Sums over the gap.
    pub(super) shape: Vec<f64>,
    pub(super) owners: Owners,
    /// Found when it is first asked for: it may take many evaluations.
    creep: OnceLock<Creep>,
}

/// Which rigid body each cell belongs to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
        let (mut cells, mut hasher) = (Vec::new(), crc32fast::Hasher::new());
        // cells without anything to touch belong to no body
        for k in (0..gap.above.len()).filter(|&k| gap.above[k].is_finite()) {
            let body = gap.owner(k);
            cells.resize(cells.len().max(body + 1), 0);
            cells[body] += 1;
            hasher.update(&(body as u16).to_le_bytes());
        }
        Owners { cells, checksum: hasher.finalize() }
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
