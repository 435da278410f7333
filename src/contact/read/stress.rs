//! The stress in bodies whose Poisson's ratio changes as they creep.

use crate::error::{Result, coverage, missing, other_contact, within};
use crate::fields::Fields;
use crate::observe::SubsurfaceStress;
use crate::rheology::Compressibility;
use crate::{Grid, memory};

/// History of the stress below the surface during a run, in a body with an elastic bulk.
///
/// Boussinesq's stress is linear in 1 − 2ν, so that by the correspondence principle the stress is A p + B r with
/// r(t) = ∫ (1 − 2ν)(t − s) dp(s) in place of (1 − 2ν) p. For an elastic bulk of modulus B the operator of 1 − 2ν is
/// 3G/(3B + G) = 3 − 9B/(3B + G): with K(t) the creep compliance to the relaxation modulus 3B + G(t),
///
/// ```text
/// (1 − 2ν)(t) = 3 − 9B K(t) = r_∞ + Σ r_k e^(−t/λ_k)
/// ```
///
/// exactly, and r takes one field per retardation time of K. Within a step the pressure is taken as linear, for which r
/// is exact: second order in the step. A contact does not compute r, since its displacements do not depend on it. A
/// history costs one field per retardation time and one pass over these fields per step.
///
/// ```
/// use viscocontact::{contact::StressHistory, observe::Stress, prelude::*};
///
/// let polymer = Material::elastic_bulk(Zener::with_time(1.0e9, 2.0e8, 0.25)?, 3.0e9)?;
/// let mut contact = ViscoelasticContact::builder(Grid::square(32, 2.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(polymer)
///     .build()?;
/// let mut history = StressHistory::new(&contact)?; // before the first load
/// for dt in [0.0, 0.1, 0.2, 0.4] {
///     contact.step(dt, Load::force(20.0))?;
///     history.record(&contact)?; // after every step
/// }
/// let stress = history.stress(&contact)?;
/// let peak = stress.maximum(&[0.1e-3, 0.2e-3, 0.3e-3, 0.4e-3], Stress::von_mises)?;
/// assert!(peak.value > 0.5 * contact.fields().max_pressure());
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct StressHistory {
    grid: Grid,
    /// The reduced time of the step recorded last.
    time: f64,
    law: Compressibility,
    /// ∫ e^(−(t − s)/λ_k) dp(s) for each retardation time.
    branches: Vec<Vec<f64>>,
    /// The pressure recorded last.
    pressure: Vec<f64>,
}

impl StressHistory {
    /// Begins the history of the body of [`Builder::material`](crate::contact::Builder::material), which must be
    /// undisturbed: call it before the first load.
    ///
    /// # Errors
    /// If the bodies are pressed already, the grid follows the indenter
    /// ([`Frame::Indenter`](crate::contact::Frame::Indenter)), so that the bodies move under it, the stress in the
    /// body is not known, or there is not enough memory.
    pub fn new<'a>(contact: impl Into<Fields<'a>>) -> Result<StressHistory> {
        StressHistory::of_body(contact.into(), 0)
    }

    /// Like [`StressHistory::new`], for the body of [`Builder::counter_body`](crate::contact::Builder::counter_body).
    ///
    /// # Errors
    /// As [`StressHistory::new`], and if there is no such body.
    pub fn of_counter_body<'a>(contact: impl Into<Fields<'a>>) -> Result<StressHistory> {
        StressHistory::of_body(contact.into(), 1)
    }

    fn of_body(contact: Fields<'_>, body: usize) -> Result<StressHistory> {
        contact.covers(coverage::STRESS_HISTORY)?;
        let material = contact.about.material.ok_or_else(|| missing("material"))?;
        let law = material.compressibility(body).ok_or_else(|| missing("counter_body"))?;
        SubsurfaceStress::body_of(contact.kernel(), !law.terms.is_empty())?;
        let peak = contact.max_pressure();
        within("pressure where the history of the stress begins", peak, peak == 0.0, "0: begin before the first load")?;
        let cells = contact.grid().len();
        let field = || memory::field("the history of the stress", cells, 0.0);
        let branches = law.terms.iter().map(|_| field()).collect::<Result<_>>()?;
        let (grid, time, pressure) = (contact.grid().clone(), contact.reduced_time(), field()?);
        Ok(StressHistory { grid, time, law, branches, pressure })
    }

    /// Takes in the step that the contact has made since the last call. Between two calls the pressure counts as
    /// linear in time, and as a jump if no time has passed.
    ///
    /// # Errors
    /// If the contact has another grid, or its time is earlier than in the last call.
    pub fn record<'a>(&mut self, contact: impl Into<Fields<'a>>) -> Result<()> {
        let contact = contact.into();
        self.check_grid(contact)?;
        let time = contact.reduced_time();
        within("time of the contact", time, time >= self.time, "no earlier than recorded")?;
        let dt = time - self.time;
        for (branch, &(_, retardation)) in self.branches.iter_mut().zip(&self.law.terms) {
            let z = dt / retardation;
            let (kept, weight) = ((-z).exp(), if z > 0.0 { -(-z).exp_m1() / z } else { 1.0 });
            for (value, (new, old)) in branch.iter_mut().zip(contact.pressure().iter().zip(&self.pressure)) {
                *value = kept * *value + weight * (new - old);
            }
        }
        self.pressure.copy_from_slice(contact.pressure());
        self.time = time;
        Ok(())
    }

    /// The stress at the end of the last recorded step.
    ///
    /// # Errors
    /// As [`SubsurfaceStress::with_changing_poisson`], and if the contact has taken another step since.
    pub fn stress<'a>(&self, contact: impl Into<Fields<'a>>) -> Result<SubsurfaceStress> {
        let contact = contact.into();
        self.check_grid(contact)?;
        let time = contact.reduced_time();
        within("time of the contact", time, time == self.time, "the time of the last recorded step")?;
        // a jump takes no time: if it was not recorded, the pressure differs
        let is_recorded = contact.pressure() == self.pressure;
        let allowed = "the peak of the last recorded step: record every step";
        within("peak pressure of the contact", contact.max_pressure(), is_recorded, allowed)?;
        let kernel = contact.kernel();
        if self.law.terms.is_empty() {
            return SubsurfaceStress::new(kernel, &self.pressure, 0.5 * (1.0 - self.law.last));
        }
        SubsurfaceStress::with_changing_poisson(kernel, &self.pressure, &self.reduced_pressure())
    }

    /// r = ∫ (1 − 2ν)(t − s) dp(s) \[Pa\] at the end of the step recorded last, one value per cell.
    pub fn reduced_pressure(&self) -> Vec<f64> {
        let mut reduced: Vec<f64> = self.pressure.iter().map(|p| self.law.last * p).collect();
        for (branch, &(share, _)) in self.branches.iter().zip(&self.law.terms) {
            reduced.iter_mut().zip(branch).for_each(|(sum, value)| *sum += share * value);
        }
        reduced
    }

    fn check_grid(&self, contact: Fields<'_>) -> Result<()> {
        contact.covers(coverage::STRESS)?;
        let remedy = ": it follows contacts on the grid that it was made for: make one of this contact";
        let other = || other_contact("the history of the stress", remedy);
        if *contact.grid() == self.grid { Ok(()) } else { Err(other()) }
    }
}
