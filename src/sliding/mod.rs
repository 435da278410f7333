//! Steady sliding and rolling as one contact problem for each velocity.
//!
//! In the frame of an indenter that moves steadily over creeping bodies nothing changes, and no time step is needed: a wave of the pressure
//! displaces by the compliance of the bodies at the frequency at which it passes a point. [`SteadySliding`] finds the one state of
//! contact of a velocity and a load, however long the relaxation times are. To step there takes as many steps as the longest of them:
//! [`ViscoelasticContact::toward_steady`] is for watching the approach.
//!
//! All friction comes from hysteresis: the surfaces have none.

mod coefficients;
mod contact_problem;
mod gmres;
mod operator;

pub use crate::error::SlidingError;

use std::fmt;

use crate::contact::{Builder, Frame, ViscoelasticContact};
use crate::error::{Error, Result, StepError, finite};
use crate::load::{Load, Tilt};
use crate::rheology::CreepSpectrum;
use crate::rounded::rounded;
use crate::solver::RigidMotion;
use contact_problem::{Found, Problem};
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
#[derive(Debug)]
pub struct SteadySliding {
    /// Shows the state; it has no past, and takes no steps.
    contact: ViscoelasticContact,
    creep: CreepSpectrum,
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
    /// Root mean square of the gap in contact, over the range of the gap that the contact closes.
    pub residual: f64,
    /// Sets of cells that were tried.
    pub sets: usize,
    /// Pairs of transforms.
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

/// "1e0 m/s: friction 0.0193, 2 N, approach …".
impl fmt::Display for SlidingReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let speed = self.velocity[0].hypot(self.velocity[1]);
        let [speed, force, friction] = [speed, self.force, self.friction()].map(|value| rounded(value, 4));
        write!(f, "{speed:e} m/s: {force:e} N, friction {friction:e}, {} cells in contact", self.contact_cells)
    }
}

impl Builder {
    /// A contact in steady motion, for [`SteadySliding::at`]: it takes the parts of [`Builder::build`]. All fields take the whole grid.
    ///
    /// The body is a half-space, which is passed along x1 or x2, or periodic along both axes ([`InfluenceKernel::periodic`](crate::InfluenceKernel::periodic),
    /// [`InfluenceKernel::from_spectrum`](crate::InfluenceKernel::from_spectrum), layers that are), or in plane strain
    /// ([`InfluenceKernel::line`](crate::InfluenceKernel::line)). On a periodic body the shape must be periodic too: a height map that jumps at its ends slides over
    /// an edge there.
    ///
    /// # Errors
    /// As [`Builder::build`], and if the body is another one, or flows without end, the surfaces attract each other, there are several rigid bodies, ranks, or a history
    /// of the temperature: scale the velocity by the shift factor instead.
    pub fn build_sliding(mut self) -> Result<SteadySliding> {
        let refuse = |what, cure| Err(SlidingError::NotCovered { what, cure }.into());
        if self.attraction.is_some() {
            return refuse("a contact of surfaces that attract each other", "build it without attraction");
        }
        if self.temperature.is_some() {
            return refuse(
                "a history of the temperature",
                "multiply the velocity by the shift factor of the temperature",
            );
        }
        if self.ranks.is_some() {
            return refuse("a contact that ranks share out", "compute it in one process");
        }
        self.settings = self.settings.with_symmetry(false).with_window(false).with_frame(Frame::Bodies);
        self.steady = true;
        let contact = self.build()?;
        let kernel = contact.kernel();
        let cure = "take a half-space, InfluenceKernel::periodic or InfluenceKernel::line, or go to the steady state by ViscoelasticContact::toward_steady";
        if kernel.periodic_axes() != [true; 2] && kernel.around_a_cell().is_none() {
            return refuse("a body that is neither a half-space nor periodic along both axes", cure);
        }
        if contact.bodies() > 1 {
            return refuse("a contact of several rigid bodies", "take one");
        }
        let creep = contact.material().contact_spectrum()?.ok_or_else(|| contact.material().no_series("a motion"))?;
        if creep.fluidity() > 0.0 {
            return refuse(
                "a body that flows",
                "take one with an equilibrium modulus: on a flowing one approach or slope grow for ever",
            );
        }
        Ok(SteadySliding { contact, creep })
    }
}

