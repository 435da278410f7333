//! What a state shows: patches, profiles, distributions, stress.

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscocontact::observe::{self as ob, Stress};

use crate::arrays::{Array, table, to_array};
use crate::contact::ViscoelasticContact;
use crate::errors::{OrRaise, choice};
use crate::kernels::axis;
use crate::shapes::Shape;

#[pymethods]
impl ViscoelasticContact {
    /// The force that moves `shape` along the surface without friction, along x1 and x2 [N].
    fn lateral_force(&self, py: Python<'_>, shape: &Shape) -> PyResult<(f64, f64)> {
        let contact = self.get()?;
        Ok(py.detach(|| contact.lateral_force(&*shape.geometry)).into())
    }

    /// Normal stiffness over the contact modulus [m].
    fn stiffness_over_modulus(&self, py: Python<'_>) -> PyResult<f64> {
        let contact = self.get()?;
        py.detach(|| contact.stiffness_over_modulus()).or_raise()
    }

    /// Estimated relative errors due to the mesh: "approach", "max_pressure" (None where it does not converge), "area"; None where there
    /// is no estimate.
    fn mesh_error<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let contact = self.get()?;
        let Some(error) = py.detach(|| contact.mesh_error()).or_raise()? else { return Ok(None) };
        let all = PyDict::new(py);
        all.set_item("approach", error.approach)?;
        all.set_item("max_pressure", error.max_pressure)?;
        all.set_item("area", error.area)?;
        Ok(Some(all))
    }

    /// The distribution of the pressure over the grid: the share at zero, the centres of the bins [Pa], and the density [1/Pa].
    fn pressure_distribution<'py>(&self, py: Python<'py>, bins: usize) -> PyResult<(f64, Array<'py>, Array<'py>)> {
        distribution(py, &self.get()?.pressure_distribution(bins).or_raise()?)
    }

    /// The distribution of the gap where it is finite: the share at zero, the centres of the bins [m], and the density [1/m].
    fn gap_distribution<'py>(&self, py: Python<'py>, bins: usize) -> PyResult<(f64, Array<'py>, Array<'py>)> {
        distribution(py, &self.get()?.gap_distribution(bins).or_raise()?)
    }

    /// Arrays "position" [m], "pressure", "displacement", "gap" and "traction" along the line of cells in the direction of the axis `along`
    /// (0 or 1) that contains the other coordinate `at` [m].
    #[pyo3(signature = (along=0, at=0.0))]
    fn profile<'py>(&self, py: Python<'py>, along: usize, at: f64) -> PyResult<Bound<'py, PyDict>> {
        let line = self.get()?.profile(axis(along)?, at).or_raise()?;
        let all = PyDict::new(py);
        let columns = [
            ("position", line.positions),
            ("pressure", line.pressure),
            ("displacement", line.displacement),
            ("gap", line.gap),
            ("traction", line.traction),
        ];
        for (name, column) in columns {
            all.set_item(name, column.into_pyarray(py))?;
        }
        Ok(all)
    }

    /// The connected patches of the contact: an array of labels (0 out of contact, k + 1 in patch k), and for each patch a dict of
    /// "cells", "area" [m²], "force" [N], "centroid" [m], "max_pressure" [Pa] and "winds" (around periodic axes).
    fn patches<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Vec<Bound<'py, PyDict>>)> {
        let contact = self.get()?;
        let patches = py.detach(|| contact.patches()).or_raise()?;
        let of = |patch: &ob::Patch| {
            let all = PyDict::new(py);
            all.set_item("cells", patch.cells)?;
            all.set_item("area", patch.area)?;
            all.set_item("force", patch.force)?;
            all.set_item("centroid", (patch.centroid[0], patch.centroid[1]))?;
            all.set_item("max_pressure", patch.max_pressure)?;
            all.set_item("winds", (patch.winds[0], patch.winds[1]))?;
            Ok(all)
        };
        let all = patches.all.iter().map(of).collect::<PyResult<_>>()?;
        Ok((patches.labels.into_pyarray(py).reshape(contact.grid().cells())?.into_any(), all))
    }

    /// Centre of pressure [m] and reach from the point `about` to the ends of the contact, along x1 and x2, back and ahead [m]; None
    /// without contact.
    #[allow(clippy::type_complexity)]
    fn asymmetry(&self, about: [f64; 2]) -> PyResult<Option<([f64; 2], [[f64; 2]; 2])>> {
        let found = self.get()?.asymmetry(about).or_raise()?;
        Ok(found.map(|found| (found.center_of_pressure, found.reach)))
    }

    /// The stress below the surface of the creeping body, or with `in_counter_body` of the other one.
    ///
    /// Raises NotImplementedError where it is not known: in layers, or with an elastic bulk.
    #[pyo3(signature = (*, in_counter_body=false))]
    fn stress(&self, py: Python<'_>, in_counter_body: bool) -> PyResult<SubsurfaceStress> {
        let contact = self.get()?;
        let stress = py
            .detach(|| if in_counter_body { contact.stress_in_counter_body() } else { contact.stress() })
            .or_raise()?;
        Ok(SubsurfaceStress(stress))
    }
}

