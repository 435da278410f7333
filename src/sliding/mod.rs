//! Steady sliding and rolling as one contact problem for each velocity.
//!
//! In the frame of an indenter that moves steadily over creeping bodies nothing changes, and no time step is needed: a wave of the pressure
//! displaces by the compliance of the bodies at the frequency at which it passes a point. [`SteadySliding`] finds the one state of
//! contact of a velocity and a load, however long the relaxation times are. To step there takes as many steps as the longest of them:
//! [`ViscoelasticContact::toward_steady`] is for watching the approach.
//!
//! All friction comes from hysteresis: the surfaces have none.

mod bodies;
mod coefficients;
mod contact_problem;
mod creep;
mod csv;
mod gmres;
mod layer_on_base;
mod operator;
mod search;
mod support;
mod sweep;

pub use crate::error::SlidingError;
pub use sweep::{SlidingSweep, SlidingTable, SweptState};

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use num_complex::Complex64;

use crate::contact::{Builder, Frame, ViscoelasticContact};
use crate::error::{Error, Result, Special, StepError, coverage, finite};
use crate::kernel::HalfSpace;
use crate::load::Load;
use crate::memory;
use crate::rheology::{Elastic, Material};
use crate::rounded::rounded;
use crate::solver::RigidMotion;
use bodies::Bodies;
use contact_problem::{Found, Problem};
use creep::Creep;
use layer_on_base::{LayerOnBase, THINNEST};
use operator::MovingBodies;

/// A contact that moves steadily over creeping bodies, made by [`Builder::build_sliding`].
///
/// ```
/// use viscocontact::prelude::*;
///
/// // a wavy indenter of 1 mm period slides over a rubber
/// let grid = Grid::square(64, 1.0e-3)?;
/// let shape = FnGeometry::new(|x1, x2| 4.0e-6 * (2.0 - (6283.2 * x1).cos() - (6283.2 * x2).cos()));
/// let rubber = GeneralizedMaxwell::new(1.0e6, &[(1.0e7, 1.0e-5), (1.0e7, 1.0e-3), (3.0e6, 0.1)])?;
/// let mut sliding = ViscoelasticContact::builder(grid.clone())
///     .geometry(&shape)
///     .material(Material::incompressible(rubber))
///     .kernel(InfluenceKernel::periodic(&grid)?)
///     .build_sliding()?;
/// for speed in [1.0e-4, 1.0e-2, 1.0, 1.0e2, 1.0e4] {
///     let report = sliding.at([speed, 0.0], Load::force(0.02))?;
///     println!("{report}");
///     assert!(report.friction() > 0.0);
/// }
/// assert!(sliding.contact().contact_area() < 1.0e-6);
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SteadySliding {
    /// Shows the state; it has no past, and takes no steps.
    contact: ViscoelasticContact,
    bodies: Arc<Bodies>,
    cancelled: Option<Arc<AtomicBool>>,
}

/// The state of a steady motion, in numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SlidingReport {
    /// Velocity of the indenter over the bodies \[m/s\].
    pub velocity: [f64; 2],
    /// Normal force \[N\].
    pub force: f64,
    /// Approach \[m\].
    pub approach: f64,
    /// Force that keeps the indenter moving, along x1 and x2 \[N\]: −∬ p ∇u.
    pub lateral_force: [f64; 2],
    /// Cells in contact.
    pub contact_cells: usize,
    /// Contact area \[m²\].
    pub contact_area: f64,
    /// Mean of the gap over the grid \[m\], where the indenter has a surface.
    pub mean_gap: f64,
    /// Root mean square of the gap in contact, over the range of the gap that the contact closes.
    pub residual: f64,
    /// Sets of cells that were tried.
    pub sets: usize,
    /// Pairs of transforms; those on a coarser mesh, where the search begins, count by their cells.
    pub transforms: usize,
}

impl SlidingReport {
    /// The power that the bodies dissipate \[W\]: lateral force times velocity.
    pub fn dissipation(&self) -> f64 {
        self.lateral_force[0] * self.velocity[0] + self.lateral_force[1] * self.velocity[1]
    }

    /// The coefficient of friction: the lateral force against the motion over the normal force; 0 at rest and without load.
    pub fn friction(&self) -> f64 {
        let speed = self.velocity[0].hypot(self.velocity[1]);
        if speed > 0.0 && self.force != 0.0 { self.dissipation() / speed / self.force } else { 0.0 }
    }
}

/// "0.1 m/s: 2 N, friction 0.0193, 812 cells in contact".
impl fmt::Display for SlidingReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let speed = self.velocity[0].hypot(self.velocity[1]);
        let [speed, force, friction] = [speed, self.force, self.friction()].map(|value| rounded(value, 4));
        write!(f, "{speed} m/s: {force} N, friction {friction}, {} cells in contact", self.contact_cells)
    }
}

