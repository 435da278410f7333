use super::data::Place;
use crate::error::{Error, Refusal, Result, in_order, least_length, within};
use crate::rheology::table::Measurements;
use crate::rheology::table::data::{Deformation, MeasuredRow};
use crate::rheology::table::isotherm::Isotherm;
use crate::rheology::table::shift::{Shift, shift_between};
use crate::rheology::{CreepSeries, MaterialFunction, Tension, TimeTemperature};

/// Isotherms shifted along the axis of time (or frequency) until they form one curve at a reference
/// temperature, which spans more decades than any isotherm (time–temperature superposition).
///
/// The shift of each isotherm relative to its neighbour has the least difference of the logarithms of the values
/// where the two overlap, each column relative to its own scatter; single outliers cost little. Vertical shifts:
/// [`MasterCurve::with_vertical_shifts`].
///
/// ```
/// use viscocontact::rheology::{Isotherm, MasterCurve, Measurements, Rheology, TimeTemperature};
/// # use viscocontact::rheology::FractionalMaxwell;
///
/// # let body = FractionalMaxwell::findley(1.0e-9, 2.0e-10, 0.3)?;
/// # let law = TimeTemperature::arrhenius(150.0e3, 300.0)?;
/// let times: Vec<f64> = (0..=20).map(|k| 10f64.powf(0.15 * f64::from(k))).collect();
/// let mut isotherms = Vec::new();
/// for temperature in [300.0, 310.0, 320.0] {
///     // three decades of time at each temperature; here from a formula
/// #   let slow = law.shift_factor(temperature)?;
/// #   let table: Vec<(f64, f64)> = times.iter().map(|&t| (t, body.creep_compliance(t / slow))).collect();
///     isotherms.push(Isotherm::new(temperature, Measurements::creep(&table)?)?);
/// }
/// let master = MasterCurve::new(300.0, isotherms)?;
/// let polymer = master.fit()?; // at 300 K, over more than four decades
/// assert!(polymer.known_until() > 1.0e4);
/// println!("activation energy {:.0} kJ/mol", 1e-3 * master.arrhenius()?.activation_energy().unwrap());
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MasterCurve {
    reference: f64,
    /// By temperature, ascending.
    isotherms: Vec<Isotherm>,
    /// The shift of each isotherm from the reference. The disagreement belongs to the shift from the neighbouring
    /// isotherm.
    shifts: Vec<Shift>,
}

impl MasterCurve {
    /// Finds the shift factors from the data alone. `reference` \[K\] must be the temperature of an isotherm within
    /// 0.5 K, as temperatures of a file are means: the curve is at the temperature of the nearest isotherm.
    ///
    /// # Errors
    /// If there is no isotherm, two have the same temperature, they measure different quantities, none is at the
    /// reference temperature, or neighbours do not overlap in their values.
    pub fn new(reference: f64, isotherms: Vec<Isotherm>) -> Result<MasterCurve> {
        MasterCurve::shifted(reference, isotherms, false)
    }

    /// [`MasterCurve::new`] with vertical shifts too: the values of an isotherm may be those at the reference times a factor
    /// b_T, the same for storage and loss, as of rubbers (b_T near T/T_ref) and of specimens that were clamped anew.
    /// Where a curve is nearly a power law, a factor and a shift can hardly be told apart: see
    /// [`MasterCurve::shift_errors`].
    ///
    /// # Errors
    /// As [`MasterCurve::new`].
    pub fn with_vertical_shifts(reference: f64, isotherms: Vec<Isotherm>) -> Result<MasterCurve> {
        MasterCurve::shifted(reference, isotherms, true)
    }

