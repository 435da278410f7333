//! One step of a contact: tried, checked, accepted.

use crate::contact::loads::lowered;
use crate::contact::region::Region;
use crate::contact::report::StepReport;
use crate::contact::settings::{Edge, TimeRule};
use crate::contact::viscoelastic::{ContactSolver, ViscoelasticContact};
use crate::error::{Convergence, Error, Result, non_negative};
use crate::events;
use crate::hereditary::{Change, History};
use crate::load::{Load, Tilt};
use crate::rheology::is_known;
use crate::solver::{Counts, Modes, Outcome, Problem, Solution, Stop};
use crate::sum::sum;

/// A step that was computed and waits to be accepted.
#[derive(Debug, Clone, Copy)]
#[must_use]
pub(super) struct Attempt {
    time: f64,
    dt: f64,
    /// Σ p.
    sum: f64,
}

impl ViscoelasticContact {
    /// Advances by `dt` \[s\] to a state that carries `load`, taking u to be linear in between. `dt` = 0 is
    /// a jump of the load: the bodies respond elastically. A body without elastic response (J(0) = 0) keeps its
    /// displacement in a jump; it can follow those after which nothing presses it, and those to a load that the pressure
    /// as it is satisfies to within [`Settings::tolerance`](crate::contact::Settings::tolerance), such as the present
    /// approach in place of the force.
    ///
    /// # Errors
    /// If `dt` or a force is negative, a number not finite, a force acts where it would topple the body, `dt` = 0 and the
    /// body has no elastic response for the pressure that the load asks for, contact reaches the edge of the grid (unless
    /// [`Edge::Allow`]), the solver does not converge, a creep closure returns an impossible value or cannot be fitted,
    /// the material is not known for so long or so short a time, a direct sum has filled its memory, there is
    /// none for the cells that the contact reaches ([`Error::OutOfMemory`]), or there are several rigid bodies. The contact is then exactly as it was before, but for
    /// [`ViscoelasticContact::within_step`], which has lost the start of the last step.
    pub fn step(&mut self, dt: f64, load: Load) -> Result<StepReport> {
        self.step_each(dt, &[load])
    }

    /// [`ViscoelasticContact::step`] with a load for each rigid body, in the order in which the builder was
    /// given them.
    ///
    /// # Errors
    /// As [`ViscoelasticContact::step`], or if there is not one load a body.
    pub fn step_each(&mut self, dt: f64, loads: &[Load]) -> Result<StepReport> {
        non_negative("time step", dt)?;
        if dt > 0.0 && dt < self.state.shortest {
            return Err(Error::BelowMaterial { time: self.state.time + dt, dt, known_from: self.state.shortest });
        }
        self.step_to(self.state.time + dt, dt, loads)
    }

    /// [`ViscoelasticContact::step_each`] with the end of the step given, so that it is met exactly.
    pub(crate) fn step_to(&mut self, time: f64, dt: f64, loads: &[Load]) -> Result<StepReport> {
        let attempt = self.attempt(time, dt, loads, self.settings.tolerance)?;
        Ok(self.accept(attempt, loads))
    }

    /// Computes a step, as the trial; the state stays as it is.
    pub(super) fn attempt(&mut self, time: f64, dt: f64, loads: &[Load], tolerance: f64) -> Result<Attempt> {
        non_negative("time", time)?;
        self.move_back();
        let attempt = self.attempt_where_it_fits(time, dt, loads, tolerance);
        if let Err(error) = &attempt {
            self.move_back();
            events::failed(time, dt, error);
        }
        attempt
    }

