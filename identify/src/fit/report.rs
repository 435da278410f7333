//! Warnings, and the ranking of models.

use std::f64::consts::LN_2;

use viscocontact::contact::StepReport;
use viscocontact::load::Load;
use viscocontact::states::StatesContact;

use super::scatter::is_error;
use crate::error::{Error, Result};
use crate::experiment::Curve;
use crate::fit::{Estimate, Fit};
use crate::model::Model;
use crate::segments::BLOCK;
use crate::statistics::{line, mean, scatter};

/// What a fit shows that a user should know.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum FitWarning {
    /// The residuals are not independent at the level of 1 %: the model of the material, of the tip or of the noise is wrong.
    #[error(
        "the residuals are not independent: {over_noise:.2} times the noise, {:.2} % of the maximum force; see Fit::variants for what this does to the modulus",
        100.0 * .over_force
    )]
    Misfit {
        /// Standard deviation of the residuals over that of the noise, from second differences of the force: 1 if the model is right.
        over_noise: f64,
        /// Standard deviation of the residuals over the maximum force.
        over_force: f64,
    },
    /// A curve has a pull-off, less offset, drift, tilt and drag of the fit: the model has none, and [`Curve::until_release`](crate::Curve::until_release) leaves it out.
    #[error("curve {curve}: a pull-off of {force:.2e} N, which the model has not: use Curve::until_release")]
    PullOff {
        /// Index of the curve.
        curve: usize,
        /// Force below the base line \[N\].
        force: f64,
    },
    /// The drive of a curve scatters, and the force does not follow it as that of a tip that moves so would: the scatter is an error of the measured drive. The
    /// fit takes it for a motion, which biases the moduli. [`Curve::averaged`](crate::Curve::averaged) reduces it.
    #[error(
        "curve {curve}: the force does not show the scatter of the drive of {scatter:.2e} m, an error of its measurement that biases the moduli: use Curve::averaged"
    )]
    DriveError {
        /// Index of the curve.
        curve: usize,
        /// Standard deviation of the scatter \[m\].
        scatter: f64,
    },
    /// The data determine a parameter by no better than a factor of two.
    #[error("{parameter} is uncertain by more than a factor of two: fix it, or measure where it matters")]
    Undetermined {
        /// Name of the parameter.
        parameter: String,
    },
    /// Two parameters are correlated by more than 0.99: the data determine only a combination of them.
    #[error("only a combination of {} and {} is determined: fix one of them", .parameters[0], .parameters[1])]
    Correlated {
        /// Names of the parameters.
        parameters: [String; 2],
    },
    /// A parameter is at a limit of the model, where the model is a simpler one.
    #[error("{parameter} is at its limit: {limit}; take the simpler model, or measure where {parameter} acts")]
    AtLimit {
        /// Name of the parameter.
        parameter: String,
        /// The limit.
        limit: &'static str,
    },
    /// The search has failed: a simpler model that this one contains fits better.
    #[error("the search has failed: {model}, a special case, has {ratio} of the sum of squares: give start values")]
    AboveContained {
        /// The simpler model.
        model: Model,
        /// Its sum of squares over that of this fit.
        ratio: f64,
    },
    /// The autoregressive coefficient of a curve is as great as the search allows: a model that is wrong leaves such residuals.
    #[error(
        "curve {curve}: the correlation of the residuals is at its bound: the model of the material or the tip is likely wrong"
    )]
    Correlation {
        /// Index of the curve.
        curve: usize,
    },
    /// A time lies outside the times of the data, so that it is extrapolated.
    #[error("{parameter} lies outside the times of the data: sample faster, or measure longer")]
    TimeOutside {
        /// Name of the parameter.
        parameter: String,
    },
    /// At its deepest, the contact of a curve is outside the model: too steep, too deep in its layer, on too few cells, or its modulus is none of
    /// a solid. The text is one of [`StepReport::messages`](viscocontact::contact::StepReport::messages).
    #[error("curve {curve}: {text}")]
    Contact {
        /// Index of the curve.
        curve: usize,
        /// What is outside, with its number and its remedy.
        text: String,
    },
}

/// Probability below which a test of the residuals is a warning.
const UNLIKELY: f64 = 0.01;
/// Correlation of neighbours that is warned of.
const GREAT_CORRELATION: f64 = 0.98;
/// Sums of squares that differ by less than this fraction are of one minimum.
const SAME_SUM: f64 = 1e-6;

