//! What a contact of surfaces that attract each other shows.

use crate::adhesion::Attraction;
use crate::contact::state::State;
use crate::contact::step::attraction::PassReport;
use crate::contact::stepper::ViscoelasticContact;
use crate::error::{AdhesionError, Result, exact_length};

impl ViscoelasticContact {
    /// The attraction between the surfaces ([`Builder::attraction`](crate::contact::Builder::attraction)).
    pub fn attraction(&self) -> Option<&dyn Attraction> {
        self.scene.attraction.as_deref()
    }

    /// Writes the net traction between the bodies into `out` \[Pa\], one value per cell: the [pressure](ViscoelasticContact::pressure) of the
    /// wall less the attraction, < 0 where the bodies pull at each other. It carries the force, and displaces the bodies.
    ///
    /// # Errors
    /// If `out` does not hold one value per cell.
    pub fn traction_into(&self, out: &mut [f64]) -> Result<()> {
        let State { region, current, .. } = &self.computation.state;
        exact_length("traction", out.len(), region.shown_len())?;
        if current.solution.attraction.is_empty() {
            out.copy_from_slice(self.pressure());
        } else {
            region.show(&current.solution.attraction, out);
            out.iter_mut().zip(self.pressure()).for_each(|(traction, pressure)| *traction = pressure - *traction);
        }
        Ok(())
    }

    /// How the passes of the step tried last went; `None` without attraction, and before the first step.
    pub fn passes(&self) -> Option<PassReport> {
        self.computation.trial.passes.as_ref().map(|passes| passes.report)
    }

    /// Refuses what is not covered where surfaces attract each other.
    pub(crate) fn not_attracted(&self, what: &'static str, cure: &'static str) -> Result<()> {
        match self.scene.attraction {
            Some(_) => Err(AdhesionError::NotCovered { what, cure }.into()),
            None => Ok(()),
        }
    }
}