    fn shifted(reference: f64, isotherms: Vec<Isotherm>, is_vertical: bool) -> Result<MasterCurve> {
        let isotherms = sorted(isotherms)?;
        let apart = |isotherm: &Isotherm| (isotherm.temperature - reference).abs();
        let nearest = (0..isotherms.len()).min_by(|&a, &b| apart(&isotherms[a]).total_cmp(&apart(&isotherms[b])));
        let Some(center) = nearest.filter(|&k| apart(&isotherms[k]) <= 0.5) else {
            let allowed = "the temperature of one of the isotherms, within 0.5 K";
            return Err(Error::OutOfRange { field: "reference temperature", value: reference, allowed });
        };
        let mut shifts = vec![Shift::default(); isotherms.len()];
        for k in (center + 1..isotherms.len()).chain((0..center).rev()) {
            let (before, [colder, warmer], sign) =
                if k > center { (k - 1, [k - 1, k], 1.0) } else { (k + 1, [k, k + 1], -1.0) };
            let shift = shift_between(&isotherms[colder], &isotherms[warmer], is_vertical)?;
            let log = shifts[before].log + sign * shift.log;
            let vertical = shifts[before].vertical + sign * shift.vertical;
            shifts[k] = Shift { log, error: shifts[before].error.hypot(shift.error), vertical, ..shift };
        }
        Ok(MasterCurve { reference: isotherms[center].temperature, isotherms, shifts })
    }

    /// Shifts by a known `law`, to its reference temperature.
    ///
    /// ```
    /// use viscocontact::rheology::{Isotherm, MasterCurve, Measurements, Rheology, TimeTemperature};
    ///
    /// // shift factors as another program found them
    /// let law = TimeTemperature::table(&[(291.15, 1.0), (298.15, 10f64.powf(-1.5))], 291.15)?;
    /// let moduli = |shift: f64| [0.1, 1.0, 10.0, 100.0].map(|t: f64| (t, 2.0e9 * (t * 10f64.powf(shift)).powf(-0.1)));
    /// let isotherms = vec![
    ///     Isotherm::new(291.15, Measurements::relaxation(&moduli(0.0))?)?,
    ///     Isotherm::new(298.15, Measurements::relaxation(&moduli(1.5))?)?,
    /// ];
    /// let master = MasterCurve::with_law(&law, isotherms)?;
    /// assert!((master.fit_tension()?.0.known_until() / 100.0 / 10f64.powf(1.5) - 1.0).abs() < 1.0e-9);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If there is no isotherm, two have the same temperature, they measure different quantities, or the law does
    /// not hold at the temperature of one.
    pub fn with_law(law: &TimeTemperature, isotherms: Vec<Isotherm>) -> Result<MasterCurve> {
        let isotherms = sorted(isotherms)?;
        let shift = |isotherm: &Isotherm| {
            let vertical = isotherm.experiment.of_modulus(law.vertical_factor(isotherm.temperature)?).ln();
            Ok(Shift { log: law.shift_factor(isotherm.temperature)?.ln(), vertical, ..Shift::default() })
        };
        let shifts = isotherms.iter().map(shift).collect::<Result<_>>()?;
        Ok(MasterCurve { reference: law.reference(), isotherms, shifts })
    }

    /// The reference temperature \[K\].
    pub fn reference(&self) -> f64 {
        self.reference
    }

    /// Temperature \[K\] and shift factor a_T of each isotherm, by temperature: at T all times are a_T times
    /// the times at the reference.
    pub fn shift_factors(&self) -> Vec<(f64, f64)> {
        self.of_each(|shift| shift.log.exp()).collect()
    }

    /// Temperature \[K\] and vertical factor b_T of each isotherm, by temperature: at T all values are b_T times
    /// those at the reference. 1 without vertical shifts.
    pub fn vertical_factors(&self) -> Vec<(f64, f64)> {
        self.of_each(|shift| shift.vertical.exp()).collect()
    }

    /// Temperature \[K\] and standard error of log₁₀ a_T of each isotherm, by temperature; 0 at the reference, and
    /// with a law.
    ///
    /// Neighbours are shifted one after the other, so that errors grow away from the reference. They include shifts
    /// that fit nearly as well, as where a curve is nearly a power law.
    pub fn shift_errors(&self) -> Vec<(f64, f64)> {
        self.of_each(|shift| decades(shift.error)).collect()
    }

