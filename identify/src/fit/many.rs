//! Fits of many curves at once.

use rayon::prelude::*;

use crate::error::Result;
use crate::experiment::Curve;
use crate::fit::Fit;
use crate::identification::Identification;

impl Identification {
    /// Fits each curve for itself, on all threads of the pool. `done` is called after each fit, from any thread: a progress bar counts
    /// there. Results are in the order of the curves, and do not depend on the number of threads.
    ///
    /// ```
    /// use std::sync::atomic::{AtomicUsize, Ordering};
    ///
    /// use viscocontact::states::ElasticStates;
    /// use viscocontact_identify::{Curve, Experiment, Identification, Model, Protocol};
    ///
    /// let times: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
    /// let drive = times.iter().map(|t| 1e-6 * t).collect();
    /// let experiment = Experiment::new(Protocol::new(times, drive)?, ElasticStates::sphere(5e-6)?);
    /// let elastic = Identification::new(Model::Elastic);
    /// let curve = |modulus: f64| {
    ///     let samples = elastic.respond(&experiment, &[("E", modulus)])?;
    ///     Curve::new(experiment.clone(), samples.iter().map(|sample| sample.force).collect())
    /// };
    /// let done = AtomicUsize::new(0);
    /// let fits = elastic.fit_each(&[curve(1e3)?, curve(2e3)?], || {
    ///     done.fetch_add(1, Ordering::Relaxed);
    /// });
    /// assert_eq!(done.into_inner(), 2);
    /// assert!((fits[1].as_ref().unwrap().estimate("E").unwrap().value - 2e3).abs() < 1e-6);
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    pub fn fit_each(&self, curves: &[Curve], done: impl Fn() + Sync) -> Vec<Result<Fit>> {
        let fit = |curve: &Curve| {
            let fit = self.fit(std::slice::from_ref(curve));
            done();
            fit
        };
        curves.par_iter().map(fit).collect()
    }
}
