//! The zone in which an attraction acts at the edge of a contact.

use std::sync::Arc;

use crate::Grid;
use crate::adhesion::{Attraction, laws, softening};
use crate::contact::{Builder, Scene};
use crate::error::{Error, Refusal, Result, length, or_failure_of, positive};
use crate::rheology::Material;

impl Builder {
    /// The attraction between the surfaces: loads may then pull, and hold until the bodies separate
    /// ([`adhesion`](crate::adhesion)). A scene without one costs nothing more.
    ///
    /// [`ViscoelasticContact::pressure`](crate::ViscoelasticContact::pressure) is the pressure of the wall,
    /// [`Fields::traction_into`](crate::fields::Fields::traction_into) the net traction, which carries the force
    /// and displaces the bodies. The whole grid is computed, [`Settings::window`](crate::contact::Settings::window)
    /// does not count. A contact that tries to come off under a given force fails with
    /// [`Error::PulledOff`]; under a given approach or a spring
    /// it comes off within a step.
    ///
    /// The mesh must resolve the zone in which the attraction acts, of the length E* ρ²/w, or E* over the steepest
    /// slope of the law if that is less: with 4 cells in it the pull-off force of a sphere is off by up to 0.5 %, with
    /// 3 by up to 2.5 %, with 2 by up to 10 %. Below 4, at the modulus that the body has reached, steps warn
    /// ([`Warnings::COARSE_ZONE`](crate::contact::Warnings::COARSE_ZONE)); below 2, at the modulus at once, `build`
    /// fails. A longer range at the same work of separation needs fewer cells.
    ///
    /// ```
    /// use viscocontact::adhesion::{ExponentialAttraction, tabor_number};
    /// use viscocontact::prelude::*;
    ///
    /// let law = ExponentialAttraction::new(0.05, 2.0e-6)?;
    /// assert!(tabor_number(&law, 1.0e-3, 1.0e5)? > 0.5);
    /// let mut contact = ViscoelasticContact::builder(Grid::square(64, 0.3e-3)?)
    ///     .geometry(&Sphere::new(1.0e-3)?)
    ///     .material(Material::incompressible(Zener::new(2.5e5, 5.0e4, 5.0e4)?))
    ///     .attraction(law)
    ///     .build()?;
    /// contact.step(0.1, Load::force(0.0))?; // no load, and yet in contact
    /// assert!(contact.contact_cells() > 0 && contact.force().abs() < 1e-12);
    /// assert!(contact.step(0.1, Load::force(-20.0e-6))?.force < 0.0);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn attraction(self, law: impl Attraction + 'static) -> Builder {
        Builder { attraction: Some(Arc::new(law)), ..self }
    }
}

/// The length of the zone in which an attraction of this [`softening`] acts at the edge of a contact, over the longer
/// side of a cell. The pull-off force errs by this figure alike for all laws (docs/accuracy.md).
fn cells_in_zone(softening: f64, compliance: f64, grid: &Grid) -> f64 {
    1.0 / (longer_side(grid) * softening * compliance)
}

/// The longer side of a cell, of the sides along which there are several cells: a line contact is the same along its
/// one cell.
fn longer_side(grid: &Grid) -> f64 {
    let sides = grid.spacing().into_iter().zip(grid.cells()).filter(|(_, cells)| *cells > 1);
    sides.map(|(side, _)| side).reduce(f64::max).unwrap_or(grid.spacing()[0])
}

/// The slope at which a law softens. Rejects a law that is no attraction, and a mesh on which even the elastic
/// response has a zone of fewer than 2 cells.
pub(in crate::contact) fn resolved_softening(law: &dyn Attraction, material: &Material, grid: &Grid) -> Result<f64> {
    let of_law = || {
        positive("work of separation", law.work())?;
        length("range of the attraction", law.range())?;
        laws::usable(law).map_err(|violation| {
            let what = format!("the attraction breaks a law: {violation}");
            Refusal::value("adhesion_law", what, "; adhesion::laws::all tests it")
        })?;
        Ok(softening(law))
    };
    let softening = or_failure_of(|| law.failure(), of_law)?;
    let (cells, minimum) = (cells_in_zone(softening, material.glassy_compliance()?, grid), 2.0);
    // but for rounding
    if cells >= minimum * (1.0 - 1e-9) {
        return Ok(softening);
    }
    let (spacing, range) = (longer_side(grid) * cells / minimum, law.range() * (minimum / cells).sqrt());
    Err(Error::ZoneNotResolved { cells, minimum, spacing, range })
}

/// The cells in the zone at this compliance, where they are fewer than 4.
pub(in crate::contact::step) fn coarse_zone(scene: &Scene, compliance: impl FnOnce() -> f64) -> Option<f64> {
    let softening = scene.ground.softening;
    let in_zone = || cells_in_zone(softening, compliance(), &scene.ground.grid);
    (softening > 0.0).then(in_zone).filter(|cells| *cells < 4.0)
}
