//! One indentation: the contact grows, and then shrinks until it ends (Ting 1966).
//!
//! While the contact grows, F(t) = ∫₀ᵗ E(t − s) df with f(δ) the elastic force of unit modulus at the depth δ. While it
//! shrinks, it is as large as at the earlier time t₁(t) with ∫ E(t − s) dδ(s) = 0 over t₁ < s < t, and F(t) = ∫ E(t − s) df over
//! 0 < s < t₁. This holds for every tip whose elastic contact only grows.
//!
//! Between samples the depth is linear, and df/dδ is a parabola with the right ends and the right mean. Integrals of the
//! exponentials with both are exact, for any ratio of a sampling interval to a relaxation time. A tip on a spring has the
//! depth z − F/k.

use crate::forward::moments::Moments;
use crate::forward::tip::{Elastic, Tip};
use crate::forward::{Drive, Sample};
use crate::model::Prony;

/// Depths that fall by less than this fraction of the greatest are held.
const HELD: f64 = 1e-13;
/// Roots end where they move by less than this fraction of a depth, or of an interval.
const CONVERGED: [f64; 2] = [1e-14, 1e-11];
/// Iterations of a root.
const MAX_ITERATIONS: usize = 80;

/// Why a cycle cannot be computed here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stop {
    /// The contact grows again after it has shrunk.
    Returns,
    /// The depth is beyond the last elastic state.
    Beyond(f64),
    /// The balance of the spring found no root.
    NoRoot,
}

/// The end of an interval.
struct Node {
    time: f64,
    depth: f64,
    elastic: Elastic,
}

/// A moment of the past: the interval after the node of this index, and the share of it that has passed. Depth and time are linear in the
/// share, so that a sudden step, whose interval has no length, has its depths in order.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    interval: usize,
    share: f64,
}

/// What the contact does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Growing,
    /// The contact is as large as at this place.
    Shrinking(Place),
    Separated,
}

/// A cycle up to the present sample.
pub(super) struct Cycle<'a> {
    prony: &'a Prony,
    tip: &'a Tip,
    /// 1/k of the spring \[m/N\].
    give: f64,
    nodes: Vec<Node>,
    /// ∫ Eᵢ exp(−(t − s)/τᵢ) df up to each node of growing contact, by node and term.
    forces: Vec<f64>,
    /// ∫ Eᵢ exp(−(t − s)/τᵢ) dδ up to each node, by node and term.
    depths: Vec<f64>,
    /// Moments over the present interval, and over the part of an interval before a place.
    moments: Moments,
    part: Moments,
    phase: Phase,
    /// Greatest depth \[m\].
    greatest: f64,
    /// Terms of the present force.
    terms: Vec<f64>,
}

