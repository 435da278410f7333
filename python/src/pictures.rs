//! Pictures that the crate draws: maps, profiles, sections, histories and animations.

use numpy::PyArrayMethods;
use viscocontact::plot::{self as vp, Chart, Map, Quantity};

use crate::arrays::cell_values;
use crate::fields::Showing;
use crate::prelude::*;
use crate::stress::QUANTITIES;
use crate::writers::FIELDS;

/// The quantity of an axis; the empty unit is that of a number.
pub fn quantity(name: &str, unit: &str) -> Quantity {
    if unit.is_empty() { name.into() } else { Quantity::new(name, unit) }
}

/// A picture: a notebook shows it, `save` writes it, `pixels` is for matplotlib's `imshow`.
///
/// Contacts, sliding tables and fits draw themselves by `picture`; `map` and `history` draw arrays. Values in SI units get a suitable prefix.
///
/// >>> contact = ViscoelasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), Material(Rheology.elastic(1e6)))
/// >>> _ = contact.step(0.0, Load.force(1.0))
/// >>> pictures = [contact.picture(field) for field in ("pressure", "gap")] + [contact.profile_picture()]
/// >>> Picture.beside(pictures).pixels.shape[2]
/// 3
#[pyclass(frozen, module = "viscocontact")]
pub struct Picture(pub vp::Picture);

#[pymethods]
impl Picture {
    /// A map of an array of the shape of a grid, of a quantity `name` in the SI `unit`; NaN stays blank. `range` are the ends of the colours.
    #[staticmethod]
    #[pyo3(signature = (grid, values, name, unit="", *, title="", range=None))]
    fn map(
        grid: &Grid,
        values: &Object<'_>,
        name: &str,
        unit: &str,
        title: &str,
        range: Option<[f64; 2]>,
    ) -> PyResult<Picture> {
        let values = cell_values("values", values, grid.0.cells())?;
        let mut map = Map::new(&grid.0, values, quantity(name, unit)).or_raise()?;
        map.title = title.to_owned();
        map.range = range.unwrap_or(map.range);
        map.draw().or_raise().map(Picture)
    }

    /// Arrays of one quantity over times [s], by label: `{"measured": force, "fitted": fit.force()[0]}`. `scale` is "linear", "log_x",
    /// "log_y" or "log_log".
    ///
    /// >>> import numpy as np
    /// >>> t = np.geomspace(1e-3, 10.0, 50)
    /// >>> gel = Rheology.generalized_maxwell(1e3, [(4e3, 0.1)])
    /// >>> picture = Picture.history(t, {"gel": gel.relaxation_modulus(t)}, "shear modulus", "Pa", scale="log_x")
    #[staticmethod]
    #[pyo3(signature = (times, values, name, unit="", *, title="", scale="linear"))]
    fn history(
        times: &Object<'_>,
        values: &Dict<'_>,
        name: &str,
        unit: &str,
        title: &str,
        scale: &str,
    ) -> PyResult<Picture> {
        use vp::Scale::{Linear, LogLog, LogX, LogY};
        let scales = [("linear", Linear), ("log_x", LogX), ("log_y", LogY), ("log_log", LogLog)];
        let (times, scale) = (column("times", times)?, choice("scale", scale, &scales)?);
        let columns: Vec<(String, Vec<f64>)> = values
            .iter()
            .map(|(label, values)| Ok((label.extract()?, column("values", &values)?)))
            .collect::<PyResult<_>>()?;
        let columns: Vec<(&str, &[f64])> = columns.iter().map(|(label, values)| (&**label, &**values)).collect();
        let mut chart = Chart::history(title, &times, quantity(name, unit), &columns).or_raise()?;
        chart.scale = scale;
        chart.draw().or_raise().map(Picture)
    }

    /// Pictures side by side, from left to right.
    #[staticmethod]
    fn beside(pictures: Vec<Bound<'_, Picture>>) -> PyResult<Picture> {
        let pictures: Vec<vp::Picture> = pictures.iter().map(|picture| picture.get().0.clone()).collect();
        vp::Picture::beside(&pictures).or_raise().map(Picture)
    }

    /// Writes the picture by the ending of the path, `.png` or `.svg`. An existing file is replaced.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        free(py, || self.0.save(path)).or_raise()
    }

    /// Red, green and blue of each pixel, of shape (height, width, 3) and type uint8.
    #[getter]
    fn pixels<'py>(&self, py: Python<'py>) -> PyResult<Object<'py>> {
        let [width, height] = self.0.size().map(|side| side as usize);
        Ok(self.0.rgb().to_vec().into_pyarray(py).reshape([height, width, 3])?.into_any())
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &free(py, || self.0.to_png()).or_raise()?))
    }

    fn __repr__(&self) -> String {
        let [width, height] = self.0.size();
        format!("Picture({width} × {height} pixels)")
    }
}