    /// Computes a step on the region at hand, or on the first larger one that turns out to hold all of the contact.
    fn attempt_where_it_fits(&mut self, time: f64, dt: f64, loads: &[Load], tolerance: f64) -> Result<Attempt> {
        self.admit(time, loads)?;
        self.make_room(dt, loads)?;
        loop {
            self.free(loads);
            let c = match self.try_step(time, dt, loads, tolerance) {
                // the load acts inside the hull of what the body may touch, but nothing in the window can carry it there
                Err(Error::LoadOutsideHull { .. }) if self.beyond.is_some() => {
                    let whole = Region::whole(&self.grid, self.region.folded());
                    self.check_room(&whole)?;
                    self.keep_for_failure();
                    self.reside(whole);
                    continue;
                }
                other => other?,
            };
            let Some(region) = self.outgrown(loads) else {
                let sum_of_pressure = sum(&self.trial.pressure);
                self.check(time, sum_of_pressure)?;
                self.displace(c, loads);
                if !sum(&self.trial_displacement).is_finite() {
                    return Err(Error::Overflow { time, what: "the displacement" });
                }
                return Ok(Attempt { time, dt, sum: sum_of_pressure });
            };
            self.check_room(&region)?;
            self.keep_for_failure();
            self.reside(region);
        }
    }

    /// Computes a step on the region at hand; returns its compliance.
    fn try_step(&mut self, time: f64, dt: f64, loads: &[Load], tolerance: f64) -> Result<f64> {
        // what was never touched has nothing to remember
        if !self.is_undisturbed() {
            self.remember(time)?;
        }
        self.state.before_is_kept = false;

        let (c, convolutions) = self.predict(time, dt)?;
        let unyielding = c == 0.0 && dt == 0.0;
        if !(unyielding || c > 0.0 && c.is_finite()) {
            return Err(Error::Overflow { time, what: "the compliance of the step" });
        }
        self.fill_gap(loads);
        self.refine_gap(c, loads);
        let prescribed = self.greatest_prescribed(loads);
        self.stay_below_full_contact(time, loads)?;

        // the contact problem of the step
        if unyielding {
            self.jump_without_response(time, loads, tolerance)?;
        } else {
            self.guess(dt, c);
        }
        let owner = self.gap_here.as_ref().unwrap_or(&self.initial_gap).owner.as_deref();
        let problem = Problem {
            kernel: &self.kernel_here,
            compliance: c,
            gap: &self.gap,
            prescribed,
            bodies: &self.freedoms,
            owner,
        };
        let stop = Stop { tolerance, max_iterations: self.settings.max_iterations };
        let outcome = match &mut self.solver {
            _ if unyielding => Outcome::Converged,
            _ if problem.all_released() => {
                self.trial.release();
                Outcome::Converged
            }
            ContactSolver::ActiveSet(solver) => solver.solve(&problem, stop, &mut self.trial, &mut self.work),
            ContactSolver::PolonskyKeer(solver) => solver.solve(&problem, stop, &mut self.trial, &mut self.work),
        };
        self.trial.follow_surface(&problem);
        self.converged(outcome, time, dt, tolerance, loads)?;
        self.trial.counts.convolutions += convolutions;
        if let History::Sources(history) = &mut self.history {
            history.advance(c, &self.trial.pressure);
        }
        if self.is_undisturbed() && self.trial.pressure.iter().any(|&p| p > 0.0) {
            self.remember(time)?;
        }
        if let Some(beyond) = &mut self.beyond {
            beyond.advance(dt, c, &self.trial.pressure);
        }
        Ok(c)
    }

    /// Makes the trial the state: nothing here can fail.
    pub(super) fn accept(&mut self, Attempt { time, dt, sum }: Attempt, loads: &[Load]) -> StepReport {
        let touched = !self.is_undisturbed() || self.trial.pressure.iter().any(|&p| p > 0.0);
        self.before_move = None;
        let change = Change { time, dt, potential: [&self.state.current.potential, &self.trial.potential] };
        let fitted = self.history.commit(&change, touched);
        std::mem::swap(&mut self.state.displacement, &mut self.trial_displacement);
        std::mem::swap(&mut self.state.previous, &mut self.state.current);
        std::mem::swap(&mut self.state.current, &mut self.trial);
        std::mem::swap(&mut self.state.previous_motions, &mut self.state.motions);
        for (body, motion) in self.state.motions.iter_mut().enumerate() {
            let free = Modes::new(self.region.grid(), self.freedoms[body]).physical(self.state.current.motions[body]);
            let [omega, alpha1, alpha2] = lowered(&loads[body], self.initial_gap.datum);
            *motion = [self.initial_gap.datum + omega + free.approach, alpha1 + free.tilt[0], alpha2 + free.tilt[1]];
        }
        if let Some(beyond) = &mut self.beyond {
            beyond.commit();
        }
        if !touched {
            self.state.undisturbed_until = time;
        }
        self.state.time = time;
        self.state.loads.copy_from_slice(loads);
        self.state.gap_is_new = false;
        self.state.last_dt = dt;
        self.state.interval = dt;
        self.state.before_is_kept = true;
        self.state.refresh.count(sum);
        self.state.contact_cells =
            self.region.images() * self.state.current.pressure.iter().filter(|&&p| p > 0.0).count();
        self.show();
        if let Some((material, times)) = fitted {
            (self.state.shortest, self.state.fitted_over) = (times[0], Some(times));
            self.material = material;
        }
        let report = self.report(dt);
        events::accepted(&report);
        report
    }

