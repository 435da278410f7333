//! Mesh, domain and steps for a given accuracy.

mod accuracy;
mod builder;
mod cells;
mod convergence;
mod difference;
mod domain;
mod error_law;
mod fields;
mod levels;
mod loads;
mod meshes;
mod rings;
mod scene;
mod steps;

pub use accuracy::Accuracy;
pub use builder::{PlanBuilder, PlanProgress};

use crate::Grid;
use crate::contact::Builder;
use crate::observe::mesh_error::MeshError;
use crate::run::Stepping;

/// A run planned for an accuracy: the extent of the contact, the required cells and steps, and their cost.
///
/// The plan solves a few elastic contacts: as the contact is a superposition of its elastic states
/// ([`states`](crate::states)), the error that a mesh leaves in the states between the least and the greatest level of
/// the run bounds its error in the run. The differences between successive meshes, each twice as fine as the last, give
/// the required fineness: they are extrapolated at most threefold, and further only beyond 128 cells across the contact, where a run that
/// needs more than 8192 cells along a side gets finer meshes still.
/// One coarse run, 16 cells across, gives the steps. The same steps on levels, each also in up to 64 parts, give the error in
/// time without a contact problem; where it exceeds its share, the steps are shortened. Where the pressure is greatest
/// while the contact is small, as under a constant force on a body that creeps much, this contact gets a separate domain.
/// Where the tilt or the load point changes, or the pressure of the elastic contact falls somewhere while its load grows, the contact is no
/// superposition: then a run in shorter steps and runs on finer meshes stand beside the coarse one. The domain reaches from the origin as far as the
/// contact does; the cells are
/// elongated like the contact.
///
/// # Promised accuracy
/// Errors of at most twice the accuracy, relative to the greatest value of the run, of
/// * approach and force at all times,
/// * the greatest pressure of the run, if it converges and the coarse meshes resolve its peak ([`Plan::pressure_converges`]),
/// * with [`PlanBuilder::area`], the contact radius wherever the contact is at least 8 cells across,
/// * with [`PlanBuilder::fields_at`], the pressure field at these times, in L1 over its load.
///
/// Other errors are estimated, not promised: [`Plan::mesh_error`] estimates the error of the area,
/// [`Plan::pressure_error_at_all_times`] the error of the greatest pressure at each time, which steps and cells resolve
/// less well at growing edges, and [`Plan::time_error`] the error in time, which exceeds the accuracy if shorter steps
/// do not lower it. The plan does not include details that the coarse meshes do not resolve, such as roughness finer
/// than their cells, or loads shorter than the steps. A contact far from the origin takes many cells without contact: shift
/// the shape ([`Shifted`](crate::geometry::Shifted)) and the points of the load.
///
/// Planning takes about as much work as the planned run in the median ([`PlanProgress::work`]), and several times as much
/// where the planned mesh is as coarse as the meshes of the plan. The plan does not include changes to its builder. Other bodies than half-spaces are planned with [`PlanBuilder::kernel`], periodic ones with
/// [`PlanBuilder::period`] and line contacts with
/// [`PlanBuilder::line`].
///
/// ```
/// use viscocontact::prelude::*;
///
/// let sphere = Sphere::new(10.0e-3)?;
/// let body = Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?);
/// let load = StepLoad::new(Load::force(1.0))?;
/// let plan = Plan::builder(&sphere, &body, &load, 2.0).accuracy(Accuracy::STANDARD).build()?;
/// println!("{plan}");
///
/// let mut contact = plan.builder.build()?;
/// let mut run = contact.follow(&load, plan.stepping, 2.0);
/// while run.next_step()?.is_some() {}
/// let exact = viscocontact::analytic::GrowingSphere::step(10.0e-3, &body, 1.0)?;
/// assert!((contact.approach() / exact.approach(2.0) - 1.0).abs() < 1e-3);
/// # Ok::<(), viscocontact::Error>(())
/// ```
/// With the feature `serde`, its figures are serialised, and its builder is not: geometry and load may be closures. So a plan is not read
/// back.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Plan {
    /// A builder with grid, geometry, material and settings; each can be replaced. [`Builder::attraction`] is refused when it is built: the grid
    /// was chosen without it.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub builder: Builder,
    /// The stepping, for [`ViscoelasticContact::follow`](crate::ViscoelasticContact::follow).
    pub stepping: Stepping,
    /// The grid.
    pub grid: Grid,
    /// Times at which steps end besides, for [`Run::stop_at`](crate::run::Run::stop_at): with them the run has the greatest pressure that is
    /// promised; none where it is not. Approach and force do not need them. \[s\]
    pub stops: Vec<f64>,
    /// The accuracy.
    pub accuracy: Accuracy,
    /// What [`Run::fields_to`](crate::run::Run::fields_to) takes of a run that is sampled at the times of [`PlanBuilder::fields_at`]; `None` if
    /// no fields were asked for.
    pub fields: Option<f64>,
    /// Expected extent of the contact from the middle of the grid, along x1 and x2 \[m\].
    pub reach: [f64; 2],
    /// Approximate number of steps of the run.
    pub steps: usize,
    /// Approximate number of convolution equivalents of the run, each O(N log N) in the number of cells.
    pub convolutions: f64,
    /// Approximate memory of the contact \[bytes\]: [`Builder::memory`], and the fields of adaptive steps.
    pub bytes: u64,
    /// Expected error in time of approach and force, relative to their greatest values: the difference from up to
    /// 64 parts of each step on elastic states, or from a run with shorter steps on a coarse mesh. `None` where the shorter steps are too short for `f64`.
    pub time_error: Option<f64>,
    /// Expected errors of the mesh, relative to the greatest values of the run: of approach and force and of the contact area
    /// at all times, of the greatest pressure of the run, if it converges, and of the pressure field and its rim at the times of
    /// [`PlanBuilder::fields_at`], or else at the end; 1 where it is not known.
    pub mesh_error: MeshError,
    /// Expected greatest error of mesh and steps, over all times, of the greatest pressure at that time, relative to the
    /// greatest of the run. It may exceed the accuracy: creep leaves a narrow rim of high pressure at a growing edge, which
    /// neither cells nor steps resolve.
    pub pressure_error_at_all_times: f64,
    doubt: Option<&'static str>,
}

