//! Materials: a rheology and the response in volume.

use viscocontact::rheology as rh;

use crate::prelude::*;
use crate::rheology::{Series, series};

made! {
    /// A rheology that was measured in tension: what it gives as J(t) is the strain of a rod under unit tension, and its moduli are Young's.
    ///
    /// A `Material` of it needs `nu` or `bulk_modulus`.
    ///
    /// >>> Material(Tension(Rheology.relaxing(3e6, 1.5e6, 0.1)), nu=0.49)
    /// Material(Tension(Rheology.relaxing(3000000.0, 1500000.0, 0.1)), nu=0.49)
    #[pyclass(frozen, module = "viscocontact")]
    Tension(body: Arc<dyn rh::Rheology>)
}

#[pymethods]
impl Tension {
    #[new]
    pub fn new(rheology: Bound<'_, Rheology>) -> PyResult<Tension> {
        let body = Arc::clone(&rheology.get().body);
        Ok(Tension::by(Recipe::new(rheology.py(), "", (rheology,))?, body))
    }
}

made! {
    /// A body of a contact: a rheology in shear and the response in volume.
    ///
    /// Parameters
    /// ----------
    /// rheology : Rheology or Tension
    ///     The shear creep, or the creep of a rod.
    /// nu : float
    ///     Poisson's ratio, constant in time; 0.5, the default in shear, is incompressible.
    /// bulk_modulus : float
    ///     A bulk that is elastic instead [Pa].
    /// bulk_ratio : float
    ///     A bulk that relaxes in proportion to the shear: the share c of B(t)/B(0) = 1 − c (1 − G(t)/G(0)).
    ///
    /// >>> pmma = Material(Rheology.relaxing(1e9, 0.5e9, 10.0), nu=0.35)
    /// >>> pmma.contact_compliance(0.0) * 1e9
    /// 0.325
    #[pyclass(frozen, module = "viscocontact")]
    Material(pub material: rh::Material)
}

makers! {Material, py:
    /// A material of the library of published ones (`published_materials`), with a constant Poisson's ratio.
    ///
    /// Raises ValueError with the known names.
    published(name: &str, nu: f64) = rh::library::find(name).and_then(|found| found.material(nu));
}

#[pymethods]
impl Material {
    #[new]
    #[pyo3(signature = (rheology, nu=None, *, bulk_modulus=None, bulk_ratio=None))]
    fn new(
        py: Python<'_>,
        rheology: Object<'_>,
        nu: Option<f64>,
        bulk_modulus: Option<f64>,
        bulk_ratio: Option<f64>,
    ) -> PyResult<Material> {
        let material = if let Ok(rod) = rheology.cast::<Tension>() {
            let rod = rh::Tension(Arc::clone(&rod.get().body));
            match (nu, bulk_modulus, bulk_ratio) {
                (Some(nu), None, None) => rh::Material::from_tension(rod, nu),
                (None, Some(bulk), None) => rh::Material::from_tension_elastic_bulk(rod, bulk),
                _ => return Err(PyTypeError::new_err("a rheology in tension needs nu or bulk_modulus, one of them")),
            }
        } else {
            let needed = "a Rheology or a Tension is needed";
            let body = Arc::clone(&rheology.cast::<Rheology>().map_err(|_| PyTypeError::new_err(needed))?.get().body);
            match (nu, bulk_modulus, bulk_ratio) {
                (None, None, None) => Ok(rh::Material::incompressible(body)),
                (Some(nu), None, None) => rh::Material::constant_poisson(body, nu),
                (None, Some(bulk), None) => rh::Material::elastic_bulk(body, bulk),
                (None, Some(bulk), Some(ratio)) => rh::Material::relaxing_bulk(body, bulk, ratio),
                _ => return Err(PyTypeError::new_err("give nu, or bulk_modulus, or bulk_modulus and bulk_ratio")),
            }
        };
        let keywords = PyDict::new(py);
        for (name, value) in [("nu", nu), ("bulk_modulus", bulk_modulus), ("bulk_ratio", bulk_ratio)] {
            if let Some(value) = value {
                keywords.set_item(name, value)?;
            }
        }
        let recipe = Recipe::new(py, "", (rheology,))?.with_keywords(Some(&keywords))?;
        Ok(Material::by(recipe, material.or_raise()?))
    }

    /// C(t) [1/Pa] at times [s], 1/E* of an elastic body: a float, or an array of the shape of `t`.
    fn contact_compliance<'py>(&self, t: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("t", t, FROM_ZERO, |t| self.material.contact_compliance(t), || self.material.failure())
    }
}

changes! {Material, slf:
    /// The two bodies as one: both deform, and their compliances add up.
    against(other: Bound<'_, Material>) = sure(slf.get().material.clone().against(other.get().material.clone()));

    /// The material with exponential series fitted over the times from `first` to `last` [s].
    #[pyo3(signature = (first, last, tolerance=1e-4))]
    fitted(first: f64, last: f64, tolerance: f64) = {
        let material = &slf.get().material;
        free(slf.py(), || material.fitted(first..=last, tolerance))
    };
}

getters! {Material.material, of:
    /// Poisson's ratio of each body; None of an elastic or a relaxing bulk, where it changes.
    nu: Vec<Option<f64>> = of.poisson_ratios().collect();
    /// The times [s] over which all rheologies were measured or fitted; (0, inf) of formulas.
    measured: (f64, f64) = of.measured().into();
    /// The exponential series of C(t), as `Rheology.creep_spectrum`; None if there is none.
    contact_spectrum: PyResult<Option<Series>> = Ok(of.contact_spectrum().or_raise()?.map(|spectrum| series(&spectrum)));
    /// The errors of series that were fitted, a line each.
    fit_reports: Vec<String> = of.fit_reports().map(ToString::to_string).collect();
}

/// Names, descriptions and references of the published materials.
///
/// >>> sorted(published_materials())[:1]  # doctest: +ELLIPSIS
/// ['...']
#[pyfunction]
pub fn published_materials() -> std::collections::BTreeMap<&'static str, (&'static str, &'static str)> {
    rh::library::all().iter().map(|material| (material.name, (material.description, material.reference))).collect()
}
