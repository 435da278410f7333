//! Columns that have left the tip.

use crate::forward::moments::Moments;
use crate::forward::real::Real;
use crate::series::Prony;

/// A column without pressure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column<const N: usize> {
    pub(super) extent: Real<N>,
    /// Depth of the tip at which it touches again \[m\].
    pub(super) surface: Real<N>,
    /// Sample of this state.
    pub(super) sample: usize,
}

/// Columns that have left the tip and recover without pressure: those that touch again first are the last ones. Between two of them the
/// state is linear.
#[derive(Clone, Debug)]
pub(super) struct Columns<'a, const N: usize> {
    prony: &'a Prony<Real<N>>,
    times: &'a [f64],
    columns: Vec<Column<N>>,
    /// Parts of the pressure, by column and term: their sum is zero.
    states: Vec<Real<N>>,
    moments: Moments<N>,
    /// The state of the last column at the next sample.
    after: Vec<Real<N>>,
}

impl<'a, const N: usize> Columns<'a, N> {
    pub(super) fn new(prony: &'a Prony<Real<N>>, times: &'a [f64]) -> Self {
        let after = vec![Real::from(0.0); prony.moduli.len()];
        Columns { prony, times, columns: Vec::new(), states: Vec::new(), moments: Moments::default(), after }
    }

    /// A column leaves the tip at a sample.
    pub(super) fn push(&mut self, column: Column<N>, state: impl Iterator<Item = Real<N>>) {
        self.columns.push(column);
        self.states.extend(state);
    }

    pub(super) fn pop(&mut self) {
        if self.columns.pop().is_some() {
            self.states.truncate(self.states.len() - self.after.len());
        }
    }

    /// The column that touches next; `None` where no further column has touched before.
    pub(super) fn next_extent(&self) -> Option<Real<N>> {
        Some(self.columns.last()?.extent)
    }

    /// Surface of the column that touches next, at the sample before and at a sample; the undisturbed surface if there is none.
    pub(super) fn next(&mut self, sample: usize) -> [Real<N>; 2] {
        let Some(last) = self.columns.last_mut() else { return [Real::from(0.0); 2] };
        let first = self.states.len() - self.after.len();
        let state = &mut self.states[first..];
        self.after.copy_from_slice(state);
        let mut surface = last.surface;
        while last.sample < sample {
            (last.surface, last.sample) = (surface, last.sample + 1);
            state.copy_from_slice(&self.after);
            let length = self.times[last.sample] - self.times[last.sample - 1];
            self.moments.set(Real::from(length), true, &self.prony.rates);
            surface = surface + recover(&mut self.after, self.prony, &self.moments);
        }
        // the state before a sample is kept
        last.sample = sample.saturating_sub(1);
        [last.surface, surface]
    }

    /// Part of a term of the pressure of the column that touches next, at a share of the interval of [`Columns::next`].
    pub(super) fn state(&self, term: usize, share: Real<N>) -> Real<N> {
        if self.columns.is_empty() {
            return Real::from(0.0);
        }
        let before = self.states[self.states.len() - self.after.len() + term];
        before + share * (self.after[term] - before)
    }
}

/// Advances a state by an interval without pressure; returns the motion of the surface.
fn recover<const N: usize>(state: &mut [Real<N>], prony: &Prony<Real<N>>, moments: &Moments<N>) -> Real<N> {
    let (mut pressure, mut unit) = (Real::from(0.0), Real::from(0.0));
    for (i, state) in state.iter().enumerate() {
        pressure = pressure + moments.decay[i] * *state;
        unit = unit + prony.moduli[i] * moments.moments[i][0];
    }
    let rise = Real::from(0.0) - pressure / unit;
    for (i, state) in state.iter_mut().enumerate() {
        *state = moments.decay[i] * *state + prony.moduli[i] * rise * moments.moments[i][0];
    }
    rise
}
