use std::fmt;
use std::sync::Arc;

use crate::error::{Error, Result, in_order, least_length, positive, within};
use crate::rheology::{Rheology, ShiftedRheology};

/// The gas constant \[J/(mol K)\] (exact since 2019).
pub(crate) const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// The dependence of creep on temperature: at T all times are a_T times the times at the reference temperature
/// (thermorheologically simple bodies), and all moduli b_T times the moduli there, if the law has such vertical
/// factors.
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
#[derive(Clone, PartialEq)]
pub struct TimeTemperature {
    law: Law,
    reference: f64,
    /// Temperatures, each lower than the one before, below which Arrhenius laws with their energies continue.
    below: Vec<Below>,
    vertical: Option<Vertical>,
}

// without vertical factors as it was printed before there were any: checkpoints compare it
impl fmt::Debug for TimeTemperature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TimeTemperature { law, reference, below, vertical } = self;
        let mut debug = f.debug_struct("TimeTemperature");
        debug.field("law", law).field("reference", reference).field("below", below);
        if let Some(vertical) = vertical {
            debug.field("vertical", vertical);
        }
        debug.finish()
    }
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

/// How moduli change with temperature, beside the times.
#[derive(Debug, Clone, PartialEq)]
enum Vertical {
    /// b_T = T/T_ref.
    Entropic,
    /// Temperatures, ascending, and b_T.
    Table { rows: Arc<[(f64, f64)]>, extrapolated: bool },
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
    /// If a constant is not finite and positive, or the reference temperature not finite and at least 100 K.
    pub fn wlf(c1: f64, c2: f64, reference: f64) -> Result<TimeTemperature> {
        positive("WLF constant C1", c1)?;
        positive("WLF constant C2", c2)?;
        // no reference is as low, but for degrees Celsius: their differences from kelvin would pass for great ones
        let allowed = "finite and at least 100 K: temperatures are in kelvin (20 °C is 293.15)";
        within("reference temperature", reference, reference >= 100.0, allowed)?;
        Ok(TimeTemperature::by(Law::Wlf { c1, c2 }, reference))
    }

    /// Arrhenius: ln a_T = (E/R)(1/T − 1/T_ref), activation `energy` E in J/mol, temperatures in K.
    ///
    /// # Errors
    /// If the energy or the reference temperature is not finite and positive.
    pub fn arrhenius(energy: f64, reference: f64) -> Result<TimeTemperature> {
        positive("activation energy", energy)?;
        positive("reference temperature", reference)?;
        Ok(TimeTemperature::by(Law::Arrhenius { energy }, reference))
    }

    fn by(law: Law, reference: f64) -> TimeTemperature {
        TimeTemperature { law, reference, below: Vec::new(), vertical: None }
    }

    /// A `table` of temperatures \[K\], ascending, and shift factors a_T, which are 1 at the `reference`. Between its
    /// rows ln a_T is linear in 1/T; outside there is no factor, unless the table is
    /// [`extrapolated`](TimeTemperature::extrapolated).
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
    /// If there are fewer than two rows, their temperatures do not ascend, a value is not finite and positive, or no
    /// row says a_T = 1 at the reference.
    pub fn table(table: &[(f64, f64)], reference: f64) -> Result<TimeTemperature> {
        least_length("rows of shift factors", table.len(), 2)?;
        let rows = checked_rows(["temperatures of shift factors", "shift factor"], table, reference)?;
        Ok(TimeTemperature::by(Law::Table { rows, extrapolated: false }, reference))
    }

    /// The same beyond a table of shift factors, by the Arrhenius law through its two last rows, and beyond a table
    /// of vertical factors, by the power of T through its two last rows; other laws stay as they are.
    #[must_use]
    pub fn extrapolated(mut self) -> TimeTemperature {
        if let Law::Table { extrapolated, .. } = &mut self.law {
            *extrapolated = true;
        }
        if let Some(Vertical::Table { extrapolated, .. }) = &mut self.vertical {
            *extrapolated = true;
        }
        self
    }

