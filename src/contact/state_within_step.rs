//! The state within the last step.

use std::borrow::Cow;

use crate::contact::state::State;
use crate::contact::view::on_the_whole_grid;
use crate::contact::viscoelastic::ViscoelasticContact;
use crate::error::{Result, exact_length, within};
use crate::hereditary::StepPolynomial;
use crate::solver::RigidMotion;

/// The state at a time inside the last step, made by [`ViscoelasticContact::within_step`]. So the times at which a user looks
/// need not be those at which a step ends.
///
/// In steps chosen by their error, and all steps of bodies without elastic response, displacement, approach, tilt and force
/// follow the quadratic through their last three values, as the rule takes the displacement to do: third order in the length
/// of the steps, second where cells come into contact or leave it. A force or displacement that would fall below zero between
/// values that do not is linear. The pressure is linear, so never negative, and second order.
///
/// Else all are linear, second order: in steps of given length, in which the load may have any kink, in the first step after a
/// jump, a corner of the load or a new indenter, in steps more than four times as long as the one before, and with direct sums.
/// So is the displacement of an elastic body.
///
/// Bodies that stay apart take long steps however they move: the approach inside such a step may be far from the one the load
/// prescribes.
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
    polynomial: StepPolynomial,
    time: f64,
}

impl ViscoelasticContact {
    /// The state at a time within the last step, its ends included.
    ///
    /// # Errors
    /// If the time does not lie within the last step. After a step that failed, or one over the bodies
    /// ([`ViscoelasticContact::step_over`]), the state before it is not kept, and only its end is left.
    pub fn within_step(&self, time: f64) -> Result<StateWithinStep<'_>> {
        let State { clock, history, earlier, .. } = &self.computation.state;
        let kept = history.displacement_before().is_some();
        let start = if kept { clock.time - clock.last_length } else { clock.time };
        // by rounding the start may come out a little off
        let inside = time >= start - 1e-12 * clock.last_length && time <= clock.time;
        within("time within the last step", time, inside, "between its start and its end")?;
        let share = if time == clock.time || !kept {
            1.0
        } else {
            (self.scene.reduced_length([start, time], time - start)? / clock.last_dt).clamp(0.0, 1.0)
        };
        let polynomial = StepPolynomial::new(share, clock.last_dt, earlier.map(|earlier| earlier.dt));
        Ok(StateWithinStep { contact: self, polynomial, time })
    }
}

impl StateWithinStep<'_> {
    /// The time \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Approach ω of the first body \[m\].
    pub fn approach(&self) -> f64 {
        self.of_motion(|motion| motion.approach)
    }

    /// Tilt (α1, α2) of the first body \[rad\].
    pub fn tilt(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.of_motion(|motion| motion.tilt[axis]))
    }

    /// Normal force on all bodies together \[N\].
    pub fn force(&self) -> f64 {
        let State { previous, current, earlier, .. } = self.state();
        let [start, end] = [previous, current].map(|equilibrium| self.state().force_of(equilibrium));
        self.polynomial.non_negative_at([start, end], earlier.map_or(0.0, |earlier| start - earlier.force))
    }

    /// Writes the contact pressure \[Pa\] into `out`.
    ///
    /// # Errors
    /// If `out` does not hold one value per cell.
    pub fn pressure_into(&self, out: &mut [f64]) -> Result<()> {
        let (start, end) =
            (self.on_the_whole_grid(&self.state().previous.solution.pressure, None), self.contact.pressure());
        exact_length("pressure", out.len(), end.len())?;
        let ends = start.iter().zip(end);
        out.iter_mut().zip(ends).for_each(|(out, (&start, &end))| *out = self.polynomial.line([start, end]));
        Ok(())
    }

    /// Writes the displacement \[m\] into `out`.
    ///
    /// # Errors
    /// If `out` does not hold one value per cell.
    pub fn displacement_into(&self, out: &mut [f64]) -> Result<()> {
        let (history, end) = (&self.state().history, self.contact.displacement());
        exact_length("displacement", out.len(), end.len())?;
        if self.polynomial.is_at_end() {
            out.copy_from_slice(end);
            return Ok(());
        }
        let start = self.on_the_whole_grid(history.trial(), history.far_trial());
        let change = history.change_before().filter(|_| !self.polynomial.is_line());
        let change = change.map(|(own, far)| self.on_the_whole_grid(own, far));
        for (k, out) in out.iter_mut().enumerate() {
            let ends = [start[k], end[k]];
            let quadratic = |change: &Cow<'_, [f64]>| self.polynomial.non_negative_at(ends, change[k]);
            *out = change.as_ref().map_or_else(|| self.polynomial.line(ends), quadratic);
        }
        Ok(())
    }

    fn state(&self) -> &State {
        &self.contact.computation.state
    }

    fn on_the_whole_grid<'a>(&'a self, own: &'a [f64], source: Option<&[f64]>) -> Cow<'a, [f64]> {
        on_the_whole_grid(&self.contact.scene, &self.state().region, own, source)
    }

    /// A part of the motion of the first body.
    fn of_motion(&self, part: impl Fn(&RigidMotion) -> f64) -> f64 {
        let State { previous, current, earlier, .. } = self.state();
        let [start, end] = [previous, current].map(|equilibrium| part(&equilibrium.motions[0]));
        self.polynomial.at([start, end], earlier.map_or(0.0, |earlier| start - part(&earlier.motion)))
    }
}
