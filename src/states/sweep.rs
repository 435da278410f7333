//! The elastic states of a scene.

use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::rc::Rc;
use std::sync::Arc;

use super::elastic::other_tilt;
use crate::Grid;
use crate::contact::Settings;
use crate::elastic::{ElasticBuilder, ElasticContact};
use crate::error::{Error, Result, count_within, finite, positive, within};
use crate::geometry::Geometry;
use crate::kernel::{InfluenceKernel, Layer};
use crate::load::{Load, Tilt, load_point};
use crate::solver::RigidMotion;
use crate::states::curve::{ElasticState, ElasticStates};
use crate::states::elastic::{Solved, state_under};
use crate::states::pressed::{Pressed, allowed_fall};
use crate::states::reach::{MARGIN, Reach};

/// Finds the elastic states of a shape on a body, each as an [`ElasticContact`] of unit compliance.
///
/// A first pass takes levels that double. Then a state is added in the middle, in ln l, of two others, and more beside
/// it where depth or slope differ from their interpolation by more than the accuracy times √(δ δ_last): small contacts
/// have few cells, whose own error is larger. A sweep costs about as much as so many solutions.
#[derive(Debug, Clone)]
#[must_use = "a sweep does nothing until it is run"]
pub struct Sweep {
    builder: ElasticBuilder,
    layer: Option<Layer>,
    tilt: [Tilt; 2],
    accuracy: f64,
    max_states: usize,
    settings: Settings,
    keep_pressures: bool,
}

/// How close the states of a sweep are.
struct Density {
    /// The minimum level of a sweep over the maximum.
    least_level: f64,
    /// The level, over the maximum, below which a contact that stays the same is the smallest.
    linear_level: f64,
    /// Levels closer than by this factor have no state between them.
    finest: f64,
    /// The error of a pressure counts relative to this part of the maximum load at least.
    least_load: f64,
    /// The error in the middle of two states is so much below the accuracy: elsewhere between them it may be greater.
    safety: f64,
}

const SWEEP: Density = Density { least_level: 1e-12, linear_level: 1e-6, finest: 1.001, least_load: 0.01, safety: 2.0 };

impl Sweep {
    /// A shape pressed upright onto an incompressible half-space.
    pub fn new(grid: Grid, geometry: &dyn Geometry) -> Sweep {
        let settings = Settings::default().with_tolerance(1e-8);
        Sweep {
            // C = 1 Pa⁻¹
            builder: ElasticContact::builder(grid).geometry(geometry).modulus(1.0),
            layer: None,
            tilt: [Tilt::Fixed(0.0); 2],
            accuracy: 1e-4,
            max_states: 4000,
            settings,
            keep_pressures: false,
        }
    }

    /// On another body than a half-space.
    pub fn kernel(mut self, kernel: impl Into<Arc<InfluenceKernel>>) -> Sweep {
        let kernel = kernel.into();
        self.layer = kernel.layer_of().cloned();
        self.builder = self.builder.kernel(kernel);
        self
    }

    /// With given tilts, or free ones about a fixed load point, as in [`Load`]. By default the body is upright.
    pub fn tilt(mut self, tilt: [Tilt; 2]) -> Sweep {
        self.tilt = tilt;
        self
    }

    /// Error of the depth δ between two states, relative to √(δ δ_last), with δ_last the maximum depth (default:
    /// 1e-4). Where [pressures are kept](Sweep::keep_pressures), the error of the pressure in L1, over the load or a
    /// hundredth of the greatest, is no greater: some 20 states a decade of the level for 1e-2, and 80 for 1e-3.
    pub fn accuracy(mut self, accuracy: f64) -> Sweep {
        self.accuracy = accuracy;
        self
    }

    /// Upper limit of the number of states (default: 4000). A sweep that reaches it is less accurate than asked for, by
    /// [`ElasticStates::interpolation_error`].
    pub fn max_states(mut self, max_states: usize) -> Sweep {
        self.max_states = max_states;
        self
    }

