//! Area, mesh error and stiffness of a contact.

use crate::contact::settings::Solver;
use crate::contact::state::State;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Convergence, Error, Result};
use crate::observe::area::Pressed;
use crate::observe::mesh_error::MeshError;
use crate::solver::{FLAT_PUNCH_TOLERANCE, flat_punch};

impl ViscoelasticContact {
    /// Area of contact \[m²\].
    ///
    /// Near the edge of a smooth contact the pressure rises with the root of the distance, so that p² extrapolates to the
    /// edge, to a part of a cell; the area is that of the polygons through these points. Where the pressure does not
    /// fall towards the edge, or there is nothing to touch beyond it, as at the rim of a punch, the contact ends with the
    /// cell. Measured on spheres: 2e-3 of the area at 64² cells and 5e-4 at 256², where counting cells
    /// ([`ViscoelasticContact::contact_cells`]) errs by 1.5e-2 and 4e-3. Where contact grows by creep, the cells that it has
    /// reached last are stiffer than those before them, and the root is approached within them only: then it errs by up to a
    /// few per cent at 128² cells.
    pub fn contact_area(&self) -> f64 {
        if self.contact_cells() == 0 { 0.0 } else { self.pressed().area() }
    }

    /// Estimates what the mesh costs in accuracy, from the cells on the rim of the contact: from how many they are among
    /// all, δ, and from the share s of the force that they carry. s √δ is of second order in the cell width where the
    /// pressure falls to zero at the edge, and of first order where it is singular there. All zero without contact, and in
    /// full contact of periodic bodies.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let body = Material::incompressible(Elastic::new(1.0e6)?);
    /// let mut contact = ViscoelasticContact::builder(Grid::square(64, 3.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(body)
    ///     .build()?;
    /// contact.step(0.0, Load::force(0.5))?;
    /// let hertz = viscocontact::analytic::Hertz::new(10.0e-3, 4.0e6, 0.5)?;
    /// let error = (contact.approach() / hertz.approach() - 1.0).abs();
    /// let estimate = contact.mesh_error().approach;
    /// assert!(error < 2.0 * estimate && error > 0.2 * estimate);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    pub fn mesh_error(&self) -> MeshError {
        self.pressed().mesh_error(self.contact_cells())
    }

    /// Normal stiffness of the contact over the contact modulus \[m\]: dW/dω = E* times this while the contact area stays as
    /// it is; with 1/C(0) it is the response to a jump, with 1/C(t) that to a step held for t. 2a for a circle of radius a.
    /// On one area bodies of all materials have it, and the electrical and thermal conductance of the contact are proportional to
    /// it (J. R. Barber, Proc. R. Soc. A 459, 2003).
    ///
    /// Zero without contact; infinite on periodic bodies in full contact, whose mean displacement is held. Costs about ten
    /// convolutions and as many preconditioners, and memory for them.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let mut contact = ViscoelasticContact::builder(Grid::square(64, 3.0e-3)?)
    ///     .geometry(&FlatPunch::circular(1.0e-3)?)
    ///     .material(Material::incompressible(Elastic::new(1.0e6)?))
    ///     .build()?;
    /// contact.step(0.0, Load::force(1.0))?;
    /// assert!((contact.stiffness_over_modulus()? / 2.0e-3 - 1.0).abs() < 0.01);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the iteration for it does not converge.
    pub fn stiffness_over_modulus(&self) -> Result<f64> {
        let State { clock, region, current, .. } = &self.computation.state;
        let kernel = self.computation.window.kernel();
        if current.contact_cells == 0 {
            return Ok(0.0);
        }
        if kernel.mean_is_held() && current.contact_cells == self.grid().len() {
            return Ok(f64::INFINITY);
        }
        match flat_punch(kernel, |k| current.solution.pressure[k] > 0.0) {
            Ok(sum) => Ok(sum * self.grid().cell_area() * region.images() as f64),
            Err((iterations, residual)) => {
                let (time, dt, tolerance) = (clock.time, clock.last_dt, FLAT_PUNCH_TOLERANCE);
                let convergence =
                    Convergence::new(Vec::new(), tolerance, self.settings().solver == Solver::ActiveSet, false).into();
                Err(Error::NotConverged { time, dt, iterations, residual, tolerance, convergence })
            }
        }
    }

    fn pressed(&self) -> Pressed<'_> {
        let (periodic, gap) = (self.scene.kernel.periodic_axes(), &self.computation.state.indenter.gap().above);
        Pressed { grid: self.grid(), periodic, pressure: self.pressure(), gap }
    }
}
