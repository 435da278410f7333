//! The elastic states of a contact, and what lies between them.

use std::f64::consts::PI;

use crate::Grid;
use crate::contact::{Figures, Warnings};
use crate::elastic::ElasticBuilder;
use crate::error::{Result, count_within, in_order, least_length, positive};
use crate::load::{Tilt, load_point};
use crate::numeric::{hermite, hermite_slope, root};
use crate::solver::RigidMotion;
use crate::states::pressed::Pressed;

/// States nearer than this factor of the level are one.
const NEAREST: f64 = 1e-12;
/// Least dln δ/dln l of the power below the first state: far below the slope of any shape that contacts are made of.
const LEAST_SLOPE: f64 = 0.01;
/// Rounding of a root between states.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// An elastic contact of unit compliance at one level.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ElasticState {
    /// Level l: force times compliance \[m²\].
    pub level: f64,
    /// Approach of the origin \[m\].
    pub approach: f64,
    /// Tilt along x1 and x2 \[rad\].
    pub tilt: [f64; 2],
    /// Stiffness over the contact modulus, dl/dy for a motion of the body without tilt \[m\]: 2a for a circle of
    /// radius a. Infinite on periodic bodies in full contact.
    pub stiffness: f64,
    /// dl/dδ of the load point, about which the body tilts where its tilt is free \[m\]: the stiffness of an upright
    /// body.
    pub load_stiffness: f64,
    /// Growth of the tilts with the level \[rad/m²\].
    pub(crate) tilt_rate: [f64; 2],
    /// Contact area, fractions of cells included \[m²\].
    pub area: f64,
    /// Number of cells in contact.
    pub cells: usize,
    /// Number of contact patches.
    pub patches: usize,
    /// What is outside the model in this contact: slopes, cells, edges, layers and waves.
    pub warnings: Warnings,
    /// The numbers of these warnings.
    pub figures: Figures,
}

impl ElasticState {
    pub(super) fn motion(&self) -> RigidMotion {
        RigidMotion { approach: self.approach, tilt: self.tilt }
    }
}

/// The elastic states of one contact, by ascending level, from a [`Sweep`](crate::states::Sweep).
///
/// Between states the logarithm of the approach is a cubic of the logarithm of the level, area and stiffness are powers
/// of the level, and tilts cubics of its logarithm; below the first state all are powers of the level.
#[derive(Clone)]
pub struct ElasticStates {
    pub(crate) states: Vec<ElasticState>,
    /// Motion of the elastic contact in the limit of no load: where the body rests.
    pub(crate) rest: RigidMotion,
    /// Tilts, or load points, along x1 and x2.
    pub(crate) tilt: [Tilt; 2],
    /// Poisson's ratio of a layer, on which its elastic states depend.
    pub(crate) poisson: Option<f64>,
    /// Maximum error that a state in the middle of two others showed, less the errors that states added later removed.
    pub(crate) error: f64,
    /// Below this level the elastic contact does not only grow: these levels are held or free as a whole.
    pub(crate) first_level: f64,
    /// The pressures of the states, if they are kept.
    pub(crate) pressures: Vec<Pressed>,
    /// The grid of the sweep.
    pub(crate) grid: Option<Grid>,
    /// What they were swept with, for states between them.
    pub(super) scene: Option<ElasticBuilder>,
    nodes: Vec<Node>,
}

/// ln l, ln δ and its slope, with δ the depth of the load point.
#[derive(Debug, Clone, Copy)]
struct Node {
    level: f64,
    depth: f64,
    slope: f64,
}

/// Motions since the body rested on the undisturbed surface.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Motions {
    /// δ, of the load point \[m\].
    pub(super) depth: f64,
    pub(crate) tilt: [f64; 2],
}

impl Motions {
    /// Adds `share` of the motions from `lower` to `upper`.
    pub(super) fn add(&mut self, share: f64, lower: Motions, upper: Motions) {
        self.depth += share * (upper.depth - lower.depth);
        for axis in 0..2 {
            self.tilt[axis] += share * (upper.tilt[axis] - lower.tilt[axis]);
        }
    }
}

impl ElasticStates {
    pub(crate) fn new(states: Vec<ElasticState>, rest: RigidMotion, tilt: [Tilt; 2]) -> ElasticStates {
        let (poisson, grid, scene) = (None, None, None);
        let (error, first_level, pressures, nodes) = (0.0, 0.0, Vec::new(), Vec::new());
        let mut elastic =
            ElasticStates { states, rest, tilt, poisson, error, first_level, pressures, grid, scene, nodes };
        elastic.nodes = elastic.nodes();
        elastic
    }

