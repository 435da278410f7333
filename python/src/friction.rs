//! Friction in space: partial slip, shear and torsion.

use std::time::Duration;

use numpy::{PyArray2, PyArrayMethods};
use pyo3::create_exception;
use viscocontact::friction as vf;

use crate::contact::timed;
use crate::loads::Tilts;
use crate::prelude::*;

create_exception!(
    viscocontact,
    Slides,
    PyValueError,
    "The body slides: friction cannot carry the forces along the surface, and the contact is as it was before the step. Prescribe its \
     motion to see it slide. `over_limit` is the force over what is carried (infinite where the bodies are apart), `direction` the motion \
     in space: shifts along x1 and x2 [m] and the twist [rad], of the largest component 1; None on elastic states.

>>> contact = StatesContact(ElasticStates.sphere(10e-3), Material(Rheology.elastic(1e6)), estimated_friction=0.5)
>>> try:
...     report = contact.step_sheared(0.0, Load.force(1.0), Load.force(1.0))
... except Slides as slides:
...     print(slides.over_limit)
2.0"
);

/// The exception of a body that slides.
pub fn slides(message: String, over_limit: f64, direction: Option<[f64; 3]>) -> PyErr {
    Python::attach(|py| {
        let raised = Slides::new_err(message);
        let direction = direction.map(|[x1, x2, twist]| (x1, x2, twist));
        let told = raised.value(py).setattr("over_limit", over_limit);
        told.and_then(|()| raised.value(py).setattr("direction", direction)).err().unwrap_or(raised)
    })
}

made! {
    /// What a surface can carry along itself: |τ| ≤ r(p).
    ///
    /// >>> FrictionLimit.coulomb(0.6).limit(1e5)
    /// 60000.0
    /// >>> FrictionLimit.lesser(FrictionLimit.coulomb(0.6), FrictionLimit.tresca(2e4)).limit(1e5)
    /// 20000.0
    #[pyclass(frozen, module = "viscocontact")]
    FrictionLimit(limit: Limit) of impl vf::FrictionLimit + 'static => |limit| Limit(Arc::new(limit))
}

/// A limit of any kind.
#[derive(Debug, Clone)]
struct Limit(Arc<dyn vf::FrictionLimit>);

impl vf::FrictionLimit for Limit {
    fn limit(&self, pressure: f64) -> f64 {
        self.0.limit(pressure)
    }
}

/// A limit by a function of Python.
struct ByFunction(Function);

impl std::fmt::Debug for ByFunction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a function of Python")
    }
}

impl vf::FrictionLimit for ByFunction {
    fn limit(&self, pressure: f64) -> f64 {
        raised_number(self.0.call((pressure,)), f64::NAN)
    }
}

makers! {FrictionLimit, py:
    /// Coulomb's law of this coefficient of friction, r = f p.
    coulomb(coefficient: f64) = vf::Coulomb::new(coefficient);

    /// A constant shear strength [Pa] wherever surfaces touch, r = τ₀, as smooth rubber has on glass.
    tresca(strength: f64) = vf::Tresca::new(strength);

    /// The lesser of two limits.
    lesser(one: Bound<'_, FrictionLimit>, other: Bound<'_, FrictionLimit>) =
        sure(vf::Lesser(one.get().limit.clone(), other.get().limit.clone()));
}

#[pymethods]
impl FrictionLimit {
    /// A function of the pressure [Pa] that returns r [Pa], 0 or more.
    ///
    /// An exception of the function comes out of the step, which changes nothing.
    #[staticmethod]
    fn function(py: Python<'_>, limit: Function) -> PyResult<FrictionLimit> {
        let recipe = Recipe::new(py, "function", (limit.clone(),))?.calling([limit.clone()]);
        Ok(FrictionLimit::by(recipe, ByFunction(limit)))
    }

    /// r [Pa] under pressures [Pa].
    fn limit<'py>(&self, pressure: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("pressure", pressure, FROM_ZERO, |pressure| vf::FrictionLimit::limit(&self.limit, pressure), never)
    }
}

made! {
    /// What acts on a body along the surface at the end of a step.
    ///
    /// Parameters
    /// ----------
    /// force : pair of float or None, optional
    ///     Forces along x1 and x2 [N].
    /// motion : pair of float or None, optional
    ///     Displacements of the body along x1 and x2 since the contact was made [m]. Each axis has a force or a motion, and None in the other pair.
    /// torque : float, optional
    ///     About the normal through the origin, from x1 to x2 [N m].
    /// angle : float, default 0
    ///     By which the body has turned [rad]; without `torque`.
    ///
    /// >>> pulled = ShearLoad((0.3, 0.0))                            # along x1; it does not turn
    /// >>> moved = ShearLoad((0.0, None), (None, 2e-6), torque=0.0)  # along x2, free along x1 and to turn
    #[pyclass(frozen, module = "viscocontact")]
    ShearLoad(load: vf::ShearLoad)
}

