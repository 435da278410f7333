//! The stress below the surface, and what follows a run: its history, and the balance of its energy.

use viscocontact::contact as ct;
use viscocontact::observe::{self as ob, Stress};
use viscocontact::output::{Format, write_stress};

use crate::arrays::{field, table};
use crate::fields::Showing;
use crate::prelude::*;
use crate::writers::{FORMATS, metadata};

/// The stress below the surface [Pa]: tension positive, x3 the depth. Components are in the order 11, 22, 33, 12, 13, 23.
///
/// Contacts have it as `stress()`; this makes it of a pressure.
///
/// Parameters
/// ----------
/// kernel : InfluenceKernel
///     The body, a half-space; under the pressure of another body an estimate, where this is thick.
/// pressure : array of the shape of the grid [Pa]
/// nu : float
///     Poisson's ratio.
///
/// `quantity` of its methods gives one number in place of the components: "von_mises", "tresca", "mean", "principal_1" or "principal_3".
///
/// >>> contact = ViscoelasticContact(Grid(32, 1e-3), Shape.sphere(10e-3), Material(Rheology.elastic(1e6)))
/// >>> _ = contact.step(0.0, Load.force(0.01))
/// >>> contact.stress().on_plane(1e-4).shape
/// (32, 32, 6)
/// >>> contact.stress().on_plane(1e-4, quantity="von_mises").shape
/// (32, 32)
/// >>> contact.stress().maximum([5e-5, 1e-4, 2e-4])["value"] > 0
/// True
#[pyclass(frozen, module = "viscocontact")]
pub struct SubsurfaceStress(pub ob::SubsurfaceStress);

/// A quantity of a stress, by name.
type Quantity = (&'static str, fn(&Stress) -> f64);

pub const QUANTITIES: [Quantity; 5] = [
    ("von_mises", Stress::von_mises),
    ("tresca", Stress::tresca),
    ("mean", Stress::mean),
    ("principal_1", |stress| stress.principal()[0]),
    ("principal_3", |stress| stress.principal()[2]),
];

/// The components, or a quantity of them, as an array of `shape`, with the components along the last axis.
fn shown<'py>(py: Python<'py>, of: &[Stress], quantity: Option<&str>, shape: &[usize]) -> PyResult<Array<'py>> {
    match quantity {
        Some(name) => {
            let quantity = choice("quantity", name, &QUANTITIES)?;
            to_array(py, of.iter().map(quantity).collect(), shape)
        }
        None => to_array(py, of.iter().flat_map(Stress::components).collect(), &[shape, &[6]].concat()),
    }
}

#[pymethods]
impl SubsurfaceStress {
    #[new]
    fn new(py: Python<'_>, kernel: &InfluenceKernel, pressure: &Object<'_>, nu: f64) -> PyResult<SubsurfaceStress> {
        let pressure = field("pressure", pressure, kernel.kernel.grid().cells())?;
        free(py, || ob::SubsurfaceStress::new(&kernel.kernel, &pressure, nu)).or_raise().map(SubsurfaceStress)
    }

    fn __repr__(&self) -> String {
        let [n1, n2] = self.0.grid().cells();
        format!("SubsurfaceStress({n1} × {n2} cells, min_depth={} m)", digits(self.0.min_depth()))
    }

