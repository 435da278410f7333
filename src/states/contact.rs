//! A creeping contact on elastic states.

use std::sync::{Arc, Mutex, PoisonError};

use super::elastic::other_tilt;
use crate::contact::{Limits, StepReport};
use crate::elastic::ElasticContact;
use crate::error::{Result, non_negative};
use crate::hereditary::{ExponentialRule, Interpolant};
use crate::load::Load;
use crate::rheology::{Material, TemperatureHistory};
use crate::run::Contact;
use crate::states::coulomb::CoulombOnStates;
use crate::states::curve::ElasticStates;
use crate::states::elastic::state_under;
use crate::states::levels::{Demand, Levels, Wanted};

/// A contact of one material on the [`ElasticStates`] of its surface, advanced step by step like a
/// [`ViscoelasticContact`](crate::ViscoelasticContact), by the same time rule. Its time, force, approach, tilt,
/// contact area and whether it is apart are those of [`Contact`].
///
/// A step costs about N (N_τ + 3) multiplications for N groups of levels and N_τ relaxation times: 7 ns for each
/// group of one. Every step adds a group at most; groups merge within an error ([`StatesContact::with_merge_error`]),
/// so that N stays below about 2.5/√error. A step allocates nothing unless there are more groups than ever before.
#[derive(Clone)]
pub struct StatesContact {
    pub(super) scene: Arc<Scene>,
    pub(super) states: Arc<ElasticStates>,
    pub(super) levels: Levels,
    pub(super) time: f64,
    pub(super) reduced_time: f64,
    /// The reduced time until which the bodies were undisturbed.
    pub(super) undisturbed_until: f64,
    /// The approach of the load point that the last step prescribed \[m\].
    pub(super) prescribed: Option<f64>,
    /// The run that saved this state, for the next run to go on with.
    pub(super) saved_run: Option<Arc<dyn std::any::Any + Send + Sync>>,
}

/// What steps do not change.
#[derive(Clone)]
pub(super) struct Scene {
    /// The states of the sweep, without those added in steps.
    pub(super) swept: Arc<ElasticStates>,
    /// Solves the state of each step.
    elastic: Option<Arc<Mutex<ElasticContact>>>,
    pub(super) temperature: Option<TemperatureHistory>,
    pub(super) limits: Limits,
    pub(super) interpolant: Interpolant,
    /// Error by which groups of levels merge.
    merge_error: f64,
    pub(super) material: Material,
    pub(super) friction: Option<CoulombOnStates>,
}

/// Error by which groups of levels merge, unless another is set.
const MERGE_ERROR: f64 = 1e-6;

impl StatesContact {
    /// An undisturbed contact of a material on the surface of these states.
    ///
    /// # Errors
    /// If the material has no exponential series ([`Material::fitted`] gives it one), or another Poisson's ratio than
    /// the layer of the sweep.
    pub fn new(states: &Arc<ElasticStates>, material: &Material) -> Result<StatesContact> {
        material.validate()?;
        if let Some(poisson) = states.poisson {
            material.check_ratio_of(poisson)?;
        }
        let creep = material.spectrum_for("a contact on elastic states")?;
        let (states, limits, interpolant) = (Arc::clone(states), Limits::of(material), Interpolant::CorrectedLinear);
        let (swept, merge_error) = (Arc::clone(&states), MERGE_ERROR);
        let (elastic, temperature, material, friction) = (None, None, material.clone(), None);
        let scene = Scene { swept, elastic, temperature, limits, interpolant, merge_error, material, friction };
        let levels = Levels::new(ExponentialRule::new(&creep));
        Ok(StatesContact {
            scene: Arc::new(scene),
            states,
            levels,
            time: 0.0,
            reduced_time: 0.0,
            undisturbed_until: 0.0,
            prescribed: None,
            saved_run: None,
        })
    }

    /// With a temperature that changes: the material creeps in reduced time.
    #[must_use]
    pub fn with_temperature(mut self, temperature: TemperatureHistory) -> StatesContact {
        self.set_temperature(Some(&temperature));
        self
    }

    pub(super) fn set_temperature(&mut self, temperature: Option<&TemperatureHistory>) {
        Arc::make_mut(&mut self.scene).temperature = temperature.cloned();
    }

    /// With steps that are linear and stay so, as
    /// [`TimeRule::ExponentialLinear`](crate::contact::TimeRule::ExponentialLinear).
    #[must_use]
    pub fn with_linear_steps(self) -> StatesContact {
        self.with_interpolant(Interpolant::Linear)
    }

    /// With the steps of adaptive runs: quadratic, unless the body has no elastic response or steps are to stay linear.
    pub(super) fn with_quadratic_steps(self) -> StatesContact {
        let is_corrected = self.scene.interpolant == Interpolant::CorrectedLinear;
        if is_corrected && !self.levels.has_dashpot() {
            self.with_interpolant(Interpolant::CorrectedQuadratic)
        } else {
            self
        }
    }