impl<'a> Cycle<'a> {
    pub(super) fn new(prony: &'a Prony, tip: &'a Tip, give: f64) -> Cycle<'a> {
        Cycle {
            prony,
            tip,
            give,
            nodes: Vec::new(),
            forces: Vec::new(),
            depths: Vec::new(),
            moments: Moments::default(),
            part: Moments::default(),
            phase: Phase::Growing,
            greatest: 0.0,
            terms: vec![0.0; prony.moduli.len()],
        }
    }

    /// Computes a sample for each time; `record` is given each with the terms of its force.
    pub(super) fn follow(&mut self, drive: Drive<'_>, mut record: impl FnMut(Sample, &[f64])) -> Result<(), Stop> {
        for (k, (&time, &z)) in drive.times.iter().zip(drive.drive).enumerate() {
            if self.nodes.is_empty() && z > 0.0 {
                self.touch(k, drive);
            }
            let sample =
                if self.nodes.is_empty() { Sample { depth: z, ..Sample::default() } } else { self.advance(time, z)? };
            record(sample, &self.terms);
        }
        Ok(())
    }

    /// First touch: at the zero of the drive between two samples, or at the first sample, suddenly.
    fn touch(&mut self, sample: usize, drive: Drive<'_>) {
        let (time, z) = (drive.times[sample], drive.drive[sample]);
        let before = sample.checked_sub(1).map(|before| (drive.times[before], drive.drive[before]));
        let start = before.map_or(time, |(t0, z0)| t0 + (time - t0) * z0 / (z0 - z));
        self.nodes.push(Node { time: start, depth: 0.0, elastic: self.tip.first() });
        self.forces.resize(self.terms.len(), 0.0);
        self.depths.resize(self.terms.len(), 0.0);
    }

    /// Goes on to the next sample.
    fn advance(&mut self, time: f64, z: f64) -> Result<Sample, Stop> {
        let last = self.nodes.len() - 1;
        let Node { time: before, depth, elastic } = self.nodes[last];
        self.moments.set(time - before, &self.prony.rates);
        let sample = match self.phase {
            Phase::Growing => {
                let held = if self.give > 0.0 { z - self.give * self.force_at(depth, elastic) } else { z };
                // what has just touched grows
                if last == 0 || held >= depth - HELD * self.greatest {
                    self.grow(z)?
                } else {
                    self.shrink(time, z, Place { interval: last.saturating_sub(1), share: 1.0 })?
                }
            }
            Phase::Shrinking(place) => {
                // the contact grows again
                if self.unbalance(time, z, place)? > HELD * self.scale() {
                    return Err(Stop::Returns);
                }
                self.shrink(time, z, place)?
            }
            Phase::Separated => Sample { depth: z, ..Sample::default() },
        };
        let mut unbalance = 0.0;
        for i in 0..self.terms.len() {
            let past = self.moments.decay[i] * self.depths[last * self.terms.len() + i];
            let now = past + self.prony.moduli[i] * (sample.depth - depth) * self.moments.moments[i][0];
            self.depths.push(now);
            unbalance += now;
        }
        // below zero, the surface recovers more slowly than the tip leaves it
        if self.phase == Phase::Separated && unbalance > HELD * self.scale() {
            return Err(Stop::Returns);
        }
        self.greatest = self.greatest.max(sample.depth);
        if self.phase != Phase::Growing {
            self.nodes.push(Node { time, depth: sample.depth, elastic: Elastic::default() });
        } else {
            let elastic = self.tip.at(sample.depth).ok_or(Stop::Beyond(sample.depth))?;
            self.nodes.push(Node { time, depth: sample.depth, elastic });
        }
        Ok(sample)
    }

    /// Terms of the force at the end of the present interval, if the depth grows to `depth` in it.
    fn force_at(&mut self, depth: f64, elastic: Elastic) -> f64 {
        let last = self.nodes.len() - 1;
        let node = &self.nodes[last];
        let weights = parabola(node.depth, node.elastic, depth, elastic);
        let past = &self.forces[last * self.terms.len()..];
        for (i, term) in self.terms.iter_mut().enumerate() {
            *term = self.moments.decay[i] * past[i] + self.prony.moduli[i] * dot(weights, self.moments.moments[i]);
        }
        self.terms.iter().sum()
    }

    /// The contact grows, or is held.
    fn grow(&mut self, z: f64) -> Result<Sample, Stop> {
        let from = self.nodes[self.nodes.len() - 1].depth;
        let depth = if self.give > 0.0 { self.balanced_depth(z, from)? } else { z.max(from) };
        let elastic = self.tip.at(depth).ok_or(Stop::Beyond(depth))?;
        let force = self.force_at(depth, elastic);
        self.forces.extend_from_slice(&self.terms);
        Ok(Sample { force, depth, contact_depth: depth })
    }

    /// The depth δ with z = δ + F(δ)/k, which is at least `from`.
    fn balanced_depth(&mut self, z: f64, from: f64) -> Result<f64, Stop> {
        let deepest = z.max(from).min(self.tip.last_depth());
        let mut excess = |depth: f64| {
            let elastic = self.tip.at(depth).ok_or(Stop::Beyond(depth))?;
            Ok(z - depth - self.give * self.force_at(depth, elastic))
        };
        // the spring pushes deeper than the states reach
        if excess(deepest)? > 0.0 && deepest < z {
            return Err(Stop::Beyond(z));
        }
        root([from, deepest], CONVERGED[0] * deepest, excess)
    }

    /// The contact shrinks from its extent at a place, at or before which it ends.
    fn shrink(&mut self, time: f64, z: f64, latest: Place) -> Result<Sample, Stop> {
        let Place { mut interval, share: mut upper } = latest;
        // the interval in which the balance changes its sign
        while self.unbalance(time, z, Place { interval, share: 0.0 })? < 0.0 {
            let Some(before) = interval.checked_sub(1) else {
                self.phase = Phase::Separated;
                self.terms.fill(0.0);
                return Ok(Sample { depth: z, ..Sample::default() });
            };
            (interval, upper) = (before, 1.0);
        }
        let share = root([0.0, upper], CONVERGED[1], |share| self.unbalance(time, z, Place { interval, share }))?;
        let place = Place { interval, share };
        self.phase = Phase::Shrinking(place);
        let contact_depth = self.contact(time, place)?;
        let force = self.terms.iter().sum();
        Ok(Sample { force, depth: z - self.give * force, contact_depth })
    }

    /// The scale of the balance.
    fn scale(&self) -> f64 {
        self.prony.moduli.iter().sum::<f64>() * self.greatest
    }

    fn time_of(&self, place: Place) -> f64 {
        let [a, b] = [&self.nodes[place.interval], &self.nodes[place.interval + 1]];
        a.time + place.share * (b.time - a.time)
    }

    /// Fills the terms of the force at `time` with the contact of a place; returns the depth there.
    fn contact(&mut self, time: f64, place: Place) -> Result<f64, Stop> {
        let then = self.time_of(place);
        let [a, b] = [&self.nodes[place.interval], &self.nodes[place.interval + 1]];
        let depth = a.depth + place.share * (b.depth - a.depth);
        let elastic = if place.share == 1.0 { b.elastic } else { self.tip.at(depth).ok_or(Stop::Beyond(depth))? };
        let weights = parabola(a.depth, a.elastic, depth, elastic);
        self.part.set(then - a.time, &self.prony.rates);
        let past = &self.forces[place.interval * self.terms.len()..];
        for (i, term) in self.terms.iter_mut().enumerate() {
            let at = self.part.decay[i] * past[i] + self.prony.moduli[i] * dot(weights, self.part.moments[i]);
            *term = at * (-(time - then) * self.prony.rates[i]).exp();
        }
        Ok(depth)
    }

    /// ∫ E(t − s) dδ from a place on, with the depth at t that balances the spring: it falls as the place gets later.
    fn unbalance(&mut self, time: f64, z: f64, place: Place) -> Result<f64, Stop> {
        let mut depth = z;
        if self.give > 0.0 {
            self.contact(time, place)?;
            depth -= self.give * self.terms.iter().sum::<f64>();
        }
        let then = self.time_of(place);
        let [a, b] = [&self.nodes[place.interval], &self.nodes[place.interval + 1]];
        self.part.set(then - a.time, &self.prony.rates);
        let (last, terms) = (self.nodes.len() - 1, self.terms.len());
        let (grown, fallen) = (place.share * (b.depth - a.depth), depth - self.nodes[last].depth);
        let now = &self.depths[last * terms..];
        let past = &self.depths[place.interval * terms..];
        let of_term = |i: usize| {
            let now = self.moments.decay[i] * now[i] + self.prony.moduli[i] * fallen * self.moments.moments[i][0];
            let past = self.part.decay[i] * past[i] + self.prony.moduli[i] * grown * self.part.moments[i][0];
            now - past * (-(time - then) * self.prony.rates[i]).exp()
        };
        Ok((0..terms).map(of_term).sum())
    }
}

