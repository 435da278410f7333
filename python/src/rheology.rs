//! Rheologies: the shear creep of bodies.

use numpy::{Complex64, PyArrayMethods};
use viscocontact::rheology::{self as rh, CreepSpectrum, Rheology as Body};

use crate::arrays::{pairs, values};
use crate::prelude::*;

made! {
    /// The shear creep of a linear viscoelastic body: J(t), the strain after a unit shear stress [1/Pa].
    ///
    /// Its static methods make the models; moduli are in Pa, times in s, compliances in 1/Pa. A `Material` adds the response in volume.
    ///
    /// >>> rubber = Rheology.generalized_maxwell(1e6, [(5e6, 1e-3), (2e6, 0.1)])
    /// >>> rubber.creep_compliance(0.0) * 8e6
    /// 1.0
    /// >>> rubber
    /// Rheology.generalized_maxwell(1000000.0, [(5000000.0, 0.001), (2000000.0, 0.1)])
    #[pyclass(frozen, weakref, module = "viscocontact")]
    Rheology(pub body: Arc<dyn Body>) of impl Body + 'static => Arc::new
}

impl Rheology {
    fn spectrum(&self) -> PyResult<CreepSpectrum> {
        self.body.creep_spectrum().ok_or_else(|| {
            PyValueError::new_err("this rheology has no exact exponential series: take fitted(first, last, tolerance)")
        })
    }
}

makers! {Rheology, py:
    /// An elastic body of shear modulus `g` [Pa]: J = 1/G.
    elastic(g: f64) = rh::Elastic::new(g);

    /// An elastic body of Young's modulus `e` [Pa] and Poisson's ratio `nu`; its `Material` needs the same `nu`.
    elastic_young(e: f64, nu: f64) = rh::Elastic::young(e, nu);

    /// A published Prony series in shear (`published_materials`), by Poisson's ratio where it was measured in tension.
    published(name: &str, nu: f64) = rh::library::find(name).and_then(|found| found.rheology(nu));

    /// Spring `g` [Pa] and dashpot in series, of `relaxation_time` [s]: a fluid.
    maxwell(g: f64, relaxation_time: f64) = rh::Maxwell::with_time(g, relaxation_time);

    /// Spring `g` [Pa] and dashpot in parallel, of `retardation_time` [s]: no elastic response.
    kelvin_voigt(g: f64, retardation_time: f64) = rh::KelvinVoigt::with_time(g, retardation_time);

    /// A spring `g` [Pa] in series with a spring `g_k` [Pa] and a dashpot in parallel, of `retardation_time` [s]: the standard linear
    /// solid.
    zener(g: f64, g_k: f64, retardation_time: f64) = rh::Zener::with_time(g, g_k, retardation_time);

    /// The standard linear solid whose modulus relaxes from `glassy` to `rubbery` [Pa] with `relaxation_time` [s].
    relaxing(glassy: f64, rubbery: f64, relaxation_time: f64) = rh::Zener::relaxing(glassy, rubbery, relaxation_time);

    /// A Maxwell element (modulus `g` [Pa], `relaxation_time` [s]) and a Kelvin–Voigt element (`g_k` [Pa], `retardation_time` [s]) in
    /// series.
    burgers(g: f64, relaxation_time: f64, g_k: f64, retardation_time: f64) =
        rh::Burgers::with_times((g, relaxation_time), (g_k, retardation_time));

    /// Springs and dashpots beside each other, G(t) = G∞ + Σ G_k exp(−t/τ_k): the `equilibrium` modulus [Pa] (0 for a fluid) and rows
    /// (modulus [Pa], relaxation time [s]). Shares in place of moduli: `prony`.
    generalized_maxwell(equilibrium: f64, terms: Value<'_>) =
        rh::GeneralizedMaxwell::new(equilibrium, &pairs("terms", &terms)?);

    /// A creep series J(t) = J_g + φ t + Σ J_k (1 − exp(−t/λ_k)): `glassy` compliance [1/Pa], `fluidity` [1/(Pa·s)], rows (compliance
    /// [1/Pa], retardation time [s]).
    generalized_kelvin(glassy: f64, fluidity: f64, terms: Value<'_>) =
        rh::GeneralizedKelvin::new(glassy, fluidity, &pairs("terms", &terms)?);

    /// A springpot J(t) = J₁ (t/t₁)^α: `compliance` J₁ [1/Pa] at `time` t₁ [s], `exponent` α.
    power_law(compliance: f64, time: f64, exponent: f64) = rh::PowerLaw::new(compliance, time, exponent);

    /// A spring `g` [Pa] and a springpot in series that creeps as much as the spring at `time` [s].
    fractional_maxwell(g: f64, time: f64, exponent: f64) = rh::FractionalMaxwell::with_time(g, time, exponent);

    /// Findley's form J = J₀ + m tⁿ: `glassy` J₀ [1/Pa], `coefficient` m, `exponent` n.
    findley(glassy: f64, coefficient: f64, exponent: f64) =
        rh::FractionalMaxwell::findley(glassy, coefficient, exponent);

    /// The standard linear solid with a springpot of `exponent` in place of the dashpot, of retardation `time` [s].
    fractional_zener(g: f64, g_k: f64, time: f64, exponent: f64) = rh::FractionalZener::new(g, g_k, time, exponent);

    /// The fractional standard linear solid whose modulus relaxes from `glassy` to `rubbery` [Pa], of relaxation `time` [s].
    fractional_relaxing(glassy: f64, rubbery: f64, time: f64, exponent: f64) =
        rh::FractionalZener::relaxing(glassy, rubbery, time, exponent);

    /// A stretched exponential J(t) = J_g + ΔJ [1 − exp(−(t/λ)^β)].
    kww(glassy: f64, retarded: f64, time: f64, exponent: f64) = rh::Kww::new(glassy, retarded, time, exponent);

    /// Logarithmic creep J(t) = J_g + c ln(1 + t/λ).
    log_creep(glassy: f64, strength: f64, time: f64) = rh::LogCreep::new(glassy, strength, time);

    /// Log-power creep J(t) = J_g + c ln(1 + (t/λ)ⁿ).
    slow_creep(glassy: f64, strength: f64, time: f64, exponent: f64) =
        rh::SlowCreep::new(glassy, strength, time, exponent);

    /// A Prony series as finite-element programs write it: the `glassy` modulus [Pa] and rows (share of it, relaxation time [s]), of shares
    /// that add up to 1 at most. Moduli in place of shares: `generalized_maxwell`.
    prony(glassy: f64, terms: Value<'_>) = rh::GeneralizedMaxwell::prony(glassy, &shares(&terms)?);

    /// The same relative to the `rubbery` modulus [Pa]: rows (modulus over it, relaxation time [s]).
    prony_long_term(rubbery: f64, terms: Value<'_>) =
        rh::GeneralizedMaxwell::prony_long_term(rubbery, &shares(&terms)?);
}

#[pymethods]
impl Rheology {
    /// Your own shear creep compliance: a function of the time t ≥ 0 [s] that returns J [1/Pa], never decreasing.
    ///
    /// An exception of the function comes out of the call that needed the compliance.
    ///
    /// >>> own = Rheology.function(lambda t: 1e-6 * (1 + t**0.3))
    /// >>> own.creep_compliance(1.0)
    /// 2e-06
    #[staticmethod]
    fn function(py: Python<'_>, creep_compliance: Function) -> PyResult<Rheology> {
        let function = creep_compliance.clone();
        let made = rh::FnRheology::fallible(move |t: f64| function.call::<f64>((t,)));
        Ok(Rheology::by(Recipe::new(py, "function", (creep_compliance.clone(),))?.calling([creep_compliance]), made))
    }

    /// Checks the laws of creep at ascending times [s]: not negative, not decreasing, concave, and as its series. Raises ValueError with the
    /// first violation.
    ///
    /// >>> Rheology.function(lambda t: 1e-6 * (1 + t**2)).check([0.0, 1.0, 2.0, 3.0])
    /// Traceback (most recent call last):
    /// ValueError: ...
    fn check(&self, py: Python<'_>, times: &Object<'_>) -> PyResult<()> {
        let times = column("times", times)?;
        let verdict = free(py, || rh::laws::all(&*self.body, &times));
        no_violation(self.body.failure(), verdict)
    }

    /// J(t) [1/Pa] at times [s]: a float, or an array of the shape of `t`.
    fn creep_compliance<'py>(&self, t: &Object<'py>) -> PyResult<Object<'py>> {
        mapped("t", t, FROM_ZERO, |t| self.body.creep_compliance(t), || self.body.failure())
    }

    /// G(t) [Pa] at times [s], without an immediate dashpot. Raises ValueError without an exponential series (`fitted`).
    fn relaxation_modulus<'py>(&self, t: &Object<'py>) -> PyResult<Object<'py>> {
        let spectrum = self.spectrum()?.relaxation();
        mapped("t", t, FROM_ZERO, |t| spectrum.modulus(t), never)
    }

    /// G*(ω) = G′ + i G″ [Pa] at angular frequencies [rad/s]: a complex number, or an array of the shape of `omega`. G*(−ω) is the complex
    /// conjugate of G*(ω). Raises ValueError without an exponential series (`fitted`).
    fn complex_modulus<'py>(&self, py: Python<'py>, omega: &Object<'py>) -> PyResult<Object<'py>> {
        let spectrum = self.spectrum()?;
        let nan = Complex64::new(f64::NAN, f64::NAN);
        let modulus = |omega: f64| if omega.is_nan() { nan } else { spectrum.complex_modulus(omega) };
        let (values, shape) = values("omega", omega)?;
        let moduli: Vec<Complex64> = values.into_iter().map(modulus).collect();
        let moduli = moduli.into_pyarray(py).reshape(&shape[..])?.into_any();
        // of a number, a number
        if shape.is_empty() { moduli.get_item(()) } else { Ok(moduli) }
    }
}