/// The prescribed part of a motion.
fn prescribed(load: Load) -> RigidMotion {
    let tilt = load.tilt().map(|tilt| if let Tilt::Fixed(angle) = tilt { angle } else { 0.0 });
    let approach = if let Load::Approach { approach, .. } = load { approach } else { 0.0 };
    // the approach belongs to the point about which the body tilts
    RigidMotion { approach, tilt }
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
    /// ([`SlidingError::NotConverged`]). The state found last is then kept.
    pub fn at(&mut self, velocity: [f64; 2], load: Load) -> Result<SlidingReport> {
        finite("velocity along x1", velocity[0])?;
        finite("velocity along x2", velocity[1])?;
        if let Load::Spring { .. } = load {
            let (what, cure) = ("a body on a spring", "give the force or the approach");
            return Err(SlidingError::NotCovered { what, cure }.into());
        }
        let (free, given) = (self.contact.free_motion(load)?, prescribed(load));
        let mut bodies = self.bodies(velocity, load)?;
        let (grid, tolerance) = (self.contact.grid().clone(), self.contact.settings().tolerance);
        let (gap, n2) = (self.contact.initial_gap(), grid.cells()[1]);
        let datum = gap.datum;
        // without translation the prescribed approach counts from the plane of the gap, else the free one from first touch
        let lowered = RigidMotion { approach: if free.translation { 0.0 } else { given.approach - datum }, ..given };
        let lower = |k: usize| lowered.at([grid.coordinate(0, k / n2), grid.coordinate(1, k % n2)]);
        let heights: Vec<f64> = gap.above.iter().enumerate().map(|(k, h)| h - lower(k)).collect();
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        if !free.translation && mean <= 0.0 && self.contact.kernel().mean_is_held() {
            let (approach, greatest) = (given.approach, given.approach + mean);
            return Err(Error::Step(StepError::BeyondFullContact { time: 0.0, approach, greatest }));
        }
        let problem = Problem { grid: &grid, gap: &heights, free, tolerance };
        let found = if free.translation && free.total == 0.0 {
            Found::apart(heights.len())
        } else if self.contact.contact_cells() == 0 {
            // the symmetric part of the response gives a first contact: in slow motion a set would grow by one row of cells at a time
            let mut symmetric = bodies.symmetric();
            let first = problem.solve(&mut symmetric, self.contact.pressure());
            let found = problem.solve(&mut bodies, &first.pressure);
            bodies.response.pairs += symmetric.transforms();
            Found { sets: found.sets + first.sets, ..found }
        } else {
            problem.solve(&mut bodies, self.contact.pressure())
        };
        let Found { pressure, displacement, motion, residual, sets, converged } = found;
        if !converged {
            return Err(SlidingError::NotConverged { velocity, sets, residual, tolerance }.into());
        }
        self.contact.check_edge(&pressure)?;
        let cell_area = grid.cell_area();
        let transforms = bodies.transforms();
        let lateral_force = bodies.drag(&pressure).map(|force| force * cell_area);
        let motion = RigidMotion { approach: datum, tilt: [0.0; 2] } + lowered + motion;
        self.contact.show_steady(load, motion, pressure, displacement);
        Ok(SlidingReport {
            velocity,
            force: self.contact.force(),
            approach: motion.approach,
            lateral_force,
            contact_cells: self.contact.contact_cells(),
            contact_area: self.contact.contact_area(),
            residual,
            sets,
            transforms,
        })
    }

    /// The bodies under a pressure with this velocity.
    fn bodies(&self, velocity: [f64; 2], load: Load) -> Result<MovingBodies> {
        let (kernel, grid) = (self.contact.kernel(), self.contact.grid());
        let Some(influence) = kernel.around_a_cell() else {
            return Ok(MovingBodies::periodic(kernel, &self.creep, velocity));
        };
        let periodic = kernel.periodic_axes();
        // in plane strain a motion along the lines changes nothing
        let across = periodic.iter().position(|&periodic| periodic).map(|along| 1 - along);
        let axis = across.unwrap_or(usize::from(velocity[0] == 0.0));
        if across.is_none() && velocity[1 - axis] != 0.0 {
            let (what, cure) =
                ("a motion over a half-space that follows neither x1 nor x2", "rotate the shape (geometry::Rotated)");
            return Err(SlidingError::NotCovered { what, cure }.into());
        }
        let farthest = self.creep.terms().iter().map(|(_, time)| time * velocity[axis].abs()).fold(0.0, f64::max);
        if across.is_some()
            && !matches!(load, Load::Force { .. })
            && kernel.datum() < Some(grid.lengths()[axis] + farthest)
        {
            let what = "a line contact of given approach whose datum is nearer than the grid and the longest memory of the motion";
            return Err(SlidingError::NotCovered { what, cure: "give the force, or a datum farther away" }.into());
        }
        Ok(MovingBodies::half_space(grid, &*influence, &self.creep, axis, velocity[axis]))
    }

    /// The contact in the state found last, to read, draw and write. It has no past: its steps are refused.
    pub fn contact(&self) -> &ViscoelasticContact {
        &self.contact
    }
}
