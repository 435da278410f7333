//! Measured creep, relaxation and dynamic moduli; temperature.

use std::collections::BTreeMap;
use std::path::Path;

use viscocontact::input::{Delimiter, TextFormat, TextTable};
use viscocontact::rheology::{self as rh, Experiment, Units};

use crate::errors::unreadable;
use crate::materials::Tension;
use crate::prelude::*;

/// Temperatures that differ by less, relative, are the same.
const SAME_TEMPERATURE: f64 = 1e-9;

const EXPERIMENTS: [(&str, Experiment); 4] = [
    ("creep", Experiment::Creep),
    ("relaxation", Experiment::Relaxation),
    ("dynamic", Experiment::Dynamic),
    ("storage", Experiment::Storage),
];

made! {
    /// A table of measured creep, relaxation or dynamic moduli; `fit` makes a `Rheology` of it.
    ///
    /// >>> t = [0.1, 0.3, 1.0, 3.0, 10.0, 100.0]
    /// >>> creep = Measurements.creep(t, [1.05e-6, 1.14e-6, 1.39e-6, 1.78e-6, 1.99e-6, 2.00e-6])
    /// >>> body = creep.fit()
    /// >>> abs(body.creep_compliance(5.0) / 1.92e-6 - 1) < 1e-2
    /// True
    #[pyclass(frozen, module = "viscocontact")]
    Measurements(measurements: rh::Measurements)
}

impl Measurements {
    /// The table of a file of this text.
    fn read<'py>(
        experiment: &str,
        (path, text): (PathBuf, Bound<'py, PyBytes>),
        units: Option<Object<'py>>,
        reading: Option<Dict<'py>>,
    ) -> PyResult<Measurements> {
        let py = text.py();
        let kind = choice("experiment", experiment, &EXPERIMENTS)?;
        let (table, of_file, keywords) = again(&path, &text, units, reading)?;
        let measurements = free(py, || rh::Measurements::from_table(kind, &table, of_file)).or_raise()?;
        let recipe = Recipe::new(py, "_of_bytes", (experiment, text))?.with_keywords(Some(&keywords))?;
        Ok(Measurements::by(recipe, measurements))
    }
}

makers! {Measurements, py:
    /// Creep: times ≥ 0 [s] and compliances [1/Pa], in any order.
    creep(times: Value<'_>, compliances: Value<'_>) =
        rh::Measurements::creep(&together(["times", "compliances"], &times, &compliances)?);

    /// Relaxation: times ≥ 0 [s] and moduli [Pa], in any order.
    relaxation(times: Value<'_>, moduli: Value<'_>) =
        rh::Measurements::relaxation(&together(["times", "moduli"], &times, &moduli)?);

    /// Storage moduli alone: angular frequencies [rad/s] and moduli [Pa], in any order.
    storage(omega: Value<'_>, storage: Value<'_>) =
        rh::Measurements::storage(&together(["omega", "storage"], &omega, &storage)?);

    /// Dynamic moduli: angular frequencies [rad/s], storage and loss moduli [Pa], in any order.
    dynamic(omega: Value<'_>, storage: Value<'_>, loss: Value<'_>) = {
        let first = together(["omega", "storage"], &omega, &storage)?;
        let second = together(["omega", "loss"], &omega, &loss)?;
        let rows = first.into_iter().zip(second).map(|((x, storage), (_, loss))| (x, storage, loss));
        rh::Measurements::dynamic(&rows.collect::<Vec<_>>())
    };
}

