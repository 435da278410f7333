//! The contact of a tip under any drive (Ting 1966, 1968).
//!
//! The contact is a bed of columns (Popov & Heß, *Method of Dimensionality Reduction*, 2015): the column d touches an elastic body at
//! the depth d, and columns up to c share the force f(c), with f the elastic force of unit modulus. A column in contact follows the
//! tip, and its pressure is ∫ E(t − s) dδ(s). It leaves the tip where its pressure falls to zero, recovers without pressure, and
//! touches again where the tip reaches it. The edge c(t) of the contact has no pressure, so that the force
//! F = ∫₀ᶜ p(d, t) df′(d) does not depend on small errors of c.
//!
//! Between samples the depth is linear, and f′ is a parabola with the right ends and the right mean over the columns that touch.
//! Integrals of the exponentials with both are exact, for any ratio of a sampling interval to a relaxation time: exact are indentations by
//! cone and punch until the contact grows again after it has shrunk. There, and for other tips, the error falls with the square of the
//! interval or faster. A tip on a spring has the depth z − F/k.

mod shrinking;

use crate::error::Result;
use crate::forward::Sample;
use crate::forward::column::Columns;
use crate::forward::growth::{Growth, Term};
use crate::forward::moments::Moments;
use crate::forward::real::Real;
use crate::forward::tip::{Elastic, Tip};
use crate::series::Prony;

/// A pressure at the edge of less than this fraction of the largest is none: the contact is held. The force changes by the square.
const HELD: f64 = 1e-12;

/// The end of an interval in which the contact grew.
#[derive(Clone, Copy, Debug)]
struct Node<const N: usize> {
    time: Real<N>,
    /// Depth of the tip \[m\].
    depth: Real<N>,
    /// The column at the edge \[m\], and the elastic contact up to it.
    extent: Real<N>,
    elastic: Elastic<N>,
    /// Whether the column at the edge has not touched before.
    fresh: bool,
}

/// The column at the edge of the contact: that which touched after a node, at a share of the time to the next.
#[derive(Clone, Copy, Debug)]
struct Edge<const N: usize> {
    node: usize,
    share: Real<N>,
    extent: Real<N>,
    elastic: Elastic<N>,
}

/// A contact up to the present.
pub(crate) struct Cycle<'a, const N: usize> {
    prony: &'a Prony<Real<N>>,
    tip: &'a Tip,
    times: &'a [f64],
    /// 1/k of the spring \[m/N\].
    give: Real<N>,
    /// Intervals of growth up to the edge, with the terms at each node.
    nodes: Vec<Node<N>>,
    past: Vec<Term<N>>,
    edge: Edge<N>,
    /// Whether the last node is the present.
    is_node: bool,
    columns: Columns<'a, N>,
    time: Real<N>,
    drive: Real<N>,
    depth: Real<N>,
    terms: Vec<Term<N>>,
    /// Terms at another time, and what they have decayed by since.
    then: Vec<Term<N>>,
    since: Vec<Real<N>>,
    moments: Moments<N>,
    part: Moments<N>,
    /// Maximum depth \[m\].
    greatest: f64,
}

impl<'a, const N: usize> Cycle<'a, N> {
    /// A tip on a spring of this `give`; the contact is computed at some times.
    pub(crate) fn new(prony: &'a Prony<Real<N>>, tip: &'a Tip, give: Real<N>, times: &'a [f64]) -> Self {
        let (zero, terms) = (Real::from(0.0), vec![Term::default(); prony.moduli.len()]);
        Cycle {
            prony,
            tip,
            times,
            give,
            nodes: Vec::new(),
            past: Vec::new(),
            edge: Edge { node: 0, share: zero, extent: zero, elastic: tip.first() },
            is_node: true,
            columns: Columns::new(prony, times),
            time: Real::from(times[0]),
            drive: zero,
            depth: zero,
            then: terms.clone(),
            since: vec![zero; terms.len()],
            terms,
            moments: Moments::default(),
            part: Moments::default(),
            greatest: 0.0,
        }
    }