impl Fit {
    /// What a user should know before the parameters are used.
    pub fn warnings(&self) -> Vec<FitWarning> {
        let mut warnings = Vec::new();
        if self.probability() < UNLIKELY {
            let [over_noise, over_force] = self.misfit();
            warnings.push(FitWarning::Misfit { over_noise, over_force });
        }
        if let Some((model, ratio)) = self.found.above.filter(|(_, ratio)| *ratio < 1.0 - SAME_SUM) {
            warnings.push(FitWarning::AboveContained { model, ratio });
        }
        for (curve, of) in self.curves.iter().enumerate() {
            let is_bound = self.autoregression_of(curve).is_some_and(|phi| phi > GREAT_CORRELATION);
            if self.identification.fits_correlation() && is_bound {
                warnings.push(FitWarning::Correlation { curve });
            }
            warnings.extend(self.pull_off(of, curve).map(|force| FitWarning::PullOff { curve, force }));
            if is_error(self.samples(curve), self.residuals(curve)) {
                warnings.push(FitWarning::DriveError { curve, scatter: scatter(of.experiment.protocol.drive()) });
            }
            warnings.extend(self.contact_warnings(curve));
        }
        let ([shortest, longest], of_material) = (self.problem.window, self.model().parameters());
        for (k, estimate) in self.estimates.iter().enumerate() {
            let parameter = estimate.name.clone();
            if let Some(limit) = estimate.limit {
                warnings.push(FitWarning::AtLimit { parameter, limit });
            } else if of_material.contains(&parameter) {
                if estimate.deviation > LN_2 {
                    warnings.push(FitWarning::Undetermined { parameter: parameter.clone() });
                }
                if parameter.starts_with("tau") && (estimate.value < 0.5 * shortest || estimate.value > 2.0 * longest) {
                    warnings.push(FitWarning::TimeOutside { parameter });
                }
            }
            for Estimate { name, .. } in &self.estimates[k + 1..] {
                if self.correlation(&estimate.name, name).is_some_and(|c| c.abs() > 0.99) {
                    warnings.push(FitWarning::Correlated { parameters: [estimate.name.clone(), name.clone()] });
                }
            }
        }
        warnings
    }

    /// The pull-off of a curve, less offset, drift, tilt and drag of the fit, below the base line before the contact, which scatters as the noise does.
    fn pull_off(&self, of: &Curve, curve: usize) -> Option<f64> {
        let bare = Curve { force: self.problem.whole().bare(curve, &self.values), ..of.clone() };
        let before = self.samples(curve).iter().position(|sample| sample.contact_depth > 0.0).unwrap_or(0);
        let means: Vec<f64> = bare.force[..before].chunks_exact(BLOCK).map(mean).collect();
        if means.is_empty() {
            return bare.pull_below(0.0, 0.0);
        }
        // about a line: the pull itself may have bent what the fit took for drift or tilt
        let order: Vec<f64> = (0..means.len()).map(|k| k as f64).collect();
        let [.., square] = line(&order, &means, true);
        bare.pull_below(mean(&means), (square / means.len() as f64).sqrt())
    }

    /// What a step on the elastic states of the tip to the maximum contact of a curve warns of.
    fn contact_warnings(&self, curve: usize) -> Vec<FitWarning> {
        let tip = self.curves()[curve].experiment().tip();
        let depth = self.samples(curve).iter().map(|sample| sample.contact_depth).fold(0.0, f64::max);
        let step = |mut contact: StatesContact| contact.step(0.0, Load::approach(tip.approach(0.0) + depth));
        let material = self.prony.material_on(tip);
        let report = material.and_then(|material| Ok(StatesContact::new(tip, &material).and_then(step)?));
        let messages = report.iter().flat_map(StepReport::messages);
        messages.map(|text| FitWarning::Contact { curve, text }).collect()
    }
}

/// Fits of the same curves, best first, each with its difference of Akaike's criterion from the best and its weight exp(−difference/2) among
/// the candidates. Candidates that failed are left out. The criterion takes residuals as independent but for the fitted correlation.
///
/// # Errors
/// [`Error::OtherData`] if fits are of different curves, or some are robust; the error of the last candidate if all failed.
pub fn ranked(candidates: impl IntoIterator<Item = Result<Fit>>) -> Result<Vec<(Fit, f64, f64)>> {
    let mut failure = None;
    let fitted = candidates.into_iter().filter_map(|candidate| candidate.map_err(|error| failure = Some(error)).ok());
    let mut fits: Vec<Fit> = fitted.collect();
    fits.sort_by(|a, b| a.aicc().total_cmp(&b.aicc()));
    let Some(best) = fits.first() else { return failure.map_or(Ok(Vec::new()), Err) };
    let is_same = |fit: &Fit| !fit.identification.robust && fit.curves == best.curves;
    if fits.len() > 1 && !fits.iter().all(is_same) {
        return Err(Error::OtherData);
    }
    // equal infinities do not differ: NaN is less than 0 here
    let differences: Vec<f64> = fits.iter().map(|fit| (fit.aicc() - best.aicc()).max(0.0)).collect();
    let weight = |difference: f64| (-0.5 * difference).exp();
    let total: f64 = differences.iter().copied().map(weight).sum();
    Ok(fits.into_iter().zip(differences).map(|(fit, more)| (fit, more, weight(more) / total)).collect())
}
