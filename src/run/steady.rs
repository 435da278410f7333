//! Motion over the bodies to the steady state.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::axis::Axis;
use crate::contact::moving::shortfall::Shortfall;
use crate::contact::{StepReport, Unsteady, ViscoelasticContact};
use crate::error::{Error, Result, StepError, coverage, finite, within};
use crate::extent::Extent;
use crate::load::Load;
use crate::rheology::CreepSpectrum;

/// Least number of the longest strides per contact length.
const STEPS_PER_CONTACT_LENGTH: usize = 8;
/// Contact lengths travelled with each shorter stride. The history that acts on the contact then consists of steps of
/// this stride.
const CONTACT_LENGTHS_PER_STRIDE: usize = 2;
/// Grid lengths after which a motion that is not yet steady fails.
const MAX_GRID_LENGTHS: f64 = 10.0;

value! {
/// A steady motion of the indenter over the bodies, and the tolerance of the steady state; made by
/// [`SteadyMotion::new`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SteadyMotion {
    /// Axis of the motion.
    axis: Axis;
    /// Velocity of the indenter over the bodies \[m/s\], of either sign.
    velocity: f64;
    /// Load on the indenter.
    load: Load;
    /// Tolerance of the steady state, in (0, 1) (default: 1e-3): of the pressure's change while the indenter travels
    /// by the length of the contact, Σ |Δp| over Σ p; of what slow creep has still to change of approach or lateral
    /// force, relative to its value; and of what has left the grid. The noise of the solver is about a hundred times
    /// [`Settings::tolerance`](crate::contact::Settings::tolerance).
    tolerance: f64, with_tolerance;
    /// Greatest distance to travel \[m\] (default: `None`, ten times the length of the grid).
    max_distance: Option<f64>, with_max_distance;
}
}

impl SteadyMotion {
    /// A motion along `axis`, with a `velocity` \[m/s\] of either sign, under a `load`.
    pub const fn new(axis: Axis, velocity: f64, load: Load) -> SteadyMotion {
        SteadyMotion { axis, velocity, load, tolerance: 1e-3, max_distance: None }
    }
}

/// A contact on its way to a steady state, made by [`ViscoelasticContact::toward_steady`].
#[derive(Debug)]
pub struct SteadyRun<'a> {
    contact: &'a mut ViscoelasticContact,
    motion: SteadyMotion,
    creep: CreepSpectrum,
    /// The cell of the grid by which the shortest stride goes.
    cell: [isize; 2],
    /// Cells per step.
    stride: usize,
    /// Cells still to travel with this stride.
    left: usize,
    /// Cells travelled so far.
    travelled: usize,
    /// Pressure one contact length ago.
    before: Vec<f64>,
    change: f64,
    outstanding: f64,
    /// Whether a step in place was taken for the indenter to touch.
    tried_to_touch: bool,
    arrived: bool,
    /// Set by another thread to end the step under way.
    cancelled: Option<Arc<AtomicBool>>,
}

