//! Gradients of creeping contacts with respect to their shape.

use std::sync::atomic::AtomicBool;

use crate::error::Result;
use crate::load::Load;
use crate::states::contact::StatesContact;
use crate::states::elastic::free_points;

impl StatesContact {
    /// How the approach of the load point would change now, ∂ω/∂g, had each cell been higher by a little from the
    /// start: one value for each cell of the grid, of the sum 1 where bodies touch, else 0. Right for any history of
    /// forces, since neither the levels nor their W depend on the shape then: with ∂ω_e(l)/∂g = q(l), the pressure of
    /// a flat punch on the elastic contact at the level l over its force,
    ///
    /// ∂ω/∂g = Σ (W_k − W_k+1) q(l_k), W = 0 above the last group.
    ///
    /// An elastic contact and a punch for each group that is free, and for the level: some forty convolutions each.
    /// The steps that were taken count as exact. Derivatives with respect to the material come of steps with another
    /// one, which cost nothing beside.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact::states::{Reach, StatesContact, Sweep};
    ///
    /// let rubber = Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?);
    /// let states = Sweep::new(Grid::square(32, 4.0e-3)?, &Sphere::new(10.0e-3)?).run(Reach::Level(6.0e-7))?;
    /// let mut contact = StatesContact::new(&states, &rubber)?;
    /// for (dt, force) in [(0.0, 0.5), (1.0, 0.5), (1.0, 0.1)] {
    ///     contact.step(dt, Load::force(force))?;
    /// }
    /// let gradient = contact.approach_gradient()?;
    /// assert!((gradient.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the states were read from a file or given as
    /// a table; as [`ElasticContact::solve`](crate::elastic::ElasticContact::solve) and
    /// [`Fields::approach_gradient`](crate::fields::Fields::approach_gradient).
    pub fn approach_gradient(&self) -> Result<Vec<f64>> {
        self.approach_gradient_unless(&AtomicBool::new(false))
    }

    /// [`StatesContact::approach_gradient`], ended within an iteration of its elastic contacts where another thread
    /// sets `cancelled`.
    ///
    /// # Errors
    /// As [`StatesContact::approach_gradient`], and [`Error::Cancelled`](crate::Error::Cancelled).
    pub fn approach_gradient_unless(&self, cancelled: &AtomicBool) -> Result<Vec<f64>> {
        let (states, mut elastic) = (self.states(), self.states().elastic_contact()?);
        let mut sum = vec![0.0; elastic.fields().grid().len()];
        if self.level() == 0.0 {
            return Ok(sum);
        }
        let mut groups = self.levels.groups().peekable();
        while let Some((level, _, displacement)) = groups.next() {
            let step = displacement - groups.peek().map_or(0.0, |(_, _, above)| *above);
            if step == 0.0 {
                continue;
            }
            elastic.solve_unless(cancelled, Load::Force { normal: level, tilt: states.tilt })?;
            let gradient = elastic.fields().load_point_gradient(free_points(states.tilt))?;
            sum.iter_mut().zip(gradient).for_each(|(sum, q)| *sum += step * q);
        }
        Ok(sum)
    }
}
