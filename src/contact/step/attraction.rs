//! Steps of surfaces that attract each other.
//!
//! With the attraction s(h) the step has h = gap + c K (z − s(h)) − motion ≥ 0, z ≥ 0, z h = 0, and z − s carries the load: z is the pressure
//! of the wall. Since s never grows with h, the energy is a convex function plus a concave one, −Σ ∫ₕ^∞ s. A pass takes s from the gap of the
//! pass before, a tangent of the concave part, and solves the contact problem of the gap − c K s under the load + Σ s: it lowers the energy
//! (Le Thi & Pham, Ann. Oper. Res. 133, 2005), and where no pass changes s any more, the state is stationary.
//!
//! Passes are extrapolated by Anderson's method (J. ACM 12, 1965). An extrapolated s is kept only where the energy falls; else the plain pass
//! follows. So a step descends from the state before it, and ends in the valley that this state belongs to.

use crate::adhesion::Attraction;
use crate::contact::scene::Scene;
use crate::contact::state::State;
use crate::contact::step::constraints::converged;
use crate::contact::step::initial_guess::{begin, fill_guess};
use crate::contact::step::request::{Step, Trial};
use crate::contact::step::spring::{TriedSpring, solve_with_springs};
use crate::contact::window::window::Window;
use crate::error::{AdhesionError, Result, StepError};
use crate::linalg::solve_normal_equations;
use crate::load::Load;
use crate::parallel::for_each_band;
use crate::solver::{Counts, Freedom, Outcome, PENETRATION_SLACK, RigidMotion, Solution, Stop};

/// Greatest number of passes of a step.
const MAX_PASSES: usize = 500;
/// Change of s in a pass, over the greatest traction, that ends a step, in tolerances of the solver.
const CHANGE: f64 = 100.0;
/// The tolerance of the solver in a pass, over the last change of s, and its greatest value.
const INNER: f64 = 0.003;
const LOOSEST: f64 = 1e-3;
/// Passes that are extrapolated from.
const KEPT: usize = 3;
/// Share of the square of a change, independent of the other changes, that counts as zero.
const DEPENDENT: f64 = 1e-10;
/// The energy of a pass is known to this many tolerances of its solver, relative to the sum of its parts: cells outside the contact may
/// penetrate by so much.
const UNSURE: f64 = PENETRATION_SLACK;
/// Traction of a cell that changed by more than this part of the greatest in the last step is not extrapolated to the next.
const GREATEST_CHANGE: f64 = 0.5;

/// Between the [response](PassReport::response) to a smooth change, on spheres at Tabor's numbers 0.5 to 3 at most 13, and to a jump, at least
/// 19.
const LEAST_OF_JUMP: f64 = 15.0;

/// What the passes of a step work in, besides the trial, and how the last step went.
#[derive(Debug, Clone)]
pub(in crate::contact) struct Passes {
    /// K s.
    image: Vec<f64>,
    /// The gap before any traction.
    open: Vec<f64>,
    /// s of passes that were kept, and s at the gaps that they led to, the last first.
    kept: [[Vec<f64>; 2]; KEPT],
    known: usize,
    /// The change of s in the first pass.
    first: Vec<f64>,
    pub(in crate::contact) report: PassReport,
}

/// How the passes of a step of surfaces that attract each other went: contact problems, each with the attraction at the gap that the one
/// before it led to ([`ViscoelasticContact::passes`](crate::ViscoelasticContact::passes)).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct PassReport {
    /// Passes.
    pub passes: usize,
    /// Passes that began with an extrapolated attraction under which the energy did not fall, and that were given up.
    pub rejected: usize,
    /// The greatest rise of the energy from pass to pass, over the sum of its parts, beyond the exactness of the passes.
    pub rise: f64,
    /// The energy of the state before the step, under the load and the creep of its end, less that of the state at its end \[J\]: what a jump loses.
    /// Where nothing jumps, it is of second order in the length of the step, of either sign.
    pub released: f64,
    /// By how many times the response of the surfaces enlarges a change of the attraction: 1 where it is weak, above 15 in a jump
    /// ([`Warnings::JUMP`](crate::contact::Warnings::JUMP)).
    pub response: f64,
}