/// Pictures of a class that has fields.
macro_rules! drawn {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            /// A map of "pressure", "gap", "displacement" or "traction" with the contact outlined; `range` are the ends of the colours.
            #[pyo3(signature = (field="pressure", *, range=None))]
            fn picture(
                slf: Shared<'_, Self>,
                py: Python<'_>,
                field: &str,
                range: Option<[f64; 2]>,
            ) -> PyResult<Picture> {
                let (field, contact) = (choice("field", field, &FIELDS)?, slf.shown()?);
                let picture = free(py, || {
                    let mut map = Map::of(contact, field)?;
                    map.range = range.unwrap_or(map.range);
                    map.draw()
                });
                picture.or_raise().map(Picture)
            }

            /// The pressure along a line of cells, as of `profile`.
            #[pyo3(signature = (along=0, at=0.0))]
            fn profile_picture(slf: Shared<'_, Self>, along: usize, at: f64) -> PyResult<Picture> {
                Chart::profile(slf.shown()?, axis(along)?, at).and_then(|chart| chart.draw()).or_raise().map(Picture)
            }

            /// A map of the stress below a line of cells, at `depths` [m] in equal steps: "von_mises", "tresca", "mean", "principal_1" or
            /// "principal_3".
            #[pyo3(signature = (depths, quantity="von_mises", *, along=0, at=0.0))]
            fn stress_picture(
                slf: Shared<'_, Self>,
                py: Python<'_>,
                depths: Vec<f64>,
                quantity: &str,
                along: usize,
                at: f64,
            ) -> PyResult<Picture> {
                let (contact, along, of) = (slf.shown()?, axis(along)?, choice("quantity", quantity, &QUANTITIES)?);
                let name = Quantity::new(quantity.replace('_', " "), "Pa");
                let picture = free(py, || {
                    let section = contact.stress()?.on_section(along, at, &depths)?;
                    Map::section(contact, &section, of, name)?.draw()
                });
                picture.or_raise().map(Picture)
            }
        }
    };
}

drawn!(ViscoelasticContact);
drawn!(ElasticContact);
drawn!(Fields);

/// A run as an animated GIF: frames of a "pressure", "gap", "displacement" or "traction", with colours from `range[0]` to `range[1]` in SI
/// units, each shown for `seconds`. `finish`, or the end of a `with` block, gives the file its name.
///
/// >>> import pathlib, tempfile
/// >>> path = pathlib.Path(tempfile.mkdtemp(), "ball.gif")
/// >>> contact = ViscoelasticContact(Grid(16, 4e-3), Shape.sphere(10e-3), Material(Rheology.maxwell(1e6, 1.0)))
/// >>> with Animation(path, "pressure", (0.0, 3e5)) as animation:
/// ...     for report in contact.follow(Load.force(0.5), 0.3, dt=0.1):
/// ...         animation.record(contact)
/// >>> path.exists()
/// True
#[pyclass(module = "viscocontact")]
pub struct Animation(Option<vp::Animation>);

#[pymethods]
impl Animation {
    #[new]
    #[pyo3(signature = (path, field, range, seconds=0.1))]
    fn new(path: PathBuf, field: &str, range: [f64; 2], seconds: f64) -> PyResult<Animation> {
        let field = choice("field", field, &FIELDS)?;
        vp::Animation::create(path, field, range, seconds).or_raise().map(|animation| Animation(Some(animation)))
    }

    /// Appends the state of a contact.
    fn record(mut slf: Taken<'_, Self>, py: Python<'_>, contact: Showing<'_>) -> PyResult<()> {
        let (animation, contact) = (slf.open()?, contact.shown()?);
        free(py, || animation.record(contact)).or_raise()
    }

    /// Appends a picture; all have the same size.
    fn record_picture(mut slf: Taken<'_, Self>, py: Python<'_>, picture: &Picture) -> PyResult<()> {
        let animation = slf.open()?;
        free(py, || animation.record_picture(&picture.0)).or_raise()
    }

    /// Writes the end of the file, and gives it its name.
    fn finish(mut slf: Taken<'_, Self>, py: Python<'_>) -> PyResult<()> {
        let animation = slf.0.take();
        free(py, || animation.map_or(Ok(()), vp::Animation::finish)).or_raise()
    }

    fn __enter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    #[pyo3(signature = (*_raised))]
    fn __exit__(slf: Taken<'_, Self>, py: Python<'_>, _raised: &Bound<'_, pyo3::types::PyTuple>) -> PyResult<()> {
        Self::finish(slf, py)
    }
}

impl Animation {
    fn open(&mut self) -> PyResult<&mut vp::Animation> {
        self.0.as_mut().ok_or_else(|| PyRuntimeError::new_err("the animation is finished"))
    }
}
