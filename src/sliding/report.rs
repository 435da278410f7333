//! The report of a steady motion.

use std::fmt;

use crate::contact::{Figures, Warnings};
use crate::rounded::rounded;

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
    /// Force that moves the indenter, along x1 and x2 \[N\]: −∬ p ∇u.
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
    /// Reasons why the state may be less accurate than expected.
    pub warnings: Warnings,
    /// The numbers of the warnings.
    pub figures: Figures,
}

impl SlidingReport {
    /// The power that the bodies dissipate \[W\]: lateral force times velocity.
    pub fn dissipation(&self) -> f64 {
        self.lateral_force[0] * self.velocity[0] + self.lateral_force[1] * self.velocity[1]
    }

    /// The coefficient of friction: the lateral force against the motion over the normal force; 0
    /// at rest and without load.
    pub fn friction(&self) -> f64 {
        let speed = self.velocity[0].hypot(self.velocity[1]);
        if speed > 0.0 && self.force != 0.0 { self.dissipation() / speed / self.force } else { 0.0 }
    }

    /// What each warning says, with its number: one line each, as
    /// [`StepReport::messages`](crate::contact::StepReport::messages).
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// // a rubber that was measured from 0.1 to 100 rad/s, on waves of 1 mm that pass at 6000
    /// let row = |w: f64| (w, 1.0e6 * w.powf(0.2), 3.0e5 * w.powf(0.2));
    /// let rows: Vec<_> = (-4..=8).map(|k| row(10_f64.powf(0.25 * f64::from(k)))).collect();
    /// let rubber = Material::incompressible(Measurements::dynamic(&rows)?.fit()?);
    /// let grid = Grid::square(64, 1.0e-3)?;
    /// let shape = Wavy::new(1.0e-6, 1.0e-3)?;
    /// let mut sliding = ViscoelasticContact::builder(grid.clone())
    ///     .geometry(&shape)
    ///     .material(rubber)
    ///     .kernel(InfluenceKernel::periodic(&grid)?)
    ///     .build_sliding()?;
    /// let report = sliding.at([1.0, 0.0], Load::force(0.02))?;
    /// assert!(report.messages().any(|message| message.contains("was not measured")), "{report}");
    /// # Ok::<(), Error>(())
    /// ```
    pub fn messages(&self) -> impl Iterator<Item = String> + '_ {
        self.figures.messages(self.warnings, None)
    }
}

/// "0.1 m/s: 2 N, friction 0.0193, 812 cells in contact", and the warnings.
impl fmt::Display for SlidingReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let speed = self.velocity[0].hypot(self.velocity[1]);
        let [speed, force, friction] = [speed, self.force, self.friction()].map(|value| rounded(value, 4));
        write!(f, "{speed} m/s: {force} N, friction {friction}, {} cells in contact", self.contact_cells)?;
        self.messages().try_for_each(|message| write!(f, "; {message}"))
    }
}
