//! The kernel of the same bodies on other cells.

use std::sync::Arc;

use super::InfluenceKernel;
use super::influence::Body;
use crate::axis::Axis;
use crate::error::Result;
use crate::grid::Grid;

impl InfluenceKernel {
    /// The kernel of the same body on a grid of other cells and the same periods; `None` of coefficients of a user,
    /// which belong to cells.
    pub(crate) fn on_other_cells(&self, grid: &Grid) -> Option<Result<InfluenceKernel>> {
        let along = self.periodic.iter().position(|&periodic| periodic).map(|axis| Axis::BOTH[axis]);
        Some(match (self.body, self.periodic, along, self.datum) {
            (Body::HalfSpace, [true, true], ..) => InfluenceKernel::periodic(grid),
            (Body::HalfSpace, _, Some(along), Some(datum)) => InfluenceKernel::periodic_along(grid, along, datum),
            (Body::HalfSpace, ..) => InfluenceKernel::half_space(grid),
            (Body::Layer(layer), periodic, along, datum) => layer.on_cells(grid, periodic, along, datum),
            (Body::User, [true, true], ..) => {
                let response = Arc::clone(&self.response);
                Ok(InfluenceKernel::new(grid, Body::User, [true; 2], move |k| response(k)))
            }
            (Body::User, ..) => return None,
        })
    }
}
