//! Coulomb's law of a contact, and what its loads ask of the levels.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::error::{Result, within};
use crate::load::{Load, LoadHistory, Tilt};
use crate::states::curve::{ElasticState, ElasticStates};
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

impl ElasticStates {
    /// By how much a body that is free to tilt turns as it is pressed: how far this moves the edge of its contact, over
    /// the depth, at most.
    pub(super) fn turn(&self) -> f64 {
        let of_state = |state: &ElasticState| {
            let turned = [0, 1].map(|axis| match self.tilt[axis] {
                Tilt::Free { .. } => (state.tilt[axis] - self.rest.tilt[axis]).abs(),
                Tilt::Fixed(_) => 0.0,
            });
            turned[0].max(turned[1]) * (state.area / PI).sqrt() / self.depth_of(state)
        };
        self.states.iter().filter(|state| state.level > 0.0).map(of_state).fold(0.0, f64::max)
    }
}