    /// Accepts states that a contact can be made of.
    pub(crate) fn validated(self) -> Result<ElasticStates> {
        least_length("elastic states", self.states.len(), 2)?;
        let depths = || self.states.iter().map(|state| self.depth_of(state));
        for (state, depth) in self.states.iter().zip(depths()) {
            positive("level of an elastic state", state.level)?;
            positive("approach of an elastic state from first touch", depth)?;
            positive("area of an elastic state", state.area)?;
            for stiffness in [state.stiffness, state.load_stiffness].into_iter().filter(|s| *s != f64::INFINITY) {
                positive("stiffness of an elastic state", stiffness)?; // but infinite in full contact
            }
        }
        let levels = self.states.iter().map(|state| state.level);
        in_order("levels of elastic states", levels, "ascend", |before, next| next > before)?;
        in_order("approaches of elastic states", depths(), "ascend", |before, next| next > before)?;
        let fits = |pressed: &Pressed| {
            let cells = self.grid.as_ref().map_or(0, Grid::len);
            pressed.cells.len() == pressed.pressures.len() && pressed.cells.iter().all(|&cell| (cell as usize) < cells)
        };
        let kept = self.pressures.len();
        let kept_well = kept == 0 || kept == self.states.len() && self.pressures.iter().all(fits);
        count_within("pressures of elastic states", kept, kept_well, "one for each state, on cells of the grid")?;
        Ok(self)
    }

    /// Adds a state, unless one as near as rounding, or out of order by it, is there.
    pub(super) fn insert(&mut self, state: ElasticState, pressure: Pressed) {
        let at = self.states.partition_point(|other| other.level < state.level);
        let depth = self.depth_of(&state);
        let is_below =
            |other: &ElasticState| other.level * (1.0 + NEAREST) < state.level && self.depth_of(other) < depth;
        let is_above =
            |other: &ElasticState| other.level > state.level * (1.0 + NEAREST) && self.depth_of(other) > depth;
        let fits =
            at.checked_sub(1).is_none_or(|k| is_below(&self.states[k])) && self.states.get(at).is_none_or(is_above);
        if !fits || depth.is_nan() || depth <= 0.0 {
            return;
        }
        self.states.insert(at, state);
        if !self.pressures.is_empty() {
            self.pressures.insert(at, pressure);
        }
        self.nodes = self.nodes();
    }

    /// The states, by ascending level.
    pub fn states(&self) -> &[ElasticState] {
        &self.states
    }

    /// Maximum error of the depth δ between two states, relative to √(δ δ_last), measured by the states in the middle
    /// of two others. Infinite if the sweep ended before it measured between all states of its first pass.
    pub fn interpolation_error(&self) -> f64 {
        self.error
    }

    /// The grid of the sweep; `None` if there was none.
    pub fn grid(&self) -> Option<&Grid> {
        self.grid.as_ref()
    }

    /// The level from which the contact only grows as the load grows \[m²\]: contacts of a level between 0 and this
    /// one are refused.
    pub fn first_level(&self) -> f64 {
        self.first_level
    }

    /// The coordinates at which the load acts: those of free tilts, the origin along the other axes.
    pub(super) fn load_point(&self) -> [f64; 2] {
        load_point(self.tilt)
    }

    /// Distance from the load point to the edge of the largest contact \[m\], at most; 0 where no tilt is free.
    pub(super) fn reach(&self) -> f64 {
        let at = self.load_point();
        let is_free = self.tilt.iter().any(|tilt| matches!(tilt, Tilt::Free { .. }));
        let radius = self.states.last().map_or(0.0, |state| (state.area / PI).sqrt());
        if is_free { at[0].hypot(at[1]) + radius } else { 0.0 }
    }

    /// Depth of the load point at a state.
    pub(super) fn depth_of(&self, state: &ElasticState) -> f64 {
        state.motion().at(self.load_point()) - self.rest.approach
    }

    /// A contact that only grows has 0 < dln δ/dln l ≤ 1. Slopes are limited to three times the slopes of the chords
    /// beside them, so that cubics rise (Fritsch & Carlson 1980) whatever a table holds.
    fn nodes(&self) -> Vec<Node> {
        let node = |state: &ElasticState| {
            let depth = self.depth_of(state);
            Node { level: state.level.ln(), depth: depth.ln(), slope: state.level / (depth * state.load_stiffness) }
        };
        let mut nodes: Vec<Node> = self.states.iter().map(node).collect();
        for k in 1..nodes.len() {
            let [a, b] = [nodes[k - 1], nodes[k]];
            let most = 3.0 * (b.depth - a.depth) / (b.level - a.level);
            (nodes[k - 1].slope, nodes[k].slope) = (a.slope.min(most), b.slope.min(most));
        }
        if let Some(first) = nodes.first_mut() {
            first.slope = first.slope.clamp(LEAST_SLOPE, 1.0);
        }
        nodes
    }

