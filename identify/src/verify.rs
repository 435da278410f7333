//! A fit compared with the stepper in space.

use viscocontact::contact::Builder;

use crate::error::Result;
use crate::fit::Fit;

/// The forces of a fit from a contact that is computed cell by cell, see [`Fit::verify`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Verification {
    /// Force of the contact at each sample of the curve \[N\], without offset, drift and drag.
    pub force: Vec<f64>,
    /// Maximum difference from the force of the fit, over the maximum force of the fit.
    pub difference: f64,
}

impl Fit {
    /// Computes a curve of the fit once more, with the identified material (of the Poisson's ratio that the elastic states tell, else incompressible), by the stepper in space: a check of tip, layer and
    /// elastic states that shares only the material with the fit. `scene` has the tip and the body of the elastic states, on a
    /// grid of choice. The difference contains the error of the mesh: twice as many cells along each side about halve it.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact_identify::{Curve, Experiment, Identification, Model, Protocol};
    ///
    /// let experiment = Experiment::new(Protocol::trapezoid(1.0e-6, [0.2, 0.5, 0.2], 0.05)?, ElasticStates::sphere(5.0e-6)?);
    /// let maxwell = Identification::new(Model::Maxwell);
    /// let samples = maxwell.respond(&experiment, &[("E0", 2.0e3), ("tau", 0.5)])?;
    /// let fit = maxwell.fit(&[Curve::new(experiment, samples.iter().map(|sample| sample.force).collect())?])?;
    /// let scene = ViscoelasticContact::builder(Grid::square(64, 6.0e-6)?).geometry(&Sphere::new(5.0e-6)?);
    /// assert!(fit.verify(0, &scene)?.difference < 0.02);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If there is no such curve; those of [`Builder::build`] and
    /// [`ViscoelasticContact::step`](viscocontact::ViscoelasticContact::step).
    pub fn verify(&self, curve: usize, scene: &Builder) -> Result<Verification> {
        let experiment = self.experiment(curve)?;
        let (contact_point, stiffness) = (self.contact_point(curve), self.problem.stiffness(curve, &self.values));
        let mut contact = scene.clone().material(self.prony().material_on(experiment.tip())?).build()?;
        let (times, samples) = (experiment.protocol().times(), self.samples(curve));
        let (mut force, mut before) = (Vec::with_capacity(times.len()), times[0]);
        for (&time, &drive) in times.iter().zip(experiment.protocol().drive()) {
            self.goes_on()?;
            force.push(contact.step(time - before, experiment.load(drive - contact_point, stiffness))?.force);
            before = time;
        }
        let greatest = samples.iter().map(|sample| sample.force).fold(0.0, f64::max);
        let differences = force.iter().zip(samples).map(|(force, sample)| (force - sample.force).abs());
        let difference = differences.fold(0.0, f64::max) / greatest;
        Ok(Verification { force, difference })
    }
}
