use crate::error::UserError;
use crate::rheology::{CreepSpectrum, FitReport, Rheology};

/// A rheology at a temperature other than the one measured; made by
/// [`TimeTemperature::at`](crate::rheology::TimeTemperature::at).
#[derive(Debug, Clone, PartialEq)]
pub struct ShiftedRheology<R> {
    pub(super) rheology: R,
    pub(super) factor: f64,
    /// b_T.
    pub(super) vertical: f64,
    pub(super) temperature: f64,
}

impl<R: Rheology> ShiftedRheology<R> {
    /// Temperature \[K\].
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// The shift factor a_T.
    pub fn shift_factor(&self) -> f64 {
        self.factor
    }

    /// The vertical factor b_T of the moduli.
    pub fn vertical_factor(&self) -> f64 {
        self.vertical
    }
}

impl<R: Rheology> Rheology for ShiftedRheology<R> {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.rheology.creep_compliance(t / self.factor) / self.vertical
    }

    fn failure(&self) -> Option<UserError> {
        self.rheology.failure()
    }

    /// `None` also where a time or a compliance leaves the range of a [`CreepSpectrum`].
    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        let slowed = self.rheology.creep_spectrum()?.slowed(self.factor).ok()?;
        if self.vertical == 1.0 { Some(slowed) } else { slowed.scaled(1.0 / self.vertical).ok() }
    }

    fn known_until(&self) -> f64 {
        self.rheology.known_until() * self.factor
    }

    fn measured(&self) -> [f64; 2] {
        self.rheology.measured().map(|time| time * self.factor)
    }

    /// The report of the rheology at its own temperature.
    fn fit_report(&self) -> Option<&FitReport> {
        self.rheology.fit_report()
    }
}