impl ViscoelasticContact {
    /// Moves the indenter steadily over the bodies, by steps of whole cells, towards the steady state: to watch the
    /// approach, and to go on from there. The state itself is one contact problem, whatever the relaxation times:
    /// [`sliding`](crate::sliding). Needs [`Frame::Indenter`](crate::contact::Frame::Indenter).
    ///
    /// Long strides come first, an eighth of the contact length each, until the bodies have passed the whole grid.
    /// Shorter strides follow, down to one cell, until the motion is steady. The early strides are cheap, and their
    /// error decays.
    ///
    /// The motion is steady where three things are below the [tolerance](SteadyMotion::tolerance). The pressure
    /// changes no more. Each term of creep, of retardation time λ, is at its limit for each wave of the pressure. On
    /// bodies that are periodic along the motion this takes a track of several v λ: a term is e^(−t/λ) short of its
    /// limit, and slow terms change slowly. On other bodies, what lies behind the grid would change neither approach
    /// nor lateral force: the grid should reach several v λ behind the contact, ten in line contact. Otherwise the
    /// run ends in [`StepError::NotSteady`], which names the term, and how far to travel, or how long a grid to take.
    /// The contact is then where the run ended.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use viscocontact::prelude::*;
    ///
    /// let grid = Grid::new([256, 1], [8.0e-3, 1.0])?;
    /// let cylinder = Shifted::new(Cylinder::new(10.0e-3)?, [2.0e-3, 0.0])?;
    /// let mut contact = ViscoelasticContact::builder(grid.clone())
    ///     .geometry(&cylinder)
    ///     .material(Material::incompressible(Zener::with_time(1.0e6, 0.5e6, 0.01)?))
    ///     .kernel(InfluenceKernel::line(&grid, 1.0)?)
    ///     .settings(Settings::default().with_frame(Frame::Indenter))
    ///     .build()?;
    /// let motion = SteadyMotion::new(Axis::X1, 0.1, Load::force(100.0)).with_tolerance(1.0e-2);
    /// contact.toward_steady(motion)?.run()?;
    /// assert!(contact.fields().lateral_force(&cylinder)[0] > 0.01 * contact.force());
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the grid is fixed to the bodies, the velocity zero or not finite, the tolerance not in (0, 1), or the
    /// bodies flow without end: there is no steady state.
    pub fn toward_steady(&mut self, motion: SteadyMotion) -> Result<SteadyRun<'_>> {
        SteadyRun::new(self, motion)
    }
}

impl<'a> SteadyRun<'a> {
    fn new(contact: &'a mut ViscoelasticContact, motion: SteadyMotion) -> Result<SteadyRun<'a>> {
        contact.covers(coverage::MOTION_TO_STEADY)?;
        let velocity = finite("velocity", motion.velocity)?;
        within("velocity", velocity, velocity != 0.0, "finite and not 0")?;
        let tolerance = motion.tolerance;
        within("tolerance of a steady motion", tolerance, tolerance > 0.0 && tolerance < 1.0, "in (0, 1)")?;
        let creep = contact.scene.material.spectrum_for("a motion")?;
        let flows = creep.fluidity();
        within(
            "fluidity of the contact",
            flows,
            flows == 0.0,
            "0: under a body that flows approach or slope grow without end",
        )?;
        let mut cell = [0; 2];
        cell[motion.axis.index()] = velocity.signum() as isize;
        let before = contact.pressure().to_vec();
        Ok(SteadyRun {
            contact,
            motion,
            creep,
            cell,
            stride: 0,
            left: 0,
            travelled: 0,
            before,
            change: f64::INFINITY,
            outstanding: f64::INFINITY,
            tried_to_touch: false,
            arrived: false,
            cancelled: None,
        })
    }

    /// Lets another thread end the step under way, as [`Run::cancelled_by`](crate::run::Run::cancelled_by).
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> SteadyRun<'a> {
        self.cancelled = Some(flag);
        self
    }

    /// Takes one step and returns its report, or `None` if the motion is steady.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step_over`], or if the load does not keep the bodies in touch, or
    /// [`StepError::NotSteady`]. A run with a greater [distance](SteadyMotion::max_distance) goes on from there.
    pub fn next_step(&mut self) -> Result<Option<StepReport>> {
        if self.arrived {
            return Ok(None);
        }
        let apart = self.contact.contact_cells() == 0;
        if apart && self.tried_to_touch {
            return Err(Error::Step(StepError::NoContact { time: self.contact.time() }));
        }
        if !apart && self.left == 0 && !self.next_stride()? {
            return Ok(None);
        }
        self.tried_to_touch |= apart;
        let SteadyMotion { velocity, load, .. } = self.motion;
        let axis = self.motion.axis.index();
        // bodies that are apart touch in place, within the time for one cell
        let (stride, lasts) = if apart { (0, 1) } else { (self.stride, self.stride) };
        let cells = self.cell.map(|cell| cell * stride as isize);
        let dt = lasts as f64 * self.contact.grid().spacing()[axis] / velocity.abs();
        let report = self.contact.step_over_unless(self.cancelled.as_deref(), cells, dt, &[load])?;
        self.travelled += stride;
        self.left = self.left.saturating_sub(stride);
        Ok(Some(report))
    }

