//! How far a misfit may be trusted.

use crate::fit::Fit;
use crate::noise::Noise;
use crate::parameters::Nuisance;
use crate::statistics::scatter;

/// A fit of the same curves with another assumption on the measurement.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Variant {
    /// What is assumed.
    pub assumption: &'static str,
    /// Times \[s\]: shortest interval, geometric mean, and length of the curves.
    pub times: [f64; 3],
    /// The contact modulus at these times over that of the fit.
    pub ratios: [f64; 3],
    /// Akaike's criterion less that of the fit: negative where the variant is better.
    pub aicc_difference: f64,
}

impl Fit {
    /// Size of the misfit: the standard deviation of the residuals over that of the noise (from second differences of the force: 1 if the model is
    /// right and the noise white), and over the maximum force; the largest of the curves.
    pub fn misfit(&self) -> [f64; 2] {
        let of_curve = |curve: usize| {
            let (force, residuals) = (self.curves()[curve].force(), self.residuals(curve));
            let deviation = (residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64).sqrt();
            let greatest = force.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
            [deviation / scatter(residuals), deviation / greatest]
        };
        (0..self.curves().len()).map(of_curve).fold([0.0; 2], |[a, b], [x, y]| [a.max(x), b.max(y)])
    }

    /// What the answer depends on: the same curves with a drift, with a tilt, with correlated noise and without outliers, each alone. Where the moduli
    /// of the variants differ by more than the deviations of the fit, the difference is the uncertainty. Variants that fail are left out.
    ///
    /// # Errors
    /// If a watch ends it.
    pub fn variants(&self) -> crate::error::Result<Vec<Variant>> {
        let ([first, last], base) = (self.problem.window, &self.identification);
        let times = [first, (first * last).sqrt(), last];
        let all = [
            ("drift", base.clone().drift(Nuisance::Fitted)),
            ("tilt", base.clone().tilt(Nuisance::Fitted)),
            ("correlated noise", base.clone().noise(Noise::Autoregressive)),
            ("no outliers", base.clone().robust()),
        ];
        let variant = |(assumption, identification): (&'static str, crate::identification::Identification)| {
            let fit = identification.fit(&self.curves).ok()?;
            let ratios = times.map(|time| fit.modulus(time) / self.modulus(time));
            Some(Variant { assumption, times, ratios, aicc_difference: fit.aicc() - self.aicc() })
        };
        let found = all.into_iter().filter_map(variant).collect();
        self.goes_on().map(|()| found)
    }
}
