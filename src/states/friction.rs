//! Friction of contacts on elastic states: partial slip of creeping bodies as a superposition.

use std::sync::Arc;

use crate::contact::StepReport;
use crate::error::{Error, Refusal, Result, within};
use crate::hereditary::Interpolant;
use crate::kernel::HalfSpace;
use crate::load::along::LateralWork;
use crate::load::{Load, LoadHistory};
use crate::rheology::Material;
use crate::run::Contact;
use crate::states::contact::StatesContact;
use crate::states::coulomb::CoulombOnStates;
use crate::states::levels::{Demand, Shear};

/// The error of bodies that do not respond alike to normal and to tangential loads.
fn other_kernel() -> Error {
    let what = "these bodies respond to loads along the surface in another way than to normal ones: friction on \
        elastic \
        states is exact in line contact and at Poisson's ratio 0, where ν = ½ or two bodies are of one material";
    let remedy = "; with_estimated_friction takes half-spaces of any constant Poisson's ratio";
    Refusal::unsupported("states_other_kernel", what, remedy).into()
}

/// A body turns if a turn moves the edge of its contact by more than this part of its depth.
const MOST_TURNED: f64 = 1e-3;

/// The error of a load along the surface without friction.
fn no_friction() -> Error {
    let what = "the contact has no friction that could carry a load along its surface";
    Refusal::unsupported("states_no_friction", what, ": call with_friction first").into()
}

/// # Friction
///
/// Coulomb's law with one coefficient f, and a force Q or a displacement d along one direction of the surface, besides
/// the normal load: the contact sticks up to a level s, [`StatesContact::stick_level`], and slips outside it, where
/// τ = ± f p. With bodies that respond alike to both, the traction is a superposition of the elastic states as the
/// pressure is, τ = Σ θ_i (p_e(l_i) − p_e(l_i−1)), for every history of both loads: slip and its reversal, creep,
/// contacts that shrink and meet again (docs/maintainers/numerics.md has the proof).
///
/// The levels that a step meets were sheared and pressed together: a step in which P and Q rise together is oblique
/// loading, all of which sticks if Q < f P. Steps are linear in time, of second order: slip begins and ends in kinks. To press first
/// and then to shear (Cattaneo's case) takes two steps, of no time if it happens at once.
impl StatesContact {
    /// With a coefficient of friction, where bodies respond alike to normal and to tangential loads: in line contact,
    /// and of bodies of ν = 0. Neither load may move the surface along the other: ν = ½ on a rigid body, or two bodies
    /// of one material. Exact as the states are.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    /// use viscocontact::states::{ElasticStates, StatesContact};
    ///
    /// let foam = || Material::constant_poisson(Zener::with_time(1.0e6, 1.0e6, 1.0)?, 0.0);
    /// let mut contact =
    ///     StatesContact::new(&ElasticStates::sphere(10.0e-3)?, &foam()?.against(foam()?))?.with_friction(0.5)?;
    /// contact.step(0.0, Load::force(1.0))?;
    /// contact.step_sheared(0.0, Load::force(1.0), Load::force(0.3))?;
    /// // Cattaneo: the radius that sticks is a (1 − Q/fP)^(1/3)
    /// let stick = contact.stick_area() / contact.contact_area();
    /// assert!((stick - 0.4_f64.powf(2.0 / 3.0)).abs() < 1e-9);
    /// let before = contact.lateral_displacement();
    /// contact.step_sheared(1.0, Load::force(1.0), Load::force(0.3))?;
    /// assert!(contact.lateral_displacement() > before);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If the coefficient is not above 0, or more than 10⁶; if the body is free to tilt and turns as it is pressed; if
    /// bodies respond to tangential loads in another way: [`StatesContact::with_estimated_friction`] takes them.
    pub fn with_friction(self, coefficient: f64) -> Result<StatesContact> {
        let (material, is_line) = (&self.scene.material, self.is_line()?);
        let has = |wanted: f64| material.poisson_ratios().all(|ratio| ratio == Some(wanted));
        if !(is_line || has(0.0)) || !(has(0.5) || material.is_pair()?) {
            return Err(other_kernel());
        }
        self.with_coulomb(coefficient, 1.0)
    }

