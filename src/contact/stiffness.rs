//! How stiff the contact is.

use crate::contact::settings::Solver;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Convergence, Error, Result};
use crate::solver::{FLAT_PUNCH_TOLERANCE, flat_punch};

impl ViscoelasticContact {
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
        if self.state.contact_cells == 0 {
            return Ok(0.0);
        }
        if self.kernel_here.mean_is_held() && self.state.contact_cells == self.grid.len() {
            return Ok(f64::INFINITY);
        }
        match flat_punch(&self.kernel_here, |k| self.state.current.pressure[k] > 0.0) {
            Ok(sum) => Ok(sum * self.grid.cell_area() * self.region.images() as f64),
            Err((iterations, residual)) => {
                let (time, dt, tolerance) = (self.state.time, self.state.interval, FLAT_PUNCH_TOLERANCE);
                let convergence =
                    Convergence::new(Vec::new(), tolerance, self.settings.solver == Solver::ActiveSet, false).into();
                Err(Error::NotConverged { time, dt, iterations, residual, tolerance, convergence })
            }
        }
    }
}
