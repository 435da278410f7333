use std::sync::Arc;

use crate::error::{Result, UserError, in_order, least_length, positive, within};
use crate::rheology::{CreepSpectrum, FitReport, Rheology};

/// The gas constant \[J/(mol K)\] (exact since 2019).
pub(crate) const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// The dependence of creep on temperature: at T all times are a_T times the times at the reference temperature
/// (thermorheologically simple bodies).
///
/// ```
/// use viscocontact::rheology::{Maxwell, Rheology, TimeTemperature};
///
/// // the constants often quoted for polymers above their glass transition (Williams, Landel & Ferry 1955)
/// let wlf = TimeTemperature::wlf(17.44, 51.6, 373.15)?;
/// assert_eq!(wlf.shift_factor(373.15)?, 1.0);
/// assert!((wlf.shift_factor(393.15)?.log10() + 17.44 * 20.0 / 71.6).abs() < 1e-12);
///
/// // a body measured at 373.15 K, at 20 K more
/// let warm = wlf.at(Maxwell::with_time(1.0e6, 1.0e3)?, 393.15)?;
/// assert!(warm.creep_compliance(1.0) > 5.0 * warm.creep_compliance(0.0));
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TimeTemperature {
    law: Law,
    reference: f64,
    /// Temperatures, each lower than the one before, below which Arrhenius laws with their energies continue.
    below: Vec<Below>,
}

