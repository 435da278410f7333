//! One contact, advanced one step at a time.

use std::fmt;
use std::sync::Arc;

use crate::Grid;
use crate::contact::builder::Builder;
use crate::contact::follow::{Follow, Stepping};
use crate::contact::report::StepReport;
use crate::contact::settings::{Edge, Settings};
use crate::error::{Error, Result, exact_length, non_negative};
use crate::geometry::{Gap, Geometry};
use crate::hereditary::{Change, History};
use crate::kernel::{InfluenceKernel, Workspace};
use crate::load::{Load, LoadHistory};
use crate::solver::{ActiveSet, Counts, PolonskyKeer, Problem, Solution, Stop};

/// The first guess of a step extrapolates p and K p alike, which saves a convolution but lets the rounding
/// of K p accumulate, step by step linearly. Out of so many steps, the last two compute it afresh: two,
/// because extrapolation reads two states, and one left stale would feed its error back, multiplied.
/// This costs a sixteenth of a convolution a step.
const REFRESH_CYCLE: usize = 32;

/// A guess reaches at most this many times the length of the last step ahead.
const FARTHEST_GUESS: f64 = 2.0;

/// A rigid indenter pressed onto a creeping half-space: the pressure between them, the area they touch
/// on, and how both change with time.
///
/// ```
/// use viscocontact::prelude::*;
///
/// let grid = Grid::square(64, 4.0e-3)?;
/// let mut contact = ViscoelasticContact::builder(grid)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
///     .build()?;
/// contact.step(0.0, Load::force(1.0))?; // Δ = 0: the load jumps
/// let before = contact.contact_area();
/// contact.step(0.5, Load::force(1.0))?; // hold it
/// assert!(contact.contact_area() > before);
/// assert!((contact.force() - 1.0).abs() < 1e-12);
/// # Ok::<(), viscocontact::Error>(())
/// ```
#[derive(Clone)]
pub struct ViscoelasticContact {
    grid: Grid,
    kernel: Arc<InfluenceKernel>,
    work: Workspace,
    settings: Settings,
    solver: ContactSolver,
    history: History,
    initial_gap: Gap,

    time: f64,
    load: Load,
    displacement: Vec<f64>,
    /// p, K p and ω, the latter from the datum of the initial gap.
    current: Solution,
    contact_cells: usize,

    /// The state one step earlier, and the length of that step: what a guess extrapolates from.
    previous: Solution,
    last_dt: f64,
    steps_in_cycle: usize,

    /// The step being tried; thrown away if it fails.
    trial: Solution,
    trial_displacement: Vec<f64>,
    gap: Vec<f64>,
}

#[derive(Debug, Clone)]
pub(crate) enum ContactSolver {
    ActiveSet(Box<ActiveSet>),
    PolonskyKeer(PolonskyKeer),
}

impl ViscoelasticContact {
    /// Starts to put a contact together on `grid`.
    pub fn builder(grid: Grid) -> Builder {
        Builder::new(grid)
    }

    pub(crate) fn new(
        grid: Grid,
        kernel: Arc<InfluenceKernel>,
        settings: Settings,
        initial_gap: Gap,
        history: History,
        solver: ContactSolver,
    ) -> ViscoelasticContact {
        let cells = grid.len();
        let current = Solution::zero(cells);
        ViscoelasticContact {
            work: kernel.workspace(),
            time: 0.0,
            load: Load::force(0.0),
            displacement: vec![0.0; cells],
            contact_cells: 0,
            previous: Solution::zero(cells),
            last_dt: 0.0,
            steps_in_cycle: 0,
            trial: current.clone(),
            current,
            trial_displacement: vec![0.0; cells],
            gap: vec![0.0; cells],
            grid,
            kernel,
            settings,
            solver,
            history,
            initial_gap,
        }
    }

    /// Advances by `dt` \[s\] to a state that carries `load`, taking u to be linear in between. `dt` = 0 is
    /// a jump of the load: the bodies respond elastically.
    ///
    /// # Errors
    /// If `dt` or the load is negative or not finite, the body has no elastic response and `dt` = 0,
    /// contact reaches the edge of the grid (unless [`Edge::Allow`]), the solver does not converge, or
    /// a creep closure returns an impossible value. The contact is then exactly as it was before.
    pub fn step(&mut self, dt: f64, load: Load) -> Result<StepReport> {
        non_negative("time step", dt)?;
        self.step_to(self.time + dt, dt, load)
    }