    /// Follows a drive beyond the contact point \[m\]; `record` is given the contact at each time.
    pub(crate) fn follow(mut self, drive: &[Real<N>], mut record: impl FnMut(&Self)) -> Result<()> {
        for (sample, (&time, &z)) in self.times.iter().zip(drive).enumerate() {
            self.advance(sample, Real::from(time), z)?;
            record(&self);
        }
        Ok(())
    }

    pub(crate) fn force(&self) -> Real<N> {
        self.forces().fold(Real::from(0.0), |sum, force| sum + force)
    }

    /// The force of each term of the series.
    pub(crate) fn forces(&self) -> impl Iterator<Item = Real<N>> {
        self.terms.iter().map(|term| term.force)
    }

    /// The present without derivatives.
    pub(crate) fn sample(&self) -> Sample {
        let contact_depth = if self.nodes.is_empty() { 0.0 } else { self.edge.extent.value() };
        Sample { force: self.force().value(), depth: self.depth.value(), contact_depth }
    }

    /// Σ over the terms after an interval.
    fn decayed(&self, moments: &Moments<N>, of: impl Fn(&Term<N>) -> Real<N>) -> Real<N> {
        let pairs = self.terms.iter().zip(&moments.decay);
        pairs.fold(Real::from(0.0), |sum, (term, &decay)| sum + decay * of(term))
    }

    /// Σ Eᵢ M₀ of an interval: the pressure of a column that the tip moves by 1 m.
    fn stiffness(&self, moments: &Moments<N>) -> Real<N> {
        let pairs = self.prony.moduli.iter().zip(&moments.moments);
        pairs.fold(Real::from(0.0), |sum, (&modulus, moments)| sum + modulus * moments[0])
    }

    fn springs(&self) -> bool {
        self.give.value() > 0.0
    }

    /// Advances to a sample.
    fn advance(&mut self, sample: usize, time: Real<N>, z: Real<N>) -> Result<()> {
        let is_separated = self.nodes.is_empty();
        if is_separated && !self.touches(sample, time, z) {
            (self.time, self.drive, self.depth) = (time, z, z);
            return Ok(());
        }
        self.moments.set(time - self.time, !is_separated, &self.prony.rates);
        // where the tip would be, and the pressure at the edge, if the contact neither grew nor shrank
        let (unit, stiffness) = (self.stiffness(&self.moments), self.edge.elastic.stiffness);
        let mut depth = z;
        if self.springs() {
            let excess = z - self.depth - self.give * self.decayed(&self.moments, |term| term.force);
            depth = self.depth + excess / (Real::from(1.0) + self.give * stiffness * unit);
        }
        let pressure = (self.decayed(&self.moments, |term| term.edge) + unit * (depth - self.depth)).value();
        let scale: f64 = self.prony.moduli.iter().map(|modulus| modulus.value().abs()).sum::<f64>() * self.greatest;
        if pressure > 0.0 {
            self.grow(sample, time, z, depth.value())?;
        } else if pressure >= -HELD * scale {
            self.hold(depth);
        } else {
            self.shrink(sample, time, z, pressure)?;
        }
        (self.time, self.drive) = (time, z);
        self.greatest = self.greatest.max(self.depth.value());
        Ok(())
    }

    /// Whether the tip touches the surface before a sample: then the time of the touch is the present.
    fn touches(&mut self, sample: usize, time: Real<N>, z: Real<N>) -> bool {
        let [before, after] = self.columns.next(sample);
        if z.value() <= after.value() {
            return false;
        }
        let (zero, one) = (Real::from(0.0), Real::from(1.0));
        // at the first sample suddenly
        let mut share = if sample == 0 { one } else { (before - self.drive) / (z - self.drive - after + before) };
        if sample > 0 && !(0.0..=1.0).contains(&share.value()) {
            share = zero;
        }
        self.time = self.time + share * (time - self.time);
        self.drive = if sample == 0 { zero } else { self.drive + share * (z - self.drive) };
        self.depth = before + share * (after - before);
        let elastic: Elastic<N> = self.tip.first();
        for (i, term) in self.terms.iter_mut().enumerate() {
            let edge = self.columns.state(i, share);
            *term = Term { tip: edge, force: elastic.stiffness * edge, edge };
        }
        self.columns.pop();
        self.push(self.time, zero, elastic);
        true
    }

