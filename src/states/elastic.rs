//! The elastic contact of unit compliance that states are solved with.

use crate::Grid;
use crate::contact::{Builder, Figures, ViscoelasticContact, Warnings};
use crate::error::{Result, StatesError};
use crate::load::{Load, Tilt};
use crate::states::curve::{ElasticState, ElasticStates};
use crate::states::pressed::Pressed;

/// A contact that jumps from state to state, each solved from the last one.
#[derive(Debug)]
pub(super) struct ElasticContact(ViscoelasticContact);

/// A state and its pressure.
pub(super) struct Solved {
    pub(super) state: ElasticState,
    pub(super) pressure: Pressed,
}

impl ElasticContact {
    pub(super) fn new(scene: &Builder) -> Result<ElasticContact> {
        scene.clone().build().map(ElasticContact)
    }

    /// Of an undisturbed contact of unit compliance.
    pub(super) fn of(contact: ViscoelasticContact) -> ElasticContact {
        ElasticContact(contact)
    }

    /// Pressure, approach and area of the contact under a load, and the convolutions that they took.
    pub(super) fn pressed(&mut self, load: Load) -> Result<(Pressed, f64, f64, usize)> {
        let report = self.0.step(0.0, load)?;
        let contact = &self.0;
        Ok((Pressed::new(contact.pressure()), contact.approach(), contact.contact_area(), report.convolutions))
    }

    pub(super) fn grid(&self) -> &Grid {
        self.0.grid()
    }

    /// The contact under a load.
    pub(super) fn under(&mut self, load: Load) -> Result<&ViscoelasticContact> {
        self.0.step(0.0, load)?;
        Ok(&self.0)
    }

    /// The state under a load.
    pub(super) fn solve(&mut self, load: Load) -> Result<Solved> {
        let report = self.0.step(0.0, load)?;
        let contact = &self.0;
        let level = if let Load::Force { normal, .. } = load { normal } else { contact.force() };
        let free = load.tilt().map(|tilt| if let Tilt::Free { at } = tilt { Some(at) } else { None });
        let (stiffness, [compliance, tilt_rate @ ..]) = contact.stiffnesses(free)?;
        let state = ElasticState {
            level,
            approach: contact.approach(),
            tilt: contact.tilt(),
            stiffness,
            load_stiffness: 1.0 / compliance,
            tilt_rate,
            area: contact.contact_area(),
            cells: contact.contact_cells(),
            patches: contact.patches()?.all.len(),
            // warnings of its own modulus and solver do not apply to the contacts that are made of it
            warnings: report.warnings - Warnings::MODULUS - Warnings::FALL_BACK - Warnings::ROUNDING,
            figures: Figures { modulus: None, ..report.figures },
        };
        Ok(Solved { state, pressure: Pressed::new(contact.pressure()) })
    }
}

impl ElasticStates {
    /// An elastic contact of unit compliance on this surface, undisturbed.
    pub(super) fn elastic_contact(&self) -> Result<ElasticContact> {
        ElasticContact::new(self.scene.as_ref().ok_or(StatesError::NoScene)?)
    }
}
