//! Drainage that looks like creep: relaxation times at two sizes of the contact.

use crate::error::{Result, positive};
use crate::statistics::WITHIN_95;

/// A relaxation time that was identified at one size of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[expect(clippy::exhaustive_structs, reason = "users write it out")]
pub struct TimeAtSize {
    /// Relaxation time τ \[s\].
    pub time: f64,
    /// Standard deviation of ln τ.
    pub log_error: f64,
    /// Contact area during the relaxation \[m²\].
    pub area: f64,
}

/// How relaxation times scale with the size of the contact, see [`TimeAtSize::scaling`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Scaling {
    /// ln(τ₂/τ₁).
    pub log_times: f64,
    /// Standard deviation of ln(τ₂/τ₁).
    pub log_error: f64,
    /// ln(A₂/A₁): the value of ln(τ₂/τ₁) for drainage.
    pub log_areas: f64,
    /// What this agrees with, at 95 %.
    pub verdict: Verdict,
}

/// With what a ratio of two relaxation times agrees at a confidence of 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Verdict {
    /// With equal times: the material relaxes. A time of the material does not depend on the size of the contact.
    Creep,
    /// With times that grow as the area: a pore fluid drains from below the contact, and the time is not one of the material.
    Drainage,
    /// With both: measure at depths further apart, or with less noise.
    Undecided,
    /// With neither: both act, or something else does, such as a layer, a nonlinear body, or a wrong model.
    Neither,
}

impl TimeAtSize {
    /// Compares this time with another one, at a contact of another size, under the hypotheses of creep, τ₂ = τ₁, and of
    /// drainage, τ ∝ a²/D with the contact radius a and the diffusivity D (Y. Hu, X. Zhao, J. J. Vlassak, Z. Suo, Appl. Phys.
    /// Lett. 96 (2010) 121904). Each true hypothesis is rejected in 5 % of the cases, if the errors are as given and
    /// independent.
    ///
    /// ```
    /// use viscocontact_identify::{TimeAtSize, Verdict};
    ///
    /// let shallow = TimeAtSize { time: 0.8, log_error: 0.05, area: 1.0e-12 };
    /// let deep = TimeAtSize { time: 3.1, log_error: 0.05, area: 4.0e-12 };
    /// assert_eq!(shallow.scaling(deep)?.verdict, Verdict::Drainage);
    /// # Ok::<(), viscocontact_identify::Error>(())
    /// ```
    ///
    /// # Errors
    /// If a time, an error or an area is not finite and positive.
    pub fn scaling(self, other: TimeAtSize) -> Result<Scaling> {
        for TimeAtSize { time, log_error, area } in [self, other] {
            positive("relaxation time", time)?;
            positive("standard deviation of ln τ", log_error)?;
            positive("contact area", area)?;
        }
        let (log_times, log_areas) = ((other.time / self.time).ln(), (other.area / self.area).ln());
        let log_error = self.log_error.hypot(other.log_error);
        let agrees = |expected: f64| (log_times - expected).abs() <= WITHIN_95 * log_error;
        let verdict = match (agrees(0.0), agrees(log_areas)) {
            (true, true) => Verdict::Undecided,
            (true, false) => Verdict::Creep,
            (false, true) => Verdict::Drainage,
            (false, false) => Verdict::Neither,
        };
        Ok(Scaling { log_times, log_error, log_areas, verdict })
    }
}