impl PassReport {
    /// Whether the surfaces snapped together or apart.
    pub(in crate::contact) fn jumped(&self) -> bool {
        self.response > LEAST_OF_JUMP
    }
}

/// Sums over the cells of a pass.
struct Found {
    /// Energy over the area of a cell.
    energy: f64,
    /// The sum of its parts, and of c z K z.
    scale: f64,
    /// The greatest change of s over the greatest traction.
    change: f64,
}

impl Passes {
    /// Fields for each cell, with s of the trial.
    pub(in crate::contact) const FIELDS: usize = 3 + 2 * KEPT + 1;

    fn new(cells: usize) -> Passes {
        let field = || vec![0.0; cells];
        let kept = std::array::from_fn(|_| [field(), field()]);
        Passes { image: field(), open: field(), kept, known: 0, first: field(), report: PassReport::default() }
    }

    /// |z − s| at the end of a step that was solved, at its start, and at the start of the step before.
    pub(in crate::contact) fn weights(&self) -> [&[f64]; 3] {
        self.kept.each_ref().map(|[weights, _]| &weights[..])
    }

    fn keep_weights(&mut self, solutions: [&Solution; 3]) {
        for ([weights, _], Solution { pressure, attraction, .. }) in self.kept.iter_mut().zip(solutions) {
            for (weight, (z, s)) in weights.iter_mut().zip(pressure.iter().zip(attraction)) {
                // no cell counts as one that the bodies have yet to meet
                *weight = (z - s).abs().max(f64::MIN_POSITIVE);
            }
        }
    }

    /// The next s: from the kept passes, the last of which led from s to g, with g − Σ γ (g − g′), where γ makes the change f = g − s
    /// less Σ γ (f − f′) as small as it can.
    fn extrapolate(&self, state: &State, greatest: f64, next: &mut [f64]) {
        const OTHERS: usize = KEPT - 1;
        let [[s, g], others @ ..] = &self.kept;
        let known = self.known - 1;
        let change = |k: usize, j: usize| (g[k] - s[k]) - (others[j][1][k] - others[j][0][k]);
        let sums = state.region.rows().sum_terms(|k| {
            let mut terms = [0.0; OTHERS * (OTHERS + 1)];
            for i in 0..known {
                let own = change(k, i);
                terms[OTHERS * OTHERS + i] = own * (g[k] - s[k]);
                (0..known).for_each(|j| terms[OTHERS * i + j] = own * change(k, j));
            }
            Some(terms)
        });
        let gram: [[f64; OTHERS]; OTHERS] = std::array::from_fn(|i| std::array::from_fn(|j| sums[OTHERS * i + j]));
        let weights = solve_normal_equations(&gram, std::array::from_fn(|i| sums[OTHERS * OTHERS + i]), DEPENDENT);
        for_each_band([next], |first, [next]| {
            for (next, k) in next.iter_mut().zip(first..) {
                let moved = (0..known).map(|j| weights[j] * (g[k] - others[j][1][k])).sum::<f64>();
                *next = (g[k] - moved).clamp(0.0, greatest);
            }
        });
    }
}

/// A step of surfaces that attract each other.
pub(super) struct AttractedStep<'a> {
    pub(super) scene: &'a Scene,
    pub(super) law: &'a dyn Attraction,
    pub(super) state: &'a State,
    pub(super) step: &'a Step<'a>,
    /// The compliance of the step, and the greatest motion taken from its gap.
    pub(super) given: [f64; 2],
    pub(super) stop: Stop<'a>,
}