/// Whether a gap differs more from the end of a periodic axis to its beginning than anywhere between neighbours along the axis.
fn jumps(gap: &[f64], cells: [usize; 2], periodic: [bool; 2]) -> bool {
    (0..2).filter(|&axis| periodic[axis] && cells[axis] > 2).any(|axis| {
        let (n, stride) = (cells[axis], if axis == 0 { cells[1] } else { 1 });
        let most = |at_end: bool| {
            let own = (0..gap.len()).filter(|k| (k / stride % n + 1 == n) == at_end);
            let rise = own.map(|k| (gap[if at_end { k - (n - 1) * stride } else { k + stride }] - gap[k]).abs());
            rise.filter(|rise| rise.is_finite()).fold(0.0, f64::max)
        };
        most(true) > JUMP * most(false)
    })
}

/// A shape that changes so many times as much at its ends as elsewhere jumps there.
const JUMP: f64 = 4.0;

/// Bytes of a problem in steady motion beside its contact, at most.
fn bytes(cells: [usize; 2], periodic: [bool; 2]) -> u64 {
    let [n1, n2] = cells.map(|n| n as u64);
    let padded = [0, 1].map(|axis| if periodic[axis] || cells[axis] == 1 { 1 } else { 2 } * cells[axis] as u64);
    // factors, coefficients and losses of the response, with its symmetric part; of the inverses, and of both on coarser meshes
    let (response, inverse) = (80 * padded[0] * (padded[1] / 2 + 1), 86 * n1 * (n2 / 2 + 1));
    // influences at about four nodes a cell, and the panels of these; tables of coefficients
    let nodes = if periodic == [true; 2] { 0 } else { 150 * n1 * n2 };
    // two fields for each direction, and a dozen others
    response + inverse + nodes + 8 * (2 * gmres::MOST as u64 + 12) * n1 * n2
}

/// Relative difference of ratios that is rounding.
const SAME_RATIO: f64 = 1e-6;

impl Builder {
    /// A contact in steady motion, for [`SteadySliding::at`]: it takes the parts of [`Builder::build`]. All fields take the whole grid.
    ///
    /// All bodies of the crate are covered but kernels of coefficients ([`InfluenceKernel::from_coefficients`](crate::InfluenceKernel::from_coefficients)). Bodies that are periodic along both
    /// axes are passed in any direction, the others along x1 or x2. Where a body is periodic the shape must be periodic too: a height map that jumps at
    /// its ends slides over an edge there. A half-space may flow: the pressure under a force is steady then.
    ///
    /// # Errors
    /// As [`Builder::build`], and if the body is another one, or flows, the surfaces attract each other, there are several rigid bodies, ranks, or a history
    /// of the temperature: scale the velocity by the shift factor instead.
    pub fn build_sliding(self) -> Result<SteadySliding> {
        self.sliding(None, None)
    }

    /// [`Builder::build_sliding`] on a layer whose base creeps otherwise, or not: a rubber sheet on steel. The kernel belongs to a layer that
    /// [`Layer::bonded_to_material`](crate::Layer::bonded_to_material) made.
    ///
    /// # Errors
    /// As [`Builder::build_sliding`]; if the kernel belongs to another layer, the base has no series, or flows; if the body is not periodic along both axes,
    /// and a side of the grid is more than 64 times as long as the layer is thick.
    pub fn build_sliding_on(self, base: Material) -> Result<SteadySliding> {
        self.sliding(Some(base), None)
    }

    /// [`Builder::build_sliding`] on a body of which the complex contact modulus E* = 1/C \[Pa\] is known as a function of the frequency ≥ 0 \[rad/s\], E′ + i E″,
    /// without a series. It takes the place of [`Builder::material`]; 4 G* if the body is incompressible. Only bodies that are periodic along both axes are covered.
    ///
    /// # Errors
    /// As [`Builder::build_sliding`]; if the body is not periodic along both axes. [`SteadySliding::at`] fails where the modulus has no positive real part.
    pub fn build_sliding_by(
        mut self,
        modulus: impl Fn(f64) -> Complex64 + Send + Sync + 'static,
    ) -> Result<SteadySliding> {
        // the contact shows the state on an elastic body
        self = self.material(Material::incompressible(Elastic::new(0.25 * modulus(0.0).re)?));
        self.sliding(None, Some(Creep::Modulus(Arc::new(modulus))))
    }

