//! The elastic curve of a tip: force and stiffness over depth, for unit modulus.

use viscocontact::numeric::{hermite, hermite_slope};
use viscocontact::states::{ElasticState, ElasticStates};

use crate::error::{Error, Result};
use crate::forward::real::Real;

/// Relative distance of the levels from which a slope is taken.
const NEAR: f64 = 1e-4;
/// Least depth of a swept tip, relative to the largest.
const TOUCH: f64 = 1e-6;
/// Cells of a contact that is a power of the depth down to a surface that is known.
const FEW_CELLS: usize = 12;
/// Number of the nodes, between which a cubic is exact to 1e-9.
const NODES: usize = 2048;
/// Exponents of two states that differ by less than this fraction are those of a closed form.
const CLOSED: f64 = 1e-12;
/// Maximum exponent of a flat punch, or a cell.
const FLAT: f64 = 1.005;

/// Elastic contact of unit modulus at one depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Elastic<const N: usize> {
    /// Force over modulus \[m²\].
    pub(super) force: Real<N>,
    /// Growth of the force with the depth \[m\].
    pub(super) stiffness: Real<N>,
}

/// The elastic states of a tip by depth, a power of it below the first node.
#[derive(Clone, Debug)]
pub(crate) struct Tip {
    /// Index of its curve, for errors.
    curve: usize,
    pub(super) last_depth: f64,
    /// ln of the depth of the first node, and the distance to the next one.
    first: f64,
    step: f64,
    /// ln of the force, and its slope over ln of the depth.
    nodes: Vec<[f64; 2]>,
}

impl Tip {
    /// The depth is 0 at the approach `surface`. `curve` is the index of the curve in errors.
    pub(crate) fn new(curve: usize, tip: &ElasticStates, surface: f64) -> Tip {
        let (states, depth_of) = (tip.states(), |state: &ElasticState| state.approach - surface);
        let exponent = |state: &ElasticState| state.load_stiffness * depth_of(state) / state.level;
        let last_depth = states.last().map_or(0.0, |last| tip.approach(last.level) - surface);
        let few = states.iter().find(|state| tip.grid().is_none() || state.cells >= FEW_CELLS);
        let is_power = tip.grid().is_none() || surface < tip.approach(0.0);
        let start = few.filter(|_| is_power);
        let count = match states {
            [a, b] if (exponent(a) / exponent(b) - 1.0).abs() < CLOSED => 2,
            _ => NODES,
        };
        let first = start.map_or(TOUCH * last_depth, depth_of).ln();
        let step = (last_depth.ln() - first) / (count - 1) as f64;
        let node = |k: usize| {
            let depth = (first + step * k as f64).exp();
            let level = tip.level_at((surface + depth).min(surface + last_depth));
            // the derivative of the curve that the states interpolate
            let [low, high] = [1.0 - NEAR, 1.0 + NEAR].map(|factor| tip.approach(level * factor));
            [level.ln(), 2.0 * NEAR * depth / (high - low)]
        };
        let mut nodes: Vec<[f64; 2]> = (0..count).map(node).collect();
        for (at, state) in [(0, start), (count - 1, states.last())] {
            nodes[at] = state.map_or(nodes[at], |state| [state.level.ln(), exponent(state)]);
        }
        Tip { curve, last_depth, first, step, nodes }
    }

    /// The error of a depth beyond the last state.
    pub(super) fn beyond(&self, depth: f64) -> Error {
        Error::BeyondStates { curve: self.curve, depth }
    }

    /// The elastic contact at a depth.
    pub(super) fn at<const N: usize>(&self, depth: Real<N>) -> Result<Elastic<N>> {
        let at = depth.value();
        if at <= 0.0 {
            return Ok(self.first());
        }
        if at > self.last_depth * (1.0 + NEAR) {
            return Err(self.beyond(at));
        }
        let place = (at.ln() - self.first) / self.step;
        let k = (place as usize).min(self.nodes.len() - 2);
        let ([a, from], [b, to]) = (self.nodes[k], self.nodes[k + 1]);
        let slope_at = |t: f64| hermite_slope([a, b], [from * self.step, to * self.step], t) / self.step;
        let t = place.max(0.0) - k as f64;
        let (slope, below) = (slope_at(t), place.min(0.0) * self.step);
        let force = (hermite([a, b], [from * self.step, to * self.step], t) + slope * below).exp();
        // the slope of a cubic is a parabola, whose differences are exact
        let bend = if below < 0.0 { 0.0 } else { (slope_at(t + 0.5) - slope_at(t - 0.5)) / self.step };
        let (stiffness, growth) = (force * slope / at, force * (slope * (slope - 1.0) + bend) / (at * at));
        Ok(Elastic { force: depth.mapped(force, stiffness), stiffness: depth.mapped(stiffness, growth) })
    }

    /// The elastic contact at first touch, where only a flat punch or a cell is stiff.
    pub(super) fn first<const N: usize>(&self) -> Elastic<N> {
        let [force, exponent] = self.nodes[0];
        let stiffness = if exponent < FLAT { (force - self.first).exp() } else { 0.0 };
        Elastic { force: Real::from(0.0), stiffness: Real::from(stiffness) }
    }
}
