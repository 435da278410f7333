//! How far a sweep has to go for a run.

use std::sync::Arc;

use crate::ascending::Times;
use crate::error::{Result, positive};
use crate::hereditary::Interpolant;
use crate::load::{Load, LoadHistory, Tilt};
use crate::rheology::{Material, TemperatureHistory};
use crate::run::trace::looks;
use crate::run::{Contact, Stepping};
use crate::states::contact::StatesContact;
use crate::states::curve::ElasticStates;

/// Number of even parts of a run at whose ends its level is sampled, and the tolerance of its steps.
const LEVELS: u32 = 1024;
const TOLERANCE: f64 = 1e-4;
/// Factor by which a sweep goes beyond the level that a run is found to need: the load may be greater between two
/// samples, and steps err.
pub(super) const MARGIN: f64 = 1.05;

/// How far a sweep goes.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Reach {
    /// To a level \[m²\]: force times compliance. A force F held on a body of the contact creep compliance C(t)
    /// reaches F C(t).
    Level(f64),
    /// To an approach of the load point \[m\].
    Approach(f64),
    /// To the largest contact of an elastic body of unit compliance under one of these loads, and 5 % of the level
    /// beyond: a force is a level \[m²\], and the stiffness of a spring is given over the contact modulus \[m\]. The
    /// loads have the tilts of the sweep.
    Loads(Vec<Load>),
}

impl Reach {
    /// What a run of this material along a load history to the time `until` \[s\] needs.
    ///
    /// Under forces that is the maximum level of the run, which does not depend on the shape, and under approaches
    /// the maximum approach. Springs, and histories of several kinds of load, take the maximum load of each kind on
    /// an elastic body of the last contact compliance. A spring, or a force among other loads, may need more than
    /// that; a step beyond the sweep is refused then. Loads are sampled at 4097 even times and at both sides of all
    /// corners.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let rubber = Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?);
    /// let load = Ramp::new(Load::force(0.0), Load::force(0.5), 1.0)?;
    /// let sweep = Sweep::new(Grid::square(32, 4.0e-3)?, &Sphere::new(10.0e-3)?).accuracy(1.0e-3);
    /// let states = sweep.run(Reach::of(&rubber, &load, 10.0)?)?;
    /// let mut contact = StatesContact::new(&states, &rubber)?;
    /// let mut run = contact.follow(&load, Stepping::adaptive(1.0e-3), 10.0);
    /// while run.next_step()?.is_some() {}
    /// assert!(run.contact().level() > 0.9 * states.states()[states.states().len() - 1].level);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If `until` is not finite and positive, a load of the history is invalid, the material has no exponential series
    /// ([`Material::fitted`]) or is not known until then, or the load jumps on a body without elastic response.
    pub fn of(material: &Material, history: &dyn LoadHistory, until: f64) -> Result<Reach> {
        Loading { material, temperature: None, history, until }.reach()
    }

    /// As [`Reach::of`], at a temperature that changes.
    ///
    /// # Errors
    /// As [`Reach::of`].
    pub fn at_temperature(
        material: &Material,
        temperature: &TemperatureHistory,
        history: &dyn LoadHistory,
        until: f64,
    ) -> Result<Reach> {
        Loading { material, temperature: Some(temperature), history, until }.reach()
    }
}

/// A material along a load history.
#[derive(Clone, Copy)]
pub(crate) struct Loading<'a> {
    pub(crate) material: &'a Material,
    pub(crate) temperature: Option<&'a TemperatureHistory>,
    pub(crate) history: &'a dyn LoadHistory,
    pub(crate) until: f64,
}

