//! Elastic contacts.

use viscocontact::contact::Settings;
use viscocontact::elastic as ve;

use crate::arrays::field;
use crate::prelude::*;

/// A rigid body, or several, pressed onto an elastic body: without time.
///
/// Parameters
/// ----------
/// grid : Grid
/// geometry : Shape, array of the shape of the grid, or sequence of shapes
///     As of `ViscoelasticContact`.
/// modulus : float
///     The contact modulus E* [Pa], E/(1 − ν²) of an elastic body under a rigid one.
/// kernel : InfluenceKernel, optional
///     The body, if it is not a half-space.
/// tolerance, max_iterations, edge, symmetry, window : optional
///     As of `ViscoelasticContact`.
///
/// >>> contact = ElasticContact(Grid(64, 3e-3), Shape.sphere(10e-3), 4e6)
/// >>> report = contact.solve(Load.force(0.5))
/// >>> a = (0.75 * 0.5 * 10e-3 / 4e6) ** (1 / 3)
/// >>> abs(contact.approach / (a**2 / 10e-3) - 1) < 5e-3
/// True
#[pyclass(module = "viscocontact")]
pub struct ElasticContact {
    pub contact: ve::ElasticContact,
    cancel: Arc<AtomicBool>,
}

#[pymethods]
impl ElasticContact {
    #[new]
    #[pyo3(
        signature = (grid, geometry, modulus, *, kernel=None, **options),
        text_signature = "(grid, geometry, modulus, *, kernel=None, **options)"
    )]
    fn new(
        py: Python<'_>,
        grid: &Grid,
        geometry: &Object<'_>,
        modulus: f64,
        kernel: Option<&InfluenceKernel>,
        options: Option<&Dict<'_>>,
    ) -> PyResult<ElasticContact> {
        let shapes = geometries(&grid.0, geometry)?;
        if shapes.is_empty() {
            return Err(PyTypeError::new_err("geometry: at least one shape is needed"));
        }
        let mut builder = ve::ElasticContact::builder(grid.0.clone()).modulus(modulus);
        for shape in &shapes {
            builder = builder.another_body(shape);
        }
        let settings = options.map(|options| settings(Settings::default(), options)).transpose()?;
        builder = if_given(builder, kernel, |builder, kernel| builder.kernel(Arc::clone(&kernel.kernel)));
        let builder = if_given(builder, settings, |builder, settings| builder.settings(settings));
        let contact = free(py, || builder.build()).or_raise()?;
        Ok(ElasticContact { contact, cancel: Arc::default() })
    }

    /// Finds the equilibrium under a `Load`, or a sequence with one for each body, from the last one. Ctrl-C ends the search within an
    /// iteration; a failure leaves the contact as it was.
    ///
    /// Returns the cost and accuracy: "iterations", "convolutions" (transforms in these units), "residual", and the "warnings" as lines.
    fn solve<'py>(mut slf: Taken<'_, Self>, py: Python<'py>, load: &Object<'py>) -> PyResult<Dict<'py>> {
        let loads = loads(load)?;
        let ElasticContact { contact, cancel, .. } = &mut *slf;
        let report = interruptible(py, true, cancel, || contact.solve_unless(cancel, &loads))?;
        let warnings: Vec<String> = report.messages().map(in_python).collect();
        Ok(dict! { py;
            report { iterations, residual },
            "convolutions": report.convolution_equivalents(),
            "warnings": warnings,
        })
    }

    /// Displaces the surface before any pressure [m], positive into the bodies: an array of the shape of the grid. The next solution
    /// begins from there.
    fn set_surface(mut slf: Taken<'_, Self>, displacement: &Object<'_>) -> PyResult<()> {
        let cells = slf.contact.fields().grid().cells();
        let values = field("displacement", displacement, cells)?;
        slf.contact.set_surface(&values).or_raise()
    }

    /// The contact modulus E* [Pa].
    #[getter]
    fn modulus(slf: Shared<'_, Self>) -> f64 {
        slf.contact.modulus()
    }

    fn __repr__(slf: Shared<'_, Self>) -> PyResult<String> {
        let of = slf.shown()?;
        let ([n1, n2], [force, approach]) = (of.grid().cells(), [of.force(), of.approach()].map(digits));
        Ok(format!("ElasticContact({n1} × {n2} cells, force={force} N, approach={approach} m)"))
    }
}
