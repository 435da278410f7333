//! The elastic contact of unit compliance that states are solved with.

use crate::contact::{Figures, Warnings};
use crate::elastic::ElasticContact;
use crate::error::{Error, Refusal, Result};
use crate::load::{Load, Tilt};
use crate::states::curve::{ElasticState, ElasticStates};
use crate::states::pressed::Pressed;

/// A state and its pressure.
pub(super) struct Solved {
    pub(super) state: ElasticState,
    pub(super) pressure: Pressed,
}

/// The state of an elastic contact of unit compliance under a load, solved from the last one.
pub(super) fn state_under(contact: &mut ElasticContact, load: Load) -> Result<Solved> {
    let report = contact.solve(load)?;
    let (rounded, fields) = (contact.heights_are_lost(), contact.fields());
    let level = if let Load::Force { normal, .. } = load { normal } else { fields.force() };
    let free = free_points(load.tilt());
    let (stiffness, [compliance, tilt_rate @ ..]) = fields.stiffnesses(free)?;
    let state = ElasticState {
        level,
        approach: fields.approach(),
        tilt: fields.tilt(),
        stiffness,
        load_stiffness: 1.0 / compliance,
        tilt_rate,
        area: fields.contact_area(),
        cells: fields.contact_cells(),
        patches: fields.patches()?.all.len(),
        // warnings of its own modulus and solver do not apply to the contacts that are made of it, those of its shape
        // do
        warnings: (report.warnings - Warnings::MODULUS - Warnings::FALL_BACK - Warnings::ROUNDING)
            | Warnings::of(&[(Warnings::ROUNDING, rounded)]),
        figures: Figures { modulus: None, ..report.figures },
    };
    Ok(Solved { state, pressure: Pressed::new(fields.pressure()) })
}

/// The error of a load whose tilts are not those of a sweep.
pub(super) fn other_tilt(swept: [Tilt; 2], given: Load) -> Error {
    let swept = Load::Force { normal: 0.0, tilt: swept };
    let what = format!(
        "the states were swept for {swept}, and {given} was given: a load point or a prescribed tilt that changes is \
         no superposition of elastic states"
    );
    Refusal::unsupported("states_other_tilt", what, "; step it with ViscoelasticContact").into()
}

/// The point about which a body tilts freely, along each axis along which it does.
pub(super) fn free_points(tilt: [Tilt; 2]) -> [Option<f64>; 2] {
    tilt.map(|tilt| if let Tilt::Free { at } = tilt { Some(at) } else { None })
}

impl ElasticStates {
    /// An elastic contact of unit compliance on this surface, undisturbed.
    pub(super) fn elastic_contact(&self) -> Result<ElasticContact> {
        let what = "the states hold no surface to solve a contact on";
        let remedy = ": fields need the states of a Sweep of this process";
        let none = || Refusal::unsupported("states_no_scene", what, remedy);
        self.scene.as_ref().ok_or_else(none)?.clone().build()
    }
}