fn distribution<'py>(py: Python<'py>, of: &ob::Distribution) -> PyResult<(f64, Array<'py>, Array<'py>)> {
    let (centers, bins) = (of.centers().collect::<Vec<_>>(), of.density.len());
    Ok((of.share_at_zero, to_array(py, centers, &[bins])?, to_array(py, of.density.clone(), &[bins])?))
}

/// The stress below the surface [Pa]: tension positive, x3 the depth. Components are in the order 11, 22, 33, 12, 13, 23.
///
/// >>> contact = ViscoelasticContact(Grid(32, 1e-3), Shape.sphere(10e-3), Material(Rheology.elastic(1e6)))
/// >>> _ = contact.step(0.0, Load.force(0.01))
/// >>> contact.stress().on_plane(1e-4).shape
/// (32, 32, 6)
/// >>> contact.stress().greatest([5e-5, 1e-4, 2e-4])["value"] > 0
/// True
#[pyclass(frozen, module = "viscocontact")]
pub struct SubsurfaceStress(ob::SubsurfaceStress);

fn components(values: Vec<Stress>) -> Vec<f64> {
    values.iter().flat_map(Stress::components).collect()
}

/// A quantity of a stress, by name.
type Quantity = (&'static str, fn(&Stress) -> f64);

const QUANTITIES: [Quantity; 5] = [
    ("von_mises", Stress::von_mises),
    ("tresca", Stress::tresca),
    ("mean", Stress::mean),
    ("principal_1", |stress| stress.principal()[0]),
    ("principal_3", |stress| stress.principal()[2]),
];

#[pymethods]
impl SubsurfaceStress {
    /// The least depth at which the stress is given [m].
    #[getter]
    fn least_depth(&self) -> f64 {
        self.0.least_depth()
    }

    /// The components below each cell at a `depth` [m]: an array of shape (n1, n2, 6).
    fn on_plane<'py>(&self, py: Python<'py>, depth: f64) -> PyResult<Array<'py>> {
        let [n1, n2] = self.0.grid().cells();
        let values = py.detach(|| self.0.on_plane(depth)).or_raise()?;
        to_array(py, components(values), &[n1, n2, 6])
    }

    /// A section below the line of cells in the direction of the axis `along` at the other coordinate `at` [m]: positions [m], and the
    /// components as an array of shape (positions, depths, 6).
    fn on_section<'py>(
        &self,
        py: Python<'py>,
        along: usize,
        at: f64,
        depths: Vec<f64>,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let along = axis(along)?;
        let section = py.detach(|| self.0.on_section(along, at, &depths)).or_raise()?;
        let n = section.positions.len();
        let values = to_array(py, components(section.values), &[n, depths.len(), 6])?;
        Ok((to_array(py, section.positions, &[n])?, values))
    }

    /// The components at points (x1, x2, depth) [m], an array of shape (n, 3): an array of shape (n, 6).
    fn at<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let points: Vec<[f64; 3]> = table("points", points)?;
        let values = py.detach(|| self.0.at(&points)).or_raise()?;
        to_array(py, components(values), &[points.len(), 6])
    }

    /// Where "von_mises", "tresca", "mean", "principal_1" or "principal_3" is greatest between the depths [m]: "value" [Pa], "position"
    /// [m] and "components".
    #[pyo3(signature = (depths, quantity="von_mises"))]
    fn greatest<'py>(&self, py: Python<'py>, depths: Vec<f64>, quantity: &str) -> PyResult<Bound<'py, PyDict>> {
        let quantity = choice("quantity", quantity, &QUANTITIES)?;
        let peak = py.detach(|| self.0.greatest(&depths, quantity)).or_raise()?;
        let all = PyDict::new(py);
        all.set_item("value", peak.value)?;
        all.set_item("position", peak.position)?;
        all.set_item("components", peak.stress.components().to_vec())?;
        all.set_item("at_end_of_depths", peak.at_end_of_depths)?;
        Ok(all)
    }
}