#[pymethods]
impl Measurements {
    /// Reads a text file of an `experiment` ("creep", "relaxation", "dynamic" or "storage").
    ///
    /// Numbers are in SI units, which headings must agree with; `units="headings"` takes the units that each heading names, and
    /// `units=(abscissa, value)` their sizes in SI. What is not to be found out is stated: `decimal_comma` (bool), `delimiter` ("comma",
    /// "semicolon", "tab" or "blanks"), `skipped_lines`, `headings` (a dict from the column, counted from 0, to `"G [kPa]"`; an empty one
    /// takes the column out of the choice), and the headings to choose from (`only`).
    ///
    /// Raises OSError if the file cannot be read, ValueError if its table is not allowed, with the line.
    #[staticmethod]
    #[pyo3(
        signature = (experiment, path, *, units=None, **reading),
        text_signature = "(experiment, path, *, units=None, decimal_comma=None, delimiter=None, skipped_lines=0, headings=None, only=None)"
    )]
    fn from_csv(
        py: Python<'_>,
        experiment: &str,
        path: PathBuf,
        units: Option<Object<'_>>,
        reading: Option<Dict<'_>>,
    ) -> PyResult<Measurements> {
        // made again from what the file has now
        let text = PyBytes::new(py, &std::fs::read(&path).map_err(unreadable(&path))?);
        Measurements::read(experiment, (path, text), units, reading)
    }

    /// The table of a pickle.
    #[staticmethod]
    #[pyo3(signature = (experiment, text, *, units, **reading))]
    fn _of_bytes(
        experiment: &str,
        text: Bound<'_, PyBytes>,
        units: Option<Object<'_>>,
        reading: Option<Dict<'_>>,
    ) -> PyResult<Measurements> {
        Measurements::read(experiment, (OF_PICKLE.into(), text), units, reading)
    }

    /// The body of the table, fitted by an exponential series. `extrapolated` lets it go on beyond the last time.
    ///
    /// Raises ConvergenceError if no series fits.
    #[pyo3(signature = (extrapolated=false))]
    fn fit(slf: Bound<'_, Self>, extrapolated: bool) -> PyResult<Rheology> {
        let (py, measurements) = (slf.py(), &slf.get().measurements);
        let series = free(py, || measurements.fit()).or_raise()?;
        Ok(series_of(Recipe::of::<Measurements>(py, "fit", (slf.clone(), extrapolated))?, series, extrapolated))
    }

    /// `fit` of a table measured in tension.
    #[pyo3(signature = (extrapolated=false))]
    fn fit_tension(slf: Bound<'_, Self>, extrapolated: bool) -> PyResult<Tension> {
        Tension::new(Bound::new(slf.py(), Measurements::_rod(slf.clone(), extrapolated)?)?)
    }

    /// The creep of the rod, for pickle.
    fn _rod(slf: Bound<'_, Self>, extrapolated: bool) -> PyResult<Rheology> {
        let (py, measurements) = (slf.py(), &slf.get().measurements);
        let series = free(py, || measurements.fit_tension()).or_raise()?.0;
        Ok(series_of(Recipe::of::<Measurements>(py, "_rod", (slf.clone(), extrapolated))?, series, extrapolated))
    }
}

changes! {Measurements, slf:
    /// The same with the relative standard deviation of the values stated.
    with_scatter(scatter: f64) = slf.get().measurements.clone().with_scatter(scatter);
}

fn series_of(recipe: Recipe, series: rh::CreepSeries, extrapolated: bool) -> Rheology {
    Rheology::by(recipe, if extrapolated { series.extrapolated() } else { series })
}

/// The table of a text, its units, and the keywords that read it again.
fn again<'py>(
    path: &Path,
    text: &Bound<'py, PyBytes>,
    units: Option<Object<'py>>,
    reading: Option<Dict<'py>>,
) -> PyResult<(TextTable, Units, Dict<'py>)> {
    let table = text_table(path, Some(text.as_bytes()), reading.as_ref())?;
    let (of_file, keywords) = (of_units(units.as_ref())?, dict! { text.py(); "units": units });
    reading.map_or(Ok(()), |reading| keywords.update(reading.as_mapping()))?;
    Ok((table, of_file, keywords))
}

