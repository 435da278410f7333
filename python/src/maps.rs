//! Measured and generated surfaces.

use std::fs::File;

use viscocontact::TextFormat;
use viscocontact::geometry::{self as geo, Anisotropy, Form, LengthUnit, RoughSpec, Roughness};

use crate::arrays::{measured_points, plane};
use crate::errors::{replace, unreadable};
use crate::prelude::*;

/// Heights of a surface on a regular grid of points, measured or computed; a `Shape`.
///
/// Parameters
/// ----------
/// heights : array of shape (n1, n2)
///     Heights [m], positive out of the material, x1 along the first axis; NaN where none was measured. A gap of the pair is the
///     maximum height minus each height.
/// lengths : float or (float, float)
///     Sides of the rectangle of all points [m], a whole cell for each point.
/// periodic : bool
///     Whether the map repeats, with `lengths` as its periods.
///
/// Missing heights must be decided before a contact: `filled()` interpolates them, `masked()` leaves nothing to touch there.
/// Raises ValueError if a height is infinite, or none is known.
///
/// >>> import numpy as np
/// >>> map = HeightMap(np.random.default_rng(0).normal(size=(32, 32)) * 1e-6, 1e-3, periodic=True)
/// >>> map.shape, map.missing
/// ((32, 32), 0)
/// >>> level = map.leveled("tilt")
#[pyclass(frozen, extends = Shape, module = "viscocontact")]
pub struct HeightMap(Arc<geo::HeightMap>);

impl HeightMap {
    /// Refuses a map of which nothing is known.
    fn known(map: geo::HeightMap) -> PyResult<Arc<geo::HeightMap>> {
        let [n1, n2] = map.cells();
        if map.missing() < n1 * n2 { Ok(Arc::new(map)) } else { Err(PyValueError::new_err("heights: none is known")) }
    }

    /// A map that is made again from its heights, whatever its file was.
    fn made(py: Python<'_>, map: geo::HeightMap) -> PyResult<Py<HeightMap>> {
        Py::new(py, HeightMap::parts(py, map)?)
    }

    fn parts(py: Python<'_>, map: geo::HeightMap) -> PyResult<PyClassInitializer<HeightMap>> {
        let map = HeightMap::known(map)?;
        let center = map.center();
        let shape = if center == [0.0; 2] {
            let heights = to_array(py, map.heights().to_vec(), &map.cells())?;
            Shape::made(py, "", (heights, map.lengths(), map.is_periodic()), Arc::clone(&map) as _)?
        } else {
            let centered = HeightMap::made(py, (*map).clone().centered_at([0.0; 2]).or_raise()?)?;
            Shape::made(py, "centered_at", (centered, center), Arc::clone(&map) as _)?
        };
        Ok(PyClassInitializer::from(shape).add_subclass(HeightMap(map)))
    }

    /// What the method `maker` makes of a map.
    fn changed<'py>(
        slf: &Bound<'py, Self>,
        maker: &'static str,
        arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
        change: impl FnOnce(geo::HeightMap) -> viscocontact::Result<geo::HeightMap> + Send,
    ) -> PyResult<Py<HeightMap>> {
        let (py, map) = (slf.py(), (*slf.get().0).clone());
        let map = HeightMap::known(free(py, || change(map)).or_raise()?)?;
        let shape = Shape::made(py, maker, arguments, Arc::clone(&map) as _)?;
        Py::new(py, PyClassInitializer::from(shape).add_subclass(HeightMap(map)))
    }
}

#[pymethods]
impl HeightMap {
    #[new]
    #[pyo3(signature = (heights, lengths, periodic=false))]
    fn new(
        py: Python<'_>,
        heights: &Object<'_>,
        lengths: PerAxis<f64>,
        periodic: bool,
    ) -> PyResult<PyClassInitializer<HeightMap>> {
        let (heights, cells) = plane("heights", heights)?;
        let map = geo::HeightMap::new(cells, lengths.0, heights).or_raise()?;
        squared(py, &map, lengths.0, true)?;
        HeightMap::parts(py, if periodic { map.periodic() } else { map })
    }