    /// The greatest level of the sweep \[m²\].
    pub(super) fn last_level(&self) -> f64 {
        self.states.last().map_or(0.0, |state| state.level)
    }

    /// The greatest depth of the sweep \[m\].
    pub(super) fn last_depth(&self) -> f64 {
        self.states.last().map_or(0.0, |state| self.depth_of(state))
    }

    /// The two states around a level, by the index of the first, and the place of ln l between them in \[0, 1\].
    fn between(&self, level: f64) -> Option<(usize, f64)> {
        let at = self.nodes.partition_point(|node| node.level <= level);
        let lower = at.checked_sub(1)?.min(self.nodes.len().checked_sub(2)?);
        let [a, b] = [self.nodes[lower].level, self.nodes[lower + 1].level];
        Some((lower, ((level - a) / (b - a)).clamp(0.0, 1.0)))
    }

    /// δ(l) \[m\].
    pub(super) fn depth(&self, level: f64) -> f64 {
        let Some(first) = self.nodes.first().filter(|_| level > 0.0) else { return 0.0 };
        let level = level.ln();
        let Some((k, s)) = self.between(level) else {
            return (first.depth + first.slope * (level - first.level)).exp();
        };
        let [a, b] = [self.nodes[k], self.nodes[k + 1]];
        hermite([a.depth, b.depth], [a.slope, b.slope].map(|slope| slope * (b.level - a.level)), s).exp()
    }

    /// Error of the interpolation at a state in the middle, in ln l, of two others, relative to the depth: of the
    /// depth, of what the tilts lift at the edge of the contact and at the origin, or of what the slopes contribute.
    /// Each cell that joins is a kink of δ(l), and slopes scatter by as much; depths may then agree in the middle
    /// alone. So each slope is compared with the slope of the parabola through the three depths. A cubic over half of
    /// the interval errs by 4/27 of its length times the error of a slope.
    pub(super) fn error_at(&self, state: &ElasticState) -> f64 {
        let (level, depth) = (state.level.ln(), self.depth_of(state));
        let (found, at) = (self.motions(state.level), self.load_point());
        let reach = (state.area / PI).sqrt();
        let lift = |axis: usize| {
            (found.tilt[axis] - (state.tilt[axis] - self.rest.tilt[axis])).abs() * (at[axis].abs() + reach) / depth
        };
        let value = (found.depth / depth).ln().abs().max(lift(0)).max(lift(1));
        let Some((k, _)) = self.between(level) else { return value };
        let [a, b] = [self.nodes[k], self.nodes[k + 1]];
        let (length, [first, second]) = (b.level - a.level, [depth.ln() - a.depth, b.depth - depth.ln()]);
        let parabola = [3.0 * first - second, first + second, 3.0 * second - first];
        let slopes = [a.slope, state.level / (depth * state.load_stiffness), b.slope];
        let scatter = parabola.iter().zip(slopes).map(|(parabola, slope)| (parabola - length * slope).abs());
        value.max(2.0 / 27.0 * scatter.sum::<f64>())
    }

    /// The level l with δ(l) + `give` l = `sum` \[m\]: 0 where the sum is not positive, infinite beyond the last
    /// state, NaN if numbers overflow. Logarithms of sums of powers are nearly linear in ln l, over any number of
    /// decades.
    pub(super) fn level_where(&self, give: f64, sum: f64) -> f64 {
        let Some((first, last)) = self.nodes.first().zip(self.nodes.last()).filter(|_| sum > 0.0) else { return 0.0 };
        let [sum, give, half] = [sum, give, 0.5 * sum].map(f64::ln);
        // ln (δ + give l) − ln sum, and its slope over ln l
        let excess = |[depth, slope, level]: [f64; 3]| {
            let yielded = give + level;
            let (greater, ratio) = (depth.max(yielded), (-(depth - yielded).abs()).exp());
            let [of_depth, of_yielded] = if depth > yielded { [1.0, ratio] } else { [ratio, 1.0] };
            [greater + ratio.ln_1p() - sum, (of_depth * slope + of_yielded) / (1.0 + ratio)]
        };
        let excess_at = |node: &Node| excess([node.depth, 1.0, node.level])[0];
        if excess_at(last) < 0.0 {
            return f64::INFINITY;
        }
        let upper = self.nodes.partition_point(|node| excess_at(node) < 0.0);
        if upper == 0 {
            // one of the summands is half of the sum at least
            let low = ((half - first.depth) / first.slope).min(half - give - first.level);
            let at = |s: f64| excess([first.depth + first.slope * s, first.slope, first.level + s]);
            let level = (first.level + root([low, 0.0], 0.0, ROUNDING, at)).exp();
            // what has no digits left is no contact
            return if level < f64::MIN_POSITIVE { 0.0 } else { level };
        }
        let [a, b] = [self.nodes[upper - 1], self.nodes[upper]];
        let (length, depths) = (b.level - a.level, [a.depth, b.depth]);
        let slopes = [a.slope, b.slope].map(|slope| slope * length);
        let at = |s: f64| {
            let [value, slope] =
                excess([hermite(depths, slopes, s), hermite_slope(depths, slopes, s) / length, a.level + s * length]);
            [value, slope * length]
        };
        (a.level + root([0.0, 1.0], 1.0, ROUNDING, at) * length).exp()
    }