impl AttractedStep<'_> {
    /// Computes wall pressure, attraction and motion of the trial; its potential is K (z − s) at the end.
    pub(super) fn solve(&self, window: &mut Window, trial: &mut Trial) -> Result<()> {
        let time = self.step.interval.time;
        if self.given[0] == 0.0 {
            let what = "a jump of surfaces that attract each other (take a short step instead)";
            return Err(StepError::NoElasticResponse { time, what }.into());
        }
        begin(self.state, trial, self.step);
        let cells = trial.gap.len();
        let mut own = trial.passes.take().unwrap_or_else(|| Box::new(Passes::new(cells)));
        trial.solution.attraction.resize(cells, 0.0);
        let solved = self.iterate(&mut own, window, trial);
        trial.gap.copy_from_slice(&own.open);
        trial.passes = Some(own);
        solved
    }

    fn iterate(&self, own: &mut Passes, window: &mut Window, trial: &mut Trial) -> Result<()> {
        let AttractedStep { state, step, stop, given: [c, _], .. } = *self;
        let (greatest, limit, wanted) = (self.law.traction(0.0), CHANGE * stop.tolerance, trial.free[0]);
        own.open.copy_from_slice(&trial.gap);
        (own.known, own.report) = (0, PassReport::default());
        let mut counts = self.guess(own, window, trial, greatest);
        let (mut least, mut inner, mut plain, mut convolved) = (f64::INFINITY, LOOSEST, true, true);
        let (mut change, mut exactness) = (f64::INFINITY, 0.0);
        // plain passes that are to follow, and after the next extrapolation that gains nothing
        let (mut wait, mut penalty) = (0_usize, 1);
        while own.report.passes < MAX_PASSES {
            own.report.passes += 1;
            if !std::mem::replace(&mut convolved, false) {
                let Window { kernel, work, .. } = &mut *window;
                kernel.apply(&trial.solution.attraction, &mut own.image, work);
                counts.convolutions += 1;
            }
            for_each_band([&mut trial.gap], |first, [gap]| {
                let fields = gap.iter_mut().zip(&own.open[first..]).zip(&own.image[first..]);
                fields.for_each(|((gap, &open), &image)| *gap = open - c * image);
            });
            let pulled = self.add_to_load(wanted, trial);
            let carried = !matches!(step.loads[0], Load::Force { .. }) || trial.free[0].total > 0.0;
            if !carried && plain {
                let force = wanted.total * self.area();
                return Err(AdhesionError::PulledOff { time: step.interval.time, force }.into());
            }
            let tolerance = inner.max(stop.tolerance);
            let outcome = if carried { self.pass(tolerance, pulled, window, trial) } else { Outcome::Stagnated };
            add(&mut counts, trial.solution.counts);
            if plain || matches!(outcome, Outcome::NotANumber | Outcome::Cancelled) {
                trial.solution.counts = counts;
                converged(outcome, self.scene, &trial.solution, step)?;
            }
            own.kept.rotate_right(1);
            let found = if outcome == Outcome::Converged { Some(self.find(wanted, own, trial)) } else { None };
            let unsure = UNSURE * tolerance.max(std::mem::replace(&mut exactness, tolerance));
            let kept = found.filter(|found| plain || found.energy <= least + unsure * found.scale);
            let Some(found) = kept else {
                // the plain pass from the last state that was kept
                own.kept.rotate_left(1);
                own.known = 1;
                own.report.rejected += 1;
                trial.solution.attraction.copy_from_slice(&own.kept[0][1]);
                (plain, wait, penalty) = (true, penalty, 2 * penalty);
                continue;
            };
            if own.report.passes == 1 {
                let Passes { first, kept: [[s, g], ..], .. } = own;
                first.iter_mut().zip(s.iter().zip(g)).for_each(|(first, (s, g))| *first = *g - *s);
            }
            if least.is_finite() {
                own.report.rise = own.report.rise.max((found.energy - least) / found.scale - unsure);
            }
            if !plain && found.change >= change {
                // it gained nothing: the more often, the more plain passes follow
                (wait, penalty) = (penalty, 2 * penalty);
            }
            (least, change) = (found.energy, found.change);
            own.known = (own.known + 1).min(KEPT);
            inner = (INNER * change).min(LOOSEST);
            if change <= limit && trial.solution.residual <= stop.tolerance {
                trial.solution.counts = counts;
                let net = &mut trial.solution.potential;
                net.iter_mut().zip(&own.image).for_each(|(net, image)| *net -= image);
                own.report.released = self.area() * (self.energy_at_start(wanted, own, trial) - found.energy);
                own.report.response = self.response(own, trial);
                own.keep_weights([&trial.solution, &state.current.solution, &state.previous.solution]);
                return Ok(());
            }
            if change <= limit {
                // the same pass, more exactly
                (inner, convolved) = (0.0, true);
                own.kept.rotate_left(1);
                own.known -= 1;
                continue;
            }
            plain = own.known == 1 || wait > 0;
            wait = wait.saturating_sub(1);
            if plain {
                trial.solution.attraction.copy_from_slice(&own.kept[0][1]);
            } else {
                own.extrapolate(state, greatest, &mut trial.solution.attraction);
            }
        }
        let (time, passes) = (step.interval.time, own.report.passes);
        Err(AdhesionError::NotConverged { time, passes, change, tolerance: limit }.into())
    }

    /// Writes z, s and K z of a guess, and K s: extrapolated from the last two states, or the last state where s has changed much.
    fn guess(&self, own: &mut Passes, window: &mut Window, trial: &mut Trial, greatest: f64) -> Counts {
        let (state, step) = (self.state, self.step);
        let (now, before) = (&state.current.solution, &state.previous.solution);
        let mut reach = state.extrapolation.reach(step.interval.dt);
        let changes = now.attraction.iter().zip(&before.attraction).map(|(now, before)| (now - before).abs());
        if changes.fold(0.0, f64::max) > GREATEST_CHANGE * greatest {
            reach = 0.0;
        }
        if state.is_undisturbed() {
            return self.first_guess(own, window, trial);
        }
        trial.reach = reach;
        fill_guess(state, window, trial, |now, before| now + reach * (now - before));
        let afresh = state.extrapolation.refresh_is_due();
        let solution = &mut trial.solution;
        let states = now.attraction.iter().zip(&before.attraction);
        solution.attraction.iter_mut().zip(states).for_each(|(s, (&now, &before))| *s = now + reach * (now - before));
        let Window { kernel, work, .. } = &mut *window;
        kernel.apply(&solution.attraction, &mut own.image, work);
        solution.counts.convolutions += 1;
        if !afresh {
            // the potential of a state is K (z − s)
            solution.potential.iter_mut().zip(&own.image).for_each(|(v, image)| *v += image);
        }
        solution.counts
    }

    /// Writes the guess of a first step: no pressure, and s of undeformed bodies, which just touch under a force.
    fn first_guess(&self, own: &mut Passes, window: &mut Window, trial: &mut Trial) -> Counts {
        let lowest = self.state.region.rows().least(own.open.iter().fold(f64::INFINITY, |low, &h| low.min(h)));
        let motion = match self.step.loads[0] {
            Load::Approach { .. } => 0.0,
            _ => lowest,
        };
        let solution = &mut trial.solution;
        solution.release();
        for (s, &open) in solution.attraction.iter_mut().zip(&own.open) {
            *s = if open.is_finite() { self.law.traction((open - motion).max(0.0)) } else { 0.0 };
        }
        let Window { kernel, work, .. } = &mut *window;
        kernel.apply(&solution.attraction, &mut own.image, work);
        solution.counts.convolutions += 1;
        solution.counts
    }

    /// Adds Σ s to the load that the wall carries, and its moments; returns the force of the attraction \[N\].
    fn add_to_load(&self, wanted: Freedom, trial: &mut Trial) -> f64 {
        let (state, s) = (self.state, &trial.solution.attraction);
        let region = &state.region;
        let [sum, moment1, moment2] = if wanted.tilts() {
            region.rows().sum_terms(|k| {
                let x = region.center(k);
                Some([s[k], s[k] * x[0], s[k] * x[1]])
            })
        } else {
            [region.rows().sum(s), 0.0, 0.0]
        };
        let motion = region.modes(trial.free[0]).physical(trial.solution.motions[0]);
        let total = wanted.total + sum;
        trial.free[0] = wanted;
        match self.step.loads[0] {
            Load::Force { .. } => {
                trial.free[0].total = total;
                if wanted.tilts() && total > 0.0 {
                    let moments = [moment1, moment2];
                    trial.free[0].point =
                        [0, 1].map(|axis| (wanted.total * wanted.point[axis] + moments[axis]) / total);
                }
            }
            // the search for the force of the wall begins at its present pressure
            Load::Spring { .. } => {
                trial.free[0].total = region.rows().sum(&trial.solution.pressure).max(0.0);
                trial.springs[0] = TriedSpring::default();
            }
            Load::Approach { .. } => {}
        }
        if wanted.tilts() {
            trial.solution.motions[0] = region.modes(trial.free[0]).coefficients(motion);
        }
        sum * self.area()
    }

    /// One contact problem with the attraction of the trial, which pulls with the force `pulled` \[N\].
    fn pass(&self, tolerance: f64, pulled: f64, window: &mut Window, trial: &mut Trial) -> Outcome {
        let stop = Stop { tolerance, ..self.stop };
        trial.solution.counts = Counts::default();
        trial.solution.trace.clear();
        let solve = |trial: &mut Trial| window.solve(&self.step.indenter, self.given, stop, trial);
        // a spring holds the wall against load and attraction: as if its end were nearer
        let loads = match self.step.loads[0] {
            Load::Spring { stiffness, drive, tilt } => {
                [Load::Spring { stiffness, drive: drive + pulled / stiffness, tilt }]
            }
            load => [load],
        };
        let indenter = std::sync::Arc::clone(&self.step.indenter);
        let step =
            Step { interval: self.step.interval, loads: &loads, indenter, tolerance, cancelled: self.step.cancelled };
        solve_with_springs(self.scene, self.state, &step, self.given[0], trial, solve)
    }

    /// Keeps s of the pass and s at the gap that it led to; energy and change of the pass. The energy is that of the Lagrangian, in which the
    /// error of the pass enters with its square.
    fn find(&self, wanted: Freedom, own: &mut Passes, trial: &Trial) -> Found {
        let AttractedStep { state, law, given: [c, _], .. } = *self;
        let (rows, solution, gap) = (state.region.rows(), &trial.solution, &trial.gap);
        let (modes, motion) = (state.region.modes(trial.free[0]), solution.motions[0]);
        let height = |k: usize| gap[k] + c * solution.potential[k] - modes.displacement(motion, k);
        let [s, g] = &mut own.kept[0];
        s.copy_from_slice(&solution.attraction);
        for_each_band([&mut *g], |first, [g]| {
            for (g, k) in g.iter_mut().zip(first..) {
                let h = if solution.pressure[k] > 0.0 { 0.0 } else { height(k).max(0.0) };
                *g = if h.is_finite() { law.traction(h) } else { 0.0 };
            }
        });
        let (s, g, image) = (&*s, &*g, &own.image);
        let cell = |k: usize| {
            let (z, h) = (solution.pressure[k], height(k));
            let [open, wall] = if z > 0.0 { [0.0, z * h] } else { [h.max(0.0), 0.0] };
            [z - s[k], solution.potential[k] - image[k], open, wall]
        };
        let [energy, parts] = self.energy(wanted, modes.physical(motion), cell);
        let pressed = rows.sum_of_pairs(&solution.pressure, &solution.potential, |z, v| c * z * v);
        let changes = s.iter().zip(g).map(|(s, g)| (g - s).abs());
        let change = changes.fold(0.0, f64::max) / law.traction(0.0);
        Found { energy, scale: parts + pressed.abs() + f64::MIN_POSITIVE, change }
    }

    /// The energy over the area of a cell, and the sum of its parts, of a state with the free motion `motion`, from z − s, K (z − s), the gap and the
    /// work of the wall of a cell.
    fn energy(&self, wanted: Freedom, motion: RigidMotion, cell: impl Fn(usize) -> [f64; 4] + Sync) -> [f64; 2] {
        let AttractedStep { state, law, given: [c, _], .. } = *self;
        let [elastic, attracted, wall] = state.region.rows().sum_terms(|k| {
            let [traction, potential, open, wall] = cell(k);
            open.is_finite().then(|| [0.5 * c * traction * potential, law.energy(open), wall])
        });
        let of_load = match self.step.loads[0] {
            Load::Force { .. } => -wanted.total * motion.at(wanted.point),
            Load::Spring { stiffness, drive, .. } => {
                let extended = drive - self.step.indenter.gap().datum - motion.approach;
                0.5 * stiffness * extended * extended / self.area()
            }
            Load::Approach { .. } => 0.0,
        };
        [elastic - attracted - wall + of_load, elastic.abs() + attracted + of_load.abs()]
    }

    /// The energy over the area of a cell of the state before the step, under the load and the creep of its end.
    fn energy_at_start(&self, wanted: Freedom, own: &Passes, trial: &Trial) -> f64 {
        let (state, step, c) = (self.state, self.step, self.given[0]);
        let Solution { pressure, attraction, potential, .. } = &state.current.solution;
        let (RigidMotion { approach, tilt }, prescribed) = (state.current.motions[0], step.prescribed(0));
        let free = |is_free: bool, value: f64| if is_free { value } else { 0.0 };
        let freedom = trial.free[0];
        let motion = RigidMotion {
            approach: free(freedom.translation, approach - step.indenter.gap().datum - prescribed.approach),
            tilt: [0, 1].map(|axis| free(freedom.tilt[axis], tilt[axis] - prescribed.tilt[axis])),
        };
        let cell = |k: usize| {
            let h = own.open[k] + c * potential[k] - motion.at(state.region.center(k));
            let traction = pressure[k] - attraction[k];
            // the wall of the state before holds its cells while the gap changes by what the step begins with
            let [open, wall] = if pressure[k] > 0.0 { [0.0, traction * h] } else { [h.max(0.0), 0.0] };
            [traction, potential[k], open, wall]
        };
        self.energy(wanted, motion, cell)[0]
    }

    /// How the surfaces respond: of the change e of s from its guess, a first pass finds r, and e·e/(e·r) is 1/(1 − λ) for the rate λ of the
    /// passes.
    fn response(&self, own: &Passes, trial: &Trial) -> f64 {
        let (state, reach) = (self.state, trial.reach);
        if state.is_undisturbed() {
            return 1.0;
        }
        let [now, before] = [&state.current.solution.attraction, &state.previous.solution.attraction];
        let [square, first] = state.region.rows().sum_terms(|k| {
            let change = trial.solution.attraction[k] - (now[k] + reach * (now[k] - before[k]));
            Some([change * change, change * own.first[k]])
        });
        let ratio = square / first;
        // no change has no ratio
        if ratio < 0.0 { f64::INFINITY } else { ratio.max(1.0) }
    }

    /// Force over Σ p \[m²\].
    fn area(&self) -> f64 {
        self.scene.grid.cell_area() * self.state.region.images() as f64
    }
}

/// Adds the work of a pass.
fn add(counts: &mut Counts, more: Counts) {
    counts.iterations += more.iterations;
    counts.convolutions += more.convolutions;
    counts.preconditioner_applications += more.preconditioner_applications;
    counts.fallback_iterations += more.fallback_iterations;
}
