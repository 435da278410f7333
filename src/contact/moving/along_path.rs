//! Steps in which the indenter moves over the grid.

use std::sync::Arc;

use crate::contact::{State, Step, StepReport, ViscoelasticContact};
use crate::equilibrium::Held;
use crate::error::{Result, count_within, coverage};
use crate::geometry::Geometry;
use crate::load::Load;
use crate::motion::Travel;

/// A step along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct TravelReport {
    /// Report of the step.
    pub step: StepReport,
    /// Position of the shape at the end of the step \[m\].
    pub position: [f64; 2],
    /// Lateral force that moves the shape \[N\], see
    /// [`Fields::slope_force`](crate::fields::Fields::slope_force).
    pub lateral_force: [f64; 2],
    /// Mean power over the step that the lateral motion feeds into the bodies \[W\]: the work of the pressure on the
    /// surface, less the work of force and moments. It equals lateral force times velocity, but includes the rim of a
    /// face. 0 for a jump.
    pub power: f64,
}

impl ViscoelasticContact {
    /// Takes a step at whose end the indenter is at the position of `travel`; the bodies do not move. Times of the path
    /// are times of the contact: at the start of the step the indenter should be at the position of the path.
    ///
    /// The indenter should move by a fraction of the contact length in each step, by less the sharper it is. After a
    /// step off the middle the symmetry of the scene is no longer used. With
    /// [`Settings::window`](crate::contact::Settings::window) the computed region grows with the track.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`], or if the path or a gap is not finite, there are several rigid bodies, or the
    /// grid is fixed to the indenter. The contact and its indenter are then unchanged.
    pub fn step_along(&mut self, travel: &Travel, dt: f64, load: Load) -> Result<TravelReport> {
        self.covers(coverage::STEP_ALONG_PATH)?;
        let only = "1: several are moved by ViscoelasticContact::set_geometries before a step";
        count_within("rigid bodies of a step along a path", self.fields().bodies(), self.fields().bodies() == 1, only)?;
        let loads = [load];
        let requested = self.plan_next_step(self.time() + dt, dt, &loads)?;
        let position = travel.position(self.time() + dt)?;
        let shape = travel.shape_at(self.time() + dt)?;
        let waves: Vec<_> = shape.waves().into_iter().chain(travel.waves_of_track()).collect();
        let indenter = self.indenter(vec![travel.gap(&shape, self.grid())?], &waves)?;
        let before = self.load_and_motion();
        let step = self.take(Step { indenter: Arc::new(indenter), ..requested })?;
        self.saved_run = None;
        let lateral_force = self.fields().slope_force(&shape);
        let power = if dt > 0.0 { self.work_along(before) / dt } else { 0.0 };
        Ok(TravelReport { step, position, lateral_force, power })
    }

    /// Work of the lateral motion in the last step \[J\]: the work of the pressure, Σ p Δu, less the work of force and
    /// moments, from load and motion before the step.
    fn work_along(&self, [load, motion]: [[f64; 3]; 2]) -> f64 {
        let State { held: Held { region, current, .. }, history, previous, .. } = &self.computation.state;
        let pressures = previous.solution.pressure.iter().zip(&current.solution.pressure);
        let displacements = history.tried_displacement().iter().zip(history.displacement());
        let work: f64 = pressures.zip(displacements).map(|((p, q), (u, w))| 0.5 * (p + q) * (w - u)).sum();
        let [load_now, motion_now] = self.load_and_motion();
        let pressed = (0..3).map(|k| 0.5 * (load[k] + load_now[k]) * (motion_now[k] - motion[k]));
        work * region.cell_area() - pressed.sum::<f64>()
    }
}