    /// Refuses a step whose past is longer than the material is known.
    fn remember(&self, time: f64) -> Result<()> {
        let (age, known_until) = (time - self.state.undisturbed_until, self.material.known_until());
        if is_known(age, known_until) { Ok(()) } else { Err(Error::BeyondMaterial { time, age, known_until }) }
    }

    pub(super) fn is_undisturbed(&self) -> bool {
        self.state.undisturbed_until == self.state.time && self.state.contact_cells == 0
    }

    /// Refuses what the solver did not solve.
    fn converged(&self, outcome: Outcome, time: f64, dt: f64, tolerance: f64, loads: &[Load]) -> Result<()> {
        let Solution { residual, counts: Counts { iterations, .. }, ref trace, .. } = self.trial;
        match outcome {
            Outcome::Converged => Ok(()),
            Outcome::NotANumber => Err(Error::Overflow { time, what: "the residual of the contact problem" }),
            Outcome::Unbalanced(body) => {
                let at = loads[body].tilt().map(|tilt| if let Tilt::Free { at } = tilt { at } else { 0.0 });
                Err(Error::LoadOutsideHull { time, body, at })
            }
            Outcome::OutOfIterations | Outcome::Stagnated => {
                let stagnated = outcome == Outcome::Stagnated;
                let convergence = Convergence::new(trace.samples(), tolerance, self.settings.solver, stagnated).into();
                Err(Error::NotConverged { time, dt, iterations, residual, tolerance, convergence })
            }
        }
    }

    /// Whether the trial may be accepted.
    fn check(&self, time: f64, sum: f64) -> Result<()> {
        if !self.trial.motions.iter().flat_map(|motion| motion.0).all(|motion| motion.is_finite()) {
            return Err(Error::Overflow { time, what: "the approach" });
        }
        let pressures = self.region.images() as f64 * sum;
        let force = self.grid.cell_area() * pressures;
        if !force.is_finite() {
            return Err(Error::Overflow { time, what: "the force" });
        }
        // no moment is greater than that of the whole force at the end of the longer side
        let arm = self.grid.lengths().into_iter().fold(0.0, f64::max);
        if !(arm * pressures.max(force)).is_finite() {
            return Err(Error::Overflow { time, what: "the moment of the force" });
        }
        if self.settings.edge == Edge::Refuse {
            let cells = self.region.positive_on_edge(&self.trial.pressure, self.kernel.periodic_axes());
            if cells > 0 {
                return Err(Error::ContactAtEdge { time, cells });
            }
        }
        Ok(())
    }

    fn report(&self, dt: f64) -> StepReport {
        let Counts { iterations, convolutions, preconditioner_applications, fallback_iterations } =
            self.state.current.counts;
        let rings = self.settings.time_rule == TimeRule::Rectangle
            && self.material.contact_compliance(dt) > 2.0 * self.material.contact_compliance(0.0);
        StepReport {
            time: self.state.time,
            dt,
            iterations,
            fallback_iterations,
            convolutions,
            preconditioner_applications,
            residual: self.state.current.residual,
            time_error: 0.0,
            rings,
            warnings: self.doubts(dt, rings),
            contact_cells: self.state.contact_cells,
            approach: self.approach(),
            tilt: self.tilt(),
            force: self.force(),
        }
    }
}
