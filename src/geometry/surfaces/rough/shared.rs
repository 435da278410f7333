//! Random rough surfaces distributed over ranks.

use crate::values::Counted;
use std::sync::Arc;

use super::{Rough, RoughSpec, heights};
use crate::Grid;
use crate::error::Result;
use crate::geometry::{Geometry, Waves};
use crate::parallel::{Ranks, Rows, part};

/// Distances from a cell centre below this, in cells, are rounding errors.
const ROUNDING: f64 = 1e-6;

/// A [`Rough`] surface distributed over [ranks](crate::parallel): each rank holds its local rows only. Made by
/// [`Rough::shared`].
///
/// As a [`Geometry`] it is defined at the cell centres of the local rows. Elsewhere it is NaN, which a contact
/// refuses: to shift or turn a surface, use [`Rough`].
#[derive(Clone, PartialEq)]
pub struct SharedRough {
    spec: RoughSpec,
    /// The local rows.
    grid: Grid,
    heights: Vec<f64>,
    /// The maximum height on all ranks.
    highest: f64,
}

debug_by! {
    self: SharedRough =>
    spec: self.spec, grid: self.grid, heights: Counted(&self.heights), highest: self.highest
}

impl Rough {
    /// The local rows of the surface of [`Rough::new`], with the same bits. Takes 40 bytes per local cell while the
    /// surface is made, and 8 afterwards. A call of all ranks.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact::parallel::Threads;
    ///
    /// let areas = Threads::run(2, |ranks| {
    ///     let grid = Grid::square(256, 1.0e-3)?;
    ///     let spec = RoughSpec::new(0.5e-3, 0.03e-3, Roughness::RmsSlope(0.02));
    ///     let rough = Rough::shared(&grid, spec, &ranks)?;
    ///     let kernel = std::sync::Arc::new(InfluenceKernel::periodic(&grid)?);
    ///     let mut contact = ViscoelasticContact::builder(grid)
    ///         .ranks(ranks)
    ///         .geometry(&rough)
    ///         .kernel(kernel)
    ///         .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
    ///         .build()?;
    ///     contact.step(0.0, Load::force(1.0e-2))?;
    ///     Ok::<_, Error>(contact.contact_area())
    /// })?;
    /// assert_eq!(areas[0], areas[1]);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Rough::new`], the same on all ranks; and if a rank has left.
    pub fn shared(grid: &Grid, spec: RoughSpec, ranks: &Arc<dyn Ranks>) -> Result<SharedRough> {
        let [n1, n2] = grid.cells();
        let rows = Rows::of_rank([n1, n2], Arc::clone(ranks));
        rows.or_loss(|| {
            let columns = part(n2 / 2 + 1, ranks.rank(), ranks.size());
            let bytes = 40 * n2.max(2) as u128 * (n1 * columns.len() / (n2 / 2 + 1)).max(rows.own().len()) as u128;
            let heights = heights(grid, &spec, &rows, bytes)?;
            let highest = rows.greatest(heights.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            let grid = Grid::of_spacing([n1, n2], grid.spacing()).part([rows.own().start, 0], [rows.own().len(), n2]);
            Ok(SharedRough { spec, grid, heights, highest })
        })
    }
}

impl SharedRough {
    /// The specification of the surface.
    pub fn spec(&self) -> &RoughSpec {
        &self.spec
    }

    /// The heights of the local rows \[m\], row-major with x2 fastest.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// The maximum height of all rows \[m\].
    pub fn highest(&self) -> f64 {
        self.highest
    }

    /// Index of the local cell along `axis` whose centre is at the coordinate `x`.
    fn cell(&self, axis: usize, x: f64) -> Option<usize> {
        let index = (x - self.grid.coordinate(axis, 0)) / self.grid.spacing()[axis];
        let cell = index.round();
        let own = (index - cell).abs() <= ROUNDING && cell >= 0.0 && cell < self.grid.cells()[axis] as f64;
        own.then_some(cell as usize)
    }
}

impl Geometry for SharedRough {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        match (self.cell(0, x1), self.cell(1, x2)) {
            (Some(i), Some(j)) => self.highest - self.heights[i * self.grid.cells()[1] + j],
            _ => f64::NAN,
        }
    }

    /// Its period is the grid that it was made for: there are no other points.
    fn waves(&self) -> Vec<Waves> {
        vec![Waves { period: [f64::INFINITY; 2], shortest: self.spec.shortest_along_axes() }]
    }
}
