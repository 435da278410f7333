//! What a checkpoint and the contact that continues it must have in common.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::contact::settings::{Settings, TimeRule};
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::CheckpointError;
use crate::geometry::Gap;
use crate::rheology::Material;
use crate::sum::moments;

/// Numbers of two scenes are the same if they differ by no more than this part: mathematical libraries round differently.
const SAME: f64 = 1e-9;
/// Times at which materials without a series are compared: so many a decade, ...
const A_DECADE: i32 = 8;
/// ... so many decades before and after a second, as far as the material is known.
const DECADES: i32 = 12;

/// What a contact was built of, as far as steps change it.
#[derive(Debug)]
pub(crate) struct Built {
    pub(super) material: Material,
    /// Sums over the gap.
    shape: Vec<f64>,
    owners: Owners,
    /// Found when it is first asked for: it may take many evaluations.
    creep: OnceLock<Creep>,
}

/// Which rigid body each cell belongs to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Owners {
    /// Cells of each body.
    cells: Vec<u64>,
    checksum: u32,
}

/// The contact compliance of a material, by numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Creep {
    /// Elastic part, fluidity, and strength and time of each term.
    Series(Vec<f64>),
    /// Its values at some times.
    Values(Vec<f64>),
}

/// A scene, as far as it must not change. How steps are solved may: solver, tolerance, limits.
#[derive(Serialize, Deserialize)]
pub(super) struct SceneMark {
    cells: [usize; 2],
    spacing: [f64; 2],
    bodies: usize,
    kernel: String,
    /// Sums over its influence.
    influence: Vec<f64>,
    time_rule: String,
    frame: String,
    symmetry: bool,
    window: bool,
    series_tolerance: f64,
    creep: Creep,
    shape: Vec<f64>,
    owners: Owners,
}

impl Built {
    pub(crate) fn new(material: &Material, gap: &Gap, cells: [usize; 2]) -> Built {
        let known = gap.above.iter().map(|h| if h.is_finite() { *h } else { 0.0 });
        let open = gap.above.iter().map(|h| f64::from(h.is_infinite()));
        let mut shape = moments(known, cells[1]);
        shape.extend(moments(open, cells[1]));
        shape.push(gap.datum);
        Built { material: material.clone(), shape, owners: Owners::of(gap), creep: OnceLock::new() }
    }

    fn creep(&self) -> &Creep {
        self.creep.get_or_init(|| match self.material.contact_spectrum() {
            Ok(Some(series)) => {
                let terms = series.terms().iter().flat_map(|&(c, lambda)| [c, lambda]);
                Creep::Series([series.glassy(), series.fluidity()].into_iter().chain(terms).collect())
            }
            _ => {
                let known = times().take_while(|&t| t <= self.material.known_until());
                Creep::Values(known.map(|t| self.material.contact_compliance(t)).collect())
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
    fn difference(&self, other: &Owners) -> [String; 2] {
        let body = self.cells.iter().zip(&other.cells).position(|(one, two)| one != two);
        [self, other].map(|owners| match body {
            Some(body) => format!("{} to body {body}", owners.cells[body]),
            None => format!("one with checksum {:08x}", owners.checksum),
        })
    }
}

fn times() -> impl Iterator<Item = f64> {
    let steps = -A_DECADE * DECADES..=A_DECADE * DECADES;
    std::iter::once(0.0).chain(steps.map(|k| 10_f64.powf(f64::from(k) / f64::from(A_DECADE))))
}

/// The first entry that differs.
fn difference(saved: &[f64], built: &[f64]) -> Option<usize> {
    let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= SAME * a.abs().max(b.abs());
    let differing = saved.iter().zip(built).position(|(&a, &b)| !same(a, b));
    differing.or_else(|| (saved.len() != built.len()).then(|| saved.len().min(built.len())))
}

impl Creep {
    fn difference(&self, other: &Creep) -> Option<usize> {
        match (self, other) {
            (Creep::Series(saved), Creep::Series(built)) | (Creep::Values(saved), Creep::Values(built)) => {
                difference(saved, built)
            }
            _ => Some(0),
        }
    }

    /// One of its numbers, in words.
    fn entry(&self, entry: usize) -> String {
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

impl SceneMark {
    pub(super) fn of(contact: &ViscoelasticContact) -> SceneMark {
        let Settings { time_rule, frame, symmetry, window, series_tolerance, .. } = contact.settings;
        let rule = if time_rule == TimeRule::Automatic { TimeRule::Exponential } else { time_rule };
        SceneMark {
            cells: contact.grid.cells(),
            spacing: contact.grid.spacing(),
            bodies: contact.bodies(),
            kernel: contact.kernel.to_string(),
            influence: contact.kernel.mark(),
            time_rule: format!("{rule:?}"),
            frame: format!("{frame:?}"),
            symmetry,
            window,
            series_tolerance,
            creep: contact.built.creep().clone(),
            shape: contact.built.shape.clone(),
            owners: contact.built.owners.clone(),
        }
    }

    /// Refuses another scene, and says what differs first.
    pub(super) fn require(&self, built: &SceneMark) -> Result<(), CheckpointError> {
        let differs = |what: &'static str, saved: String, built: String| {
            if saved == built { Ok(()) } else { Err(CheckpointError::OtherScene { what, saved, built }) }
        };
        let numbers = |what: &'static str, saved: &[f64], built: &[f64]| match difference(saved, built) {
            Some(k) => {
                let entry = |numbers: &[f64]| numbers.get(k).map_or("another".into(), |x| format!("one of {x:e}"));
                Err(CheckpointError::OtherScene { what, saved: entry(saved), built: entry(built) })
            }
            None => Ok(()),
        };
        let grid = |mark: &SceneMark| {
            format!("{} × {} cells of {:e} m × {:e} m", mark.cells[0], mark.cells[1], mark.spacing[0], mark.spacing[1])
        };
        if self.cells != built.cells || difference(&self.spacing, &built.spacing).is_some() {
            return Err(CheckpointError::OtherScene { what: "grid", saved: grid(self), built: grid(built) });
        }
        differs("number of rigid bodies", self.bodies.to_string(), built.bodies.to_string())?;
        differs("kernel", self.kernel.clone(), built.kernel.clone())?;
        numbers("influence", &self.influence, &built.influence)?;
        differs("Settings::time_rule", self.time_rule.clone(), built.time_rule.clone())?;
        differs("Settings::frame", self.frame.clone(), built.frame.clone())?;
        differs("Settings::symmetry", self.symmetry.to_string(), built.symmetry.to_string())?;
        differs("Settings::window", self.window.to_string(), built.window.to_string())?;
        let tolerance = |mark: &SceneMark| format!("{:e}", mark.series_tolerance);
        differs("Settings::series_tolerance", tolerance(self), tolerance(built))?;
        if let Some(entry) = self.creep.difference(&built.creep) {
            let [saved, built] = [&self.creep, &built.creep].map(|creep| creep.entry(entry));
            return Err(CheckpointError::OtherScene { what: "contact compliance", saved, built });
        }
        numbers("geometry", &self.shape, &built.shape)?;
        if self.owners != built.owners {
            let [saved, built] = self.owners.difference(&built.owners);
            return Err(CheckpointError::OtherScene { what: "assignment of cells to rigid bodies", saved, built });
        }
        Ok(())
    }
}