#[derive(Debug, Clone, PartialEq)]
enum Law {
    Wlf {
        c1: f64,
        c2: f64,
    },
    Arrhenius {
        energy: f64,
    },
    /// Temperatures, ascending, and a_T.
    Table {
        rows: Arc<[(f64, f64)]>,
        extrapolated: bool,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Below {
    temperature: f64,
    energy: f64,
}

impl TimeTemperature {
    /// Williams, Landel and Ferry: log₁₀ a_T = −C₁ (T − T_ref)/(C₂ + T − T_ref), C₂ and temperatures in K.
    ///
    /// # Errors
    /// If a constant or the reference temperature is not finite and positive.
    pub fn wlf(c1: f64, c2: f64, reference: f64) -> Result<TimeTemperature> {
        positive("WLF constant C1", c1)?;
        positive("WLF constant C2", c2)?;
        positive("reference temperature", reference)?;
        Ok(TimeTemperature { law: Law::Wlf { c1, c2 }, reference, below: Vec::new() })
    }

    /// Arrhenius: ln a_T = (E/R)(1/T − 1/T_ref), activation `energy` E in J/mol, temperatures in K.
    ///
    /// # Errors
    /// If the energy or the reference temperature is not finite and positive.
    pub fn arrhenius(energy: f64, reference: f64) -> Result<TimeTemperature> {
        positive("activation energy", energy)?;
        positive("reference temperature", reference)?;
        Ok(TimeTemperature { law: Law::Arrhenius { energy }, reference, below: Vec::new() })
    }

    /// A `table` of temperatures \[K\], ascending, and shift factors a_T, which are 1 at the `reference`. Between its rows ln a_T
    /// is linear in 1/T; outside there is no factor, unless the table is [`extrapolated`](TimeTemperature::extrapolated).
    ///
    /// ```
    /// use viscocontact::rheology::TimeTemperature;
    ///
    /// let measured = TimeTemperature::table(&[(291.15, 1.0), (298.15, 0.0316), (305.15, 0.001)], 291.15)?;
    /// assert!((measured.shift_factor(305.15)? / 0.001 - 1.0).abs() < 1e-12);
    /// assert!(measured.shift_factor(320.0).is_err());
    /// assert!(measured.extrapolated().shift_factor(320.0)? < 1.0e-4);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If there are fewer than two rows, their temperatures do not ascend, a value is not finite and positive, or no row says
    /// a_T = 1 at the reference.
    pub fn table(table: &[(f64, f64)], reference: f64) -> Result<TimeTemperature> {
        least_length("rows of shift factors", table.len(), 2)?;
        for &(temperature, factor) in table {
            positive("temperature", temperature)?;
            positive("shift factor", factor)?;
        }
        in_order("temperatures of shift factors", table.iter().map(|row| row.0), "ascend", |a, b| a < b)?;
        let allowed = "a temperature of the table at which a_T = 1";
        within("reference temperature", reference, table.contains(&(reference, 1.0)), allowed)?;
        Ok(TimeTemperature {
            law: Law::Table { rows: table.into(), extrapolated: false },
            reference,
            below: Vec::new(),
        })
    }

    /// The same beyond a table of shift factors, by the Arrhenius law through its two last rows; other laws stay as they are.
    #[must_use]
    pub fn extrapolated(mut self) -> TimeTemperature {
        if let Law::Table { extrapolated, .. } = &mut self.law {
            *extrapolated = true;
        }
        self
    }

    /// The same above a `temperature` \[K\], and below it an Arrhenius law with an `energy` in J/mol, without a jump: as of
    /// polymers below their glass transition.
    ///
    /// # Errors
    /// If one is not finite and positive, the law does not hold at the temperature, or the temperature is above the reference, or not below
    /// the temperature of an Arrhenius law that continues the law already.
    pub fn with_arrhenius_below(mut self, temperature: f64, energy: f64) -> Result<TimeTemperature> {
        positive("activation energy", energy)?;
        let is_below = match self.below.last() {
            Some(above) => temperature < above.temperature,
            None => temperature <= self.reference,
        };
        let allowed = "at most the reference temperature, and below those given before";
        within("upper end of an Arrhenius law", temperature, is_below, allowed)?;
        self.shift_factor(temperature)?;
        self.below.push(Below { temperature, energy });
        Ok(self)
    }

    /// Temperatures \[K\] below which Arrhenius laws continue, and their energies in J/mol.
    pub(crate) fn arrhenius_below(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.below.iter().map(|below| (below.temperature, below.energy))
    }

    /// The rows of a table of shift factors, and whether it is extrapolated.
    pub(crate) fn rows(&self) -> Option<(&[(f64, f64)], bool)> {
        if let Law::Table { rows, extrapolated } = &self.law { Some((rows, *extrapolated)) } else { None }
    }

    /// The temperature at which a_T = 1 \[K\].
    pub fn reference(&self) -> f64 {
        self.reference
    }

    /// C₁ and C₂ \[K\] of a WLF law.
    pub fn wlf_constants(&self) -> Option<[f64; 2]> {
        if let Law::Wlf { c1, c2 } = self.law { Some([c1, c2]) } else { None }
    }

    /// E \[J/mol\] of an Arrhenius law.
    pub fn activation_energy(&self) -> Option<f64> {
        if let Law::Arrhenius { energy } = self.law { Some(energy) } else { None }
    }

    /// a_T at `temperature` \[K\].
    ///
    /// # Errors
    /// If the temperature is not finite and positive, not above T_ref − C₂, where the WLF law ends, outside a table, or a_T is outside
    /// \[1e-60, 1e60\].
    pub fn shift_factor(&self, temperature: f64) -> Result<f64> {
        positive("temperature", temperature)?;
        if let Some(below) = self.below.iter().rfind(|below| temperature < below.temperature) {
            let slower = below.energy / GAS_CONSTANT * (1.0 / temperature - 1.0 / below.temperature);
            let factor = self.shift_factor(below.temperature)? * slower.exp();
            return within("shift factor", factor, (1e-60..=1e60).contains(&factor), "in [1e-60, 1e60]");
        }
        let difference = temperature - self.reference;
        let factor = match &self.law {
            &Law::Wlf { c1, c2 } => {
                let allowed = "above T_ref - C2, where the WLF law ends: temperatures are in kelvin (20 °C is 293.15)";
                within("temperature", temperature, c2 + difference > 0.0, allowed)?;
                10f64.powf(-c1 * difference / (c2 + difference))
            }
            Law::Arrhenius { energy } => (energy / GAS_CONSTANT * (1.0 / temperature - 1.0 / self.reference)).exp(),
            Law::Table { rows, extrapolated } => {
                let (x, last) = (1.0 / temperature, rows.len() - 1);
                let node = |k: usize| (1.0 / rows[k].0, rows[k].1.ln());
                let inside = *extrapolated || (node(last).0..=node(0).0).contains(&x);
                within(
                    "temperature",
                    temperature,
                    inside,
                    "in the table of shift factors (TimeTemperature::extrapolated)",
                )?;
                let k = rows.partition_point(|row| 1.0 / row.0 > x).clamp(1, last);
                let [a, b] = [node(k - 1), node(k)];
                (a.1 + (x - a.0) / (b.0 - a.0) * (b.1 - a.1)).exp()
            }
        };
        let allowed = "in [1e-60, 1e60]: temperatures are in kelvin (20 °C is 293.15), energies in J/mol";
        within("shift factor", factor, (1e-60..=1e60).contains(&factor), allowed)
    }

    /// A `rheology` known at the reference temperature, at another `temperature` \[K\]: J(t/a_T).
    ///
    /// # Errors
    /// As [`TimeTemperature::shift_factor`].
    pub fn at<R: Rheology>(&self, rheology: R, temperature: f64) -> Result<ShiftedRheology<R>> {
        Ok(ShiftedRheology { rheology, factor: self.shift_factor(temperature)?, temperature })
    }
}

/// A rheology at a temperature other than the one measured; made by [`TimeTemperature::at`].
#[derive(Debug, Clone, PartialEq)]
pub struct ShiftedRheology<R> {
    rheology: R,
    factor: f64,
    temperature: f64,
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
}

impl<R: Rheology> Rheology for ShiftedRheology<R> {
    fn creep_compliance(&self, t: f64) -> f64 {
        self.rheology.creep_compliance(t / self.factor)
    }

    fn failure(&self) -> Option<UserError> {
        self.rheology.failure()
    }

    /// `None` also where a time leaves the range of a [`CreepSpectrum`].
    fn creep_spectrum(&self) -> Option<CreepSpectrum> {
        self.rheology.creep_spectrum()?.slowed(self.factor).ok()
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
