//! One step of a contact.
//!
//! | Flow chart of the source paper (Figure 1) | here |
//! |---|---|
//! | load, and the motions that it leaves free (Eq. 4, Eq. 5) | [`find_free_motions`] |
//! | displacement due to the past, u_old (Eq. 9 to Eq. 12) | [`History::predict`](crate::hereditary::History::predict) |
//! | gap before any pressure (Eq. 1) | [`RigidBodies::fill_gap_of_step`] |
//! | initial guess of the pressure | [`initial_guess`] |
//! | contact problem of an elastic body (Eq. 2 to Eq. 8), by conjugate gradients | [`Window::solve`] |
//! | displacement at the end of the step | [`History::respond`](crate::hereditary::History::respond) |
//! | pressure and displacement kept for the steps to come (Eq. 11); next step | [`Computation::accept`] |
//!
//! The calls: [`step`](ViscoelasticContact::step) makes a [`Step`]; `take` computes it (`attempt`: [`compute`], which
//! chooses the region; [`OnRegion::solve`] below is the flow chart itself) and accepts it (`accept`: search for a
//! jump, report; `adopt`: exchanges with other ranks; [`Computation::accept`]: the state changes).
//!
//! Beyond the paper, a step checks whether the bodies might touch outside the computed region. If so, it continues in
//! a copy of the state on a larger region ([`outgrown`]). A step writes to its trial, to the window, to this copy,
//! and to the part of the history reserved for steps. The state changes when the step is accepted
//! ([`ViscoelasticContact::adopt`]): after a failed step it is what it was, but for the start of the step before,
//! which [`ViscoelasticContact::within_step`] would need.

mod accept;
#[cfg(feature = "adhesion")]
pub(in crate::contact) mod attraction;
#[cfg(not(feature = "adhesion"))]
#[path = "no_attraction.rs"]
pub(in crate::contact) mod attraction;
pub(crate) mod error_in_time;
mod load_jump;
pub(in crate::contact) mod planned;
mod prediction;
mod retraction;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::contact::{Clock, Computation, Scene, State, Step, StepReport, ViscoelasticContact};
use crate::equilibrium::constraints::{acceptable, below_full_contact, converged, find_free_motions, validate_loads};
use crate::equilibrium::guess::initial_guess;
use crate::equilibrium::pressed::Pressed;
use crate::equilibrium::spring::{guess_forces, solve_with_springs};
use crate::equilibrium::window::growth::{OnRegion, solve_on_growing_region};
use crate::equilibrium::window::placement::{outgrown, region_for};
use crate::equilibrium::{Figures, Held, Region, RigidBodies, Trial};
use crate::error::{Error, Result, StepError, non_negative, or_failure_of};
use crate::hereditary::{Interpolant, Interval, Outlook, TimeError};
use crate::load::Load;
use crate::parallel::in_pool;
use crate::solver::Stop;
use crate::traced;
use accept::collect_warnings;
use attraction::{AttractedStep, coarse_zone};
use error_in_time::error_in_time;
use load_jump::hold_through_load_jump;
use prediction::predict_contact;

/// A computed step, not yet accepted. Dropping it leaves the contact unchanged.
#[must_use]
pub(crate) struct Attempt {
    /// The copy on a larger region, if the step needed one.
    larger: Option<Box<Computation>>,
    /// Σ p, less the attraction.
    sum: f64,
}

