//! Measurements at one temperature; several in one text file.

use std::io::Read;

use super::columns::{Columns, Units};
use super::{Experiment, Measurements};
use crate::error::{Result, within};
use crate::input::{Quantity, TextFormat, TextTable, UnitOf, WantedColumn};
use crate::rheology::table::data::{Deformation, MeasuredRow};
use crate::values::Counted;

const TEMPERATURE: WantedColumn = WantedColumn {
    name: "temperature",
    words: &["t", "temperature", "temp"],
    others: &[],
    quantity: Quantity::TEMPERATURE,
    by_unit: true,
};

type Row = (f64, MeasuredRow);

/// Rows of nearly one temperature, in the order of their temperatures, as isotherms: one begins where a frequency, or a
/// time, returns, but for one that is measured twice, at temperatures within 0.1 K. The rows are followed in the order
/// of the file or of the temperatures, whichever needs fewer.
fn sweeps(rows: &[Row], are_times: bool) -> Vec<Vec<Row>> {
    let is_one = |earlier: &Row, row: &Row| match are_times {
        // times may be dense
        true => earlier.1.x == row.1.x,
        false => (earlier.1.x / row.1.x - 1.0).abs() < 1e-3,
    };
    let returns = |sweep: &[Row], row: &Row| {
        let is_twice = |last: &Row| is_one(last, row) && (last.0 - row.0).abs() < 0.1;
        !sweep.last().is_some_and(is_twice) && sweep.iter().any(|earlier| is_one(earlier, row))
    };
    let split = |rows: &[Row]| {
        let mut sweeps: Vec<Vec<Row>> = Vec::new();
        for row in rows {
            match sweeps.last_mut().filter(|sweep| !returns(sweep, row)) {
                Some(sweep) => sweep.push(row.clone()),
                None => sweeps.push(vec![row.clone()]),
            }
        }
        sweeps
    };
    let mut as_written = rows.to_vec();
    as_written.sort_by_key(|row| row.1.place);
    let (by_temperature, by_place) = (split(rows), split(&as_written));
    if by_temperature.len() < by_place.len() { by_temperature } else { by_place }
}

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
    pub(super) temperature: f64,
    pub(super) experiment: Experiment,
    pub(super) deformation: Deformation,
    /// Ascending.
    pub(super) rows: Vec<MeasuredRow>,
    /// The stated scatter of the values.
    pub(super) scatter: Option<f64>,
}

debug_by! {
    self: Isotherm =>
    temperature: self.temperature, experiment: self.experiment, deformation: self.deformation,
    rows: Counted(&self.rows)
}

impl Isotherm {
    /// `measurements` at `temperature` \[K\], without a row at t = 0, which cannot be shifted.
    ///
    /// # Errors
    /// If the temperature is not finite and positive.
    pub fn new(temperature: f64, measurements: Measurements) -> Result<Isotherm> {
        within("temperature", temperature, temperature > 0.0, "finite and > 0 (kelvin)")?;
        let Measurements { experiment, deformation, mut rows, scatter, .. } = measurements;
        rows.retain(|row| row.x > 0.0);
        Ok(Isotherm { temperature, experiment, deformation, rows, scatter })
    }

    /// Temperature \[K\].
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// ln of the range of times; frequencies count as their reciprocals.
    pub(super) fn span(&self) -> [f64; 2] {
        let ends = [&self.rows[0], &self.rows[self.rows.len() - 1]].map(|row| self.log_time(row));
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    pub(super) fn log_time(&self, row: &MeasuredRow) -> f64 {
        if self.experiment.layout().is_over_time { row.x.ln() } else { -row.x.ln() }
    }

    /// Reads isotherms from one text file: the columns of [`Measurements::from_csv`], and one of the temperature in K
    /// or °C.
    ///
    /// Rows belong to one isotherm if their temperatures, in order, are less than 1 K apart, until a time or frequency
    /// returns, as in a temperature ramp at several frequencies; its temperature is their mean.
    ///
    /// ```
    /// use viscocontact::TextFormat;
    /// use viscocontact::rheology::{Experiment, Isotherm, Units};
    ///
    /// let mut text = String::from("f,E_stor,E_loss,T,Set\nHz,MPa,MPa,C,-\n");
    /// for (set, temperature) in [20.0, 40.1].into_iter().enumerate() {
    ///     for k in 0..6 {
    ///         let f = 10f64.powi(k - 2);
    ///         let modulus = 1000.0 * (f * 10f64.powi(-(set as i32))).powf(0.1);
    ///         text += &format!("{f},{modulus},{},{temperature},{set}\n", 0.1 * modulus);
    ///     }
    /// }
    /// let format = TextFormat::default();
    /// let isotherms = Isotherm::from_csv_reader(Experiment::Dynamic, text.as_bytes(), Units::OF_HEADINGS, format)?;
    /// assert_eq!(isotherms.len(), 2);
    /// assert!((isotherms[1].temperature() - 313.25).abs() < 1e-9);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Measurements::from_csv`], and [`Isotherm::new`].
    pub fn from_csv_reader(
        experiment: Experiment,
        reader: impl Read,
        units: Units,
        format: TextFormat,
    ) -> Result<Vec<Isotherm>> {
        Isotherm::from_table(experiment, &TextTable::named(reader, "isotherms", format)?, units)
    }

    /// [`Isotherm::from_csv_reader`] from a table that was read before.
    ///
    /// # Errors
    /// As [`Isotherm::from_csv_reader`].
    pub fn from_table(experiment: Experiment, table: &TextTable, units: Units) -> Result<Vec<Isotherm>> {
        let mut columns = Columns::of(experiment, table, units)?;
        let temperature = table.find(&TEMPERATURE)?.ok_or_else(|| table.missing(&TEMPERATURE, ""))?;
        let zero = match &temperature.unit_of {
            UnitOf::Sizes(unit, _) if unit.to_lowercase().contains('c') => 273.15,
            _ => 0.0,
        };
        let deformation = columns.deformation();
        columns.taken.push(temperature);
        let with_temperature = |mut row: MeasuredRow| (row.values.pop().unwrap_or(f64::NAN) + zero, row);
        let mut rows: Vec<Row> = columns.rows(table)?.into_iter().map(with_temperature).collect();
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let near = rows.chunk_by(|a, b| b.0 - a.0 < 1.0);
        let groups = near.flat_map(|rows| sweeps(rows, experiment.layout().is_over_time));
        let isotherm = |rows: Vec<Row>| {
            let mean = rows.iter().map(|row| row.0).sum::<f64>() / rows.len() as f64;
            let table = Measurements::from_rows(experiment, rows.into_iter().map(|row| row.1).collect())?;
            Isotherm::new(mean, Measurements { deformation, columns: columns.taken.clone(), ..table })
        };
        groups.map(isotherm).collect()
    }
}