    /// Temperatures \[K\] of isotherms that storage and loss moduli would shift differently relative to their
    /// neighbours, by more than their errors explain, and by how many decades: the body is not thermorheologically
    /// simple, or a modulus is disturbed by the machine.
    pub fn disagreements(&self) -> Vec<(f64, f64)> {
        self.of_each(|shift| decades(shift.disagreement)).filter(|(_, decades)| *decades > 0.0).collect()
    }

    fn of_each(&self, value: fn(&Shift) -> f64) -> impl Iterator<Item = (f64, f64)> {
        self.isotherms.iter().zip(&self.shifts).map(move |(isotherm, shift)| (isotherm.temperature, value(shift)))
    }

    /// The law of the shift factors themselves, a [table](TimeTemperature::table), with the vertical factors of the
    /// curve: [`TimeTemperature::at`] gives the fitted body at another temperature.
    ///
    /// # Errors
    /// If there is no temperature besides the reference.
    pub fn shift_table(&self) -> Result<TimeTemperature> {
        self.with_own_vertical(TimeTemperature::table(&self.with_reference(self.shift_factors()), self.reference)?)
    }

    /// Rows of factors with one at the reference, where a known law may have no isotherm.
    fn with_reference(&self, mut rows: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
        let k = rows.partition_point(|(temperature, _)| *temperature < self.reference);
        if rows.get(k).is_none_or(|(temperature, _)| *temperature != self.reference) {
            rows.insert(k, (self.reference, 1.0));
        }
        rows
    }

    /// A law of the shift factors with the vertical factors of the curve, of moduli.
    fn with_own_vertical(&self, law: TimeTemperature) -> Result<TimeTemperature> {
        if self.shifts.iter().all(|shift| shift.vertical == 0.0) {
            return Ok(law);
        }
        let experiment = self.isotherms[0].experiment;
        let of_modulus = |(temperature, factor)| (temperature, experiment.of_modulus(factor));
        let rows = self.vertical_factors().into_iter().map(of_modulus).collect();
        law.with_vertical_factors(&self.with_reference(rows))
    }

    /// The WLF law through the shift factors: least squares in −ΔT/log₁₀ a_T = (C₂ + ΔT)/C₁. It has the vertical
    /// factors of the curve, which end with its isotherms ([`TimeTemperature::extrapolated`]).
    ///
    /// # Errors
    /// If there are fewer than two temperatures besides the reference, or the factors do not follow such a law.
    pub fn wlf(&self) -> Result<TimeTemperature> {
        let points: Vec<(f64, f64)> = self
            .off_reference()
            .map(|(temperature, shift)| (temperature - self.reference, shift / std::f64::consts::LN_10))
            .map(|(dt, log)| (dt, -dt / log))
            .collect();
        least_length("temperatures besides the reference", points.len(), 2)?;
        let count = points.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
        let c1 = 1.0 / slope;
        self.with_own_vertical(TimeTemperature::wlf(c1, (y - slope * x) * c1, self.reference)?)
    }

    /// The Arrhenius law through the shift factors: least squares in ln a_T over 1/T. It has the vertical factors of
    /// the curve, as
    /// [`MasterCurve::wlf`].
    ///
    /// # Errors
    /// If there is no temperature besides the reference, or the factors rise with temperature.
    pub fn arrhenius(&self) -> Result<TimeTemperature> {
        let points: Vec<(f64, f64)> = self
            .off_reference()
            .map(|(temperature, shift)| (1.0 / temperature - 1.0 / self.reference, shift))
            .collect();
        least_length("temperatures besides the reference", points.len(), 1)?;
        let slope = points.iter().map(|(x, y)| x * y).sum::<f64>() / points.iter().map(|(x, _)| x * x).sum::<f64>();
        let energy = slope * crate::rheology::GAS_CONSTANT;
        let allowed = "> 0: shift factors must fall as the temperature rises; check the temperatures of the isotherms";
        within("activation energy of the shift factors", energy, energy > 0.0, allowed)?;
        self.with_own_vertical(TimeTemperature::arrhenius(energy, self.reference)?)
    }

