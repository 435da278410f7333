//! Where the error of a run comes from.

use std::fmt;

use crate::observe::MeshError;

/// Where the error of a run comes from, made by
/// [`Follow::error_budget`](crate::contact::Follow::error_budget). All relative; `None` where nothing was estimated.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Burgers::new(1.0e6, 2.0e6, 0.5e6, 0.5e6)?))
///     .build()?;
/// let load = PiecewiseLinear::new(&[(0.0, Load::force(0.5)), (2.0, Load::force(0.5)), (3.0, Load::force(0.0))])?;
/// let mut run = contact.follow(&load, Stepping::fixed(0.5), 4.0);
/// assert_eq!(run.error_budget().time, None);
/// while run.next_step()?.is_some() {}
/// let budget = run.error_budget();
/// assert!(budget.time > Some(1.0e-3));
/// assert_eq!(budget.mesh, None); // the bodies have parted ...
/// assert!(budget.max_mesh.is_some()); // ... but were in contact before
/// println!("{budget}");
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ErrorBudget {
    /// Greatest error in time estimated for a step: of the approach where a force is given, of the force where a motion is.
    /// Relative to the displacement, or to v = K p; below a part of the greatest so far, to that part. 0 of elastic bodies,
    /// which make no such error; `None` before the first step.
    ///
    /// Of steps chosen by their error it is what they were chosen by, or the error that all steps together have left, as far as a
    /// mean over the contact gives, where that is greater. Steps of given length are estimated by the same, and the
    /// first after a jump or a corner of a force from the material alone. Measured on a sphere and six bodies
    /// (`tests/time/fixed_steps.rs`), the true error is 0.5 to 1.5 times the estimate for forces that jump or grow linearly.
    /// It is up to 4.5 times where a force begins like a power of time, whose course in the first step is unknown, and down
    /// to 0.05 times under a given motion of bodies that begin to touch, whose first cells are met in part.
    pub time: Option<f64>,
    /// Greatest error in time estimated for a step in a single cell, relative to the mean in contact: what the pressure at a
    /// point, and the greatest pressure, may be off by. It is largest where a body meets cells faster than the steps resolve,
    /// which hardly moves the body. `None` before the first step.
    pub pressure: Option<f64>,
    /// Errors due to the mesh, of the present state; `None` without contact, of a contact that the cells do not resolve, and where
    /// [ranks](crate::parallel) share out the rows.
    pub mesh: Option<MeshError>,
    /// The greatest errors due to the mesh of all states of the run that have an estimate, each of them relative to its own
    /// state: largest where few cells are in contact. `None` if no state has one.
    pub max_mesh: Option<MeshError>,
    /// Greatest residual of the contact problems, of the displacement.
    pub solver: f64,
}

/// One line: `error in time 1.2e-3 (pressure 2.0e-2), mesh: approach 1.0e-3, ...; solver 9.8e-7`.
impl fmt::Display for ErrorBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = |error: Option<f64>| error.map_or("not estimated".into(), |error| format!("{error:.1e}"));
        write!(f, "error in time {} (pressure {}), mesh: ", known(self.time), known(self.pressure))?;
        match self.mesh {
            Some(mesh) => write!(f, "{mesh}")?,
            None => f.write_str("not estimated")?,
        }
        if let Some(greatest) = self.max_mesh {
            write!(f, " (greatest of the run: {greatest})")?;
        }
        write!(f, "; solver {:.1e}", self.solver)
    }
}
