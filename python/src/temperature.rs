//! Temperature: how it shifts the time scale of a material, and its history.

use viscocontact::rheology as rh;

use crate::arrays::{number, pairs};
use crate::prelude::*;

made! {
    /// How temperature shifts the time scale: a_T, by which all times of a material are multiplied at a temperature T [K]; and b_T, by which its
    /// moduli are, if the law has vertical factors.
    ///
    /// >>> law = TimeTemperature.wlf(17.44, 51.6, 373.15)
    /// >>> law.shift_factor(373.15)
    /// 1.0
    #[pyclass(frozen, module = "viscocontact")]
    TimeTemperature(pub law: rh::TimeTemperature)
}

makers! {TimeTemperature, py:
    /// The law of Williams, Landel and Ferry: constants C₁, C₂ [K] about the `reference` [K].
    wlf(c1: f64, c2: f64, reference: f64) = rh::TimeTemperature::wlf(c1, c2, reference);

    /// The law of Arrhenius: activation `energy` [J/mol] about the `reference` [K].
    arrhenius(energy: f64, reference: f64) = rh::TimeTemperature::arrhenius(energy, reference);

    /// Rows of temperature [K] and shift factor a_T, about the `reference` [K].
    table(table: Value<'_>, reference: f64) = rh::TimeTemperature::table(&pairs("table", &table)?, reference);
}

#[pymethods]
impl TimeTemperature {
    /// The law of a published material (`published_materials`), None without one.
    #[staticmethod]
    fn published(py: Python<'_>, name: &str) -> PyResult<Option<TimeTemperature>> {
        let Some(law) = rh::library::find(name).or_raise()?.time_temperature() else { return Ok(None) };
        Ok(Some(TimeTemperature::by(Recipe::new(py, "published", (name,))?, law)))
    }

    /// b_T at a temperature [K]: 1 without vertical factors.
    fn vertical_factor(&self, temperature: f64) -> PyResult<f64> {
        self.law.vertical_factor(temperature).or_raise()
    }

    /// a_T at a temperature [K].
    fn shift_factor(&self, temperature: f64) -> PyResult<f64> {
        self.law.shift_factor(temperature).or_raise()
    }

    /// A rheology at a constant temperature [K].
    fn at(slf: Bound<'_, Self>, rheology: Bound<'_, Rheology>, temperature: f64) -> PyResult<Rheology> {
        let body = slf.get().law.at(Arc::clone(&rheology.get().body), temperature).or_raise()?;
        let recipe = Recipe::of::<TimeTemperature>(slf.py(), "at", (slf, rheology, temperature))?;
        Ok(Rheology::by(recipe, body))
    }
}

changes! {TimeTemperature, slf:
    /// The same beyond a table, by the Arrhenius law through its two last rows.
    extrapolated() = sure(slf.get().law.clone().extrapolated());

    /// The same above a `temperature` [K], and below it an Arrhenius law of activation `energy` [J/mol], without a jump.
    with_arrhenius_below(temperature: f64, energy: f64) = slf.get().law.clone().with_arrhenius_below(temperature, energy);

    /// The same with moduli that are b_T times those at the reference: rows of temperature [K] and vertical factor b_T.
    with_vertical_factors(table: Value<'_>) = slf.get().law.clone().with_vertical_factors(&pairs("table", &table)?);

    /// The same with moduli in proportion to the temperature, as of rubbers.
    with_entropic_moduli() = sure(slf.get().law.clone().with_entropic_moduli());

    /// The same with moduli that do not change with temperature, as a `TemperatureHistory` needs.
    without_vertical_factors() = sure(slf.get().law.clone().without_vertical_factors());
}

getters! {TimeTemperature.law, of:
    /// The reference temperature [K].
    reference: f64 = of.reference();
}

made! {
    /// A temperature that changes in time; the material creeps in reduced time.
    ///
    /// Parameters
    /// ----------
    /// law : TimeTemperature
    /// temperature : float, rows of (time [s], temperature [K]), or a function of time
    /// corners : times at which a function of time has corners [s]
    ///
    /// >>> law = TimeTemperature.arrhenius(80e3, 300.0)
    /// >>> warming = TemperatureHistory(law, [(0.0, 300.0), (10.0, 320.0)])
    /// >>> warming.at(5.0), warming.reduced_time(0.0, 10.0) > 10.0      # it creeps faster when warm
    /// (310.0, True)
    #[pyclass(frozen, module = "viscocontact")]
    TemperatureHistory(pub history: rh::TemperatureHistory)
}

#[pymethods]
impl TemperatureHistory {
    #[new]
    #[pyo3(signature = (law, temperature, corners=vec![]))]
    fn new(
        py: Python<'_>,
        law: Bound<'_, TimeTemperature>,
        temperature: Value<'_>,
        corners: Vec<f64>,
    ) -> PyResult<TemperatureHistory> {
        let given = law.get().law.clone();
        let function: Option<Function> = temperature.extract().ok();
        let history = if let Some(constant) = number(&temperature) {
            rh::TemperatureHistory::table(given, &[(0.0, constant)])
        } else if let Some(function) = function.clone() {
            rh::TemperatureHistory::function(given, move |t| raised_number(function.call((t,)), f64::NAN), &corners)
        } else {
            rh::TemperatureHistory::table(given, &pairs("temperature", &temperature)?)
        };
        let recipe =
            Recipe::new(py, "", (law, temperature, corners))?.calling(function.into_iter().collect::<Vec<_>>());
        Ok(TemperatureHistory::by(recipe, history.or_raise()?))
    }

    /// The temperature [K] at times [s].
    fn at<'py>(&self, t: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("t", t, FROM_ZERO, |t| self.history.at(t), never)
    }

    /// The reduced time between two times [s].
    fn reduced_time(&self, start: f64, end: f64) -> PyResult<f64> {
        self.history.reduced_time(start, end).or_raise()
    }
}