impl ViscoelasticContact {
    /// Advances by `dt` \[s\] to a state that carries `loads`: one [`Load`], or a load for each rigid body in the
    /// order in which the builder was given them. `dt` = 0 is a jump of the load: the bodies respond elastically. A
    /// body without elastic response (J(0) = 0) keeps its displacement in a jump. It accepts jumps to zero pressure,
    /// and jumps to a load that the present pressure satisfies to within
    /// [`Settings::tolerance`](crate::contact::Settings::tolerance), such as the present approach in place of the force.
    ///
    /// ```
    /// use viscocontact::prelude::*;
    ///
    /// let ball = |at: f64| Shifted::new(Sphere::new(5.0e-3)?, [at, 0.0]);
    /// let mut contact = ViscoelasticContact::builder(Grid::new([64, 32], [8.0e-3, 4.0e-3])?)
    ///     .geometry(&ball(-2.0e-3)?)
    ///     .another_body(&ball(2.0e-3)?)
    ///     .material(Material::incompressible(KelvinVoigt::with_time(1.0e6, 1.0)?))
    ///     .build()?;
    /// contact.step(0.1, [Load::force(0.2), Load::approach(10.0e-6)])?;
    /// assert!((contact.fields().body(0).expect("the first").force - 0.2).abs() < 1.0e-12);
    /// # Ok::<(), Error>(())
    /// ```
    ///
    /// # Errors
    /// If `dt` or a force is negative, a number not finite, a force acts where it would topple the body, `dt` = 0 and
    /// the body has no elastic response for the pressure that the load needs, contact reaches the edge of the grid
    /// (unless
    /// [`Edge::Allow`](crate::contact::Edge::Allow)), the solver does not converge, a creep closure returns an impossible
    /// value, the material is not known for so long a time, there is no memory
    /// for the cells that the contact reaches ([`Error::OutOfMemory`]), or there is not one load per body. The
    /// contact is then unchanged, except that [`ViscoelasticContact::within_step`] has lost the start of the last
    /// step.
    pub fn step(&mut self, dt: f64, loads: impl AsRef<[Load]>) -> Result<StepReport> {
        self.next(None, self.time() + dt, dt, loads.as_ref())
    }

    /// [`ViscoelasticContact::step`], ended within an iteration where another thread sets `cancelled`.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`], and [`Error::Cancelled`].
    pub fn step_unless(&mut self, cancelled: &AtomicBool, dt: f64, loads: impl AsRef<[Load]>) -> Result<StepReport> {
        self.next(Some(cancelled), self.time() + dt, dt, loads.as_ref())
    }

    /// Takes a step of length `dt` to a time.
    pub(crate) fn next(
        &mut self,
        cancelled: Option<&AtomicBool>,
        time: f64,
        dt: f64,
        loads: &[Load],
    ) -> Result<StepReport> {
        let rows = self.computation.state.held.region.rows();
        rows.or_loss(|| {
            // here, so that all ranks agree on an error before they begin; steps of runs come by `compute` alone
            let requested = self.plan_next_step(time, dt, loads);
            let requested =
                requested.and_then(|step| validate_loads(&self.scene.ground, step.request()).map(|()| step));
            let step = rows.agree(requested)?;
            let report = self.take(Step { cancelled, ..step })?;
            self.saved_run = None; // a run that a file held does not know of it
            Ok(report)
        })
    }

