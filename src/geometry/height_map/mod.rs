//! Measured surfaces.

mod error;
mod read;
mod unit;
mod write;

pub use error::MapError;
pub use unit::LengthUnit;

use crate::error::{Error, Result};

/// The heights of a surface on a regular grid of points.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    cells: [usize; 2],
    spacing: [f64; 2],
    /// Row-major, x2 fastest; NaN where nothing was measured.
    heights: Vec<f64>,
}

impl HeightMap {
    /// A map of `cells[0]` × `cells[1]` heights \[m\], each in the middle of its cell of a rectangle of `lengths` \[m\],
    /// row-major with x2 fastest; NaN where nothing was measured.
    ///
    /// # Errors
    /// If a count or a length is not one a [`Grid`](crate::Grid) may have, there are not `cells[0] * cells[1]` heights, or one is infinite.
    pub fn new(cells: [usize; 2], lengths: [f64; 2], heights: Vec<f64>) -> Result<HeightMap> {
        let grid = crate::Grid::new(cells, lengths)?;
        crate::error::exact_length("heights", heights.len(), grid.len())?;
        if let Some(k) = heights.iter().position(|h| h.is_infinite()) {
            return Err(Error::Map(MapError::NotFinite { entry: k, value: heights[k] }));
        }
        Ok(HeightMap { cells, spacing: grid.spacing(), heights })
    }
}