/// A text file, read as keywords say: `decimal_comma`, `delimiter`, `skipped_lines`, `headings` by column, and `only` some of them.
pub fn text_table(path: &Path, text: Option<&[u8]>, reading: Option<&Dict<'_>>) -> PyResult<TextTable> {
    use Delimiter::{Blanks, Comma, Semicolon, Tab};
    let delimiters = [("comma", Comma), ("semicolon", Semicolon), ("tab", Tab), ("blanks", Blanks)];
    let (mut format, mut headings, mut only) = (TextFormat::default(), BTreeMap::<usize, String>::new(), None);
    for (name, value) in reading.into_iter().flatten() {
        match name.extract::<&str>()? {
            _ if value.is_none() => {}
            "decimal_comma" => format = format.with_decimal_comma(value.extract()?),
            "delimiter" => format = format.with_delimiter(choice("delimiter", value.extract()?, &delimiters)?),
            "skipped_lines" => format = format.with_skipped_lines(value.extract::<Count>()?.0 as u64),
            "headings" => headings = value.extract()?,
            "only" => only = Some(value.extract::<Vec<String>>()?),
            name => return Err(unexpected("from_csv", name, "decimal_comma delimiter skipped_lines headings only")),
        }
    }
    let mut table = match text {
        Some(text) => TextTable::read(text, format),
        None => TextTable::open(path, format),
    }
    .or_raise()?;
    for (column, heading) in headings {
        table = table.with_heading(column + 1, &heading).or_raise()?;
    }
    if let Some(only) = only {
        table = table.only(&only.iter().map(String::as_str).collect::<Vec<_>>()).or_raise()?;
    }
    Ok(table)
}

fn of_units(units: Option<&Object<'_>>) -> PyResult<Units> {
    match units {
        None => Ok(Units::SI),
        Some(units) if units.extract::<&str>().is_ok_and(|text| text == "headings") => Ok(Units::OF_HEADINGS),
        Some(units) => {
            let (abscissa, value) =
                units.extract().map_err(|_| PyTypeError::new_err("units: \"headings\" or (abscissa, value)"))?;
            Units::new(abscissa, value).or_raise()
        }
    }
}

made! {
    /// Measurements at several temperatures, shifted along the axis of time (or frequency) to one curve.
    ///
    /// Parameters
    /// ----------
    /// reference : float
    ///     The temperature of the curve [K].
    /// isotherms : sequence of (temperature [K], Measurements)
    /// law : TimeTemperature, optional
    ///     A known law of the same reference, without `vertical_shifts`; else the shifts are found from the data.
    /// vertical_shifts : bool
    ///     Whether the values may be shifted too.
    ///
    /// >>> import numpy as np
    /// >>> t = np.geomspace(1e-1, 1e1, 9)
    /// >>> creep = lambda shift: Measurements.creep(t, 1e-6 * (1 + (t / shift) ** 0.3))
    /// >>> curve = MasterCurve(300.0, [(300.0, creep(1.0)), (310.0, creep(0.1))])
    /// >>> [round(shift, 2) for temperature, shift, error in curve.shift_factors]
    /// [1.0, 0.1]
    #[pyclass(frozen, module = "viscocontact")]
    MasterCurve(curve: rh::MasterCurve)
}