impl Loading<'_> {
    fn reach(&self) -> Result<Reach> {
        positive("end of the run", self.until)?;
        let all = sampled(self.history, [0.0, self.until])?;
        if all.iter().all(Load::is_force) {
            return Ok(Reach::Level(MARGIN * self.greatest_level(all[0].tilt(), Interpolant::CorrectedLinear)?));
        }
        Ok(Reach::Loads(greatest(&all, self.softest_compliance()?).collect()))
    }

    pub(super) fn softest_compliance(&self) -> Result<f64> {
        softest_compliance(&[self.material], self.temperature, self.until)
    }

    /// An undisturbed contact on these states at the start of a run.
    pub(crate) fn undisturbed(
        &self,
        states: &Arc<ElasticStates>,
        interpolant: Interpolant,
        start: f64,
    ) -> Result<StatesContact> {
        let mut contact = StatesContact::new(states, self.material)?.with_interpolant(interpolant);
        contact.set_temperature(self.temperature);
        if start > 0.0 {
            contact.step_to(start, start, Load::Force { normal: 0.0, tilt: states.tilt })?;
        }
        Ok(contact)
    }

    /// The greatest level at the ends of the steps and at even parts of a run under given forces.
    fn greatest_level(&self, tilt: [Tilt; 2], interpolant: Interpolant) -> Result<f64> {
        let mut contact = self.undisturbed(&states_of(tilt)?, interpolant, 0.0)?;
        let mut greatest = 0.0_f64;
        let run = contact.follow(self.history, Stepping::adaptive(TOLERANCE), self.until);
        let mut run = run.sample_at(Times::every(self.until / f64::from(LEVELS)))?;
        while run.next_step()?.is_some() {
            for sample in run.samples() {
                greatest = greatest.max(sample?.contact().level());
            }
        }
        Ok(greatest)
    }
}

/// Some states under loads of this tilt: levels under given forces do not depend on the shape.
pub(super) fn states_of(tilt: [Tilt; 2]) -> Result<Arc<ElasticStates>> {
    let mut states = ElasticStates::sphere(1.0)?;
    Arc::make_mut(&mut states).tilt = tilt;
    Ok(states)
}

/// The loads of a run.
pub(crate) fn sampled(history: &dyn LoadHistory, ends: [f64; 2]) -> Result<Vec<Load>> {
    let mut all = Vec::new();
    for look in looks(history, ends[0], ends[1], false) {
        all.extend(look?.1);
    }
    Ok(all)
}

/// The compliance of bodies together at the end of a run, as far as they are known; at its start where it is infinite
/// then.
pub(crate) fn softest_compliance(
    bodies: &[&Material],
    temperature: Option<&TemperatureHistory>,
    until: f64,
) -> Result<f64> {
    let creeping = temperature.map_or(Ok(until), |history| history.reduced_time(0.0, until))?;
    let at = |time: f64| bodies.iter().map(|body| body.contact_compliance(time.min(body.known_until()))).sum::<f64>();
    Ok(Some(at(creeping)).filter(|softest| softest.is_finite()).unwrap_or_else(|| at(0.0)))
}

/// The greatest force, approach and drive of a spring among some loads, as loads of an elastic body of unit compliance.
pub(crate) fn greatest(all: &[Load], compliance: f64) -> impl Iterator<Item = Load> {
    let kind = |load: &Load| match *load {
        Load::Force { normal, .. } => (0, normal),
        Load::Approach { approach, .. } => (1, approach),
        Load::Spring { drive, .. } => (2, drive),
    };
    let of_kind = move |which| all.iter().filter(move |load| kind(load).0 == which);
    let greatest = (0..3).filter_map(move |which| of_kind(which).max_by(|a, b| kind(a).1.total_cmp(&kind(b).1)));
    greatest.map(move |load| as_elastic(*load, compliance))
}

/// A load of a body of this compliance as a load of a body of unit compliance.
pub(crate) fn as_elastic(load: Load, compliance: f64) -> Load {
    match load {
        Load::Force { normal, tilt } => Load::Force { normal: normal * compliance, tilt },
        Load::Spring { stiffness, drive, tilt } => Load::Spring { stiffness: stiffness * compliance, drive, tilt },
        approach @ Load::Approach { .. } => approach,
    }
}