    /// Temperature and ln a_T of every isotherm but that at the reference.
    fn off_reference(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.of_each(|shift| shift.log).filter(|(temperature, _)| *temperature != self.reference)
    }

    /// The points of the curve, with values as at the reference: reduced time \[s\] or angular frequency \[rad/s\],
    /// material function, value; from the lowest temperature to the highest.
    pub fn points(&self) -> Vec<(f64, MaterialFunction, f64)> {
        let functions = self.isotherms[0].experiment.layout().columns.iter().map(|&(_, function)| function);
        let values =
            |row: MeasuredRow| functions.clone().zip(row.values).map(move |(function, value)| (row.x, function, value));
        self.reduced().flat_map(values).collect()
    }

    /// The rows of all isotherms, at reduced times or frequencies.
    fn reduced(&self) -> impl Iterator<Item = MeasuredRow> {
        self.isotherms.iter().zip(&self.shifts).flat_map(|(isotherm, shift)| {
            let factor = if isotherm.experiment.layout().is_over_time { (-shift.log).exp() } else { shift.log.exp() };
            let values = |row: &MeasuredRow| row.values.iter().map(|value| value / shift.vertical.exp()).collect();
            isotherm.rows.iter().map(move |row| MeasuredRow { x: row.x * factor, values: values(row), ..row.clone() })
        })
    }

    /// The body at the reference temperature: all points, fitted as one table.
    ///
    /// Points at the same time are separated by one unit in the last place.
    ///
    /// # Errors
    /// If the curve cannot be fitted ([`Measurements::fit`]).
    pub fn fit(&self) -> Result<CreepSeries> {
        self.fitted(Deformation::Shear)
    }

    /// [`MasterCurve::fit`] of isotherms in tension: the creep of a rod
    /// ([`Measurements::fit_tension`]).
    ///
    /// # Errors
    /// If the curve cannot be fitted.
    pub fn fit_tension(&self) -> Result<Tension<CreepSeries>> {
        self.fitted(Deformation::Tension).map(Tension)
    }

    fn fitted(&self, deformation: Deformation) -> Result<CreepSeries> {
        self.isotherms.iter().try_for_each(|isotherm| isotherm.deformation.accepts(deformation))?;
        let mut rows: Vec<MeasuredRow> = self.reduced().collect();
        rows.sort_by(|a, b| a.x.total_cmp(&b.x));
        for k in 0..rows.len() {
            if k > 0 && rows[k].x <= rows[k - 1].x {
                rows[k].x = rows[k - 1].x.next_up();
            }
            rows[k].place = Place::Entry(k);
        }
        // the greatest that is stated
        let scatter = self.isotherms.iter().filter_map(|isotherm| isotherm.scatter).reduce(f64::max);
        let curve = Measurements::from_rows(self.isotherms[0].experiment, rows)?;
        Measurements { scatter, ..curve }.fitted(deformation)
    }
}

fn decades(logarithm: f64) -> f64 {
    logarithm / std::f64::consts::LN_10
}

/// Sorts isotherms by temperature, and checks that they measure the same quantity.
fn sorted(mut isotherms: Vec<Isotherm>) -> Result<Vec<Isotherm>> {
    least_length("isotherms", isotherms.len(), 1)?;
    isotherms.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
    let first = isotherms[0].experiment;
    if let Some(other) = isotherms.iter().map(|isotherm| isotherm.experiment).find(|other| *other != first) {
        let [first, second] = [first, other].map(|experiment| experiment.layout().table);
        let what = format!("a {first} and a {second} cannot be joined to one master curve");
        let remedy = ": give isotherms of one experiment";
        return Err(Refusal::value("table_mixed_isotherms", what, remedy).into());
    }
    let temperatures = isotherms.iter().map(|isotherm| isotherm.temperature);
    in_order("temperatures of the isotherms", temperatures, "differ", |colder, warmer| colder != warmer)?;
    Ok(isotherms)
}