#[pymethods]
impl MasterCurve {
    #[new]
    #[pyo3(signature = (reference, isotherms, *, law=None, vertical_shifts=false))]
    fn new(
        py: Python<'_>,
        reference: f64,
        isotherms: Vec<(f64, Bound<'_, Measurements>)>,
        law: Option<Bound<'_, TimeTemperature>>,
        vertical_shifts: bool,
    ) -> PyResult<MasterCurve> {
        let isotherm = |(temperature, measured): &(f64, Bound<'_, Measurements>)| {
            rh::Isotherm::new(*temperature, measured.get().measurements.clone())
        };
        let measured = isotherms.iter().map(isotherm).collect::<viscocontact::Result<Vec<_>>>().or_raise()?;
        let known = law.as_ref().map(|law| &law.get().law);
        if let Some(own) = known.map(rh::TimeTemperature::reference) {
            if (reference - own).abs() > SAME_TEMPERATURE * own {
                return Err(PyValueError::new_err(format!(
                    "reference = {reference} K is not that of the law, {own} K: give law.reference, and move the fitted body by law.at(body, {reference})"
                )));
            }
            if vertical_shifts {
                return Err(PyTypeError::new_err(
                    "give law or vertical_shifts: a known law has vertical factors of its own",
                ));
            }
        }
        let curve = free(py, || match known {
            Some(law) => rh::MasterCurve::with_law(law, measured),
            None => shifted(reference, measured, vertical_shifts),
        });
        let keywords = dict! { py; "law": law, "vertical_shifts": vertical_shifts };
        let recipe = Recipe::new(py, "", (reference, isotherms))?.with_keywords(Some(&keywords))?;
        Ok(MasterCurve::by(recipe, curve.or_raise()?))
    }

    /// The curve of a text file with a column of the temperature in K or °C, read as by `Measurements.from_csv`.
    #[staticmethod]
    #[pyo3(
        signature = (experiment, path, reference, *, units=None, vertical_shifts=false, **reading),
        text_signature = "(experiment, path, reference, *, units=None, vertical_shifts=False, decimal_comma=None, delimiter=None, skipped_lines=0, headings=None, only=None)"
    )]
    fn from_csv(
        py: Python<'_>,
        experiment: &str,
        path: PathBuf,
        reference: f64,
        units: Option<Object<'_>>,
        vertical_shifts: bool,
        reading: Option<Dict<'_>>,
    ) -> PyResult<MasterCurve> {
        let text = PyBytes::new(py, &std::fs::read(&path).map_err(unreadable(&path))?);
        MasterCurve::read(experiment, (path, text), reference, units, vertical_shifts, reading)
    }

    /// The curve of a pickle.
    #[staticmethod]
    #[pyo3(signature = (experiment, text, reference, *, units, vertical_shifts, **reading))]
    fn _of_bytes(
        experiment: &str,
        text: Bound<'_, PyBytes>,
        reference: f64,
        units: Option<Object<'_>>,
        vertical_shifts: bool,
        reading: Option<Dict<'_>>,
    ) -> PyResult<MasterCurve> {
        MasterCurve::read(experiment, (OF_PICKLE.into(), text), reference, units, vertical_shifts, reading)
    }

    /// Temperature [K], shift factor a_T and standard error of log₁₀ a_T of each isotherm.
    #[getter]
    fn shift_factors(&self) -> Vec<(f64, f64, f64)> {
        let pairs = self.curve.shift_factors().into_iter().zip(self.curve.shift_errors());
        pairs.map(|((temperature, factor), (_, error))| (temperature, factor, error)).collect()
    }

    /// The WLF law through the shift factors: constants C₁, C₂ [K] and reference [K] of a `TimeTemperature`. It has the vertical factors
    /// of the curve.
    fn wlf(&self, py: Python<'_>) -> PyResult<TimeTemperature> {
        let law = self.curve.wlf().or_raise()?;
        let [c1, c2] = law.wlf_constants().unwrap_or([f64::NAN; 2]);
        self.with_vertical(py, &law, TimeTemperature::wlf(py, c1, c2, law.reference())?)
    }

    /// The Arrhenius law through the shift factors. It has the vertical factors of the curve.
    fn arrhenius(&self, py: Python<'_>) -> PyResult<TimeTemperature> {
        let law = self.curve.arrhenius().or_raise()?;
        let energy = law.activation_energy().unwrap_or(f64::NAN);
        self.with_vertical(py, &law, TimeTemperature::arrhenius(py, energy, law.reference())?)
    }

    /// The law of the shift factors themselves, a table, with the vertical factors of the curve.
    fn shift_table(&self, py: Python<'_>) -> PyResult<TimeTemperature> {
        let law = self.curve.shift_table().or_raise()?;
        let table = self.with_reference(self.curve.shift_factors(), law.reference()).into_pyobject(py)?;
        self.with_vertical(py, &law, TimeTemperature::table(py, Value(table.into_any()), law.reference())?)
    }

    /// The body at the reference temperature.
    #[pyo3(signature = (extrapolated=false))]
    fn fit(slf: Bound<'_, Self>, extrapolated: bool) -> PyResult<Rheology> {
        let (py, curve) = (slf.py(), &slf.get().curve);
        let series = free(py, || curve.fit()).or_raise()?;
        Ok(series_of(Recipe::of::<MasterCurve>(py, "fit", (slf.clone(), extrapolated))?, series, extrapolated))
    }

    /// The points of the curve: reduced times [s] or angular frequencies [rad/s] and values, by function.
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Dict<'py>> {
        let all = PyDict::new(py);
        for (x, function, value) in self.curve.points() {
            let name = format!("{function:?}").to_lowercase();
            let rows = match all.get_item(&name)? {
                Some(rows) => rows.cast_into::<pyo3::types::PyList>()?,
                None => {
                    let rows = pyo3::types::PyList::empty(py);
                    all.set_item(&name, &rows)?;
                    rows
                }
            };
            rows.append((x, value))?;
        }
        Ok(all)
    }
}

