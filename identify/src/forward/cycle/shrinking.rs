//! Steps in which the contact shrinks: columns leave the tip where their pressure falls to zero.

use super::{Cycle, Edge, Node};
use crate::error::Result;
use crate::forward::column::Column;
use crate::forward::growth::{Growth, Term};
use crate::forward::real::Real;

/// Columns nearer to the last than this fraction of the maximum depth are as it is.
const NEAR: f64 = 2e-4;

impl<const N: usize> Cycle<'_, N> {
    /// The contact when the column touched that is at a share of the interval after a node; `then` has the terms.
    pub(super) fn look(&mut self, node: usize, share: Real<N>) -> Result<Node<N>> {
        let count = self.terms.len();
        let past = &self.past[node * count..];
        let a = self.nodes[node];
        if share.value() == 0.0 {
            self.then.copy_from_slice(&past[..count]);
            return Ok(a);
        }
        let b = self.nodes[node + 1];
        let [length, rise, width] =
            [b.time - a.time, b.depth - a.depth, b.extent - a.extent].map(|whole| share * whole);
        let extent = a.extent + width;
        let elastic = self.tip.at(extent)?;
        let growth = Growth::new((a.extent, a.elastic), (extent, elastic), rise, a.fresh && b.fresh);
        self.part.set(length, false, &self.prony.rates);
        for i in 0..count {
            let (start, end) = (&past[i], past[count + i].edge);
            let edge = start.edge + share * (end - start.edge);
            let (decay, moments) = (self.part.decay[i], &self.part.moments[i]);
            self.then[i] = growth.after(start, self.prony.moduli[i], decay, moments, edge);
        }
        Ok(Node { time: a.time + length, depth: a.depth + rise, extent, elastic, fresh: false })
    }

    /// The contact when a column touched; the pressure of this column at a sample, times the length that one sample adds to it, and the depth of the
    /// tip, if it moves so far that the spring is balanced with the contact up to this column; and the rise without pressure.
    fn pressure(&mut self, node: usize, share: Real<N>, time: Real<N>, z: Real<N>) -> Result<(Node<N>, [Real<N>; 3])> {
        let at = self.look(node, share)?;
        let (mut force, mut past) = (Real::from(0.0), Real::from(0.0));
        let elapsed = time - at.time;
        for (i, term) in self.then.iter().enumerate() {
            let decay = (self.prony.rates[i] * elapsed).decay();
            past = past + decay * (term.tip - term.edge);
            force = force + decay * (term.force - at.elastic.stiffness * term.edge);
            self.since[i] = decay;
        }
        let depth = if self.springs() { z - self.give * force } else { z };
        let (unit, tip) = (self.stiffness(&self.moments), self.decayed(&self.moments, |term| term.tip));
        Ok((at, [unit * (depth - self.depth) + tip - past, depth, (past - tip) / unit]))
    }

    /// The contact shrinks to the column without pressure, from the pressure at the edge.
    pub(super) fn shrink(&mut self, sample: usize, time: Real<N>, z: Real<N>, mut outside: f64) -> Result<()> {
        let (zero, one) = (Real::from(0.0), Real::from(1.0));
        let last = Column { extent: self.edge.extent, surface: self.depth, sample: sample - 1 };
        self.columns.push(last, self.terms.iter().map(|term| term.edge));
        let (mut node, mut upper) = (self.edge.node, self.edge.share);
        let inside = loop {
            let (at, [pressure, _, rise]) = self.pressure(node, zero, time, z)?;
            if upper.value() > 0.0 && pressure.value() >= 0.0 {
                break pressure.value();
            }
            let last = self.columns.next_extent().unwrap_or_default();
            if node == 0 || upper.value() > 0.0 && (last - at.extent).value() > NEAR * self.greatest {
                self.release(sample, at.extent, rise);
            }
            if node == 0 {
                // the last column has left the tip
                self.nodes.clear();
                self.past.clear();
                self.terms.fill(Term::default());
                self.depth = z;
                self.is_node = true;
                return Ok(());
            }
            (node, upper, outside) = (node - 1, one, pressure.value());
        };
        let near = inside / (inside - outside);
        let share = Real::root([zero, upper], near, |share| Ok(self.pressure(node, share, time, z)?.1[0]))?;
        let (at, [_, depth, _]) = self.pressure(node, share, time, z)?;
        let rise = depth - self.depth;
        for (i, then) in self.then.iter().enumerate() {
            let decay = self.since[i];
            let moved = self.prony.moduli[i] * rise * self.moments.moments[i][0];
            let tip = self.moments.decay[i] * self.terms[i].tip + moved;
            let force = decay * then.force + at.elastic.stiffness * (tip - decay * then.tip);
            self.terms[i] = Term { tip, force, edge: tip - decay * (then.tip - then.edge) };
        }
        self.edge = Edge { node, share, extent: at.extent, elastic: at.elastic };
        self.depth = depth;
        self.is_node = false;
        self.nodes.truncate(node + 2);
        self.past.truncate(self.nodes.len() * self.terms.len());
        Ok(())
    }

    /// The column of a node leaves the tip, from the last look at it. It is free from the sample on, where it would be without pressure.
    fn release(&mut self, sample: usize, extent: Real<N>, rise: Real<N>) {
        let state = |i: usize| {
            let (then, decay) = (&self.then[i], self.since[i]);
            let moved = self.prony.moduli[i] * rise * self.moments.moments[i][0];
            self.moments.decay[i] * self.terms[i].tip + moved - decay * (then.tip - then.edge)
        };
        let column = Column { extent, surface: self.depth + rise, sample };
        self.columns.push(column, (0..self.terms.len()).map(state));
    }
}