    /// The components below each cell at a `depth` [m]: an array of shape (n1, n2, 6).
    #[pyo3(signature = (depth, *, quantity=None))]
    fn on_plane<'py>(&self, py: Python<'py>, depth: f64, quantity: Option<&str>) -> PyResult<Array<'py>> {
        let values = free(py, || self.0.on_plane(depth)).or_raise()?;
        shown(py, &values, quantity, &self.0.grid().cells())
    }

    /// A section below the line of cells in the direction of the axis `along` at the other coordinate `at` [m]: positions [m], and the
    /// components as an array of shape (positions, depths, 6).
    #[pyo3(signature = (along, at, depths, *, quantity=None))]
    fn on_section<'py>(
        &self,
        py: Python<'py>,
        along: usize,
        at: f64,
        depths: Vec<f64>,
        quantity: Option<&str>,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let along = axis(along)?;
        let section = free(py, || self.0.on_section(along, at, &depths)).or_raise()?;
        let n = section.positions.len();
        let values = shown(py, &section.values, quantity, &[n, depths.len()])?;
        Ok((to_array(py, section.positions, &[n])?, values))
    }

    /// The components below each cell at each of the `depths` [m]: an array of shape (depths, n1, n2, 6).
    #[pyo3(signature = (depths, *, quantity=None))]
    fn in_volume<'py>(&self, py: Python<'py>, depths: Vec<f64>, quantity: Option<&str>) -> PyResult<Array<'py>> {
        let volume = free(py, || self.0.in_volume(&depths)).or_raise()?;
        let [n1, n2] = self.0.grid().cells();
        shown(py, &volume.values, quantity, &[depths.len(), n1, n2])
    }

    /// The components at points (x1, x2, depth) [m], an array of shape (n, 3): an array of shape (n, 6).
    #[pyo3(signature = (points, *, quantity=None))]
    fn at<'py>(&self, py: Python<'py>, points: &Object<'py>, quantity: Option<&str>) -> PyResult<Array<'py>> {
        let points: Vec<[f64; 3]> = table("points", points)?;
        let values = free(py, || self.0.at(&points)).or_raise()?;
        shown(py, &values, quantity, &[points.len()])
    }

    /// Where a quantity has its maximum between the depths [m]: "value" [Pa], "position" [m], "components", and whether it is
    /// "at_end_of_depths", so that more may lie beyond.
    #[pyo3(signature = (depths, quantity="von_mises"))]
    fn maximum<'py>(&self, py: Python<'py>, depths: Vec<f64>, quantity: &str) -> PyResult<Dict<'py>> {
        let quantity = choice("quantity", quantity, &QUANTITIES)?;
        let peak = free(py, || self.0.maximum(&depths, quantity)).or_raise()?;
        Ok(dict! { py; peak { value, position, at_end_of_depths }, "components": peak.stress.components().to_vec() })
    }

    /// Writes the stress at `depths` [m] below a `contact` of this grid: `format` "npz" (`numpy.load`) or "vtk" (name it `.vtr`: ParaView,
    /// PyVista). Arrays: "s11" to "s23", "von_mises", "tresca", each of shape (n1, n2, depths), "x1", "x2", "x3" and the "pressure".
    #[pyo3(signature = (path, contact, depths, *, format="npz", title="", notes=None))]
    #[allow(clippy::too_many_arguments)]
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        contact: Showing<'_>,
        depths: Vec<f64>,
        format: &str,
        title: &str,
        notes: Option<&Dict<'_>>,
    ) -> PyResult<()> {
        let format: Format = choice("format", format, &FORMATS)?;
        let (contact, metadata) = (contact.shown()?, metadata(title, notes)?);
        let write = || write_stress(path, format, contact, &self.0.in_volume(&depths)?, &metadata);
        free(py, write).or_raise()
    }
}

getters! {SubsurfaceStress, of:
    /// The minimum depth at which the stress is given [m].
    min_depth: f64 = of.min_depth();
    /// The grid of the surface.
    grid: Grid = Grid(of.grid().clone());
}

/// The work of the load of a contact, and what the bodies store and dissipate of it: it follows a run from before the first step.
///
/// >>> contact = ViscoelasticContact(Grid(48, 4e-3), Shape.sphere(10e-3), Material(Rheology.relaxing(4e6, 1e6, 1.0)))
/// >>> balance = EnergyBalance(contact)
/// >>> for report in contact.follow(LoadHistory.ramp(Load.approach(0.0), Load.approach(1e-4), 1.0), 11.0):
/// ...     energies = balance.record(contact, report)
/// >>> energies["viscous"] > 0.3 * energies["work"] and abs(energies["imbalance"]) < 0.01 * energies["work"]
/// True
#[pyclass(module = "viscocontact")]
pub struct EnergyBalance(ct::EnergyBalance);

fn energies<'py>(py: Python<'py>, of: ct::Energies) -> PyResult<Dict<'py>> {
    Ok(dict! { py; of { work, stored, viscous, lost }, "imbalance": of.imbalance() })
}

#[pymethods]
impl EnergyBalance {
    #[new]
    fn new(contact: Shared<'_, ViscoelasticContact>) -> PyResult<EnergyBalance> {
        ct::EnergyBalance::new(contact.get()?).or_raise().map(EnergyBalance)
    }

    fn __repr__(slf: Shared<'_, Self>) -> String {
        let of = slf.0.energies();
        let [work, stored, viscous] = [of.work, of.stored, of.viscous].map(digits);
        format!("EnergyBalance(work={work} J, stored={stored} J, viscous={viscous} J)")
    }

    /// Takes in the last step, of which this is the report, and returns `energies`.
    fn record<'py>(
        mut slf: Taken<'_, Self>,
        py: Python<'py>,
        contact: Shared<'_, ViscoelasticContact>,
        report: &StepReport,
    ) -> PyResult<Dict<'py>> {
        let (contact, balance) = (contact.get()?, &mut slf.0);
        energies(py, free(py, || balance.record(contact, &report.0)).or_raise()?)
    }

    /// Since the bodies were undisturbed [J]: the "work" of the load, what is "stored", what the creep dissipated ("viscous"), what was "lost"
    /// in jumps, and the "imbalance" of these, the error of the steps.
    #[getter]
    fn energies<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Dict<'py>> {
        energies(py, slf.0.energies())
    }
}
