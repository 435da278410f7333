//! The elastic states of a scene, found by the stepper with an elastic body.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::Grid;
use crate::contact::{Builder, Settings, ViscoelasticContact};
use crate::error::{Error, Result, StatesError, count_within, finite, positive, within};
use crate::geometry::Geometry;
use crate::kernel::{InfluenceKernel, Layer};
use crate::load::{Load, Tilt};
use crate::rheology::{Elastic, Material};
use crate::states::curve::{ElasticState, ElasticStates, Rest, approach_at, load_point};
use crate::states::elastic::{ElasticContact, Solved};
use crate::states::pressed::Pressed;

/// How far a sweep goes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Reach {
    /// To a level \[m²\]: force times compliance. A force F held on a body of the contact creep compliance C(t) reaches F C(t).
    Level(f64),
    /// To an approach of the load point \[m\].
    Approach(f64),
}

/// Finds the elastic states of a shape on a body, each by the stepper with an elastic body of unit compliance.
///
/// A first pass takes levels that double. Then a state is added in the middle, in ln l, of two others, and more beside
/// it where depth or slope differ from their interpolation by more than the accuracy times √(δ δ_last): small contacts
/// have few cells, whose own error is larger. A sweep costs about as much as so many jumps of the load.
#[derive(Debug, Clone)]
#[must_use = "a sweep does nothing until it is run"]
pub struct Sweep {
    builder: Builder,
    layer: Option<Layer>,
    tilt: [Tilt; 2],
    accuracy: f64,
    max_states: usize,
    settings: Settings,
    keep_pressures: bool,
}

/// The smallest level of a sweep over the greatest.
const LEAST_LEVEL: f64 = 1e-12;
/// The level, over the greatest, below which a contact that stays the same is the smallest.
const LINEAR_LEVEL: f64 = 1e-6;
/// Levels closer than by this factor have no state between them.
const FINEST: f64 = 1.001;
/// Greatest fall of a pressure, over the greatest pressure, that is taken for an error of a solver of this tolerance.
const FALL_OVER_TOLERANCE: f64 = 1e2;
/// The error in the middle of two states is so much below the accuracy: elsewhere between them it may be greater.
const SAFETY: f64 = 2.0;