    /// The present, where the contact has grown to an edge, becomes a node.
    fn push(&mut self, time: Real<N>, extent: Real<N>, elastic: Elastic<N>) {
        let fresh = self.terms.iter().all(|term| term.edge.value() == 0.0);
        self.edge = Edge { node: self.nodes.len(), share: Real::from(0.0), extent, elastic };
        self.nodes.push(Node { time, depth: self.depth, extent, elastic, fresh });
        self.past.extend_from_slice(&self.terms);
        self.is_node = true;
    }

    /// The tip moves to a depth at which the contact neither grows nor shrinks.
    fn hold(&mut self, depth: Real<N>) {
        let rise = depth - self.depth;
        for (i, term) in self.terms.iter_mut().enumerate() {
            let (decay, added) = (self.moments.decay[i], self.prony.moduli[i] * rise * self.moments.moments[i][0]);
            *term = Term {
                tip: decay * term.tip + added,
                force: decay * term.force + self.edge.elastic.stiffness * added,
                edge: decay * term.edge + added,
            };
        }
        self.depth = depth;
        self.is_node = false;
    }

    /// The contact grows until a sample: over one free column after the other, and then over columns that have not touched. The tip ends
    /// near some depth.
    fn grow(&mut self, sample: usize, time: Real<N>, z: Real<N>, near: f64) -> Result<()> {
        self.settle()?;
        let (zero, one) = (Real::from(0.0), Real::from(1.0));
        // share of the interval that has passed
        let mut passed = zero;
        loop {
            let next = self.columns.next_extent();
            let [before, after] = self.columns.next(sample);
            let before = before + passed * (after - before);
            if let Some(extent) = next.filter(|_| !self.springs() && z.value() > after.value()) {
                passed = self.reach(extent, before, after, z - after, time, passed)?;
                continue;
            }
            if passed.value() > 0.0 {
                self.moments.set(time - self.time, false, &self.prony.rates);
            }
            // where the column at the edge would be, had it been free
            let unit = self.stiffness(&self.moments);
            let released = self.depth - self.decayed(&self.moments, |term| term.edge) / unit;
            let start = (self.edge.extent, self.edge.elastic);
            let width = next.map(|next| (next - start.0, after - released));
            let mut sums = [[zero; 3]; 4];
            for (i, term) in self.terms.iter().enumerate().filter(|_| self.springs()) {
                let (modulus, moments) = (self.prony.moduli[i], &self.moments.moments[i]);
                let free = self.moments.decay[i] * term.edge + modulus * moments[0] * (released - self.depth);
                let reached = if next.is_some() { self.columns.state(i, one) } else { zero };
                for (sum, factor) in sums.iter_mut().zip([modulus, term.edge, free - term.edge, reached - free]) {
                    (0..3).for_each(|k| sum[k] = sum[k] + factor * moments[k]);
                }
            }
            let past = self.decayed(&self.moments, |term| term.force);
            let is_fresh = self.nodes[self.nodes.len() - 1].fresh && next.is_none();
            let (tip, give, depth_before) = (self.tip, self.give, self.depth);
            // the share of the way to the next column, the edge, and the growth of a contact that ends with the tip at a depth
            let at = |depth: Real<N>| {
                let (share, extent) = match width {
                    Some((width, travel)) => {
                        let share = if travel.value() > 0.0 { (depth - released) / travel } else { one };
                        (share, start.0 + share * width)
                    }
                    None => (zero, start.0 + depth - released),
                };
                tip.at(extent).map(|elastic| {
                    let growth = Growth::new(start, (extent, elastic), depth - depth_before, is_fresh);
                    (share, extent, elastic, growth)
                })
            };
            let excess = |depth: Real<N>| {
                let (share, .., growth) = at(depth)?;
                let change = |k: usize| sums[2][k] + share * sums[3][k];
                Ok(z - depth - give * (past + growth.force(&sums[0], &sums[1], &[change(0), change(1), change(2)])))
            };
            if let Some(extent) = next.filter(|_| self.springs()) {
                let left = excess(after)?;
                if left.value() > 0.0 {
                    passed = self.reach(extent, before, after, left, time, passed)?;
                    continue;
                }
            }
            let depth = if self.springs() {
                let deepest = z.value().max(released.value());
                let limit = tip.last_depth + (released - start.0).value();
                let is_limited = width.is_none() && deepest > limit;
                let end = width.map_or(if is_limited { Real::from(limit) } else { z }, |_| after);
                // the spring pushes deeper than the states reach
                if is_limited && excess(end)?.value() > 0.0 {
                    return Err(tip.beyond(z.value()));
                }
                let near = (near - released.value()) / (end - released).value();
                Real::root([released, end], near, excess)?
            } else {
                z
            };
            let (share, extent, elastic, growth) = at(depth)?;
            std::mem::swap(&mut self.part, &mut self.moments);
            self.append(time, depth, (extent, elastic), growth, |columns, i, free| {
                if next.is_some() { free + share * (columns.state(i, one) - free) } else { zero }
            });
            std::mem::swap(&mut self.part, &mut self.moments);
            return Ok(());
        }
    }