impl Plan {
    /// Whether the greatest pressure of the run is promised, to a run that stops at [`Plan::stops`]. There are five exceptions: the pressure
    /// does not converge with mesh and steps, as under the edges of punches and the tips of cones, where it is infinite, and at the rim
    /// of a contact that grows fast on a body that creeps fast; the tilt or the load point changes, and the contact was small before; it is a
    /// peak in time that even the shortest steps tried may miss; the body is no half-space and has crept, so that
    /// its greatest pressure is no elastic one; or it would require more than 8192 cells along a side.
    pub fn pressure_converges(&self) -> bool {
        self.doubt.is_none()
    }

    /// Why the greatest pressure of the run is not promised; `None` if it is.
    pub fn pressure_doubt(&self) -> Option<&'static str> {
        self.doubt
    }
}

impl std::fmt::Display for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([n1, n2], [l1, l2]) = (self.grid.cells(), self.grid.lengths());
        write!(
            f,
            "for {:.0e}: {n1} × {n2} cells on {l1:.3e} m × {l2:.3e} m, about {} steps, {:.0} convolutions, {:.1} MB; errors of the \
             mesh: {}",
            self.accuracy.target(),
            self.steps,
            self.convolutions,
            self.bytes as f64 * 1e-6,
            self.mesh_error
        )?;
        self.doubt.map_or(Ok(()), |doubt| write!(f, "; the greatest pressure is not promised: {doubt}"))?;
        match self.time_error {
            None => write!(f, "; the error in time is unknown"),
            Some(error) if error > self.accuracy.target() => {
                write!(f, "; the error in time stays at {error:.1e} with shorter steps")
            }
            Some(_) => Ok(()),
        }
    }
}
