//! Many curves, each with a material of its own.

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::error::Result;
use crate::experiment::Curve;
use crate::fit::Fit;
use crate::identification::Identification;

impl Identification {
    /// Fits each curve alone, as the curves of a force map: the results are in the order of the curves. With the feature `rayon` the
    /// curves are shared between the threads of the present pool. `done` is called after each fit, for a progress bar. A list of contact points,
    /// springs, or starts of the material has one for each curve ([`Identification::parameter`]).
    ///
    /// ```
    /// use std::sync::atomic::{AtomicUsize, Ordering};
    /// use viscocontact::states::ElasticStates;
    /// use viscocontact_identify::{Curve, Experiment, Identification, Model, Protocol};
    ///
    /// let protocol = Protocol::trapezoid(1.0e-6, [0.1, 1.0, 0.1], 0.05)?;
    /// let experiment = Experiment::new(protocol, ElasticStates::sphere(5.0e-6)?);
    /// let maxwell = Identification::new(Model::Maxwell);
    /// let curve = |modulus: f64| -> viscocontact_identify::Result<Curve> {
    ///     let samples = maxwell.respond(&experiment, &[("E0", modulus), ("tau", 0.5)])?;
    ///     Curve::new(experiment.clone(), samples.iter().map(|sample| sample.force).collect())
    /// };
    /// let map = [curve(1.0e3)?, curve(2.0e3)?, curve(3.0e3)?];
    /// let done = AtomicUsize::new(0);
    /// let fits = maxwell.fit_each(&map, |_| { done.fetch_add(1, Ordering::Relaxed); });
    /// assert_eq!((fits.len(), done.into_inner()), (3, 3));
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// Each result as of [`Identification::fit`], where the index of a curve is 0. An error of one curve does not end the others.
    pub fn fit_each(&self, curves: &[Curve], done: impl Fn(&Result<Fit>) + Sync) -> Vec<Result<Fit>> {
        let fit = |(index, curve): (usize, &Curve)| {
            let fit = self.of_curve(index).fit(std::slice::from_ref(curve));
            done(&fit);
            fit
        };
        #[cfg(feature = "rayon")]
        return curves.par_iter().enumerate().map(fit).collect();
        #[cfg(not(feature = "rayon"))]
        curves.iter().enumerate().map(fit).collect()
    }
}
