//! Coulomb's law of a contact, and what its loads ask of the levels.

use std::sync::Arc;

use crate::error::{Result, within};
use crate::load::{Load, LoadHistory, Tilt};
use crate::states::levels::Demand;

/// Coulomb's law of a contact.
#[derive(Debug, Clone)]
pub(super) struct CoulombOnStates {
    /// Coefficient of friction f.
    pub(super) coefficient: f64,
    /// Tangential compliance over the normal one.
    pub(super) ratio: f64,
    /// What acts along the surface.
    pub(super) history: Option<Arc<dyn LoadHistory>>,
}

impl CoulombOnStates {
    /// What tells it from another.
    #[cfg(feature = "checkpoint")]
    pub(super) fn numbers(&self) -> [f64; 2] {
        [self.coefficient, self.ratio]
    }

    /// What multiplies displacements of the levels: the coefficient, and the tangential compliance over the normal one.
    pub(super) fn of_displacement(&self) -> f64 {
        self.coefficient * self.ratio
    }

    /// What a load along the surface asks of the levels.
    pub(super) fn demand(&self, load: Load) -> Result<Demand> {
        for tilt in load.tilt() {
            let (Tilt::Fixed(angle) | Tilt::Free { at: angle }) = tilt;
            within("tilt of a load along the surface", angle, tilt == Tilt::Fixed(0.0), "0: it only shifts the body")?;
        }
        let of_displacement = self.of_displacement();
        Ok(match load {
            Load::Force { normal: force, .. } => Demand::Force(force / self.coefficient),
            Load::Approach { approach: shift, .. } => Demand::Depth { depth: shift / of_displacement, give: 0.0 },
            Load::Spring { stiffness, drive, .. } => {
                let (give, allowed) = (1.0 / (stiffness * self.ratio), "so great that its inverse is a number");
                within("stiffness of a spring along the surface", stiffness, give.is_finite(), allowed)?;
                Demand::Depth { depth: drive / of_displacement, give }
            }
        })
    }
}
