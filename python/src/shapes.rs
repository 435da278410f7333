//! Shapes: the gap between the bodies before they deform.

use vc::geometry::{self as geo, Geometry};
use viscocontact as vc;

use crate::arrays::{cell_values, number};
use crate::prelude::*;

made! {
    /// A shape: the gap between the undeformed bodies over the plane of contact, `+inf` where there is nothing to touch.
    ///
    /// Its static methods make shapes; `+` superposes them, `shifted` moves them. Lengths are in metres.
    ///
    /// >>> ball = Shape.sphere(10e-3)
    /// >>> rough_ball = ball + Shape.wavy(1e-6, 0.2e-3).shifted((0.1e-3, 0))
    /// >>> ball.gap(Grid(2, 2e-3))
    /// array([[2.5e-05, 2.5e-05],
    ///        [2.5e-05, 2.5e-05]])
    #[pyclass(frozen, subclass, weakref, module = "viscocontact")]
    Shape(pub geometry: Arc<dyn Geometry>) of impl Geometry + 'static => Arc::new
}

impl Shape {
    /// The shape that the static method `maker` makes of `arguments`.
    pub fn made<'py>(
        py: Python<'py>,
        maker: &'static str,
        arguments: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
        geometry: Arc<dyn Geometry>,
    ) -> PyResult<Shape> {
        Ok(Shape { geometry, recipe: Recipe::new(py, maker, arguments)? })
    }

    pub fn with_keywords(self, keywords: &Dict<'_>) -> PyResult<Shape> {
        Ok(Shape { recipe: self.recipe.with_keywords(Some(keywords))?, ..self })
    }
}

/// Cells by which a point may be beside a grid.
const RIM: f64 = 1e-9;

/// A gap given cell by cell.
#[derive(Debug)]
struct GapOnCells {
    grid: vc::Grid,
    gap: Vec<f64>,
}

impl Geometry for GapOnCells {
    fn initial_gap(&self, x1: f64, x2: f64) -> f64 {
        let ([n1, n2], spacing) = (self.grid.cells(), self.grid.spacing());
        // there is nothing beside the grid; its rim is on it, but for rounding
        let index = |x: f64, axis: usize, n: usize| {
            let place = x / spacing[axis] + 0.5 * n as f64;
            let is_inside = (-RIM..=n as f64 + RIM).contains(&place);
            is_inside.then(|| (place.floor().max(0.0) as usize).min(n - 1))
        };
        let cell = index(x1, 0, n1).zip(index(x2, 1, n2));
        cell.map_or(f64::INFINITY, |(i, j)| self.gap[i * n2 + j])
    }

    fn fill_gap_at(&self, grid: &vc::Grid, by: [f64; 2], gap: &mut [f64]) {
        if *grid == self.grid && by == [0.0; 2] {
            return gap.copy_from_slice(&self.gap);
        }
        let n2 = grid.cells()[1];
        for (k, value) in gap.iter_mut().enumerate() {
            let [x1, x2] = grid.center(k / n2, k % n2);
            *value = self.initial_gap(x1 - by[0], x2 - by[1]);
        }
    }
}

makers! {Shape, py:
    /// A sphere of `radius` [m], as a paraboloid: r²/2R.
    sphere(radius: f64) = geo::Sphere::new(radius);

    /// A cylinder of `radius` [m] along x2, as a parabola: x1²/2R.
    cylinder(radius: f64) = geo::Cylinder::new(radius);

    /// A paraboloid of the radii of curvature `r1` and `r2` [m] along x1 and x2.
    ellipsoid(r1: f64, r2: f64) = geo::Ellipsoid::new(r1, r2);

    /// A cone whose flank rises by `tan_beta` per unit of radius.
    cone(tan_beta: f64) = geo::Cone::new(tan_beta);

    /// A flat punch with a circular face of `radius` [m]; nothing to touch outside.
    circular_punch(radius: f64) = geo::FlatPunch::circular(radius);

    /// A flat punch with a rectangular face of full `sides` along x1 and x2 [m].
    rectangular_punch(sides: [f64; 2]) = geo::FlatPunch::rectangular(sides);

    /// A wave along x1, A (1 − cos 2πx1/λ), of `amplitude` A and `wavelength` λ [m]; a pair of each makes the sum of a wave along x1
    /// and one along x2.
    wavy(amplitude: Value<'_>, wavelength: Value<'_>) =
        match (amplitude.extract(), wavelength.extract()) {
        (Ok(amplitudes), Ok(wavelengths)) => geo::Wavy::in_two_directions(amplitudes, wavelengths),
        _ => geo::Wavy::new(amplitude.extract()?, wavelength.extract()?),
    };
}

