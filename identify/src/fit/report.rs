//! Warnings, and the ranking of models.

use std::fmt;

use viscocontact::contact::StepReport;
use viscocontact::load::Load;
use viscocontact::states::StatesContact;

use crate::error::{Error, Result};
use crate::fit::Fit;
use crate::model::Model;
use crate::noise::CurveNoise;

/// What a fit shows that a user should know.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum FitWarning {
    /// The residuals are not independent at the level of 1 %: the model of the material, of the tip or of the noise is wrong.
    Misfit {
        /// Standard deviation of the residuals over that of the noise, from second differences of the force: 1 if the model is right.
        over_noise: f64,
        /// Standard deviation of the residuals over the greatest force.
        over_force: f64,
    },
    /// A curve has a pull-off: the model has none, and [`Curve::until_release`](crate::Curve::until_release) leaves it out.
    PullOff {
        /// Index of the curve.
        curve: usize,
        /// Force below the base line \[N\].
        force: f64,
    },
    /// The data determine a parameter by no better than a factor of two.
    Undetermined {
        /// Name of the parameter.
        parameter: String,
    },
    /// Two parameters are correlated by more than 0.99: the data determine only a combination of them.
    Correlated {
        /// Names of the parameters.
        parameters: [String; 2],
    },
    /// A parameter is at a limit of the model, where the model is a simpler one.
    AtLimit {
        /// Name of the parameter.
        parameter: String,
        /// The limit.
        limit: &'static str,
    },
    /// The search has failed: a simpler model that this one contains fits better.
    AboveContained {
        /// The simpler model.
        model: Model,
        /// Its sum of squares over that of this fit.
        ratio: f64,
    },
    /// The autoregressive coefficient of a curve is as great as the search allows: a model that is wrong leaves such residuals.
    Correlation {
        /// Index of the curve.
        curve: usize,
    },
    /// A time lies outside the times of the data, so that it is extrapolated.
    TimeOutside {
        /// Name of the parameter.
        parameter: String,
    },
    /// At its deepest, the contact of a curve is outside the model: too steep, too deep in its layer, on too few cells, or its modulus is none of
    /// a solid. The text is one of [`StepReport::messages`](viscocontact::contact::StepReport::messages).
    Contact {
        /// Index of the curve.
        curve: usize,
        /// What is outside, with its number and its cure.
        text: String,
    },
}

impl fmt::Display for FitWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FitWarning::Misfit { over_noise, over_force } => write!(
                f,
                "the residuals are not independent: {over_noise:.2} times the noise, {:.2} % of the greatest force; see Fit::variants for what this does to the modulus",
                100.0 * over_force
            ),
            FitWarning::PullOff { curve, force } => {
                write!(
                    f,
                    "curve {curve}: a pull-off of {force:.2e} N, which the model has not: use Curve::until_release"
                )
            }
            FitWarning::Undetermined { parameter } => {
                write!(f, "{parameter} is uncertain by more than a factor of two: fix it, or measure where it matters")
            }
            FitWarning::Correlated { parameters: [one, other] } => {
                write!(f, "only a combination of {one} and {other} is determined: fix one of them")
            }
            FitWarning::AtLimit { parameter, limit } => write!(f, "{parameter} is at its limit: {limit}"),
            FitWarning::AboveContained { model, ratio } => {
                write!(
                    f,
                    "the search has failed: {model}, a special case, has {ratio} of the sum of squares: give start values"
                )
            }
            FitWarning::Correlation { curve } => write!(
                f,
                "curve {curve}: the correlation of the residuals is at its bound: the model of the material or the tip is likely wrong"
            ),
            FitWarning::TimeOutside { parameter } => {
                write!(f, "{parameter} lies outside the times of the data: sample faster, or measure longer")
            }
            FitWarning::Contact { curve, text } => write!(f, "curve {curve}: {text}"),
        }
    }
}