    pub(crate) fn with_interpolant(mut self, interpolant: Interpolant) -> StatesContact {
        Arc::make_mut(&mut self.scene).interpolant = interpolant;
        self
    }

    /// With groups of levels that merge where this changes force and depth by at most about `error`, relative to what
    /// they are: 1e-6 unless set. The contact area errs ten times as much. A long run on a solid has at most about
    /// 2.5/√`error` groups, whatever the number of its steps and relaxation times, and a contact law in a loop is
    /// faster with 1e-4; on fluids, which keep all imprints, up to 6 times as many were counted. With friction a
    /// million steps of a fretting loop keep 80 groups with 1e-3 in place of 2800, and take a tenth of the time; the
    /// loss is then off by 1e-3, the force along the surface by 2e-4. Runs with
    /// [`Stepping::adaptive`](crate::run::Stepping::adaptive) take a hundredth of their tolerance instead; 0 merges
    /// only groups with the same past.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let rubber = Material::incompressible(Zener::with_time(1.0e6, 1.0e6, 1.0)?);
    /// let mut contact = StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &rubber)?.with_merge_error(1.0e-4)?;
    /// for step in 1..=10_000 {
    ///     contact.step(1.0e-3, Load::force(1.0 + (0.05 * f64::from(step)).sin()))?;
    /// }
    /// assert!(contact.groups() < 300);
    /// # Ok::<(), viscocontact::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the error is negative or not finite.
    pub fn with_merge_error(mut self, error: f64) -> Result<StatesContact> {
        Arc::make_mut(&mut self.scene).merge_error = non_negative("error of merged groups", error)?;
        Ok(self)
    }

    /// With the elastic state of every step solved exactly, by one elastic contact problem that starts from the last
    /// one, and added to the states of this contact. Steps then agree with those of a
    /// [`ViscoelasticContact`](crate::ViscoelasticContact) to the tolerance of the solver, also under a given
    /// approach, in area to the cell. Without it, the approach and the level under a given approach err by the
    /// interpolation of the sweep; the level under a given force does not err. Such a step allocates the state that
    /// it adds.
    ///
    /// # Errors
    /// If the states were read from a file or given as a table; those of
    /// [`Builder::build`](crate::contact::Builder::build).
    pub fn with_exact_states(mut self) -> Result<StatesContact> {
        let elastic = self.scene.swept.elastic_contact()?;
        Arc::make_mut(&mut self.scene).elastic = Some(Arc::new(Mutex::new(elastic)));
        Ok(self)
    }

    /// Advances by `dt` \[s\] to a load; `dt` = 0 is a jump. A body without elastic response cannot follow jumps but
    /// to its present load and a release. A body that tilts freely under no force rests in the limit of small forces.
    ///
    /// # Errors
    /// If `dt` is negative or not finite, or the load invalid; if the load has other tilts or another
    /// load point than the sweep, needs a state beyond it, or a group of levels leaves its order; if `dt` = 0 and the
    /// body has no elastic response, or the time under load is beyond the material's. A step that fails changes
    /// nothing but, with exact states, the states between which it interpolates.
    pub fn step(&mut self, dt: f64, load: Load) -> Result<StepReport> {
        let report = self.step_to(self.time + dt, dt, load)?;
        self.saved_run = None; // a run that a file held does not know of it
        Ok(report)
    }

    /// The demand of a load, the level that the end of a step to it has, and the reduced time there.
    fn predict(&mut self, time: f64, dt: f64, load: Load) -> Result<(Demand, Wanted, f64)> {
        non_negative("time step", dt)?;
        load.validate_in(false)?;
        let (length, reduced) = self.reduced(time, dt)?;
        let (demand, times, interpolant) = (self.demand(load)?, (time, length), self.scene.interpolant);
        // time at rest does not count
        let age = reduced - self.undisturbed_until;
        self.scene.limits.check_age(time, age, self.groups() > 0)?;
        let mut wanted = self.levels.wanted(&self.states, times, interpolant, demand)?;
        self.scene.limits.check_age(time, age, wanted.level > 0.0)?;
        if self.scene.elastic.is_some() && wanted.level > 0.0 {
            self.solve(wanted)?;
            wanted = self.levels.wanted(&self.states, times, interpolant, demand)?;
        }
        Ok((demand, wanted, reduced))
    }

    /// The length of a step in reduced time, and the reduced time at its end.
    pub(super) fn reduced(&self, time: f64, dt: f64) -> Result<(f64, f64)> {
        let Some(temperature) = &self.scene.temperature else { return Ok((dt, time)) };
        let length = temperature.reduced_time(self.time, time)?;
        Ok((length, self.reduced_time + length))
    }

    /// The depth that bodies must pass to touch at a time, if they do not touch before.
    pub(super) fn surface_at(&mut self, time: f64) -> Result<f64> {
        let (length, _) = self.reduced(time, time - self.time)?;
        Ok(self.levels.surface_after(length, self.scene.interpolant))
    }