    /// The next step of length `dt`, to a time, to the tolerance of the settings.
    pub(crate) fn plan_next_step<'a>(&self, time: f64, dt: f64, loads: &'a [Load]) -> Result<Step<'a>> {
        non_negative("time step", dt)?;
        self.request(time, dt, loads, self.settings().tolerance)
    }

    /// A step of `length` to the time `time`, without motion along the surface.
    pub(crate) fn request<'a>(&self, time: f64, length: f64, loads: &'a [Load], tolerance: f64) -> Result<Step<'a>> {
        let State { held: Held { indenter, .. }, clock, .. } = &self.computation.state;
        non_negative("time", time)?;
        let dt = self.scene.reduced_length(clock.time, time, length)?;
        let reduced = if self.scene.temperature.is_some() { clock.reduced_time + dt } else { time };
        let interval =
            Interval { time, length, reduced, dt, stride: [0; 2], interpolant: self.settings().interpolant() };
        Ok(Step { interval, loads, indenter: Arc::clone(indenter), tolerance, end: None, cancelled: None })
    }

    /// Computes a step and accepts it.
    pub(crate) fn take(&mut self, step: Step<'_>) -> Result<StepReport> {
        Ok(self.take_expecting(step, &Outlook::default())?.0)
    }

    /// Computes a step and accepts it; the `outlook` enters the estimate of its error.
    pub(crate) fn take_expecting(&mut self, step: Step<'_>, outlook: &Outlook) -> Result<(StepReport, TimeError)> {
        let attempt = self.attempt(&step)?;
        let error = error_in_time(&self.scene, attempt.computation(&self.computation), &step, outlook);
        Ok((self.accept(attempt, step, error)?, error))
    }

    /// Computes a step. The state stays as it is.
    pub(crate) fn attempt(&mut self, step: &Step<'_>) -> Result<Attempt> {
        let (mut larger, region) = (None, &self.computation.state.held.region);
        let (rows, from) = (region.rows(), region.cells());
        // ranks wait for each other: on the threads of one pool they would block each other
        let cells = if region.is_shared() { 0 } else { region.len() };
        let tried = rows.or_loss(|| {
            rows.same(marks(step))?;
            // ranks would see the flag in different iterations: they ask once a step
            if step.cancelled.is_some_and(|flag| rows.any(flag.load(Ordering::Relaxed))) {
                return Err(Error::Cancelled { what: "a step" });
            }
            in_pool(cells, || compute(&self.scene, &mut self.computation, &mut larger, step))
        });
        if let Some(larger) = &larger {
            traced::moved(from, larger.state.held.region.cells());
        }
        if let Err(error) = &tried {
            traced::failed(step.interval.time, step.interval.length, error);
            if let Some(larger) = &larger {
                self.computation.trial.solution.counts = larger.trial.solution.counts; // the work was done
            }
        }
        tried.map(|sum| Attempt { larger, sum })
    }

    /// Computes a step, and goes on with the region that it needed. The state stays that before the step.
    #[cfg(feature = "adhesion")]
    pub(crate) fn attempt_on_its_region(&mut self, step: &Step<'_>) -> Result<Attempt> {
        let attempt = self.attempt(step)?;
        let sum = attempt.sum;
        self.move_to_region_of(attempt);
        Ok(Attempt { larger: None, sum })
    }

    /// Goes on with the region of an attempt, with the state before it.
    #[cfg(feature = "adhesion")]
    pub(crate) fn move_to_region_of(&mut self, attempt: Attempt) {
        if let Some(larger) = attempt.larger {
            self.computation = *larger;
            self.view.refresh(&self.computation.state.held);
        }
    }

    /// Makes an attempt the state, and reports it. The loss of a rank is an error, which leaves the state unchanged.
    pub(crate) fn accept(&mut self, attempt: Attempt, step: Step<'_>, error: TimeError) -> Result<StepReport> {
        // lengths beyond 1e154 m have no squares, and so no estimate
        let estimated = step.interval.stride == [0; 2] && error.relative.is_finite();
        let attracted = &attempt.computation(&self.computation).attracted;
        let is_suspected = attracted.as_ref().is_some_and(|own| own.suspects_jump());
        let again = is_suspected.then(|| (step.clone(), self.computation.state.clone()));
        let pressed = self.adopt(attempt, step, error.sizes)?;
        if let Some((step, before)) = again
            && let Err(error) = self.look_for_jump(&step)
        {
            self.go_to(&before);
            return Err(error);
        }
        let report = self.report(estimated.then_some(error.relative), pressed);
        report.emit();
        Ok(report)
    }

    /// Takes a part of a step, to `time`, under loads of its own; returns where it presses.
    pub(in crate::contact) fn take_part(
        &mut self,
        time: f64,
        loads: &[Load],
        tolerance: f64,
        interpolant: Interpolant,
    ) -> Result<Pressed> {
        let mut part = self.request(time, time - self.time(), loads, tolerance)?;
        part.interval.interpolant = interpolant;
        let attempt = self.attempt(&part)?;
        self.adopt(attempt, part, [0.0; 2])
    }

    /// The report of the last step, and where it presses.
    pub(crate) fn report(&self, time_error: Option<f64>, pressed: Pressed) -> StepReport {
        let (scene, state) = (&self.scene, &self.computation.state);
        let clock: &Clock = &state.clock;
        let compliance = || scene.material.contact_compliance(clock.age().max(clock.last_dt));
        let figures = Figures {
            cells_in_zone: coarse_zone(scene, compliance),
            beyond_edge: self.computation.attracted.as_ref().and_then(|own| own.beyond_edge(scene)),
            modulus: scene.limits.modulus,
            ..state.held.figures(&scene.ground, &pressed)
        };
        StepReport {
            time: clock.time,
            dt: clock.last_length,
            time_error,
            warnings: collect_warnings(scene, &self.computation, pressed.reach, &figures, time_error),
            figures,
            ..StepReport::solved(self.fields())
        }
    }

    /// Makes an attempt the state, without a report; `sizes` are the mean displacement and the mean v in contact.
    /// Returns where it presses.
    pub(crate) fn adopt(&mut self, attempt: Attempt, step: Step<'_>, sizes: [f64; 2]) -> Result<Pressed> {
        // all exchanges with other ranks precede the change of the state
        let Computation { state, trial, .. } = attempt.computation(&self.computation);
        let (pressure, region) = (&trial.solution.pressure, &state.held.region);
        let pressed = Pressed::by(pressure, &self.scene.ground, region, &step.indenter);
        self.computation.state.held.region.rows().intact()?;
        if let Some(larger) = attempt.larger {
            self.computation = *larger;
        }
        self.computation.accept(step, attempt.sum, pressed.cells, sizes);
        self.view.refresh(&self.computation.state.held);
        Ok(pressed)
    }
}