    /// The contact grows to the next column, whose surface rises from `before`, where a share of the interval has passed, to `after` and leaves the
    /// spring this excess. Returns the share that has passed then.
    fn reach(
        &mut self,
        extent: Real<N>,
        before: Real<N>,
        after: Real<N>,
        left: Real<N>,
        time: Real<N>,
        passed: Real<N>,
    ) -> Result<Real<N>> {
        let (zero, one, start) = (Real::from(0.0), Real::from(1.0), (self.edge.extent, self.edge.elastic));
        // the gap is linear in time
        let instant = self.prony.moduli.iter().fold(zero, |sum, &modulus| sum + modulus);
        let gap = (self.depth - before) * (one + self.give * start.1.stiffness * instant);
        let share = if gap.value() < 0.0 { gap / (gap - left) } else { zero };
        let (elastic, depth) = (self.tip.at(extent)?, before + share * (after - before));
        let growth = Growth::new(start, (extent, elastic), depth - self.depth, false);
        let (length, all) = (share * (time - self.time), passed + share * (one - passed));
        self.part.set(length, false, &self.prony.rates);
        self.append(self.time + length, depth, (extent, elastic), growth, |columns, i, _| columns.state(i, all));
        self.columns.pop();
        Ok(all)
    }

    /// Ends an interval of growth whose moments are those of a part. `edge` is the pressure of a term at the edge, by the columns, the term and
    /// the pressure of the last edge, had it been free.
    fn append(
        &mut self,
        time: Real<N>,
        depth: Real<N>,
        (extent, elastic): (Real<N>, Elastic<N>),
        growth: Growth<N>,
        edge: impl Fn(&Columns<'a, N>, usize, Real<N>) -> Real<N>,
    ) {
        let zero = Real::from(0.0);
        let released = self.decayed(&self.part, |term| term.edge) / self.stiffness(&self.part);
        for i in 0..self.terms.len() {
            let (modulus, decay, moments) = (self.prony.moduli[i], self.part.decay[i], &self.part.moments[i]);
            let term = &self.terms[i];
            let free = if growth.fresh { zero } else { decay * term.edge - modulus * moments[0] * released };
            self.terms[i] = growth.after(term, modulus, decay, moments, edge(&self.columns, i, free));
        }
        (self.time, self.depth) = (time, depth);
        self.push(time, extent, elastic);
    }

    /// Makes the present a node: cuts the interval in which the column at the edge touched, and adds one in which nothing did.
    fn settle(&mut self) -> Result<()> {
        if self.is_node {
            return Ok(());
        }
        let edge = self.edge;
        let at = self.look(edge.node, edge.share)?;
        self.nodes.truncate(edge.node + 1);
        self.past.truncate(self.nodes.len() * self.terms.len());
        if edge.share.value() > 0.0 {
            let fresh = self.then.iter().all(|term| term.edge.value() == 0.0);
            self.nodes.push(Node { fresh, ..at });
            self.past.extend_from_slice(&self.then);
        }
        self.push(self.time, edge.extent, edge.elastic);
        Ok(())
    }
}