    /// The same with moduli that change with temperature, too: a `table` of temperatures \[K\], ascending, and
    /// vertical factors b_T, which are 1 at the reference. At T all moduli are b_T times those at the reference, and
    /// all compliances 1/b_T times. Between its rows ln b_T is linear in ln T; outside there is no factor, unless the
    /// law is [`extrapolated`](TimeTemperature::extrapolated). The laws of a
    /// [`MasterCurve`](crate::rheology::MasterCurve) have the factors of the curve.
    ///
    /// ```
    /// use viscocontact::rheology::{Elastic, Rheology, TimeTemperature};
    ///
    /// let law = TimeTemperature::wlf(8.61, 200.4, 293.15)?.with_vertical_factors(&[(293.15, 1.0), (353.15, 1.15)])?;
    /// let warm = law.at(Elastic::new(1.0e6)?, 353.15)?;
    /// assert!((warm.creep_compliance(0.0) * 1.15e6 - 1.0).abs() < 1e-12);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If there is no row, the temperatures do not ascend, a value is not finite and positive, or no row says b_T = 1
    /// at the reference.
    pub fn with_vertical_factors(self, table: &[(f64, f64)]) -> Result<TimeTemperature> {
        let rows = checked_rows(["temperatures of vertical factors", "vertical factor"], table, self.reference)?;
        Ok(TimeTemperature { vertical: Some(Vertical::Table { rows, extrapolated: false }), ..self })
    }

    /// The same with moduli in proportion to the temperature, b_T = T/T_ref, as of rubbers, whose elasticity is that
    /// of entropy.
    #[must_use]
    pub fn with_entropic_moduli(self) -> TimeTemperature {
        TimeTemperature { vertical: Some(Vertical::Entropic), ..self }
    }

    /// The same with moduli that do not change with temperature: no other law has a
    /// [history of the temperature](crate::rheology::TemperatureHistory).
    #[must_use]
    pub fn without_vertical_factors(self) -> TimeTemperature {
        TimeTemperature { vertical: None, ..self }
    }

    /// Whether moduli change with temperature beside the times.
    pub fn has_vertical_factors(&self) -> bool {
        self.vertical.is_some()
    }

    /// The same above a `temperature` \[K\], and below it an Arrhenius law with an `energy` in J/mol, without a jump:
    /// as of polymers below their glass transition.
    ///
    /// # Errors
    /// If one is not finite and positive, the law does not hold at the temperature, or the temperature is above the
    /// reference, or not below the temperature of an Arrhenius law that continues the law already.
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

    /// b_T at `temperature` \[K\]: 1 of a law without vertical factors.
    ///
    /// # Errors
    /// If the temperature is not finite and positive, or outside a table of vertical factors.
    pub fn vertical_factor(&self, temperature: f64) -> Result<f64> {
        positive("temperature", temperature)?;
        match &self.vertical {
            None => Ok(1.0),
            Some(Vertical::Entropic) => Ok(temperature / self.reference),
            Some(Vertical::Table { rows, extrapolated }) => {
                let allowed = "in the table of vertical factors (TimeTemperature::extrapolated)";
                within("temperature", temperature, *extrapolated || is_inside(rows, temperature), allowed)?;
                Ok(interpolated(rows, temperature, f64::ln))
            }
        }
    }