impl Attempt {
    /// The computation of the attempt: its copy on a larger region, or `own`, the contact's.
    pub(crate) fn computation<'a>(&'a self, own: &'a Computation) -> &'a Computation {
        self.larger.as_deref().unwrap_or(own)
    }
}

/// Numbers of a step that must agree on all ranks.
fn marks(step: &Step<'_>) -> [f64; 4] {
    let load = step.loads.first().map_or(0.0, Load::main);
    [step.interval.time, step.interval.dt, step.tolerance, load]
}

/// Computes a step in `own`, or in a copy on a `larger` region. Returns Σ p, less the attraction.
fn compute(
    scene: &Scene,
    own: &mut Computation,
    larger: &mut Option<Box<Computation>>,
    step: &Step<'_>,
) -> Result<f64> {
    let (ground, request) = (&scene.ground, step.request());
    validate_loads(ground, request)?;
    let is_windowed = own.state.history.far_source().is_some();
    let first = || scene.material.contact_compliance(step.interval.dt);
    let first = (is_windowed && own.state.is_undisturbed()).then(first);
    let moving = step.interval.stride.map(|cells| cells != 0);
    let placed = region_for(ground, &own.state.held, request, moving, first)?;
    solve_on_growing_region(ground, own, larger, placed, (scene, step))
}

/// Rejects a step beyond the loading times for which the material is known. Bodies that were never `touched` have no
/// loading time.
fn material_is_known(scene: &Scene, state: &State, step: &Step<'_>, touched: bool) -> Result<()> {
    let Interval { time, reduced, .. } = step.interval;
    scene.limits.check_age(time, reduced - state.clock.undisturbed_until, touched)
}

/// Rejects a compliance that overflows or underflows. It is 0 only in jumps of bodies without elastic response.
fn compliance_is_usable(c: f64, step: &Step<'_>) -> Result<()> {
    let Interval { time, dt, .. } = step.interval;
    let usable = c > 0.0 && c.is_finite() || c == 0.0 && dt == 0.0;
    if usable { Ok(()) } else { Err(Error::Step(StepError::Overflow { time, what: "the compliance of the step" })) }
}