#[pymethods]
impl ShearLoad {
    #[new]
    #[pyo3(signature = (force=None, motion=None, *, torque=None, angle=None))]
    fn new(py: Python<'_>, force: Tilts, motion: Tilts, torque: Option<f64>, angle: Option<f64>) -> PyResult<Self> {
        let component = |along: &str, [force, motion]: [Option<f64>; 2]| match (force, motion) {
            (Some(force), None) => Ok(vf::Component::Force(force)),
            (None, Some(motion)) => Ok(vf::Component::Motion(motion)),
            _ => Err(PyTypeError::new_err(format!("give one of {along}, and None for the other"))),
        };
        let along = |axis: usize| [force, motion].map(|given| given.and_then(|given| given[axis]));
        let twist = [torque, angle.or(if torque.is_none() { Some(0.0) } else { None })];
        let components = [
            component("force and motion along x1", along(0))?,
            component("force and motion along x2", along(1))?,
            component("torque and angle", twist)?,
        ];
        let pairs = (force.map(<(_, _)>::from), motion.map(<(_, _)>::from));
        let keywords = dict! { py; "torque": torque, "angle": angle };
        Ok(ShearLoad::by(Recipe::new(py, "", pairs)?.with_keywords(Some(&keywords))?, vf::ShearLoad { components }))
    }
}

/// A contact that is pressed as a `ViscoelasticContact` is, and sheared: each cell sticks, or slips at the limit of friction.
///
/// Parameters
/// ----------
/// grid, geometry, material
///     As of `ViscoelasticContact`, of one body.
/// friction : float or FrictionLimit
///     The coefficient of friction, or another limit.
/// options
///     Keywords of `ViscoelasticContact`, but `time_rule` (steps are linear) and `attraction`.
///
/// Raises NotImplementedError of bodies whose response along the surface is not covered: it takes half-spaces, periodic bodies and line
/// contacts of ν = ½ on a rigid body, or two bodies of one material.
///
/// Copies go their own way: `copy.copy(contact)`.
///
/// >>> rubber = Material(Rheology.zener(1e6, 1e6, 1.0))
/// >>> contact = FrictionContact(Grid(32, 4e-3), Shape.sphere(10e-3), rubber, 0.5)
/// >>> report = contact.step(0.0, Load.force(1.0), ShearLoad((0.0, 0.0)))
/// >>> report = contact.step(0.0, Load.force(1.0), ShearLoad((0.3, 0.0)))    # 60 % of what friction carries: the middle sticks
/// >>> 0 < contact.stick_cells < contact.normal.contact_cells
/// True
/// >>> contact.step(0.0, Load.force(1.0), ShearLoad((0.6, 0.0)))
/// Traceback (most recent call last):
/// Slides: ...
/// >>> round(contact.lateral_force[0], 8)    # as it was before
/// 0.3
#[pyclass(module = "viscocontact")]
pub struct FrictionContact {
    pub contact: vf::FrictionContact,
    pub recipe: Recipe,
    cancel: Arc<AtomicBool>,
    last: Duration,
}