    /// A quantity of the states that is a power of the level between two of them; below the first one, it falls as
    /// the power `of_radius` of the contact radius does where the depth is a power of the radius.
    fn power_law(&self, level: f64, of: impl Fn(&ElasticState) -> f64, of_radius: f64) -> f64 {
        let Some(first) = self.nodes.first().filter(|_| level > 0.0) else { return 0.0 };
        let level = level.ln();
        match self.between(level) {
            Some((k, s)) => {
                let [a, b] = [k, k + 1].map(|k| of(&self.states[k]));
                // full contact, whose stiffness is infinite
                if a == b || a == f64::INFINITY { a } else { a * (b / a).powf(s) }
            }
            None => {
                let (least, power) = (of(&self.states[0]), of_radius * (1.0 - first.slope).max(0.0));
                if least == f64::INFINITY { least } else { least * (power * (level - first.level)).exp() }
            }
        }
    }

    /// δ(l), and the tilts, which are cubics of ln l, and below the first state linear in l.
    pub(super) fn motions(&self, level: f64) -> Motions {
        let at = if level > 0.0 { self.between(level.ln()) } else { None };
        let tilt = |axis: usize| {
            let turned = |k: usize| self.states[k].tilt[axis] - self.rest.tilt[axis];
            let slope = |k: usize, length: f64| self.states[k].tilt_rate[axis] * self.states[k].level * length;
            let Some((k, s)) = at else { return turned(0) * level / self.states[0].level };
            let length = self.nodes[k + 1].level - self.nodes[k].level;
            hermite([k, k + 1].map(turned), [k, k + 1].map(|k| slope(k, length)), s)
        };
        Motions { depth: self.depth(level), tilt: [tilt(0), tilt(1)] }
    }

    /// Approach of the load point at a level, of the elastic contact \[m\].
    pub fn approach(&self, level: f64) -> f64 {
        known(level, self.rest.approach + self.depth(level))
    }

    /// The level of the elastic contact at an approach of the load point \[m²\]: 0 without contact, NaN beyond the
    /// last state. An elastic body of contact modulus E* carries the force E* times it.
    pub fn level_at(&self, approach: f64) -> f64 {
        let level = self.level_where(0.0, approach - self.rest.approach);
        if level == f64::INFINITY { f64::NAN } else { known(approach, level) }
    }

    /// Contact area at a level \[m²\].
    pub fn area(&self, level: f64) -> f64 {
        known(level, self.power_law(level, |state| state.area, 2.0))
    }

    /// The state at a level, or else the state below it, or the first one; `None` without contact.
    pub(super) fn state_at(&self, level: f64) -> Option<&ElasticState> {
        let above = self.states.partition_point(|state| state.level * (1.0 - NEAREST) <= level);
        (level > 0.0).then(|| &self.states[above.saturating_sub(1)])
    }

    /// Poisson's ratio of the layer that was swept, which a material has to have; `None` of other bodies.
    pub fn poisson_ratio(&self) -> Option<f64> {
        self.poisson
    }

    /// Stiffness over the contact modulus at a level \[m\], see [`ElasticState::stiffness`].
    pub fn stiffness(&self, level: f64) -> f64 {
        known(level, self.power_law(level, |state| state.stiffness, 1.0))
    }

    /// Conductance of the contact of two conductors of resistivities ρ₁ and ρ₂, electrical \[Ω m → S\] or thermal \[m
    /// K/W → W/K\]: 2 S/(E* (ρ₁ + ρ₂)), with S/E* the stiffness over the modulus (J. R. Barber, Proc. R. Soc. A 459,
    /// 2003). Exact for half-spaces that conduct through the contact alone. NaN where a resistivity is below 0.
    pub fn conductance(&self, level: f64, resistivities: [f64; 2]) -> f64 {
        let of = |resistivity: f64| if resistivity >= 0.0 { resistivity } else { f64::NAN };
        2.0 * self.stiffness(level) / resistivities.map(of).iter().sum::<f64>()
    }
}

/// A value at a place: NaN where the place is none.
fn known(place: f64, value: f64) -> f64 {
    if place.is_nan() { place } else { value }
}

debug_by!(self: ElasticStates => states: self.states.len(), last_level: self.last_level(), error: self.error);
