//! The numbers of a fit, from which it is made again without a search.

use std::sync::Arc;

use viscocontact::numeric::LeastSquares;

use super::Fit;
use super::search::Found;
use crate::error::{Result, same_length};
use crate::experiment::Curve;
use crate::identification::Identification;
use crate::noise::Whitening;
use crate::part::Part;
use crate::problem::{LONG, Problem};

/// The numbers of a fit, without its curves: to save it, or to send it to another process.
///
/// ```
/// use viscocontact::states::ElasticStates;
/// use viscocontact_identify::{Curve, Experiment, Identification, Model, Protocol};
///
/// let experiment = Experiment::new(Protocol::trapezoid(1.0e-6, [0.2, 0.5, 0.2], 0.05)?, ElasticStates::sphere(5.0e-6)?);
/// let maxwell = Identification::new(Model::Maxwell);
/// let samples = maxwell.respond(&experiment, &[("E0", 2.0e3), ("tau", 0.5)])?;
/// let curves = [Curve::new(experiment, samples.iter().map(|sample| sample.force).collect())?];
/// let fit = maxwell.fit(&curves)?;
/// let again = fit.state().fit(&maxwell, &curves)?;
/// assert_eq!(again.estimates(), fit.estimates());
/// # Ok::<(), viscocontact_identify::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::exhaustive_structs, reason = "readers write it out")]
pub struct FitState {
    /// The free parameters on their scales.
    pub coordinates: Vec<f64>,
    /// Of each curve: its weight, the autoregressive coefficient, the order of the memory, and a weight of each sample
    /// or mean.
    pub noise: Vec<(f64, [f64; 2], Vec<f64>)>,
    /// Whether means of neighbours were fitted.
    pub means: bool,
    /// Iterations of the search.
    pub iterations: usize,
    /// The least sum of squares of a model that this one contains, over the own one.
    pub above: Option<f64>,
}

impl FitState {
    /// The fit of these numbers to the curves that they are of.
    ///
    /// # Errors
    /// If there are other numbers of curves, samples or parameters; as [`Identification::fit`].
    pub fn fit(self, identification: &Identification, curves: &[Curve]) -> Result<Fit> {
        let mut problem = identification.problem(curves.to_vec())?;
        same_length("state of a fit", self.coordinates.len(), problem.free().count())?;
        same_length("noise of the curves of a fit", self.noise.len(), curves.len())?;
        if let Some(means) = problem.thinned(LONG).filter(|_| self.means) {
            problem = Problem { whole: Some(Arc::new(problem)), ..means };
        }
        for (part, (scale, [phi, memory], outliers)) in problem.parts.iter_mut().zip(self.noise) {
            same_length("weights of the samples of a fit", outliers.len(), part.len())?;
            (part.scale, part.outliers, part.whitening) = (scale, outliers, Whitening { phi, memory });
        }
        let residuals = problem.residuals(&self.coordinates)?;
        let minimum = LeastSquares::at(self.coordinates, residuals, self.iterations);
        let above = problem.model.contained().zip(self.above);
        Fit::new(identification, problem, Found { minimum, above })
    }
}

impl Fit {
    /// What tells this fit from others of the same curves, to make it again without a search ([`FitState::fit`]).
    pub fn state(&self) -> FitState {
        let noise = |part: &Part| (part.scale, [part.whitening.phi, part.whitening.memory], part.outliers.clone());
        FitState {
            coordinates: self.found.minimum.coordinates.clone(),
            noise: self.problem.parts.iter().map(noise).collect(),
            means: self.problem.whole.is_some(),
            iterations: self.iterations(),
            above: self.found.above.map(|(_, ratio)| ratio),
        }
    }
}