    /// [`StatesContact::with_friction`] of any constant Poisson's ratio, as an estimate: as if tangential kernels were
    /// (2 − ν)/(2(1 − ν)) times the normal ones, which is exact in the mean of a circle, and neither load moved the
    /// surface along the other. At ν = ½ the displacement of a ball is off by 0.2 % at Q = 0.5 f P and by 0.4 % at
    /// 0.9 f P; that of a rough surface by 1.7 % in the median of 12, at most 8 %.
    ///
    /// # Errors
    /// If the coefficient is not above 0, or more than 10⁶; if the body turns as it is pressed; for layers and other
    /// kernels than those of half-spaces, and for bodies whose Poisson's ratio changes with time. States of a table or a file, which
    /// do not tell their kernel, are taken for those of half-spaces.
    pub fn with_estimated_friction(self, coefficient: f64) -> Result<StatesContact> {
        let (material, is_line) = (&self.scene.material, self.is_line()?);
        let mut sums = [0.0; 2];
        for body in material.each() {
            let poisson = body.poisson_ratios().next().flatten().ok_or_else(other_kernel)?;
            let ratio = if is_line { 1.0 } else { 0.5 * (2.0 - poisson) / (1.0 - poisson) };
            // a body of no glassy compliance is as soft as it creeps
            let compliance = body.contact_compliance(0.0).max(f64::MIN_POSITIVE);
            sums = [sums[0] + ratio * compliance, sums[1] + compliance];
        }
        // 3/4 at ν = −1 to 3/2 at ν = ½, unless the sums are no numbers
        let ratio = Some(sums[0] / sums[1]).filter(|ratio| (0.5..2.0).contains(ratio)).ok_or_else(other_kernel)?;
        self.with_coulomb(coefficient, ratio)
    }

    /// With Coulomb's law: the states along the surface are those of a shift, which all that sticks follows alike.
    fn with_coulomb(mut self, coefficient: f64, ratio: f64) -> Result<StatesContact> {
        let allowed = "above 0, at most 1e6";
        within("coefficient of friction", coefficient, coefficient > 0.0 && coefficient <= 1e6, allowed)?;
        if self.states.turn() > MOST_TURNED {
            let what = "friction on elastic states whose body turns as it is pressed, since a shift along the surface does not";
            let remedy = ": compute it in space (FrictionContact), or sweep the states with fixed tilts";
            return Err(Refusal::unsupported("friction_turning", what, remedy).into());
        }
        self = self.with_interpolant(Interpolant::Linear);
        self.levels.with_shear(&self.states);
        Arc::make_mut(&mut self.scene).friction = Some(CoulombOnStates { coefficient, ratio, history: None });
        Ok(self)
    }

    /// With the whole motion of a step as slip of what it meets, as other programs count it (CONTACT): oblique loading
    /// then slips at the edge, the less the shorter the steps are.
    ///
    /// # Errors
    /// If the contact has no friction.
    pub fn with_slip_from_start(mut self) -> Result<StatesContact> {
        self.scene.friction.as_ref().ok_or_else(no_friction)?;
        self.levels.slip_from_start();
        Ok(self)
    }

    /// Whether the load is uniform along one axis. Layers respond in another way; states without a scene, of closed
    /// forms, tables and files, are those of half-spaces.
    fn is_line(&self) -> Result<bool> {
        if self.states.poisson.is_some() {
            return Err(other_kernel());
        }
        let Some(scene) = self.states.scene.as_ref() else { return Ok(false) };
        match scene.half_space_below() {
            Some(body) => Ok(matches!(body, HalfSpace::Line { .. })),
            None => Err(other_kernel()),
        }
    }

    /// With what acts along the surface in all further steps: forces Q \[N\] as [`Load::force`], of either sign,
    /// displacements d \[m\] as [`Load::approach`], springs as [`Load::spring`]. Runs end their steps at its corners
    /// and follow its jumps as those of the normal load, if both jump at once by oblique loading. Forces below 2e-16 of
    /// the maximum of a run are none, as normal loads are. Without it no force acts along the surface.
    ///
    /// # Errors
    /// If the contact has no friction.
    pub fn sheared_by(mut self, history: impl LoadHistory + 'static) -> Result<StatesContact> {
        let friction = Arc::make_mut(&mut self.scene).friction.as_mut().ok_or_else(no_friction)?;
        friction.history = Some(Arc::new(history));
        Ok(self)
    }

    /// What acts along the surface.
    pub(super) fn lateral_history(&self) -> &[Arc<dyn LoadHistory>] {
        self.scene.friction.as_ref().map_or(&[], |friction| friction.history.as_slice())
    }

    /// The maximum so far of what the history along the surface prescribes.
    pub(super) fn reached_along(&self) -> f64 {
        let load = self.lateral_history().first().map(|along| along.before(self.time()));
        let of = |friction: &CoulombOnStates, shear: &Shear| {
            let (far, most) = (friction.of_displacement() * shear.maxima[0], friction.coefficient * shear.maxima[1]);
            match load {
                Some(Load::Approach { .. }) => far,
                Some(Load::Spring { stiffness, .. }) => far + most / stiffness,
                _ => most,
            }
        };
        self.with_friction_state(of).unwrap_or(0.0)
    }