impl Sweep {
    /// A shape pressed upright onto an incompressible half-space.
    pub fn new(grid: Grid, geometry: &dyn Geometry) -> Sweep {
        let settings = Settings::default().with_tolerance(1e-8);
        Sweep {
            builder: ViscoelasticContact::builder(grid).geometry(geometry),
            layer: None,
            tilt: [Tilt::Fixed(0.0); 2],
            accuracy: 1e-4,
            max_states: 400,
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

    /// Error of the depth δ between two states, relative to √(δ δ_last), with δ_last the greatest depth (default: 1e-4).
    pub fn accuracy(mut self, accuracy: f64) -> Sweep {
        self.accuracy = accuracy;
        self
    }

    /// Upper limit of the number of states (default: 400): where it is reached, the sweep is less accurate than asked for, and
    /// [`ElasticStates::interpolation_error`] says so.
    pub fn max_states(mut self, max_states: usize) -> Sweep {
        self.max_states = max_states;
        self
    }

    /// Settings of the stepper (default: those of [`Settings`] with a tolerance of 1e-8).
    pub fn settings(mut self, settings: Settings) -> Sweep {
        self.settings = settings;
        self
    }

    /// Keeps the pressure of every state, 12 bytes for each of its cells in contact, for
    /// [`StatesContact::pressure`](crate::states::StatesContact::pressure).
    pub fn keep_pressures(mut self) -> Sweep {
        self.keep_pressures = true;
        self
    }

    /// Runs the sweep.
    ///
    /// # Errors
    /// Those of [`Builder::build`] and [`ViscoelasticContact::step`]; [`StatesError::Shrinks`] if the pressure falls
    /// somewhere while the load grows; if the accuracy is outside \[1e-8, 0.1\], or the reach is not finite and
    /// positive.
    pub fn run(self, to: Reach) -> Result<Arc<ElasticStates>> {
        self.run_with(to, |_| ControlFlow::Continue(()))
    }

    /// As [`Sweep::run`], calling `progress` after each state with all states so far, in the order of their solution;
    /// it may end the sweep early, with the states that it has then.
    ///
    /// # Errors
    /// As [`Sweep::run`].
    pub fn run_with(
        self,
        to: Reach,
        progress: impl FnMut(&[ElasticState]) -> ControlFlow<()>,
    ) -> Result<Arc<ElasticStates>> {
        let accuracy =
            within("accuracy of a sweep", self.accuracy, (1e-8..=0.1).contains(&self.accuracy), "in [1e-8, 0.1]")?;
        count_within("states of a sweep", self.max_states, self.max_states >= 3, "3 or more")?;
        let (Reach::Level(reach) | Reach::Approach(reach)) = to;
        positive("reach of a sweep", reach)?;
        for tilt in self.tilt {
            let (Tilt::Fixed(value) | Tilt::Free { at: value }) = tilt;
            finite("tilt or load point of a sweep", value)?;
        }
        let nu = self.layer.as_ref().map_or(0.5, Layer::poisson_ratio);
        // C = (1 − ν) J/2 = 1 Pa⁻¹
        let unit = Material::constant_poisson(Elastic::new(0.5 * (1.0 - nu))?, nu)?;
        let scene = self.builder.material(unit).settings(self.settings);
        let elastic = ElasticContact::new(&scene)?;
        let tilt = self.tilt.map(|tilt| if let Tilt::Fixed(angle) = tilt { angle } else { 0.0 });
        let at = load_point(&self.tilt);
        let grid = elastic.grid().clone();
        let mut solver = Solver {
            elastic,
            tilt: self.tilt,
            at,
            rest: Rest { approach: 0.0, tilt },
            last_depth: 0.0,
            first_level: 0.0,
            accuracy,
            max_states: self.max_states,
            allowed_fall: FALL_OVER_TOLERANCE * self.settings.tolerance,
            solved: Vec::new(),
            kept: self.keep_pressures.then(Vec::new),
            error: 0.0,
            progress,
        };
        let last = match to {
            Reach::Level(level) => level,
            Reach::Approach(approach) => solver.level_at(approach)?,
        };
        solver.sweep(last)?;
        let mut states = solver.finish();
        (states.poisson, states.grid) = (self.layer.map(|layer| layer.poisson_ratio()), Some(grid));
        states.scene = Some(scene);
        Ok(Arc::new(states))
    }
}

/// The elastic contact that finds states.
struct Solver<P> {
    elastic: ElasticContact,
    tilt: [Tilt; 2],
    /// The load point.
    at: [f64; 2],
    rest: Rest,
    last_depth: f64,
    /// The level from which the contact only grows.
    first_level: f64,
    accuracy: f64,
    max_states: usize,
    allowed_fall: f64,
    solved: Vec<ElasticState>,
    /// The pressures of these states, if they are kept.
    kept: Option<Vec<Pressed>>,
    error: f64,
    progress: P,
}

impl<P: FnMut(&[ElasticState]) -> ControlFlow<()>> Solver<P> {
    /// The level at an approach of the load point.
    fn level_at(&mut self, approach: f64) -> Result<f64> {
        match self.elastic.solve(Load::Approach { approach, tilt: self.tilt })?.state.level {
            level if level > 0.0 => Ok(level),
            _ => Err(Error::OutOfRange {
                field: "approach that a sweep reaches",
                value: approach,
                allowed: "beyond the first touch",
            }),
        }
    }

    fn solve(&mut self, level: f64) -> Result<Solved> {
        self.elastic.solve(Load::Force { normal: level, tilt: self.tilt })
    }

    /// Adds a state, unless the sweep is to end.
    fn add(&mut self, Solved { state, pressure }: &Solved) -> ControlFlow<()> {
        self.solved.push(*state);
        self.kept.iter_mut().for_each(|kept| kept.push(pressure.clone()));
        if self.solved.len() >= self.max_states {
            return ControlFlow::Break(());
        }
        (self.progress)(&self.solved)
    }

    /// Levels from `last` down by halves to the smallest contact, then what lies between them, the largest contacts first.
    fn sweep(&mut self, last: f64) -> Result<()> {
        let mut coarse = vec![self.solve(last)?];
        // on the same cells, motions are linear in the level; no contact has fewer than one cell for each free motion
        let (mut is_linear, free) = (false, self.tilt.iter().filter(|tilt| matches!(tilt, Tilt::Free { .. })).count());
        while let Some(Solved { state, pressure }) = coarse.last() {
            let is_smallest = is_linear && (state.cells <= 1 + free || state.level < LINEAR_LEVEL * last);
            if is_smallest || state.level < LEAST_LEVEL * last {
                break;
            }
            let next = self.solve(0.5 * state.level)?;
            is_linear = pressure.is_on_the_cells_of(&next.pressure);
            if is_linear {
                self.rest = self.rest_below(state, &next.state);
            }
            coarse.push(next);
        }
        for solved in &coarse {
            if self.add(solved).is_break() {
                return Ok(());
            }
        }
        self.last_depth = self.depth(&coarse[0].state);
        for pair in coarse.windows(2) {
            match self.between(&pair[1], &pair[0]) {
                Ok(ControlFlow::Continue(())) => {}
                Ok(ControlFlow::Break(())) => break,
                // what lies below is held or free as a whole
                Err(Error::States(StatesError::Shrinks { .. })) if pair[0].state.level < last => {
                    self.first_level = pair[0].state.level;
                    break;
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Depth of the load point at a state.
    fn depth(&self, state: &ElasticState) -> f64 {
        approach_at(self.at, state.approach, state.tilt) - self.rest.approach
    }

    /// Where the body rests: the line through a state and one of half its level, continued to no load.
    fn rest_below(&self, upper: &ElasticState, lower: &ElasticState) -> Rest {
        let [upper, lower] = [upper, lower].map(|state| {
            let approach = approach_at(self.at, state.approach, state.tilt);
            [approach, state.tilt[0], state.tilt[1]]
        });
        let [approach, first, second] = [0, 1, 2].map(|k| 2.0 * lower[k] - upper[k]);
        Rest { approach, tilt: [first, second] }
    }

    /// Adds what is needed between two states.
    fn between(&mut self, lower: &Solved, upper: &Solved) -> Result<ControlFlow<()>> {
        self.check_growth(lower, upper)?;
        let pair = ElasticStates::new(vec![lower.state, upper.state], self.rest, self.tilt);
        let middle = self.solve((lower.state.level * upper.state.level).sqrt())?;
        let error = pair.error_at(&middle.state) * (self.depth(&middle.state) / self.last_depth).sqrt();
        let is_fine = SAFETY * error <= self.accuracy || upper.state.level < FINEST * lower.state.level;
        if self.add(&middle).is_break() || is_fine {
            self.error = self.error.max(error);
            self.check_growth(lower, &middle)?;
            self.check_growth(&middle, upper)?;
            let ends = self.solved.len() >= self.max_states;
            return Ok(if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) });
        }
        if self.between(&middle, upper)?.is_break() {
            return Ok(ControlFlow::Break(()));
        }
        self.between(lower, &middle)
    }

    /// Nowhere may the pressure fall while the load grows.
    fn check_growth(&self, lower: &Solved, upper: &Solved) -> Result<()> {
        let levels = [lower.state.level, upper.state.level];
        lower.pressure.check_growth(&upper.pressure, levels, self.allowed_fall)
    }

    fn finish(self) -> ElasticStates {
        let Solver { solved, mut kept, rest, tilt, error, first_level, .. } = self;
        let mut order: Vec<usize> = (0..solved.len()).filter(|&k| solved[k].level >= first_level).collect();
        order.sort_by(|&a, &b| solved[a].level.total_cmp(&solved[b].level));
        let states = order.iter().map(|&k| solved[k]).collect();
        let pressures = kept.iter_mut().flat_map(|kept| order.iter().map(|&k| std::mem::take(&mut kept[k]))).collect();
        let mut states = ElasticStates::new(states, rest, tilt);
        (states.error, states.first_level, states.pressures) = (error, first_level, pressures);
        states
    }
}
