//! The fingerprint of a scene: what a checkpoint and the contact that continues it must have in common.

use serde::{Deserialize, Serialize};

use super::built::{Creep, Owners, difference};
use crate::contact::scene::Scene;
use crate::contact::settings::Settings;
use crate::error::CheckpointError;

/// A scene, as far as it must not change. How steps are solved may: solver, tolerance, limits.
#[derive(Serialize, Deserialize)]
pub(super) struct Fingerprint {
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

impl Fingerprint {
    pub(super) fn of(scene: &Scene) -> Fingerprint {
        let Settings { time_rule, frame, symmetry, window, series_tolerance, .. } = scene.settings;
        Fingerprint {
            cells: scene.grid.cells(),
            spacing: scene.grid.spacing(),
            bodies: scene.bodies,
            kernel: scene.kernel.to_string(),
            influence: scene.kernel.mark(),
            time_rule: format!("{time_rule:?}"),
            frame: format!("{frame:?}"),
            symmetry,
            window,
            series_tolerance,
            creep: scene.built.creep(&scene.material).clone(),
            shape: scene.built.shape.clone(),
            owners: scene.built.owners.clone(),
        }
    }

    /// Refuses another scene, and says what differs first.
    pub(super) fn require(&self, built: &Fingerprint) -> Result<(), CheckpointError> {
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
        let grid = |mark: &Fingerprint| {
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
        let tolerance = |mark: &Fingerprint| format!("{:e}", mark.series_tolerance);
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
