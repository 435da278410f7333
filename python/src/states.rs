//! Elastic states: many materials, histories and temperatures on one surface.

use viscocontact::contact::Settings;
use viscocontact::output::{Metadata, read_states, states_from_bytes, states_to_bytes, write_states};
use viscocontact::run::{Contact, Stepping};
use viscocontact::states as st;
use viscocontact::{self as vc};

use crate::arrays::{check, table};
use crate::held::Led;
use crate::loads::{Tilts, tilts};
use crate::prelude::*;
use crate::run::asked_for;

/// The elastic states of a surface, found once: any material, history and temperature on it is then a matter of microseconds a step.
///
/// Exact wherever contact only grows with the load of the elastic body.
///
/// >>> tip = ElasticStates.sphere(10e-3)
/// >>> round(tip.approach(1.0), 6), round(tip.stiffness(1.0), 6)
/// (3.831547, 0.391487)
#[pyclass(frozen, module = "viscocontact")]
pub struct ElasticStates {
    pub states: Arc<st::ElasticStates>,
    /// None of a sweep and of a file, whose pickles hold the states.
    recipe: Option<Recipe>,
    /// What a sweep is of, which shows the functions of its shape.
    surface: Option<Py<PyAny>>,
}

impl ElasticStates {
    fn by(recipe: Recipe, states: Arc<st::ElasticStates>) -> ElasticStates {
        ElasticStates { states, recipe: Some(recipe), surface: None }
    }
}

impl ElasticStates {
    /// The call that makes these states again.
    fn made(&self, py: Python<'_>) -> PyResult<Recipe> {
        match &self.recipe {
            Some(recipe) => Ok(recipe.again(py)),
            None => {
                let bytes = free(py, || states_to_bytes(&self.states)).or_raise()?;
                Recipe::new(py, "_of_bytes", (PyBytes::new(py, &bytes),))
            }
        }
    }
}

makers! {ElasticStates, py:
    /// A sphere of `radius` [m] (Hertz).
    sphere(radius: f64) = st::ElasticStates::sphere(radius);

    /// A cone whose flank rises by `tan_beta` per unit of radius.
    cone(tan_beta: f64) = st::ElasticStates::cone(tan_beta);

    /// A flat circular punch of `radius` [m].
    punch(radius: f64) = st::ElasticStates::punch(radius);

    /// A body of the shape c rⁿ: `coefficient` c [m^(1−n)], `exponent` n.
    power(coefficient: f64, exponent: f64) = st::ElasticStates::power(coefficient, exponent);

    /// A true sphere of `radius` [m], up to a contact radius of 0.97 of it (Sneddon); `sphere` is its paraboloid.
    true_sphere(radius: f64) = viscocontact_identify::tips::sphere(radius);

    /// States of an upright body from rows (level [m²], approach [m], stiffness over modulus [m], contact area [m²]).
    from_table(rows: Value<'_>) = {
        let table: Vec<_> = table::<4>("rows", &rows)?.into_iter().map(|[a, b, c, d]| (a, b, c, d)).collect();
        st::ElasticStates::from_table(&table)
    };
}