changes! {Rheology, slf:
    /// This body fitted by an exponential series over the times from `first` to `last` [s] within a relative error.
    #[pyo3(signature = (first, last, tolerance=1e-4))]
    fitted(first: f64, last: f64, tolerance: f64) = {
        let body = &slf.get().body;
        free(slf.py(), || body.series(first..=last, tolerance))
    };
}

getters! {Rheology.body, of:
    /// The exact exponential series of J(t): glassy compliance [1/Pa], fluidity [1/(Pa·s)], rows (compliance, retardation time); None
    /// if there is none.
    creep_spectrum: Option<Series> = of.creep_spectrum().map(|spectrum| series(&spectrum));
    /// The times [s] over which it was measured or fitted; (0, inf) of formulas.
    measured: (f64, f64) = of.measured().into();
    /// The longest time at which it is known [s]; inf of formulas.
    known_until: f64 = of.known_until();
    /// The error of the series, if it was fitted, in one line.
    fit_report: Option<String> = of.fit_report().map(|report| report.to_string());
}

/// Glassy compliance, fluidity, and compliances with their retardation times.
pub type Series = (f64, f64, Vec<(f64, f64)>);

pub fn series(of: &CreepSpectrum) -> Series {
    (of.glassy(), of.fluidity(), of.terms().to_vec())
}

fn shares(terms: &Object<'_>) -> PyResult<Vec<rh::PronyTerm>> {
    Ok(pairs("terms", terms)?.into_iter().map(|(share, time)| rh::PronyTerm { share, time }).collect())
}
