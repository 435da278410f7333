//! Steps in which the indenter moves over the grid.

use crate::contact::report::StepReport;
use crate::contact::settings::Frame;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Error, Result, non_negative};
use crate::load::Load;
use crate::memory;
use crate::motion::Travel;

/// A step along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TravelReport {
    /// The step itself.
    pub step: StepReport,
    /// Where the shape is at its end \[m\].
    pub position: [f64; 2],
    /// Where it was at its start \[m\].
    pub from: [f64; 2],
    /// The force that moves it \[N\], see
    /// [`ViscoelasticContact::lateral_force`](crate::ViscoelasticContact::lateral_force).
    pub lateral_force: [f64; 2],
    /// The power that the motion along the surface feeds into the bodies \[W\], a mean over the step: what the pressure does there,
    /// less what force and moments do. Lateral force times velocity, but also where it acts on the rim of a face. 0 for a jump.
    pub power: f64,
}

impl ViscoelasticContact {
    /// A step at whose end the indenter is where `travel` says: the bodies stay where they are. The time is the contact's own:
    /// at its start the indenter should be at the path's position there.
    ///
    /// The sharper the shape, the shorter the steps: an indenter should not move by more than a part of the contact's
    /// length in each. A step off the middle gives up the symmetry of the scene for good. With [`Settings::window`](crate::contact::Settings::window) what is computed grows with the track.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`], or if the path or a gap is not finite, there are several rigid bodies, or the grid is
    /// fixed to the indenter. The contact, its indenter included, is then where it was.
    pub fn step_along(&mut self, travel: &Travel, dt: f64, load: Load) -> Result<TravelReport> {
        if self.settings.frame != Frame::Bodies {
            return Err(Error::WrongFrame { what: "a step along a path" });
        }
        if self.state.loads.len() != 1 {
            return Err(Error::WrongNumberOfBodies { given: 1, bodies: self.state.loads.len() });
        }
        non_negative("time step", dt)?;
        let from = travel.position(self.state.time)?;
        if self.spare_gap.capacity() < self.grid.len() {
            memory::check("the gap of a moving indenter", 16 * self.grid.len() as u128)?;
        }
        self.move_back();
        let mut gap = std::mem::take(&mut self.spare_gap);
        gap.resize(self.grid.len(), f64::INFINITY);
        let filled = travel.fill_gap(self.state.time + dt, &self.grid, &mut gap, &mut self.spare_track);
        let exchanged = filled.and_then(|()| self.initial_gap.exchange(&mut gap, &self.grid));
        let datum = exchanged.inspect_err(|_| self.spare_gap = std::mem::take(&mut gap))?;
        // what is lost with the symmetry does not come back
        let still = self.still_even(&self.initial_gap);
        if still != self.region.folded()
            && let Err(error) = self.check_room(&self.unfolded(still))
        {
            self.initial_gap.put_back(&mut gap, datum);
            self.spare_gap = gap;
            return Err(error);
        }
        let whole = (still != self.region.folded()).then(|| {
            let mut whole = Box::new(self.clone());
            whole.initial_gap.put_back(&mut gap.clone(), datum);
            whole
        });
        let gap_was_new = self.state.gap_is_new;
        self.take_in_the_gap(still);
        let before = (self.force(), self.moment(), self.state.motions[0]);
        let result = self.step(dt, load);
        if result.is_err() {
            match whole {
                Some(whole) => *self = *whole,
                None => {
                    self.initial_gap.put_back(&mut gap, datum);
                    self.take_in_the_gap(still);
                    self.state.gap_is_new = gap_was_new;
                }
            }
        }
        self.spare_gap = gap;
        let step = result?;
        let position = travel.position(self.state.time)?;
        let lateral_force = self.lateral_force(&travel.shape_at(self.state.time)?);
        let power = if dt > 0.0 { self.work_along(before) / dt } else { 0.0 };
        Ok(TravelReport { step, position, from, lateral_force, power })
    }

    /// The work of the last step \[J\] that went along the surface: what the pressure did there, Σ p Δu, less the part of force
    /// and moments.
    fn work_along(&self, (force, moment, motion): (f64, [f64; 2], [f64; 3])) -> f64 {
        let pressures = self.state.previous.pressure.iter().zip(&self.state.current.pressure);
        let displacements = self.trial_displacement.iter().zip(&self.state.displacement);
        let work: f64 = pressures.zip(displacements).map(|((p, q), (u, w))| 0.5 * (p + q) * (w - u)).sum();
        let ends = [[force, moment[0], moment[1]], {
            let [m1, m2] = self.moment();
            [self.force(), m1, m2]
        }];
        let pressed = (0..3).map(|k| 0.5 * (ends[0][k] + ends[1][k]) * (self.state.motions[0][k] - motion[k]));
        work * self.grid.cell_area() * self.region.images() as f64 - pressed.sum::<f64>()
    }
}
