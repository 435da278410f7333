//! The state within the last step.

use crate::contact::state::{Equilibrium, State};
use crate::contact::view::on_the_whole_grid;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Result, exact_length, within};

/// The state at a time inside the last step, made by [`ViscoelasticContact::within_step`]: linear in time between its
/// ends, as the rule takes the displacement to be, and second order like it. So the times at which a user looks need not
/// be those at which a step ends.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// contact.step(0.0, Load::force(0.5))?;
/// let start = contact.approach();
/// contact.step(0.2, Load::force(0.5))?;
/// let middle = contact.within_step(0.1)?;
/// assert!((middle.approach() - 0.5 * (start + contact.approach())).abs() < 1e-15);
/// assert!((middle.force() - 0.5).abs() < 1e-12);
/// assert!(contact.within_step(0.3).is_err()); // not there yet
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct StateWithinStep<'a> {
    contact: &'a ViscoelasticContact,
    /// 0 at the start of the step, 1 at its end.
    share: f64,
    time: f64,
}

impl ViscoelasticContact {
    /// The state at a time within the last step, its ends included.
    ///
    /// # Errors
    /// If the time does not lie within the last step. After a step that failed, or one over the bodies
    /// ([`ViscoelasticContact::step_over`]), the state before it is not kept, and only its end is left.
    pub fn within_step(&self, time: f64) -> Result<StateWithinStep<'_>> {
        let State { clock, history, .. } = &self.computation.state;
        let kept = history.displacement_before().is_some();
        let start = if kept { clock.time - clock.last_dt } else { clock.time };
        // by rounding the start may come out a little off
        let inside = time >= start - 1e-12 * clock.last_dt && time <= clock.time;
        within("time within the last step", time, inside, "between its start and its end")?;
        let share = if time == clock.time || !kept { 1.0 } else { ((time - start) / clock.last_dt).clamp(0.0, 1.0) };
        Ok(StateWithinStep { contact: self, share, time })
    }
}

impl StateWithinStep<'_> {
    /// The time \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Approach ω of the first body \[m\].
    pub fn approach(&self) -> f64 {
        self.mix(|state| state.motions[0].approach)
    }

    /// Tilt (α1, α2) of the first body \[rad\].
    pub fn tilt(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.mix(|state| state.motions[0].tilt[axis]))
    }

    /// Normal force on all bodies together \[N\].
    pub fn force(&self) -> f64 {
        let area = self.contact.grid().cell_area() * self.contact.computation.state.region.images() as f64;
        self.mix(|state| state.solution.pressure.iter().sum::<f64>() * area)
    }

    /// Writes the contact pressure \[Pa\] into `out`.
    ///
    /// # Errors
    /// If `out` does not hold one value per cell.
    pub fn pressure_into(&self, out: &mut [f64]) -> Result<()> {
        let State { region, previous, .. } = &self.contact.computation.state;
        let before = on_the_whole_grid(&self.contact.scene, region, &previous.solution.pressure, None);
        self.mix_into(out, "pressure", &before, self.contact.pressure())
    }

    /// Writes the displacement \[m\] into `out`.
    ///
    /// # Errors
    /// If `out` does not hold one value per cell.
    pub fn displacement_into(&self, out: &mut [f64]) -> Result<()> {
        let State { region, history, .. } = &self.contact.computation.state;
        // at the end of the step the field before it has no share, and no convolution is needed for it
        let source = history.far_trial().filter(|_| self.share != 1.0);
        let before = on_the_whole_grid(&self.contact.scene, region, history.trial(), source);
        self.mix_into(out, "displacement", &before, self.contact.displacement())
    }

    fn mix(&self, of: impl Fn(&Equilibrium) -> f64) -> f64 {
        let State { previous, current, .. } = &self.contact.computation.state;
        self.interpolate(of(previous), of(current))
    }

    fn interpolate(&self, before: f64, after: f64) -> f64 {
        if self.share == 1.0 { after } else { before + self.share * (after - before) }
    }

    fn mix_into(&self, out: &mut [f64], field: &'static str, before: &[f64], after: &[f64]) -> Result<()> {
        exact_length(field, out.len(), after.len())?;
        for ((out, &before), &after) in out.iter_mut().zip(before).zip(after) {
            *out = self.interpolate(before, after);
        }
        Ok(())
    }
}