    /// Reads a map: SDF, SUR, PRO, GSF and X3P files by their content, in metres; NPY files and text (matrices, or with `points`
    /// lines of x, y and height) need `unit`, and matrices `lengths` [m] along x1 and x2.
    ///
    /// `orientation` tells how a matrix lies, of NPY files and of text alike: "array" (default) as every array of this package, line i at the place i
    /// along x1, which `numpy.save` and `numpy.savetxt` write; "picture" as programs of instruments export it, a line along x1, the first line at the
    /// maximum x2.
    ///
    /// Raises OSError if the file cannot be read or understood, and says where; ValueError if the cells are square with `lengths` exchanged alone.
    ///
    /// >>> HeightMap.read("no_such_file.sdf")
    /// Traceback (most recent call last):
    /// FileNotFoundError: ...
    #[staticmethod]
    #[pyo3(signature = (path, *, lengths=None, unit=None, orientation="array", points=false, profile=false, decimal_comma=None, missing_height=None))]
    #[allow(clippy::too_many_arguments)]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        lengths: Option<PerAxis<f64>>,
        unit: Option<&str>,
        orientation: &str,
        points: bool,
        profile: bool,
        decimal_comma: Option<bool>,
        missing_height: Option<f64>,
    ) -> PyResult<Py<HeightMap>> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        let unit = unit.map(|unit| unit.parse::<LengthUnit>().or_raise()).transpose()?;
        let format = if_given(TextFormat::default(), decimal_comma, TextFormat::with_decimal_comma);
        let format = if_given(format, missing_height, TextFormat::with_missing_height);
        let lengths = lengths.map(|lengths| lengths.0);
        let needs = |what: &str| PyTypeError::new_err(format!("{}: this kind of file needs {what}", path.display()));
        let is_text = !["sdf", "sur", "pro", "x3p", "gsf", "npy"].contains(&ending.as_str());
        for (name, given) in [("missing_height", missing_height.is_some()), ("decimal_comma", decimal_comma.is_some())]
        {
            if given && !is_text {
                let what = format!("{}: this kind of file has no {name}, which is of texts", path.display());
                return Err(PyTypeError::new_err(what));
            }
        }
        let map = match ending.as_str() {
            "sdf" | "sur" | "pro" | "x3p" => free(py, || geo::HeightMap::read(&path)),
            "gsf" => {
                let file = File::open(&path).map_err(unreadable(&path))?;
                free(py, || geo::HeightMap::from_gsf(file, unit))
            }
            _ => {
                let file = File::open(&path).map_err(unreadable(&path))?;
                let unit = unit.ok_or_else(|| needs("the unit of its numbers, such as unit=\"um\""))?;
                if points {
                    free(py, || geo::HeightMap::from_xyz(file, unit, unit, format))
                } else if profile {
                    free(py, || geo::HeightMap::from_profile(file, unit, unit, format))
                } else {
                    let lengths = lengths.ok_or_else(|| needs("the lengths of its sides in m, as lengths=(l1, l2)"))?;
                    let is_picture = choice("orientation", orientation, &[("array", false), ("picture", true)])?;
                    let map = free(py, || matrix(file, &ending, lengths, (unit, format), is_picture)).or_raise()?;
                    squared(py, &map, lengths, false)?;
                    Ok(map)
                }
            }
        };
        HeightMap::made(py, map.or_raise()?)
    }

    /// A map of points (x, y, height) [m] on a regular grid in any order: an array of shape (n, 3).
    #[staticmethod]
    fn from_points(py: Python<'_>, points: &Object<'_>) -> PyResult<Py<HeightMap>> {
        let points: Vec<[f64; 3]> = measured_points("points", points)?;
        HeightMap::made(py, free(py, || geo::HeightMap::from_points(&points)).or_raise()?)
    }

    /// The heights [m], of the shape of the map; NaN where one is missing.
    #[getter]
    fn heights<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        to_array(py, self.0.heights().to_vec(), &self.0.cells())
    }

    /// The map with missing heights filled by harmonic interpolation.
    fn filled(slf: &Bound<'_, Self>) -> PyResult<Py<HeightMap>> {
        let (cancel, map) = (AtomicBool::new(false), (*slf.get().0).clone());
        let filled = interruptible(slf.py(), true, &cancel, || map.filled_unless(&cancel))?;
        HeightMap::changed(slf, "filled", (slf.clone(),), |_| Ok(filled))
    }

    /// The map with nothing to touch where heights are missing.
    fn masked(slf: &Bound<'_, Self>) -> PyResult<Py<HeightMap>> {
        HeightMap::changed(slf, "masked", (slf.clone(),), |map| Ok(map.masked()))
    }

    /// The map less the "mean", "tilt" or "curvature" that fits it best.
    #[pyo3(signature = (form="tilt"))]
    fn leveled(slf: &Bound<'_, Self>, form: &str) -> PyResult<Py<HeightMap>> {
        let forms = [("mean", Form::Mean), ("tilt", Form::Tilt), ("curvature", Form::Curvature)];
        let chosen = choice("form", form, &forms)?;
        HeightMap::changed(slf, "leveled", (slf.clone(), form), |map| map.leveled(chosen))
    }

    /// The part of `shape` points that begins at the point `first`.
    fn cropped(slf: &Bound<'_, Self>, first: [usize; 2], shape: [usize; 2]) -> PyResult<Py<HeightMap>> {
        HeightMap::changed(slf, "cropped", (slf.clone(), first, shape), |map| map.cropped(first, shape))
    }

    /// The mirror image along the chosen axes, a bool for each.
    fn flipped(slf: &Bound<'_, Self>, along: [bool; 2]) -> PyResult<Py<HeightMap>> {
        HeightMap::changed(slf, "flipped", (slf.clone(), along), |map| Ok(map.flipped(along)))
    }

    /// The map with x1 and x2 exchanged.
    fn transposed(slf: &Bound<'_, Self>) -> PyResult<Py<HeightMap>> {
        HeightMap::changed(slf, "transposed", (slf.clone(),), |map| Ok(map.transposed()))
    }

    /// The map with peaks and valleys exchanged, as on a replica.
    fn inverted(slf: &Bound<'_, Self>) -> PyResult<Py<HeightMap>> {
        HeightMap::changed(slf, "inverted", (slf.clone(),), |map| Ok(map.inverted()))
    }

    /// The map with all heights multiplied by `factor`.
    fn scaled(slf: &Bound<'_, Self>, factor: f64) -> PyResult<Py<HeightMap>> {
        HeightMap::changed(slf, "scaled", (slf.clone(), factor), |map| map.scaled(factor))
    }

    /// The map with its middle at the point `center` [m].
    fn centered_at(slf: &Bound<'_, Self>, center: [f64; 2]) -> PyResult<Py<HeightMap>> {
        HeightMap::changed(slf, "centered_at", (slf.clone(), center), |map| map.centered_at(center))
    }

    /// The map repeated along both axes, its lengths being the periods.
    fn periodic(slf: &Bound<'_, Self>) -> PyResult<Py<HeightMap>> {
        HeightMap::changed(slf, "periodic", (slf.clone(),), |map| Ok(map.periodic()))
    }

    /// The map interpolated at the cells of a grid.
    fn resampled(slf: &Bound<'_, Self>, grid: &Bound<'_, Grid>) -> PyResult<Py<HeightMap>> {
        let onto = grid.get().0.clone();
        HeightMap::changed(slf, "resampled", (slf.clone(), grid.clone()), |map| map.resampled(&onto))
    }

    /// A dict of "mean", "rms_height" [m], "skewness", "kurtosis", "rms_slope", "rms_slopes" along x1 and x2, and "rms_curvature" [1/m].
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Dict<'py>> {
        let of = free(py, || self.0.statistics()).or_raise()?;
        let slopes: (f64, f64) = of.rms_slopes.into();
        Ok(dict! { py;
            of { mean, rms_height, skewness, kurtosis, rms_slope, rms_curvature },
            "rms_slopes": slopes,
        })
    }

    /// Wave numbers [rad/m] and the radial mean of the power spectral density of the heights [m⁴], as rows.
    fn power_spectrum<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        rows_of(py, free(py, || self.0.power_spectrum()).or_raise()?)
    }

    /// The height at `x1` along the line x2 = `x2` [m], NaN where there is none: a float or an array of the shape of `x1`.
    fn height_at<'py>(&self, x1: &Object<'py>, x2: f64) -> PyResult<Object<'py>> {
        mapped("x1", x1, ALL, |x1| self.0.height_at(x1, x2).unwrap_or(f64::NAN), never)
    }

    /// Writes the map by the ending of the path: `.sdf` (all digits), `.gsf` (single precision) or `.npy`, in m.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let kinds = [("sdf", 0), ("gsf", 1), ("npy", 2)];
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        let kind = choice("ending of the path", &ending, &kinds)?;
        let mut file = std::io::Cursor::new(Vec::new());
        let written = free(py, || match kind {
            0 => self.0.write_sdf(&mut file),
            1 => self.0.write_gsf(&mut file),
            _ => self.0.write_npy(&mut file),
        });
        written.or_raise()?;
        replace(&path, &file.into_inner())
    }

    /// A self-affine random surface of whole periods, of the lengths of `grid`: a periodic map.
    ///
    /// Waves run from `longest` to `shortest` [m] with the Hurst exponent `hurst`; longer than `roll_off` their spectrum is flat. Give
    /// `rms_slope` or `rms_height` [m]. `anisotropy` is (ratio, direction [rad]). With a `period` [m], longer than the grid, the map
    /// is one period, of which the grid holds a part. The same seed gives the same surface everywhere.
    ///
    /// >>> HeightMap.rough(Grid(64, 1e-3), 0.5e-3, 0.1e-3, rms_slope=0.1, seed=3).statistics()["rms_slope"].__round__(3)
    /// 0.1
    #[staticmethod]
    #[pyo3(signature = (grid, longest, shortest, *, rms_slope=None, rms_height=None, hurst=0.8, roll_off=None, anisotropy=None, period=None, seed=0))]
    #[allow(clippy::too_many_arguments)]
    fn rough(
        py: Python<'_>,
        grid: Bound<'_, Grid>,
        longest: f64,
        shortest: f64,
        rms_slope: Option<f64>,
        rms_height: Option<f64>,
        hurst: f64,
        roll_off: Option<f64>,
        anisotropy: Option<(f64, f64)>,
        period: Option<PerAxis<f64>>,
        #[pyo3(from_py_with = count)] seed: usize,
    ) -> PyResult<Py<HeightMap>> {
        let roughness = match (rms_slope, rms_height) {
            (Some(slope), None) => Roughness::RmsSlope(slope),
            (None, Some(height)) => Roughness::RmsHeight(height),
            _ => return Err(PyTypeError::new_err("give rms_slope or rms_height, one of them")),
        };
        let spec = RoughSpec::new(longest, shortest, roughness).with_seed(seed as u64).with_hurst(hurst);
        let spec = if_given(spec, roll_off, RoughSpec::with_roll_off);
        let along = anisotropy.map(|(ratio, direction)| Anisotropy::new(ratio, direction));
        let spec = if_given(spec, along, RoughSpec::with_anisotropy);
        let on = &grid.get().0;
        let period = period.map(|period| period.0);
        let rough = free(py, || match period {
            Some(period) => geo::Rough::windowed(on, spec, period),
            None => geo::Rough::new(on, spec),
        });
        let rough = rough.or_raise()?;
        let keywords = dict! { py;
            "rms_slope": rms_slope,
            "rms_height": rms_height,
            "hurst": hurst,
            "roll_off": roll_off,
            "anisotropy": anisotropy,
            "period": period,
            "seed": seed,
        };
        let map = HeightMap(Arc::new(rough.height_map().clone()));
        let shape = Shape::made(py, "rough", (grid, longest, shortest), Arc::new(rough))?.with_keywords(&keywords)?;
        Py::new(py, PyClassInitializer::from(shape).add_subclass(map))
    }
}

