//! Closed forms to compare with.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact::analytic as an;

use crate::arrays::mapped;
use crate::errors::OrRaise;
use crate::grid::Grid;
use crate::loads::history;
use crate::materials::Material;
use crate::shapes::Shape;
use crate::sliding::complex;

/// Hertz: a sphere of `radius` [m] on a body of contact `modulus` E* [Pa] under `force` [N]: "contact_radius" [m], "max_pressure" [Pa]
/// and "approach" [m].
///
/// >>> round(hertz(10e-3, 4e6, 1.0)["contact_radius"], 6)
/// 0.001233
#[pyfunction]
pub fn hertz<'py>(py: Python<'py>, radius: f64, modulus: f64, force: f64) -> PyResult<Bound<'py, PyDict>> {
    let of = an::Hertz::new(radius, modulus, force).or_raise()?;
    let all = PyDict::new(py);
    all.set_item("contact_radius", of.contact_radius)?;
    all.set_item("max_pressure", of.max_pressure)?;
    all.set_item("approach", of.approach)?;
    Ok(all)
}

/// A sphere on a viscoelastic half-space under a force for which the contact never shrinks (Lee and Radok).
///
/// >>> ball = GrowingSphere(10e-3, Material(Rheology.maxwell(1e6, 1.0)), Load.force(1.0))
/// >>> round(ball.contact_radius(0.0), 6)
/// 0.001233
#[pyclass(frozen, module = "viscocontact")]
pub struct GrowingSphere(an::GrowingSphere);

#[pymethods]
impl GrowingSphere {
    #[new]
    fn new(radius: f64, material: &Material, load: &Bound<'_, PyAny>) -> PyResult<GrowingSphere> {
        an::GrowingSphere::new(radius, &material.material, history(load)?).or_raise().map(GrowingSphere)
    }

    /// Contact radius [m] at times [s].
    fn contact_radius<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        mapped("t", t, |t| self.0.contact_radius(t))
    }

    /// Approach [m] at times [s].
    fn approach<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        mapped("t", t, |t| self.0.approach(t))
    }

    /// Pressure [Pa] at distances from the centre [m] and one time [s].
    fn pressure<'py>(&self, r: &Bound<'py, PyAny>, t: f64) -> PyResult<Bound<'py, PyAny>> {
        mapped("r", r, |r| self.0.pressure(r, t))
    }
}

/// Pull-off force [N] of a sphere of `radius` [m] that sticks with the `work` of separation [J/m²] to a body of contact `modulus` E* [Pa],
/// by Johnson, Kendall and Roberts.
#[pyfunction]
pub fn jkr_pull_off(radius: f64, modulus: f64, work: f64) -> PyResult<f64> {
    Ok(an::Jkr::new(radius, modulus, work).or_raise()?.pull_off_force())
}

/// Persson's theory of a rubber that slides on a rough surface: the coefficient of friction and the share of the surface in contact.
///
/// Parameters
/// ----------
/// grid : Grid
///     One period of the surface.
/// surface : Shape
/// modulus : function
///     The complex contact modulus E* [Pa] at frequencies ≥ 0 [rad/s]: 4 G* if incompressible.
/// pressure : float
///     The mean pressure [Pa].
/// velocity : (float, float)
///     [m/s]
/// gamma : float
///     The number γ of the theory, 0 to 1.
#[pyfunction]
pub fn persson_friction(
    py: Python<'_>,
    grid: &Grid,
    surface: &Shape,
    modulus: Py<PyAny>,
    pressure: f64,
    velocity: [f64; 2],
    gamma: f64,
) -> PyResult<(f64, f64)> {
    let surface = Arc::clone(&surface.geometry);
    let theory = py.detach(|| {
        an::PerssonFriction::new(&grid.0, &*surface, |omega| complex(&modulus, omega), pressure, velocity, gamma)
    });
    let theory = theory.or_raise()?;
    Ok((theory.friction, theory.contact_share))
}
