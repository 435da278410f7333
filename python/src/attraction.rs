//! The attraction between surfaces.

use std::fmt;
use std::sync::{Mutex, PoisonError};

use crate::prelude::*;
use viscocontact::UserError;
use viscocontact::adhesion::{self as ad, Attraction as Law};

made! {
    /// A law of the attraction between surfaces: traction [Pa] over gap [m].
    ///
    /// Laws have the `work` of separation w [J/m²] and a `range` ρ [m], or the maximum traction `max_traction` [Pa] in its place.
    ///
    /// >>> law = Attraction.exponential(0.05, 0.1e-6)
    /// >>> law.work, law.range
    /// (0.05, 1e-07)
    #[pyclass(frozen, module = "viscocontact")]
    Attraction(pub law: Arc<dyn Law>) of impl Law + 'static => Arc::new
}

/// Laws by their work, and their range or maximum traction.
macro_rules! laws {
    ($($(#[$doc:meta])* $name:ident($($more:ident),*) = $law:ident;)*) => {
        #[pymethods]
        impl Attraction {
            $(
                $(#[$doc])*
                #[staticmethod]
                #[pyo3(signature = (work, range=None, *, max_traction=None $(, $more=None)*))]
                fn $name(
                    py: Python<'_>,
                    work: f64,
                    range: Option<f64>,
                    max_traction: Option<f64>,
                    $($more: Option<f64>),*
                ) -> PyResult<Attraction> {
                    let law = match (range, max_traction) {
                        (Some(range), None) => ad::$law::new(work, range),
                        (None, Some(most)) if most > 0.0 && most.is_finite() => ad::$law::new(work, work / most),
                        (None, Some(most)) => {
                            let says = format!("max_traction = {most:?} is not allowed: it must be finite and > 0");
                            return Err(PyValueError::new_err(says));
                        }
                        _ => return Err(PyTypeError::new_err("give range or max_traction, one of them")),
                    };
                    $(let law = law.and_then(|law| $more.map_or(Ok(law), |width| law.with_width(width)));)*
                    let keywords = dict! { py; "range": range, "max_traction": max_traction };
                    $(keywords.set_item(stringify!($more), $more)?;)*
                    let recipe = Recipe::new(py, stringify!($name), (work,))?.with_keywords(Some(&keywords))?;
                    Ok(Attraction::by(recipe, law.or_raise()?))
                }
            )*
        }
    };
}

laws! {
    /// An attraction that decays exponentially with the gap: (w/ρ) exp(−h/ρ).
    exponential() = ExponentialAttraction;

    /// The attraction of half-spaces whose molecules attract each other with the sixth power of their distance.
    van_der_waals() = VanDerWaals;

    /// An attraction that falls linearly with the gap, to zero at twice the range.
    linear_softening() = LinearSoftening;

    /// The constant attraction of Dugdale and Maugis up to the range, with an end of `width` over the range.
    dugdale(width) = Dugdale;
}

#[pymethods]
impl Attraction {
    /// Your own law: functions of the gap [m], 0 or more: the traction [Pa], which never grows with the gap, and the energy [J/m²], its
    /// integral from the gap to infinity.
    ///
    /// An exception of a function comes out of the step that needed it.
    #[staticmethod]
    fn function(py: Python<'_>, traction: Function, energy: Function) -> PyResult<Attraction> {
        let recipe = Recipe::new(py, "function", (traction.clone(), energy.clone()))?
            .calling([traction.clone(), energy.clone()]);
        let law = OwnLaw { traction, energy, failure: Mutex::default() };
        let _ = (law.traction(0.0), law.energy(0.0));
        nothing_raised(law.failure())?;
        Ok(Attraction::by(recipe, law))
    }

    /// Checks the laws of attractions: a traction that falls with the gap, and the energy its integral. Raises ValueError with the first
    /// violation.
    fn check(&self, py: Python<'_>) -> PyResult<()> {
        let verdict = free(py, || ad::laws::all(&*self.law));
        no_violation(self.law.failure(), verdict)
    }

    /// Traction [Pa] at gaps [m].
    fn traction<'py>(&self, gap: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("gap", gap, FROM_ZERO, |gap| self.law.traction(gap), || self.law.failure())
    }

    /// Energy [J/m²] that opens the gap [m] to infinity.
    fn energy<'py>(&self, gap: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("gap", gap, FROM_ZERO, |gap| self.law.energy(gap), || self.law.failure())
    }

    /// Tabor's number of a sphere of `radius` [m] on a body of contact `modulus` E* [Pa].
    fn tabor_number(&self, radius: f64, modulus: f64) -> PyResult<f64> {
        let number = ad::tabor_number(&*self.law, radius, modulus);
        nothing_raised(self.law.failure())?;
        number.or_raise()
    }
}

getters! {Attraction.law, of:
    /// Work of separation [J/m²].
    work: PyResult<f64> = {
        let work = of.work();
        nothing_raised(of.failure()).map(|()| work)
    };
    /// Range: work over the maximum traction [m].
    range: PyResult<f64> = {
        let range = of.range();
        nothing_raised(of.failure()).map(|()| range)
    };
}

/// A law of two functions in Python.
struct OwnLaw {
    traction: Function,
    energy: Function,
    failure: Mutex<Option<UserError>>,
}

impl OwnLaw {
    fn call(&self, function: &Function, gap: f64) -> f64 {
        function.call((gap,)).unwrap_or_else(|error: PyErr| {
            *self.failure.lock().unwrap_or_else(PoisonError::into_inner) =
                Some(UserError::new("the attraction", error));
            f64::NAN
        })
    }
}

impl Law for OwnLaw {
    fn traction(&self, gap: f64) -> f64 {
        self.call(&self.traction, gap)
    }

    fn energy(&self, gap: f64) -> f64 {
        self.call(&self.energy, gap)
    }

    fn failure(&self) -> Option<UserError> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl fmt::Debug for OwnLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a law of two functions")
    }
}