/// The root of a function that falls between two values, by the Illinois rule; the end that is nearer to a root outside.
fn root(
    [mut low, mut high]: [f64; 2],
    tolerance: f64,
    mut value: impl FnMut(f64) -> Result<f64, Stop>,
) -> Result<f64, Stop> {
    let (mut below, mut above) = (value(low)?, value(high)?);
    if below <= 0.0 || above >= 0.0 {
        return Ok(if below <= 0.0 { low } else { high });
    }
    let (mut last_side, mut last) = (None, f64::NAN);
    for _ in 0..MAX_ITERATIONS {
        let at = low + (high - low) * (below / (below - above));
        let here = value(at)?;
        if here == 0.0 || (at - last).abs() <= tolerance || high - low <= tolerance {
            return Ok(at);
        }
        last = at;
        let side = here > 0.0;
        let share = if last_side == Some(side) { 0.5 } else { 1.0 };
        if side {
            (low, below, above) = (at, here, above * share);
        } else {
            (high, above, below) = (at, here, below * share);
        }
        last_side = Some(side);
    }
    Err(Stop::NoRoot)
}

/// Coefficients of ξ⁰, ξ¹, ξ² of df/dξ over an interval: a parabola with the ends and the mean of df/dδ.
fn parabola(from: f64, start: Elastic, to: f64, end: Elastic) -> [f64; 3] {
    let (rise, growth) = (to - from, end.force - start.force);
    let [a, b] = [start.stiffness * rise, end.stiffness * rise];
    [a, 6.0 * growth - 4.0 * a - 2.0 * b, 3.0 * (a + b) - 6.0 * growth]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