getters! {HeightMap, of:
    /// The middle of the map [m].
    center: (f64, f64) = of.center().into();
    /// Whether the map repeats along both axes.
    is_periodic: bool = of.is_periodic();
    /// Number of points along x1 and x2.
    shape: (usize, usize) = of.cells().into();
    /// Sides of the rectangle of all points [m].
    lengths: (f64, f64) = of.lengths().into();
    /// Number of missing heights.
    missing: usize = of.missing();
    /// The grid whose cells have the points of the map as their centres.
    grid: Grid = Grid(of.grid());
}

/// A map of a matrix: as an array of this package, whose entry (i, j) is at the places i along x1 and j along x2; or as a picture, whose lines are
/// along x1, the first at the maximum x2. NPY files are read as the one, texts as the other, and turned where they are not.
fn matrix(
    file: File,
    ending: &str,
    [l1, l2]: [f64; 2],
    (unit, format): (LengthUnit, TextFormat),
    is_picture: bool,
) -> viscocontact::Result<geo::HeightMap> {
    match (ending, is_picture) {
        ("npy", false) => geo::HeightMap::from_npy(file, [l1, l2], unit),
        ("npy", true) => Ok(geo::HeightMap::from_npy(file, [l2, l1], unit)?.flipped([true, false]).transposed()),
        (_, false) => Ok(geo::HeightMap::from_text(file, [l2, l1], unit, format)?.transposed().flipped([true, false])),
        (_, true) => geo::HeightMap::from_text(file, [l1, l2], unit, format),
    }
}

/// Refuses, or where `only_warns` warns of, sides that make squares of the cells if they are exchanged, and only then.
fn squared(py: Python<'_>, map: &geo::HeightMap, lengths: [f64; 2], only_warns: bool) -> PyResult<()> {
    py.import("viscocontact._values")?.call_method1("squared", (map.cells(), lengths, only_warns)).map(drop)
}
