//! Fields and numbers of the state of a contact of any kind.

use viscocontact as vc;
use viscocontact::fields as vf;

use crate::prelude::*;
use crate::reports::BodyState;
use crate::sliding::SteadySliding;

/// What has fields to show.
pub trait Shown {
    fn shown(&self) -> PyResult<vf::Fields<'_>>;
}

impl Shown for ViscoelasticContact {
    fn shown(&self) -> PyResult<vf::Fields<'_>> {
        self.get().map(vc::ViscoelasticContact::fields)
    }
}

impl Shown for ElasticContact {
    fn shown(&self) -> PyResult<vf::Fields<'_>> {
        Ok(self.contact.fields())
    }
}

impl Shown for Fields {
    fn shown(&self) -> PyResult<vf::Fields<'_>> {
        Ok(self.0.fields())
    }
}

/// The fields of a contact as they were: of a steady motion, of a sample of a run, of a contact on elastic states.
///
/// >>> contact = ElasticContact(Grid(32, 4e-3), Shape.sphere(10e-3), 4e6)
/// >>> _ = contact.solve(Load.force(0.5))
/// >>> before = contact.fields
/// >>> _ = contact.solve(Load.force(1.0))
/// >>> before.contact_area < contact.contact_area
/// True
#[pyclass(frozen, module = "viscocontact")]
pub struct Fields(pub vf::KeptFields);

#[pymethods]
impl Fields {
    fn __repr__(&self) -> String {
        let (of, [n1, n2]) = (self.0.fields(), self.0.fields().grid().cells());
        format!("Fields({n1} × {n2} cells, force={} N, approach={} m)", digits(of.force()), digits(of.approach()))
    }
}

/// What has fields, as an argument.
#[derive(FromPyObject)]
pub enum Showing<'py> {
    Contact(Shared<'py, ViscoelasticContact>),
    Elastic(Shared<'py, ElasticContact>),
    Sliding(Shared<'py, SteadySliding>),
    Kept(Shared<'py, Fields>),
}

impl Shown for Showing<'_> {
    fn shown(&self) -> PyResult<vf::Fields<'_>> {
        match self {
            Showing::Contact(contact) => contact.shown(),
            Showing::Elastic(contact) => contact.shown(),
            Showing::Sliding(sliding) => sliding.shown(),
            Showing::Kept(kept) => kept.shown(),
        }
    }
}

/// The arrays of a class that has fields.
macro_rules! arrays {
    ($class:ident) => {
        getters! {by shown $class, of, py:
            /// Pressure [Pa], of the shape of the grid.
            pressure: Array<'py> = to_array(py, of.pressure().to_vec(), &of.grid().cells())?;
            /// Displacement of the surface, positive into the bodies [m], of the shape of the grid.
            displacement: Array<'py> = to_array(py, of.displacement().to_vec(), &of.grid().cells())?;
            /// Gap between the deformed bodies [m], of the shape of the grid; +inf where there is nothing to touch.
            gap: Array<'py> = field(py, of, |of, values| of.gap_into(values))?;
            /// Net traction [Pa]: the pressure less the attraction, of the shape of the grid.
            traction: Array<'py> = field(py, of, |of, values| of.traction_into(values))?;
        }
    };
}

/// The numbers of a class that has fields.
macro_rules! of_fields {
    ($class:ident) => {
        getters! {by shown $class, of, py:
            /// The state of each rigid body.
            bodies: Vec<BodyState> = (0..of.bodies()).filter_map(|body| of.body(body)).map(BodyState).collect();
            /// The load on the first body.
            load: Load = Load::of(py, of.load())?;
            /// The grid of every field.
            grid: Grid = Grid(of.grid().clone());
            /// Normal force on all bodies [N].
            force: f64 = of.force();
            /// Approach of the first body, at the origin [m].
            approach: f64 = of.approach();
            /// Tilt of the first body along x1 and x2 [rad].
            tilt: (f64, f64) = of.tilt().into();
            /// Moments of the pressure about the origin, ∬ p x1 and ∬ p x2 [N·m].
            moment: (f64, f64) = of.moment().into();
            /// Cells in contact.
            contact_cells: usize = of.contact_cells();
            /// Area of contact [m²], fractions of cells included.
            contact_area: f64 = of.contact_area();
            /// Mean pressure over the contact [Pa].
            mean_pressure: f64 = of.mean_pressure();
            /// Maximum pressure of any cell [Pa].
            max_pressure: f64 = of.max_pressure();
            /// Whether the bodies are apart.
            is_separated: bool = of.is_separated();
        }
    };
}

arrays!(ViscoelasticContact);
arrays!(ElasticContact);
arrays!(Fields);
arrays!(SteadySliding);
of_fields!(ViscoelasticContact);
of_fields!(ElasticContact);
of_fields!(Fields);

/// The fields of a contact that goes on.
macro_rules! kept {
    ($($class:ident)*) => {$(
        getters! {by shown $class, of:
            /// The fields as they are, to keep.
            fields: Fields = Fields(of.keep());
        }
    )*};
}

kept! {ViscoelasticContact ElasticContact}

/// A field that a contact writes.
fn field<'py>(
    py: Python<'py>,
    of: vf::Fields<'_>,
    write: fn(&vf::Fields<'_>, &mut [f64]) -> vc::Result<()>,
) -> PyResult<Array<'py>> {
    let mut values = vec![0.0; of.grid().len()];
    free(py, || write(&of, &mut values)).or_raise()?;
    to_array(py, values, &of.grid().cells())
}

getters! {by get ViscoelasticContact, of, py:
    /// How the last step of surfaces that attract each other went: contact problems ("passes"), those given up ("rejected"), the greatest
    /// "rise" of the energy over the sum of its parts, the energy "released" [J], and whether the surfaces "jumped". None without attraction.
    passes: Option<Dict<'py>> = {
        let Some(of) = of.passes() else { return Ok(None) };
        Some(dict! { py; of { passes, rejected, rise, released, jumped } })
    };
    /// Time [s].
    time: f64 = of.time();
    /// Reduced time of the material [s].
    reduced_time: f64 = of.reduced_time();
    /// The errors of exponential series that were fitted for this contact, a line each.
    fit_reports: Vec<String> = of.material().fit_reports().map(ToString::to_string).collect();
}
