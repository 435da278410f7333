//! Where the error of a run comes from.

use std::fmt;

use crate::fields::mesh_error::MeshError;

/// Where the error of a run comes from, made by [`Run::error_budget`](crate::run::Run::error_budget). All
/// errors are relative; `None` where nothing was estimated.
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
/// assert_eq!(budget.mesh, None); // the bodies have parted
/// println!("{budget}");
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ErrorBudget {
    /// Maximum estimated error in time of a step: of the approach under a given force, of the force under a given
    /// motion. It is relative to the displacement, or to v = K p, or to a fraction of the largest so far, whichever is
    /// greater. 0 for elastic bodies, which have no error in time; `None` before the first step.
    ///
    /// For adaptive steps it is the error that chose their length, or, if greater, the error left by all steps
    /// together, estimated by a mean over the contact. The estimate of steps of given length is the same; for the first
    /// step after a jump or a corner of a force it follows from the material alone. Measured on a sphere and six bodies
    /// (`tests/time/fixed_steps.rs`), the true error is 0.5 to 1.5 times the estimate for forces that jump or grow
    /// linearly. It is up to 4.5 times the estimate where a force begins like a power of time, since the estimate does
    /// not include its course within the first step. It is down to 0.02 times under a given motion of bodies that begin
    /// to touch, when the first cells touch in part.
    pub time: Option<f64>,
    /// Maximum estimated error in time of the fields that were sampled so far, Σ |δp| over Σ p
    /// ([`Run::fields_to`](crate::run::Run::fields_to)). The L2 error is about twice as large, relative to the field,
    /// and the error of the maximum pressure five times. `None` if none has an estimate.
    pub field: Option<f64>,
    /// Errors due to the mesh in the present state, measured on coarser meshes; `None` where they are not measured:
    /// without contact, for a contact of few cells, of surfaces that attract each other, and where
    /// [ranks](crate::parallel) share out the rows. Those of a whole run are measured by a study (feature `study`).
    pub mesh: Option<MeshError>,
    /// Maximum residual of the contact problems, relative to the displacement.
    pub solver: f64,
}

/// One line: `error in time 1.2e-3, mesh: approach 1.0e-3, ...; solver 9.8e-7`.
impl fmt::Display for ErrorBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known = |error: Option<f64>| error.map_or("not estimated".into(), |error| format!("{error:.1e}"));
        write!(f, "error in time {}, ", known(self.time))?;
        self.field.map_or(Ok(()), |field| write!(f, "fields {field:.1e}, "))?;
        f.write_str("mesh: ")?;
        match self.mesh {
            Some(mesh) => write!(f, "{mesh}")?,
            None => f.write_str("not measured")?,
        }
        write!(f, "; solver {:.1e}", self.solver)
    }
}