    /// Bytes of a contact in steady motion at most, with all cells in contact: of [`Builder::memory`], the factors of waves and the nodes of influences, and the
    /// directions of the iteration, which are most. No field is allocated to find out.
    ///
    /// # Errors
    /// As [`Builder::memory`].
    pub fn sliding_memory(&self) -> Result<u64> {
        let own = self.memory()?;
        // neither symmetry nor a window counts
        let times = (self.grid.len() as u64).div_ceil(own.computed_cells.max(1) as u64);
        let periodic = self.kernel.as_ref().map_or([false; 2], |kernel| kernel.periodic_axes());
        Ok(own.total().saturating_mul(times).saturating_add(bytes(self.grid.cells(), periodic)))
    }

    fn sliding(mut self, base: Option<Material>, modulus: Option<Creep>) -> Result<SteadySliding> {
        self.is_covered(Special::SteadyMotion)?;
        self.settings = self.settings.with_symmetry(false).with_window(false).with_frame(Frame::Bodies);
        self.steady = true;
        memory::check("a contact in steady motion", self.sliding_memory()?.into())?;
        let contact = self.build()?;
        let (kernel, grid) = (contact.kernel(), contact.grid());
        let periodic = kernel.periodic_axes();
        let ends = || (0..2).filter(|&axis| !periodic[axis]);
        let has_rows = periodic == [true; 2] || ends().any(|axis| kernel.rows_along(axis, Some(0.0)).is_some());
        let jumps = jumps(&contact.initial_gap().above, grid.cells(), periodic);
        let by_modulus = modulus.is_some() && periodic != [true; 2];
        coverage::COEFFICIENTS.unless(|_| !has_rows)?;
        coverage::JUMPING_SHAPE.unless(|_| jumps)?;
        coverage::MODULUS.unless(|_| by_modulus)?;
        let series = |material: &Material| material.spectrum_for("a motion").map(Creep::Series);
        let creep = if let Some(modulus) = modulus { modulus } else { series(contact.material())? };
        let flows = creep.fluidity() > 0.0 && kernel.half_space_below() != Some(HalfSpace::LoadedOnGrid);
        coverage::FLOW.unless(|_| flows)?;
        let on_base = |base: Material| {
            let layer = kernel.layer_of().copied().filter(|layer| !layer.is_on_rigid());
            let layer = layer.ok_or(coverage::BASE_OF_NO_LAYER.error())?;
            let same = crate::Layer::bonded_to_material(layer.thickness(), contact.material(), &base)?;
            let ratio = same.longest_over_half_space() / layer.longest_over_half_space();
            let other = (ratio - 1.0).abs() > SAME_RATIO || same.base_poisson() != layer.base_poisson();
            let thin = ends().any(|axis| grid.lengths()[axis] > THINNEST * layer.thickness());
            coverage::OTHER_BASE.unless(|_| other)?;
            coverage::THIN_LAYER.unless(|_| thin)?;
            Ok::<_, Error>(LayerOnBase { layer, own: creep.clone(), base: series(&base)?, kernel: kernel.clone() })
        };
        let layer = base.map(on_base).transpose()?;
        let bodies = Arc::new(Bodies { kernel: kernel.clone(), creep, layer, rows: Default::default() });
        Ok(SteadySliding { contact, bodies, cancelled: None })
    }
}

