//! The fingerprint of a scene: what a checkpoint and the contact that continues it must have in common.

use serde::{Deserialize, Serialize};

use super::built::{Creep, Owners, difference};
use crate::contact::scene::Scene;
use crate::contact::settings::Settings;
use crate::error::CheckpointError;

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