    /// Settings of the elastic contact (default: those of [`Settings`] with a tolerance of 1e-8).
    pub fn settings(mut self, settings: Settings) -> Sweep {
        self.settings = settings;
        self
    }

    /// Keeps the pressure of every state, 12 bytes for each of its cells in contact, for
    /// [`StatesContact::pressure`](crate::states::StatesContact::pressure), with states so near that it has the [accuracy](Sweep::accuracy).
    pub fn keep_pressures(mut self) -> Sweep {
        self.keep_pressures = true;
        self
    }

    /// Runs the sweep.
    ///
    /// # Errors
    /// Those of [`ElasticBuilder::build`] and [`ElasticContact::solve`]; [`Error::Shrinks`] if the pressure falls
    /// somewhere while the load grows; if the accuracy is outside \[1e-8, 0.1\], or the reach is not finite and
    /// positive.
    pub fn run(self, to: Reach) -> Result<Arc<ElasticStates>> {
        self.run_with(to, |_| ControlFlow::Continue(()))
    }

    /// As [`Sweep::run`], calling `progress` after each state with all states so far, in the order of their solution;
    /// it may end the sweep early, with the states that it has then. The pressure may not fall between neighbours
    /// among them either.
    ///
    /// # Errors
    /// As [`Sweep::run`].
    pub fn run_with(
        self,
        to: Reach,
        progress: impl FnMut(&[ElasticState]) -> ControlFlow<()>,
    ) -> Result<Arc<ElasticStates>> {
        within("accuracy of a sweep", self.accuracy, (1e-8..=0.1).contains(&self.accuracy), "in [1e-8, 0.1]")?;
        count_within("states of a sweep", self.max_states, self.max_states >= 3, "3 or more")?;
        if let Reach::Approach(reach) = to {
            positive("reach of a sweep", reach)?;
        }
        for tilt in self.tilt {
            let (Tilt::Fixed(value) | Tilt::Free { at: value }) = tilt;
            finite("tilt or load point of a sweep", value)?;
        }
        let scene = self.builder.clone().settings(self.settings);
        let elastic = scene.clone().build()?;
        let tilt = self.tilt.map(|tilt| if let Tilt::Fixed(angle) = tilt { angle } else { 0.0 });
        let at = load_point(self.tilt);
        let grid = elastic.fields().grid().clone();
        let mut solver = SweepSolver {
            asked: &self,
            elastic,
            at,
            rest: RigidMotion { approach: 0.0, tilt },
            last_depth: 0.0,
            last_level: 0.0,
            first_level: 0.0,
            allowed_fall: allowed_fall(self.settings.tolerance),
            solved: Vec::new(),
            kept: self.keep_pressures.then(Vec::new),
            error: 0.0,
            progress,
        };
        let last = match to {
            Reach::Level(level) => level,
            Reach::Approach(approach) => solver.largest_level(&[Load::Approach { approach, tilt: self.tilt }])?,
            Reach::Loads(loads) => MARGIN * solver.largest_level(&loads)?,
        };
        positive("level that a sweep reaches", last)?;
        solver.sweep(last)?;
        let mut states = solver.finish();
        (states.poisson, states.grid) = (self.layer.map(|layer| layer.poisson_ratio()), Some(grid));
        states.scene = Some(scene);
        Ok(Arc::new(states))
    }
}

/// Two neighbouring states that may have others between them.
struct Pair {
    lower: Rc<Solved>,
    upper: Rc<Solved>,
    /// Upper level of the pair of the first pass that this pair is a part of.
    top: f64,
    /// Error in the middle of the pair that this pair is a half of; infinite in the first pass.
    error: f64,
}

impl Pair {
    fn new(lower: &Rc<Solved>, upper: &Rc<Solved>, top: f64, error: f64) -> Pair {
        Pair { lower: Rc::clone(lower), upper: Rc::clone(upper), top, error }
    }
}