#[pymethods]
impl ElasticStates {
    /// Reads states that `save` has written. They hold no surface, so that `StatesContact.fields` is not possible.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<ElasticStates> {
        Ok(ElasticStates { states: free(py, || read_states(&path)).or_raise()?, recipe: None, surface: None })
    }

    /// The states of a shape on a grid, up to a `level` [m²], an `approach` [m], or what a `material` needs along a `load` to the time
    /// `until`.
    ///
    /// Parameters
    /// ----------
    /// accuracy : float, default 1e-4
    ///     Error of the depth between two states.
    /// kernel : InfluenceKernel, optional
    /// keep_pressures : bool
    ///     Whether `StatesContact.pressure` is possible.
    /// max_states : int, default 4000
    /// at, tilt : pairs
    ///     The tilts of the loads, as of `Load.force`.
    /// temperature : TemperatureHistory, optional
    ///     That of the `material` along the `load`.
    /// progress : function, optional
    ///     Called with the number of states so far; the sweep ends with these where it returns False. Ctrl-C ends it, too.
    /// settings
    ///     Keywords tolerance, max_iterations, edge, symmetry and window of `ViscoelasticContact`.
    ///
    /// >>> rubber = Material(Rheology.zener(1e6, 1e6, 1.0))
    /// >>> states = ElasticStates.sweep(Grid(32, 4e-3), Shape.sphere(10e-3), material=rubber, load=Load.force(1.0), until=10.0)
    /// >>> len(states) > 5
    /// True
    #[staticmethod]
    #[pyo3(
        signature = (grid, geometry, *, level=None, approach=None, material=None, load=None, until=None, kernel=None, accuracy=1e-4, keep_pressures=false, max_states=None, at=None, tilt=None, temperature=None, progress=None, **settings),
        text_signature = "(grid, geometry, *, level=None, approach=None, material=None, load=None, until=None, kernel=None, accuracy=1e-4, keep_pressures=False, max_states=None, at=None, tilt=None, temperature=None, progress=None, **settings)"
    )]
    #[allow(clippy::too_many_arguments)]
    fn sweep(
        py: Python<'_>,
        grid: Bound<'_, Grid>,
        geometry: Object<'_>,
        level: Option<f64>,
        approach: Option<f64>,
        material: Option<Bound<'_, Material>>,
        load: Option<Object<'_>>,
        until: Option<f64>,
        kernel: Option<Bound<'_, InfluenceKernel>>,
        accuracy: f64,
        keep_pressures: bool,
        max_states: Option<Count>,
        at: Tilts,
        tilt: Tilts,
        temperature: Option<Bound<'_, TemperatureHistory>>,
        progress: Option<Function>,
        settings: Option<Dict<'_>>,
    ) -> PyResult<ElasticStates> {
        let reach = match (level, approach, &material, &load, until) {
            (Some(level), None, None, None, None) => st::Reach::Level(level),
            (None, Some(approach), None, None, None) => st::Reach::Approach(approach),
            (None, None, Some(material), Some(load), Some(until)) => {
                let (material, history) = (&material.get().material, history(load)?);
                match &temperature {
                    Some(at) => st::Reach::at_temperature(material, &at.get().history, &*history, until),
                    None => st::Reach::of(material, &*history, until),
                }
                .or_raise()?
            }
            _ => return Err(PyTypeError::new_err("give level, or approach, or material, load and until")),
        };
        let [shape] = &geometries(&grid.get().0, &geometry)?[..] else {
            return Err(PyTypeError::new_err("geometry: a sweep is of one shape"));
        };
        let sweep = st::Sweep::new(grid.get().0.clone(), shape).accuracy(accuracy).tilt(tilts(at, tilt)?);
        let sweep = if_given(sweep, kernel, |sweep, kernel| sweep.kernel(Arc::clone(&kernel.get().kernel)));
        let sweep = if_given(sweep, keep_pressures.then_some(()), |sweep, ()| sweep.keep_pressures());
        let sweep = if_given(sweep, max_states, |sweep, most| sweep.max_states(most.0));
        let base = Settings::default().with_tolerance(1e-8);
        let settings = settings.map(|given| self::settings(base, &given)).transpose()?;
        let sweep = if_given(sweep, settings, st::Sweep::settings);
        let mut listener = Listener::new(progress);
        let states = free(py, || sweep.run_with(reach, |states| listener.goes_on((states.len(),))));
        let states = listener.result(states.or_raise())?;
        Ok(ElasticStates { states, recipe: None, surface: Some(geometry.unbind()) })
    }

    /// Writes the states as an NPZ archive.
    #[pyo3(signature = (path, title=""))]
    fn save(&self, py: Python<'_>, path: PathBuf, title: &str) -> PyResult<()> {
        free(py, || write_states(path, &self.states, &Metadata::new(title))).or_raise()
    }

    /// Approach of the elastic contact [m] at levels [m²].
    fn approach<'py>(&self, level: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("level", level, FROM_ZERO, |level| self.states.approach(level), never)
    }

    /// Level [m²] of the elastic contact at approaches [m]; NaN beyond the last state.
    fn level_at<'py>(&self, approach: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("approach", approach, ALL, |approach| self.states.level_at(approach), never)
    }

    /// Contact area [m²] at levels [m²].
    fn area<'py>(&self, level: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("level", level, FROM_ZERO, |level| self.states.area(level), never)
    }

    /// Stiffness over the contact modulus [m] at levels [m²].
    fn stiffness<'py>(&self, level: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("level", level, FROM_ZERO, |level| self.states.stiffness(level), never)
    }

    /// The states as arrays: "level" [m²], "approach" [m], "stiffness" [m], "area" [m²], "cells", "patches".
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Dict<'py>> {
        let column = |of: fn(&st::ElasticState) -> f64| {
            self.states.states().iter().map(of).collect::<Vec<f64>>().into_pyarray(py)
        };
        Ok(dict! { py;
            "level": column(|state| state.level),
            "approach": column(|state| state.approach),
            "stiffness": column(|state| state.stiffness),
            "area": column(|state| state.area),
            "cells": column(|state| state.cells as f64),
            "patches": column(|state| state.patches as f64),
        })
    }

    /// Conductance of the contact at levels [m²] of two conductors of `resistivities`, electrical [Ω m] in S, or thermal [m K/W] in W/K.
    fn conductance<'py>(&self, level: &Object<'py>, resistivities: [f64; 2]) -> PyResult<Object<'py>> {
        resistivities.into_iter().try_for_each(|of| check("resistivities", of, FROM_ZERO))?;
        mapped("level", level, FROM_ZERO, |level| self.states.conductance(level, resistivities), never)
    }

    /// The curves of many materials on this surface in one call.
    ///
    /// Parameters
    /// ----------
    /// materials : sequence of Material
    /// load : as of `follow`
    /// times : sequence of float
    ///     Ascending times > 0 of the curve [s]; the last one ends it.
    /// tolerance : float, default 1e-4
    ///
    /// Returns an array of shape (materials, times, 3): force [N], approach [m] and contact area [m²].
    ///
    /// >>> rubbers = [Material(Rheology.zener(1e6, 1e6, tau)) for tau in (0.1, 1.0, 10.0)]
    /// >>> ElasticStates.sphere(10e-3).curves(rubbers, Load.force(1.0), [0.1, 1.0, 10.0]).shape
    /// (3, 3, 3)
    #[pyo3(signature = (materials, load, times, *, tolerance=1e-4))]
    fn curves<'py>(
        &self,
        py: Python<'py>,
        materials: Vec<Bound<'py, Material>>,
        load: &Object<'py>,
        times: &Object<'py>,
        tolerance: f64,
    ) -> PyResult<Array<'py>> {
        let (history, times) = (history(load)?, column("times", times)?);
        let until = *times.last().ok_or_else(|| PyTypeError::new_err("times: at least one is needed"))?;
        if !times.is_sorted_by(|one, next| one < next) {
            return Err(PyValueError::new_err("times: they must ascend, each once"));
        }
        let (cancel, mut values) = (Arc::default(), Vec::with_capacity(3 * materials.len() * times.len()));
        for material in &materials {
            let material = &material.get().material;
            let rows = interruptible(py, true, &cancel, || -> vc::Result<Vec<[f64; 4]>> {
                let contact = st::StatesContact::new(&self.states, material)?;
                let run = contact.into_follow(Arc::clone(&history), Stepping::adaptive(tolerance), until);
                let mut run = run.cancelled_by(Arc::clone(&cancel)).sample_at(&times)?;
                let mut rows = Vec::with_capacity(times.len());
                while run.next_step()?.is_some() {
                    rows.extend(asked_for(&run, |sample| sample.contact().state())?);
                }
                Ok(rows)
            })?;
            one_for_each("of the times, which must lie after 0", "states", rows.len(), times.len())?;
            values.extend(rows.iter().flat_map(|row| &row[1..]));
        }
        to_array(py, values, &[materials.len(), times.len(), 3])
    }

    fn __len__(&self) -> usize {
        self.states.states().len()
    }

    fn __repr__(&self) -> String {
        format!("ElasticStates({} states)", self.states.states().len())
    }

    /// The states of a pickle.
    #[staticmethod]
    fn _of_bytes(bytes: &Bound<'_, PyBytes>) -> PyResult<ElasticStates> {
        Ok(ElasticStates { states: states_from_bytes(bytes.as_bytes()).or_raise()?, recipe: None, surface: None })
    }

    /// A sweep becomes its states, without the surface: `StatesContact.fields` is then not possible.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        slf.get().made(slf.py())?.reduce(slf.get_type())
    }

    fn __eq__(slf: &Bound<'_, Self>, other: &Bound<'_, ElasticStates>) -> PyResult<bool> {
        let key = slf.get().made(slf.py())?.key(slf.get_type())?;
        key.eq(other.get().made(slf.py())?.key(slf.get_type())?)
    }

    fn __hash__(&self) -> usize {
        self.states.states().len()
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        self.recipe.iter().try_for_each(|recipe| recipe.traverse(&visit))?;
        visit.call(&self.surface)
    }
}

getters! {ElasticStates.states, of:
    /// The grid of the sweep; None if there was none.
    grid: Option<Grid> = of.grid().cloned().map(Grid);
    /// The level from which contact only grows with the load [m²]: contacts of lower levels are refused.
    first_level: f64 = of.first_level();
    /// Poisson's ratio of the layer that was swept, which materials need to have; None of other bodies.
    nu: Option<f64> = of.poisson_ratio();
    /// Maximum error of the depth between two states, relative.
    interpolation_error: f64 = of.interpolation_error();
}
