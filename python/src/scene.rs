//! The parts of a contact, by keyword.

use viscocontact::contact::{Builder, Edge, Frame, Settings, TimeRule};
use viscocontact::{self as vc, ViscoelasticContact};

use crate::attraction::Attraction;
use crate::prelude::*;

/// Changes a setting if it is one of the keyword `name`.
fn setting(settings: Settings, name: &str, value: &Object<'_>) -> PyResult<Option<Settings>> {
    let text = || value.extract::<String>();
    Ok(Some(match name {
        "tolerance" => settings.with_tolerance(value.extract()?),
        "max_iterations" => settings.with_max_iterations(value.extract::<Count>()?.0),
        "series_tolerance" => settings.with_series_tolerance(value.extract()?),
        "symmetry" => settings.with_symmetry(value.extract()?),
        "window" => settings.with_window(value.extract()?),
        "time_rule" => {
            let rules = [("exponential", TimeRule::Exponential), ("exponential_linear", TimeRule::ExponentialLinear)];
            settings.with_time_rule(choice(name, &text()?, &rules)?)
        }
        "edge" => settings.with_edge(choice(name, &text()?, &[("refuse", Edge::Refuse), ("allow", Edge::Allow)])?),
        "frame" => {
            settings.with_frame(choice(name, &text()?, &[("bodies", Frame::Bodies), ("indenter", Frame::Indenter)])?)
        }
        _ => return Ok(None),
    }))
}

/// The settings of keywords of a contact that does not creep, each of which must be one.
pub fn settings(base: Settings, given: &Dict<'_>) -> PyResult<Settings> {
    given.iter().try_fold(base, |settings, (name, value)| {
        let name: String = name.extract()?;
        let unknown = || unexpected("the contact problem", &name, ELASTIC);
        if !ELASTIC.split_whitespace().any(|known| known == name) {
            return Err(unknown());
        }
        setting(settings, &name, &value).map_err(|error| noted(error, &name, &value))?.ok_or_else(unknown)
    })
}

/// An error of the value of a keyword, with its name, as errors of other arguments have it.
fn noted(error: PyErr, name: &str, value: &Object<'_>) -> PyErr {
    // Python 3.10 has no notes
    let _ = error.value(value.py()).call_method1("add_note", (format!("while processing '{name}'"),));
    error
}

/// The keywords of a contact.
const OPTIONS: &str = "counter_body kernel attraction temperature times tolerance max_iterations time_rule edge series_tolerance \
    symmetry window frame";

/// Those of a contact that does not creep.
const ELASTIC: &str = "tolerance max_iterations edge symmetry window";

/// The error of a keyword that `of` does not have: with the nearest one.
pub fn unexpected(of: &str, name: &str, known: &str) -> PyErr {
    let nearest = Python::attach(|py| {
        py.import("difflib")?
            .call_method1("get_close_matches", (name, known.split_whitespace().collect::<Vec<_>>(), 1))?
            .extract::<Vec<String>>()
    });
    let hint = nearest.ok().and_then(|names| names.first().map(|name| format!(": did you mean '{name}'?")));
    PyTypeError::new_err(format!("{of}() got an unexpected keyword argument '{name}'{}", hint.unwrap_or_default()))
}

/// A builder of the parts: of the required ones, and of `options` by the names of the crate. A value of None is the default.
pub fn builder(
    grid: &Grid,
    geometry: &Object<'_>,
    material: &Material,
    options: Option<&Dict<'_>>,
) -> PyResult<Builder> {
    let shapes = geometries(&grid.0, geometry)?;
    let [first, others @ ..] = &shapes[..] else {
        return Err(PyTypeError::new_err("geometry: at least one shape is needed"));
    };
    // the gap of a function in Python is evaluated here, with the GIL
    let mut builder = ViscoelasticContact::builder(grid.0.clone()).geometry(first).material(material.material.clone());
    for shape in others {
        builder = builder.another_body(shape);
    }
    let mut changed = Settings::default();
    for (name, value) in options.into_iter().flatten() {
        let name: String = name.extract()?;
        if value.is_none() {
            continue;
        }
        let given = (builder, &mut changed);
        builder = with_option(given, &name, &value).map_err(|error| noted(error, &name, &value))?;
    }
    Ok(builder.settings(changed))
}

/// A builder and its settings with what one keyword says.
fn with_option((builder, changed): (Builder, &mut Settings), name: &str, value: &Object<'_>) -> PyResult<Builder> {
    if let Some(settings) = setting(*changed, name, value)? {
        *changed = settings;
        return Ok(builder);
    }
    Ok(match name {
        "counter_body" => builder.counter_body(value.cast::<Material>()?.get().material.clone()),
        "kernel" => builder.kernel(value.cast::<InfluenceKernel>()?.get().kernel.clone()),
        "attraction" => builder.attraction(value.cast::<Attraction>()?.get().law.clone()),
        "temperature" => builder.temperature(value.cast::<TemperatureHistory>()?.get().history.clone()),
        "times" => {
            let (first, last): (Object<'_>, f64) = value.extract()?;
            match first.extract::<f64>() {
                Ok(first) if first.is_nan() || first >= last => {
                    let text =
                        format!("times = ({first}, {last}) is not allowed: the first must be less than the last");
                    return Err(PyValueError::new_err(text));
                }
                Ok(first) => builder.times(first..=last),
                Err(_) => builder.times_of(&*history(&first)?, last),
            }
        }
        _ => return Err(unexpected("a contact", name, OPTIONS)),
    })
}

/// Bytes that a contact takes, before it is built.
///
/// Takes the arguments of `ViscoelasticContact`.
///
/// >>> need = memory(Grid(256, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> need["total"] > need["state"] > 0
/// True
#[pyfunction]
#[pyo3(signature = (grid, geometry, material, **options))]
pub fn memory<'py>(
    py: Python<'py>,
    grid: &Grid,
    geometry: &Object<'py>,
    material: &Material,
    options: Option<&Dict<'py>>,
) -> PyResult<Dict<'py>> {
    let memory: vc::contact::Memory = builder(grid, geometry, material, options)?.memory().or_raise()?;
    Ok(dict! { py; memory { computed_cells, grid, state, history, solver, kernel }, "total": memory.total() })
}