/// The name of a file that is read again from a pickle.
const OF_PICKLE: &str = "text of a pickle";

/// A curve of shifts that are found from the data.
fn shifted(reference: f64, isotherms: Vec<rh::Isotherm>, vertical: bool) -> viscocontact::Result<rh::MasterCurve> {
    let make = if vertical { rh::MasterCurve::with_vertical_shifts } else { rh::MasterCurve::new };
    make(reference, isotherms)
}

impl MasterCurve {
    /// The curve of a file of this text.
    fn read<'py>(
        experiment: &str,
        (path, text): (PathBuf, Bound<'py, PyBytes>),
        reference: f64,
        units: Option<Object<'py>>,
        vertical_shifts: bool,
        reading: Option<Dict<'py>>,
    ) -> PyResult<MasterCurve> {
        let py = text.py();
        let kind = choice("experiment", experiment, &EXPERIMENTS)?;
        let (table, of_file, keywords) = again(&path, &text, units, reading)?;
        let isotherms = || rh::Isotherm::from_table(kind, &table, of_file);
        let curve = free(py, || shifted(reference, isotherms()?, vertical_shifts)).or_raise()?;
        keywords.set_item("vertical_shifts", vertical_shifts)?;
        let recipe = Recipe::new(py, "_of_bytes", (experiment, text, reference))?.with_keywords(Some(&keywords))?;
        Ok(MasterCurve::by(recipe, curve))
    }

    /// Rows of factors with one at the reference, where a known law may have no isotherm.
    fn with_reference(&self, mut rows: Vec<(f64, f64)>, reference: f64) -> Vec<(f64, f64)> {
        let k = rows.partition_point(|(temperature, _)| *temperature < reference);
        if rows.get(k).is_none_or(|(temperature, _)| *temperature != reference) {
            rows.insert(k, (reference, 1.0));
        }
        rows
    }

    /// A law that was `made` anew, with the vertical factors of the `law` of the curve.
    fn with_vertical(
        &self,
        py: Python<'_>,
        law: &rh::TimeTemperature,
        made: TimeTemperature,
    ) -> PyResult<TimeTemperature> {
        if !law.has_vertical_factors() {
            return Ok(made);
        }
        let row = |(temperature, _)| Ok((temperature, law.vertical_factor(temperature)?));
        let rows =
            self.curve.shift_factors().into_iter().map(row).collect::<viscocontact::Result<Vec<_>>>().or_raise()?;
        let rows = self.with_reference(rows, law.reference());
        TimeTemperature::with_vertical_factors(Bound::new(py, made)?, Value(rows.into_pyobject(py)?))
    }
}

getters! {MasterCurve.curve, of:
    /// Temperature [K] and vertical factor of each isotherm.
    vertical_factors: Vec<(f64, f64)> = of.vertical_factors();
    /// Temperature [K] of each isotherm, and how far it is off its neighbours where they overlap, relative.
    disagreements: Vec<(f64, f64)> = of.disagreements();
}
