//! The loads of one body: at the last nodes of a run, and within a step.

use crate::contact::{Computation, Scene, State};
use crate::error::{Error, Result};
use crate::load::{Load, LoadHistory};
use crate::run::passage::{Passage, Span};
use crate::run::run_scale::{RunScale, approach};

/// Nodes of the quadratic and its correction, besides the end of the step.
const NODES: usize = 3;
/// What a run knows of the loads of a body.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Track {
    /// Times and loads of the last nodes since the last jump or corner, newest first.
    pub(super) nodes: Vec<(f64, Load)>,
    /// Length of the last step before a corner, and the slope of the load over it, per second of reduced time.
    pub(super) corner: Option<(f64, f64)>,
    /// Maximum loads and displacements of the run.
    pub(super) scale: RunScale,
    /// The load within the step under way.
    #[cfg_attr(feature = "checkpoint", serde(skip))]
    pub(super) passage: Passage,
    /// Whether the body is apart at the start of the step, ...
    pub(super) is_apart: bool,
    /// ... and driven, upright, in the step under way.
    pub(super) is_driven: bool,
}

impl Track {
    pub(super) fn new() -> Track {
        let nodes = Vec::with_capacity(NODES + 1);
        let (scale, passage) = (RunScale::default(), Passage::default());
        Track { nodes, corner: None, scale, passage, is_apart: false, is_driven: false }
    }

    /// Whether a run can continue with these values; a damaged file may hold any.
    #[cfg(feature = "checkpoint")]
    pub(super) fn fits(&self) -> bool {
        self.nodes.len() <= NODES
            && self.nodes.windows(2).all(|pair| pair[0].0 > pair[1].0)
            && self.nodes.iter().all(|(time, load)| time.is_finite() && load.validate().is_ok())
            && self.scale.fits()
    }

    /// Starts anew at a jump of the load.
    pub(super) fn jump(&mut self) {
        self.corner = None;
        self.nodes.clear();
    }

    /// Starts anew at a corner of a load at the end of the last step.
    pub(super) fn turn(&mut self) {
        self.corner = match self.nodes[..] {
            [(end, load), (start, before), ..] => {
                let change = self.scale.magnitude(&load) - self.scale.magnitude(&before);
                Some((end - start, change / (end - start)))
            }
            _ => None,
        };
        self.nodes.clear();
    }

    /// Records the load at the end of a step.
    pub(super) fn accept(&mut self, time: f64, load: Load) {
        if self.nodes.first().is_some_and(|(_, last)| !last.is_like(&load)) {
            self.nodes.clear();
        }
        self.nodes.truncate(NODES - 1);
        self.nodes.insert(0, (time, load));
    }

    /// Whether the body, which is apart, has a path of its own in the step: where it was does not matter then.
    pub(super) fn is_parted(&self) -> bool {
        self.is_apart && self.is_driven
    }

    /// Looks at the load within a step.
    pub(super) fn look(&mut self, history: &dyn LoadHistory, span: Span) -> Result<()> {
        let Track { scale, passage, .. } = self;
        let (start, attracts) = (history.checked_at(span.now, scale.attracts)?, scale.attracts);
        let end = history.checked_before(span.end, attracts)?;
        self.is_driven = [start, end].iter().all(|load| approach(load).is_some());
        passage.look(span, start.main(), &scale.bends, |time| Ok(history.checked_before(time, attracts)?.main()))
    }

    /// Maximum deviation of the load in the step that was looked at from the polynomial through its last nodes and the
    /// load at its end, relative to the load or to a fraction of the maximum load of the run. Beyond the `tolerance` it
    /// is not followed further.
    pub(super) fn straying(
        &self,
        scene: &Scene,
        state: &State,
        history: &dyn LoadHistory,
        tolerance: f64,
    ) -> Result<f64> {
        let (clock, time, attracts) = (&state.clock, self.passage.span().end, self.scale.attracts);
        let end = history.checked_before(time, attracts)?;
        let mut nodes = [(scene.reduced_time(clock, time)?, end); NODES + 1];
        let known = self.nodes.len().min(NODES);
        nodes[1..=known].copy_from_slice(&self.nodes[..known]);
        let nodes = &nodes[..=known];
        let start = nodes[known.min(1)].1;
        let scale = self.scale.of_load(&start, &end);
        let mut most = 0.0_f64;
        for (between, _) in self.passage.inside() {
            // a step that is too long already need not be looked at further
            if most > tolerance {
                break;
            }
            let load = history.checked_at(between, attracts)?;
            let like = load.is_like(&start) && load.is_like(&end);
            let off = || Ok::<_, Error>(load.deviation(scene.reduced_time(clock, between)?, nodes, scale));
            most = most.max(if like { off()? } else { f64::INFINITY });
        }
        Ok(most)
    }
}

/// Whether the load is the same from `now` to `time`, and for as long after it.
pub(super) fn is_held(history: &dyn LoadHistory, now: f64, time: f64) -> bool {
    let load = history.at(now);
    load == history.at(time) && load == history.at(time + (time - now))
}

/// Whether a body presses in a step that was computed. A call of all ranks.
pub(super) fn presses(scene: &Scene, computed: &Computation, body: usize) -> bool {
    computed.state.held.presses(&scene.ground, &computed.trial.solution.pressure, body)
}
