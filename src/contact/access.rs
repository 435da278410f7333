//! What a contact shows of its state.

use std::fmt;
use std::sync::Arc;

use crate::Grid;
use crate::contact::region::Region;
use crate::contact::report::BodyState;
use crate::contact::settings::Settings;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Result, exact_length};
use crate::kernel::InfluenceKernel;
use crate::load::Load;
use crate::memory;
use crate::rheology::Material;
use crate::sum::sum;

impl ViscoelasticContact {
    /// Time \[s\], 0 at first.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// The grid of every field.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What the bodies are made of. Where a rheology has no exact exponential series, the one that was fitted in
    /// its place, by the builder or by the first step that took time: [`Material::fit_reports`] tells how
    /// well.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// The influence kernel, to share with other contacts.
    pub fn kernel(&self) -> &Arc<InfluenceKernel> {
        &self.kernel
    }

    /// The load of the last step, on the first body.
    pub fn load(&self) -> Load {
        self.state.loads[0]
    }

    /// Contact pressure \[Pa\], one value a cell, ≥ 0.
    pub fn pressure(&self) -> &[f64] {
        if self.region.is_whole() { &self.state.current.pressure } else { &self.shown }
    }

    /// Composite normal surface displacement, positive into the bodies \[m\], one value a cell.
    ///
    /// With [`Settings::window`] the first call after a step costs a convolution on the whole grid, and memory for its
    /// result.
    pub fn displacement(&self) -> &[f64] {
        if self.region.is_whole() {
            return &self.state.displacement;
        }
        let source = self.beyond.as_ref().map(|beyond| &beyond.strength[..]);
        self.whole_displacement.get_or_init(|| self.on_the_whole_grid(&self.state.displacement, source).into_owned())
    }

    /// The part of the grid that is computed, and the displacement there.
    pub(super) fn computed(&self) -> (&Region, &[f64]) {
        (&self.region, &self.state.displacement)
    }

    /// Writes the gap between the deformed bodies into `out` \[m\]: zero in contact to within the
    /// tolerance, +∞ where there is nothing to touch.
    ///
    /// # Errors
    /// If `out` does not hold one value a cell, or there is no memory for the displacement, where not all of it is computed.
    pub fn gap_into(&self, out: &mut [f64]) -> Result<()> {
        exact_length("gap", out.len(), self.grid.len())?;
        if !self.region.is_whole() && self.whole_displacement.get().is_none() {
            let whole = Region::whole(&self.grid, self.region.folded());
            let [kernel, _] = self.kernel.bytes_on(whole.cells(), whole.folded());
            memory::check(
                "the displacement on the whole grid",
                kernel + 8 * (self.grid.len() + 2 * whole.len()) as u128,
            )?;
        }
        let (n2, displacement) = (self.grid.cells()[1], self.displacement());
        for (k, h) in out.iter_mut().enumerate() {
            let [omega, alpha1, alpha2] = self.state.motions[self.initial_gap.owner(k)];
            let [x1, x2] = self.grid.center(k / n2, k % n2);
            let lowered = (omega - self.initial_gap.datum) + alpha1 * x1 + alpha2 * x2;
            *h = self.initial_gap.above[k] + displacement[k] - lowered;
        }
        Ok(())
    }

    /// Length of the last step and the displacement before it.
    pub(super) fn displacement_before(&self) -> (f64, &[f64]) {
        (if self.state.before_is_kept { self.state.interval } else { 0.0 }, &self.trial_displacement)
    }

    /// Time since the bodies were undisturbed \[s\].
    pub(super) fn age(&self) -> f64 {
        self.state.time - self.state.undisturbed_until
    }

    pub(super) fn last_step_was_a_jump(&self) -> bool {
        self.state.interval == 0.0
    }

    /// Pressure and displacement at the end of a step that was tried.
    pub(super) fn trial(&self) -> (&[f64], &[f64]) {
        (&self.trial.pressure, &self.trial_displacement)
    }