    /// Advances by `dt` to `time`.
    pub(crate) fn step_to(&mut self, time: f64, dt: f64, load: Load) -> Result<StepReport> {
        self.step_along(time, dt, load, None)
    }

    /// [`StatesContact::step_to`] along the surface to a load of its own, else to that of its history.
    pub(super) fn step_along(&mut self, time: f64, dt: f64, load: Load, along: Option<Load>) -> Result<StepReport> {
        let report = self.advance(time, dt, load, along)?;
        self.levels.merge(&self.states, self.scene.merge_error);
        Ok(report)
    }

    /// [`StatesContact::step_to`] without merging.
    pub(super) fn advance(&mut self, time: f64, dt: f64, load: Load, along: Option<Load>) -> Result<StepReport> {
        let (demand, wanted, reduced) = self.predict(time, dt, load)?;
        let along = self.along(time, dt, along)?;
        along.map_or(Ok(()), |along| self.levels.check_shear(&self.states, time, along, wanted))?;
        self.levels.accept(&self.states, demand, wanted, along);
        (self.time, self.reduced_time) = (time, reduced);
        self.prescribed = if let Load::Approach { approach, .. } = load { Some(approach) } else { None };
        if self.groups() == 0 {
            self.undisturbed_until = reduced;
        }
        Ok(self.report(dt, load))
    }

    /// Adds the elastic state at a level to the states of this contact.
    fn solve(&mut self, Wanted { level, give, sum, .. }: Wanted) -> Result<()> {
        let Some(elastic) = &self.scene.elastic else { return Ok(()) };
        let (tilt, drive) = (self.states.tilt, sum + self.states.rest.approach);
        let load = match give {
            f64::INFINITY => Load::Force { normal: level, tilt },
            0.0 => Load::Approach { approach: drive, tilt },
            _ => Load::Spring { stiffness: 1.0 / give, drive, tilt },
        };
        let solved = state_under(&mut elastic.lock().unwrap_or_else(PoisonError::into_inner), load)?;
        Arc::make_mut(&mut self.states).insert(solved.state, solved.pressure);
        Ok(())
    }

    /// Depth of the load point \[m\].
    pub(crate) fn depth(&self) -> f64 {
        self.levels.motions.depth
    }

    pub(super) fn demand(&self, load: Load) -> Result<Demand> {
        if load.tilt() != self.states.tilt {
            return Err(other_tilt(self.states.tilt, load));
        }
        let rest = self.states.rest.approach;
        match load {
            Load::Force { normal, .. } => Ok(Demand::Force(normal)),
            Load::Approach { approach, .. } => Ok(Demand::Depth { depth: approach - rest, give: 0.0 }),
            Load::Spring { stiffness, drive, .. } => Ok(Demand::Depth { depth: drive - rest, give: 1.0 / stiffness }),
        }
    }

    /// The elastic states that it is made of.
    pub fn states(&self) -> &Arc<ElasticStates> {
        &self.states
    }

    /// Level c(t): the elastic contact at this level has the same area \[m²\]; 0 without contact.
    pub fn level(&self) -> f64 {
        self.levels.level
    }

    /// Number of groups of levels, each with its own past.
    pub fn groups(&self) -> usize {
        self.levels.count()
    }

    /// Stiffness over the contact modulus \[m\], see
    /// [`ElasticState::stiffness`](crate::states::ElasticState::stiffness).
    pub fn stiffness_over_modulus(&self) -> f64 {
        self.states.stiffness(self.levels.level)
    }

    /// A quantity of the pressure, as its value in a cell, by the one of the elastic contact of unit compliance,
    /// q(l): Σ w_i (q(l_i) − q(l_i−1)), with the levels and tractions of [`StatesContact::tractions`], and q = 0 at
    /// the level 0.
    pub fn superposed(&self, elastic: impl Fn(f64) -> f64) -> f64 {
        let mut below = 0.0;
        let part = |(level, traction)| {
            let before = std::mem::replace(&mut below, elastic(level));
            traction * (below - before)
        };
        self.tractions().map(part).sum()
    }

    /// The pressure as a sum of elastic ones: level l_i at the top of each group that carries pressure, and its
    /// traction w_i \[Pa\]. With p_e(l) the pressure of the elastic contact of unit compliance, p = Σ w_i (p_e(l_i) −
    /// p_e(l_i−1)), l_0 = 0.
    pub fn tractions(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.levels.groups().map(|(top, traction, _)| (top, traction)).take(self.levels.held())
    }
}

debug_by!(self: StatesContact =>
    time: self.time, force: self.force(), approach: self.approach(), tilt: self.tilt(), level: self.level(), groups: self.groups(),
    lateral_force: self.lateral_force(), lateral_displacement: self.lateral_displacement(), stick_level: self.stick_level());