impl OnRegion for Computation {
    type Asked<'a> = (&'a Scene, &'a Step<'a>);

    fn held(&mut self) -> &mut Held {
        &mut self.state.held
    }

    fn outgrown(&self, (scene, step): (&Scene, &Step<'_>)) -> Option<Region> {
        let Computation { state, window, trial, .. } = self;
        outgrown(&scene.ground, &state.held, window, trial, step.request(), (1.0, state.history.tried_far_source()?))
    }

    fn acceptable(&self, (scene, step): (&Scene, &Step<'_>)) -> Result<f64> {
        let (Computation { state, trial, attracted, .. }, ground) = (self, &scene.ground);
        let displaced = state.held.region.rows().sum(state.history.tried_displacement());
        let sum = acceptable(ground, &state.held, displaced, trial, step.request())?;
        attracted.as_ref().map_or(Ok(()), |own| own.check_edge(scene, step))?;
        Ok(sum)
    }

    /// Writes the part of the history reserved for steps, too.
    fn solve(&mut self, (scene, step): (&Scene, &Step<'_>)) -> Result<()> {
        let (Computation { state, window, trial, attracted }, ground) = (self, &scene.ground);
        let (held, request) = (&state.held, step.request());
        window.follow(&held.region, &step.indenter);
        find_free_motions(ground, &held.region, request, &mut trial.free);
        material_is_known(scene, state, step, !state.is_undisturbed())?;

        // u = u_old + c K p
        let (kernel, work) = (&window.kernel, &mut window.work);
        let (c, convolutions) = state.history.predict(step.interval, scene.history_inputs(), kernel, work);
        compliance_is_usable(c, step)?;

        // h = hi + u_old + c K p − ω − α·x, with the prescribed parts of ω and α
        let gap_is_new = state.indenter_is_new || !Arc::ptr_eq(&step.indenter, &held.indenter);
        let on_bodies = state.history.follows_body_exactly() && !gap_is_new;
        let start = on_bodies.then_some((&held.loads[..], &held.current.motions[..]));
        let bodies = RigidBodies { request, region: &held.region, start };
        let before = &held.current.solution.pressure;
        bodies.fill_gap_of_step(window.gap(&step.indenter), &state.history, before, &mut trial.gap);
        below_full_contact(window, trial, request)?;

        // p ≥ 0, h ≥ 0, p h = 0, with force and moments in balance
        let cancelled = step.cancelled.filter(|_| !held.region.is_shared());
        let stop = Stop { tolerance: step.tolerance, max_iterations: ground.settings.max_iterations, cancelled };
        if let Some(law) = ground.attraction.as_deref() {
            let attracted_step =
                AttractedStep { scene, law, state, step, bodies, compliance: c, stop, wanted: trial.free[0] };
            or_failure_of(|| law.failure(), || attracted_step.solve(window, trial, attracted))?;
        } else {
            guess_forces(ground, held, window.gap(&step.indenter), request, c, trial);
            if c == 0.0 {
                hold_through_load_jump(state, window, trial, step)?;
            } else {
                let ahead = held.extrapolation.reach(step.interval.dt);
                let extrapolated = initial_guess(held, (&state.previous, ahead), window, trial, request, c);
                if extrapolated && step.interval.stride == [0; 2] {
                    trial.predicted = predict_contact(state, window, trial, step, c);
                }
            }
            let prescribed = bodies.greatest_motion(&ground.grid);
            let solve = |trial: &mut Trial| window.solve(&step.indenter, c, prescribed, stop, trial);
            let outcome = solve_with_springs(ground, held, request, c, trial, solve);
            converged(outcome, ground, &trial.solution, request)?;
        }
        trial.solution.counts.convolutions += convolutions;
        let pressure = &trial.solution.pressure;
        let touched = state.is_undisturbed() && (state.attracts || held.region.is_positive_anywhere(pressure));
        material_is_known(scene, state, step, touched)?;

        // the history of the bodies
        let (initial, integrated) = (window.gap(&step.indenter), state.history.integrates_displacement());
        state.history.respond(c, [pressure, &trial.solution.potential], |now, u| {
            bodies.displace(initial, c, integrated, trial, u);
            bodies.follow_prescribed(initial, [before, pressure], now, u);
        });
        Ok(())
    }

    fn transferred_to(&mut self, (scene, step): (&Scene, &Step<'_>), region: Region) -> Result<Box<Computation>> {
        self.transferred_to(scene, region, &step.indenter)
    }
}
