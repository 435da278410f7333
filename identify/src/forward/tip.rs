//! The elastic curve of a tip: force, stiffness and area over depth, for unit modulus.

use std::sync::Arc;

use viscocontact::numeric::{hermite, hermite_slope};
use viscocontact::states::{ElasticState, ElasticStates};

use crate::forward::real::Real;

/// Relative distance of the levels from which a slope is taken.
const NEAR: f64 = 1e-4;
/// Relative distance of the levels from which the growth of a slope is taken.
const APART: f64 = 2e-3;
/// Least depth, relative to the greatest: there the stiffness is taken of a tip that just touches.
const TOUCH: f64 = 1e-6;

/// Elastic contact of unit modulus at one depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Elastic<T> {
    /// Force over modulus \[m²\].
    pub(super) force: T,
    /// Growth of the force with the depth \[m\].
    pub(super) stiffness: T,
}

impl<T: Real> Elastic<T> {
    /// From force, stiffness and growth of the stiffness at a depth.
    fn of(depth: T, [force, stiffness, growth]: [f64; 3]) -> Elastic<T> {
        Elastic { force: depth.mapped(force, stiffness), stiffness: depth.mapped(stiffness, growth) }
    }
}

/// The elastic states of a tip by depth.
#[derive(Clone, Debug)]
pub(super) struct Tip {
    states: Arc<ElasticStates>,
    /// Approach at first touch \[m\].
    rest: f64,
    last_depth: f64,
    /// Force and depth of a state, and the exponent, of a closed form: the force is a power of the depth.
    power: Option<[f64; 3]>,
    /// ln of the force, and its slope over ln of the depth, at equal distances of ln of the depth up to the last one, of other curves.
    nodes: Vec<[f64; 2]>,
}

/// Number of the nodes, between which a cubic is exact to 1e-9.
const NODES: usize = 2048;

/// Deviation of an exponent from a state to the next below which the states are a closed form.
const CLOSED: f64 = 1e-12;

impl Tip {
    pub(super) fn new(states: &Arc<ElasticStates>) -> Tip {
        let rest = states.approach(0.0);
        let last = states.states().last().map_or(0.0, |state| state.level);
        let power = match states.states() {
            [a, b] if rest == 0.0 => {
                let exponent = (b.level / a.level).ln() / (b.approach / a.approach).ln();
                let is_power =
                    |s: &ElasticState| (s.load_stiffness * s.approach / s.level / exponent - 1.0).abs() < CLOSED;
                (is_power(a) && is_power(b)).then_some([a.level, a.approach, exponent])
            }
            _ => None,
        };
        let mut tip = Tip {
            states: Arc::clone(states),
            rest,
            last_depth: states.approach(last) - rest,
            power,
            nodes: Vec::new(),
        };
        if power.is_none() && tip.last_depth > 0.0 {
            let node = |k: usize| {
                let depth = tip.last_depth * (TOUCH.ln() * (1.0 - k as f64 / (NODES - 1) as f64)).exp();
                let level = tip.states.level_at(tip.rest + depth);
                [level.ln(), tip.stiffness(level) * depth / level]
            };
            tip.nodes = (0..NODES).map(node).collect();
        }
        tip
    }

    /// Force and stiffness at a depth between the nodes.
    fn between(&self, depth: f64) -> Option<[f64; 2]> {
        let step = -TOUCH.ln() / (NODES - 1) as f64;
        let place = ((depth / self.last_depth).ln() - TOUCH.ln()) / step;
        let k = if (0.0..(NODES - 1) as f64).contains(&place) { place as usize } else { return None };
        let ([a, da], [b, db], t) = (*self.nodes.get(k)?, *self.nodes.get(k + 1)?, place - k as f64);
        let (values, slopes) = ([a, b], [da * step, db * step]);
        let (force, slope) = (hermite(values, slopes, t).exp(), hermite_slope(values, slopes, t) / step);
        Some([force, force * slope / depth]).filter(|[force, _]| force.is_finite())
    }

    /// Depth of the last state \[m\].
    pub(super) fn last_depth(&self) -> f64 {
        self.last_depth
    }

    /// The elastic contact at a depth; `None` beyond the last state.
    pub(super) fn at<T: Real>(&self, depth: T) -> Option<Elastic<T>> {
        let at = depth.value();
        if at <= 0.0 {
            return Some(self.first());
        }
        if let Some([force, unit, exponent]) = self.power.filter(|_| at <= self.last_depth) {
            let force = force * (at / unit).powf(exponent);
            let stiffness = exponent * force / at;
            return Some(Elastic::of(depth, [force, stiffness, (exponent - 1.0) * stiffness / at]));
        }
        let [level, stiffness] = self.between(at).or_else(|| {
            let level = self.states.level_at(self.rest + at.min(self.last_depth));
            let inside = at <= self.last_depth * (1.0 + NEAR) && level.is_finite();
            inside.then(|| [level, self.stiffness(level)])
        })?;
        // only derivatives need it
        let growth = if T::DERIVES { self.growth(level) * stiffness } else { 0.0 };
        Some(Elastic::of(depth, [level, stiffness, growth]))
    }

    /// The elastic contact at first touch: only a flat punch is stiff there. The stiffness is a secant, since a rough or layered tip rests
    /// at an approach that hides the digits of smaller depths.
    pub(super) fn first<T: Real>(&self) -> Elastic<T> {
        let depth = TOUCH * self.last_depth;
        let stiffness = match self.power {
            Some([.., exponent]) if exponent > 1.0 + CLOSED => 0.0,
            _ => self.states.level_at(self.rest + depth) / depth,
        };
        Elastic { force: T::from(0.0), stiffness: T::from(stiffness) }
    }

    /// dS/dl at a level.
    fn growth(&self, level: f64) -> f64 {
        let [low, high] = [1.0 - APART, 1.0 + APART].map(|factor| self.stiffness(level * factor));
        (high - low) / (2.0 * APART * level)
    }

    /// dl/dδ between two levels nearby: the derivative of the curve that the states interpolate.
    fn stiffness(&self, level: f64) -> f64 {
        let [low, high] = [1.0 - NEAR, 1.0 + NEAR].map(|factor| self.states.approach(level * factor));
        2.0 * NEAR * level / (high - low)
    }
}