    /// [`ViscoelasticContact::step`] with the end of the step given, so that it is met exactly.
    pub(crate) fn step_to(&mut self, time: f64, dt: f64, load: Load) -> Result<StepReport> {
        load.validate()?;
        non_negative("time", time)?;

        // what the past makes of the end of the step: u = u_old + c K p
        let c = self.history.predict(time, dt, &self.displacement, &mut self.trial_displacement)?;
        for ((gap, &initial), &u_old) in self.gap.iter_mut().zip(&self.initial_gap.above).zip(&self.trial_displacement)
        {
            *gap = initial + u_old;
        }

        // the contact problem of the step
        self.guess(dt);
        let Load::Force { normal } = load;
        let total = normal / self.grid.cell_area();
        let problem = Problem { kernel: &self.kernel, compliance: c, gap: &self.gap, total };
        let Settings { tolerance, max_iterations, .. } = self.settings;
        let stop = Stop { tolerance, max_iterations };
        if total == 0.0 {
            self.trial.release(&problem);
        } else {
            match &mut self.solver {
                ContactSolver::ActiveSet(solver) => solver.solve(&problem, stop, &mut self.trial, &mut self.work),
                ContactSolver::PolonskyKeer(solver) => solver.solve(&problem, stop, &mut self.trial, &mut self.work),
            }
        }
        self.check(time, dt)?;

        // accept: nothing below can fail
        for (u, &v) in self.trial_displacement.iter_mut().zip(&self.trial.potential) {
            *u += c * v;
        }
        self.history.commit(&Change {
            time,
            dt,
            displacement: [&self.displacement, &self.trial_displacement],
            potential: [&self.current.potential, &self.trial.potential],
        });
        std::mem::swap(&mut self.displacement, &mut self.trial_displacement);
        std::mem::swap(&mut self.previous, &mut self.current);
        std::mem::swap(&mut self.current, &mut self.trial);
        self.time = time;
        self.load = load;
        self.last_dt = dt;
        self.steps_in_cycle = (self.steps_in_cycle + 1) % REFRESH_CYCLE;
        self.contact_cells = self.current.pressure.iter().filter(|&&p| p > 0.0).count();
        Ok(self.report(dt))
    }

    /// Fills the trial with a guess: the state extrapolated from the last step, p and K p alike.
    fn guess(&mut self, dt: f64) {
        let trial = &mut self.trial;
        trial.counts = Counts::default();
        let ahead = if self.last_dt > 0.0 { (dt / self.last_dt).min(FARTHEST_GUESS) } else { 0.0 };
        let extrapolate = |trial: &mut [f64], current: &[f64], previous: &[f64]| {
            for ((guess, &now), &before) in trial.iter_mut().zip(current).zip(previous) {
                *guess = now + ahead * (now - before);
            }
        };
        extrapolate(&mut trial.pressure, &self.current.pressure, &self.previous.pressure);
        if self.steps_in_cycle < REFRESH_CYCLE - 2 {
            extrapolate(&mut trial.potential, &self.current.potential, &self.previous.potential);
        } else if matches!(self.solver, ContactSolver::ActiveSet(_)) {
            self.kernel.apply(&trial.pressure, &mut trial.potential, &mut self.work);
            trial.counts.convolutions += 1;
        }
    }

    /// Whether the trial may be accepted.
    fn check(&self, time: f64, dt: f64) -> Result<()> {
        let Settings { tolerance, max_iterations: _, edge, .. } = self.settings;
        let Solution { approach, residual, counts, .. } = self.trial;
        if !approach.is_finite() {
            return Err(Error::Overflow { time, what: "the approach" });
        }
        if residual > tolerance || residual.is_nan() {
            return Err(Error::NotConverged { time, dt, iterations: counts.iterations, residual, tolerance });
        }
        if edge == Edge::Refuse {
            let cells = self.grid.positive_on_edge(&self.trial.pressure);
            if cells > 0 {
                return Err(Error::ContactAtEdge { time, cells });
            }
        }
        Ok(())
    }

