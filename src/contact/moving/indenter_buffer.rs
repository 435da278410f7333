//! The fields in which the indenter of a step along a path is made.

use std::sync::Arc;

use crate::Grid;
use crate::contact::Indenter;
use crate::error::Result;
use crate::geometry::Gap;
use crate::motion::Travel;

/// The indenter of the step before the last, and the fields in which the next one is made. A step along a path
/// allocates nothing, unless a snapshot still holds this indenter, or the load leaves it free to tilt.
#[derive(Debug, Clone, Default)]
pub(crate) struct IndenterBuffer {
    pub(super) indenter: Option<Arc<Indenter>>,
    pub(super) heights: Vec<f64>,
    track: Vec<f64>,
}

impl IndenterBuffer {
    /// Returns the indenter at time `t` of its path.
    ///
    /// # Errors
    /// If the gap is not a valid gap.
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