    /// a_T at `temperature` \[K\].
    ///
    /// # Errors
    /// If the temperature is not finite and positive, not above T_ref − C₂, where the WLF law ends, outside a table,
    /// less than a third or more than three times the temperature at which an Arrhenius law begins, or a_T is outside
    /// \[1e-60, 1e60\].
    pub fn shift_factor(&self, temperature: f64) -> Result<f64> {
        positive("temperature", temperature)?;
        let allowed = "in [1e-60, 1e60]: temperatures are in kelvin (20 °C is 293.15), energies in J/mol";
        let in_range = |factor: f64| within("shift factor", factor, (1e-60..=1e60).contains(&factor), allowed);
        // one energy does not hold so far, and degrees Celsius are as far from kelvin
        let arrhenius = |energy: f64, from: f64| {
            let allowed =
                "from a third to three times that of an Arrhenius law: temperatures are in kelvin (20 °C is 293.15)";
            within("temperature", temperature, (from / 3.0..=3.0 * from).contains(&temperature), allowed)?;
            Ok::<f64, Error>((energy / GAS_CONSTANT * (1.0 / temperature - 1.0 / from)).exp())
        };
        if let Some(below) = self.below.iter().rfind(|below| temperature < below.temperature) {
            return in_range(self.shift_factor(below.temperature)? * arrhenius(below.energy, below.temperature)?);
        }
        let difference = temperature - self.reference;
        in_range(match &self.law {
            &Law::Wlf { c1, c2 } => {
                let allowed = "above T_ref - C2, where the WLF law ends: temperatures are in kelvin (20 °C is 293.15)";
                within("temperature", temperature, c2 + difference > 0.0, allowed)?;
                10f64.powf(-c1 * difference / (c2 + difference))
            }
            Law::Arrhenius { energy } => arrhenius(*energy, self.reference)?,
            Law::Table { rows, extrapolated } => {
                let allowed = "in the table of shift factors (TimeTemperature::extrapolated)";
                within("temperature", temperature, *extrapolated || is_inside(rows, temperature), allowed)?;
                interpolated(rows, temperature, |temperature| -1.0 / temperature)
            }
        })
    }

    /// A `rheology` known at the reference temperature, at another `temperature` \[K\]: J(t/a_T)/b_T.
    ///
    /// # Errors
    /// As [`TimeTemperature::shift_factor`] and [`TimeTemperature::vertical_factor`].
    pub fn at<R: Rheology>(&self, rheology: R, temperature: f64) -> Result<ShiftedRheology<R>> {
        let (factor, vertical) = (self.shift_factor(temperature)?, self.vertical_factor(temperature)?);
        Ok(ShiftedRheology { rheology, factor, vertical, temperature })
    }
}

/// Rows of temperatures \[K\] and factors, with a factor of 1 at the reference.
fn checked_rows(
    [temperatures, factor]: [&'static str; 2],
    table: &[(f64, f64)],
    reference: f64,
) -> Result<Arc<[(f64, f64)]>> {
    for &(temperature, value) in table {
        positive("temperature", temperature)?;
        positive(factor, value)?;
    }
    in_order(temperatures, table.iter().map(|row| row.0), "ascend", |a, b| a < b)?;
    let allowed = "a temperature of the table at which the factor is 1";
    within("reference temperature", reference, table.contains(&(reference, 1.0)), allowed)?;
    Ok(table.into())
}

fn is_inside(rows: &[(f64, f64)], temperature: f64) -> bool {
    let ends = rows.first().zip(rows.last());
    ends.is_some_and(|(first, last)| (first.0..=last.0).contains(&temperature))
}

/// The factor at a temperature, its logarithm being linear in an `abscissa` that ascends with the temperature:
/// between two rows, or beyond all of them through the last two.
fn interpolated(rows: &[(f64, f64)], temperature: f64, abscissa: impl Fn(f64) -> f64) -> f64 {
    if rows.len() < 2 {
        return rows.first().map_or(1.0, |row| row.1);
    }
    let node = |k: usize| (abscissa(rows[k].0), rows[k].1.ln());
    let k = rows.partition_point(|row| row.0 < temperature).clamp(1, rows.len() - 1);
    let (x, [a, b]) = (abscissa(temperature), [node(k - 1), node(k)]);
    (a.1 + (x - a.0) / (b.0 - a.0) * (b.1 - a.1)).exp()
}