    /// Convolutions and preconditioner applications of the step that was tried.
    pub(super) fn work_of_trial(&self) -> [usize; 2] {
        [self.trial.counts.convolutions, self.trial.counts.preconditioner_applications]
    }

    /// Rigid-body approach ω of the (first) body, at the origin of the grid \[m\]. Without load, the approach
    /// at which it just touches.
    pub fn approach(&self) -> f64 {
        self.state.motions[0][0]
    }

    /// Tilt (α1, α2) of the (first) body \[rad\]: it lowers the surface by ω + α1 x1 + α2 x2.
    pub fn tilt(&self) -> [f64; 2] {
        [self.state.motions[0][1], self.state.motions[0][2]]
    }

    /// Normal force Σ p ΔA on all bodies together \[N\].
    pub fn force(&self) -> f64 {
        // row by row, so that rounding does not grow with the number of cells
        let rows = self.state.current.pressure.chunks_exact(self.region.cells()[1]);
        rows.map(sum).sum::<f64>() * self.grid.cell_area() * self.region.images() as f64
    }

    /// Moments of the whole pressure about the origin, \[∬ p x1, ∬ p x2\] \[N·m\].
    pub fn moment(&self) -> [f64; 2] {
        self.sums(|_| true).1
    }

    /// Number of cells in contact (p > 0).
    pub fn contact_cells(&self) -> usize {
        self.state.contact_cells
    }

    /// How far the cells in contact reach from the origin along x1 and x2, outer sides included \[m\].
    pub(crate) fn reach_of_contact(&self) -> [f64; 2] {
        let n2 = self.grid.cells()[1];
        let half = self.grid.spacing().map(|side| 0.5 * side);
        let touched = self.pressure().iter().enumerate().filter(|(_, p)| **p > 0.0);
        touched.fold([0.0; 2], |reach: [f64; 2], (k, _)| {
            let center = self.grid.center(k / n2, k % n2);
            [0, 1].map(|axis| reach[axis].max(center[axis].abs() + half[axis]))
        })
    }

    /// Number of rigid bodies.
    pub fn bodies(&self) -> usize {
        self.state.loads.len()
    }

    /// The state of one rigid body, in the order in which the builder was given them; `None` if there are
    /// not as many.
    pub fn body(&self, body: usize) -> Option<BodyState> {
        let [approach, alpha1, alpha2] = *self.state.motions.get(body)?;
        let (force, moment, contact_cells) = self.sums(|k| self.initial_gap.owner(k) == body);
        Some(BodyState { approach, tilt: [alpha1, alpha2], force, moment, contact_cells })
    }

    /// Force, moments and number of cells in contact over the cells for which `counts` holds.
    fn sums(&self, counts: impl Fn(usize) -> bool) -> (f64, [f64; 2], usize) {
        let (n2, area) = (self.grid.cells()[1], self.grid.cell_area());
        let (mut force, mut moment, mut cells) = (0.0, [0.0; 2], 0);
        for (i, row) in self.pressure().chunks_exact(n2).enumerate() {
            let (mut row_force, mut row_moment) = (0.0, 0.0);
            for (j, &p) in row.iter().enumerate().filter(|(j, p)| **p > 0.0 && counts(i * n2 + j)) {
                row_force += p;
                row_moment += p * self.grid.coordinate(1, j);
                cells += 1;
            }
            force += row_force;
            moment[0] += row_force * self.grid.coordinate(0, i);
            moment[1] += row_moment;
        }
        (force * area, moment.map(|sum| sum * area), cells)
    }
}

impl fmt::Debug for ViscoelasticContact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ViscoelasticContact")
            .field("grid", &self.grid)
            .field("settings", &self.settings)
            .field("time", &self.state.time)
            .field("loads", &self.state.loads)
            .field("motions", &self.state.motions)
            .field("contact_cells", &self.state.contact_cells)
            .finish_non_exhaustive()
    }
}
