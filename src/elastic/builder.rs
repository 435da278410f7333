//! The parts that an elastic contact is built from.

use std::sync::Arc;

use crate::Grid;
use crate::elastic::ElasticContact;
use crate::equilibrium::Settings;
use crate::equilibrium::indenter::even_axes_of;
use crate::equilibrium::{Ground, Indenter, Region};
use crate::error::{Result, missing, positive};
use crate::geometry::{Gap, Geometry, Missed, Waves, evaluate};
use crate::kernel::{HalfSpace, InfluenceKernel};

/// The parts of an [`ElasticContact`]; see [`ElasticContact::builder`].
#[derive(Debug, Clone)]
#[must_use = "a builder does nothing until it is built"]
pub struct ElasticBuilder {
    pub(crate) grid: Grid,
    gaps: Vec<Result<Vec<f64>>>,
    waves: Vec<Waves>,
    kernel: Option<Arc<InfluenceKernel>>,
    settings: Settings,
    modulus: Option<f64>,
}

impl ElasticBuilder {
    pub(super) fn new(grid: Grid) -> ElasticBuilder {
        ElasticBuilder::with_gaps(grid, Vec::new(), Vec::new())
    }

    /// With gaps that are evaluated already, and the waves in them.
    pub(crate) fn with_gaps(grid: Grid, gaps: Vec<Result<Vec<f64>>>, waves: Vec<Waves>) -> ElasticBuilder {
        ElasticBuilder { grid, gaps, waves, kernel: None, settings: Settings::default(), modulus: None }
    }

    /// The shape of the rigid body: the gap before the bodies deform. Required. Replaces the shapes given before.
    pub fn geometry(mut self, geometry: &dyn Geometry) -> ElasticBuilder {
        self.gaps.clear();
        self.waves.clear();
        self.another_body(geometry)
    }

    /// A further rigid body on the same elastic body, with a force, approach and tilt of its own. Gaps are measured
    /// from the same plane; a cell can be touched by one body only, the one whose gap is lowest there.
    pub fn another_body(mut self, geometry: &dyn Geometry) -> ElasticBuilder {
        self.gaps.push(evaluate(geometry, &self.grid));
        self.waves.extend(geometry.waves());
        self
    }

    /// The contact modulus E* \[Pa\], required: E/(1 − ν²) of an elastic body under a rigid one, 1/E* = Σ (1 − ν²)/E
    /// of two. That of a layer is the one of a half-space of its material.
    pub fn modulus(self, modulus: f64) -> ElasticBuilder {
        ElasticBuilder { modulus: Some(modulus), ..self }
    }

    /// How the load of the body continues beyond the grid, if it is a half-space.
    #[cfg(feature = "states")]
    pub(crate) fn half_space_below(&self) -> Option<HalfSpace> {
        self.kernel.as_ref().map_or(Some(HalfSpace::LoadedOnGrid), |kernel| kernel.half_space_below())
    }

    /// An influence kernel, or an [`Arc`] of one that other contacts on the same grid share; without one,
    /// [`InfluenceKernel::half_space`] is made.
    pub fn kernel(self, kernel: impl Into<Arc<InfluenceKernel>>) -> ElasticBuilder {
        ElasticBuilder { kernel: Some(kernel.into()), ..self }
    }

    /// Settings other than the defaults. Those of time do not matter.
    pub fn settings(self, settings: Settings) -> ElasticBuilder {
        ElasticBuilder { settings, ..self }
    }

    /// The bytes that the contact will take; with [`Settings::window`] with the largest window. No field is allocated
    /// to find out. About 117 for each computed cell: pressure and its potential at the last equilibrium and in the
    /// trial 32, gap, marks and displacement 17, solver and preconditioner 36, kernel and work space 25, and 16 a
    /// cell of the whole grid where not all are computed.
    ///
    /// # Errors
    /// As [`ElasticBuilder::build`], except for invalid gaps and memory.
    pub fn memory(&self) -> Result<u64> {
        let (ground, _) = self.ground()?;
        let gaps: Option<Vec<_>> = self.gaps.iter().map(|gap| gap.as_ref().ok()).collect();
        let folded = gaps.filter(|_| self.settings.symmetry);
        let folded = folded.map_or([false; 2], |gaps| even_axes_of(&gaps, self.grid.cells()));
        Ok(ElasticContact::bytes(&ground, &Region::whole(&self.grid, folded)))
    }

    /// Makes the contact, without load.
    ///
    /// # Errors
    /// If geometry or modulus is missing, the modulus is not positive, a gap is NaN or −∞ or none is finite, a
    /// setting is out of range, the kernel was made for another grid or cannot be made for its cells
    /// ([`InfluenceKernel::half_space`]), there is not enough memory ([`OutOfMemory`](crate::Error::OutOfMemory)), or
    /// more than 2³² − 1 cells would be computed.
    pub fn build(self) -> Result<ElasticContact> {
        let (ground, compliance) = self.ground()?;
        let gaps = self.gaps.into_iter().collect::<Result<Vec<_>>>()?;
        let missed = Missed::of(&self.waves, &self.grid, ground.kernel.periodic_axes());
        let indenter = Indenter::new(Gap::new(gaps, &self.grid)?, ground.bodies).missing(missed);
        ElasticContact::new(Arc::new(ground), compliance, Arc::new(indenter))
    }

    fn ground(&self) -> Result<(Ground, f64)> {
        let ground = Ground::of(&self.grid, self.kernel.as_ref(), self.settings, self.gaps.len())?;
        let modulus = self.modulus.ok_or_else(|| missing("modulus"))?;
        Ok((ground, 1.0 / positive("contact modulus", modulus)?))
    }
}