#[pymethods]
impl Shape {
    /// A gap by a function of the coordinates x1 and x2 [m], two floats, that returns a float [m].
    ///
    /// An exception of the function comes out of the call that needed the gap.
    #[staticmethod]
    fn function(py: Python<'_>, gap: Function) -> PyResult<Shape> {
        let function = gap.clone();
        let made = geo::FnGeometry::fallible(move |x1: f64, x2: f64| function.call::<f64>((x1, x2)));
        Ok(Shape::by(Recipe::new(py, "function", (gap.clone(),))?.calling([gap]), made))
    }

    /// A gap [m] for each cell of `grid`: any array of its shape, `+inf` where there is nothing to touch, as beside the grid.
    ///
    /// Raises ValueError if the shapes differ, or a value is NaN.
    ///
    /// >>> grid = Grid(4, 1e-3)
    /// >>> x1, x2 = grid.coordinates()
    /// >>> Shape.gap_on(grid, (x1**2 + x2**2) / 2e-2)
    /// Shape.gap_on(Grid((4, 4), (0.001, 0.001)), <array [4, 4]>)
    #[staticmethod]
    fn gap_on(py: Python<'_>, grid: Bound<'_, Grid>, gap: Object<'_>) -> PyResult<Shape> {
        let on = grid.get().0.clone();
        let values = crate::arrays::field("gap", &gap, on.cells())?;
        // as it was read: another thread may write into the array
        let gap = to_array(py, values.clone(), &on.cells())?;
        Shape::made(py, "gap_on", (grid, gap), Arc::new(GapOnCells { grid: on, gap: values }))
    }

    fn __add__(slf: Bound<'_, Self>, other: Bound<'_, Shape>) -> PyResult<Shape> {
        let sum = geo::Sum::new(Arc::clone(&slf.get().geometry), Arc::clone(&other.get().geometry));
        Ok(Shape::by(Recipe::new(slf.py(), "__add__", (slf, other))?, sum))
    }

    /// Arrays leave `+` to shapes, which refuse it: an array has no grid.
    #[classattr]
    #[pyo3(name = "__array_ufunc__")]
    const ARRAY_UFUNC: Option<bool> = None;

    /// `sum` of shapes begins with 0.
    fn __radd__<'py>(slf: Bound<'py, Self>, other: &Object<'py>) -> PyResult<Bound<'py, Shape>> {
        let needed = "a Shape is added to a Shape: Shape.gap_on(grid, array) makes one of an array";
        if number(other) == Some(0.0) { Ok(slf) } else { Err(PyTypeError::new_err(needed)) }
    }

    /// Checks the laws of shapes on a grid: a gap that is no NaN, something to touch, the same by points and by fields. Raises ValueError with
    /// the first violation.
    fn check(&self, py: Python<'_>, grid: &Grid) -> PyResult<()> {
        let verdict = free(py, || geo::laws::all(&*self.geometry, &grid.0));
        no_violation(self.geometry.failure(), verdict)
    }

    /// The gap at the centres of the cells of a grid [m].
    fn gap<'py>(&self, py: Python<'py>, grid: &Grid) -> PyResult<Array<'py>> {
        let mut gap = vec![0.0; grid.0.len()];
        free(py, || self.geometry.fill_gap(&grid.0, &mut gap));
        nothing_raised(self.geometry.failure())?;
        to_array(py, gap, &grid.0.cells())
    }
}

changes! {Shape, slf:
    /// This shape with its origin at the point `by` [m].
    shifted(by: [f64; 2]) = geo::Shifted::new(Arc::clone(&slf.get().geometry), by);

    /// The part of this shape within half a `period` [m] of the origin, repeated along x1 and x2; `inf` along an axis without
    /// repetition.
    repeated(period: [f64; 2]) = geo::Repeated::new(Arc::clone(&slf.get().geometry), period);
}

/// The shapes of the rigid bodies of a contact: a shape, an array of the gap on the grid, or a sequence of shapes.
pub fn geometries(grid: &vc::Grid, given: &Object<'_>) -> PyResult<Vec<Arc<dyn Geometry>>> {
    if let Ok(shape) = given.cast::<Shape>() {
        return Ok(vec![Arc::clone(&shape.get().geometry)]);
    }
    if given.hasattr("dtype")? {
        let gap = cell_values("geometry", given, grid.cells())?;
        return Ok(vec![Arc::new(GapOnCells { grid: grid.clone(), gap })]);
    }
    let needed = "geometry: a Shape, an array of gaps on the grid, or a sequence of shapes is needed";
    let shapes: Vec<Bound<'_, Shape>> = given.extract().map_err(|_| PyTypeError::new_err(needed))?;
    Ok(shapes.iter().map(|shape| Arc::clone(&shape.get().geometry)).collect())
}