/// The elastic contact that finds states.
struct SweepSolver<'a, P> {
    asked: &'a Sweep,
    elastic: ElasticContact,
    /// The load point.
    at: [f64; 2],
    rest: RigidMotion,
    last_depth: f64,
    last_level: f64,
    /// The level from which the contact only grows.
    first_level: f64,
    allowed_fall: f64,
    solved: Vec<ElasticState>,
    /// The pressures of these states, if they are kept.
    kept: Option<Vec<Pressed>>,
    error: f64,
    progress: P,
}

impl<P: FnMut(&[ElasticState]) -> ControlFlow<()>> SweepSolver<'_, P> {
    /// The greatest level under some loads.
    fn largest_level(&mut self, loads: &[Load]) -> Result<f64> {
        let mut largest = 0.0_f64;
        for &load in loads {
            if load.tilt() != self.asked.tilt {
                return Err(other_tilt(self.asked.tilt, load));
            }
            largest = largest.max(state_under(&mut self.elastic, load)?.state.level);
        }
        let allowed = "beyond the first touch";
        if largest > 0.0 {
            Ok(largest)
        } else {
            Err(Error::OutOfRange { field: "load that a sweep reaches", value: largest, allowed })
        }
    }

    fn solve(&mut self, level: f64) -> Result<Solved> {
        state_under(&mut self.elastic, Load::Force { normal: level, tilt: self.asked.tilt })
    }

    /// Adds a state. Breaks if the sweep is to end with it.
    fn add(&mut self, Solved { state, pressure }: &Solved) -> ControlFlow<()> {
        self.solved.push(*state);
        self.kept.iter_mut().for_each(|kept| kept.push(pressure.clone()));
        let ends = (self.progress)(&self.solved).is_break() || self.solved.len() >= self.asked.max_states;
        if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Levels from `last` down by halves to the smallest contact, then what lies between them. Pairs of neighbours
    /// are halved in turn: where a sweep ends early, the pairs left have about the same error. Where the pressure
    /// falls between the levels of a pair of the first pass but the last, contacts of these levels and below are held
    /// or free as a whole.
    fn sweep(&mut self, last: f64) -> Result<()> {
        let mut states = self.first_pass(last)?;
        (self.last_depth, self.last_level) = (self.depth(&states[0].state), last);
        let ended = states.iter().position(|solved| self.add(solved).is_break());
        states.truncate(ended.map_or(states.len(), |last| last + 1));
        self.error = if states.len() > 1 { 0.0 } else { f64::INFINITY };
        let mut ends = ended.is_some();
        let first = |pair: &[Rc<Solved>]| Pair::new(&pair[1], &pair[0], pair[0].state.level, f64::INFINITY);
        let mut pairs: VecDeque<Pair> = states.windows(2).map(first).collect();
        drop(states);
        while let Some(pair) = pairs.pop_front() {
            let top = pair.top;
            if top <= self.first_level {
                continue;
            }
            match self.halve(pair, &mut pairs, ends) {
                Ok(next) => ends |= next.is_break(),
                Err(Error::Shrinks { .. }) if top < last => self.first_level = top,
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// States from `last` down by halves of the level to the smallest contact.
    fn first_pass(&mut self, last: f64) -> Result<Vec<Rc<Solved>>> {
        let mut states = vec![Rc::new(self.solve(last)?)];
        // on the same cells, motions are linear in the level; no contact has fewer than one cell for each free motion
        let (mut is_linear, free) =
            (false, self.asked.tilt.iter().filter(|tilt| matches!(tilt, Tilt::Free { .. })).count());
        while let Some(Solved { state, pressure }) = states.last().map(Rc::as_ref) {
            let is_smallest = is_linear && (state.cells <= 1 + free || state.level < SWEEP.linear_level * last);
            if is_smallest || state.level < SWEEP.least_level * last {
                break;
            }
            let next = self.solve(0.5 * state.level)?;
            is_linear = pressure.is_on_the_cells_of(&next.pressure);
            if is_linear {
                self.rest = self.rest_below(state, &next.state);
            }
            states.push(Rc::new(next));
        }
        Ok(states)
    }

    /// Depth of the load point at a state.
    fn depth(&self, state: &ElasticState) -> f64 {
        state.motion().at(self.at) - self.rest.approach
    }

    /// Where the body rests: the line through a state and one of half its level, continued to no load.
    fn rest_below(&self, upper: &ElasticState, lower: &ElasticState) -> RigidMotion {
        let [upper, lower] = [upper, lower].map(|state| [state.motion().at(self.at), state.tilt[0], state.tilt[1]]);
        let [approach, first, second] = [0, 1, 2].map(|k| 2.0 * lower[k] - upper[k]);
        RigidMotion { approach, tilt: [first, second] }
    }

    /// Adds the state in the middle of a pair, and both halves to the pairs unless the pair is accurate. A sweep that
    /// ends leaves the pair as it is.
    fn halve(&mut self, pair: Pair, pairs: &mut VecDeque<Pair>, ends: bool) -> Result<ControlFlow<()>> {
        let Pair { lower, upper, top, error } = pair;
        self.check_growth(&lower, &upper)?;
        if ends {
            self.error = self.error.max(error);
            return Ok(ControlFlow::Break(()));
        }
        let curve = ElasticStates::new(vec![lower.state, upper.state], self.rest, self.asked.tilt);
        let middle = Rc::new(self.solve((lower.state.level * upper.state.level).sqrt())?);
        let mut error = curve.error_at(&middle.state) * (self.depth(&middle.state) / self.last_depth).sqrt();
        if self.kept.is_some() {
            error = error.max(self.error_of_pressure([&lower, &middle, &upper]));
        }
        if SWEEP.safety * error <= self.asked.accuracy || upper.state.level < SWEEP.finest * lower.state.level {
            self.check_growth(&lower, &middle)?;
            self.check_growth(&middle, &upper)?;
            self.error = self.error.max(error);
        } else {
            // checked in their turn
            pairs.extend([Pair::new(&middle, &upper, top, error), Pair::new(&lower, &middle, top, error)]);
        }
        Ok(self.add(&middle))
    }

    /// Σ |δp| of the pressure in the middle from the line through both others, over its load, or over a part of the
    /// greatest load.
    fn error_of_pressure(&self, [lower, middle, upper]: [&Solved; 3]) -> f64 {
        let (grid, [low, level, high]) =
            (self.elastic.fields().grid(), [lower, middle, upper].map(|solved| solved.state.level));
        let (share, mut off) = ((level - low) / (high - low), vec![0.0; grid.len()]);
        for (solved, share) in [(lower, 1.0 - share), (upper, share), (middle, -1.0)] {
            solved.pressure.add_to(share, &mut off);
        }
        let sum: f64 = off.iter().map(|off| off.abs()).sum();
        sum * grid.cell_area() / level.max(SWEEP.least_load * self.last_level)
    }

    /// Nowhere may the pressure fall while the load grows.
    fn check_growth(&self, lower: &Solved, upper: &Solved) -> Result<()> {
        let levels = [lower.state.level, upper.state.level];
        lower.pressure.check_growth(&upper.pressure, levels, self.allowed_fall)
    }

    fn finish(self) -> ElasticStates {
        let SweepSolver { asked, solved, mut kept, rest, error, first_level, .. } = self;
        let mut order: Vec<usize> = (0..solved.len()).filter(|&k| solved[k].level >= first_level).collect();
        order.sort_by(|&a, &b| solved[a].level.total_cmp(&solved[b].level));
        let states = order.iter().map(|&k| solved[k]).collect();
        let pressures = kept.iter_mut().flat_map(|kept| order.iter().map(|&k| std::mem::take(&mut kept[k]))).collect();
        let mut states = ElasticStates::new(states, rest, asked.tilt);
        (states.error, states.first_level, states.pressures) = (error, first_level, pressures);
        states
    }
}
