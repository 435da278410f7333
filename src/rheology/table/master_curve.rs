use crate::error::{Error, Place, Result, TableError, in_order, least_length, within};
use crate::rheology::table::data::{Deformation, Row};
use crate::rheology::table::{Experiment, Measurements};
use crate::rheology::{CreepSeries, MaterialFunction, TimeTemperature};
use crate::values::Counted;

/// Measurements at one temperature.
///
/// ```
/// use viscocontact::rheology::{Isotherm, Measurements};
///
/// let creep = Measurements::creep(&[(1.0, 1.0e-9), (10.0, 1.1e-9), (100.0, 1.4e-9), (1000.0, 2.0e-9)])?;
/// let at_60 = Isotherm::new(333.15, creep)?;
/// assert_eq!(at_60.temperature(), 333.15);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Isotherm {
    temperature: f64,
    experiment: Experiment,
    deformation: Deformation,
    /// Ascending.
    rows: Vec<Row>,
}

debug_by! {
    self: Isotherm =>
    temperature: self.temperature, experiment: self.experiment, deformation: self.deformation,
    rows: Counted(&self.rows)
}

impl Isotherm {
    /// `measurements` at `temperature` \[K\].
    ///
    /// # Errors
    /// If the temperature is not finite and positive.
    pub fn new(temperature: f64, measurements: Measurements) -> Result<Isotherm> {
        within("temperature", temperature, temperature > 0.0, "finite and > 0 (kelvin)")?;
        let Measurements { experiment, deformation, mut rows, .. } = measurements;
        rows.retain(|row| row.x > 0.0); // a time of zero cannot be shifted
        Ok(Isotherm { temperature, experiment, deformation, rows })
    }

    /// Temperature \[K\].
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// ln of the range of times; frequencies count as their reciprocals.
    fn span(&self) -> [f64; 2] {
        let ends = [&self.rows[0], &self.rows[self.rows.len() - 1]].map(|row| self.log_time(row));
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    fn log_time(&self, row: &Row) -> f64 {
        if self.experiment.layout().zero { row.x.ln() } else { -row.x.ln() }
    }

    /// ln of a column at ln t, linear in between.
    fn at(&self, column: usize, log_time: f64) -> Option<f64> {
        let pair = self.rows.windows(2).find(|pair| {
            let (a, b) = (self.log_time(&pair[0]), self.log_time(&pair[1]));
            (a.min(b)..=a.max(b)).contains(&log_time)
        })?;
        let [a, b] = [&pair[0], &pair[1]].map(|row| (self.log_time(row), row.values[column].ln()));
        Some(a.1 + (log_time - a.0) / (b.0 - a.0) * (b.1 - a.1))
    }
}

/// Isotherms shifted along the axis of time (or frequency) until they form one curve at a reference
/// temperature, which spans more decades than any isotherm (time–temperature superposition).
///
/// The shift of each isotherm relative to its neighbour minimises the mean square difference of the logarithms of the
/// values where the two overlap. There are no vertical shifts.
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
    /// ln a_T of each.
    log_shifts: Vec<f64>,
}

impl MasterCurve {
    /// Finds the shift factors from the data alone. `reference` \[K\] must be the temperature of an isotherm.
    ///
    /// # Errors
    /// If there is no isotherm, two have the same temperature, they measure different quantities, none is at the
    /// reference temperature, or neighbours do not overlap in their values ([`TableError::NoOverlap`]).
    pub fn new(reference: f64, isotherms: Vec<Isotherm>) -> Result<MasterCurve> {
        let isotherms = sorted(isotherms)?;
        let Some(center) = isotherms.iter().position(|isotherm| isotherm.temperature == reference) else {
            let allowed = "the temperature of one of the isotherms";
            return Err(Error::OutOfRange { field: "reference temperature", value: reference, allowed });
        };
        let mut log_shifts = vec![0.0; isotherms.len()];
        for k in center + 1..isotherms.len() {
            log_shifts[k] = log_shifts[k - 1] + shift_between(&isotherms[k - 1], &isotherms[k])?;
        }
        for k in (0..center).rev() {
            log_shifts[k] = log_shifts[k + 1] - shift_between(&isotherms[k], &isotherms[k + 1])?;
        }
        Ok(MasterCurve { reference, isotherms, log_shifts })
    }

    /// Shifts by a known `law`, to its reference temperature.
    ///
    /// # Errors
    /// If there is no isotherm, two have the same temperature, they measure different quantities, or the law does
    /// not hold at the temperature of one.
    pub fn with_law(law: &TimeTemperature, isotherms: Vec<Isotherm>) -> Result<MasterCurve> {
        let isotherms = sorted(isotherms)?;
        let log_shifts =
            isotherms.iter().map(|isotherm| Ok(law.shift_factor(isotherm.temperature)?.ln())).collect::<Result<_>>()?;
        Ok(MasterCurve { reference: law.reference(), isotherms, log_shifts })
    }

    /// The reference temperature \[K\].
    pub fn reference(&self) -> f64 {
        self.reference
    }

    /// Temperature \[K\] and shift factor a_T of each isotherm, by temperature: at T all times are a_T times
    /// the times at the reference.
    pub fn shift_factors(&self) -> Vec<(f64, f64)> {
        let pairs = self.isotherms.iter().zip(&self.log_shifts);
        pairs.map(|(isotherm, shift)| (isotherm.temperature, shift.exp())).collect()
    }

