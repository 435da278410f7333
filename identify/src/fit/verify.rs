//! Verification of a fit by the contact in space.

use viscocontact::ViscoelasticContact;
use viscocontact::load::Load;

use crate::error::Result;
use crate::fit::Fit;

impl Fit {
    /// Drives a contact in space through the protocol of a curve and compares: the greatest difference of its force from the force of the
    /// fit, relative to the greatest force. The contact has the shape, the layer and the grid of the tip, the material
    /// [`Fit::material`], and no step yet; its steps are the samples.
    ///
    /// This checks what the fit takes for granted: elastic states, their interpolation and the superposition.
    ///
    /// # Errors
    /// If a step fails.
    pub fn verify(&self, curve: usize, contact: &mut ViscoelasticContact) -> Result<f64> {
        let experiment = &self.curves()[curve].experiment;
        let (times, drive) = (experiment.protocol.times(), experiment.protocol.drive());
        let (rest, stiffness) = (experiment.tip.approach(0.0), self.stiffness(curve));
        let point = self.contact_point(curve);
        let (mut worst, mut greatest, mut before) = (0.0_f64, 0.0_f64, times[0]);
        for ((&time, z), sample) in times.iter().zip(drive).zip(self.samples(curve)) {
            let approach = rest + z - point;
            let load = if stiffness.is_finite() { Load::spring(stiffness, approach) } else { Load::approach(approach) };
            let report = contact.step(time - before, load)?;
            worst = worst.max((report.force - sample.force).abs());
            greatest = greatest.max(sample.force);
            before = time;
        }
        Ok(worst / greatest)
    }
}