    /// Moves on to the steady state.
    ///
    /// # Errors
    /// As [`SteadyRun::next_step`].
    pub fn run(mut self) -> Result<()> {
        while self.next_step()?.is_some() {}
        Ok(())
    }

    /// The contact.
    pub fn contact(&self) -> &ViscoelasticContact {
        self.contact
    }

    /// Change of the pressure over the last contact length, Σ |Δp| over Σ p; infinite before the first full length.
    pub fn change(&self) -> f64 {
        self.change
    }

    /// What slow terms of creep have still to change of approach or lateral force, relative to its value; infinite
    /// before the first full length of the contact.
    pub fn outstanding(&self) -> f64 {
        self.outstanding
    }

    /// Distance travelled by the indenter \[m\].
    pub fn distance(&self) -> f64 {
        self.travelled as f64 * self.contact.grid().spacing()[self.motion.axis.index()]
    }

    /// Sets the next stride and the cells to travel with it; false if the motion is steady.
    fn next_stride(&mut self) -> Result<bool> {
        let (axis, grid) = (self.motion.axis.index(), self.contact.grid());
        let (cells, contact) = (grid.cells()[axis], self.length_of_contact());
        (self.stride, self.left) = match self.stride {
            // the largest power of two within an eighth of the contact
            0 => (1 << (contact / STEPS_PER_CONTACT_LENGTH).max(1).ilog2(), cells),
            1 => {
                let pairs = self.contact.pressure().iter().zip(&self.before);
                let change: f64 = pairs.map(|(now, before)| (now - before).abs()).sum();
                self.change = change / self.contact.pressure().iter().sum::<f64>();
                self.arrived = self.arrives()?;
                if self.arrived {
                    return Ok(false);
                }
                (1, contact)
            }
            longer => (longer / 2, CONTACT_LENGTHS_PER_STRIDE * contact),
        };
        self.before.copy_from_slice(self.contact.pressure());
        Ok(true)
    }

    /// Whether the motion is steady; an error if it cannot be within the distance that it may travel.
    fn arrives(&mut self) -> Result<bool> {
        let SteadyMotion { axis, tolerance, max_distance, .. } = self.motion;
        let (change, distance) = (self.change, self.distance());
        let most = max_distance.unwrap_or(MAX_GRID_LENGTHS * self.contact.grid().lengths()[axis.index()]);
        let mut shortfall = Shortfall { contact: self.contact, creep: &self.creep, cell: self.cell };
        let remaining = shortfall.outstanding();
        self.outstanding = remaining;
        let (time, reach) = shortfall.slowest(distance);
        let farther = reach * (remaining / tolerance).max(1.0).ln();
        let reason = if remaining <= tolerance && change <= tolerance {
            shortfall.left_grid(tolerance)
        } else if distance + farther <= most {
            return Ok(false);
        } else if remaining <= tolerance {
            Some(Unsteady::Changing { change })
        } else {
            Some(Unsteady::SlowTerm { time, remaining, farther })
        };
        reason.map_or(Ok(true), |reason| Err(Error::Step(StepError::NotSteady { distance, tolerance, reason })))
    }

    /// Cells between the ends of the contact along the axis of the motion.
    fn length_of_contact(&self) -> usize {
        let along = |Extent { low, high }| high[self.motion.axis.index()] + 1 - low[self.motion.axis.index()];
        self.contact.fields().extent_of_contact().map_or(1, along)
    }
}