#[pymethods]
impl FrictionContact {
    #[new]
    #[pyo3(
        signature = (grid, geometry, material, friction, **options),
        text_signature = "(grid, geometry, material, friction, **options)"
    )]
    fn new(
        py: Python<'_>,
        grid: Bound<'_, Grid>,
        geometry: Bound<'_, PyAny>,
        material: Bound<'_, Material>,
        friction: Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<FrictionContact> {
        let needed = |_| PyTypeError::new_err("friction: a number or a FrictionLimit is needed");
        let limit = match friction.cast::<FrictionLimit>() {
            Ok(limit) => limit.get().limit.clone(),
            Err(_) => Limit(Arc::new(vf::Coulomb::new(friction.extract().map_err(needed)?).or_raise()?)),
        };
        if options.is_some_and(|options| options.contains("time_rule").unwrap_or(false)) {
            return Err(unexpected("FrictionContact", "time_rule", ""));
        }
        let builder = builder(grid.get(), &geometry, material.get(), options)?;
        let contact = free(py, || vf::FrictionContact::new(builder, limit)).or_raise()?;
        let recipe = Recipe::new(py, "", (grid, geometry, material, friction))?.with_keywords(options)?;
        Ok(FrictionContact { contact, recipe, cancel: Arc::default(), last: Duration::ZERO })
    }

    /// Advances by `dt` [s] to a load, and to what acts along the surface; `dt` = 0 is a jump.
    ///
    /// A step in which both rise together is oblique loading. To press first and then to shear takes two steps, of no time if it happens at
    /// once. Ctrl-C ends the step within an iteration. A step that fails leaves the contact as it was.
    ///
    /// Returns the cost and accuracy: the report of the "normal" contact, Newton steps along the surface ("iterations"), their work in
    /// "convolutions" of a pressure on the whole grid, and the largest slip of a cell that sticks, over the largest displacement ("residual").
    ///
    /// Raises `Slides` if friction cannot carry the forces; otherwise as `ViscoelasticContact.step`.
    fn step<'py>(
        mut slf: Taken<'_, Self>,
        py: Python<'py>,
        dt: f64,
        load: &Load,
        shear: &ShearLoad,
    ) -> PyResult<Bound<'py, PyDict>> {
        let FrictionContact { contact, cancel, last, .. } = &mut *slf;
        let (cells, load, shear) = (contact.normal().grid().len(), load.load, shear.load);
        let step = |slow| interruptible(py, slow, cancel, || contact.step_unless(cancel, dt, load, shear));
        match timed(last, cells, step)? {
            vf::Outcome::Holds(of) => Ok(dict! { py;
                "normal": StepReport(of.normal),
                "iterations": of.iterations,
                "convolutions": of.convolution_equivalents,
                "residual": of.residual,
            }),
            vf::Outcome::Slides { direction, over_limit } => {
                let text = format!(
                    "the body slides: the forces along the surface are {over_limit:.5} times what friction carries"
                );
                Err(slides(text, over_limit, Some(direction)))
            }
            _ => Err(PyValueError::new_err("this outcome of a step has no name in Python")),
        }
    }

    /// The fields in the normal direction, to keep: pressure, gap, displacement and what is made of them.
    #[getter]
    fn normal(slf: Shared<'_, Self>) -> Fields {
        Fields(slf.contact.normal().fields().keep())
    }

    /// Tractions along x1 and x2 [Pa]: two fields, of the shape (2, cells, cells).
    #[getter]
    fn traction<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        slf.both(py, slf.contact.traction())
    }

    /// Slip of the body over the surface in the last step along x1 and x2 [m], 0 where bodies are apart: of the shape (2, cells, cells).
    #[getter]
    fn slip<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Array<'py>> {
        slf.both(py, slf.contact.slip())
    }

    /// Whether each cell sticks, of the shape of the grid.
    #[getter]
    fn sticks<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        slf.contact.sticks().into_pyarray(py).reshape(slf.contact.normal().grid().cells())
    }

    /// Where the work along the surface went since the contact was made [J]: "work" = "slip" + "stored" + "creep". Of a jump under a
    /// constant normal load it is exact as far as each cell slips in one direction; in time the errors of the work are of second order.
    #[getter]
    fn lateral_work<'py>(slf: Shared<'_, Self>, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let contact = &slf.contact;
        let of = free(py, || contact.lateral_work());
        Ok(dict! { py; of { work, slip, stored, creep } })
    }

    fn __copy__(slf: Shared<'_, Self>, py: Python<'_>) -> FrictionContact {
        let contact = &slf.contact;
        let contact = free(py, || contact.clone());
        FrictionContact { contact, recipe: slf.recipe.again(py), cancel: Arc::default(), last: slf.last }
    }

    fn __deepcopy__(slf: Shared<'_, Self>, py: Python<'_>, _memo: Bound<'_, PyAny>) -> FrictionContact {
        Self::__copy__(slf, py)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Traversed {
        self.recipe.traverse(&visit)
    }

    fn __repr__(slf: Shared<'_, Self>) -> String {
        let (of, [x1, x2, _]) = (slf.contact.normal(), slf.contact.force());
        let ([n1, n2], time, force) = (of.grid().cells(), of.time(), of.force());
        format!(
            "FrictionContact({n1} × {n2} cells, time={time} s, force={force:e} N, along the surface ({x1:e}, {x2:e}) N)"
        )
    }
}

impl FrictionContact {
    fn both<'py>(&self, py: Python<'py>, fields: [Vec<f64>; 2]) -> PyResult<Array<'py>> {
        let [n1, n2] = self.contact.normal().grid().cells();
        to_array(py, fields.concat(), &[2, n1, n2])
    }
}

impl FrictionContact {
    pub fn get(&self) -> PyResult<&vf::FrictionContact> {
        Ok(&self.contact)
    }
}

getters! {by get FrictionContact, of:
    /// Time [s].
    time: f64 = of.normal().time();
    /// How far the body has moved along x1 and x2 [m] and turned [rad].
    motion: (f64, f64, f64) = of.motion().into();
    /// Normal force [N].
    force: f64 = of.normal().force();
    /// Force along x1 and x2 [N] that moves the body.
    lateral_force: (f64, f64) = (of.force()[0], of.force()[1]);
    /// Torque about the normal [N m] that turns it.
    torque: f64 = of.force()[2];
    /// Cells that stick.
    stick_cells: usize = of.stick_cells();
}
