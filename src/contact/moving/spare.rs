//! Reuses the fields of an earlier indenter for the next position on a path.

use std::sync::Arc;

use crate::Grid;
use crate::contact::indenter::Indenter;
use crate::error::Result;
use crate::geometry::Gap;
use crate::motion::Travel;

/// The indenter of the step before the last, and the fields that a new one is made in: a step along a path allocates
/// nothing, unless a snapshot still holds it, or the load leaves the indenter free to tilt.
#[derive(Debug, Clone, Default)]
pub(crate) struct Spare {
    pub(super) indenter: Option<Arc<Indenter>>,
    heights: Vec<f64>,
    track: Vec<f64>,
}

impl Spare {
    /// Whether no step along a path has been taken.
    pub(super) fn is_empty(&self) -> bool {
        self.heights.is_empty()
    }

    /// The indenter at time `t` of its path.
    ///
    /// # Errors
    /// If its gap is none.
    pub(super) fn fill(&mut self, grid: &Grid, travel: &Travel, t: f64) -> Result<Arc<Indenter>> {
        self.heights.resize(grid.len(), f64::INFINITY);
        travel.fill_gap(t, grid, &mut self.heights, &mut self.track)?;
        if let Some(mut unused) = self.indenter.take()
            && let Some(indenter) = Arc::get_mut(&mut unused)
        {
            indenter.refill(&mut self.heights, grid)?;
            return Ok(unused);
        }
        Ok(Arc::new(Indenter::new(Gap::new(vec![self.heights.clone()], grid)?, 1)))
    }
}