    /// The WLF law through the shift factors: least squares in −ΔT/log₁₀ a_T = (C₂ + ΔT)/C₁.
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
        TimeTemperature::wlf(c1, (y - slope * x) * c1, self.reference)
    }

    /// The Arrhenius law through the shift factors: least squares in ln a_T over 1/T.
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
        TimeTemperature::arrhenius(slope * crate::rheology::GAS_CONSTANT, self.reference)
    }

    /// Temperature and ln a_T of every isotherm but that at the reference.
    fn off_reference(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let pairs = self.isotherms.iter().zip(&self.log_shifts);
        pairs.map(|(isotherm, &shift)| (isotherm.temperature, shift)).filter(|(t, _)| *t != self.reference)
    }

    /// The points of the curve: reduced time \[s\] or angular frequency \[rad/s\], material function, value; from
    /// the lowest temperature to the highest.
    pub fn points(&self) -> Vec<(f64, MaterialFunction, f64)> {
        let functions = self.isotherms[0].experiment.layout().columns.iter().map(|&(_, function)| function);
        let values =
            |row: Row| functions.clone().zip(row.values).map(move |(function, value)| (row.x, function, value));
        self.reduced().flat_map(values).collect()
    }

    /// The rows of all isotherms, at reduced times or frequencies.
    fn reduced(&self) -> impl Iterator<Item = Row> {
        self.isotherms.iter().zip(&self.log_shifts).flat_map(|(isotherm, &shift)| {
            let factor = if isotherm.experiment.layout().zero { (-shift).exp() } else { shift.exp() };
            isotherm.rows.iter().map(move |row| Row { x: row.x * factor, ..row.clone() })
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
    pub fn fit_tension(&self) -> Result<CreepSeries> {
        self.fitted(Deformation::Tension)
    }

    fn fitted(&self, deformation: Deformation) -> Result<CreepSeries> {
        self.isotherms.iter().try_for_each(|isotherm| isotherm.deformation.accepts(deformation))?;
        let mut rows: Vec<Row> = self.reduced().collect();
        rows.sort_by(|a, b| a.x.total_cmp(&b.x));
        for k in 0..rows.len() {
            if k > 0 && rows[k].x <= rows[k - 1].x {
                rows[k].x = rows[k - 1].x.next_up();
            }
            rows[k].place = Place::Entry(k);
        }
        Measurements::from_rows(self.isotherms[0].experiment, rows)?.fitted(deformation)
    }
}

/// Sorts isotherms by temperature, and checks that they measure the same quantity.
fn sorted(mut isotherms: Vec<Isotherm>) -> Result<Vec<Isotherm>> {
    least_length("isotherms", isotherms.len(), 1)?;
    isotherms.sort_by(|a, b| a.temperature.total_cmp(&b.temperature));
    let first = isotherms[0].experiment;
    if let Some(other) = isotherms.iter().map(|isotherm| isotherm.experiment).find(|other| *other != first) {
        return Err(TableError::MixedIsotherms { first: first.layout().table, second: other.layout().table }.into());
    }
    let temperatures = isotherms.iter().map(|isotherm| isotherm.temperature);
    in_order("temperatures of the isotherms", temperatures, "differ", |colder, warmer| colder != warmer)?;
    Ok(isotherms)
}

/// Points at which two isotherms are compared.
const COMPARED: usize = 60;
/// Shifts tried before the best is refined.
const TRIED: usize = 400;
/// Fraction of the shorter isotherm that must overlap.
const LEAST_OVERLAP: f64 = 0.1;

/// ln a of `warmer` relative to `colder`: the shift of least mean square difference where they overlap.
fn shift_between(colder: &Isotherm, warmer: &Isotherm) -> Result<f64> {
    let ([c0, c1], [w0, w1]) = (colder.span(), warmer.span());
    let least = LEAST_OVERLAP * (c1 - c0).min(w1 - w0);
    // warmer at ln t is at ln t − shift on the axis of colder
    let distance = |shift: f64| {
        let (from, to) = ((w0 - shift).max(c0), (w1 - shift).min(c1));
        if to - from < least {
            return f64::INFINITY;
        }
        let columns = colder.experiment.layout().columns.len();
        let mut sum = 0.0;
        for column in 0..columns {
            for k in 0..=COMPARED {
                let at = from + (to - from) * k as f64 / COMPARED as f64;
                let [Some(one), Some(other)] = [colder.at(column, at), warmer.at(column, at + shift)] else { continue };
                sum += (one - other).powi(2);
            }
        }
        sum / (columns * (COMPARED + 1)) as f64
    };
    let (low, high) = (w0 - c1 + least, w1 - c0 - least);
    let step = (high - low) / TRIED as f64;
    let tried = (0..=TRIED).map(|k| low + step * k as f64);
    let best = tried.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0.0);
    // golden section around the best
    let (mut a, mut b) = (best - step, best + step);
    for _ in 0..60 {
        let (x, y) = (b - 0.618_033_988_749_895 * (b - a), a + 0.618_033_988_749_895 * (b - a));
        if distance(x) <= distance(y) { b = y } else { a = x }
    }
    let shift = 0.5 * (a + b);
    let span = |isotherm: &Isotherm| {
        let logs = || isotherm.rows.iter().map(|row| row.values[0].ln());
        logs().fold(f64::NEG_INFINITY, f64::max) - logs().fold(f64::INFINITY, f64::min)
    };
    if span(colder).min(span(warmer)) < 1e-6 {
        return Err(TableError::NothingToShift { temperatures: [colder.temperature, warmer.temperature] }.into());
    }
    // at the least overlap allowed, the values of the two hardly overlap
    let apart = distance(shift).sqrt();
    let at_end = (shift - low).min(high - shift) < step;
    if at_end || apart > 0.2 {
        return Err(TableError::NoOverlap { temperatures: [colder.temperature, warmer.temperature], apart }.into());
    }
    Ok(shift)
}