/// Probability below which a test of the residuals is a warning; there are two tests.
const UNLIKELY: f64 = 0.005;
/// Correlation of neighbours that is warned of.
const GREAT_CORRELATION: f64 = 0.98;
/// Sums of squares that differ by less than this fraction are of one minimum.
const SAME_SUM: f64 = 1e-6;
/// ln 2.
const FACTOR_OF_TWO: f64 = std::f64::consts::LN_2;

impl Fit {
    /// What a user should know before the parameters are used.
    pub fn warnings(&self) -> Vec<FitWarning> {
        let mut warnings = Vec::new();
        if self.runs().probability < UNLIKELY && self.runs().statistic < 0.0
            || self.correlations().probability < UNLIKELY
        {
            let [over_noise, over_force] = self.misfit();
            warnings.push(FitWarning::Misfit { over_noise, over_force });
        }
        if let Some((model, sum)) = self.contained.filter(|(_, sum)| *sum < (1.0 - SAME_SUM) * self.sum) {
            warnings.push(FitWarning::AboveContained { model, ratio: sum / self.sum });
        }
        let is_bound = |noise: &CurveNoise| noise.correlation.is_some_and(|phi| phi > GREAT_CORRELATION);
        let bound = self
            .noise
            .iter()
            .enumerate()
            .filter(|(_, noise)| self.identification.fits_correlation() && is_bound(noise));
        warnings.extend(bound.map(|(curve, _)| FitWarning::Correlation { curve }));
        let pulled = self.curves().iter().enumerate();
        warnings.extend(pulled.filter_map(|(curve, of)| Some(FitWarning::PullOff { curve, force: of.pull_off()? })));
        let limits = self.estimates().iter().filter_map(|estimate| Some((estimate, estimate.limit?)));
        warnings
            .extend(limits.map(|(estimate, limit)| FitWarning::AtLimit { parameter: estimate.name.clone(), limit }));
        let of_material = self.model().parameters();
        let material = || self.estimates().iter().filter(|e| of_material.contains(&e.name) && e.limit.is_none());
        for estimate in material() {
            let parameter = estimate.name.clone();
            if estimate.deviation > FACTOR_OF_TWO {
                warnings.push(FitWarning::Undetermined { parameter: parameter.clone() });
            }
            let [shortest, longest] = self.window();
            if parameter.starts_with("tau") && (estimate.value < 0.5 * shortest || estimate.value > 2.0 * longest) {
                warnings.push(FitWarning::TimeOutside { parameter });
            }
        }
        for (k, one) in self.estimates().iter().enumerate() {
            for other in &self.estimates()[k + 1..] {
                if self.correlation(&one.name, &other.name).is_some_and(|c| c.abs() > 0.99) {
                    let parameters = [one.name.clone(), other.name.clone()];
                    warnings.push(FitWarning::Correlated { parameters });
                }
            }
        }
        warnings.extend((0..self.curves().len()).flat_map(|curve| self.contact_warnings(curve)));
        warnings
    }

    /// What a step on the elastic states of the tip to the greatest contact of a curve warns of.
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
    let (mut fits, mut failure) = (Vec::<Fit>::new(), None);
    for candidate in candidates {
        match candidate {
            Ok(fit) => fits.push(fit),
            Err(error) => failure = Some(error),
        }
    }
    fits.sort_by(|a, b| a.aicc().total_cmp(&b.aicc()));
    let Some(best) = fits.first() else { return failure.map_or(Ok(Vec::new()), Err) };
    let of_best = best.aicc();
    let is_same = |fit: &Fit| !fit.identification.is_robust() && fit.curves == best.curves;
    if fits.len() > 1 && !fits.iter().all(is_same) {
        return Err(Error::OtherData);
    }
    let total: f64 = fits.iter().map(|fit| (-0.5 * (fit.aicc() - of_best)).exp()).sum();
    let of = |fit: Fit| {
        let difference = fit.aicc() - of_best;
        (fit, difference, (-0.5 * difference).exp() / total)
    };
    Ok(fits.into_iter().map(of).collect())
}