impl SteadySliding {
    /// Finds the state of contact under `load`, a force or an approach, of the indenter that moves over the bodies with `velocity` \[m/s\]
    /// along x1 and x2. At velocity 0 it is the relaxed contact, at a great one the one of the elastic response. The search begins at the state found
    /// last, so that sweeps over velocities or loads cost less.
    ///
    /// Another temperature is the same as the velocity times its shift factor
    /// ([`TimeTemperature::shift_factor`](crate::rheology::TimeTemperature::shift_factor)).
    ///
    /// # Errors
    /// If the velocity is not finite, or follows neither axis of a half-space; if the load is a spring, cannot be balanced, tilts a periodic body, or is an approach
    /// beyond full contact, or one in line contact whose datum is too near; if contact reaches the edge of the grid, or the state is not found
    /// ([`SlidingError::NotConverged`]) or lost in rounding ([`SlidingError::Rounding`]), or another thread ends the search. The state found last is then kept.
    pub fn at(&mut self, velocity: [f64; 2], load: Load) -> Result<SlidingReport> {
        finite("velocity along x1", velocity[0])?;
        finite("velocity along x2", velocity[1])?;
        coverage::SPRING.unless(|_| matches!(load, Load::Spring { .. }))?;
        let (free, lowered) = self.contact.steady_motion(load)?;
        let mut bodies = self.moving(velocity, load)?;
        let (grid, tolerance) = (self.contact.grid().clone(), self.contact.settings().tolerance);
        let (gap, n2) = (self.contact.initial_gap(), grid.cells()[1]);
        let datum = gap.datum;
        let lower = |(k, height): (usize, &f64)| height - lowered.at(grid.center(k / n2, k % n2));
        let heights: Vec<f64> = gap.above.iter().enumerate().map(lower).collect();
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        if !free.translation && mean <= 0.0 && self.contact.kernel().mean_is_held() {
            let approach = lowered.approach + datum;
            return Err(Error::Step(StepError::BeyondFullContact { time: 0.0, approach, greatest: approach + mean }));
        }
        let cancelled = self.cancelled.as_deref();
        let problem = Problem { grid: &grid, gap: &heights, free, tolerance, cancelled };
        let found = if free.translation && free.total == 0.0 {
            Found::apart(heights.len())
        } else {
            problem.search(&mut bodies, self.contact.pressure())
        };
        let Found { pressure, mut displacement, mut motion, residual, rounding, sets, converged } = found;
        if problem.is_cancelled() {
            return Err(Error::Cancelled { what: "a steady motion" });
        }
        if !converged && rounding > tolerance {
            return Err(SlidingError::Rounding { velocity, rounding, tolerance }.into());
        }
        if !converged {
            return Err(SlidingError::NotConverged { velocity, sets, residual, tolerance }.into());
        }
        self.contact.check_edge(&pressure)?;
        let (cell_area, transforms) = (grid.cell_area(), bodies.transforms);
        let lateral_force = bodies.drag(&pressure).map(|force| force * cell_area);
        let excess = self.bodies.excess(velocity, cell_area * pressure.iter().sum::<f64>());
        displacement.iter_mut().for_each(|u| *u -= excess);
        motion.approach -= excess;
        let motion = RigidMotion { approach: datum, tilt: [0.0; 2] } + lowered + motion;
        self.contact.show_steady(load, motion, pressure, displacement);
        let gaps: Vec<f64> = self.contact.gap()?.into_iter().filter(|gap| gap.is_finite()).collect();
        Ok(SlidingReport {
            velocity,
            force: self.contact.force(),
            approach: motion.approach,
            lateral_force,
            contact_cells: self.contact.contact_cells(),
            contact_area: self.contact.contact_area(),
            mean_gap: gaps.iter().sum::<f64>() / gaps.len() as f64,
            residual,
            sets,
            transforms,
        })
    }

    /// Lets another thread end the search under way in [`SteadySliding::at`], and the searches of a sweep, as [`Run::cancelled_by`](crate::run::Run::cancelled_by): the
    /// call ends in [`Error::Cancelled`], and the state found last is kept.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use std::sync::atomic::{AtomicBool, Ordering};
    ///
    /// use viscocontact::prelude::*;
    ///
    /// let cancel = Arc::new(AtomicBool::new(false));
    /// let mut sliding = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
    ///     .geometry(&Sphere::new(10.0e-3)?)
    ///     .material(Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 0.01)?))
    ///     .build_sliding()?
    ///     .cancelled_by(Arc::clone(&cancel));
    /// sliding.at([0.1, 0.0], Load::force(0.5))?;
    /// cancel.store(true, Ordering::Relaxed); // by another thread
    /// assert!(matches!(sliding.at([0.2, 0.0], Load::force(0.5)), Err(Error::Cancelled { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    #[must_use]
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> SteadySliding {
        self.cancelled = Some(flag);
        self
    }

    /// The bodies under a pressure with this velocity, where a load has a steady state.
    fn moving(&self, velocity: [f64; 2], load: Load) -> Result<MovingBodies> {
        let (kernel, creep, forced) = (self.contact.kernel(), &self.bodies.creep, load.is_force());
        let drifts = creep.fluidity() > 0.0 && !(forced && velocity != [0.0; 2]);
        coverage::DRIFT.unless(|_| drifts)?;
        let bodies = self.bodies.moving(velocity)?;
        let (axis, lengths) = (self.bodies.axis(velocity).unwrap_or(0), self.contact.grid().lengths());
        let speed = if kernel.periodic_axes()[axis] { 0.0 } else { velocity[axis].abs() };
        let mut reaches = creep.reaches(speed);
        if let Some(layer) = &self.bodies.layer {
            reaches.extend(layer.base.reaches(speed));
        }
        let farthest = reaches.iter().map(|(_, reach)| *reach).fold(0.0, f64::max);
        let near = !forced && kernel.datum().is_some_and(|datum| datum < lengths[axis] + farthest);
        coverage::NEAR_DATUM.unless(|_| near)?;
        Ok(bodies)
    }

    /// The contact in the state found last, to read, draw and write. It has no past: its steps are refused.
    pub fn contact(&self) -> &ViscoelasticContact {
        &self.contact
    }
}