    fn report(&self, dt: f64) -> StepReport {
        let Counts { iterations, convolutions, preconditioner_applications } = self.current.counts;
        StepReport {
            time: self.time,
            dt,
            iterations,
            convolutions,
            preconditioner_applications,
            residual: self.current.residual,
            contact_cells: self.contact_cells,
            approach: self.approach(),
            force: self.force(),
        }
    }

    /// Follows a load history to the time `until` \[s\], step by step as `stepping` says.
    pub fn follow<'a>(&'a mut self, history: &'a dyn LoadHistory, stepping: Stepping, until: f64) -> Follow<'a> {
        Follow::new(self, history, stepping, until)
    }

    /// Replaces the indenter, moved or changed, between two steps; the bodies keep their deformation,
    /// and touch the new one from the next step on.
    ///
    /// # Errors
    /// If a gap is NaN or −∞, or none is finite; the contact then keeps the old one.
    pub fn set_geometry(&mut self, geometry: &dyn Geometry) -> Result<()> {
        let gap = Gap::new(geometry, &self.grid)?;
        self.current.approach += self.initial_gap.datum - gap.datum; // the same approach, from another datum
        self.initial_gap = gap;
        self.last_dt = 0.0; // the last change of the pressure says nothing about the next
        Ok(())
    }

    /// Time \[s\], 0 at first.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The grid of every field.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The settings it was built with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The influence kernel, to share with other contacts.
    pub fn kernel(&self) -> &Arc<InfluenceKernel> {
        &self.kernel
    }

    /// The load of the last step.
    pub fn load(&self) -> Load {
        self.load
    }

    /// Contact pressure \[Pa\], one value a cell, ≥ 0.
    pub fn pressure(&self) -> &[f64] {
        &self.current.pressure
    }

    /// Composite normal surface displacement, positive into the bodies \[m\], one value a cell.
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Writes the gap between the deformed bodies into `out` \[m\]: zero in contact to within the
    /// tolerance, +∞ where there is nothing to touch.
    ///
    /// # Errors
    /// If `out` does not hold one value a cell.
    pub fn gap_into(&self, out: &mut [f64]) -> Result<()> {
        exact_length("gap", out.len(), self.grid.len())?;
        for ((h, &initial), &u) in out.iter_mut().zip(&self.initial_gap.above).zip(&self.displacement) {
            *h = initial + u - self.current.approach;
        }
        Ok(())
    }

    /// Rigid-body approach ω \[m\]. Without load, the approach at which the bodies just touch.
    pub fn approach(&self) -> f64 {
        self.initial_gap.datum + self.current.approach
    }

    /// Normal force Σ p ΔA \[N\].
    pub fn force(&self) -> f64 {
        self.current.pressure.iter().sum::<f64>() * self.grid.cell_area()
    }

    /// Moments of the pressure about the origin, \[∬ p x1, ∬ p x2\] \[N·m\].
    pub fn moment(&self) -> [f64; 2] {
        let [_, n2] = self.grid.cells();
        let mut moment = [0.0; 2];
        for (i, row) in self.current.pressure.chunks_exact(n2).enumerate() {
            moment[0] += self.grid.coordinate(0, i) * row.iter().sum::<f64>();
            moment[1] += row.iter().enumerate().map(|(j, p)| self.grid.coordinate(1, j) * p).sum::<f64>();
        }
        moment.map(|sum| sum * self.grid.cell_area())
    }

    /// Area of the cells in contact \[m²\].
    pub fn contact_area(&self) -> f64 {
        self.contact_cells as f64 * self.grid.cell_area()
    }

    /// Number of cells in contact (p > 0).
    pub fn contact_cells(&self) -> usize {
        self.contact_cells
    }
}

impl fmt::Debug for ViscoelasticContact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ViscoelasticContact")
            .field("grid", &self.grid)
            .field("settings", &self.settings)
            .field("time", &self.time)
            .field("load", &self.load)
            .field("approach", &self.approach())
            .field("contact_cells", &self.contact_cells)
            .finish_non_exhaustive()
    }
}