    /// [`StatesContact::step`] with a load along the surface, as those of [`StatesContact::sheared_by`].
    ///
    /// # Errors
    /// As [`StatesContact::step`]; if there is no friction, [`Error::Slides`] if the force is more than f P, and if a
    /// load along the surface has a tilt.
    pub fn step_sheared(&mut self, dt: f64, load: Load, along: Load) -> Result<StepReport> {
        let report = self.step_along(self.time() + dt, dt, load, Some(along))?;
        self.saved_run = None;
        Ok(report)
    }

    /// What a step of length `dt` to `time` asks of the levels along the surface: that of its history at a jump of no
    /// time, before it at the end of a step.
    pub(super) fn along(&self, time: f64, dt: f64, given: Option<Load>) -> Result<Option<Demand>> {
        let Some(friction) = &self.scene.friction else {
            return if given.is_some() { Err(no_friction()) } else { Ok(None) };
        };
        let load = match (given, &friction.history) {
            (Some(load), _) => load.validate().map(|()| load),
            (None, None) => Ok(Load::force(0.0)),
            (None, Some(history)) if dt > 0.0 => history.checked_before(time, true),
            (None, Some(history)) => history.checked_at(time, true),
        };
        let least = self.levels.shear.as_ref().filter(|_| given.is_none()).map_or(0.0, |shear| shear.least);
        friction.demand(load.map_err(Error::along)?.without_force_below(least)).map(Some)
    }

    /// What the levels have along the surface, if there is friction.
    fn with_friction_state<T>(&self, of: impl Fn(&CoulombOnStates, &Shear) -> T) -> Option<T> {
        Some(of(self.scene.friction.as_ref()?, self.levels.shear.as_ref()?))
    }

    /// Force along the surface \[N\]; 0 without friction.
    pub fn lateral_force(&self) -> f64 {
        self.with_friction_state(|friction, shear| friction.coefficient * shear.force).unwrap_or(0.0)
    }

    /// Displacement of the body along the surface \[m\], how far it has slid included.
    pub fn lateral_displacement(&self) -> f64 {
        self.with_friction_state(|friction, shear| friction.of_displacement() * shear.displacement()).unwrap_or(0.0)
    }

    /// How far the whole contact has slid \[m\], beyond its partial slip; of bodies apart, how far they moved freely.
    pub fn slid(&self) -> f64 {
        self.with_friction_state(|friction, shear| friction.of_displacement() * shear.slid).unwrap_or(0.0)
    }

    /// Level s up to which the contact sticks \[m²\]: 0 where all of it slides, [`StatesContact::level`] where nothing
    /// slips and without friction.
    pub fn stick_level(&self) -> f64 {
        self.with_friction_state(|_, shear| shear.stick).unwrap_or(self.level())
    }

    /// Area that sticks \[m²\].
    pub fn stick_area(&self) -> f64 {
        self.states.area(self.stick_level())
    }

    /// Where the work along the surface went; all 0 without friction.
    pub fn lateral_work(&self) -> LateralWork {
        let found = self.with_friction_state(|friction, shear| {
            let unit = friction.coefficient * friction.of_displacement();
            LateralWork::new(unit * shear.work, unit * shear.lost, unit * self.levels.stored_along())
        });
        found.unwrap_or_default()
    }

    /// What tables of a history have besides, with friction.
    pub(super) fn columns_along(&self) -> Vec<(&'static str, f64)> {
        if self.scene.friction.is_none() {
            return Vec::new();
        }
        vec![
            ("force along [N]", self.lateral_force()),
            ("displacement along [m]", self.lateral_displacement()),
            ("slid [m]", self.slid()),
            ("stick area [m2]", self.stick_area()),
            ("work along [J]", self.lateral_work().work),
            ("loss by slip [J]", self.lateral_work().slip),
        ]
    }

    /// The traction along the surface as a sum of elastic pressures: level l_i at the top of each group that carries
    /// pressure, and θ_i \[Pa\], as [`StatesContact::tractions`].
    pub fn shear_tractions(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let coefficient = self.scene.friction.as_ref().map_or(0.0, |friction| friction.coefficient);
        self.levels.shears().map(move |(top, shear)| (top, coefficient * shear)).take(self.levels.held())
    }

    /// The traction along the surface \[Pa\] from the states that the sweep kept, as [`StatesContact::pressure`].
    ///
    /// # Errors
    /// As [`StatesContact::pressure`].
    pub fn shear(&self) -> Result<Vec<f64>> {
        self.states.superposed_field(self.shear_tractions())
    }
}

impl Material {
    /// Each body alone.
    fn each(&self) -> impl Iterator<Item = Material> {
        self.apart().into_iter().filter(|body| body.poisson_ratios().next().is_some())
    }
}
