//! What a checkpoint and the contact that continues it must have in common.

use serde::{Deserialize, Serialize};

use super::CheckpointError;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::rheology::Material;

/// Times \[s\] at which materials are compared: decades about a second.
const DECADES: std::ops::RangeInclusive<i32> = -9..=9;

/// A scene, as far as it does not change. The gap is part of the state: indenters move.
#[derive(Serialize, Deserialize)]
pub(super) struct SceneMark {
    cells: [usize; 2],
    /// Bits of the numbers, so that NaN is itself.
    spacing: [u64; 2],
    bodies: usize,
    kernel: String,
    /// The influence of a cell on itself.
    influence: u64,
    settings: String,
    /// C at some times.
    compliance: Vec<u64>,
}

impl SceneMark {
    pub(super) fn of(contact: &ViscoelasticContact) -> SceneMark {
        SceneMark {
            cells: contact.grid.cells(),
            spacing: contact.grid.spacing().map(f64::to_bits),
            bodies: contact.bodies(),
            kernel: contact.kernel.to_string(),
            influence: contact.kernel.self_influence().to_bits(),
            settings: format!("{:?}", contact.settings),
            compliance: contact.built_compliance.clone(),
        }
    }

    /// Refuses another scene, and says what differs first.
    pub(super) fn require(&self, built: &SceneMark) -> Result<(), CheckpointError> {
        let differs = |what: &'static str, saved: String, built: String| {
            if saved == built { Ok(()) } else { Err(CheckpointError::OtherScene { what, saved, built }) }
        };
        let grid = |mark: &SceneMark| {
            let [side1, side2] = mark.spacing.map(f64::from_bits);
            format!("{} × {} cells of {side1:e} m × {side2:e} m", mark.cells[0], mark.cells[1])
        };
        differs("grid", grid(self), grid(built))?;
        differs("number of rigid bodies", self.bodies.to_string(), built.bodies.to_string())?;
        differs("kernel", self.kernel.clone(), built.kernel.clone())?;
        let influence = |mark: &SceneMark| format!("{:e} m of a cell on itself", f64::from_bits(mark.influence));
        differs("influence", influence(self), influence(built))?;
        differs("settings", self.settings.clone(), built.settings.clone())?;
        let pairs = self.compliance.iter().zip(&built.compliance).zip(std::iter::once(None).chain(DECADES.map(Some)));
        for ((&saved, &built), decade) in pairs {
            if saved != built {
                let show = |bits: u64| {
                    let value = f64::from_bits(bits);
                    decade.map_or(format!("{value:e} 1/Pa at 0 s"), |decade| format!("{value:e} 1/Pa at 1e{decade} s"))
                };
                return differs("contact compliance", show(saved), show(built));
            }
        }
        Ok(())
    }
}

/// C of a material at the times of comparison.
pub(crate) fn compliance_of(material: &Material) -> Vec<u64> {
    let times = std::iter::once(0.0).chain(DECADES.map(|decade| 10_f64.powi(decade)));
    times.map(|t| material.contact_compliance(t).to_bits()).collect()
}
